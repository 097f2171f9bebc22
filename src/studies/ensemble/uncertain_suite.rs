//! Fragility of an uncertain structure: the intensity from which each record of a suite overturns each sample. It separates scatter due to
//! records from scatter due to uncertain numbers.

use askama::Template;
use serde::{Deserialize, Serialize};

use super::influence::InfluencedAnswer;
use super::page::{SAMPLES, SamplePage};
use super::report::{self, SampleSummary, answer_column, why_not};
use super::uncertain_threshold::{StrengthBand, first_strength};
use super::{NoAnswer, SampleCases, SampleRow, Samples};
use crate::dynamics::{Direction, Directions};
use crate::output::page::SpotKind;
use crate::output::{Chart, Figure, Key, Mark, OutputError, Scale, Stroke, Table, color, column};
use crate::scenario::{Measure, Scenario, Suite, Varied, shown};
use crate::studies::intervals::{FRACTILES, FractileIntervals};
use crate::studies::quotable::{
    self, ModelAnswer, SlipWords, SurvivorFriction, directions_in_words,
};
use crate::studies::report::{Report, Warnings};
use crate::studies::statistics::{ascending_weighted, shares_up_to, weighted_fractile};
use crate::studies::suite::strength::warning_of_few_records;
use crate::studies::suite::{OF_LEVELS, case, directions, records_in_words};
use crate::studies::threshold::first_edge::{FirstEdge, TREATMENTS, Treatment, TriedHistory};
use crate::studies::threshold::{format_edge, rounded_range};
use crate::studies::{Ending, ModelCheck, Results, Study, Style};

const TITLE: &str = "Fragility with uncertain data";
/// Relative width to which bisection encloses an intensity: much less than the scatter between records.
const WIDTH: f64 = 2e-3;

/// The study of the capacities of each sample under the records of a suite.
#[derive(Clone, Debug)]
pub struct Capacities<'a> {
    cases: SampleCases<'a>,
    suite: Suite,
    directions: Directions,
    levels: Vec<f64>,
}

const NO_LEVELS: &str =
    "[suite] has no levels, among which each sample overturns; give `scales` or `peaks_g`";

/// The first edge of a sample under each record; in both directions, the mirrored record follows its record. A sample without a second direction has
/// the same edge twice.
type EdgePerRecord = Vec<FirstEdge>;

impl<'a> Capacities<'a> {
    /// Makes the study of a scenario with the tables `[suite]` and `[uncertain]`.
    ///
    /// # Errors
    /// Returns the change that the scenario needs, in words.
    pub fn of(scenario: &'a Scenario) -> Result<Self, String> {
        scenario.check_from_rest("suite")?;
        let suite = scenario.suite.as_ref();
        let suite = suite.ok_or("the scenario has no [suite], whose records shake the samples")?;
        Ok(Self {
            cases: SampleCases::of(scenario)?,
            levels: suite.levels.as_ref().ok_or(NO_LEVELS)?.values(),
            suite: suite.clone(),
            directions: scenario.simulation.direction,
        })
    }

    fn answer(&self, scenario: &Scenario) -> Result<EdgePerRecord, NoAnswer> {
        let model = scenario.model().map_err(NoAnswer::without_model)?;
        let edge = |record: usize, direction: Direction| {
            FirstEdge::find_among(&self.levels, WIDTH, |level: f64| {
                let (ground, request) = case(scenario, &self.suite, record, level, direction);
                let ending = Ending::of(&*model, &ground, &request)?;
                Ok(TriedHistory::from(Ending {
                    direction,
                    ..ending
                }))
            })
        };
        let mut edges = EdgePerRecord::new();
        for record in 0..self.suite.records.len() {
            for direction in directions(scenario, &self.suite, &*model) {
                edges.push(edge(record, *direction)?);
            }
            while !edges.len().is_multiple_of(self.signs()) {
                edges.extend(edges.last().cloned());
            }
        }
        Ok(edges)
    }

    /// Number of edges of each record.
    fn signs(&self) -> usize {
        1 + usize::from(self.directions == Directions::Both)
    }

