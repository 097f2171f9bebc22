//! A rigid block, and a joint between two of them.

use std::ops::Add;

use nalgebra::Vector2;

use super::geometry::curve::polygon;
use super::geometry::rigid::{MassMoments, mirrored};
use crate::mechanics::{Curve, Edge};

/// Rigid block in the undeformed row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    /// Mass in kg.
    pub mass_kg: f64,
    /// Centre of gravity in metres.
    pub centre_m: Vector2<f64>,
    /// Polar moment of inertia about the centre of gravity, in kg m2.
    pub inertia_kg_m2: f64,
}

impl Block {
    /// Prism with a simple polygon as outline, given by its corners (m) in order, clockwise or anticlockwise.
    pub fn prism(corners_m: &[Vector2<f64>], depth_m: f64, density_kg_m3: f64) -> Self {
        let pole = corners_m.first().copied().unwrap_or_else(Vector2::zeros);
        Self::bounded(polygon(corners_m), pole, depth_m, density_kg_m3)
    }

    /// Prism with a closed outline (m), clockwise or anticlockwise; `pole_m` is a point near it, which limits rounding errors.
    pub(crate) fn bounded(
        outline_m: impl IntoIterator<Item = Curve>,
        pole_m: Vector2<f64>,
        depth_m: f64,
        density_kg_m3: f64,
    ) -> Self {
        let swept = outline_m
            .into_iter()
            .map(|curve| curve.swept_moments(pole_m));
        let moments = swept.fold(MassMoments::default(), Add::add);
        let surface_kg_m2 = depth_m * density_kg_m3 * moments.mass.signum();
        let centre = moments.first / moments.mass;
        Self {
            mass_kg: moments.mass * surface_kg_m2,
            centre_m: pole_m + centre,
            inertia_kg_m2: (moments.polar - moments.mass * centre.norm_squared()) * surface_kg_m2,
        }
    }

    /// This block and another one combined as one rigid body.
    pub fn with(&self, other: &Self) -> Self {
        let mass_kg = self.mass_kg + other.mass_kg;
        let apart_m = other.centre_m - self.centre_m;
        Self {
            mass_kg,
            centre_m: self.centre_m + apart_m * (other.mass_kg / mass_kg),
            inertia_kg_m2: self.inertia_kg_m2
                + other.inertia_kg_m2
                + self.mass_kg * other.mass_kg / mass_kg * apart_m.norm_squared(),
        }
    }

    /// Mirror image about the y axis.
    pub fn mirrored(&self) -> Self {
        Self {
            centre_m: mirrored(self.centre_m),
            ..*self
        }
    }

    /// Mass, first and polar moment about the origin, for a centre of gravity at `centre_m`.
    pub fn moments_at(&self, centre_m: Vector2<f64>) -> MassMoments {
        MassMoments::of_body(self.mass_kg, centre_m, self.inertia_kg_m2)
    }
}

/// Closed joint of the undeformed row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint {
    /// Corner at the intrados in metres (of a stack: left).
    pub intrados_m: Vector2<f64>,
    /// Corner at the extrados in metres (of a stack: right).
    pub extrados_m: Vector2<f64>,
}

impl Joint {
    /// Distance of the corners in metres.
    pub fn thickness_m(&self) -> f64 {
        (self.extrados_m - self.intrados_m).norm()
    }

    /// Midpoint of the corners in metres.
    pub fn middle_m(&self) -> Vector2<f64> {
        (self.intrados_m + self.extrados_m) * 0.5
    }

    /// Unit vector from the intrados to the extrados.
    pub fn direction(&self) -> Vector2<f64> {
        (self.extrados_m - self.intrados_m) / self.thickness_m()
    }

    /// Corner on an edge, in metres.
    pub const fn corner_m(&self, edge: Edge) -> Vector2<f64> {
        [self.intrados_m, self.extrados_m][edge as usize]
    }

    /// Mirror image about the y axis.
    pub fn mirrored(&self) -> Self {
        Self {
            intrados_m: mirrored(self.intrados_m),
            extrados_m: mirrored(self.extrados_m),
        }
    }

    /// Corners of the quadrilateral between this joint and the next one, in order around it.
    pub const fn outline_m(&self, next: &Self) -> [Vector2<f64>; 4] {
        [
            self.intrados_m,
            self.extrados_m,
            next.extrados_m,
            next.intrados_m,
        ]
    }

    /// Whether two joints have a point in common.
    pub(super) fn meets(&self, other: &Self) -> bool {
        let side = |joint: &Self, point: Vector2<f64>| {
            (joint.extrados_m - joint.intrados_m).perp(&(point - joint.intrados_m))
        };
        let parted =
            |one: &Self, two: &Self| side(one, two.intrados_m) * side(one, two.extrados_m) > 0.0;
        !(parted(self, other) || parted(other, self))
    }
}
