//! The history of every sample: ending, largest rotation and rotation over time.

use std::ops::ControlFlow;

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use super::influence::percent;
use super::report::{Band, Findings, Line, doubts_in_words, of_answer, share_in_words};
use super::{NoAnswer, Question, Samples};
use crate::dynamics::model::WithoutDemand;
use crate::dynamics::repeatability::repeated;
use crate::output::panels::{MAIN, scale_around};
use crate::output::{
    Figure, Key, Mark, OutputError, Panels, Scale, Sign, Stroke, Subject, color, column, csv, list,
};
use crate::scenario::{MotionModel, Scenario, Structure};
use crate::studies::ending::columns::{self, OUTCOMES};
use crate::studies::remarks::ModelCheck;
use crate::studies::statistics::{band, fractile, quantile};
use crate::{Ending, Factors, Model, NoHistory, Sample, Verdict};

/// Largest number of times at which samples are compared.
const MOST_TIMES: usize = 300;

/// The question for the history of each sample, with the times at which samples are compared.
#[derive(Debug)]
pub struct Histories {
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
    /// Outcome of the history.
    pub ending: Ending,
    /// Largest potential energy of a row of blocks over the barrier; `None` if the barrier is unknown.
    pub potential_over_barrier: Option<f64>,
    /// Recorded rotations of the body, in radians, until the end of the history. After it the rotation is constant, or the sample has
    /// overturned.
    pub course_rad: Vec<f32>,
}

/// Makes the model of a scenario for a study of many cases.
fn many_cases(scenario: &Scenario) -> Result<Box<dyn Model>, String> {
    let model = scenario.motion.model_for_many_cases(&scenario.structure);
    model.map_err(|error| error.to_string())
}

impl Question for Histories {
    type Answer = HistoryAnswer;

    const NAME: &'static str = "uncertain";

