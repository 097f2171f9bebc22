//! Fragility: the probability that ground motions of a given intensity overturn the structure.
//!
//! A suite of records, each at several intensities and perhaps with both signs, gives cases that overturn and cases that survive. The curve
//! through these cases is lognormal,
//!
//! `P(overturns | x) = Phi(ln(x / theta) / beta)`,
//!
//! with the median `theta` and the dispersion `beta` of maximum likelihood (Baker, "Efficient analytical fragility function fitting using
//! dynamic structural analysis", Earthquake Spectra 31(1), 2015). The log-likelihood is the sum, over all cases, of the logarithm of the
//! probability of the observed outcome. With `eta = a + b ln x`, `b = 1 / beta` and `theta = exp(-a / b)` this is probit regression. Its
//! log-likelihood is concave in `a` and `b`, so Newton's method finds the only maximum from any start. In one dimension the maximum exists
//! unless one intensity separates the cases that overturn from those that survive (Silvapulle, "On the existence of maximum likelihood
//! estimators for the binomial response models", Journal of the Royal Statistical Society B 43, 1981).
//!
//! # Uncertainty
//!
//! There are two sets of standard errors. The first is the inverse of the observed information, and assumes that all cases are independent.
//! Cases of one record are not independent: a record that is harmless for its intensity is harmless at every scale. So more levels without more
//! records add less information than this set shows. The second set allows for any dependence within a record (Liang and Zeger, "Longitudinal
//! data analysis using generalized linear models", Biometrika 73, 1986): the scores of the likelihood are summed for each record, and the
//! scatter of these sums replaces the scatter of independent cases. The factor `G / (G - 1)` for `G` records is the usual correction for small
//! samples (Cameron and Miller, "A practitioner's guide to cluster-robust inference", Journal of Human Resources 50(2), 2015). With fewer than
//! about thirty records these errors, too, tend to be too small.
//!
//! Both sets are first-order approximations: they hold if the errors are small compared with the dispersion. The 95 % intervals use neither: they take each
//! record as one value of a lognormal distribution. Their measured coverage is in docs/evidence.md.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use nalgebra::{Matrix2, Vector2};
use thiserror::Error;

use crate::argument::plain;
use crate::studies::intervals::{dispersion_interval, median_interval, student_quantile};
use crate::studies::statistics::TWO_SIDED_95;

/// The outcome of a record at one intensity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    /// Intensity of the ground motion, positive, in any unit; the median has the same unit.
    pub intensity: f64,
    /// 1 if the structure overturned, 0 if it survived, and the fraction of the repetitions that overturn if this is uncertain. A fraction counts in
    /// the likelihood as that part of a case that overturned, and the rest of a case that survived.
    pub overturned: f64,
    /// Index of the record. Cases of one record are not independent.
    pub record: usize,
}

/// The share of cases at one intensity that overturned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fraction {
    /// The intensity.
    pub intensity: f64,
    /// Number of cases.
    pub cases: usize,
    /// Number of cases that overturned; uncertain ones count with their fractions.
    pub overturned: f64,
}

/// Standard errors of the parameters of a [`Fragility`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// Standard error of the median, in the unit of the median.
    pub median: f64,
    /// Standard error of the dispersion.
    pub dispersion: f64,
}

/// A lognormal fragility curve with its uncertainty. All numbers are finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fragility {
    /// Median `theta`: the intensity at which half of the cases overturn.
    pub median: f64,
    /// Dispersion `beta`: standard deviation of the logarithm of the overturning intensity.
    pub dispersion: f64,
    /// Standard errors under the assumption that all cases are independent.
    pub independent: Errors,
    /// Standard errors that allow for any dependence within a record; `None` with one record.
    pub clustered: Option<Errors>,
    /// The maximum of the log-likelihood.
    pub log_likelihood: f64,
    /// Number of records.
    records: usize,
    line: FittedLine,
    /// Covariance of level and slope of the line under the assumption that all cases are independent.
    covariance: Matrix2<f64>,
    /// Covariance of level and slope, allowing for dependence within records.
    clustered_covariance: Option<Matrix2<f64>>,
}

