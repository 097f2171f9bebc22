//! Finer search below an edge: bands of factors narrower than a stride, which the search upwards steps over.
//!
//! Towards a band, histories come ever closer to overturning. So the factors are first tried in steps, and then halved where the closeness of neighbours,
//! extrapolated with its slope, reaches overturning. Histories are not repeated. docs/evidence.md has the measurement on which the constants rest.

use crate::argument::ArgumentError;
use crate::dynamics::repeatability::energy_over_barrier;
use crate::studies::ending::answer_valid_cases;
use crate::{EndCondition, GroundMotion, Model, Request, SimulationError, Summary, Verdict};

/// Steps of the search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fineness {
    /// Relative step between the first factors.
    step: f64,
    /// Relative step at which factors are no longer halved.
    finest_step: f64,
    /// Part of the lowest factor known to overturn down to which lower ones are tried.
    reach: f64,
}

impl Fineness {
    /// Steps below the edge of a threshold of a mechanism, or of elastic joints.
    const THRESHOLD: Self = Self {
        step: 0.005,
        finest_step: 0.0005,
        reach: 0.6,
    };
    /// Steps below the edge of a threshold of a model. Blocks with free hinges have half the steps: after tens of impacts, a history
    /// hardly shows how close its neighbours come to overturning.
    pub fn of_threshold(model: &dyn Model) -> Self {
        let has_free_hinges = model.as_mechanisms().is_none() && model.has_impacts();
        let part = if has_free_hinges { 0.5 } else { 1.0 };
        Self {
            step: part * Self::THRESHOLD.step,
            ..Self::THRESHOLD
        }
    }

    /// Steps below the edges of samples, which scatter more than an edge.
    pub const SAMPLES: Self = Self {
        step: 0.02,
        finest_step: 0.002,
        reach: 0.6,
    };
    /// Steps between the levels of a suite, whose records scatter far more than an edge.
    pub const LEVELS: Self = Self {
        step: 0.01,
        finest_step: 0.0015,
        reach: 0.0,
    };

    /// Expected number of histories after a halving, counted from 1, over that of this halving.
    fn histories_after_halving(self, halving: u32) -> f64 {
        let last = libm::ceil(libm::log2(self.step / (WIDE * self.finest_step)));
        let left = (last - f64::from(halving)).max(0.0);
        (libm::pow(GROWTH, left + 1.0) - GROWTH) / (GROWTH - 1.0)
    }
}

/// Width of a step, over the finest one, from which it is halved.
const WIDE: f64 = 1.5;
/// Closeness below which a history hides no band beside it.
const FAR: f64 = 0.3;
/// Number of first steps in a group. After each group, the steps that will be halved are counted.
const GROUP: usize = 24;
/// Expected number of histories after the first steps, over that of first steps: for estimates of the time left before the first group is computed.
const AFTER_STEPS: f64 = 1.0;
/// Expected number of histories of a halving, over that of the halving before.
const GROWTH: f64 = 1.5;
/// Factor on the slope of the closeness: a band is much narrower than its surroundings.
const STEEPER: f64 = 8.0;

/// The largest energy of a history over the energy that overturns the structure; infinite if the history does not survive.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Closeness(pub f64);

impl Closeness {
    /// Closeness at an edge.
    pub const EDGE: Self = Self(1.0);

    /// Closeness of a history. Where the barrier is unknown, as after large slip, steps are not halved: all of them would be, at eight times the
    /// cost.
    fn of(
        model: &dyn Model,
        request: &Request,
        history: &Result<Summary, SimulationError>,
    ) -> Self {
        let survives = |history: &&Summary| Verdict::from(history.outcome) == Verdict::Survives;
        let Some(history) = history.as_ref().ok().filter(survives) else {
            return Self(f64::INFINITY);
        };
        // Near the unstable equilibrium the potential energy of a mechanism is a parabola of the rotation.
        let of_mechanism = |peak: f64| 1.0 - (1.0 - peak.min(1.0)) * (1.0 - peak.min(1.0));
        let own = history.peak_over_critical().map(of_mechanism);
        Self(
            own.or_else(|| energy_over_barrier(model, request, history))
                .unwrap_or(FAR),
        )
    }

