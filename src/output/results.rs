//! `impacts.csv` and `summary.json` of a run.

use std::io::Write;

use serde_json::{Value, json};

use super::rotations::columns;
use super::{OutputError, finite};
use crate::dynamics::history::{History, ImpactEvent, Outcome};
use crate::mechanics::arch::Arch;
use crate::mechanics::linkage::Linkage;
use crate::mechanics::structure::Structure;
use crate::scenario::Scenario;

/// Writes one row per impact.
///
/// The mechanism after is the one that the impact leads to, with the energy that it would keep, also where
/// that is so little that the arch comes to rest. Where no mechanism can follow the hinges are left empty.
///
/// The impulses at its hinges act on the part towards the crown, in the frame of the ground; they are empty
/// where the restitution coefficient is prescribed.
///
/// # Errors
/// When the system refuses, or a value is not finite.
pub fn write_impacts(
    writer: impl Write,
    arch: &Arch,
    impacts: &[ImpactEvent<'_, Arch>],
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
        header.extend(columns::<Linkage>("rate", &format!("{moment}_rad_s")));
    }
    header.extend(["a", "b", "c", "d"].map(|hinge| format!("hinge_{hinge}_deg")));
    header.extend(
        ["a", "b", "c", "d"].into_iter().flat_map(|hinge| {
            ["x", "y"].map(|component| format!("impulse_{hinge}_{component}_n_s"))
        }),
    );
    csv.write_record(header).map_err(OutputError::csv(WHAT))?;

    let joule = arch.mass_unit_kg() * arch.length_m() * arch.length_m();
    for (index, impact) in impacts.iter().enumerate() {
        let (before, after) = impact.energies();
        let (rates_before, rates_after) = impact.rates_rad_s();
        let sway_after = impact.sway_before.opposite();
        let hinges_deg = arch.chain.link(impact.impacts).map_or([None; 4], |link| {
            let hinges = link
                .mechanism
                .hinges_from_left(arch.chain.ring(), sway_after);
            hinges.map(|(angle_rad, _)| Some(angle_rad.to_degrees()))
        });
        let unit_n_s = arch.mass_unit_kg() * arch.length_m() * impact.rate_before_rad_s.abs();
        let impulses_n_s = arch
            .chain
            .link(impact.impacts)
            .and_then(|link| link.impulse_line.as_ref())
            .map_or([[None; 2]; 4], |line| {
                line.hinge_impulses_from_left(sway_after)
                    .map(|impulse| [impulse.x, impulse.y].map(|force| Some(force * unit_n_s)))
            });
        let restitution = impact.after.map_or(0.0, |link| link.restitution);
        let energies = [before * joule, after * joule];
        finite("of a row of impacts.csv", &[impact.time_s, restitution])?;
        finite("of a row of impacts.csv", &energies)?;
        finite(
            "of a row of impacts.csv",
            &[rates_before, rates_after].concat(),
        )?;
        let known: Vec<f64> = impulses_n_s.into_iter().flatten().flatten().collect();
        finite("of a row of impacts.csv", &known)?;
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

/// The summary of a run as JSON.
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
