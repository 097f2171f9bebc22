//! The pointed arch: two arcs about centres on the line of the springings, which meet at the crown.

use std::f64::consts::PI;

use nalgebra::Vector2;

use super::Dimensions;
use super::cut::{CutArch, EdgePosition};
use super::middle_line::part;
use crate::argument::{ArgumentError, require};
use crate::mechanics::Curve;

/// Cuts a pointed arch. Its joints point at the centres and divide the intrados into equal lengths. An even number of voussoirs has a vertical joint
/// at the crown, an odd number has a keystone.
///
/// The radius of the middle line is `r = rise^2 / span + span / 4`; with a rise of half the span it is a semicircle.
pub(super) fn cut_pointed(dimensions: &Dimensions) -> Result<CutArch, ArgumentError> {
    dimensions.check()?;
    let (span_m, rise_m) = (dimensions.span_m, dimensions.rise_m);
    let thickness_m = dimensions.thickness_m;
    let least_m = 0.5 * span_m;
    let allowed = format_args!(
        "at least half the span, {least_m:?}; lower arches are segments of a circle, elliptic or of three centres"
    );
    require(rise_m >= least_m, "rise_m", rise_m, allowed)?;
    let radius_m = rise_m * rise_m / span_m + 0.25 * span_m;
    // The centre of the left arc is right of the middle.
    let centre = Vector2::new(radius_m - 0.5 * span_m, 0.0);
    let inner_m = radius_m - 0.5 * thickness_m;
    let allowed = format_args!("below the span of {span_m:?}");
    require(inner_m > centre.x, "thickness_m", thickness_m, allowed)?;
    let arc = |radius: f64| Curve::Arc {
        centre,
        radius,
        // The arc ends at the middle.
        angles_rad: [PI, libm::acos(-centre.x / radius)],
    };
    let halves = |radius: f64| vec![arc(radius), arc(radius).mirrored()];
    let outer_m = inner_m + thickness_m;
    // Fraction of the extrados opposite the intrados; the rest extends to the crown.
    let angle = |radius: f64| PI - libm::acos(-centre.x / radius);
    let shorter = angle(inner_m) / angle(outer_m);
    let joint = |joint: usize| {
        // Twice the fraction of the path, so that the crown is at 1.
        let way = 2.0 * part(joint, dimensions.voussoirs);
        let (piece, part) = if way <= 1.0 { (0, way) } else { (1, way - 1.0) };
        let outer = match piece {
            _ if way == 1.0 => 1.0,
            0 => part * shorter,
            _ => 1.0 - (1.0 - part) * shorter,
        };
        [
            EdgePosition { piece, part },
            EdgePosition { piece, part: outer },
        ]
    };
    Ok(CutArch {
        intrados: halves(inner_m),
        extrados: halves(outer_m),
        joints: (0..=dimensions.voussoirs).map(joint).collect(),
    })
}
