//! Loads: `[[load]]`, on the extrados of an arch or at points of a column.

use super::back_wall::wrong_wall;
use super::prelude::*;
use crate::mechanics::stability::collapse_mechanism;
use crate::mechanics::{ColumnLoadError, Edge, LARGEST_THRUST_N, PlacedLoad};
use crate::{Column, Sway};

/// A `[[load]]`.
#[derive(Clone, Debug)]
pub(super) struct LoadTable {
    /// The load with the given keys and the defaults of the others.
    load: PlacedLoad,
    /// True if `x_m` is given.
    has_position: bool,
}

impl LoadTable {
    pub(super) fn read(table: &mut Table<'_>) -> ReadResult<Self> {
        table.rename("[[load]]");
        let thrust = within(&(-LARGEST_THRUST_N..=LARGEST_THRUST_N));
        let mass_kg = table.optional("mass_kg", &within(&(0.0..=1e15)));
        let x_m = table.optional("x_m", &within(&(-1e6..=1e6)));
        let width_m = table.optional("width_m", &MAGNITUDE);
        let load = PlacedLoad {
            mass_kg: mass_kg.unwrap_or(0.0),
            x_m: x_m.unwrap_or(0.0),
            width_m: width_m.unwrap_or(0.0),
            pier: table.optional("pier", &one_of(Sway::ALL)),
            height_m: table.optional("height_m", &within(&(0.0..=1e12))),
            moves: table.or("moves", &switch(), true),
            live: table.or("live", &switch(), false),
            thrust_n: table.or("thrust_n", &thrust, 0.0),
        };
        table.apply_relations(&[SomeOf(&["mass_kg", "thrust_n"], None)])?;
        let others = ["moves", "thrust_n", "pier", "height_m"];
        let other = others.into_iter().find(|key| table.has_key(key));
        if let Some(other) = other.filter(|_| load.live) {
            let wrong =
                "has no effect on a live load, a weight on the extrados of an arch: leave it out";
            return Err(table.reject(other, wrong));
        }
        Ok(Self {
            load,
            has_position: x_m.is_some(),
        })
    }

    /// Load for an arch or one of its piers.
    ///
    /// # Errors
    /// A key that is missing, or that applies to piers and columns only, with the reason.
    fn place_on_arch(&self) -> Result<PlacedLoad, WrongKey> {
        if self.load.pier.is_none() {
            let wrong = "applies to columns and piers: loads of an arch are on its extrados; leave it out, or give `pier`";
            ensure(self.load.height_m.is_none(), || ("height_m", wrong))?;
            let lacks = "is missing: a load on the extrados has a position; give it, or `pier`";
            ensure(self.has_position, || ("x_m", lacks))?;
        }
        Ok(self.load)
    }

    /// Load for a column.
    ///
    /// # Errors
    /// A key that applies to arches only, with the reason.
    fn place_on_column(&self) -> Result<PlacedLoad, WrongKey> {
        let wrong = "applies to arches: a load on a column acts at a point; leave it out";
        ensure(self.load.width_m == 0.0, || ("width_m", wrong))?;
        ensure(self.load.pier.is_none(), || ("pier", wrong))?;
        let wrong = "applies to arches: loads of other structures are part of them; leave it out";
        ensure(!self.load.live, || ("live", wrong))?;
        Ok(self.load)
    }
}

/// A key of a load that does not fit, and the reason.
type WrongKey = (&'static str, &'static str);

/// Loads for an arch and its piers.
pub(super) fn place_loads_on_arch(
    table: &mut Table<'_>,
    loads: &[LoadTable],
) -> ReadResult<Vec<PlacedLoad>> {
    place_loads(table, loads, LoadTable::place_on_arch)
}

fn place_loads(
    table: &mut Table<'_>,
    loads: &[LoadTable],
    place: fn(&LoadTable) -> Result<PlacedLoad, WrongKey>,
) -> ReadResult<Vec<PlacedLoad>> {
    let loads = loads.iter().enumerate();
    let placed = loads.map(|(index, load)| {
        place(load).map_err(|(key, wrong)| table.reject_in_element(("load", index), key, wrong))
    });
    placed.collect()
}

