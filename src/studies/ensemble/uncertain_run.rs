//! The history of every sample: ending, largest rotation and rotation over time.

use std::collections::BTreeMap;
use std::iter;
use std::ops::ControlFlow;

use askama::Template;
use serde::{Deserialize, Serialize};

use super::influence::{InfluencedAnswer, NumberInfluence, percent};
use super::page::{PageAnswer, SAMPLES, SamplePage};
use super::report::{self, Band, Line, SampleSummary, answer_column};
use super::{NoAnswer, SampleCases, SampleRow, Samples};
use crate::dynamics::repeatability::{CheckedHistory, checked, repeat_cases};
use crate::dynamics::{Direction, EndCondition, WithoutDemand};
use crate::output::panels::MAIN;
use crate::output::{
    Figure, HistoryPanels, Key, Mark, OutputError, Scale, Sign, Stroke, Subject, Table, color,
    column, each, filters, list, scale_around,
};
use crate::scenario::{MotionModel, Scenario, Structure, Varied};
use crate::studies::ending::columns::{self, OUTCOMES, OVERTURNED};
use crate::studies::page::kind_of;
use crate::studies::quotable::SurvivorFriction;
use crate::studies::report::{Report, Warnings};
use crate::studies::statistics::{Share, band, fractile, quantile};
use crate::studies::{Results, Study, Style};
use crate::{Ending, Model, NoHistory, Sample, Verdict};

/// Smallest number of certainly overturned samples, and of certainly surviving ones, for influences on overturning.
const LEAST_OF_EACH: usize = 10;

/// Largest number of times at which samples are compared.
const MOST_TIMES: usize = 300;

/// The study of the history of each sample, with the times at which samples are compared.
#[derive(Debug)]
pub struct Histories<'a> {
    cases: SampleCases<'a>,
    /// Index of the body whose rotation is recorded, from 0: the body with the largest rotation in the history of the scenario itself.
    pub body: usize,
    /// Interval between recorded rotations, in seconds.
    pub step_s: f64,
    /// Number of recorded rotations, the first at time zero.
    pub times: usize,
    /// Structure, motion and model of the scenario itself. Samples with the same structure and motion use this model, because finding mechanisms
    /// after impacts takes much longer than a history.
    own: (Structure, MotionModel, Box<dyn Model>),
}

/// Rotation over time and ending of the history of a sample.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HistoryAnswer {
    /// Ending of the history in the worse direction of the ground motion.
    pub ending: Ending,
    /// Largest potential energy of a row of blocks over the barrier; `None` if the barrier is unknown.
    pub potential_over_barrier: Option<f64>,
    /// Recorded rotations of the body under the ground motion as given, in radians, until the end of the history. After it the rotation is constant,
    /// or the sample has overturned.
    pub course_rad: Vec<f32>,
    /// True if the recorded history overturns.
    pub course_overturns: bool,
}

impl<'a> Histories<'a> {
    /// Makes the study of a scenario with a table `[uncertain]`. Computes the history of the scenario itself.
    ///
    /// # Errors
    /// Returns the change that the scenario needs, in words.
    pub fn of(scenario: &'a Scenario) -> Result<Self, String> {
        scenario.check_for_run()?;
        let model = scenario.model().map_err(|error| error.to_string())?;
        let request = scenario.request();
        let summary = model
            .simulate(scenario.ground_motion(), &request, None)
            .map_err(|error| error.to_string())?;
        let peaks = summary.peak_rotations_rad.iter().enumerate();
        let most = peaks.max_by(|a, b| a.1.total_cmp(b.1));
        // Other samples may come to rest later than the scenario itself.
        let end_s = request.end_s.min(2.0 * summary.end_s);
        let samples = (end_s / request.output_step_s).floor().max(1.0);
        let stride = (samples / MOST_TIMES as f64).ceil();
        let times = (samples / stride).floor() as usize + 1;
        let structure = scenario.structure.clone();
        let many_cases = scenario
            .model_for_many_cases()
            .map_err(|error| error.to_string())?;
        Ok(Self {
            cases: SampleCases::of(scenario)?,
            body: most.map_or(0, |(body, _)| body),
            step_s: stride * request.output_step_s,
            times,
            own: (structure, scenario.motion.clone(), many_cases),
        })
    }

