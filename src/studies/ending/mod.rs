//! How a history ended, as studies keep it, and whether that is certain.
//!
//! Where a model can be computed in [other ways that are as good](Model::repetitions), a case is computed in these as well,
//! and where they do not agree on whether it overturns that is **uncertain**: neither overturned nor survived. To which side
//! it overturns, and whether what survives has come to rest, does not count.
//!
//! Most repetitions can be spared, because nothing that follows an impact decides: of what `is_plain`.

pub(crate) mod columns;

use std::ops::ControlFlow;

use serde::{Deserialize, Serialize};

use crate::dynamics::ground::GroundMotion;
use crate::dynamics::history::{Outcome, Sample, Summary};
use crate::dynamics::model::{Model, Recorder, Repetition, Request, SimulationError};

/// Whether a history overturns, as far as that is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// It does not, to the end of the simulation.
    Survives,
    /// That depends on how it is computed.
    Uncertain,
    /// It does.
    Overturns,
}

impl From<Outcome> for Verdict {
    fn from(outcome: Outcome) -> Self {
        match outcome {
            Outcome::Overturned(_) => Self::Overturns,
            Outcome::NeverMoved | Outcome::Rest | Outcome::StillRocking => Self::Survives,
        }
    }
}

impl Verdict {
    const fn words(self) -> &'static str {
        match self {
            Self::Survives => "survives",
            Self::Uncertain => "is uncertain",
            Self::Overturns => "overturns",
        }
    }
}

/// The steps of a history.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Steps {
    /// The longest, in seconds.
    pub longest_s: f64,
    /// The shortest, in seconds, but for steps that end at landings.
    pub shortest_s: f64,
}

/// How a history ended, in the numbers that studies compare. They are finite.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ending {
    /// How it ended.
    pub outcome: Outcome,
    /// When, in seconds.
    pub outcome_time_s: f64,
    /// Number of impacts; where the structure overturns, all are before.
    pub impacts: usize,
    /// Largest gap in the energy balance: of a mechanism over its energy barrier, of free hinges over weight times
    /// size.
    pub energy_defect_ratio: f64,
    /// How far it went.
    pub peak: PeakRotation,
    /// The steps that it was computed in; `None` of models whose steps follow from a tolerance.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub steps: Option<Steps>,
    /// Why it is uncertain whether it overturns: what it does, and what a repetition does instead. `None` where it is certain.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub uncertain: Option<String>,
}

/// The largest rotation, measured as the model can.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PeakRotation {
    /// Of one mechanism at a time, all of whose hinges close at once: over that at the unstable equilibrium, where
    /// that is known.
    OverCritical(Option<f64>),
    /// Of free hinges, which close one by one: that of any block, in radians.
    Rad(f64),
}

impl PeakRotation {
    fn of(summary: &Summary) -> Self {
        match summary.free_hinges {
            Some(_) => Self::Rad(summary.largest_rotation_rad()),
            None => Self::OverCritical(summary.peak_over_critical),
        }
    }

    /// Over that at the unstable equilibrium, where that is known.
    #[must_use]
    pub const fn over_critical(self) -> Option<f64> {
        match self {
            Self::OverCritical(ratio) => ratio,
            Self::Rad(_) => None,
        }
    }

    /// In radians, of free hinges.
    #[must_use]
    pub const fn rad(self) -> Option<f64> {
        match self {
            Self::OverCritical(_) => None,
            Self::Rad(rotation_rad) => Some(rotation_rad),
        }
    }
}

impl Ending {
    /// Number of impacts at which all hinges close at once; `None` of free hinges, which close one by one.
    #[must_use]
    pub const fn impacts_of_all_hinges(&self) -> Option<usize> {
        match self.peak {
            PeakRotation::OverCritical(_) => Some(self.impacts),
            PeakRotation::Rad(_) => None,
        }
    }

