//! The summary of a run: `summary.json`.

use serde::{Deserialize, Deserializer, Serialize};
use serde_json::Value;

use super::Scales;
use super::feet::FeetApart;
use super::impacts::{NotableImpact, NotableImpacts};
use crate::dynamics::repeatability::key;
use crate::dynamics::{
    Directions, EXCESS_LEVELS, ElasticSummary, HalfCycle, MODEL_LIMIT, OutcomeCount, OutcomeKind,
    Repeatability, Repetition, RowSummary, ThrustRecord, VariationResult,
};
use crate::mechanics::Sides;
use crate::output::mechanisms::columns;
use crate::output::{Named, OutputError, summary_of};
use crate::scenario::{ELASTIC_JOINTS, Ground, ModelKind, Scenario, Varied};
use crate::studies::quotable::{self, ModelAnswer, QUOTED_PEAK, SlipWords, restitution_in_words};
use crate::studies::report::Warnings;
use crate::{MechanismModel, Model, Outcome, Summary, Sway, Verdict};

/// A computed motion, with its repetitions and variations.
pub struct ComputedRun<'a> {
    /// The scenario.
    pub scenario: &'a Scenario,
    /// The model of motion.
    pub model: &'a dyn Model,
    /// The history.
    pub history: &'a Summary,
    /// The impacts that may be described.
    pub impacts: NotableImpacts,
    /// The comparison with its repetitions; `None` if the history was not repeated.
    pub repeated: Option<&'a Repeatability>,
    /// The histories with other stiffness and contact, and with rigid joints.
    pub varied: &'a [VariedRun],
    /// The result under the mirrored ground motion; `None` without a second direction.
    pub mirrored: Option<MirroredSummary>,
}

/// A history with other properties, and that under the mirrored ground motion; `None` without a second direction.
pub type VariedRun = (VariationResult, Option<VariationResult>);

/// The summary of a run: `summary.json`. Largest rotations of the bodies have keys such as `peak_rotation_left_rad`, `peak_rotation_1_rad` for
/// the first block of a row, or `peak_rotation_rad` for a column.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct RunSummary {
    /// The name of the program.
    pub program: String,
    /// Version of the program.
    pub version: String,
    /// Model of motion, as in the option `--hinges`.
    pub model: &'static ModelKind,
    /// The scenario with all defaults.
    pub scenario: Value,
    /// Checksums of the records.
    pub record_checksums: Vec<String>,
    /// Verdict on overturning; uncertain if the repetitions disagree. The worse one if the motion was computed in both directions.
    pub verdict: Verdict,
    /// The warnings.
    #[serde(flatten)]
    pub warnings: Warnings,
    /// Outcome of the motion.
    #[serde(flatten)]
    pub outcome: OutcomeSummary,
    /// The result under the mirrored ground motion, whose horizontal accelerations have the opposite sign; absent without a second direction. All
    /// other results are those of the motion as given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mirrored: Option<MirroredSummary>,
    /// Time at which the simulation ended, in seconds.
    pub end_s: f64,
    /// Number of impacts; null with elastic joints, whose contact is continuous.
    pub impacts: Option<usize>,
    /// First impact before overturning; absent without impact.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub first_impact: Option<NotableImpact>,
    /// Impact of a row that took the most energy before overturning; absent if this is the first one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hardest_impact: Option<NotableImpact>,
    /// Largest rotations of the bodies, in radians.
    #[serde(flatten, deserialize_with = "peak_rotations")]
    pub peak_rotations_rad: Named<f64>,
    /// Largest rotation of any body, in radians.
    pub largest_peak_rotation_rad: f64,
    /// The push that starts the structure to each side, in units of gravity; null if no push starts it.
    pub incipient_acceleration_g: Sides<Option<f64>>,
    /// Side of the wall behind a column, which carries pushes towards it; absent without a wall.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wall_behind: Option<Sway>,
    /// The ground, in units of gravity.
    pub ground: GroundSummary,
    /// Largest error of the energy balance. Reference of four links and columns: the barrier of the first mechanism. Reference of a row of
    /// blocks: weight times size (the mean radius of an arch, or half the diagonal of a column). With friction, the largest energy created.
    pub energy_defect_ratio: f64,
    /// The friction that prevents sliding.
    #[serde(flatten)]
    pub friction: Option<FrictionDemand>,
    /// Friction coefficient that the run and its repetitions require without slip, in both directions: the condition of the answer. Null if joints slip
    /// or are elastic.
    #[serde(default)]
    pub friction_demand: Option<f64>,
    /// Number of steps.
    pub steps: u64,
    /// Results of four links and columns.
    #[serde(flatten)]
    pub mechanisms: Option<MechanismResults>,
    /// Results of rows of blocks.
    #[serde(flatten)]
    pub row: Option<RowResults>,
    /// The comparison with its repetitions; absent if the history was not repeated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub repeatability: Option<RepeatabilitySummary>,
    /// The ends of the histories with other stiffness and contact, and with rigid joints.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub variations: Vec<VariationSummary>,
    /// Largest displacements of the points that were chosen with `--point`, relative to the ground.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub points: Vec<PointPeaks>,
    /// The answer that may be quoted, in words; absent from the summary of one of several models, which have one answer together.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub to_quote: Option<String>,
    /// Models of motion of all runs whose words are printed together; absent for one model.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub compared_models: Vec<&'static ModelKind>,
    /// True if the scenario has a table `[elastic_joints]` that this run ignores; absent otherwise.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub ignores_elastic_joints: bool,
    /// Summary of the samples of `[uncertain]`, as their `uncertain.json`; absent without samples.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub uncertain: Option<Value>,
    /// Computing time of the longest step, in microseconds. It is the only number that differs between computations.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub longest_step_us: Option<f64>,
}

