//! The scenario of a command: where it is read from, what changes it, and where its results go.

use std::collections::BTreeMap;
use std::env;
use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use archrock::output::Folder;
use archrock::scenario::{Assignment, Changes, Hinges, Scenario, Source, shown};
use archrock::studies::results::Results;

use super::Failure;
use super::study::say;

/// The scenario of a command.
#[derive(clap::Args)]
pub struct ScenarioFile {
    /// Scenario file (TOML); `-` for standard input.
    scenario: PathBuf,
    #[command(flatten)]
    set: SetOption,
}

/// What changes a scenario.
#[derive(clap::Args)]
pub struct SetOption {
    /// Replace a value of the scenario or add one, such as --set arch.thickness_ratio=0.12; can be repeated.
    #[arg(long, value_name = "TABLE.KEY=VALUE")]
    set: Vec<Assignment>,
    /// Leave out [uncertain]: compute the scenario alone.
    #[arg(long)]
    no_uncertain: bool,
}

impl ScenarioFile {
    /// Takes its text.
    pub fn open(&self) -> Result<Input<'_>, Failure> {
        self.set.open(&self.scenario)
    }
}

impl SetOption {
    /// What was given.
    pub fn assignments(&self) -> &[Assignment] {
        &self.set
    }

    /// Takes the text of a scenario file.
    pub fn open<'a>(&'a self, path: &'a Path) -> Result<Input<'a>, Failure> {
        let source = if is_stdin(path) {
            Source::of_reader(io::stdin().lock(), "<stdin>")?
        } else {
            Source::of_file(path)?
        };
        Ok(Input {
            path,
            source,
            set: &self.set,
            no_uncertain: self.no_uncertain,
        })
    }
}

/// Whether the records of a suite are meant.
#[derive(clap::Args, Clone, Copy)]
pub struct SuiteOption {
    /// For each record of [suite] as it is in its file, instead of [ground]; results in a folder each.
    #[arg(long)]
    suite: bool,
}

/// Scenarios that differ in their models of motion, and the record of the suite that shakes them, if one does.
pub type Shaken = (Option<String>, Vec<Scenario>);

impl SuiteOption {
    /// The scenarios, which differ in their models of motion, or the same once for each record of their suite, if that
    /// is asked for.
    pub fn choose(self, models: Vec<Scenario>) -> Result<Vec<Shaken>, Failure> {
        if !self.suite {
            return Ok(vec![(None, models)]);
        }
        let mut chosen: Vec<Shaken> = Vec::new();
        for model in &models {
            for (index, (file, scenario)) in model.by_record().into_iter().enumerate() {
                match chosen.get_mut(index) {
                    Some((_, scenarios)) => scenarios.push(scenario),
                    None => chosen.push((Some(file), vec![scenario])),
                }
            }
        }
        if chosen.is_empty() {
            let message = "--suite is for a scenario with a table [suite], which names records";
            return Err(Failure::Input(message.to_owned()));
        }
        Ok(chosen)
    }
}

/// Whether this stands for standard input.
pub fn is_stdin(path: &Path) -> bool {
    path == Path::new("-")
}

/// The text of a scenario, and what changes it.
pub struct Input<'a> {
    path: &'a Path,
    source: Source,
    set: &'a [Assignment],
    no_uncertain: bool,
}

impl Input<'_> {
    /// The scenario with the model of motion that is asked for; `None`: the one that it chooses.
    pub fn read(&self, hinges: Option<Hinges>) -> Result<Scenario, Failure> {
        let set = self.set;
        let scenario = Scenario::of(&self.source, &Changes { hinges, set })?;
        Ok(if self.no_uncertain {
            scenario.without_uncertain()
        } else {
            scenario
        })
    }

    /// The failure, prefixed with the name of the scenario file.
    pub fn about(&self, failure: Failure) -> Failure {
        match failure {
            Failure::Input(message) => Failure::Input(format!("{}: {message}", self.source.name())),
            other => other,
        }
    }

    /// Name of the folder for its results.
    pub fn stem(&self) -> &Path {
        if is_stdin(self.path) {
            return Path::new("stdin");
        }
        Path::new(self.path.file_stem().unwrap_or_default())
    }

    /// Where its results go: to `out`, or else to a folder that has its name. The latter is refused where it holds
    /// results of a scenario file elsewhere that has the same name.
    pub fn results(&self, out: Option<&Path>) -> Result<Destination, Failure> {
        if let Some(out) = out {
            return Ok(Destination::of(out));
        }
        let path = Path::new("results").join(self.stem());
        let origin = (!is_stdin(self.path)).then(|| origin(self.path));
        Destination::checked(path, origin)
    }
}

