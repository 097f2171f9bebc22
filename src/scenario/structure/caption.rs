//! The structure in the caption of a picture.

use super::Structure;
use crate::scenario::Quantity;

/// Four digits are enough to identify a value.
pub(crate) fn four_digits(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

fn voussoirs(count: Option<usize>) -> String {
    count.map_or_else(
        || "hinges anywhere".to_owned(),
        |count| format!("{count} voussoirs"),
    )
}

impl Structure {
    /// What identifies it, except what `varies`: told by the quantities of a map, or by its key.
    pub(crate) fn caption(&self, varies: &dyn Fn(&[Quantity], &str) -> bool) -> String {
        let mut words = Vec::new();
        match self {
            Self::Arch(arch) => {
                let shape = [
                    (Quantity::MeanRadius, "arch.mean_radius_m"),
                    (Quantity::ThicknessRatio, "arch.thickness_ratio"),
                    (Quantity::Embrace, "arch.embrace_deg"),
                ];
                let varies_shape = shape
                    .iter()
                    .any(|(quantity, key)| varies(&[*quantity], key))
                    || ["arch.span_m", "arch.rise_m", "arch.thickness_m"]
                        .iter()
                        .any(|key| varies(&[], key));
                if let Some(line) = arch.measured_at().filter(|_| !varies_shape) {
                    let [span_m, rise_m] = arch.span_and_rise_m(line).map(four_digits);
                    let thick_m = four_digits(arch.mean_radius_m() * arch.thickness_ratio());
                    let at = line.in_words();
                    words.push(format!(
                        "span {span_m} m, rise {rise_m} m {at}, {thick_m} m thick"
                    ));
                    if !varies(&[], "arch.voussoirs") {
                        words.push(voussoirs(arch.voussoirs()));
                    }
                    return format!("arch: {}", words.join(", "));
                }
                if !varies(&[Quantity::MeanRadius], "arch.mean_radius_m") {
                    words.push(format!("R {} m", four_digits(arch.mean_radius_m())));
                }
                if !varies(&[Quantity::ThicknessRatio], "arch.thickness_ratio") {
                    words.push(format!("t/R {}", four_digits(arch.thickness_ratio())));
                }
                if !varies(&[Quantity::Embrace], "arch.embrace_deg") {
                    words.push(format!("{} degrees", four_digits(arch.embrace_deg())));
                }
                if !varies(&[], "arch.voussoirs") {
                    words.push(voussoirs(arch.voussoirs()));
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
