//! Statistics of samples: shares with confidence intervals, quantiles, and random numbers that are the same on every machine.

use serde::{Deserialize, Serialize};

/// Number of standard deviations on each side of the mean that enclose 95 % of a normal distribution.
pub(super) const TWO_SIDED_95: f64 = 1.959_963_984_540_054;

/// Number of samples with a verdict below which only the interval of their share is reported in words.
const FEW: usize = 20;

/// Number of samples with a property, and the estimated share among all possible samples.
///
/// # Interval
///
/// An uncertain sample has the property or not, and a sample without a verdict as well: the samples do not determine which. The interval of
/// Wilson (Journal of the American Statistical Association 22, 1927) contains the true share with a probability of 95 % for each possible number
/// of samples with the property. Both ends of his interval grow with this number. So the interval from his lower end, if none of these samples
/// has the property, to his upper end, if all have it, contains every such interval, and the true share with at least 95 %.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Share {
    /// The number of samples that certainly have the property.
    pub count: usize,
    /// The number of uncertain samples; each counts with a fraction in `share`.
    pub uncertain: usize,
    /// The number of samples without a verdict. They count in the interval only.
    pub no_verdict: usize,
    /// The number of samples with a verdict, certain or not.
    pub of: usize,
    /// The share of the samples with a verdict.
    pub share: f64,
    /// Lower end of the 95 % confidence interval.
    pub low: f64,
    /// Upper end of the 95 % confidence interval.
    pub high: f64,
}

impl Share {
    /// Computes the share of `count` samples among `of`, all certain. `None` without samples.
    pub fn of(count: usize, of: usize) -> Option<Self> {
        Self::of_counts([count, count, of, 0], count as f64)
    }

    /// Computes the share of samples that have a property with these probabilities: 0 or 1, a fraction if it is uncertain, and `None` without a
    /// verdict. `None` if no sample has a verdict.
    pub fn of_chances(chances: impl Iterator<Item = Option<f64>> + Clone) -> Option<Self> {
        let known = chances.clone().flatten();
        let count = |least: f64| known.clone().filter(|chance| *chance >= least).count();
        let [certain, possible, of] = [1.0, f64::MIN_POSITIVE, 0.0].map(count);
        let counts = [certain, possible, of, chances.count() - of];
        Self::of_counts(counts, known.clone().sum())
    }

    /// Computes the share from the number of samples that certainly have the property, of those that may have it, of those with a verdict, and of
    /// those without; `expected` is the sum of their probabilities.
    pub(super) fn of_counts(counts: [usize; 4], expected: f64) -> Option<Self> {
        let [count, possible, of, no_verdict] = counts;
        let all = of + no_verdict;
        (of > 0).then(|| Self {
            count,
            uncertain: possible - count,
            no_verdict,
            of,
            share: (expected / of as f64).min(1.0),
            low: wilson(count, all)[0],
            high: wilson(possible + no_verdict, all)[1],
        })
    }

    /// True if the share itself says little: fewer than [`FEW`] samples have a verdict, or more than a tenth of all has none.
    pub(super) const fn is_known_by_interval_only(&self) -> bool {
        self.of < FEW || 9 * self.no_verdict > self.of
    }

    /// Share and both ends of its interval.
    pub(super) const fn numbers(&self) -> [f64; 3] {
        [self.share, self.low, self.high]
    }
}

/// Computes the ends of Wilson's interval, which holds for independent samples. Samples of a low-discrepancy sequence are more even, so the
/// interval is conservative.
fn wilson(count: usize, of: usize) -> [f64; 2] {
    let (n, z2) = (of as f64, TWO_SIDED_95 * TWO_SIDED_95);
    let share = count as f64 / n;
    let middle = (share + 0.5 * z2 / n) / (1.0 + z2 / n);
    let half =
        TWO_SIDED_95 / (1.0 + z2 / n) * (share * (1.0 - share) / n + 0.25 * z2 / (n * n)).sqrt();
    let [low, high] = [middle - half, middle + half].map(|end| end.clamp(0.0, 1.0));
    // The ends are exactly 0 and 1 if no sample or every sample has the property.
    [
        if count == 0 { 0.0 } else { low },
        if count == of { 1.0 } else { high },
    ]
}

/// Sorts values in ascending order.
pub fn ascending(values: impl IntoIterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    values
}

/// Sorts values with weights, given as `[value, weight]`, in ascending order of the values.
pub fn ascending_weighted(values: impl IntoIterator<Item = [f64; 2]>) -> Vec<[f64; 2]> {
    let mut values: Vec<[f64; 2]> = values
        .into_iter()
        .filter(|[_, weight]| *weight > 0.0)
        .collect();
    values.sort_by(|a, b| a[0].total_cmp(&b[0]));
    values
}

