//! The AT2 and VT2 files of the PEER ground motion databases.
//!
//! The last line of a short header gives the number of samples and their spacing, in one of many wordings. Accelerations follow, in units of
//! gravity unless a line of the header names a unit, or velocities. Fortran wrote several numbers per line with a fixed width, so sometimes only
//! a minus sign separates two numbers.

use archrock_text::{ensure, plain};

use crate::layout::{Format, Layout, Parser};
use crate::samples::{
    Contents, IF_TABLE, LineFault, MAX_SAMPLES, Parsed, Values, checked_step, header_words, number,
    words,
};
use crate::unit::{RecordedQuantity, Unit};

impl Format {
    /// PEER strong motion database (AT2, VT2).
    pub const AT2: Self = Self {
        name: "at2",
        label: "AT2 file (PEER)",
        extensions: &["at2", "vt2"],
        begins: |lines| lines.iter().take(8).any(|line| ends_header(line)),
        parser: Parser::Record(parse, None),
    };
}

/// Largest number of lines in which the end of the header is searched for.
const MAX_HEADER_LINES: usize = 64;
/// Largest number of characters of a line that are searched.
const MAX_HEADER_LINE_CHARS: usize = 1000;

/// Reads the samples; the first is at time zero. The unit of the layout overrides that in the header.
fn parse(text: &str, layout: &Layout) -> Parsed<Contents> {
    let (unit, quantity) = (layout.unit, layout.quantity);
    let (line, [count, step_s], named) = header(text, unit, quantity)?;
    let gravity = Some(Unit::Gravity).filter(|_| quantity == RecordedQuantity::Acceleration);
    let missing = "the header names no unit up to here; give `unit`: what the velocities are in";
    let states_unit = unit.is_none() && named.is_some();
    let unit = unit.or(named).or(gravity);
    let unit = unit.ok_or_else(|| LineFault::on(line)(missing))?;
    let values = Values::below(text, line, |line| line.split(',').flat_map(words))?;
    values.check_count((line, count), "NPTS")?;
    Ok(Contents {
        states_unit,
        ..Contents::new(values.evenly(step_s, line, "DT")?, unit)
    })
}

const COUNT: &str = "NPTS";
const STEP: &str = "DT";

/// Reads the header. Returns the number of its last line, from 1, the number of samples and their step in s, and the unit that it names.
fn header(
    text: &str,
    known: Option<Unit>,
    quantity: RecordedQuantity,
) -> Parsed<(usize, [f64; 2], Option<Unit>)> {
    let (mut unit, mut items, mut last) = (None, Vec::new(), 1);
    for (text, line) in text.lines().zip(1..).take(MAX_HEADER_LINES) {
        last = line;
        let end = text.char_indices().nth(MAX_HEADER_LINE_CHARS);
        let text = end.map_or(text, |(end, _)| &text[..end]);
        let fault = LineFault::on::<String>(line);
        check_quantity(text, quantity).map_err(fault)?;
        if let Some(named) = unit_named(text) {
            let remedy = "give `unit`: what the samples are in";
            unit = match known {
                Some(_) => Unit::written(named).or(known),
                None => Some(Unit::of_header(named, quantity, remedy).map_err(fault)?),
            };
        }
        let begins = header_words(text).any(|word| word.eq_ignore_ascii_case(COUNT));
        if begins || !items.is_empty() {
            items.extend(header_words(text).filter(|word| is_item(word)));
        }
        if position(&items, STEP).is_some() {
            let missing = || fault("gives no numbers for NPTS and DT".to_owned());
            let (count, step_s) = values(&items).ok_or_else(missing)?;
            let step_s = checked_step(STEP, step_s).map_err(fault)?;
            let is_count = count.fract() == 0.0 && (2.0..=MAX_SAMPLES as f64).contains(&count);
            ensure(is_count, || {
                let count = plain(count);
                fault(format!(
                    "{COUNT} is {count}; must be a whole number from 2 to {MAX_SAMPLES}"
                ))
            })?;
            return Ok((line, [count, step_s], unit));
        }
        // Number of samples and spacing may be on two consecutive lines.
        if !items.is_empty() && !begins {
            break;
        }
    }
    let message = match items.is_empty() {
        true => format!(
            "there is no NPTS (number of samples) up to here: is this an AT2 file? {IF_TABLE}"
        ),
        false => "the header has no DT (time step) up to here".to_owned(),
    };
    Err(LineFault::on(last)(message))
}

/// Returns true for a line of the header with both labels, which is no comment.
fn ends_header(line: &str) -> bool {
    let words: Vec<_> = header_words(line).collect();
    let has = |label| position(&words, label).is_some();
    has(COUNT) && has(STEP) && !line.trim_start().starts_with(['#', '%'])
}

/// Returns true if a word of the header is a label or a number.
fn is_item(word: &str) -> bool {
    position(&[word], COUNT).is_some()
        || position(&[word], STEP).is_some()
        || leading_number(word).is_some()
}

fn position(items: &[&str], label: &str) -> Option<usize> {
    items
        .iter()
        .position(|item| item.eq_ignore_ascii_case(label))
}

