//! The overturning spectrum: how strong a pulse must be to overturn a structure of a given size.
//!
//! An arch is compared with its equivalent free-standing column. The column has the same `A_L` and the same frequency
//! parameter, and the restitution of the scenario if that is prescribed, otherwise Housner's. The comparison shows how
//! well this single block represents the arch.

pub mod picture;
mod told;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::ending::{Ending, check_finite};
use super::impact_free::ScalablePulse;
use super::runner::Study;
use crate::dynamics::history::Outcome;
use crate::dynamics::model::{MechanismModel, Request};
use crate::mechanics::column::{Column, RockingColumn};
use crate::mechanics::four_link::arch::FourLinkError;
use crate::mechanics::sway::Sway;
use crate::scenario::{Ground, MAX_ACCELERATION_G, PulseGround, Scenario, block};

/// Why a scenario has no spectrum.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum NoSpectrum {
    /// Its histories do not start from rest.
    #[error("the histories of a spectrum start from rest: leave [initial] out")]
    Initial,
    /// Its hinges are free.
    #[error(
        "a spectrum needs four links or a column, whose motion is similar at all sizes: leave [{0}] out"
    )]
    Joints(&'static str),
    /// There is no pulse whose duration could vary.
    #[error(
        "a spectrum needs a pulse: give a table [ground.<kind>], such as [ground.rectangular]; only \
         the sign of its amplitude is used, durations and amplitudes are those of [spectrum]"
    )]
    NoPulse,
    /// There is no equivalent block to measure the size.
    #[error("the structure has no unstable equilibrium, hence no equivalent block")]
    NoBlock,
    /// The structure does not rock as four links.
    #[error(transparent)]
    Limit(#[from] FourLinkError),
}

named! {
    /// The structures of a spectrum.
    pub enum StructureKind {
        /// The arch.
        Arch = "arch",
        /// The column, or the equivalent column of the arch.
        Column = "column",
    }
}

/// How a structure overturns.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Overturning {
    /// Peak acceleration over `g A_L`.
    pub over_incipient: f64,
    /// Number of impacts before overturning.
    pub impacts: usize,
    /// The side to which it overturns.
    pub sway: Sway,
}

/// A point of a spectrum: a structure of a given size.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PointRow {
    /// The structure.
    pub structure: StructureKind,
    /// `p t_p`.
    pub p_t: f64,
    /// Duration of the pulse, in seconds.
    pub duration_s: f64,
    /// Least peak acceleration over `g A_L` that overturns without impact, by bisection; `None` if no amplitude that
    /// a scenario may have does so.
    pub no_impact_over_incipient: Option<f64>,
    /// The least that overturns at all: the least of those tried, or the one without impact if that is smaller.
    /// `None` if none of those tried overturns.
    pub minimum: Option<Overturning>,
    /// Number of tried accelerations that left the structure still rocking at the end. They count as survived.
    pub still_rocking: usize,
    /// Number of tried accelerations that left the structure with too much energy for a verdict at the end. They count neither as
    /// survived nor as overturned.
    #[serde(default)]
    pub incomplete: usize,
    /// Histories and searches that could not be computed, which count neither as survived nor as overturned.
    pub failures: Vec<Failure>,
}

/// A computation that failed at a point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Failure {
    /// Peak acceleration of the history over `g A_L`; `None` if the search for the least without impact failed.
    pub over_incipient: Option<f64>,
    /// The reason.
    pub reason: String,
}

impl PointRow {
    /// The least that overturns, if it does so after impacts and is less than the least that overturns without impact.
    #[must_use]
    pub fn minimum_after_impacts(&self) -> Option<f64> {
        let least = self.minimum?.over_incipient;
        let edge = self.no_impact_over_incipient;
        edge.is_none_or(|edge| least < edge).then_some(least)
    }
}

/// The points of a spectrum: one structure after the other, with ascending sizes.
#[derive(Debug)]
pub struct OverturningSpectrum<'a> {
    scenario: &'a Scenario,
    pulse: &'a PulseGround,
    request: Request,
    frequency_rad_s: f64,
    structures: Vec<(StructureKind, Box<dyn MechanismModel>)>,
    p_t: Vec<f64>,
    over_incipient: Vec<f64>,
}

/// Time from the end of a pulse to the end of a history, in units of `1/p`. Near the unstable equilibrium a motion
/// dwells for some forty of these units before rounding decides. If it comes back, the ground is still by then
/// and every impact takes energy. A motion that still rocks at the end, as slender columns do for long, is as good as safe.
const END_P_T: f64 = 50.0;

