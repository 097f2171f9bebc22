//! The summary of a run: `summary.json`.

use serde::Serialize;
use serde_json::Value;

use super::Scales;
use super::caveats::{first_peak_rad, friction_condition, warnings};
use super::comparison::{changed_outcome, without_verdict};
use super::feet::FeetApart;
use crate::dynamics::history::{ElasticSummary, RowSummary};
use crate::dynamics::repeatability::key;
use crate::dynamics::variation::VariationResult;
use crate::dynamics::{HalfCycle, Repeatability, ThrustRecord};
use crate::mechanics::Sides;
use crate::output::mechanisms::columns;
use crate::output::{Named, OutputError, summary_of};
use crate::scenario::{Ground, Scenario};
use crate::studies::quotable::{self, ModelAnswer};
use crate::{MechanismModel, Model, Outcome, Summary as History, Sway, Verdict};

/// A computed motion, with its repetitions and variations.
#[derive(Clone, Copy)]
pub struct ComputedRun<'a> {
    /// The scenario.
    pub scenario: &'a Scenario,
    /// The model of motion.
    pub model: &'a dyn Model,
    /// The history.
    pub history: &'a History,
    /// The comparison with its repetitions; `None` if the history was not repeated.
    pub repeated: Option<&'a Repeatability>,
    /// The histories with other stiffness and contact, and with rigid joints.
    pub varied: &'a [VariationResult],
}

impl<'a> ComputedRun<'a> {
    /// Returns the answer that may be quoted: a certain outcome that does not depend on the stiffness and contact of its joints.
    pub(super) fn answer(&self) -> ModelAnswer {
        let (scenario, history, varied) = (self.scenario, self.history, self.varied);
        let happens = match history.outcome {
            Outcome::Overturned(_) => "overturns under",
            _ => "survives",
        };
        let no_answer = match (self.verdict(), changed_outcome(history, varied)) {
            (Verdict::Incomplete, _) => Some("the run has no verdict".to_owned()),
            (Verdict::Uncertain, _) => Some("it is uncertain whether it overturns".to_owned()),
            _ if self.model.row().is_some() && self.repeated.is_none() => {
                Some("the run was not repeated".to_owned())
            }
            (_, Some(change)) => Some(format!(
                "THE OUTCOME DEPENDS ON JOINT STIFFNESS AND CONTACT: it {happens} this motion as given, and {change}"
            )),
            _ if !scenario.motion.kind.is_rigid && varied.is_empty() => {
                Some("the dependence of the outcome on joint stiffness is unknown".to_owned())
            }
            _ => without_verdict(varied),
        };
        let samples = "with the given numbers: quote the probability of [uncertain] as well";
        let samples = scenario.uncertain.as_ref().map(|_| samples.to_owned());
        let conditions: Vec<String> = [friction_condition(scenario, history), samples]
            .into_iter()
            .flatten()
            .collect();
        let condition = match &conditions[..] {
            [] => String::new(),
            conditions => format!(" ({})", conditions.join("; ")),
        };
        let answer = no_answer.map_or_else(|| Ok(format!("{happens} this motion{condition}")), Err);
        let (kind, is_arch) = (
            scenario.motion.kind,
            scenario.structure.has_horizontal_thrust(),
        );
        ModelAnswer::new(kind, is_arch, history.thrust_excess_ratio(), answer)
    }

    /// Returns the verdict; uncertain if the repetitions disagree.
    pub(super) fn verdict(&self) -> Verdict {
        let count = self.repeated.map(|repeated| &repeated.count);
        Verdict::counted(self.history.outcome, count)
    }
}

