//! The reader of tables. The bits of the first byte choose the columns; the contents follow.
#![no_main]

mod common;

use archrock::scenario::{Layout, TableColumn, Unit};
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
    let layout = Layout::Csv {
        time_column: column(settings >> 2, [1, 2, 10_000], "t"),
        acceleration_column: column(*settings, [2, 1, 3], "a"),
        unit: Unit::Gravity,
    };
    common::check(&layout, contents);
});
