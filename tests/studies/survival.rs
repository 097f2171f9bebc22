//! The line of words about the strengths that a structure survives.

use archrock::studies::Verdict;
use archrock::studies::threshold::{Survival, survival_in_words};

fn survival(outcomes: &str) -> Survival {
    let levels = outcomes.bytes().zip(1..).map(|(outcome, level)| {
        let verdict = match outcome {
            b'x' => Some(Verdict::Overturns),
            b'.' => Some(Verdict::Survives),
            b'/' => Some(Verdict::Incomplete),
            b'~' => Some(Verdict::Uncertain),
            _ => None,
        };
        (f64::from(level), verdict)
    });
    Survival::of_levels(&levels.collect::<Vec<_>>())
}

/// Only an unbroken row of certain survivals from the smallest strength on is safe.
#[test]
fn safe_strengths_end_at_the_first_doubt() {
    let of = |outcomes: &str| {
        let found = survival(outcomes);
        (found.survives_up_to, found.overturns_from)
    };
    for (outcomes, expected) in [
        ("....", (Some(4.0), None)),
        ("..xx", (Some(2.0), Some(3.0))),
        (".x..x", (Some(1.0), Some(2.0))),
        (".~.x", (Some(1.0), Some(4.0))),
        ("../.x", (Some(2.0), Some(5.0))),
        (".?.x", (Some(1.0), Some(4.0))),
        ("x.", (None, Some(1.0))),
        ("~.x", (None, Some(3.0))),
        ("?.x", (None, Some(3.0))),
        ("??", (None, None)),
        ("", (None, None)),
    ] {
        assert_eq!(of(outcomes), expected, "{outcomes}");
    }
}

#[test]
fn the_words_are_one_line_that_begins_with_the_safe_strengths() {
    for (outcomes, words) in [
        ("....", "survives up to 4.000 g, the largest tried"),
        ("..x", "survives up to 2.000 g; overturns from 3.000 g"),
        (
            ".~~x..x.",
            "survives up to 1.000 g; uncertain above; certainly overturns at 4.000 g (gaps above: 5.000 to 6.000 g, 8.000 g)",
        ),
        (
            ".~.~/x~?x",
            "survives up to 1.000 g; uncertain at 2.000 g, 4.000 g; no verdict at 5.000 g; \
             certainly overturns at 6.000 g (uncertain above: 7.000 g; not known above: 8.000 g)",
        ),
        ("xx", "overturns at 1.000 g already, the smallest tried"),
        (
            "~x",
            "uncertain at 1.000 g already, the smallest tried; certainly overturns at 2.000 g",
        ),
        (
            ".//",
            "survives up to 1.000 g; no verdict above; does not certainly overturn up to 3.000 g",
        ),
        (
            "..??",
            "survives up to 2.000 g; not known above; does not certainly overturn up to 2.000 g",
        ),
        ("", "no history"),
    ] {
        assert_eq!(survival_in_words(&survival(outcomes), " g", None), words);
    }
    let at_most = Survival {
        at_most: true,
        ..survival(".~x")
    };
    let words = survival_in_words(&at_most, " g", None);
    assert!(words.ends_with("certainly overturns at or below 3.000 g"));
    // A safe strength is never rounded upwards.
    let found = Survival::of_levels(&[
        (0.123_47, Some(Verdict::Survives)),
        (0.123_48, Some(Verdict::Overturns)),
    ]);
    assert_eq!(
        survival_in_words(&found, "", Some(10.0)),
        "survives up to 0.1234 (1.234 g); overturns from 0.1235 (1.235 g)"
    );
}
