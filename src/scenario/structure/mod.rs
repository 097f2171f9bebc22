//! The structure on the ground: an arch, blocks, or `[column]`.

mod dimensions;
mod words;

pub(super) use dimensions::bounds_m;
pub use dimensions::{Dimension, DimensionSide, metres};
pub use words::{forces_in_words, load_in_words};

use std::f64::consts::FRAC_PI_2;

use thiserror::Error;

use super::back_wall;
use super::held_top;
use super::load::{NO_CONSTANT_FORCES, loaded_column};
use super::masonry::{self, Additions};
use super::prelude::*;
use super::span::Circular;
use super::tie::{self, TieTable};
use crate::argument::rounded_up;
use crate::mechanics::four_link::least_thickness_ratio;
use crate::mechanics::masonry::{CircularArch, LoadOutlines};
use crate::mechanics::{DENSITY_KG_M3, DEPTH_M, GivenBody, HeldTop, MAX_BLOCKS};
use crate::mechanics::{LimitError, MasonryShape, Parts, PlacedLoad, RowError, Supports, Tie};
use crate::{
    Arch, BackWall, Column, FourLinkError, FourLinks, FreeHinges, ImpactLaw, ImpactModel, Masonry,
    MechanismModel, RockingColumn, Row, RowModelError, RowOptions, Sway,
};

/// The structure that stands on the ground.
#[derive(Clone, Debug, PartialEq)]
pub enum Structure {
    /// A circular arch, from `[arch]`.
    Arch(Arch),
    /// A free-standing column, from `[column]`, or a body by its numbers, from `[body]`.
    Column(Column),
    /// An arch of another shape, on piers or with loads, or given blocks: a row of blocks.
    Masonry(Box<Masonry>),
}

impl Serialize for Structure {
    /// Writes the tables of the structure.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let table = match self {
            Self::Masonry(masonry) => return masonry.serialize(serializer),
            Self::Arch(arch) => ("arch", json!(arch)),
            Self::Column(column) => match &column.given {
                Some(body) => (BODY, json!(body)),
                None => ("column", json!(column)),
            },
        };
        serializer.collect_map([table])
    }
}

/// Table of a rigid body by its numbers.
const BODY: &str = "body";

