//! The scenario of a command: its file, the options that change it, and the folder of its results.

use std::collections::BTreeMap;
use std::env;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use archrock::output::print::PictureFormat;
use archrock::output::{Batch, Folder, OutputError};
use archrock::scenario::{Assignment, Changes, Hinges, Scenario, Source, shown};
use archrock::studies::results::Results;

use super::{Failure, refused};
use archrock::studies::kept::{ORIGIN, Origin, Writer};

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
    /// Reads its text.
    pub fn open(&self) -> Result<Input<'_>, Failure> {
        self.set.open(&self.scenario)
    }
}

impl SetOption {
    /// The assignments given with `--set`.
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

/// Scenarios that differ only in their model of motion, and the folder for their results, if any. The name is that of the record of the
/// suite that shakes them, or empty.
pub type Task = (String, Vec<Scenario>, Option<Destination>);

impl SuiteOption {
    /// The scenarios, which differ in their model of motion, with the folder `root`. With `--suite`, once for each record of the suite,
    /// shaken by it, with a folder inside `root`. All scenarios must pass the check.
    pub fn tasks(
        self,
        models: Vec<Scenario>,
        root: Option<&Destination>,
        check: impl Fn(&Scenario) -> Result<(), String>,
    ) -> Result<Vec<Task>, Failure> {
        let mut tasks: Vec<Task> = Vec::new();
        let records = models.iter();
        let records = records.flat_map(|model| model.by_record().into_iter().enumerate());
        for (index, (record, scenario)) in records.filter(|_| self.suite) {
            if let Some((_, scenarios, _)) = tasks.get_mut(index) {
                scenarios.push(scenario);
            } else {
                let place = root.map(|root| root.of_record(&record)).transpose()?;
                tasks.push((record, vec![scenario], place));
            }
        }
        if !self.suite {
            tasks.push((String::new(), models, root.cloned()));
        } else if tasks.is_empty() {
            let message = "--suite is for a scenario with a table [suite], which names records";
            return Err(message.into());
        }
        for (_, scenarios, _) in &tasks {
            check(&scenarios[0])?;
        }
        Ok(tasks)
    }
}

/// Whether this path stands for standard input.
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
    /// Reads the scenario with this model of motion; `None`: its tables choose the model.
    pub fn read(&self, hinges: Option<Hinges>) -> Result<Scenario, Failure> {
        self.read_for(hinges, false)
    }

    /// Scenario for static analysis: it needs neither the records of its ground motion nor a model of motion.
    pub fn read_statics(&self) -> Result<Scenario, Failure> {
        self.read_for(None, true)
    }

    fn read_for(&self, hinges: Option<Hinges>, statics: bool) -> Result<Scenario, Failure> {
        let changes = Changes {
            hinges,
            set: self.set,
            statics,
        };
        let scenario = Scenario::of(&self.source, &changes)?;
        Ok(match self.no_uncertain {
            true => scenario.without_uncertain(),
            false => scenario,
        })
    }

    /// Reads the scenario for computations on the undeformed structure; refuses moved springings.
    pub fn read_as_built(&self) -> Result<Scenario, Failure> {
        self.as_built(self.read(None)?)
    }

    /// Refuses a scenario whose springings have moved.
    pub fn as_built(&self, scenario: Scenario) -> Result<Scenario, Failure> {
        let built = scenario.check_as_built();
        built.map_err(|message| self.wrong(message))?;
        Ok(scenario)
    }

    /// A failure for this reason, with the name of the scenario file in front.
    pub fn wrong(&self, reason: impl Into<String>) -> Failure {
        self.about(Failure::Input(reason.into()))
    }

    /// The failure, with the name of the scenario file in front.
    pub fn about(&self, failure: Failure) -> Failure {
        match failure {
            Failure::Input(message) => Failure::Input(format!("{}: {message}", self.source.name())),
            other => other,
        }
    }

    /// Name of the folder for the results.
    pub fn stem(&self) -> &Path {
        if is_stdin(self.path) {
            return Path::new("stdin");
        }
        Path::new(self.path.file_stem().unwrap_or_default())
    }

    /// The folder for results: `out`, or else a folder named after the scenario file. That folder is refused if it holds
    /// results of another scenario file of the same name.
    pub fn results(&self, out: Option<&Path>) -> Result<Destination, Failure> {
        if let Some(out) = out {
            return Ok(Destination::of(out));
        }
        let path = Path::new("results").join(self.stem());
        let origin = (!is_stdin(self.path)).then(|| origin(self.path));
        Destination::checked(path, origin)
    }
}

/// The path of a scenario file, from the current folder if the file is below it, otherwise from the root.
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
    /// The scenario file that names the folder; `None` with `--out`.
    origin: Option<String>,
    /// The format of pictures beside SVG.
    pictures: Option<PictureFormat>,
    /// The command whose results go there, once the folder is locked.
    locked: Option<(Batch, Writer)>,
}

