//! The free-standing column of Housner (1963): a rigid block that rocks about the toes of its base.
//!
//! A column of height `2h` and width `2b` has the half diagonal `R = sqrt(b^2 + h^2)`, the unit of length
//! here, and the slenderness `alpha = atan(b / h)`. Swaying right it turns clockwise by `q` about its right
//! toe, and with `m` its mass
//!
//! `4/3 m R^2 q'' + m g R sin(alpha - q) + m a_g R cos(alpha - q) = 0`,
//!
//! so that a push of `tan(alpha)` times gravity starts it, `q = alpha` is its unstable equilibrium, and at
//! `q = pi/2` it lies on its side. With `p^2 = 3 g / (4 R)` the slender column obeys
//! `q'' = p^2 (q - alpha) - p^2 a_g / g`.
//!
//! At an impact it passes from one toe to the other. Only one mechanism can follow, so the models that
//! search for it ([`ImpactModel::MaxRestitution`], [`ImpactModel::SameSections`],
//! [`ImpactModel::Mirrored`]) all reduce to Housner's.
//!
//! With a wall behind it (see [`BackWall`]) it turns about one toe only, and every impact leads to the same mechanism.
//!
//! With loads it is a general rigid body, under constant forces; see [`Tilting`].

use std::f64::consts::FRAC_PI_2;

use nalgebra::Vector2;
use serde::Serialize;
use thiserror::Error;

use super::arch::{DENSITY_KG_M3, DEPTH_M};
use super::back_wall::three_impacts;
use super::blocks::{GRAVITY_M_S2, MAX_BLOCKS};
use super::chain::MechanismState;
use super::given_body::{GivenBody, MAGNITUDE};
use super::tie::TieError;
use super::tilting::{Tilting, thrust_section_parts};
use crate::argument::{ArgumentError, plain, require, require_within};
use crate::mechanics::four_link::resultant::SectionResultant;
use crate::mechanics::masonry::LoadOutlines;
use crate::mechanics::{
    BackWall, Block, Demand, FourLinkError, HeldTop, Hinge, ImpactLaw, ImpactModel, Link,
    MechanismChain, NoWallRatio, PlacedLoad, Row, RowError, Sides, Sway, Tie,
};

/// A free-standing column: a rectangular block on rigid ground, which does not slide.
///
/// It may have any proportions. A column wider than `sqrt(2)` times its height stops at its first impact. To
/// rock from rest without sliding, a column needs a friction coefficient of its width over its height.
///
/// It is one block unless it is cut into drums, and prismatic unless it is tapered. Housner's model is a single
/// prismatic block; the others are simulated with free hinges.
#[readonly::make]
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Column {
    /// Height, in metres.
    pub height_m: f64,
    /// Width in the plane of the motion, in metres.
    pub width_m: f64,
    /// Length out of plane, in metres.
    pub depth_m: f64,
    /// Density, in kg/m3.
    pub density_kg_m3: f64,
    drum_heights_m: Option<Vec<f64>>,
    top_width_m: Option<f64>,
    /// Numbers of a rigid body in place of those of a prism; `None` for a column. Its height and width are then those of a block for drawings.
    #[serde(skip)]
    pub given: Option<GivenBody>,
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pedestal: bool,
    /// Wall behind the column; `None` if it stands free. [`Column::row`] has no wall.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub back: Option<BackWall>,
    /// Floor that holds its top sideways; `None` if its top is free. [`Column::row`] and [`RockingColumn`] have a free top.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub top: Option<HeldTop>,
    /// Ties of the column.
    #[serde(skip)]
    pub ties: Vec<Tie>,
    /// Loads of the column.
    #[serde(skip)]
    pub loads: Vec<PlacedLoad>,
    /// Gravity for which ties and loads were given, in m/s2.
    #[serde(skip)]
    pub(super) gravity_m_s2: f64,
}

/// Reason why a column cannot carry its loads.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ColumnLoadError {
    /// A number of the load with this index is not allowed.
    #[error("load {number}: {1}", number = .0 + 1)]
    Load(usize, ArgumentError),
    /// The wall behind the column is too low for its loads.
    #[error("the wall behind it is too low: {0}")]
    Wall(ArgumentError),
    /// The column overturns to this side under its own weight and its loads.
    #[error("it overturns to the {side} under its own weight and its loads, without ground motion", side = .0.name())]
    Overturns(Sway),
}

impl Column {
    /// Column of given height and width (in the plane of the motion), with a depth of 1 m and a density of 2000 kg/m3.
    ///
    /// # Errors
    /// When a size is outside 1e-9 to 1e12 m.
    pub fn new(height_m: f64, width_m: f64) -> Result<Self, ArgumentError> {
        Ok(Self {
            height_m: require_within("height_m", height_m, MAGNITUDE)?,
            width_m: require_within("width_m", width_m, MAGNITUDE)?,
            depth_m: DEPTH_M,
            density_kg_m3: DENSITY_KG_M3,
            drum_heights_m: None,
            top_width_m: None,
            given: None,
            pedestal: false,
            back: None,
            top: None,
            ties: Vec::new(),
            loads: Vec::new(),
            gravity_m_s2: GRAVITY_M_S2,
        })
    }

