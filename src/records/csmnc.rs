//! The text files of the China Strong Motion Networks Center (CSMNC).
//!
//! A header in words, then the samples, several a row. Source: files of CSMNC, and their reader `CSMNC2SAC`.

use crate::history::{History, count_and_step, has, is_text};
use crate::layout::{Format, Parser};
use crate::networks::{find, header_and_data};
use crate::samples::{Parsed, number};

impl Format {
    /// China Strong Motion Networks Center.
    pub const CSMNC: Self = Self {
        name: "csmnc",
        label: "file of CSMNC",
        extensions: &[],
        begins: |lines| has(lines, "NO. OF POINTS:") && has(lines, "SPACED INTERVALS OF:"),
        parser: Parser::History(histories),
    };
}

/// Finds the only history of a file of CSMNC.
fn histories(lines: &[&str]) -> Parsed<Vec<History>> {
    let (header, data) = header_and_data(lines, "peak value:", is_text)?;
    let (line, count) = find(header, "no. of points:")?;
    let (step_line, step) = find(header, "spaced intervals of:")?;
    let (unit_line, unit) = find(header, "unit:")?;
    let (count, step_s) = count_and_step((line, &count), (step_line, number(&step)))?;
    let held = header[unit_line - 1].to_ascii_lowercase();
    let quantity = ["acceleration", "velocity", "displacement"]
        .into_iter()
        .find(|one| held.contains(one));
    let (_, name) = find(header, "comp.").unwrap_or_default();
    Ok(vec![History {
        name,
        quantity: quantity.unwrap_or("unknown samples").to_owned(),
        unit,
        peak: find(header, "peak value:").ok().map(|(_, peak)| peak),
        data,
        ..History::new(line, count, Some(step_s))
    }])
}
