//! What a run of a row of blocks writes beside the tables of any run: `joints.csv`, `impacts.csv`, `summary.json`.

use std::io::Write;

use serde_json::{Value, json};

use super::results::{beginning, edges, joints};
use super::table::{Table, table};
use super::{OutputError, finite};
use crate::dynamics::free_hinges::FreeHinges;
use crate::dynamics::history::{Impact, Sample, Summary};
use crate::dynamics::model::Model as _;
use crate::dynamics::spread::{PeakSpread, Spread, SpreadError};
use crate::mechanics::sway::Sway;
use crate::scenario::Scenario;

/// Writes the gaps of all joints at both edges, a row per sample: `time_s`, `gap_0_intrados_m`, `gap_0_extrados_m`
/// and so on; where joints slip, then `slip_0_m` and so on: the offset of the right face towards the extrados (of a column: of
/// the upper face to the right).
///
/// Joint 0 is the left springing, or the base of a column, whose intrados is its left side. The larger gap of a
/// joint is an arc: thickness times relative rotation, plus the smaller gap.
pub struct JointsWriter<W: Write> {
    csv: Table<W>,
}

impl<W: Write> JointsWriter<W> {
    const WHAT: &str = "cannot write the joints";

    /// Starts with the header for so many joints, which slip or do not.
    ///
    /// # Errors
    /// When the system refuses.
    pub fn new(writer: W, joints: usize, slip: bool) -> Result<Self, OutputError> {
        let mut csv = table(writer);
        let gaps = (0..joints)
            .flat_map(|joint| ["intrados", "extrados"].map(|edge| format!("gap_{joint}_{edge}_m")));
        let slips = (0..joints)
            .filter(|_| slip)
            .map(|joint| format!("slip_{joint}_m"));
        let header = std::iter::once("time_s".to_owned())
            .chain(gaps)
            .chain(slips);
        csv.write_record(header)
            .map_err(OutputError::csv(Self::WHAT))?;
        Ok(Self { csv })
    }

    /// Writes a row.
    ///
    /// # Errors
    /// When the system refuses, or a value is not finite.
    pub fn write(&mut self, sample: &Sample) -> Result<(), OutputError> {
        self.csv
            .serialize((sample.time_s, &sample.gaps_m[..], &sample.offsets_m[..]))
            .map_err(OutputError::csv(Self::WHAT))
    }

    /// Ends the table.
    ///
    /// # Errors
    /// When the system refuses.
    pub fn finish(mut self) -> Result<(), OutputError> {
        self.csv.flush().map_err(OutputError::io(Self::WHAT))
    }
}

/// Writes the landings, a row per impact: `impact` (from 1), `time_s`, `joints_shut` and `joints_opened` (numbers with
/// spaces between), each with its edges in the same order (`edges_shut`: which landed, `edges_opened`: about which they turn; `both`
/// where both landed or the joint parts), `energy_before_j`, `energy_after_j` and `energy_taken_j`, kinetic energies, and where joints slip `friction_j`, the
/// part that friction took.
pub struct LandingsWriter<W: Write> {
    csv: Table<W>,
    rows: usize,
}

impl<W: Write> LandingsWriter<W> {
    const WHAT: &str = "cannot write the impacts";

    /// Starts with the header, for joints that slip or do not.
    ///
    /// # Errors
    /// When the system refuses.
    pub fn new(writer: W, slip: bool) -> Result<Self, OutputError> {
        let mut csv = table(writer);
        let columns = [
            "impact",
            "time_s",
            "joints_shut",
            "edges_shut",
            "joints_opened",
            "edges_opened",
            "energy_before_j",
            "energy_after_j",
            "energy_taken_j",
        ];
        csv.write_record(columns.into_iter().chain(slip.then_some("friction_j")))
            .map_err(OutputError::csv(Self::WHAT))?;
        Ok(Self { csv, rows: 0 })
    }

    /// Writes a row.
    ///
    /// # Errors
    /// When the system refuses, or a value is not finite.
    pub fn write(&mut self, time_s: f64, impact: &Impact) -> Result<(), OutputError> {
        let (before_j, after_j) = (impact.energy_before_j, impact.energy_after_j);
        self.rows += 1;
        self.csv
            .serialize((
                self.rows,
                time_s,
                joints(&impact.closed),
                edges(&impact.closed),
                joints(&impact.opened),
                edges(&impact.opened),
                before_j,
                after_j,
                before_j - after_j,
                impact.friction_j.as_slice(),
            ))
            .map_err(OutputError::csv(Self::WHAT))
    }

    /// Ends the table.
    ///
    /// # Errors
    /// When the system refuses.
    pub fn finish(mut self) -> Result<(), OutputError> {
        self.csv.flush().map_err(OutputError::io(Self::WHAT))
    }
}

