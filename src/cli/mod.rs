//! The commands: from arguments to exit codes.
//!
//! Data goes to standard output, everything else to standard error. Exit codes: 0 done, 1 the run failed,
//! 2 bad usage or bad input, 130 interrupted by Ctrl-C.

mod capacity_spread_verify;
mod check;
mod examples;
mod execution;
mod figure;
mod film;
mod impact;
mod init;
mod interrupts;
mod limit;
mod models;
mod named_files;
mod parsers;
mod progress;
mod results;
mod run;
mod scenario_file;
mod studies;
mod study;
mod study_options;
mod threshold;

use std::fmt::Display;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use archrock::output::{OutputError, PrintError, pretty};
use archrock::scenario::{ScenarioErrors, shown_lines};
use archrock::studies::{CAPACITY, MAP, RUN, SPREAD, SUITE, THRESHOLD, THRESHOLD_ALONG, VERIFY};
use clap::error::{ContextKind, ContextValue};
use clap::{CommandFactory as _, Parser, Subcommand, ValueEnum};

use serde_json::Value;

/// Simulates masonry arches and free-standing columns that rock under ground motion.
#[derive(Parser)]
#[command(version, arg_required_else_help = true)]
struct Arguments {
    /// Print no progress and no details: only verdict, warnings that limit it, and the answer to quote.
    #[arg(long, global = true)]
    quiet: bool,
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Write a commented scenario to start from.
    #[command(after_help = examples::INIT)]
    Init(init::Arguments),
    /// Simulate the time history of a scenario: report.html to look at, pictures, tables as CSV, summary.json.
    #[command(after_help = examples::of_studies(&[RUN], examples::RUN))]
    Run(run::Arguments),
    /// Make a film of the moving structure: MP4 or WebM by ffmpeg, GIF or animated PNG.
    #[command(after_help = examples::FILM)]
    #[cfg_attr(not(feature = "print"), command(before_help = archrock_text::wrapped(&PrintError::NotBuilt.to_string()).join("\n")))]
    Film(film::Arguments),
    /// Print the incipient acceleration, the mechanism to either side and the equivalent block; of live loads the factor at collapse.
    #[command(after_help = examples::LIMIT)]
    Limit(limit::LimitArguments),
    /// Print the mechanisms after successive impacts, their restitution and impulses.
    #[command(after_help = examples::IMPACT)]
    Impact(impact::Arguments),
    /// Find the quasi-static capacity curve of the first mechanism and its equivalent oscillator.
    #[command(after_help = examples::of_studies(&[CAPACITY], examples::CAPACITY))]
    Capacity(capacity_spread_verify::CapacityArguments),
    /// Find how far a springing may move until the arch falls, and what push it bears on the way.
    #[command(after_help = examples::of_studies(&[SPREAD], examples::SPREAD))]
    Spread(capacity_spread_verify::SpreadArguments),
    /// Check the first mechanism by the Circolare 7/2019 (C8.7.1.2.1) against [demand] of the scenario: one page, JSON.
    #[command(after_help = examples::of_studies(&[VERIFY], examples::VERIFY))]
    Verify(capacity_spread_verify::CommonArguments),
    /// Map which pulses overturn the structure: one history per cell of [map] in the scenario.
    #[command(after_help = examples::of_studies(&[MAP], examples::MAP))]
    Map(studies::MapArguments),
    /// Run every record of a suite at every level and fit a fragility curve, or each record once, unscaled: see [suite] in the scenario.
    #[command(after_help = examples::of_studies(&[SUITE], examples::SUITE))]
    Suite(study_options::StudyArguments),
    /// Find the factors on the ground motion that overturn the structure, and the safe gaps between them; or the least factor for
    /// each value of a key.
    #[command(after_help = examples::of_studies(&[THRESHOLD, THRESHOLD_ALONG], examples::THRESHOLD))]
    Threshold(threshold::Arguments),
    /// Merge the parts of a study computed with --shard.
    #[command(after_help = examples::MERGE)]
    Merge(studies::MergeArguments),
    /// Check a scenario and print it with every default written out, or describe a record file.
    #[command(after_help = examples::CHECK)]
    Check(check::Arguments),
    /// Print a script that completes commands and options in a shell.
    #[command(after_help = examples::COMPLETIONS)]
    Completions {
        /// The shell.
        #[arg(value_enum)]
        shell: clap_complete::Shell,
    },
    /// Write the manual pages of all commands, for packages of the program.
    #[command(hide = true)]
    Manual {
        /// The folder.
        folder: PathBuf,
    },
}

