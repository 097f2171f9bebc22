//! Earlier results that a command finds in its folder: those of its own last run, and those of other commands.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use super::catalogue::{self, StudyKind};
use super::part::{Shard, rows_in};
use super::{peaks, run};
use crate::output::print::PictureFormat;
use crate::scenario::{self, Hinges, Scenario};

/// Name of a hidden file in a folder of results. The file holds the name of the scenario file.
pub const ORIGIN: &str = ".scenario";

/// A command that writes a folder of results.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ResultsCommand {
    /// The name of the command.
    pub name: &'static str,
    /// All files that the command may write in one folder, the seal last. The first JSON file contains the scenario.
    pub files: &'static [&'static str],
    /// The study of the samples of `[uncertain]`. Its results are in a subfolder; `None` if the command has no such study.
    samples_study: Option<StudyKind>,
    /// The file whose presence shows that the results of several models of motion are in subfolders; `None` if the command has no such
    /// subfolders.
    models_marker: Option<&'static str>,
    /// True if the results of each record of the suite may be in a subfolder.
    has_record_folders: bool,
}

/// `archrock run`.
const RUN: ResultsCommand = ResultsCommand {
    samples_study: Some(catalogue::UNCERTAIN),
    models_marker: Some(run::OVERLAY),
    has_record_folders: true,
    ..ResultsCommand::of_study(catalogue::RUN)
};
/// `archrock threshold`.
const THRESHOLD: ResultsCommand = ResultsCommand {
    samples_study: Some(catalogue::UNCERTAIN_THRESHOLD),
    models_marker: Some("threshold.json"),
    has_record_folders: true,
    ..ResultsCommand::of_study(catalogue::THRESHOLD)
};
/// `archrock threshold --along`.
const ALONG: ResultsCommand =
    ResultsCommand::new("threshold --along", catalogue::THRESHOLD_ALONG.files);
const MAP: ResultsCommand = ResultsCommand {
    samples_study: Some(catalogue::UNCERTAIN_MAP),
    ..ResultsCommand::of_study(catalogue::MAP)
};
const SUITE: ResultsCommand = ResultsCommand {
    samples_study: Some(catalogue::UNCERTAIN_SUITE),
    models_marker: Some("models/peaks.json"),
    ..ResultsCommand::of_study(catalogue::SUITE)
};

/// The commands with results in subfolders, or with a name that is not the name of a study.
const SPECIAL: [ResultsCommand; 5] = [RUN, THRESHOLD, ALONG, MAP, SUITE];
const MERGE: &str = "merge";

/// Subfolder for the comparison of several models of motion.
const MODELS: &str = "models";

impl ResultsCommand {
    const fn new(name: &'static str, files: &'static [&'static str]) -> Self {
        Self {
            name,
            files,
            samples_study: None,
            models_marker: None,
            has_record_folders: false,
        }
    }

    const fn of_study(kind: StudyKind) -> Self {
        Self::new(kind.name, kind.files)
    }

    /// Returns the command `merge` for a study. It replaces the results of that study only; samples are merged separately.
    #[must_use]
    pub const fn merge(kind: StudyKind) -> Self {
        Self::new(MERGE, kind.files)
    }

    /// Returns the command that writes the results of a study into a folder chosen by the user. For a study of samples that is `merge`: other
    /// commands write samples into a subfolder.
    #[must_use]
    pub fn of(kind: StudyKind) -> Self {
        let has_samples = |command: &Self| command.samples_study == Some(kind);
        let mut special = SPECIAL.into_iter();
        match special.find(|command| command.files == kind.files || has_samples(command)) {
            Some(command) if has_samples(&command) => Self::merge(kind),
            command => command.unwrap_or(Self::of_study(kind)),
        }
    }

    /// Returns the command of each study.
    fn all() -> impl Iterator<Item = Self> {
        StudyKind::ALL.into_iter().map(Self::of)
    }

    /// Returns the command whose results end with this seal; `None` if no command writes it.
    #[must_use]
    pub fn of_seal(seal: &str) -> Option<Self> {
        Self::all().find(|command| command.files.last() == Some(&seal))
    }

    /// Returns the name of the file that contains the scenario.
    fn summary(&self) -> Option<&'static str> {
        let mut files = self.files.iter().copied();
        files.find(|file| file.ends_with(".json"))
    }

    /// Reads the scenario from the summary among files of results; `None` if there is none.
    #[must_use]
    pub fn origin_in(&self, files: &[(String, Vec<u8>)]) -> Option<Origin> {
        let mut files = files.iter();
        let (_, summary) = files.find(|(name, _)| Some(&**name) == self.summary())?;
        of_summary(&serde_json::from_slice(summary).ok()?)
    }

