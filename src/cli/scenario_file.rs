//! The scenario of a command: its file, the options that change it, and the folder of its results.

use std::cell::OnceCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::{env, io};

use archrock::output::{Batch, Folder, Manifest, Origin, OutputError, PictureFormat};
use archrock::scenario::{Assignment, ModelKind, ReadOptions, Scenario, Source, shown};
use archrock::studies::{PEAKS_SUMMARY, Results, StudyKind};

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
            set: &self.set,
            no_uncertain: self.no_uncertain,
        })
    }
}

/// The option to run the records of the suite.
#[derive(clap::Args, Clone, Copy)]
pub struct SuiteOption {
    /// Run once for each record of [suite], unscaled, instead of [ground]; results go to a folder each.
    #[arg(long)]
    suite: bool,
}

/// Name of a task, scenarios that differ only in their model of motion, and the folder for their results, if there is one. The name is that of
/// the scenario file, with the record of the suite.
pub type ScenarioTask = (String, Vec<Scenario>, Option<Destination>);

impl SuiteOption {
    /// Returns the tasks of a scenario file, with the folder `root`. With `--suite` there is one task for each record of the suite, with a
    /// folder inside `root`. All scenarios must pass `check`.
    pub fn tasks(
        self,
        input: &Input<'_>,
        models: Vec<Scenario>,
        root: Option<&Destination>,
        check: impl Fn(&Scenario) -> Result<(), String>,
    ) -> Result<Vec<ScenarioTask>, Failure> {
        let file = input.path.display().to_string();
        let mut tasks: Vec<ScenarioTask> = Vec::new();
        let records = models.iter();
        let records = records.flat_map(|model| model.by_record().into_iter().enumerate());
        for (index, (record, scenario)) in records.filter(|_| self.suite) {
            if let Some((_, scenarios, _)) = tasks.get_mut(index) {
                scenarios.push(scenario);
            } else {
                let name = Path::new(&record).file_name().unwrap_or_default();
                let place = root.map(|root| root.within(name));
                tasks.push((format!("{file}, {record}"), vec![scenario], place));
            }
        }
        if !self.suite {
            tasks.push((file, models, root.cloned()));
        } else if tasks.is_empty() {
            let message = "--suite is for a scenario with a table [suite], which names records";
            return Err(input.input_error(message));
        }
        let mut scenarios = tasks.iter().flat_map(|(_, scenarios, _)| scenarios);
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
    set: &'a [Assignment],
    no_uncertain: bool,
}

impl Input<'_> {
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
            set: self.set,
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

    /// Returns an error for a scenario with moved springings.
    pub fn as_built(&self, scenario: Scenario) -> Result<Scenario, Failure> {
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

    /// Returns the name of the folder for the results.
    pub fn stem(&self) -> &Path {
        if is_stdin(self.path) {
            return Path::new("stdin");
        }
        Path::new(self.path.file_stem().unwrap_or_default())
    }

    /// Returns the folder for results: `out`, or a folder named after the scenario file. The latter is an error if it contains results of
    /// another scenario file with the same name.
    pub fn results(&self, out: Option<&Path>) -> Result<Destination, Failure> {
        if let Some(out) = out {
            return Ok(Destination::of(out));
        }
        let path = Path::new("results").join(self.stem());
        let scenario_file = (!is_stdin(self.path)).then(|| origin(self.path));
        if let Some(own) = &scenario_file {
            let manifest = Manifest::read(&path).map_err(suggest_other_folder)?;
            if let Some(other) = manifest.other_scenario_file(own) {
                let (path, other) = (path.display(), shown(other));
                let remedy = "choose another folder with --out, or remove that one";
                return Err(format!("{path} holds the results of {other}: {remedy}").into());
            }
        }
        let place = Destination::of(&path);
        Ok(Destination {
            scenario_file,
            ..place
        })
    }
}

/// Returns the path of a scenario file: relative to the current folder if the file is below it, otherwise absolute.
fn origin(path: &Path) -> String {
    let own = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let here = env::current_dir().and_then(|here| here.canonicalize());
    let below = here.ok().and_then(|here| own.strip_prefix(here).ok());
    below.unwrap_or(&own).display().to_string()
}

/// The folder for results.
#[derive(Clone, Default)]
pub struct Destination {
    path: PathBuf,
    /// The scenario file after which the folder is named; `None` with `--out`.
    scenario_file: Option<String>,
    /// Format of pictures in addition to SVG.
    pictures: Option<PictureFormat>,
    /// The results in the locked folder. Folders inside this one share the lock.
    locked: Rc<OnceCell<Batch>>,
}

impl Destination {
    /// Makes the destination of a folder given with `--out`.
    pub fn of(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            ..Self::default()
        }
    }

