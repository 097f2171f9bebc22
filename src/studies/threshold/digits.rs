//! Factors and accelerations with a suitable number of digits.

use crate::output::range_ends;

/// Factor or an acceleration with four digits: the usual accuracy of an edge.
pub fn format_edge(value: f64) -> String {
    let decimals = decimals(value);
    format!("{value:.decimals$}")
}

/// Strength that is safe with four digits, never rounded upwards.
pub fn rounded_down(value: f64) -> String {
    round_down(value, decimals(value))
}

fn round_down(value: f64, decimals: usize) -> String {
    // A little less than half a digit keeps decimal numbers such as 0.45 unchanged.
    let lowered = value - (0.5 - 1e-9) * 0.1_f64.powi(decimals as i32);
    format!("{lowered:.decimals$}")
}

/// Both ends of a range with four digits, or with as many as needed to distinguish them.
pub fn rounded_range(ends: [f64; 2]) -> [String; 2] {
    match ends.map(format_edge) {
        [from, to] if from != to => [from, to],
        _ => range_ends(ends, decimals(ends[1])),
    }
}

/// Safe strength, never rounded upwards, and one that overturns, with four digits, or with as many as needed to distinguish them.
pub fn rounded_edge(ends: [Option<f64>; 2]) -> [Option<String>; 2] {
    // More decimals than two different strengths need.
    const MOST: usize = 12;
    let [Some(safe), Some(overturns)] = ends else {
        return [ends[0].map(rounded_down), ends[1].map(format_edge)];
    };
    let [below, above] = [safe, overturns].map(decimals);
    let with = |more: usize| {
        let above = above + more;
        [
            round_down(safe, below + more),
            format!("{overturns:.above$}"),
        ]
    };
    let longer = (0..MOST).filter(|_| safe != overturns);
    let distinct = longer.map(with).find(|[safe, other]| safe != other);
    distinct.unwrap_or_else(|| with(0)).map(Some)
}

/// Number of decimals that shows four digits.
fn decimals(value: f64) -> usize {
    let power = if value > 0.0 { libm::log10(value) } else { 0.0 };
    (4.0 - (power.floor() + 1.0)).max(0.0) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_two_sides_of_an_edge_are_printed_with_distinct_digits() {
        for (ends, printed) in [
            ([1.0, 1.5], ["1.000", "1.500"]),
            ([1.283_09, 1.283_17], ["1.2830", "1.2832"]),
            ([1.283_98, 1.284_07], ["1.283", "1.284"]),
            ([0.999_96, 1.000_04], ["0.9999", "1.000"]),
            ([0.500_001, 0.500_04], ["0.50000", "0.50004"]),
            ([12_345.2, 12_346.0], ["12345", "12346"]),
            ([2.0, 2.0], ["2.000", "2.000"]),
        ] {
            assert_eq!(
                rounded_edge(ends.map(Some)),
                printed.map(|text| Some(text.to_owned()))
            );
        }
    }

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
