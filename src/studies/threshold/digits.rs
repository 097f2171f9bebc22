//! Factors and accelerations with a suitable number of digits.

use crate::output::range_ends;

/// Returns a factor or an acceleration with four digits: the usual accuracy of an edge.
pub fn rounded(value: f64) -> String {
    let decimals = decimals(value);
    format!("{value:.decimals$}")
}

/// Returns a strength that is safe with four digits, never rounded upwards.
pub fn rounded_down(value: f64) -> String {
    let decimals = decimals(value);
    // A little less than half a digit keeps decimal numbers such as 0.45 unchanged.
    let lowered = value - (0.5 - 1e-9) * 0.1_f64.powi(decimals as i32);
    format!("{lowered:.decimals$}")
}

/// Returns both ends of a range with four digits, or with as many as needed to distinguish them.
pub fn rounded_range(ends: [f64; 2]) -> [String; 2] {
    match ends.map(rounded) {
        [from, to] if from != to => [from, to],
        _ => range_ends(ends, decimals(ends[1])),
    }
}

/// Returns the number of decimals that shows four digits.
fn decimals(value: f64) -> usize {
    let power = if value > 0.0 { libm::log10(value) } else { 0.0 };
    (4.0 - (power.floor() + 1.0)).max(0.0) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbouring_ends_are_printed_with_distinct_digits() {
        assert_eq!(rounded_range([1.0, 1.5]), ["1.000", "1.500"]);
        assert_eq!(rounded_range([1.10351, 1.10362]), ["1.1035", "1.1036"]);
        assert_eq!(
            rounded_range([0.994_201, 0.994_204]),
            ["0.994201", "0.994204"]
        );
    }
}
