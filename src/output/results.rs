//! `events.csv`, `impacts.csv` and `summary.json` of a run.

use std::io::Write;

use serde_json::{Value, json};

use super::rotations::{Scales, columns};
use super::{OutputError, finite};
use crate::dynamics::history::{Event, History, ImpactEvent, Outcome, Rotations};
use crate::mechanics::four_link::mechanism::Sway;
use crate::mechanics::structure::{Hinge, Structure};
use crate::scenario::{Ground, Scenario};

/// Writes one row per transition.
///
/// | column | |
/// |---|---|
/// | `time_s` | instant |
/// | `phase` | the phase that begins, as in `rotations.csv`; phase 0 begins with the run, without a row |
/// | `kind` | `uplift`, `impact`, `rest` or `overturned` |
/// | `sway` | `right` or `left`, from here on; empty at rest |
/// | `mechanism` | index in the chain: impacts since the last uplift or release; empty at rest |
/// | `rotation_..._rad`, `rate_..._rad_s` | of each body, just after |
/// | `energy_j` | kinetic and potential, just after |
///
/// # Errors
/// When the system refuses, or a value is not finite.
pub fn write_events<S: Structure>(
    writer: impl Write,
    structure: &S,
    events: &[Event<Rotations<S>>],
) -> Result<(), OutputError> {
    const WHAT: &str = "cannot write the events";
    let mut csv = csv::Writer::from_writer(writer);
    let mut header: Vec<String> = ["time_s", "phase", "kind", "sway", "mechanism"]
        .map(str::to_owned)
        .to_vec();
    header.extend(columns::<S::Mechanism>("rotation", "rad"));
    header.extend(columns::<S::Mechanism>("rate", "rad_s"));
    header.push("energy_j".to_owned());
    csv.write_record(header).map_err(OutputError::csv(WHAT))?;
    for (index, event) in events.iter().enumerate() {
        let (rotations, rates) = (event.rotations_rad.as_ref(), event.rates_rad_s.as_ref());
        let energy_j = event.energy * joules_per_unit(structure);
        finite("of a row of events.csv", &[event.time_s, energy_j])?;
        finite("of a row of events.csv", rotations)?;
        finite("of a row of events.csv", rates)?;
        csv.serialize((
            event.time_s,
            index + 1,
            event.kind.name(),
            event.sway.map(Sway::name),
            event.mechanism,
            rotations,
            rates,
            energy_j,
        ))
        .map_err(OutputError::csv(WHAT))?;
    }
    csv.flush().map_err(OutputError::io(WHAT))
}

