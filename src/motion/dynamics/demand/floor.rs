//! Spectrum at a height in a building, Circolare 7/2019, C7.2.3, [C7.2.5] to [C7.2.8].
//!
//! In addition, on the safe side, peak and ordinates are at least those of the ground at every period. The clause requires that only for periods
//! above the first one; its spectrum is below that of the ground where a building sways little.

use serde::{Deserialize, Serialize};

use super::{damping_factor, displacement_m};
use crate::dynamics::GroundSpectrum;

/// Periods, over that of a mode, between which the ordinate of the mode is the largest.
pub(crate) const PLATEAU: [f64; 2] = [0.8, 1.1];

/// A mode of a building, in its present state.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Mode {
    /// Period, in seconds.
    pub t_s: f64,
    /// Damping, in per cent.
    pub damping_percent: f64,
    /// Participation factor.
    pub gamma: f64,
    /// Modal shape at the height of the mechanism.
    pub psi: f64,
}

impl Mode {
    /// Largest acceleration of the floor in this mode, [C7.2.7], in g.
    pub fn peak_g(&self, ground: &GroundSpectrum) -> f64 {
        let damping = self.damping_percent;
        ground.acceleration_g(self.t_s, damping)
            * (self.gamma * self.psi).abs()
            * (1.0 + 0.0004 * damping * damping).sqrt()
    }

    /// Ratio of an oscillator of this damping, in resonance with the mode, to the floor, [C7.2.6]. The damping of the mode counts as a
    /// fraction here, as in the transfer of a harmonic motion; in per cent there would be no amplification.
    pub fn amplification(&self, damping_percent: f64) -> f64 {
        1.1 * damping_factor(damping_percent) / (self.damping_percent / 100.0).sqrt()
    }

    /// Ordinate of the mode, [C7.2.6], in g.
    pub fn acceleration_g(
        &self,
        ground: &GroundSpectrum,
        period_s: f64,
        damping_percent: f64,
    ) -> f64 {
        let factor = self.amplification(damping_percent);
        let [low, high] = PLATEAU.map(|part| period_s / (part * self.t_s));
        let falls = if low < 1.0 {
            libm::pow(1.0 - low, 1.6)
        } else if high > 1.0 {
            libm::pow(high - 1.0, 1.2)
        } else {
            0.0
        };
        factor * self.peak_g(ground) / (1.0 + (factor - 1.0) * falls)
    }
}

/// The spectrum at the height of a mechanism in a building.
#[derive(Clone, Debug, PartialEq)]
pub struct FloorSpectrum {
    /// The spectrum of the ground.
    pub ground: GroundSpectrum,
    /// The modes of the building.
    pub modes: Vec<Mode>,
}

impl FloorSpectrum {
    /// Spectrum in a building on that ground; `None` without modes.
    pub fn new(ground: GroundSpectrum, modes: Vec<Mode>) -> Option<Self> {
        (!modes.is_empty()).then_some(Self { ground, modes })
    }

    /// Longest period of the building, `T_1`, in seconds.
    pub fn first_period_s(&self) -> f64 {
        let periods = self.modes.iter().map(|mode| mode.t_s);
        periods.fold(0.0, f64::max)
    }

    /// Largest acceleration of the floor, [C7.2.8], and at least that of the ground, in g.
    pub fn peak_g(&self) -> f64 {
        let modes = self.modes.iter().map(|mode| mode.peak_g(&self.ground));
        root_of_squares(modes).max(self.ground.peak_g)
    }

    /// Spectral acceleration `S_eZ`, [C7.2.5], and at least that of the ground at every period, in g.
    pub fn acceleration_g(&self, period_s: f64, damping_percent: f64) -> f64 {
        let modes = self.modes.iter();
        let floor = modes.map(|mode| mode.acceleration_g(&self.ground, period_s, damping_percent));
        root_of_squares(floor).max(self.ground.acceleration_g(period_s, damping_percent))
    }

    /// Period up to which a mechanism is in resonance with the first mode, in seconds.
    pub fn resonance_s(&self) -> f64 {
        PLATEAU[1] * self.first_period_s()
    }

    /// Displacement demand at the period [`Self::resonance_s`], in metres.
    pub fn resonance_m(&self, damping_percent: f64, gravity_m_s2: f64) -> f64 {
        let acceleration_g = self.acceleration_g(self.first_period_s(), damping_percent);
        displacement_m(acceleration_g, self.resonance_s(), gravity_m_s2)
    }

    /// Displacement demand on a mechanism, [C8.7.1.12], in metres: `S_eZ T^2 / (4 pi^2)`. Beyond the resonance with the first mode it is
    /// at least that at resonance.
    pub fn displacement_m(&self, period_s: f64, damping_percent: f64, gravity_m_s2: f64) -> f64 {
        let acceleration_g = self.acceleration_g(period_s, damping_percent);
        let own_m = displacement_m(acceleration_g, period_s, gravity_m_s2);
        if period_s <= self.resonance_s() {
            return own_m;
        }
        own_m.max(self.resonance_m(damping_percent, gravity_m_s2))
    }
}

/// Square root of the sum of the squares.
fn root_of_squares(values: impl Iterator<Item = f64>) -> f64 {
    values.map(|value| value * value).sum::<f64>().sqrt()
}