/// Outcome of a motion.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct OutcomeSummary {
    /// `never_moved`, `vibrates`, `rest`, `overturned`, `still_rocking` or `incomplete`.
    pub outcome: OutcomeKind,
    /// Time of the outcome, in seconds. For an overturned structure it is the last time at which the structure could still return.
    pub outcome_time_s: f64,
    /// The side to which the structure overturned; null if it did not.
    pub overturning_sway: Option<Sway>,
}

/// The ground during a history, in units of gravity.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct GroundSummary {
    /// End of the motion of the ground, in seconds.
    pub end_s: f64,
    /// Largest horizontal acceleration until the end of the history.
    pub peak_g: f64,
    /// Largest horizontal acceleration, also after the end of the history.
    pub whole_peak_g: f64,
    /// Largest vertical acceleration until the end of the history.
    pub vertical_peak_g: f64,
    /// Largest push to each side until the end of the history.
    pub pushes_g: Sides<f64>,
}

/// The friction that prevents sliding, up to the end of the last half cycle whose peak is at least half of the largest, or up to overturning.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct FrictionDemand {
    /// Largest coefficient of friction that a motion without sliding needs, over all steps outside impacts, up to the end of the last half cycle
    /// whose peak is at least half of the largest. Joints that carry less than a hundredth of the weight do not count.
    pub largest_friction_demand: f64,
    /// Time of the largest friction demand, in seconds.
    pub largest_friction_demand_time_s: f64,
    /// Coefficient of friction that a motion without sliding needs for more than a hundredth of the time in motion; null for mechanisms, whose
    /// largest demand does not depend on the steps.
    pub lasting_friction_demand: Option<f64>,
}

impl FrictionDemand {
    /// Friction coefficient that prevents sliding, except for short peaks of rows.
    pub(super) fn required_coefficient(&self) -> f64 {
        self.lasting_friction_demand
            .unwrap_or(self.largest_friction_demand)
    }
}

/// Results of four links or of a column.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct MechanismResults {
    /// Largest rotation over that at the unstable equilibrium of the mechanism that moved. From 1 on, the structure overturns on quiet ground.
    pub peak_rotation_over_critical: Option<f64>,
    /// Largest excess of the thrust line of four links up to the largest rotation, or up to overturning, over the thickness; null for a column.
    pub thrust_excess_ratio: Option<f64>,
    /// Energy at the end over the least energy barrier of the moving mechanism and of all that may follow it, if more than a quarter of the barrier is
    /// left on quiet ground: below 1 the structure cannot overturn any more. Absent otherwise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub remaining_energy_over_barrier: Option<f64>,
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
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Dimensionless {
    /// Frequency parameter of the structure, in rad/s.
    pub p_rad_s: f64,
    /// Frequency parameter times the duration of the pulse; null for records.
    pub p_t_p: Option<f64>,
    /// Largest acceleration of the ground over `g A_L` of the side to which the ground pushes.
    pub peak_acceleration_over_incipient: f64,
}

