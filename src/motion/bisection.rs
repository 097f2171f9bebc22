//! Bisection: finds the number at which a property changes.

use std::convert::Infallible;

/// Width of an interval at which bisection stops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Width {
    /// Stops if there is no number between the ends.
    Rounding,
    /// Stops at this width, or if there is no number between the ends.
    Absolute(f64),
    /// Stops at this width relative to the upper end, or if there is no number between the ends.
    Relative(f64),
}

impl Width {
    fn is_reached(self, low: f64, high: f64) -> bool {
        let middle = middle(low, high);
        let neighbours = middle <= low || middle >= high;
        neighbours
            || match self {
                Self::Rounding => false,
                Self::Absolute(width) => high - low <= width,
                Self::Relative(width) => high - low <= width * high,
            }
    }
}

/// Middle of an interval; of two neighbouring numbers, the even one.
pub fn middle(low: f64, high: f64) -> f64 {
    0.5 * (low + high)
}

/// All numbers at which [`bisect`] may evaluate the property in its next `steps` steps.
pub fn next_middles(low: f64, high: f64, width: Width, steps: usize) -> Vec<f64> {
    if steps == 0 || width.is_reached(low, high) {
        return Vec::new();
    }
    let middle = middle(low, high);
    let [below, above] = [(low, middle), (middle, high)]
        .map(|(low, high)| next_middles(low, high, width, steps - 1));
    [vec![middle], below, above].concat()
}

/// Halves the interval from `low`, where a property does not hold, to `high`, where it holds, until it is narrow enough. Returns its ends.
pub fn bisect(low: f64, high: f64, width: Width, mut holds: impl FnMut(f64) -> bool) -> (f64, f64) {
    let Ok(ends) = try_bisect(low, high, width, |at| Ok::<_, Infallible>(holds(at)));
    ends
}

/// Bisects as [`bisect`], for a property whose evaluation may fail.
///
/// # Errors
/// Those of the property.
pub fn try_bisect<E>(
    mut low: f64,
    mut high: f64,
    width: Width,
    mut holds: impl FnMut(f64) -> Result<bool, E>,
) -> Result<(f64, f64), E> {
    while !width.is_reached(low, high) {
        let middle = middle(low, high);
        if holds(middle)? {
            high = middle;
        } else {
            low = middle;
        }
    }
    Ok((low, high))
}

/// Ends of a small interval in which a function falls below zero. `high` is the upper end of the initial interval with its value. At the
/// lower end the value is not negative; at the upper end it is negative or NaN.
///
/// The search ends at neighbouring numbers, or if the function falls by at most `rounding` between the ends. If the upper value is NaN, the search
/// ends at an interval no wider than `rounding`.
///
/// The next point is the zero of an inverse quadratic interpolation if this is safe, and the middle of the interval otherwise: Chandrupatla, "A new
/// hybrid quadratic/bisection algorithm for finding the zero of a nonlinear function without using derivatives", Adv. Eng. Softw. 28 (1997).
pub(crate) fn falls_below_zero(
    low: f64,
    high: (f64, f64),
    rounding: f64,
    mut value: impl FnMut(f64) -> f64,
) -> (f64, f64) {
    let (mut newest, mut opposite, mut part) = ((low, value(low)), high, 0.5_f64);
    loop {
        let forwards = newest.0 < opposite.0;
        let [low, high] = if forwards {
            [newest, opposite]
        } else {
            [opposite, newest]
        };
        let width = high.0 - low.0;
        let falls = if high.1.is_nan() {
            width
        } else {
            low.1 - high.1
        };
        if falls <= rounding || Width::Rounding.is_reached(low.0, high.0) {
            return (low.0, high.0);
        }
        // Step slightly beyond zero, so that both ends approach it.
        let ulp = f64::EPSILON * low.0.abs().max(high.0.abs());
        let beyond = (0.4 * rounding / falls).max(ulp / width).min(0.5);
        let at = newest.0 + part.clamp(beyond, 1.0 - beyond) * (opposite.0 - newest.0);
        let at = if low.0 < at && at < high.0 {
            at
        } else {
            middle(low.0, high.0)
        };
        let now = (at, value(at));
        let former = if (now.1 >= 0.0) == (newest.1 >= 0.0) {
            newest
        } else {
            std::mem::replace(&mut opposite, newest)
        };
        newest = now;
        part = inverse_quadratic(newest, opposite, former).unwrap_or(0.5);
    }
}

