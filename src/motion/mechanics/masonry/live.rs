//! Live loads of an arch: weights on its extrados, and a vehicle that crosses it. They have no inertia.

use serde::Serialize;

use super::cut::CutArch;
use super::{MAGNITUDE, Masonry, MasonryError};
use crate::argument::{ArgumentError, require_count, require_within};
use crate::mechanics::load::Weight;
use crate::mechanics::{PlacedLoad, Supports, Sway};

/// Largest number of axles of a vehicle.
pub const MAX_AXLES: usize = 20;
/// Tolerance over the length of the arch: a load at this distance from a joint stands on it, and a patch of this width is a point.
const ON_JOINT: f64 = 1e-9;
/// Largest number of loads on joints for which all combinations of sides are tried.
const MOST_ON_JOINTS: usize = 8;

named! {
    /// Spreading of axles through the fill.
    pub enum Spread {
        /// Each axle acts at a point of the extrados.
        None = "none",
        /// Each axle spreads by 1 horizontally for 2 vertically to both sides, from the top of the fill down to the extrados below the axle.
        TwoToOne = "2:1",
    }
}

/// Vehicle that crosses an arch.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Vehicle {
    /// Loads of the axles from the front one on, in kg.
    pub axles_kg: Vec<f64>,
    /// Distances of neighbouring axles, in metres.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub spacing_m: Vec<f64>,
    /// Spreading through the fill.
    pub spread: Spread,
}

impl Vehicle {
    fn check(&self) -> Result<(), ArgumentError> {
        require_count("axles_kg", self.axles_kg.len(), 1..=MAX_AXLES)?;
        let spacings = self.axles_kg.len() - 1;
        require_count("spacing_m", self.spacing_m.len(), spacings..=spacings)?;
        for axle_kg in &self.axles_kg {
            require_within("axles_kg", *axle_kg, MAGNITUDE)?;
        }
        for spacing_m in &self.spacing_m {
            require_within("spacing_m", *spacing_m, 1e-3..=1e6)?;
        }
        Ok(())
    }

    /// Distance of each axle from the front one, in metres.
    pub fn distances_m(&self) -> impl Iterator<Item = f64> {
        let spacings = [0.0].iter().chain(&self.spacing_m);
        spacings.scan(0.0, |behind_m, spacing_m| {
            *behind_m += spacing_m;
            Some(*behind_m)
        })
    }
}

/// Extrados of masonry under live loads.
#[derive(Clone, Debug)]
pub struct LoadedExtrados {
    arch: CutArch,
    /// Index of the first voussoir.
    first: usize,
    /// Height of the top of the fill, in metres; `None` without fill.
    fill_top_m: Option<f64>,
}

impl Masonry {
    /// This masonry with a vehicle that crosses it.
    ///
    /// # Errors
    /// If a number of the vehicle is not allowed, or it spreads through fill that is not there.
    pub fn with_vehicle(mut self, vehicle: Vehicle) -> Result<Self, MasonryError> {
        vehicle.check().map_err(MasonryError::Vehicle)?;
        let [from_m, to_m] = self.shape.cut()?.ends_m();
        if self.row.supports != Supports::Both || from_m >= to_m {
            return Err(MasonryError::NoRoad);
        }
        if vehicle.spread == Spread::TwoToOne && self.fill.is_none() {
            return Err(MasonryError::NoFill);
        }
        self.vehicle = Some(vehicle);
        Ok(self)
    }

    /// Whether live loads or a vehicle act on it. Only limit analysis computes them.
    pub fn has_live_loads(&self) -> bool {
        self.vehicle.is_some() || self.loads.iter().any(|load| load.live)
    }

    /// Extrados, to place live loads on it.
    ///
    /// # Errors
    /// Those of [`Masonry::new`].
    pub fn loaded_extrados(&self) -> Result<LoadedExtrados, MasonryError> {
        let arch = self.shape.cut()?;
        let fill_top_m = self.fill.map(|fill| fill.level_m(&arch)).transpose();
        Ok(LoadedExtrados {
            fill_top_m: fill_top_m.map_err(MasonryError::Fill)?,
            arch,
            first: self.piers.left.map_or(0, |pier| pier.blocks),
        })
    }
}

