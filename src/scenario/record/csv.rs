//! Tables of times and accelerations: comma-separated values, or parted by semicolons or tabs.
//!
//! Read line by line, so that every fault has its line: numbers contain no line breaks.

use super::{
    COLUMN_NUMBER, LEAST_STEP_S, LONGEST_S, LineFault, MOST_SAMPLES, Samples, TableColumn, number,
};
use crate::scenario::error::excerpt;

/// Reads the samples of two columns, in the unit of the file.
///
/// Blank lines and lines that begin with `#` are skipped. The first of the others may hold the names of
/// the columns, and must where a column is chosen by name.
pub(super) fn parse(
    text: &str,
    time: &TableColumn,
    acceleration: &TableColumn,
) -> Result<Samples, LineFault> {
    let mut rows = text
        .lines()
        .enumerate()
        .map(|(index, line)| (index + 1, line.trim()))
        .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'))
        .peekable();
    let Some(&(first_line, first)) = rows.peek() else {
        return Err(LineFault {
            line: 1,
            message: "there are no samples".to_owned(),
        });
    };
    let delimiter = [';', '\t']
        .into_iter()
        .find(|c| first.contains(*c))
        .unwrap_or(',');
    let most_columns = *COLUMN_NUMBER.range.end();
    let names: Vec<_> = cells(first, delimiter).take(most_columns).collect();
    let column = |column: &TableColumn| {
        column.index(&names).map_err(|message| LineFault {
            line: first_line,
            message,
        })
    };
    let columns = [column(time)?, column(acceleration)?];
    let by_name = [time, acceleration]
        .iter()
        .any(|column| matches!(column, TableColumn::Name(_)));
    let no_numbers = || {
        let mut cells = columns.iter().filter_map(|index| names.get(*index));
        cells.all(|cell| number(cell).is_err())
    };
    if by_name || no_numbers() {
        rows.next();
    }

    let mut samples: Samples = Vec::new();
    let mut last_line = first_line;
    for (line, row) in rows {
        last_line = line;
        let fault = |message: String| LineFault { line, message };
        let mut values = [0.0; 2];
        for (value, index) in values.iter_mut().zip(columns) {
            let cell = cells(row, delimiter).nth(index).ok_or_else(|| {
                fault(format!(
                    "there is no column {} in `{}`",
                    index + 1,
                    excerpt(row)
                ))
            })?;
            *value = number(cell).map_err(fault)?;
        }
        let [time_s, acceleration] = values;
        if time_s.abs() > LONGEST_S {
            return Err(fault(format!(
                "the time {time_s:?} s is out of range; allowed are at most {LONGEST_S:?} s"
            )));
        }
        if let Some((before_s, _)) = samples.last()
            && time_s - before_s < LEAST_STEP_S
        {
            return Err(fault(format!(
                "the time does not increase: {time_s:?} s follows {before_s:?} s; allowed are steps of at \
                 least {LEAST_STEP_S:?} s"
            )));
        }
        if samples.len() == MOST_SAMPLES {
            return Err(fault(format!(
                "more than {MOST_SAMPLES} samples, too many for a record"
            )));
        }
        samples.push((time_s, acceleration));
    }
    if samples.len() < 2 {
        return Err(LineFault {
            line: last_line,
            message: format!(
                "the number of samples is {}; allowed are at least 2",
                samples.len()
            ),
        });
    }
    Ok(samples)
}

/// The cells of a row, without blanks and quotation marks around them.
fn cells(row: &str, delimiter: char) -> impl Iterator<Item = &str> {
    row.split(delimiter)
        .map(|cell| cell.trim().trim_matches('"').trim())
}

impl TableColumn {
    /// The index from 0.
    fn index(&self, names: &[&str]) -> Result<usize, String> {
        let wanted = match self {
            Self::Number(number) => return Ok(number - 1),
            Self::Name(name) => name,
        };
        let mut found = (0..names.len()).filter(|index| names[*index] == wanted);
        match (found.next(), found.next()) {
            (Some(index), None) => Ok(index),
            (Some(_), Some(_)) => Err(format!(
                "there are two columns named `{}`: choose one by its number",
                excerpt(wanted)
            )),
            (None, _) => Err(format!(
                "there is no column named `{}` in `{}`",
                excerpt(wanted),
                excerpt(&names.join(", "))
            )),
        }
    }
}
