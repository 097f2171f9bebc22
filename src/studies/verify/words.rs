//! The check in a few lines.

use std::fmt::Write as _;

use super::summary::verdict;
use super::{Check, EITHER, Histories, HistorySide, Method, StateCheck};
use crate::mechanics::sway::Sway;
use crate::scenario::LimitState;

/// The verdict in a sentence, then the result for each limit state, with the governing side.
#[must_use]
pub fn words(check: &Check) -> String {
    let mut text = verdict_sentence(check, |zeta_e| format!("zeta_E {zeta_e:.5}")) + "\n\n";
    if check.by_the_code() {
        text += "local mechanisms by Circolare 7/2019, C8.7.1.2.1, spectra of NTC 2018\n";
    } else {
        text += "local mechanisms, spectra by points: no clause is named\n";
    }
    for place in &check.tie_places {
        let _ = writeln!(text, "  {place}");
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
        "zeta_E {:.5}, the least of the checked states: {}",
        check.zeta_e(),
        names(check.checked())
    );
    for warning in &check.warnings {
        let _ = writeln!(text, "warning: {warning}");
    }
    text
}

/// Which states pass, which do not and which are not checked, each with its `zeta_E` in the given form.
pub(super) fn verdict_sentence(check: &Check, number: impl Fn(f64) -> String) -> String {
    let list = |wanted: &str| {
        let states = check.states.iter().filter(|one| verdict(one) == wanted);
        let named = states.map(|one| {
            let zeta_e = one.governing().map(|(.., margin)| number(margin.zeta_e));
            name(one.state) + &zeta_e.map_or(String::new(), |zeta_e| format!(" ({zeta_e})"))
        });
        enumerated(
            named.collect(),
            if wanted == "not_passed" { "or" } else { "and" },
        )
    };
    let clauses = [
        (list("not_passed"), "does not pass "),
        (list("passed"), "passes "),
    ];
    let clauses: Vec<String> = clauses
        .into_iter()
        .filter_map(|(list, does)| Some(does.to_owned() + &list?))
        .collect();
    let mut sentence = format!("The structure {}.", clauses.join("; it "));
    if let Some(rest) = list("not_checked") {
        sentence += &format!(" Not checked: {rest}.");
    }
    sentence
}

/// Names of limit states in a list.
pub(super) fn names(states: impl Iterator<Item = LimitState>) -> String {
    enumerated(states.map(name).collect(), "and").unwrap_or_default()
}

/// Items with commas and a last `and` or `or`; `None` without any.
fn enumerated(mut items: Vec<String>, last_link: &str) -> Option<String> {
    let last = items.pop()?;
    Some(if items.is_empty() {
        last
    } else {
        format!("{} {last_link} {last}", items.join(", "))
    })
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

/// Name of a method in words.
pub(super) const fn of_method(method: Method) -> &'static str {
    match method {
        Method::Activation => "activation",
        Method::Simplified => "q times activation",
        Method::Displacement => "displacement",
    }
}

fn state_in_words(state: &StateCheck) -> String {
    let name = name(state.state);
    let (Some((_, method, margin)), Some(side)) = (state.governing(), state.governing_side())
    else {
        return format!("{name}  not checked: there is no capacity curve\n");
    };
    let mut text = format!(
        "{name}  {}: zeta_E {:.5} to {}, by {}\n",
        passed(verdict(state)),
        margin.zeta_e,
        if side == EITHER {
            "either side".to_owned()
        } else {
            format!("the {side}")
        },
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
            if let (Some(start_g), Some(ag_g)) = (one.activation_ag_g, one.margin.ag_g) {
                let _ = write!(
                    text,
                    "; the activation counts: a_g {start_g:.5} g, demand {ag_g:.5} g, zeta_E {:.5}",
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
            None => without_demand(side).to_owned(),
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
pub(super) const fn in_passes(passes: [Option<bool>; 2]) -> &'static str {
    match passes {
        [Some(true), Some(true)] => "passed",
        [Some(true), Some(false)] => "passed without FC only",
        [Some(false), _] => "not passed",
        [None, Some(false)] => "not passed with FC, no verdict without",
        [_, None] | [None, Some(true)] => NO_VERDICT,
    }
}

/// Why histories to a side have no demand, in words.
pub(super) const fn without_demand(side: &HistorySide) -> &'static str {
    if side.overturned {
        "overturns"
    } else {
        NO_VERDICT
    }
}

/// In place of the peak of a history that ended too early, and of what depends on it.
pub(super) const NO_VERDICT: &str = "no verdict";
