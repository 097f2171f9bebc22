//! The check as JSON: every number, unrounded.

use nalgebra::Vector2;
use serde_json::{Map, Value, json};

use super::histories::{Histories, Peak};
use super::{
    Activation, ByDisplacement, Check, Margin, Mechanism, SideCheck, Simplified, Spectrum,
    StateCheck, alike, notes,
};
use crate::dynamics::demand::ground::GroundSpectrum;
use crate::output::OutputError;
use crate::scenario::Scenario;

/// All numbers of a check of a scenario.
///
/// # Errors
/// When a number is not finite, which is a bug in the program.
pub fn to_json(scenario: &Scenario, check: &Check) -> Result<Value, OutputError> {
    let states: Map<String, Value> = check
        .states
        .iter()
        .map(|one| (one.state.name().to_owned(), state(check, one)))
        .collect();
    let mechanisms: Map<String, Value> = check
        .mechanisms
        .iter()
        .map(|one| (one.sway.name().to_owned(), mechanism(check, one)))
        .collect();
    let decisions = notes::decisions(check).into_iter();
    let decisions: Vec<Value> = decisions
        .map(|(name, text)| json!({ "name": name, "text": text }))
        .collect();
    let zeta_e = check.zeta_e();
    let numbers = check.states.iter().flat_map(|one| &one.sides);
    let margins = numbers.filter_map(|side| Some(side.governing()?.1.zeta_e));
    if !margins.chain([zeta_e]).all(f64::is_finite) {
        return Err(OutputError::NotFinite {
            what: "zeta_e".to_owned(),
        });
    }
    Ok(json!({
        "program": env!("CARGO_PKG_NAME"),
        "version": env!("CARGO_PKG_VERSION"),
        "title": scenario.title(),
        "formulas": check.by_the_code().then_some("Circolare 7/2019, C8.7.1.2.1, with the spectra of NTC 2018"),
        "scenario_sha256": scenario_sha256(scenario),
        "files": scenario.files(),
        "zeta_e": zeta_e,
        "verdict": check.states.iter().map(|one| (one.state.name().to_owned(), verdict(one).into())).collect::<Map<_, _>>(),
        "confidence_factor": check.settings.confidence_factor,
        "behaviour_factor": check.settings.behaviour_factor,
        "sides": check.settings.sides.name(),
        "t0_s": check.t0_s,
        "gravity_m_s2": check.gravity_m_s2,
        "allowed_friction": check.allowed_friction,
        "mechanisms": mechanisms,
        "states": states,
        "warnings": check.warnings,
        "decisions": decisions,
        "assumptions": notes::assumptions(check),
        "not_covered": notes::not_covered(scenario, check),
        "scenario": scenario.to_json(),
    }))
}

/// SHA-256 of the scenario with every default written out, as `archrock check` prints it.
#[must_use]
pub fn scenario_sha256(scenario: &Scenario) -> String {
    crate::scenario::sha256(scenario.to_resolved_toml().as_bytes())
}

/// The verdict in a word.
pub(super) fn verdict(state: &StateCheck) -> &'static str {
    match state.governing() {
        Some((.., margin)) if margin.passes() => "passed",
        Some(_) => "not_passed",
        None => "not_checked",
    }
}

/// Sums over the bodies of a mechanism, weights in kN.
pub(super) struct Sums {
    /// The weights.
    pub(super) weight_kn: f64,
    /// The weights times the horizontal virtual displacements.
    pub(super) sway_kn: f64,
    /// The weights times their squares.
    pub(super) sway_squared_kn: f64,
    /// The weights times the vertical virtual displacements.
    pub(super) rise_kn: f64,
    /// Of what ties pull with at rest, times their lengthening.
    pub(super) held_kn: f64,
}

