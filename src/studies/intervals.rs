//! Confidence intervals of 95 % from few independent values: records, or samples.
//!
//! The interval of a dispersion is that of the standard deviation of normal values, by the chi-square distribution; the interval of a median is that of
//! their mean, by Student's. Median and dispersion from fractiles have [intervals of their own](FractileIntervals), by simulation. All assume that the
//! logarithms of the overturning intensities of records are normal and independent. docs/evidence.md has the measured coverage. The limit of a fractile is
//! an order statistic and needs no distribution (Wilks, Annals of Mathematical Statistics 12, 1941).

use std::f64::consts::FRAC_2_PI;

use super::statistics::{RandomNumbers, ascending, quantile};
use crate::bisection::{Width, bisect};

/// Rank, from 1, of the value that is the lower 95 % confidence limit of the 5 % fractile, among `count` independent values in ascending
/// order: the largest rank `k` for which at most `k - 1` of the values are below the fractile with a probability of at most 5 %. `None` if there are too
/// few values, so that even the lowest may be above the fractile.
pub(super) fn rank_of_lower_limit(count: usize) -> Option<usize> {
    const RISK: f64 = 0.05;
    let [below, above] = [LOW_PART, 1.0 - LOW_PART].map(libm::log);
    let (mut term, mut reached, mut rank) = (count as f64 * above, 0.0, 0);
    while rank < count {
        reached += libm::exp(term);
        if reached > RISK {
            break;
        }
        rank += 1;
        term += libm::log((count - rank + 1) as f64 / rank as f64) + below - above;
    }
    (rank > 0).then_some(rank)
}

/// The fractile of [`rank_of_lower_limit`].
pub(super) const LOW_PART: f64 = 0.05;

/// Smallest number of values that have such a rank.
pub(super) const LEAST_FOR_LIMIT: usize = 59;

/// Ends of the interval of a dispersion of maximum likelihood from `count` independent values; `None` with fewer than two.
pub(super) fn dispersion_interval(dispersion: f64, count: usize) -> Option<[f64; 2]> {
    let degrees = count.checked_sub(1).filter(|degrees| *degrees > 0)?;
    // The sum of squares of `count` logarithms about their mean.
    let squares = dispersion * dispersion * count as f64;
    let end = |part: f64| (squares / chi_square_quantile(part, degrees)).sqrt();
    Some([end(0.975), end(0.025)])
}

/// Ends of the interval of a median from `count` independent values with this dispersion; `None` with fewer than two.
pub(super) fn median_interval(median: f64, dispersion: f64, count: usize) -> Option<[f64; 2]> {
    let degrees = count.checked_sub(1).filter(|degrees| *degrees > 0)?;
    let margin = student_quantile(degrees) * dispersion / (degrees as f64).sqrt();
    Some([-margin, margin].map(|margin| median * libm::exp(margin)))
}

/// The fractiles from which a dispersion and a median are computed.
pub(super) const FRACTILES: [f64; 3] = [0.16, 0.5, 0.84];

/// Intervals of a median and of a dispersion from the [`FRACTILES`] of independent lognormal values. The ratio of the dispersion to the true one, and the
/// logarithm of the median over the true one divided by the dispersion, have distributions that depend on the number of values only. They are simulated.
pub(super) struct FractileIntervals {
    /// The quantiles of 2.5 and 97.5 % of the ratio of the dispersion to the true one.
    ratios: [f64; 2],
    /// The quantile of 95 % of the logarithm of the median over the true one, divided by the dispersion, without its sign.
    margin: f64,
}

impl FractileIntervals {
    /// Number of simulated sets of values: the ends are those of a coverage of 95 +- 0.4 %.
    const SETS: usize = 4000;