    /// A rigid body by its numbers, which rocks about its toes as a column does. It is drawn as a block on its toes, twice as high as its centre of
    /// gravity, and 1 m deep.
    ///
    /// # Errors
    /// When a number is outside its range, or the body does not stand.
    pub fn of_body(body: GivenBody) -> Result<Self, ArgumentError> {
        body.check()?;
        let [left, right] = body.toes_x_m;
        let block = Self::new(2.0 * body.centre_m.y, right - left)?;
        let density_kg_m3 = body.mass_kg / (block.height_m * block.width_m * block.depth_m);
        Ok(Self {
            density_kg_m3,
            given: Some(body),
            ..block
        })
    }

    /// This column cut into equal drums.
    ///
    /// # Errors
    /// If there is none, or more than a row of blocks may have.
    pub fn with_drums(mut self, drums: usize) -> Result<Self, ArgumentError> {
        let count = drums as f64;
        require_within("drums", count, 1.0..=MAX_BLOCKS as f64)?;
        self.drum_heights_m = Some(vec![self.height_m / count; drums]);
        Ok(self)
    }

    /// This column cut into drums of these heights in metres, from the base up.
    ///
    /// # Errors
    /// When a height is outside 1e-9 to 1e12, they do not add up to the height of the column (to a millionth), or
    /// there are none or too many.
    pub fn with_drum_heights_m(mut self, heights_m: Vec<f64>) -> Result<Self, ArgumentError> {
        require_within("drums", heights_m.len() as f64, 1.0..=MAX_BLOCKS as f64)?;
        for height_m in &heights_m {
            require_within("drum_heights_m", *height_m, MAGNITUDE)?;
        }
        let sum_m: f64 = heights_m.iter().sum();
        let fits = (sum_m - self.height_m).abs() <= 1e-6 * self.height_m;
        let allowed = format_args!("the height of the column, {:?}", self.height_m);
        require(fits, "sum of drum_heights_m", sum_m, allowed)?;
        self.drum_heights_m = Some(heights_m);
        Ok(self)
    }

    /// This column with another width at the top, in metres; the width varies linearly.
    ///
    /// # Errors
    /// When it is outside 1e-9 to 1e12.
    pub fn with_top_width_m(mut self, top_width_m: f64) -> Result<Self, ArgumentError> {
        self.top_width_m = Some(require_within("top_width_m", top_width_m, MAGNITUDE)?);
        Ok(self)
    }

    /// This column on a pedestal as wide as its base (`true`), from which it can slide off, or on ground that extends beyond the base
    /// (`false`).
    #[must_use]
    pub fn on_pedestal(self, pedestal: bool) -> Self {
        Self { pedestal, ..self }
    }

    /// This column with these ties, under this gravity. A column with ties is a row of blocks, also if it is one prism.
    ///
    /// # Errors
    /// If a tie is not valid, with its index.
    pub fn with_ties(self, ties: Vec<Tie>, gravity_m_s2: f64) -> Result<Self, (usize, TieError)> {
        let (blocks, size_m) = (self.drum_heights_m().len(), self.half_diagonal_m());
        for (index, tie) in ties.iter().enumerate() {
            tie.check(blocks, size_m).map_err(|error| (index, error))?;
        }
        Ok(Self {
            ties,
            gravity_m_s2,
            ..self
        })
    }

    /// This column with a wall behind it.
    ///
    /// # Errors
    /// If the wall is higher than the column, or below its centre of gravity, or the ratio of rates is not in 0 to 1.
    pub fn with_back(mut self, back: BackWall) -> Result<Self, ArgumentError> {
        let height_m = back.height_m.unwrap_or(self.height_m);
        let allowed = format_args!("from 0 to the height of the column, {:?} m", self.height_m);
        let fits = (0.0..=self.height_m).contains(&height_m);
        require(fits, "height_m", height_m, allowed)?;
        if let Some(rate_ratio) = back.rate_ratio {
            require_within("restitution", rate_ratio, 0.0..=1.0)?;
        }
        self.back = Some(back);
        self.check_wall_height()?;
        Ok(self)
    }

    /// This column with a floor that holds its top sideways, under this gravity; its drums come before.
    ///
    /// # Errors
    /// When the weight is outside 1e-9 to 1e12 N or beyond the top, or the column has one drum and a taper, or a wall stands behind it.
    pub fn with_top(mut self, top: HeldTop, gravity_m_s2: f64) -> Result<Self, ArgumentError> {
        require_within("weight_n", top.weight_n, MAGNITUDE)?;
        let (half_m, base_m) = (0.5 * self.top_width_m(), self.width_m);
        require_within("x_m", top.x_m, -half_m..=half_m)?;
        let fits = !self.is_one_block() || 2.0 * half_m == base_m;
        let allowed = "that of the base without drums: give drums";
        require(fits, "top_width_m", 2.0 * half_m, allowed)?;
        let no_wall = "left out with a floor that holds the top of the column";
        require(self.back.is_none(), "back", 1.0, no_wall)?;
        (self.top, self.gravity_m_s2) = (Some(top), gravity_m_s2);
        Ok(self)
    }

    /// This column cut at heights in metres, from the lower one up; ends do not count. Its ties go to the drums at their heights.
    pub(super) fn cut_at(&self, heights_m: &[f64]) -> Self {
        let mut from_m = 0.0;
        let ends_m = heights_m.iter().filter(|height_m| **height_m > 0.0);
        let drums_m = ends_m.chain([&self.height_m]).map(|end_m| {
            let height_m = end_m - from_m;
            from_m = *end_m;
            height_m
        });
        let mut cut = self.clone();
        cut.drum_heights_m = Some(drums_m.collect());
        for tie in 0..cut.ties.len() {
            for end in 0..2 {
                let anchor = cut.ties[tie].ends[end];
                let drum = anchor.block.map(|_| cut.drum_at(anchor.at_m.y));
                cut.ties[tie].ends[end].block = drum;
            }
        }
        cut
    }