/// Writes one row per impact.
///
/// The mechanism after is the one that the impact leads to, with the energy that it would keep, also where
/// that is so little that the structure comes to rest. Where no mechanism can follow the hinges are left
/// empty. A column has no columns for hinges.
///
/// The impulses at its hinges act on the part towards the crown, in the frame of the ground; they are empty
/// where the restitution coefficient is prescribed.
///
/// # Errors
/// When the system refuses, or a value is not finite.
pub fn write_impacts<S: Structure>(
    writer: impl Write,
    structure: &S,
    impacts: &[ImpactEvent<'_, S>],
) -> Result<(), OutputError> {
    const WHAT: &str = "cannot write the impacts";
    let mut csv = csv::Writer::from_writer(writer);
    let mut header: Vec<String> = [
        "impact",
        "time_s",
        "sway_before",
        "sway_after",
        "restitution",
        "energy_before_j",
        "energy_after_j",
    ]
    .map(str::to_owned)
    .to_vec();
    for moment in ["before", "after"] {
        header.extend(columns::<S::Mechanism>("rate", &format!("{moment}_rad_s")));
    }
    let sections = sections_deg(structure, 0, Sway::Right).len();
    let hinges = ["a", "b", "c", "d"].iter().take(sections);
    header.extend(hinges.clone().map(|hinge| format!("hinge_{hinge}_deg")));
    header.extend(
        hinges.flat_map(|hinge| {
            ["x", "y"].map(|component| format!("impulse_{hinge}_{component}_n_s"))
        }),
    );
    csv.write_record(header).map_err(OutputError::csv(WHAT))?;

    let joule = joules_per_unit(structure);
    for (index, impact) in impacts.iter().enumerate() {
        let (before, after) = impact.energies();
        let (rates_before, rates_after) = impact.rates_rad_s();
        let (rates_before, rates_after) = (rates_before.as_ref(), rates_after.as_ref());
        let sway_after = impact.sway_before.opposite();
        let mut hinges_deg = sections_deg(structure, impact.impacts, sway_after);
        hinges_deg.resize(sections, None);
        let unit_n_s =
            structure.mass_unit_kg() * structure.length_m() * impact.rate_before_rad_s.abs();
        let impulses_n_s: Vec<f64> = structure
            .hinge_impulses(impact.impacts, sway_after)
            .iter()
            .flat_map(|impulse| [impulse.x * unit_n_s, impulse.y * unit_n_s])
            .collect();
        finite("of a row of impacts.csv", &impulses_n_s)?;
        let mut impulses_n_s: Vec<Option<f64>> = impulses_n_s.into_iter().map(Some).collect();
        impulses_n_s.resize(2 * sections, None);
        let restitution = impact.after.map_or(0.0, |link| link.restitution);
        let energies = [before * joule, after * joule];
        finite("of a row of impacts.csv", &[impact.time_s, restitution])?;
        finite("of a row of impacts.csv", &energies)?;
        finite("of a row of impacts.csv", rates_before)?;
        finite("of a row of impacts.csv", rates_after)?;
        csv.serialize((
            index + 1,
            impact.time_s,
            impact.sway_before.name(),
            sway_after.name(),
            restitution,
            energies,
            rates_before,
            rates_after,
            hinges_deg,
            impulses_n_s,
        ))
        .map_err(OutputError::csv(WHAT))?;
    }
    csv.flush().map_err(OutputError::io(WHAT))
}

/// Angles of the hinges that are at sections of an arch, in degrees from the left springing.
fn sections_deg<S: Structure>(structure: &S, impacts: usize, sway: Sway) -> Vec<Option<f64>> {
    let hinges = structure.hinges(impacts, sway).into_iter();
    hinges
        .filter_map(|hinge| match hinge {
            Hinge::Section { angle_rad, .. } => Some(Some(angle_rad.to_degrees())),
            Hinge::Toe(_) => None,
        })
        .collect()
}

/// The structure's unit of energy (see [`crate::dynamics::hybrid::rocking::Rocking::barrier`]) in J.
fn joules_per_unit<S: Structure>(structure: &S) -> f64 {
    structure.mass_unit_kg() * structure.length_m() * structure.length_m()
}

/// What a study was of: program, version, scenario as resolved, number of cases.
#[must_use]
pub fn study_summary(scenario: &Scenario, cases: usize) -> Value {
    json!({
        "program": env!("CARGO_PKG_NAME"),
        "version": env!("CARGO_PKG_VERSION"),
        "scenario": scenario.to_json(),
        "cases": cases,
    })
}

/// The summary of a run as JSON.
///
/// `dimensionless` has `p_rad_s` (see [`Scales`]), `p_t_p` (times the duration of the pulse) and
/// `peak_acceleration_over_incipient` (of the ground, over `g A_L`).
///
/// # Errors
/// When a value is not finite.
pub fn summary<S: Structure>(
    scenario: &Scenario,
    structure: &S,
    history: &History<'_, S>,
) -> Result<Value, OutputError> {
    let peaks = history.peak_rotations_rad.as_ref();
    finite("peak_rotation", peaks)?;
    finite("energy_defect_ratio", &[history.energy_defect_ratio])?;
    finite("outcome_time_s", &[history.outcome_time_s])?;
    let incipient_g = structure.incipient_g();
    let mut summary = json!({
        "program": env!("CARGO_PKG_NAME"),
        "version": env!("CARGO_PKG_VERSION"),
        "scenario": scenario.to_json(),
        "outcome": history.outcome.name(),
        "outcome_time_s": history.outcome_time_s,
        "overturning_sway": match history.outcome {
            Outcome::Overturned(sway) => Some(sway.name()),
            _ => None,
        },
        "impacts": history.impacts.len(),
    });
    let more = summary.as_object_mut().expect("the summary is an object");
    let keys = columns::<S::Mechanism>("peak_rotation", "rad");
    more.extend(keys.into_iter().zip(peaks.iter().map(|peak| json!(peak))));
    more.insert(
        "incipient_acceleration_g".to_owned(),
        json!({ "right": incipient_g, "left": incipient_g }),
    );
    let gravity_m_s2 = scenario.simulation.gravity_m_s2;
    if let Some(scales) = Scales::new(structure, gravity_m_s2) {
        let p_rad_s = scales.frequency_rad_s;
        let p_t_p = match &scenario.ground {
            Some(Ground::Pulse(pulse)) => Some(pulse.duration_s * p_rad_s),
            Some(Ground::Record(_)) | None => None,
        };
        let peaks_m_s2 = scenario.ground_motion().peaks_m_s2(history.end_s);
        let peak = peaks_m_s2.x / scales.incipient_m_s2;
        finite("dimensionless", &[p_rad_s, p_t_p.unwrap_or(0.0), peak])?;
        more.insert(
            "dimensionless".to_owned(),
            json!({
                "p_rad_s": p_rad_s,
                "p_t_p": p_t_p,
                "peak_acceleration_over_incipient": peak,
            }),
        );
    }
    more.insert(
        "energy_defect_ratio".to_owned(),
        json!(history.energy_defect_ratio),
    );
    if let Some(thrust) = &history.thrust {
        let shares = thrust.shares_within();
        let share = |level: usize| shares.map_or(Value::Null, |shares| json!(shares[level]));
        for (name, value) in [
            (
                "largest_thrust_excess_ratio",
                json!(thrust.largest_excess.value),
            ),
            (
                "largest_thrust_excess_time_s",
                json!(thrust.largest_excess.time_s),
            ),
            (
                "largest_friction_demand",
                json!(thrust.largest_friction.value),
            ),
            (
                "largest_friction_demand_time_s",
                json!(thrust.largest_friction.time_s),
            ),
            ("rocking_share_thrust_excess_below_0_01", share(0)),
            ("rocking_share_thrust_excess_below_0_05", share(1)),
        ] {
            more.insert(name.to_owned(), value);
        }
    }
    more.insert("evaluations".to_owned(), json!(history.cost.evaluations));
    more.insert("steps".to_owned(), json!(history.cost.steps));
    Ok(summary)
}
