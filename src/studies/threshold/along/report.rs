//! Report and files of thresholds along a key.

use askama::Template;
use serde::{Deserialize, Serialize};

use super::{Along, AlongOptions, AlongRow, KeyRange, Point, picture};
use crate::argument::plain;
use crate::dynamics::Direction;
use crate::output::page::SpotKind;
use crate::output::{OutputError, Table, column, fields};
use crate::studies::page::{CaseScenario, Page, PageCases, input_in_words};
use crate::studies::quotable::{
    self, ModelAnswer, SlipWords, SurvivorFriction, directions_in_words, restitution_in_words,
};
use crate::studies::report::{Report, Warnings};
use crate::studies::threshold::report::lower_in_words;
use crate::studies::threshold::{Factors, format_edge, rounded_down, rounded_edge};
use crate::studies::{
    CaseSummary, ModelCheck, NoAnswer, Remark, Remarks, Results, Style, no_verdict,
};

/// Report on the threshold for each value of a key.
#[derive(Serialize, Deserialize, Template)]
#[template(path = "studies/threshold/along/words.txt")]
pub struct AlongSummary {
    #[serde(flatten)]
    all: CaseSummary,
    /// The answer that may be quoted, in words: the least of all values.
    to_quote: Option<String>,
    /// Number of values without a verdict, because their histories end too early.
    values_without_verdict: usize,
    /// The key and its values.
    along: KeyRange,
    /// The tried factors.
    factors: Factors,
    /// True if the factor that overturns the structure before any impact was requested.
    no_impact: bool,
    /// The threshold for each value.
    values: Vec<Point>,
}

const SUMMARY: &str = "threshold_along.json";

/// Names of the files, the seal last.
pub(super) const FILES: [&str; 4] = [
    "threshold_along.html",
    "threshold_along.svg",
    SUMMARY,
    "threshold_along.csv",
];

impl Along<'_> {
    /// Makes the report and the other files of all rows.
    pub(super) fn report(&self, rows: &[AlongRow], style: Style) -> Result<Results, OutputError> {
        let incomplete = |row: &&AlongRow| row.edge == Err(NoAnswer::Incomplete);
        let remarks = self.remarks(rows);
        let values_without_verdict = rows.iter().filter(incomplete).count();
        let limits = limits(&remarks, values_without_verdict, rows.len());
        let AlongOptions {
            along,
            factors,
            no_impact,
        } = self.options.clone();
        let edges = rows.iter().filter_map(|row| row.edge.as_ref().ok());
        let demands = edges.map(|edge| edge.friction_demand);
        let study = format!("threshold FILE --along {along}{}", factors.options());
        let survivors = (study.as_str(), "surviving motions");
        let friction = SurvivorFriction::of(demands, self.scenario, survivors);
        let condition = SlipWords::of(self.scenario).condition(friction.friction_demand, &study);
        let answer = self.answer(rows).with_friction(condition);
        let report = AlongSummary {
            all: CaseSummary::new(
                (self.scenario, &self.options.varied()),
                rows.len(),
                remarks,
                friction,
                limits,
            ),
            to_quote: quotable::quote_answers(&[answer]),
            values_without_verdict,
            along,
            factors,
            no_impact,
            values: rows.iter().map(Point::of).collect(),
        };
        let key = report.along.key.as_str();
        let mut columns = vec![column(key, |point: &Point| point.value)];
        columns.extend(fields!(
            |point: &Point| point => survives_up_to_factor, survives_up_to_g, overturns_from_factor,
            overturns_from_g, at_most, uncertain_from_factor, tried_to_factor, failed_beyond, no_impact_factor, no_impact_g,
            thrust_excess_ratio, friction_demand
        ));
        columns.push(column("direction", |point: &Point| {
            point.direction.map(Direction::name)
        }));
        columns.push(column("why_not", |point: &Point| point.why_not.clone()));
        let title = self
            .scenario
            .title
            .as_deref()
            .unwrap_or("Threshold of overturning");
        let mut cases = PageCases::default();
        let text = cases.add_text(&self.scenario.to_json(), false);
        for row in rows {
            self.add_case(&mut cases, row, text);
        }
        let draw = |figure, spots: &[_]| picture::draw(figure, (title, key), &report.values, spots);
        let results = Results::of(SUMMARY, &report)?
            .with_table("threshold_along.csv", Table::new(columns, &report.values)?)
            .with_file("threshold_along.svg", draw(style.figure, &[]));
        let factors = &report.factors;
        let own = format!(
            "{}. Stronger motions are not searched for",
            factors.in_words()
        );
        let what = input_in_words(&[self.scenario]);
        let mut page = Page::new(title, what, &[&own], &[self.scenario.motion.kind]);
        page.command = factors.command();
        let marked = |figure| draw(figure, &cases.spots);
        let results = results.with_page("threshold_along.html", page, &cases, (&marked, &[]));
        Ok(results.in_order(&FILES))
    }
}

