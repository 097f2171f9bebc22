//! The ASC files of the Engineering Strong Motion database and of ITACA (DYNA format).
//!
//! A header of lines `KEY: value`, followed by accelerations or velocities, one per line.

use std::collections::HashMap;

use archrock_text::{ensure, excerpt};

use crate::history::has;
use crate::layout::{Format, Layout, Parser};
use crate::samples::{
    Contents, IF_TABLE, LineFault, Parsed, Values, checked_step, different_peak, number, peak_of,
    words,
};
use crate::unit::{RecordedQuantity, Unit};

impl Format {
    /// Engineering Strong Motion database (ASC).
    pub const ASC: Self = Self {
        name: "asc",
        label: "ASC file (ESM)",
        extensions: &["asc"],
        begins: |lines| lines[0].contains(':') && has(lines, "SAMPLING_INTERVAL_S:"),
        parser: Parser::Record(
            parse,
            Some("does not apply to an ASC file, whose header has UNITS"),
        ),
    };
}

/// Largest number of lines of the header.
const MAX_HEADER_LINES: usize = 200;

/// Reads the samples; the first is at time zero.
fn parse(text: &str, layout: &Layout) -> Parsed<Contents> {
    const STEP: &str = "SAMPLING_INTERVAL_S";
    let quantity = layout.quantity;
    let (mut header, mut last) = (HashMap::new(), 0);
    for (line, number) in text.lines().zip(1..).take(MAX_HEADER_LINES) {
        if let Some((key, value)) = line.split_once(':') {
            header.insert(key.trim(), (number, value.trim()));
            last = number;
        } else if !line.trim().is_empty() {
            break;
        }
    }
    let needed = |key: &str| {
        let missing =
            || format!("the header has no {key} up to here: is this an ASC file? {IF_TABLE}");
        let found = header.get(key).copied();
        found.ok_or_else(|| LineFault::on(last.max(1))(missing()))
    };
    let (step_line, step) = needed(STEP)?;
    let step_s = number(step).and_then(|step_s| checked_step(STEP, step_s));
    let step_s = step_s.map_err(LineFault::on(step_line))?;
    let (line, written) = needed("UNITS")?;
    let remedy = "must be one of acceleration or velocity, such as cm/s^2";
    let unit = Unit::of_header(written, quantity, remedy).map_err(LineFault::on(line))?;
    if let Some((line, held)) = header.get("DATA_TYPE") {
        check_quantity(held, quantity).map_err(LineFault::on(*line))?;
    }
    let values = Values::below(text, last, words)?;
    if let Some((line, count)) = header.get("NDATA") {
        let count = number(count).map_err(LineFault::on(*line))?;
        values.check_count((*line, count), "NDATA")?;
    }
    let stated = match unit {
        Unit::CentimetrePerS2 => header.get("PGA_CM/S^2"),
        Unit::CentimetrePerS => header.get("PGV_CM/S"),
        _ => None,
    };
    let found = peak_of(&values.values, 0.0);
    let difference = stated.and_then(|(_, peak)| different_peak(peak, found, unit, ""));
    let contents = Contents::new(values.evenly(step_s, step_line, STEP)?, unit);
    Ok(contents.doubted(difference))
}

fn check_quantity(held: &str, quantity: RecordedQuantity) -> Result<(), String> {
    let wanted = match quantity {
        RecordedQuantity::Acceleration => "an acceleration history",
        RecordedQuantity::Velocity => "a velocity history",
    };
    let unless = match held {
        "VELOCITY" => ", unless you give `quantity = \"velocity\"`",
        _ => "",
    };
    ensure(held.eq_ignore_ascii_case(quantity.name()), || {
        format!("the file holds {}; must be {wanted}{unless}", excerpt(held))
    })
}

#[cfg(test)]
mod tests {
    use crate::tests::assert_fault;
    use crate::{Contents, Format, Layout, RecordedQuantity, Unit};

    fn asc() -> Layout {
        Layout::new(Format::ASC)
    }

    const FILE: &str = "EVENT_NAME: A: B\nEVENT_ID: XX-2009-0009\nSAMPLING_INTERVAL_S: 0.005000\nNDATA: 3\n\
                        PGA_CM/S^2: -1.2\nUNITS: cm/s^2\nDATA_TYPE: ACCELERATION\nUSER5:\n0.1\n -1.2E0\n0.3\n";

    #[test]
    fn the_header_gives_step_and_unit() {
        for end in ["\n", "\r\n"] {
            let text = FILE.replace('\n', end);
            assert_eq!(
                asc().parse(text.as_bytes()),
                Ok(Contents::new(
                    vec![(0.0, 0.1), (0.005, -1.2), (0.01, 0.3)],
                    Unit::CentimetrePerS2,
                ))
            );
        }
        let text = FILE.replace("cm/s^2\nDATA", "g\nDATA");
        let contents = asc().parse(text.as_bytes()).unwrap();
        assert_eq!(contents.unit, Unit::Gravity);
        let velocities = Layout {
            quantity: RecordedQuantity::Velocity,
            ..asc()
        };
        assert_fault(FILE, &velocities, 6, "leave out `quantity");
        let text = FILE.replace(
            "cm/s^2\nDATA_TYPE: ACCELERATION",
            "cm/s\nDATA_TYPE: VELOCITY",
        );
        let contents = velocities.parse(text.as_bytes()).unwrap();
        assert_eq!(contents.unit, Unit::CentimetrePerS);
    }

    #[test]
    fn faults_of_asc_files_have_lines() {
        let fault = |old: &str, new: &str, line, words| {
            assert!(FILE.contains(old));
            assert_fault(&FILE.replace(old, new), &asc(), line, words);
        };
        fault("SAMPLING_INTERVAL_S", "DT", 8, "no SAMPLING_INTERVAL_S");
        fault("UNITS", "U", 8, "no UNITS");
        fault("0.005000", "0", 3, "SAMPLING_INTERVAL_S is 0 s");
        fault("0.005000", "x", 3, "`x` is not a finite number");
        fault("0.005000", "1e6", 3, "make a record of 2e6 s");
        fault("cm/s^2\nD", "cm\nD", 6, "the unit is cm;");
        fault(
            "cm/s^2\nD",
            "cm/s\nD",
            6,
            "the unit is cm/s, a unit of velocity; give `quantity",
        );
        fault(
            "ACCELERATION",
            "VELOCITY",
            7,
            "the file holds VELOCITY; must be an acceleration history, unless you give `quantity = \"velocity\"`",
        );
        fault("NDATA: 3", "NDATA: 4", 11, "line 4 announces 4 (NDATA)");
        fault("0.3\n", "0.3\nnan\n", 12, "`nan` is not a finite number");
        assert_fault("", &asc(), 1, "is this an ASC file?");
        assert_fault("0.1\n0.2\n", &asc(), 1, "is this an ASC file?");
        fault(
            "NDATA: 3\nPGA_CM/S^2: -1.2\nUNITS: cm/s^2\nDATA_TYPE: ACCELERATION\nUSER5:\n0.1\n -1.2E0\n0.3\n",
            "UNITS: g\n1\n",
            5,
            "number of samples is 1",
        );
    }
}