    /// Name and the sign of each record, in the order of the answers.
    fn records_and_signs(&self) -> impl Iterator<Item = (&str, i64)> {
        let signs: &[_] = match self.directions {
            Directions::Both => &[1, -1],
            Directions::AsGiven => &[1],
            Directions::Mirrored => &[-1],
        };
        let records = self.suite.records.iter();
        records.flat_map(move |series| signs.iter().map(|sign| (series.name.as_str(), *sign)))
    }

    /// Answer that may be quoted: median and dispersion over records and samples. `excess_ratio` is the largest excess of the thrust line, and
    /// `demand` the largest friction demand.
    fn quotable_answer(
        &self,
        samples: &Samples<'_, EdgePerRecord>,
        both: &Estimated,
        excess_ratio: Option<f64>,
        demand: Option<f64>,
    ) -> ModelAnswer {
        let scenario = samples.scenario;
        let answer = match (both.median, both.dispersion) {
            (Some(_), Some(_)) => Ok(format!(
                "overturns with 50 % at {} {}, dispersion {} (95 %){OF_LEVELS}, over {} and {} samples{}",
                self.suite.measure.name(),
                estimated(&both.median, &both.median_interval, self.suite.measure.unit()),
                estimated(&both.dispersion, &both.dispersion_interval, ""),
                records_in_words(self.suite.records.len()),
                samples.answers().count(),
                directions_in_words(self.directions, Direction::AsGiven)
            )),
            _ => Err("too few records and samples overturn for a median and a dispersion; add higher levels".to_owned()),
        };
        let is_arch = scenario.structure.has_horizontal_thrust();
        let answer = ModelAnswer::new(scenario.motion.kind, is_arch, excess_ratio, answer);
        answer.with_friction(SlipWords::of(scenario).condition(demand, "suite FILE"))
    }

