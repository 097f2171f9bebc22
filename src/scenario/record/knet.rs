//! The files of K-NET and KiK-net (NIED, Japan).
//!
//! A header comes first, of lines with a name of up to 18 characters and a value; the last line begins with `Memo.`.
//! Whole numbers follow, several to a line. Multiplied by the `Scale Factor`, such as `3920(gal)/6182761`, they are
//! accelerations in gal, including the offset of the instrument.

use super::layout::{Contents, evenly};
use super::{LineFault, MAX_SAMPLES, MIN_STEP_S, Unit, number, sample};
use crate::argument::{plain, short};
use crate::scenario::error::excerpt;

/// Number of lines that may make up the header.
const MAX_HEADER_LINES: usize = 64;

const FREQUENCY: &str = "Sampling Freq(Hz)";
const SCALE: &str = "Scale Factor";
const DURATION: &str = "Duration Time(s)";
const LAST: &str = "Memo.";

/// The contents of the header.
#[derive(Default)]
struct Header {
    step_s: Option<f64>,
    /// Converts the whole numbers to gal.
    scale: Option<f64>,
    /// The duration, with its line from 1.
    duration_s: Option<(usize, f64)>,
}

/// Reads the samples; the first is at time zero.
pub(super) fn parse(text: &str) -> Result<Contents, LineFault> {
    let (header, header_lines) = Header::parse(text)?;
    let missing = |key: &str| LineFault {
        line: header_lines,
        message: format!("the header has no {key} up to here: is this a file of K-NET?"),
    };
    let step_s = header.step_s.ok_or_else(|| missing(FREQUENCY))?;
    let scale = header.scale.ok_or_else(|| missing(SCALE))?;
    let mut accelerations = Vec::new();
    let mut last_line = header_lines;
    for (index, line) in text.lines().enumerate().skip(header_lines) {
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
            accelerations.push(scale * sample(word).map_err(fault)?);
        }
    }
    let count = accelerations.len();
    let fault = |message| LineFault {
        line: last_line,
        message,
    };
    if count < 2 {
        return Err(fault(format!(
            "the number of samples is {count}; must be at least 2"
        )));
    }
    let samples = evenly(step_s, accelerations)
        .map_err(|wrong| fault(format!("{FREQUENCY} and the number of samples {wrong}")))?;
    // The header gives the duration in whole seconds.
    let lasts_s = count as f64 * step_s;
    if let Some((line, duration_s)) = header.duration_s
        && (lasts_s - duration_s).abs() > 1.0
    {
        return Err(fault(format!(
            "the file ends after {count} samples, {} s: line {line} announces {} s ({DURATION})",
            plain(lasts_s),
            plain(duration_s)
        )));
    }
    Ok(Contents {
        samples,
        unit: Unit::CentimetrePerS2,
        wrapped: false,
    })
}

impl Header {
    /// The header, and its number of lines.
    fn parse(text: &str) -> Result<(Self, usize), LineFault> {
        let mut header = Self::default();
        for (index, line) in text.lines().enumerate().take(MAX_HEADER_LINES) {
            if line.starts_with(LAST) {
                return Ok((header, index + 1));
            }
            header.take(index + 1, line).map_err(|message| LineFault {
                line: index + 1,
                message,
            })?;
        }
        Err(LineFault {
            line: text.lines().take(MAX_HEADER_LINES).count().max(1),
            message: format!("there is no {LAST} up to here: is this a file of K-NET?"),
        })
    }

