//! The reader of tables. The bits of the first byte choose the layout; the contents follow.
#![no_main]

mod common;

use archrock_records::{Decimal, Layout, TableColumn, Times, Unit};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|input: &[u8]| {
    let Some((settings, contents)) = input.split_first() else {
        return;
    };
    // '0' is times in the first column and accelerations in the second, '?' is `t` and `a`.
    let column = |bits: u8, numbers: [usize; 3], name: &str| match bits & 3 {
        3 => TableColumn::Name(name.to_owned()),
        number => TableColumn::Number(numbers[usize::from(number)]),
    };
    let times = if settings & 64 == 0 {
        Times::Column(column(settings >> 2, [1, 2, 10_000], "t"))
    } else {
        Times::Step(0.01)
    };
    let layout = Layout {
        skip_rows: usize::from(settings >> 4 & 3),
        decimal: if settings & 128 == 0 {
            Decimal::Point
        } else {
            Decimal::Comma
        },
        end_marker: (settings & 72 == 72).then(|| "END".to_owned()),
        // A second column is not named explicitly: it is the default in a table of two.
        acceleration_column: Some(column(*settings, [2, 1, 3], "a"))
            .filter(|column| *column != TableColumn::Number(2)),
        // Applies if no column is chosen.
        wrapped: settings & 4 != 0,
        ..Layout::table(times, Unit::Gravity)
    };
    common::check(&layout, contents);
});
