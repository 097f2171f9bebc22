//! The standard format of the Institute of Engineering of UNAM, Mexico (ASA), version 2.0.
//!
//! It follows the readers in the USGS's `gmprocess` (group unam), in OpenQuake's `smtk` (ASA), and of the Institute of Engineering, which agree; no
//! original description was at hand.

use archrock_text::ensure;

use crate::history::{History, count_and_step, has, is_text, rest, single_blanks};
use crate::layout::{Format, Parser};
use crate::networks::refuse_words;
use crate::samples::{LineFault, Parsed, number};
use crate::unit::Unit;

impl Format {
    /// Institute of Engineering of UNAM, Mexico (ASA).
    pub const UNAM: Self = Self {
        name: "unam",
        label: "file of UNAM",
        extensions: &[],
        begins: |lines| has(lines, "ARCHIVO ESTANDAR DE ACELERACION"),
        parser: Parser::Channels(histories),
    };
}

/// Finds the channels of a file of UNAM. In its header a line has a name, a colon and the values of the channels, each after a slash. The numbers are
/// below the first line of dashes before a number.
fn histories(lines: &[&str]) -> Parsed<Vec<History>> {
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
            name: single_blanks(name),
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