impl Sums {
    pub(super) fn of(mechanism: &Mechanism, gravity_m_s2: f64) -> Self {
        let sum = |term: fn(Vector2<f64>) -> f64| -> f64 {
            let bodies = mechanism.bodies.iter();
            let terms =
                bodies.map(|body| body.mass_kg * gravity_m_s2 / 1000.0 * term(body.displacement));
            terms.sum()
        };
        Self {
            weight_kn: sum(|_| 1.0),
            sway_kn: sum(|delta| delta.x),
            sway_squared_kn: sum(|delta| delta.x * delta.x),
            rise_kn: sum(|delta| delta.y),
            held_kn: {
                let ties = mechanism.ties.iter();
                let each = ties.map(|tie| tie.force_kg * tie.lengthening);
                each.sum::<f64>() * gravity_m_s2 / 1000.0
            },
        }
    }
}

fn mechanism(check: &Check, mechanism: &Mechanism) -> Value {
    let sums = Sums::of(mechanism, check.gravity_m_s2);
    let hinges = mechanism.hinges.iter().map(|placed| {
        let mut hinge = json!(placed.hinge);
        hinge["x_m"] = (placed.at_m.x + 0.0).into();
        hinge["y_m"] = (placed.at_m.y + 0.0).into();
        hinge
    });
    let bodies = mechanism.bodies.iter().map(|body| {
        json!({
            "mass_kg": body.mass_kg,
            "weight_kn": body.mass_kg * check.gravity_m_s2 / 1000.0,
            "x_m": body.centre_m.x + 0.0,
            "y_m": body.centre_m.y + 0.0,
            "delta_x": body.displacement.x,
            "delta_y": body.displacement.y,
            "rotation_per_m": body.rotation,
        })
    });
    let ties = mechanism.ties.iter().map(|tie| {
        json!({
            "force_kn": tie.force_kg * check.gravity_m_s2 / 1000.0,
            "delta_l": tie.lengthening,
        })
    });
    let participation = &mechanism.participation;
    let way = mechanism.way.as_ref().ok();
    let end = way.map(|way| *way.centre.end());
    let crown = way.and_then(|way| way.crown.as_ref());
    let yielding = way.and_then(|way| check.yielding(way));
    let curve = way.map(|way| {
        let points = way.centre.curve.iter();
        let points = points.map(|point| {
            json!([
                point.oscillator_displacement_m,
                point.oscillator_acceleration_g
            ])
        });
        points.collect::<Vec<_>>()
    });
    json!({
        "hinges": hinges.collect::<Vec<_>>(),
        "bodies": bodies.collect::<Vec<_>>(),
        "ties": ties.collect::<Vec<_>>(),
        "sum_f_delta_l_kn": sums.held_kn,
        "sum_p_kn": sums.weight_kn,
        "sum_p_delta_x_kn": sums.sway_kn,
        "sum_p_delta_x2_kn": sums.sway_squared_kn,
        "sum_p_delta_y_kn": sums.rise_kn,
        "alpha0": mechanism.alpha0,
        "moving_mass_kg": participation.moving_mass_kg,
        "e_star": participation.mass_fraction,
        "m_star_kg": participation.participating_mass_kg,
        "a0_over_fc_g": check.activation_g(mechanism),
        "d_c0_m": end.map(|end| end.displacement_m),
        "d0_m": end.map(|end| end.oscillator_displacement_m),
        "d_c0_crown_m": crown.map(|crown| crown.end().displacement_m),
        "d0_crown_m": crown.map(|crown| crown.end().oscillator_displacement_m),
        "d_y_m": yielding.map(|both| both.0),
        "a_y_over_fc_g": yielding.map(|both| both.1),
        "friction": way.map(|way| way.friction_up_to(check.furthest_part())),
        "curve_m_g": curve,
        "no_curve": mechanism.way.as_ref().err(),
    })
}