/// Format of a printed result.
#[derive(Clone, Copy, Default, ValueEnum)]
enum Format {
    /// For people.
    #[default]
    Text,
    /// For programs, with full precision.
    Json,
}

/// Error of a command.
enum Failure {
    /// The input is wrong: exit code 2.
    Input(String),
    /// The work failed: exit code 1.
    Work(String),
    /// The reader of the output closed the pipe: no failure.
    ClosedPipe,
}

impl From<&str> for Failure {
    fn from(message: &str) -> Self {
        Self::Input(message.to_owned())
    }
}

impl From<String> for Failure {
    fn from(message: String) -> Self {
        Self::Input(message)
    }
}

impl From<ScenarioErrors> for Failure {
    fn from(errors: ScenarioErrors) -> Self {
        Self::Input(errors.to_string())
    }
}

impl From<OutputError> for Failure {
    fn from(error: OutputError) -> Self {
        let other = "choose another folder with --out";
        if let OutputError::Unpublished(cause, files) = error {
            return Self::from(*cause).map(|cause| format!("{cause}; {files}"));
        }
        Self::Input(match &error {
            error if error.is_closed_pipe() => return Self::ClosedPipe,
            OutputError::OfOtherScenario(..) => format!("{error}: {other}, or remove that one"),
            OutputError::Taken { .. }
            | OutputError::NoFile(_)
            | OutputError::IsLink(_)
            | OutputError::NoManifest(_) => {
                format!("{error}; move what is there, or {other}")
            }
            OutputError::Unusable { .. } | OutputError::InUse(_) | OutputError::IsInput(_) => {
                format!("{error}; {other}")
            }
            error => return Self::Work(error.to_string()),
        })
    }
}

impl Failure {
    /// Returns the failure with another message.
    fn map(self, message: impl FnOnce(String) -> String) -> Self {
        match self {
            Self::Input(own) => Self::Input(message(own)),
            Self::Work(own) => Self::Work(message(own)),
            Self::ClosedPipe => Self::ClosedPipe,
        }
    }
}

/// Returns the result. If the input is wrong, adds the message to `wrong` and returns `None`.
fn collect_input_error<T>(
    result: Result<T, Failure>,
    wrong: &mut Vec<String>,
) -> Result<Option<T>, Failure> {
    match result {
        Err(Failure::Input(message)) => {
            wrong.push(message);
            Ok(None)
        }
        result => result.map(Some),
    }
}

/// Returns an error if there is any message.
fn check_no_errors(wrong: &[String]) -> Result<(), Failure> {
    match wrong {
        [] => Ok(()),
        _ => Err(wrong.join("\n").into()),
    }
}

/// Runs the program.
pub fn main() -> ExitCode {
    let arguments = Arguments::try_parse().unwrap_or_else(|error| with_suggestion(error).exit());
    interrupts::receive_signals();
    progress::set_quiet(arguments.quiet);
    let result = match arguments.command {
        Command::Init(init) => init::init(&init),
        Command::Run(run) => run::run(&run),
        Command::Film(film) => film::film(&film),
        Command::Limit(limit) => limit::limit(&limit),
        Command::Impact(arguments) => impact::impact(&arguments),
        Command::Capacity(capacity) => capacity_spread_verify::capacity(&capacity),
        Command::Spread(spread) => capacity_spread_verify::spread(&spread),
        Command::Verify(verify) => capacity_spread_verify::verify(&verify),
        Command::Map(map) => studies::map(&map),
        Command::Suite(suite) => studies::suite(&suite),
        Command::Threshold(threshold) => threshold::threshold(&threshold),
        Command::Merge(merge) => studies::merge(&merge),
        Command::Check(check) => check::check(&check),
        Command::Completions { shell } => completions(shell),
        Command::Manual { folder } => manual(&folder),
    };
    let (code, message) = match result {
        Ok(()) | Err(Failure::ClosedPipe) => return ExitCode::SUCCESS,
        Err(Failure::Work(message)) => (1, message),
        Err(Failure::Input(message)) => (2, message),
    };
    progress::print_always(&format!("error: {message}"));
    ExitCode::from(code)
}

/// Commands and options of earlier versions, and their replacements.
const REPLACED: [(&str, &str); 4] = [
    (
        "chart",
        "was removed: `limit` and `impact` give these numbers for one arch, and python/examples/shapes_of_arches.py for many",
    ),
    (
        "spectrum",
        "was removed: use `threshold SCENARIO --along TABLE.KEY=FROM..TO:COUNT`",
    ),
    ("--no-spread", "is now called `--no-repeat`"),
    (
        "--no-impact",
        "is an option of `threshold SCENARIO --along TABLE.KEY=FROM..TO:COUNT`, such as --along ground.half_sine.duration_s=0.1..1:10",
    ),
];

