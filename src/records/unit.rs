//! Units of recorded accelerations and velocities.

use archrock_text::{ensure, excerpt};

named! {
    /// The quantity that the samples of a record measure.
    #[derive(Default)]
    pub enum RecordedQuantity {
        /// Accelerations, joined by straight lines.
        #[default]
        Acceleration = "acceleration",
        /// Velocities, joined by straight lines: the acceleration is constant between samples.
        Velocity = "velocity",
    }
}

named! {
    /// Unit of the samples in a file.
    #[derive(Default)]
    pub enum Unit {
        #[default]
        /// Gravity of the simulation.
        Gravity = "g",
        /// Metres per second squared.
        MetrePerS2 = "m/s2",
        /// Centimetres per second squared, gal.
        CentimetrePerS2 = "cm/s2",
        /// Millimetres per second squared.
        MillimetrePerS2 = "mm/s2",
        /// Thousandths of the gravity of the simulation.
        MilliGravity = "mg",
        /// Tenths of the gravity of the simulation.
        TenthGravity = "g/10",
        /// Inches per second squared, of 0.0254 m.
        InchPerS2 = "in/s2",
        /// Feet per second squared, of 0.3048 m.
        FootPerS2 = "ft/s2",
        /// Metres per second.
        MetrePerS = "m/s",
        /// Centimetres per second.
        CentimetrePerS = "cm/s",
        /// Millimetres per second.
        MillimetrePerS = "mm/s",
    }
}

impl Unit {
    /// Returns the quantity that the unit measures.
    pub const fn quantity(self) -> RecordedQuantity {
        match self {
            Self::MetrePerS | Self::CentimetrePerS | Self::MillimetrePerS => {
                RecordedQuantity::Velocity
            }
            _ => RecordedQuantity::Acceleration,
        }
    }

    /// Returns the unit in m/s2, or m/s.
    pub const fn in_si(self, gravity_m_s2: f64) -> f64 {
        match self {
            Self::Gravity => gravity_m_s2,
            Self::MetrePerS2 | Self::MetrePerS => 1.0,
            Self::CentimetrePerS2 | Self::CentimetrePerS => 0.01,
            Self::MillimetrePerS2 | Self::MillimetrePerS => 0.001,
            Self::MilliGravity => 0.001 * gravity_m_s2,
            Self::TenthGravity => 0.1 * gravity_m_s2,
            Self::InchPerS2 => 0.0254,
            Self::FootPerS2 => 0.3048,
        }
    }

