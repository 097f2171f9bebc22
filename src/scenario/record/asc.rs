//! The ASC files of the Engineering Strong Motion database and of ITACA (DYNA format).
//!
//! A header of lines `KEY: value`, followed by the accelerations or velocities, one per line.

use super::layout::{Contents, evenly};
use super::{LineFault, MAX_SAMPLES, MIN_STEP_S, Recorded, Unit, number, sample};
use crate::argument::{plain, short};
use crate::scenario::error::excerpt;

/// Number of lines that may make up the header.
const MAX_HEADER_LINES: usize = 200;

/// The contents of the header, each with its line from 1.
#[derive(Default)]
struct Header {
    step_s: Option<(usize, f64)>,
    count: Option<(usize, f64)>,
    unit: Option<(usize, Unit)>,
    /// The last line.
    line: usize,
}

/// Reads the samples; the first is at time zero.
pub(super) fn parse(text: &str, quantity: Recorded) -> Result<Contents, LineFault> {
    let header = Header::parse(text, quantity)?;
    let missing = |key: &str| LineFault {
        line: header.line.max(1),
        message: format!("the header has no {key} up to here: is this an ASC file?"),
    };
    let (step_line, step_s) = header
        .step_s
        .ok_or_else(|| missing("SAMPLING_INTERVAL_S"))?;
    let (_, unit) = header.unit.ok_or_else(|| missing("UNITS"))?;
    let mut accelerations = Vec::new();
    let mut last_line = header.line.max(1);
    for (index, line) in text.lines().enumerate().skip(header.line) {
        for word in line.split_whitespace() {
            last_line = index + 1;
            let fault = |message| LineFault {
                line: last_line,
                message,
            };
            if accelerations.len() == MAX_SAMPLES {
                return Err(fault(format!(
                    "more than {MAX_SAMPLES} samples, too many for a record"
                )));
            }
            accelerations.push(sample(word).map_err(fault)?);
        }
    }
    let found = accelerations.len();
    if let Some((line, count)) = header.count
        && count != found as f64
    {
        return Err(LineFault {
            line: last_line,
            message: format!(
                "the number of samples is {found}: line {line} announces {} (NDATA)",
                plain(count)
            ),
        });
    }
    if found < 2 {
        return Err(LineFault {
            line: last_line,
            message: format!("the number of samples is {found}; must be at least 2"),
        });
    }
    let samples = evenly(step_s, accelerations).map_err(|wrong| LineFault {
        line: step_line,
        message: format!("SAMPLING_INTERVAL_S and the number of samples {wrong}"),
    })?;
    Ok(Contents {
        samples,
        unit,
        wrapped: false,
    })
}

impl Header {
    fn parse(text: &str, quantity: Recorded) -> Result<Self, LineFault> {
        let mut header = Self::default();
        for (index, line) in text.lines().enumerate().take(MAX_HEADER_LINES) {
            let Some((key, value)) = line.split_once(':') else {
                if line.trim().is_empty() {
                    continue;
                }
                break;
            };
            header.line = index + 1;
            header
                .take(key.trim(), value.trim(), quantity)
                .map_err(|message| LineFault {
                    line: index + 1,
                    message,
                })?;
        }
        Ok(header)
    }

    fn take(&mut self, key: &str, value: &str, quantity: Recorded) -> Result<(), String> {
        let line = self.line;
        match key {
            "SAMPLING_INTERVAL_S" => {
                let step_s = number(value)?;
                if step_s < MIN_STEP_S {
                    return Err(format!(
                        "SAMPLING_INTERVAL_S is {} s; must be at least {} s",
                        plain(step_s),
                        short(MIN_STEP_S)
                    ));
                }
                self.step_s = Some((line, step_s));
            }
            "NDATA" => self.count = Some((line, number(value)?)),
            "UNITS" => {
                let unit = Unit::written(value).ok_or_else(|| {
                    format!(
                        "the unit is {}; must be one of acceleration or velocity, such as cm/s^2",
                        excerpt(value)
                    )
                })?;
                if unit.quantity() != quantity {
                    return Err(format!(
                        "the unit is {}, {}",
                        excerpt(value),
                        unit.other_quantity()
                    ));
                }
                self.unit = Some((line, unit));
            }
            "DATA_TYPE" if !value.eq_ignore_ascii_case(quantity.name()) => {
                return Err(format!(
                    "the file holds {}; must be {} history{}",
                    excerpt(value),
                    match quantity {
                        Recorded::Acceleration => "an acceleration",
                        Recorded::Velocity => "a velocity",
                    },
                    match value {
                        "VELOCITY" => ", unless you give `quantity = \"velocity\"`",
                        _ => "",
                    }
                ));
            }
            _ => {}
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use crate::scenario::record::tests::assert_fault;
    use crate::scenario::record::{Contents, Form, Layout, Recorded, Unit};

    fn asc() -> Layout {
        Form::Asc.into()
    }

    const FILE: &str = "EVENT_NAME: A: B\nEVENT_ID: XX-2009-0009\nSAMPLING_INTERVAL_S: 0.005000\nNDATA: 3\n\
                        PGA_CM/S^2: -1.2\nUNITS: cm/s^2\nDATA_TYPE: ACCELERATION\nUSER5:\n0.1\n -1.2E0\n0.3\n";

    #[test]
    fn the_header_gives_step_and_unit() {
        for end in ["\n", "\r\n"] {
            let text = FILE.replace('\n', end);
            assert_eq!(
                asc().parse(text.as_bytes()),
                Ok(Contents {
                    samples: vec![(0.0, 0.1), (0.005, -1.2), (0.01, 0.3)],
                    unit: Unit::CentimetrePerS2,
                    wrapped: false,
                })
            );
        }
        let text = FILE.replace("cm/s^2\nDATA", "g\nDATA");
        let contents = asc().parse(text.as_bytes()).unwrap();
        assert_eq!(contents.unit, Unit::Gravity);
        let velocities = Layout {
            quantity: Recorded::Velocity,
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