/// Adds to the error the replacement of a former command or option, or the most similar command; two swapped letters count as one mistake.
fn with_suggestion(mut error: clap::Error) -> clap::Error {
    for kind in [ContextKind::InvalidSubcommand, ContextKind::InvalidArg] {
        let Some(ContextValue::String(given)) = error.get(kind) else {
            continue;
        };
        if let Some((name, successor)) = REPLACED.iter().find(|(name, _)| name == given) {
            let message = format!("`{name}` {successor}");
            return Arguments::command().error(error.kind(), message);
        }
    }
    if let Some(ContextValue::String(given)) = error.get(ContextKind::InvalidSubcommand) {
        let commands = Arguments::command();
        let names = commands.get_subcommands().map(clap::Command::get_name);
        let far = |name: &str| strsim::damerau_levenshtein(name, given);
        let nearest = names.min_by_key(|name| far(name)).map(str::to_owned);
        if let Some(name) = nearest.filter(|name| far(name) <= FAR) {
            let names = ContextValue::Strings(vec![name]);
            error.insert(ContextKind::SuggestedSubcommand, names);
        }
    }
    error
}

/// Largest number of typing mistakes in a command.
const FAR: usize = 2;

/// Prints warnings, such as those about unlikely values in a scenario or a record.
fn warn(warnings: &[impl Display]) {
    for warning in warnings {
        progress::print_status(&format!("warning: {warning}"));
    }
}

/// Prints the completions of a shell.
fn completions(shell: clap_complete::Shell) -> Result<(), Failure> {
    let mut script = Vec::new();
    let mut command = Arguments::command();
    clap_complete::generate(shell, &mut command, "archrock", &mut script);
    print(&String::from_utf8_lossy(&script))
}

/// The usage of a command with the values of its options, which manual pages would leave out.
fn usage(command: &clap::Command) -> String {
    let mut usage = command.get_bin_name().unwrap_or_default().to_owned();
    let shown = command.get_arguments().filter(|one| !one.is_hide_set());
    let (others, options): (Vec<_>, Vec<_>) = shown.partition(|one| one.is_positional());
    for option in options {
        let repeats = matches!(option.get_action(), clap::ArgAction::Append);
        let dots = if repeats { "..." } else { "" };
        usage += &match option.is_required_set() {
            true => format!(" {option}"),
            false => format!(" [{option}]{dots}"),
        };
    }
    others
        .iter()
        .fold(usage, |usage, other| usage + &format!(" {other}"))
}

/// Writes the manual pages of the program and of its commands into a folder.
fn manual(folder: &Path) -> Result<(), Failure> {
    let mut program = Arguments::command().disable_help_subcommand(true);
    program.build();
    let program = program.mut_subcommands(|command| {
        let usage = usage(&command);
        command.override_usage(usage)
    });
    let written =
        fs::create_dir_all(folder).and_then(|()| clap_mangen::generate_to(program, folder));
    written.map_err(|error| {
        let folder = folder.display();
        Failure::Work(format!("cannot write manual pages into {folder}: {error}"))
    })
}

/// Prints results: their summary as JSON, or in words.
fn show(summary: &Value, words: &str, format: Format) -> Result<(), Failure> {
    match format {
        Format::Json => print(&pretty(summary)),
        Format::Text => print(words),
    }
}

/// Prints summaries as JSON: one summary alone, several as an array.
fn print_all(summaries: impl IntoIterator<Item = Value>) -> Result<(), Failure> {
    let mut all: Vec<Value> = summaries.into_iter().collect();
    let only = (all.len() == 1).then(|| all.pop()).flatten();
    print(&pretty(&only.unwrap_or(Value::Array(all))))
}

/// Prints a result on standard output. Control characters in names are escaped, because a terminal would obey them.
fn print(text: &str) -> Result<(), Failure> {
    let text = shown_lines(text);
    let mut out = io::stdout().lock();
    let printed = out.write_all(text.as_bytes()).and_then(|()| out.flush());
    printed.map_err(|error| match error.kind() {
        io::ErrorKind::BrokenPipe => Failure::ClosedPipe,
        _ => Failure::Work(format!("cannot write to standard output: {error}")),
    })
}
