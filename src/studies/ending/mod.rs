//! The ending of a history, as studies record it, and whether it is [certain](crate::dynamics::repeatability).

pub(crate) mod columns;

use serde::{Deserialize, Serialize};
use thiserror::Error;

pub use self::columns::outcome_name;
pub use crate::dynamics::repeatability::Verdict;
use crate::dynamics::repeatability::{CheckedDirections, CheckedHistory, checked, checked_in};
use crate::dynamics::{Direction, Directions, MODEL_LIMIT, OutcomeCount};
use crate::mechanics::{LimitError, StabilityError};
use crate::scenario::ModelError;
use crate::{
    Case, EndCondition, FourLinkError, GroundMotion, Model, Outcome, Request, RowModelError,
    SimulationError,
};

/// The steps of a history.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Steps {
    /// Longest step, in seconds.
    pub longest_s: f64,
    /// Shortest step, in seconds, apart from steps that end at landings.
    pub shortest_s: f64,
}

/// The ending of a history, in numbers that studies compare. All numbers are finite.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
// A row of a part file from another build is refused, not read in part.
#[serde(deny_unknown_fields)]
pub struct Ending {
    /// Direction of the ground motion under which all numbers were computed: of two directions, the worse one.
    pub direction: Direction,
    /// The outcome.
    pub outcome: Outcome,
    /// The time of the outcome, in seconds.
    pub outcome_time_s: f64,
    /// Time, in seconds, from which the structure can no longer overturn, and no body exceeds its largest rotation. The history was stopped at this
    /// time, so later impacts and the time of rest are unknown. `None` if the history was computed to its end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub safe_from_s: Option<f64>,
    /// Number of impacts; of an overturned structure, those before overturning. `None` for elastic joints, which have no impacts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub impacts: Option<usize>,
    /// Largest error of the energy balance, over the energy barrier of a mechanism, or over weight times size of a row of blocks.
    pub energy_defect_ratio: f64,
    /// Largest rotation over that at the unstable equilibrium; `None` for a row of blocks.
    pub peak_over_critical: Option<f64>,
    /// Largest excess of the thrust line of four links up to the largest rotation, over the thickness; `None` for other models.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub thrust_excess_ratio: Option<f64>,
    /// Largest rotation of any body, in radians, for every model.
    pub peak_rotation_rad: f64,
    /// Largest friction coefficient that the history and its repetitions require without slip, up to the last large half cycle: see
    /// [`FrictionRecord`](crate::dynamics::FrictionRecord). `None` if joints slip or are elastic.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction_demand: Option<f64>,
    /// Time steps of the computation of a row of blocks; `None` for mechanisms, whose steps follow from a tolerance.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub steps: Option<Steps>,
    /// Count of the outcomes of the history and its repetitions; `None` if the history was not repeated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub count: Option<OutcomeCount>,
}

impl Ending {
    /// Reason why a case with [`Outcome::Incomplete`] does not count, and the remedy.
    pub const INCOMPLETE: &str = "incomplete: the run ends while the ground still moves, or with too much energy left for a verdict; \
                                  give a longer `duration_s` in [simulation]";

    /// Reason why a sample outside the model of four links has no verdict, and the remedy.
    pub const OUTSIDE_MODEL: &str = "outside the model of four links: the thrust line leaves the arch too far; compute it with free hinges";

    /// Time of the outcome, in seconds; `None` if it is unknown.
    pub fn known_time_s(&self) -> Option<f64> {
        self.safe_from_s.is_none().then_some(self.outcome_time_s)
    }

    /// Number of all impacts; `None` if it is unknown.
    pub fn known_impacts(&self) -> Option<usize> {
        self.impacts.filter(|_| self.safe_from_s.is_none())
    }

    /// Number of impacts at which all hinges close together; `None` for a row of blocks, whose hinges close one by one.
    pub fn impacts_of_all_hinges(&self) -> Option<usize> {
        self.impacts.filter(|_| self.steps.is_none())
    }

    /// Largest rotation of a row of blocks, in radians; `None` for mechanisms.
    pub fn peak_of_row_rad(&self) -> Option<f64> {
        self.steps.map(|_| self.peak_rotation_rad)
    }

    /// True if the thrust line leaves the structure so far that four links do not describe the history; false for other models.
    pub fn is_outside_model(&self) -> bool {
        self.thrust_excess_ratio
            .is_some_and(|ratio| ratio > MODEL_LIMIT)
    }

    /// True if the history itself overturned, even if the verdict is uncertain.
    pub const fn overturned_itself(&self) -> bool {
        matches!(self.outcome, Outcome::Overturned(_))
    }

    /// Largest rotation of any body, in radians; infinite if the history overturned.
    pub const fn peak_or_infinite_rad(&self) -> f64 {
        match self.overturned_itself() {
            true => f64::INFINITY,
            false => self.peak_rotation_rad,
        }
    }

