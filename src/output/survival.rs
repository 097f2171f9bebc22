//! In a line: where a structure first overturns, and where it survives again.

use super::threshold::rounded;
use crate::studies::survival::Survival;

/// The line, of strengths in this unit, which may be empty: `first overturns at 2.113; survives again at 2.401 to
/// 2.604`.
#[must_use]
pub fn in_words(survival: &Survival, unit: &str) -> String {
    let at = |strength: f64| format!("{}{unit}", rounded(strength));
    let Some(first) = survival.overturns_from else {
        return format!("does not overturn up to {}", at(survival.tried_to));
    };
    let mut words = if survival.from_the_first {
        format!("overturns at {} already, the least tried", at(first))
    } else {
        format!("first overturns at {}", at(first))
    };
    let again: Vec<String> = survival
        .again
        .iter()
        .map(|[from, to]| {
            if from == to {
                at(*from)
            } else {
                format!("{} to {}", rounded(*from), at(*to))
            }
        })
        .collect();
    if !again.is_empty() {
        words += &format!("; survives again at {}", again.join(", "));
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
    }
}