    /// Heights in metres between which the loads above a section vary smoothly: base, loads and ties, top.
    pub(super) fn heights_of_forces_m(&self) -> Vec<f64> {
        let loads_m = self.placed_loads().map(|(_, at_m)| at_m.y);
        let ends = self.ties.iter().flat_map(|tie| &tie.ends);
        let ties_m = ends.filter_map(|end| end.block.and(Some(end.at_m.y)));
        let inside = |height_m: &f64| 0.0 < *height_m && *height_m < self.height_m;
        let mut heights_m: Vec<f64> = loads_m.chain(ties_m).filter(inside).collect();
        heights_m.extend([0.0, self.height_m]);
        heights_m.sort_by(f64::total_cmp);
        heights_m.dedup();
        heights_m
    }

    /// Checks that no push turns the column over the top of the wall behind it.
    fn check_wall_height(&self) -> Result<(), ArgumentError> {
        let Some((_, height_m)) = self.wall() else {
            return Ok(());
        };
        let centre_m = self.body().centre_m.y;
        let allowed = format_args!(
            "0 for no wall, or at least {centre_m:?} m, the height of the centre of gravity: a push turns the column over the top of a lower wall, which \
             the model does not compute"
        );
        require(height_m >= centre_m, "height_m", height_m, allowed).map(|_| ())
    }

    /// This column with these loads, under this gravity. The column carries its loads as a rigid block, or as drums: each load is on the drum
    /// at its height, on the lower one at a joint.
    ///
    /// # Errors
    /// If a number is not allowed, the wall behind the column is too low, or the column, one prism, overturns at rest.
    pub fn with_loads(
        self,
        loads: Vec<PlacedLoad>,
        gravity_m_s2: f64,
    ) -> Result<Self, ColumnLoadError> {
        for (index, load) in loads.iter().enumerate() {
            let fits = load.check_on_column(self.height_m);
            fits.map_err(|error| ColumnLoadError::Load(index, error))?;
        }
        let loaded = Self {
            loads,
            gravity_m_s2,
            ..self
        };
        let fits = loaded.check_wall_height();
        fits.map_err(ColumnLoadError::Wall)?;
        let is_free = loaded.is_one_prism() && loaded.top.is_none();
        match loaded.overturns_to().filter(|_| is_free) {
            Some(sway) => Err(ColumnLoadError::Overturns(sway)),
            None => Ok(loaded),
        }
    }

    /// Side to which the column, as one block, overturns under its own weight and its loads; `None` if it stands.
    fn overturns_to(&self) -> Option<Sway> {
        let is_held = |sway| match self.wall() {
            Some((wall, height_m)) => wall.side == sway && self.leans_safely(sway, height_m),
            None => false,
        };
        let mut sides = Sway::ALL.iter().copied();
        sides.find(|sway| self.tilting_block(*sway).incipient_g() <= 0.0 && !is_held(*sway))
    }

    /// Column as one block that sways to this side.
    fn tilting_block(&self, sway: Sway) -> Tilting {
        let size_m = [self.height_m, self.width_m];
        let (own, given) = (self.own_body(), self.given.is_some());
        let loads = self.placed_loads();
        Tilting::new(size_m, (&own, given), loads, self.gravity_m_s2, sway)
    }

    /// Whether its weight and its loads do not turn the column over the top of a wall of this height on this side: in a virtual rotation
    /// about that point, towards the wall, they do no positive work.
    fn leans_safely(&self, side: Sway, height_m: f64) -> bool {
        let top_m = Vector2::new(0.5 * self.width_m * side.sign(), height_m);
        let body = self.body();
        let weight_n = Vector2::new(0.0, -body.mass_kg * self.gravity_m_s2);
        let weight = (body.centre_m, weight_n);
        let forces = self.constant_forces().chain([weight]);
        let moments = forces.map(|(at_m, force_n)| (at_m - top_m).perp(&force_n));
        // Clockwise moments turn it to the right.
        side.sign() * moments.sum::<f64>() >= 0.0
    }

    /// Loads, each with its point, in metres from the middle of the base.
    pub fn placed_loads(&self) -> impl Iterator<Item = (&PlacedLoad, Vector2<f64>)> {
        self.loads.iter().map(|load| {
            let height_m = load.height_m.unwrap_or(self.height_m);
            let middle_m = self.given.map_or(0.0, |body| body.middle_m());
            (load, Vector2::new(load.x_m - middle_m, height_m))
        })
    }

    /// Loads for drawings, each with the drum that carries it.
    pub fn load_outlines(&self) -> LoadOutlines {
        let loads_m = self
            .placed_loads()
            .map(|(_, at_m)| (self.drum_at(at_m.y), at_m));
        LoadOutlines {
            fill_m: Vec::new(),
            loads_m: loads_m.collect(),
        }
    }

