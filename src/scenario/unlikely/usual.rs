//! The usual numbers of keys with a unit, and the units with which users confuse it.
//!
//! The ranges contain the structures of all documents and examples, those of published codes for blocks and arches, and small models in laboratories. A
//! key is missing if every range has false alarms: see "Not noticed" in docs/records.md.

use std::f64::consts::PI;
use std::ops::RangeInclusive;

use crate::scenario::bounds::LIKELY_EMBRACE_DEG;

/// The usual numbers of a key.
pub(super) struct Usual {
    /// The key, after as many of its tables as distinguish it from others.
    pub(super) key: &'static str,
    /// Subject and verb of a sentence about the number; `{of}` stands for the table of the key.
    pub(super) what: &'static str,
    /// The unit of the number in a sentence; empty without a unit.
    pub(super) unit: &'static str,
    /// The usual magnitudes.
    pub(super) range: RangeInclusive<f64>,
    /// Other units in which the number may be, each with its size in the unit of the key.
    pub(super) others: &'static [(&'static str, f64)],
    /// Unusual magnitudes that users choose on purpose.
    pub(super) on_purpose: RangeInclusive<f64>,
}

impl Usual {
    /// Unit in which a number would be nearest to the middle of the usual ones, on a logarithmic scale; `None` if it would be unusual in
    /// all units.
    pub(super) fn nearest_unit(&self, magnitude: f64) -> Option<&'static str> {
        let (low, high) = (*self.range.start(), *self.range.end());
        let middle = (low.max(1e-3 * high) * high).sqrt();
        let usual = self.others.iter().filter_map(|(unit, size)| {
            let value = magnitude * size;
            let far = libm::log(value / middle).abs();
            self.range.contains(&value).then_some((unit, far))
        });
        let nearest = usual.min_by(|one, other| one.1.total_cmp(&other.1));
        nearest.map(|(unit, _)| *unit)
    }
}

const fn usual_range(
    key: &'static str,
    what: &'static str,
    unit: &'static str,
    range: RangeInclusive<f64>,
    others: &'static [(&'static str, f64)],
) -> Usual {
    /// Zero is chosen on purpose for most keys: no prestress, no damping, no mass.
    const ZERO: RangeInclusive<f64> = 0.0..=0.0;
    Usual {
        key,
        what,
        unit,
        range,
        others,
        on_purpose: ZERO,
    }
}

impl Usual {
    const fn unless(self, on_purpose: RangeInclusive<f64>) -> Self {
        Self { on_purpose, ..self }
    }
}

const LENGTHS: &[(&str, f64)] = &[("centimetres", 1e-2), ("millimetres", 1e-3)];
const TIMES: &[(&str, f64)] = &[("milliseconds", 1e-3)];
const GIGAPASCALS: &[(&str, f64)] = &[("MPa", 1e-3), ("kPa", 1e-6), ("Pa", 1e-9)];
const DEGREES: &[(&str, f64)] = &[("degrees", PI / 180.0)];
const RADIANS: &[(&str, f64)] = &[("radians", 180.0 / PI)];
const FRACTION: &[(&str, f64)] = &[("fractions of one", 100.0)];
const PERCENT: &[(&str, f64)] = &[("per cent", 0.01)];

/// Force or mass of a load or a tie over the weight or mass of the structure: a smaller one has no effect, a larger one is no part of a structure.
const PART_OF_WEIGHT: RangeInclusive<f64> = 1e-3..=100.0;

