//! Ties between points of blocks or supports: `[[tie]]`.
//!
//! ```toml
//! [[tie]]
//! height_m = 2.0                 # level, between the intrados on both sides; or between = "springings"; or from_m and to_m
//! area_mm2 = 491.0
//! modulus_gpa = 210.0            # or, instead of both, stiffness_n_m
//! prestress_n = 10e3             # optional
//! yield_stress_mpa = 235.0       # optional; or yield_force_n
//! breaks_at_strain = 0.05        # optional
//! ```

use nalgebra::Vector2;

use super::prelude::*;
use crate::mechanics::MAX_BLOCKS;
use crate::mechanics::TieError;
use crate::mechanics::stability::collapse_mechanism;
use crate::mechanics::{Anchor, Tie};
use crate::{Column, Row};

pub(super) const COORDINATE_M: Number = within(&(-1e6..=1e6));
/// Largest stiffness of a tie, in N/m: a steel bar of 30,000 mm2 with a length of 0.6 m. Stiffer ties are practically rigid, and computations
/// take longer.
const STIFFEST_N_M: f64 = 1e10;
/// Largest number of ties of a structure.
const MOST_TIES: usize = 200;
const BLOCK: Count = Count(
    0..=MAX_BLOCKS,
    "blocks are counted from 1, and 0 is the ground",
);

/// Largest distance of an end of a tie from its named block, over the size of the structure. Curved sides are drawn with straight lines, so a
/// point may be slightly outside.
const NEAR_RATIO: f64 = 0.01;

named! {
    /// Named ends of a tie.
    pub enum TieEnds {
        /// The intrados corners of the springings.
        Springings = "springings",
    }
}

/// The contents of `[[tie]]`, in the units of the keys.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TieTable {
    /// Named ends; `None` if the ends are given by coordinates or height.
    pub between: Option<TieEnds>,
    /// Height of a horizontal tie between the intrados on both sides, in m; `None` if the ends are given otherwise.
    pub height_m: Option<f64>,
    /// Coordinates of the first end, in m; `None` if the ends are given otherwise.
    pub from_m: Option<[f64; 2]>,
    /// Block of the first end, from 1; 0 is the ground; `None` if the coordinates determine it.
    pub from_block: Option<usize>,
    /// Coordinates of the second end, in m; `None` if the ends are given otherwise.
    pub to_m: Option<[f64; 2]>,
    /// Block of the second end, from 1; 0 is the ground; `None` if the coordinates determine it.
    pub to_block: Option<usize>,
    /// Area of the section, in mm2; `None` if the stiffness is given.
    pub area_mm2: Option<f64>,
    /// Young's modulus, in GPa; `None` if the stiffness is given.
    pub modulus_gpa: Option<f64>,
    /// Stiffness, in N/m; `None` if area and modulus are given.
    pub stiffness_n_m: Option<f64>,
    /// Force in the undeformed structure, in N.
    pub prestress_n: f64,
    /// Yield force, in N; `None` if the tie does not yield, or its yield stress is given.
    pub yield_force_n: Option<f64>,
    /// Yield stress, in MPa; `None` if the tie does not yield, or its yield force is given.
    pub yield_stress_mpa: Option<f64>,
    /// Strain at which the tie breaks; `None` if it does not break.
    pub breaks_at_strain: Option<f64>,
}

impl TieTable {
    /// Reads all tables `[[tie]]`.
    pub(super) fn read_all(table: &mut Table<'_>) -> Vec<Self> {
        let ties = table.tables("tie", Self::read);
        let count = ties.len();
        if count > MOST_TIES {
            let wrong = format!(
                "is one of {count} ties; must be at most {MOST_TIES}: join those that lie side by side"
            );
            table.reject_element("tie", MOST_TIES, wrong);
        }
        ties
    }

    fn read(table: &mut Table<'_>) -> ReadResult<Self> {
        let stiffness = within(&(1e-3..=STIFFEST_N_M));
        let stress = within(&(1e-3..=1e5));
        let read = Self {
            between: table.optional("between", &one_of(TieEnds::ALL)),
            height_m: table.optional("height_m", &COORDINATE_M),
            from_m: read_point(table, "from_m"),
            from_block: table.optional("from_block", &BLOCK),
            to_m: read_point(table, "to_m"),
            to_block: table.optional("to_block", &BLOCK),
            area_mm2: table.optional("area_mm2", &within(&(1e-3..=1e9))),
            modulus_gpa: table.optional("modulus_gpa", &within(&(1e-4..=1e4))),
            stiffness_n_m: table.optional("stiffness_n_m", &stiffness),
            prestress_n: table.or("prestress_n", &within(&(0.0..=1e12)), 0.0),
            yield_force_n: table.optional("yield_force_n", &within(&(1e-6..=1e12))),
            yield_stress_mpa: table.optional("yield_stress_mpa", &stress),
            breaks_at_strain: table.optional("breaks_at_strain", &within(&(1e-6..=10.0))),
        };
        table.apply_relations(&[
            OneOf(&["between", "height_m", "from_m"], None),
            Together(&["from_m", "to_m"]),
            Requires("from_block", "from_m", " beside it"),
            Requires("to_block", "to_m", " beside it"),
            OneOf(&["area_mm2", "stiffness_n_m"], None),
            Together(&["area_mm2", "modulus_gpa"]),
            AtMostOne(&["yield_force_n", "yield_stress_mpa"], GIVE_ONE),
            Requires("yield_stress_mpa", "area_mm2", " beside it"),
        ])?;
        Ok(read)
    }