    /// Verdict on overturning.
    pub fn verdict(&self) -> Verdict {
        Verdict::counted(self.outcome, self.count.as_ref())
    }

    /// Count of the outcomes if the verdict is uncertain; `None` otherwise.
    pub fn doubt(&self) -> Option<&OutcomeCount> {
        let count = self.count.as_ref();
        count.filter(|_| self.verdict() == Verdict::Uncertain)
    }

    /// Share of the history and its repetitions that overturn: 0 or 1 if the verdict is certain. `None` for an incomplete history.
    pub fn overturning_share(&self) -> Option<f64> {
        match (self.verdict(), &self.count) {
            (Verdict::Uncertain, Some(count)) => Some(count.overturns_in as f64 / count.of as f64),
            (Verdict::Incomplete, _) => None,
            (verdict, _) => Some(f64::from(verdict == Verdict::Overturns)),
        }
    }

    /// Simulates a structure, repeats the history if that may matter, and returns the ending.
    ///
    /// # Errors
    /// The reason why there is no history, or a number is not finite.
    pub fn of(
        model: &dyn Model,
        ground: &GroundMotion,
        request: &Request,
    ) -> Result<Self, NoHistory> {
        Self::of_all(model, &[(ground.clone(), *request)]).remove(0)
    }

    /// Simulates several cases and returns their endings in order. A case without a history, or with a number that is not finite, has the reason
    /// instead. A history of a row of blocks stops once it can no longer overturn and no block exceeds its largest rotation.
    pub fn of_all(model: &dyn Model, cases: &[Case]) -> Vec<Result<Self, NoHistory>> {
        let checked = checked(model, cases, EndCondition::Settled).into_iter();
        checked.map(Self::of_checked).collect()
    }

    /// Simulates several cases as [`Ending::of_all`], in these directions of their ground motion, and returns the worse ending of each. The ground
    /// motions of the cases are those of the [first direction](Directions::first); the second one is computed if the first survives or is uncertain.
    pub fn of_all_in(
        directions: Directions,
        model: &dyn Model,
        cases: &[Case],
    ) -> Vec<Result<Self, NoHistory>> {
        let checked = checked_in(directions, model, cases, EndCondition::Settled).into_iter();
        let worse = |CheckedDirections { own, mirrored }| {
            let own = Self {
                direction: directions.first(),
                ..Self::of_checked(own)?
            };
            own.or_worse(mirrored.map(Self::of_checked))
        };
        checked.map(worse).collect()
    }

    /// Worse ending of this one and that under the mirrored ground motion, if there is one: the worse verdict counts, of equal verdicts the
    /// larger peak. Its friction demand is the larger one of both.
    ///
    /// # Errors
    /// If the mirrored history failed, and this one survives: the case then has no verdict.
    pub fn or_worse(self, mirrored: Option<Result<Self, NoHistory>>) -> Result<Self, NoHistory> {
        let severity = |ending: &Self| (ending.verdict(), ending.peak_or_infinite_rad());
        match mirrored {
            Some(Ok(mirrored)) => {
                let demands = [self.friction_demand, mirrored.friction_demand];
                let worse = match severity(&mirrored) > severity(&self) {
                    true => Self {
                        direction: Direction::Mirrored,
                        ..mirrored
                    },
                    false => self,
                };
                Ok(Self {
                    friction_demand: demands.into_iter().flatten().reduce(f64::max),
                    ..worse
                })
            }
            Some(Err(reason)) if self.verdict() < Verdict::Uncertain => Err(reason.mirrored()),
            _ => Ok(self),
        }
    }

    /// Makes the ending of a history with its repetitions.
    ///
    /// # Errors
    /// The reason why there is no history, or a number is not finite.
    pub(super) fn of_checked(checked: CheckedHistory) -> Result<Self, NoHistory> {
        let summary = checked.own?;
        let CheckedHistory {
            count,
            friction_demand,
            ..
        } = checked;
        let ending = Self {
            direction: Direction::AsGiven,
            outcome: summary.outcome,
            outcome_time_s: summary.outcome_time_s,
            safe_from_s: summary.is_cut.then_some(summary.end_s),
            impacts: summary.known_impacts(),
            energy_defect_ratio: summary.energy_defect_ratio,
            peak_over_critical: summary.peak_over_critical(),
            thrust_excess_ratio: summary.thrust_excess_ratio(),
            peak_rotation_rad: summary.largest_rotation_rad(),
            friction_demand,
            steps: summary.row().map(|row| Steps {
                longest_s: row.longest_step_s,
                shortest_s: row.shortest_step_s,
            }),
            count,
        };
        let peak = ending.peak_over_critical.unwrap_or(0.0);
        let excess = ending.thrust_excess_ratio.unwrap_or(0.0);
        let friction = ending.friction_demand.unwrap_or(0.0);
        check_finite(&[ending.peak_rotation_rad, peak, excess, friction])?;
        check_finite(&[ending.outcome_time_s, ending.energy_defect_ratio])?;
        Ok(ending)
    }
}

