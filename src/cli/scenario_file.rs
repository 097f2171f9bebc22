//! The scenario of a command: its file, the options that change it, and the folder of its results.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::{env, io};

use archrock::dynamics::Directions;
use archrock::output::{Folder, Origin, PictureFormat};
use archrock::scenario::{Assignment, ModelKind, ReadOptions, Scenario, Source};
use clap::builder::{PossibleValuesParser, TypedValueParser};

use super::progress::with_notice;
use super::{Failure, check_no_errors};

/// The scenario of a command.
#[derive(clap::Args)]
pub struct ScenarioFile {
    /// Scenario file (TOML); `-` for standard input.
    scenario: PathBuf,
    #[command(flatten)]
    set: SetOption,
}

/// The options that change a scenario.
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
    /// Reads the text of the scenario.
    pub fn open(&self) -> Result<Input<'_>, Failure> {
        self.set.open(&self.scenario)
    }
}

impl SetOption {
    /// Returns the assignments given with `--set`.
    pub fn assignments(&self) -> &[Assignment] {
        &self.set
    }

    /// Reads the text of a scenario file.
    pub fn open<'a>(&'a self, path: &'a Path) -> Result<Input<'a>, Failure> {
        let source = match is_stdin(path) {
            true => Source::of_reader(io::stdin().lock(), "<stdin>")?,
            false => Source::of_file(path)?,
        };
        Ok(Input {
            path,
            source,
            set: self.set.clone(),
            no_uncertain: self.no_uncertain,
            models: Vec::new(),
        })
    }
}

/// The option for the direction of the ground motion.
#[derive(clap::Args, Clone, Copy)]
pub struct DirectionOption {
    /// Direction of the horizontal ground motion, in place of `direction` in [simulation] [default: both].
    #[arg(long, value_name = "DIRECTION", value_parser = directions())]
    direction: Option<Directions>,
}

impl DirectionOption {
    /// Returns the direction as a value of the scenario.
    fn assignment(self) -> Option<Assignment> {
        let assignment = format!("simulation.direction={}", self.direction?.name());
        assignment.parse().ok()
    }
}

fn directions() -> impl TypedValueParser<Value = Directions> {
    let names = Directions::ALL.iter().map(|direction| direction.name());
    PossibleValuesParser::new(names).map(|name| {
        let mut all = Directions::ALL.iter().copied();
        let named = all.find(|direction| direction.name() == name);
        named.unwrap_or_default()
    })
}

/// The option to run the records of the suite.
#[derive(clap::Args, Clone, Copy)]
pub struct SuiteOption {
    /// Run once for each record of [suite], unscaled, instead of [ground]; results go to a folder each.
    #[arg(long)]
    suite: bool,
}

/// Scenarios that differ only in their model of motion.
pub struct ScenarioTask {
    /// The scenario file, with the record of the suite.
    pub name: String,
    pub scenarios: Vec<Scenario>,
    /// Subfolder for the results of a record; `None` without `--suite`.
    subfolder: Option<PathBuf>,
    /// The scenario file with the options that change its scenario, for another command; `None` if no command reads it so.
    pub again: Option<String>,
}

impl ScenarioTask {
    /// Makes the task of a scenario file.
    pub fn of(input: &Input<'_>, scenarios: Vec<Scenario>) -> Self {
        Self {
            name: input.path.display().to_string(),
            scenarios,
            subfolder: None,
            again: input.again(),
        }
    }

    /// Returns the folder for the results of the task.
    pub fn folder(&self, root: &Folder) -> Folder {
        let subfolder = self.subfolder.as_ref();
        subfolder.map_or_else(|| root.clone(), |name| root.within(name))
    }

    /// Returns the name of the task, and the path of the folder for its results.
    pub fn place(&self, root: &Destination) -> (String, PathBuf) {
        let path = [Some(&root.path), self.subfolder.as_ref()];
        (self.name.clone(), path.into_iter().flatten().collect())
    }
}

