//! Uncertain numbers: `[uncertain]`.
//!
//! ```toml
//! [uncertain]
//! samples = 100
//! seed = 1
//! "arch.thickness_ratio" = { deviation = 0.003 }
//! "free_hinges.friction_coefficient" = { from = 0.5, to = 0.8 }
//! ```
//!
//! Every number of another table may be uncertain. A sample gives each uncertain number a value, from one point of a Sobol sequence with Owen
//! scrambling.

use super::Scenario;
use super::prelude::*;
use super::sequence::Spacing;
use super::variant::{number, parts};
use crate::bisection::{Width, bisect, middle};

named! {
    /// Form of a distribution about the value in the scenario.
    pub enum DistributionForm {
        /// Normal distribution, with that value as its mean.
        Normal = "normal",
        /// Lognormal distribution, with that value as its median; the deviation is that of the logarithm.
        Lognormal = "lognormal",
    }
}

/// Distribution of an uncertain number.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Distribution {
    /// Uniform distribution over a range.
    Range {
        /// The smallest value.
        from: f64,
        /// The largest value.
        to: f64,
        /// Spacing: the values or their logarithms are uniformly distributed.
        spacing: Spacing,
    },
    /// Distribution about the value in the scenario, truncated at [`MAX_DEVIATIONS`].
    About {
        /// Standard deviation, in the unit of the key; that of the natural logarithm for a lognormal distribution.
        deviation: f64,
        /// The form of the distribution.
        #[serde(rename = "distribution")]
        form: DistributionForm,
    },
}

/// Number of standard deviations at which distributions are truncated.
pub const MAX_DEVIATIONS: f64 = 3.0;

/// An uncertain number of a scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct UncertainKey {
    /// Key of the number: `table.key`.
    pub key: String,
    /// Distribution of its values.
    pub distribution: Distribution,
    /// Value in the scenario; `None` if the scenario has no value.
    pub own: Option<f64>,
}

/// The uncertain numbers of a scenario, and the number of samples.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Uncertain {
    /// The number of samples, at least 1.
    pub samples: usize,
    /// Seed of the scrambling.
    pub seed: u32,
    /// True to compute total indices, which needs additional samples.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub total_indices: bool,
    /// The numbers, at least one, in the order of the file.
    #[serde(flatten, serialize_with = "serialize_by_key")]
    pub keys: Vec<UncertainKey>,
}

/// Range of the number of samples: the sequence has no more points.
const SAMPLES: Count = Count(1..=65_536, "one sample");
const SEED: Count = Count(0..=u32::MAX as usize, "the first");
/// Largest number of keys, because the sequence has that many dimensions.
const MAX_KEYS: usize = 256;
const DISTRIBUTION: &str = "must be a range, such as { from = 0.5, to = 0.8 }, or a deviation from the scenario's value, such as \
                      { deviation = 0.003 }";

impl Distribution {
    fn read(table: &mut Table<'_>) -> ReadResult<Self> {
        let from = table.optional("from", &ANY_NUMBER);
        let to = table.optional("to", &ANY_NUMBER);
        let spacing = table.optional("spacing", &one_of(Spacing::ALL));
        let deviation = table.optional("deviation", &above(0.0, 1e12));
        let distribution = table.optional("distribution", &one_of(DistributionForm::ALL));
        let relations = [
            OneOf(&["from", "deviation"], Some(DISTRIBUTION)),
            Together(&["from", "to"]),
            Requires("spacing", "from", " beside it"),
            Requires("distribution", "deviation", " beside it"),
            AtMostOne(&["from", "distribution"], DISTRIBUTION),
        ];
        table.check_relations(&relations)?;
        let Some((from, to)) = from.zip(to) else {
            return Ok(Self::About {
                deviation: deviation.ok_or(FaultRecorded)?,
                form: distribution.unwrap_or(DistributionForm::Normal),
            });
        };
        let spacing = spacing.unwrap_or(Spacing::Linear);
        let wrong = format!("is not above `from`; must be above {}", short(from));
        table.refuse(to <= from, "to", wrong)?;
        let has_zero = spacing == Spacing::Logarithmic && from <= 0.0;
        let wrong = "needs numbers above 0; use \"linear\" here";
        table.refuse(has_zero, "spacing", wrong)?;
        Ok(Self::Range { from, to, spacing })
    }

