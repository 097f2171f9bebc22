//! Mistakes in the structure, its joints and the demand on it that only several numbers together show.

use std::ops::RangeInclusive;

use super::{Numbers, Unlikely, plain};
use crate::Column;
use crate::mechanics::masonry::Vehicle;
use crate::scenario::Scenario;

impl Scenario {
    /// Mistakes that only several numbers together show.
    pub(super) fn unlikely_together(&self, numbers: &Numbers) -> Vec<Unlikely> {
        let column = self
            .structure
            .column()
            .filter(|column| column.given.is_none());
        let alone = column.into_iter().flat_map(|column| {
            [
                width_exchanged(column),
                released_beyond_balance(column, numbers),
            ]
        });
        let loads = column.into_iter().flat_map(loads_beside);
        let vehicle = self.structure.under_live_loads();
        let vehicle = vehicle.and_then(|masonry| masonry.vehicle.as_ref());
        let axles = vehicle.into_iter().flat_map(unlikely_axles);
        let found = alone.flatten().chain(loads).chain(axles);
        let body = self.structure.column().and_then(odd_inertia);
        let others = [stiff_mortar(numbers), falling_hazard(numbers), body];
        found.chain(others.into_iter().flatten()).collect()
    }
}

/// Warning about a column that is wider than twice its height: it rocks under no ground motion below 2 g.
fn width_exchanged(column: &Column) -> Option<Unlikely> {
    let (height_m, width_m) = (column.height_m, column.width_m);
    (width_m > 2.0 * height_m).then(|| {
        let [height, width] = [height_m, width_m].map(plain);
        let warning = format!(
            "the column is {height} m high and {width} m wide: are height and width exchanged?"
        );
        Unlikely::new("column.width_m", width_m, "m", warning)
    })
}

/// Warning about a body whose radius of gyration is far from that of bodies of its size. A block has 0.58 times the distance of its centre from a
/// toe, a ring or a hollow body at most about 1.
fn odd_inertia(column: &Column) -> Option<Unlikely> {
    let body = column.given?;
    let reach_m = column.half_diagonal_m();
    let gyration_m = (body.inertia_kg_m2 / body.mass_kg).sqrt();
    let is_usual = (0.15..=1.5).contains(&(gyration_m / reach_m));
    (!is_usual).then(|| {
        let [gyration, reach] = [gyration_m, reach_m].map(plain);
        let warning = format!(
            "the radius of gyration of the body is {gyration} m, and its half diagonal about {reach} m: is the inertia in kg m2, about the centre of \
             gravity?"
        );
        Unlikely::new("body.inertia_kg_m2", body.inertia_kg_m2, "kg m2", warning)
    })
}

/// Warning about a column that is released beyond its unstable equilibrium, from where it falls.
fn released_beyond_balance(column: &Column, numbers: &Numbers) -> Option<Unlikely> {
    let key = "initial.rotation_rad";
    let rotation_rad = numbers.get(key).filter(|_| column.is_one_prism())?;
    let slenderness_rad = column.slenderness_rad();
    (rotation_rad > slenderness_rad).then(|| {
        let [rotation, slenderness] = [rotation_rad, slenderness_rad].map(plain);
        let warning =
            format!("the initial rotation is {rotation} rad, beyond the balance of the column at {slenderness} rad: is it in degrees?");
        Unlikely::new(key, rotation_rad, "rad", warning).in_unit("degrees")
    })
}

/// Warnings about loads that are more than its width outside of the faces of a column.
fn loads_beside(column: &Column) -> impl Iterator<Item = Unlikely> {
    let width_m = column.width_m;
    let loads = (1..).zip(&column.loads);
    let beside = loads.filter(move |(_, load)| load.x_m.abs() > 1.5 * width_m);
    beside.map(move |(number, load)| {
        let (x, width) = (plain(load.x_m), plain(width_m));
        let warning = format!(
            "load {number} is at x = {x} m, far beside the column, {width} m wide: is it in metres from the axis?"
        );
        Unlikely::new(format!("load.{number}.x_m"), load.x_m, "m", warning)
    })
}

/// Warnings about axles that are lighter than a hand cart or heavier than any road bridge bears, and about their distances.
fn unlikely_axles(vehicle: &Vehicle) -> impl Iterator<Item = Unlikely> {
    let unusual = |values: &[f64], usual: RangeInclusive<f64>| {
        let mut values = values.iter().copied();
        values.find(|value| !usual.contains(value))
    };
    let axle = unusual(&vehicle.axles_kg, 50.0..=50_000.0).map(|axle_kg| {
        let warning = format!(
            "an axle of the vehicle has {} kg: are loads in kg?",
            plain(axle_kg)
        );
        Unlikely::new("vehicle.axles_kg", axle_kg, "kg", warning)
    });
    let spacing = unusual(&vehicle.spacing_m, 0.3..=50.0).map(|spacing_m| {
        let warning = format!(
            "two axles of the vehicle are {} m apart: are distances in metres?",
            plain(spacing_m)
        );
        Unlikely::new("vehicle.spacing_m", spacing_m, "m", warning)
    });
    axle.into_iter().chain(spacing)
}

/// Warning about mortar that is stiffer than the blocks between it.
fn stiff_mortar(numbers: &Numbers) -> Option<Unlikely> {
    let key = "elastic_joints.mortar_modulus_gpa";
    let mortar_gpa = numbers.get(key)?;
    let stone_gpa = numbers.get("elastic_joints.stone_modulus_gpa")?;
    (mortar_gpa > stone_gpa).then(|| {
        let [mortar, stone] = [mortar_gpa, stone_gpa].map(plain);
        let warning =
            format!("the modulus of the mortar is {mortar} GPa, that of the stone {stone} GPa: are they exchanged?");
        Unlikely::new(key, mortar_gpa, "GPa", warning)
    })
}

/// Warning about a rarer limit state with a weaker ground motion.
fn falling_hazard(numbers: &Numbers) -> Option<Unlikely> {
    let states = ["sld", "slv", "slc"].map(|state| {
        let key = format!("demand.{state}.ag_g");
        (numbers.get(&key), key, state)
    });
    let given: Vec<_> = states
        .into_iter()
        .filter_map(|(ag_g, key, state)| Some((ag_g?, key, state)))
        .collect();
    let mut pairs = given.windows(2);
    pairs.find_map(|pair| {
        let [(often_g, key, often), (rare_g, _, rare)] = pair else {
            return None;
        };
        (often_g > rare_g).then(|| {
            let [first, second] = [often_g, rare_g].map(|ag_g| plain(*ag_g));
            let [often, rare] = [often, rare].map(|state| state.to_uppercase());
            let warning =
                format!("ag is {first} g at {often} and {second} g at {rare}, which is rarer: are they exchanged?");
            Unlikely::new(key.clone(), *often_g, "g", warning)
        })
    })
}