    /// Returns all paths that the last run of this command may have written in a folder, in the order of removal: the seal first. Rows of an
    /// interrupted study are not included.
    #[must_use]
    pub fn last_results(&self, folder: &Path) -> Vec<PathBuf> {
        let mut seal_first = self.paths_in_folder(folder, self.files).into_iter();
        let mut all: Vec<PathBuf> = seal_first.by_ref().take(1).collect();
        all.extend(self.paths_in_subfolders(folder));
        if self.has_record_folders {
            for record in self.record_folders(folder) {
                all.extend(self.paths_in_folder(&record, self.files));
                all.extend(self.paths_in_subfolders(&record));
                all.push(record.join(ORIGIN));
            }
        }
        all.extend(seal_first);
        all.extend(self.paths_in_folder(&folder.join(self.models(folder)), &peaks::FILES));
        all
    }

    /// Returns the name of the subfolder that compares several models of motion: `models`, or another name if that folder belongs to another
    /// command.
    #[must_use]
    pub fn models(&self, folder: &Path) -> String {
        let has_models = |command: &Self| {
            Hinges::ALL.iter().any(|hinges| {
                let below = folder.join(hinges.name());
                let samples = |kind: StudyKind| below.join(kind.name).is_dir();
                match command.name {
                    "run" => command.samples_study.is_some_and(samples),
                    _ => command.is_sealed(&below),
                }
            })
        };
        let others = [RUN, SUITE].into_iter().filter(|command| command != self);
        if others.into_iter().any(|other| has_models(&other)) {
            format!("{MODELS}_{}", self.name)
        } else {
            MODELS.to_owned()
        }
    }

    /// Returns warnings about results of other commands in a folder that come from another scenario.
    #[must_use]
    pub fn warnings(&self, folder: &Path, own: &Origin) -> Vec<String> {
        let others = Self::all().filter(|other| other.files != self.files && other.name != MERGE);
        let warning = |other: Self| {
            let mut places = other.result_folders(folder).into_iter();
            let difference = places.find_map(|place| own.difference(&other.origin(&place)?))?;
            Some(format!(
                "{} holds results of `archrock {}` from another scenario: {difference}. They stay; choose another folder to keep results apart",
                folder.display(),
                other.name
            ))
        };
        let mut all: Vec<String> = others.filter_map(warning).collect();
        if own.scenario.get("uncertain").is_none() {
            all.extend(self.interrupted(folder));
        }
        all
    }

    /// Returns a warning about rows of an interrupted study of samples. This run has no samples and does not remove the rows.
    fn interrupted(&self, folder: &Path) -> Option<String> {
        let kind = self.samples_study?;
        let part = Self::part(folder, kind);
        let rows = rows_in(&part).filter(|rows| *rows > 0)?;
        Some(format!(
            "{} has {rows} cases of samples from an interrupted run; they are not part of the results of this run",
            part.display()
        ))
    }

    /// Returns the path of the part file of a study of samples.
    fn part(folder: &Path, kind: StudyKind) -> PathBuf {
        folder
            .join(kind.name)
            .join(Shard::WHOLE.file_name(kind.name))
    }

    /// Returns true if a folder contains complete results of this command.
    fn is_sealed(&self, folder: &Path) -> bool {
        let seal = self.files.last();
        seal.is_some_and(|seal| folder.join(seal).is_file())
    }

    /// Returns a folder of results and its subfolders of several models.
    fn result_folders(&self, folder: &Path) -> Vec<PathBuf> {
        let mut places = vec![folder.to_owned()];
        if self.models_marker.is_some() {
            places.extend(Hinges::ALL.iter().map(|model| folder.join(model.name())));
        }
        places
    }

    /// Reads the scenario of complete results in a folder.
    fn origin(&self, folder: &Path) -> Option<Origin> {
        let summary = folder.join(self.summary()?);
        // Reading a pipe of that name would never end.
        if !self.is_sealed(folder) || !summary.is_file() {
            return None;
        }
        let summary: Value = serde_json::from_slice(&fs::read(summary).ok()?).ok()?;
        of_summary(&summary)
    }

    /// Returns the paths of files of one folder, the seal first, and of their pictures in other formats.
    fn paths_in_folder(&self, folder: &Path, files: &[&str]) -> Vec<PathBuf> {
        if !folder.is_dir() {
            return Vec::new();
        }
        let mut all: Vec<PathBuf> = files.iter().rev().map(|file| folder.join(file)).collect();
        let pictures = files.iter().filter_map(|file| file.strip_suffix(".svg"));
        for stem in pictures {
            let names = PictureFormat::OTHERS.map(|other| format!("{stem}.{}", other.name()));
            all.extend(names.map(|name| folder.join(name)));
        }
        all
    }

