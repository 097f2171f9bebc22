//! In a line: where a structure first overturns, where it survives again, and where that is uncertain.

use super::threshold::rounded;
use crate::studies::survival::Survival;

/// The line, of strengths in this unit, which may be empty: `first overturns at 2.113; survives again at 2.401 to
/// 2.604`.
#[must_use]
pub fn in_words(survival: &Survival, unit: &str) -> String {
    let at = |strength: f64| format!("{}{unit}", rounded(strength));
    let mut words = match survival.overturns_from {
        None if survival.uncertain.is_empty() => {
            format!("does not overturn up to {}", at(survival.tried_to))
        }
        None => format!(
            "does not certainly overturn up to {}",
            at(survival.tried_to)
        ),
        Some(first) if survival.from_the_first => {
            format!("overturns at {} already, the least tried", at(first))
        }
        Some(first) => format!("first overturns at {}", at(first)),
    };
    for (what, ranges) in [
        ("survives again", &survival.again),
        ("uncertain", &survival.uncertain),
    ] {
        let ranges: Vec<String> = ranges
            .iter()
            .map(|[from, to]| match (at(*from), at(*to)) {
                (from, to) if from == to => to,
                (_, to) => format!("{} to {to}", rounded(*from)),
            })
            .collect();
        if !ranges.is_empty() {
            words += &format!("; {what} at {}", ranges.join(", "));
        }
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_words_are_one_line() {
        let survival = |from: Option<f64>, again: &[[f64; 2]]| Survival {
            overturns_from: from,
            from_the_first: from == Some(0.1),
            again: again.to_vec(),
            uncertain: Vec::new(),
            tried_to: 4.0,
        };
        assert_eq!(
            in_words(&survival(None, &[]), " g"),
            "does not overturn up to 4.000 g"
        );
        assert_eq!(
            in_words(&survival(Some(2.113_06), &[[2.4, 2.6], [3.0, 3.0]]), " g"),
            "first overturns at 2.113 g; survives again at 2.400 to 2.600 g, 3.000 g"
        );
        assert_eq!(
            in_words(&survival(Some(0.1), &[]), ""),
            "overturns at 0.1000 already, the least tried"
        );
        let uncertain = |from, uncertain: &[[f64; 2]]| Survival {
            uncertain: uncertain.to_vec(),
            ..survival(from, &[])
        };
        assert_eq!(
            in_words(&uncertain(Some(2.5), &[[2.1, 2.4], [3.0, 3.0]]), " g"),
            "first overturns at 2.500 g; uncertain at 2.100 to 2.400 g, 3.000 g"
        );
        assert_eq!(
            in_words(&uncertain(None, &[[3.0, 4.0]]), ""),
            "does not certainly overturn up to 4.000; uncertain at 3.000 to 4.000"
        );
    }
}