    const FILES: &'static [&'static str] = &[
        "bands.svg",
        "matters.svg",
        "bands.csv",
        "samples.csv",
        "uncertain.json",
    ];

    /// Computes the history of the scenario itself.
    fn of(scenario: &Scenario, _: Factors) -> Result<Self, String> {
        scenario.check_for_run()?;
        let model = scenario.model().map_err(|error| error.to_string())?;
        let request = scenario.request();
        let summary = model.simulate(scenario.ground_motion(), &request, None);
        let summary = summary.map_err(|error| error.to_string())?;
        let peaks = summary.peak_rotations_rad.iter().enumerate();
        let most = peaks.max_by(|a, b| a.1.total_cmp(b.1));
        // Other samples may come to rest later than the scenario itself.
        let end_s = request.end_s.min(2.0 * summary.end_s);
        let samples = (end_s / request.output_step_s).floor().max(1.0);
        let stride = (samples / MOST_TIMES as f64).ceil();
        let times = (samples / stride).floor() as usize + 1;
        let structure = scenario.structure.clone();
        Ok(Self {
            body: most.map_or(0, |(body, _)| body),
            step_s: stride * request.output_step_s,
            times,
            own: (structure, scenario.motion.clone(), many_cases(scenario)?),
        })
    }

    fn findings<'a>(
        &'a self,
        samples: &Samples<'a, HistoryAnswer>,
        figure: Figure,
    ) -> Result<Findings<'a, HistoryAnswer, impl Serialize>, OutputError> {
        // Overturned samples have no largest rotation, but rank above all others.
        let peak_rad = |answer: &HistoryAnswer| answer.ending.peak_or_infinite_rad();
        let names = [
            ["overturning", "whether it overturns"],
            ["peak_rotation_rank", "how far it rocks"],
        ];
        let influences = vec![
            samples.influence(names[0], false, HistoryAnswer::overturned),
            samples.influence(names[1], true, peak_rad),
        ];
        let peaks: Vec<f64> = samples.answers().map(peak_rad).collect();
        let peak_band = band(peaks.clone(), fractile);
        let (mut outcomes, mut lines) = (Map::new(), Vec::new());
        for (index, name) in OUTCOMES.into_iter().enumerate() {
            let share = samples.share(|answer| match index {
                0 => answer.overturned(),
                _ => f64::from(answer.ending.outcome_name() == name),
            });
            let Some(share) = share else {
                continue;
            };
            outcomes.insert(name.to_owned(), json!(share));
            if share.share > 0.0 {
                let name = name.replace('_', " ");
                lines.push(format!("{name}: {}", share_in_words(&share)));
            }
        }
        lines.push(peak_band.map_or("largest rotation: not known".to_owned(), peaks_in_words));
        let has_joints = samples.scenario.motion.kind.has_joints;
        let mut all = columns::columns(has_joints, |line: &Line<'_, HistoryAnswer>| {
            let answer = line.answer.as_ref();
            answer.map(|answer| &answer.ending).map_err(NoAnswer::name)
        });
        let potential = |one: &HistoryAnswer| one.potential_over_barrier;
        let rotation = |one: &HistoryAnswer| one.ending.peak_rotation_rad;
        all.push(match has_joints {
            true => of_answer("peak_potential_over_barrier", potential),
            false => of_answer("peak_rotation_rad", rotation),
        });
        let bands = self.bands(samples);
        let answers = samples.answers();
        let excess_ratios = answers.map(|answer| answer.ending.thrust_excess_ratio);
        Ok(Findings {
            first: first_words(samples),
            lines,
            influences,
            no_verdict: samples.no_verdict(),
            model: ModelCheck::of(excess_ratios),
            checked: "samples",
            details: Details {
                outcomes,
                peak_rotation_rad: peak_band.into(),
                followed_body: self.body,
            },
            pictures: vec![self.draw(figure, samples, &bands)],
            tables: vec![table(&bands)?],
            columns: all,
            peaks,
        })
    }

    fn answer(&self, scenario: &Scenario) -> Result<HistoryAnswer, NoAnswer> {
        let (structure, motion, model) = &self.own;
        if scenario.structure == *structure && scenario.motion == *motion {
            return self.history(scenario, &**model);
        }
        let model = many_cases(scenario).map_err(NoAnswer::Invalid)?;
        self.history(scenario, &*model)
    }

    /// Computes the answer of the scenario itself with the steps of `run`.
    fn own_answer(&self, scenario: &Scenario) -> Result<HistoryAnswer, NoAnswer> {
        let model = scenario.model().map_err(NoAnswer::invalid)?;
        self.history(scenario, &*model)
    }
}

