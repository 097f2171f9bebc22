//! Reasons why a mechanism has no capacity curve.

use serde::{Deserialize, Serialize};

use crate::Sway;
use crate::mechanics::settling::HeldError;
use crate::mechanics::{CapacityError, HeldTopError};
use crate::scenario::Language;

/// The reason why a mechanism has no capacity curve. In JSON it is the sentence in English.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(into = "String", from = "String")]
pub enum NoCurve {
    /// Joints slide before the mechanism forms.
    Slides,
    /// The mechanism has ties.
    Ties,
    /// The linkage to this side reaches its limit position before its strength is zero.
    Locks(Sway),
    /// It does not move as one mechanism up to the unstable equilibrium, for this reason in English.
    Moves(String),
}

impl NoCurve {
    /// Reason as a sentence. In Italian all reasons of [`NoCurve::Moves`] have one sentence.
    pub(super) fn in_words(&self, language: Language) -> String {
        let [english, italian] = match self {
            Self::Slides => [
                "joints slide before it forms, and the displacements of sliding joints are not computed",
                "i giunti scorrono prima che si formi; gli spostamenti di giunti che scorrono non sono calcolati",
            ],
            Self::Ties => [
                "the forces of ties change as the structure moves; this check does not follow them, quasi-static capacity does",
                "le forze delle catene variano durante il moto; questa verifica non le segue",
            ],
            Self::Locks(sway) => [
                &*CapacityError::Locks(*sway).to_string(),
                "il cinematismo raggiunge la posizione limite prima che α si annulli",
            ],
            Self::Moves(why) => [
                &**why,
                "dopo l’attivazione non si muove come un solo cinematismo fino ad α = 0",
            ],
        };
        language.choose(english, italian).to_owned()
    }
}

impl From<NoCurve> for String {
    fn from(why: NoCurve) -> Self {
        why.in_words(Language::English)
    }
}

impl From<String> for NoCurve {
    fn from(text: String) -> Self {
        let [right, left] = [Sway::Right, Sway::Left].map(Self::Locks);
        let mut known = [Self::Slides, Self::Ties, right, left].into_iter();
        let found = known.find(|why| why.in_words(Language::English) == text);
        found.unwrap_or(Self::Moves(text))
    }
}

impl From<CapacityError> for NoCurve {
    fn from(error: CapacityError) -> Self {
        match error {
            CapacityError::Locks(sway) => Self::Locks(sway),
            error => Self::Moves(error.to_string()),
        }
    }
}

impl From<HeldTopError> for NoCurve {
    fn from(error: HeldTopError) -> Self {
        match error {
            HeldTopError::Locks(error) => error.into(),
            HeldTopError::Ties => Self::Ties,
            error => Self::Moves(error.to_string()),
        }
    }
}

impl From<HeldError> for NoCurve {
    fn from(error: HeldError) -> Self {
        match error {
            HeldError::Locks(error) => error.into(),
            error => Self::Moves(error.to_string()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reasons_are_read_from_json_as_they_were_written() {
        for why in [
            NoCurve::Slides,
            NoCurve::Ties,
            NoCurve::Locks(Sway::Right),
            NoCurve::Locks(Sway::Left),
            NoCurve::Moves("a push to the right opens 3 hinges".to_owned()),
        ] {
            let json = serde_json::to_string(&why).unwrap();
            let english = why.in_words(Language::English);
            assert_eq!(json, format!("{english:?}"));
            assert_eq!(serde_json::from_str::<NoCurve>(&json).unwrap(), why);
            assert_ne!(english, why.in_words(Language::Italian));
        }
    }
}
