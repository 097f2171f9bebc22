//! The accelerogram files of GeoNet, New Zealand (V1A and V2A).
//!
//! Each component has 16 lines of text, 4 of ten integers (10I8) and 6 of ten numbers (10F8), then blocks of accelerations, velocities and displacements
//! with ten numbers a line, in mm/s2, mm/s and mm. The integers have the number of samples of each block, the numbers step and peaks. Source: GNS Accelerogram Data File
//! Format (GeoNet), as files of the USGS's tests of `gmprocess` follow it.

use archrock_text::{ensure, plain};

use crate::history::{History, header_fields, lines_of_numbers, rest, single_blanks};
use crate::layout::{Format, Parser};
use crate::samples::{LineFault, Parsed, checked_step, number, words};
use crate::unit::Unit;

impl Format {
    /// GeoNet, New Zealand (V1A, V2A).
    pub const GEONET: Self = Self {
        name: "geonet",
        label: "file of GeoNet",
        extensions: &[],
        begins,
        parser: Parser::Channels(histories),
    };
}

const INTEGERS: usize = 16;
const REALS: usize = 20;
const DATA: usize = 26;
const COLUMNS: usize = 10;

/// Returns true for the first lines of a component of a GeoNet file.
fn begins(lines: &[&str]) -> bool {
    let has = |index: usize, word: &str| lines.get(index).is_some_and(|line| line.contains(word));
    has(0, "orrected accelerogram") && has(1, "Site ") && has(9, "Number of points")
}

/// Finds all histories of a file.
fn histories(lines: &[&str]) -> Parsed<Vec<History>> {
    let filled = |from| (from..lines.len()).find(|index| words(lines[*index]).next().is_some());
    let (mut histories, mut next) = (Vec::new(), Some(filled(0).unwrap_or(0)));
    while let Some(start) = next {
        ensure(begins(&lines[start..]), || {
            LineFault::on(start + 1)(if histories.is_empty() {
                "the lines do not begin like `Corrected accelerogram`, `Site`: is this a file of GeoNet?"
            } else {
                "no component begins here; the number of samples in the header may be wrong"
            })
        })?;
        next = filled(component(lines, start, &mut histories)?);
    }
    Ok(histories)
}

/// Reads the header of a component. Returns the index of the line after its numbers.
fn component(lines: &[&str], start: usize, histories: &mut Vec<History>) -> Parsed<usize> {
    let integers = header_fields(lines, start + INTEGERS..start + REALS, 8, 40)?;
    let reals = header_fields(lines, start + REALS..start + DATA, 8, 60)?;
    let is_corrected = lines[start].trim_start().starts_with("Corr");
    let text = &lines[start..start + INTEGERS];
    let named = text.iter().find_map(|line| line.strip_prefix("Component"));
    // Raw readings may have another unit.
    let mut raw = text.iter().zip(start + 1..).filter(|_| !is_corrected);
    let raw = raw.find_map(|(line, number)| Some((number, rest(line, "units of ")?)));
    let (factor, unit) = match raw {
        Some((line, text)) => raw_unit(text).map_err(LineFault::on(line))?,
        None => (1.0, "mm/s2"),
    };
    // The header has peaks in millimetres.
    let has_peak = Unit::written(unit) == Some(Unit::MillimetrePerS2);
    let peak = has_peak.then_some(if is_corrected { 35 } else { 30 });
    let (line, mut from) = (start + REALS, start + DATA);
    let step_s = number(reals[25]).and_then(|step_s| checked_step("the step", step_s));
    let step_s = step_s.map_err(LineFault::on(line + 3))?;
    let blocks = [
        ("acceleration", unit, factor, peak),
        ("velocity", "mm/s", 1.0, Some(40)),
        ("displacement", "mm", 1.0, Some(45)),
    ];
    for ((quantity, unit, factor, peak), count) in blocks.into_iter().zip(&integers[33..]) {
        let count = number(count).map_err(LineFault::on(line))?;
        if count < 1.0 {
            continue;
        }
        let below = lines_of_numbers(lines, from);
        let needed = (count / COLUMNS as f64).ceil();
        // A wrong number would shift all blocks below.
        ensure(needed <= below.len() as f64, || {
            let announced = plain(count);
            let wrong =
                format!("the numbers of {quantity} end here: line {line} announces {announced}");
            LineFault::on(below.end.max(1))(wrong)
        })?;
        let data = below.start..below.start + needed as usize;
        from = data.end;
        histories.push(History {
            name: single_blanks(named.unwrap_or_default()),
            quantity: quantity.to_owned(),
            unit: unit.to_owned(),
            factor,
            peak: peak.map(|index: usize| reals[index].to_owned()),
            data,
            width: 8,
            ..History::new(line, count, Some(step_s))
        });
    }
    Ok(from)
}

/// Reads factor and unit of raw readings, as `1.00 mm/s/s` or `mm/s/s`.
fn raw_unit(text: &str) -> Result<(f64, &str), String> {
    let mut words = text.split_whitespace();
    let first = words.next().unwrap_or_default();
    if first.starts_with(char::is_alphabetic) {
        return Ok((1.0, first));
    }
    Ok((number(first)?, words.next().unwrap_or_default()))
}
