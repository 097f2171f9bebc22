//! The COSMOS strong-motion format, version 1.20 (volumes 1 and 2).
//!
//! Each history has lines of text, of which the first has `(Format v01.20 with 13 text lines)`, 100 integers, 100 numbers, comments, and its samples below
//! a line such as `7000 acceleration pts, approx 70 secs, units=cm/sec2(04),Format=(8F10.5)`. The numbers 62 and 64 are the step in ms and the peak. Source: COSMOS
//! Strong Motion Data Format (COSMOS 2001, strongmotioncenter.org/vdc/cosmos_format_1_20.pdf), with the indices of the USGS's PRISM.

use archrock_text::{ensure, plain};

use crate::history::{
    History, count_and_step, header_fields, is_text, lines_of_numbers, single_blanks, width_in,
    word_after,
};
use crate::layout::{Format, Parser};
use crate::samples::{LineFault, Parsed, number};

impl Format {
    /// COSMOS strong-motion format (V1, V2).
    pub const COSMOS: Self = Self {
        name: "cosmos",
        label: "COSMOS file",
        extensions: &[],
        begins: |lines| begins(lines[0]),
        parser: Parser::Channels(histories),
    };
}

const REALS: &str = "real-header values follow on ";
/// The number that marks unknown values.
const UNKNOWN: f64 = -999.0;

/// Returns true for the first line of a COSMOS file, as `Corrected acceleration (Format v01.20 with 13 text lines)`.
fn begins(first: &str) -> bool {
    let first = first.to_ascii_lowercase();
    first.contains("(format v0") && first.contains("text lines")
}

/// Finds all histories of a file.
fn histories(lines: &[&str]) -> Parsed<Vec<History>> {
    let (mut histories, mut name, mut reals) = (Vec::new(), String::new(), (1, Vec::new()));
    for (index, line) in lines.iter().enumerate().filter(|(_, line)| is_text(line)) {
        let lower = line.to_ascii_lowercase();
        if let Some(channel) = lower.strip_prefix("sta cha") {
            let channel = &line[line.len() - channel.len()..];
            name = single_blanks(channel.trim_start_matches(['n', 'N', ':', ' ']));
        } else if let Some(count) = word_after(line, REALS) {
            let count = number(count).map_err(LineFault::on(index + 1))?;
            let at = index + 1..index + 1 + count.clamp(0.0, 100.0) as usize;
            reals = (index + 1, header_fields(lines, at, width_in(line), 64)?);
        } else if lower.contains(" pts, approx") {
            histories.push(history(lines, index, &name, &reals)?);
            reals.1.clear();
        }
    }
    let missing = "there is no line like `100 acceleration pts, approx 1 secs, units=cm/sec2`: is this a COSMOS file?";
    histories.first().ok_or_else(|| LineFault::on(1)(missing))?;
    Ok(histories)
}

/// Reads the line before samples. `reals` are the numbers of the header, below their line.
fn history(
    lines: &[&str],
    index: usize,
    name: &str,
    (reals_line, reals): &(usize, Vec<&str>),
) -> Parsed<History> {
    let (line, fault) = (lines[index], LineFault::on::<String>(index + 1));
    ensure(reals.len() >= 64, || {
        fault(format!(
            "no line with `{}` precedes these samples",
            REALS.trim_end()
        ))
    })?;
    let mut words = line.split_whitespace();
    let [count, quantity] = [words.next(), words.next()].map(Option::unwrap_or_default);
    let step_s = number(reals[61]).map(|step_ms| 1e-3 * step_ms);
    let (count, step_s) = count_and_step((index + 1, count), (*reals_line, step_s))?;
    let lasts_s = number(word_after(line, "approx").unwrap_or_default()).map_err(fault)?;
    let found_s = count * step_s;
    // The line gives whole seconds.
    let agrees = (found_s - lasts_s).abs() <= 1.0 + 0.01 * lasts_s;
    ensure(agrees, || {
        let [step_s, lasts_s, found_s] = [step_s, lasts_s, found_s].map(plain);
        fault(format!(
            "these samples last {lasts_s} s, but at the step of {step_s} s in the header they last {found_s} s"
        ))
    })?;
    let unit = word_after(line, "units=").unwrap_or_default();
    let is_known = |peak: &&str| number(peak) != Ok(UNKNOWN);
    Ok(History {
        name: name.to_owned(),
        quantity: quantity.to_lowercase(),
        unit: unit.split([',', '(']).next().unwrap_or_default().to_owned(),
        peak: Some(reals[63]).filter(is_known).map(str::to_owned),
        data: lines_of_numbers(lines, index + 1),
        width: width_in(line),
        ..History::new(index + 1, count, Some(step_s))
    })
}