    fn survives(self) -> bool {
        self.0 < f64::INFINITY
    }
}

/// A history at a factor, without repetitions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FineHistory {
    /// The factor.
    pub factor: f64,
    /// How close it comes to overturning.
    pub close: Closeness,
    /// Excess of the thrust line, as in [`Ending`](crate::studies::Ending).
    pub thrust_excess_ratio: Option<f64>,
    /// Friction coefficient that it requires without slip; `None` if joints slip or are elastic.
    pub friction_demand: Option<f64>,
}

impl FineHistory {
    /// Makes a history of which only the closeness is known.
    pub const fn new(factor: f64, close: Closeness) -> Self {
        Self {
            factor,
            close,
            thrust_excess_ratio: None,
            friction_demand: None,
        }
    }

    /// Computes the histories of a model at factors, in their order, under the ground motions at these factors. They stop once they can no longer
    /// overturn.
    pub fn of_all(
        model: &dyn Model,
        request: &Request,
        factors: &[f64],
        ground: impl Fn(f64) -> Result<GroundMotion, ArgumentError>,
    ) -> Vec<Self> {
        let cases = factors
            .iter()
            .map(|factor| Ok((ground(*factor)?, *request)));
        let histories = answer_valid_cases(cases, |cases| {
            model.simulate_all_until(EndCondition::Safe, cases)
        });
        let of = |(factor, history): (&f64, Result<Summary, SimulationError>)| {
            let close = Closeness::of(model, request, &history);
            let known = history.as_ref().ok();
            Self {
                thrust_excess_ratio: known.and_then(Summary::thrust_excess_ratio),
                friction_demand: known.and_then(Summary::required_friction),
                ..Self::new(*factor, close)
            }
        };
        factors.iter().zip(histories).map(of).collect()
    }

    /// Closer one of this history and that under the mirrored ground motion, with the larger excess and friction demand of both.
    pub fn or_closer(self, mirrored: Self) -> Self {
        let larger = |one: Option<f64>, other| one.into_iter().chain(other).reduce(f64::max);
        Self {
            factor: self.factor,
            close: Closeness(self.close.0.max(mirrored.close.0)),
            thrust_excess_ratio: larger(self.thrust_excess_ratio, mirrored.thrust_excess_ratio),
            friction_demand: larger(self.friction_demand, mirrored.friction_demand),
        }
    }
}

/// The lowest edge that a search below an edge found, with repeated histories.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LowestEdge {
    /// The lowest factor that does not survive.
    pub factor: f64,
    /// Its verdict.
    pub verdict: Verdict,
    /// The next lower tried factor, which survives; `None` if none does.
    pub survived: Option<f64>,
}

/// The histories of a search below an edge.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FineSearch {
    /// The edge, then all histories, by descending factors.
    pub histories: Vec<FineHistory>,
}

impl FineSearch {
    /// Index of the lowest history that does not survive; `None` if all survive.
    fn lowest_index(&self) -> Option<usize> {
        let mut histories = self.histories.iter();
        histories.rposition(|history| !history.close.survives())
    }

    /// Lowest factor whose history does not survive, and the survived factor above those next to it that do not survive either: the ends of
    /// a band, of which both are survived or repeated. `None` if all survive.
    pub fn upper_edge(&self) -> Option<(f64, f64)> {
        let above = &self.histories[..=self.lowest_index()?];
        let survived = above.iter().rposition(|history| history.close.survives())?;
        Some((above[survived + 1].factor, above[survived].factor))
    }