    /// Makes the tie of a row of blocks. `springings` are the joints of its springings, if it has any.
    ///
    /// # Errors
    /// The change that the tie needs.
    fn place_tie(&self, row: &Row, springings: Option<[usize; 2]>) -> Result<Tie, String> {
        let ends = self.find_ends(row, springings)?;
        let [first, second] = ends.map(|end| end.at_m);
        let length_m = (second - first).norm();
        let stiffness_n_m = match (self.area_mm2, self.modulus_gpa, self.stiffness_n_m) {
            // A square millimetre times a GPa is a thousand newtons.
            (Some(area_mm2), Some(modulus_gpa), _) => 1e3 * area_mm2 * modulus_gpa / length_m,
            (_, _, stiffness_n_m) => stiffness_n_m.unwrap_or(0.0),
        };
        ensure(stiffness_n_m <= STIFFEST_N_M, || {
            let [stiffness, length] = [stiffness_n_m, length_m].map(short);
            format!(
                "has a stiffness of {stiffness} N/m by its section and its length of {length} m; must be at most {STIFFEST_N_M:e} N/m: give a \
                 smaller `area_mm2` or `modulus_gpa`"
            )
        })?;
        let by_section = self
            .yield_stress_mpa
            .zip(self.area_mm2)
            .map(|(mpa, mm2)| mpa * mm2);
        let tie = Tie {
            ends,
            stiffness_n_m,
            prestress_n: self.prestress_n,
            yield_force_n: self.yield_force_n.or(by_section).unwrap_or(f64::INFINITY),
            breaks_at_strain: self.breaks_at_strain.unwrap_or(f64::INFINITY),
        };
        Err(match tie.check(row.blocks.len(), row.size_m) {
            Ok(()) => return Ok(tie),
            Err(TieError::OnSupports) if self.between.is_some() => {
                "is between springings that both stand on rigid ground, which a tie cannot move: give [piers], or \
                 tie voussoirs with `height_m`"
                    .to_owned()
            }
            Err(TieError::OneBlock(block)) => format!(
                "has both ends on block {}, which is rigid: tie two blocks, or a block and the ground (block 0)",
                block + 1
            ),
            Err(TieError::OnSupports) => {
                "has both ends on the ground, which a tie cannot move: give one of them on a block".to_owned()
            }
            Err(TieError::NoLength) => {
                "has both ends at one point: give two points that are apart".to_owned()
            }
            Err(error) => format!("is not a valid tie: {error}"),
        })
    }

    fn find_ends(&self, row: &Row, springings: Option<[usize; 2]>) -> Result<[Anchor; 2], String> {
        if let (Some(from_m), Some(to_m)) = (self.from_m, self.to_m) {
            return Ok([
                anchor(row, from_m, self.from_block, "from")?,
                anchor(row, to_m, self.to_block, "to")?,
            ]);
        }
        if let Some(height_m) = self.height_m {
            return points_at_height(row, height_m);
        }
        let missing = "is between springings, which only arches given by their dimensions have: give `from_m` and `to_m`";
        let [left, right] = springings.ok_or(missing)?;
        let end = |joint: usize, block: Option<usize>| {
            let at_m = row.joints[joint].intrados_m;
            Anchor { block, at_m }
        };
        // The piers of the arch: the block before the left springing, and the block after the right springing.
        let behind = (right < row.blocks.len()).then_some(right);
        Ok([end(left, left.checked_sub(1)), end(right, behind)])
    }
}

fn read_point(table: &mut Table<'_>, key: &str) -> Option<[f64; 2]> {
    let numbers = table.optional(key, &list_of(&COORDINATE_M))?;
    let point = <[f64; 2]>::try_from(numbers);
    let wrong = "has not two elements; must be a point [x, y] in m";
    table.accept(key, point.map_err(|_| wrong)).ok()
}