    /// Shares the lock of a destination with the same folder, if one is among these.
    pub fn with_lock_of<'d>(self, mut known: impl Iterator<Item = &'d Self>) -> Self {
        match known.find(|known| known.path == self.path) {
            Some(known) => Self {
                locked: Rc::clone(&known.locked),
                ..self
            },
            None => self,
        }
    }

    /// Returns true if the folders of two destinations share a lock.
    pub fn shares_lock(&self, other: &Self) -> bool {
        Rc::ptr_eq(&self.locked, &other.locked)
    }

    /// Locks the folder and everything below it for the results of a study, unless it is locked, before anything is written. Prints warnings
    /// about results of other commands from another scenario. Several parts of a study may be computed in one folder at the same time.
    pub fn lock(&self, kind: StudyKind, mut origin: Origin, is_part: bool) -> Result<(), Failure> {
        if self.locked.get().is_some() {
            return Ok(());
        }
        origin.scenario_file.clone_from(&self.scenario_file);
        let batch = Batch::lock(&self.path, kind.name, origin, !is_part);
        let batch = batch.map_err(suggest_other_folder)?;
        if !is_part {
            super::warn(&batch.warnings());
        }
        self.locked.get_or_init(|| batch);
        Ok(())
    }

    fn locked(&self) -> &Batch {
        self.locked.get().expect("the folder is locked")
    }

    /// Returns the folder inside this one for the comparison of several models: `models`, or another name if that folder belongs to another
    /// command.
    pub fn models_folder(&self, kind: StudyKind) -> Self {
        let models = self.within("models");
        match self
            .locked()
            .is_of_other_command(&models.path.join(PEAKS_SUMMARY))
        {
            true => self.within(format!("models_{}", kind.name)),
            false => models,
        }
    }

    /// Gives all results in the locked folder their names.
    pub fn publish(&self) -> Result<(), Failure> {
        Ok(self.locked().publish()?)
    }

    /// Deletes the results in this folder that are not published.
    pub fn abandon(&self) {
        self.locked().abandon(&self.path);
    }

    /// Returns an error if files with these names cannot be written to the folder.
    pub fn check_names(&self, names: &[&str]) -> Result<(), Failure> {
        let checked = self.locked().check(&self.path, names);
        Ok(checked.map_err(suggest_other_folder)?)
    }

    /// Returns the path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the folder for a model of motion: a subfolder if there are several models.
    pub fn of_model(&self, scenario: &Scenario, several: bool) -> Self {
        match several {
            true => self.within(scenario.motion.kind.option),
            false => self.clone(),
        }
    }

    /// Returns a folder inside this one.
    pub fn within(&self, name: impl AsRef<Path>) -> Self {
        Self {
            path: self.path.join(name),
            ..self.clone()
        }
    }

    /// Sets the format of pictures in addition to SVG.
    pub fn with_pictures(self, pictures: Option<PictureFormat>) -> Self {
        Self { pictures, ..self }
    }

    /// Returns an error if two tasks would write to the same folder.
    pub fn check_distinct(tasks: &[ScenarioTask]) -> Result<(), Failure> {
        let mut first = BTreeMap::new();
        let mut wrong = Vec::new();
        for (name, _, place) in tasks {
            let path = place.iter().map(|place| &place.path);
            for (path, other) in path.filter_map(|path| Some((path, first.insert(path, name)?))) {
                wrong.push(format!(
                    "{other} and {name} would both have their results in {}: rename one, or run them one by one with --out",
                    path.display()
                ));
            }
        }
        check_no_errors(&wrong)
    }

    /// Prepares results in the folder without publishing them. A history has already written its files.
    pub fn prepare(&self, results: &Results) -> Result<(), Failure> {
        if results.files.is_empty() {
            return Ok(());
        }
        Ok(results.write(self.open(&results.names())?)?)
    }

    /// Returns the folder and the names of its result files, in words.
    pub fn describe(&self, results: &Results) -> String {
        let also = self.pictures.filter(|format| *format != PictureFormat::Svg);
        let also = also.map_or("", |format| match format {
            PictureFormat::Pdf => ", pictures also as PDF",
            _ => ", pictures also as PNG",
        });
        let (path, names) = (self.path.display(), results.names().join(", "));
        format!("{path}: {names}{also}")
    }

    /// Opens the folder for files with these names, the seal last. The error suggests `--out`.
    pub fn open(&self, names: &[&str]) -> Result<Folder, String> {
        let folder = self.locked().folder(&self.path, names);
        Ok(folder
            .map_err(suggest_other_folder)?
            .with_pictures(self.pictures))
    }
}

/// Returns the error of a folder that cannot be used.
fn suggest_other_folder(error: OutputError) -> String {
    let remedy = match error {
        OutputError::Taken { .. } | OutputError::NoManifest { .. } => {
            "move what is there, or choose another folder with --out"
        }
        _ => "choose another folder with --out",
    };
    format!("{error}; {remedy}")
}
