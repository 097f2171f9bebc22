//! A rigid body given by its numbers, such as a statue, a machine or a boulder, which stands on two toes.

use std::ops::RangeInclusive;

use nalgebra::Vector2;
use serde::Serialize;

use super::block::Block;
use crate::argument::{ArgumentError, require, require_within};

/// Range of sizes in metres, of masses in kg, and of inertias and densities in SI units; their products stay in the range of an `f64`.
pub(super) const MAGNITUDE: RangeInclusive<f64> = 1e-9..=1e12;

/// A rigid body that stands on two toes on flat ground. Positions are measured from any point of the ground.
///
/// ```
/// # use archrock_motion::mechanics::{Column, GivenBody};
/// // A statue of 1.2 t, whose centre is 0.05 m right of the middle of its base.
/// let statue = GivenBody { mass_kg: 1200.0, inertia_kg_m2: 500.0, centre_m: [0.05, 0.9].into(), toes_x_m: [-0.4, 0.4] };
/// let column = Column::of_body(statue)?;
/// assert_eq!(column.width_m, 0.8);
/// # Ok::<(), archrock_motion::argument::ArgumentError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct GivenBody {
    /// Mass in kg.
    pub mass_kg: f64,
    /// Moment of inertia about the centre of gravity, in kg m2.
    pub inertia_kg_m2: f64,
    /// Centre of gravity in metres, to the right and upwards.
    pub centre_m: Vector2<f64>,
    /// Left and right toe, in metres to the right.
    pub toes_x_m: [f64; 2],
}

impl GivenBody {
    /// Checks that the numbers are those of a body that stands.
    ///
    /// # Errors
    /// When mass, inertia, height or base is outside 1e-9 to 1e12, or the centre of gravity is not between the toes.
    pub(super) fn check(&self) -> Result<(), ArgumentError> {
        require_within("mass_kg", self.mass_kg, MAGNITUDE)?;
        require_within("inertia_kg_m2", self.inertia_kg_m2, MAGNITUDE)?;
        require_within("centre_m", self.centre_m.y, MAGNITUDE)?;
        let [left, right] = self.toes_x_m;
        require_within("toes_x_m", right - left, MAGNITUDE)?;
        let x_m = self.centre_m.x;
        let allowed =
            format_args!("between the toes, at {left:?} and {right:?} m: it falls by itself");
        require(left < x_m && x_m < right, "centre_m", x_m, allowed).map(|_| ())
    }

    /// Middle between the toes, in metres to the right.
    pub(super) fn middle_m(&self) -> f64 {
        0.5 * (self.toes_x_m[0] + self.toes_x_m[1])
    }

    /// The body, with its centre from the middle between the toes.
    pub(super) fn block(&self) -> Block {
        Block {
            mass_kg: self.mass_kg,
            centre_m: self.centre_m - Vector2::new(self.middle_m(), 0.0),
            inertia_kg_m2: self.inertia_kg_m2,
        }
    }
}
