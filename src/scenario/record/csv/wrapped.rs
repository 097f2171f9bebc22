//! Tables whose rows hold several consecutive samples.

use super::*;

/// Returns true if the table shows that its rows contain several samples: all rows but the last have the same length and the last is shorter. Or
/// the total number of samples is given before the table, in a comment or in the row of names; `text` includes the skipped lines.
pub(super) fn is_shown(text: &str, table: &str, layout: &Layout) -> bool {
    let Some((names, lengths)) = lengths(table, layout.decimal) else {
        return false;
    };
    let [full @ .., last] = &*lengths else {
        return false;
    };
    if let [length, ..] = full
        && full.iter().all(|other| other == length)
        && last < length
    {
        return true;
    }
    if lengths.iter().all(|length| *length == 1) {
        return false;
    }
    let comments = table.lines().filter(|line| line.trim().starts_with('#'));
    let skipped = text.lines().take(layout.skip_rows);
    let announced: Vec<_> = skipped
        .chain(comments)
        .chain(names.as_deref())
        .flat_map(header_words)
        .filter_map(|word| word.parse::<usize>().ok())
        .collect();
    // A number equal to the number of rows announces rows, not samples.
    announced.contains(&lengths.iter().sum()) && !announced.contains(&lengths.len())
}

/// Returns the first row if it contains names, and the number of cells of each other row; `None` if a cell is not a number.
fn lengths(table: &str, decimal: Decimal) -> Option<(Option<String>, Vec<usize>)> {
    let mut rows = Rows::new(table, decimal).peekable();
    let names = rows.next_if(|row| row.has_no_number(decimal));
    let lengths = rows.map(|row| is_of_numbers(&row, decimal).then(|| row.count()));
    let names = names.map(|row| row.text.to_owned());
    Some((names, lengths.collect::<Option<_>>()?))
}

/// Reads the samples of all rows. A first row without any number contains names.
pub(super) fn parse(table: &str, step_s: f64, decimal: Decimal) -> Parsed<Samples> {
    let mut values = Values::default();
    for row in Rows::new(table, decimal) {
        let is_first = std::mem::replace(&mut values.line, row.line) == 0;
        if is_first && row.has_no_number(decimal) {
            continue;
        }
        for cell in row.cells().take(row.count()) {
            let value = decimal.number(cell).and_then(in_range);
            let value = value.map_err(|wrong| {
                let is_of_table = |row: &Row<'_>| is_of_numbers(row, decimal);
                let hint = begin_below(&row, Rows::new(table, decimal), &values, is_of_table);
                row.fault(wrong + &hint)
            })?;
            values.push(row.line, value)?;
        }
    }
    let line = values.line;
    ensure(!values.values.is_empty(), || nothing(table, line))?;
    values.evenly(step_s, line, "`dt_s`")
}

fn is_of_numbers(row: &Row<'_>, decimal: Decimal) -> bool {
    let mut cells = row.cells().take(row.count());
    cells.all(|cell| decimal.number(cell).is_ok())
}

#[cfg(test)]
mod tests {
    use crate::scenario::record::tests::{assert_fault, parse};
    use crate::scenario::record::{Decimal, Layout, TableColumn, Times, Unit};

    fn table() -> Layout {
        Layout::table(Times::Step(0.5), Unit::Gravity)
    }

    fn wrapped() -> Layout {
        Layout {
            wrapped: true,
            ..table()
        }
    }

    #[track_caller]
    fn assert_reads(text: &str, layout: Layout) {
        let expected = [1.0, -2.0, 3.0, 4.0, 5.0, 6.0];
        let found = parse(text, &layout).unwrap();
        let times_s = (0..6).map(|i| 0.5 * f64::from(i));
        let expected: Vec<_> = times_s.zip(expected).collect();
        assert_eq!(found, expected, "{text}");
    }

    #[test]
    fn rows_of_several_samples_are_read_where_that_is_said() {
        for text in [
            "1 -2 3\n4 5 6\n",
            "  1.0E+00 -2.0 3.\r\n\r\n 4 5 6",
            "1,-2,3,\n4,5,6,\n",
            "1;-2;3;4\n5;6\n",
            "acceleration in g\n1 -2\n3 4\n# half\n5 6\n",
            "1\n-2\n3\n4\n5\n6\n",
            "1 -2 3 4 5 6",
        ] {
            assert_reads(text, wrapped());
        }
        let comma = Layout {
            decimal: Decimal::Comma,
            ..wrapped()
        };
        assert_reads("1,0 -2,0 3,0\n4,0 5,0 6,0\n", comma);
    }

    #[test]
    fn rows_of_several_samples_are_seen() {
        // The last line is shorter.
        assert_reads("1 -2 3 4\n5 6\n", table());
        assert_reads("acceleration in g\n1,-2,3,4,5\n6\n", table());
        // The header gives the number of samples.
        let skipping = |skip_rows| Layout {
            skip_rows,
            ..table()
        };
        let header = "PEER 1999\nNPTS=   6, DT= .5 SEC\n";
        assert_reads(&format!("{header}1 -2 3\n4 5 6\n"), skipping(2));
        assert_reads("# 6 samples\n1 -2 3\n4 5 6\n", table());
        assert_reads("acceleration (6)\n1 -2 3\n4 5 6\n", table());
    }

    #[test]
    fn columns_are_not_taken_for_samples() {
        let fault = |text: &str, layout: Layout, line, words| {
            assert_fault(text, &layout, line, words);
        };
        let say =
            "there are 3 columns: give `acceleration_column`, the one to read, or `wrapped = true`";
        for text in [
            "1 -2 3\n4 5 6\n",
            // The header announces two of three rows, or a number that fits no row count.
            "# 2 rows of 3, 6 in all\n1 -2 3\n4 5 6\n",
            "# 7 samples\n1 -2 3\n4 5 6\n",
            // The last line is too long, or an earlier line is too short.
            "1 -2 3\n4 5 6 7\n",
            "1 -2 3\n4 5\n6\n",
        ] {
            let line = if text.starts_with('#') { 2 } else { 1 };
            fault(text, table(), line, say);
        }
        let times = Layout {
            times: Some(Times::Column(TableColumn::Number(1))),
            ..table()
        };
        let say = "there are 3 columns: give `acceleration_column`, the one to read; or, if a row holds 3 samples";
        fault("0 -2 3\n4 5 6\n", times.clone(), 1, say);
        // An empty column is ignored.
        assert_eq!(parse("0,1,\n1,2,\n", &times).unwrap().len(), 2);
        // With a chosen column the last line may have any length.
        let second = Layout {
            acceleration_column: Some(TableColumn::Number(2)),
            ..table()
        };
        let found = parse("1 -2 3\n4 5\n", &second).unwrap();
        assert_eq!(found, [(0.0, -2.0), (0.5, 5.0)]);
    }

    #[test]
    fn faults_of_wrapped_tables_have_lines() {
        let fault = |text: &str, line, words| assert_fault(text, &wrapped(), line, words);
        fault("", 1, "no samples");
        fault("a b\n", 1, "no samples");
        fault("1\n", 1, "number of samples is 1");
        fault("1 2\n3 x\n", 2, "`x` is not a finite number");
        fault("1 2\n\n3 1e308\n", 3, "`1e308` is out of range");
        fault(
            "PEER\nNPTS= 4\n1 2\n3 4\n",
            2,
            "`NPTS=` is not a finite number; numbers begin on line 3: give `skip_rows = 2`",
        );
    }
}