/// Usual masses and forces of a structure of a mass in kg and a size in m.
pub(super) fn usual_forces(mass_kg: f64, size_m: f64, gravity_m_s2: f64) -> [Usual; 6] {
    const KILONEWTONS: &[(&str, f64)] = &[("kN", 1e3)];
    let times = |factor: f64| PART_OF_WEIGHT.start() * factor..=PART_OF_WEIGHT.end() * factor;
    let weight_n = mass_kg * gravity_m_s2;
    let force = |key, what, part| usual_range(key, what, "N", times(part * weight_n), KILONEWTONS);
    let masses: &[_] = &[("tonnes", 1e3), ("kN", 1e3 / 9.81), ("grams", 1e-3)];
    // At the lower end a tie as long as the structure would double its length under the weight; the upper end is that of the key.
    let stiffness_n_m = weight_n / size_m..=1e10;
    // A blow that gives the structure some cm/s.
    let impulse_n_s = times(weight_n);
    [
        usual_range(
            "mass_kg",
            "the mass of {of} is",
            "kg",
            times(mass_kg),
            masses,
        ),
        force("thrust_n", "the thrust of {of} is", 1.0),
        // A tie may be tightened by hand.
        force("prestress_n", "the prestress of {of} is", 0.1),
        force("yield_force_n", "the yield force of {of} is", 1.0),
        usual_range(
            "stiffness_n_m",
            "the stiffness of {of} is",
            "N/m",
            stiffness_n_m,
            &[("kN/m", 1e3), ("kN/mm", 1e6)],
        ),
        usual_range(
            "impulse_n_s",
            "the impulse is",
            "N s",
            impulse_n_s,
            &[("kN s", 1e3)],
        ),
    ]
}

/// Peaks of ground motions, in g, and the units with which users confuse it.
pub(super) const PEAK: Usual = usual_range(
    "",
    "",
    "g",
    0.05..=5.0,
    &[
        ("m/s2", 1.0 / 9.81),
        ("per cent of gravity", 0.01),
        ("cm/s2", 1.0 / 981.0),
    ],
);

/// Makes a table of usual numbers, one key on each line: key, subject and verb, unit, range and other units, and numbers that are chosen on purpose.
macro_rules! usual_numbers {
    ($($key:literal, $what:literal, $unit:literal, $range:expr, $others:expr $(, unless $on_purpose:expr)?;)*) => {
        &[$(usual_range($key, $what, $unit, $range, $others)$(.unless($on_purpose))?),*]
    };
}