/// The summary of a run: `summary.json`. Largest rotations of the bodies have keys such as `peak_rotation_left_rad`, `peak_rotation_1_rad` for
/// the first block of a row, or `peak_rotation_rad` for a column.
#[derive(Clone, Debug, Serialize)]
pub struct Summary<'a> {
    /// The name of the program.
    pub program: &'static str,
    /// Version of the program.
    pub version: &'static str,
    /// The scenario with all defaults.
    pub scenario: Value,
    /// Checksums of the records.
    pub record_checksums: Vec<String>,
    /// Verdict on overturning; uncertain if the repetitions disagree.
    pub verdict: Verdict,
    /// Warnings about unlikely numbers of the scenario, and about limits of its history.
    pub warnings: Vec<String>,
    /// Outcome of the motion.
    #[serde(flatten)]
    pub outcome: OutcomeSummary,
    /// Number of impacts; null with elastic joints, whose contact is continuous.
    pub impacts: Option<usize>,
    /// Largest rotations of the bodies, in radians.
    #[serde(flatten)]
    pub peak_rotations_rad: Named<f64>,
    /// Largest rotation of any body, in radians.
    pub largest_peak_rotation_rad: f64,
    /// The push that starts the structure to each side, in units of gravity; null if no push starts it.
    pub incipient_acceleration_g: Sides<Option<f64>>,
    /// Largest error of the energy balance. Reference of four links and columns: the barrier of the first mechanism. Reference of a row of
    /// blocks: weight times size (the mean radius of an arch, or half the diagonal of a column). With friction, the largest energy created.
    pub energy_defect_ratio: f64,
    /// The friction that prevents sliding.
    #[serde(flatten)]
    pub friction: Option<FrictionDemand>,
    /// Number of steps.
    pub steps: u64,
    /// Results of four links and columns.
    #[serde(flatten)]
    pub mechanisms: Option<MechanismResults>,
    /// Results of rows of blocks.
    #[serde(flatten)]
    pub row: Option<RowResults<'a>>,
    /// The comparison with its repetitions; absent if the history was not repeated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub repeatability: Option<RepeatabilitySummary<'a>>,
    /// The ends of the histories with other stiffness and contact, and with rigid joints.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub variations: Vec<VariationSummary<'a>>,
    /// Largest displacements of the points that were chosen with `--point`, relative to the ground.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub points: Vec<PointPeaks>,
    /// The answer that may be quoted, in words; absent from the summary of one of several models, which have one answer together.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub to_quote: Option<String>,
    /// Summary of the samples of `[uncertain]`, as their `uncertain.json`; absent without samples.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub uncertain: Option<Value>,
    /// Computing time of the longest step, in microseconds. It is the only number that differs between computations.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub longest_step_us: Option<f64>,
}

/// Outcome of a motion.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct OutcomeSummary {
    /// `never_moved`, `vibrates`, `rest`, `overturned`, `still_rocking` or `incomplete`.
    pub outcome: &'static str,
    /// Time of the outcome, in seconds. For an overturned structure it is the last time at which the structure could still return.
    pub outcome_time_s: f64,
    /// The side to which the structure overturned; null if it did not.
    pub overturning_sway: Option<Sway>,
}

/// The friction that prevents sliding.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct FrictionDemand {
    /// Largest coefficient of friction that a motion without sliding needs, over all steps outside impacts. Joints that carry less than a
    /// hundredth of the weight do not count.
    pub largest_friction_demand: f64,
    /// Time of the largest friction demand, in seconds.
    pub largest_friction_demand_time_s: f64,
    /// Coefficient of friction that a motion without sliding needs for more than a hundredth of the time in motion; null for mechanisms, whose
    /// largest demand does not depend on the steps.
    pub lasting_friction_demand: Option<f64>,
}

impl FrictionDemand {
    /// Returns the friction coefficient that prevents sliding, except for short peaks of rows.
    pub(super) fn required(&self) -> f64 {
        self.lasting_friction_demand
            .unwrap_or(self.largest_friction_demand)
    }
}

/// Results of four links or of a column.
#[derive(Clone, Debug, Serialize)]
pub struct MechanismResults {
    /// Largest rotation over that at the unstable equilibrium of the mechanism that moved. From 1 on, gravity alone overturns the structure.
    pub peak_rotation_over_critical: Option<f64>,
    /// Largest excess of the thrust line of four links up to the largest rotation, or up to overturning, over the thickness; null for a column.
    pub thrust_excess_ratio: Option<f64>,
    /// Dimensionless numbers; absent without an unstable equilibrium.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dimensionless: Option<Dimensionless>,
    /// The thrust line.
    #[serde(flatten)]
    pub thrust: Option<Thrust>,
    /// Evaluations of the equation of motion.
    pub evaluations: u64,
}

/// Dimensionless numbers of a history.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Dimensionless {
    /// Frequency parameter of the structure, in rad/s.
    pub p_rad_s: f64,
    /// Frequency parameter times the duration of the pulse; null for records.
    pub p_t_p: Option<f64>,
    /// Largest acceleration of the ground over `g A_L` of the side to which the ground pushes.
    pub peak_acceleration_over_incipient: f64,
}