    /// Computes the answer of a sample, or of the scenario itself with the steps of `run`.
    fn answer(&self, scenario: &Scenario, is_own: bool) -> Result<HistoryAnswer, NoAnswer> {
        if is_own {
            let model = scenario.model().map_err(NoAnswer::without_model)?;
            return self.history(scenario, &*model);
        }
        let (structure, motion, model) = &self.own;
        if scenario.structure == *structure && scenario.motion == *motion {
            return self.history(scenario, &**model);
        }
        let model = scenario.model_for_many_cases();
        let model = model.map_err(NoAnswer::without_model)?;
        self.history(scenario, &*model)
    }
}

impl Study for Histories<'_> {
    type Row = SampleRow<HistoryAnswer>;

    const NAME: &'static str = "uncertain";

    const FILES: &'static [&'static str] = &[
        SAMPLES,
        "bands.svg",
        "matters.svg",
        "bands.csv",
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
        self.cases
            .rows(cases, |scenario, is_own| self.answer(scenario, is_own))
    }

    fn results(
        &self,
        rows: Vec<Self::Row>,
        Style { figure, .. }: Style,
    ) -> Result<Results, OutputError> {
        let samples = &Samples::new(self.cases, &rows);
        let influences = influences(samples);
        let of_samples = samples
            .rows
            .iter()
            .map(|row| row.answer.as_ref().ok().map(peak_rad));
        let largest_rotations_rad: Vec<_> = iter::once(None).chain(of_samples).collect();
        let outcomes = OUTCOMES.into_iter().filter_map(|name| {
            let share = samples.share(|answer| match name {
                OVERTURNED => answer.overturned_weight(),
                _ => f64::from(answer.ending.outcome_name() == name),
            });
            Some((name.to_owned(), share?))
        });
        let answers = samples.answers();
        let model = samples.model_check(answers.map(|answer| answer.ending.thrust_excess_ratio));
        let survivors = samples
            .answers()
            .map(|answer| &answer.ending)
            .filter(|ending| ending.verdict() == Verdict::Survives);
        let demands = survivors.map(|ending| ending.friction_demand);
        let study = ("run FILE", "surviving samples");
        let friction = SurvivorFriction::of(demands, samples.scenario, study);
        let limits = (CHECKED, samples.no_verdict());
        let report = UncertainRunSummary {
            all: SampleSummary::new(
                (samples, &Varied::default()),
                model,
                friction,
                limits,
                influences,
            ),
            own: samples.own.as_ref().ok().map(OwnHistory::of),
            outcomes: outcomes.collect(),
            peak_rotation_rad: each(band(samples.answers().map(peak_rad).collect(), fractile))
                .into(),
            followed_body: self.body,
        };
        let kind = samples.scenario.motion.kind;
        let mut columns =
            columns::columns(kind.is_repeated, |(_, row): &Line<'_, HistoryAnswer>| {
                let answer = row.answer.as_ref();
                answer.map(|answer| &answer.ending).map_err(NoAnswer::name)
            });
        let potential = |one: &HistoryAnswer| one.potential_over_barrier;
        let rotation = |one: &HistoryAnswer| one.ending.peak_rotation_rad;
        columns.push(columns::direction(|(_, row): &Line<'_, HistoryAnswer>| {
            let answer = row.answer.as_ref();
            answer.map(|answer| &answer.ending).map_err(NoAnswer::name)
        }));
        columns.push(match kind.has_mechanism {
            false => answer_column("peak_potential_over_barrier", potential),
            true => answer_column("peak_rotation_rad", rotation),
        });
        let bands = self.bands(samples);
        let results = Results::of("uncertain.json", &report)?
            .with_table("samples.csv", report::table(samples, columns)?)
            .with_table("bands.csv", table(&bands)?)
            .with_file("bands.svg", self.draw(figure, samples, &bands))
            .with_file("matters.svg", report.all.draw_influences(samples, figure));
        let page = SamplePage {
            title: samples.title(TITLE),
            label: "peak rotation (rad)",
            command: "run - --out case".to_owned(),
            are_suites: false,
            answer: &page_answer,
            picture: &|figure| self.draw(figure, samples, &bands),
        };
        Ok(Results {
            largest_rotations_rad,
            ..page
                .add_to(results, samples, &report.all)
                .in_order(Self::FILES)
        })
    }
}

