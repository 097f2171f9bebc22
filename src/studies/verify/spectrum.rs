//! The spectrum of a limit state on the ground, at a height in a building, or from points.

use serde::{Deserialize, Serialize};

use crate::dynamics::demand::{FloorSpectrum, Mode, PeriodOutOfRange, PointSpectrum};
use crate::dynamics::{GroundSpectrum, Site};
use crate::scenario::{Demand, LimitState, StateRule};

/// The spectrum of a limit state at the place of the mechanism.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Spectrum {
    /// Spectrum at a height in a building by NTC 2018.
    Floor {
        /// The spectrum of the ground.
        #[serde(flatten)]
        ground: SpectrumGround,
        /// The modes of the building.
        modes: Vec<FloorMode>,
        /// Peak acceleration of the floor that carries the mechanism, in g.
        a_z_g: f64,
    },
    /// Spectrum of the ground by NTC 2018. It follows `Floor`, because the first variant that fits is read, and the JSON of a floor fits this one as well.
    Ground(SpectrumGround),
    /// Spectrum given by points.
    Points {
        /// Name of the file of points.
        spectrum: String,
        /// The spectrum.
        #[serde(flatten)]
        points: PointSpectrum,
    },
}

/// The spectrum of the ground by NTC 2018.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpectrumGround {
    /// The spectrum.
    #[serde(flatten)]
    pub spectrum: GroundSpectrum,
    /// Peak displacement of the ground, in metres.
    pub peak_displacement_m: f64,
}

/// A mode of the building.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FloorMode {
    /// The mode.
    #[serde(flatten)]
    pub mode: Mode,
    /// Spectral acceleration of the ground at period and damping of the mode, in g.
    pub acceleration_g: f64,
    /// Largest acceleration of the floor in this mode [C7.2.7], in g.
    pub a_z_g: f64,
    /// Amplification at the damping of the mechanism [C7.2.6].
    pub f: f64,
}

/// Ordinates of the spectrum at a height at a period, mode by mode.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FloorOrdinates {
    /// The period, in seconds.
    pub period_s: f64,
    /// Ordinate of each mode [C7.2.6], in g.
    pub modes_g: Vec<f64>,
    /// Spectral acceleration of the ground, below which the ordinate does not fall, in g.
    pub ground_g: f64,
    /// Spectral acceleration at the height [C7.2.5], in g.
    pub acceleration_g: f64,
}

fn floor_spectrum(ground: &SpectrumGround, modes: &[FloorMode]) -> FloorSpectrum {
    FloorSpectrum {
        ground: ground.spectrum,
        modes: modes.iter().map(|one| one.mode).collect(),
    }
}

/// First period at which a displacement of points counts, in seconds.
fn points_from_s(points: &PointSpectrum, from_s: Option<f64>, period_s: f64) -> f64 {
    from_s.unwrap_or(points.range_s()[0]).min(period_s)
}

impl Spectrum {
    /// Makes the spectrum of a limit state; `None` if the demand does not include that state.
    pub(super) fn of(
        demand: &Demand,
        state: LimitState,
        rule: Option<&StateRule>,
        gravity_m_s2: f64,
    ) -> Option<Self> {
        let code = match demand {
            Demand::Points(points) => {
                let points = points.get(&state)?.clone();
                return Some(Self::Points {
                    spectrum: points.spectrum,
                    points: points.points,
                });
            }
            Demand::Code(code) => code,
        };
        let site = Site {
            soil: code.soil,
            topographic_factor: code.topography.factor(),
        };
        let spectrum = GroundSpectrum::new(*code.hazards.get(&state)?, site)
            .expect("the hazards of a scenario are within the ranges of the code");
        let ground = SpectrumGround {
            spectrum,
            peak_displacement_m: spectrum.peak_displacement_m(gravity_m_s2),
        };
        let height = code.height.as_ref();
        let floor = height.and_then(|height| FloorSpectrum::new(spectrum, height.modes_at(state)));
        let Some(floor) = floor else {
            return Some(Self::Ground(ground));
        };
        let damping_percent = rule.map_or(5.0, |rule| rule.damping_percent);
        let modes = floor.modes.iter().map(|mode| FloorMode {
            mode: *mode,
            acceleration_g: spectrum.acceleration_g(mode.t_s, mode.damping_percent),
            a_z_g: mode.peak_g(&spectrum),
            f: mode.amplification(damping_percent),
        });
        Some(Self::Floor {
            ground,
            modes: modes.collect(),
            a_z_g: floor.peak_g(),
        })
    }

    /// Spectrum of the ground; `None` for points.
    pub const fn ground(&self) -> Option<&SpectrumGround> {
        match self {
            Self::Ground(ground) | Self::Floor { ground, .. } => Some(ground),
            Self::Points { .. } => None,
        }
    }

