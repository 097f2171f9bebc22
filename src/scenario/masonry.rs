//! Arches of other shapes, blocks from files, and additions to any arch: `[pointed_arch]`, `[elliptic_arch]`,
//! `[basket_arch]`, `[blocks]`; `[piers]`, `[fill]`, `[[load]]`, `[vehicle]`.
//!
//! ```toml
//! [blocks]
//! joints = "joints.csv"          # a row a joint: x and y of the intrados corner, then of the extrados corner, in m
//! decimal = "point"              # or "comma": decimal mark of the numbers in these files
//! outlines = "outlines.csv"      # optional: block (from 1), x, y
//! supports = "both"              # or "left": a stack, whose last joint is its free top
//! density_kg_m3 = 2000.0         # or an array, one for each block
//! ```

use nalgebra::Vector2;

use super::LineFault;
use super::files::Files;
use super::load::{self, LoadTable, NO_CONSTANT_FORCES};
use super::prelude::*;
use super::record::{Decimal, faulty, layout, read_numbers};
use super::tie::{self, PULLS_OVER, TieTable};
use crate::Masonry;
use crate::argument::ArgumentError;
use crate::mechanics::masonry::{
    BasketArch, Dimensions, Fill, FillLevel, GivenBlocks, MAX_AXLES, MasonryError, Material, Pier,
    Piers, Remedy, Spread, Vehicle,
};
use crate::mechanics::stability::collapse_mechanism;
use crate::mechanics::{DENSITY_KG_M3, DEPTH_M, MAX_BLOCKS};
use crate::mechanics::{Joint, MasonryShape, MeasuredAt, PlacedLoad, RowError, Supports};

const PIER_BLOCKS: Count = Count(1..=MAX_BLOCKS, "a pier of one piece");

/// The shapes that have tables of their own.
pub(super) const SHAPES: [&str; 4] = ["pointed_arch", "elliptic_arch", "basket_arch", "blocks"];

/// Reads the shapes that have separate tables, and returns the first given one.
pub(super) fn read_shapes(table: &mut Table<'_>) -> Option<MasonryShape> {
    let pointed = table.table("pointed_arch", |table| read_dimensions(table, true));
    let elliptic = table.table("elliptic_arch", |table| read_dimensions(table, false));
    let basket = table.table("basket_arch", |table| {
        Ok(BasketArch {
            crown_deg: table.or("crown_deg", &above(0.0, 179.0), BasketArch::CROWN_DEG),
            dimensions: read_dimensions(table, false)?,
        })
    });
    let blocks = table.table("blocks", read_blocks);
    let pointed = pointed.map(MasonryShape::PointedArch);
    let elliptic = elliptic.map(MasonryShape::EllipticArch);
    let basket = basket.map(MasonryShape::BasketArch);
    let blocks = blocks.map(MasonryShape::Blocks);
    pointed.or(elliptic).or(basket).or(blocks)
}

/// Reads the dimensions and converts span and rise to those of the middle line.
fn read_dimensions(table: &mut Table<'_>, is_pointed: bool) -> ReadResult<Dimensions> {
    let measured_at = table.or("measured_at", &one_of(MeasuredAt::ALL), MeasuredAt::Mean);
    let mut span_m = table.read_required("span_m", &MAGNITUDE);
    let mut rise_m = table.read_required("rise_m", &MAGNITUDE);
    let thickness_m = table.read_required("thickness_m", &within(&(1e-6..=1e6)));
    if measured_at != MeasuredAt::Mean {
        let outwards_m = measured_at.to_mean() * thickness_m;
        // The arcs of a pointed arch keep their centres.
        let centre_m = rise_m * rise_m / span_m - 0.25 * span_m;
        span_m += 2.0 * outwards_m;
        rise_m = match is_pointed {
            true => (0.5 * span_m * (0.5 * span_m + 2.0 * centre_m)).sqrt(),
            false => rise_m + outwards_m,
        };
        let wrong = format!("leaves no arch {} m thick", plain(thickness_m));
        table.refuse(
            span_m.min(rise_m).is_nan() || span_m <= 0.0 || rise_m <= 0.0,
            "span_m",
            wrong,
        )?;
    }
    Ok(Dimensions {
        span_m,
        rise_m,
        thickness_m,
        voussoirs: table.read_required("voussoirs", &VOUSSOIRS),
        material: Material {
            depth_m: table.or("depth_m", &MAGNITUDE, DEPTH_M),
            density_kg_m3: table.or("density_kg_m3", &MAGNITUDE, DENSITY_KG_M3),
        },
    })
}