/// Largest rotation of a sample, in radians. Overturned samples have none, but rank above all others.
const fn peak_rad(answer: &HistoryAnswer) -> f64 {
    answer.ending.peak_or_infinite_rad()
}

/// The influence of the uncertain numbers on an answer; `None` if it is unknown.
type OnAnswer = (InfluencedAnswer, Option<Vec<NumberInfluence>>);

/// Influences on overturning, if enough samples overturn and survive, and on the rank of the largest rotation.
fn influences(samples: &Samples<'_, HistoryAnswer>) -> [OnAnswer; 2] {
    let is_enough = [1.0, 0.0].into_iter().all(|end| {
        let alike = samples
            .answers()
            .filter(|one| one.overturned_weight() == end);
        alike.count() >= LEAST_OF_EACH
    });
    let overturning = is_enough.then(|| samples.influence(false, HistoryAnswer::overturned_weight));
    let rank = samples.influence(true, peak_rad);
    [
        (InfluencedAnswer::Overturning, overturning.flatten()),
        (InfluencedAnswer::PeakRotationRank, rank),
    ]
}

impl Histories<'_> {
    /// Computes the history of a scenario, and under the mirrored ground motion if that may be worse.
    fn history(&self, scenario: &Scenario, model: &dyn Model) -> Result<HistoryAnswer, NoAnswer> {
        let (ground, mut request) = (scenario.ground_motion(), scenario.request());
        // Output times do not affect mechanisms, but steps of rows may end at output times.
        if model.as_mechanisms().is_some() {
            request.output_step_s = self.step_s;
        }
        let mut course_rad: Vec<f32> = Vec::with_capacity(self.times);
        let mut record = WithoutDemand(|sample: &Sample| {
            // Rounding errors of times are far below half an output step.
            let wanted = self.step_s * course_rad.len() as f64 - 0.5 * request.output_step_s;
            if sample.time_s >= wanted && course_rad.len() < self.times {
                let rotation = sample.rotations_rad.get(self.body).copied();
                course_rad.push(rotation.unwrap_or(0.0) as f32);
            }
            ControlFlow::Continue(())
        });
        let case = (ground.clone(), request);
        let own = vec![model.simulate(ground, &request, Some(&mut record))];
        let checked = repeat_cases(model, &[case], own).remove(0);
        let given = ended_history(checked)?;
        let course_overturns = given.0.overturned_itself();
        let (ending, potential_over_barrier) = worse_direction(given, scenario, model)?;
        if ending.verdict() == Verdict::Incomplete {
            return Err(NoAnswer::Incomplete);
        }
        if ending.is_outside_model() {
            return Err(NoAnswer::OutsideModel);
        }
        Ok(HistoryAnswer {
            ending,
            potential_over_barrier,
            course_rad,
            course_overturns,
        })
    }

    /// Computes the bands of the rotation over time.
    fn bands(&self, samples: &Samples<'_, HistoryAnswer>) -> Vec<BandAt> {
        let at = |time: usize| {
            let answers = samples.answers();
            let rotations: Vec<f64> = answers.map(|answer| answer.rotation_rad(time)).collect();
            let own = samples.own.as_ref().ok().map(|own| own.rotation_rad(time));
            Some(BandAt {
                time_s: time as f64 * self.step_s,
                own_rad: own.filter(|rotation| rotation.is_finite()),
                overturned: rotations.iter().filter(|rad| rad.is_infinite()).count(),
                band_rad: band(rotations, quantile)?,
            })
        };
        (0..self.times).filter_map(at).collect()
    }

    /// Draws the rotation over time: the band of the samples, their median, and the history of the scenario itself.
    fn draw(
        &self,
        figure: Figure,
        samples: &Samples<'_, HistoryAnswer>,
        bands: &[BandAt],
    ) -> String {
        let scenario = samples.scenario;
        let title = samples.title(TITLE);
        let end_s = bands.last().map_or(1.0, |at| at.time_s);
        let subject = Subject {
            title,
            ground: scenario.ground_motion(),
            gravity_m_s2: scenario.gravity_m_s2(),
            incipient_g: [None; 2],
        };
        let mut panels = HistoryPanels::new(figure, &subject, end_s, None);
        panels.ground(90.0);
        let values = bands.iter();
        let values = values.flat_map(|at| at.band_rad.into_iter().chain(at.own_rad));
        let y = scale_around(&[], values, 6);
        let model = scenario.model().ok();
        let body = model.and_then(|model| model.bodies().get(self.body).cloned());
        let of_body = body
            .filter(|name| !name.is_empty())
            .map_or(String::new(), |name| {
                format!("of {} ", name.replace('_', " "))
            });
        let label = format!("Rotation {of_body}(rad)");
        // Overturned samples are outside the picture.
        let at = |which: usize| {
            let points = bands.iter().map(move |at| (at.time_s, at.band_rad[which]));
            points.map(move |(time_s, rad)| (time_s, rad.clamp(y.low, y.high)))
        };
        let own = bands.iter().filter_map(|at| Some((at.time_s, at.own_rad?)));
        let marks = vec![
            Mark::between("band", BAND, at(0), at(2)),
            Mark::curve("median", MEDIAN, at(1)),
            Mark::curve("own", MAIN, own),
        ];
        panels.panel(&label, 330.0, y, marks);
        let all = samples.answers().count().max(1) as f64;
        let shares = bands
            .iter()
            .map(|at| (at.time_s, at.overturned as f64 / all));
        let shares = vec![Mark::curve("overturned", MEDIAN, shares)];
        let y = Scale::exactly(0.0, 1.0, 2);
        panels.panel("Overturned", 70.0, y, shares);
        let beyond = "5 to 95 %; overturned samples are beyond";
        panels.panels.keys = vec![
            Key::line("the scenario itself", MAIN),
            Key::line("median of the samples", MEDIAN),
            Key::new(beyond, Sign::Band(BAND, 1.0)),
        ];
        panels.finish(false)
    }
}