/// Reasons why a fragility curve cannot be fitted.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum NoFit {
    /// An intensity has no finite logarithm.
    #[error("intensity {0}: must be positive and finite")]
    Intensity(f64),
    /// There are no cases.
    #[error("no cases to fit a fragility curve to: run records at several intensities")]
    NoObservations,
    /// Every case survives: their number, and the highest intensity.
    #[error(
        "{} up to the intensity {highest}: add higher intensities",
        count_in_words(*.0, "the only case does not overturn", |cases| format!("none of {cases} cases overturns")),
        highest = plain(*.1)
    )]
    NoneOverturned(usize, f64),
    /// No case survives: their number, and the lowest intensity.
    #[error(
        "{} down to the intensity {lowest}: add lower intensities",
        count_in_words(*.0, "the only case overturns", |cases| format!("all {cases} cases overturn")),
        lowest = plain(*.1)
    )]
    AllOverturned(usize, f64),
    /// All cases have one intensity, so the growth of the fraction is unknown: the intensity, the number of cases, and the number of overturned
    /// cases.
    #[error(
        "{2} of {1} cases overturn, but all at the intensity {intensity}: add lower and higher ones",
        intensity = plain(*.0)
    )]
    OneIntensity(f64, usize, usize),
    /// One intensity separates survival from overturning, so the likelihood increases as the dispersion goes to zero: the highest intensity of a
    /// survived case, and the lowest of an overturned case.
    #[error(
        "no case overturns below an intensity of {overturned} and none survives above {survived}: the median is about there, and the \
         dispersion is too small for these levels; add closer ones there",
        overturned = plain(*.1), survived = plain(*.0)
    )]
    Separated(f64, f64),
    /// The curve of maximum likelihood is horizontal or falls: the geometric mean intensity of the survived cases, and that of the overturned
    /// cases.
    #[error(
        "the fraction that overturns does not increase with the intensity: the geometric mean intensity of \
         cases that overturn is {overturned}, of those that survive {survived}; add intensities at which few and at which most cases \
         overturn, or more records",
        overturned = plain(*.1), survived = plain(*.0)
    )]
    NotIncreasing(f64, f64),
    /// The fraction grows so little, or over so narrow a range, that the parameters or their errors are not finite.
    #[error(
        "the fraction that overturns hardly grows with the intensity, and the likeliest curve cannot be \
         computed; add intensities at which few and at which most cases overturn"
    )]
    Undetermined,
}

/// Number of cases in words, which differ for one case.
fn count_in_words(cases: usize, only: &str, several: fn(usize) -> String) -> String {
    match cases {
        1 => only.to_owned(),
        _ => several(cases),
    }
}

impl Fragility {
    /// Probability that a ground motion of intensity `x` overturns the structure; zero at zero intensity.
    pub fn probability(&self, x: f64) -> f64 {
        normal_probability(self.line.value_at(logarithm(x)))
    }

    /// Ends of the 95 % interval of the median, by Student's distribution for the number of records; `None` with one record.
    pub fn median_interval(&self) -> Option<[f64; 2]> {
        median_interval(self.median, self.dispersion, self.records)
    }

    /// Ends of the 95 % interval of the dispersion, by the chi-square distribution for the number of records; `None` with one record.
    pub fn dispersion_interval(&self) -> Option<[f64; 2]> {
        dispersion_interval(self.dispersion, self.records)
    }

    /// Pointwise 95 % confidence band of the curve at intensity `x`: `Phi(eta -+ t s)`. `s` is the larger standard error of
    /// `eta`, with or without dependence within records, and `t` is Student's quantile for the number of records, 1.96 with one record.
    pub fn band(&self, x: f64) -> (f64, f64) {
        let log = logarithm(x);
        let gradient = Vector2::new(1.0, log - self.line.pivot);
        let independent = standard_error(&self.covariance, &gradient);
        let error = self.clustered_covariance.map_or(independent, |covariance| {
            independent.max(standard_error(&covariance, &gradient))
        });
        let quantile = match self.records {
            0 | 1 => TWO_SIDED_95,
            records => student_quantile(records - 1),
        };
        let (eta, margin) = (self.line.value_at(log), quantile * error);
        let [low, high] = [eta - margin, eta + margin].map(normal_probability);
        (low, high)
    }