fn read_blocks(table: &mut Table<'_>) -> ReadResult<GivenBlocks> {
    let joints_file = table.read_required("joints", &text());
    let outlines_file = table.optional("outlines", &text());
    let decimal = layout::decimal(table);
    let supports = table.or("supports", &one_of(Supports::ALL), Supports::Both);
    let depth_m = table.or("depth_m", &MAGNITUDE, DEPTH_M);
    let densities = one_or_more(&MAGNITUDE);
    let density_kg_m3 = table.or("density_kg_m3", &densities, vec![DENSITY_KG_M3]);
    table.check_faultless()?;
    let path = table.files().path(&joints_file);
    let rows = table.accept("joints", read_numbers::<4>(table.files(), &path, decimal))?;
    table.note_file(&joints_file);
    let (count, most) = (rows.len(), MAX_BLOCKS + 1);
    let wrong = format!(
        "has {count} joints; must be from 2 to {most}: blocks lie between joints, and a row has at most {MAX_BLOCKS}"
    );
    table.refuse(!(2..=most).contains(&count), "joints", wrong)?;
    let joints = rows.iter().map(|(_, [xi, yi, xe, ye])| Joint {
        intrados_m: Vector2::new(*xi, *yi),
        extrados_m: Vector2::new(*xe, *ye),
    });
    let mut given = GivenBlocks {
        joints_file,
        outlines_file,
        decimal: (decimal != Decimal::Point).then(|| decimal.name()),
        supports,
        depth_m,
        density_kg_m3,
        joints: joints.collect(),
        outlines: Vec::new(),
    };
    let fits = given.check().map_err(|error| {
        let (count, allowed) = (error.value, error.allowed);
        format!("has {count} elements; must be {allowed}")
    });
    table.accept("density_kg_m3", fits)?;
    if let Some(file) = &given.outlines_file {
        let outlines = read_outlines(table.files(), file, &given, decimal);
        given.outlines = table.accept("outlines", outlines)?;
        table.note_file(file);
    }
    // If the blocks do not form a row, the error names the line of the joint.
    let shape = MasonryShape::Blocks(given.clone());
    let wrong = match Masonry::new(shape, Piers::default(), None, Vec::new()) {
        Ok(_) => return Ok(given),
        Err(MasonryError::Row(error)) => {
            let joint = GivenBlocks::joint_of(&error).unwrap_or(0);
            let line = rows.get(joint).map_or(1, |(line, _)| *line);
            let message = why_no_row(&error);
            faulty(&path, &LineFault { line, message })
        }
        Err(error) => {
            let (line, message) = (rows[0].0, error.to_string());
            faulty(&path, &LineFault { line, message })
        }
    };
    Err(table.reject("joints", wrong))
}

/// Reason why blocks do not form a row, with blocks and joints counted as in the files.
fn why_no_row(error: &RowError) -> String {
    match error {
        RowError::Crossing(first) => format!(
            "this joint crosses or touches the one before (joint {first}): a block lies between two joints; move its \
             corners apart"
        ),
        RowError::Order { block, .. } => format!(
            "block {} is not on its side of this joint: give the joints from left to right and at each the intrados \
             corner first",
            block + 1
        ),
        RowError::Block("mass in kg" | "inertia in kg m2", index, ..) => format!(
            "block {} from this joint to the next has no area: check its corners, and that at every joint the intrados corner \
             comes first",
            index + 1
        ),
        RowError::Thickness(_, value) => {
            format!("this joint is {value:?} m long: its two corners must be apart")
        }
        other => other.to_string(),
    }
}

fn read_outlines(
    files: &Files,
    file: &str,
    given: &GivenBlocks,
    decimal: Decimal,
) -> Result<Outlines, String> {
    let path = &files.path(file);
    let rows = read_numbers::<3>(files, path, decimal)?;
    let blocks = given.joints.len() - 1;
    let fault = |line: usize, message: String| faulty(path, &LineFault { line, message });
    let mut outlines = Outlines::new();
    let mut lines = Vec::new();
    for (line, [block, x, y]) in rows {
        let index = (0..blocks).find(|index| (index + 1) as f64 == block);
        let missing =
            || format!("there is no block {block}: blocks are counted from 1 to {blocks}");
        let index = index.ok_or_else(|| fault(line, missing()))?;
        let corner = Vector2::new(x, y);
        let known = outlines.iter().position(|(known, _)| *known == index);
        match known {
            None => {
                outlines.push((index, vec![corner]));
                lines.push(line);
            }
            Some(known) if known + 1 == outlines.len() => outlines[known].1.push(corner),
            Some(_) => {
                let wrong =
                    format!("block {block} comes back: give the corners of a block together");
                return Err(fault(line, wrong));
            }
        }
    }
    for ((block, corners), line) in outlines.iter().zip(lines) {
        let fits = given.check_outline(*block, corners);
        fits.map_err(|error| fault(line, error.to_string()))?;
    }
    Ok(outlines)
}