    /// Index of the drum at a height; at a joint, of the lower one.
    fn drum_at(&self, height_m: f64) -> usize {
        let heights_m = self.drum_heights_m();
        let mut top_m = 0.0;
        let drum = heights_m.iter().position(|drum_m| {
            top_m += drum_m;
            top_m >= height_m * (1.0 - 1e-9)
        });
        drum.unwrap_or(heights_m.len() - 1)
    }

    /// Constant forces of its loads in N, each after its point in metres.
    pub fn constant_forces(&self) -> impl Iterator<Item = (Vector2<f64>, Vector2<f64>)> {
        let loads = self.placed_loads();
        let forces = loads.map(|(load, at_m)| (at_m, load.constant_force_n(self.gravity_m_s2)));
        forces.filter(|(_, force_n)| *force_n != Vector2::zeros())
    }

    /// Column without loads as one rigid body; its drums and its taper are neglected.
    fn own_body(&self) -> Block {
        if let Some(given) = self.given {
            return given.block();
        }
        let mass_kg = self.density_kg_m3 * self.depth_m * self.height_m * self.width_m;
        let diagonal_m = libm::hypot(self.height_m, self.width_m);
        Block {
            mass_kg,
            centre_m: Vector2::new(0.0, 0.5 * self.height_m),
            inertia_kg_m2: mass_kg * diagonal_m * diagonal_m / 12.0,
        }
    }

    /// Column and its moving loads as one rigid body; its drums and its taper are neglected.
    pub fn body(&self) -> Block {
        let loads = self
            .placed_loads()
            .filter_map(|(load, at_m)| load.moving_body(at_m));
        loads.fold(self.own_body(), |body, load| body.with(&load))
    }

    /// Wall behind the column with its height in metres; `None` without a wall, or if its height is zero.
    pub fn wall(&self) -> Option<(BackWall, f64)> {
        let back = self.back?;
        let height_m = back.height_m.unwrap_or(self.height_m);
        (height_m > 0.0).then_some((back, height_m))
    }

    /// Ratio of the rates after and before an impact on the wall behind the column; `None` without a wall. The default is that of a
    /// homogeneous block that is held over its full height.
    ///
    /// # Errors
    /// If the ratio is not given, and the wall is lower than the column, loads move with the column, or the column is too wide.
    pub fn wall_rate_ratio(&self) -> Result<Option<f64>, NoWallRatio> {
        let Some((wall, height_m)) = self.wall() else {
            return Ok(None);
        };
        if let Some(rate_ratio) = wall.rate_ratio {
            return Ok(Some(rate_ratio));
        }
        if height_m < self.height_m {
            return Err(NoWallRatio::Low {
                wall_m: height_m,
                column_m: self.height_m,
            });
        }
        let loads = self.placed_loads();
        let moving = loads.filter_map(|(load, at_m)| load.moving_body(at_m));
        let moving_kg = moving.map(|load| load.mass_kg).sum::<f64>();
        if moving_kg > 0.0 {
            return Err(NoWallRatio::Loads(moving_kg));
        }
        // Lengths in half diagonals.
        let half_m = self.half_diagonal_m();
        let outer = Vector2::new(0.5 * self.width_m / half_m, 0.0);
        let contact = Vector2::new(0.0, self.height_m / half_m) - outer;
        let tilting = self.tilting_block(wall.side.opposite());
        let ratio = three_impacts(tilting.body(), [outer, -outer, contact]);
        let wide = NoWallRatio::Wide(self.width_m / self.height_m);
        ratio.map(Some).ok_or(wide)
    }

    /// Rate about the toe to this side, in rad/s, of a column of one block at rest just after a short horizontal blow: the angular impulse
    /// about the toe over the moment of inertia about it. The base does not slip in the blow. `None` for several drums, which do not start as one.
    pub fn rate_of_blow_rad_s(&self, sway: Sway, impulse_n_s: f64, height_m: f64) -> Option<f64> {
        let [block] = &self.row().ok()?.blocks[..] else {
            return None;
        };
        let arm_m = block.centre_m - Vector2::new(0.5 * sway.sign() * self.width_m, 0.0);
        let inertia_kg_m2 = block.inertia_kg_m2 + block.mass_kg * arm_m.norm_squared();
        Some(impulse_n_s * height_m / inertia_kg_m2)
    }

    /// Side and height in metres of a wall behind drums with elastic joints; `None` without a wall. Each drum is held at its centre or above, so
    /// the wall carries every push towards it.
    ///
    /// # Errors
    /// If the column tapers or has ties, or the wall is below the centre of a drum.
    pub fn wall_behind_drums(&self) -> Result<Option<(Sway, f64)>, ArgumentError> {
        let Some((wall, height_m)) = self.wall() else {
            return Ok(None);
        };
        let top_m = self.drum_heights_m().last().copied().unwrap_or(0.0);
        // Loads may raise the centre of the top drum.
        let row = self.row().ok().filter(|_| !self.loads.is_empty());
        let loaded_m = row.and_then(|row| Some(row.blocks.last()?.centre_m.y));
        let least_m = (self.height_m - 0.5 * top_m).max(loaded_m.unwrap_or(0.0));
        let tapers = self.top_width_m() != self.width_m;
        let foot_only = "that of the base with a wall behind the column, which a tapered face touches at its foot only";
        require(!tapers, "top_width_m", self.top_width_m(), foot_only)?;
        require(self.ties.is_empty(), "height_m", height_m, "0 with ties")?;
        let allowed = format!(
            "0 for no wall, or at least {} m, the centre of the top drum: a push turns a drum over the top of a lower wall, and its onset is not computed",
            plain(least_m)
        );
        require(height_m >= least_m, "height_m", height_m, allowed)?;
        Ok(Some((wall.side, height_m)))
    }

