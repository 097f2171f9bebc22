//! The option `--hinges`, which chooses models of motion.

use archrock::scenario::{MODELS, ModelKind, Scenario, Varied};
use clap::builder::{PossibleValuesParser, TypedValueParser as _};

use super::Failure;
use super::progress::print_status;
use super::scenario_file::Input;

/// Value of the option for both rigid models: four links and free hinges.
const BOTH: &str = "both";

fn parser() -> impl clap::builder::TypedValueParser<Value = Vec<&'static ModelKind>> {
    let names = MODELS.iter().map(|model| model.option);
    PossibleValuesParser::new(names.chain([BOTH])).map(|name| {
        let chosen = |model: &&ModelKind| match name.as_str() {
            BOTH => !model.has_stiffness,
            name => model.option == name,
        };
        MODELS.into_iter().filter(chosen).collect()
    })
}

/// The option of commands that compute several models of motion.
#[derive(clap::Args, Clone)]
pub struct ModelsOption {
    /// Models of motion. Several models write to one folder each, named after the model, with a comparison beside them [default:
    /// elastic or free if the scenario has [elastic_joints] or [free_hinges], else four].
    #[arg(long, value_name = "MODELS", value_delimiter = ',', value_parser = parser())]
    hinges: Vec<Vec<&'static ModelKind>>,
}

impl ModelsOption {
    /// Returns the chosen models, each once; empty without a choice.
    pub fn chosen(&self) -> Vec<&'static ModelKind> {
        let mut models: Vec<&ModelKind> = Vec::new();
        for model in self.hinges.iter().flatten() {
            if !models.contains(model) {
                models.push(model);
            }
        }
        models
    }

    /// Reads the scenario once for each chosen model; without a choice, once with the model of its tables.
    pub fn read(&self, input: &Input<'_>) -> Result<Vec<Scenario>, Failure> {
        let models = self.chosen();
        if models.is_empty() {
            return Ok(vec![input.read(None)?]);
        }
        let scenarios = models.into_iter().map(|model| input.read(Some(model)));
        let scenarios: Vec<Scenario> = scenarios.collect::<Result<_, _>>()?;
        Ok(with_known_restitution(scenarios))
    }

    /// Reads a scenario with one model; several models are an error.
    pub fn read_one(&self, input: &Input<'_>, command: &str) -> Result<Scenario, Failure> {
        let mut scenarios = self.read(input)?;
        if scenarios.len() > 1 {
            let message = format!("{command} takes one model; choose with --hinges");
            return Err(input.input_error(message));
        }
        Ok(scenarios.remove(0))
    }
}

/// Leaves out, with a warning, a model that needs a restitution of the wall behind the column. If all models need it, keeps them all: the study
/// reports the error.
fn with_known_restitution(scenarios: Vec<Scenario>) -> Vec<Scenario> {
    let missing = |scenario: &Scenario| scenario.check_restitution().err();
    if scenarios.iter().all(|scenario| missing(scenario).is_some()) {
        return scenarios;
    }
    let known = scenarios.into_iter().filter(|scenario| {
        let missing = missing(scenario);
        if let Some(why) = &missing {
            super::warn(&[format!("one rigid block is not computed: {why}")]);
        }
        missing.is_none()
    });
    known.collect()
}

/// Prints the warnings about unlikely numbers of these scenarios, each once, and about a table that a model ignores. `study` are options that are not part
/// of the scenarios.
pub fn warn_of<'s, I>(scenarios: I, study: &Varied<'_>)
where
    I: IntoIterator<Item = &'s Scenario> + Clone,
{
    super::warn(&Scenario::unlikely_of_all(scenarios.clone(), study));
    if let Some(ignored) = scenarios.into_iter().find_map(Scenario::ignored_table) {
        print_status(ignored);
    }
}