    /// Makes the curve of a line, with first-order errors; `None` if a number is out of range.
    fn new(best: &Likelihood, observations: &[Observation]) -> Option<Self> {
        let line = best.line;
        let covariance = Matrix2::from_diagonal(&best.information.map(f64::recip));
        let clustered_covariance = clustered_covariance(&line, &covariance, observations);

        // `theta = exp(pivot - level / slope)` and `beta = 1 / slope`.
        let (level, dispersion) = (line.coefficients.x, line.coefficients.y.recip());
        let median = libm::exp(line.pivot - level * dispersion);
        let log_median_gradient = Vector2::new(-1.0, level * dispersion) * dispersion;
        let dispersion_gradient = Vector2::new(0.0, -dispersion * dispersion);
        let errors = |covariance: &Matrix2<f64>| Errors {
            median: median * standard_error(covariance, &log_median_gradient),
            dispersion: standard_error(covariance, &dispersion_gradient),
        };
        let independent = errors(&covariance);
        let clustered = clustered_covariance.as_ref().map(errors);

        let sound = |errors: &Errors| errors.median.is_finite() && errors.dispersion.is_finite();
        let mut records: Vec<usize> = observations.iter().map(|case| case.record).collect();
        records.sort_unstable();
        records.dedup();
        let in_range = median.is_normal()
            && dispersion.is_normal()
            && sound(&independent)
            && clustered.as_ref().is_none_or(sound);
        in_range.then_some(Self {
            median,
            dispersion,
            independent,
            clustered,
            log_likelihood: best.logarithm,
            records: records.len(),
            line,
            covariance,
            clustered_covariance,
        })
    }
}

/// `ln x` with `x` clamped to positive finite numbers, so that the logarithm is finite.
fn logarithm(x: f64) -> f64 {
    libm::log(x.clamp(f64::MIN_POSITIVE, f64::MAX))
}

/// Groups cases by intensity, the lowest first. Only exactly equal intensities form a group.
pub(super) fn group_by_intensity<T: Copy>(
    mut cases: Vec<T>,
    intensity: impl Fn(T) -> f64,
) -> Vec<(f64, Vec<T>)> {
    cases.sort_by(|a, b| intensity(*a).total_cmp(&intensity(*b)));
    cases
        .chunk_by(|a, b| intensity(*a) == intensity(*b))
        .map(|alike| (intensity(alike[0]), alike.to_vec()))
        .collect()
}

/// Fraction of overturned cases at each intensity, the lowest first.
pub fn fractions(observations: &[Observation]) -> Vec<Fraction> {
    group_by_intensity(observations.to_vec(), |case| case.intensity)
        .into_iter()
        .map(|(intensity, cases)| Fraction {
            intensity,
            cases: cases.len(),
            // Adding zero makes a negative zero positive.
            overturned: cases.iter().map(|case| case.overturned).sum::<f64>() + 0.0,
        })
        .collect()
}

/// Fits the lognormal fragility curve of maximum likelihood. The order of the observations does not matter.
///
/// # Errors
///
/// [`NoFit`] if the likelihood has no maximum with a positive dispersion, or an intensity is not positive
/// and finite.
pub fn fit(observations: &[Observation]) -> Result<Fragility, NoFit> {
    let levels = fractions(observations);
    demand_two_levels(&levels)?;
    demand_overlap_and_growth(&levels)?;
    let best = Likelihood::largest(&levels).ok_or(NoFit::Undetermined)?;
    Fragility::new(&best, observations).ok_or(NoFit::Undetermined)
}

/// Checks that there are overturned and survived cases, at two or more intensities, all valid.
fn demand_two_levels(levels: &[Fraction]) -> Result<(), NoFit> {
    let mut intensities = levels.iter().map(|level| level.intensity);
    if let Some(wrong) = intensities.find(|at| !(*at > 0.0 && at.is_finite())) {
        return Err(NoFit::Intensity(wrong));
    }
    let (Some(lowest), Some(highest)) = (levels.first(), levels.last()) else {
        return Err(NoFit::NoObservations);
    };
    let (lowest, highest) = (lowest.intensity, highest.intensity);
    let cases = levels.iter().map(|level| level.cases).sum();
    let mut ends = [0, 1].map(|kind| levels.iter().map(move |level| level.numbers()[kind]));
    match ends.each_mut().map(|numbers| numbers.sum::<f64>()) {
        [overturned, _] if overturned <= 0.0 => Err(NoFit::NoneOverturned(cases, highest)),
        [_, survived] if survived <= 0.0 => Err(NoFit::AllOverturned(cases, lowest)),
        [overturned, _] if libm::log(highest) == libm::log(lowest) => Err(NoFit::OneIntensity(
            lowest,
            cases,
            overturned.round() as usize,
        )),
        _ => Ok(()),
    }
}

