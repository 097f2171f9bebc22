//! The readers of all formats. The first byte chooses the format, the second quantity, channel and corrections; the contents follow, whose format is also
//! searched for in their header.
#![no_main]

mod common;

use archrock_records::{Baseline, Format, Layout, RecordedQuantity, TableColumn};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|input: &[u8]| {
    let [format, settings, contents @ ..] = input else {
        return;
    };
    let quantities = RecordedQuantity::ALL;
    let layout = Layout {
        quantity: quantities[usize::from(settings & 1)],
        channel: match settings >> 1 & 3 {
            0 => None,
            3 => Some(TableColumn::Name("deg".to_owned())),
            number => Some(TableColumn::Number(usize::from(number))),
        },
        baseline: (settings >> 3 & 1 == 1).then_some(Baseline::Linear),
        high_pass_hz: (settings >> 4 & 1 == 1).then_some(1.0),
        ..Layout::new(Format::ALL[usize::from(*format) % Format::ALL.len()])
    };
    let _ = Format::of_contents(contents);
    common::check(&layout, contents);
});