/// Limits of the model, and the number of values without a verdict, in words.
fn limits(
    remarks: &Remarks,
    without_verdict: usize,
    values: usize,
) -> impl Iterator<Item = String> + use<> {
    let no_verdict = no_verdict(without_verdict, values, "values");
    let limits = [remarks.model.in_words("thresholds"), no_verdict];
    limits.into_iter().flatten()
}

impl Along<'_> {
    /// Adds the threshold of a value to a page, whose text with this index is the scenario.
    fn add_case(&self, cases: &mut PageCases, row: &AlongRow, text: usize) {
        let (mark, words) = match &row.edge {
            Ok(edge) => {
                let [safe, first] = rounded_edge([edge.survives_up_to, edge.factor]);
                let overturns = match edge.at_most {
                    true => "certainly overturns from at most",
                    false => "certainly overturns from",
                };
                let parts = [
                    ("survives up to", safe),
                    ("UNCERTAIN from", edge.uncertain_from.map(format_edge)),
                    (overturns, first),
                ]
                .into_iter()
                .filter_map(|(what, at)| Some(format!("{what} factor {}", at?)));
                let words = parts.collect::<Vec<_>>().join("; ");
                let words = match edge.direction {
                    Direction::AsGiven => words,
                    Direction::Mirrored => words + "; under the mirrored ground motion",
                };
                ((edge.spot_kind(), edge.is_outside_model()), words)
            }
            Err(why) => ((SpotKind::Unknown, false), why.reason().to_owned()),
        };
        let words = format!("{} {}: {words}", self.options.along.key, plain(row.value));
        cases.push(mark, words, || {
            self.variant(row.value).ok()?;
            Some(CaseScenario::of(
                text,
                [(&self.options.along.key, row.value)],
            ))
        });
    }

    /// Answer that may be quoted: the least strength of all values.
    fn answer(&self, rows: &[AlongRow]) -> ModelAnswer {
        let (scenario, along) = (self.scenario, &self.options.along);
        let known: Option<Vec<_>> = rows
            .iter()
            .map(|row| {
                let edge = row.edge.as_ref().ok()?;
                Some((edge.survives_up_to? * row.peak_g?, row.value, edge))
            })
            .collect();
        let least = known
            .into_iter()
            .flatten()
            .min_by(|a, b| a.0.total_cmp(&b.0));
        let answer = least.map(|(safe_g, value, edge)| {
            let stiffness = match scenario.motion.kind.has_stiffness {
                false => "",
                true => ", other stiffness and contact unknown",
            };
            let directions = match scenario.ground_motion().has_horizontal() {
                true => directions_in_words(scenario.simulation.direction, edge.direction),
                false => "",
            };
            format!(
                "survives up to {} g{stiffness}{directions}{}, the lowest of {} values of {} (at {})",
                rounded_down(safe_g),
                lower_in_words(edge.tried_from),
                rows.len(),
                along.key,
                plain(value)
            )
        });
        let edges = rows.iter().flat_map(|row| &row.edge);
        let excess_ratio = edges.filter_map(|edge| edge.thrust_excess_ratio);
        let variant = least.and_then(|(_, value, _)| self.variant(value).ok());
        let answer = answer.ok_or_else(|| {
            format!(
                "not every value of {} certainly survives the smallest factor tried",
                along.key
            )
        });
        let is_arch = scenario.structure.has_horizontal_thrust();
        let kind = scenario.motion.kind;
        ModelAnswer::new(kind, is_arch, excess_ratio.reduce(f64::max), answer)
            .with_restitution(variant.as_ref().and_then(restitution_in_words))
            .unless_uncertain(scenario.uncertain.is_some())
    }

    /// Values without an answer, with the reasons.
    fn remarks(&self, rows: &[AlongRow]) -> Remarks {
        let edges = rows.iter().flat_map(|row| &row.edge);
        let mut remarks = Remarks::default();
        remarks.model = ModelCheck::of(edges.map(|edge| edge.thrust_excess_ratio));
        for row in rows {
            let case = format!("{} = {}", self.options.along.key, plain(row.value));
            if let Err(NoAnswer::Invalid(reason) | NoAnswer::Failed(reason)) = &row.edge {
                remarks.failures.push(Remark::new(case, reason));
            } else if let Some(Err(reason)) = &row.no_impact {
                remarks
                    .failures
                    .push(Remark::new(case + ", without impact", reason));
            }
        }
        remarks
    }
}

