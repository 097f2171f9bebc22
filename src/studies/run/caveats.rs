//! Caveats of a history, for words, warnings, the verdict and the answer to quote. They follow from its summary.

use askama::Template;

use super::summary::{FourLinkQuality, RunSummary, Thrust};
use crate::Verdict;
use crate::dynamics::{EXCESS_LEVELS, OutcomeKind};
use crate::output::filters;
use crate::scenario::FREE_HINGES;
use crate::studies::quotable::{MOST_FRICTION, condition_of};

/// Coefficient of friction as text.
pub(super) fn coefficient(friction: &f64) -> String {
    match *friction > MOST_FRICTION {
        true => format!("more than {MOST_FRICTION}"),
        false => format!("{friction:.3}"),
    }
}

/// Largest coefficient of friction as text.
pub(super) fn largest_coefficient(friction: &f64) -> String {
    let bound = if *friction > MOST_FRICTION {
        ""
    } else {
        "at most "
    };
    bound.to_owned() + &coefficient(friction)
}

/// A caveat.
#[derive(Template)]
#[template(path = "studies/run/words/caveat.txt")]
pub(super) enum Caveat<'a> {
    /// The run ends too early for a verdict.
    NoVerdict(&'a RunSummary),
    /// A motion without slip needs more friction than stone may have.
    Friction(String),
    /// The thrust line leaves the arch, which four links cannot follow.
    FourLinks {
        thrust: Thrust,
        quality: FourLinkQuality,
        /// True in words, false in warnings, which are one line.
        in_words: bool,
        /// True if free hinges are compared already.
        is_compared: bool,
    },
    /// The ground cannot pull a column down, as it would have to at this time, in seconds.
    FliesOff(f64),
    /// The opposite outcome, and the properties with which it occurs.
    Changed(Verdict, Vec<&'a str>),
    /// Properties with which the motion has no verdict.
    Unknown(Vec<&'a str>),
}

impl RunSummary {
    /// Limits of the history, as warnings.
    pub(super) fn caveats(&self) -> Vec<String> {
        let excess = self.limits(false).filter(|limits| match limits {
            // An arch moves as four links as long as its thrust line stays almost inside.
            Caveat::FourLinks { thrust, .. } => {
                thrust.largest_thrust_excess_ratio > EXCESS_LEVELS[1]
            }
            _ => true,
        });
        let caveats = [self.no_verdict(), excess, self.friction_condition()];
        caveats.iter().flatten().map(Caveat::to_string).collect()
    }

    /// Reason why a run has no verdict, and the remedy; `None` for a complete run.
    pub(super) fn no_verdict(&self) -> Option<Caveat<'_>> {
        let is_incomplete = self.outcome.outcome == OutcomeKind::Incomplete;
        is_incomplete.then_some(Caveat::NoVerdict(self))
    }

    /// Friction that a motion without slip needs; `None` if stone certainly has it.
    pub(super) fn friction_condition(&self) -> Option<Caveat<'_>> {
        condition_of(self.friction_demand).map(Caveat::Friction)
    }

    /// Limits of four links, or of a column on its toe; `None` for rows, if the structure did not rock, and for a column that never needs
    /// tension at its base.
    pub(super) fn limits(&self, in_words: bool) -> Option<Caveat<'_>> {
        let thrust = self.mechanisms.as_ref()?.thrust?;
        thrust.rocking_share_thrust_excess_below_0_05?;
        match thrust.four_links {
            Some(quality) => Some(Caveat::FourLinks {
                thrust,
                quality,
                in_words,
                is_compared: self.is_compared_with(&FREE_HINGES),
            }),
            None => (thrust.largest_thrust_excess_ratio > 0.0)
                .then_some(Caveat::FliesOff(thrust.largest_thrust_excess_time_s)),
        }
    }

    /// Opposite outcome and the properties with which it occurs; `None` if no property changes the outcome.
    pub(super) fn changed_outcome(&self) -> Option<Caveat<'_>> {
        let opposite = match self.verdict_without_repetitions() {
            Verdict::Overturns => Verdict::Survives,
            Verdict::Survives => Verdict::Overturns,
            _ => return None,
        };
        let names = self.variations_with(opposite);
        (!names.is_empty()).then_some(Caveat::Changed(opposite, names))
    }

    /// Properties with which the motion has no verdict; `None` if it has one with all.
    pub(super) fn without_verdict(&self) -> Option<Caveat<'_>> {
        let names = self.variations_with(Verdict::Incomplete);
        (!names.is_empty()).then_some(Caveat::Unknown(names))
    }

    fn variations_with(&self, verdict: Verdict) -> Vec<&str> {
        let varied = self
            .variations
            .iter()
            .filter(|one| one.verdict() == verdict);
        varied.map(|one| one.with.as_str()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_coefficient_that_no_stone_has_is_no_upper_bound() {
        assert_eq!(largest_coefficient(&0.5746), "at most 0.575");
        assert_eq!(largest_coefficient(&28.24), "more than 10");
    }
}
