//! The overturning spectrum: `[spectrum]`.
//!
//! ```toml
//! [spectrum]
//! p_t = { from = 0.2, to = 10.0, count = 50, spacing = "logarithmic" }
//! acceleration_over_incipient = { from = 1.0, to = 20.0, count = 400, spacing = "logarithmic" }
//! ```
//!
//! How strong must a pulse be to overturn a structure of some size? With the frequency parameter `p` of the
//! equivalent block at the unstable equilibrium (see [`crate::mechanics::equivalent`]) and the duration `t_p`
//! of the pulse, size is `p t_p`: similar structures under pulses of one shape do the same at the same `p t_p`
//! and the same peak acceleration over `g A_L`. So the structure stays as it is, and the duration varies; so
//! does the horizontal amplitude, while a vertical one stays.
//!
//! Beside an arch stands its equivalent free-standing column, which has the same `A_L` and the same `p`, and
//! the restitution of the scenario if that is prescribed, else Housner's: how much of the arch is told by that
//! one block.

use std::ops::Bound::{Excluded, Included};

use thiserror::Error;

use super::keys::{DURATION_S, LARGEST_G};
use super::sequence::{Sequence, Spacing};
use super::table::{Number, Reading, Rule as _, Table, Writer};
use super::{Ground, PulseGround, Scenario, Structure};
use crate::dynamics::history::Outcome;
use crate::dynamics::model::SimulationError;
use crate::mechanics::column::{Column, RockingColumn};
use crate::mechanics::equivalent::{Block, Equivalent};
use crate::mechanics::four_link::arch::FourLinkError;
use crate::mechanics::four_link::impact::ImpactModel;
use crate::mechanics::four_link::mechanism::Sway;
use crate::studies::specimen::{Conditions, Specimen};

/// What is tried for a spectrum.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    /// The sizes `p t_p`.
    pub p_t: Sequence,
    /// Peak accelerations of the pulse over `g A_L`, as magnitudes: the scenario's own amplitude says to which
    /// side.
    pub acceleration_over_incipient: Sequence,
}

/// Beyond, a pulse is a blow or a new rest.
const P_T: Number = Number(Included(1e-3), Included(1e3));
/// Beyond a million times nothing is tried that stands.
const ACCELERATION_OVER_INCIPIENT: Number = Number(Excluded(0.0), Included(1e6));

impl Default for Spectrum {
    fn default() -> Self {
        let range = |from, to, count| Sequence::Range {
            from,
            to,
            count,
            spacing: Spacing::Logarithmic,
        };
        Self {
            p_t: range(0.2, 10.0, 50),
            acceleration_over_incipient: range(1.0, 20.0, 400),
        }
    }
}

impl Spectrum {
    /// Reads `[spectrum]`; whether it suits what stands and how it is shaken is told where they are known.
    pub(super) fn read(
        table: &mut Table<'_>,
        structure: Option<&Structure>,
        ground: Option<&Option<Ground>>,
        gravity_m_s2: Reading<f64>,
    ) -> Reading<Self> {
        let default = Self::default();
        let p_t = Sequence::read(table, "p_t", &P_T);
        let accelerations = Sequence::read(
            table,
            "acceleration_over_incipient",
            &ACCELERATION_OVER_INCIPIENT,
        );
        let spectrum = Self {
            p_t: p_t?.unwrap_or(default.p_t),
            acceleration_over_incipient: accelerations?
                .unwrap_or(default.acceleration_over_incipient),
        };
        Ground::check_pulse(table, ground)?;
        let specimen = structure.and_then(|s| s.specimen(ImpactModel::MaxRestitution).ok());
        if let (Some(specimen), Ok(gravity_m_s2)) = (specimen, gravity_m_s2)
            && let Some((_, block)) = block(&specimen, gravity_m_s2)
            && let Some(largest) = spectrum.p_t.values().last()
        {
            let longest_s = largest / block.frequency_rad_s;
            if !DURATION_S.contains(longest_s) {
                let wrong = format!(
                    "makes a pulse of {longest_s:?} s, as p is {:?} rad/s; the duration is to be {}",
                    block.frequency_rad_s,
                    DURATION_S.allowed()
                );
                return Err(table.wrong("p_t", wrong));
            }
        }
        Ok(spectrum)
    }

