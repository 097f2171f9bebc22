//! The search for the threshold of a model in one direction of the ground motion: upwards in strides, then to the edges, then finely below the first
//! one.

use std::ops::ControlFlow;

use super::below::{Closeness, FineHistory, FineSearch, Fineness, search_below_edge};
use super::factors::{EDGE_WIDTH, SearchedFactors, UNCERTAIN_EDGE_WIDTH};
use super::{FactorSample, Survival, Threshold};
use crate::bisection::{Width, next_middles, try_bisect};
use crate::dynamics::Direction;
use crate::studies::ending::{Ending, NoHistory, Verdict, answer_valid_cases};
use crate::studies::runner::in_parallel;
use crate::studies::{Counted, Progress, Runner, RunnerError, SearchStep, StudyError};
use crate::{GroundMotion, Model, Request, SimulationError};

/// Largest number of bisection steps computed ahead: three steps are seven histories.
const STEPS_AHEAD: usize = 3;

/// Number of bisection steps computed together, for a model that computes histories faster together, or if threads are idle because there are
/// fewer edges. Results do not depend on it: of the histories ahead, only those that the bisection reaches count.
fn steps_together(model: &dyn Model, edges: usize) -> usize {
    let idle = rayon::current_num_threads() / edges.max(1);
    match model.lanes() > 1 {
        true => STEPS_AHEAD,
        // Two steps are three histories.
        false => (idle + 1).ilog2().clamp(1, STEPS_AHEAD as u32) as usize,
    }
}

/// Number of factors computed together on the way up to the first collapse. It does not depend on the number of threads, so that no result does.
const TOGETHER: usize = 16;

/// The model, the ground motion in a direction, and the request.
#[derive(Clone, Copy)]
pub(super) struct Shaking<'a> {
    pub(super) direction: Direction,
    pub(super) model: &'a dyn Model,
    /// The model with the longer steps of many cases, for histories that nobody quotes: all but those at edges. `None` if there is none.
    pub(super) faster: Option<&'a dyn Model>,
    pub(super) ground: &'a GroundMotion,
    pub(super) request: &'a Request,
    pub(super) searched: &'a SearchedFactors,
}

/// Histories of a search that are no samples.
pub(super) struct OtherHistories {
    pub(super) bisected: Vec<FactorSample>,
    /// Histories below the first edge, without repetitions.
    pub(super) fine: Vec<FineHistory>,
}

/// Edges: neighbouring factors with different verdicts.
type Edges = Vec<(f64, f64)>;

/// Step of a search after these samples.
fn step_after(samples: &[FactorSample], is_open: bool) -> SearchStep {
    let survives = |sample: &&FactorSample| sample.verdict() == Some(Verdict::Survives);
    let safe = samples.iter().take_while(survives).last();
    SearchStep {
        safe_up_to: safe.map(|sample| sample.factor),
        is_open,
    }
}

/// Function that reports the progress of a step of a search.
fn report_step(
    step: SearchStep,
    mut watch: impl FnMut(Progress) -> ControlFlow<()>,
) -> impl FnMut(Progress) -> ControlFlow<()> {
    move |progress| {
        watch(Progress {
            counted: Counted::Search(step),
            ..progress
        })
    }
}

