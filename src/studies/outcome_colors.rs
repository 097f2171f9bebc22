//! Colours of outcomes, the same in all pictures.

use super::ending::columns::{
    CANNOT_STAND, FAILED, GROUND_FALLS, NOT_FOUR_LINKS, OVERTURNED, UNCERTAIN,
};
use super::ending::{Ending, NoHistory, outcome_name};
use crate::Outcome;
use crate::output::page::SpotKind;
use crate::output::{Key, Sign, color};

/// Colour of results with the same kind of outcome.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct OutcomeColor {
    pub(crate) name: &'static str,
    pub(crate) label: &'static str,
    pub(crate) fill: &'static str,
}

/// Surviving cases, by their largest rotation over the critical one: darker colours came closer to overturning.
const SURVIVED: [OutcomeColor; 6] = [
    OutcomeColor::new("survived-0", "survives, peak below 20 %", "#e3eef9"),
    OutcomeColor::new("survived-20", "below 40 %", "#c1d9ed"),
    OutcomeColor::new("survived-40", "below 60 %", "#8fc1de"),
    OutcomeColor::new("survived-60", "below 80 %", "#539dcc"),
    OutcomeColor::new("survived-80", "below 100 %", "#2171b5"),
    OutcomeColor::new("survived-100", "beyond the critical rotation", "#08306b"),
];

impl OutcomeColor {
    pub(crate) const fn new(name: &'static str, label: &'static str, fill: &'static str) -> Self {
        Self { name, label, fill }
    }

    /// The colour of a case that survived with this largest rotation over the critical one.
    pub(crate) fn survived(peak_over_critical: f64) -> Self {
        let bounds = [0.2, 0.4, 0.6, 0.8, 1.0];
        SURVIVED[bounds.partition_point(|bound| *bound <= peak_over_critical)]
    }

    /// In the order of the legend.
    pub(crate) const ALL: [Self; 21] = [
        Self::new(Outcome::NeverMoved.name(), "never moves", "#b0b0b0"),
        Self::new(
            Outcome::Vibrates.name(),
            "vibrates without opening",
            "#dfe8c8",
        ),
        Self::new(
            Outcome::Rest.name(),
            "comes to rest",
            SpotKind::Survives.fill(),
        ),
        SURVIVED[0],
        SURVIVED[1],
        SURVIVED[2],
        SURVIVED[3],
        SURVIVED[4],
        SURVIVED[5],
        Self::new(Outcome::StillRocking.name(), "still rocking", "#6f8ba0"),
        Self::new("overturned-0", "overturns without impact", color::VERMILION),
        Self::new("overturned-1", "overturns after 1 impact", color::ORANGE),
        Self::new("overturned-2", "overturns after 2 impacts", "#f0e442"),
        Self::new("overturned-more", "overturns after more", color::PURPLE),
        Self::new(OVERTURNED, "overturns", SpotKind::Overturns.fill()),
        Self::new(
            Outcome::Incomplete.name(),
            "ends too early for a verdict",
            "#8c7aa0",
        ),
        Self::new(
            UNCERTAIN,
            "uncertain whether it overturns",
            SpotKind::Uncertain.fill(),
        ),
        Self::new(CANNOT_STAND, "cannot stand", "#ffffff"),
        Self::new(NOT_FOUR_LINKS, "not four links", "#c8bfae"),
        Self::new(GROUND_FALLS, "the ground falls freely", "#d9cfe8"),
        Self::new(FAILED, "failed", color::BLACK),
    ];

    /// Colour of a case.
    pub(crate) fn of_result(result: &Result<Ending, NoHistory>) -> Self {
        let ending = result.as_ref().ok();
        let impacts = ending.and_then(Ending::impacts_of_all_hinges);
        Self::of(outcome_name(result), impacts)
    }

    /// Colour of an outcome. It depends on the number of impacts before overturning if all hinges close at once;
    /// landings of free hinges come in cascades, and their number does not matter.
    pub(crate) fn of(outcome: &str, impacts: Option<usize>) -> Self {
        let name = match (outcome, impacts) {
            (OVERTURNED, Some(0)) => "overturned-0",
            (OVERTURNED, Some(1)) => "overturned-1",
            (OVERTURNED, Some(2)) => "overturned-2",
            (OVERTURNED, Some(_)) => "overturned-more",
            (outcome, _) => outcome,
        };
        let known = Self::ALL.into_iter().find(|color| color.name == name);
        known.unwrap_or(Self::ALL[Self::ALL.len() - 1])
    }
}

/// The legend entries of the colours of a palette that are present.
pub(crate) fn keys(palette: &[OutcomeColor], colors: &[OutcomeColor]) -> Vec<Key> {
    let present = palette.iter().filter(|color| colors.contains(color));
    present
        .map(|color| Key::new(color.label, Sign::Band(color.fill, 1.0)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Colour in the CIELAB space (D65): lightness, green to red, and blue to yellow.
    fn lab(fill: &str) -> [f64; 3] {
        let channel = |at: usize| {
            let value = f64::from(u8::from_str_radix(&fill[at..at + 2], 16).unwrap()) / 255.0;
            if value <= 0.040_45 {
                value / 12.92
            } else {
                ((value + 0.055) / 1.055).powf(2.4)
            }
        };
        let [r, g, b] = [1, 3, 5].map(channel);
        let part = |value: f64| {
            if value > 0.008_856 {
                value.cbrt()
            } else {
                7.787 * value + 16.0 / 116.0
            }
        };
        let x = part((0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.9505);
        let y = part(0.2126 * r + 0.7152 * g + 0.0722 * b);
        let z = part((0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.089);
        [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
    }

    /// Colours of neighbouring outcomes in maps differ visibly.
    #[test]
    fn outcomes_without_overturning_differ_in_colour() {
        let quiet = [
            "never_moved",
            "vibrates",
            "rest",
            "still_rocking",
            "incomplete",
        ];
        let labs = quiet.map(|name| lab(OutcomeColor::of(name, None).fill));
        for (index, one) in labs.iter().enumerate() {
            for (other, name) in labs[..index].iter().zip(quiet) {
                let squares = one.iter().zip(other).map(|(a, b)| (a - b) * (a - b));
                let apart = squares.sum::<f64>().sqrt();
                assert!(apart > 18.0, "{} {name}: {apart}", quiet[index]);
            }
        }
    }

    #[test]
    fn no_colour_means_two_outcomes() {
        let fills: std::collections::BTreeSet<_> =
            OutcomeColor::ALL.iter().map(|color| color.fill).collect();
        assert_eq!(fills.len(), OutcomeColor::ALL.len());
    }
}
