//! Factors and accelerations in words.

use crate::output::range_ends;

/// A factor or an acceleration with four digits, about as many as are certain for an edge.
#[must_use]
pub fn rounded(value: f64) -> String {
    let decimals = decimals(value);
    format!("{value:.decimals$}")
}

/// Both ends of a range with four digits, or with as many as it takes to distinguish them.
#[must_use]
pub fn rounded_range(ends: [f64; 2]) -> [String; 2] {
    match ends.map(rounded) {
        [from, to] if from != to => [from, to],
        _ => range_ends(ends, decimals(ends[1])),
    }
}

/// Decimals of four digits.
fn decimals(value: f64) -> usize {
    let power = if value > 0.0 { value.log10() } else { 0.0 };
    (4.0 - (power.floor() + 1.0)).max(0.0) as usize
}
