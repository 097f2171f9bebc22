//! Samples of record files: numbers on lines, at given times or at a constant step.

use archrock_text::{ensure, excerpt, plain, short};
use thiserror::Error;

use crate::unit::Unit;

/// Result of parsing a file.
pub(crate) type Parsed<T> = Result<T, LineFault>;

/// Times in s, and accelerations or velocities.
pub(crate) type Samples = Vec<(f64, f64)>;

/// Largest number of samples: an hour at 500 Hz.
pub(crate) const MAX_SAMPLES: usize = 1_800_000;
/// Largest magnitude of the times of a record, in s.
pub const MAX_TIME_S: f64 = 1e6;
/// Smallest step between samples, in s: a jump may take a microsecond.
pub const MIN_STEP_S: f64 = 1e-6;
/// Largest magnitude of a sample in any unit: products and squares of samples stay in the range of an `f64`.
pub(crate) const MAX_SAMPLE: f64 = 1e12;

/// The remedy for a table whose name ends as that of another format.
pub(crate) const IF_TABLE: &str = "Give `format = \"csv\"` if it is a table";

/// The contents of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Contents {
    /// Times in s, at least a microsecond apart, and accelerations or velocities: 2 to 1 800 000 samples, with magnitudes up to 1e12.
    pub samples: Vec<(f64, f64)>,
    /// The unit of the samples.
    pub unit: Unit,
    /// The columns of a table or the channel of a file, in words that follow the unit: ` from column 2`. Empty without a choice.
    pub columns: String,
    /// True if the file states the unit: its header, or the name of the column.
    pub states_unit: bool,
    /// Number from 1 and name of the channel, of formats with channels.
    pub channel: Option<(usize, String)>,
    /// Differences between header and samples and doubtful samples, as a phrase that follows the name of the file.
    pub difference: Option<String>,
}

impl Contents {
    pub(crate) fn new(samples: Samples, unit: Unit) -> Self {
        Self {
            samples,
            unit,
            columns: String::new(),
            states_unit: true,
            channel: None,
            difference: None,
        }
    }

    /// Adds phrases about doubtful samples to [`Contents::difference`].
    pub(crate) fn doubted(mut self, doubts: impl IntoIterator<Item = String>) -> Self {
        let all = self.difference.into_iter().chain(doubts);
        self.difference = all.reduce(|first, next| {
            let stop = if first.ends_with('?') { "" } else { "." };
            format!("{first}{stop} It also {next}")
        });
        self
    }
}

/// Compares the peak that a header states with that of the samples, in one unit. Returns a warning if they differ by more than the rounding. It is no
/// error: headers may state the peak before an offset was subtracted. `what` describes the compared samples, after a blank.
pub(crate) fn different_peak(stated: &str, found: f64, unit: Unit, what: &str) -> Option<String> {
    const TOLERANCE: f64 = 0.01;
    let peak = number(stated).ok()?.abs();
    let decimals = stated.split('.').nth(1).map_or(0, str::len);
    let rounding = match stated.contains(['e', 'E', 'd', 'D']) {
        true => 0.0,
        false => 0.5 * 0.1_f64.powi(decimals as i32),
    };
    let differs = (found - peak).abs() > rounding + TOLERANCE * peak.max(found);
    differs.then(|| {
        let ([found, peak], unit) = ([found, peak].map(plain), unit.name());
        format!("reaches {found} {unit}{what}, but its header states a peak of {peak} {unit}: are samples damaged?")
    })
}

/// Returns the largest magnitude of values, as differences from `offset`.
pub(crate) fn peak_of(values: &[f64], offset: f64) -> f64 {
    let magnitudes = values.iter().map(|value| (value - offset).abs());
    magnitudes.fold(0.0, f64::max)
}

/// A fault on a line of a record file.
///
/// Displayed as `line: message`, after the name of the file and a colon.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{line}: {message}")]
pub struct LineFault {
    /// Line, from 1.
    pub line: usize,
    /// The wrong value and the allowed values.
    pub message: String,
}

impl LineFault {
    /// Returns a function that makes faults of this line from messages.
    pub(crate) fn on<M: Into<String>>(line: usize) -> impl Fn(M) -> Self + Copy {
        move |message| Self {
            line,
            message: message.into(),
        }
    }
}