/// Whether the left side is the mirror image of the right one, with all their numbers.
pub(super) fn is_symmetric(check: &Check) -> bool {
    let [right, left] = &check.mechanisms[..] else {
        return false;
    };
    let mut mirrored = mechanism(check, left);
    let mut own = mechanism(check, right);
    for list in ["hinges", "bodies"] {
        for value in [&mut own, &mut mirrored] {
            for place in value[list].as_array_mut().into_iter().flatten() {
                // The position of a hinge says which joint or angle it is.
                for name in ["angle_deg", "edge", "toe", "joint"] {
                    place.as_object_mut().map(|place| place.remove(name));
                }
            }
        }
        if let Some(places) = mirrored[list].as_array_mut() {
            places.reverse();
            for place in places {
                place["x_m"] = (-place["x_m"].as_f64().unwrap_or(f64::NAN)).into();
            }
        }
    }
    let states = check.states.iter().all(|one| {
        let [right, left] = &one.sides[..] else {
            return false;
        };
        let histories = one.histories.as_ref().map(histories);
        let histories = histories.is_none_or(|all| are_alike(&all["right"], &all["left"]));
        are_alike(&side(right), &side(left)) && histories
    });
    states && are_alike(&own, &mirrored)
}

/// Whether two values have the same numbers, up to rounding; texts may name a side.
fn are_alike(a: &Value, b: &Value) -> bool {
    match (a, b) {
        (Value::Number(a), Value::Number(b)) => {
            a.as_f64().zip(b.as_f64()).is_some_and(|(a, b)| alike(a, b))
        }
        (Value::String(_), Value::String(_)) => true,
        (Value::Array(a), Value::Array(b)) => {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| are_alike(a, b))
        }
        (Value::Object(a), Value::Object(b)) => {
            let same = |(key, a): (&String, &Value)| b.get(key).is_some_and(|b| are_alike(a, b));
            a.len() == b.len() && a.iter().all(same)
        }
        _ => a == b,
    }
}

fn state(check: &Check, one: &StateCheck) -> Value {
    let sides = one
        .sides
        .iter()
        .map(|each| (each.sway.name().to_owned(), side(each)));
    let mut state = json!({
        "verdict": verdict(one),
        "zeta_e": one.governing().map(|(.., margin)| margin.zeta_e),
        "side": one.governing_side(),
        "method": one.governing().map(|(_, method, _)| method.name()),
        "demand": demand(check, one),
        "rule": one.rule,
        "histories": one.histories.as_ref().map(histories),
    });
    if let Some(state) = state.as_object_mut() {
        state.extend(sides);
    }
    state
}

fn histories(one: &Histories) -> Value {
    let records = one.records.iter().map(|record| {
        let [right, left] = record.peaks;
        let peak = |peak: Peak| {
            let peak_m = (!peak.overturned && !peak.incomplete).then_some(peak.displacement_m);
            json!({ "peak_m": peak_m, "overturned": peak.overturned, "incomplete": peak.incomplete })
        };
        json!({
            "file": record.file,
            "crc32": format!("{:08x}", record.checksum),
            "peak_g": record.peak_g,
            "right": peak(right),
            "left": peak(left),
        })
    });
    let sides = one.sides.iter().map(|side| {
        let told = json!({
            "restitution": side.restitution,
            "demand_m": side.demand_m,
            "mean_interval_m": side.mean_interval_m,
            "capacity_m": side.capacity_m,
            "capacity_over_fc_m": side.capacity_over_fc_m,
            "d0_m": side.d0_m,
            "records_beyond_d0": side.exceeded[0],
            "records_beyond_d0_over_fc": side.exceeded[1],
            "passed": side.passes[0],
            "passed_over_fc": side.passes[1],
        });
        (side.sway.name().to_owned(), told)
    });
    let mut value = json!({
        "demand": if one.is_mean() { "mean of the peaks" } else { "largest peak" },
        "passed": one.passes()[0],
        "passed_over_fc": one.passes()[1],
        "incomplete": one.incomplete(),
        "records": records.collect::<Vec<_>>(),
        "mean_spectrum": {
            "from_s": one.periods_s[0],
            "to_s": one.periods_s[1],
            "least_ratio": one.spectrum_ratios.map(|ratios| ratios[0]),
            "largest_ratio": one.spectrum_ratios.map(|ratios| ratios[1]),
            "fits": one.fits_the_spectrum(),
        },
    });
    if let Some(value) = value.as_object_mut() {
        value.extend(sides);
    }
    value
}