/// Reasons why a structure has no model of motion.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ModelError {
    /// The structure does not rock as four links.
    #[error(transparent)]
    FourLinks(#[from] FourLinkError),
    /// The structure is not a row of blocks that can stand.
    #[error(transparent)]
    FreeHinges(#[from] RowModelError),
    /// The structure cannot stand on its elastic joints.
    #[error(transparent)]
    ElasticJoints(RowModelError),
}

impl Structure {
    /// Reads the structure with its ties, for a model of motion with joints or without. `lands` is true if its blocks are rigid and land on each other,
    /// `moves` if a model of motion follows.
    pub(super) fn read(
        table: &mut Table<'_>,
        (has_joints, lands, unproved, moves): (bool, bool, bool, bool),
        gravity_m_s2: Option<f64>,
    ) -> ReadResult<(Self, Vec<TieTable>)> {
        let beside = Additions::read(table);
        let alone = beside.as_ref().is_ok_and(Additions::is_empty);
        let arch = table.table("arch", |table| {
            read_arch(table, has_joints, alone, unproved)
        });
        let column = table.table("column", |table| read_column(table, has_joints));
        let body = table.table(BODY, read_body);
        let shape = masonry::read_shapes(table).map(StructureTable::Shape);
        let [pointed, elliptic, basket, blocks] = masonry::SHAPES;
        let tables = ["arch", "column", BODY, pointed, elliptic, basket, blocks];
        table.apply_relations(&[OneOf(&tables, None)])?;
        let body = body.map(|body| (body, (None, None)));
        let column = column.or(body);
        let column = column.map(|(column, sides)| StructureTable::Column(column, sides));
        let read = arch.or(column).or(shape).ok_or(FaultRecorded)?;
        let (beside, gravity_m_s2) = (beside?, gravity_m_s2.ok_or(FaultRecorded)?);
        let ties = beside.ties.clone();
        let structure = match read {
            StructureTable::Arch(arch) => Self::Arch(arch),
            StructureTable::Column(column, (back, top)) if beside.fits_column() => {
                let column =
                    back_wall::place_before_wall(table, column, back, (has_joints, lands))?;
                let column = held_top::hold(table, column, top, gravity_m_s2)?;
                let has_joints = has_joints || !ties.is_empty();
                let by = (has_joints, gravity_m_s2);
                let column = loaded_column(table, &beside.loads, column, by)?;
                let is_pushed = !ties.is_empty() && column.constant_forces().count() > 0;
                table.refuse(is_pushed, "tie", NO_CONSTANT_FORCES)?;
                let is_held = column.wall().is_some() && !ties.is_empty();
                table.refuse(is_held, "tie", NO_TIES)?;
                let is_tied = column.given.is_some() && !ties.is_empty();
                table.refuse(
                    is_tied,
                    "tie",
                    "goes with an arch or a [column], not with a [body] by its numbers",
                )?;
                let column = tie::tied_column(table, &ties, column, gravity_m_s2)?;
                held_top::check(table, &column, moves)?;
                Self::Column(column)
            }
            StructureTable::Column(..) => {
                return Err(beside.reject_all(table, "applies to an arch, not to a column"));
            }
            StructureTable::Shape(shape) => {
                let masonry = beside.build_masonry(table, shape, (gravity_m_s2, unproved))?;
                Self::Masonry(Box::new(masonry))
            }
        };
        Ok((structure, ties))
    }

    /// Ties of the structure.
    pub fn ties(&self) -> &[Tie] {
        match self {
            Self::Arch(_) => &[],
            Self::Column(column) => &column.ties,
            Self::Masonry(masonry) => masonry.row.bars(),
        }
    }

    /// Makes the model of mechanisms of one degree of freedom: four links, or Housner's block.
    ///
    /// # Errors
    /// When the structure does not rock as four links.
    pub fn model<L: Into<ImpactLaw>>(
        &self,
        law: L,
    ) -> Result<Box<dyn MechanismModel>, FourLinkError> {
        Ok(match self {
            Self::Arch(arch) => Box::new(FourLinks::of_arch(arch, law)?),
            Self::Column(column) if !column.ties.is_empty() => return Err(FourLinkError::Ties),
            Self::Column(column) => Box::new(RockingColumn::new(column, law)?),
            Self::Masonry(masonry) => Box::new(four_link_row(masonry, law)?),
        })
    }

    /// Makes the four-link model, with the properties that only four links have; `None` for a column.
    ///
    /// # Errors
    /// When the structure does not rock as four links.
    pub fn four_links<L: Into<ImpactLaw>>(
        &self,
        law: L,
    ) -> Result<Option<FourLinks>, FourLinkError> {
        Ok(match self {
            Self::Arch(arch) => Some(FourLinks::of_arch(arch, law)?),
            Self::Column(_) => None,
            Self::Masonry(masonry) => Some(four_link_row(masonry, law)?),
        })
    }

    /// Structure as parts with masses.
    pub fn as_parts(&self) -> &dyn Parts {
        match self {
            Self::Arch(arch) => arch,
            Self::Column(column) => column,
            Self::Masonry(masonry) => &masonry.row,
        }
    }

    /// Side of the wall behind a column, towards which it cannot move; `None` without a wall.
    pub fn wall_behind(&self) -> Option<Sway> {
        let (wall, _) = self.column()?.wall()?;
        Some(wall.side)
    }

    /// Arch under live loads or a vehicle; `None` for other structures.
    pub(crate) fn under_live_loads(&self) -> Option<&Masonry> {
        match self {
            Self::Masonry(masonry) => Some(&**masonry).filter(|it| it.has_live_loads()),
            Self::Arch(_) | Self::Column(_) => None,
        }
    }

    /// Fill and loads for drawings.
    pub fn fill_and_loads(&self) -> (LoadOutlines, &[PlacedLoad]) {
        match self {
            Self::Arch(_) => (LoadOutlines::default(), &[]),
            Self::Column(column) => (column.load_outlines(), &column.loads),
            Self::Masonry(masonry) => (masonry.load_outlines.clone(), &masonry.loads),
        }
    }

    /// True for an arch, which has thrust at its springings; false for a free-standing column.
    pub const fn has_horizontal_thrust(&self) -> bool {
        !matches!(self, Self::Column(_))
    }

    /// Name of each of its two supports: springing, foot of a pier, or support of given blocks.
    pub fn support_name(&self) -> &'static str {
        match self {
            Self::Masonry(masonry) => match masonry.springing_joints() {
                None => "support",
                Some([0, last]) if last + 1 == masonry.row.joints.len() => "springing",
                Some(_) => "foot",
            },
            Self::Arch(_) | Self::Column(_) => "springing",
        }
    }

    /// True if the structure stands on one support, as a column does.
    pub fn stands_on_one_support(&self) -> bool {
        self.row().is_ok_and(|row| row.supports == Supports::Left)
    }

    /// True for shapes that are symmetric for all dimensions.
    pub fn is_symmetric(&self) -> bool {
        match self {
            Self::Arch(_) => true,
            Self::Column(column) => {
                column.loads.is_empty() && column.given.is_none() && column.top.is_none()
            }
            Self::Masonry(_) => false,
        }
    }

    /// Circular arch; `None` for other structures, and for an arch with piers, fill, loads or ties.
    pub const fn circular_arch(&self) -> Option<&Arch> {
        match self {
            Self::Arch(arch) => Some(arch),
            Self::Column(_) | Self::Masonry(_) => None,
        }
    }

    /// Column; `None` for other structures.
    pub(crate) const fn column(&self) -> Option<&Column> {
        match self {
            Self::Column(column) => Some(column),
            Self::Arch(_) | Self::Masonry(_) => None,
        }
    }

    /// Column whose top is held by a floor; `None` for other structures.
    pub(crate) fn held_column(&self) -> Option<&Column> {
        self.column().filter(|column| column.top.is_some())
    }

    /// Length out of plane in m and the density in kg/m3; if densities differ, the first.
    pub(crate) fn depth_and_density(&self) -> (f64, f64) {
        match self {
            Self::Arch(arch) => (arch.depth_m, arch.density_kg_m3),
            Self::Column(column) => (column.depth_m, column.density_kg_m3),
            Self::Masonry(masonry) => {
                let material = masonry.shape.material();
                (material.depth_m, material.density_kg_m3)
            }
        }
    }

    /// Limit position of the first mechanism, in rad: initial rotations must be smaller. `None` if that mechanism has more than one
    /// degree of freedom. Drums turn about the base as one block.
    pub(super) fn release_limit_rad(&self) -> Option<f64> {
        // The limit position does not depend on the impact model.
        let Some(links) = self.four_links(ImpactModel::MaxRestitution).ok()? else {
            return Some(FRAC_PI_2);
        };
        let sides = Sway::ALL.iter().map(|sway| links.limit_rad(*sway));
        Some(sides.fold(f64::INFINITY, f64::min))
    }

    /// Structure as a row of blocks.
    ///
    /// # Errors
    /// When the structure is an arch without voussoirs.
    pub fn row(&self) -> Result<Row, RowError> {
        match self {
            Self::Arch(arch) => arch.row(),
            Self::Column(column) => column.row(),
            Self::Masonry(masonry) => Ok(masonry.row.clone()),
        }
    }

    /// Length that scales the motion, in m: the mean radius of an arch, half the diagonal of a column.
    pub fn size_m(&self) -> f64 {
        match self {
            Self::Arch(arch) => arch.mean_radius_m,
            Self::Column(column) => column.half_diagonal_m(),
            Self::Masonry(masonry) => masonry.row.size_m,
        }
    }

    /// Makes the model of a row of rigid blocks whose joints open and close.
    ///
    /// # Errors
    /// When the structure is an arch without voussoirs, or cannot stand.
    pub fn free_hinges(&self, options: RowOptions) -> Result<FreeHinges, RowModelError> {
        FreeHinges::new(self.row()?)?.with_options(options)
    }
}