impl LoadedExtrados {
    /// Ends of the joints on the extrados, in metres to the right.
    pub fn joints_m(&self) -> Vec<f64> {
        let joints = self.arch.joints().into_iter();
        joints.map(|joint| joint.extrados_m.x).collect()
    }

    /// All combinations of these loads in which each point load on a joint stands on one side of it. Of more than eight such loads, all stand on the
    /// left side or all on the right one.
    pub fn beside_joints(&self, loads: &[PlacedLoad]) -> Vec<Vec<PlacedLoad>> {
        let joints_m = self.joints_m();
        let near_m = ON_JOINT * (joints_m[joints_m.len() - 1] - joints_m[0]);
        let is_on_joint = |load: &PlacedLoad| {
            let mut joints = joints_m.iter();
            load.live && load.width_m == 0.0 && joints.any(|x_m| (load.x_m - x_m).abs() < near_m)
        };
        let on_joints = loads
            .iter()
            .enumerate()
            .filter(|(_, load)| is_on_joint(load));
        let on_joints: Vec<usize> = on_joints.map(|(index, _)| index).collect();
        let combinations: Vec<usize> = match on_joints.len() {
            count if count <= MOST_ON_JOINTS => (0..1 << count).collect(),
            _ => vec![0, usize::MAX],
        };
        let placed = combinations.into_iter().map(|sides| {
            let mut loads = loads.to_vec();
            for (bit, index) in (0_u32..).zip(&on_joints) {
                let is_left = sides.checked_shr(bit).unwrap_or(sides) & 1 == 0;
                let side = if is_left { -1.0 } else { 1.0 };
                loads[*index].x_m += 2.0 * side * near_m;
            }
            loads
        });
        placed.collect()
    }

    /// Live loads as weights on the blocks of the row. Parts beyond the ends of the arch are left out.
    pub fn weights(&self, loads: &[PlacedLoad]) -> Vec<Weight> {
        let live = loads.iter().filter(|load| load.live);
        let bodies = live.flat_map(|load| {
            let mut bodies = load.bodies(&self.arch);
            // Slivers of a patch are rounding errors.
            bodies.retain(|(_, body)| body.mass_kg > ON_JOINT * load.mass_kg);
            bodies
        });
        let weights = bodies.map(|(voussoir, body)| Weight {
            block: self.first + voussoir,
            mass_kg: body.mass_kg,
            x_m: body.centre_m.x,
        });
        weights.collect()
    }

    /// Axles of a vehicle as live loads; its front axle is at `x_m`, and it drives to a side.
    pub fn axles(&self, vehicle: &Vehicle, x_m: f64, towards: Sway) -> Vec<PlacedLoad> {
        let axles = vehicle.axles_kg.iter().zip(vehicle.distances_m());
        let axles = axles.map(|(axle_kg, behind_m)| {
            let x_m = x_m - towards.sign() * behind_m;
            PlacedLoad {
                live: true,
                width_m: self.width_m(vehicle.spread, x_m),
                ..PlacedLoad::mass(*axle_kg, x_m)
            }
        });
        axles.collect()
    }

    /// Width over which an axle spreads, in metres. An axle beyond the arch spreads as at its end.
    fn width_m(&self, spread: Spread, x_m: f64) -> f64 {
        let [from_m, to_m] = self.arch.ends_m();
        let below = PlacedLoad::mass(1.0, x_m.clamp(from_m, to_m)).place_m(&self.arch);
        match (spread, below, self.fill_top_m) {
            (Spread::TwoToOne, Some((_, below_m)), Some(top_m)) => {
                let deep_m = top_m - below_m.y;
                if deep_m > ON_JOINT * (to_m - from_m) {
                    deep_m
                } else {
                    0.0
                }
            }
            _ => 0.0,
        }
    }
}