    /// Computes the quantile: the value below which the fraction `part` of all values lies, from 0 to 1. `own` is the value in the scenario.
    fn quantile(self, part: f64, own: f64) -> f64 {
        match self {
            Self::Range { from, to, spacing } => match spacing {
                Spacing::Linear => from * (1.0 - part) + to * part,
                Spacing::Logarithmic => {
                    (from * libm::exp(part * libm::log(to / from))).clamp(from, to)
                }
            },
            Self::About { deviation, form } => match form {
                DistributionForm::Normal => own + deviation * cut_normal(part),
                DistributionForm::Lognormal => own * libm::exp(deviation * cut_normal(part)),
            },
        }
    }
}

/// Probability that a standard normal variable is below this deviation.
fn normal(deviations: f64) -> f64 {
    0.5 * libm::erfc(-deviations * std::f64::consts::FRAC_1_SQRT_2)
}

/// Computes a quantile of the standard normal distribution truncated at [`MAX_DEVIATIONS`].
fn cut_normal(part: f64) -> f64 {
    let most = MAX_DEVIATIONS;
    let below = normal(-most);
    let wanted = below + part * (1.0 - 2.0 * below);
    // The ends are reported as bounds, so they are exact.
    if part <= 0.0 || part >= 1.0 {
        return if part <= 0.0 { -most } else { most };
    }
    let (low, high) = bisect(-most, most, Width::Absolute(1e-14), |deviations| {
        normal(deviations) >= wanted
    });
    middle(low, high)
}

/// Writes each key with its distribution.
fn serialize_by_key<S: Serializer>(
    keys: &[UncertainKey],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_map(keys.iter().map(|key| (&key.key, key.distribution)))
}

const TABLE: &str = "uncertain";
const TOTAL_INDICES: &str = "total_indices";

impl Uncertain {
    /// Reads `[uncertain]`. [`Uncertain::check`] checks it later against the rest of the scenario.
    pub(super) fn read(table: &mut Table<'_>) -> ReadResult<Self> {
        let samples = table.or("samples", &SAMPLES, 100);
        let seed = table.or("seed", &SEED, 1);
        let total_indices = table.or(TOTAL_INDICES, &switch(), false);
        let mut keys = Vec::new();
        for key in table.keys_of_other_tables() {
            if let Some(distribution) = table.table(&key, Distribution::read) {
                let own = None;
                keys.push(UncertainKey {
                    key,
                    distribution,
                    own,
                });
            }
        }
        table.check_faultless()?;
        let wrong = format!(
            "needs 1 to {MAX_KEYS} keys of other tables between quotation marks, such as \
             \"arch.thickness_ratio\" = {{ deviation = 0.003 }}"
        );
        table.refuse_all(!(1..=MAX_KEYS).contains(&keys.len()), wrong)?;
        let are_many = total_indices && 2 * keys.len() > MAX_KEYS;
        let wrong = format!("goes with at most {} keys", MAX_KEYS / 2);
        table.refuse(are_many, TOTAL_INDICES, wrong)?;
        Ok(Self {
            keys,
            samples,
            seed: u32::try_from(seed).unwrap_or(u32::MAX),
            total_indices,
        })
    }