/// Corners of the outlines of blocks, with the indices of the blocks.
type Outlines = Vec<(usize, Vec<Vector2<f64>>)>;

/// Additions to an arch: piers, fill and loads.
pub(super) struct Additions {
    piers: Piers,
    fill: Option<Fill>,
    vehicle: Option<Vehicle>,
    pub loads: Vec<LoadTable>,
    pub ties: Vec<TieTable>,
}

impl Additions {
    pub fn read(table: &mut Table<'_>) -> ReadResult<Self> {
        let before = table.faults();
        let read = Self {
            piers: table.table("piers", read_piers).unwrap_or_default(),
            fill: table.table("fill", read_fill),
            vehicle: table.table("vehicle", read_vehicle),
            loads: table.tables("load", LoadTable::read),
            ties: TieTable::read_all(table),
        };
        ensure(table.faults() == before, || FaultRecorded).map(|()| read)
    }

    pub fn is_empty(&self) -> bool {
        self.fits_column() && self.loads.is_empty() && self.ties.is_empty()
    }

    pub fn fits_column(&self) -> bool {
        self.piers.are_none() && self.fill.is_none() && self.vehicle.is_none()
    }

    /// Records that the additions do not fit a structure of this kind.
    pub fn reject_all(&self, table: &mut Table<'_>, wrong: &str) -> FaultRecorded {
        let key = match self {
            _ if !self.piers.are_none() => "piers",
            Self { fill: Some(_), .. } => "fill",
            Self {
                vehicle: Some(_), ..
            } => "vehicle",
            _ => "load",
        };
        table.reject(key, wrong)
    }

    /// Makes the arch with its additions and ties. A fault is recorded if it cannot stand, unless that is `unproved`.
    pub fn build_masonry(
        self,
        table: &mut Table<'_>,
        shape: MasonryShape,
        (gravity_m_s2, unproved): (f64, bool),
    ) -> ReadResult<Masonry> {
        let key = shape.name();
        if self.piers.are_none() && table.has_key_in("fill", "on_piers") {
            let wrong = "has no effect without [piers]: leave it out";
            return Err(table.reject_in(&["fill"], "on_piers", wrong));
        }
        let loads = load::place_loads_on_arch(table, &self.loads)?;
        let is_loaded = loads.iter().any(|load| load.live);
        table.refuse(
            is_loaded && self.vehicle.is_some(),
            "vehicle",
            "cannot be combined with a live load: both would grow; leave one out",
        )?;
        let vehicle = self.vehicle.clone();
        let masonry = Masonry::new(shape, self.piers, self.fill, loads)
            .and_then(|masonry| match vehicle {
                Some(vehicle) => masonry.with_vehicle(vehicle),
                None => Ok(masonry),
            })
            .map_err(|error| self.reject_for(table, key, &error))?;
        let on = (&masonry.row, masonry.springing_joints());
        let ties = tie::place_ties(table, &self.ties, on)?;
        let is_tied = !ties.is_empty();
        let tied = masonry.with_ties(ties, gravity_m_s2);
        let mut masonry =
            tied.map_err(|(index, error)| table.reject_element("tie", index, error))?;
        if !is_tied {
            masonry = masonry.with_constant_forces(gravity_m_s2);
        }
        let constant = |load: &PlacedLoad| load.constant_force_n(gravity_m_s2) != Vector2::zeros();
        let is_pushed = masonry.loads.iter().any(constant);
        table.refuse(is_tied && is_pushed, "tie", NO_CONSTANT_FORCES)?;
        if unproved {
            return Ok(masonry);
        }
        match collapse_mechanism(&masonry.row) {
            Ok(None) => Ok(masonry),
            Ok(Some(_)) if stands_without_ties(&masonry) => Err(table.reject("tie", PULLS_OVER)),
            Ok(Some(openings)) => {
                let joints: Vec<_> = openings.iter().map(|o| o.joint.to_string()).collect();
                Err(why_it_falls(table, &masonry, &joints.join(", ")))
            }
            Err(error) => Err(table.reject(key, format!("cannot be checked to stand: {error}"))),
        }
    }

