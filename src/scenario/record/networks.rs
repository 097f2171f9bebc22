//! Texts of national networks, with a header in words: AFAD (Turkey), CWB (Taiwan) and CSMNC (China).
//!
//! Sources: files of the three networks, and their readers in the USGS's `gmprocess` (groups nsmn and cwb) and in `CSMNC2SAC`.

use super::histories::{History, count_and_step, is_text, lines_of_numbers, squeezed, word_after};
use super::samples::{LineFault, Parsed, number};
use crate::scenario::prelude::*;

/// Largest number of lines of a header.
const MAX_HEADER_LINES: usize = 64;

/// Returns the number of lines of a header, up to the last one with words.
fn header_lines(lines: &[&str]) -> usize {
    let header = &lines[..lines.len().min(MAX_HEADER_LINES)];
    let last = header.iter().rposition(|line| is_text(line));
    last.map_or(0, |last| last + 1)
}

/// Finds the line of a header with a phrase in lower case, single blanks between words. Returns its number, from 1, and the word after the phrase.
fn find(lines: &[&str], phrase: &str) -> Parsed<(usize, String)> {
    let end = header_lines(lines);
    let mut header = lines[..end].iter().zip(1..);
    let found = header.find_map(|(line, number)| {
        let line = squeezed(line);
        Some((number, word_after(&line, phrase)?.to_owned()))
    });
    found.ok_or_else(|| {
        let wrong = format!("the header has no `{}` up to here", phrase.trim_end());
        LineFault::on(end.max(1))(wrong)
    })
}

/// Returns the part of a line after a phrase in lower case.
fn rest<'t>(line: &'t str, phrase: &str) -> Option<&'t str> {
    let at = line.to_ascii_lowercase().find(phrase)? + phrase.len();
    Some(&line[at..])
}

/// Finds the three components of a file of AFAD: columns `N-S`, `E-W` and `U-D`, in gal.
pub(super) fn afad(lines: &[&str]) -> Parsed<Vec<History>> {
    let (line, count) = find(lines, "number of data : ")?;
    let (_, step) = find(lines, "sampling interval (sec) : ")?;
    let (count, step_s) = count_and_step(line, &count, number(&step))?;
    let end = header_lines(lines);
    let names: Vec<_> = lines[end - 1].split_whitespace().collect();
    ensure(names.len() == 3, || {
        LineFault::on(end)("the line before the numbers must name three components")
    })?;
    let peaks = find(lines, "raw pga values (gal) : ").map_or("", |(line, _)| lines[line - 1]);
    let histories = names.iter().enumerate().map(|(index, name)| History {
        name: squeezed(name),
        quantity: "acceleration".to_owned(),
        line,
        unit: "gal".to_owned(),
        factor: 1.0,
        step_s: Some(step_s),
        count,
        columns: (3, index),
        peak: word_after(peaks, &format!("({}) ", name.to_lowercase())).map(str::to_owned),
        data: lines_of_numbers(lines, end),
        width: 0,
    });
    Ok(histories.collect())
}

/// Finds the components of a file of CWB: a column of times, then those that the header names.
pub(super) fn cwb(lines: &[&str]) -> Parsed<Vec<History>> {
    let end = header_lines(lines);
    let (line, lasts_s) = find(lines, "#recordlength(sec):")?;
    let (rate_line, rate) = find(lines, "#samplerate(hz):")?;
    let (_, unit) = find(lines, "#amplitudeunit:")?;
    let (order_line, _) = find(lines, "#datasequence: time")?;
    let (lasts_s, step_s) = count_and_step(line, &lasts_s, number(&rate).map(f64::recip))?;
    let data = lines_of_numbers(lines, end);
    let count = lines[data.clone()]
        .iter()
        .filter(|line| !line.trim().is_empty())
        .count() as f64;
    // The header gives the length only.
    ensure((count * step_s - lasts_s).abs() <= 1.0, || {
        let [found_s, lasts_s] = [count * step_s, lasts_s].map(plain);
        LineFault::on(data.end.max(1))(format!(
            "the file ends after {found_s} s at the rate on line {rate_line}: line {line} announces {lasts_s} s"
        ))
    })?;
    let names = rest(lines[order_line - 1], "time").unwrap_or_default();
    let names: Vec<_> = names
        .split(';')
        .map(|name| squeezed(name.trim().trim_end_matches("(+)")))
        .collect();
    let histories = names.iter().enumerate().map(|(index, name)| {
        let phrase = format!("#amplitudemax. {}:", name.to_lowercase());
        let peaks = lines[..end]
            .iter()
            .find_map(|line| rest(line, &phrase))
            .unwrap_or_default();
        let magnitude = |word: &&str| number(word).unwrap_or_default().abs();
        let peak = peaks
            .split('~')
            .map(str::trim)
            .filter(|word| number(word).is_ok());
        History {
            name: name.clone(),
            quantity: "acceleration".to_owned(),
            line,
            unit: unit.trim_end_matches('.').to_owned(),
            factor: 1.0,
            step_s: None,
            count,
            columns: (names.len() + 1, index + 1),
            peak: peak
                .max_by(|a, b| magnitude(a).total_cmp(&magnitude(b)))
                .map(str::to_owned),
            data: data.clone(),
            width: 10,
        }
    });
    Ok(histories.collect())
}

/// Finds the only history of a file of CSMNC.
pub(super) fn csmnc(lines: &[&str]) -> Parsed<Vec<History>> {
    let (line, count) = find(lines, "no. of points:")?;
    let (_, step) = find(lines, "spaced intervals of:")?;
    let (unit_line, unit) = find(lines, "unit:")?;
    let (count, step_s) = count_and_step(line, &count, number(&step))?;
    let held = lines[unit_line - 1].to_ascii_lowercase();
    let quantity = ["acceleration", "velocity", "displacement"]
        .into_iter()
        .find(|one| held.contains(one));
    Ok(vec![History {
        name: find(lines, "comp.")
            .map(|(_, name)| name)
            .unwrap_or_default(),
        quantity: quantity.unwrap_or("unknown samples").to_owned(),
        line,
        unit,
        factor: 1.0,
        step_s: Some(step_s),
        count,
        columns: (1, 0),
        peak: find(lines, "peak value:").ok().map(|(_, peak)| peak),
        data: lines_of_numbers(lines, header_lines(lines)),
        width: 0,
    }])
}
