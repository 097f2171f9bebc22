//! The check in a few lines.

use std::fmt::Write as _;

use super::summary::verdict;
use super::{Check, Histories, Method, StateCheck, notes};
use crate::mechanics::sway::Sway;
use crate::scenario::LimitState;

/// The result for each limit state, with the governing side.
#[must_use]
pub fn words(check: &Check) -> String {
    let mut text = String::new();
    if check.by_the_code() {
        text += "local mechanisms by Circolare 7/2019, C8.7.1.2.1, spectra of NTC 2018\n";
    } else {
        text += "local mechanisms, spectra by points: no clause is named\n";
    }
    for mechanism in &check.mechanisms {
        let _ = write!(
            text,
            "  to the {:5}  alpha0 {:.5}  e* {:.5}  a0/FC {:.5} g",
            mechanism.sway.name(),
            mechanism.alpha0,
            mechanism.participation.mass_fraction,
            check.activation_g(mechanism)
        );
        match &mechanism.way {
            Ok(way) => {
                let end = way.centre.end();
                let _ = writeln!(text, "  d0 {:.5} m", end.oscillator_displacement_m);
            }
            Err(why) => {
                let _ = writeln!(text, "  no capacity curve: {why}");
            }
        }
    }
    for state in &check.states {
        text += &state_in_words(state);
    }
    let _ = writeln!(
        text,
        "zeta_E {:.5}, the least of the states asked for",
        check.zeta_e()
    );
    for warning in notes::warnings(check) {
        let _ = writeln!(text, "warning: {warning}");
    }
    text
}

/// Name of a limit state as engineers write it.
pub(super) fn name(state: LimitState) -> String {
    state.name().to_uppercase()
}

/// A verdict in words.
fn passed(verdict: &str) -> &'static str {
    match verdict {
        "passed" => "passed",
        "not_passed" => "not passed",
        _ => "not checked",
    }
}

/// The clause of a method, or what the method does.
pub(super) const fn of_method(method: Method) -> &'static str {
    match method {
        Method::Activation => "activation",
        Method::Simplified => "q times activation",
        Method::Displacement => "displacement",
    }
}

fn state_in_words(state: &StateCheck) -> String {
    let name = name(state.state);
    let Some((worse, method, margin)) = state.governing() else {
        return format!("{name}  not checked: there is no capacity curve\n");
    };
    let mut text = format!(
        "{name}  {}: zeta_E {:.5} to the {}, by {}\n",
        passed(verdict(state)),
        margin.zeta_e,
        worse.name(),
        of_method(method)
    );
    for side in &state.sides {
        let to = Sway::name(side.sway);
        if let Some(one) = &side.activation {
            let _ = writeln!(
                text,
                "  to the {to:5}  activation: a0/FC {:.5} g, demand {:.5} g, zeta_E {:.5}",
                one.capacity_g, one.demand_g, one.margin.zeta_e
            );
        }
        if let Some(one) = &side.displacement {
            let _ = write!(
                text,
                "  to the {to:5}  displacement: d {:.5} m, T {:.4} s, demand {:.5} m, zeta_E {:.5}",
                one.capacity_m, one.period_s, one.demand_m, one.displacement.zeta_e
            );
            if one.activation_ag_g.is_some() {
                let _ = write!(
                    text,
                    "; the activation counts, zeta_E {:.5}",
                    one.margin.zeta_e
                );
            }
            text.push('\n');
        }
        if let Some(one) = &side.simplified {
            let _ = writeln!(
                text,
                "  to the {to:5}  q {} times activation: a_g {:.5} g, zeta_E {:.5}",
                one.behaviour_factor,
                one.margin.ag_capacity_g.unwrap_or_default(),
                one.margin.zeta_e
            );
        }
    }
    if let Some(histories) = &state.histories {
        text += &in_histories(histories);
    }
    text
}

fn in_histories(histories: &Histories) -> String {
    let counted = if histories.is_mean() {
        "mean"
    } else {
        "largest"
    };
    let mut text = String::new();
    for side in &histories.sides {
        let demand = match side.demand_m {
            Some(demand_m) => {
                let spread = side.mean_interval_m.map_or(String::new(), |[low, high]| {
                    format!(" (95 %: {low:.5} to {high:.5} m)")
                });
                let count = histories.records.len();
                format!("{counted} of {count} peaks {demand_m:.5} m{spread}")
            }
            None => "overturns".to_owned(),
        };
        let _ = writeln!(
            text,
            "  to the {:5}  histories: {demand}, allowed {:.5} m ({:.5} m over FC), d0 exceeded by {} ({}): {}",
            side.sway.name(),
            side.capacity_m,
            side.capacity_over_fc_m,
            side.exceeded[0],
            side.exceeded[1],
            in_passes(side.passes)
        );
    }
    text
}

/// Whether histories pass as they are and with FC, in words.
pub(super) const fn in_passes(passes: [bool; 2]) -> &'static str {
    match passes {
        [true, true] => "passed",
        [true, false] => "passed without FC only",
        [false, _] => "not passed",
    }
}