    fn reject_for(
        &self,
        table: &mut Table<'_>,
        shape: &'static str,
        error: &MasonryError,
    ) -> FaultRecorded {
        let allowed = |error: &ArgumentError| format!("is not allowed; must be {}", error.allowed);
        match error {
            MasonryError::Shape(error) => {
                table.reject_in(&[shape], error.argument, allowed(error))
            }
            MasonryError::Pier(side, error) => {
                let side = side.name();
                let wrong = format!("of the {side} pier {}", allowed(error));
                table.reject_in(&["piers", side], error.argument, wrong)
            }
            MasonryError::Fill(error) => table.reject_in(&["fill"], error.argument, allowed(error)),
            MasonryError::Vehicle(error) => {
                table.reject_in(&["vehicle"], error.argument, allowed(error))
            }
            MasonryError::NoFill => {
                let wrong = match shape {
                    "blocks" => "spreads the axles through fill, which [blocks] do not have: leave it out",
                    _ => "spreads the axles through fill: give [fill], or spread = \"none\"",
                };
                table.reject_in(&["vehicle"], "spread", wrong)
            }
            MasonryError::NoRoad => {
                table.reject("vehicle", format!("does not fit: {error}; leave it out"))
            }
            MasonryError::Load(index, error) => {
                table.reject_in_element(("load", *index), error.argument, allowed(error))
            }
            MasonryError::NoPier(index, _) => {
                let wrong = "names a pier that the arch does not have; give [piers], or leave `pier` out";
                table.reject_in_element(("load", *index), "pier", wrong)
            }
            MasonryError::Blocks => self.reject_all(
                table,
                "goes with arches that are given by their dimensions: give piers and fill of [blocks] as blocks",
            ),
            MasonryError::Count(_) => table.reject("piers", format!("makes {error}")),
            MasonryError::Row(error) => table.reject(
                shape,
                format!("makes no row of blocks: {error}; give fewer voussoirs or a smaller thickness"),
            ),
            _ => table.reject(shape, error),
        }
    }
}

fn stands_without_ties(masonry: &Masonry) -> bool {
    let row = &masonry.row;
    !row.bars().is_empty() && matches!(collapse_mechanism(&row.clone().without_ties()), Ok(None))
}

/// Keys of a pier.
const PIER_KEYS: [&str; 5] = ["height_m", "width_m", "density_kg_m3", "blocks", "pedestal"];

/// Reads `[piers]`. Its keys hold for both piers; `[piers.left]` and `[piers.right]` may override them.
fn read_piers(table: &mut Table<'_>) -> ReadResult<Piers> {
    let both = ["height_m", "width_m", "density_kg_m3"].map(|key| {
        let value = table.optional(key, &MAGNITUDE);
        // A wrong value must not be reported as missing.
        value.or(table.has_key(key).then_some(1.0))
    });
    let blocks = table.optional("blocks", &PIER_BLOCKS);
    let pedestal = table.optional("pedestal", &switch());
    let one = |table: &mut Table<'_>| {
        let mut number = |key, both: Option<f64>| match both {
            Some(both) => table.or(key, &MAGNITUDE, both),
            None => {
                let own = table.optional(key, &MAGNITUDE);
                table.needed(key, &MAGNITUDE, own)
            }
        };
        Ok(Pier {
            height_m: number("height_m", both[0]),
            width_m: number("width_m", both[1]),
            density_kg_m3: table.optional("density_kg_m3", &MAGNITUDE).or(both[2]),
            blocks: table.or("blocks", &PIER_BLOCKS, blocks.unwrap_or(1)),
            pedestal: table.or("pedestal", &switch(), pedestal.unwrap_or(false)),
        })
    };
    let (left, right) = (table.table("left", one), table.table("right", one));
    for key in PIER_KEYS {
        let is_unused = ["left", "right"]
            .iter()
            .all(|side| table.has_key_in(side, key));
        let wrong = "has no effect: [piers.left] and [piers.right] give their own; leave it out, or change it in these tables";
        let _ = table.refuse(is_unused && table.has_key(key), key, wrong);
    }
    table.check_faultless()?;
    // If `[piers]` itself has values, both piers exist.
    let has_values = blocks.is_some() || both.iter().any(Option::is_some);
    if [&left, &right].iter().filter(|pier| pier.is_some()).count() > usize::from(has_values) {
        return Ok(Piers { left, right });
    }
    let mut value = |key: &str, value: Option<f64>| {
        value.ok_or_else(|| {
            table.fault_of_table(format!(
                "lacks `{key}`: give it for both piers, or give [piers.left] and [piers.right]"
            ))
        })
    };
    let pier = Pier {
        height_m: value("height_m", both[0])?,
        width_m: value("width_m", both[1])?,
        blocks: blocks.unwrap_or(1),
        density_kg_m3: both[2],
        pedestal: pedestal.unwrap_or(false),
    };
    Ok(Piers {
        left: left.or(Some(pier)),
        right: right.or(Some(pier)),
    })
}