/// Puts loads on a column, which moves as a row of blocks if `has_joints`.
pub(super) fn loaded_column(
    table: &mut Table<'_>,
    loads: &[LoadTable],
    column: Column,
    (has_joints, gravity_m_s2): (bool, f64),
) -> ReadResult<Column> {
    if loads.is_empty() {
        return Ok(column);
    }
    let placed = place_loads(table, loads, LoadTable::place_on_column)?;
    let wall = column.wall().map(|(wall, _)| wall.side);
    let column = column.with_loads(placed, gravity_m_s2);
    let column = column.map_err(|error| match error {
        ColumnLoadError::Overturns(side) if wall == Some(side) => {
            let wrong = format!(
                "turns the column over the top of the wall on its {0}, foot outwards, without ground motion; give less load or eccentricity to the {0}, or \
                 a wider column",
                side.name()
            );
            table.reject("load", wrong)
        }
        error => why_not(table, &error),
    })?;
    if has_joints && column.top.is_none() {
        let held = column.wall_behind_drums().map(drop);
        held.map_err(|error| wrong_wall(table, &error))?;
        let row = column.row().map_err(|error| error.to_string());
        let falls = row
            .and_then(|row| collapse_mechanism(&row).map_err(|error| error.to_string()))
            .map_err(|wrong| format!("cannot be checked to stand: {wrong}"));
        if let Some(openings) = table.accept("load", falls)? {
            // The intrados of a column is its left side.
            let edge = |side| match side {
                Sway::Left => Some(Edge::Intrados),
                Sway::Right => Some(Edge::Extrados),
            };
            let leans = |side: &Sway| openings.iter().all(|open| open.hinge == edge(*side));
            let wrong = match wall.filter(leans) {
                Some(side) => format!(
                    "leans the column on the wall on its {} before the ground moves, and columns with joints must stand by themselves; give less load, \
                     or leave [elastic_joints] out",
                    side.name()
                ),
                None => "opens joints of the column under its own weight and its loads, without ground motion; give less load, or less eccentricity"
                    .to_owned(),
            };
            return Err(table.reject("load", wrong));
        }
    }
    Ok(column)
}

/// Loads of a column with their defaults, except the height of loads at the top, which follows that of the column.
pub(super) fn with_defaults(loads: &[PlacedLoad]) -> Vec<Value> {
    let keys = |load: &PlacedLoad| {
        let mut keys = json!(load);
        keys["moves"] = json!(load.moves);
        keys["thrust_n"] = json!(load.thrust_n);
        if let Value::Object(keys) = &mut keys
            && load.mass_kg == 0.0
            && load.thrust_n != 0.0
        {
            keys.shift_remove("mass_kg");
        }
        keys
    };
    loads.iter().map(keys).collect()
}

/// Message about ties of a structure with constant forces.
pub(super) const NO_CONSTANT_FORCES: &str = "cannot be combined with a [[load]] that has `thrust_n`, or `moves = false`: the model computes ties or \
                                             constant forces; leave one out";

fn why_not(table: &mut Table<'_>, error: &ColumnLoadError) -> FaultRecorded {
    match error {
        ColumnLoadError::Load(index, error) => {
            let wrong = format!("is not allowed; must be {}", error.allowed);
            table.reject_in_element(("load", *index), error.argument, wrong)
        }
        ColumnLoadError::Wall(error) => wrong_wall(table, error),
        ColumnLoadError::Overturns(side) => {
            let (side, other) = (side.name(), side.opposite().name());
            let wrong = format!(
                "overturns the column to the {side}, without ground motion; give less thrust or eccentricity to that side, or a wider column, or a \
                 load further to the {other}"
            );
            table.reject("load", wrong)
        }
        error => table.reject("load", error),
    }
}
