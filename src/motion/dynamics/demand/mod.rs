//! Demand of earthquakes on an oscillator: elastic spectra of the Italian code NTC 2018 on the ground ([`GroundSpectrum`]) and at a
//! height in a building ([`FloorSpectrum`]), spectra given by points ([`PointSpectrum`]), and those of records ([`peak_displacement`]).
//!
//! Clauses are those of NTC 2018 (§) and of the Circolare 7/2019 (C). Accelerations are in units of gravity, periods in
//! seconds, damping in per cent of the critical.

mod floor;
mod ground;
mod oscillator;
mod points;

use std::f64::consts::PI;

pub use floor::{FloorSpectrum, Mode};
pub use ground::{GroundSpectrum, Hazard, Site, Soil, Topography};
pub use oscillator::peak_displacement;
pub use points::{PeriodOutOfRange, PointError, PointSpectrum};

/// Factor from ordinates at 5 % damping to those at another damping: `sqrt(10 / (5 + xi))`, at least 0.55 (§ 3.2.3.2.1).
pub fn damping_factor(damping_percent: f64) -> f64 {
    (10.0 / (5.0 + damping_percent)).sqrt().max(0.55)
}

/// Spectral displacement, in metres, that corresponds to a spectral acceleration, in g, at a period: `S T^2 / (4 pi^2)`.
pub fn displacement_m(acceleration_g: f64, period_s: f64, gravity_m_s2: f64) -> f64 {
    let circular = period_s / (2.0 * PI);
    acceleration_g * gravity_m_s2 * circular * circular
}