impl Destination {
    /// A folder that was given with `--out`.
    pub fn of(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            ..Self::default()
        }
    }

    /// Locks the folder and everything below it for a command, before anything is written. The results of its last run are removed when
    /// those of this run are published. Warns of results of other commands that come from another scenario.
    pub fn locked_for(mut self, writer: Writer, origin: &Origin) -> Result<Self, Failure> {
        let batch = Batch::lock(&self.path, true).map_err(elsewhere)?;
        batch.replace(writer.last_run(&self.path));
        super::warn(&writer.warnings(&self.path, origin));
        self.locked = Some((batch, writer));
        Ok(self)
    }

    /// Locks the folder for a part of a study: other parts may be computed in it at the same time.
    pub fn locked_for_a_part(mut self, writer: Writer) -> Result<Self, Failure> {
        let batch = Batch::lock(&self.path, false).map_err(elsewhere)?;
        self.locked = Some((batch, writer));
        Ok(self)
    }

    /// Destination in a folder that this command has already locked.
    pub fn locked_with(mut self, outer: &Self) -> Self {
        self.locked.clone_from(&outer.locked);
        self
    }

    /// The folder inside this one for the comparison of several models.
    pub fn of_models(&self) -> Self {
        let writer = self.locked.as_ref().map(|(_, writer)| *writer);
        self.within(writer.map_or_else(String::new, |writer| writer.models(&self.path)))
    }

    /// Gives all results their names.
    pub fn publish(&self) -> Result<(), Failure> {
        match &self.locked {
            Some((batch, _)) => Ok(batch.publish()?),
            None => Ok(()),
        }
    }

    /// Drops the results that are not published.
    pub fn abandon(&self) {
        if let Some((batch, _)) = &self.locked {
            batch.abandon();
        }
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The folder for a model of motion: one of its own inside this folder if there are several models.
    pub fn of_model(&self, scenario: &Scenario, several: bool) -> Self {
        match several {
            true => self.within(scenario.motion.hinges().name()),
            false => self.clone(),
        }
    }

    /// A folder inside this one.
    pub fn within(&self, name: impl AsRef<Path>) -> Self {
        Self {
            path: self.path.join(name),
            origin: None,
            ..self.clone()
        }
    }

    /// This folder, with every picture in this format too.
    pub fn with_pictures(self, pictures: Option<PictureFormat>) -> Self {
        Self { pictures, ..self }
    }

    /// Refuses two results in one place; each place comes with the name of its scenario.
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
        refused(&wrong)
    }

    /// The folder inside this one for the results of one record of the suite.
    pub fn of_record(&self, record: &str) -> Result<Self, Failure> {
        let name = Path::new(record).file_name().unwrap_or_default();
        let place = Self::checked(self.path.join(name), self.origin.clone())?;
        Ok(place.with_pictures(self.pictures).locked_with(self))
    }

    /// The folder, unless it holds the results of another scenario file.
    fn checked(path: PathBuf, origin: Option<String>) -> Result<Self, Failure> {
        let known = path.join(ORIGIN);
        // Reading a pipe of that name would never end.
        if known.is_file()
            && let (Some(ours), Ok(theirs)) = (&origin, fs::read_to_string(known))
            && ours != theirs.trim_end()
        {
            let (path, theirs) = (path.display(), shown(theirs.trim_end()));
            let remedy = "choose another folder with --out, or remove that one";
            return Err(format!("{path} holds the results of {theirs}: {remedy}").into());
        }
        let mut place = Self::of(&path);
        place.origin = origin;
        Ok(place)
    }

    /// Prepares results in the folder, which are not published yet.
    pub fn prepare(&self, results: &Results) -> Result<(), Failure> {
        Ok(results.write(self.open(&results.names())?)?)
    }

    /// The folder and the names of the result files in it.
    pub fn holds(&self, results: &Results) -> String {
        let also = self.pictures.filter(|format| *format != PictureFormat::Svg);
        let also = also.map_or("", |format| match format {
            PictureFormat::Pdf => ", pictures also as PDF",
            _ => ", pictures also as PNG",
        });
        let (path, names) = (self.path.display(), results.names().join(", "));
        format!("{path}: {names}{also}")
    }

    /// Opens the folder for files of these names, the seal last; a failure suggests `--out`.
    pub fn open(&self, names: &[&str]) -> Result<Folder, Failure> {
        let mut all = names.to_vec();
        if self.origin.is_some() {
            all.insert(0, ORIGIN);
        }
        let folder = match &self.locked {
            Some((batch, _)) => batch.folder(&self.path, &all),
            None => Folder::open(&self.path, &all),
        };
        let mut folder = folder.map_err(elsewhere)?;
        if let Some(origin) = &self.origin {
            folder.write(ORIGIN, format!("{origin}\n"))?;
        }
        Ok(folder.with_pictures(self.pictures))
    }
}

/// Error for a folder that cannot be used.
fn elsewhere(error: OutputError) -> Failure {
    Failure::Input(format!("{error}; choose another folder with --out"))
}
