//! Circular masonry arch: shape, size and material.

use std::ops::RangeInclusive;
use std::sync::{Arc, OnceLock};

use serde::Serialize;

use crate::argument::{ArgumentError, require, require_count, require_within};
use crate::mechanics::four_link::limit::{Incipient, incipient};
use crate::mechanics::four_link::mechanism::HingeSites;
use crate::mechanics::{LimitError, Ring, Row, RowError};

/// Range of lengths in metres and of densities in kg/m3, wide enough for any arch; their products stay in the range of an `f64`.
pub const MAGNITUDE: RangeInclusive<f64> = 1e-3..=1e6;

/// Least thickness over mean radius; rounding errors dominate in thinner arches.
pub const MIN_THICKNESS_RATIO: f64 = 1e-6;

/// Upper bound of thickness over mean radius: the ring then has no hole.
pub const THICKNESS_RATIO_BOUND: f64 = 2.0;

/// Range of embrace angles, in degrees. Below one degree a straight thrust line fits into almost all rings, and no push moves them.
pub const EMBRACE_DEG: RangeInclusive<f64> = 1.0..=180.0;

/// Range of the number of voussoirs: a mechanism has four hinges, and three voussoirs have four joints.
pub const VOUSSOIRS: RangeInclusive<usize> = 3..=200;

/// Default depth, in metres.
pub const DEPTH_M: f64 = 1.0;

/// Default density, in kg/m3.
pub const DENSITY_KG_M3: f64 = 2000.0;

named! {
    /// Line of an arch along which lengths are measured.
    pub enum MeasuredAt {
        /// The lower side: the clear span.
        Intrados = "intrados",
        /// The middle line.
        Mean = "mean",
        /// The upper side.
        Extrados = "extrados",
    }
}

impl MeasuredAt {
    /// Line in words.
    pub const fn in_words(self) -> &'static str {
        match self {
            Self::Intrados => "at the intrados",
            Self::Mean => "at the middle line",
            Self::Extrados => "at the extrados",
        }
    }

    /// Distance outwards from this line to the mean line, in thicknesses.
    pub const fn to_mean(self) -> f64 {
        match self {
            Self::Intrados => 0.5,
            Self::Mean => 0.0,
            Self::Extrados => -0.5,
        }
    }
}

/// A circular arch of constant thickness.
///
/// ```
///
/// # use archrock_motion::mechanics::Arch;
/// // Mean radius, thickness over mean radius, embrace angle in degrees.
/// let arch = Arch::new(10.0, 0.15, 157.5)?.with_voussoirs(7)?;
/// assert!((arch.incipient()?.acceleration_g - 0.370009738).abs() < 1e-9);
///
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[readonly::make]
#[derive(Clone, Debug, Serialize)]
pub struct Arch {
    /// Radius of the middle line, in metres.
    pub mean_radius_m: f64,
    /// Thickness over mean radius.
    pub thickness_ratio: f64,
    /// Angle from springing to springing, in degrees.
    pub embrace_deg: f64,
    /// Length out of plane, in metres.
    pub depth_m: f64,
    /// Density, in kg/m3.
    pub density_kg_m3: f64,
    /// Number of equal voussoirs; `None` if hinges may open at any section.
    pub voussoirs: Option<usize>,
    /// Line whose span and rise are given in drawings and captions; `None` if not set.
    #[serde(skip)]
    pub measured_at: Option<MeasuredAt>,
    /// Onset of rocking, computed at the first request. It depends on the shape only, so arches of the same shape share it.
    #[serde(skip)]
    incipient: Arc<OnceLock<Result<Incipient, LimitError>>>,
}

/// Arches are equal if shape, size and material are equal.
impl PartialEq for Arch {
    fn eq(&self, other: &Self) -> bool {
        let shape = |arch: &Self| (arch.thickness_ratio, arch.embrace_deg, arch.voussoirs);
        let other_numbers = |arch: &Self| (arch.mean_radius_m, arch.depth_m, arch.density_kg_m3);
        shape(self) == shape(other) && other_numbers(self) == other_numbers(other)
    }
}