impl Fraction {
    fn log(&self) -> f64 {
        libm::log(self.intensity)
    }

    /// Number of overturned cases and the number of survived cases.
    const fn numbers(&self) -> [f64; 2] {
        [self.overturned, self.cases as f64 - self.overturned]
    }

    /// Log-probability of the outcomes of the cases, at the linear predictor `eta`.
    fn log_probability(&self, eta: f64) -> LogProbability {
        let [overturned, survived] = self.numbers();
        let [fall, survival] = [eta, -eta].map(LogProbability::at);
        LogProbability {
            value: overturned * fall.value + survived * survival.value,
            slope: overturned * fall.slope - survived * survival.slope,
            bend: overturned * fall.bend + survived * survival.bend,
        }
    }
}

/// Rounding error of the difference between two mean logarithms, over their range.
const ROUNDING: f64 = 1e-12;

/// Checks that the likelihood has a maximum with a positive slope.
///
/// If no survived case has a larger intensity than an overturned case, the likelihood increases with the slope without limit. The slope at the
/// maximum has the sign of the derivative of the log-likelihood by the slope, at zero slope and the best level. With `n` cases this derivative
/// is `n phi(a)` times the mean logarithm of the overturning intensities minus that of the survived intensities.
fn demand_overlap_and_growth(levels: &[Fraction]) -> Result<(), NoFit> {
    let last_survival = levels.iter().rfind(|level| level.numbers()[1] > 0.0);
    let first_fall = levels.iter().find(|level| level.overturned > 0.0);
    let (Some(survival), Some(fall)) = (last_survival, first_fall) else {
        return Ok(());
    };
    if survival.log() <= fall.log() {
        return Err(NoFit::Separated(survival.intensity, fall.intensity));
    }
    let [overturned, survived] = [0, 1].map(|kind| {
        let counts = levels.iter().map(|level| level.numbers()[kind]);
        let logs = levels.iter().zip(counts.clone());
        logs.map(|(level, count)| count * level.log()).sum::<f64>() / counts.sum::<f64>()
    });
    let range = levels[levels.len() - 1].log() - levels[0].log();
    if overturned - survived <= ROUNDING * range {
        return Err(NoFit::NotIncreasing(
            libm::exp(survived),
            libm::exp(overturned),
        ));
    }
    Ok(())
}

/// The linear predictor `eta = level + slope (ln x - pivot)`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct FittedLine {
    pivot: f64,
    /// Level and slope.
    coefficients: Vector2<f64>,
}

impl FittedLine {
    fn value_at(&self, log: f64) -> f64 {
        self.coefficients.x + self.coefficients.y * (log - self.pivot)
    }
}

/// The likelihood of a line. The pivot is the mean of the logarithms weighted by their information. The information about level and slope is
/// then a diagonal matrix, and narrow ranges lose no digits.
struct Likelihood {
    line: FittedLine,
    logarithm: f64,
    /// Derivatives of the log-likelihood by level and slope.
    score: Vector2<f64>,
    /// Negative second derivatives of the log-likelihood by level and by slope.
    information: Vector2<f64>,
}

/// Largest number of Newton steps. About ten are usual; levels that almost coincide, with others hundreds of decades away, needed 114.
const STEPS: usize = 1000;

/// Largest number of halvings of a step that does not increase the likelihood.
const HALVINGS: usize = 60;

/// Tolerance of the squared length of a Newton step, in standard errors of level and slope.
const SHORT: f64 = 1e-20;

