//! The SMC files of the U.S. Geological Survey (National Strong Motion Program).
//!
//! 11 lines of text, 48 integers (8I10), 50 numbers (5E15.7), comments that begin with `|`, then accelerations in cm/s2 (or velocities in cm/s) in
//! fields of ten characters. If the header has no sampling rate, every sample follows its time. Source: the format description of the USGS
//! (escweb.wr.usgs.gov/nsmp-data/smcfmt.html), as its `gmprocess` and the files of its tests follow it.

use archrock_text::ensure;

use crate::history::{History, count_and_step, header_fields, largest, single_blanks};
use crate::layout::{Format, Parser};
use crate::samples::{LineFault, Parsed, number, step_of_rate};

impl Format {
    /// U.S. Geological Survey (SMC).
    pub const SMC: Self = Self {
        name: "smc",
        label: "SMC file (USGS)",
        extensions: &[],
        begins: |lines| begins(lines[0]),
        parser: Parser::History(histories),
    };
}

const INTEGERS: usize = 11;
const REALS: usize = 17;
const COMMENTS: usize = 27;
/// Line of the header with the number of samples, from 1.
const COUNT_LINE: usize = 14;
/// Line of the header with the sampling rate, from 1.
const RATE_LINE: usize = 18;

/// Returns true for the first line of an SMC file, as `2 CORRECTED ACCELEROGRAM`.
fn begins(first: &str) -> bool {
    const KINDS: [&str; 4] = ["ACCELEROGRAM", "VELOCITY", "DISPLACEMENT", "SPECTRA"];
    let first = first.trim();
    let has_code =
        first.starts_with(|c: char| ('0'..='6').contains(&c)) && first[1..].starts_with(' ');
    has_code && KINDS.iter().any(|kind| first.contains(kind))
}

/// Finds the only history of a file.
fn histories(lines: &[&str]) -> Parsed<Vec<History>> {
    let first = lines.first().copied().unwrap_or_default();
    let wrong = "the first line is not like `2 CORRECTED ACCELEROGRAM`: is this an SMC file?";
    ensure(begins(first), || LineFault::on(1)(wrong))?;
    let integers = header_fields(lines, INTEGERS..REALS, 10, 48)?;
    let reals = header_fields(lines, REALS..COMMENTS, 15, 50)?;
    let comments = number(integers[15]).unwrap_or_default().clamp(0.0, 1e4) as usize;
    let data = COMMENTS + comments;
    let is_comment = |index: &usize| {
        lines
            .get(*index)
            .is_none_or(|line| line.trim_start().starts_with('|'))
    };
    if let Some(index) = (COMMENTS..data).find(|index| !is_comment(index)) {
        let wrong = format!(
            "line 13 announces {comments} lines of comments, but this one does not begin with `|`"
        );
        return Err(LineFault::on(index + 1)(wrong));
    }
    // The first number marks unknown values.
    let known = |index: usize| Some(reals[index]).filter(|real| *real != reals[0]);
    let rate = known(1);
    let step_s = rate.map_or(Ok(1.0), |rate| step_of_rate("the rate", number(rate)?));
    let (count, step_s) = count_and_step((COUNT_LINE, integers[16]), (RATE_LINE, step_s))?;
    let (columns, count, step_s) = match rate {
        Some(_) => ((1, 0), count, Some(step_s)),
        None => ((2, 1), 0.5 * count, None),
    };
    let kind = first.trim()[2..].trim();
    let (quantity, unit) = match kind {
        _ if kind.contains("ACCELEROGRAM") => ("acceleration", "cm/s2"),
        _ if kind == "VELOCITY" => ("velocity", "cm/s"),
        _ => (kind, ""),
    };
    let name = lines[5]
        .split_once("component=")
        .map_or("", |(_, name)| name);
    Ok(vec![History {
        name: single_blanks(name),
        quantity: quantity.to_lowercase(),
        unit: unit.to_owned(),
        columns,
        peak: largest([known(29), known(31)].into_iter().flatten()),
        data: data.min(lines.len())..lines.len(),
        width: 10,
        ..History::new(COUNT_LINE, count, step_s)
    }])
}