/// Point of a block, or of the ground if `block` is 0.
fn anchor(row: &Row, point_m: [f64; 2], block: Option<usize>, end: &str) -> Result<Anchor, String> {
    let at_m = Vector2::from(point_m);
    let point = format!("({:?}, {:?}) m", at_m.x, at_m.y);
    let blocks = row.blocks.len();
    let ground = || format!("for a point of the ground give `{end}_block = 0`");
    let block = match (block, &row.blocks_at(at_m)[..]) {
        (Some(0), _) => None,
        (Some(number), _) => {
            ensure(number <= blocks, || {
                format!(
                    "has `{end}_block = {number}`: there are {blocks} blocks, counted from 1; 0 is the ground"
                )
            })?;
            let away_m = row.distance_m(number - 1, at_m);
            ensure(away_m <= NEAR_RATIO * row.size_m, || {
                format!(
                    "has an end at {point}, {away_m:.4} m away from block {number}: give a point of that block; {}",
                    ground()
                )
            })?;
            Some(number - 1)
        }
        (None, [index]) => Some(*index),
        (None, []) => {
            let away = (0..blocks).map(|index| (row.distance_m(index, at_m), index + 1));
            let nearest = away.min_by(|one, other| one.0.total_cmp(&other.0));
            let nearest = nearest.map_or(String::new(), |(away_m, number)| {
                format!("; the nearest, {number}, is {away_m:.4} m away")
            });
            return Err(format!(
                "has an end at {point}, in no block{nearest}: give a point of a block; {}",
                ground()
            ));
        }
        (None, these) => {
            let numbers: Vec<String> = these.iter().map(|index| (index + 1).to_string()).collect();
            return Err(format!(
                "has an end at {point}, on the edge of blocks {}: choose one of them by `{end}_block`",
                numbers.join(" and ")
            ));
        }
    };
    Ok(Anchor { block, at_m })
}

/// The two points of the intrados at a height. The intrados is a straight line between joints.
fn points_at_height(row: &Row, height_m: f64) -> Result<[Anchor; 2], String> {
    let pairs = row.joints.windows(2).enumerate();
    let crossings: Vec<Anchor> = pairs
        .filter_map(|(block, pair)| {
            let (from, to) = (pair[0].intrados_m, pair[1].intrados_m);
            let crosses = (from.y <= height_m) != (to.y <= height_m);
            crosses.then(|| Anchor {
                block: Some(block),
                at_m: from + (to - from) * ((height_m - from.y) / (to.y - from.y)),
            })
        })
        .collect();
    <[Anchor; 2]>::try_from(crossings).map_err(|_| {
        let corners = row.joints.iter().map(|joint| joint.intrados_m.y);
        let lowest = corners.clone().fold(f64::INFINITY, f64::min);
        let highest = corners.fold(f64::NEG_INFINITY, f64::max);
        format!(
            "is at a height of {height_m:?} m, where the intrados is not crossed on both sides: give a height between {lowest:.4} \
             and {highest:.4} m, or `from_m` and `to_m`"
        )
    })
}

/// Makes the ties of a structure.
pub(super) fn place_ties(
    table: &mut Table<'_>,
    ties: &[TieTable],
    (row, springings): (&Row, Option<[usize; 2]>),
) -> ReadResult<Vec<Tie>> {
    let placed = ties.iter().enumerate().map(|(index, tie)| {
        let placed = tie.place_tie(row, springings);
        placed.map_err(|wrong| table.reject_element("tie", index, wrong))
    });
    placed.collect()
}

/// Adds ties to a column, which may have drums.
pub(super) fn tied_column(
    table: &mut Table<'_>,
    ties: &[TieTable],
    column: Column,
    gravity_m_s2: f64,
) -> ReadResult<Column> {
    if ties.is_empty() {
        return Ok(column);
    }
    let row = column.row();
    let row = row.map_err(|error| format!("makes no row of blocks: {error}"));
    let row = table.accept("column", row)?;
    let ties = place_ties(table, ties, (&row, None))?;
    let column = column
        .with_ties(ties, gravity_m_s2)
        .map_err(|(index, error)| table.reject_element("tie", index, error))?;
    if column.top.is_some() {
        return Ok(column);
    }
    let row = column.row().map_err(|error| error.to_string());
    let falls = row
        .and_then(|row| collapse_mechanism(&row).map_err(|error| error.to_string()))
        .map_err(|wrong| format!("cannot be checked to stand: {wrong}"));
    let falls = table.accept("column", falls)?.is_some();
    table.refuse(falls, "tie", PULLS_OVER)?;
    Ok(column)
}

/// Message about ties whose prestress overturns a structure that stands without them.
pub(super) const PULLS_OVER: &str = "overturns the structure, which stands without ties: give less `prestress_n`, or tie other points";