/// Answers the valid cases and returns all in order. Invalid cases keep their errors.
pub(super) fn answer_valid_cases<C, A, E>(
    cases: impl IntoIterator<Item = Result<C, E>>,
    answer: impl FnOnce(&[C]) -> Vec<Result<A, E>>,
) -> Vec<Result<A, E>> {
    let mut known = Vec::new();
    let cases: Vec<Result<(), E>> = cases
        .into_iter()
        .map(|case| case.map(|case| known.push(case)))
        .collect();
    let mut answers = answer(&known).into_iter();
    let of = |case: Result<(), E>| case.and_then(|()| answers.next().expect("one for each"));
    cases.into_iter().map(of).collect()
}

/// Error for numbers that are not finite: they are a bug of the program.
pub(super) fn check_finite(values: &[f64]) -> Result<(), NoHistory> {
    let wrong = "a result is not a finite number: please report the scenario";
    let are_finite = values.iter().all(|value| value.is_finite());
    are_finite
        .then_some(())
        .ok_or_else(|| NoHistory::Failed(wrong.to_owned()))
}

/// Reasons why a case has no history.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Error)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum NoHistory {
    /// The structure cannot carry its own weight.
    #[error("it cannot stand")]
    CannotStand,
    /// The arch is too thick for four links.
    #[error("it is too thick for four links")]
    NotFourLinks,
    /// The ground accelerates downwards as fast as a free fall, which the model does not cover.
    #[error("{0}")]
    GroundFalls(String),
    /// The history could not be computed.
    #[error("{0}")]
    Failed(String),
}

impl NoHistory {
    /// Reason for a history under the mirrored ground motion.
    fn mirrored(self) -> Self {
        let reason = |why: String| format!("with the mirrored ground motion: {why}");
        match self {
            Self::GroundFalls(why) => Self::GroundFalls(reason(why)),
            Self::Failed(why) => Self::Failed(reason(why)),
            other => other,
        }
    }
}

impl From<SimulationError> for NoHistory {
    fn from(error: SimulationError) -> Self {
        let kind = match error {
            SimulationError::FreeFall(_) => Self::GroundFalls,
            _ => Self::Failed,
        };
        kind(error.to_string())
    }
}

impl From<ModelError> for NoHistory {
    fn from(error: ModelError) -> Self {
        match error {
            ModelError::FourLinks(FourLinkError::Limit(LimitError::CannotStand))
            | ModelError::FreeHinges(RowModelError::Stability(StabilityError::CannotStand(_))) => {
                Self::CannotStand
            }
            ModelError::FourLinks(FourLinkError::Limit(
                LimitError::OtherMechanism(_) | LimitError::NoPush,
            )) => Self::NotFourLinks,
            error => Self::Failed(error.to_string()),
        }
    }
}

/// Reasons why a sample has no answer.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum NoAnswer {
    /// The values of the sample give no structure that stands.
    Invalid(String),
    /// The history could not be computed.
    Failed(String),
    /// The history ended too early for a verdict.
    Incomplete,
    /// The history is outside the model of four links, so it may survive or overturn.
    OutsideModel,
}

impl From<NoHistory> for NoAnswer {
    fn from(reason: NoHistory) -> Self {
        let kind = match reason {
            NoHistory::CannotStand | NoHistory::NotFourLinks => Self::Invalid,
            NoHistory::GroundFalls(_) | NoHistory::Failed(_) => Self::Failed,
        };
        kind(reason.to_string())
    }
}

impl NoAnswer {
    /// Error of a sample whose structure has no model of motion. Without a restitution the structure is valid, but its answer unknown.
    pub(super) fn without_model(error: ModelError) -> Self {
        match error {
            ModelError::FourLinks(error @ FourLinkError::Wall(_)) => {
                Self::Failed(error.to_string())
            }
            error => Self::Invalid(error.to_string()),
        }
    }

    /// Name of the reason in tables.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Invalid(_) => "invalid",
            Self::Failed(_) => columns::FAILED,
            Self::Incomplete => Outcome::Incomplete.name(),
            Self::OutsideModel => columns::OUTSIDE_MODEL,
        }
    }

    /// Reason in words.
    pub fn reason(&self) -> &str {
        match self {
            Self::Invalid(reason) | Self::Failed(reason) => reason,
            Self::Incomplete => Ending::INCOMPLETE,
            Self::OutsideModel => Ending::OUTSIDE_MODEL,
        }
    }
}
