//! The readers of files whose header describes one or several histories. The first byte chooses format, quantity, channel and corrections; the contents follow, whose
//! format is also searched for in their header.
#![no_main]

mod common;

use archrock::scenario::{Baseline, Format, Layout, RecordedQuantity, TableColumn};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|input: &[u8]| {
    let Some((settings, contents)) = input.split_first() else {
        return;
    };
    const FORMATS: [Format; 10] = [
        Format::Smc,
        Format::Csmip,
        Format::Usc,
        Format::Bhrc,
        Format::Cosmos,
        Format::Geonet,
        Format::Afad,
        Format::Cwb,
        Format::Csmnc,
        Format::Unam,
    ];
    let quantities = RecordedQuantity::ALL;
    let layout = Layout {
        quantity: quantities[usize::from(settings >> 3 & 1)],
        channel: match settings >> 4 & 3 {
            0 => None,
            3 => Some(TableColumn::Name("deg".to_owned())),
            number => Some(TableColumn::Number(usize::from(number))),
        },
        baseline: (settings >> 6 & 1 == 1).then_some(Baseline::Linear),
        high_pass_hz: (settings >> 7 == 1).then_some(1.0),
        ..Layout::new(FORMATS[usize::from(settings & 7) % FORMATS.len()])
    };
    let _ = Format::of_contents(contents);
    common::check(&layout, contents);
});
