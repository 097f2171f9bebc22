//! Loads at points of a structure: a roof, a floor, or the thrust of a vault.
//!
//! A load has a mass, a horizontal thrust, or both. The mass is fixed to the block that carries it, or only its weight acts on the block. This weight
//! and the thrust are constant forces: they keep size and direction while their point moves, and the ground motion does not accelerate them.
//!
//! A live load is no part of the structure: limit analysis computes the factor on it at which the structure collapses.

use nalgebra::Vector2;
use serde::Serialize;

use super::arch::MAGNITUDE;
use super::block::Block;
use crate::argument::{ArgumentError, require, require_within};
use crate::mechanics::Sway;

/// Load at a point, or a mass distributed uniformly over a width of an arch.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PlacedLoad {
    /// The mass in kg; zero for a thrust alone.
    pub mass_kg: f64,
    /// Distance to the right of the middle of the span, or of the axis of a column or pier, in metres; for a patch, of its middle.
    pub x_m: f64,
    /// Width of the patch, in metres; zero for a point.
    #[serde(skip_serializing_if = "is_zero")]
    pub width_m: f64,
    /// Pier that carries the load; `None` for a column, or the extrados of an arch.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pier: Option<Sway>,
    /// Height above the base of a column or pier, in metres; `None` for its top, and on the extrados.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub height_m: Option<f64>,
    /// True if the mass moves with the block that carries it; false if its weight is a constant force, without inertia.
    #[serde(skip_serializing_if = "is_true")]
    pub moves: bool,
    /// True for a live load, whose multiple at collapse limit analysis computes.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub live: bool,
    /// Constant horizontal force, in N, positive to the right.
    #[serde(skip_serializing_if = "is_zero")]
    pub thrust_n: f64,
}

/// Floor on a wall that holds its top sideways, and rises with it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HeldTop {
    /// Weight of the floor on the wall, in N, without inertia.
    pub weight_n: f64,
    /// Distance of the weight from the axis, to the right, in metres.
    pub x_m: f64,
}

fn is_zero(x: &f64) -> bool {
    *x == 0.0
}

pub(super) const fn is_true(moves: &bool) -> bool {
    *moves
}

impl Default for PlacedLoad {
    /// Load of zero mass on the axis, at the top of a column.
    fn default() -> Self {
        Self {
            mass_kg: 0.0,
            x_m: 0.0,
            width_m: 0.0,
            pier: None,
            height_m: None,
            moves: true,
            live: false,
            thrust_n: 0.0,
        }
    }
}

/// Weight on a block of a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weight {
    /// Index of the block.
    pub block: usize,
    /// Weight over gravity, in kg.
    pub mass_kg: f64,
    /// Line of action, in metres to the right.
    pub x_m: f64,
}

/// Largest thrust, in N.
pub const LARGEST_THRUST_N: f64 = 1e15;

impl PlacedLoad {
    /// Mass at a distance to the right of the middle.
    pub fn mass(mass_kg: f64, x_m: f64) -> Self {
        Self {
            mass_kg,
            x_m,
            ..Self::default()
        }
    }

    fn check_numbers(&self, least_kg: f64) -> Result<(), ArgumentError> {
        let thrusts_n = -LARGEST_THRUST_N..=LARGEST_THRUST_N;
        require_within("mass_kg", self.mass_kg, least_kg..=1e15)?;
        require_within("x_m", self.x_m, -1e6..=1e6)?;
        require_within("thrust_n", self.thrust_n, thrusts_n).map(drop)
    }

    /// Checks the numbers of a load on a column of this height.
    pub(super) fn check_on_column(&self, column_height_m: f64) -> Result<(), ArgumentError> {
        self.check_numbers(0.0)?;
        let at_a_point = "0: a load on a column acts at a point";
        require(self.width_m == 0.0, "width_m", self.width_m, at_a_point)?;
        let height_m = self.height_m.unwrap_or(0.0);
        let allowed = format_args!("from 0 to the height of the column, {column_height_m:?} m");
        let fits = (0.0..=column_height_m).contains(&height_m);
        require(fits, "height_m", height_m, allowed).map(|_| ())
    }

    /// Checks the numbers of a load on an arch.
    pub(super) fn check_on_arch(&self) -> Result<(), ArgumentError> {
        let least_kg = if self.thrust_n == 0.0 { 1e-6 } else { 0.0 };
        self.check_numbers(least_kg)?;
        if self.width_m != 0.0 {
            require_within("width_m", self.width_m, MAGNITUDE)?;
            let is_spread = self.moves && self.thrust_n == 0.0 && self.pier.is_none();
            let at_a_point =
                "0: only masses on the extrados that move are spread; other loads act at a point";
            require(is_spread, "width_m", self.width_m, at_a_point)?;
        }
        Ok(())
    }

    /// Mass that moves with the block, in kg.
    pub const fn moving_mass_kg(&self) -> f64 {
        if self.moves && !self.live {
            self.mass_kg
        } else {
            0.0
        }
    }

    /// Constant force, in N.
    pub fn constant_force_n(&self, gravity_m_s2: f64) -> Vector2<f64> {
        let still_kg = if self.moves || self.live {
            0.0
        } else {
            self.mass_kg
        };
        Vector2::new(self.thrust_n, -still_kg * gravity_m_s2)
    }

    /// Moving mass as a body at a point in metres; `None` without such a mass.
    pub(super) fn moving_body(&self, at_m: Vector2<f64>) -> Option<Block> {
        let mass_kg = self.moving_mass_kg();
        (mass_kg > 0.0).then_some(Block {
            mass_kg,
            centre_m: at_m,
            inertia_kg_m2: 0.0,
        })
    }
}
