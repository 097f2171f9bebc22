//! The overturning spectrum: how strong a pulse must be to overturn a structure of some size.
//!
//! Beside an arch stands its equivalent free-standing column, which has the same `A_L` and the same frequency
//! parameter, and the restitution of the scenario if that is prescribed, else Housner's: how much of the arch is
//! told by that one block.

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
    /// There is no size to compare with.
    #[error("the structure has no unstable equilibrium, hence no equivalent block")]
    NoBlock,
    /// There is no such arch.
    #[error(transparent)]
    Limit(#[from] FourLinkError),
}

named! {
    /// The structures of a spectrum.
    pub enum StructureKind {
        /// The arch.
        Arch = "arch",
        /// The column, or that which is equivalent to the arch.
        Column = "column",
    }
}

/// How a structure overturns.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Overturning {
    /// Peak acceleration over `g A_L`.
    pub over_incipient: f64,
    /// Number of impacts before.
    pub impacts: usize,
    /// To which side.
    pub sway: Sway,
}

/// A point of a spectrum: a structure of some size.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PointRow {
    /// Which structure.
    pub structure: StructureKind,
    /// `p t_p`.
    pub p_t: f64,
    /// Duration of the pulse, in seconds.
    pub duration_s: f64,
    /// Least peak acceleration over `g A_L` that overturns without impact, bisected; `None` where no amplitude
    /// does that a scenario may have.
    pub no_impact_over_incipient: Option<f64>,
    /// The least that overturns at all: the least of those tried, or the one without impact where that is less.
    /// `None` if it is larger than all that are tried.
    pub minimum: Option<Overturning>,
    /// How many of the accelerations tried left the structure rocking at the end. They count as survived.
    pub still_rocking: usize,
    /// What could not be computed. It counts as survived.
    pub failures: Vec<Failure>,
}

/// What could not be computed of a point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Failure {
    /// Peak acceleration of the history over `g A_L`; `None`: the search for the least without impact.
    pub over_incipient: Option<f64>,
    /// Why.
    pub reason: String,
}

impl PointRow {
    /// The least that overturns, where it does so after impacts and is less than what overturns without.
    #[must_use]
    pub fn minimum_after_impacts(&self) -> Option<f64> {
        let least = self.minimum?.over_incipient;
        let edge = self.no_impact_over_incipient;
        edge.is_none_or(|edge| least < edge).then_some(least)
    }
}

/// The points of a spectrum: structure by structure, sizes ascending.
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

/// Time from the end of a pulse to that of a history, in units of `1/p`. Near the unstable equilibrium a motion
/// dwells for some forty of its time scales before rounding decides; once it has come back, the ground is still
/// and every impact takes energy. What rocks on then, as slender columns do for long, is as good as saved.
const END_P_T: f64 = 50.0;

impl<'a> OverturningSpectrum<'a> {
    /// The points of a scenario's spectrum, by default of what [`crate::scenario::Spectrum::default`] says.
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

    /// The peak accelerations over `g A_L` that are tried.
    #[must_use]
    pub fn over_incipient(&self) -> &[f64] {
        &self.over_incipient
    }

    /// How a pulse of another amplitude ends.
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
            // When it begins does not matter, and so no time is lost.
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
            failures: Vec::new(),
        };
        // What a scenario may have; the sequence ascends, so that the two go side by side.
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
        // One by one, and never by bisection: above the least there are others that do not overturn.
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
                        // Mechanisms count theirs.
                        impacts: impacts.unwrap_or(0),
                        sway,
                    });
                    break;
                }
                Ok(ending) if ending.outcome == Outcome::StillRocking => row.still_rocking += 1,
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
