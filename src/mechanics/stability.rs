//! Whether a row stands, and the push that starts it, by limit analysis with any number of hinges.
//!
//! A row gives way under a load per unit mass if the velocities nearest to that load, among those that its
//! joints allow, are not zero ([`super::contact`]). These velocities then form a mechanism, and the load at
//! which it just does no work is an upper bound of the strength. Under that load the row either stands, and the
//! bound is the strength, or another mechanism lowers the bound. There are finitely many mechanisms, and the
//! bounds fall fast (Dinkelbach, "On nonlinear fractional programming", Management Science 13, 1967): it takes
//! only a few programs.

use nalgebra::Vector2;
use thiserror::Error;

use super::blocks::Row;
use super::contact::{ContactError, Load, Program};
use crate::mechanics::geometry::field::Twist;
use crate::mechanics::geometry::ring::Edge;
use crate::mechanics::joints::Placement;
use crate::mechanics::sway::Sway;

/// Velocities below this fraction of those without contact count as zero.
const STANDSTILL: f64 = 1e-9;

/// A joint that opens in a mechanism.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Opening {
    /// Which joint.
    pub joint: usize,
    /// The corner about which it opens; `None` where both edges open.
    pub hinge: Option<Edge>,
    /// Rates of the gaps at intrados and extrados, up to a common factor.
    pub rates: [f64; 2],
}

/// The push that starts a row.
#[derive(Clone, Debug, PartialEq)]
pub struct RowOnset {
    /// Ground acceleration, without its sign, in units of gravity.
    pub acceleration_g: f64,
    /// The mechanism that starts, from left to right.
    pub openings: Vec<Opening>,
    /// Velocities of its blocks from left to right, in metres and up to a common factor; their pole is the origin.
    pub velocities: Vec<Twist>,
}

/// Why a row has no onset.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum StabilityError {
    /// It does not carry its own weight.
    #[error("the row cannot carry its own weight")]
    CannotStand(Vec<Opening>),
    /// The velocities of a trial were not found.
    #[error(transparent)]
    Contact(#[from] ContactError),
}

/// The mechanism in which a row falls under its own weight; `None` when it stands.
///
/// # Errors
/// When the velocities under the weight are not found.
pub fn falls(row: &Row) -> Result<Option<Vec<Opening>>, ContactError> {
    let undeformed = Placement::new(row);
    let mut trial = Trial::new(row, &undeformed);
    Ok(trial
        .moves(Vector2::new(0.0, -1.0))?
        .map(|_| trial.openings()))
}

/// The least horizontal ground acceleration that starts the row swaying to a side; `None` when no push moves
/// it without sliding.
///
/// # Errors
/// When the row does not stand, or the velocities of a trial are not found.
pub fn onset(row: &Row, sway: Sway) -> Result<Option<RowOnset>, StabilityError> {
    onset_at(row, &Placement::new(row), sway)
}

/// The same where some joints are open already, as where supports have moved: those press at their corners alone, and may go on
/// opening or shut again.
///
/// # Errors
/// As [`onset`].
pub fn onset_at(
    row: &Row,
    placement: &Placement,
    sway: Sway,
) -> Result<Option<RowOnset>, StabilityError> {
    let mut trial = Trial::new(row, placement);
    if trial.moves(Vector2::new(0.0, -1.0))?.is_some() {
        return Err(StabilityError::CannotStand(trial.openings()));
    }
    let mut load = Vector2::new(sway.sign(), 0.0);
    let mut found: Option<RowOnset> = None;
    while let Some(work) = trial.moves(load)? {
        let acceleration_g = work.y / (sway.sign() * work.x);
        // The bounds fall until rounding stops them.
        if found
            .as_ref()
            .is_some_and(|found| acceleration_g >= found.acceleration_g * (1.0 - 1e-14))
        {
            break;
        }
        found = Some(RowOnset {
            acceleration_g,
            openings: trial.openings(),
            velocities: trial.program.velocities().to_vec(),
        });
        load = Vector2::new(sway.sign() * acceleration_g, -1.0);
    }
    Ok(found)
}

/// A row under loads.
struct Trial<'a> {
    row: &'a Row,
    centres_m: &'a [Vector2<f64>],
    program: Program,
    free: Vec<Twist>,
    jumps: Vec<Twist>,
    touching: Vec<[bool; 2]>,
}

impl<'a> Trial<'a> {
    fn new(row: &'a Row, placement: &'a Placement) -> Self {
        let mut program = Program::new(row);
        program.place(placement);
        let gaps_m = placement.gaps_m().iter();
        Self {
            row,
            centres_m: placement.centres_m(),
            program,
            free: vec![Twist::ZERO; row.blocks().len()],
            jumps: vec![Twist::ZERO; row.joints().len()],
            touching: gaps_m.map(|gaps| gaps.map(|gap| gap == 0.0)).collect(),
        }
    }

    /// Integral of the velocities over the masses, if the row moves under a load per unit mass.
    fn moves(&mut self, load: Vector2<f64>) -> Result<Option<Vector2<f64>>, ContactError> {
        self.free.fill(Twist::translation(load));
        let load_case = Load {
            free: &self.free,
            jumps: &self.jumps,
            touching: &self.touching,
        };
        self.program.solve(&load_case)?;
        let blocks = self.row.blocks().iter().zip(self.centres_m);
        let mut work = Vector2::zeros();
        let mut fastest = 0.0_f64;
        for ((block, centre_m), twist) in blocks.zip(self.program.velocities()) {
            let velocity = twist.at(*centre_m);
            work += velocity * block.mass_kg;
            fastest = fastest
                .max(velocity.norm())
                .max(twist.rate.abs() * self.row.size_m());
        }
        Ok((fastest > STANDSTILL * load.norm()).then_some(work))
    }

    fn openings(&self) -> Vec<Opening> {
        let rates = || self.program.open_joints();
        let most = rates().flat_map(|(_, rates)| rates).fold(0.0, f64::max);
        let opens = rates().filter(|(_, rates)| rates.iter().any(|rate| *rate > 1e-9 * most));
        opens
            .map(|(joint, rates)| Opening {
                joint,
                hinge: match self.program.active()[joint] {
                    [true, _] => Some(Edge::Intrados),
                    [_, true] => Some(Edge::Extrados),
                    _ => None,
                },
                rates,
            })
            .collect()
    }
}