impl Likelihood {
    fn at(levels: &[Fraction], mut line: FittedLine) -> Self {
        let terms: Vec<LogProbability> = levels
            .iter()
            .map(|level| level.log_probability(line.value_at(level.log())))
            .collect();
        let information: f64 = terms.iter().map(|term| term.bend).sum();
        let lever: f64 = (levels.iter().zip(&terms))
            .map(|(level, term)| term.bend * (level.log() - line.pivot))
            .sum();
        let pivot = line.pivot + lever / information;
        line.coefficients.x = line.value_at(pivot);
        line.pivot = pivot;
        let mut likelihood = Self {
            line,
            logarithm: 0.0,
            score: Vector2::zeros(),
            information: Vector2::zeros(),
        };
        for (level, term) in levels.iter().zip(&terms) {
            let arm = level.log() - pivot;
            likelihood.logarithm += term.value;
            likelihood.score += Vector2::new(term.slope, term.slope * arm);
            likelihood.information += Vector2::new(term.bend, term.bend * arm * arm);
        }
        likelihood
    }

    /// Finds the maximum of the likelihood by Newton's method with step halving, starting from a probability of one half everywhere. `None` if
    /// the search does not converge.
    fn largest(levels: &[Fraction]) -> Option<Self> {
        let equal_chances = FittedLine {
            pivot: levels[0].log(),
            coefficients: Vector2::zeros(),
        };
        let mut best = Self::at(levels, equal_chances);
        for _ in 0..STEPS {
            let step = best.score.component_div(&best.information);
            if best.score.dot(&step) <= SHORT {
                return Some(best);
            }
            // Near the maximum the gain of a good step is less than the rounding error.
            let least = best.logarithm * (1.0 + ROUNDING);
            let mut line = best.line;
            let from = line.coefficients;
            let next = |step: Vector2<f64>| {
                line.coefficients = from + step;
                Self::at(levels, line)
            };
            let steps = std::iter::successors(Some(step), |step| Some(step * 0.5));
            let mut nexts = steps.take(HALVINGS).map(next);
            best = nexts.find(|next| next.logarithm >= least)?;
        }
        None
    }
}

/// Standard error of a quantity with this gradient by level and slope.
fn standard_error(covariance: &Matrix2<f64>, gradient: &Vector2<f64>) -> f64 {
    let variance = gradient.dot(&(covariance * gradient));
    // With few records the matrix may be singular, and rounding errors may make the variance negative. Infinity stays infinite.
    variance.clamp(0.0, f64::INFINITY).sqrt()
}

/// Computes the covariance of level and slope with any dependence within records, from the covariance without dependence: the sandwich `C M C G
/// / (G - 1)`, where `M` sums the squares of the scores of `G` records. `None` with one record.
fn clustered_covariance(
    line: &FittedLine,
    covariance: &Matrix2<f64>,
    observations: &[Observation],
) -> Option<Matrix2<f64>> {
    let mut sorted = observations.to_vec();
    sorted.sort_by(|a, b| {
        (a.record.cmp(&b.record))
            .then(a.intensity.total_cmp(&b.intensity))
            .then(a.overturned.total_cmp(&b.overturned))
    });
    let mut records = 0;
    let mut squares = Matrix2::zeros();
    // Derivatives of the log-probability of the outcome of a case by level and slope.
    let score = |case: &Observation| {
        let case = fractions(&[*case])[0];
        let slope = case.log_probability(line.value_at(case.log())).slope;
        Vector2::new(slope, slope * (case.log() - line.pivot))
    };
    for record in sorted.chunk_by(|a, b| a.record == b.record) {
        let score: Vector2<f64> = record.iter().map(score).sum();
        records += 1;
        squares += score * score.transpose();
    }
    let factor = f64::from(records) / f64::from(records - 1);
    (records > 1).then(|| covariance * squares * covariance * factor)
}

/// `Phi(eta)`.
fn normal_probability(eta: f64) -> f64 {
    0.5 * libm::erfc(-eta * FRAC_1_SQRT_2)
}

/// The logarithm of a probability, and its derivatives by the linear predictor `eta`.
struct LogProbability {
    value: f64,
    /// First derivative.
    slope: f64,
    /// Negative second derivative; positive, because the logarithm is concave.
    bend: f64,
}

