//! Printed sentences: their numbers are compared with results, and one text of each study with `tests/golden`.
//!
//! A changed sentence breaks its golden text: `ARCHROCK_GOLDEN=write cargo test` writes the texts anew.

use std::fs;
use std::path::Path;

/// The text with `#` in place of every number, and the numbers as printed, in order.
pub fn skeleton(text: &str) -> (String, Vec<&str>) {
    let (mut shape, mut numbers) = (String::new(), Vec::new());
    let mut rest = text;
    while let Some(start) = rest.find(|c: char| c.is_ascii_digit()) {
        let within_word = rest[..start].ends_with(|c: char| c.is_alphanumeric() || c == '_');
        let length = rest[start..]
            .find(|c: char| !(c.is_ascii_digit() || c == '.'))
            .unwrap_or(rest.len() - start);
        // A full stop ends the sentence.
        let length = rest[start..start + length].trim_end_matches('.').len();
        let minus = rest[..start]
            .strip_suffix(['-', '\u{2212}', '+'])
            .map_or(0, |before| {
                let is_sign = before.is_empty() || before.ends_with([' ', '(', '[', ',']);
                if is_sign { start - before.len() } else { 0 }
            });
        let (before, number) = (start - minus, &rest[start - minus..start + length]);
        shape += &rest[..before];
        if within_word {
            shape += number;
        } else {
            shape.push('#');
            numbers.push(number);
        }
        rest = &rest[start + length..];
    }
    (shape + rest, numbers)
}

/// Whether a printed number is this one, rounded to the digits shown; it must show two of them, because many numbers begin with any one digit.
pub fn is_shown(printed: &str, value: f64) -> bool {
    let printed = printed.replace('\u{2212}', "-");
    let printed = printed.trim_start_matches('+');
    let digits = printed.split_once('.').map_or(0, |(_, after)| after.len());
    let significant = printed.trim_start_matches(['-', '0', '.']);
    significant.len() >= 2 && format!("{value:.digits$}") == printed
}

/// Asserts that a text shows these numbers in this order, each rounded to the digits shown, maybe with others between them.
#[track_caller]
pub fn shows(text: &str, numbers: &[f64]) {
    let (_, printed) = skeleton(text);
    let mut printed = printed.iter();
    for &number in numbers {
        assert!(
            printed.any(|printed| is_shown(printed, number)),
            "{number} is not in this order in: {text}"
        );
    }
}

/// Whether two printed numbers agree to three digits: counts below 200 are equal. The further digits follow the sine of the machine, and so do
/// long counts of steps.
fn agree(known: &str, now: &str) -> bool {
    let [known, now] = [known, now].map(|printed| {
        let number: f64 = printed.replace('\u{2212}', "-").parse().unwrap();
        number
    });
    (known - now).abs() <= 5e-3 * known.abs()
}

/// Compares a text with `tests/golden/NAME.txt`, its words exactly and its numbers to three digits, or writes it there if `ARCHROCK_GOLDEN` is
/// `write`.
#[track_caller]
pub fn golden(name: &str, text: &str) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden");
    let path = folder.join(format!("{name}.txt"));
    if std::env::var("ARCHROCK_GOLDEN").is_ok_and(|value| value == "write") {
        fs::create_dir_all(folder).unwrap();
        fs::write(path, text).unwrap();
        return;
    }
    let known = fs::read_to_string(&path).unwrap_or_default();
    let same = |known: &str, now: &str| {
        let ((known, of_known), (now, of_now)) = (skeleton(known), skeleton(now));
        known == now && of_known.into_iter().zip(of_now).all(|(a, b)| agree(a, b))
    };
    let first = (known.lines().zip(text.lines())).find(|(known, now)| !same(known, now));
    assert!(
        first.is_none() && known.lines().count() == text.lines().count(),
        "tests/golden/{name}.txt differs, first in {first:?}. If the new text is better, write it with ARCHROCK_GOLDEN=write in the environment of this test"
    );
}

#[test]
fn skeletons_of_sentences_have_no_numbers() {
    let (shape, numbers) = skeleton("tie_1 pulls 12.50 kN at -0.3 g, (-2 to 3 s), SLV 0.5.");
    assert_eq!(shape, "tie_1 pulls # kN at # g, (# to # s), SLV #.");
    assert_eq!(numbers, ["12.50", "-0.3", "-2", "3", "0.5"]);
    shows("falls at 0.358811 m with 16 blocks", &[0.358_810_9, 16.0]);
    assert!(!is_shown("0.4", 0.358_81));
    assert!(agree("0.6812", "0.6813") && agree("9342", "9350"));
    assert!(!agree("7", "8") && !agree("0.31", "0.32") && !agree("0.000", "0.001"));
}

#[test]
#[should_panic = "0.7 is not in this order"]
fn exchanged_numbers_are_found() {
    shows("0.7000 g to the right, 0.3000 g to the left", &[0.3, 0.7]);
}