/// The tasks of a scenario file, and the folder around their results, if files are written.
pub struct FileTasks {
    /// Name of the scenario file, for errors.
    pub name: String,
    pub tasks: Vec<ScenarioTask>,
    pub origin: Origin,
    pub destination: Option<Destination>,
}

impl SuiteOption {
    /// Returns the tasks of a scenario file. With `--suite` there is one task for each record of the suite, with a folder of its own. All
    /// scenarios must pass `check`.
    pub fn tasks(
        self,
        input: &Input<'_>,
        models: Vec<Scenario>,
        check: impl Fn(&Scenario) -> Result<(), String>,
    ) -> Result<Vec<ScenarioTask>, Failure> {
        let file = input.path.display().to_string();
        let mut tasks: Vec<ScenarioTask> = Vec::new();
        let records = models.iter();
        let records = records.flat_map(|model| model.by_record().into_iter().enumerate());
        for (index, (record, scenario)) in records.filter(|_| self.suite) {
            if let Some(task) = tasks.get_mut(index) {
                task.scenarios.push(scenario);
            } else {
                tasks.push(ScenarioTask {
                    name: format!("{file}, {record}"),
                    scenarios: vec![scenario],
                    subfolder: Path::new(&record).file_name().map(PathBuf::from),
                    again: None,
                });
            }
        }
        if !self.suite {
            tasks.push(ScenarioTask::of(input, models));
        } else if tasks.is_empty() {
            let message = "--suite is for a scenario with a table [suite], which names records";
            return Err(input.input_error(message));
        }
        let mut scenarios = tasks.iter().flat_map(|task| &task.scenarios);
        let checked = scenarios.try_for_each(check);
        checked.map_err(|message| input.input_error(message))?;
        Ok(tasks)
    }
}

/// Returns true if this path means standard input.
pub fn is_stdin(path: &Path) -> bool {
    path == Path::new("-")
}

/// The text of a scenario, and the options that change it.
pub struct Input<'a> {
    path: &'a Path,
    source: Source,
    set: Vec<Assignment>,
    no_uncertain: bool,
    models: Vec<&'static ModelKind>,
}

impl Input<'_> {
    /// Returns the scenario with these models.
    pub fn choosing(self, models: Vec<&'static ModelKind>) -> Self {
        Self { models, ..self }
    }

    /// Returns the scenario in the directions of the option.
    pub fn in_direction(mut self, option: DirectionOption) -> Self {
        self.set.extend(option.assignment());
        self
    }

    /// Reads the scenario with this model of motion; `None` if the tables of the scenario choose the model.
    pub fn read(&self, model: Option<&'static ModelKind>) -> Result<Scenario, Failure> {
        self.read_for(model, false)
    }

    /// Reads the scenario for static analysis, which needs neither the records of the ground motion nor a model of motion.
    pub fn read_statics(&self) -> Result<Scenario, Failure> {
        self.read_for(None, true)
    }

    fn read_for(
        &self,
        model: Option<&'static ModelKind>,
        statics: bool,
    ) -> Result<Scenario, Failure> {
        let options = ReadOptions {
            model,
            set: &self.set,
            statics,
        };
        let name = self.source.name().to_owned();
        let waiting = format!("still reading {name}, and finding the equilibrium of its structure");
        let scenario = with_notice(waiting, || Scenario::of(&self.source, &options))?;
        Ok(match self.no_uncertain {
            true => scenario.without_uncertain(),
            false => scenario,
        })
    }

    /// Returns the scenario; moved springings are an error.
    pub fn without_moved_springings(&self, scenario: Scenario) -> Result<Scenario, Failure> {
        let built = scenario.check_as_built();
        built.map_err(|message| self.input_error(message))?;
        Ok(scenario)
    }

    /// Makes a failure with this reason, after the name of the scenario file.
    pub fn input_error(&self, reason: impl Into<String>) -> Failure {
        self.with_file_name(Failure::Input(reason.into()))
    }

    /// Adds the name of the scenario file before the message of a failure.
    pub fn with_file_name(&self, failure: Failure) -> Failure {
        match failure {
            Failure::Input(message) => Failure::Input(format!("{}: {message}", self.source.name())),
            other => other,
        }
    }

    /// Returns the task of scenarios that differ only in their models, with the folder for its results.
    pub fn task(&self, scenarios: Vec<Scenario>, destination: Option<Destination>) -> FileTasks {
        FileTasks {
            name: self.name(),
            origin: Origin::of(&scenarios[0]),
            tasks: vec![ScenarioTask::of(self, scenarios)],
            destination,
        }
    }

    /// Returns the scenario file with the options that change its scenario, as a shell reads them; `None` for standard input, and for several models.
    fn again(&self) -> Option<String> {
        let hinges = match &self.models[..] {
            [] => None,
            [one] => Some(format!("--hinges {}", one.option)),
            _ => return None,
        };
        let path = (!is_stdin(self.path)).then(|| quoted(&self.path.display().to_string()))?;
        let set = self
            .set
            .iter()
            .map(|one| format!("--set {}", quoted(one.given())));
        let more = self.no_uncertain.then(|| "--no-uncertain".to_owned());
        let words = [path].into_iter().chain(hinges).chain(set).chain(more);
        Some(words.collect::<Vec<_>>().join(" "))
    }

    /// Returns the name of the scenario file.
    pub fn name(&self) -> String {
        self.source.name().to_owned()
    }

    /// Returns the name of the folder for the results.
    pub fn stem(&self) -> &Path {
        if is_stdin(self.path) {
            return Path::new("stdin");
        }
        Path::new(self.path.file_stem().unwrap_or_default())
    }

    /// Returns the folder for results: `out`, or a folder named after the scenario file.
    pub fn results(&self, out: Option<&Path>) -> Destination {
        let scenario_file = (out.is_none() && !is_stdin(self.path)).then(|| origin(self.path));
        let default = || Path::new("results").join(self.stem());
        Destination {
            path: out.map_or_else(default, Path::to_owned),
            scenario_file,
        }
    }
}

