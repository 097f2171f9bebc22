//! The report of a check: the numbers in JSON, and words, notes and a page that prints on A4 as templates.
//!
//! Every number of the page is a rounded number of the [`VerifySummary`], in an element `data` that holds the full value.

use std::collections::BTreeMap;

use askama::Template;
use askama::filters::Safe;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::histories::{FOR_THE_MEAN, SPECTRUM_MARGIN};
use super::{
    CheckVerdict, CheckedMechanism, ComparedPeak, Decision, FRICTION, FloorMode, FloorOrdinates,
    GoverningSide, HighestPoint, Histories, Method, PlacedHinge, SlidingCheck, Spectrum,
    StateCheck, VerifySummary, equal_numbers, picture,
};
use crate::clock;
use crate::dynamics::MODEL_LIMIT;
use crate::dynamics::demand::damping_factor;
use crate::output::{Figure, OutputError, filters, render, render_in};
use crate::scenario::{
    CONFIDENCE_FACTOR, CheckedSides, FreeStanding, Language, LimitState, Scenario, StateRule,
};
use crate::studies::report::{Report, Warnings};
use crate::studies::{Results, no_verdict};
use crate::{Hinge, Sway};

/// Names of the files, the seal last.
pub const FILES: [&str; 2] = ["verify.html", "verify.json"];
/// Gravity of the codes, in m/s2.
const GRAVITY_M_S2: f64 = 9.81;
/// A smaller damping in per cent is probably given as a fraction.
const LEAST_DAMPING_PERCENT: f64 = 1.0;
/// Largest number of points of a spectrum on the page.
const MOST_POINTS: usize = 40;

/// Makes page, numbers and words of a check.
///
/// # Errors
/// When a value is not finite.
pub fn report(scenario: &Scenario, check: &VerifySummary) -> Result<Results, OutputError> {
    let today = clock::since_1970().map(|since| date_of(since.as_secs() / 86_400));
    let page = VerifyPage::new(scenario, check, today);
    let results = Results::of("verify.json", check)?.with_file("verify.html", page.html());
    Ok(results.in_order(&FILES))
}

/// Verdict in a sentence, then the result for each limit state, with the governing side.
pub fn words(check: &VerifySummary) -> String {
    render(check)
}

/// The verdict in a sentence.
#[derive(Template)]
#[template(
    source = "{% import \"studies/verify/sentence.txt\" as verdict %}{% call verdict::sentence(check, false) %}{% endcall %}",
    ext = "txt"
)]
struct Sentence<'a> {
    check: &'a VerifySummary,
}

impl Report for VerifySummary {
    const IS_TABLE: bool = true;

    fn verdict(&self) -> String {
        render(&Sentence { check: self }).trim().to_owned()
    }

    fn warnings(&self) -> &Warnings {
        &self.warnings
    }
}

/// The printed page.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Template)]
#[template(path = "studies/verify/page.html")]
pub struct VerifyPage {
    /// The check.
    pub check: VerifySummary,
    /// Date of the check, such as 2025-01-31; `None` if it is unknown.
    pub date: Option<String>,
    /// Pictures of the printed sides: one if the left side is the mirror image of the right one.
    pub pictures: BTreeMap<Sway, SidePictures>,
    /// The scenario with every default written out.
    pub resolved: String,
}

/// The pictures of a side, as SVG.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SidePictures {
    /// The mechanism.
    pub mechanism: String,
    /// The capacity curve; `None` if there is none.
    pub curve: Option<String>,
}

/// Makes the HTML of a page again from its JSON.
///
/// # Errors
/// When the JSON is not that of a [`VerifyPage`].
pub fn page_of(json: &str) -> serde_json::Result<String> {
    serde_json::from_str(json).map(|page: VerifyPage| page.html())
}