/// Makes the four-link model of a row of blocks, with the depth in the scenario.
fn four_link_row<L: Into<ImpactLaw>>(
    masonry: &Masonry,
    law: L,
) -> Result<FourLinks, FourLinkError> {
    let depth_m = masonry.shape.material().depth_m;
    Ok(FourLinks::of_row(&masonry.row, law)?.with_depth_m(depth_m)?)
}

/// Wall behind a column and floor that holds its top.
type BackAndTop = (Option<BackWall>, Option<HeldTop>);

/// The contents of a table that describes a structure.
enum StructureTable {
    Arch(Arch),
    Column(Column, BackAndTop),
    Shape(MasonryShape),
}

/// Reads `[arch]`. With `alone` the arch has no piers, fill, loads or ties; with equal voussoirs or none it must then start as four links. With
/// free hinges it must have voussoirs and stand.
fn read_arch(
    table: &mut Table<'_>,
    free_hinges: bool,
    alone: bool,
    unproved: bool,
) -> ReadResult<StructureTable> {
    let circular = Circular::read(table);
    let depth_m = table.or("depth_m", &MAGNITUDE, DEPTH_M);
    let density_kg_m3 = table.or("density_kg_m3", &MAGNITUDE, DENSITY_KG_M3);
    let voussoirs = table.optional("voussoirs", &VOUSSOIRS);
    let joints_deg = table.optional("joints_deg", &list_of(&JOINT_DEG));
    let equal = "`voussoirs` are equal: give one of them";
    table.check_relations(&[AtMostOne(&["voussoirs", "joints_deg"], equal)])?;
    let circular = circular?;
    let (radius_m, ratio) = (circular.mean_radius_m, circular.thickness_ratio);
    let arch = Arch::new(radius_m, ratio, circular.embrace_deg)
        .and_then(|arch| arch.with_depth_m(depth_m))
        .and_then(|arch| arch.with_density_kg_m3(density_kg_m3))
        .and_then(|arch| match voussoirs {
            Some(voussoirs) => arch.with_voussoirs(voussoirs),
            None => Ok(arch),
        })
        .expect("the ranges of the keys are those of an arch")
        .with_measured_at(circular.measured_at);
    if (free_hinges || !alone) && voussoirs.is_none() && joints_deg.is_none() {
        return Err(table.fault_of_table(match free_hinges {
            true => "lacks `voussoirs`: joints open between blocks; give the number of voussoirs",
            false => "lacks `voussoirs`, which piers, fill, loads, vehicles and ties need: give their number",
        }));
    }
    if joints_deg.is_some() || !alone {
        let arch = CircularArch::new(arch, joints_deg).map_err(|error| {
            let wrong = format!("does not fit: {:?} must be {}", error.value, error.allowed);
            table.reject(error.argument, wrong)
        });
        return Ok(StructureTable::Shape(MasonryShape::Circular(arch?)));
    }
    if unproved {
        return Ok(StructureTable::Arch(arch));
    }
    match arch.incipient() {
        Ok(_) => Ok(StructureTable::Arch(arch)),
        Err(LimitError::OtherMechanism(_) | LimitError::NoPush) if free_hinges => {
            Ok(StructureTable::Arch(arch))
        }
        Err(error) => {
            let keys = ["thickness_m", "thickness_ratio"];
            let key = keys.into_iter().find(|key| table.has_key(key));
            Err(table.reject(key.unwrap_or(keys[1]), why_not(&arch, error)))
        }
    }
}

