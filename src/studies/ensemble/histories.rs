//! How the history of every sample ends, how far it goes, and how it proceeds over time.

use std::ops::ControlFlow;

use serde::{Deserialize, Serialize};

use super::{NoAnswer, Question, Told, told};
use crate::dynamics::history::{Outcome, Sample};
use crate::dynamics::model::{Model, WithoutDemand};
use crate::dynamics::repeatability::repeated;
use crate::output::{Figure, OutputError};
use crate::scenario::{Motion, Scenario, Structure};
use crate::studies::ending::{Ending, Verdict};
use crate::studies::results::Results;
use crate::studies::statistics::{Share, band, quantile};

/// Largest number of times in the bands over time.
const MOST_TIMES: usize = 300;

/// A history, and the times at which its samples are compared.
#[derive(Debug)]
pub struct Histories {
    /// The body whose rotation is followed, from 0: the one that rotates most in the history of the scenario itself.
    pub body: usize,
    /// Time between the instants at which the rotation is recorded.
    pub step_s: f64,
    /// Number of these instants, from time zero.
    pub times: usize,
    /// Structure, motion and model of the scenario itself. Samples that differ in neither share the model: its mechanisms after impacts take
    /// many times as long to find as a history of four links takes.
    own: (Structure, Motion, Box<dyn Model>),
}

/// How the history of a sample proceeded and ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Went {
    /// How the history ended.
    pub ending: Ending,
    /// Largest rotation of any body, in radians; if it overturned, the largest until overturning was certain.
    pub peak_rotation_rad: f64,
    /// For a row of blocks, its largest potential energy over the barrier, if that is known.
    pub potential_over_barrier: Option<f64>,
    /// Rotation of the body at the instants, in radians, until the end of the history; then it stays constant, or has overturned.
    pub course_rad: Vec<f32>,
}

impl Histories {}

/// The model of a scenario for a study of many cases.
fn many_cases(scenario: &Scenario) -> Result<Box<dyn Model>, String> {
    let model = scenario.motion().model_for_many_cases(scenario.structure());
    model.map_err(|error| error.to_string())
}

impl Histories {
    /// The question about a scenario.
    ///
    /// # Errors
    /// Explains what to change.
    pub fn of(scenario: &Scenario) -> Result<Self, String> {
        scenario.check_for_run()?;
        let model = scenario.model().map_err(|error| error.to_string())?;
        let request = scenario.request();
        let summary = model
            .simulate(scenario.ground_motion(), &request, None)
            .map_err(|error| error.to_string())?;
        let peaks = summary.peak_rotations_rad.iter().enumerate();
        let most = peaks.max_by(|a, b| a.1.total_cmp(b.1));
        let body = most.map_or(0, |(body, _)| body);
        // A history that ends early may last longer in another sample.
        let end_s = request.end_s.min(2.0 * summary.end_s);
        let samples = (end_s / request.output_step_s).floor().max(1.0);
        let stride = (samples / MOST_TIMES as f64).ceil();
        let times = (samples / stride).floor() as usize + 1;
        Ok(Self {
            body,
            step_s: stride * request.output_step_s,
            times,
            own: (
                scenario.structure().clone(),
                *scenario.motion(),
                many_cases(scenario)?,
            ),
        })
    }
}

impl Question for Histories {
    type Answer = Went;

    const NAME: &'static str = "uncertain";

    fn results(
        &self,
        told: &Told<'_, Self::Answer>,
        figure: Figure,
    ) -> Result<Results, OutputError> {
        told::histories(told, self, figure)
    }

    fn answer(&self, scenario: &Scenario) -> Result<Went, NoAnswer> {
        let (structure, motion, model) = &self.own;
        if scenario.structure() == structure && scenario.motion() == motion {
            return self.went(scenario, &**model);
        }
        let model = many_cases(scenario).map_err(NoAnswer::Invalid)?;
        self.went(scenario, &*model)
    }

    /// With the steps of a run.
    fn own_answer(&self, scenario: &Scenario) -> Result<Went, NoAnswer> {
        let model = scenario.model();
        let model = model.map_err(|error| NoAnswer::Invalid(error.to_string()))?;
        self.went(scenario, &*model)
    }
}