    /// Returns the message that the unit belongs to the other quantity, with the remedy.
    pub const fn other_quantity(self) -> &'static str {
        match self.quantity() {
            RecordedQuantity::Velocity => {
                "a unit of velocity; give `quantity = \"velocity\"` if the record is one of velocities"
            }
            RecordedQuantity::Acceleration => {
                "a unit of acceleration; leave out `quantity = \"velocity\"` if the record is one of accelerations"
            }
        }
    }

    /// Returns the unit in a header, which must be a unit of this quantity. `remedy` is for unknown units.
    pub(crate) fn of_header(
        text: &str,
        quantity: RecordedQuantity,
        remedy: &str,
    ) -> Result<Self, String> {
        let wrong = match Self::written(text) {
            Some(unit) if unit.quantity() == quantity => return Ok(unit),
            Some(unit) => format!(", {}", unit.other_quantity()),
            None => format!("; {remedy}"),
        };
        let text = excerpt(text.trim_end_matches('.'));
        Err(format!("the unit is {text}{wrong}"))
    }

    /// Checks the unit in the name of a column, as in `acc (g)` or `acc_gal`. Returns true if it is this unit, and false if there is none.
    ///
    /// # Errors
    /// When it is another unit.
    pub(crate) fn check_name(self, name: &str) -> Result<bool, String> {
        let bracket = name
            .strip_suffix([')', ']'])
            .and_then(|name| name.rsplit(['(', '[']).next());
        let last = name.rsplit([' ', '_', ',']).next();
        let given = bracket.or(last).unwrap_or_default();
        let written = Self::written(given);
        let is_other = match written {
            Some(unit) => unit != self,
            // A unit without a name in scenarios.
            None => given.eq_ignore_ascii_case("%g"),
        };
        ensure(!is_other, || {
            let [name, given] = [name, given].map(excerpt);
            let own = self.name();
            format!(
                "the column is named `{name}`, but `unit` is {own:?}: give `unit` as {given}, or correct the name"
            )
        })?;
        Ok(written == Some(self))
    }

    /// Parses one of the spellings in files: `cm/s^2`, `CM/SEC/SEC`, `gal`, `g.`.
    pub fn written(text: &str) -> Option<Self> {
        let text = text.trim_end_matches('.');
        let plain = text.replace(|c: char| c.is_whitespace() || "^*()[]".contains(c), "");
        match plain.to_ascii_lowercase().replace("sec", "s").as_str() {
            "g" => Some(Self::Gravity),
            "m/s2" | "m/s/s" => Some(Self::MetrePerS2),
            "cm/s2" | "cm/s/s" | "cms/s/s" | "gal" | "gals" => Some(Self::CentimetrePerS2),
            "mm/s2" | "mm/s/s" => Some(Self::MillimetrePerS2),
            "mg" => Some(Self::MilliGravity),
            "g/10" => Some(Self::TenthGravity),
            "in/s2" | "in/s/s" => Some(Self::InchPerS2),
            "ft/s2" | "ft/s/s" => Some(Self::FootPerS2),
            "m/s" => Some(Self::MetrePerS),
            "cm/s" | "cms/s" => Some(Self::CentimetrePerS),
            "mm/s" => Some(Self::MillimetrePerS),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_read_as_files_write_them() {
        for (unit, texts) in [
            (Unit::Gravity, &["g", "G", " g ", "g."][..]),
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
                    "CMS/SEC/SEC",
                ],
            ),
            (
                Unit::MillimetrePerS2,
                &["mm/s2", "mm/s/s", "MM/SEC^2", "(mm/s^2)"],
            ),
            (Unit::MilliGravity, &["mg", "MG", "(mg)"]),
            (Unit::TenthGravity, &["g/10", "G/10.", "(g/10)"]),
            (Unit::InchPerS2, &["in/s2", "IN/SEC/SEC", "in/s^2"]),
            (Unit::FootPerS2, &["ft/s2", "FT/SEC2", "ft/s/s"]),
            (Unit::MetrePerS, &["m/s", "M/SEC"]),
            (
                Unit::CentimetrePerS,
                &["cm/s", "CM/SEC", "(cm/s)", "CMS/SEC"],
            ),
            (Unit::MillimetrePerS, &["mm/s", "MM/SEC"]),
        ] {
            for text in texts {
                assert_eq!(Unit::written(text), Some(unit), "{text}");
            }
        }
        for text in ["", ".", "cm", "mm", "in", "%g", "in/s", "g/5", "counts"] {
            assert_eq!(Unit::written(text), None, "{text}");
        }
    }

    /// One g of 9.80665 m/s2 in every unit: 386.0886 in/s2 and 32.17405 ft/s2.
    #[test]
    fn a_standard_gravity_is_the_same_in_all_units() {
        for (unit, gravity) in [
            (Unit::Gravity, 1.0),
            (Unit::MetrePerS2, 9.80665),
            (Unit::CentimetrePerS2, 980.665),
            (Unit::MillimetrePerS2, 9806.65),
            (Unit::MilliGravity, 1000.0),
            (Unit::TenthGravity, 10.0),
            (Unit::InchPerS2, 386.088_583),
            (Unit::FootPerS2, 32.174_048_6),
        ] {
            let gravity_m_s2 = gravity * unit.in_si(9.80665);
            assert!((gravity_m_s2 / 9.80665 - 1.0).abs() < 2e-9, "{unit:?}");
            assert_eq!(unit.quantity(), RecordedQuantity::Acceleration);
        }
    }
}