impl VerifyPage {
    /// Makes the page of a check.
    pub fn new(scenario: &Scenario, check: &VerifySummary, date: Option<String>) -> Self {
        let mut figure: Figure = "78mm".parse().expect("a width of a figure");
        figure.decimal_mark = check.language.decimal_mark();
        let drawn = |(sway, mechanism): (&Sway, _)| {
            let pictures = SidePictures {
                mechanism: picture::mechanism(
                    figure,
                    check.language,
                    &scenario.structure,
                    *sway,
                    mechanism,
                ),
                curve: picture::capacity(figure, check, *sway, mechanism),
            };
            (*sway, pictures)
        };
        let printed = check.mechanisms.iter().take(check.printed_sides());
        Self {
            check: check.clone(),
            date,
            pictures: printed.map(drawn).collect(),
            resolved: scenario.to_resolved_toml(),
        }
    }

    /// Page as HTML.
    pub fn html(&self) -> String {
        render_in(self, self.check.language)
    }

    /// Category of the subsoil; empty without spectra of the code.
    fn soil(&self) -> &'static str {
        let mut grounds = self.check.states.values();
        let ground = grounds.find_map(|one| one.demand.ground());
        ground.map_or("", |ground| ground.spectrum.soil.name())
    }

    /// Modes of the building with their ordinates.
    fn modes<'a>(
        &self,
        state: &'a StateCheck,
        at: &'a FloorOrdinates,
    ) -> impl Iterator<Item = (&'a FloorMode, &'a f64)> {
        let modes = match &state.demand {
            Spectrum::Floor { modes, .. } => modes.as_slice(),
            Spectrum::Ground(_) | Spectrum::Points { .. } => &[],
        };
        modes.iter().zip(&at.modes_g)
    }

    /// Every fifth point of a capacity curve in rows of three, which continue downwards.
    fn curve_rows(&self, one: &CheckedMechanism) -> Vec<Vec<[f64; 2]>> {
        let points: Vec<[f64; 2]> = one.curve_m_g.iter().flatten().step_by(5).copied().collect();
        let rows = points.len().div_ceil(3).max(1);
        let row = |row| points.iter().skip(row).step_by(rows).copied().collect();
        (0..rows).map(row).collect()
    }

    /// Hinges with their letters on the picture.
    fn hinge_letters<'a>(
        &self,
        one: &'a CheckedMechanism,
    ) -> impl Iterator<Item = (char, &'a PlacedHinge)> {
        ('A'..='Z').zip(&one.hinges)
    }

    /// Factor for the damping of a mechanism.
    fn eta(&self, rule: &StateRule) -> f64 {
        damping_factor(rule.damping_percent)
    }

    fn is_on_floor(&self) -> bool {
        let mut states = self.check.states.values();
        states.any(|one| matches!(one.demand, Spectrum::Floor { .. }))
    }
}

impl StateCheck {
    /// True if the result of this method to this side governs: the page prints it in bold.
    fn governs(&self, sway: &Sway, method: &Method) -> bool {
        let side = self.side.map_or("", super::GoverningSide::name);
        self.method.as_ref() == Some(method) && ["either", sway.name()].contains(&side)
    }

    /// Comparison with the slide of joints, if it governs.
    fn governing_slide(&self) -> Option<SlidingCheck> {
        let mut sides = self.sides.iter();
        let governs = |(sway, _): &(&Sway, _)| self.governs(sway, &Method::Sliding);
        sides.find(governs)?.1.sliding
    }
}

/// Names of sides, points and compared peaks, in English and in Italian.
const WORDS: [[&str; 2]; 8] = [
    ["right", "destra"],
    ["left", "sinistra"],
    ["crown", "chiave"],
    ["top", "sommità"],
    ["intrados", "intradosso"],
    ["extrados", "estradosso"],
    ["mean of the peaks", "media dei massimi"],
    ["largest peak", "massimo maggiore"],
];

/// The printed words.
#[derive(Template)]
#[template(path = "studies/verify/words.txt")]
struct Words<'a> {
    check: &'a VerifySummary,
}

impl Words<'_> {
    /// Side in a column of equal width.
    fn padded_side(&self, sway: &Sway) -> String {
        let to = self.check.language.choose("to the", "verso");
        let width = match self.check.language {
            Language::English => 5,
            Language::Italian => 8,
        };
        format!("{to} {:<width$}", self.check.word(sway.name()))
    }
}

