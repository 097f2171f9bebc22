//! The sensitivity of an answer to uncertain numbers: the share of the variance of an answer that is due to each number.
//!
//! Sobol's first-order index of a number is the part of the variance of the answer that would vanish, on average, if that number were known:
//! `Var(E[Y | X]) / Var(Y)`. It is estimated from the existing samples: the answer is expanded in cosines of the rank of the number. The cosines
//! are orthogonal for uniformly distributed ranks, and the squares of the coefficients add up to the numerator (Plischke, Rel. Eng. Syst. Safety
//! 107, 2012). The mean contribution of the other numbers to these squares is noise and is subtracted.

use serde::{Deserialize, Serialize};

use crate::studies::statistics::{bootstrap, correlation, interval, moments, ranks};

/// The sensitivity of an answer to an uncertain number.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sensitivity {
    /// First-order index, from 0 to 1.
    pub first_order: f64,
    /// 95 % interval of the first-order index, by bootstrap.
    pub first_order_interval: [f64; 2],
    /// Spearman's rank correlation with the answer: positive if larger numbers give larger answers.
    pub rank_correlation: f64,
    /// 95 % interval of the rank correlation, by bootstrap with the original ranks.
    pub rank_correlation_interval: [f64; 2],
    /// Total index; `None` without `total_indices` in the scenario.
    #[serde(flatten)]
    pub total: Option<Total>,
}

/// The total index of a number: the part of the variance of the answer that would remain, on average, if all other numbers were known, `E[Var(Y
/// | all others)] / Var(Y)`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Total {
    /// Total index, from 0 to 1; absent without `total_indices` in the scenario.
    pub total: f64,
    /// 95 % interval of the total index, by bootstrap; absent with it.
    pub total_interval: [f64; 2],
}

/// Computes the total index of each number, by the estimator of Jansen (Computer Physics Communications 117, 1999) with the design of Saltelli
/// and others (Computer Physics Communications 181, 2010).
///
/// `answers` has the answer of each sample. `moved` has, for each sample in turn, one answer per number: that of the sample with another value
/// of this number alone. `None` in either list means no answer. Returns `None` if the answers do not vary, or there are fewer than
/// `LEAST_SAMPLES`.
pub fn total_indices(answers: &[Option<f64>], moved: &[Option<f64>]) -> Option<Vec<Total>> {
    let numbers = moved.len() / answers.len().max(1);
    let samples: Vec<usize> = (0..answers.len())
        .filter(|sample| answers[*sample].is_some())
        .collect();
    if samples.len() < LEAST_SAMPLES {
        return None;
    }
    let half_square = |sample: usize, number: usize| {
        let difference = answers[sample]? - (*moved.get(sample * numbers + number)?)?;
        Some(0.5 * difference * difference)
    };
    let index = |number: usize, chosen: &[usize]| {
        let chosen = chosen.iter().map(|place| samples[*place]);
        let known: Vec<f64> = chosen
            .clone()
            .filter_map(|sample| answers[sample])
            .collect();
        let terms: Vec<f64> = chosen
            .filter_map(|sample| half_square(sample, number))
            .collect();
        let ([_, variance], [mean, _]) = (moments(&known), moments(&terms));
        (variance > 0.0 && !terms.is_empty()).then(|| (mean / variance).clamp(0.0, 1.0))
    };
    let all: Vec<usize> = (0..samples.len()).collect();
    let resampled: Vec<Vec<usize>> = bootstrap(samples.len()).collect();
    let of = |number: usize| {
        let drawn = resampled.iter().filter_map(|drawn| index(number, drawn));
        Some(Total {
            total: index(number, &all)?,
            total_interval: interval(drawn.collect())?,
        })
    };
    (0..numbers).map(of).collect()
}

/// Smallest number of samples for which a sensitivity is computed.
pub const LEAST_SAMPLES: usize = 16;