    fn take(&mut self, line_number: usize, line: &str) -> Result<(), String> {
        let after = |key: &str| line.strip_prefix(key).map(str::trim);
        if let Some(value) = after(FREQUENCY) {
            let frequency_hz = number(value.trim_end_matches("Hz").trim_end())?;
            let step_s = 1.0 / frequency_hz;
            if !(step_s.is_finite() && step_s >= MIN_STEP_S) {
                return Err(format!(
                    "{FREQUENCY} is {}; must be above 0 and at most {}",
                    plain(frequency_hz),
                    short(1.0 / MIN_STEP_S)
                ));
            }
            self.step_s = Some(step_s);
        } else if let Some(value) = after(SCALE) {
            let wrong = || {
                format!(
                    "the {SCALE} is `{}`; must be like 3920(gal)/6182761",
                    excerpt(value)
                )
            };
            let (gal, counts) = value.split_once("(gal)/").ok_or_else(wrong)?;
            let scale = number(gal.trim())? / number(counts.trim())?;
            // Products with samples of at most 1e12 stay finite.
            if !(scale > 0.0 && scale <= 1.0) {
                return Err(wrong());
            }
            self.scale = Some(scale);
        } else if let Some(value) = after(DURATION) {
            self.duration_s = Some((line_number, number(value)?));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use crate::scenario::record::tests::assert_fault;
    use crate::scenario::record::{Form, Layout, Unit};

    const FILE: &str = "Origin Time       2024/01/02 03:04:05\nLat.              37.0\nStation Code      XXX001\n\
                        Record Time       2024/01/02 03:04:06\nSampling Freq(Hz) 4Hz\nDuration Time(s)  3\n\
                        Dir.              N-S\nScale Factor      3920(gal)/6182761\nMax. Acc. (gal)   1.0\n\
                        Memo.             \n    8009     9006     7998     8001     8009     8007     8002     8005\n\
                        -12  0 8003     8003\n";

    fn knet() -> Layout {
        Form::Knet.into()
    }

    #[test]
    fn counts_times_the_scale_factor_are_gal() {
        for end in ["\n", "\r\n"] {
            let contents = knet().parse(FILE.replace('\n', end).as_bytes()).unwrap();
            assert_eq!(contents.unit, Unit::CentimetrePerS2);
            assert_eq!(contents.samples.len(), 12);
            for (index, count) in [(0, 8009.0), (1, 9006.0), (8, -12.0), (11, 8003.0)] {
                let (time_s, gal) = contents.samples[index];
                assert_eq!(time_s, 0.25 * index as f64);
                assert!((gal - count * 3920.0 / 6_182_761.0).abs() < 1e-14 * count.abs());
            }
        }
    }

    /// Without the mean over time, the velocity at the end is zero.
    #[test]
    fn the_offset_goes_only_where_that_is_asked_for() {
        let layout = Layout {
            remove_mean: true,
            ..knet()
        };
        let gained = |layout: &Layout| {
            let samples = layout.parse(FILE.as_bytes()).unwrap().samples;
            let areas = samples
                .windows(2)
                .map(|pair| 0.5 * (pair[0].1 + pair[1].1) * (pair[1].0 - pair[0].0));
            areas.sum::<f64>()
        };
        assert!(gained(&layout).abs() < 1e-12);
        assert!(gained(&knet()) > 10.0);
    }

    #[test]
    fn faults_of_knet_files_have_lines() {
        let fault = |old: &str, new: &str, line, words| {
            assert!(FILE.contains(old));
            assert_fault(&FILE.replace(old, new), &knet(), line, words);
        };
        fault("Memo.", "Note", 12, "is this a file of K-NET?");
        fault("Sampling Freq(Hz)", "Sampling", 10, "no Sampling Freq(Hz)");
        fault("Scale Factor", "Factor", 10, "no Scale Factor");
        fault("4Hz", "0Hz", 5, "Sampling Freq(Hz) is 0; must be");
        fault("4Hz", "fast", 5, "`fast` is not a finite number");
        fault("3920(gal)/6182761", "1/2", 8, "must be like 3920(gal)");
        fault("/6182761", "/0", 8, "must be like 3920(gal)");
        fault(
            "Duration Time(s)  3",
            "Duration Time(s)  9",
            12,
            "line 6 announces 9 s",
        );
        fault("9006", "9006.x", 11, "`9006.x` is not a finite number");
        assert_fault("", &knet(), 1, "is this a file of K-NET?");
        let short = FILE.split_inclusive('\n').take(10).collect::<String>();
        assert_fault(&short, &knet(), 10, "number of samples is 0");
    }
}