/// The thrust line of four links, or of a column, at the output samples.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Thrust {
    /// Largest excess of the thrust line, over the thickness.
    pub largest_thrust_excess_ratio: f64,
    /// Time of the largest excess, in seconds.
    pub largest_thrust_excess_time_s: f64,
    /// Share of the time in motion in which the excess is at most 0.01; null if the structure never moved.
    pub rocking_share_thrust_excess_below_0_01: Option<f64>,
    /// Share of the time in motion in which the excess is at most 0.05; null if the structure never moved.
    pub rocking_share_thrust_excess_below_0_05: Option<f64>,
}

/// Results of a row of blocks.
#[derive(Clone, Debug, Serialize)]
pub struct RowResults<'a> {
    /// Half cycles whose peak is at least a thousandth of the largest rotation.
    pub half_cycles: Vec<HalfCycle>,
    /// Results of elastic joints.
    #[serde(flatten)]
    pub elastic: Option<&'a ElasticSummary>,
    /// Results of all rows.
    #[serde(flatten)]
    pub row: &'a RowSummary,
    /// Displacement between the feet; absent if both feet move together.
    #[serde(flatten)]
    pub feet: Option<FeetApart>,
    /// Coefficient of friction; absent if joints cannot slip.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub friction_coefficient: Option<f64>,
    /// Number of systems of equations that were solved.
    pub iterations: u64,
}

/// The comparison of a motion with its repetitions.
#[derive(Clone, Debug, Serialize)]
pub struct RepeatabilitySummary<'a> {
    /// Outcomes of the run itself (`own`) and of its repetitions, by name.
    pub outcomes: Named<&'static str>,
    /// The sides to which the structure overturned, by name.
    pub overturning_sways: Named<Option<Sway>>,
    /// The results.
    #[serde(flatten)]
    pub repeatability: &'a Repeatability,
}

/// The end of a history with other properties.
#[derive(Clone, Debug, Serialize)]
pub struct VariationSummary<'a> {
    /// The changed property.
    pub with: &'a str,
    /// The end of the history.
    #[serde(flatten)]
    pub end: VariationOutcome<'a>,
}

/// The end of a history with other properties, or the reason why there is none.
#[derive(Clone, Copy, Debug, Serialize)]
#[serde(untagged)]
pub enum VariationOutcome<'a> {
    /// The history was computed.
    Computed {
        /// The outcome.
        #[serde(flatten)]
        outcome: OutcomeSummary,
        /// Peak of the first half cycle that rocks, in radians.
        first_peak_rad: Option<f64>,
        /// Largest rotation of a block, in radians.
        largest_peak_rotation_rad: f64,
    },
    /// The history failed.
    Failed {
        /// The reason.
        failed: &'a str,
    },
}

/// Largest displacements of a point.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct PointPeaks {
    /// Horizontal position in the undeformed structure, from its middle to the right, in metres.
    pub x_m: f64,
    /// Height in the undeformed structure, in metres.
    pub y_m: f64,
    /// Largest displacement to the right, or negative to the left, in metres.
    pub peak_x_m: f64,
    /// Time of the largest horizontal displacement, in seconds.
    pub peak_x_time_s: f64,
    /// Largest displacement upwards, or negative downwards, in metres.
    pub peak_y_m: f64,
    /// Time of the largest vertical displacement, in seconds.
    pub peak_y_time_s: f64,
}

impl OutcomeSummary {
    /// Returns the outcome of a history.
    pub fn of(history: &History) -> Self {
        Self {
            outcome: history.outcome.name(),
            outcome_time_s: history.outcome_time_s,
            overturning_sway: history.outcome.overturning_sway(),
        }
    }
}