    /// Acceleration `a_g` of the hazard, in g. For points it is their peak; `None` if they do not begin at period zero.
    pub fn ag_g(&self) -> Option<f64> {
        match self {
            Self::Ground(ground) | Self::Floor { ground, .. } => Some(ground.spectrum.hazard.ag_g),
            Self::Points { points, .. } => points.peak_g().ok(),
        }
    }

    /// Peak acceleration of the ground, or of the floor that carries the mechanism, in g.
    ///
    /// # Errors
    /// When the points do not begin at period zero.
    pub fn peak_g(&self) -> Result<f64, PeriodOutOfRange> {
        match self {
            Self::Ground(ground) => Ok(ground.spectrum.peak_g),
            Self::Floor { a_z_g, .. } => Ok(*a_z_g),
            Self::Points { points, .. } => points.peak_g(),
        }
    }

    /// Spectral acceleration at a period and a damping, in g.
    ///
    /// # Errors
    /// When the period is outside the points.
    pub fn acceleration_g(
        &self,
        period_s: f64,
        damping_percent: f64,
    ) -> Result<f64, PeriodOutOfRange> {
        match self {
            Self::Ground(ground) => Ok(ground.spectrum.acceleration_g(period_s, damping_percent)),
            Self::Floor { ground, modes, .. } => {
                let floor = floor_spectrum(ground, modes);
                Ok(floor.acceleration_g(period_s, damping_percent))
            }
            Self::Points { points, .. } => points.acceleration_g(period_s, damping_percent),
        }
    }

    /// Longest period of the building, in seconds; `None` on the ground.
    pub(super) fn first_period_s(&self) -> Option<f64> {
        let Self::Floor { ground, modes, .. } = self else {
            return None;
        };
        Some(floor_spectrum(ground, modes).first_period_s())
    }

    /// Ordinates of the modes at a period and a damping; `None` on the ground.
    pub(super) fn ordinates(&self, period_s: f64, percent: f64) -> Option<FloorOrdinates> {
        let Self::Floor { ground, modes, .. } = self else {
            return None;
        };
        let spectrum = &ground.spectrum;
        let modes_g = modes
            .iter()
            .map(|one| one.mode.acceleration_g(spectrum, period_s, percent));
        Some(FloorOrdinates {
            period_s,
            modes_g: modes_g.collect(),
            ground_g: spectrum.acceleration_g(period_s, percent),
            acceleration_g: floor_spectrum(ground, modes).acceleration_g(period_s, percent),
        })
    }

    /// Smallest displacement demand, in metres, on a floor at a period beyond resonance with the building; `None` below it and on
    /// the ground.
    pub(super) fn resonance_m(
        &self,
        period_s: f64,
        damping_percent: f64,
        gravity_m_s2: f64,
    ) -> Option<f64> {
        let Self::Floor { ground, modes, .. } = self else {
            return None;
        };
        let floor = floor_spectrum(ground, modes);
        let is_beyond = period_s > floor.resonance_s();
        is_beyond.then(|| floor.resonance_m(damping_percent, gravity_m_s2))
    }

    /// Period of the largest displacement of points up to a period, in seconds (see [`Self::displacement_m`]); `None` for spectra by NTC 2018.
    pub(super) fn demand_period_s(
        &self,
        period_s: f64,
        from_s: Option<f64>,
        damping_percent: f64,
        gravity_m_s2: f64,
    ) -> Option<f64> {
        let Self::Points { points, .. } = self else {
            return None;
        };
        let periods_s = [points_from_s(points, from_s, period_s), period_s];
        let largest = points.largest_displacement(periods_s, damping_percent, gravity_m_s2);
        Some(largest.ok()?.1)
    }

    /// Computes the displacement demand on a mechanism whose period has lengthened to `period_s`, in metres. For points it is the largest demand
    /// between the periods `from_s` and `period_s`.
    ///
    /// # Errors
    /// When a period is outside the points.
    pub fn displacement_m(
        &self,
        period_s: f64,
        from_s: Option<f64>,
        damping_percent: f64,
        gravity_m_s2: f64,
    ) -> Result<f64, PeriodOutOfRange> {
        Ok(match self {
            Self::Ground(SpectrumGround { spectrum, .. }) => {
                spectrum.largest_displacement_m(period_s, damping_percent, gravity_m_s2)
            }
            Self::Floor { ground, modes, .. } => {
                let floor = floor_spectrum(ground, modes);
                floor.displacement_m(period_s, damping_percent, gravity_m_s2)
            }
            Self::Points { points, .. } => {
                let periods_s = [points_from_s(points, from_s, period_s), period_s];
                let largest =
                    points.largest_displacement(periods_s, damping_percent, gravity_m_s2)?;
                largest.0
            }
        })
    }
}
