//! The text files of AFAD, Turkey.
//!
//! A header in words, then rows of three components. Source: files of AFAD, and the reader in the USGS's `gmprocess` (group nsmn).

use archrock_text::ensure;

use crate::history::{History, count_and_step, is_text, single_blanks, word_after};
use crate::layout::{Format, Parser};
use crate::networks::{find, header_and_data};
use crate::samples::{LineFault, Parsed, number};

impl Format {
    /// AFAD, Turkey.
    pub const AFAD: Self = Self {
        name: "afad",
        label: "file of AFAD",
        extensions: &[],
        begins: |lines| lines[0].starts_with("STRONG GROUND MOTION RECORDS OF"),
        parser: Parser::Channels(histories),
    };
}

/// Finds the three components of a file of AFAD: columns `N-S`, `E-W` and `U-D`, in the unit of the peaks.
fn histories(lines: &[&str]) -> Parsed<Vec<History>> {
    let (header, data) = header_and_data(lines, "raw pga values (", is_text)?;
    let (line, count) = find(header, "number of data : ")?;
    let (step_line, step) = find(header, "sampling interval (sec) : ")?;
    let (count, step_s) = count_and_step((line, &count), (step_line, number(&step)))?;
    let (peaks, unit) = find(header, "raw pga values (")?;
    let end = header.iter().rposition(|line| is_text(line));
    let end = end.unwrap_or_default();
    let names: Vec<_> = header[end].split_whitespace().collect();
    ensure(names.len() == 3, || {
        LineFault::on(end + 1)("the line before the numbers must name three components")
    })?;
    let histories = names.iter().enumerate().map(|(index, name)| History {
        name: single_blanks(name),
        unit: unit.clone(),
        columns: (3, index),
        is_table: true,
        peak: word_after(header[peaks - 1], &format!("({}) ", name.to_lowercase()))
            .map(str::to_owned),
        data: data.clone(),
        ..History::new(line, count, Some(step_s))
    });
    Ok(histories.collect())
}