/// Returns number of samples and time step: the number after each label, or otherwise the first two numbers in the order of the labels, as in
/// `4096 0.01 NPTS, DT`.
fn values(items: &[&str]) -> Option<(f64, f64)> {
    let (count, step) = (position(items, COUNT)?, position(items, STEP)?);
    let after = |at: usize| leading_number(items.get(at + 1)?);
    if let (Some(count), Some(step)) = (after(count), after(step)) {
        return Some((count, step));
    }
    let mut numbers = items.iter().filter_map(|item| leading_number(item));
    let (first, second) = (numbers.next()?, numbers.next()?);
    Some(if count < step {
        (first, second)
    } else {
        (second, first)
    })
}

/// Returns the number at the beginning of a word, as in `.0050SEC`.
fn leading_number(word: &str) -> Option<f64> {
    let end = word
        .find(|c: char| !(c.is_ascii_digit() || "+-.eEdD".contains(c)))
        .unwrap_or(word.len());
    // An E after the number may belong to the number or to the next word.
    (1..=end.min(40))
        .rev()
        .find_map(|end| number(&word[..end]).ok())
}

/// Returns an error if a line of the header shows that the file contains another quantity.
fn check_quantity(line: &str, wanted: RecordedQuantity) -> Result<(), String> {
    let line = line.to_ascii_uppercase();
    let holds = |name: &str| line.contains(&format!("{name} TIME"));
    let (velocities, accelerations) = (holds("VELOCITY"), holds("ACCELERATION"));
    Err(match wanted {
        _ if holds("DISPLACEMENT") => {
            "the file holds a displacement history; must be an acceleration or velocity history"
        }
        RecordedQuantity::Acceleration if velocities && !accelerations => {
            "the file holds a velocity history: give `quantity = \"velocity\"`"
        }
        RecordedQuantity::Velocity if accelerations => {
            "the file holds an acceleration history: leave out `quantity = \"velocity\"`"
        }
        _ => return Ok(()),
    }
    .to_owned())
}

/// Returns the unit that a line of the header names.
fn unit_named(line: &str) -> Option<&str> {
    const WORDS: &str = "UNITS OF ";
    // Upper case does not move characters: only ASCII letters change.
    let at = line.to_ascii_uppercase().find(WORDS)? + WORDS.len();
    let unit = line[at..].split_whitespace().next()?;
    Some(unit.trim_end_matches(|c: char| !c.is_alphanumeric()))
}

#[cfg(test)]
mod tests {
    use crate::tests::{assert_fault, parse};
    use crate::{Format, Layout, RecordedQuantity, Unit};

    #[test]
    fn headers_of_all_wordings_are_read() {
        for header in [
            "NPTS=     3, DT=   .0050 SEC",
            "NPTS=3, DT= .00500 SEC, 5E15.7",
            "NPTS=  3 , DT= 0.0050 SEC,",
            "NPTS 3 DT 0.005",
            "npts: 3; dt: 5.0E-3 sec",
            "    3   0.0050   NPTS, DT",
            "   3    0.0050  NPTS, DT, 8 VALUES TO A LINE",
            "NPTS, DT = 3, .005",
            "DT, NPTS = .005 3",
            "3 NPTS, .005SEC DT",
            "DT= .0050SEC  NPTS= 3",
            "NPTS= 3.  DT= .5D-02",
            "NPTS= 3\nDT= .005 SEC",
        ] {
            for end in ["\n", "\r\n"] {
                let text = format!(
                    "\u{feff}PEER STRONG MOTION DATABASE RECORD\nSYNTHETIC 1, 0\n\
                     ACCELERATION TIME HISTORY IN UNITS OF G. FILTER POINTS: HP=0.1 Hz\n{header}\n 0.1 -.2E-01\n 3.D-1\n"
                );
                let samples =
                    parse(&text.replace('\n', end), &Layout::new(Format::AT2)).expect(header);
                assert_eq!(
                    samples,
                    [(0.0, 0.1), (0.005, -0.02), (0.01, 0.3)],
                    "{header}"
                );
            }
        }
    }

    #[test]
    fn fixed_width_values_may_touch() {
        let values = |line: &str| {
            let count = 4;
            let text = format!("NPTS= {count}, DT= .01\n{line}\n");
            parse(&text, &Layout::new(Format::AT2))
                .map(|samples| samples.into_iter().map(|s| s.1).collect::<Vec<_>>())
        };
        assert_eq!(
            values("-.1234E-03-.5678E-03+.1E+01-0.2").unwrap(),
            [-0.000_123_4, -0.000_567_8, 1.0, -0.2]
        );
        assert_eq!(
            values("1,-2-3\n\n 4\r\n\u{1a}").unwrap(),
            [1.0, -2.0, -3.0, 4.0]
        );
        // Numbers without a sign or blank between them are an error.
        for line in [
            "0.12340.5678 0 0 0",
            ".12E-03.56E-03 0 0",
            "1--2 3",
            "1 2 3 4-",
        ] {
            assert!(values(line).is_err(), "{line}");
        }
    }