/// The summary of a run with free hinges as JSON.
///
/// `peak_potential_over_barrier` is the largest potential energy over that at which the first mechanism overturns, where that
/// is known. Normal forces and friction are those outside impacts; `largest_friction_demand` is that of the samples, as in
/// `rotations.csv`. `energy_defect_ratio` is over weight times size (the mean radius of an arch, half the diagonal of
/// a column), `energy_defect_over_largest` over the larger of the barrier, where that is known, and the largest kinetic energy. Where joints slip: `slips_m` at the end and `largest_slips_m` of every joint, `friction_j` taken, and what did
/// not converge. `spread` is left out where the run was not repeated; where a repetition failed it says why, as `failed`.
///
/// # Errors
/// When a value is not finite.
pub fn summary(
    scenario: &Scenario,
    model: &FreeHinges,
    history: &Summary,
    spread: Option<&Result<Spread, SpreadError>>,
) -> Result<Value, OutputError> {
    let mut summary = beginning(scenario, history, &model.bodies())?;
    let more = summary.as_object_mut().expect("the summary is an object");
    let mut put = |name: &str, value: Value| more.insert(name.to_owned(), value);
    let incipient_g = |sway| model.incipient_acceleration_g(sway);
    let largest_rad = history.largest_rotation_rad();
    put("largest_peak_rotation_rad", json!(largest_rad));
    let over_barrier = history.peak_potential_over_barrier;
    finite("peak_potential_over_barrier", over_barrier.as_slice())?;
    put("peak_potential_over_barrier", json!(over_barrier));
    put(
        "incipient_acceleration_g",
        json!({ "right": incipient_g(Sway::Right), "left": incipient_g(Sway::Left) }),
    );
    if let Some(row) = &history.row {
        let mut half_cycles = Vec::new();
        for cycle in &row.half_cycles {
            finite(
                "of a half cycle",
                &[cycle.start_s, cycle.duration_s, cycle.peak_rad],
            )?;
            finite("of a half cycle", cycle.energy_ratio.as_slice())?;
            half_cycles.push(json!({
                "sway": cycle.sway.name(),
                "start_s": cycle.start_s,
                "duration_s": cycle.duration_s,
                "peak_rad": cycle.peak_rad,
                "energy_ratio": cycle.energy_ratio,
            }));
        }
        put("half_cycles", json!(half_cycles));
        // None where it was released beyond where it overturns.
        if history.cost.steps > 0 {
            let least_normal_n = row.least_normal_n;
            put("least_normal_n", number("least_normal_n", least_normal_n)?);
        }
        if let Some(thrust) = &history.thrust {
            let (name, largest) = ("largest_friction_demand", thrust.largest_friction);
            put(name, number(name, largest.value)?);
            put(
                "largest_friction_demand_time_s",
                number(name, largest.time_s)?,
            );
        }
        for (name, value) in [
            ("energy_taken_j", row.energy_taken_j),
            ("energy_defect_ratio", history.energy_defect_ratio),
            ("energy_defect_over_largest", row.energy_error),
            ("closure_error_m", row.closure_error_m),
        ] {
            put(name, number(name, value)?);
        }
        if let Some(sliding) = &row.sliding {
            put("friction_coefficient", json!(model.friction_coefficient()));
            finite("of a slip", &sliding.offsets_m)?;
            finite("of a slip", &sliding.largest_offsets_m)?;
            put("slips_m", json!(sliding.offsets_m));
            put("largest_slips_m", json!(sliding.largest_offsets_m));
            for (name, value) in [
                ("friction_j", sliding.friction_j),
                ("friction_bound_error", sliding.bound_error),
            ] {
                put(name, number(name, value)?);
            }
            put("unconverged_steps", json!(sliding.unconverged));
        }
        for (name, count) in [
            ("steps", history.cost.steps),
            ("programs", row.programs),
            ("iterations", history.cost.evaluations),
            ("most_iterations", row.most_iterations),
            ("relaxed", row.relaxed),
            ("merged", row.merged),
        ] {
            put(name, json!(count));
        }
    }
    match spread {
        Some(Ok(spread)) => put("spread", of_spread(spread)?),
        Some(Err(reason)) => put("spread", json!({ "failed": reason.to_string() })),
        None => None,
    };
    Ok(summary)
}

fn number(name: &str, value: f64) -> Result<Value, OutputError> {
    finite(name, &[value])?;
    Ok(json!(value))
}

fn of_spread(spread: &Spread) -> Result<Value, OutputError> {
    let mut half_cycles = Vec::new();
    let peak = |peak: &PeakSpread| -> Result<Value, OutputError> {
        finite("spread", &[peak.own_rad, peak.min_rad, peak.max_rad])?;
        Ok(json!({ "own": peak.own_rad, "min": peak.min_rad, "max": peak.max_rad }))
    };
    for cycle in &spread.half_cycles {
        half_cycles.push(json!({ "peak_rad": peak(cycle)? }));
    }
    let mut outcomes = serde_json::Map::new();
    let names = std::iter::once("own").chain(spread.repeated.iter().copied());
    for (name, outcome) in names.zip(&spread.outcomes) {
        outcomes.insert(name.replace(' ', "_"), json!(outcome.name()));
    }
    let largest = spread.largest.as_ref().map(peak).transpose()?;
    Ok(json!({
        "outcomes": outcomes,
        "half_cycles": half_cycles,
        "same_until_half_cycle": spread.same_until_half_cycle,
        "parts_at_s": spread.parts_at_s,
        "largest_rotation_rad": largest,
    }))
}