impl VerifySummary {
    /// Words of the check.
    pub(super) fn words(&self) -> String {
        render_in(&Words { check: self }, self.language)
    }

    /// Word of [`WORDS`] in the language of the check, and any other text unchanged.
    fn word<'a>(&self, english: &'a str) -> &'a str {
        let known = WORDS.iter().find(|[word, _]| *word == english);
        known.map_or(english, |[_, italian]| {
            self.language.choose(english, italian)
        })
    }

    /// Number of printed sides.
    fn printed_sides(&self) -> usize {
        if self.is_symmetric {
            1
        } else {
            self.mechanisms.len()
        }
    }

    /// Printed sides to which joints slide first.
    pub(super) fn sliding_sides(&self) -> Vec<(&Sway, &CheckedMechanism)> {
        let printed = self.mechanisms.iter().take(self.printed_sides());
        printed.filter(|(_, one)| one.sliding.is_some()).collect()
    }

    /// Limit states with this verdict.
    pub(super) fn states_with(&self, verdict: CheckVerdict) -> Vec<(&LimitState, &StateCheck)> {
        let states = self.states.iter();
        states.filter(|(_, one)| one.verdict == verdict).collect()
    }

    /// Limit states with a result.
    pub(super) fn checked(&self) -> Vec<(&LimitState, &StateCheck)> {
        let states = self.states.iter();
        states.filter(|(_, one)| one.zeta_e.is_some()).collect()
    }

    /// Clause of a formula; empty if clauses are not cited.
    fn clause(&self, clause: &str) -> Safe<String> {
        let cited = format!(" <span class=\"clause\">[{clause}]</span>");
        Safe(self.formulas.as_ref().map_or_else(String::new, |_| cited))
    }
}

/// The reason why there is no `zeta_E`.
#[derive(Template)]
#[template(
    source = "{% import \"studies/verify/sentence.txt\" as verdict %}{% call verdict::because(check) %}{% endcall %}",
    ext = "txt"
)]
struct NoRatio<'a> {
    check: &'a VerifySummary,
}

/// The notes, one per line, in four paragraphs.
#[derive(Template)]
#[template(
    source = "{% match check.language %}{% when Language::English %}{% include \"studies/verify/notes.txt\" %}\
              {% when Language::Italian %}{% include \"studies/verify/notes.it.txt\" %}{% endmatch %}",
    ext = "txt"
)]
struct Notes<'a> {
    check: &'a VerifySummary,
    /// Keys of records whose histories are not computed, because joints slide first.
    unused_records: &'a [&'static str],
}

impl Notes<'_> {
    fn no_verdict(&self, histories: &Histories) -> Option<String> {
        no_verdict(histories.incomplete, histories.records.len(), "records")
    }

    fn has_curve(&self) -> bool {
        let mut mechanisms = self.check.mechanisms.values();
        mechanisms.any(|one| one.curve_m_g.is_some())
    }

    fn has_constant_forces(&self) -> bool {
        let mut mechanisms = self.check.mechanisms.values();
        mechanisms.any(|one| !one.forces.is_empty())
    }

    fn slides(&self) -> bool {
        !self.check.sliding_sides().is_empty()
    }

    fn has_histories(&self) -> bool {
        let mut states = self.check.states.values();
        states.any(|one| one.histories.is_some())
    }
}

