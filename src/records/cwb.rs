//! The text files of the Central Weather Bureau, Taiwan (CWB).
//!
//! A header of lines that begin with `#`, then rows of a time and the components. Source: files of CWB, and the reader in the USGS's `gmprocess` (group cwb).

use archrock_text::{ensure, plain};

use crate::history::{History, count_and_step, fields, has, largest, rest, single_blanks};
use crate::layout::{Format, Parser};
use crate::networks::{find, header_and_data};
use crate::samples::{LineFault, Parsed, number, step_of_rate, surplus, words};

impl Format {
    /// Central Weather Bureau, Taiwan.
    pub const CWB: Self = Self {
        name: "cwb",
        label: "file of CWB",
        extensions: &[],
        begins: |lines| has(lines, "#AmplitudeUnit:") && has(lines, "#DataSequence: Time"),
        parser: Parser::Channels(histories),
    };
}

/// Finds the components of a file of CWB: a column of times, then those that the header names.
fn histories(lines: &[&str]) -> Parsed<Vec<History>> {
    /// Number of characters of a number.
    const WIDTH: usize = 10;
    let is_header = |line: &str| line.trim_start().starts_with('#');
    let (header, data) = header_and_data(lines, "#datasequence: time", is_header)?;
    let (line, lasts_s) = find(header, "#recordlength(sec):")?;
    let (rate_line, rate) = find(header, "#samplerate(hz):")?;
    let (_, unit) = find(header, "#amplitudeunit:")?;
    let (order_line, _) = find(header, "#datasequence: time")?;
    let step_s = number(&rate).and_then(|rate_hz| step_of_rate("the rate", rate_hz));
    let (lasts_s, step_s) = count_and_step((line, &lasts_s), (rate_line, step_s))?;
    let is_row = |index: &usize| words(lines[*index]).next().is_some();
    let rows: Vec<usize> = data.clone().filter(is_row).collect();
    let count = rows.len() as f64;
    let last_line = rows.last().map_or(data.end.max(1), |index| index + 1);
    // The header gives only the length: the step times the number of samples, or of steps between them.
    ensure((count * step_s - lasts_s).abs() <= 1.5 * step_s, || {
        let remedy = surplus((count - lasts_s / step_s).round(), line);
        let [found_s, lasts_s] = [count * step_s, lasts_s].map(plain);
        LineFault::on(last_line)(format!(
            "the file ends after {found_s} s at the rate on line {rate_line}: line {line} announces {lasts_s} s{remedy}"
        ))
    })?;
    let time_s = |row: Option<&usize>| {
        row.map_or(Ok(0.0), |index| {
            let row = fields(lines[*index], WIDTH);
            let time = row.first().copied().unwrap_or_default();
            number(time).map_err(LineFault::on(index + 1))
        })
    };
    let spans_s = time_s(rows.last())? - time_s(rows.first())?;
    let has_step = (spans_s - (count - 1.0) * step_s).abs() <= 0.5 * step_s;
    ensure(has_step, || {
        let [spans_s, step_s] = [spans_s, step_s].map(plain);
        LineFault::on(last_line)(format!(
            "{count} rows take {spans_s} s: line {rate_line} announces a step of {step_s} s"
        ))
    })?;
    let names = rest(header[order_line - 1], "time").unwrap_or_default();
    let names = names.split(';').map(str::trim);
    let names: Vec<_> = names
        .map(|name| single_blanks(name.trim_end_matches("(+)")))
        .collect();
    let histories = names.iter().enumerate().map(|(index, name)| {
        let phrase = format!("#amplitudemax. {}:", name.to_lowercase());
        let peaks = header.iter().find_map(|line| rest(line, &phrase));
        History {
            name: name.clone(),
            unit: unit.clone(),
            columns: (names.len() + 1, index + 1),
            is_table: true,
            peak: largest(peaks.unwrap_or_default().split('~').map(str::trim)),
            data: data.clone(),
            width: WIDTH,
            ..History::new(line, count, None)
        }
    });
    Ok(histories.collect())
}
