//! The answer that may be quoted: one rule for runs, thresholds, suites and comparisons of models.
//!
//! The model with the fewest assumptions decides; other models only show how the answer depends on the model. It answers with the largest strength
//! up to which the structure certainly survives, over all computed stiffnesses and contacts of its joints, or with an outcome that is certain and
//! the same for all of them. Four links of an arch are quoted only if their thrust line was followed, and inside their model; a single motion that they
//! survive only if its peak rotation is below 40 % of overturning.
//!
//! One rigid block names the restitution that it assumes.
//!
//! Rigid joints without a friction coefficient never slip. The answer then depends on the largest friction coefficient that its histories require,
//! over all motions up to the quoted one and all repetitions ([`FrictionCondition`]).

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::argument::plain;
use crate::dynamics::{Direction, Directions, MODEL_LIMIT};
use crate::scenario::{FOUR_LINKS, FREE_HINGES, ModelKind, Scenario, Structure};

/// Smallest and largest coefficient of friction of stone on stone. An answer has no condition up to the smallest one.
pub(super) const STONE_FRICTION: [f64; 2] = [0.5, 0.8];

/// Smallest and largest measured restitution of blocks over Housner's, both ratios of energies.
const MEASURED_RESTITUTION: [f64; 2] = [0.9, 1.05];

/// Height over width of the most squat blocks that do not bounce in experiments (Lipscombe and Pellegrino, Free rocking of prismatic blocks, Journal
/// of Engineering Mechanics 119, 1993).
const LEAST_SLENDERNESS: f64 = 3.0;

/// Friction coefficient above which joints of stone may slip under weaker motions, so that the answer is not on the safe side.
const SLIPS_ABOVE: f64 = 0.6;

/// Peak rotation, over that of overturning, from which the survival of an arch with four links is not quoted. Of the surviving cells inside the model in
/// `scenarios/recipes/map-for-print.toml` 6 of 620 overturn with free hinges below it, and 187 of 244 from there on.
pub(super) const QUOTED_PEAK: f64 = 0.4;

/// True for an arch without voussoirs, whose hinges may lie anywhere.
fn lacks_joints(structure: &Structure) -> bool {
    let arch = structure.circular_arch();
    arch.is_some_and(|arch| arch.voussoirs.is_none())
}

/// Returns the options of a command that computes an arch of four links with free hinges instead; `None` for other structures and models.
pub(super) fn free_hinges_instead(scenario: &Scenario) -> Option<&'static str> {
    let (structure, motion) = (&scenario.structure, &scenario.motion);
    let is_arch = motion.kind == &FOUR_LINKS && structure.has_horizontal_thrust();
    is_arch.then(|| match lacks_joints(structure) {
        true => "--hinges free --set arch.voussoirs=36",
        false => "--hinges free",
    })
}

/// The part of a scenario that words about its friction need.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct SlipWords {
    /// True for one rigid block, which slips on its base.
    is_block: bool,
    /// Options of a command that let joints slip, with a space before each; `None` if free hinges do not describe the structure.
    options: Option<String>,
}

impl SlipWords {
    /// Words for a scenario.
    pub(super) fn of(scenario: &Scenario) -> Self {
        let (structure, motion) = (&scenario.structure, &scenario.motion);
        let has_free_hinges = structure.wall_behind().is_none() && !lacks_joints(structure);
        let is_free = motion.kind == &FREE_HINGES && !motion.ignores_elastic_joints;
        let hinges = if is_free { "" } else { " --hinges free" };
        let options = format!("{hinges} --set free_hinges.friction_coefficient={SLIPS_ABOVE}");
        Self {
            is_block: motion.kind == &FOUR_LINKS && !structure.has_horizontal_thrust(),
            options: has_free_hinges.then_some(options),
        }
    }

    /// Condition of an answer whose histories require this coefficient. `study` is the command of the study with its options, without
    /// `archrock`. `None` if stone certainly has the coefficient, or without one: if joints slip or are elastic.
    pub(super) fn condition(&self, demand: Option<f64>, study: &str) -> Option<FrictionCondition> {
        let coefficient = demand.filter(|demand| *demand > STONE_FRICTION[0])?;
        let options = self.options.as_ref();
        Some(FrictionCondition {
            coefficient,
            surfaces: if self.is_block {
                "its base has"
            } else {
                "its joints have"
            },
            command: options.map(|options| format!("archrock {study}{options}")),
        })
    }
}

/// Friction on which an answer depends.
#[derive(Clone, Debug, PartialEq)]
pub struct FrictionCondition {
    /// Friction coefficient that the histories require.
    coefficient: f64,
    /// The surfaces that need it, with the verb.
    surfaces: &'static str,
    /// Command that computes the answer with slip; `None` if free hinges do not describe the structure.
    command: Option<String>,
}