    /// Half the diagonal of its outline, in metres, for a top as wide as the base.
    pub fn half_diagonal_m(&self) -> f64 {
        0.5 * libm::hypot(self.height_m, self.width_m)
    }

    /// Whether the column with its loads and ties is its own mirror image, without a wall behind it. See [`Row::is_symmetric`].
    pub fn is_symmetric(&self) -> bool {
        self.wall().is_none() && self.row().is_ok_and(|row| row.is_symmetric())
    }

    /// Drums as a row of blocks, on ground that extends beyond the base, or on a pedestal.
    ///
    /// # Errors
    /// If the drums do not form a row, or the column has ties and constant forces.
    pub fn row(&self) -> Result<Row, RowError> {
        let row = Row::tapered_stack(
            &self.drum_heights_m(),
            self.width_m,
            self.top_width_m(),
            self.depth_m,
            self.density_kg_m3,
        )?;
        let row = match self.given {
            Some(given) => row.with_block(0, given.block()),
            None => row,
        };
        let loads = self
            .placed_loads()
            .filter_map(|(load, at_m)| Some((at_m, load.moving_body(at_m)?)));
        let row = loads
            .fold(row, |row, (at_m, load)| {
                row.with_body(self.drum_at(at_m.y), &load)
            })
            .with_supports_that_extend([!self.pedestal, false]);
        let mut forces = self.constant_forces();
        if self.ties.is_empty() {
            let forces = forces.map(|(at_m, force_n)| (self.drum_at(at_m.y), at_m, force_n));
            return Ok(row.with_constant_forces(forces, self.gravity_m_s2));
        }
        if forces.next().is_some() {
            return Err(RowError::TiesAndForces);
        }
        let tied = row.with_ties(self.ties.clone(), self.gravity_m_s2);
        Ok(tied.expect("the ties were checked with the same blocks"))
    }

    /// Heights of its drums from the base up, in metres; its own height for a single block.
    pub fn drum_heights_m(&self) -> Vec<f64> {
        let drums = self.drum_heights_m.clone();
        drums.unwrap_or_else(|| vec![self.height_m])
    }

    /// Whether the column is one block, without drums.
    pub(super) fn is_one_block(&self) -> bool {
        self.drum_heights_m().len() == 1
    }

    /// Whether it is one prismatic block without ties, as in Housner's model.
    pub fn is_one_prism(&self) -> bool {
        let prism = self.is_one_block() && self.top_width_m() == self.width_m;
        prism && self.ties.is_empty()
    }

    /// Width at the top, in metres.
    pub fn top_width_m(&self) -> f64 {
        self.top_width_m.unwrap_or(self.width_m)
    }

    /// This column with another depth out of plane, in metres.
    ///
    /// # Errors
    /// When it is outside 1e-9 to 1e12.
    pub fn with_depth_m(mut self, depth_m: f64) -> Result<Self, ArgumentError> {
        self.depth_m = require_within("depth_m", depth_m, MAGNITUDE)?;
        Ok(self)
    }

    /// This column with another density, in kg/m3.
    ///
    /// # Errors
    /// When it is outside 1e-9 to 1e12.
    pub fn with_density_kg_m3(mut self, density_kg_m3: f64) -> Result<Self, ArgumentError> {
        self.density_kg_m3 = require_within("density_kg_m3", density_kg_m3, MAGNITUDE)?;
        Ok(self)
    }

    /// Sections at which the thrust line of a single block is reported, in metres above the base: 21, from the base to the top; of a body by its
    /// numbers the base alone.
    pub fn thrust_sections_m(&self) -> Vec<f64> {
        let parts = thrust_section_parts(self.given.is_some());
        parts.map(|part| part * self.height_m).collect()
    }

    /// Slenderness `alpha`, the angle of the diagonal with the vertical, in radians.
    pub fn slenderness_rad(&self) -> f64 {
        libm::atan2(self.width_m, self.height_m)
    }
}

/// Free-standing column that rocks under an impact model.
#[derive(Clone, Debug)]
pub struct RockingColumn {
    half_diagonal_m: f64,
    mass_unit_kg: f64,
    first: Sides<Link<Tilting>>,
    /// Links after one or more impacts; `None` if the impact stops the column.
    next: Sides<Option<Link<Tilting>>>,
    /// Side of the wall behind it, towards which it cannot sway.
    wall: Option<Sway>,
    /// True if there is a wall behind it, lower than the column, over whose top it may turn.
    wall_is_low: bool,
    /// True if the column is its own mirror image.
    is_symmetric: bool,
}