    /// Whether it overturns, as far as that is known.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        match self.uncertain {
            Some(_) => Verdict::Uncertain,
            None => self.outcome.into(),
        }
    }

    /// That of the mirror image.
    pub(super) fn mirrored(&self) -> Self {
        let outcome = match self.outcome {
            Outcome::Overturned(sway) => Outcome::Overturned(sway.opposite()),
            other => other,
        };
        Self {
            outcome,
            ..self.clone()
        }
    }

    /// Simulates a structure, and again in other ways where that may matter, and returns how that ended.
    ///
    /// # Errors
    /// Says why there is no history, or none that could be kept.
    pub fn of(model: &dyn Model, ground: &GroundMotion, request: &Request) -> Result<Self, String> {
        let summary = model
            .simulate(ground, request, None)
            .map_err(|error| error.to_string())?;
        let doubt = doubt(model, ground, request, &summary);
        Self::from_summary(&summary, doubt)
    }

    /// What a history came to, and why that is uncertain, if it is.
    ///
    /// # Errors
    /// Says that a number is not finite.
    pub(super) fn from_summary(
        summary: &Summary,
        uncertain: Option<String>,
    ) -> Result<Self, String> {
        let ending = Self {
            outcome: summary.outcome,
            outcome_time_s: summary.outcome_time_s,
            impacts: summary.impacts,
            energy_defect_ratio: summary.energy_defect_ratio,
            peak: PeakRotation::of(summary),
            steps: summary.free_hinges.as_ref().map(|run| Steps {
                longest_s: run.longest_step_s,
                shortest_s: run.shortest_step_s,
            }),
            uncertain,
        };
        check_finite(&[ending.outcome_time_s, ending.energy_defect_ratio])?;
        check_finite(ending.peak.over_critical().as_slice())?;
        check_finite(ending.peak.rad().as_slice())?;
        Ok(ending)
    }
}

/// What a repetition says against a history that ended like this; `None` where it agrees.
pub(super) fn objection(
    own: Outcome,
    name: &str,
    repeated: &Result<Summary, SimulationError>,
) -> Option<String> {
    let own = Verdict::from(own);
    match repeated {
        Ok(summary) => {
            let other = Verdict::from(summary.outcome);
            (other != own).then(|| format!("{}; {} with {name}", own.words(), other.words()))
        }
        Err(error) => Some(format!("{}; failed with {name}: {error}", own.words())),
    }
}

/// Why it is uncertain whether a history overturns, which is repeated where that may matter.
pub(super) fn doubt(
    model: &dyn Model,
    ground: &GroundMotion,
    request: &Request,
    own: &Summary,
) -> Option<String> {
    if is_plain(own) {
        return None;
    }
    let repetitions = model.repetitions();
    repetitions.iter().find_map(|Repetition { name, model }| {
        let mut until_safe = UntilSafe {
            quiet_s: ground.end_s(),
        };
        let repeated = model.simulate(ground, request, Some(&mut until_safe));
        objection(own.outcome, name, &repeated)
    })
}

/// What survives without ever reaching this part of the energy barrier of its first mechanism is not repeated.
const FAR_FROM_OVERTURNING: f64 = 0.5;

/// Whether repetitions can be spared: it never moved, it overturned before it changed side, up to which all ways agree, or it
/// survived far from overturning.
fn is_plain(own: &Summary) -> bool {
    match own.outcome {
        Outcome::NeverMoved => true,
        Outcome::Overturned(_) => own
            .free_hinges
            .as_ref()
            .is_some_and(|run| run.half_cycles.len() <= 1),
        Outcome::Rest | Outcome::StillRocking => own
            .peak_potential_over_barrier
            .is_some_and(|ratio| ratio < FAR_FROM_OVERTURNING),
    }
}

/// On ground that is quiet for good, what has less than this part of the energy barrier of its first mechanism cannot
/// overturn any more.
const SAFE: f64 = 0.1;

/// Ends a history that cannot overturn any more.
struct UntilSafe {
    /// From when on the ground is quiet.
    quiet_s: f64,
}

impl Recorder for UntilSafe {
    fn sample(&mut self, sample: &Sample) -> ControlFlow<()> {
        // What has slipped stands lower, and its energy says nothing.
        let slips = !sample.offsets_m.is_empty();
        let safe = sample.energy_ratio.is_some_and(|ratio| ratio < SAFE);
        if sample.time_s >= self.quiet_s && safe && !slips {
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    }
}

/// Refuses what is not finite, which is a defect of the program.
pub(super) fn check_finite(values: &[f64]) -> Result<(), String> {
    if values.iter().all(|value| value.is_finite()) {
        Ok(())
    } else {
        Err("a result is not a finite number: please report the scenario".to_owned())
    }
}
