//! Finer search below an edge: bands of factors narrower than a stride, which the search upwards steps over.
//!
//! Towards a band, histories come ever closer to overturning. So the factors are first tried in steps, and then halved where the closeness of neighbours,
//! extrapolated with its slope, reaches overturning. Histories are not repeated. docs/evidence.md has the measurement on which the constants rest.

use crate::argument::ArgumentError;
use crate::dynamics::repeatability::energy_over_barrier;
use crate::studies::ending::answered;
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
    /// Steps below the edge of a threshold.
    pub const THRESHOLD: Self = Self {
        step: 0.005,
        finest_step: 0.001,
        reach: 0.6,
    };
    /// Steps between the levels of a suite, whose records scatter far more than an edge.
    pub const LEVELS: Self = Self {
        step: 0.03,
        finest_step: 0.002,
        reach: 0.0,
    };
}

/// Closeness below which a history hides no band beside it.
const FAR: f64 = 0.3;
/// Factor on the slope of the closeness: a band is much narrower than its surroundings.
const STEEPER: f64 = 4.0;

/// The largest energy of a history over the energy that overturns the structure; infinite if the history does not survive.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Closeness(pub f64);

impl Closeness {
    /// Returns the closeness of a history. A structure whose barrier is unknown always counts as close.
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
                .unwrap_or(1.0),
        )
    }

    /// Closeness at an edge.
    pub const EDGE: Self = Self(1.0);

    fn survives(self) -> bool {
        self.0 < f64::INFINITY
    }
}

/// A history without repetitions, and how close it comes to overturning.
pub type UnrepeatedHistory = (Closeness, Result<Summary, SimulationError>);

/// Computes the histories of a model under several ground motions, in their order, without repetitions. They stop once they can no longer overturn.
pub fn unrepeated(
    model: &dyn Model,
    request: &Request,
    grounds: impl IntoIterator<Item = Result<GroundMotion, ArgumentError>>,
) -> Vec<UnrepeatedHistory> {
    let cases = grounds.into_iter().map(|ground| Ok((ground?, *request)));
    let histories = answered(cases, |cases| {
        model.simulate_all_until(EndCondition::Safe, cases)
    });
    let histories = histories.into_iter();
    histories
        .map(|history| (Closeness::of(model, request, &history), history))
        .collect()
}

/// Lowest factor below an edge whose history does not survive.
pub struct LowestHit {
    /// The factor.
    pub hit: f64,
    /// All lower tried factors, which survive, descending.
    pub lower: Vec<f64>,
}

impl LowestHit {
    /// Repeats the history of the hit, then those of the lower factors until one survives, and returns the lowest that does not, with its verdict, and
    /// the one that does; `None` if none does.
    ///
    /// # Errors
    /// Those of the histories.
    pub fn confirm<E>(
        self,
        verdict: impl Fn(f64) -> Result<Verdict, E>,
    ) -> Result<((f64, Verdict), Option<f64>), E> {
        let mut first = (self.hit, verdict(self.hit)?);
        for lower in self.lower {
            let found = verdict(lower)?;
            if found == Verdict::Survives {
                return Ok((first, Some(lower)));
            }
            first = (lower, found);
        }
        Ok((first, None))
    }
}

/// Finds the lowest factor below a safe one with its closeness, and not below `from`, whose history does not survive; `None` if all survive. `closeness`
/// computes the histories of descending factors.
///
/// # Errors
/// Those of the histories.
pub fn below_edge<E>(
    (safe, close): (f64, Closeness),
    from: f64,
    fineness: Fineness,
    mut closeness: impl FnMut(&[f64]) -> Result<Vec<Closeness>, E>,
) -> Result<Option<LowestHit>, E> {
    // Descending factors.
    let mut tried = vec![(safe, close)];
    let mut lowest = safe;
    loop {
        let least = from.max(fineness.reach * lowest);
        let last = tried.last().map_or(safe, |(factor, _)| *factor);
        let steps =
            std::iter::successors(Some(last), |factor| Some(factor / (1.0 + fineness.step)));
        let next: Vec<f64> = steps
            .skip(1)
            .take_while(|factor| *factor >= least)
            .collect();
        let next = match next.is_empty() {
            true => middles(&tried, lowest, fineness.finest_step),
            false => next,
        };
        if next.is_empty() {
            break;
        }
        let found = closeness(&next)?;
        tried.extend(next.into_iter().zip(found));
        tried.sort_by(|a, b| b.0.total_cmp(&a.0));
        let hits = tried.iter().filter(|(_, close)| !close.survives());
        lowest = hits.map(|(factor, _)| *factor).fold(safe, f64::min);
    }
    let lower = tried.iter().map(|(factor, _)| *factor);
    let lower = lower.filter(|factor| *factor < lowest).collect();
    Ok((lowest < safe).then_some(LowestHit { hit: lowest, lower }))
}

/// Returns the geometric middles between neighbouring factors up to the lowest hit that may hide a band.
fn middles(tried: &[(f64, Closeness)], lowest: f64, finest_step: f64) -> Vec<f64> {
    let below = tried.iter().filter(|(factor, _)| *factor <= lowest);
    let below: Vec<(f64, Closeness)> = below.copied().collect();
    let width = |index: usize| libm::log(below[index].0 / below[index + 1].0);
    let close = |index: usize| below[index].1.0.min(1.0);
    let slope = |index: usize| (close(index) - close(index + 1)).abs() / width(index);
    let Some(last) = below.len().checked_sub(1).filter(|last| *last > 0) else {
        return Vec::new();
    };
    let hides_band = |index: &usize| {
        let neighbours = index.saturating_sub(1)..=(index + 1).min(last - 1);
        let steepest = neighbours.map(slope).fold(0.0, f64::max);
        let closest = close(*index).max(close(index + 1));
        let is_wide = width(*index) > 1.5 * finest_step;
        let reaches = closest + STEEPER * steepest * width(*index) >= 1.0;
        is_wide && below[*index].1.survives() && closest > FAR && reaches
    };
    let wide = (0..last).filter(hides_band);
    let middle = |index: usize| libm::sqrt(below[index].0 * below[index + 1].0);
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

    /// Returns the lowest hit and the number of histories.
    fn search(from: f64, band: (f64, f64)) -> (Option<f64>, usize) {
        let mut histories = 0;
        let edge = (1.0, Closeness::EDGE);
        let found = below_edge(edge, from, Fineness::THRESHOLD, |factors| {
            histories += factors.len();
            assert!(factors.iter().all(|factor| (from..1.0).contains(factor)));
            let close = factors.iter().map(|factor| close_at(*factor, band));
            Ok::<_, Infallible>(close.collect())
        });
        let Ok(found) = found;
        for lower in found.iter().flat_map(|found| &found.lower) {
            assert!(close_at(*lower, band).survives());
        }
        (found.map(|found| found.hit), histories)
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
        let found = below_edge(edge, 0.1, Fineness::THRESHOLD, |factors| {
            Ok::<_, Infallible>(factors.iter().map(|factor| hits(*factor)).collect())
        });
        let Ok(found) = found;
        assert!((found.unwrap().hit / 0.5 - 1.0).abs() < 0.003);
    }
}
