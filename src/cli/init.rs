//! The command `init`: writes a scenario to start from.

use std::fs::{self, File};
use std::io::{self, ErrorKind, Write as _};
use std::path::{Path, PathBuf};

use archrock::Scenario;
use archrock::output::OutputError;
use clap::ValueEnum;

use super::progress::print_status;
use super::scenario_file::is_stdin;
use super::{Failure, print};

#[derive(clap::Args)]
pub struct Arguments {
    /// The subject of the scenario.
    #[arg(value_enum, default_value_t)]
    kind: Kind,
    /// The file to write; `-` for standard output [default: <KIND>.toml].
    #[arg(value_name = "FILE")]
    file: Option<PathBuf>,
}

/// The subject of a scenario.
#[derive(Clone, Copy, Default, ValueEnum)]
enum Kind {
    /// An arch under a pulse.
    #[default]
    Arch,
    /// A free-standing column under a pulse.
    Column,
    /// An arch under a record.
    Record,
    /// A map of pulses.
    Map,
    /// A suite of records.
    Suite,
    /// An arch and the hazard of its site, to be checked.
    Verify,
}

/// Name of the file with the JSON schema of scenarios, for editors.
const SCHEMA: &str = "archrock.schema.json";
/// Name and contents of the record file that is written beside scenarios with a record.
const RECORD: (&str, &str) = ("record.csv", include_str!("init/record.csv"));

impl Kind {
    /// Returns name and text of the scenario, the command for it, and true if it has a record.
    const fn about(self) -> (&'static str, &'static str, &'static str, bool) {
        match self {
            Self::Arch => ("arch", include_str!("init/arch.toml"), "run", false),
            Self::Column => ("column", include_str!("init/column.toml"), "run", false),
            Self::Record => ("record", include_str!("init/record.toml"), "run", true),
            Self::Map => ("map", include_str!("init/map.toml"), "map", false),
            Self::Suite => ("suite", include_str!("init/suite.toml"), "suite", true),
            Self::Verify => ("verify", include_str!("init/verify.toml"), "verify", false),
        }
    }
}

pub fn init(arguments: &Arguments) -> Result<(), Failure> {
    let (name, text, command, has_record) = arguments.kind.about();
    let text = format!("#:schema ./{SCHEMA}\n{text}");
    let default = || PathBuf::from(name).with_extension("toml");
    let file = arguments.file.clone().unwrap_or_else(default);
    if is_stdin(&file) {
        return print(&text);
    }
    write_new(&file, &text)?;
    let mut written = file.display().to_string();
    let path = file.with_file_name(SCHEMA);
    let schema = format!("{:#}\n", Scenario::schema());
    fs::write(&path, schema).map_err(|error| cannot_write(&path, &error))?;
    written += &format!(" and {}", path.display());
    if has_record {
        let (name, record) = RECORD;
        let path = file.with_file_name(name);
        // Scenarios in the same folder may share the record.
        if !path.exists() {
            write_new(&path, record)?;
            written += &format!(" and {}", path.display());
        }
    }
    print_status(&format!(
        "{written} written. Next: archrock {command} {}",
        file.display()
    ));
    Ok(())
}

fn cannot_write(path: &Path, error: &io::Error) -> Failure {
    Failure::Input(format!("cannot write {}: {error}", path.display()))
}

/// Writes a new file; an existing file is an error.
fn write_new(path: &Path, text: &str) -> Result<(), Failure> {
    let cannot = |error: io::Error| match error.kind() {
        ErrorKind::AlreadyExists => Failure::Input(format!(
            "{} exists already: give another name for the scenario, as in `archrock init arch other.toml`",
            path.display()
        )),
        ErrorKind::NotFound => {
            let folder = path.parent().unwrap_or(path).to_owned();
            Failure::Input(OutputError::NoFolder(path.to_owned(), folder).to_string())
        }
        _ => cannot_write(path, &error),
    };
    let mut file = File::create_new(path).map_err(cannot)?;
    file.write_all(text.as_bytes()).map_err(cannot)
}
