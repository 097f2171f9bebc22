//! Bisection: finds the number at which a property changes.

use std::convert::Infallible;

/// The width at which bisection stops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Width {
    /// Until no number lies between its ends.
    Rounding,
    /// Until it is at most this wide, or no number lies between its ends.
    Absolute(f64),
    /// Until it is at most this wide relative to its upper end, or no number lies between its ends.
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

/// The middle of an interval; of two neighbouring numbers, the even one.
pub fn middle(low: f64, high: f64) -> f64 {
    0.5 * (low + high)
}

/// The numbers about which [`bisect`] may ask in its next steps, for this many steps.
pub fn next_middles(low: f64, high: f64, width: Width, steps: usize) -> Vec<f64> {
    if steps == 0 || width.is_reached(low, high) {
        return Vec::new();
    }
    let middle = middle(low, high);
    let [below, above] = [(low, middle), (middle, high)]
        .map(|(low, high)| next_middles(low, high, width, steps - 1));
    [vec![middle], below, above].concat()
}

/// Halves the interval from `low`, where a property does not hold yet, to `high`, where it holds, until it is
/// narrow enough. Returns its ends.
pub fn bisect(low: f64, high: f64, width: Width, mut holds: impl FnMut(f64) -> bool) -> (f64, f64) {
    let Ok(ends) = try_bisect(low, high, width, |at| Ok::<_, Infallible>(holds(at)));
    ends
}

/// Bisects like [`bisect`], for a property whose evaluation may fail.
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

/// Two numbers between which a function falls below zero, of an interval at whose upper end alone its value, which is given, is negative, or no number: neighbours, or
/// two between which it falls by no more than this rounding, or, where it ends, that are no farther apart than this.
///
/// It evaluates the function as often as [`bisect`] at worst, and far less where the function is smooth: Oliveira and Takahashi, "An enhancement of the
/// bisection method average performance preserving minmax optimality", ACM Trans. Math. Softw. 47 (2020).
pub fn falls_below_zero(
    mut low: f64,
    (mut high, mut at_high): (f64, f64),
    rounding: f64,
    mut value: impl FnMut(f64) -> f64,
) -> (f64, f64) {
    let mut at_low = value(low);
    let (interval, ulp) = (high - low, f64::EPSILON * low.abs().max(high.abs()));
    let mut spare = 2.0 * interval;
    let found = |low: f64, high: f64, at_low: f64, at_high: f64| {
        let falls = if at_high.is_nan() {
            high - low
        } else {
            at_low - at_high
        };
        falls <= rounding || Width::Rounding.is_reached(low, high)
    };
    while !found(low, high, at_low, at_high) {
        let (width, middle) = (high - low, middle(low, high));
        let secant = low + width * at_low / (at_low - at_high);
        let inwards = 0.1 * width * width / interval;
        let towards = if inwards < (middle - secant).abs() {
            secant + inwards.copysign(middle - secant)
        } else {
            middle
        };
        // No farther from the middle than leaves halving enough steps.
        let reach = (0.5 * (spare - width)).max(0.0);
        let at = towards.clamp(middle - reach, middle + reach);
        let at = if low < at && at < high { at } else { middle };
        let now = value(at);
        if now >= 0.0 {
            (low, at_low) = (at, now);
        } else {
            (high, at_high) = (at, now);
        }
        spare = (0.5 * spare).max(ulp);
    }
    (low, high)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::SQRT_2;

    use super::*;

    #[test]
    fn ends_enclose_the_change_as_narrowly_as_asked() {
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
    fn a_smooth_function_is_followed_to_zero_in_few_steps() {
        let smooth = |x: f64| 2.0 - x * x + (SQRT_2 - x).powi(3);
        let cliff = |x: f64| if x < SQRT_2 { 1.0 } else { f64::NAN };
        for (value, most) in [(smooth as fn(f64) -> f64, 15), (cliff, 60)] {
            let mut asked = 0;
            let (low, high) = falls_below_zero(1.0, (2.0, value(2.0)), 0.0, |x| {
                asked += 1;
                value(x)
            });
            assert_eq!(low.next_up(), high);
            assert!((low - SQRT_2).abs() < 1e-15 && asked <= most, "{asked}");
        }
    }

    #[test]
    fn rounding_is_not_followed() {
        let noisy = |x: f64| SQRT_2 - x + 1e-9 * (1e12 * x).sin();
        let cliff = |x: f64| if x < SQRT_2 { 1.0 } else { f64::NAN };
        for (value, most) in [(noisy as fn(f64) -> f64, 12), (cliff, 30)] {
            let mut asked = 0;
            let (low, high) = falls_below_zero(1.0, (2.0, value(2.0)), 1e-8, |x| {
                asked += 1;
                value(x)
            });
            assert!(value(low) >= 0.0 && (value(high) < 0.0 || value(high).is_nan()));
            assert!((low - SQRT_2).abs() < 2e-8 && asked <= most, "{asked}");
        }
    }

    #[test]
    fn what_may_be_asked_next_is_asked() {
        for change in [1.01, 1.3, 1.77, 1.999] {
            let (width, mut asked, mut next) = (Width::Relative(1e-3), Vec::new(), Vec::new());
            let (mut low, mut high) = (1.0, 2.0);
            let ends = bisect(low, high, width, |x| {
                if !next.contains(&x) {
                    next = next_middles(low, high, width, 3);
                    asked.push(next.len());
                }
                assert!(next.contains(&x));
                *if x >= change { &mut high } else { &mut low } = x;
                x >= change
            });
            assert_eq!(ends, (low, high));
            // Ten steps, or nine where a thousandth of the end is twice that of the beginning.
            assert!(
                asked == [7, 7, 7, 1] || asked == [7, 7, 7],
                "{change}: {asked:?}"
            );
        }
    }

    #[test]
    fn failures_are_passed_on() {
        let failed = try_bisect(0.0, 1.0, Width::Rounding, |_| Err::<bool, _>("no"));
        assert_eq!(failed, Err("no"));
    }
}