impl Shaking<'_> {
    fn fastest(&self) -> &dyn Model {
        self.faster.unwrap_or(self.model)
    }

    /// Finds the threshold of the model with this name among these ascending factors. Returns it with the other histories: those of bisections, and
    /// those of the search below the first edge.
    pub(super) fn threshold(
        &self,
        name: &str,
        factors: &[f64],
        runner: &Runner,
        mut watch: impl FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<(Threshold, OtherHistories), StudyError> {
        let mut samples = self.search_upwards(factors, runner, &mut watch)?;
        self.compute_edges_again(&mut samples, runner, &mut watch)?;
        let (mut edges, mut others) = self.bisect(&mut samples, runner, &mut watch)?;
        let first = Threshold::new(name.to_owned(), *self.searched, samples, &edges);
        let safe = Survival::of_threshold(&first).survives_up_to;
        let mut samples = first.samples;
        let mut fine = FineSearch::default();
        if let Some(safe) = safe {
            let found = (&mut samples, &mut edges);
            let tried;
            (tried, fine) = self.search_below(safe, found, runner, &mut watch)?;
            others.extend(tried);
        }
        if let (Some(safe), Some(_)) = (safe, self.faster) {
            self.compute_demand_again(safe, &mut samples, &mut fine.histories);
        }
        let threshold = Threshold {
            direction: self.direction,
            ..Threshold::new(first.model, *self.searched, samples, &edges)
        };
        let fine = fine.histories;
        Ok((
            threshold,
            OtherHistories {
                bisected: others,
                fine,
            },
        ))
    }

    /// Computes the histories for these ascending factors, or up to the first one that certainly overturns the structure.
    fn search_upwards(
        &self,
        factors: &[f64],
        runner: &Runner,
        mut watch: impl FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Vec<FactorSample>, RunnerError> {
        let ends_at_collapse = self.searched.ends_at_collapse;
        let mut samples: Vec<FactorSample> = Vec::new();
        for some in factors.chunks(TOGETHER) {
            let (before, all) = (samples.len(), factors.len());
            let step = step_after(&samples, ends_at_collapse);
            let mut watch = report_step(step, &mut watch);
            let watch = |progress: Progress| {
                let done = before + progress.done;
                watch(Progress {
                    done,
                    all,
                    ..progress
                })
            };
            let found = self.compute_in_parallel(
                some,
                |some| self.samples(self.fastest(), some),
                runner,
                watch,
            )?;
            samples.extend(found);
            let overturns = |sample: &FactorSample| sample.verdict() == Some(Verdict::Overturns);
            let first = samples.iter().position(overturns);
            if let Some(first) = first.filter(|_| ends_at_collapse) {
                samples.truncate(first + 1);
                break;
            }
        }
        Ok(samples)
    }

    /// Computes samples at edges again, with the steps of a run, until the verdicts on both sides of each edge have these steps. So has the last sample,
    /// which is quoted if no factor overturns the structure.
    fn compute_edges_again(
        &self,
        samples: &mut [FactorSample],
        runner: &Runner,
        mut watch: impl FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<(), RunnerError> {
        let mut again = vec![self.faster.is_none(); samples.len()];
        loop {
            let differs = |pair: &[FactorSample]| pair[0].verdict() != pair[1].verdict();
            let is_at_edge = |index: usize| {
                let neighbours = &samples[index.saturating_sub(1)..samples.len().min(index + 2)];
                index + 1 == samples.len() || neighbours.windows(2).any(differs)
            };
            let wanted = (0..samples.len()).filter(|index| !again[*index] && is_at_edge(*index));
            let wanted: Vec<usize> = wanted.collect();
            if wanted.is_empty() {
                return Ok(());
            }
            let factors: Vec<f64> = wanted.iter().map(|index| samples[*index].factor).collect();
            let watch = report_step(step_after(samples, false), &mut watch);
            let compute = |some: &[f64]| self.samples(self.model, some);
            let found = self.compute_in_parallel(&factors, compute, runner, watch)?;
            for (index, sample) in wanted.into_iter().zip(found) {
                (samples[index], again[index]) = (sample, true);
            }
        }
    }

    /// Computes the largest friction demand up to a safe factor, which is quoted, with the steps of a run: again and again, until the largest one has these
    /// steps.
    fn compute_demand_again(
        &self,
        safe: f64,
        samples: &mut [FactorSample],
        fine: &mut [FineHistory],
    ) {
        let mut again = Vec::new();
        loop {
            let endings = samples.iter_mut().filter_map(|sample| {
                let ending = sample.result.as_mut().ok()?;
                Some((sample.factor, &mut ending.friction_demand))
            });
            let fine = fine.iter_mut();
            let fine = fine.map(|history| (history.factor, &mut history.friction_demand));
            let up_to_safe = endings.chain(fine).filter(|(factor, _)| *factor <= safe);
            let largest = up_to_safe.max_by(|(_, one), (_, other)| {
                let value = |demand: &Option<f64>| demand.unwrap_or(0.0);
                value(one).total_cmp(&value(other))
            });
            match largest {
                Some((factor, demand)) if demand.is_some() && !again.contains(&factor) => {
                    again.push(factor);
                    let sample = self.samples(self.model, &[factor]).remove(0);
                    *demand = sample.result.ok().and_then(|ending| ending.friction_demand);
                }
                _ => return,
            }
        }
    }

    /// Computes results for several factors on all threads, in their order.
    fn compute_in_parallel<R: Send>(
        &self,
        factors: &[f64],
        compute: impl Fn(&[f64]) -> Vec<R> + Sync,
        runner: &Runner,
        watch: impl FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Vec<R>, RunnerError> {
        let family = |_| (self.model.lanes() > 1).then_some(0);
        let results_of = |indices: &[usize]| {
            let some = indices.iter().map(|index| factors[*index]);
            compute(&some.collect::<Vec<_>>())
        };
        runner.each_of_families(factors.len(), family, results_of, watch)
    }

    /// Finds the edges between neighbouring samples with different verdicts. Adds histories with a third verdict to the samples, and returns the edges
    /// and all other histories.
    fn bisect(
        &self,
        samples: &mut Vec<FactorSample>,
        runner: &Runner,
        watch: impl FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<(Edges, Vec<FactorSample>), RunnerError> {
        let pairs = samples.windows(2).map(|pair| (&pair[0], &pair[1]));
        let changes: Vec<Change<'_>> = pairs
            .filter(|(below, above)| {
                let both = below.verdict().zip(above.verdict());
                both.is_some_and(|(below, above)| below != above)
            })
            .collect();
        let search = |index: usize| self.search(changes[index], changes.len());
        let watch = report_step(step_after(samples, false), watch);
        let found = runner.each(changes.len(), search, watch)?;
        let (mut edges, mut tried) = (Vec::new(), Vec::new());
        for found in found.into_iter().flatten() {
            match found {
                EdgeStep::Edge(low, high) => edges.push((low, high)),
                EdgeStep::Met(sample) => samples.push(*sample),
                EdgeStep::Tried(sample) => tried.push(sample),
            }
        }
        samples.sort_by(|a, b| a.factor.total_cmp(&b.factor));
        Ok((edges, tried))
    }

    /// Searches below the first edge for factors whose histories do not survive. Adds the lowest to the samples, with the next lower factor that is
    /// certainly survived, and adds their edges. Returns the other histories of bisections, and those of the search.
    fn search_below(
        &self,
        safe: f64,
        (samples, edges): (&mut Vec<FactorSample>, &mut Edges),
        runner: &Runner,
        mut watch: impl FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<(Vec<FactorSample>, FineSearch), RunnerError> {
        let step = step_after(samples, false);
        let mut before = 0;
        let histories = |factors: &[f64], later: usize| {
            let compute = |some: &[f64]| {
                let ground = |factor| self.ground.scaled(factor);
                FineHistory::of_all(self.fastest(), self.request, some, ground)
            };
            let mut watch = report_step(step, &mut watch);
            let found = self.compute_in_parallel(factors, compute, runner, |progress| {
                watch(Progress {
                    done: before + progress.done,
                    all: before + factors.len() + later,
                    ..progress
                })
            });
            before += factors.len();
            found
        };
        let edge = (safe, Closeness::EDGE);
        let fine = search_below_edge(
            edge,
            self.searched.from,
            Fineness::of_threshold(self.model),
            histories,
        )?;
        let mut lower: Vec<FactorSample> = Vec::new();
        let repeated = |factor: f64| {
            lower.splice(0..0, self.samples(self.model, &[factor]));
            Ok::<_, RunnerError>(lower[0].verdict().unwrap_or(Verdict::Incomplete))
        };
        fine.confirm_lowest(repeated)?;
        if let Some((hit, _)) = fine.upper_edge()
            && lower.iter().all(|sample| sample.factor != hit)
        {
            lower.extend(self.samples(self.model, &[hit]));
        }
        let (found, tried) = self.bisect(&mut lower, runner, watch)?;
        edges.extend(found);
        edges.extend(fine.upper_edge());
        samples.extend(lower);
        samples.sort_by(|a, b| a.factor.total_cmp(&b.factor));
        Ok((tried, fine))
    }

    fn sample(&self, factor: f64, result: Result<Ending, NoHistory>) -> FactorSample {
        let direction = self.direction;
        let result = result.map(|ending| Ending {
            direction,
            ..ending
        });
        FactorSample { factor, result }
    }

    /// Computes the histories of a model for several factors, in their order.
    fn samples(&self, model: &dyn Model, factors: &[f64]) -> Vec<FactorSample> {
        let cases = factors.iter().map(|factor| {
            let ground = self.ground.scaled(*factor);
            Ok((ground.map_err(SimulationError::from)?, *self.request))
        });
        let endings = answer_valid_cases(cases, |cases| Ending::of_all(model, cases));
        let samples = factors.iter().copied().zip(endings);
        samples
            .map(|(factor, result)| self.sample(factor, result))
            .collect()
    }

    /// Finds the edge between neighbouring factors with different verdicts, one of a number of `edges`. If a history has a third verdict, returns this
    /// history and the edges on both sides of it; if a history fails, returns that history. The other histories come with it.
    fn search(&self, (below, above): Change<'_>, edges: usize) -> Vec<EdgeStep> {
        let is_uncertain = [below, above]
            .map(FactorSample::verdict)
            .contains(&Some(Verdict::Uncertain));
        let width = Width::Relative(if is_uncertain {
            UNCERTAIN_EDGE_WIDTH
        } else {
            EDGE_WIDTH
        });
        let steps = steps_together(self.model, edges);
        let compute = |factors: &[f64]| match self.model.lanes() > 1 {
            true => self.samples(self.model, factors),
            false => in_parallel(factors, |factor| self.samples(self.model, &[*factor])).concat(),
        };
        let (mut low, mut high) = (below.factor, above.factor);
        let mut ahead: Vec<FactorSample> = Vec::new();
        let mut found = Vec::new();
        let edge = try_bisect(low, high, width, |factor| {
            let known = |ahead: &[FactorSample]| ahead.iter().position(|it| it.factor == factor);
            let place = known(&ahead).unwrap_or_else(|| {
                ahead = compute(&next_middles(low, high, width, steps));
                // The first history ahead is the one that is needed now.
                0
            });
            let sample = ahead.swap_remove(place);
            let is_above = match sample.verdict() {
                verdict if verdict == below.verdict() => {
                    low = factor;
                    false
                }
                verdict if verdict == above.verdict() => {
                    high = factor;
                    true
                }
                _ => return Err(Box::new(sample)),
            };
            found.push(EdgeStep::Tried(sample));
            Ok(is_above)
        });
        match edge {
            Ok((low, high)) => found.push(EdgeStep::Edge(low, high)),
            Err(met) => {
                if met.verdict().is_some() {
                    found.extend(self.search((below, &*met), edges));
                    found.extend(self.search((&*met, above), edges));
                }
                found.push(EdgeStep::Met(met));
            }
        }
        found
    }
}

/// Neighbouring samples with different verdicts.
type Change<'a> = (&'a FactorSample, &'a FactorSample);

/// Result of a search between neighbouring samples.
enum EdgeStep {
    /// Two close factors with different verdicts.
    Edge(f64, f64),
    /// A history between the samples that failed or has a third verdict.
    Met(Box<FactorSample>),
    /// Another history of the bisection.
    Tried(FactorSample),
}