/// The ending of a history, and its largest potential energy over the barrier.
type Ended = (Ending, Option<f64>);

fn ended_history(checked: CheckedHistory) -> Result<Ended, NoHistory> {
    let own = checked.own.as_ref().ok();
    let potential = own.and_then(|own| own.peak_potential_over_barrier());
    Ok((Ending::of_checked(checked)?, potential))
}

/// History of a scenario in its first direction, or the history under the mirrored ground motion if that is worse. The mirrored history is
/// computed if the first survives or is uncertain.
fn worse_direction(
    (mut ending, potential): Ended,
    scenario: &Scenario,
    model: &dyn Model,
) -> Result<Ended, NoHistory> {
    ending.direction = scenario.simulation.direction.first();
    let is_open = matches!(ending.verdict(), Verdict::Survives | Verdict::Uncertain);
    if !(is_open && scenario.has_second_direction(model)) {
        return Ok((ending, potential));
    }
    let case = (scenario.ground_motion().mirrored(), scenario.request());
    let (mirrored, of_mirrored) =
        match ended_history(checked(model, &[case], EndCondition::End).remove(0)) {
            Ok((ending, potential)) => (Ok(ending), potential),
            Err(reason) => (Err(reason), None),
        };
    let worse = ending.or_worse(Some(mirrored))?;
    let potential = match worse.direction {
        Direction::AsGiven => potential,
        Direction::Mirrored => of_mirrored,
    };
    Ok((worse, potential))
}

impl HistoryAnswer {
    /// Weight of the sample as overturned: 1 or 0, or the fraction of its repetitions that overturn.
    pub fn overturned_weight(&self) -> f64 {
        let share = self.ending.overturning_share();
        share.expect("a sample with an incomplete history has no answer")
    }

    /// Rotation at a recorded time, in radians; infinite, with its sign, after the sample has overturned.
    fn rotation_rad(&self, time: usize) -> f64 {
        let last = self.course_rad.last().copied().map_or(0.0, f64::from);
        match self.course_rad.get(time) {
            Some(rotation_rad) => f64::from(*rotation_rad),
            None if self.course_overturns => f64::INFINITY.copysign(last),
            None => last,
        }
    }
}

const TITLE: &str = "Histories with uncertain data";

/// Answer of a sample on its page: the largest rotation, beyond the axis if the sample overturned.
fn page_answer(HistoryAnswer { ending, .. }: &HistoryAnswer) -> PageAnswer {
    let peak_rad = (!ending.overturned_itself()).then_some(ending.peak_rotation_rad);
    (kind_of(Some(ending.verdict())), false, peak_rad)
}

