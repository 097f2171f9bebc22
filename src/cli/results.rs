//! The results of a command, and their text and JSON on standard output.

use archrock::output::{Folder, PictureFormat};
use archrock::scenario::ModelKind;
use archrock::studies::{Comparison, ModelAnswer, Results, StudyKind, quoted_in_words};
use serde::Serialize;
use serde_json::{Map, Value, json};

use super::Failure;
use super::progress::is_quiet;

/// How much of a report is printed.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Detail {
    /// The answer with its conditions and warnings.
    Quiet,
    /// The answer, the main numbers, the next command and the page.
    Answer,
    /// All numbers.
    All,
}

/// The option to print all numbers.
#[derive(clap::Args, Clone, Copy, Default)]
pub struct DetailsOption {
    /// Print all numbers, as on the page and in the JSON.
    #[arg(long, conflicts_with = "quiet")]
    details: bool,
}

impl DetailsOption {
    /// Returns how much is printed, with `--quiet` taken into account.
    pub fn get(self) -> Detail {
        match is_quiet() {
            true => Detail::Quiet,
            false if self.details => Detail::All,
            false => Detail::Answer,
        }
    }
}

/// The results of a study of scenarios that differ only in their models of motion.
pub struct CommandResults {
    /// The results of each model, or of all models together.
    pub of_models: Vec<ModelResults>,
    /// The comparison of the models by their largest rotations.
    pub compared: Option<Results>,
}

/// The results of a model, or of all models together.
pub struct ModelResults {
    /// The model, or the first of several.
    pub model: &'static ModelKind,
    /// The results on the samples of each model that has `[uncertain]`.
    pub samples: Vec<SampleResults>,
    /// The comparison of the models by the largest rotations of their samples.
    pub compared: Option<Results>,
    /// The results on the scenario itself.
    pub own: Results,
    /// Their place; `None` without files.
    pub place: Option<Place>,
}

/// The results on the samples of a model.
pub struct SampleResults {
    pub model: &'static ModelKind,
    pub results: Results,
    pub place: Place,
}

/// The place of results.
pub struct Place {
    /// Their folder, and the names of their files, in words.
    pub files: String,
    /// Their page; without one, their folder.
    pub page: String,
    /// True if the details name the files.
    pub is_in_words: bool,
}

/// Heading of the report on the scenario without uncertainty, after that on its samples.
const NOMINAL_HEADING: &str = "the scenario with its given numbers:";

impl ModelResults {
    /// Returns the report on the samples, which has the probability of overturning, and then that on the scenario itself.
    fn words(&self, is_indented: bool, detail: Detail, again: Option<&str>) -> String {
        let has_numbers = detail != Detail::Quiet;
        // A table is complete.
        let detail = match detail {
            Detail::Answer if !is_indented => Detail::All,
            detail => detail,
        };
        let words = |results: &Results| match detail {
            Detail::Quiet | Detail::Answer if is_indented => {
                let answer = results.statement.answer(has_numbers);
                match again {
                    Some(again) => command_again(&answer, again),
                    None => answer,
                }
            }
            _ => results.words.clone(),
        };
        let place = |place: &Place| match detail {
            Detail::Quiet => None,
            Detail::Answer => Some(format!("{}; all numbers: --details", place.page)),
            Detail::All => Some(format!("results in {}", place.files)),
        };
        let indent = if is_indented { "  " } else { "" };
        let mut lines = Vec::new();
        for one in &self.samples {
            lines.extend((self.samples.len() > 1).then(|| one.model.label.to_owned()));
            lines.push(format!("  {}", words(&one.results)));
            lines.extend(place(&one.place).map(|place| format!("  {place}")));
        }
        if let Some(compared) = self.compared.as_ref().filter(|_| has_numbers) {
            lines.push(format!("  {}", compared.words));
        }
        lines.extend((!self.samples.is_empty()).then(|| NOMINAL_HEADING.to_owned()));
        lines.push(format!("{indent}{}", words(&self.own)));
        let next = self.own.statement.next.as_ref().zip(again);
        let next = next.filter(|_| detail == Detail::Answer);
        lines.extend(
            next.map(|(next, again)| {
                format!("{indent}next: archrock {}", command_again(next, again))
            }),
        );
        let own = self.place.as_ref();
        // The details of a run name its files.
        let own = own.filter(|place| detail != Detail::All || !place.is_in_words);
        lines.extend(own.and_then(place).map(|place| format!("{indent}{place}")));
        lines.join("\n")
    }