impl<'a> Summary<'a> {
    /// Makes the summary of a history, with the peaks of the observed points.
    pub fn of(computed: &ComputedRun<'a>, points: Vec<PointPeaks>) -> Self {
        let (scenario, model, history) = (computed.scenario, computed.model, computed.history);
        let mechanisms = model.as_mechanisms();
        let names = columns(&model.bodies(), "peak_rotation", "rad");
        let peaks_rad = history.peak_rotations_rad.iter().copied();
        // Only the summary contains the time of computation; results would otherwise differ between runs.
        let longest_step = history.row().and_then(|row| row.longest_step);
        Self {
            program: env!("CARGO_PKG_NAME"),
            version: env!("CARGO_PKG_VERSION"),
            scenario: scenario.to_json(),
            record_checksums: scenario.record_checksums(),
            verdict: computed.verdict(),
            warnings: warnings(scenario, model, history),
            outcome: OutcomeSummary::of(history),
            impacts: history.known_impacts(),
            peak_rotations_rad: Named(names.into_iter().zip(peaks_rad).collect()),
            largest_peak_rotation_rad: history.largest_rotation_rad(),
            incipient_acceleration_g: Sides::of(|sway| model.incipient_acceleration_g(sway)),
            energy_defect_ratio: history.energy_defect_ratio,
            friction: history.thrust.as_ref().map(|thrust| FrictionDemand {
                largest_friction_demand: thrust.largest_friction.value,
                largest_friction_demand_time_s: thrust.largest_friction.time_s,
                lasting_friction_demand: thrust.lasting_friction,
            }),
            steps: history.cost.steps,
            mechanisms: mechanisms.map(|model| MechanismResults::of(scenario, model, history)),
            row: history.row().map(|row| RowResults {
                half_cycles: history.half_cycles(),
                elastic: history.elastic(),
                row,
                feet: FeetApart::of(scenario, history),
                friction_coefficient: scenario.motion.options.friction_coefficient(),
                iterations: history.cost.evaluations,
            }),
            repeatability: computed.repeated.map(RepeatabilitySummary::of),
            variations: computed.varied.iter().map(VariationSummary::of).collect(),
            points,
            to_quote: quotable::in_words(&[computed.answer()]),
            uncertain: None,
            longest_step_us: longest_step.map(|step| (step.as_secs_f64() * 1e6).round()),
        }
    }
}

impl MechanismResults {
    fn of(scenario: &Scenario, model: &dyn MechanismModel, history: &History) -> Self {
        let pushes_m_s2 = scenario.ground_motion().pushes_m_s2(history.end_s);
        let dimensionless = |scales: Scales| Dimensionless {
            p_rad_s: scales.frequency_rad_s,
            p_t_p: match scenario.ground.as_ref() {
                Some(Ground::Pulse(pulse)) => Some(pulse.duration_s * scales.frequency_rad_s),
                Some(Ground::Record(_)) | None => None,
            },
            peak_acceleration_over_incipient: scales.over_incipient(pushes_m_s2),
        };
        let thrust = |thrust: &ThrustRecord| {
            let [close, near] = thrust.shares_within().map_or([None; 2], |s| s.map(Some));
            Thrust {
                largest_thrust_excess_ratio: thrust.largest_excess.value,
                largest_thrust_excess_time_s: thrust.largest_excess.time_s,
                rocking_share_thrust_excess_below_0_01: close,
                rocking_share_thrust_excess_below_0_05: near,
            }
        };
        Self {
            peak_rotation_over_critical: history.peak_over_critical(),
            thrust_excess_ratio: history.thrust_excess_ratio(),
            dimensionless: Scales::new(model, scenario.gravity_m_s2()).map(dimensionless),
            thrust: history.thrust.as_ref().map(thrust),
            evaluations: history.cost.evaluations,
        }
    }
}

impl<'a> RepeatabilitySummary<'a> {
    fn of(repeatability: &'a Repeatability) -> Self {
        let names = ["own"].into_iter();
        let names = names.chain(repeatability.repeated.iter().copied());
        let named = names.map(key).zip(&repeatability.outcomes);
        let outcomes = named.clone().map(|(key, one)| (key, one.name()));
        let sways = named.map(|(key, one)| (key, one.overturning_sway()));
        Self {
            outcomes: Named(outcomes.collect()),
            overturning_sways: Named(sways.collect()),
            repeatability,
        }
    }
}

impl<'a> VariationSummary<'a> {
    fn of(VariationResult { name, result }: &'a VariationResult) -> Self {
        Self {
            with: name,
            end: match result {
                Ok(history) => VariationOutcome::Computed {
                    outcome: OutcomeSummary::of(history),
                    first_peak_rad: first_peak_rad(history),
                    largest_peak_rotation_rad: history.largest_rotation_rad(),
                },
                Err(failed) => VariationOutcome::Failed { failed },
            },
        }
    }
}

/// Returns the summary of a history as JSON.
///
/// # Errors
/// When a value is not finite.
pub fn summary(computed: &ComputedRun<'_>) -> Result<Value, OutputError> {
    // Computing time would differ between equal histories.
    summary_of(&Summary {
        longest_step_us: None,
        ..Summary::of(computed, Vec::new())
    })
}