/// Largest `eta` of the tail of the normal distribution. In the tail `h + eta` loses digits, and `Phi` eventually underflows.
const TAIL: f64 = -5.0;

/// Number of terms of the continued fraction in the tail: full precision at `TAIL`.
const TERMS: u32 = 40;

impl LogProbability {
    /// `ln Phi(eta)` with its derivatives `h = phi / Phi` and `-h (h + eta)`.
    fn at(eta: f64) -> Self {
        if eta < TAIL {
            // Laplace's continued fraction: with t = -eta, h - t = 1/(t + 2/(t + 3/(t + ...))).
            let terms = (1..=TERMS).rev().map(f64::from);
            let excess = terms.fold(0.0, |rest, k| k / (rest - eta));
            let slope = excess - eta;
            return Self {
                value: -0.5 * eta * eta - libm::log(slope * (2.0 * PI).sqrt()),
                slope,
                bend: slope * excess,
            };
        }
        let probability = normal_probability(eta);
        let slope = libm::exp(-0.5 * eta * eta) / ((2.0 * PI).sqrt() * probability);
        Self {
            // Above zero the complement has more digits.
            value: match eta > 0.0 {
                true => libm::log1p(-normal_probability(-eta)),
                false => libm::log(probability),
            },
            slope,
            bend: slope * (slope + eta),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `(eta, ln Phi, h, h (h + eta))`, computed with forty digits.
    const REFERENCE: [(f64, f64, f64, f64); 8] = [
        (
            -1_000.0,
            -500_007.826_694_812_16,
            1_000.000_999_998,
            0.999_999_000_006,
        ),
        (
            -40.0,
            -804.608_442_013_753_8,
            40.024_968_847_207_26,
            0.999_377_331_621_408_6,
        ),
        (
            -8.0,
            -35.013_437_159_914_55,
            8.121_368_112_236_112,
            0.985_675_116_556_659_1,
        ),
        (
            -5.0,
            -15.064_998_393_988_725,
            5.186_503_967_125_842,
            0.967_303_565_382_887_8,
        ),
        (
            -1.0,
            -1.841_021_645_009_263_6,
            1.525_135_276_160_981,
            0.800_902_334_429_651_2,
        ),
        (
            0.5,
            -0.368_946_415_288_656_4,
            0.509_160_433_837_033_5,
            0.513_824_564_303_632_9,
        ),
        (
            3.0,
            -0.001_350_809_964_748_193_8,
            0.004_437_839_042_125_664,
            0.013_333_211_541_740_806,
        ),
        (
            7.5,
            -3.190_891_672_910_947e-14,
            2.434_320_533_029_087_4e-13,
            1.825_740_399_771_874_7e-12,
        ),
    ];

    fn assert_close(value: f64, reference: f64, relative: f64) {
        assert!(
            (value - reference).abs() <= relative * reference.abs(),
            "{value} {reference}"
        );
    }

    #[test]
    fn logarithms_of_the_normal_distribution_keep_their_digits() {
        for (eta, value, slope, bend) in REFERENCE {
            let at = LogProbability::at(eta);
            // At -5, h + eta = 0.19 has lost a digit and a half; exp(-x^2 / 2) loses one digit at 7.5.
            assert_close(at.value, value, 1e-14);
            assert_close(at.slope, slope, 2e-14);
            assert_close(at.bend, bend, 1e-13);
        }
    }

    #[test]
    fn the_tail_continues_the_middle() {
        let below = LogProbability::at(TAIL.next_down());
        let above = LogProbability::at(TAIL);
        assert_close(below.value, above.value, 1e-14);
        assert_close(below.slope, above.slope, 1e-14);
        assert_close(below.bend, above.bend, 1e-13);
    }

    #[test]
    fn logarithms_are_finite_as_far_as_numbers_reach() {
        for eta in [-1e150, -1e10, -1e3, -38.6, 0.0, 38.6, 1e3, 1e10, 1e150] {
            let at = LogProbability::at(eta);
            assert!(at.value.is_finite() && at.value <= 0.0, "{eta}");
            assert!(at.slope.is_finite() && at.slope >= 0.0, "{eta}");
            assert!((0.0..=1.0).contains(&at.bend), "{eta}");
        }
    }
}