impl Arch {
    /// Arch whose hinges may open at any section, 1 m deep, of 2000 kg/m3.
    ///
    /// `mean_radius_m` is the radius of its middle line (0.001 to 1e6 m), `thickness_ratio` its thickness over
    /// that (from 1e-6, below 2) and `embrace_deg` the angle from springing to springing (1 to 180).
    /// [`Arch::incipient`] computes whether it stands.
    ///
    /// # Errors
    /// When an argument is outside its range.
    pub fn new(
        mean_radius_m: f64,
        thickness_ratio: f64,
        embrace_deg: f64,
    ) -> Result<Self, ArgumentError> {
        let arch = Self {
            mean_radius_m: require_within("mean_radius_m", mean_radius_m, MAGNITUDE)?,
            thickness_ratio,
            embrace_deg: require_within("embrace_deg", embrace_deg, EMBRACE_DEG)?,
            depth_m: DEPTH_M,
            density_kg_m3: DENSITY_KG_M3,
            voussoirs: None,
            measured_at: None,
            incipient: Arc::default(),
        };
        arch.reshaped()
    }

    /// Arch after a change of its shape.
    ///
    /// # Errors
    /// If the thickness is out of range.
    fn reshaped(mut self) -> Result<Self, ArgumentError> {
        let ratio = self.thickness_ratio;
        let range = MIN_THICKNESS_RATIO..THICKNESS_RATIO_BOUND;
        let allowed = format_args!("a number from {:?} to below {:?}", range.start, range.end);
        require(range.contains(&ratio), "thickness_ratio", ratio, allowed)?;
        self.incipient = Arc::default();
        Ok(self)
    }

    /// This arch with another mean radius, in metres, and a proportional thickness.
    ///
    /// # Errors
    /// When it is outside 0.001 to 1e6.
    pub fn with_mean_radius_m(mut self, mean_radius_m: f64) -> Result<Self, ArgumentError> {
        self.mean_radius_m = require_within("mean_radius_m", mean_radius_m, MAGNITUDE)?;
        Ok(self)
    }

    /// This arch with another thickness, in mean radii.
    ///
    /// # Errors
    /// When it is not from 1e-6 to below 2.
    pub fn with_thickness_ratio(mut self, thickness_ratio: f64) -> Result<Self, ArgumentError> {
        self.thickness_ratio = thickness_ratio;
        self.reshaped()
    }

    /// This arch with another embrace angle, in degrees.
    ///
    /// # Errors
    /// When it is outside 1 to 180.
    pub fn with_embrace_deg(mut self, embrace_deg: f64) -> Result<Self, ArgumentError> {
        self.embrace_deg = require_within("embrace_deg", embrace_deg, EMBRACE_DEG)?;
        self.reshaped()
    }

    /// This arch cut into equal voussoirs, so that hinges open at their joints only.
    ///
    /// # Errors
    /// When there are fewer than 3, as four hinges need four joints, or more than 200.
    pub fn with_voussoirs(mut self, voussoirs: usize) -> Result<Self, ArgumentError> {
        self.voussoirs = Some(require_count("voussoirs", voussoirs, VOUSSOIRS)?);
        self.reshaped()
    }

    /// This arch with another depth out of plane, in metres.
    ///
    /// # Errors
    /// When it is outside 0.001 to 1e6.
    pub fn with_depth_m(mut self, depth_m: f64) -> Result<Self, ArgumentError> {
        self.depth_m = require_within("depth_m", depth_m, MAGNITUDE)?;
        Ok(self)
    }

    /// This arch with another density, in kg/m3.
    ///
    /// # Errors
    /// When it is outside 0.001 to 1e6.
    pub fn with_density_kg_m3(mut self, density_kg_m3: f64) -> Result<Self, ArgumentError> {
        self.density_kg_m3 = require_within("density_kg_m3", density_kg_m3, MAGNITUDE)?;
        Ok(self)
    }

