//! Units of recorded accelerations.

use toml::de::DeValue;

use crate::scenario::table::{OneOf, Rule};

named! {
    /// Unit of the accelerations in a file.
    pub enum Unit {
        /// Gravity of the simulation.
        Gravity = "g",
        /// Metres per second squared.
        MetrePerS2 = "m/s2",
        /// Centimetres per second squared, gal.
        CentimetrePerS2 = "cm/s2",
    }
}

impl Unit {
    pub(super) const fn in_m_s2(self, gravity_m_s2: f64) -> f64 {
        match self {
            Self::Gravity => gravity_m_s2,
            Self::MetrePerS2 => 1.0,
            Self::CentimetrePerS2 => 0.01,
        }
    }

    /// The unit that is written in one of the ways that files have: `cm/s^2`, `CM/SEC/SEC`, `gal`.
    pub(super) fn written(text: &str) -> Option<Self> {
        let plain: String = text
            .chars()
            .filter(|c| !c.is_whitespace() && !"^*()[]".contains(*c))
            .collect();
        let plain = plain.to_ascii_lowercase().replace("sec", "s");
        match plain.as_str() {
            "g" => Some(Self::Gravity),
            "m/s2" | "m/s/s" => Some(Self::MetrePerS2),
            "cm/s2" | "cm/s/s" | "gal" | "gals" => Some(Self::CentimetrePerS2),
            _ => None,
        }
    }
}

/// A unit, by its name or as files write it.
pub(super) struct AnyUnit;

const NAMES: OneOf<'static, Unit> = OneOf {
    all: Unit::ALL,
    name: Unit::name,
};

impl Rule for AnyUnit {
    type Value = Unit;

    fn allowed(&self) -> String {
        format!("{} or \"gal\"", NAMES.allowed())
    }

    fn read(&self, value: &DeValue<'_>) -> Result<Unit, String> {
        match value.as_str().and_then(Unit::written) {
            Some(unit) => Ok(unit),
            None => NAMES.read(value),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_read_as_files_write_them() {
        for (unit, texts) in [
            (Unit::Gravity, &["g", "G", " g "][..]),
            (Unit::MetrePerS2, &["m/s2", "m/s^2", "M/SEC/SEC", "m/s**2"]),
            (
                Unit::CentimetrePerS2,
                &[
                    "cm/s2",
                    "cm/s^2",
                    "CM/SEC2",
                    "cm/s/s",
                    "gal",
                    "Gal",
                    "(cm/sec^2)",
                ],
            ),
        ] {
            for text in texts {
                assert_eq!(Unit::written(text), Some(unit), "{text}");
            }
        }
        for text in ["", "mg", "cm/s", "mm/s2", "g/10", "in/s2"] {
            assert_eq!(Unit::written(text), None, "{text}");
        }
    }
}