/// Finite values in ascending order, each with the share of all weights up to it, from values with weights in any order.
pub(super) fn shares_up_to(values: impl IntoIterator<Item = [f64; 2]>) -> Vec<(f64, f64)> {
    let values = ascending_weighted(values);
    let all: f64 = values.iter().map(|[_, weight]| weight).sum();
    let mut reached = 0.0;
    let finite = values.into_iter().filter(|[value, _]| value.is_finite());
    let share = |[value, weight]: [f64; 2]| {
        reached += weight;
        (value, reached / all)
    };
    finite.map(share).collect()
}

/// Computes a quantile of ascending values, for a `part` of 0 to 1. Value `i` of `n`, counted from 1, is the quantile of `(i - 1/2) / n`
/// (Hazen). Quantiles between neighbours are interpolated linearly. Infinite if a neighbour is infinite; `None` without values.
pub fn quantile(ascending: &[f64], part: f64) -> Option<f64> {
    interpolate_quantile(&equal_weights(ascending), part, |low, high, way| {
        low + way * (high - low)
    })
}

/// Computes a fractile of ascending values of at least 0 as [`quantile`] does, but interpolates logarithms: strengths and peaks scatter by
/// ratios. 0 if the lower neighbour is 0.
pub fn fractile(ascending: &[f64], part: f64) -> Option<f64> {
    weighted_fractile(&equal_weights(ascending), part)
}

/// Computes a fractile of values with weights, [ascending](ascending_weighted). A value lies in the middle of its weight.
pub fn weighted_fractile(ascending: &[[f64; 2]], part: f64) -> Option<f64> {
    interpolate_quantile(ascending, part, |low, high, way| {
        if low > 0.0 {
            low * libm::exp(way * libm::log(high / low))
        } else {
            low
        }
    })
}

fn equal_weights(values: &[f64]) -> Vec<[f64; 2]> {
    values.iter().map(|value| [*value, 1.0]).collect()
}

/// Interpolates between the neighbours of a quantile of values with weights.
fn interpolate_quantile(
    ascending: &[[f64; 2]],
    part: f64,
    interpolate: impl Fn(f64, f64, f64) -> f64,
) -> Option<f64> {
    let mut reached = 0.0;
    let middle = |[_, weight]: &[f64; 2]| {
        reached += weight;
        reached - 0.5 * weight
    };
    let places: Vec<f64> = ascending.iter().map(middle).collect();
    let place = part * reached;
    // A rounding error must not include the next value, which may be infinite.
    let above = places.partition_point(|at| *at <= place + 1e-9);
    let below = above.saturating_sub(1);
    let low = ascending.get(below)?[0];
    let Some([high, _]) = ascending.get(above).filter(|_| above > 0) else {
        return Some(low);
    };
    let way = (place - places[below]) / (places[above] - places[below]);
    if way <= 1e-9 || low.is_infinite() || *high == low {
        return Some(low);
    }
    Some(if high.is_infinite() {
        *high
    } else {
        interpolate(low, *high, way)
    })
}

/// The quantiles of bands: 5 %, the median and 95 %.
pub const BAND: [f64; 3] = [0.05, 0.5, 0.95];

/// Computes the 5 % quantile, the median and the 95 % quantile of values in any order, by [`quantile`] or [`fractile`]. `None` without values.
pub fn band(values: Vec<f64>, quantile: fn(&[f64], f64) -> Option<f64>) -> Option<[f64; 3]> {
    let values = ascending(values);
    let [low, median, high] = BAND.map(|part| quantile(&values, part));
    Some([low?, median?, high?])
}

/// Computes ranks, from 1. Equal values share the mean of their ranks.
pub fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    let mut ranks = vec![0.0; values.len()];
    let mut before = 0;
    for equal in order.chunk_by(|a, b| values[*a] == values[*b]) {
        let rank = before as f64 + 0.5 * (equal.len() as f64 + 1.0);
        before += equal.len();
        for index in equal {
            ranks[*index] = rank;
        }
    }
    ranks
}

/// Computes mean and variance.
pub fn moments(values: &[f64]) -> [f64; 2] {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares = values.iter().map(|value| (value - mean).powi(2));
    [mean, squares.sum::<f64>() / n]
}

