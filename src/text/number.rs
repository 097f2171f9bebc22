//! Numbers in few digits.

/// Returns a number in decimal notation with at most six digits: 0.12, not 0.12000000000000002.
pub fn plain(x: f64) -> String {
    // Six digits, in the notation that gives the fewest digits without trailing zeros.
    short(format!("{x:.5e}").parse().unwrap_or(x))
}

/// Returns a number with `decimals` decimals; zero has no sign.
pub fn format_fixed(x: f64, decimals: usize) -> String {
    let text = format!("{x:.decimals$}");
    match text.strip_prefix('-') {
        Some(size) if text.parse() == Ok(0.0) => size.to_owned(),
        _ => text,
    }
}

/// Returns a bound in the shortest notation: 1e6, not 1000000.0.
pub fn short(x: f64) -> String {
    if x != 0.0 && !(1e-3..1e5).contains(&x.abs()) {
        format!("{x:e}")
    } else {
        format!("{x}")
    }
}