    #[test]
    fn faults_of_at2_files_have_lines() {
        let fault =
            |text: &str, line, words| assert_fault(text, &Layout::new(Format::AT2), line, words);
        let head = "A\nB\nUNITS OF G\nNPTS= 3, DT= .01 SEC\n";
        fault(
            &format!("{head}1 2\n3 4\n"),
            6,
            "samples is 4: line 4 announces 3",
        );
        fault(&format!("{head}1 2\n3\n\n.5\n"), 8, "line 4 announces 3");
        fault(
            &format!("{head}1 2\n"),
            5,
            "number of samples is 2: line 4 announces 3",
        );
        fault(head, 4, "number of samples is 0");
        fault(&format!("{head}1\nabc"), 6, "`abc` is not a finite number");
        for word in ["nan", "inf", "1e999", "****", "-", "1.2.3"] {
            fault(&format!("{head}1\n{word}"), 6, "is not a finite number");
        }
        fault("", 1, "no NPTS");
        fault("1 2 3", 1, "no NPTS");
        fault("A\nNPTS= 3\n1 2 3", 3, "no DT");
        fault("A\nNPTS= 3", 2, "no DT");
        fault("NPTS, DT\n1 2", 1, "no numbers");
        fault("NPTS= 3.5, DT= .1", 1, "NPTS is 3.5");
        fault("NPTS= 1, DT= .1", 1, "NPTS is 1;");
        fault("NPTS= 99999999999, DT= .1", 1, "from 2 to 1800000");
        fault("NPTS= -5, DT= .1", 1, "NPTS is -5;");
        fault("NPTS= 1e308, DT= .1", 1, "NPTS is 1e308;");
        fault(&format!("{head}1\n1e308"), 6, "`1e308` is out of range");
        fault("NPTS= 5, DT= 0", 1, "DT is 0 s");
        fault("NPTS= 5, DT= -.1", 1, "DT is -0.1 s");
        fault(
            "NPTS= 3, DT= 1e6\n1 2 3",
            1,
            "record of 2e6 s; at most 1e6 s",
        );
        fault(
            "A\nVELOCITY TIME HISTORY IN UNITS OF CM/S",
            2,
            "the file holds a velocity history: give `quantity = \"velocity\"`",
        );
        fault("UNITS OF CM/S\nNPTS 2 DT 1\n1 2", 1, "a unit of velocity");
        fault(
            "DISPLACEMENT TIME SERIES IN UNITS OF CM",
            1,
            "a displacement history",
        );
        fault("A\nUNITS OF GG\nNPTS 2 DT 1\n1 2", 2, "the unit is GG;");
    }

    #[test]
    fn accelerations_may_be_in_other_units() {
        let unit = |header: &str, key: Option<Unit>| {
            let text = format!("A\n{header}\nNPTS= 2, DT= .01\n1 2\n");
            let layout = Layout {
                unit: key,
                ..Layout::new(Format::AT2)
            };
            layout.parse(text.as_bytes()).unwrap().unit
        };
        for (header, named) in [
            ("ACCELERATION TIME SERIES IN UNITS OF G", Unit::Gravity),
            ("Units of g. Filter points", Unit::Gravity),
            ("UNITS OF CM/SEC/SEC", Unit::CentimetrePerS2),
            ("units of m/s^2,", Unit::MetrePerS2),
            ("UNITS OF MG", Unit::MilliGravity),
            ("UNITS OF IN/SEC/SEC", Unit::InchPerS2),
            ("no unit", Unit::Gravity),
        ] {
            assert_eq!(unit(header, None), named, "{header}");
            assert_eq!(unit(header, Some(Unit::MetrePerS2)), Unit::MetrePerS2);
        }
        assert_eq!(
            unit("UNITS OF GG", Some(Unit::CentimetrePerS2)),
            Unit::CentimetrePerS2
        );
    }

    #[test]
    fn velocities_are_read_where_they_are_announced() {
        let velocities = |unit| Layout {
            quantity: RecordedQuantity::Velocity,
            unit,
            ..Layout::new(Format::AT2)
        };
        let text = "A\nVELOCITY TIME SERIES IN UNITS OF CM/S\nNPTS= 2, DT= .01\n1 2\n";
        let contents = velocities(None).parse(text.as_bytes()).unwrap();
        assert_eq!(contents.unit, Unit::CentimetrePerS);
        assert_eq!(contents.samples, [(0.0, 1.0), (0.01, 2.0)]);
        let nameless = "A\nNPTS= 2, DT= .01\n1 2\n";
        assert_fault(nameless, &velocities(None), 2, "names no unit");
        let contents = velocities(Some(Unit::MetrePerS)).parse(nameless.as_bytes());
        assert_eq!(contents.unwrap().unit, Unit::MetrePerS);
        let text = "ACCELERATION TIME SERIES IN UNITS OF G\nNPTS= 2, DT= .01\n1 2\n";
        assert_fault(text, &velocities(None), 1, "leave out `quantity");
    }
}