/// Largest number of cosines: enough for an answer with three extremes, and few enough to keep the noise small.
const MOST_HARMONICS: usize = 8;
/// Number of samples needed for each cosine.
const SAMPLES_PER_HARMONIC: usize = 16;

/// Computes the sensitivity of the answers of the samples to each number, from `values[sample][number]` and `answers[sample]`. `None` if the
/// answers do not vary, or there are fewer than `LEAST_SAMPLES`.
pub fn sensitivities(values: &[Vec<f64>], answers: &[f64]) -> Option<Vec<Sensitivity>> {
    let count = answers.len();
    if count < LEAST_SAMPLES || moments(answers)[1] <= 0.0 {
        return None;
    }
    let resampled: Vec<Vec<usize>> = bootstrap(count).collect();
    let answer_ranks = ranks(answers);
    let numbers = values.first().map_or(0, Vec::len);
    let of = |number: usize| {
        let own: Vec<f64> = values.iter().map(|values| values[number]).collect();
        let own_ranks = ranks(&own);
        let expansion = Expansion::of(&own_ranks);
        let all: Vec<usize> = (0..count).collect();
        let raw = expansion.index(&all, answers)?;
        let first_order = correct_bias(raw, expansion.bias());
        // Resampling adds noise of the same size again.
        let drawn = resampled
            .iter()
            .filter_map(|drawn| expansion.index(drawn, answers))
            .map(|raw| correct_bias(raw, 2.0 * expansion.bias()));
        let [low, high] = interval(drawn.collect())?;
        let pairs = |drawn: &[usize]| {
            let drawn = drawn.iter();
            correlation(drawn.map(|index| (own_ranks[*index], answer_ranks[*index])))
        };
        let rank_correlation = pairs(&all)?;
        let drawn = resampled.iter().filter_map(|drawn| pairs(drawn));
        Some(Sensitivity {
            first_order,
            first_order_interval: [low.min(first_order), high.max(first_order)],
            rank_correlation,
            rank_correlation_interval: interval(drawn.collect())?,
            total: None,
        })
    };
    (0..numbers).map(of).collect()
}

/// Corrects an index for noise. Noise increases the index by `bias` times the unexplained part.
fn correct_bias(raw: f64, bias: f64) -> f64 {
    ((raw - bias) / (1.0 - bias)).clamp(0.0, 1.0)
}

/// Cosines of the ranks of a number: a list of samples for each harmonic.
struct Expansion(Vec<Vec<f64>>);

impl Expansion {
    fn of(ranks: &[f64]) -> Self {
        let count = ranks.len();
        let harmonics = (count / SAMPLES_PER_HARMONIC).clamp(1, MOST_HARMONICS);
        let angle = |rank: &f64| std::f64::consts::PI * (rank - 0.5) / count as f64;
        let angles: Vec<f64> = ranks.iter().map(angle).collect();
        let cosines = (1..=harmonics).map(|harmonic| {
            let cosine =
                |angle: &f64| std::f64::consts::SQRT_2 * libm::cos(harmonic as f64 * angle);
            angles.iter().map(cosine).collect()
        });
        Self(cosines.collect())
    }

    /// Mean index of pure noise.
    fn bias(&self) -> f64 {
        let samples = self.0.first().map_or(1, Vec::len);
        self.0.len() as f64 / samples as f64
    }

    /// Computes the part of the variance of the answers of these samples that the expansion explains; `None` if the answers do not vary.
    fn index(&self, samples: &[usize], answers: &[f64]) -> Option<f64> {
        let chosen: Vec<f64> = samples.iter().map(|index| answers[*index]).collect();
        let [mean, variance] = moments(&chosen);
        let explained: f64 = self
            .0
            .iter()
            .map(|cosines| {
                let terms = samples.iter().zip(&chosen);
                let sum: f64 = terms
                    .map(|(index, answer)| (answer - mean) * cosines[*index])
                    .sum();
                (sum / chosen.len() as f64).powi(2)
            })
            .sum();
        (variance > 0.0).then(|| explained / variance)
    }
}
