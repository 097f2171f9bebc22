//! The files of the California Strong Motion Instrumentation Program (volumes 1 and 2), and those that are like its older ones: of RENADIC (Chile), of the
//! University of Southern California (USC, as before it of the California Institute of Technology), and of BHRC (Iran).
//!
//! Each channel has lines of text, integers and numbers, then its samples. In volume 2, a line such as `7500 points of accel data equally spaced
//! at .010 sec, in cm/sec2. (8f10.6)` begins accelerations, velocities and displacements; in volume 1, a line such as `13200 Accelerogram points at 200
//! pts/sec in units of g . Format: (8f9.6)`. Without such a line, 27 lines of header precede pairs of times and accelerations in fields of seven characters, in the unit
//! that the text gives as `UNITS OF UNCOR ACCEL ARE SEC AND G/10`. A line with `End of data` ends the channel. In volume 2 of USC the line before
//! samples may lack their unit, which is then that of the stated peak. BHRC has no times: the step is the duration over the number of samples. Sources:
//! files of the USGS's tests of `gmprocess` (groups dmg, renadic, usc and bhrc), and its readers of them.

use std::ops::Range;

use crate::history::{
    History, count_and_step, is_text, lines_of_numbers, rest, single_blanks, width_in, word_after,
};
use crate::layout::{Format, Parser};
use crate::samples::{LineFault, Parsed, checked_step, number, step_of_rate};
use crate::unit::Unit;

impl Format {
    /// California Strong Motion Instrumentation Program (V1, V2), RENADIC.
    pub const CSMIP: Self = Self {
        name: "csmip",
        label: "file of CSMIP",
        extensions: &[],
        begins: |lines| begins(lines[0]),
        parser: Parser::Channels(histories),
    };
}

impl Format {
    /// University of Southern California, California Institute of Technology (Volumes I and II).
    pub const USC: Self = Self {
        name: "usc",
        label: "file of USC",
        extensions: &[],
        begins: is_usc,
        parser: Parser::Channels(histories),
    };
}

impl Format {
    /// Building and Housing Research Center, Iran (V1).
    pub const BHRC: Self = Self {
        name: "bhrc",
        label: "file of BHRC",
        extensions: &[],
        begins: |lines| is_bhrc(lines[0]),
        parser: Parser::Channels(histories),
    };
}

/// Lines of text, integers and numbers before the pairs of volume 1.
const HEADER_LINES: usize = 27;
/// Largest number of lines at the beginning of a channel that are searched for its name and peaks.
const SEARCHED_LINES: usize = 64;

/// Returns true for the first line of a CSMIP file, and of its channels.
fn begins(first: &str) -> bool {
    let first = first.trim_start().to_ascii_lowercase();
    first.starts_with("corrected accelerogram") || first.starts_with("uncorrected accelerogram")
}

/// Returns true for the first lines of a file of USC, of which one is like `FILE 0 OF UNCORRECTED ACCELEROGRAM DATA OF VOLUME I`.
fn is_usc(lines: &[&str]) -> bool {
    let mut first = lines.iter().take(2).map(|line| single_blanks(line));
    first.any(|line| {
        line.starts_with("FILE ") && line.contains("OF UNCORRECTED ACCELEROGRAM DATA OF VOL")
    })
}

/// Returns true for the first line of a file of BHRC, and of its channels, as `* VOL1DS FILE:  5520/01`.
fn is_bhrc(first: &str) -> bool {
    first.starts_with("* VOL") && first.contains(" FILE")
}

/// Finds all histories of a file.
fn histories(lines: &[&str]) -> Parsed<Vec<History>> {
    let (mut histories, mut start, mut in_channel) = (Vec::new(), 0, 0);
    for (index, line) in lines.iter().enumerate().filter(|(_, line)| is_text(line)) {
        let lower = line.to_ascii_lowercase();
        let is_end = lower.contains("end of data");
        if is_end || begins(line) || is_bhrc(line) {
            if histories.len() == in_channel {
                histories.extend(volume_1(lines, start..index)?);
            }
            start = index + usize::from(is_end);
            in_channel = histories.len();
        } else if let Some((_, quantity)) = BLOCKS.iter().find(|(block, _)| lower.contains(block)) {
            histories.push(equally_spaced(lines, start, index, quantity)?);
        }
    }
    if histories.len() == in_channel {
        histories.extend(volume_1(lines, start..lines.len())?);
    }
    let missing = "there is no line like `100 points of accel data equally spaced at .01 sec` or `NO. OF POINTS`: is this a file of CSMIP, USC or BHRC?";
    histories.first().ok_or_else(|| LineFault::on(1)(missing))?;
    Ok(histories)
}

