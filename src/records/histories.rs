//! Files whose header describes one or several histories: quantity, unit, step, number of samples and peak of each.
//!
//! A reader of such a format only finds the histories; this module chooses one of them, reads its numbers, and compares them with the header.

use archrock_text::{ensure, excerpt, plain};

use crate::history::{Finder, History, single_blanks};
use crate::layout::{Layout, TableColumn};
use crate::samples::{Contents, LineFault, Parsed, different_peak, peak_of};
use crate::unit::{RecordedQuantity, Unit};

/// Returns the number of channels of a file: of its histories of the wanted quantity.
pub(crate) fn count(text: &str, layout: &Layout, histories: Finder) -> Parsed<usize> {
    let lines: Vec<&str> = text.lines().collect();
    let histories = histories(&lines)?;
    let wanted = layout.quantity.name();
    Ok(histories
        .iter()
        .filter(|one| one.quantity == wanted)
        .count())
}

/// Reads the history that the layout chooses among those of a file.
pub(crate) fn read(text: &str, layout: &Layout, histories: Finder) -> Parsed<Contents> {
    let lines: Vec<&str> = text.lines().collect();
    let histories = histories(&lines)?;
    ensure(!histories.is_empty(), || {
        LineFault::on(1)("the header announces no samples")
    })?;
    let wanted = layout.quantity.name();
    let fits = |one: &&History| one.quantity == wanted;
    let fitting: Vec<_> = histories.iter().filter(fits).collect();
    let index = choose(&fitting, layout.channel.as_ref()).map_err(|wrong| {
        let other = histories.first().filter(|_| fitting.is_empty());
        let line = other.or(fitting.first().copied()).map_or(1, |one| one.line);
        LineFault::on(line)(
            other.map_or(wrong, |_| quantity_not_found(&histories, layout.quantity)),
        )
    })?;
    let history = fitting[index];
    let fault = LineFault::on::<String>(history.line);
    let remedy = "such samples are not read; convert them";
    let unit = Unit::of_header(&history.unit, layout.quantity, remedy).map_err(fault)?;
    let is_factor = (1e-6..=1e6).contains(&history.factor);
    ensure(is_factor, || {
        let factor = plain(history.factor);
        fault(format!("the factor {factor} is not from 1e-6 to 1e6"))
    })?;
    let (clock, values) = history.numbers(&lines)?;
    values.check_count((history.line, history.count), "samples")?;
    let peak = history.peak.as_deref();
    let difference =
        peak.and_then(|peak| different_peak(peak, peak_of(&values.values, 0.0), unit, ""));
    let (samples, repeated) = match history.step_s {
        Some(step_s) => (values.evenly(step_s, history.line, "the step")?, None),
        None => clock.samples(values)?,
    };
    let (count, name) = (fitting.len(), excerpt(&history.name));
    let columns = match (count, &*name) {
        (1, "") => String::new(),
        (1, name) => format!(" of channel `{name}`"),
        (count, name) => format!(" of channel {} of {count} `{name}`", index + 1),
    };
    let contents = Contents {
        columns,
        channel: Some((index + 1, history.name.clone())).filter(|_| layout.format.has_channels()),
        ..Contents::new(samples, unit)
    };
    Ok(contents.doubted(repeated.into_iter().chain(difference)))
}

/// Returns the index of the channel that is chosen, or of the only one.
fn choose(histories: &[&History], channel: Option<&TableColumn>) -> Result<usize, String> {
    /// Largest number of channels in a message.
    const LISTED: usize = 9;
    let named = |fits: &dyn Fn(&str) -> bool| {
        let names = histories.iter().map(|one| one.name.to_lowercase());
        let fitting = names.enumerate().filter(|(_, name)| fits(name));
        fitting.map(|(index, _)| index).collect::<Vec<_>>()
    };
    let found = match channel {
        None => (0..histories.len()).collect(),
        Some(TableColumn::Number(number)) => {
            let indices = 0..histories.len();
            indices.filter(|index| index + 1 == *number).collect()
        }
        Some(TableColumn::Name(name)) => {
            let name = single_blanks(name).to_lowercase();
            let equal = named(&|own| own == name);
            match equal.is_empty() {
                true => named(&|own| has_words(own, &name)),
                false => equal,
            }
        }
    };
    if let [index] = found[..] {
        return Ok(index);
    }
    let names = histories.iter().zip(1..).take(LISTED);
    let names = names.map(|(one, number)| format!("{number} `{}`", excerpt(&one.name)));
    let mut listed = names.collect::<Vec<_>>().join(", ");
    if histories.len() > LISTED {
        listed += " and others";
    }
    Err(match channel {
        None => format!(
            "the file has {} channels: set `channel` to the number or to a part of the name of one of them: {listed}",
            histories.len()
        ),
        Some(TableColumn::Number(number)) => {
            format!("there is no channel {number}; the file has {listed}")
        }
        Some(TableColumn::Name(name)) => {
            let matches = match found.is_empty() {
                true => "no channel matches",
                false => "several channels match",
            };
            let number = match name.trim().parse::<usize>() {
                Ok(number) => format!(" (its number has no quotation marks: `channel = {number}`)"),
                Err(_) => String::new(),
            };
            format!(
                "{matches} `{}`{number}; the file has {listed}",
                excerpt(name)
            )
        }
    })
}

/// Returns true if a name contains a part that neither begins nor ends inside a word of the name.
fn has_words(name: &str, part: &str) -> bool {
    let is_inside = |left: Option<char>, right: Option<char>| {
        let mut sides = [left, right].into_iter();
        sides.all(|side| side.is_some_and(char::is_alphanumeric))
    };
    name.match_indices(part).any(|(start, _)| {
        let (before, after) = (&name[..start], &name[start + part.len()..]);
        !is_inside(before.chars().next_back(), part.chars().next())
            && !is_inside(part.chars().next_back(), after.chars().next())
    })
}

/// Returns the message that a file has no history of the wanted quantity.
fn quantity_not_found(histories: &[History], wanted: RecordedQuantity) -> String {
    let mut held: Vec<_> = histories.iter().map(|one| excerpt(&one.quantity)).collect();
    held.dedup();
    held.truncate(3);
    let other = RecordedQuantity::ALL
        .iter()
        .find(|other| histories.iter().any(|one| one.quantity == other.name()));
    let remedy = match other {
        Some(RecordedQuantity::Velocity) => ", unless you give `quantity = \"velocity\"`",
        Some(RecordedQuantity::Acceleration) => ", unless you leave out `quantity = \"velocity\"`",
        None => "",
    };
    format!(
        "the file holds {}; must be {}{remedy}",
        held.join(" and "),
        wanted.name()
    )
}