/// The thrust line of four links, or of a column, at the output samples.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Thrust {
    /// Largest excess of the thrust line, over the thickness.
    pub largest_thrust_excess_ratio: f64,
    /// Time of the largest excess, in seconds.
    pub largest_thrust_excess_time_s: f64,
    /// Share of the time in motion in which the excess is at most 0.01; null if the structure never moved.
    pub rocking_share_thrust_excess_below_0_01: Option<f64>,
    /// Share of the time in motion in which the excess is at most 0.05; null if the structure never moved.
    pub rocking_share_thrust_excess_below_0_05: Option<f64>,
    /// Quality of four links as a model of the motion; null for a column, and if the structure never moved.
    pub four_links: Option<FourLinkQuality>,
    /// True for a continuous ring, which needs `voussoirs` to compare it with free hinges.
    pub is_continuous: bool,
}

named! {
    /// Quality of four links as a model of a motion.
    pub enum FourLinkQuality {
        /// The thrust line leaves the arch by at most a twentieth of its thickness, and the arch survives with less than 40 % of overturning, or overturns.
        Close = "close",
        /// The thrust line leaves the arch by more, or the arch survives with a larger rotation.
        Rough = "rough",
        /// Up to the largest rotation the thrust line leaves the arch so far that the mechanism cannot transmit its own forces.
        Outside = "outside",
    }
}

impl FourLinkQuality {
    fn of(history: &Summary, thrust: &ThrustRecord) -> Self {
        let up_to_peak = history.thrust_excess_ratio();
        let overturns = matches!(history.outcome, Outcome::Overturned(_));
        let is_large = history
            .peak_over_critical()
            .is_some_and(|peak| peak >= QUOTED_PEAK);
        match thrust.largest_excess.value {
            _ if up_to_peak.is_some_and(|ratio| ratio > MODEL_LIMIT) => Self::Outside,
            excess_ratio if excess_ratio <= EXCESS_LEVELS[1] && (overturns || !is_large) => {
                Self::Close
            }
            _ => Self::Rough,
        }
    }
}

/// Results of a row of blocks.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct RowResults {
    /// Half cycles whose peak is at least a thousandth of the largest rotation.
    pub half_cycles: Vec<HalfCycle>,
    /// Results of elastic joints.
    #[serde(flatten)]
    pub elastic: Option<ElasticSummary>,
    /// Results of all rows.
    #[serde(flatten)]
    pub row: RowSummary,
    /// Displacement between the feet; absent if both feet move together.
    #[serde(flatten)]
    pub feet: Option<FeetApart>,
    /// Coefficient of friction; absent if joints cannot slip.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub friction_coefficient: Option<f64>,
    /// Strength that limits the stress of elastic joints, in MPa; absent without a limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub compressive_strength_mpa: Option<f64>,
    /// Joints that slipped by more than a millionth of their thickness, the largest slip first; absent if none slipped.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub slipped_joints: Vec<usize>,
    /// Number of systems of equations that were solved.
    pub iterations: u64,
}

/// The result under the mirrored ground motion.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct MirroredSummary {
    /// Verdict on overturning under the mirrored ground motion alone; `incomplete` if its history failed.
    pub verdict: Verdict,
    /// Outcome of the motion; absent if its history failed.
    #[serde(flatten)]
    pub outcome: Option<OutcomeSummary>,
    /// Largest rotation of any body, in radians; null if its history failed.
    pub largest_peak_rotation_rad: Option<f64>,
    /// Largest rotation over that at the unstable equilibrium; absent for rows of blocks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub peak_rotation_over_critical: Option<f64>,
    /// Largest potential energy over the barrier of the first mechanism; absent for mechanisms, and if the barrier is unknown.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub peak_potential_over_barrier: Option<f64>,
    /// Largest excess of the thrust line of four links up to the largest rotation, over the thickness; absent for other models.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub thrust_excess_ratio: Option<f64>,
    /// Friction coefficient that the motion and its repetitions require without slip; absent if joints slip or are elastic.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction_demand: Option<f64>,
    /// Count of the outcomes of the motion and its repetitions; absent if it was not repeated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub certainty: Option<OutcomeCount>,
    /// Reason why its history failed; absent if it was computed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failed: Option<String>,
}