    pub(super) fn write(&self, out: &mut Writer) {
        let Self {
            p_t,
            acceleration_over_incipient,
        } = self;
        out.table("spectrum");
        p_t.write("p_t", out);
        acceleration_over_incipient.write("acceleration_over_incipient", out);
    }
}

/// The equivalent block of a specimen at the unstable equilibrium, and its slenderness in radians.
fn block(specimen: &Specimen, gravity_m_s2: f64) -> Option<(f64, Block)> {
    let Equivalent {
        slenderness_rad,
        at_critical,
        ..
    } = specimen.equivalent(gravity_m_s2)?;
    Some((slenderness_rad, at_critical?))
}

/// Why a scenario has no spectrum.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum NoSpectrum {
    /// Its histories do not start from rest.
    #[error("the histories of a spectrum start from rest: leave [initial] out")]
    Initial,
    /// There is no pulse whose duration could vary.
    #[error(
        "a spectrum needs a pulse: give a table [ground.<kind>], such as [ground.rectangular]; its \
         amplitude says to which side, and the durations and amplitudes are those of [spectrum]"
    )]
    NoPulse,
    /// There is no size to compare with.
    #[error("the structure has no unstable equilibrium, and so no equivalent block")]
    NoBlock,
    /// There is no such arch.
    #[error(transparent)]
    Limit(#[from] FourLinkError),
}

/// A point of a spectrum: a structure of some size.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// `arch` or `column`.
    pub structure: &'static str,
    /// `p t_p`.
    pub p_t: f64,
    /// Duration of the pulse.
    pub duration_s: f64,
    /// Least peak acceleration over `g A_L` that overturns without impact, bisected; `None` where no amplitude
    /// does that a scenario may have.
    pub no_impact_over_incipient: Option<f64>,
    /// The least that overturns at all: the least of those tried, or the one without impact where that is less.
    /// `None` if it is larger than all that are tried.
    pub least: Option<Overturning>,
    /// How many of the accelerations tried left the structure rocking at the end. They count as survived.
    pub still_rocking: usize,
    /// Histories that could not be computed. They count as survived.
    pub failures: Vec<SimulationError>,
}

/// How a structure overturns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overturning {
    /// Peak acceleration over `g A_L`.
    pub over_incipient: f64,
    /// Number of impacts before.
    pub impacts: usize,
    /// To which side.
    pub sway: Sway,
}

/// The points of a spectrum, each a function of its index alone: structure by structure, sizes ascending.
#[derive(Debug)]
pub struct Points<'a> {
    pulse: &'a PulseGround,
    conditions: Conditions,
    frequency_rad_s: f64,
    structures: Vec<(&'static str, Specimen)>,
    p_t: Vec<f64>,
    over_incipient: Vec<f64>,
}

/// Time from the end of a pulse to that of a history, in units of `1/p`. Near the unstable equilibrium a motion
/// dwells for some forty of its time scales before rounding decides; once it has come back, the ground is still
/// and every impact takes energy. What rocks on then, as slender columns do for long, is as good as saved.
const END_P_T: f64 = 50.0;

impl<'a> Points<'a> {
    /// The points of a scenario's spectrum, by default of what [`Spectrum::default`] says.
    ///
    /// # Errors
    /// When the scenario has no spectrum.
    pub fn new(scenario: &'a Scenario) -> Result<Self, NoSpectrum> {
        if scenario.initial.is_some() {
            return Err(NoSpectrum::Initial);
        }
        let Some(Ground::Pulse(pulse)) = &scenario.ground else {
            return Err(NoSpectrum::NoPulse);
        };
        let conditions = scenario.conditions();
        let specimen = scenario.structure.specimen(scenario.impact)?;
        let (slenderness_rad, block) =
            block(&specimen, conditions.gravity_m_s2).ok_or(NoSpectrum::NoBlock)?;
        let structures = match &specimen {
            Specimen::Column(_) => vec![("column", specimen)],
            Specimen::Arch(arch) => {
                let (sin, cos) = slenderness_rad.sin_cos();
                let diagonal_m = 2.0 * block.half_diagonal_m;
                let column = Column::new(diagonal_m * cos, diagonal_m * sin)
                    .and_then(|column| column.with_depth_m(arch.arch().depth_m()))
                    .and_then(|column| column.with_density_kg_m3(arch.arch().density_kg_m3()))
                    .and_then(|column| RockingColumn::new(&column, scenario.impact))
                    .map_err(FourLinkError::from)?;
                vec![("arch", specimen), ("column", Specimen::Column(column))]
            }
        };
        let spectrum = scenario.spectrum.clone().unwrap_or_default();
        Ok(Self {
            pulse,
            conditions,
            frequency_rad_s: block.frequency_rad_s,
            structures,
            p_t: spectrum.p_t.values(),
            over_incipient: spectrum.acceleration_over_incipient.values(),
        })
    }