/// Report on the histories of samples.
#[derive(Serialize, Deserialize, Template)]
#[template(path = "studies/ensemble/uncertain_run.txt")]
pub struct UncertainRunSummary {
    #[serde(flatten)]
    all: SampleSummary,
    /// The history of the scenario itself; null if it has no answer.
    own: Option<OwnHistory>,
    /// Share of the samples with each outcome; empty if no sample has an answer. In that of `overturned`, uncertain samples count with the fraction
    /// of their repetitions that overturn.
    outcomes: BTreeMap<String, Share>,
    /// Largest rotation, in radians; quantiles in the range of overturned samples are null.
    peak_rotation_rad: Band,
    /// Index of the body whose rotation is recorded, from 0.
    followed_body: usize,
}

/// The history of the scenario itself.
#[derive(Serialize, Deserialize)]
struct OwnHistory {
    /// The verdict.
    verdict: Verdict,
    /// 1 if the structure overturns and 0 if it survives; if that is uncertain, the fraction of the repetitions that overturn.
    overturning_share: f64,
    /// Largest rotation over the critical one; null if the critical rotation is unknown.
    peak_rotation_over_critical: Option<f64>,
    /// Largest potential energy of a row of blocks over the barrier; null if the barrier is unknown.
    peak_potential_over_barrier: Option<f64>,
}

impl OwnHistory {
    fn of(answer: &HistoryAnswer) -> Self {
        Self {
            verdict: answer.ending.verdict(),
            overturning_share: answer.overturned_weight(),
            peak_rotation_over_critical: answer.ending.peak_over_critical,
            peak_potential_over_barrier: answer.potential_over_barrier,
        }
    }

    /// Largest part of the rotation or energy from which the structure would overturn, and the quantity.
    fn margin(&self) -> Option<(f64, &'static str)> {
        let rotation = self
            .peak_rotation_over_critical
            .map(|part| (part, "rotation"));
        let energy = || Some((self.peak_potential_over_barrier?, "energy"));
        rotation.or_else(energy)
    }
}

impl Report for UncertainRunSummary {
    fn verdict(&self) -> String {
        let share = self
            .outcomes
            .get(OVERTURNED)
            .map_or(String::new(), Share::in_words);
        let words = format!("overturns with a probability of {share} of [uncertain]");
        self.all.verdict(|| words)
    }

    fn warnings(&self) -> &Warnings {
        &self.all.warnings
    }
}

impl UncertainRunSummary {
    /// Outcomes of samples, in words, with their shares.
    fn outcomes(&self) -> impl Iterator<Item = (String, &Share)> {
        let known = OUTCOMES
            .iter()
            .filter_map(|name| Some((name.replace('_', " "), self.outcomes.get(*name)?)));
        known.filter(|(_, share)| share.share > 0.0)
    }
}

/// The rotations of all samples at a time.
struct BandAt {
    time_s: f64,
    /// Rotation of the scenario itself, in radians; `None` after it has overturned.
    own_rad: Option<f64>,
    /// The 5 % quantile, the median and the 95 % quantile of the samples, in radians; infinite in the range of overturned samples.
    band_rad: [f64; 3],
    /// Number of samples that have overturned by this time.
    overturned: usize,
}

fn table(bands: &[BandAt]) -> Result<Table, OutputError> {
    let quantiles = ["quantile_05_rad", "median_rad", "quantile_95_rad"];
    let finite = |rad: f64| Some(rad).filter(|rad| rad.is_finite());
    let columns = [
        column("time_s", |at: &BandAt| at.time_s),
        column("own_rad", |at: &BandAt| at.own_rad),
        list(quantiles, |at: &BandAt| at.band_rad.map(finite)),
        column("overturned", |at: &BandAt| at.overturned),
    ];
    Table::new(columns, bands)
}

/// Quantile of the largest rotation in words.
fn rotation(rad: &Option<f64>) -> String {
    rad.map_or("overturning".to_owned(), |rad| format!("{rad:.4} rad"))
}

/// The histories that are checked, in words.
const CHECKED: &str = "samples";

const BAND: &str = "#cfe3f1";
const MEDIAN: Stroke = Stroke::new(color::BLUE, 1.6, "");