/// The comparison of a motion with its repetitions.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct RepeatabilitySummary {
    /// Outcomes of the run itself (`own`) and of its repetitions, by name.
    pub outcomes: Named<OutcomeKind>,
    /// The sides to which the structure overturned, by name.
    pub overturning_sways: Named<Option<Sway>>,
    /// The results.
    #[serde(flatten)]
    pub repeatability: Repeatability,
}

/// The end of a history with other properties.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct VariationSummary {
    /// The changed property.
    pub with: String,
    /// The end of the history.
    #[serde(flatten)]
    pub end: VariationOutcome,
    /// The end of the history under the mirrored ground motion; absent without a second direction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mirrored: Option<VariationOutcome>,
}

/// The end of a history with other properties, or the reason why there is none.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(untagged)]
pub enum VariationOutcome {
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
        failed: String,
    },
}

/// Largest displacements of a point.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
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
    /// Outcome of a history.
    pub fn of(history: &Summary) -> Self {
        Self {
            outcome: history.outcome.kind(),
            outcome_time_s: history.outcome_time_s,
            overturning_sway: history.outcome.overturning_sway(),
        }
    }

    /// Outcome with its side.
    pub(super) fn with_side(&self) -> Outcome {
        self.outcome.to_outcome(self.overturning_sway)
    }
}

/// Reads the largest rotations of the bodies among the other keys of a summary.
fn peak_rotations<'de, D: Deserializer<'de>>(keys: D) -> Result<Named<f64>, D::Error> {
    let Named(keys) = Named::<Value>::deserialize(keys)?;
    let is_peak = |key: &str| key.starts_with("peak_rotation") && key.ends_with("_rad");
    let peaks = keys
        .into_iter()
        .filter(|(key, _)| is_peak(key))
        .filter_map(|(key, peak)| Some((key, peak.as_f64()?)));
    Ok(Named(peaks.collect()))
}

impl RunSummary {
    /// Makes the summary of a history.
    pub fn of(computed: &ComputedRun<'_>) -> Self {
        let (scenario, model, history) = (computed.scenario, computed.model, computed.history);
        let names = columns(&model.bodies(), "peak_rotation", "rad");
        let peaks_rad = history.peak_rotations_rad.iter().copied();
        let [first_impact, hardest_impact] = computed.impacts.first_and_hardest(history);
        let mut summary = Self {
            program: env!("CARGO_PKG_NAME").to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            model: scenario.motion.kind,
            scenario: scenario.to_json(),
            record_checksums: scenario.record_checksums(),
            verdict: Verdict::Incomplete,
            warnings: Warnings::new(scenario.unlikely_in(&Varied::of_model(model)), []),
            outcome: OutcomeSummary::of(history),
            mirrored: computed.mirrored.clone(),
            end_s: history.end_s,
            impacts: history.known_impacts(),
            first_impact,
            hardest_impact,
            peak_rotations_rad: Named(names.into_iter().zip(peaks_rad).collect()),
            largest_peak_rotation_rad: history.largest_rotation_rad(),
            incipient_acceleration_g: Sides::of(|sway| model.incipient_acceleration_g(sway)),
            wall_behind: scenario.structure.wall_behind(),
            ground: GroundSummary::of(scenario, history),
            energy_defect_ratio: history.energy_defect_ratio,
            friction: history.friction.map(|friction| FrictionDemand {
                largest_friction_demand: friction.largest.value,
                largest_friction_demand_time_s: friction.largest.time_s,
                lasting_friction_demand: friction.lasting,
            }),
            friction_demand: friction_demand(computed),
            steps: history.cost.steps,
            mechanisms: model
                .as_mechanisms()
                .map(|model| MechanismResults::of(scenario, model, history)),
            row: RowResults::of(scenario, model, history),
            repeatability: computed.repeated.map(RepeatabilitySummary::of),
            variations: computed.varied.iter().map(VariationSummary::of).collect(),
            points: Vec::new(),
            to_quote: None,
            compared_models: Vec::new(),
            ignores_elastic_joints: scenario.motion.ignores_elastic_joints,
            uncertain: None,
            longest_step_us: None,
        };
        let own = summary.own_verdict();
        let mirrored = summary.mirrored.as_ref();
        summary.verdict = mirrored.map_or(own, |mirrored| own.max(mirrored.verdict));
        let caveats = summary.caveats();
        summary.warnings.extend(caveats);
        summary.to_quote = quotable::quote_answers(&[summary.answer(scenario, model)]);
        summary
    }