    /// Simulates the distributions for a number of values. `None` with fewer than two values, which have no scatter.
    pub(super) fn of(count: usize) -> Option<Self> {
        let mut random = RandomNumbers::default();
        let mut set = || {
            let values = ascending((0..count).map(|_| random.normal()));
            let [low, median, high] = FRACTILES.map(|part| quantile(&values, part));
            let dispersion = 0.5 * (high? - low?);
            Some((dispersion, (median? / dispersion).abs()))
        };
        let sets: Option<Vec<_>> = (0..Self::SETS).map(|_| set()).collect();
        let (ratios, margins): (Vec<f64>, Vec<f64>) =
            sets.filter(|_| count > 1)?.into_iter().unzip();
        let ratios = ascending(ratios);
        Some(Self {
            ratios: [quantile(&ratios, 0.025)?, quantile(&ratios, 0.975)?],
            margin: quantile(&ascending(margins), 0.95)?,
        })
    }

    /// Ends of the interval of a dispersion.
    pub(super) fn dispersion_interval(&self, dispersion: f64) -> [f64; 2] {
        let [low, high] = self.ratios;
        [dispersion / high, dispersion / low]
    }

    /// Ends of the interval of a median with this dispersion.
    pub(super) fn median_interval(&self, median: f64, dispersion: f64) -> [f64; 2] {
        let margin = self.margin * dispersion;
        [-margin, margin].map(|margin| median * libm::exp(margin))
    }
}

/// Finds the point at which an increasing function reaches a value. `high` is an upper bound that grows until it is one.
fn solve(value: f64, mut high: f64, function: impl Fn(f64) -> f64) -> f64 {
    while function(high) < value {
        high *= 2.0;
    }
    bisect(0.0, high, Width::Rounding, |at| function(at) >= value).1
}

/// Quantile of the chi-square distribution.
pub(super) fn chi_square_quantile(part: f64, degrees: usize) -> f64 {
    solve(part, degrees as f64, |x| chi_square_probability(x, degrees))
}

/// Probability that a chi-square variable is at most `x`: a finite sum for whole degrees of freedom (Abramowitz and Stegun, 26.4.4 and
/// 26.4.5).
fn chi_square_probability(x: f64, degrees: usize) -> f64 {
    let half = 0.5 * x;
    let (first, beyond) = match degrees % 2 {
        0 => (0.0, 0.0),
        _ => (0.5, libm::erfc(half.sqrt())),
    };
    let terms = (0..degrees / 2).map(|index| {
        let power = first + index as f64;
        libm::exp(power * libm::log(half) - half - libm::lgamma(power + 1.0))
    });
    1.0 - beyond - terms.sum::<f64>()
}

/// Quantile of 97.5 % of Student's distribution.
pub(super) fn student_quantile(degrees: usize) -> f64 {
    solve(0.95, 2.0, |t| student_probability(t, degrees))
}

