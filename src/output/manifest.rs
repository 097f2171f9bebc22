//! The list of the results in a folder, `archrock.json`: which files each command wrote, and for which scenario.

use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};
use std::{fs, io};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::OutputError;
use crate::scenario::{self, Scenario, StudyTable, shown};

/// Name of the list.
pub(super) const MANIFEST: &str = "archrock.json";

/// The results in a folder and its subfolders. Only the files that it lists are removed or replaced.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
pub struct Manifest {
    /// Name of the program.
    program: String,
    /// The results of each command, by its name.
    results: BTreeMap<String, CommandResults>,
}

/// The results of the last run of a command.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
struct CommandResults {
    /// Version of the program.
    version: String,
    /// False while the files are being replaced, and after a kill at that time.
    complete: bool,
    #[serde(flatten)]
    origin: Origin,
    /// The files in the order in which they were written, relative to the folder.
    files: Vec<String>,
}

/// The scenario of results.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
pub struct Origin {
    /// The scenario file, if the folder is named after it.
    pub scenario_file: Option<String>,
    /// Checksum of each table of the scenario.
    scenario: BTreeMap<String, String>,
    /// Name and checksum of each record file.
    records: Vec<String>,
    /// The input files, which results must not replace.
    #[serde(skip)]
    inputs: Vec<PathBuf>,
}

impl Manifest {
    /// Reads the list of a folder; it is empty if there is none.
    ///
    /// # Errors
    /// When the file with its name is not such a list.
    pub fn read(folder: &Path) -> Result<Self, OutputError> {
        let path = folder.join(MANIFEST);
        let text = match fs::metadata(&path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Self::default()),
            // Reading a pipe of that name would never end.
            Ok(found) if found.is_file() => fs::read(&path).unwrap_or_default(),
            _ => Vec::new(),
        };
        // No file outside the folder is a result.
        let is_below = |name: &String| {
            let mut parts = Path::new(name).components();
            parts.all(|part| matches!(part, Component::Normal(_)))
        };
        let is_sound = |found: &Self| {
            let mut files = found.results.values().flat_map(|results| &results.files);
            found.program == env!("CARGO_PKG_NAME") && files.all(is_below)
        };
        let found = serde_json::from_slice::<Self>(&text).ok();
        found.filter(is_sound).ok_or(OutputError::NoManifest(path))
    }

    /// Returns the files of the last run of a command, in the order in which they were written.
    pub(super) fn files(&self, command: &str) -> &[String] {
        self.results.get(command).map_or(&[], |it| &it.files)
    }

    /// Returns the other scenario of the same name whose results are in the folder, in words; `None` if the user chose the folder.
    pub(super) fn other_scenario(&self, command: &str, own: &Origin) -> Option<String> {
        let file = own.scenario_file.as_deref()?;
        let results = self.results.values();
        let mut files = results.filter_map(|it| it.origin.scenario_file.as_deref());
        if let Some(other) = files.find(|other| *other != file) {
            return Some(shown(other));
        }
        // Results that the command would replace, and that got there by a choice of the folder.
        let last = &self.results.get(command)?.origin;
        let difference = own.difference(last)?;
        let chosen = || format!("another scenario, put there by --out or Python ({difference})");
        last.scenario_file.is_none().then(chosen)
    }

    /// Returns true if the results of another command contain this file.
    pub(super) fn is_of_other(&self, command: &str, file: &str) -> bool {
        let mut others = self.results.iter().filter(|(name, _)| *name != command);
        others.any(|(_, results)| results.files.iter().any(|name| name == file))
    }

    /// Sets the results of a command.
    pub(super) fn set(
        &mut self,
        command: &str,
        origin: &Origin,
        files: Vec<String>,
        complete: bool,
    ) {
        env!("CARGO_PKG_NAME").clone_into(&mut self.program);
        let results = CommandResults {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            complete,
            origin: origin.clone(),
            files,
        };
        self.results.insert(command.to_owned(), results);
    }

    /// Returns warnings about results of other commands that come from another scenario.
    pub fn warnings(&self, folder: &Path, command: &str, own: &Origin) -> Vec<String> {
        let others = self.results.iter().filter(|(name, _)| *name != command);
        let warning = |(name, other): (&String, &CommandResults)| {
            let difference = own.difference(&other.origin)?;
            Some(format!(
                "{} holds results of `archrock {}` from another scenario: {difference}. They stay; choose another folder to keep results apart",
                folder.display(),
                command_line(name)
            ))
        };
        others.filter_map(warning).collect()
    }
}

