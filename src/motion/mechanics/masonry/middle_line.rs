//! Arches of constant thickness about a smooth middle line: circular, elliptic, and with three centres.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::Vector2;
use serde::Serialize;

use super::cut::{CutArch, EdgePosition};
use super::{Dimensions, Material};
use crate::argument::{ArgumentError, require, require_above};
use crate::mechanics::{Arch, Curve};

/// Cuts the area within half a thickness of a middle line, from left to right, at given lengths along this line.
fn cut(middle: &[Curve], thickness_m: f64, at_m: &[f64]) -> CutArch {
    let edge = |offset_m: f64| {
        let mut edge = middle.to_vec();
        for piece in &mut edge {
            match piece {
                Curve::Arc { radius, .. } => *radius += offset_m,
                Curve::Ellipse { offset, .. } => *offset += offset_m,
                Curve::Line { .. } => {}
            }
        }
        edge
    };
    let lengths: Vec<f64> = middle.iter().map(Curve::length).collect();
    let place = |at_m: &f64| {
        let (mut left_m, mut piece) = (*at_m, 0);
        while piece + 1 < middle.len() && left_m > lengths[piece] {
            left_m -= lengths[piece];
            piece += 1;
        }
        let part = if left_m >= lengths[piece] {
            1.0
        } else {
            middle[piece].part_at(left_m.max(0.0))
        };
        [EdgePosition { piece, part }; 2]
    };
    CutArch {
        intrados: edge(-0.5 * thickness_m),
        extrados: edge(0.5 * thickness_m),
        joints: at_m.iter().map(place).collect(),
    }
}

/// Cuts at equal lengths of the middle line.
fn cut_equally(middle: &[Curve], dimensions: &Dimensions) -> CutArch {
    let whole_m: f64 = middle.iter().map(Curve::length).sum();
    let at_m = |joint| whole_m * part(joint, dimensions.voussoirs);
    let joints_m: Vec<f64> = (0..=dimensions.voussoirs).map(at_m).collect();
    cut(middle, dimensions.thickness_m, &joints_m)
}

pub(super) fn part(index: usize, count: usize) -> f64 {
    index as f64 / count as f64
}

/// A circular arch, of equal voussoirs or with joints at given angles.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CircularArch {
    /// Ring of the arch.
    #[serde(flatten)]
    pub arch: Arch,
    /// Angles of its joints from the left springing, in degrees, both springings included; `None` for equal voussoirs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub joints_deg: Option<Vec<f64>>,
}

impl CircularArch {
    /// Arch with its equal voussoirs, or with joints at these angles.
    ///
    /// # Errors
    /// If it has neither, or both, or if the angles do not increase from zero to the embrace angle.
    pub fn new(arch: Arch, joints_deg: Option<Vec<f64>>) -> Result<Self, ArgumentError> {
        let allowed = "given, or else `joints_deg`, for a row of blocks";
        let is_given_once = joints_deg.is_some() != arch.voussoirs.is_some();
        require(is_given_once, "voussoirs", 0.0, allowed)?;
        if let Some(joints_deg) = &joints_deg {
            let (name, embrace_deg) = ("joints_deg", arch.embrace_deg);
            let count = joints_deg.len();
            require(count >= 2, name, f64::NAN, "at least the two springings")?;
            let (first, last) = (joints_deg[0], joints_deg[count - 1]);
            require(first == 0.0, name, first, "0 first, the left springing")?;
            let right = format_args!("{embrace_deg:?} last, the right springing");
            require(last == embrace_deg, name, last, right)?;
            for pair in joints_deg.windows(2) {
                let above = format_args!("above the one before, {:?}", pair[0]);
                require(pair[0] < pair[1], name, pair[1], above)?;
            }
        }
        Ok(Self { arch, joints_deg })
    }

    pub(super) fn material(&self) -> Material {
        Material {
            depth_m: self.arch.depth_m,
            density_kg_m3: self.arch.density_kg_m3,
        }
    }