    /// This arch with a line whose span and rise are given in drawings and captions.
    #[must_use]
    pub const fn with_measured_at(mut self, line: Option<MeasuredAt>) -> Self {
        self.measured_at = line;
        self
    }

    /// Radius of a line, in metres.
    pub fn radius_at_m(&self, line: MeasuredAt) -> f64 {
        self.mean_radius_m * (1.0 - line.to_mean() * self.thickness_ratio)
    }

    /// Span and rise of a line, in metres.
    pub fn span_and_rise_m(&self, line: MeasuredAt) -> [f64; 2] {
        let radius_m = self.radius_at_m(line);
        let (sin, cos) = libm::sincos(0.5 * self.embrace_deg.to_radians());
        [2.0 * radius_m * sin, radius_m * (1.0 - cos)]
    }

    /// Voussoirs as a row of blocks.
    ///
    /// # Errors
    /// If it has no voussoirs.
    pub fn row(&self) -> Result<Row, RowError> {
        Row::arch(
            &self.ring(),
            self.voussoirs.ok_or(RowError::NoVoussoirs)?,
            self.mean_radius_m,
            self.depth_m,
            self.density_kg_m3,
        )
    }

    /// Sections at which hinges may open.
    pub fn sites(&self) -> HingeSites {
        (self.voussoirs).map_or(HingeSites::Anywhere, HingeSites::Voussoirs)
    }

    /// Sections at which thrust lines are reported, in radians from the left springing: the joints, or 61 sections of an arch with hinges
    /// anywhere.
    pub(crate) fn thrust_sections_rad(&self) -> Vec<f64> {
        let parts = self.voussoirs.unwrap_or(60);
        self.ring().sections(parts)
    }

    /// Shape: the ring of unit mean radius.
    pub fn ring(&self) -> Ring {
        Ring::new(self.thickness_ratio, self.embrace_deg.to_radians())
            .expect("the constructors check what makes a ring")
    }

    /// Onset of rocking by limit analysis; see [`incipient`].
    ///
    /// # Errors
    /// When the arch cannot stand, or does not start as a four-link mechanism.
    pub fn incipient(&self) -> Result<&Incipient, LimitError> {
        let onset = || incipient(&self.ring(), self.sites());
        let known = self.incipient.get_or_init(onset).as_ref();
        known.map_err(|error| *error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_name_the_argument_and_its_allowed_range() {
        let message = |result: Result<Arch, ArgumentError>| result.unwrap_err().to_string();
        let arch = || Arch::new(5.0, 0.15, 180.0).unwrap();
        assert_eq!(
            message(Arch::new(f64::NAN, 0.15, 180.0)),
            "`mean_radius_m = NaN` is not allowed: it must be a number from 0.001 to 1e6"
        );
        assert!(message(Arch::new(5.0, 2.0, 180.0)).starts_with("`thickness_ratio = 2.0`"));
        assert!(message(arch().with_embrace_deg(180.1)).contains("from 1 to 180"));
        assert!(message(arch().with_voussoirs(2)).contains("from 3 to 200"));
        assert!(arch().with_depth_m(f64::INFINITY).is_err());
        assert!(arch().with_density_kg_m3(0.0).is_err());
    }

    #[test]
    fn arches_of_one_shape_share_their_limit_analysis() {
        let arch = Arch::new(5.0, 0.15, 180.0).unwrap();
        let first = arch.incipient().unwrap() as *const Incipient;
        let larger = arch.clone().with_mean_radius_m(10.0).unwrap();
        assert_eq!(larger.incipient().unwrap() as *const Incipient, first);
        let thinner = arch.with_thickness_ratio(0.12).unwrap();
        assert!(thinner.incipient().unwrap().acceleration_g < 0.1);
    }
}