/// Returns a word of a command as a shell reads it.
fn quoted(word: &str) -> String {
    let is_bare = |c: char| c.is_ascii_alphanumeric() || "_-./=:,+@%".contains(c);
    match !word.is_empty() && word.chars().all(is_bare) {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', r"'\''")),
    }
}

/// Returns the path of a scenario file: relative to the current folder if the file is below it, otherwise absolute.
fn origin(path: &Path) -> String {
    let own = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let here = env::current_dir().and_then(|here| here.canonicalize());
    let below = here.ok().and_then(|here| own.strip_prefix(here).ok());
    below.unwrap_or(&own).display().to_string()
}

/// The folder for results, before it is locked.
pub struct Destination {
    pub path: PathBuf,
    /// The scenario file after which the folder is named; `None` with `--out`.
    scenario_file: Option<String>,
}

impl Destination {
    /// Makes the destination of a folder given with `--out`.
    pub fn of(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            scenario_file: None,
        }
    }

    /// Locks the folder and everything below it for the results of a command, before anything is written. Prints warnings about results of other
    /// commands from another scenario. `pictures` is the format of pictures in addition to SVG. Several parts of a study may be computed in one folder at the same time.
    pub fn lock(
        &self,
        command: &str,
        mut origin: Origin,
        pictures: Option<PictureFormat>,
        is_part: bool,
    ) -> Result<Folder, Failure> {
        origin.scenario_file.clone_from(&self.scenario_file);
        let mut folder = Folder::lock(&self.path, command, origin, !is_part)?;
        folder.pictures = pictures;
        if !is_part {
            super::warn(&folder.warnings());
        }
        Ok(folder)
    }
}

/// Returns an error if two of these named tasks would write to the same folder.
pub fn check_distinct(tasks: impl Iterator<Item = (String, PathBuf)>) -> Result<(), Failure> {
    let mut first = BTreeMap::new();
    let mut wrong = Vec::new();
    for (name, path) in tasks {
        if let Some(other) = first.insert(path.clone(), name.clone()) {
            wrong.push(format!(
                "{other} and {name} would both have their results in {}: rename one, or run them one by one with --out",
                path.display()
            ));
        }
    }
    check_no_errors(&wrong)
}
