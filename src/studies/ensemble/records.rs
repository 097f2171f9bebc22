//! The intensity from which each record of a suite overturns each sample: fragility due to the records, to uncertain numbers, and to both.

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::{NoAnswer, Question, Told, told};
use crate::output::{Figure, OutputError};
use crate::scenario::{Measure, Scenario, Suite};
use crate::studies::ending::Ending;
use crate::studies::results::Results;
use crate::studies::statistics::{bootstrap, fractile, interval};
use crate::studies::suite::case;
use crate::studies::threshold::first_edge::FirstEdge;

/// Relative width to which an intensity is bisected: far less than the scatter between records.
const WIDTH: f64 = 2e-3;

/// The records of a suite, and its levels in ascending order.
#[derive(Clone, Debug)]
pub struct Capacities {
    suite: Suite,
    levels: Vec<f64>,
}

impl Capacities {
    /// The measure of the intensities.
    #[must_use]
    pub const fn measure(&self) -> Measure {
        self.suite.measure
    }

    /// The levels to try, ascending.
    #[must_use]
    pub fn levels(&self) -> &[f64] {
        &self.levels
    }

    const fn signs(&self) -> usize {
        if self.suite.both_signs { 2 } else { 1 }
    }

    /// The file of each record, and whether it is mirrored, in the order of the answers.
    pub(crate) fn shakes(&self) -> impl Iterator<Item = (&str, bool)> {
        let records = self.suite.records.iter();
        records.flat_map(|series| {
            let signs = [false, true].into_iter().take(self.signs());
            signs.map(|mirrored| (series.file.as_str(), mirrored))
        })
    }
}

/// The intensity from which each record overturns a sample; the mirrored record follows each record.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Capacity(pub Vec<FirstEdge>);

impl Capacities {
    /// The question about a scenario.
    ///
    /// # Errors
    /// Explains what to change.
    pub fn of(scenario: &Scenario) -> Result<Self, String> {
        scenario.check_from_rest("suite")?;
        let suite = scenario
            .suite
            .as_ref()
            .ok_or("the scenario has no [suite], whose records shake the samples")?;
        Ok(Self {
            levels: suite.levels.values(),
            suite: suite.clone(),
        })
    }
}

impl Question for Capacities {
    type Answer = Capacity;

    const NAME: &'static str = "uncertain_suite";

    fn results(
        &self,
        told: &Told<'_, Self::Answer>,
        figure: Figure,
    ) -> Result<Results, OutputError> {
        told::capacities(told, self, figure)
    }

    fn answer(&self, scenario: &Scenario) -> Result<Capacity, NoAnswer> {
        let model = scenario
            .model()
            .map_err(|error| NoAnswer::Invalid(error.to_string()))?;
        let edges = (0..self.suite.records.len() * self.signs()).map(|shake| {
            let (record, mirrored) = (shake / self.signs(), shake % self.signs() == 1);
            let verdict = |level: f64| {
                let (ground, request) = case(scenario, &self.suite, record, level, mirrored);
                let ending = Ending::of(&*model, &ground, &request);
                ending.map(|ending| ending.verdict())
            };
            FirstEdge::search(&self.levels, WIDTH, verdict)
        });
        edges.collect::<Result<_, _>>().map(Capacity)
    }
}

/// A distribution of the intensities that overturn, from its 16, 50 and 84 % fractiles. The dispersion is half the logarithm of the
/// ratio of the outer two, which for a lognormal distribution is the standard deviation of the logarithm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Distribution {
    /// The median; `None` if fewer than half of them overturn.
    pub median: Option<f64>,
    /// The dispersion; `None` if the upper fractile is not reached.
    pub dispersion: Option<f64>,
}

impl Distribution {
    /// From intensities in any order; infinite ones mean that nothing overturned.
    fn of(mut intensities: Vec<f64>) -> Self {
        intensities.sort_by(f64::total_cmp);
        let finite = |part| fractile(&intensities, part).filter(|at| at.is_finite());
        let [low, median, high] = [0.16, 0.5, 0.84].map(finite);
        Self {
            median,
            dispersion: low.zip(high).map(|(low, high)| 0.5 * (high / low).ln()),
        }
    }
}

/// A distribution, with the 95 % intervals of its median and its dispersion, by bootstrap over the records.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimated {
    /// The distribution.
    pub of: Distribution,
    /// Ends of the interval of the median, if it is known.
    pub median: Option<[f64; 2]>,
    /// The same for the dispersion.
    pub dispersion: Option<[f64; 2]>,
}

/// The three distributions.
#[derive(Clone, Debug, PartialEq)]
pub struct Fragilities {
    /// Due to the records: for the scenario itself.
    pub records: Estimated,
    /// Due to the uncertain numbers: for the median over the records of each sample.
    pub uncertain: Estimated,
    /// Due to both: for all samples under all records.
    pub both: Estimated,
}

/// The intensities of a sample, a list for each record.
type Intensities = Vec<Vec<f64>>;

/// The three distributions for these records, some of which may occur more than once.
fn distributions(
    own: &[Vec<f64>],
    samples: &[Intensities],
    records: &[usize],
) -> [Distribution; 3] {
    let chosen = |of: &[Vec<f64>]| -> Vec<f64> {
        records
            .iter()
            .filter_map(|record| of.get(*record))
            .flatten()
            .copied()
            .collect()
    };
    let median = |of: &Intensities| {
        let mut intensities = chosen(of);
        intensities.sort_by(f64::total_cmp);
        fractile(&intensities, 0.5)
    };
    [
        Distribution::of(chosen(own)),
        Distribution::of(samples.iter().filter_map(median).collect()),
        Distribution::of(samples.iter().flat_map(|of| chosen(of)).collect()),
    ]
}