    /// What is shaken, by name: the arch and its equivalent column, or the column.
    #[must_use]
    pub fn structures(&self) -> &[(&'static str, Specimen)] {
        &self.structures
    }

    /// The sizes `p t_p`.
    #[must_use]
    pub fn sizes(&self) -> &[f64] {
        &self.p_t
    }

    /// The peak accelerations over `g A_L` that are tried.
    #[must_use]
    pub fn over_incipient(&self) -> &[f64] {
        &self.over_incipient
    }

    /// Number of points.
    #[must_use]
    pub fn count(&self) -> usize {
        self.structures.len() * self.p_t.len()
    }

    /// A point.
    #[must_use]
    pub fn point(&self, index: usize) -> Point {
        let (structure, specimen) = &self.structures[index / self.p_t.len()];
        let p_t = self.p_t[index % self.p_t.len()];
        let pulse = PulseGround {
            duration_s: p_t / self.frequency_rad_s,
            // When it begins does not matter, and so no time is lost.
            start_s: 0.0,
            ..self.pulse.clone()
        };
        let incipient_g = specimen.incipient_g();
        let mut point = Point {
            structure,
            p_t,
            duration_s: pulse.duration_s,
            no_impact_over_incipient: None,
            least: None,
            still_rocking: 0,
            failures: Vec::new(),
        };
        // What a scenario may have; the sequence ascends, so that the two go side by side.
        let tried_g: Vec<f64> = self
            .over_incipient
            .iter()
            .map(|over_incipient| over_incipient * incipient_g)
            .filter(|amplitude_g| *amplitude_g <= LARGEST_G)
            .collect();
        let mut below_g = f64::INFINITY;
        match pulse.without_impact(specimen, &self.conditions, &tried_g) {
            Ok(Some((amplitude_g, sway))) => {
                let over_incipient = amplitude_g / incipient_g;
                point.no_impact_over_incipient = Some(over_incipient);
                if tried_g.last().is_some_and(|last_g| amplitude_g <= *last_g) {
                    below_g = amplitude_g;
                    point.least = Some(Overturning {
                        over_incipient,
                        impacts: 0,
                        sway,
                    });
                }
            }
            Ok(None) => {}
            Err(error) => point.failures.push(error),
        }
        // One by one, and never by bisection: above the least there are others that do not overturn.
        for (over_incipient, amplitude_g) in self.over_incipient.iter().copied().zip(tried_g) {
            if amplitude_g >= below_g {
                break;
            }
            match self.outcome(specimen, &pulse, amplitude_g) {
                Ok((Outcome::Overturned(sway), impacts)) => {
                    point.least = Some(Overturning {
                        over_incipient,
                        impacts,
                        sway,
                    });
                    break;
                }
                Ok((Outcome::StillRocking, _)) => point.still_rocking += 1,
                Ok((Outcome::NeverMoved | Outcome::Rest, _)) => {}
                Err(error) => point.failures.push(error),
            }
        }
        point
    }

    /// What a pulse of another amplitude does, and after how many impacts.
    fn outcome(
        &self,
        specimen: &Specimen,
        pulse: &PulseGround,
        amplitude_g: f64,
    ) -> Result<(Outcome, usize), SimulationError> {
        let ground = pulse
            .of_magnitude(amplitude_g)
            .motion(self.conditions.gravity_m_s2);
        let conditions = Conditions {
            end_s: ground.end_s() + END_P_T / self.frequency_rad_s,
            ..self.conditions
        };
        let verdict = specimen.verdict(&ground, &conditions)?;
        Ok((verdict.outcome, verdict.impacts))
    }
}
