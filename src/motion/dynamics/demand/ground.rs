//! The elastic response spectrum of the horizontal ground motion, NTC 2018, § 3.2.3.2.

use serde::{Deserialize, Serialize};

use super::{damping_factor, displacement_m};
use crate::argument::{ArgumentError, require, short};

named! {
    /// Subsoil category (Tab. 3.2.II).
    #[derive(Default)]
    pub enum Soil {
        #[default]
        /// Rock, or very stiff soil.
        A = "A",
        /// Soft rock, dense coarse or very stiff fine soil.
        B = "B",
        /// Medium dense coarse or medium stiff fine soil.
        C = "C",
        /// Loose coarse or soft fine soil.
        D = "D",
        /// Soil like C or D, at most 30 m thick, on rock.
        E = "E",
    }
}

impl Soil {
    /// Coefficient `S_S` (Tab. 3.2.IV) for `x = F_o a_g / g`.
    pub fn amplification(self, x: f64) -> f64 {
        let (most, slope, range) = match self {
            Self::A => return 1.0,
            Self::B => (1.40, 0.40, (1.00, 1.20)),
            Self::C => (1.70, 0.60, (1.00, 1.50)),
            Self::D => (2.40, 1.50, (0.90, 1.80)),
            Self::E => (2.00, 1.10, (1.00, 1.60)),
        };
        (most - slope * x).clamp(range.0, range.1)
    }

    /// Coefficient `C_C` (Tab. 3.2.IV) for `T_C*` in seconds.
    pub fn period_coefficient(self, tc_star_s: f64) -> f64 {
        match self {
            Self::A => 1.0,
            Self::B => 1.10 * libm::pow(tc_star_s, -0.20),
            Self::C => 1.05 * libm::pow(tc_star_s, -0.33),
            Self::D => 1.25 * libm::pow(tc_star_s, -0.50),
            Self::E => 1.15 * libm::pow(tc_star_s, -0.40),
        }
    }

    /// Period `T_E` (Tab. 3.2.VII), in seconds.
    pub const fn t_e_s(self) -> f64 {
        match self {
            Self::A => 4.5,
            Self::B => 5.0,
            Self::C | Self::D | Self::E => 6.0,
        }
    }
}

/// Period `T_F` (Tab. 3.2.VII), in seconds, for all soils.
pub(crate) const T_F_S: f64 = 10.0;

named! {
    /// Topographic category (Tab. 3.2.III).
    pub enum Topography {
        /// Flat, or slopes of at most 15 degrees.
        T1 = "T1",
        /// Slopes steeper than 15 degrees.
        T2 = "T2",
        /// Ridges with slopes of 15 to 30 degrees.
        T3 = "T3",
        /// Ridges with slopes steeper than 30 degrees.
        T4 = "T4",
    }
}

impl Topography {
    /// Largest coefficient `S_T` of the category (Tab. 3.2.V), that at the top.
    pub const fn factor(self) -> f64 {
        match self {
            Self::T1 => 1.0,
            Self::T2 | Self::T3 => 1.2,
            Self::T4 => 1.4,
        }
    }
}

/// Seismic hazard of a site for a limit state (§ 3.2).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Hazard {
    /// Peak acceleration `a_g` on rigid ground, in g.
    pub ag_g: f64,
    /// Largest amplification `F_o`.
    pub f0: f64,
    /// Reference period `T_C*`, in seconds.
    pub tc_star_s: f64,
}

/// Soil and topography of a site.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Site {
    /// Subsoil category.
    pub soil: Soil,
    /// Topographic coefficient `S_T`.
    pub topographic_factor: f64,
}

/// The elastic spectrum of a site for a limit state.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct GroundSpectrum {
    /// Subsoil category.
    pub soil: Soil,
    /// The hazard.
    #[serde(flatten)]
    pub hazard: Hazard,
    /// Soil coefficient `S_S`.
    pub s_s: f64,
    /// Topographic coefficient `S_T`.
    pub s_t: f64,
    /// `S = S_S S_T`.
    pub s: f64,
    /// Coefficient `C_C`.
    pub c_c: f64,
    /// Period at which the branch of constant acceleration begins, in seconds.
    pub t_b_s: f64,
    /// Period at which the branch of constant velocity begins, in seconds.
    pub t_c_s: f64,
    /// Period at which the branch of constant displacement begins, in seconds.
    pub t_d_s: f64,
    /// Period at which the branch of constant displacement ends, in seconds.
    pub t_e_s: f64,
    /// Peak acceleration of the ground, `a_g S`, in g.
    pub peak_g: f64,
}