    /// Repeats the lowest history that does not survive, then those at lower factors until one survives. `None` if all histories survive.
    ///
    /// # Errors
    /// Those of the histories.
    pub fn confirm_lowest<E>(
        &self,
        mut verdict: impl FnMut(f64) -> Result<Verdict, E>,
    ) -> Result<Option<LowestEdge>, E> {
        let Some(lowest) = self.lowest_index() else {
            return Ok(None);
        };
        let factors = self.histories[lowest..].iter().map(|one| one.factor);
        let mut edge: Option<LowestEdge> = None;
        for factor in factors {
            match (verdict(factor)?, &mut edge) {
                (Verdict::Survives, Some(edge)) => {
                    edge.survived = Some(factor);
                    break;
                }
                (verdict, edge) => {
                    *edge = Some(LowestEdge {
                        factor,
                        verdict,
                        survived: None,
                    });
                }
            }
        }
        Ok(edge)
    }
}

/// Searches below a safe factor of known closeness, and not below `from`, for histories that do not survive. `histories` computes those of descending
/// factors; it is given the expected number of later ones.
///
/// # Errors
/// Those of the histories.
pub fn search_below_edge<E>(
    (safe, close): (f64, Closeness),
    from: f64,
    fineness: Fineness,
    mut histories: impl FnMut(&[f64], usize) -> Result<Vec<FineHistory>, E>,
) -> Result<FineSearch, E> {
    let mut search = FineSearch {
        histories: vec![FineHistory::new(safe, close)],
    };
    let mut halvings = 0_u32;
    loop {
        let tried = &search.histories;
        let lowest = search.lowest_index().unwrap_or(0);
        let least = from.max(fineness.reach * tried[lowest].factor);
        let last = tried[tried.len() - 1].factor;
        let steps =
            std::iter::successors(Some(last), |factor| Some(factor / (1.0 + fineness.step)));
        let mut next: Vec<f64> = steps
            .skip(1)
            .take_while(|factor| *factor >= least)
            .collect();
        let halved = || middles(&tried[lowest..], fineness.finest_step);
        let later = if next.is_empty() {
            halvings += 1;
            next = halved();
            fineness.histories_after_halving(halvings) * next.len() as f64
        } else {
            let steps = next.len();
            next.truncate(GROUP);
            let after_steps = match tried.len() {
                ..=GROUP => AFTER_STEPS * steps as f64,
                _ => (1.0 + fineness.histories_after_halving(1)) * halved().len() as f64,
            };
            after_steps + (steps - next.len()) as f64
        };
        if next.is_empty() {
            return Ok(search);
        }
        search.histories.extend(histories(&next, later as usize)?);
        search
            .histories
            .sort_by(|a, b| b.factor.total_cmp(&a.factor));
    }
}

