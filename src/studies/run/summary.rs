//! `summary.json`.

use serde_json::{Map, Value, json};

use super::Scales;
use super::feet::FeetApart;
use super::verdict::Evidence;
use super::words::{first_peak_rad, warnings};
use crate::dynamics::history::{ElasticSummary, Outcome, RowSummary, Summary, TieSummary};
use crate::dynamics::model::{MechanismModel, Model};
use crate::dynamics::repeatability::{Repeatability, RepeatabilityError, RepeatedValue};
use crate::dynamics::variation::Varied;
use crate::mechanics::sway::Sway;
use crate::output::mechanisms::columns;
use crate::output::{OutputError, finite};
use crate::scenario::{Ground, Scenario};

/// The summary of a run as JSON.
///
/// For mechanisms, `peak_rotation_over_critical` is the largest rotation relative to that at the unstable equilibrium of the
/// mechanism that moved. `dimensionless` has `p_rad_s` (see [`Scales`]), `p_t_p` (`p` times the duration of the pulse) and
/// `peak_acceleration_over_incipient` (of the ground, relative to `g A_L` of the side to which it pushes; the larger of both).
///
/// For a row of blocks, `peak_potential_over_barrier` is the largest potential energy relative to that at which the first mechanism
/// overturns, if that is known. Normal forces and friction are those outside impacts; `largest_friction_demand` is the largest
/// among the samples, as in `rotations.csv`. `energy_defect_ratio` is relative to weight times size (the mean radius of an arch, half the
/// diagonal of a column), `energy_defect_over_largest` to the larger of the barrier, if that is known, and the largest
/// kinetic energy. If joints slip: `slips_m` at the end and `largest_slips_m` for every joint, `friction_j` dissipated, and, with
/// free hinges, what did not converge. `impacts` is null with elastic joints, because their contact lasts. `repeatability` is left out if the
/// run was not repeated; if a repetition failed, it holds the reason as `failed`. `warnings` are sentences about unlikely numbers of the
/// scenario and about what limits the trust in its history.
///
/// # Errors
/// When a value is not finite.
pub fn summary(
    scenario: &Scenario,
    model: &dyn Model,
    history: &Summary,
    spread: Option<&Result<Repeatability, RepeatabilityError>>,
) -> Result<Value, OutputError> {
    let mut object = Object::default();
    object.put("program", json!(env!("CARGO_PKG_NAME")));
    object.put("version", json!(env!("CARGO_PKG_VERSION")));
    object.put("scenario", scenario.to_json());
    object.put("record_checksums", json!(scenario.record_checksums()));
    let evidence = Evidence {
        scenario,
        history,
        spread,
        varied: &[],
    };
    object.put("verdict", json!(evidence.verdict().name()));
    object.put("warnings", json!(warnings(scenario, model, history)));
    object.ending(history)?;
    object.put("impacts", json!(history.known_impacts()));
    let peaks = columns(&model.bodies(), "peak_rotation", "rad");
    for (name, peak_rad) in peaks.iter().zip(&history.peak_rotations_rad) {
        object.number(name, *peak_rad)?;
    }
    match (model.as_mechanisms(), history.row()) {
        (Some(model), _) => object.mechanisms(scenario, model, history)?,
        (None, Some(row)) => object.row(scenario, model, history, row)?,
        (None, None) => {}
    }
    match spread {
        Some(Ok(spread)) => object.put("repeatability", of_spread(spread)?),
        Some(Err(reason)) => object.put("repeatability", json!({ "failed": reason.to_string() })),
        None => {}
    }
    Ok(Value::Object(object.0))
}

/// The JSON object so far.
#[derive(Default)]
struct Object(Map<String, Value>);

impl Object {
    fn put(&mut self, name: &str, value: Value) {
        self.0.insert(name.to_owned(), value);
    }