/// Numbers of a file, in order.
#[derive(Default)]
pub(crate) struct Values {
    pub(crate) values: Vec<f64>,
    /// Line of the last number, from 1.
    pub(crate) line: usize,
}

impl Values {
    /// Reads the samples below a header of `header_lines` lines. `words` divides a line into numbers.
    pub(crate) fn below<'t, W: Iterator<Item = &'t str>>(
        text: &'t str,
        header_lines: usize,
        words: impl Fn(&'t str) -> W,
    ) -> Parsed<Self> {
        let (values, line) = (Vec::new(), header_lines.max(1));
        let mut values = Self { values, line };
        for (index, line) in text.lines().enumerate().skip(header_lines) {
            for word in words(line) {
                let value = number(word).and_then(in_range);
                values.push(index + 1, value.map_err(LineFault::on(index + 1))?)?;
            }
        }
        Ok(values)
    }

    /// Adds a sample of a line.
    pub(crate) fn push(&mut self, line: usize, value: f64) -> Parsed<()> {
        self.line = line;
        ensure(self.values.len() < MAX_SAMPLES, || too_many(line))?;
        self.values.push(value);
        Ok(())
    }

    /// Returns a fault on the line of the last number.
    pub(crate) fn fault(&self, message: impl Into<String>) -> LineFault {
        LineFault::on(self.line)(message)
    }

    /// Returns an error if the number of samples is not the one that a line of the header announces.
    pub(crate) fn check_count(&self, (line, count): (usize, f64), key: &str) -> Parsed<()> {
        let found = self.values.len();
        ensure(count == found as f64, || {
            let announced = plain(count);
            self.fault(format!(
                "the number of samples is {found}: line {line} announces {announced} ({key}){}",
                surplus(found as f64 - count, line)
            ))
        })
    }

    /// Returns an error if there are too few samples for a record.
    pub(crate) fn check_enough(&self) -> Parsed<()> {
        let found = self.values.len();
        let wrong = format!("the number of samples is {found}; must be at least 2");
        ensure(found >= 2, || self.fault(wrong))
    }

    /// Returns the samples at a constant step, the first at time zero. `key` on this line gives the step.
    pub(crate) fn evenly(self, step_s: f64, line: usize, key: &str) -> Parsed<Samples> {
        self.check_enough()?;
        // Counts below 2^53 are exact.
        let times_s = (0..self.values.len()).map(|index| index as f64 * step_s);
        let last_s = times_s.clone().next_back().unwrap_or(0.0);
        ensure(last_s <= MAX_TIME_S, || {
            let (last, most) = (plain(last_s), short(MAX_TIME_S));
            LineFault::on(line)(format!(
                "{key} and the number of samples make a record of {last} s; at most {most} s are allowed"
            ))
        })?;
        Ok(times_s.zip(self.values).collect())
    }
}

/// Returns the fault of a record with too many samples, on the line of the first one beyond the limit.
pub(crate) fn too_many(line: usize) -> LineFault {
    LineFault::on(line)(format!(
        "more than {MAX_SAMPLES} samples, too many for a record"
    ))
}

/// Returns the remedy for more samples than a line of the header announces; empty for fewer.
pub(crate) fn surplus(more: f64, line: usize) -> String {
    match more > 0.0 {
        true => format!(
            "; delete the last {}, if they are not of this record, or correct line {line}",
            plain(more)
        ),
        false => String::new(),
    }
}

/// The times of samples, each with the line of its row.
#[derive(Default)]
pub(crate) struct Clock {
    times: Vec<(usize, f64)>,
}

impl Clock {
    /// Adds the time of the sample on a line. It may repeat the time before, but not be earlier.
    pub(crate) fn push(&mut self, line: usize, time_s: f64) -> Parsed<()> {
        let before_s = self.times.last().map(|time| time.1);
        if before_s != Some(time_s) {
            check_time(time_s, before_s).map_err(LineFault::on(line))?;
        }
        self.times.push((line, time_s));
        Ok(())
    }