    /// Answer that may be quoted: a certain outcome that does not depend on the stiffness and contact of its joints.
    pub(super) fn answer(&self, scenario: &Scenario, model: &dyn Model) -> ModelAnswer {
        let [happens, direction] = self.outcome_in_words(only_direction(scenario, model));
        let no_answer = match (self.verdict, self.changed_outcome()) {
            (Verdict::Incomplete, _) => Some("the run has no verdict".to_owned()),
            (Verdict::Uncertain, _) => Some("it is uncertain whether it overturns".to_owned()),
            _ if self.row.is_some() && self.repeatability.is_none() => {
                Some("the run is not repeated".to_owned())
            }
            (_, Some(change)) => Some(format!(
                "the outcome depends on the stiffness and contact of the joints: it {happens} this motion{direction} with the given ones, and {change}"
            )),
            _ if *self.model == ELASTIC_JOINTS && self.variations.is_empty() => {
                Some("the dependence of the outcome on joint stiffness is unknown".to_owned())
            }
            _ => self.without_verdict().map(|caveat| caveat.to_string()),
        };
        let answer = no_answer.map_or_else(|| Ok(format!("{happens} this motion{direction}")), Err);
        let excess_ratio = self
            .mechanisms
            .as_ref()
            .and_then(|own| own.thrust_excess_ratio);
        let mirrored = self.mirrored.as_ref();
        let mirrored_ratio = mirrored.and_then(|mirrored| mirrored.thrust_excess_ratio);
        // A ratio that was not followed as given is not known from the mirrored motion.
        let excess_ratio = excess_ratio.map(|ratio| ratio.max(mirrored_ratio.unwrap_or(0.0)));
        let answer = ModelAnswer::new(
            self.model,
            scenario.structure.has_horizontal_thrust(),
            excess_ratio,
            answer,
        );
        let own_peak = self
            .mechanisms
            .as_ref()
            .and_then(|own| own.peak_rotation_over_critical);
        let mirrored_peak = mirrored.and_then(|mirrored| mirrored.peak_rotation_over_critical);
        let peak = own_peak.into_iter().chain(mirrored_peak).reduce(f64::max);
        let answer = match peak.filter(|_| self.verdict == Verdict::Survives) {
            Some(peak) => answer.surviving_with(peak),
            None => answer,
        };
        let repeated = self.repeatability.as_ref();
        let certainty = repeated.map(|all| match all.repeatability.count.path_repeats {
            true => "the same in all repetitions".to_owned(),
            false => "the same in all repetitions, though their paths differ".to_owned(),
        });
        let samples = "this is for the given numbers: quote the probability of [uncertain] as well";
        let samples = scenario.uncertain.as_ref().map(|_| samples.to_owned());
        answer
            .with_restitution(restitution_in_words(scenario))
            .with_certainty(certainty.into_iter().chain(samples))
            .with_friction(SlipWords::of(scenario).condition(self.friction_demand, "run FILE"))
    }
}

/// Friction coefficient that the motion, its repetitions and the mirrored motion require without slip.
fn friction_demand(computed: &ComputedRun<'_>) -> Option<f64> {
    let own = match computed.repeated {
        Some(repeated) => repeated.friction_demand,
        None => computed.history.required_friction(),
    };
    let mirrored = computed.mirrored.as_ref();
    let mirrored = mirrored.and_then(|mirrored| mirrored.friction_demand);
    own.into_iter().chain(mirrored).reduce(f64::max)
}

/// The only direction in which a motion is computed, if the other direction is another problem; otherwise `None`.
fn only_direction(scenario: &Scenario, model: &dyn Model) -> Option<Directions> {
    let directions = scenario.simulation.direction;
    let (ground, request) = (scenario.ground_motion(), scenario.request());
    let is_one =
        directions != Directions::Both && Directions::Both.has_second(model, ground, &request);
    is_one.then_some(directions)
}

impl GroundSummary {
    fn of(scenario: &Scenario, history: &Summary) -> Self {
        let (ground, gravity_m_s2) = (scenario.ground_motion(), scenario.gravity_m_s2());
        let peaks_m_s2 = ground.peaks_m_s2(history.end_s);
        let [right, left] = ground.pushes_m_s2(history.end_s);
        Self {
            end_s: ground.end_s(),
            peak_g: peaks_m_s2.x / gravity_m_s2,
            whole_peak_g: ground.peaks_m_s2(f64::INFINITY).x / gravity_m_s2,
            vertical_peak_g: peaks_m_s2.y / gravity_m_s2,
            pushes_g: Sides { right, left }.map(|push_m_s2| push_m_s2 / gravity_m_s2),
        }
    }
}