/// Probability that the absolute value of a variable of Student is at most `t`: a finite sum (Abramowitz and Stegun, 26.7.3 and 26.7.4).
fn student_probability(t: f64, degrees: usize) -> f64 {
    let (sine, cosine) = {
        let hypotenuse = (t * t + degrees as f64).sqrt();
        (t / hypotenuse, (degrees as f64).sqrt() / hypotenuse)
    };
    let is_odd = degrees % 2 == 1;
    let first = usize::from(is_odd);
    let mut term = if is_odd { cosine } else { 1.0 };
    let mut sum = 0.0;
    for power in (first..=degrees.saturating_sub(2)).step_by(2) {
        sum += term;
        term *= cosine * cosine * (power + 1) as f64 / (power + 2) as f64;
    }
    match is_odd {
        true => FRAC_2_PI * (libm::atan(t / (degrees as f64).sqrt()) + sine * sum),
        false => sine * sum,
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_1_SQRT_2;

    use super::*;
    use crate::Scenario;
    use crate::studies::statistics::moments;
    use crate::studies::suite::{Observation, fit};

    /// Published: with 59, 93, 124, 153 and 181 values the first to fifth lowest are 95 % confidence limits of the 5 % fractile (Wilks; NUREG/CR-1475);
    /// one value less has a lower rank.
    #[test]
    fn ranks_are_those_of_wilks() {
        for (rank, count) in [59, 93, 124, 153, 181].into_iter().enumerate() {
            assert_eq!(rank_of_lower_limit(count), Some(rank + 1), "{count}");
            assert_eq!(rank_of_lower_limit(count - 1).unwrap_or(0), rank, "{count}");
        }
        assert_eq!(rank_of_lower_limit(LEAST_FOR_LIMIT - 1), None);
        assert_eq!(rank_of_lower_limit(0), None);
        // The probability of at most `k - 1` of 65,536: normal approximation, 3276.8 - 1.645 * 55.79.
        let rank = rank_of_lower_limit(65_536).unwrap();
        assert!(rank.abs_diff(3185) <= 2, "{rank}");
    }

    /// Tables of Abramowitz and Stegun: chi-square of 2.5 and 97.5 %, and Student of 97.5 %.
    #[test]
    fn quantiles_are_those_of_the_tables() {
        for (degrees, low, high, student) in [
            (1, 0.000_982_069, 5.023_886, 12.706_205),
            (2, 0.050_636, 7.377_759, 4.302_653),
            (3, 0.215_795, 9.348_404, 3.182_446),
            (7, 1.689_869, 16.012_764, 2.364_624),
            (10, 3.246_973, 20.483_177, 2.228_139),
            (29, 16.047_072, 45.722_286, 2.045_230),
            (100, 74.221_927, 129.561_197, 1.983_972),
        ] {
            for (part, known) in [(0.025, low), (0.975, high)] {
                let found = chi_square_quantile(part, degrees);
                assert!(
                    (found / known - 1.0).abs() < 2e-5,
                    "{degrees} {found} {known}"
                );
            }
            let found = student_quantile(degrees);
            assert!(
                (found - student).abs() < 2e-6 * student,
                "{degrees} {found}"
            );
        }
        // Thousands of degrees do not underflow: Wilson and Hilferty's approximation.
        let cube = 1.0 - 2.0 / 45_000.0 + 1.959_964 * (2.0_f64 / 45_000.0).sqrt();
        let found = chi_square_quantile(0.975, 5000);
        assert!(
            (found / (5000.0 * cube.powi(3)) - 1.0).abs() < 1e-5,
            "{found}"
        );
    }

    /// The fractiles of 16 and 84 % of two values are the values. Their half difference over the true deviation is half the absolute value of a normal
    /// variable of variance 2: its quantiles are 0.7071 times 0.031338 and 2.241403. The median over half the difference is Student's with one degree of
    /// freedom: 12.7062. With many values the quantiles are those of the normal limit, with a variance of 0.918 / n and one of 1.571 / n. The tolerance is
    /// four standard errors of quantiles from 4000 values.
    #[test]
    fn simulated_quantiles_are_the_known_ones() {
        let two = FractileIntervals::of(2).unwrap();
        assert!(
            (two.ratios[0] / (FRAC_1_SQRT_2 * 0.031_338) - 1.0).abs() < 0.4,
            "{:?}",
            two.ratios
        );
        assert!(
            (two.ratios[1] / (FRAC_1_SQRT_2 * 2.241_403) - 1.0).abs() < 0.06,
            "{:?}",
            two.ratios
        );
        assert!((two.margin / 12.706_2 - 1.0).abs() < 0.3, "{}", two.margin);
        let many = FractileIntervals::of(400).unwrap();
        let deviation = (0.918_f64 / 400.0).sqrt();
        let known = [-1.959_964, 1.959_964].map(|by| 0.994_46 + by * deviation);
        for (found, known) in many.ratios.into_iter().zip(known) {
            assert!((found - known).abs() < 0.2 * deviation, "{found} {known}");
        }
        let margin = 1.959_964 * (1.571_f64 / 400.0).sqrt() / 0.994_46;
        assert!(
            (many.margin / margin - 1.0).abs() < 0.06,
            "{} {margin}",
            many.margin
        );
        assert!(FractileIntervals::of(1).is_none() && FractileIntervals::of(0).is_none());
    }

    /// With values 0 and `2 s` the standard deviation of `n - 1 = 1` degree is known, so the ends follow from the tables.
    #[test]
    fn intervals_follow_from_the_quantiles() {
        let [low, high] = dispersion_interval(0.4, 8).unwrap();
        let deviation = 0.4 * (8.0_f64 / 7.0).sqrt();
        assert!((low - deviation * (7.0_f64 / 16.012_764).sqrt()).abs() < 1e-5);
        assert!((high - deviation * (7.0_f64 / 1.689_869).sqrt()).abs() < 1e-5);
        let [low, high] = median_interval(0.5, 0.4, 8).unwrap();
        let margin = 2.364_624 * deviation / 8.0_f64.sqrt();
        assert!((libm::log(high / 0.5) - margin).abs() < 1e-6);
        assert!((low * high - 0.25).abs() < 1e-12);
        assert_eq!(
            (dispersion_interval(0.4, 1), median_interval(0.5, 0.4, 0)),
            (None, None)
        );
    }

    /// Number of simulated suites: 400, or `ARCHROCK_CASES`.
    fn suites() -> usize {
        std::env::var("ARCHROCK_CASES").map_or(400, |cases| cases.parse().unwrap())
    }

    /// Asserts that a number of intervals out of all contains the truth: 95 %, or at least so many in a hundred, within four standard errors.
    fn assert_coverage(name: &str, count: usize, of: usize, [least, most]: [f64; 2]) {
        let covered = 100.0 * count as f64 / of as f64;
        let error = 400.0 * (0.05 * 0.95 / of as f64).sqrt();
        assert!(
            covered > least - error && covered < most + error,
            "{name}: {covered}"
        );
    }

    /// Fragility curves of suites of records with lognormal intensities, each tried at 20 levels from 0.2 to 4: the intervals of median and dispersion, and
    /// the band of the curve at the true median, contain the truth about as often as they say. Suites without a curve do not count.
    #[test]
    fn intervals_of_fragility_curves_contain_the_truth() {
        let (median, dispersion) = (0.7, 0.5);
        let levels: Vec<f64> = (0..20)
            .map(|level| 0.2 * 20.0_f64.powf(f64::from(level) / 19.0))
            .collect();
        let mut random = RandomNumbers::default();
        for records in [8, 20] {
            let (mut counts, mut curves) = ([0; 3], 0);
            for _ in 0..suites() {
                let cases = (0..records).flat_map(|record| {
                    let capacity = median * libm::exp(dispersion * random.normal());
                    levels.iter().map(move |level| Observation {
                        intensity: *level,
                        overturned: f64::from(*level >= capacity),
                        record,
                    })
                });
                let Ok(found) = fit(&cases.collect::<Vec<_>>()) else {
                    continue;
                };
                curves += 1;
                let (low, high) = found.band(median);
                let all = [
                    (found.median_interval().unwrap(), median),
                    (found.dispersion_interval().unwrap(), dispersion),
                    ([low, high], 0.5),
                ];
                for (count, ([low, high], truth)) in counts.iter_mut().zip(all) {
                    *count += usize::from(low <= truth && truth <= high);
                }
            }
            for (name, count) in ["median", "dispersion", "band"].iter().zip(counts) {
                assert_coverage(&format!("{name} of {records}"), count, curves, [92.0, 98.0]);
            }
        }
    }

    /// Dispersions of capacities from their standard deviation, and medians and dispersions from fractiles.
    #[test]
    fn intervals_of_lognormal_values_contain_the_truth() {
        let mut random = RandomNumbers::default();
        // Other numbers than those of the simulated quantiles.
        random.next_number();
        for count in [3, 8, 20] {
            let (mut counts, intervals) = ([0; 3], FractileIntervals::of(count).unwrap());
            for _ in 0..suites() {
                let values = ascending((0..count).map(|_| 0.5 * random.normal()));
                let [_, variance] = moments(&values);
                let [low, middle, high] = FRACTILES.map(|part| quantile(&values, part).unwrap());
                let scatter = 0.5 * (high - low);
                let all = [
                    (dispersion_interval(variance.sqrt(), count).unwrap(), 0.5),
                    (intervals.dispersion_interval(scatter), 0.5),
                    (intervals.median_interval(libm::exp(middle), scatter), 1.0),
                ];
                for (covered, ([low, high], truth)) in counts.iter_mut().zip(all) {
                    *covered += usize::from(low <= truth && truth <= high);
                }
            }
            let names = ["deviation", "dispersion of fractiles", "median"];
            for (name, covered) in names.iter().zip(counts) {
                assert_coverage(&format!("{name} of {count}"), covered, suites(), [95.0; 2]);
            }
        }
    }

    /// All samples under all records, with scatter of records, of samples and of pairs: records count as independent values, so the intervals contain the
    /// truth at least as often as they say.
    #[test]
    fn intervals_over_records_and_samples_contain_the_truth() {
        let (records, samples) = (8, 20);
        let intervals = FractileIntervals::of(records).unwrap();
        let mut random = RandomNumbers::default();
        for [of_record, of_sample, of_pair] in
            [[0.4, 0.1, 0.0], [0.4, 0.1, 0.2], [0.2; 3], [0.1, 0.4, 0.0]]
        {
            let truth = f64::hypot(f64::hypot(of_record, of_sample), of_pair);
            let mut counts = [0; 2];
            for _ in 0..suites() {
                let mut normals = |count: usize, deviation: f64| -> Vec<f64> {
                    (0..count).map(|_| deviation * random.normal()).collect()
                };
                let (rows, columns) = (normals(records, of_record), normals(samples, of_sample));
                let pairs = normals(records * samples, of_pair);
                let values = pairs
                    .iter()
                    .enumerate()
                    .map(|(index, pair)| rows[index / samples] + columns[index % samples] + pair);
                let values = ascending(values);
                let [low, middle, high] = FRACTILES.map(|part| quantile(&values, part).unwrap());
                let scatter = 0.5 * (high - low);
                let all = [
                    (intervals.dispersion_interval(scatter), truth),
                    (intervals.median_interval(libm::exp(middle), scatter), 1.0),
                ];
                for (covered, ([low, high], truth)) in counts.iter_mut().zip(all) {
                    *covered += usize::from(low <= truth && truth <= high);
                }
            }
            for (name, covered) in ["dispersion", "median"].iter().zip(counts) {
                let name = format!("{name} of {of_record} {of_sample} {of_pair}");
                assert_coverage(&name, covered, suites(), [95.0, 100.0]);
            }
        }
    }

    /// The sum of three independent numbers from 0 to 1 has its 5 % fractile at the cube root of 0.3. Of the scrambled Sobol points of a scenario, as of
    /// independent ones, the limit is below it in at least 95 % of the seeds.
    #[test]
    fn limits_are_below_the_fractile() {
        let fractile = 0.3_f64.cbrt();
        for count in [59, 93, 200] {
            let rank = rank_of_lower_limit(count).unwrap();
            let below = (0..suites()).filter(|seed| {
                let text = format!(
                    "[column]\nheight_m = 4.0\nwidth_m = 0.8\n[ground.one_sine]\namplitude_g = 0.5\nduration_s = 0.6\n\
                     [uncertain]\nsamples = {count}\nseed = {seed}\n'column.width_m' = {{ from = 0.7, to = 0.9 }}\n\
                     'column.height_m' = {{ from = 3.0, to = 5.0 }}\n'ground.one_sine.amplitude_g' = {{ from = 0.4, to = 0.6 }}\n"
                );
                let scenario = Scenario::parse(&text, "s.toml").unwrap();
                let uncertain = scenario.uncertain.as_ref().unwrap();
                let sums = (0..count).map(|sample| uncertain.point(sample).iter().sum());
                ascending(sums)[rank - 1] <= fractile
            });
            assert_coverage(
                &format!("limit of {count}"),
                below.count(),
                suites(),
                [95.0, 100.0],
            );
        }
    }
}