/// Reason why limit analysis rejects the arch, and the remedy.
fn why_not(arch: &Arch, error: LimitError) -> String {
    let embrace_deg = arch.embrace_deg;
    let embrace = plain(embrace_deg);
    match error {
        LimitError::CannotStand => {
            let least = least_thickness_ratio(embrace_deg.to_radians(), arch.sites(), 1e-12)
                .expect("the ranges of the keys are those of a ring");
            let least = short(rounded_up(least));
            format!(
                "makes an arch that cannot carry its own weight at an embrace angle of {embrace} degrees; \
                 the thickness must be at least {least} mean radii"
            )
        }
        // Another mechanism, or no push.
        _ => {
            let degrees = plain(embrace_deg.to_degrees());
            let unit = match embrace_deg < LIKELY_EMBRACE_DEG {
                true => format!(": is it in radians, {degrees} degrees?"),
                false => String::new(),
            };
            format!(
                "makes an arch too thick for its embrace angle of {embrace} degrees: {error}; give a \
                 thinner arch or a larger angle{unit}"
            )
        }
    }
}

/// Reads `[body]`.
fn read_body(table: &mut Table<'_>) -> ReadResult<Column> {
    let mass_kg = table.read_required("mass_kg", &MAGNITUDE);
    let inertia_kg_m2 = table.read_required("inertia_kg_m2", &MAGNITUDE);
    let centre_m = table.read_required("centre_m", &list_of(&tie::COORDINATE_M));
    let toes_x_m = table.read_required("toes_x_m", &list_of(&tie::COORDINATE_M));
    table.check_faultless()?;
    let mut pair = |key, numbers: Vec<f64>| {
        let count = numbers.len();
        let pair = <[f64; 2]>::try_from(numbers);
        table.accept(
            key,
            pair.map_err(|_| {
                format!("must be two numbers, x and y or left and right, not {count}")
            }),
        )
    };
    let (centre_m, toes_x_m) = (pair("centre_m", centre_m)?, pair("toes_x_m", toes_x_m)?);
    let body = GivenBody {
        mass_kg,
        inertia_kg_m2,
        centre_m: centre_m.into(),
        toes_x_m,
    };
    Column::of_body(body).map_err(|error| {
        let wrong = format!("gives {}; must be {}", plain(error.value), error.allowed);
        table.reject(error.argument, wrong)
    })
}