    /// Returns the JSON of all results. A run has that of its samples already.
    fn summary(&self, kind: StudyKind) -> Result<Value, Failure> {
        let samples = self.samples.iter().filter(|_| !kind.reports_samples);
        let samples = samples.map(|one| {
            let summary = one.results.summary.clone();
            match self.samples.len() {
                1 => ("uncertain".to_owned(), summary),
                _ => (one.model.option.to_owned(), json!({ "uncertain": summary })),
            }
        });
        let summary = Summary {
            own: &self.own.summary,
            samples: samples.collect(),
            peaks: self.compared.as_ref().map(|compared| &compared.summary),
        };
        serde_json::to_value(summary).map_err(|error| Failure::Work(error.to_string()))
    }
}

/// JSON of all results: of the scenario itself, of its samples, and of the comparison of models.
#[derive(Serialize)]
struct Summary<'f> {
    #[serde(flatten)]
    own: &'f Value,
    #[serde(flatten)]
    samples: Map<String, Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    peaks: Option<&'f Value>,
}

impl CommandResults {
    /// Makes the results of a study of one model without samples, with their folder in words.
    pub fn alone(model: &'static ModelKind, own: Results, place: Place) -> Self {
        let of_model = ModelResults {
            model,
            samples: Vec::new(),
            compared: None,
            own,
            place: Some(place),
        };
        Self {
            of_models: vec![of_model],
            compared: None,
        }
    }

    /// Returns the results in words, with the title of the scenario. `again` is the scenario file with its options, for the next command.
    pub fn words(
        &self,
        kind: StudyKind,
        title: Option<&str>,
        detail: Detail,
        again: Option<&str>,
    ) -> String {
        let title = title.filter(|_| kind.has_title);
        let mut text = title.map_or(String::new(), |title| format!("{title}\n"));
        let input = self.of_models.first().filter(|_| detail != Detail::Quiet);
        text.extend(input.map(|one| one.own.statement.input.as_str()));
        for one in &self.of_models {
            let label = (self.of_models.len() > 1).then_some(one.model.label);
            text.extend(label.map(|label| format!("{label}\n")));
            text += &format!("{}\n", one.words(kind.has_title, detail, again));
        }
        if let Some(compared) = self.compared.as_ref().filter(|_| detail != Detail::Quiet) {
            text += &format!("{}\n", compared.words);
        }
        text.extend(self.quote().map(|quote| format!("{quote}\n")));
        text
    }

    /// Returns the answer of several models that may be quoted.
    fn quote(&self) -> Option<String> {
        let several = self.of_models.iter().filter(|_| self.of_models.len() > 1);
        let answers = several.filter_map(|one| one.own.answer.clone());
        quoted_in_words(&answers.collect::<Vec<ModelAnswer>>())
    }

    /// Returns the results as JSON.
    pub fn summary(&self, kind: StudyKind) -> Result<Value, Failure> {
        if let [one] = &self.of_models[..] {
            return one.summary(kind);
        }
        let models = self.of_models.iter();
        let models = models.map(|one| Ok((one.model, one.summary(kind)?)));
        let models = models.collect::<Result<Vec<_>, Failure>>()?;
        let peaks = self.compared.as_ref().map(|peaks| peaks.summary.clone());
        let all = Comparison::new(models, self.quote(), peaks);
        serde_json::to_value(all).map_err(|error| Failure::Work(error.to_string()))
    }
}

/// Writes the scenario file with its options in place of `FILE` in a command, whose model of motion replaces that of the options.
fn command_again(command: &str, again: &str) -> String {
    const MODEL: &str = " --hinges ";
    let (before, after) = again.split_once(MODEL).unwrap_or((again, ""));
    let (_, after) = after.split_once(' ').unwrap_or_default();
    let without_model = [before, after].join(if after.is_empty() { "" } else { " " });
    let again = match command.contains(MODEL) {
        true => &without_model,
        false => again,
    };
    command.replace("FILE", again)
}

/// Returns the place of the results of a study in a folder. `has_page` is false if the user wants none.
pub fn describe(folder: &Folder, kind: StudyKind, results: &Results, has_page: bool) -> Place {
    let names = kind.files.iter().filter(|name| name.ends_with(".html"));
    let mut pages = names.filter(|_| has_page);
    let page = pages.find(|name| kind.streams_tables || results.names().contains(name));
    let page = page.map_or_else(|| folder.path().to_owned(), |page| folder.path().join(page));
    Place {
        files: in_words(folder, results),
        page: page.display().to_string(),
        is_in_words: kind.streams_tables,
    }
}

/// Returns the folder with its result files, in words.
fn in_words(folder: &Folder, results: &Results) -> String {
    let also = match folder.pictures {
        None | Some(PictureFormat::Svg) => "",
        Some(PictureFormat::Pdf) => ", pictures also as PDF",
        Some(PictureFormat::Png) => ", pictures also as PNG",
    };
    let (path, names) = (folder.path().display(), results.names().join(", "));
    format!("{path}: {names}{also}")
}