    /// Joins times and samples. Keeps the first of several samples at the same time. Returns a warning about the others, as a phrase that follows the name of
    /// the file. Many of them are an error: such times are rounded.
    pub(crate) fn samples(self, values: Values) -> Parsed<(Samples, Option<String>)> {
        values.check_enough()?;
        let count = self.times.len() as f64;
        let rows = || self.times.iter().zip(&values.values);
        let repeats = || {
            rows()
                .zip(rows().skip(1))
                .filter(|(one, next)| one.0.1 == next.0.1)
        };
        let repeated = repeats().count();
        let Some((_, (&(line, time_s), left_out))) = repeats().next() else {
            let samples = rows().map(|(time, value)| (time.1, *value));
            return Ok((samples.collect(), None));
        };
        // A hundredth, and three in short records, if they are no large part of it.
        let most = (0.01 * count).max(3.0).min(0.25 * count);
        ensure(repeated as f64 <= most, || {
            let [time, least] = [time_s, MIN_STEP_S].map(short);
            let remedy =
                "if times are rounded, give them with more digits, or the step (`dt_s` of tables)";
            LineFault::on(line)(format!(
                "the time does not increase: {time} s follows {time} s, and {repeated} of {count} times repeat the one before; \
                 allowed are steps of at least {least} s: {remedy}"
            ))
        })?;
        let [time, left_out] = [time_s, *left_out].map(plain);
        let others = match repeated {
            1 => String::new(),
            _ => format!(", as are those at {} more", repeated - 1),
        };
        let mut samples: Samples = rows().map(|(time, value)| (time.1, *value)).collect();
        samples.dedup_by(|next, one| next.0 == one.0);
        Ok((
            samples,
            Some(format!(
                "repeats the time {time} s on line {line}: its second sample, {left_out}, is left out{others}"
            )),
        ))
    }