/// Lines before samples, and their quantities.
const BLOCKS: [(&str, &str); 8] = [
    ("points of accel data", "acceleration"),
    ("points of acc data", "acceleration"),
    ("points of veloc data", "velocity"),
    ("points of vel data", "velocity"),
    ("points of displ data", "displacement"),
    ("points of disp data", "displacement"),
    ("points of dis data", "displacement"),
    ("accelerogram points at", "acceleration"),
];

/// Reads the line before samples at a constant step, of the channel that begins at `start`.
fn equally_spaced(lines: &[&str], start: usize, index: usize, quantity: &str) -> Parsed<History> {
    let line = lines[index];
    let header = &lines[start..index.min(start + SEARCHED_LINES)];
    let step_s = match word_after(line, "points at ") {
        Some(rate) => number(rate).and_then(|rate_hz| step_of_rate("the rate", rate_hz)),
        None => number(word_after(line, "spaced at ").unwrap_or_default()),
    };
    let count = line.split_whitespace().next().unwrap_or_default();
    let (count, step_s) = count_and_step((index + 1, count), (index + 1, step_s))?;
    let unit = ["sec, in ", "units of ", "units: ", "in units "]
        .into_iter()
        .find_map(|phrase| word_after(line, phrase));
    let peak = format!("peak {quantity} = ");
    let peaks = header.iter().filter_map(|line| {
        let line = single_blanks(line);
        let stated = rest(&line, &peak).or_else(|| rest(&line, " max = "))?;
        let (word, rest) = stated.split_once(' ')?;
        Some((word.to_owned(), rest.split(' ').next()?.to_owned()))
    });
    let is_of = |(_, own): &(String, String)| {
        unit.is_none_or(|unit| Unit::written(own) == Unit::written(unit))
    };
    let (stated, unit_of_peak) = peaks.clone().find(is_of).unzip();
    Ok(History {
        name: name(header),
        quantity: quantity.to_owned(),
        unit: unit.map(str::to_owned).or(unit_of_peak).unwrap_or_default(),
        peak: stated,
        data: lines_of_numbers(lines, index + 1),
        width: width_in(line),
        ..History::new(index + 1, count, Some(step_s))
    })
}

/// Reads the header of a channel of volume 1: of times and accelerations, or of BHRC's accelerations; `None` without one.
fn volume_1(lines: &[&str], channel: Range<usize>) -> Parsed<Option<History>> {
    let start = channel.start;
    let header = &lines[start..channel.end.min(start + HEADER_LINES)];
    let find = |phrase: &str| {
        header.iter().zip(start..).find_map(|(line, index)| {
            Some((index, word_after(&single_blanks(line), phrase)?.to_owned()))
        })
    };
    let unit = find("are sec and ").or_else(|| find("are seconds and "));
    let [Some((line, count)), Some((_, unit))] = [find("no. of points = "), unit] else {
        return Ok(None);
    };
    let fault = LineFault::on::<String>(line + 1);
    let count = number(&count).map_err(fault)?;
    let unit = unit.trim_end_matches('.');
    let (unit, tenths) = unit.split_once('/').unwrap_or((unit, "1"));
    let tenths = number(tenths).map_err(fault)?;
    let (columns, width, step_s) = match header.first().is_some_and(|first| is_bhrc(first)) {
        true => {
            let lasts_s = find("duration = ").map_or(String::new(), |(_, duration)| duration);
            let step_s = number(&lasts_s).map(|lasts_s| lasts_s / count);
            let step_s = step_s.and_then(|step_s| checked_step("the duration per sample", step_s));
            ((1, 0), 13, Some(step_s.map_err(fault)?))
        }
        false => ((2, 1), 7, None),
    };
    Ok(Some(History {
        name: name(header),
        unit: unit.to_owned(),
        factor: tenths.recip(),
        columns,
        peak: find("max = ").map(|(_, peak)| peak),
        data: lines_of_numbers(lines, start + HEADER_LINES),
        width,
        ..History::new(line + 1, count, step_s)
    }))
}

/// Returns the name of a channel, as `360 Deg` in `Chan  1: 360 Deg`, or `N08W` in `COMP N08W`.
fn name(header: &[&str]) -> String {
    let channel = header.iter().find_map(|line| {
        let (label, name) = line.split_once(':')?;
        let is_name = label.trim_start().to_ascii_lowercase().starts_with("chan ");
        is_name.then(|| single_blanks(name))
    });
    let component = || {
        header
            .iter()
            .find_map(|line| line.strip_prefix("COMP ")?.split_whitespace().next())
    };
    channel
        .or_else(|| component().map(str::to_owned))
        .unwrap_or_default()
}