    pub(super) fn cut(&self) -> CutArch {
        let (radius, embrace_rad) = (self.arch.mean_radius_m, self.arch.embrace_deg.to_radians());
        let middle = Curve::Arc {
            centre: Vector2::zeros(),
            radius,
            angles_rad: [0.5, -0.5].map(|part| FRAC_PI_2 + part * embrace_rad),
        };
        let at_m = match (&self.joints_deg, self.arch.voussoirs) {
            (Some(joints_deg), _) => {
                let joints_rad = joints_deg.iter().map(|deg| deg.to_radians());
                joints_rad.map(|angle_rad| angle_rad * radius).collect()
            }
            (None, voussoirs) => {
                let voussoirs = voussoirs.unwrap_or(1);
                let at = |joint| embrace_rad * radius * part(joint, voussoirs);
                (0..=voussoirs).map(at).collect::<Vec<_>>()
            }
        };
        cut(&[middle], self.arch.thickness_ratio * radius, &at_m)
    }
}

/// Cuts an arch with half an ellipse as middle line into voussoirs of equal length along this line.
pub(super) fn cut_elliptic(dimensions: &Dimensions) -> Result<CutArch, ArgumentError> {
    dimensions.check()?;
    let (half_m, rise_m) = (0.5 * dimensions.span_m, dimensions.rise_m);
    let (longer_m, shorter_m) = (half_m.max(rise_m), half_m.min(rise_m));
    dimensions.check_curvature(shorter_m * shorter_m / longer_m)?;
    let middle = Curve::Ellipse {
        semi_axes: Vector2::new(half_m, rise_m),
        offset: 0.0,
        angles_rad: [PI, 0.0],
    };
    Ok(cut_equally(&[middle], dimensions))
}

/// Arch with a middle line of three arcs that join smoothly (basket handle). The outer arcs are vertical at the springings. Its voussoirs have equal
/// lengths along the middle line.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BasketArch {
    /// Span, rise, thickness, voussoirs and material.
    #[serde(flatten)]
    pub dimensions: Dimensions,
    /// Angle of the arc at the crown, in degrees; the classical construction has three arcs of 60 degrees.
    pub crown_deg: f64,
}

impl BasketArch {
    /// The crown angle of the classical construction, in degrees.
    pub const CROWN_DEG: f64 = 60.0;

    /// Cuts the arch. Let `a` be half the span, `f` the rise and `c` half the angle at the crown. The centre of an outer arc is at distance `e` from
    /// the middle, and that of the crown `e / tan c` below, with `a - f = e (1 - tan(c/2))`.
    pub(super) fn cut(&self) -> Result<CutArch, ArgumentError> {
        let dimensions = &self.dimensions;
        dimensions.check()?;
        require_above("crown_deg", self.crown_deg, 0.0, 179.0)?;
        let half_rad = 0.5 * self.crown_deg.to_radians();
        let (half_m, rise_m) = (0.5 * dimensions.span_m, dimensions.rise_m);
        let aside_m = (half_m - rise_m) / (1.0 - libm::tan(0.5 * half_rad));
        let outer_m = half_m - aside_m;
        let allowed = format_args!(
            "above {:.6} and at most {half_m:?}, half the span, for three arcs with {:?} degrees at the crown",
            half_m * libm::tan(0.5 * half_rad),
            self.crown_deg
        );
        require(aside_m >= 0.0 && outer_m > 0.0, "rise_m", rise_m, allowed)?;
        dimensions.check_curvature(outer_m)?;
        let crown = Curve::Arc {
            centre: Vector2::new(0.0, -aside_m / libm::tan(half_rad)),
            radius: outer_m + aside_m / libm::sin(half_rad),
            angles_rad: [FRAC_PI_2 + half_rad, FRAC_PI_2 - half_rad],
        };
        let left = Curve::Arc {
            centre: Vector2::new(-aside_m, 0.0),
            radius: outer_m,
            angles_rad: [PI, FRAC_PI_2 + half_rad],
        };
        Ok(cut_equally(&[left, crown, left.mirrored()], dimensions))
    }
}