impl MechanismResults {
    fn of(scenario: &Scenario, model: &dyn MechanismModel, history: &Summary) -> Self {
        let pushes_m_s2 = scenario.ground_motion().pushes_m_s2(history.end_s);
        let dimensionless = |scales: Scales| Dimensionless {
            p_rad_s: scales.frequency_rad_s,
            p_t_p: match scenario.ground.as_ref() {
                Some(Ground::Pulse(pulse)) => Some(pulse.duration_s * scales.frequency_rad_s),
                Some(Ground::Record(_)) | None => None,
            },
            peak_acceleration_over_incipient: scales.ratio_to_incipient(pushes_m_s2),
        };
        let structure = &scenario.structure;
        let thrust = |thrust: &ThrustRecord| {
            let shares = thrust.shares_within();
            let [close, near] = shares.map_or([None; 2], |s| s.map(Some));
            let rocks = shares.is_some() && structure.has_horizontal_thrust();
            Thrust {
                largest_thrust_excess_ratio: thrust.largest_excess.value,
                largest_thrust_excess_time_s: thrust.largest_excess.time_s,
                rocking_share_thrust_excess_below_0_01: close,
                rocking_share_thrust_excess_below_0_05: near,
                four_links: rocks.then(|| FourLinkQuality::of(history, thrust)),
                is_continuous: structure
                    .circular_arch()
                    .is_some_and(|arch| arch.voussoirs.is_none()),
            }
        };
        Self {
            peak_rotation_over_critical: history.peak_over_critical(),
            thrust_excess_ratio: history.thrust_excess_ratio(),
            remaining_energy_over_barrier: history.remaining_over_barrier(),
            dimensionless: Scales::new(model, scenario.gravity_m_s2()).map(dimensionless),
            thrust: history.thrust.as_ref().map(thrust),
            evaluations: history.cost.evaluations,
        }
    }
}

/// Rotations up to this value are printed as zero: such a block slides without rocking.
pub(super) const STRAIGHT_RAD: f64 = 5e-7;

/// Slips below this fraction of the thickness of a joint are not reported.
const LEAST_SLIP_RATIO: f64 = 1e-6;

impl RowResults {
    fn of(scenario: &Scenario, model: &dyn Model, history: &Summary) -> Option<Self> {
        let (blocks, row) = (model.row()?, history.row()?);
        let largest_m = row
            .sliding
            .as_ref()
            .map_or(&[][..], |one| &one.largest_offsets_m);
        let slips = |joint: &usize| {
            largest_m[*joint] > LEAST_SLIP_RATIO * blocks.joints[*joint].thickness_m()
        };
        let mut slipped_joints: Vec<usize> = (0..largest_m.len()).filter(slips).collect();
        slipped_joints.sort_by(|a, b| largest_m[*b].total_cmp(&largest_m[*a]));
        Some(Self {
            half_cycles: history.half_cycles(),
            elastic: history.elastic_summary().copied(),
            row: row.clone(),
            feet: FeetApart::of(scenario, history),
            friction_coefficient: scenario.motion.options.friction_coefficient(),
            compressive_strength_mpa: scenario.motion.options.compressive_strength_mpa(),
            slipped_joints,
            iterations: history.cost.evaluations,
        })
    }
}

impl RepeatabilitySummary {
    fn of(repeatability: &Repeatability) -> Self {
        let names = ["own"]
            .into_iter()
            .chain(repeatability.repeated.iter().copied());
        let named = names.map(key).zip(&repeatability.outcomes);
        let outcomes = named.clone().map(|(key, one)| (key, one.kind()));
        let sways = named.map(|(key, one)| (key, one.overturning_sway()));
        Self {
            outcomes: Named(outcomes.collect()),
            overturning_sways: Named(sways.collect()),
            repeatability: repeatability.clone(),
        }
    }

    /// Names of the repetitions that did not fail.
    pub(super) fn repetition_names(&self) -> Vec<String> {
        let Self { outcomes, .. } = self;
        outcomes.0[1..]
            .iter()
            .map(|(key, _)| key.replace('_', " "))
            .collect()
    }

