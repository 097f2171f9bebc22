//! The accelerogram files of GeoNet, New Zealand (V1A and V2A).
//!
//! Each component has 16 lines of text, 4 of ten integers (10I8) and 6 of ten numbers (10F8), then blocks of accelerations, velocities and displacements
//! with ten numbers a line, in mm/s2, mm/s and mm. The integers have the number of samples of each block, the numbers step and peaks. Source: GNS Accelerogram Data File
//! Format (GeoNet), as files of the USGS's tests of `gmprocess` follow it.

use super::histories::{
    History, count_and_step, header_fields, lines_of_numbers, squeezed, word_after,
};
use super::samples::{LineFault, Parsed, number};
use crate::scenario::prelude::*;

const INTEGERS: usize = 16;
const REALS: usize = 20;
const DATA: usize = 26;
const COLUMNS: usize = 10;

/// Returns true for the lines with which such a file begins.
pub(super) fn begins(lines: &[&str]) -> bool {
    let has = |index: usize, word: &str| lines.get(index).is_some_and(|line| line.contains(word));
    has(0, "orrected accelerogram") && has(1, "Site ") && has(9, "Number of points")
}

/// Finds all histories of a file.
pub(super) fn histories(lines: &[&str]) -> Parsed<Vec<History>> {
    let (mut histories, mut start) = (Vec::new(), 0);
    while start == 0 || lines.get(start).is_some_and(|line| !line.trim().is_empty()) {
        ensure(begins(&lines[start.min(lines.len())..]), || {
            LineFault::on(start.max(1))(match start {
                0 => {
                    "the lines do not begin like `Corrected accelerogram`, `Site`: is this a file of GeoNet?"
                }
                _ => "no component begins below; the number of samples in the header may be wrong",
            })
        })?;
        start = component(lines, start, &mut histories)?;
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
    let raw = text
        .iter()
        .find(|line| line.contains("units of"))
        .filter(|_| !is_corrected);
    let factor = raw.and_then(|line| number(word_after(line, "units of ")?).ok());
    let mut from = start + DATA;
    let peaks = [if is_corrected { 35 } else { 30 }, 40, 45];
    let blocks = [
        ("acceleration", "mm/s2"),
        ("velocity", "mm/s"),
        ("displacement", "mm"),
    ];
    for (index, (quantity, unit)) in blocks.into_iter().enumerate() {
        let line = start + REALS;
        let (count, step_s) = count_and_step(line, integers[33 + index], number(reals[25]))?;
        if count < 1.0 {
            continue;
        }
        let rest = lines_of_numbers(lines, from);
        let needed = (count / COLUMNS as f64).ceil();
        // A wrong number would shift all blocks below.
        ensure(needed <= rest.len() as f64, || {
            let announced = plain(count);
            let wrong =
                format!("the numbers of {quantity} end here: line {line} announces {announced}");
            LineFault::on(rest.end.max(1))(wrong)
        })?;
        let data = rest.start..rest.start + needed as usize;
        from = data.end;
        histories.push(History {
            name: squeezed(named.unwrap_or_default()),
            quantity: quantity.to_owned(),
            line,
            unit: unit.to_owned(),
            factor: factor.unwrap_or(1.0),
            step_s: Some(step_s),
            count,
            columns: (1, 0),
            peak: Some(reals[peaks[index]].to_owned()),
            data,
            width: 8,
        });
    }
    Ok(from)
}