/// Message about ties of a column with a wall behind it.
const NO_TIES: &str = "cannot be combined with [column.back]: a tie may pull the column against the wall, which no model computes; leave one out";

const DRUMS: Count = Count(1..=MAX_BLOCKS, "each is a block");

/// Keys of `[column]` that need a model with joints.
pub(super) const DRUM_KEYS: [&str; 3] = ["drums", "drum_heights_m", "top_width_m"];

/// Reads `[column]`, the wall behind it and the floor on it. Drums and a taper need a model with joints, unless a floor holds the top.
fn read_column(table: &mut Table<'_>, has_joints: bool) -> ReadResult<(Column, BackAndTop)> {
    let height_m = table.read_required("height_m", &MAGNITUDE);
    let width_m = table.read_required("width_m", &MAGNITUDE);
    let drums = table.optional("drums", &DRUMS);
    let drum_heights_m = table.optional("drum_heights_m", &list_of(&MAGNITUDE));
    let top_width_m = table.optional("top_width_m", &MAGNITUDE);
    let depth_m = table.or("depth_m", &MAGNITUDE, DEPTH_M);
    let density_kg_m3 = table.or("density_kg_m3", &MAGNITUDE, DENSITY_KG_M3);
    let pedestal = table.or("pedestal", &switch(), false);
    let back = table.table("back", back_wall::read);
    let top = table.table("top", held_top::read);
    let needs_model = !has_joints && !table.has_key("top");
    if needs_model && let Some(key) = DRUM_KEYS.into_iter().find(|key| table.has_key(key)) {
        let wrong = "needs a table [free_hinges] or [elastic_joints]: Housner's model is a single prismatic block";
        table.reject(key, wrong);
    }
    table.check_relations(&[
        AtMostOne(&["drums", "drum_heights_m"], GIVE_ONE),
        Excludes("back", "top", held_top::NO_WALL),
    ])?;
    let mut column = Column::new(height_m, width_m)
        .and_then(|column| column.with_depth_m(depth_m))
        .and_then(|column| column.with_density_kg_m3(density_kg_m3))
        .and_then(|column| match drums {
            Some(drums) => column.with_drums(drums),
            None => Ok(column),
        })
        .and_then(|column| match top_width_m {
            Some(top_width_m) => column.with_top_width_m(top_width_m),
            None => Ok(column),
        })
        .expect("the ranges of the keys are within those of a column")
        .on_pedestal(pedestal);
    if let Some(heights_m) = drum_heights_m {
        let drums = column
            .with_drum_heights_m(heights_m)
            .map_err(|error| format!("does not fit: {error}"));
        column = table.accept("drum_heights_m", drums)?;
    }
    Ok((column, (back, top)))
}