    /// Adds the values in the scenario, and rejects keys and values that the scenario does not allow. The faults are recorded in the table that
    /// contains `[uncertain]`.
    pub(super) fn check(mut self, table: &mut Table<'_>, scenario: &Scenario) -> ReadResult<Self> {
        let mut faulty = Ok(());
        let known = [scenario.to_resolved_json(), scenario.resolved_values()];
        for index in 0..self.keys.len() {
            let (before, others) = self.keys.split_at_mut(index);
            if let Err(wrong) = others[0].add_scenario_value(before, &known) {
                faulty = Err(table.reject_in(&[TABLE], &self.keys[index].key, wrong));
            }
        }
        faulty?;
        let allows = |keys: &[UncertainKey], part: f64| {
            let values: Vec<_> = keys
                .iter()
                .map(|key| (&*key.key, key.quantile(part)))
                .collect();
            scenario.with_values(&values)
        };
        // Reading a scenario takes time, so all keys are tried together first.
        if PROBED.iter().all(|part| allows(&self.keys, *part).is_ok()) {
            return Ok(self);
        }
        for key in &self.keys {
            if let Err(wrong) = key.check(scenario) {
                faulty = Err(table.reject_in(&[TABLE], &key.key, wrong));
            }
        }
        faulty?;
        // Each key is allowed alone, so two keys set the same quantity.
        for count in 2..=self.keys.len() {
            if let Err(wrong) = allows(&self.keys[..count], 0.5) {
                let wrong = format!("contradicts the keys before it: {wrong}");
                return Err(table.reject_in(&[TABLE], &self.keys[count - 1].key, wrong));
            }
        }
        Ok(self)
    }

    /// Number of cases. With total indices, after all samples, each sample has one more case for each key, in which only that key
    /// has another value.
    pub fn cases(&self) -> usize {
        let keys = usize::from(self.total_indices) * self.keys.len();
        self.samples.saturating_mul(1 + keys)
    }

    /// Point of a sample, counted from 0: a number between 0 and 1, exclusive, for each key.
    pub fn point(&self, sample: usize) -> Vec<f64> {
        let keys = self.keys.len();
        // A case after the samples has the values of sample `like`, except for the key `other`.
        let (like, other) = match sample.checked_sub(self.samples) {
            Some(behind) if self.total_indices => (behind / keys, Some(behind % keys)),
            _ => (sample, None),
        };
        let at = |key: usize| {
            let dimension = if other == Some(key) { keys + key } else { key };
            self.coordinate(like, dimension)
        };
        (0..keys).map(at).collect()
    }

    /// Coordinate of a point of the sequence.
    fn coordinate(&self, index: usize, dimension: usize) -> f64 {
        // The sequence has numbers of 24 bits. The middle of the interval that is rounded down to such a number is used.
        const HALF_BIT: f64 = 0.5 / (1_u32 << 24) as f64;
        let whole = |number: usize| u32::try_from(number).unwrap_or(u32::MAX);
        let part = sobol_burley::sample(whole(index), whole(dimension), self.seed);
        f64::from(part) + HALF_BIT
    }

    /// Values of a sample, counted from 0, in the order of the keys.
    pub fn values(&self, sample: usize) -> Vec<f64> {
        let parts = self.point(sample).into_iter().zip(&self.keys);
        parts.map(|(part, key)| key.quantile(part)).collect()
    }

    /// Scenario with these values of the keys, without studies and without uncertain numbers.
    ///
    /// # Errors
    /// The reason why the scenario does not allow the values.
    pub fn scenario(&self, scenario: &Scenario, values: &[f64]) -> Result<Scenario, String> {
        let keys = self.keys.iter().map(|key| key.key.as_str());
        let values: Vec<_> = keys.zip(values.iter().copied()).collect();
        scenario.with_values(&values)
    }
}

/// Fractions of the distribution at which keys are tried: the smallest value, the largest value, and one that is not a whole number.
const PROBED: [f64; 3] = [0.0, 1.0, 0.381_966];

impl UncertainKey {
    /// Adds the value in the scenario. Rejects a key that is not a number, or is one of the previous keys. `known` is the scenario with the given
    /// keys, and with resolved ones.
    fn add_scenario_value(&mut self, before: &[Self], known: &[Value; 2]) -> Result<(), String> {
        let mut before = before.iter();
        let is_known = before.any(|other| parts(&other.key) == parts(&self.key));
        let wrong = "is the same as a key before it; leave one out";
        ensure(!is_known, || wrong)?;
        let own = known
            .iter()
            .find_map(|known| number(known, &self.key))
            .unwrap_or_default();
        self.own = own.as_f64();
        ensure(!own.is_i64() && !own.is_u64(), || {
            format!(
                "is the whole number {own} in the scenario; only numbers that may have a fraction are uncertain"
            )
        })?;
        let wrong = "is no number in the scenario; only numbers are uncertain";
        ensure(own.is_number() || own.is_null(), || wrong)?;
        let is_enough =
            self.own.is_some() || matches!(self.distribution, Distribution::Range { .. });
        ensure(is_enough, || {
            let key = &self.key;
            format!(
                "has no value in the scenario from which it could deviate: give {key} there, or a range here"
            )
        })
    }