    /// Adds a finite number, or null.
    fn number(&mut self, name: &str, value: impl Into<Option<f64>>) -> Result<(), OutputError> {
        let value = value.into();
        finite(name, value.as_slice())?;
        self.put(name, json!(value));
        Ok(())
    }

    fn numbers(&mut self, name: &str, values: &[f64]) -> Result<(), OutputError> {
        finite(name, values)?;
        self.put(name, json!(values));
        Ok(())
    }

    fn counts(&mut self, counts: impl IntoIterator<Item = (&'static str, u64)>) {
        for (name, count) in counts {
            self.put(name, json!(count));
        }
    }

    /// Adds how the history ended.
    fn ending(&mut self, history: &Summary) -> Result<(), OutputError> {
        self.put("outcome", json!(history.outcome.name()));
        self.number("outcome_time_s", history.outcome_time_s)?;
        let sway = match history.outcome {
            Outcome::Overturned(sway) => Some(sway.name()),
            _ => None,
        };
        self.put("overturning_sway", json!(sway));
        Ok(())
    }

    /// Adds the accelerations that start the structure.
    fn incipient(&mut self, model: &dyn Model) {
        let [right, left] =
            [Sway::Right, Sway::Left].map(|sway| model.incipient_acceleration_g(sway));
        let both = json!({ "right": right, "left": left });
        self.put("incipient_acceleration_g", both);
    }

    /// Adds the results that only mechanisms have.
    fn mechanisms(
        &mut self,
        scenario: &Scenario,
        model: &dyn MechanismModel,
        history: &Summary,
    ) -> Result<(), OutputError> {
        self.number("peak_rotation_over_critical", history.peak_over_critical())?;
        self.incipient(model);
        if let Some(scales) = Scales::new(model, scenario.gravity_m_s2()) {
            let p_rad_s = scales.frequency_rad_s;
            let p_t_p = match scenario.ground() {
                Some(Ground::Pulse(pulse)) => Some(pulse.duration_s * p_rad_s),
                Some(Ground::Record(_)) | None => None,
            };
            let pushes_m_s2 = scenario.ground_motion().pushes_m_s2(history.end_s);
            let mut dimensionless = Self::default();
            dimensionless.number("p_rad_s", p_rad_s)?;
            dimensionless.number("p_t_p", p_t_p)?;
            dimensionless.number(
                "peak_acceleration_over_incipient",
                scales.over_incipient(pushes_m_s2),
            )?;
            self.put("dimensionless", Value::Object(dimensionless.0));
        }
        self.number("energy_defect_ratio", history.energy_defect_ratio)?;
        if let Some(thrust) = &history.thrust {
            let (excess, friction) = (thrust.largest_excess, thrust.largest_friction);
            let share = |level: usize| thrust.shares_within().map(|shares| shares[level]);
            for (name, value) in [
                ("largest_thrust_excess_ratio", Some(excess.value)),
                ("largest_thrust_excess_time_s", Some(excess.time_s)),
                ("largest_friction_demand", Some(friction.value)),
                ("largest_friction_demand_time_s", Some(friction.time_s)),
                ("rocking_share_thrust_excess_below_0_01", share(0)),
                ("rocking_share_thrust_excess_below_0_05", share(1)),
            ] {
                self.number(name, value)?;
            }
        }
        let cost = &history.cost;
        self.counts([("evaluations", cost.evaluations), ("steps", cost.steps)]);
        Ok(())
    }

    /// Adds the results that only elastic joints have.
    fn elastic(&mut self, elastic: &ElasticSummary) -> Result<(), OutputError> {
        let largest = &elastic.largest_stress;
        self.number("largest_compressive_stress_pa", largest.stress_pa)?;
        self.put("largest_compressive_stress_joint", json!(largest.joint));
        self.number("largest_compressive_stress_time_s", largest.time_s)?;
        for (name, value) in [
            ("elastic_j", elastic.elastic_j),
            ("damped_j", elastic.damped_j),
            ("friction_j", elastic.friction_j),
            ("crushed_j", elastic.crushed_j),
            ("ties_j", elastic.ties_j),
            ("rest_eccentricity_ratio", elastic.rest_eccentricity_ratio),
        ] {
            self.number(name, value)?;
        }
        let joint = elastic.rest_eccentricity_joint;
        self.put("rest_eccentricity_joint", json!(joint));
        Ok(())
    }

    /// What is told of ties; nothing where there are none.
    fn ties(&mut self, ties: &[TieSummary]) -> Result<(), OutputError> {
        let mut told = Vec::new();
        for tie in ties {
            let mut object = Self::default();
            for (name, value) in [
                ("peak_force_n", Some(tie.peak_force_n)),
                ("peak_force_time_s", Some(tie.peak_force_time_s)),
                ("yielded_s", tie.yielded_s),
                ("broken_s", tie.broken_s),
                ("yielded_m", Some(tie.yielded_m)),
                ("force_n", Some(tie.force_n)),
                ("elastic_j", Some(tie.elastic_j)),
                ("taken_j", Some(tie.taken_j)),
            ] {
                object.number(name, value)?;
            }
            told.push(Value::Object(object.0));
        }
        if !told.is_empty() {
            self.put("ties", told.into());
        }
        Ok(())
    }

    /// Adds the results that only rows of blocks have.
    fn row(
        &mut self,
        scenario: &Scenario,
        model: &dyn Model,
        history: &Summary,
        row: &RowSummary,
    ) -> Result<(), OutputError> {
        self.number("largest_peak_rotation_rad", history.largest_rotation_rad())?;
        let over_barrier = history.peak_potential_over_barrier();
        self.number("peak_potential_over_barrier", over_barrier)?;
        self.incipient(model);
        let mut half_cycles = Vec::new();
        for cycle in history.half_cycles() {
            let mut object = Self::default();
            object.put("sway", json!(cycle.sway.name()));
            object.number("start_s", cycle.start_s)?;
            object.number("duration_s", cycle.duration_s)?;
            object.number("peak_rad", cycle.peak_rad)?;
            object.number("peak_time_s", cycle.peak_time_s)?;
            object.number("energy_ratio", cycle.energy_ratio)?;
            half_cycles.push(Value::Object(object.0));
        }
        self.put("half_cycles", half_cycles.into());
        if let Some(elastic) = history.elastic() {
            self.elastic(elastic)?;
        // There is none if the row was released beyond the point where it overturns.
        } else if history.cost.steps > 0 {
            self.number("least_normal_n", row.least_normal_n)?;
        }
        self.ties(&row.ties)?;
        if let Some(apart) = FeetApart::of(scenario, history) {
            self.number("start_s", scenario.ground_motion().start_s())?;
            self.numbers("feet_farthest_apart_m", apart.farthest_m.as_slice())?;
            self.number("feet_farthest_apart_time_s", apart.farthest_s)?;
            self.numbers("feet_apart_at_end_m", apart.last_m.as_slice())?;
        }
        if let Some(thrust) = &history.thrust {
            let friction = thrust.largest_friction;
            self.number("largest_friction_demand", friction.value)?;
            self.number("largest_friction_demand_time_s", friction.time_s)?;
        }
        if history.elastic().is_none() {
            self.number("energy_taken_j", row.energy_taken_j)?;
        }
        self.number("ground_j", row.ground_j)?;
        self.number("right_foot_j", row.right_foot_j)?;
        self.number("energy_defect_ratio", history.energy_defect_ratio)?;
        self.number("energy_defect_over_largest", row.energy_error)?;
        self.number("closure_error_m", row.closure_error_m)?;
        if let Some(sliding) = &row.sliding {
            let coefficient = scenario.motion().friction_coefficient();
            self.number("friction_coefficient", coefficient)?;
            self.numbers("slips_m", &sliding.offsets_m)?;
            self.numbers("largest_slips_m", &sliding.largest_offsets_m)?;
            self.number("friction_j", sliding.friction_j)?;
        }
        if history.elastic().is_some() {
            self.counts([("steps", history.cost.steps)]);
            self.number("longest_step_s", row.longest_step_s)?;
            self.number("shortest_step_s", row.shortest_step_s)?;
            return Ok(());
        }
        if let Some(sliding) = &row.sliding {
            self.number("friction_bound_error", sliding.bound_error)?;
            self.counts([("unconverged_steps", sliding.unconverged)]);
        }
        self.counts([
            ("steps", history.cost.steps),
            ("programs", row.programs),
            ("iterations", history.cost.evaluations),
            ("most_iterations", row.most_iterations),
            ("relaxed", row.relaxed),
            ("merged", row.merged),
        ]);
        if row.halvings > 0 {
            self.counts([("step_halvings", row.halvings.into())]);
        }
        Ok(())
    }
}

/// How the motion ends with other properties: a list of what differs (`with`), `outcome`, `outcome_time_s`, `overturning_sway`,
/// `first_peak_rad` and `largest_peak_rotation_rad`; or `failed`, with the reason.
///
/// # Errors
/// When a value is not finite.
pub(super) fn of_variations(varied: &[Varied]) -> Result<Value, OutputError> {
    let variation = |varied: &Varied| {
        let mut object = Object::default();
        object.put("with", json!(varied.name));
        match &varied.result {
            Ok(history) => {
                object.ending(history)?;
                object.number("first_peak_rad", first_peak_rad(history))?;
                let largest_rad = history.largest_rotation_rad();
                object.number("largest_peak_rotation_rad", largest_rad)?;
            }
            Err(reason) => object.put("failed", json!(reason)),
        }
        Ok(Value::Object(object.0))
    };
    varied.iter().map(variation).collect()
}

fn of_spread(spread: &Repeatability) -> Result<Value, OutputError> {
    let peak = |peak: &RepeatedValue| -> Result<Value, OutputError> {
        let mut object = Object::default();
        object.number("own", peak.own)?;
        object.number("min", peak.min)?;
        object.number("max", peak.max)?;
        Ok(Value::Object(object.0))
    };
    let mut slips_m = Vec::new();
    for slip in &spread.slips_m {
        let mut object = Object::default();
        object.number("own", slip.own)?;
        object.number("min", slip.min)?;
        object.number("max", slip.max)?;
        slips_m.push(Value::Object(object.0));
    }
    let early = spread.early.map(|early| {
        json!({
            "peak_time_s": early.peak_time_s,
            "ratio": early.ratio,
            "repetition": early.repetition.replace(' ', "_"),
        })
    });
    let mut half_cycles = Vec::new();
    for cycle in &spread.half_cycles {
        let peak_rad = cycle.peak_rad.as_ref().map(peak).transpose()?;
        half_cycles.push(json!({ "peak_time_s": cycle.own.peak_time_s, "peak_rad": peak_rad }));
    }
    let names = std::iter::once("own").chain(spread.repeated.iter().copied());
    let names = names.map(|name| name.replace(' ', "_"));
    let outcomes = spread.outcomes.iter().map(|outcome| json!(outcome.name()));
    let sways = spread.outcomes.iter().map(|outcome| match outcome {
        Outcome::Overturned(sway) => json!(sway.name()),
        _ => Value::Null,
    });
    let sways: Map<_, _> = names.clone().zip(sways).collect();
    let outcomes: Map<_, _> = names.zip(outcomes).collect();
    let largest = spread.largest_rad.as_ref().map(peak).transpose()?;
    Ok(json!({
        "outcomes": outcomes,
        "overturning_sways": sways,
        "half_cycles": half_cycles,
        "same_until_half_cycle": spread.same_until_half_cycle,
        "parts_at_s": spread.parts_at_s,
        "largest_rotation_rad": largest,
        "early_difference": early,
        "slips_m": slips_m,
    }))
}