impl<'a> OverturningSpectrum<'a> {
    /// The points of a scenario's spectrum; without a table `[spectrum]`, those of [`crate::scenario::Spectrum::default`].
    ///
    /// # Errors
    /// When the scenario has no spectrum.
    pub fn new(scenario: &'a Scenario) -> Result<Self, NoSpectrum> {
        if scenario.initial().is_some() {
            return Err(NoSpectrum::Initial);
        }
        if scenario.motion().hinges().has_joints() {
            return Err(NoSpectrum::Joints(scenario.motion().table_name()));
        }
        let Some(Ground::Pulse(pulse)) = scenario.ground() else {
            return Err(NoSpectrum::NoPulse);
        };
        let request = scenario.request_from_rest();
        let model = scenario.mechanisms()?;
        let (slenderness_rad, block) =
            block(&*model, request.gravity_m_s2).ok_or(NoSpectrum::NoBlock)?;
        let structures = if scenario.structure().thrusts() {
            let (depth_m, density_kg_m3) = scenario.structure().depth_and_density();
            let (sin, cos) = slenderness_rad.sin_cos();
            let diagonal_m = 2.0 * block.half_diagonal_m;
            let column = Column::new(diagonal_m * cos, diagonal_m * sin)
                .and_then(|column| column.with_depth_m(depth_m))
                .and_then(|column| column.with_density_kg_m3(density_kg_m3))
                .and_then(|column| RockingColumn::new(&column, scenario.motion().impact()))
                .map_err(FourLinkError::from)?;
            vec![
                (StructureKind::Arch, model),
                (StructureKind::Column, Box::new(column)),
            ]
        } else {
            vec![(StructureKind::Column, model)]
        };
        let spectrum = scenario.spectrum().cloned().unwrap_or_default();
        Ok(Self {
            scenario,
            pulse,
            request,
            frequency_rad_s: block.frequency_rad_s,
            structures,
            p_t: spectrum.p_t.values(),
            over_incipient: spectrum.acceleration_over_incipient.values(),
        })
    }

    /// The structures: the arch and its equivalent column, or the column.
    #[must_use]
    pub fn structures(&self) -> &[(StructureKind, Box<dyn MechanismModel>)] {
        &self.structures
    }

    /// The sizes `p t_p`.
    #[must_use]
    pub fn sizes(&self) -> &[f64] {
        &self.p_t
    }

    /// The peak accelerations over `g A_L` to try.
    #[must_use]
    pub fn over_incipient(&self) -> &[f64] {
        &self.over_incipient
    }

    /// How the history under a pulse of another amplitude ends.
    fn ending(
        &self,
        model: &dyn MechanismModel,
        pulse: &ScalablePulse,
        amplitude_g: f64,
    ) -> Result<Ending, String> {
        let ground = pulse.motion_of_magnitude(amplitude_g);
        let request = Request {
            end_s: ground.end_s() + END_P_T / self.frequency_rad_s,
            ..self.request
        };
        Ending::of(model, &ground, &request)
    }
}

impl Study for OverturningSpectrum<'_> {
    type Row = PointRow;

    const NAME: &'static str = "spectrum";

    fn scenario(&self) -> String {
        self.scenario.to_toml()
    }

    fn count(&self) -> usize {
        self.structures.len() * self.p_t.len()
    }

    fn row(&self, index: usize) -> PointRow {
        let (structure, model) = &self.structures[index / self.p_t.len()];
        let p_t = self.p_t[index % self.p_t.len()];
        let duration_s = p_t / self.frequency_rad_s;
        let pulse = PulseGround {
            duration_s,
            // The start of the pulse does not matter, so the history need not wait for it.
            start_s: 0.0,
            ..self.pulse.clone()
        };
        let pulse = ScalablePulse::new(pulse, self.request.gravity_m_s2);
        let incipient_g = model
            .incipient_acceleration_g(Sway::Right)
            .unwrap_or(f64::INFINITY);
        let mut row = PointRow {
            structure: *structure,
            p_t,
            duration_s,
            no_impact_over_incipient: None,
            minimum: None,
            still_rocking: 0,
            incomplete: 0,
            failures: Vec::new(),
        };
        // Only amplitudes that a scenario may have. The sequence ascends, so the two lists run in parallel.
        let tried_g: Vec<f64> = self
            .over_incipient
            .iter()
            .map(|over_incipient| over_incipient * incipient_g)
            .filter(|amplitude_g| *amplitude_g <= MAX_ACCELERATION_G)
            .collect();
        let edge = pulse.minimum_without_impact(&**model, &self.request, &tried_g);
        let edge = edge.map_err(|error| error.to_string()).and_then(|edge| {
            let edge = edge.map(|(edge_g, sway)| (edge_g, edge_g / incipient_g, sway));
            check_finite(edge.map(|edge| edge.1).as_slice()).map(|()| edge)
        });
        let mut below_g = f64::INFINITY;
        match edge {
            Ok(Some((edge_g, over_incipient, sway))) => {
                row.no_impact_over_incipient = Some(over_incipient);
                if tried_g.last().is_some_and(|last_g| edge_g <= *last_g) {
                    below_g = edge_g;
                    row.minimum = Some(Overturning {
                        over_incipient,
                        impacts: 0,
                        sway,
                    });
                }
            }
            Ok(None) => {}
            Err(reason) => row.failures.push(Failure {
                over_incipient: None,
                reason,
            }),
        }
        // One by one, not by bisection: some amplitudes above the least do not overturn.
        for (over_incipient, amplitude_g) in self.over_incipient.iter().copied().zip(tried_g) {
            if amplitude_g >= below_g {
                break;
            }
            match self.ending(&**model, &pulse, amplitude_g) {
                Ok(Ending {
                    outcome: Outcome::Overturned(sway),
                    impacts,
                    ..
                }) => {
                    row.minimum = Some(Overturning {
                        over_incipient,
                        // Mechanisms always count their impacts.
                        impacts: impacts.unwrap_or(0),
                        sway,
                    });
                    break;
                }
                Ok(ending) if ending.outcome == Outcome::StillRocking => row.still_rocking += 1,
                Ok(ending) if ending.outcome == Outcome::Incomplete => row.incomplete += 1,
                Ok(_) => {}
                Err(reason) => row.failures.push(Failure {
                    over_incipient: Some(over_incipient),
                    reason,
                }),
            }
        }
        row
    }
}