/// Returns the command, as in a command line, that writes the results with this name in the manifest.
pub(super) fn command_line(name: &str) -> &str {
    match name {
        "threshold_along" => "threshold --along",
        // The other commands write samples as a part of their own results.
        samples if samples.starts_with("uncertain") => "merge",
        name => name,
    }
}

impl Origin {
    /// Returns the origin of results that this scenario will have.
    pub fn of(scenario: &Scenario) -> Self {
        let inputs = scenario.input_paths();
        Self {
            records: scenario.record_checksums(),
            // A path that does not exist is no input, such as that of a scenario that was read from text.
            inputs: inputs.filter_map(|path| path.canonicalize().ok()).collect(),
            ..Self::of_tables(&scenario.to_json())
        }
    }

    /// Adds files that results must not replace.
    #[must_use]
    pub fn with_inputs(mut self, paths: &[PathBuf]) -> Self {
        let paths = paths.iter().filter_map(|path| path.canonicalize().ok());
        self.inputs.extend(paths);
        self
    }

    /// Sets name and checksum of each record file, separated by a space.
    #[must_use]
    pub fn with_records(self, records: Vec<String>) -> Self {
        Self { records, ..self }
    }

    /// Returns the origin of results of a scenario as JSON, without its records.
    pub(crate) fn of_tables(scenario: &Value) -> Self {
        let checksum =
            |table: &Value| format!("{:08x}", crc32fast::hash(table.to_string().as_bytes()));
        let tables = scenario.as_object().into_iter().flatten();
        Self {
            scenario: tables
                .map(|(name, table)| (name.clone(), checksum(table)))
                .collect(),
            ..Self::default()
        }
    }

    /// Adds the inputs of another scenario to those that results must not replace.
    pub(super) fn protect(&mut self, other: &Self) {
        self.inputs.extend_from_slice(&other.inputs);
    }

    /// Returns true if results at this path would replace an input file.
    pub(super) fn is_input(&self, path: &Path) -> bool {
        path.canonicalize()
            .is_ok_and(|path| self.inputs.contains(&path))
    }

    /// Returns the first difference from the scenario of other results, in words; `None` if they agree, or if one is unknown.
    fn difference(&self, other: &Self) -> Option<String> {
        let (own, others) = (&self.scenario, &other.scenario);
        if own.is_empty() || others.is_empty() {
            return None;
        }
        let tables = own.keys().chain(others.keys());
        let mut of_both = tables.filter(|table| {
            let mut models = scenario::MODELS.iter();
            let of_model = models.any(|one| one.table == table.as_str());
            let in_both = own.contains_key(*table) && others.contains_key(*table);
            // The title and the tables of studies may differ, and models of motion may have different tables.
            let of_some = *table == "title" || StudyTable::is_name(table);
            !of_some && (!of_model || in_both)
        });
        if let Some(table) = of_both.find(|table| own.get(*table) != others.get(*table)) {
            return Some(format!("[{table}] differs"));
        }
        let name = |record: &str| record.rsplit_once(' ').map(|(name, _)| name.to_owned());
        let mut changed = self.records.iter().filter(|record| {
            let mut others = other.records.iter();
            !other.records.contains(record) && others.any(|other| name(other) == name(record))
        });
        let changed = changed.next().and_then(|record| name(record))?;
        Some(format!("the contents of {changed} differ"))
    }
}
