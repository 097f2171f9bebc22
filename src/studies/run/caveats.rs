//! Caveats of a history, in sentences for words, warnings and the verdict.

use crate::dynamics::peak::Peak;
use crate::dynamics::thrust::{EXCESS_LEVELS, MODEL_LIMIT};
use crate::scenario::{Scenario, Structure};
use crate::{Model, Outcome, Summary as History};

/// Rotations up to this value are printed as zero: such a block slides without rocking.
pub(super) const STRAIGHT_RAD: f64 = 5e-7;

/// Smallest and largest coefficient of friction of stone on stone.
pub(super) const STONE_FRICTION: [f64; 2] = [0.5, 0.8];

/// Returns the peak of the first half cycle that rocks, in radians.
pub(super) fn first_peak_rad(history: &History) -> Option<f64> {
    let cycles = history.half_cycles().into_iter();
    let mut peaks = cycles.map(|cycle| cycle.peak_rad);
    peaks.find(|peak_rad| *peak_rad > STRAIGHT_RAD)
}

/// Returns warnings about a run: unlikely numbers of its scenario, and limits of its history. The texts name no options, because the Python
/// package prints them too.
pub fn warnings(scenario: &Scenario, model: &dyn Model, history: &History) -> Vec<String> {
    let mut warnings = scenario.unlikely_of(Some(model));
    let structure = &scenario.structure;
    // The ground cannot pull a column down. An arch moves as four links as long as its thrust line stays almost inside.
    let thrusts = structure.has_horizontal_thrust();
    let most = if thrusts { EXCESS_LEVELS[1] } else { 0.0 };
    let of_mechanisms = model.as_mechanisms().and(history.thrust.as_ref());
    let leaves = of_mechanisms.is_some_and(|thrust| thrust.largest_excess.value > most);
    warnings.extend(no_verdict(scenario, history));
    let advice = Some("compare with free hinges");
    if leaves && let Some(limits) = four_link_limits(history, structure, advice) {
        warnings.push(limits.join(" "));
    }
    warnings.extend(friction_condition(scenario, history));
    warnings
}

/// Returns the reason why a run has no verdict, and the remedy; `None` for a complete run.
pub(super) fn no_verdict(scenario: &Scenario, history: &History) -> Option<String> {
    let (end_s, ground_s) = (history.end_s, scenario.ground_motion().end_s());
    let why = if end_s < ground_s {
        format!("the run ends at {end_s:.4} s and the ground moves until {ground_s:.4} s")
    } else {
        format!(
            "at {end_s:.4} s, the end of the run, it moves with more than a quarter of the energy that overturns it"
        )
    };
    let is_incomplete = history.outcome == Outcome::Incomplete;
    is_incomplete.then(|| format!("NO VERDICT: {why}; give a longer duration_s in [simulation]"))
}

/// Returns the time since which elastic joints that still move at the end only vibrate, in s; `None` for other outcomes.
pub(super) fn vibrates_since_s(history: &History) -> Option<f64> {
    let moves = history.outcome == Outcome::StillRocking;
    history.elastic().filter(|_| moves)?.vibrates_since_s
}

/// Returns a coefficient of friction as text. Values above 10, which no stone has, occur at almost unloaded joints.
pub(super) fn coefficient(friction: f64, decimals: usize) -> String {
    if friction > 10.0 {
        "more than 10".to_owned()
    } else {
        format!("{friction:.decimals$}")
    }
}

/// Returns the friction that a motion without sliding needs; `None` if stone certainly has it.
pub(super) fn friction_condition(scenario: &Scenario, history: &History) -> Option<String> {
    let needed = history.thrust.as_ref()?.required_friction();
    let [low, high] = STONE_FRICTION;
    if scenario.motion.options.friction_coefficient().is_some() || needed <= low {
        return None;
    }
    Some(if needed > high {
        let needed = coefficient(needed, 2);
        format!("would slide: needs a friction of {needed}, and stone has {low} to {high}")
    } else {
        format!("needs a friction of {needed:.2}")
    })
}

/// Returns a conjunction and the quality of four links, for an excess of the thrust line in thicknesses, and for the excess up to the largest rotation.
fn quality(excess_ratio: f64, up_to_peak: Option<f64>) -> [&'static str; 2] {
    if up_to_peak.is_some_and(|ratio| ratio > MODEL_LIMIT) {
        ["but", "outside the model of four links"]
    } else if excess_ratio <= EXCESS_LEVELS[0] {
        ["and", "four links suffice"]
    } else if excess_ratio <= EXCESS_LEVELS[1] {
        ["and", "four links are close"]
    } else {
        ["but", "four links are a rough guide"]
    }
}

/// Returns the quality of four links of an arch that rocked.
pub(super) fn four_link_quality(scenario: &Scenario, history: &History) -> Option<String> {
    let is_arch = scenario.structure.has_horizontal_thrust();
    let four = !scenario.motion.kind.has_joints && is_arch;
    let thrust = history.thrust.as_ref().filter(|_| four)?;
    thrust.shares_within()?;
    let excess_ratio = thrust.largest_excess.value;
    Some(quality(excess_ratio, history.thrust_excess_ratio()).join(" "))
}

/// Returns the limits of four links, or of a column on its toe, in parts of a sentence, with `advice` if four links are not enough. `None` if
/// the structure did not rock; empty for a column that never needs tension at its base.
pub(super) fn four_link_limits(
    history: &History,
    structure: &Structure,
    advice: Option<&str>,
) -> Option<Vec<String>> {
    let thrust = history.thrust.as_ref()?;
    let [_, near] = thrust.shares_within()?;
    let Peak { value, time_s } = thrust.largest_excess;
    let [close, most] = EXCESS_LEVELS;
    if !structure.has_horizontal_thrust() {
        let flies = format!(
            "the ground would have to hold the column down (at {time_s:.4} s): it flies off"
        );
        return Some(Vec::from_iter((value > 0.0).then_some(flies)));
    }
    let [_, quality] = quality(value, history.thrust_excess_ratio());
    if value <= close {
        return Some(vec![format!(
            "{quality}: the thrust line leaves the arch by {value:.4} t at most"
        )]);
    }
    let above = value > most;
    let safe = if above { ", not on the safe side" } else { "" };
    let give = match structure.circular() {
        Some(arch) if arch.voussoirs.is_none() => "give `voussoirs` and ",
        _ => "",
    };
    let compare = advice.map_or(String::new(), |advice| format!("; {give}{advice}"));
    Some(vec![
        format!(
            "{quality}{safe}: the thrust line leaves the arch by up to {value:.3} t (at {time_s:.4} s),"
        ),
        format!(
            "and stays within {most} t for {:.1} % of the rocking time{compare}",
            100.0 * near
        ),
    ])
}
