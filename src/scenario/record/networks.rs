//! Texts of national networks, with a header in words: AFAD (Turkey), CWB (Taiwan), CSMNC (China) and UNAM (Mexico).
//!
//! Sources: files of the first three networks, and their readers in the USGS's `gmprocess` (groups nsmn and cwb) and in `CSMNC2SAC`. The standard
//! format of UNAM, version 2.0, follows the readers in `gmprocess` (group unam), in OpenQuake's `smtk` (ASA), and of the Institute of Engineering,
//! which agree; no original description was at hand.

use std::ops::Range;

use super::histories::{
    History, count_and_step, fields, is_text, largest, rest, squeezed, word_after,
};
use super::samples::{LineFault, Parsed, number, step_of_rate, surplus, words};
use super::unit::Unit;
use crate::scenario::prelude::*;

/// Largest number of lines of a header.
const MAX_HEADER_LINES: usize = 64;

/// Finds the line of a header with a phrase in lower case, single blanks between words. Returns its number, from 1, and the word after the phrase.
fn find(header: &[&str], phrase: &str) -> Parsed<(usize, String)> {
    let mut lines = header.iter().zip(1..).take(MAX_HEADER_LINES);
    let found = lines.find_map(|(line, number)| {
        let line = squeezed(line);
        Some((number, word_after(&line, phrase)?.to_owned()))
    });
    found.ok_or_else(|| {
        let wrong = format!("the header has no `{}` up to here", phrase.trim_end());
        LineFault::on(header.len().clamp(1, MAX_HEADER_LINES))(wrong)
    })
}

/// Splits a file into header and numbers. The header extends to the line with a phrase, and over further lines that are blank or satisfy `is_header`.
/// Words among the numbers are a fault, or the numbers of another record would be read with this header.
fn header_and_data<'l, 't>(
    lines: &'l [&'t str],
    phrase: &str,
    is_header: fn(&str) -> bool,
) -> Parsed<(&'l [&'t str], Range<usize>)> {
    let (above, _) = find(lines, phrase)?;
    let is_data = |line: &&str| words(line).next().is_some() && !is_header(line);
    let length = lines[above..].iter().position(is_data);
    let data = length.map_or(lines.len(), |length| above + length)..lines.len();
    refuse_words(lines, data.clone())?;
    Ok((&lines[..data.start], data))
}

/// Returns a fault if there are words among the numbers.
fn refuse_words(lines: &[&str], mut data: Range<usize>) -> Parsed<()> {
    if let Some(index) = data.find(|index| is_text(lines[*index])) {
        let text = excerpt(lines[index]);
        return Err(LineFault::on(index + 1)(format!(
            "`{text}` is not a row of numbers; if another record begins here, give it a file of its own"
        )));
    }
    Ok(())
}

/// Finds the three components of a file of AFAD: columns `N-S`, `E-W` and `U-D`, in the unit of the peaks.
pub(super) fn afad(lines: &[&str]) -> Parsed<Vec<History>> {
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
        name: squeezed(name),
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

/// Finds the components of a file of CWB: a column of times, then those that the header names.
pub(super) fn cwb(lines: &[&str]) -> Parsed<Vec<History>> {
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
        .map(|name| squeezed(name.trim_end_matches("(+)")))
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

/// Finds the channels of a file of UNAM. In its header a line has a name, a colon and the values of the channels, each after a slash. The numbers are
/// below the first line of dashes before a number.
pub(super) fn unam(lines: &[&str]) -> Parsed<Vec<History>> {
    /// Largest number of lines of a header; 109 is usual.
    const MAX_LINES: usize = 256;
    let most = lines.len().min(MAX_LINES);
    let is_last = |index: &usize| {
        let below = lines[index + 1..]
            .iter()
            .find(|line| !line.trim().is_empty());
        lines[*index].contains("----")
            && below.is_some_and(|line| !is_text(line) && !line.contains("----"))
    };
    let end = (0..most).find(is_last).map_or(most, |index| index + 1);
    refuse_words(lines, end..lines.len())?;
    let entry = |name: &str| {
        let found = lines[..end].iter().zip(1..).find_map(|(line, number)| {
            let value = rest(line, name)?.split_once(':')?.1;
            Some((number, value.trim()))
        });
        let wrong = || format!("the header has no `{name}` up to here");
        found.ok_or_else(|| LineFault::on(end.max(1))(wrong()))
    };
    let of_channels = |name: &str| {
        let (line, values) = entry(name)?;
        let values = values.split('/').map(str::trim);
        Ok((line, values.filter(|value| !value.is_empty()).collect()))
    };
    let (line, counts): (usize, Vec<&str>) = of_channels("num. total de muestras, c1")?;
    let (step_line, steps) = of_channels("intervalo de muestreo, c1")?;
    let (name_line, names) = of_channels("orientacion c1")?;
    for (other_line, other) in [(step_line, &steps), (name_line, &names)] {
        let [found, channels] = [other.len(), counts.len()];
        ensure(found == channels, || {
            LineFault::on(other_line)(format!(
                "the number of channels differs: {found} in this line, {channels} in line {line}"
            ))
        })?;
    }
    let (_, unit) = entry("unidades de los datos")?;
    let in_brackets = unit
        .split_once('(')
        .and_then(|(_, unit)| unit.split_once(')'));
    let unit = in_brackets.map_or(unit, |(unit, _)| unit.trim());
    let peaks = of_channels("acel. max.(gal), c1").map(|(_, peaks)| peaks);
    let fits = |peaks: &Vec<&str>| {
        Unit::written(unit) == Some(Unit::CentimetrePerS2) && peaks.len() == counts.len()
    };
    let peaks = peaks.ok().filter(fits).unwrap_or_default();
    let channels = counts.iter().zip(&steps).zip(&names).enumerate();
    let histories = channels.map(|(index, ((count, step), name))| {
        let (count, step_s) = count_and_step((line, count), (step_line, number(step)))?;
        Ok(History {
            name: squeezed(name),
            unit: unit.to_owned(),
            columns: (counts.len(), index),
            is_table: true,
            peak: peaks.get(index).map(|peak| (*peak).to_owned()),
            data: end..lines.len(),
            ..History::new(line, count, Some(step_s))
        })
    });
    histories.collect()
}

/// Finds the only history of a file of CSMNC.
pub(super) fn csmnc(lines: &[&str]) -> Parsed<Vec<History>> {
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