    /// Makes the table of all edges.
    fn table(&self, samples: &Samples<'_, EdgePerRecord>) -> Result<Table, OutputError> {
        type Row<'a> = (usize, &'a str, i64, &'a FirstEdge);
        let mut rows: Vec<Row<'_>> = Vec::new();
        for (number, row) in samples.lines() {
            let edges = row.answer.iter().flatten().zip(self.records_and_signs());
            rows.extend(edges.map(|(edge, (record, sign))| (number, record, sign, edge)));
        }
        let mut columns = vec![
            column("sample", |row: &Row<'_>| row.0),
            column("record", |row: &Row<'_>| shown(row.1)),
            column("sign", |row: &Row<'_>| row.2),
        ];
        columns.extend(FirstEdge::columns("intensity", |row: &Row<'_>| Some(row.3)));
        Table::new(columns, &rows)
    }

    /// Draws the share that overturns against the intensity: for the scenario itself under all records, for each sample, and for all samples
    /// together.
    fn draw(&self, figure: Figure, samples: &Samples<'_, EdgePerRecord>) -> String {
        const MOST_FAINT: usize = 20;
        const FAINT: Stroke = Stroke::new("#b9d3e8", 0.9, "");
        const ALL: Stroke = Stroke::new(color::BLUE, 1.6, "");
        const OWN: Stroke = Stroke::new(color::BLACK, 1.4, "6 4");
        let ends =
            [self.levels.first(), self.levels.last()].map(|level| level.copied().unwrap_or(1.0));
        let x = Scale::logarithmic(0.95 * ends[0], 1.05 * ends[1]);
        let steps = |name, stroke, edges: Vec<&FirstEdge>| {
            let strengths = |edge: &FirstEdge| edge.strengths(TREATMENTS[0]);
            let rises = shares_up_to(edges.into_iter().flat_map(strengths));
            Mark::staircase(name, stroke, (x, 0.0), rises)
        };
        let single = samples
            .answers()
            .take(MOST_FAINT)
            .map(|edges| steps("sample", FAINT, edges.iter().collect()));
        let mut marks: Vec<Mark> = single.collect();
        marks.push(steps("both", ALL, samples.answers().flatten().collect()));
        if let Ok(own) = samples.own {
            marks.push(steps("own", OWN, own.iter().collect()));
        }
        let label = self.suite.measure.name().replace('_', " ");
        let y_axis = ("share that overturns", Scale::exactly(0.0, 1.0, 5));
        let chart = Chart {
            keys: vec![
                Key::line("all samples and records", ALL),
                Key::line("single samples", FAINT),
                Key::line("the scenario itself, from record to record", OWN),
            ],
            marks,
            ..Chart::new(405.0, (&label, x), y_axis)
        };
        chart.draw(figure, samples.title(TITLE))
    }
}

impl Study for Capacities<'_> {
    type Row = SampleRow<EdgePerRecord>;

    const NAME: &'static str = "uncertain_suite";

    const FILES: &'static [&'static str] = &[
        SAMPLES,
        "fragility.svg",
        "matters.svg",
        "fragility.csv",
        "capacities.csv",
        "samples.csv",
        "uncertain.json",
    ];

    fn base(&self) -> Option<&Scenario> {
        Some(self.cases.scenario)
    }

    fn count(&self) -> usize {
        self.cases.count()
    }

    fn rows(&self, cases: &[usize]) -> Vec<Self::Row> {
        self.cases.rows(cases, |scenario, _| self.answer(scenario))
    }

    fn results(
        &self,
        rows: Vec<Self::Row>,
        Style { figure, .. }: Style,
    ) -> Result<Results, OutputError> {
        let samples = &Samples::new(self.cases, &rows);
        let counted = EdgesThatCount::new(self, samples);
        // Influence on the median over the records of a sample; the largest level if fewer than half of the records overturn the sample.
        let most = self.levels.last().copied().unwrap_or(1.0);
        let inside = |edge: &&FirstEdge| !edge.is_outside_model();
        let median = |edges: &EdgePerRecord| {
            let median = first_strength(edges.iter().filter(inside), 0.5);
            median.map_or(most, |(strength, _)| strength.min(most))
        };
        let influences = [(
            InfluencedAnswer::MedianIntensity,
            samples.influence(false, median),
        )];
        let edges = counted.sample_edges();
        let model = ModelCheck::of(edges.clone().map(|edge| edge.thrust_excess_ratio));
        let edges = edges.filter(|edge| !edge.is_outside_model());
        let demands = edges.clone().map(|edge| edge.friction_demand);
        let survivors = ("suite FILE", "surviving motions of samples");
        let friction = SurvivorFriction::of(demands, samples.scenario, survivors);
        let limits = (CHECKED, samples.no_verdict());
        let fragility = counted.fragilities();
        let excess = edges.clone().filter_map(|edge| edge.thrust_excess_ratio);
        let demand = friction.friction_demand;
        let quoted =
            self.quotable_answer(samples, &fragility.both, excess.reduce(f64::max), demand);
        let report = UncertainSuiteSummary {
            all: SampleSummary::new(
                (samples, &Varied::default()),
                model,
                friction,
                limits,
                influences,
            ),
            intensity: self.suite.measure,
            to_quote: quotable::quote_answers(std::slice::from_ref(&quoted)),
            quote: "both".to_owned(),
            first_intensity: StrengthBand::of(edges.clone()),
            own_first_intensity: StrengthBand::of(counted.scenario_edges()),
            fragility,
            records: self.suite.records.len(),
            edges: edges.clone().count(),
            at_lowest_level: edges.filter(|edge| edge.at_most).count(),
        };
        let overturned =
            |edges: &EdgePerRecord| edges.iter().filter(|edge| edge.factor.is_some()).count();
        let columns = [answer_column("overturned", overturned), why_not()];
        let results = Results::of("uncertain.json", &report)?
            .with_table("samples.csv", report::table(samples, columns)?)
            .with_table("capacities.csv", self.table(samples)?)
            .with_table("fragility.csv", counted.table_of_levels()?)
            .with_file("fragility.svg", self.draw(figure, samples))
            .with_file("matters.svg", report.all.draw_influences(samples, figure));
        let answer = |edges: &EdgePerRecord| {
            let median =
                first_strength(edges.iter().filter(inside), 0.5).map(|(strength, _)| strength);
            let outside = edges.iter().any(FirstEdge::is_outside_model);
            (
                SpotKind::Point,
                outside,
                median.filter(|strength| strength.is_finite()),
            )
        };
        let page = SamplePage {
            title: samples.title(TITLE),
            label: "median intensity that overturns",
            command: "suite - --out case".to_owned(),
            are_suites: true,
            answer: &answer,
            picture: &|figure| self.draw(figure, samples),
        };
        Ok(page
            .add_to(results, samples, &report.all)
            .in_order(Self::FILES))
    }
}

/// Report on the intensities that overturn samples.
#[derive(Serialize, Deserialize, Template)]
#[template(path = "studies/ensemble/uncertain_suite.txt")]
pub struct UncertainSuiteSummary {
    #[serde(flatten)]
    all: SampleSummary,
    /// The measure of the intensities.
    intensity: Measure,
    /// The answer that may be quoted, in words.
    to_quote: Option<String>,
    /// Name of the distribution in `fragility` to quote: it has the scatter of records and of uncertain numbers.
    quote: String,
    /// The intensity at which a record first overturns a sample.
    first_intensity: StrengthBand,
    /// The intensity at which a record first overturns the scenario itself.
    own_first_intensity: StrengthBand,
    /// Median and dispersion of the overturning intensities.
    fragility: Fragilities,
    /// Number of records of the suite.
    records: usize,
    /// Number of edges: one for each sample and record; two if the mirrored record counts as well.
    edges: usize,
    /// Number of edges at the lowest level already.
    at_lowest_level: usize,
}

impl Report for UncertainSuiteSummary {
    fn verdict(&self) -> String {
        let (unit, name) = (self.intensity.unit(), self.intensity.name());
        let at = |which, before: &str| {
            let words = [before, unit];
            self.first_intensity.in_words(which, &words, NOWHERE)
        };
        self.all.verdict(|| {
            format!(
                "overturns with a probability of 5 % {}, of 50 % {} (dispersion {}), over records and {} samples of [uncertain]",
                at(0, &format!("{name} ")),
                at(1, ""),
                estimated(&self.fragility.both.dispersion, &None, ""),
                self.all.samples
            )
        })
    }

    fn quote(&self) -> Option<&str> {
        self.to_quote.as_deref()
    }

    fn warnings(&self) -> &Warnings {
        &self.all.warnings
    }
}

impl UncertainSuiteSummary {
    /// True if the last distribution may be quoted.
    fn has_answer(&self) -> bool {
        let quote = self.to_quote.as_ref();
        quote.is_some_and(|quote| !quote.starts_with(quotable::NO_ANSWER))
    }
}

/// Words for an intensity at which too few records overturn.
const NOWHERE: &str = "nowhere up to the highest level";

/// The histories that are checked, in words.
const CHECKED: &str = "edges of samples";

/// The three distributions of overturning intensities.
#[derive(Serialize, Deserialize)]
struct Fragilities {
    /// Scatter due to the records: the scenario itself under all records.
    record_to_record: Estimated,
    /// Scatter due to the uncertain numbers: the median over the records of each sample.
    uncertain_data: Estimated,
    /// Scatter due to both: all samples under all records.
    both: Estimated,
}

/// A distribution, with 95 % intervals from the number of records.
#[derive(Serialize, Deserialize)]
struct Estimated {
    /// Median; `None` if fewer than half of the cases overturn. Uncertain intensities count with the fraction of the repetitions that overturn.
    median: Option<f64>,
    /// Ends of the 95 % interval of the median; `None` without a dispersion, or with one record. It contains both ends: uncertain intensities overturn, and
    /// samples without a verdict at the lowest level, or all survive.
    median_interval: Option<[f64; 2]>,
    /// Dispersion; `None` if too few cases overturn for the 84 % fractile.
    dispersion: Option<f64>,
    /// Ends of the 95 % interval of the dispersion; `None` without a dispersion, with one record, or for the uncertain data alone.
    dispersion_interval: Option<[f64; 2]>,
}

impl Fragilities {
    /// Distributions with their names in words.
    fn named_distributions(&self) -> [(&'static str, &Estimated); 3] {
        [
            ("record to record", &self.record_to_record),
            ("uncertain data", &self.uncertain_data),
            ("both records and samples", &self.both),
        ]
    }
}

/// Number with its unit and its interval in words.
fn estimated(number: &Option<f64>, ends: &Option<[f64; 2]>, unit: &str) -> String {
    let ends = ends
        .map(rounded_range)
        .map_or(String::new(), |[low, high]| {
            format!(" ({low} to {high}{unit})")
        });
    let number = number.map(|number| format_edge(number) + unit);
    number.unwrap_or("not known".to_owned()) + &ends
}

/// Computes median and dispersion of overturning intensities from their 16, 50 and 84 % fractiles. The dispersion is half the logarithm of the
/// ratio of the outer fractiles; for a lognormal distribution this is the standard deviation of the logarithm. Infinite intensities are cases
/// that do not overturn.
fn distribution(intensities: impl IntoIterator<Item = [f64; 2]>) -> [Option<f64>; 2] {
    let intensities = ascending_weighted(intensities);
    let finite = |part| weighted_fractile(&intensities, part).filter(|at| at.is_finite());
    let [low, median, high] = FRACTILES.map(finite);
    let dispersion = low.zip(high).map(|(low, high)| 0.5 * libm::log(high / low));
    [median, dispersion]
}

/// The edges that count. Mirrored records do not count if no sample has a second direction.
struct EdgesThatCount<'a> {
    question: &'a Capacities<'a>,
    /// The edges of each record, for the scenario itself; `samples` has them for each sample.
    own: Vec<&'a [FirstEdge]>,
    samples: Vec<Vec<&'a [FirstEdge]>>,
    /// Number of samples without a verdict.
    unknown: usize,
}

impl<'a> EdgesThatCount<'a> {
    fn new(question: &'a Capacities<'a>, samples: &Samples<'a, EdgePerRecord>) -> Self {
        let own = samples.own.as_ref().ok();
        let mut all = own.into_iter().chain(samples.answers());
        let is_symmetric = all.all(|edges| {
            let mut records = edges.chunks(question.signs());
            records.all(|signs| signs.iter().all(|edge| *edge == signs[0]))
        });
        let signs = if is_symmetric { 1 } else { question.signs() };
        let counted = |edges: &'a EdgePerRecord| -> Vec<&'a [FirstEdge]> {
            let records = edges.chunks(question.signs());
            records.map(|edges| &edges[..signs]).collect()
        };
        Self {
            question,
            own: own.map(counted).unwrap_or_default(),
            samples: samples.answers().map(counted).collect(),
            unknown: samples.count_unknown(),
        }
    }

    /// Edges of the scenario itself that are inside the model.
    fn scenario_edges(&self) -> impl Iterator<Item = &'a FirstEdge> + Clone {
        let edges = self.own.iter().copied().flatten();
        edges.filter(|edge| !edge.is_outside_model())
    }

    /// Edges of all samples, also those outside the model.
    fn sample_edges(&self) -> impl Iterator<Item = &'a FirstEdge> + Clone {
        self.samples.iter().flatten().copied().flatten()
    }

    fn fragilities(&self) -> Fragilities {
        let count = self.question.suite.records.len();
        let all: Vec<usize> = (0..count).collect();
        let found = self.distributions(&all, TREATMENTS[0], None);
        let lowest = self.question.levels.first().copied();
        let ends = [(1, lowest), (2, Some(f64::INFINITY))]
            .map(|(how, unknown)| self.distributions(&all, TREATMENTS[how], unknown));
        // Both signs of a record, and all samples under it, count as one value.
        let intervals = FractileIntervals::of(count);
        let estimated = |which: usize| {
            let [median, dispersion] = found[which];
            // The median of the uncertain data has the scatter of the records as well.
            let scatter = if which == 0 { dispersion } else { found[2][1] };
            let both = intervals.as_ref().zip(median.zip(scatter));
            let median_interval = both.and_then(|(intervals, (median, scatter))| {
                let [low, high] = intervals.median_interval(median, scatter);
                Some([low.min(ends[0][which][0]?), high.max(ends[1][which][0]?)])
            });
            // Few records leave scatter of pairs of record and sample in the medians of the samples, which this interval would miss.
            let both = intervals.as_ref().zip(dispersion.filter(|_| which != 1));
            Estimated {
                median,
                median_interval,
                dispersion,
                dispersion_interval: both
                    .map(|(of, dispersion)| of.dispersion_interval(dispersion)),
            }
        };
        Fragilities {
            record_to_record: estimated(0),
            uncertain_data: estimated(1),
            both: estimated(2),
        }
    }

    /// Computes the distributions due to the records, to the uncertain numbers and to both, for a list of records with repetitions.
    /// Samples without a verdict, and edges outside the model, have the intensity `unknown`, or do not count.
    fn distributions(
        &self,
        records: &[usize],
        treatment: Treatment,
        unknown: Option<f64>,
    ) -> [[Option<f64>; 2]; 3] {
        let chosen = |of: &Vec<&[FirstEdge]>| -> Vec<[f64; 2]> {
            let edges = records
                .iter()
                .filter_map(|record| of.get(*record).copied())
                .flatten();
            let strengths = |edge: &FirstEdge| match edge.is_outside_model() {
                true => unknown.map(|at| [at, 1.0]).into_iter().collect(),
                false => edge.strengths(treatment),
            };
            edges.flat_map(strengths).collect()
        };
        let median = |of: &Vec<&[FirstEdge]>| {
            let median = weighted_fractile(&ascending_weighted(chosen(of)), 0.5);
            median.map(|median| [median, 1.0])
        };
        let unknown = unknown.map(|at| [at, 1.0]).into_iter().cycle();
        let unknown = |each: usize| unknown.clone().take(each * self.unknown);
        let all = self.samples.iter();
        [
            distribution(chosen(&self.own)),
            distribution(all.clone().filter_map(median).chain(unknown(1))),
            distribution(all.flat_map(chosen).chain(unknown(records.len()))),
        ]
    }

    /// Makes the table of the shares that overturn up to each level: of the records with the scenario itself, and of all samples.
    fn table_of_levels(&self) -> Result<Table, OutputError> {
        let share = |edges: Vec<&FirstEdge>, level: f64| {
            let overturned = edges.iter().filter_map(|edge| edge.overturns_up_to(level));
            (!edges.is_empty()).then(|| overturned.sum::<f64>() / edges.len() as f64)
        };
        let own = |level: &f64| share(self.scenario_edges().collect(), *level);
        let inside = |edge: &&FirstEdge| !edge.is_outside_model();
        let all = |level: &f64| share(self.sample_edges().filter(inside).collect(), *level);
        let columns = [
            column(self.question.suite.measure.name(), |level: &f64| *level),
            column("record_to_record", own),
            column("both", all),
        ];
        Table::new(columns, &self.question.levels)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lognormal intensities from their quantiles: the fractiles give median and dispersion back, within the spacing of the 2000 values.
    #[test]
    fn fractiles_are_those_of_lognormal_intensities() {
        // Phi(1) = 0.8413: the fractile of 84 % is at 0.9945 deviations, and the interpolation error is negligible with this number of values.
        let intensities: Vec<f64> = (0..2000)
            .map(|index| {
                let part = (f64::from(index) + 0.5) / 2000.0;
                let (mut low, mut high) = (-6.0_f64, 6.0_f64);
                while high - low > 1e-12 {
                    let middle = 0.5 * (low + high);
                    let below = 0.5 * libm::erfc(-middle / std::f64::consts::SQRT_2) < part;
                    if below { low = middle } else { high = middle }
                }
                0.7 * (0.4 * low).exp()
            })
            .collect();
        let [median, dispersion] = distribution(intensities.into_iter().map(|at| [at, 1.0]));
        let (median, dispersion) = (median.unwrap(), dispersion.unwrap());
        assert!((median / 0.7 - 1.0).abs() < 1e-3, "{median}");
        assert!((dispersion - 0.4 * 0.9945).abs() < 1e-3, "{dispersion}");
        // The median is unknown if fewer than half of the intensities are finite.
        let none = distribution([1.0, f64::INFINITY, f64::INFINITY].map(|at| [at, 1.0]));
        assert_eq!(none, [None, None]);
    }
}