    /// Returns the paths of results in the subfolders of a results folder: samples, films and models.
    fn paths_in_subfolders(&self, folder: &Path) -> Vec<PathBuf> {
        let mut all = Vec::new();
        if let Some(kind) = self.samples_study {
            let samples = folder.join(kind.name);
            all.extend(self.paths_in_folder(&samples, kind.files));
            // A part file without rows may be removed.
            let part = Self::part(folder, kind);
            if rows_in(&part) == Some(0) {
                all.push(part);
            }
        }
        if self.name == RUN.name {
            let film = folder.join(run::FILM);
            // One path is enough: hidden files of a killed run are removed with the results beside them.
            all.extend(self.paths_in_folder(&film, &["frame-0001.svg"]));
            all.extend(run::pictures_in(&film));
        }
        if let Some(marker) = self.models_marker {
            for below in Hinges::ALL.iter().map(|hinges| folder.join(hinges.name())) {
                // A sealed subfolder without the marker is the result of another run, which used it with --out.
                let alone = self.is_sealed(&below) && !folder.join(marker).is_file();
                if below.is_dir() && !alone {
                    all.extend(self.paths_in_folder(&below, self.files));
                    let one = Self {
                        models_marker: None,
                        ..*self
                    };
                    all.extend(one.paths_in_subfolders(&below));
                }
            }
        }
        all
    }

    /// Returns the subfolders with results of one record each. They have the name of the record.
    fn record_folders(&self, folder: &Path) -> Vec<PathBuf> {
        let entries = fs::read_dir(folder).into_iter().flatten().flatten();
        let is_of_record = |path: &PathBuf| {
            let Some(name) = path.file_name().and_then(|name| name.to_str()) else {
                return false;
            };
            let shaken_by = |place: PathBuf| {
                let origin = self.origin(&place)?;
                let file = origin.scenario.pointer("/ground/record/file")?.as_str()?;
                Some(Path::new(file).file_name()? == name)
            };
            // Names of records have an extension.
            let mut places = self.result_folders(path).into_iter();
            name.contains('.') && places.any(|place| shaken_by(place) == Some(true))
        };
        let paths = entries.map(|entry| entry.path());
        paths.filter(is_of_record).collect()
    }
}

/// Returns the scenario of a summary, which may be a summary of several models.
fn of_summary(summary: &Value) -> Option<Origin> {
    let of_models = summary.pointer("/models/0");
    Origin::of_summary(of_models.unwrap_or(summary))
}

/// The scenario of results, with the checksums of its records.
#[derive(Clone, Debug, Default)]
pub struct Origin {
    scenario: Value,
    /// Name and checksum of each record file.
    records: Vec<String>,
}

/// Tables that may differ between results of several commands: the title, and tables of studies. Tables of models of motion are handled
/// separately.
const OF_SOME: [&str; 6] = ["title", "map", "suite", "demand", "verify", "uncertain"];

impl Origin {
    /// Returns the origin of results that this scenario will have.
    #[must_use]
    pub fn of(scenario: &Scenario) -> Self {
        Self {
            scenario: scenario.to_json(),
            records: scenario.record_checksums(),
        }
    }

    /// Reads the scenario in a summary of results; `None` if there is none.
    #[must_use]
    pub fn of_summary(summary: &Value) -> Option<Self> {
        let records = summary["record_checksums"].as_array();
        let records = records.into_iter().flatten().filter_map(Value::as_str);
        Some(Self {
            scenario: summary.get("scenario")?.clone(),
            records: records.map(str::to_owned).collect(),
        })
    }

    /// Returns the first difference from the scenario of other results, in words; `None` if they agree.
    fn difference(&self, other: &Self) -> Option<String> {
        let (own, others) = (self.scenario.as_object()?, other.scenario.as_object()?);
        let tables = own.keys().chain(others.keys());
        let of_both = tables.filter(|table| {
            let of_model = scenario::MODELS
                .iter()
                .any(|one| one.table == table.as_str());
            let in_both = own.contains_key(*table) && others.contains_key(*table);
            !OF_SOME.contains(&table.as_str()) && (!of_model || in_both)
        });
        let mut of_both = of_both.filter(|table| own.get(*table) != others.get(*table));
        if let Some(table) = of_both.next() {
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