/// Zero of the inverse quadratic interpolation of three points, as a fraction of the way from the newest point to the opposite one;
/// `None` if the interpolation is not monotonic.
fn inverse_quadratic(newest: (f64, f64), opposite: (f64, f64), former: (f64, f64)) -> Option<f64> {
    let ((a, at_a), (b, at_b), (c, at_c)) = (newest, opposite, former);
    let place = (a - b) / (c - b);
    let level = (at_a - at_b) / (at_c - at_b);
    (level.powi(2) < place && (1.0 - level).powi(2) < 1.0 - place).then(|| {
        at_a / (at_b - at_a) * at_c / (at_b - at_c)
            + (c - a) / (b - a) * at_a / (at_c - at_a) * at_b / (at_c - at_b)
    })
}

#[cfg(test)]
mod tests {
    use std::f64::consts::SQRT_2;

    use super::*;

    #[test]
    fn the_interval_is_as_narrow_as_the_given_width() {
        let change = 2.0_f64.sqrt();
        let ends = |width| bisect(1.0, 2.0, width, |x| x >= change);
        let (low, high) = ends(Width::Rounding);
        assert!(low < change && high == change && low.next_up() == high);
        let (low, high) = ends(Width::Absolute(1e-3));
        assert!(low < change && change <= high && high - low <= 1e-3 && high - low > 4e-4);
        let (low, high) = ends(Width::Relative(1e-6));
        assert!(low < change && change <= high && high - low <= 1e-6 * high);
    }

    #[test]
    fn the_zero_of_a_smooth_function_is_found_in_few_steps() {
        let smooth = |x: f64| 2.0 - x * x + (SQRT_2 - x).powi(3);
        let cliff = |x: f64| if x < SQRT_2 { 1.0 } else { f64::NAN };
        for (value, most) in [(smooth as fn(f64) -> f64, 15), (cliff, 60)] {
            let mut calls = 0;
            let (low, high) = falls_below_zero(1.0, (2.0, value(2.0)), 0.0, |x| {
                calls += 1;
                value(x)
            });
            assert_eq!(low.next_up(), high);
            assert!((low - SQRT_2).abs() < 1e-15 && calls <= most, "{calls}");
        }
    }

    #[test]
    fn the_search_ends_at_rounding_error() {
        let noisy = |x: f64| SQRT_2 - x + 1e-9 * (1e12 * x).sin();
        let cliff = |x: f64| if x < SQRT_2 { 1.0 } else { f64::NAN };
        // Least of several linear functions: rising at first, steep at the end.
        let kinked = |x: f64| (0.01 + 1e-3 * x).min(SQRT_2 - x).min(30.0 * (1.43 - x));
        for (value, most) in [(noisy as fn(f64) -> f64, 12), (cliff, 30), (kinked, 14)] {
            let mut calls = 0;
            let (low, high) = falls_below_zero(1.0, (2.0, value(2.0)), 1e-8, |x| {
                calls += 1;
                value(x)
            });
            assert!(value(low) >= 0.0 && (value(high) < 0.0 || value(high).is_nan()));
            assert!((low - SQRT_2).abs() < 2e-8 && calls <= most, "{calls}");
        }
    }

    #[test]
    fn next_middles_contain_every_next_point() {
        for change in [1.01, 1.3, 1.77, 1.999] {
            let (width, mut calls, mut next) = (Width::Relative(1e-3), Vec::new(), Vec::new());
            let (mut low, mut high) = (1.0, 2.0);
            let ends = bisect(low, high, width, |x| {
                if !next.contains(&x) {
                    next = next_middles(low, high, width, 3);
                    calls.push(next.len());
                }
                assert!(next.contains(&x));
                *if x >= change { &mut high } else { &mut low } = x;
                x >= change
            });
            assert_eq!(ends, (low, high));
            // Nine steps if the change is near 2, where the allowed width is twice that near 1; otherwise ten.
            assert!(
                calls == [7, 7, 7, 1] || calls == [7, 7, 7],
                "{change}: {calls:?}"
            );
        }
    }

    #[test]
    fn errors_of_the_function_are_returned() {
        let failed = try_bisect(0.0, 1.0, Width::Rounding, |_| Err::<bool, _>("no"));
        assert_eq!(failed, Err("no"));
    }
}