    /// Whether one of the repetitions is that under the mirrored ground motion.
    pub(super) fn is_mirrored(&self) -> bool {
        let mut repeated = self.repetition_names().into_iter();
        repeated.any(|name| name == Repetition::MIRRORED)
    }

    /// Opposite side of overturning, with the names of the repetitions that overturn to it; `None` if all overturn to one side.
    pub(super) fn other_side(&self) -> Option<(Sway, String)> {
        let mut others = self.other_outcomes().into_iter();
        others.find_map(|(other, names)| Some((other.overturning_sway()?, names)))
    }

    /// Whether a repetition has another verdict, or overturns to the other side.
    pub(super) fn differs(&self) -> bool {
        let own = self.own_outcome();
        let differs = |(other, _): &(Outcome, String)| {
            Some(Verdict::from(*other)) != own.map(Verdict::from)
                || Some(other.overturning_sway()) != own.map(|own| own.overturning_sway())
        };
        self.other_outcomes().iter().any(differs)
    }

    /// Outcome of the motion itself.
    fn own_outcome(&self) -> Option<Outcome> {
        let kinds = self.outcomes.0.iter();
        let mut outcomes = kinds.zip(&self.overturning_sways.0);
        let ((_, kind), (_, sway)) = outcomes.next()?;
        Some(kind.to_outcome(*sway))
    }

    /// The other outcomes, including those that differ in the side of overturning alone, each with the names of its repetitions.
    pub(super) fn other_outcomes(&self) -> Vec<(Outcome, String)> {
        let Self {
            outcomes: Named(kinds),
            overturning_sways: Named(sways),
            ..
        } = self;
        let mut outcomes = kinds
            .iter()
            .zip(sways)
            .map(|((_, kind), (_, sway))| kind.to_outcome(*sway));
        let own = outcomes.next();
        let mut others: Vec<(Outcome, String)> = Vec::new();
        for (name, outcome) in self.repetition_names().into_iter().zip(outcomes) {
            match others.iter_mut().find(|(other, _)| *other == outcome) {
                Some((_, names)) => *names += &format!(" and {name}"),
                None if Some(outcome) == own => {}
                None => others.push((outcome, name)),
            }
        }
        others
    }
}

/// Peak of the first half cycle that rocks, in radians.
fn first_peak_rad(history: &Summary) -> Option<f64> {
    let mut cycles = history.half_cycles().into_iter();
    let first = cycles.find(|cycle| cycle.peak_rad > STRAIGHT_RAD);
    first.map(|cycle| cycle.peak_rad)
}

impl VariationSummary {
    fn of((own, mirrored): &VariedRun) -> Self {
        Self {
            with: own.name.clone(),
            end: VariationOutcome::of(own),
            mirrored: mirrored.as_ref().map(VariationOutcome::of),
        }
    }

    /// Worse verdict of all directions; incomplete if a history failed.
    pub(super) fn verdict(&self) -> Verdict {
        let own = self.end.verdict();
        let mirrored = self.mirrored.as_ref();
        mirrored.map_or(own, |mirrored| own.max(mirrored.verdict()))
    }

    /// Ends in all directions, with their names.
    pub(super) fn named_ends(&self) -> impl Iterator<Item = (&'static str, &VariationOutcome)> {
        let mirrored = self.mirrored.iter().map(|end| ("; mirrored: ", end));
        [("", &self.end)].into_iter().chain(mirrored)
    }
}

impl VariationOutcome {
    fn of(VariationResult { result, .. }: &VariationResult) -> Self {
        match result {
            Ok(history) => Self::Computed {
                outcome: OutcomeSummary::of(history),
                first_peak_rad: first_peak_rad(history),
                largest_peak_rotation_rad: history.largest_rotation_rad(),
            },
            Err(failed) => Self::Failed {
                failed: failed.clone(),
            },
        }
    }

    fn verdict(&self) -> Verdict {
        match self {
            Self::Computed { outcome, .. } => outcome.with_side().into(),
            Self::Failed { .. } => Verdict::Incomplete,
        }
    }
}

/// Summary of a history as JSON.
///
/// # Errors
/// When a value is not finite.
pub fn summary(computed: &ComputedRun<'_>) -> Result<Value, OutputError> {
    summary_of(&RunSummary::of(computed))
}