impl RockingColumn {
    /// Column under an impact model. A prescribed restitution coefficient, or a factor on it, applies to impacts on the base, or on the
    /// wall behind the column.
    ///
    /// # Errors
    /// If a prescribed restitution coefficient is not in 0 to 1, or the column is not one prismatic block, or the wall behind it needs a ratio of rates
    /// that is neither given nor prescribed.
    pub fn new(column: &Column, law: impl Into<ImpactLaw>) -> Result<Self, FourLinkError> {
        let law = law.into();
        law.check()?;
        if column.top.is_some() {
            return Err(FourLinkError::HeldTop);
        }
        let (drums, top_m) = (column.drum_heights_m().len(), column.top_width_m());
        let one = "1 in Housner's model: a column of drums needs free hinges";
        require(drums <= 1, "drums", drums as f64, one)?;
        let width = "the width in Housner's model: a taper needs free hinges";
        require(top_m == column.width_m, "top_width_m", top_m, width)?;
        let half_diagonal_m = column.half_diagonal_m();
        let tilting = Sides::of(|sway| column.tilting_block(sway));
        let slenderness_rad = column.slenderness_rad();
        let link = |sway: Sway, rate_ratio, restitution| {
            let tilting = tilting.get(sway).clone();
            let critical_rad = tilting.critical_rad(slenderness_rad);
            Link::new(tilting, critical_rad, FRAC_PI_2, rate_ratio, restitution)
        };
        let wall = column.wall().map(|(wall, _)| wall.side);
        let of_wall = match law.model.is_prescribed() {
            true => None,
            false => column.wall_rate_ratio()?,
        };
        // The impact that starts a sway to this side.
        let next = |sway: Sway| {
            let before = wall.map_or(sway.opposite(), |_| sway);
            let [before, after] = [before, sway].map(|sway| tilting.get(sway));
            let inertia_ratio = after.unit_inertia() / before.unit_inertia();
            let (rate_ratio, restitution) = match law.model {
                ImpactModel::Prescribed { restitution } => {
                    ((restitution / inertia_ratio).sqrt(), restitution)
                }
                ImpactModel::MaxRestitution | ImpactModel::SameSections | ImpactModel::Mirrored => {
                    let rate_ratio = of_wall.unwrap_or_else(|| after.base_rate_ratio());
                    (rate_ratio, rate_ratio * rate_ratio * inertia_ratio)
                }
            };
            let (rate_ratio, restitution) = law.rate_and_restitution(rate_ratio, restitution);
            (rate_ratio > 0.0).then(|| link(sway, rate_ratio, restitution))
        };
        Ok(Self {
            half_diagonal_m,
            mass_unit_kg: column.density_kg_m3 * column.depth_m * half_diagonal_m * half_diagonal_m,
            first: Sides::of(|sway| link(sway, 1.0, 1.0)),
            next: Sides::of(next),
            wall,
            wall_is_low: column
                .wall()
                .is_some_and(|(_, height_m)| height_m < column.height_m),
            is_symmetric: column.is_symmetric(),
        })
    }

    /// Whether the column is its own mirror image.
    pub const fn is_symmetric(&self) -> bool {
        self.is_symmetric
    }
}

/// Demand at the base for a ground reaction per unit weight and its moment about the middle of the base.
fn base_demand(mechanism: &Tilting, (reaction, moment): (Vector2<f64>, f64)) -> Demand {
    let width = 2.0 * mechanism.toe().x;
    let base = SectionResultant {
        normal: reaction.y,
        tangential: reaction.x,
        moment,
        eccentricity_ratio: moment / (reaction.y * width),
        thickness: width,
    };
    Demand::of_sections(std::iter::once(base), 1.0)
}

impl MechanismChain for RockingColumn {
    type Mechanism = Tilting;

    fn length_m(&self) -> f64 {
        self.half_diagonal_m
    }

    fn mass_unit_kg(&self) -> f64 {
        self.mass_unit_kg
    }

    fn incipient_towards_g(&self, sway: Sway) -> f64 {
        self.first.get(sway).mechanism.incipient_g()
    }

    const THRUSTS: bool = false;

    /// The only section of the column is the base, where the ground's reaction acts at the toe. The excess is zero unless the reaction is tensile.
    fn demand(&self, mechanism: &Tilting, motion: &MechanismState) -> Demand {
        let reaction = mechanism.reaction(motion);
        base_demand(mechanism, (reaction, reaction.y * mechanism.toe().x))
    }

    fn demand_at_rest(&self, body_force_g: Vector2<f64>) -> Demand {
        let mechanism = &self.first.right.mechanism;
        base_demand(
            mechanism,
            mechanism.reaction_at_rest(body_force_g, self.wall),
        )
    }

    fn eccentricity_ratios(
        &self,
        mechanism: &Tilting,
        motion: &MechanismState,
    ) -> Vec<Option<f64>> {
        mechanism.eccentricity_ratios(motion)
    }

    fn mirrored(&self, eccentricity_ratios: Vec<Option<f64>>) -> Vec<Option<f64>> {
        let ratios = eccentricity_ratios.into_iter();
        ratios.map(|ratio| ratio.map(|ratio| -ratio)).collect()
    }

    fn eccentricity_ratios_at_rest(&self, body_force_g: Vector2<f64>) -> Vec<Option<f64>> {
        let mechanism = &self.first.right.mechanism;
        mechanism.eccentricity_ratios_at_rest(body_force_g, self.wall)
    }

    fn sway_after(&self, sway: Sway, impacts: usize) -> Sway {
        let away = self.wall.map(Sway::opposite);
        away.unwrap_or_else(|| sway.after(impacts))
    }

    fn link_from(&self, first: Sway, impacts: usize) -> Option<&Link<Tilting>> {
        match impacts {
            _ if self.wall == Some(first) => None,
            0 => Some(self.first.get(first)),
            _ => self.next.get(self.sway_after(first, impacts)).as_ref(),
        }
    }