impl<'a> Told<'a, Capacity> {
    /// The number of signs of each record that count: one if every mirrored record gives exactly what the record itself gives, as with
    /// four links of a symmetric structure.
    fn counted_signs(&self, asked: &Capacities) -> usize {
        let mut all = self
            .own
            .iter()
            .chain(self.answered().map(|(_, answer)| answer));
        let alike = all.all(|capacity| {
            let mut records = capacity.0.chunks(asked.signs());
            records.all(|signs| signs.iter().all(|edge| *edge == signs[0]))
        });
        if alike { 1 } else { asked.signs() }
    }

    /// The edges that count: of the scenario itself, and of all samples.
    pub(crate) fn counted(&self, asked: &Capacities) -> [Vec<&'a FirstEdge>; 2] {
        let signs = self.counted_signs(asked);
        let of = |capacity: &'a Capacity| -> Vec<&'a FirstEdge> {
            let records = capacity.0.chunks(asked.signs());
            records.flat_map(|edges| &edges[..signs]).collect()
        };
        [
            self.own.iter().flat_map(of).collect(),
            self.answered()
                .flat_map(|(_, capacity)| of(capacity))
                .collect(),
        ]
    }

    fn by_record(asked: &Capacities, signs: usize, capacity: &Capacity) -> Intensities {
        let records = capacity.0.chunks(asked.signs());
        let strengths = |edges: &[FirstEdge]| edges.iter().map(FirstEdge::strength).collect();
        records.map(|edges| strengths(&edges[..signs])).collect()
    }

    /// The fragility due to the records, to the uncertain numbers, and to both.
    pub(crate) fn fragilities(&self, asked: &Capacities) -> Fragilities {
        let signs = self.counted_signs(asked);
        let own = self
            .own
            .as_ref()
            .map_or_else(|_| Vec::new(), |own| Self::by_record(asked, signs, own));
        let samples: Vec<Intensities> = self
            .answered()
            .map(|(_, capacity)| Self::by_record(asked, signs, capacity))
            .collect();
        let count = asked.suite.records.len();
        let all: Vec<usize> = (0..count).collect();
        let found = distributions(&own, &samples, &all);
        let drawn: Vec<[Distribution; 3]> = bootstrap(count)
            .map(|drawn| distributions(&own, &samples, &drawn))
            .collect();
        let with_intervals = |which: usize| {
            let of = |number: fn(&Distribution) -> Option<f64>| {
                let numbers = drawn.iter().filter_map(|drawn| number(&drawn[which]));
                let numbers: Vec<f64> = numbers.collect();
                // If any draw lacks the number, there is no interval.
                (numbers.len() == drawn.len())
                    .then(|| interval(numbers))
                    .flatten()
            };
            Estimated {
                of: found[which],
                median: of(|one| one.median),
                dispersion: of(|one| one.dispersion),
            }
        };
        Fragilities {
            records: with_intervals(0),
            uncertain: with_intervals(1),
            both: with_intervals(2),
        }
    }

    /// The probability of overturning up to each level: due to the records, and due to both.
    pub(crate) fn at_levels(&self, asked: &Capacities) -> Vec<AtLevel> {
        let share = |edges: Vec<&FirstEdge>, level: f64| {
            let overturned = edges.iter().filter(|edge| edge.strength() <= level).count();
            (!edges.is_empty()).then(|| overturned as f64 / edges.len() as f64)
        };
        let at = |level: &f64| AtLevel {
            intensity: *level,
            records: self
                .own
                .as_ref()
                .ok()
                .and_then(|own| share(own.0.iter().collect(), *level)),
            both: share(
                self.answered()
                    .flat_map(|(_, capacity)| &capacity.0)
                    .collect(),
                *level,
            ),
        };
        asked.levels.iter().map(at).collect()
    }
}

/// The share of cases that overturn up to an intensity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AtLevel {
    /// The intensity.
    pub intensity: f64,
    /// For the records that shake the scenario itself.
    pub records: Option<f64>,
    /// For all samples under all records.
    pub both: Option<f64>,
}

impl Fragilities {
    /// Each with its name in results.
    pub(crate) const fn all(&self) -> [(&'static str, &Estimated); 3] {
        [
            ("record_to_record", &self.records),
            ("uncertain_data", &self.uncertain),
            ("both", &self.both),
        ]
    }

    pub(crate) fn to_json(&self) -> Value {
        let all = self.all().map(|(name, estimated)| {
            let of = json!({
                "median": estimated.of.median,
                "median_interval": estimated.median,
                "dispersion": estimated.of.dispersion,
                "dispersion_interval": estimated.dispersion,
            });
            (name.to_owned(), of)
        });
        Value::Object(all.into_iter().collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lognormal intensities from their quantiles: the fractiles give median and dispersion back, within the spacing of the 2000 values.
    #[test]
    fn fractiles_are_those_of_lognormal_intensities() {
        // Phi(1) = 0.8413: the fractile of 84 % is at 0.9945 deviations, and interpolation adds nothing to so many values.
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
        let found = Distribution::of(intensities);
        assert!(
            (found.median.unwrap() / 0.7 - 1.0).abs() < 1e-3,
            "{found:?}"
        );
        assert!(
            (found.dispersion.unwrap() - 0.4 * 0.9945).abs() < 1e-3,
            "{found:?}"
        );
        // The median is unknown if fewer than half of the intensities are finite.
        let none = Distribution::of(vec![1.0, f64::INFINITY, f64::INFINITY]);
        assert_eq!([none.median, none.dispersion], [None, None]);
    }
}