impl FrictionCondition {
    /// Whether joints of stone may slip under weaker motions.
    fn may_slip(&self) -> bool {
        may_slip(self.coefficient)
    }

    /// Condition of an answer: `if its joints have a friction coefficient of 0.54`; `None` if joints may slip.
    fn clause(&self) -> Option<String> {
        let coefficient = format_friction(self.coefficient);
        let clause = format!(
            "if {} a friction coefficient of {coefficient}",
            self.surfaces
        );
        (!self.may_slip()).then_some(clause)
    }

    /// Condition in words; `need` is a verb with its subject.
    fn in_words(&self, need: &str) -> String {
        let condition = friction_in_words(self.coefficient, need);
        if !self.may_slip() {
            return condition;
        }
        let [low, high] = STONE_FRICTION;
        let command = self.command.as_ref();
        let command = command.map_or(String::new(), |command| format!("; run `{command}`"));
        format!("{condition}, and stone has {low} to {high}{command}")
    }
}

impl fmt::Display for FrictionCondition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.in_words(NEEDS))
    }
}

/// Verb for the friction that one history needs.
pub(super) const NEEDS: &str = "needs a friction coefficient of";

fn may_slip(coefficient: f64) -> bool {
    coefficient > SLIPS_ABOVE
}

/// Needed friction coefficient in words, and whether joints of stone may slip under weaker motions. `need` is a verb with its subject.
fn friction_in_words(coefficient: f64, need: &str) -> String {
    let need = match coefficient > MOST_FRICTION {
        true => need.trim_end_matches(" up to"),
        false => need,
    };
    let before = if may_slip(coefficient) {
        "joints may slip: "
    } else {
        ""
    };
    format!("{before}{need} {}", format_friction(coefficient))
}

/// Friction coefficient that a history needs, in words; `None` if stone certainly has it.
pub(super) fn condition_of(demand: Option<f64>) -> Option<String> {
    let demand = demand.filter(|demand| *demand > STONE_FRICTION[0])?;
    Some(friction_in_words(demand, NEEDS))
}

/// Coefficient of friction above which values are not printed. No stone has them; they occur at almost unloaded joints.
pub(super) const MOST_FRICTION: f64 = 10.0;

/// Needed coefficient of friction as text, rounded up: with less, joints slip.
fn format_friction(coefficient: f64) -> String {
    match coefficient > MOST_FRICTION {
        true => format!("more than {MOST_FRICTION}"),
        false => format!("{:.2}", libm::ceil(100.0 * coefficient - 1e-9) / 100.0),
    }
}

/// Friction on which the survivors of a study depend.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct SurvivorFriction {
    /// Largest friction coefficient that surviving histories inside their model and their repetitions require without slip; null if joints slip or are
    /// elastic, or if nothing survives.
    #[serde(default)]
    pub(super) friction_demand: Option<f64>,
    /// The condition on friction, in words; absent if all stone meets it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) friction_condition: Option<String>,
}

impl SurvivorFriction {
    /// Makes the condition of survivors, in words such as `surviving cells`, that require these coefficients. `study` is the command, as in
    /// [`SlipWords::condition`].
    pub(super) fn of(
        demands: impl IntoIterator<Item = Option<f64>>,
        scenario: &Scenario,
        (study, survivors): (&str, &str),
    ) -> Self {
        let friction_demand = demands.into_iter().flatten().reduce(f64::max);
        let condition = SlipWords::of(scenario).condition(friction_demand, study);
        Self {
            friction_demand,
            friction_condition: condition.map(|condition| {
                condition.in_words(&format!("{survivors} need a friction coefficient of up to"))
            }),
        }
    }
}

/// The answer of a model of motion.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelAnswer {
    model: &'static ModelKind,
    /// Name of the model in sentences.
    label: &'static str,
    /// The certain answer, in words; or the reason why there is none.
    answer: Result<String, String>,
    /// Friction on which the answer depends; `None` without condition.
    friction: Option<FrictionCondition>,
    /// The assumed restitution, in words; `None` unless the model is one rigid block.
    restitution: Option<String>,
    /// The certainty of a single history, and of its numbers, in words.
    certainty: Vec<String>,
}