impl Histories {
    /// How the history of a scenario goes.
    fn went(&self, scenario: &Scenario, model: &dyn Model) -> Result<Went, NoAnswer> {
        let (ground, mut request) = (scenario.ground_motion(), scenario.request());
        // Output times do not influence the motion of mechanisms; for rows of blocks, steps may end at output times.
        if model.as_mechanisms().is_some() {
            request.output_step_s = self.step_s;
        }
        let mut course_rad: Vec<f32> = Vec::with_capacity(self.times);
        let mut record = WithoutDemand(|sample: &Sample| {
            // The rounding error of times is far below half an output step.
            let wanted = self.step_s * course_rad.len() as f64 - 0.5 * request.output_step_s;
            if sample.time_s >= wanted && course_rad.len() < self.times {
                let rotation = sample.rotations_rad.get(self.body).copied();
                course_rad.push(rotation.unwrap_or(0.0) as f32);
            }
            ControlFlow::Continue(())
        });
        let failed = |error: String| NoAnswer::Failed(error);
        let case = (ground.clone(), request);
        let own = vec![model.simulate(ground, &request, Some(&mut record))];
        let checked = repeated(model, &[case], own).remove(0);
        let summary = checked.own.map_err(|error| failed(error.to_string()))?;
        let ending = Ending::from_summary(&summary, None, checked.doubt).map_err(failed)?;
        if ending.verdict() == Verdict::Incomplete {
            return Err(NoAnswer::Incomplete);
        }
        Ok(Went {
            ending,
            peak_rotation_rad: summary.largest_rotation_rad(),
            potential_over_barrier: summary.peak_potential_over_barrier(),
            course_rad,
        })
    }
}

impl Went {
    /// Whether the history itself overturned, whether certain or not.
    #[must_use]
    pub const fn goes_over(&self) -> bool {
        matches!(self.ending.outcome, Outcome::Overturned(_))
    }

    /// The largest rotation; infinite if it overturned.
    #[must_use]
    pub fn peak_rad(&self) -> f64 {
        if self.goes_over() {
            f64::INFINITY
        } else {
            self.peak_rotation_rad
        }
    }

    /// The weight with which it counts as overturned: a half if that is uncertain.
    #[must_use]
    pub fn overturned(&self) -> f64 {
        match self.ending.verdict() {
            Verdict::Survives => 0.0,
            // No sample answers with an incomplete history.
            Verdict::Incomplete | Verdict::Uncertain => 0.5,
            Verdict::Overturns => 1.0,
        }
    }

    /// The rotation at an instant; infinite, with its sign, once it has overturned.
    fn rotation_rad(&self, time: usize) -> f64 {
        let last = || {
            let last = self.course_rad.last().copied().map_or(0.0, f64::from);
            if self.goes_over() {
                f64::INFINITY.copysign(last)
            } else {
                last
            }
        };
        self.course_rad
            .get(time)
            .copied()
            .map_or_else(last, f64::from)
    }
}

/// The rotation at an instant, over all samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandAt {
    /// The time.
    pub time_s: f64,
    /// The rotation of the scenario itself; `None` once it has overturned.
    pub own_rad: Option<f64>,
    /// The 5 % quantile, the median and the 95 % quantile of the samples; infinite if enough of them have overturned.
    pub band_rad: [f64; 3],
    /// The number of samples that have overturned by then.
    pub overturned: usize,
}

/// The number of samples with each outcome.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcomes(pub Vec<(&'static str, Share)>);

impl Outcomes {
    /// The share of an outcome by its name in results.
    #[must_use]
    pub fn share(&self, name: &str) -> Option<Share> {
        let found = self.0.iter().find(|(outcome, _)| *outcome == name);
        found.map(|(_, share)| *share)
    }
}

impl Told<'_, Went> {
    /// The shares of all outcomes, including those that no sample has.
    pub(crate) fn outcomes(&self) -> Outcomes {
        let names = [
            "overturned",
            "uncertain",
            "rest",
            "never_moved",
            "vibrates",
            "still_rocking",
        ];
        let all = self.answered().count();
        let shares = names.into_iter().filter_map(|name| {
            let of = |went: &&Went| went.ending.outcome_name() == name;
            let count = self.answered().map(|(_, went)| went).filter(of).count();
            Some((name, Share::of(count, all)?))
        });
        Outcomes(shares.collect())
    }

    /// The bands of the rotation over time.
    pub(crate) fn bands(&self, asked: &Histories) -> Vec<BandAt> {
        let at = |time: usize| {
            let rotations: Vec<f64> = self
                .answered()
                .map(|(_, went)| went.rotation_rad(time))
                .collect();
            let own = self.own.as_ref().ok().map(|went| went.rotation_rad(time));
            Some(BandAt {
                time_s: time as f64 * asked.step_s,
                own_rad: own.filter(|rotation| rotation.is_finite()),
                overturned: rotations
                    .iter()
                    .filter(|rotation| rotation.is_infinite())
                    .count(),
                band_rad: band(rotations, quantile)?,
            })
        };
        (0..asked.times).filter_map(at).collect()
    }
}
