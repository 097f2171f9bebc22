//! What matters: which share of the variance of an answer each uncertain number has.
//!
//! The first-order index of Sobol of a number is the part of the variance of the answer that would go if that number were
//! known, on average: `Var(E[Y | X]) / Var(Y)`. It is estimated from the samples as they are, without further ones: the
//! answer is expanded in cosines of the rank of the number, which are orthogonal for the equal distribution of ranks, and
//! the squares of the coefficients add up to that variance (Plischke, Rel. Eng. Syst. Safety 107, 2012). What noise of the
//! other numbers adds to the squares on average is taken off.

use serde::Serialize;

use super::statistics::{bootstrap, correlation, interval, moments, ranks};

/// How much an uncertain number matters.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Matters {
    /// Its first-order index, from 0 to 1.
    pub first_order: f64,
    /// The interval of 95 % of that, by bootstrap.
    pub first_order_interval: [f64; 2],
    /// Spearman's rank correlation with the answer: above 0 where larger numbers make it larger.
    pub rank_correlation: f64,
    /// The interval of 95 % of that, by bootstrap over the ranks as they are.
    pub rank_correlation_interval: [f64; 2],
}

/// Samples below which nothing is said.
pub const LEAST_SAMPLES: usize = 16;

/// Cosines of the expansion: enough for an answer that turns three times, and so few that their noise is small.
const MOST_HARMONICS: usize = 8;
/// Samples that each of them takes.
const SAMPLES_PER_HARMONIC: usize = 16;

/// How much each number matters for the answer of the samples: `values[sample][number]`, `answers[sample]`. `None` where the
/// answer does not vary, or there are fewer than [`LEAST_SAMPLES`].
#[must_use]
pub fn what_matters(values: &[Vec<f64>], answers: &[f64]) -> Option<Vec<Matters>> {
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
        let first_order = unbiased(raw, expansion.bias());
        // Drawing again adds as much noise once more.
        let drawn = resampled
            .iter()
            .filter_map(|drawn| expansion.index(drawn, answers))
            .map(|raw| unbiased(raw, 2.0 * expansion.bias()));
        let [low, high] = interval(drawn.collect())?;
        let pairs = |drawn: &[usize]| {
            let pairs = drawn
                .iter()
                .map(|index| (own_ranks[*index], answer_ranks[*index]));
            correlation(pairs)
        };
        let rank_correlation = pairs(&all)?;
        let drawn = resampled.iter().filter_map(|drawn| pairs(drawn));
        Some(Matters {
            first_order,
            first_order_interval: [low.min(first_order), high.max(first_order)],
            rank_correlation,
            rank_correlation_interval: interval(drawn.collect())?,
        })
    };
    (0..numbers).map(of).collect()
}

/// The part that is not noise of an index that grows by `bias` times what it does not explain.
fn unbiased(raw: f64, bias: f64) -> f64 {
    ((raw - bias) / (1.0 - bias)).clamp(0.0, 1.0)
}

/// Cosines of the ranks of a number: a list for each harmonic.
struct Expansion(Vec<Vec<f64>>);

impl Expansion {
    fn of(ranks: &[f64]) -> Self {
        let count = ranks.len();
        let harmonics = (count / SAMPLES_PER_HARMONIC).clamp(1, MOST_HARMONICS);
        let angles: Vec<f64> = ranks
            .iter()
            .map(|rank| std::f64::consts::PI * (rank - 0.5) / count as f64)
            .collect();
        let cosines = (1..=harmonics).map(|harmonic| {
            let cosine =
                |angle: &f64| std::f64::consts::SQRT_2 * libm::cos(harmonic as f64 * angle);
            angles.iter().map(cosine).collect()
        });
        Self(cosines.collect())
    }

    /// What noise alone would add to the index.
    fn bias(&self) -> f64 {
        let samples = self.0.first().map_or(1, Vec::len);
        self.0.len() as f64 / samples as f64
    }

    /// The part of the variance of the answers, of the samples of these numbers, that is a function of the number.
    fn index(&self, samples: &[usize], answers: &[f64]) -> Option<f64> {
        let chosen: Vec<f64> = samples.iter().map(|index| answers[*index]).collect();
        let [mean, variance] = moments(&chosen);
        let explained = self.0.iter().map(|cosines| {
            let terms = samples.iter().zip(&chosen);
            let sum: f64 = terms
                .map(|(index, answer)| (answer - mean) * cosines[*index])
                .sum();
            (sum / chosen.len() as f64).powi(2)
        });
        let explained: f64 = explained.sum();
        (variance > 0.0).then(|| explained / variance)
    }
}
