//! The options of every study of many histories.

use std::path::PathBuf;

use archrock::scenario::Scenario;
use archrock::studies::{Options, StudyKind, Style};

use super::execution::Execution;
use super::figure::FigureOption;
use super::models::ModelsOption;
use super::results::DetailsOption;
use super::scenario_file::{DirectionOption, FileTasks, Input, ScenarioFile};
use super::study::WorkOptions;
use super::{Failure, Format};

/// Options of every study of many histories.
#[derive(clap::Args)]
pub struct StudyArguments {
    #[command(flatten)]
    pub scenario: ScenarioFile,
    /// Folder for the results [default: results/<name of the scenario file>].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub models: ModelsOption,
    #[command(flatten)]
    direction: DirectionOption,
    #[command(flatten)]
    pub figure: FigureOption,
    #[command(flatten)]
    pub work: WorkOptions,
    /// Write no page (HTML) for the browser.
    #[arg(long)]
    no_report: bool,
    /// Format of the printed summary; JSON goes to standard output.
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
    #[command(flatten)]
    details: DetailsOption,
}

impl StudyArguments {
    /// Reads the text of the scenario.
    pub fn open(&self) -> Result<Input<'_>, Failure> {
        let input = self.scenario.open()?.in_direction(self.direction);
        Ok(input.choosing(self.models.chosen()))
    }

    /// Returns the task of a scenario file, with the folder for its results.
    pub fn file(&self, input: &Input<'_>, scenarios: Vec<Scenario>) -> FileTasks {
        let destination = input.results(self.out.as_deref());
        input.task(scenarios, Some(destination))
    }

    /// Returns the options with which the command executes a study.
    pub fn execution(&self, kind: StudyKind, style: Style, mut options: Options) -> Execution {
        options.run.no_report = self.no_report;
        Execution {
            kind,
            style,
            options,
            work: self.work,
            pictures: self.figure.figure_format,
            format: self.format,
            detail: self.details.get(),
            has_words_apart: false,
        }
    }
}