    fn repeats_from(&self, _: Sway) -> Option<usize> {
        Some(1)
    }

    fn barriers_decide(&self) -> bool {
        !self.wall_is_low
    }

    fn hinges(&self, impacts: usize, sway: Sway) -> Vec<Hinge> {
        // An impact stops the sways to both sides or to neither, so the side of the first sway does not matter; the side of a wall has no links.
        let link = self.link_from(sway, impacts);
        link.map_or(Vec::new(), |_| vec![Hinge::Toe(sway)])
    }

    /// Empty list: the restitution coefficient alone describes the impact of a column.
    fn hinge_impulses(&self, _: usize, _: Sway) -> Vec<Vector2<f64>> {
        Vec::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::{Coefficients, Mechanism};
    use proptest::prelude::*;

    fn column(slenderness_rad: f64, model: ImpactModel) -> RockingColumn {
        let column = Column::new(2.0, 2.0 * slenderness_rad.tan()).unwrap();
        RockingColumn::new(&column, model).unwrap()
    }

    proptest! {
        #[test]
        fn restitution_is_the_one_of_housner(slenderness_rad in 1e-6_f64..0.955) {
            let column = column(slenderness_rad, ImpactModel::MaxRestitution);
            let housner = 1.0 - 1.5 * slenderness_rad.sin().powi(2);
            // 0.9553 is asin(sqrt(2/3)).
            let link = column.link(1).unwrap();
            prop_assert!((link.rate_ratio - housner).abs() < 1e-15);
            prop_assert!((link.restitution - housner * housner).abs() < 2e-15);
        }

        /// Positions come from the rotation of the diagonal, derivatives from central differences,
        /// whose errors are `h^2` and `1e-16 / h`.
        #[test]
        fn coefficients_are_derivatives(slenderness_rad in 0.01_f64..1.5, q in 0.0_f64..FRAC_PI_2) {
            let tilting = column(slenderness_rad, ImpactModel::Mirrored).first.right.mechanism;
            let mass = 2.0 * (2.0 * slenderness_rad).sin();
            let gravity_center = |q: f64| {
                let angle = slenderness_rad - q;
                Vector2::new(-angle.sin(), angle.cos()) * mass
            };
            let moved = tilting.displacement(q) - (gravity_center(q) - gravity_center(0.0));
            prop_assert!(moved.norm() < 1e-15 * 4.0);
            let h = 1e-5;
            let slope = (gravity_center(q + h) - gravity_center(q - h)) / (2.0 * h);
            let exact = tilting.coefficients(q);
            prop_assert!((slope - Vector2::new(exact.s_x, exact.s_y)).norm() < 1e-9);
        }
    }

    #[test]
    fn mass_and_size_are_those_of_the_block() {
        let column = Column::new(4.0, 0.8)
            .unwrap()
            .with_depth_m(0.5)
            .unwrap()
            .with_density_kg_m3(2200.0)
            .unwrap();
        let column = RockingColumn::new(&column, ImpactModel::MaxRestitution).unwrap();
        let kg = column.mass_unit_kg() * column.first.right.mechanism.moments()[0].mass;
        assert!((kg - 4.0 * 0.8 * 0.5 * 2200.0).abs() < 1e-9);
        assert!((column.length_m() - 2.0 * 1.04_f64.sqrt()).abs() < 1e-15);
        // Moment of inertia about the toe, m (H^2 + W^2) / 3.
        let inertia = column.first.right.mechanism.coefficients(0.0).inertia;
        let kg_m2 = inertia * column.mass_unit_kg() * column.length_m() * column.length_m();
        assert!((kg_m2 / (kg * (16.0 + 0.64) / 3.0) - 1.0).abs() < 1e-14);
    }

    /// At release a column falls with `q'' = -3/4 g/R sin(alpha - q)`, like the falling rod of the textbooks:
    /// the ground carries `1 - 3/4 sin^2` of the weight and pushes with `3/4 sin cos` of it. At rest the ground
    /// carries all of the weight, and pushes with its acceleration.
    #[test]
    fn base_forces_balance_weight_and_inertia() {
        let column = column(0.3, ImpactModel::MaxRestitution);
        for q_rad in [0.0, 0.1, 0.3, 0.5] {
            let (sin, cos) = (0.3_f64 - q_rad).sin_cos();
            let motion = MechanismState {
                q_rad,
                rate: 0.0,
                acceleration: -0.75 * sin,
                body_force_g: Vector2::new(0.0, -1.0),
            };
            let demand = column.demand(&column.first.right.mechanism, &motion);
            let friction = 0.75 * (sin * cos).abs() / (1.0 - 0.75 * sin * sin);
            assert!((demand.friction - friction).abs() < 1e-15 && demand.excess_ratio == 0.0);
        }
        let at_rest = |push_g| column.demand_at_rest(Vector2::new(push_g, -1.0));
        assert!(at_rest(0.2).friction == 0.2 && at_rest(0.2).excess_ratio == 0.0);
        let beyond = at_rest(-0.4).excess_ratio - (0.2 / 0.3_f64.tan() - 0.5);
        assert!(beyond.abs() < 1e-15);
        // A fast column would fly off: the ground cannot pull.
        let fast = MechanismState {
            q_rad: 0.3,
            rate: 1.1,
            acceleration: 0.0,
            body_force_g: Vector2::new(0.0, -1.0),
        };
        assert!(
            column
                .demand(&column.first.right.mechanism, &fast)
                .excess_ratio
                > 0.0
        );
    }

    proptest! {
        /// The reference sums over thin slices of the block. Each has the acceleration of its own centre, by the second
        /// derivative of its position, and the moment that turns it.
        #[test]
        fn the_line_of_thrust_is_that_of_slices(
            slenderness_rad in 0.05_f64..0.8,
            part in 0.0_f64..1.2,
            rate in -0.5_f64..0.5,
            push_g in -0.5_f64..0.5,
            lift_g in -0.3_f64..0.3,
        ) {
            let column = column(slenderness_rad, ImpactModel::MaxRestitution);
            let mechanism = column.first.right.mechanism.clone();
            let (half, height) = (slenderness_rad.sin(), 2.0 * slenderness_rad.cos());
            let q_rad = part * slenderness_rad;
            let body_force_g = Vector2::new(push_g, -1.0 + lift_g);
            let Coefficients { inertia, s_x, s_y, .. } = mechanism.coefficients(q_rad);
            let acceleration = (body_force_g.x * s_x + body_force_g.y * s_y) / inertia;
            let motion = MechanismState { q_rad, rate, acceleration, body_force_g };
            let ratios = column.eccentricity_ratios(&mechanism, &motion);
            prop_assert_eq!(ratios.len(), 21);

            // Position of a point of the axis at a given time, in the frame of the ground.
            let axis = |y: f64, time: f64| {
                let q = q_rad + rate * time + 0.5 * acceleration * time * time;
                let (sin, cos) = q.sin_cos();
                Vector2::new(half - half * cos + y * sin, half * sin + y * cos)
            };
            let step = 1e-4;
            let slices = 4000;
            let thin = height / f64::from(slices);
            let up = axis(1.0, 0.0) - axis(0.0, 0.0);
            for (index, ratio) in ratios.iter().enumerate().take(20) {
                let from = height * index as f64 / 20.0;
                let section = axis(from, 0.0);
                let (mut force, mut moment) = (Vector2::zeros(), 0.0);
                for slice in (index as i32 * slices / 20)..slices {
                    let y = (f64::from(slice) + 0.5) * thin;
                    let acceleration_g = (axis(y, step) - 2.0 * axis(y, 0.0) + axis(y, -step)) / (step * step);
                    let on_slice = acceleration_g - body_force_g;
                    force += on_slice * thin;
                    let turning = -acceleration * (2.0 * half).powi(2) / 12.0;
                    moment += ((axis(y, 0.0) - section).perp(&on_slice) + turning) * thin;
                }
                let normal = force.dot(&up);
                let due = moment / (normal * 2.0 * half);
                match ratio {
                    Some(ratio) => prop_assert!((ratio - due).abs() < 1e-4 * (1.0 + due.abs()) / normal.min(1.0)),
                    None => prop_assert!(normal < 1e-6),
                }
            }
            // A column that turns about its toe always presses the ground at the toe.
            if let Some(base) = ratios[0] {
                prop_assert!((base - 0.5).abs() < 1e-12 / -body_force_g.y.min(-1e-2));
            }
            let mirrored = column.mirrored(ratios.clone());
            prop_assert!(mirrored.iter().zip(&ratios).all(|(a, b)| *a == b.map(|b| -b)));
        }

        /// At rest the line of thrust is straight, from the point at the base that the demand gives to the middle of the top.
        #[test]
        fn the_line_of_thrust_at_rest_is_straight(slenderness_rad in 0.05_f64..0.8, push_g in -2.0_f64..2.0) {
            let column = column(slenderness_rad, ImpactModel::MaxRestitution);
            let body_force_g = Vector2::new(push_g, -0.9);
            let ratios = column.eccentricity_ratios_at_rest(body_force_g);
            let base = ratios[0].unwrap();
            let excess = (base.abs() - 0.5).max(0.0);
            let demand = column.demand_at_rest(body_force_g);
            prop_assert!((excess - demand.excess_ratio).abs() < 1e-12 * (1.0 + excess));
            prop_assert!(base == 0.0 || base.signum() == push_g.signum());
            for (index, ratio) in ratios.iter().enumerate() {
                let due = base * (1.0 - index as f64 / 20.0);
                prop_assert!((ratio.unwrap() - due).abs() < 1e-12 * (1.0 + base.abs()));
            }
            let flies = column.eccentricity_ratios_at_rest(Vector2::new(push_g, 0.1));
            prop_assert!(flies.iter().all(Option::is_none));
        }
    }

    #[test]
    fn flat_columns_stop_at_the_first_impact() {
        let flattest_rad = (2.0_f64 / 3.0).sqrt().asin();
        let next = |slenderness_rad, model| column(slenderness_rad, model).link(1).is_some();
        for model in [
            ImpactModel::MaxRestitution,
            ImpactModel::SameSections,
            ImpactModel::Mirrored,
        ] {
            assert!(next(flattest_rad - 1e-9, model) && !next(flattest_rad + 1e-9, model));
        }
        let prescribed = |restitution| ImpactModel::Prescribed { restitution };
        assert!(next(1.2, prescribed(0.5)) && !next(0.2, prescribed(0.0)));
        let column = column(0.2, prescribed(0.49));
        let link = column.link(7).unwrap();
        assert!(link.restitution == 0.49 && (link.rate_ratio - 0.7).abs() < 1e-15);
    }
}
