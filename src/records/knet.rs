//! The files of K-NET and KiK-net (NIED, Japan).
//!
//! The header has lines with a name of up to 18 characters and a value; its last line begins with `Memo.`. Integers follow, several per line.
//! Multiplied by the `Scale Factor`, such as `3920(gal)/6182761`, they are accelerations in gal, including the offset of the instrument. For
//! `Max. Acc. (gal)` their mean is subtracted. Source: the descriptions of both formats (NIED, kyoshin.bosai.go.jp).

use archrock_text::{ensure, excerpt, plain};

use crate::history::has;
use crate::layout::{Format, Layout, Parser};
use crate::samples::{
    Contents, IF_TABLE, LineFault, Parsed, Values, different_peak, number, peak_of, step_of_rate,
    surplus, words,
};
use crate::unit::Unit;

impl Format {
    /// K-NET and KiK-net.
    pub const KNET: Self = Self {
        name: "knet",
        label: "file of K-NET",
        extensions: &["ns", "ew", "ud", "ns1", "ew1", "ud1", "ns2", "ew2", "ud2"],
        begins: |lines| lines[0].starts_with("Origin Time") && has(lines, FREQUENCY),
        parser: Parser::Record(
            parse,
            Some("does not apply to a file of K-NET, whose header has a Scale Factor"),
        ),
    };
}

/// Largest number of lines of the header.
const MAX_HEADER_LINES: usize = 64;

const FREQUENCY: &str = "Sampling Freq(Hz)";
const SCALE: &str = "Scale Factor";
const DURATION: &str = "Duration Time(s)";
/// The peak, as files and as the description spell it.
const PEAKS: [&str; 2] = ["Max. Acc. (gal)", "Max Acc. (gal)"];
const LAST: &str = "Memo.";

/// Reads the samples; the first is at time zero.
fn parse(text: &str, _: &Layout) -> Parsed<Contents> {
    let mut header: Vec<&str> = text.lines().take(MAX_HEADER_LINES).collect();
    let end = header.iter().position(|line| line.starts_with(LAST));
    header.truncate(end.map_or(header.len(), |end| end + 1));
    let lines = header.len();
    let missing = |key: &str| {
        let message = format!("there is no {key} up to here: is this a file of K-NET? {IF_TABLE}");
        LineFault::on(lines.max(1))(message)
    };
    end.ok_or_else(|| missing(LAST))?;
    // Lines from 1, with the values after a name.
    let find = |key: &str| {
        let at = header.iter().rposition(|line| line.starts_with(key))?;
        Some((at + 1, header[at][key.len()..].trim()))
    };
    let (line, frequency) = find(FREQUENCY).ok_or_else(|| missing(FREQUENCY))?;
    let step_s = read_step(frequency).map_err(LineFault::on(line))?;
    let (line, scale) = find(SCALE).ok_or_else(|| missing(SCALE))?;
    let scale = read_scale(scale).map_err(LineFault::on(line))?;
    let mut values = Values::below(text, lines, words)?;
    values.values.iter_mut().for_each(|value| *value *= scale);
    values.check_enough()?;
    let other_length = find(DURATION).map(|duration| check_duration(&values, step_s, duration));
    let other_length = other_length.transpose()?.flatten();
    let mean = values.values.iter().sum::<f64>() / values.values.len() as f64;
    let (found, unit) = (peak_of(&values.values, mean), Unit::CentimetrePerS2);
    let stated = PEAKS.iter().find_map(|key| find(key));
    let difference =
        stated.and_then(|(_, peak)| different_peak(peak, found, unit, " without its mean"));
    let last = values.line;
    let samples = values.evenly(step_s, last, FREQUENCY)?;
    Ok(Contents::new(samples, unit).doubted(other_length.into_iter().chain(difference)))
}

/// Compares the number of samples with the duration on a line of the header. One sample more or less, as some programs count them, is a warning, a
/// phrase that follows the name of the file; more are a fault.
fn check_duration(
    values: &Values,
    step_s: f64,
    (line, duration): (usize, &str),
) -> Parsed<Option<String>> {
    let duration_s = number(duration).map_err(LineFault::on(line))?;
    let (found, announced) = (values.values.len() as f64, (duration_s / step_s).round());
    let more = found - announced;
    ensure(more.abs() <= 1.0, || {
        let [lasts_s, duration_s, announced] = [found * step_s, duration_s, announced].map(plain);
        values.fault(format!(
            "the file ends after {found} samples, {lasts_s} s: line {line} announces {duration_s} s ({DURATION}), {announced} samples{}",
            surplus(more, line)
        ))
    })?;
    Ok((more != 0.0).then(|| format!("has {found} samples, but its header announces {announced}")))
}

fn read_step(frequency: &str) -> Result<f64, String> {
    let frequency_hz = number(frequency.trim_end_matches("Hz").trim_end())?;
    step_of_rate(FREQUENCY, frequency_hz)
}

/// Returns the factor that converts the integers to gal.
fn read_scale(scale: &str) -> Result<f64, String> {
    let part = |text: &str| number(text.trim()).ok();
    let parts = scale.split_once("(gal)/");
    let factor = parts.and_then(|(gal, counts)| Some(part(gal)? / part(counts)?));
    // Products with samples of at most 1e12 stay finite.
    let factor = factor.filter(|factor| (0.0..=1.0).contains(factor) && *factor > 0.0);
    factor.ok_or_else(|| {
        let scale = excerpt(scale);
        format!(
            "the {SCALE} is `{scale}`; must be like 3920(gal)/6182761, the gal at so many counts"
        )
    })
}

#[cfg(test)]
mod tests {
    use crate::tests::assert_fault;
    use crate::{Baseline, Format, Layout, Unit};

    const FILE: &str = "Origin Time       2024/01/02 03:04:05\nLat.              37.0\nStation Code      XXX001\n\
                        Record Time       2024/01/02 03:04:06\nSampling Freq(Hz) 4Hz\nDuration Time(s)  3\n\
                        Dir.              N-S\nScale Factor      3920(gal)/6182761\nMax. Acc. (gal)   1.0\n\
                        Memo.             \n    8009     9006     7998     8001     8009     8007     8002     8005\n\
                        -12  0 8003     8003\n";

    fn knet() -> Layout {
        Layout::new(Format::KNET)
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

    /// If the mean over time is removed, the velocity at the end is zero.
    #[test]
    fn the_offset_goes_only_where_that_is_asked_for() {
        let layout = Layout {
            baseline: Some(Baseline::Mean),
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
            "3920(gal)",
            "(gal)",
            8,
            "`(gal)/6182761`; must be like 3920(gal)",
        );
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