impl Histories {
    /// Computes the history of a scenario.
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
        let checked = repeated(model, &[case], own).remove(0);
        let summary = checked.own.map_err(NoHistory::from)?;
        let ending = Ending::from_summary(&summary, None, checked.count)?;
        if ending.verdict() == Verdict::Incomplete {
            return Err(NoAnswer::Incomplete);
        }
        Ok(HistoryAnswer {
            ending,
            potential_over_barrier: summary.peak_potential_over_barrier(),
            course_rad,
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
        let title = samples.title("Histories with uncertain data");
        let end_s = bands.last().map_or(1.0, |at| at.time_s);
        let mut panels = Panels::new(figure, title, [0.0, end_s]);
        let subject = Subject {
            title,
            ground: scenario.ground_motion(),
            gravity_m_s2: scenario.gravity_m_s2(),
            incipient_g: [None; 2],
        };
        panels.ground(90.0, &subject, None);
        let values = bands.iter();
        let values = values.flat_map(|at| at.band_rad.into_iter().chain(at.own_rad));
        let y = scale_around(&[], values, 6);
        let model = scenario.model().ok();
        let body = model.and_then(|model| model.bodies().get(self.body).cloned());
        let of_body = body.filter(|name| !name.is_empty());
        let of_body = of_body.map_or(String::new(), |name| {
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
        panels.panel(&label, 330.0, y, None, marks);
        let all = samples.answers().count().max(1) as f64;
        let shares = bands.iter();
        let shares = shares.map(|at| (at.time_s, at.overturned as f64 / all));
        let shares = vec![Mark::curve("overturned", MEDIAN, shares)];
        let y = Scale::exactly(0.0, 1.0, 2);
        panels.panel("Overturned", 70.0, y, None, shares);
        let beyond = "5 to 95 %; overturned samples are beyond";
        panels.keys = vec![
            Key::line("the scenario itself", MAIN),
            Key::line("median of the samples", MEDIAN),
            Key::new(beyond, Sign::Band(BAND, 1.0)),
        ];
        panels.finish(false)
    }
}

impl HistoryAnswer {
    /// Returns the weight of the sample as overturned: 1 or 0, or the fraction of its repetitions that overturn.
    pub fn overturned(&self) -> f64 {
        let share = self.ending.overturning_share();
        share.expect("a sample with an incomplete history has no answer")
    }

    /// Returns the rotation at a recorded time, in radians; infinite, with its sign, after the sample has overturned.
    fn rotation_rad(&self, time: usize) -> f64 {
        let last = self.course_rad.last().copied().map_or(0.0, f64::from);
        match self.course_rad.get(time) {
            Some(rotation_rad) => f64::from(*rotation_rad),
            None if self.ending.overturned_itself() => f64::INFINITY.copysign(last),
            None => last,
        }
    }
}

/// The part of the summary that is specific to histories.
#[derive(Serialize)]
struct Details {
    /// Share of the samples with each outcome. In that of `overturned`, uncertain samples count with the fraction of their repetitions that
    /// overturn.
    outcomes: Map<String, Value>,
    /// Largest rotation, in radians; quantiles in the range of overturned samples are null.
    peak_rotation_rad: Band,
    /// Index of the body whose rotation is recorded, from 0.
    followed_body: usize,
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

fn table(bands: &[BandAt]) -> Result<Vec<u8>, OutputError> {
    let quantiles = ["quantile_05_rad", "median_rad", "quantile_95_rad"];
    let finite = |rad: f64| Some(rad).filter(|rad| rad.is_finite());
    let columns = [
        column("time_s", |at: &BandAt| at.time_s),
        column("own_rad", |at: &BandAt| at.own_rad),
        list(quantiles, |at: &BandAt| at.band_rad.map(finite)),
        column("overturned", |at: &BandAt| at.overturned),
    ];
    csv(columns, bands)
}

/// Returns the probability of overturning, and the ending of the scenario itself, in words; `None` if no sample has an answer.
fn first_words(samples: &Samples<'_, HistoryAnswer>) -> Option<String> {
    let share = samples.share(HistoryAnswer::overturned)?;
    let own = match samples.own.as_ref().map(|own| (own, own.ending.verdict())) {
        Err(_) => "has no answer".to_owned(),
        Ok((_, Verdict::Overturns)) => "overturns".to_owned(),
        Ok((own, Verdict::Uncertain)) => {
            let part = percent(own.overturned());
            format!("is uncertain: {part} of its repetitions overturn")
        }
        Ok((own, _)) => {
            let rotation = own.ending.peak_over_critical;
            let rotation = rotation.map(|part| (part, "rotation"));
            let margin = rotation.or(own.potential_over_barrier.map(|part| (part, "energy")));
            // Rounded down as in `run`: a value just below 100 % must not be printed as 100 %.
            margin.map_or("survives".to_owned(), |(part, what)| {
                let percent = (1000.0 * part).floor() / 10.0;
                format!("survives, at {percent:.1} % of the {what} from which it would overturn")
            })
        }
    };
    let (doubts, share) = (doubts_in_words(&share), share_in_words(&share));
    Some(format!(
        "overturns with a probability of {share} of [uncertain]{doubts};\n    the scenario itself {own}"
    ))
}

fn peaks_in_words(band_rad: [f64; 3]) -> String {
    let [low, median, high] = band_rad.map(|rad| match rad.is_finite() {
        true => format!("{rad:.4} rad"),
        false => "overturning".to_owned(),
    });
    format!("largest rotation: median {median}; 5 to 95 %: {low} to {high}")
}

const BAND: &str = "#cfe3f1";
const MEDIAN: Stroke = Stroke::new(color::BLUE, 1.6, "");