    /// Returns a warning if most steps are equal and others longer, as a phrase that follows the name of the file.
    pub(crate) fn gap(&self) -> Option<String> {
        let last_s = self.times.last()?.1;
        let pairs = self.times.windows(2);
        let steps = pairs.map(|pair| (pair[1].0, pair[1].1 - pair[0].1));
        let steps: Vec<_> = steps.filter(|step| step.1 > 0.0).collect();
        let mut equal: Vec<f64> = steps.iter().map(|step| step.1).collect();
        equal.sort_by(f64::total_cmp);
        let median_s = *equal.get(equal.len() / 2)?;
        let is_usual = is_step(median_s, last_s);
        equal.retain(|step_s| is_usual(*step_s));
        let is_regular = 3 * equal.len() >= 2 * steps.len();
        let usual_s = equal.iter().sum::<f64>() / equal.len() as f64;
        let mut long = steps.iter().filter(|step| step.1 > 1.5 * usual_s);
        let (line, first_s) = long.next().filter(|_| is_regular)?;
        let others = match long.count() {
            0 => String::new(),
            others => format!(", and {others} more such steps"),
        };
        let [first, usual] = [*first_s, usual_s].map(plain);
        Some(format!(
            "has a step of {first} s up to line {line}{others}, but the others take {usual} s: are rows missing?"
        ))
    }
}

/// Returns the test whether a step equals the usual one of a record that ends at `last_s`: to a thousandth, and to the rounding of times to six digits. A
/// step of twice the usual one is never equal.
pub(crate) fn is_step(usual_s: f64, last_s: f64) -> impl Fn(f64) -> bool {
    const EVEN: f64 = 1e-3;
    let rounding_s = libm::pow(10.0, libm::log10(last_s.abs()).floor() - 5.0);
    let tolerance_s = EVEN * usual_s + rounding_s.min(0.4 * usual_s);
    move |step_s| (step_s - usual_s).abs() <= tolerance_s
}

/// Checks samples that a program gives in place of a table, and returns the contents of that table. A fault has the number of its sample, from 1.
pub(crate) fn checked(samples: &[(f64, f64)], unit: Unit) -> Parsed<Contents> {
    let finite = |value: f64| {
        let message = || format!("`{value}` is not a finite number").to_lowercase();
        ensure(value.is_finite(), message).map(|()| value)
    };
    let (mut values, mut before_s) = (Values::default(), None);
    for (number, &(time_s, value)) in (1..).zip(samples) {
        let checked = finite(time_s).and_then(|time_s| check_time(time_s, before_s));
        let value = checked.and_then(|()| finite(value)).and_then(in_range);
        values.push(number, value.map_err(LineFault::on(number))?)?;
        before_s = Some(time_s);
    }
    values.line = values.line.max(1);
    values.check_enough()?;
    Ok(Contents {
        columns: " from column 2, times from column 1".to_owned(),
        states_unit: false,
        ..Contents::new(samples.to_vec(), unit)
    })
}

/// Returns the words of a line. Fortran writes numbers with a fixed width, so that only a sign may separate two of them: a sign begins a word,
/// except in an exponent.
pub(crate) fn words(line: &str) -> impl Iterator<Item = &str> {
    // Some files end with the end-of-file character of DOS.
    let blank = |c: char| c.is_whitespace() || c == '\u{1a}';
    line.split(blank).flat_map(|mut rest| {
        std::iter::from_fn(move || {
            let bytes = rest.as_bytes();
            let is_next = |&at: &usize| {
                matches!(bytes[at], b'+' | b'-')
                    && !matches!(bytes[at - 1], b'e' | b'E' | b'd' | b'D')
            };
            let end = (1..bytes.len()).find(is_next).unwrap_or(bytes.len());
            let word;
            (word, rest) = rest.split_at(end);
            Some(word).filter(|word| !word.is_empty())
        })
    })
}

/// Returns the words of a line of a header.
pub(crate) fn header_words(line: &str) -> impl Iterator<Item = &str> {
    line.split(|c: char| c.is_whitespace() || "=,:;()".contains(c))
}

/// Returns an error for a step that is too short.
pub(crate) fn checked_step(key: &str, step_s: f64) -> Result<f64, String> {
    ensure(step_s >= MIN_STEP_S, || {
        let (step, least) = (plain(step_s), short(MIN_STEP_S));
        format!("{key} is {step} s; must be at least {least} s")
    })?;
    Ok(step_s)
}

/// Returns the step in s between samples at a rate, in Hz.
pub(crate) fn step_of_rate(key: &str, rate_hz: f64) -> Result<f64, String> {
    let step_s = 1.0 / rate_hz;
    ensure(step_s.is_finite() && step_s >= MIN_STEP_S, || {
        let [given, most] = [plain(rate_hz), short(1.0 / MIN_STEP_S)];
        format!("{key} is {given}; must be above 0 and at most {most}")
    })?;
    Ok(step_s)
}

/// Returns an error if a time is out of range, or not later than the previous time.
pub(crate) fn check_time(time_s: f64, before_s: Option<f64>) -> Result<(), String> {
    ensure(time_s.abs() <= MAX_TIME_S, || {
        let (time, most) = (plain(time_s), short(MAX_TIME_S));
        format!("the time {time} s is out of range; its magnitude must be at most {most} s")
    })?;
    let before_s = before_s.unwrap_or(f64::NEG_INFINITY);
    ensure(time_s - before_s >= MIN_STEP_S, || {
        let [time, before, least] = [time_s, before_s, MIN_STEP_S].map(short);
        format!(
            "the time does not increase: {time} s follows {before} s; allowed are steps of at least {least} s"
        )
    })
}

/// Parses a finite number as programs write it; Fortran's `D` may begin the exponent.
pub(crate) fn number(given: &str) -> Result<f64, String> {
    // The standard parser also accepts "inf" and "nan".
    let numeric = |c: char| c.is_ascii_digit() || "+-.eEdD".contains(c);
    let word = Some(given).filter(|word| word.len() <= 60 && word.chars().all(numeric));
    let value = word.and_then(|word| match word.contains(['d', 'D']) {
        true => word.replace(['d', 'D'], "e").parse::<f64>().ok(),
        false => word.parse().ok(),
    });
    let value = value.filter(|value| value.is_finite());
    value.ok_or_else(|| format!("`{}` is not a finite number", excerpt(given)))
}

/// Returns an error for a sample that is out of range.
pub(crate) fn in_range(value: f64) -> Result<f64, String> {
    ensure(value.abs() <= MAX_SAMPLE, || {
        let (value, most) = (plain(value), short(MAX_SAMPLE));
        format!("`{value}` is out of range; samples must be at most {most} in magnitude")
    })?;
    Ok(value)
}