/// A hidden file that tells which scenario file the results beside it are of.
const ORIGIN: &str = ".scenario";

/// A scenario file by its path from the current folder, if it is below that, or else from the root.
fn origin(path: &Path) -> String {
    let own = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let here = env::current_dir().and_then(|here| here.canonicalize());
    let below = here.ok().and_then(|here| own.strip_prefix(here).ok());
    below.unwrap_or(&own).display().to_string()
}

/// Where results go.
#[derive(Clone)]
pub struct Destination {
    path: PathBuf,
    /// The scenario file that the folder has its name from.
    origin: Option<String>,
}

impl Destination {
    /// A folder that was asked for.
    pub fn of(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            origin: None,
        }
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// A folder in that one.
    pub fn within(&self, name: impl AsRef<Path>) -> Self {
        Self::of(&self.path.join(name))
    }

    /// Refuses two results in one place; each place has the name of what it is for.
    pub fn check_distinct<'d>(
        places: impl IntoIterator<Item = (&'d str, &'d Self)>,
    ) -> Result<(), Failure> {
        let mut first = BTreeMap::new();
        let mut wrong = Vec::new();
        for (name, Self { path, .. }) in places {
            if let Some(other) = first.insert(path, name) {
                wrong.push(format!(
                    "{other} and {name} would both have their results in {}: rename one, or run them one by one with --out",
                    path.display()
                ));
            }
        }
        if wrong.is_empty() {
            Ok(())
        } else {
            Err(Failure::Input(wrong.join("\n")))
        }
    }

    /// The folder in that one for what a record of the scenario's suite does.
    pub fn of_record(&self, record: &str) -> Result<Self, Failure> {
        let name = Path::new(record).file_name().unwrap_or_default();
        Self::checked(self.path.join(name), self.origin.clone())
    }

    /// The folder, unless it holds the results of another scenario file.
    fn checked(path: PathBuf, origin: Option<String>) -> Result<Self, Failure> {
        let told = path.join(ORIGIN);
        // Of a pipe nobody would ever read the end.
        if told.is_file()
            && let (Some(ours), Ok(theirs)) = (&origin, fs::read_to_string(told))
            && ours != theirs.trim_end()
        {
            return Err(Failure::Input(format!(
                "{} holds the results of {}: choose another folder with --out, or remove that one",
                path.display(),
                shown(theirs.trim_end())
            )));
        }
        Ok(Self { path, origin })
    }

    /// Writes results there, and says so.
    pub fn write(&self, results: &Results, quiet: bool) -> Result<(), Failure> {
        results.write(self.open(&results.names())?)?;
        if !quiet {
            say(&format!("results in {}", self.holds(results)));
        }
        Ok(())
    }

    /// The folder and the files of results in it.
    pub fn holds(&self, results: &Results) -> String {
        format!("{}: {}", self.path.display(), results.names().join(", "))
    }

    /// Opens the folder for files of these names, the seal last; a failure suggests `--out`.
    pub fn open(&self, names: &[&str]) -> Result<Folder, Failure> {
        let mut all = names.to_vec();
        if self.origin.is_some() {
            all.insert(0, ORIGIN);
        }
        let mut folder = Folder::open(&self.path, &all).map_err(|error| {
            Failure::Input(format!("{error}; choose another folder with --out"))
        })?;
        if let Some(origin) = &self.origin {
            writeln!(folder.file(ORIGIN), "{origin}")
                .map_err(|error| Failure::Work(format!("cannot write {ORIGIN}: {error}")))?;
        }
        Ok(folder)
    }
}
