//! The answer that may be quoted: one rule for runs, thresholds, suites and comparisons of models.
//!
//! The model with the fewest assumptions decides; other models only show how the answer depends on the model. It answers with the largest strength
//! up to which the structure certainly survives, over all computed stiffnesses and contacts of its joints, or with an outcome that is certain and
//! the same for all of them. Four links of an arch are quoted only if their thrust line was followed, and inside their model.

use crate::dynamics::MODEL_LIMIT;
use crate::scenario::{FOUR_LINKS, FREE_HINGES, ModelKind};

/// The answer of a model of motion.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelAnswer {
    model: &'static ModelKind,
    /// Name of the model in sentences.
    label: &'static str,
    /// The certain answer, in words; or the reason why there is none.
    answer: Result<String, String>,
}

impl ModelAnswer {
    /// Makes the answer of a model of motion. `excess_ratio` is the largest excess of the thrust line of four links over the thickness; `None` if it
    /// was not followed.
    pub fn new(
        model: &'static ModelKind,
        is_arch: bool,
        excess_ratio: Option<f64>,
        answer: Result<String, String>,
    ) -> Self {
        let outside = (model == &FOUR_LINKS && is_arch).then(|| outside_four_links(excess_ratio));
        Self {
            model,
            label: match model == &FOUR_LINKS && !is_arch {
                true => "one rigid block",
                false => model.label,
            },
            answer: answer.and_then(|answer| outside.flatten().map_or(Ok(answer), Err)),
        }
    }
}

/// Returns the reason why four links of an arch are outside their model; `None` if they are inside.
fn outside_four_links(excess_ratio: Option<f64>) -> Option<String> {
    let why = match excess_ratio {
        None => "their thrust line was not followed".to_owned(),
        Some(ratio) if ratio > MODEL_LIMIT => {
            format!("their thrust line leaves the arch by up to {ratio:.3} t")
        }
        Some(_) => return None,
    };
    Some(format!("{why}; compare with free hinges"))
}

/// Returns the answer that may be quoted, in words; `None` without models.
pub fn in_words(answers: &[ModelAnswer]) -> Option<String> {
    let best = answers.iter().max_by_key(|one| one.model.rank())?;
    let label = best.label;
    let more = match best.model {
        model if model == &FREE_HINGES => "; the stiffness of joints is not considered",
        model if model == &FOUR_LINKS && label == model.label => "; compare with free hinges",
        _ => "",
    };
    Some(match &best.answer {
        Ok(answer) => format!("to quote: {answer}, with {label}{more}"),
        Err(why) => format!("to quote: no answer with {label}: {why}"),
    })
}