/// Geometric middles between neighbouring factors that may hide a band. The first history is the edge or does not survive.
fn middles(below: &[FineHistory], finest_step: f64) -> Vec<f64> {
    let width = |index: usize| libm::log(below[index].factor / below[index + 1].factor);
    let close = |index: usize| below[index].close.0.min(1.0);
    let slope = |index: usize| (close(index) - close(index + 1)).abs() / width(index);
    let Some(last) = below.len().checked_sub(1).filter(|last| *last > 0) else {
        return Vec::new();
    };
    let hides_band = |index: &usize| {
        let neighbours = index.saturating_sub(1)..=(index + 1).min(last - 1);
        let steepest = neighbours.map(slope).fold(0.0, f64::max);
        let closest = close(*index).max(close(index + 1));
        let is_wide = width(*index) > WIDE * finest_step;
        let reaches = closest + STEEPER * steepest * width(*index) >= 1.0;
        is_wide && below[*index].close.survives() && closest > FAR && reaches
    };
    let wide = (0..last).filter(hides_band);
    let middle = |index: usize| libm::sqrt(below[index].factor * below[index + 1].factor);
    wide.map(middle).collect()
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;

    use super::*;

    /// Closeness of histories that rises gently to an edge at 1, and in a steep peak to a band; the history overturns where it reaches 1.
    fn close_at(factor: f64, (centre, width): (f64, f64)) -> Closeness {
        let peak = 1.02 - 0.02 * ((factor - centre) / (0.5 * width)).abs().powf(0.7);
        let close = (0.9 * factor * factor).max(peak);
        Closeness(if close >= 1.0 { f64::INFINITY } else { close })
    }

    fn fine(factors: &[f64], close: impl Fn(f64) -> Closeness) -> Vec<FineHistory> {
        let of = |factor: &f64| FineHistory::new(*factor, close(*factor));
        factors.iter().map(of).collect()
    }

    /// Lowest hit and the number of histories.
    fn search(from: f64, band: (f64, f64)) -> (Option<f64>, usize) {
        let (mut histories, mut expected) = (0, Vec::new());
        let edge = (1.0, Closeness::EDGE);
        let found = search_below_edge(edge, from, Fineness::THRESHOLD, |factors, later| {
            histories += factors.len();
            expected.push(histories + later);
            assert!(factors.iter().all(|factor| (from..1.0).contains(factor)));
            Ok::<_, Infallible>(fine(factors, |factor| close_at(factor, band)))
        });
        let Ok(found) = found;
        // Estimates of all histories hold within a factor of 2.5, and end with their number.
        let mut good = expected.iter().map(|all| *all as f64 / histories as f64);
        assert!(
            good.clone().all(|over| (0.4..2.5).contains(&over)),
            "{expected:?}"
        );
        assert_eq!(good.next_back(), Some(1.0));
        let lowest = found.lowest_index();
        if let Some(lowest) = lowest {
            let (hit, survived) = found.upper_edge().unwrap();
            assert!(hit < survived && !close_at(hit, band).survives());
            assert!(survived == 1.0 || close_at(survived, band).survives());
            let lower = &found.histories[lowest + 1..];
            assert!(lower.iter().all(|one| one.close.survives()));
        }
        (
            lowest.map(|lowest| found.histories[lowest].factor),
            histories,
        )
    }

    /// Bands of 0.15 % are found down to 0.6 of the edge, with far fewer histories than steps of 0.1 % need (511).
    #[test]
    fn narrow_bands_below_an_edge_are_found() {
        for centre in [0.9873, 0.9312, 0.8531, 0.7717, 0.6109] {
            let (hit, histories) = search(0.1, (centre, 0.0015 * centre));
            assert!((hit.unwrap() / centre - 1.0).abs() < 0.00076, "{hit:?}");
            assert!(histories < 330, "{histories}");
        }
        assert_eq!(search(0.1, (0.3, 0.001)).0, None);
        assert_eq!(search(0.95, (0.9312, 0.0015)).0, None);
    }

    /// Below a band that was found, the search reaches as far as below the edge.
    #[test]
    fn the_search_goes_on_below_a_band() {
        let hits = |factor: f64| {
            let both = [(0.8, 0.002), (0.5, 0.002)].map(|band| close_at(factor, band));
            if both[0].0 > both[1].0 {
                both[0]
            } else {
                both[1]
            }
        };
        let edge = (1.0, Closeness::EDGE);
        let found = search_below_edge(edge, 0.1, Fineness::THRESHOLD, |factors, _| {
            Ok::<_, Infallible>(fine(factors, hits))
        });
        let Ok(found) = found;
        // Repeated, the histories near 0.5 do not survive down to 0.49.
        let verdict = |factor: f64| {
            let survives = factor < 0.49;
            Ok::<_, Infallible>(if survives {
                Verdict::Survives
            } else {
                Verdict::Uncertain
            })
        };
        let Ok(confirmed) = found.confirm_lowest(verdict);
        let edge = confirmed.unwrap();
        assert_eq!(edge.verdict, Verdict::Uncertain);
        assert!((0.49..0.4925).contains(&edge.factor) && edge.survived.unwrap() < 0.49);
    }
}
