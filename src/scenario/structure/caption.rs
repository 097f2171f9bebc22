//! The structure in the caption of a picture.

use super::Structure;
use crate::scenario::Quantity;

/// Four digits are enough to identify a value.
pub(crate) fn four_digits(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

impl Structure {
    /// What identifies it, except what `varies`: told by the quantities of a map, or by its key.
    pub(crate) fn caption(&self, varies: &dyn Fn(&[Quantity], &str) -> bool) -> String {
        let mut words = Vec::new();
        match self {
            Self::Arch(arch) => {
                if !varies(&[Quantity::MeanRadius], "arch.mean_radius_m") {
                    words.push(format!("R {} m", four_digits(arch.mean_radius_m())));
                }
                if !varies(&[Quantity::ThicknessRatio], "arch.thickness_ratio") {
                    words.push(format!("t/R {}", four_digits(arch.thickness_ratio())));
                }
                if !varies(&[Quantity::Embrace], "arch.embrace_deg") {
                    words.push(format!("{} degrees", four_digits(arch.embrace_deg())));
                }
                match arch.voussoirs() {
                    _ if varies(&[], "arch.voussoirs") => {}
                    Some(voussoirs) => words.push(format!("{voussoirs} voussoirs")),
                    None => words.push("hinges anywhere".to_owned()),
                }
                format!("arch: {}", words.join(", "))
            }
            Self::Column(column) => {
                if !varies(&[], "column.height_m") {
                    words.push(format!("{} m high", four_digits(column.height_m())));
                }
                if !varies(&[], "column.width_m") {
                    words.push(format!("{} m wide", four_digits(column.width_m())));
                }
                format!("column: {}", words.join(", "))
            }
            Self::Masonry(_) => "blocks".to_owned(),
        }
    }
}