fn read_fill(table: &mut Table<'_>) -> ReadResult<Fill> {
    let height_m = table.optional("height_m", &MAGNITUDE);
    let above_crown_m = table.optional("above_crown_m", &within(&(0.0..=1e6)));
    let density_kg_m3 = table.read_required("density_kg_m3", &MAGNITUDE);
    let on_piers = table.or("on_piers", &switch(), true);
    table.apply_relations(&[OneOf(&["height_m", "above_crown_m"], None)])?;
    let level = height_m.map(FillLevel::AboveSpringing);
    Ok(Fill {
        level: level
            .or(above_crown_m.map(FillLevel::AboveCrown))
            .ok_or(FaultRecorded)?,
        density_kg_m3,
        on_piers,
    })
}

/// Reads `[vehicle]`.
fn read_vehicle(table: &mut Table<'_>) -> ReadResult<Vehicle> {
    let axles_kg = table.read_required("axles_kg", &list_of(&MAGNITUDE));
    let spacing_m = table.optional("spacing_m", &list_of(&within(&(1e-3..=1e6))));
    let spread = table.or("spread", &one_of(Spread::ALL), Spread::None);
    table.check_faultless()?;
    let (axles, spacings) = (axles_kg.len(), spacing_m.as_ref().map_or(0, Vec::len));
    table.refuse(
        axles_kg.is_empty(),
        "axles_kg",
        "has no axle: give their loads in kg",
    )?;
    let wrong = format!("has {axles} axles: give at most {MAX_AXLES}");
    table.refuse(axles > MAX_AXLES, "axles_kg", wrong)?;
    if spacings + 1 != axles {
        let wrong = format!(
            "has {axles} axles and {spacings} distances between them: give the distance of each axle from the one before in `spacing_m`"
        );
        return Err(table.fault_of_table(wrong));
    }
    Ok(Vehicle {
        axles_kg,
        spacing_m: spacing_m.unwrap_or_default(),
        spread,
    })
}

/// Records that the masonry collapses under its own weight, with remedies.
fn why_it_falls(table: &mut Table<'_>, masonry: &Masonry, joints: &str) -> FaultRecorded {
    let shape = masonry.shape.name();
    let falls = format!(
        "cannot carry its own weight: it opens at joints {joints} (0: the left base or springing)"
    );
    match masonry.remedy() {
        Remedy::WiderPiers(factor) => {
            let wider = |factor| format!("it stands with piers {factor:.4} times as wide");
            let remedy = factor.map_or("give wider or lower piers".to_owned(), wider);
            let wrong = format!(
                "gives piers that are too slender for this arch, which stands on rigid ground: joints {joints} open under \
                 its weight; {remedy}"
            );
            table.reject("piers", wrong)
        }
        Remedy::LessLoad(factor) => {
            let thicker = |factor| format!(", or an arch {factor:.4} times as thick");
            let thicker = factor.map_or_else(String::new, thicker);
            let wrong = format!(
                "overloads the structure, which stands without it: joints {joints} open; give less load, or spread it{thicker}"
            );
            table.reject("load", wrong)
        }
        Remedy::ThickerArch(Some(factor)) => {
            let wrong = format!("{falls}; it stands if it is {factor:.4} times as thick");
            let mut keys = ["thickness_m", "thickness_ratio"].into_iter();
            match keys.find(|key| table.has_key_in(shape, key)) {
                Some(key) => table.reject_in(&[shape], key, format!("makes an arch that {wrong}")),
                None => table.reject(shape, wrong),
            }
        }
        Remedy::ThickerArch(None) => {
            table.reject(shape, format!("{falls}; give a thicker arch, or less load"))
        }
    }
}