/// Adds decisions, assumptions, gaps and warnings to a check, and the reason if it has no `zeta_E`. `unused_records` are
/// the keys of records whose histories are not computed.
pub(super) fn add_notes(check: &mut VerifySummary, unused_records: &[&'static str]) {
    if check.zeta_e.is_none() {
        let why = render_in(&NoRatio { check }, check.language);
        check.no_zeta_e_because = Some(why.trim().to_owned());
    }
    let notes = Notes {
        check,
        unused_records,
    };
    let text = render_in(&notes, check.language);
    let mut parts = text.split("\n\n").map(|part| {
        let lines = part.lines().skip(1).map(str::to_owned);
        lines.collect::<Vec<String>>()
    });
    let mut part = || parts.next().unwrap_or_default();
    let decisions = (1..).zip(part()).map(|(number, text)| Decision {
        name: format!("D{number}"),
        text,
    });
    check.decisions = decisions.collect();
    check.assumptions = part();
    check.not_covered = part();
    check.warnings.extend(part());
}

/// True if the left side is the mirror image of the right one, including all numbers. Hinges and bodies of a stack are in the same order to both sides.
pub(super) fn are_mirrored(
    is_stack: bool,
    mechanisms: &BTreeMap<Sway, CheckedMechanism>,
    states: &BTreeMap<LimitState, StateCheck>,
) -> bool {
    let both = [Sway::Right, Sway::Left].map(|sway| mechanisms.get(&sway));
    let [Some(right), Some(left)] = both else {
        return false;
    };
    let mut mirrored = left.clone();
    if !is_stack {
        mirrored.hinges.reverse();
        mirrored.bodies.reverse();
    }
    let hinges = mirrored.hinges.iter_mut().map(|hinge| &mut hinge.x_m);
    let bodies = mirrored.bodies.iter_mut().map(|body| &mut body.x_m);
    let positions = mirrored.positions.iter_mut().flat_map(|at| {
        if !is_stack {
            at.hinges_m.reverse();
            at.centres_m.reverse();
        }
        let points_m = at.hinges_m.iter_mut().chain(&mut at.centres_m);
        points_m.map(|point_m| &mut point_m.x)
    });
    let all = hinges.chain(bodies).chain(positions);
    all.for_each(|x_m| *x_m = -*x_m);
    let mut own = right.clone();
    // Joints, blocks and angles of hinges differ between mirrored sides, so the comparison uses positions only.
    for one in [&mut own, &mut mirrored] {
        (one.hinges.iter_mut()).for_each(|hinge| hinge.hinge = Hinge::Toe(Sway::Right));
        one.bodies.iter_mut().for_each(|body| body.blocks = None);
    }
    let states = states.values().all(|one| {
        let histories = one.histories.as_ref().map(|all| &all.sides);
        are_alike(&one.sides[&Sway::Right], &one.sides[&Sway::Left])
            && histories.is_none_or(|sides| are_alike(&sides[&Sway::Right], &sides[&Sway::Left]))
    });
    states && are_alike(&own, &mirrored)
}

/// True if two results have the same numbers, up to rounding errors. Texts may differ: they may name a side.
fn are_alike<T: Serialize>(a: &T, b: &T) -> bool {
    fn alike_values(a: &Value, b: &Value) -> bool {
        match (a, b) {
            (Value::Number(a), Value::Number(b)) => a
                .as_f64()
                .zip(b.as_f64())
                .is_some_and(|(a, b)| equal_numbers(a, b)),
            (Value::String(_), Value::String(_)) => true,
            (Value::Array(a), Value::Array(b)) => {
                a.len() == b.len() && a.iter().zip(b).all(|(a, b)| alike_values(a, b))
            }
            (Value::Object(a), Value::Object(b)) => {
                a.len() == b.len() && a.values().zip(b.values()).all(|(a, b)| alike_values(a, b))
            }
            _ => a == b,
        }
    }
    alike_values(&json!(a), &json!(b))
}

/// Date a number of days after 1 January 1970, such as 2025-01-31.
fn date_of(days: u64) -> String {
    // Years that begin in March end with the leap day (Hinnant, chrono-Compatible Low-Level Date Algorithms).
    let days = days + 719_468;
    let (era, day) = (days / 146_097, days % 146_097);
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let day = day - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    let year = year + 400 * era + u64::from(month <= 2);
    format!("{year}-{month:02}-{day:02}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_those_of_the_calendar() {
        for (days, date) in [
            (0, "1970-01-01"),
            (58, "1970-02-28"),
            (59, "1970-03-01"),
            (789, "1972-02-29"),
            (11_016, "2000-02-29"),
            (20_088, "2024-12-31"),
            (20_089, "2025-01-01"),
        ] {
            assert_eq!(date_of(days), date);
        }
    }
}