    /// Rejects values that the scenario does not allow while all other keys have their own values.
    fn check(&self, scenario: &Scenario) -> Result<(), String> {
        let largest = self.quantile(0.0).abs().max(self.quantile(1.0).abs());
        for part in PROBED {
            // A bound that differs from zero by rounding errors only is zero.
            let value = Some(self.quantile(part))
                .filter(|value| value.abs() > 1e-12 * largest)
                .unwrap_or(0.0);
            let allowed = scenario.with_values(&[(&self.key, value)]);
            let value = plain(value);
            allowed.map_err(|wrong| {
                format!("reaches {value}, which the scenario does not allow: {wrong}")
            })?;
        }
        Ok(())
    }

    /// Computes the quantile: the value below which the fraction `part` of all values lies, from 0 to 1.
    pub fn quantile(&self, part: f64) -> f64 {
        self.distribution.quantile(part, self.own.unwrap_or(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The quantile function agrees with the density of the normal distribution, integrated by Simpson's rule.
    #[test]
    fn normal_values_are_cut_off_and_keep_their_shares() {
        let density = |x: f64| (-0.5 * x * x).exp();
        let integral = |to: f64| {
            let steps = 2000;
            let width = (to + 3.0) / f64::from(steps);
            let at = |step: i32| density(-3.0 + width * f64::from(step));
            let inner: f64 = (1..steps)
                .map(|step| if step % 2 == 0 { 2.0 } else { 4.0 } * at(step))
                .sum();
            width / 3.0 * (at(0) + inner + at(steps))
        };
        for part in [1e-6, 0.025, 0.3, 0.5, 0.9, 0.999] {
            let found = integral(cut_normal(part)) / integral(3.0);
            assert!((found - part).abs() < 1e-10, "{part} {found}");
        }
        assert_eq!([cut_normal(0.0), cut_normal(1.0)], [-3.0, 3.0]);
    }

    /// Of the first 2^m points of a Sobol sequence, scrambled or not, each of 2^m equal intervals holds one, in every
    /// dimension; and in the first two dimensions, each box of that area holds one.
    #[test]
    fn points_are_spread_evenly() {
        let key = |key: &str| UncertainKey {
            key: key.to_owned(),
            distribution: Distribution::Range {
                from: 0.0,
                to: 1.0,
                spacing: Spacing::Linear,
            },
            own: None,
        };
        for seed in [0, 1, 77] {
            let uncertain = Uncertain {
                keys: (0..20).map(|_| key("a.b")).collect(),
                samples: 256,
                seed,
                total_indices: false,
            };
            let points: Vec<_> = (0..256).map(|sample| uncertain.point(sample)).collect();
            let part = |value: f64, parts: f64| (value * parts).floor();
            for dimension in 0..20 {
                let mut parts: Vec<_> = points
                    .iter()
                    .map(|point| part(point[dimension], 256.0))
                    .collect();
                parts.sort_by(f64::total_cmp);
                assert!(
                    parts
                        .iter()
                        .zip(0..)
                        .all(|(part, index)| *part == f64::from(index))
                );
            }
            for (wide, high) in [(16.0, 16.0), (4.0, 64.0), (128.0, 2.0)] {
                let mut boxes: Vec<_> = points
                    .iter()
                    .map(|point| part(point[0], wide) * high + part(point[1], high))
                    .collect();
                boxes.sort_by(f64::total_cmp);
                assert!(
                    boxes
                        .iter()
                        .zip(0..)
                        .all(|(part, index)| *part == f64::from(index))
                );
            }
        }
    }
}