/// Computes Pearson's correlation of two lists; `None` if one list does not vary.
pub fn correlation(pairs: impl Iterator<Item = (f64, f64)> + Clone) -> Option<f64> {
    let n = pairs.clone().count() as f64;
    let sums = pairs
        .clone()
        .fold([0.0; 2], |[a, b], (x, y)| [a + x, b + y]);
    let [x_mean, y_mean] = sums.map(|sum| sum / n);
    let [xx, xy, yy] = pairs.fold([0.0; 3], |[xx, xy, yy], (x, y)| {
        let (x, y) = (x - x_mean, y - y_mean);
        [xx + x * x, xy + x * y, yy + y * y]
    });
    (xx > 0.0 && yy > 0.0).then(|| (xy / (xx * yy).sqrt()).clamp(-1.0, 1.0))
}

/// Number of bootstrap replicates.
pub const REPLICATES: usize = 300;

/// Random numbers that are the same on every machine: SplitMix64 (Steele, Lea and Flood 2014).
#[derive(Default)]
pub(super) struct RandomNumbers(u64);

impl RandomNumbers {
    pub(super) fn next_number(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// Number below `count`.
    fn index(&mut self, count: usize) -> usize {
        ((u128::from(self.next_number()) * count as u128) >> 64) as usize
    }

    /// Number from the standard normal distribution (Box and Muller 1958).
    pub(super) fn normal(&mut self) -> f64 {
        // The middle of one of 2^53 equal parts of 0 to 1.
        let [radius, angle] =
            [(); 2].map(|()| ((self.next_number() >> 11) as f64 + 0.5) / (1_u64 << 53) as f64);
        (-2.0 * libm::log(radius)).sqrt() * libm::cos(std::f64::consts::TAU * angle)
    }
}

/// Draws `count` indices below `count` with replacement, [`REPLICATES`] times. The indices are the same on every machine.
pub fn bootstrap(count: usize) -> impl Iterator<Item = Vec<usize>> {
    let mut random = RandomNumbers::default();
    (0..REPLICATES).map(move |_| (0..count).map(|_| random.index(count)).collect())
}

/// Computes the ends of the 95 % interval of bootstrapped values; `None` without values.
pub fn interval(values: Vec<f64>) -> Option<[f64; 2]> {
    let values = ascending(values);
    Some([quantile(&values, 0.025)?, quantile(&values, 0.975)?])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Published: Wilson's interval of 15 of 148 is 0.0624 to 0.1605 (Newcombe 1998, Table I, method 3: 81 of 263 is 0.2553 to 0.3662).
    #[test]
    fn shares_have_the_published_intervals() {
        for (count, of, low, high) in [(81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605)] {
            let share = Share::of(count, of).unwrap();
            assert!(
                (share.low - low).abs() < 5e-5 && (share.high - high).abs() < 5e-5,
                "{share:?}"
            );
        }
        // If no sample or every sample has the property, one end is exact: 0 of 20 is 0 to 0.1611, 29 of 29 is 0.8830 to 1.
        let none = Share::of(0, 20).unwrap();
        assert!(none.low == 0.0 && (none.high - 0.1611).abs() < 5e-5);
        let all = Share::of(29, 29).unwrap();
        assert!(all.high == 1.0 && (all.low - 0.8830).abs() < 5e-5);
        assert_eq!(Share::of(0, 0), None);
    }

    /// One of 12 samples overturns, nine are uncertain and count one half each, and two survive: 5.5 of 12. The ends are those of 1 and of 10 of 12 by
    /// Wilson. Three more samples without a verdict widen the interval to that of 1 and of 13 of 15.
    #[test]
    fn intervals_contain_both_ends_of_uncertain_samples() {
        let chances = [vec![Some(1.0)], vec![Some(0.5); 9], vec![Some(0.0); 2]].concat();
        let share = Share::of_chances(chances.iter().copied()).unwrap();
        assert_eq!([share.count, share.uncertain, share.of], [1, 9, 12]);
        assert!((share.share - 5.5 / 12.0).abs() < 1e-15);
        let ends = |count, of| Share::of(count, of).unwrap();
        assert_eq!(
            [share.low, share.high],
            [ends(1, 12).low, ends(10, 12).high]
        );
        let more = chances.into_iter().chain([None; 3]);
        let more = Share::of_chances(more).unwrap();
        assert_eq!([more.share, more.low], [share.share, ends(1, 15).low]);
        assert_eq!((more.high, more.no_verdict), (ends(13, 15).high, 3));
        // However the uncertain samples end, the interval contains that of Wilson.
        for count in 1..=13 {
            let one = ends(count, 15);
            assert!(more.low <= one.low && one.high <= more.high, "{count}");
        }
        assert_eq!(Share::of_chances([None].into_iter()), None);
    }

    #[test]
    fn weights_move_fractiles() {
        let eight = [0.243, 0.281, 0.330, 0.342, 0.503, 0.559, 0.848, 0.859];
        let alike = ascending_weighted(eight.iter().rev().map(|value| [*value, 0.5]));
        for part in [0.0, 0.05, 0.16, 0.5, 0.84, 1.0] {
            let [a, b] = [
                weighted_fractile(&alike, part).unwrap(),
                fractile(&eight, part).unwrap(),
            ];
            assert!((a / b - 1.0).abs() < 1e-12, "{part}: {a} {b}");
        }
        // One value, half at 1 and half at 4: its median lies between the two.
        let halves = ascending_weighted([[4.0, 0.5], [1.0, 0.5]]);
        assert!((weighted_fractile(&halves, 0.5).unwrap() - 2.0).abs() < 1e-12);
        let infinite = ascending_weighted([[1.0, 0.9], [f64::INFINITY, 0.1], [7.0, 0.0]]);
        let of = |part| weighted_fractile(&infinite, part);
        assert_eq!([of(0.45), of(0.5)], [Some(1.0), Some(f64::INFINITY)]);
        assert_eq!(shares_up_to(infinite), [(1.0, 0.9)]);
        assert_eq!(weighted_fractile(&[], 0.5), None);
    }

    #[test]
    fn quantiles_lie_between_values() {
        let values: Vec<f64> = (1..=20).map(f64::from).collect();
        let of = |part| quantile(&values, part).unwrap();
        assert_eq!(
            [0.0, 0.025, 0.05, 0.5, 0.95, 0.975, 1.0].map(of),
            [1.0, 1.0, 1.5, 10.5, 19.5, 20.0, 20.0]
        );
        assert_eq!(quantile(&[], 0.5), None);
        let [low, median, high] = band(vec![f64::INFINITY, 1.0, 2.0], quantile).unwrap();
        assert_eq!([low, median, high], [1.0, 2.0, f64::INFINITY]);
        // A quantile between a value and infinity is infinite.
        assert_eq!(quantile(&[1.0, f64::INFINITY], 0.5), Some(f64::INFINITY));
        assert_eq!(quantile(&[-f64::INFINITY, 1.0], 0.5), Some(-f64::INFINITY));
    }

    /// Eight intensities that overturn; the lower neighbour of the median is 0.342.
    #[test]
    fn fractiles_of_few_values_lie_between_them() {
        let eight = [0.243, 0.281, 0.330, 0.342, 0.503, 0.559, 0.848, 0.859];
        let of = |part| fractile(&eight, part).unwrap();
        assert!((of(0.5) - (0.342_f64 * 0.503).sqrt()).abs() < 1e-12);
        // The 16 % fractile of eight values lies 0.78 after the first.
        let known = 0.243 * (0.281_f64 / 0.243).powf(0.78);
        assert!((of(0.16) - known).abs() < 1e-12, "{}", of(0.16));
        // Three values and their reciprocals have reciprocal fractiles.
        for part in [0.16, 0.4, 0.5, 0.84] {
            let product = fractile(&[0.5, 1.0, 8.0], part).unwrap()
                * fractile(&[0.125, 1.0, 2.0], 1.0 - part).unwrap();
            assert!((product - 1.0).abs() < 1e-12, "{part}");
        }
        // If half of the values are infinite, the median is infinite.
        let half = [0.2, 0.3, f64::INFINITY, f64::INFINITY];
        assert_eq!(fractile(&half, 0.5), Some(f64::INFINITY));
        assert_eq!(fractile(&half, 0.375), Some(0.3));
        assert_eq!(fractile(&[0.0, 1.0], 0.5), Some(0.0));
    }

    #[test]
    fn equal_values_share_their_ranks() {
        assert_eq!(ranks(&[3.0, 1.0, 3.0, 2.0, 3.0]), [4.0, 1.0, 4.0, 2.0, 4.0]);
        let squares = (1..9).map(|x| (f64::from(x), f64::from(x * x)));
        assert!(correlation(squares).unwrap() < 0.98);
        assert_eq!(correlation([(1.0, 2.0), (2.0, 2.0)].into_iter()), None);
    }

    /// The variance of the mean of 100 draws is that of one draw divided by 100.
    #[test]
    fn bootstraps_draw_evenly() {
        let means: Vec<f64> = bootstrap(100)
            .map(|drawn| drawn.iter().sum::<usize>() as f64 / 100.0)
            .collect();
        let [mean, variance] = moments(&means);
        // Numbers 0 to 99 have mean 49.5 and variance 833.25; the bounds are four standard errors.
        assert!(
            (mean - 49.5).abs() < 4.0 * (8.3325_f64 / 300.0).sqrt(),
            "{mean}"
        );
        assert!(
            (variance / 8.3325 - 1.0).abs() < 4.0 * (2.0_f64 / 300.0).sqrt(),
            "{variance}"
        );
    }
}