impl Report for AlongSummary {
    fn verdict(&self) -> String {
        let KeyRange { key, from, to, .. } = &self.along;
        let (from, to) = (plain(*from), plain(*to));
        let (values, ranges) = (self.all.cases, self.ranges());
        format!("{values} values of {key} from {from} to {to}: {ranges}")
    }

    fn quote(&self) -> Option<&str> {
        self.to_quote.as_deref()
    }

    fn warnings(&self) -> &Warnings {
        &self.all.warnings
    }
}

impl AlongSummary {
    /// Ranges of the thresholds, and the numbers of values without one, in words.
    fn ranges(&self) -> String {
        let points = &self.values;
        // The lowest and the highest acceleration, with their values.
        let ends = |of: fn(&Point) -> Option<f64>| {
            let known = points
                .iter()
                .filter_map(|point| Some((of(point)?, point.value)));
            let least = known.clone().min_by(|a, b| a.0.total_cmp(&b.0));
            [least, known.max_by(|a, b| a.0.total_cmp(&b.0))]
        };
        let range =
            |what: &str, ends: [Option<(f64, f64)>; 2], [low, high]: [Option<String>; 2]| {
                let [least, most] = ends.map(|end| Some(plain(end?.1)));
                let (least, most, low, high) = (least?, most?, low?, high?);
                Some(format!(
                    "{what} {low} g (lowest, at {least}) and {high} g (highest, at {most})"
                ))
            };
        let safe = ends(|point| point.survives_up_to_g);
        let first = ends(|point| point.overturns_from_g);
        let edge = |end: usize| rounded_edge([safe, first].map(|ends| Some(ends[end]?.0)));
        let ([safe_low, first_low], [safe_high, first_high]) = (edge(0), edge(1));
        // Where the smallest factor tried overturns it already, the threshold is an upper bound.
        let bounded = |in_g: Option<String>, end: Option<(f64, f64)>| {
            let (_, at) = end?;
            let is_bound = points
                .iter()
                .any(|point| point.value == at && point.at_most);
            Some(format!(
                "{}{}",
                if is_bound { "at most " } else { "" },
                in_g?
            ))
        };
        let [least, most] = first;
        let first_in_g = [bounded(first_low, least), bounded(first_high, most)];
        let count = |what: &str, at: fn(&&Point) -> bool| {
            let count = points.iter().filter(at).count();
            let values = ["value", "values"][usize::from(count > 1)];
            (count > 0).then(|| format!("{what} at {count} {values}"))
        };
        let no_impact = || {
            let ends = ends(|point| point.no_impact_g);
            let in_g = ends.map(|end| Some(format_edge(end?.0)));
            let words = range("without impact overturns from", ends, in_g);
            words.unwrap_or_else(|| "no factor overturns it without impact".to_owned())
        };
        let parts = [
            range("survives up to", safe, [safe_low, safe_high]),
            count("not certain to survive the smallest factor", |point| {
                point.tried_to_factor.is_some() && point.survives_up_to_g.is_none()
            }),
            count("uncertain above", |point| {
                point.uncertain_from_factor.is_some()
            }),
            range("certainly overturns from", first, first_in_g),
            count("no factor certainly overturns it", |point| {
                let reached = point.tried_to_factor.is_some() && !point.failed_beyond;
                reached && point.overturns_from_g.is_none()
            }),
            count(
                "not known beyond the factor from which on the ground falls freely or the model fails,",
                |point| point.failed_beyond,
            ),
            count("the mirrored ground motion governs", |point| {
                point.direction == Some(Direction::Mirrored)
            }),
            count("no verdict", |point| point.why_not.is_some()),
            self.no_impact.then(no_impact),
        ];
        parts.into_iter().flatten().collect::<Vec<_>>().join("; ")
    }
}