fn demand(check: &Check, one: &StateCheck) -> Value {
    match &one.spectrum {
        Spectrum::Ground(ground) => parameters(check, ground),
        Spectrum::Floor(ground, floor) => {
            let mut demand = parameters(check, ground);
            let damping = one.rule.map_or(5.0, |rule| rule.damping_percent);
            let modes = floor.modes.iter().map(|mode| {
                json!({
                    "t_s": mode.t_s,
                    "damping_percent": mode.damping_percent,
                    "gamma": mode.gamma,
                    "psi": mode.psi,
                    "acceleration_g": ground.acceleration_g(mode.t_s, mode.damping_percent),
                    "a_z_g": mode.peak_g(ground),
                    "f": mode.amplification(damping),
                })
            });
            demand["modes"] = modes.collect();
            demand["a_z_g"] = floor.peak_g().into();
            demand
        }
        Spectrum::Points(points) => json!({
            "spectrum": points.spectrum,
            "damping_percent": points.damping_percent,
            "points_s_g": points.points.points(),
        }),
    }
}

fn parameters(check: &Check, ground: &GroundSpectrum) -> Value {
    json!({
        "soil": ground.site.soil.name(),
        "ag_g": ground.hazard.ag_g,
        "f0": ground.hazard.f0,
        "tc_star_s": ground.hazard.tc_star_s,
        "s_s": ground.s_s,
        "s_t": ground.site.topographic_factor,
        "s": ground.s(),
        "c_c": ground.c_c,
        "t_b_s": ground.t_b_s,
        "t_c_s": ground.t_c_s,
        "t_d_s": ground.t_d_s,
        "t_e_s": ground.t_e_s,
        "peak_g": ground.peak_g(),
        "peak_displacement_m": ground.peak_displacement_m(check.gravity_m_s2),
    })
}

fn side(side: &SideCheck) -> Value {
    json!({
        "zeta_e": side.governing().map(|(_, margin)| margin.zeta_e),
        "activation": side.activation.as_ref().map(activation),
        "simplified": side.simplified.as_ref().map(simplified),
        "displacement": side.displacement.as_ref().map(displacement),
    })
}

fn with_margin(mut value: Value, margin: &Margin) -> Value {
    value["ag_capacity_g"] = margin.ag_capacity_g.into();
    value["ag_g"] = margin.ag_g.into();
    value["zeta_e"] = margin.zeta_e.into();
    value["passed"] = margin.passes().into();
    value
}

fn activation(one: &Activation) -> Value {
    let value = json!({ "capacity_g": one.capacity_g, "demand_g": one.demand_g });
    with_margin(value, &one.margin)
}

fn simplified(one: &Simplified) -> Value {
    let value = json!({ "activation_ag_g": one.activation_ag_g, "q": one.behaviour_factor });
    with_margin(value, &one.margin)
}

fn displacement(one: &ByDisplacement) -> Value {
    let value = json!({
        "reached_m": one.reached_m,
        "capacity_m": one.capacity_m,
        "acceleration_g": one.acceleration_g,
        "period_s": one.period_s,
        "demand_m": one.demand_m,
        "resonance_m": one.resonance_m,
        "demand_acceleration_g": one.demand_g,
        "by_displacement_ag_g": one.displacement.ag_capacity_g,
        "activation_governs": one.activation_ag_g.is_some(),
        "ag_capacity_following_g": one.ag_following_g,
        "zeta_e_crown": one.zeta_e_crown,
    });
    with_margin(value, &one.margin)
}