impl GroundSpectrum {
    /// Spectrum of a hazard on a site.
    ///
    /// # Errors
    /// When a parameter is out of the range of the code: `F_o` below 2.2, or corner periods out of order.
    pub fn new(hazard: Hazard, site: Site) -> Result<Self, ArgumentError> {
        let (ag_g, f0, tc_star_s) = (hazard.ag_g, hazard.f0, hazard.tc_star_s);
        let t_e_s = site.soil.t_e_s();
        let (soil, s_t) = (site.soil, site.topographic_factor);
        let allowed = "a number from 2.2 (NTC 2018, § 3.2.1) to 10";
        require((2.2..=10.0).contains(&f0), "f0", f0, allowed)?;
        let t_d_s = 4.0 * ag_g + 1.6;
        let allowed = format!(
            "above 0 and at most {} on soil {}, so that T_D = 4 a_g/g + 1.6 is at most T_E = {} s (NTC 2018, § 3.2.3.2)",
            short(((t_e_s - 1.6) / 4.0 * 1e6).round() / 1e6),
            soil.name(),
            short(t_e_s),
        );
        // False also for NaN.
        require(ag_g > 0.0 && t_d_s <= t_e_s, "ag_g", ag_g, allowed)?;
        let c_c = soil.period_coefficient(tc_star_s);
        let t_c_s = c_c * tc_star_s;
        let allowed = format!(
            "above 0, and T_C = C_C T_C* (NTC 2018, Tab. 3.2.IV) at most T_D = {} s",
            short((t_d_s * 1e6).round() / 1e6)
        );
        let in_order = tc_star_s > 0.0 && t_c_s <= t_d_s;
        require(in_order, "tc_star_s", tc_star_s, allowed)?;
        let allowed = "a number from 1 to 2 (NTC 2018, Tab. 3.2.V has 1.0 to 1.4)";
        let fits = (1.0..=2.0).contains(&s_t);
        require(fits, "topographic_factor", s_t, allowed)?;
        let s_s = soil.amplification(f0 * ag_g);
        Ok(Self {
            soil,
            hazard,
            s_s,
            s_t,
            s: s_s * s_t,
            c_c,
            t_b_s: t_c_s / 3.0,
            t_c_s,
            t_d_s,
            t_e_s,
            peak_g: ag_g * (s_s * s_t),
        })
    }

    /// Spectral acceleration `S_e` [3.2.2] at a period and a damping, in g.
    pub fn acceleration_g(&self, period_s: f64, damping_percent: f64) -> f64 {
        let (t, amplified) = (period_s, damping_factor(damping_percent) * self.hazard.f0);
        let shape = if t < self.t_b_s {
            let part = t / self.t_b_s;
            part + (1.0 - part) / amplified
        } else if t < self.t_c_s {
            1.0
        } else if t < self.t_d_s {
            self.t_c_s / t
        } else {
            self.t_c_s * self.t_d_s / (t * t)
        };
        self.peak_g * amplified * shape
    }

    /// Spectral displacement `S_De` (§ 3.2.3.2.3) at a period and a damping, in metres.
    pub fn displacement_m(&self, period_s: f64, damping_percent: f64, gravity_m_s2: f64) -> f64 {
        if period_s <= self.t_e_s {
            let acceleration_g = self.acceleration_g(period_s, damping_percent);
            return displacement_m(acceleration_g, period_s, gravity_m_s2);
        }
        let amplified = damping_factor(damping_percent) * self.hazard.f0;
        let part = ((period_s - self.t_e_s) / (T_F_S - self.t_e_s)).min(1.0);
        self.peak_displacement_m(gravity_m_s2) * (amplified + (1.0 - amplified) * part)
    }

    /// Peak displacement of the ground, `d_g = 0.025 a_g S T_C T_D`, in metres.
    pub fn peak_displacement_m(&self, gravity_m_s2: f64) -> f64 {
        0.025 * self.peak_g * gravity_m_s2 * self.t_c_s * self.t_d_s
    }

    /// Largest spectral displacement up to a period, in metres. The displacement decreases beyond `T_E`, and a structure that softens
    /// passes this period.
    pub fn largest_displacement_m(
        &self,
        period_s: f64,
        damping_percent: f64,
        gravity_m_s2: f64,
    ) -> f64 {
        let period_s = period_s.min(self.t_e_s);
        self.displacement_m(period_s, damping_percent, gravity_m_s2)
    }
}