/// Restitution that one rigid block assumes, in words that follow its name; `None` for other models.
pub(super) fn restitution_in_words(scenario: &Scenario) -> Option<String> {
    let structure = &scenario.structure;
    let column = structure
        .column()
        .filter(|_| scenario.motion.kind == &FOUR_LINKS)?;
    let law = scenario.motion.impact();
    let is_given = law.model.is_prescribed();
    let model = scenario.mechanisms().ok()?;
    let energies = model.restitution_from(model.first_side(), 1).unwrap_or(0.0);
    let factor = law.restitution_factor;
    let bounces = match column.height_m < LEAST_SLENDERNESS * column.width_m {
        true => "; blocks below 3 : 1 bounce (Lipscombe and Pellegrino 1993)",
        false => "",
    };
    Some(match column.wall() {
        Some(_) if is_given => format!("restitution {energies:.3} at the wall (energies, given)"),
        Some((wall, _)) => {
            let source = match (wall.rate_ratio, factor) {
                (Some(_), _) => "given".to_owned(),
                (None, 1.0) => "default of a full wall".to_owned(),
                (None, factor) => format!("energies {} of the default", plain(factor)),
            };
            let rates = energies.sqrt();
            format!("restitution {rates:.3} at the wall (rates, {source})")
        }
        None if is_given => format!("restitution {energies:.3} (given){bounces}"),
        None => {
            let [low, high] = MEASURED_RESTITUTION;
            let own = match factor {
                1.0 => "Housner's".to_owned(),
                factor => format!("{} of Housner's", plain(factor)),
            };
            let measured = format!("measured {low} to {high} times that");
            format!("restitution {energies:.3} ({own}, {measured}){bounces}")
        }
    })
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
            friction: None,
            restitution: None,
            certainty: Vec::new(),
        }
    }

    /// Answer with the restitution that it assumes, in words.
    pub fn with_restitution(self, restitution: Option<String>) -> Self {
        Self {
            restitution,
            ..self
        }
    }

    /// Answer of a scenario itself, which may not be quoted if its numbers are uncertain.
    pub(super) fn unless_uncertain(self, is_uncertain: bool) -> Self {
        match is_uncertain {
            false => self,
            true => Self {
                answer: Err("its numbers are uncertain; quote the answer of the samples".to_owned()),
                ..self
            },
        }
    }

    /// Answer of a single history that survives with this peak rotation over that of overturning. It is none for four links of an arch from
    /// 40 % on, because most of them overturn with free hinges.
    pub fn surviving_with(self, peak_over_critical: f64) -> Self {
        let is_arch = self.model == &FOUR_LINKS && self.label == self.model.label;
        let answer = match is_arch && peak_over_critical >= QUOTED_PEAK {
            true => self.answer.and_then(|_| {
                Err(format!(
                    "peak rotation {:.0} % of overturning, and with free hinges 187 of 244 such survivors from 40 % on overturn (below, 6 of 620); compare \
                     with free hinges",
                    100.0 * peak_over_critical
                ))
            }),
            false => self.answer,
        };
        Self { answer, ..self }
    }

    /// Answer with its certainty, in words.
    pub fn with_certainty(self, certainty: impl IntoIterator<Item = String>) -> Self {
        let certainty = certainty.into_iter().collect();
        Self { certainty, ..self }
    }

    /// Answer with the friction on which it depends.
    pub fn with_friction(self, friction: Option<FrictionCondition>) -> Self {
        Self { friction, ..self }
    }
}

/// Directions of the ground motion for which an answer holds, in words that follow the answer. `governing` is the direction of the worse
/// result, if both are computed.
pub(super) const fn directions_in_words(
    directions: Directions,
    governing: Direction,
) -> &'static str {
    match directions {
        Directions::Both if matches!(governing, Direction::Mirrored) => {
            " in both directions (the mirrored one governs)"
        }
        Directions::Both => " in both directions",
        Directions::AsGiven => " in the direction as given only",
        Directions::Mirrored => " in the mirrored direction only",
    }
}

/// Reason why four links of an arch are outside their model; `None` if they are inside.
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

/// Begin of a quote without an answer.
pub(super) const NO_ANSWER: &str = "no answer";

/// Separates an answer and its conditions. The words of a study have them in lines.
pub(super) const THOUGHT_END: &str = "; ";

/// Answer that may be quoted with its conditions, in words; `None` without models.
pub fn quote_answers(answers: &[ModelAnswer]) -> Option<String> {
    let best = answers.iter().max_by_key(|one| one.model.rank())?;
    let label = best.label;
    let answer = match &best.answer {
        Ok(answer) => answer,
        Err(why) => return Some(format!("{NO_ANSWER} with {label}: {why}")),
    };
    let restitution = best.restitution.iter().map(|words| format!(", {words}"));
    let restitution: String = restitution.collect();
    let more = match best.model {
        model if model == &FREE_HINGES => Some("the stiffness of joints is not considered"),
        model if model == &FOUR_LINKS && label == model.label => Some("compare with free hinges"),
        _ => None,
    };
    let friction = best.friction.as_ref();
    let slip = friction.filter(|friction| friction.may_slip());
    let conditions = [
        friction.and_then(FrictionCondition::clause),
        more.map(str::to_owned),
        slip.map(FrictionCondition::to_string),
    ];
    let answer = format!("{answer}, with {label}{restitution}");
    let certainty = best.certainty.iter().cloned();
    let parts = [answer].into_iter().chain(certainty);
    let parts: Vec<String> = parts.chain(conditions.into_iter().flatten()).collect();
    Some(parts.join(THOUGHT_END))
}