/// The usual numbers; the first row that fits a key counts.
pub(super) const USUAL: &[Usual] = usual_numbers! {
    // The largest masonry arches span 146 m (Danhe bridge), the smallest models of laboratories 0.2 m.
    "mean_radius_m", "the mean radius is", "m", 0.1..=100.0, LENGTHS;
    "span_m", "the span is", "m", 0.1..=200.0, LENGTHS;
    "rise_m", "the rise is", "m", 0.05..=100.0, LENGTHS;
    // Vaults of one brick in models are 1 cm thick, bridges up to 3 m.
    "thickness_m", "the thickness is", "m", 0.005..=5.0, LENGTHS;
    "embrace_deg", "the embrace angle is", "degrees", LIKELY_EMBRACE_DEG..=360.0, RADIANS;
    "crown_deg", "the angle of the middle arc is", "degrees", 5.0..=180.0, RADIANS;
    // Masonry towers are up to 100 m high and 20 m wide.
    "column.height_m", "the column measures", "m", 0.05..=100.0, LENGTHS;
    "column.width_m", "the width of the column is", "m", 0.01..=20.0, LENGTHS;
    // From a vase to a monolith.
    "body.mass_kg", "the mass of the body is", "kg", 5.0..=1e7, &[("t", 1e3)];
    "body.centre_m", "the centre of gravity is at", "m", -20.0..=20.0, LENGTHS;
    "piers.height_m", "the height of {of} is", "m", 0.05..=100.0, LENGTHS;
    "piers.width_m", "the width of {of} is", "m", 0.02..=30.0, LENGTHS;
    "blocks.joints", "the structure measures", "m", 0.05..=200.0, LENGTHS;
    "fill.height_m", "the height of {of} is", "m", 0.05..=30.0, LENGTHS;
    "above_crown_m", "the fill above the crown is", "m", 0.01..=20.0, LENGTHS;
    "load.width_m", "the width of {of} is", "m", 0.01..=50.0, LENGTHS;
    // Barrel vaults and bridges are up to 60 m deep.
    "depth_m", "the depth of {of} is", "m", 0.02..=60.0, LENGTHS;
    // From aerated concrete to steel blocks of laboratories; at most 1 is a unit of density.
    "density_kg_m3", "the density of {of} is", "kg/m3", 300.0..=9000.0, &[("kN/m3", 1000.0 / 9.81), ("t/m3", 1e3), ("N/m3", 1.0 / 9.81)], unless 0.0..=1.0;
    // Stone on stone has 0.3 to 1; from 90 on it is no angle, but "never slips".
    "friction_coefficient", "the friction coefficient is", "", 0.05..=2.0, DEGREES, unless 90.0..=f64::INFINITY;
    // From earth blocks to basalt; steel, with 210, is no stone.
    "stone_modulus_gpa", "the modulus of the stone is", "GPa", 0.02..=150.0, GIGAPASCALS;
    "mortar_modulus_gpa", "the modulus of the mortar is", "GPa", 1e-3..=60.0, GIGAPASCALS;
    // Byzantine joints have up to 7 cm.
    "mortar_thickness_m", "the thickness of the mortar is", "m", 2e-4..=0.1, LENGTHS;
    // From earth blocks to basalt.
    "compressive_strength_mpa", "the compressive strength is", "MPa", 0.2..=400.0, &[("kPa", 1e-3), ("Pa", 1e-6)];
    "free_standing.modulus_gpa", "the modulus of {of} is", "GPa", 0.02..=150.0, GIGAPASCALS;
    // From wires of 2.5 mm to several bars of 100 mm.
    "area_mm2", "the area of {of} is", "mm2", 5.0..=5e4, &[("cm2", 1e2), ("m2", 1e6)];
    // From ropes of polymer to carbon fibres.
    "tie.modulus_gpa", "the modulus of {of} is", "GPa", 0.5..=700.0, GIGAPASCALS;
    "yield_stress_mpa", "the yield stress of {of} is", "MPa", 20.0..=5e3, &[("GPa", 1e3), ("kPa", 1e-3), ("Pa", 1e-6)];
    "breaks_at_strain", "the strain at which {of} breaks is", "", 1e-4..=0.99, PERCENT;
    // Larger movements of springings leave no arch.
    "supports.rotation_rad", "the rotation of {of} is", "rad", 0.0..=0.3, DEGREES;
    "spread_m", "the spread of {of} is", "m", 0.0..=1.0, LENGTHS;
    "settlement_m", "the settlement of {of} is", "m", 0.0..=1.0, LENGTHS;
    // A rate of 3 rad/s overturns every column that is higher than 1 m and than its width.
    "rate_rad_s", "the initial rate is", "rad/s", 0.0..=3.0, DEGREES;
    // Dominant pulses of earthquakes last 0.1 to 10 s; longer ones push slowly.
    "ground.duration_s", "the pulse lasts", "s", 0.01..=60.0, TIMES;
    // Corners of the processing of records are 0.02 to 1 Hz.
    "high_pass_hz", "the corner of the high-pass filter is", "Hz", 0.01..=5.0, &[];
    // Feet 1 km apart in the slowest wave.
    "delay_s", "the delay of the right foot is", "s", 0.0..=10.0, TIMES;
    // Slowest shear waves in mud; an infinite velocity is often written as 1e6.
    "apparent_velocity_m_s", "the apparent velocity is", "m/s", 40.0..=1e6, &[("km/s", 1e3)];
    // Periods and damping of code spectra and of soft or damped structures.
    "spectral_period_s", "the period of the spectral acceleration is", "s", 0.02..=20.0, TIMES;
    "spectral_damping_percent", "the damping of the spectral acceleration is", "%", 0.3..=50.0, FRACTION;
    // Tables of NTC 2008: 0.15 to 0.6 s.
    "tc_star_s", "T_C* of {of} is", "s", 0.05..=2.0, TIMES;
};
