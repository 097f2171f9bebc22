//! Whether a row stands, and the push that starts it, by limit analysis with any number of hinges.
//!
//! A row gives way under a load per unit mass if the velocities nearest to that load, among those that its
//! joints allow, are not zero (`contact`). These velocities then form a mechanism, and the load at
//! which it just does no work is an upper bound of the strength. Under that load the row either stands, and the
//! bound is the strength, or another mechanism lowers the bound. There are finitely many mechanisms, and the
//! bounds fall fast (Dinkelbach, "On nonlinear fractional programming", Management Science 13, 1967): it takes
//! only a few programs.

use nalgebra::{DMatrix, DVector, Vector2};
use thiserror::Error;

use super::blocks::Row;
use super::contact::{ContactError, Load, Program};
use super::joints::Placement;
use super::stance::Stance;
use super::tie::TieLine;
use crate::mechanics::geometry::field::Twist;
use crate::mechanics::geometry::ring::Edge;
use crate::mechanics::sway::Sway;

/// Velocities below this fraction of those without contact count as zero.
const STANDSTILL: f64 = 1e-9;

/// A joint that opens in a mechanism.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Opening {
    /// Index of the joint.
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
    /// Rates at which its ties lengthen, likewise.
    pub lengthening: Vec<f64>,
}

/// Why a row has no onset.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum StabilityError {
    /// The row does not carry its own weight.
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
    falls_at(row, &Stance::undeformed(row))
}

/// The mechanism in which a row falls under its own weight from where it stands; `None` when it stays.
///
/// # Errors
/// When the velocities under the weight are not found.
pub fn falls_at(row: &Row, stance: &Stance) -> Result<Option<Vec<Opening>>, ContactError> {
    let mut trial = Trial::new(row, stance);
    let moves = trial.moves(Vector2::new(0.0, -1.0), true)?;
    Ok(moves.map(|_| trial.openings()))
}

/// The least horizontal ground acceleration that starts the row swaying to a side, its ties pulling as they do at rest; `None` when no
/// push moves it without sliding.
///
/// # Errors
/// When the row does not stand, or the velocities of a trial are not found.
pub fn onset(row: &Row, sway: Sway) -> Result<Option<RowOnset>, StabilityError> {
    onset_at(row, &Stance::undeformed(row), sway)
}

/// The least horizontal ground acceleration that starts a row where it stands, on supports that may have moved. Open joints press at one corner, and may go on
/// opening or shut again. Its ties pull as they do there.
///
/// # Errors
/// Those of [`onset`].
pub fn onset_at(
    row: &Row,
    stance: &Stance,
    sway: Sway,
) -> Result<Option<RowOnset>, StabilityError> {
    let mut trial = Trial::new(row, stance);
    if trial.moves(Vector2::new(0.0, -1.0), true)?.is_some() {
        return Err(StabilityError::CannotStand(trial.openings()));
    }
    let mut load = Vector2::new(sway.sign(), 0.0);
    let mut found: Option<RowOnset> = None;
    // A push beyond all bounds leaves no part to ties.
    while let Some(work) = trial.moves(load, found.is_some())? {
        let lengthening = trial.lengthening();
        let ties = lengthening.iter().zip(&trial.ties_kg);
        let resists: f64 = ties.map(|(rate, kg)| rate * kg).sum();
        let acceleration_g = (work.y + resists) / (sway.sign() * work.x);
        // The bounds fall; below rounding they do not.
        let falls = |found: &RowOnset| acceleration_g < found.acceleration_g * (1.0 - 1e-14);
        if !found.as_ref().is_none_or(falls) {
            break;
        }
        found = Some(trial.onset(acceleration_g));
        load = Vector2::new(sway.sign() * acceleration_g, -1.0);
    }
    Ok(found)
}

/// The limit of a row whose ties yield.
#[derive(Clone, Debug, PartialEq)]
pub struct TiedLimit {
    /// The push and the mechanism that it starts, under these forces.
    pub onset: RowOnset,
    /// Forces of the ties then, in N.
    pub forces_n: Vec<f64>,
}

/// The largest horizontal ground acceleration that a row bears to a side whose ties pull with any force up to that at which they yield,
/// whatever they pull with at rest, and the least of these forces; `None` when it bears any.
///
/// Every mechanism bounds push and forces by a plane. The planes met so far are a small linear programme for the push and the forces to
/// try next, until nothing moves under these (Kelley, "The cutting-plane method for solving convex programs", J. SIAM 8, 1960).
///
/// # Errors
/// When the row does not stand with the forces at rest, or the velocities of a trial are not found.
pub fn limit_with_yielding_ties(
    row: &Row,
    sway: Sway,
) -> Result<Option<TiedLimit>, StabilityError> {
    let Some(at_rest) = onset(row, sway)? else {
        return Ok(None);
    };
    let pushed = |push_g: f64| Vector2::new(sway.sign() * push_g, -1.0);
    let weight_n = row.mass_kg() * row.gravity_m_s2;
    let ties = row.ties.iter();
    let most = ties.map(|tie| (tie.yield_force_n / weight_n).min(STRONGEST));
    let undeformed = Stance::undeformed(row);
    let mut trial = Trial::new(row, &undeformed);
    let work_at_rest = work(row, &undeformed.placement, &at_rest.velocities);
    let mut highest = Highest::new(most.collect());
    let at_rest = Plane::new(row, work_at_rest, &at_rest.lengthening, sway);
    highest.planes.push(at_rest);
    let (mut push_g, mut forces) = (f64::INFINITY, Vec::new());
    for _ in 0..MOST_TRIALS {
        let Some((highest_g, next)) = highest.find() else {
            break;
        };
        if (highest_g, &next) == (push_g, &forces) {
            break;
        }
        (push_g, forces) = (highest_g, next);
        let ties_kg = forces.iter().map(|force| force * row.mass_kg());
        trial.ties_kg = ties_kg.collect();
        let mut lower_g = push_g;
        let known = highest.planes.len();
        // With the same forces, down to the push that they bear.
        while trial.moves(pushed(lower_g), true)?.is_some() {
            let plane = Plane::new(row, trial.work(), &trial.lengthening(), sway);
            let bound_g = plane.bound_g(&forces);
            highest.planes.push(plane);
            let falls = |bound_g: &f64| *bound_g >= 0.0 && *bound_g < lower_g * (1.0 - 1e-14);
            let Some(bound_g) = bound_g.filter(falls) else {
                break;
            };
            lower_g = bound_g;
        }
        if highest.planes.len() == known {
            break;
        }
    }
    // A push that only the bounds of the programme limit is unlimited.
    let mut strongest = row.ties.iter().zip(&forces);
    let unbounded = push_g >= 0.99 * LARGEST_PUSH
        || strongest
            .any(|(tie, force)| tie.yield_force_n > force * weight_n && *force >= 0.99 * STRONGEST);
    if unbounded {
        return Ok(None);
    }
    // The mechanism is that of a push a little larger.
    trial.moves(pushed(push_g * (1.0 + BEYOND)), true)?;
    let ties = row.ties.iter().zip(&forces);
    let forces_n = ties.map(|(tie, force)| (force * weight_n).min(tie.yield_force_n));
    let (onset, forces_n) = (trial.onset(push_g), forces_n.collect());
    Ok(Some(TiedLimit { onset, forces_n }))
}

/// By what part a push is larger than the one that is just borne, to see the mechanism.
const BEYOND: f64 = 1e-6;
/// Pulls in units of the weight beyond which a tie that does not yield makes a push as large as anybody wants.
const STRONGEST: f64 = 1e3;
/// A push, in units of gravity, that is as good as any.
const LARGEST_PUSH: f64 = 1e6;
/// A push that is worth a force of the weight.
const LESS_FORCE: f64 = 1e-9;
/// Exchanges of constraints, at most.
const MOST_EXCHANGES: usize = 10_000;
/// After so many exchanges the inverse of the basis is computed anew.
const EXACT_EXCHANGES: usize = 100;
/// Part of its terms by which a constraint may be violated.
const ROUNDING: f64 = 1e-14;
/// Forces that are tried, at most.
const MOST_TRIALS: usize = 200;

/// A bound of the push and the forces of the ties, such as a mechanism leaves: their slopes times these are at most so much, in units of the
/// weight.
struct Plane {
    slopes: DVector<f64>,
    most: f64,
}

impl Plane {
    /// That of a mechanism, by the integral of its velocities over the masses.
    fn new(row: &Row, work: Vector2<f64>, lengthening: &[f64], sway: Sway) -> Self {
        let work = work / row.mass_kg();
        let (push, weight) = (sway.sign() * work.x, work.y);
        let all = lengthening.iter().copied().chain([push, weight]);
        let largest = all.map(f64::abs).fold(0.0, f64::max);
        let tied = lengthening.iter().map(|rate| -rate);
        let slopes = [push].into_iter().chain(tied);
        Self {
            slopes: DVector::from_iterator(1 + lengthening.len(), slopes) / largest,
            most: weight / largest,
        }
    }

    /// The push that it leaves with these forces, if it bounds any.
    fn bound_g(&self, forces: &[f64]) -> Option<f64> {
        let (push, pulls) = (self.slopes[0], self.slopes.iter().skip(1));
        let held: f64 = pulls.zip(forces).map(|(pull, force)| -pull * force).sum();
        (push > 0.0).then(|| (self.most + held) / push)
    }
}

/// The largest push below all planes, and the forces of the ties there.
///
/// The dual simplex method: from the corner of the bounds on it exchanges one of the constraints that meet there for the one that is
/// violated most. A further plane leaves that corner a start for the next search.
struct Highest {
    /// Largest forces of the ties.
    most: Vec<f64>,
    /// Bounds.
    planes: Vec<Plane>,
    /// Those that meet at the corner.
    basis: Vec<usize>,
    /// Inverse of the slopes of the basis, whose rows they are.
    inverse: DMatrix<f64>,
    goal: DVector<f64>,
}

impl Highest {
    fn new(most: Vec<f64>) -> Self {
        let width = 1 + most.len();
        let axis = |index: usize, slope: f64, most: f64| {
            let mut slopes = DVector::zeros(width);
            slopes[index] = slope;
            Plane { slopes, most }
        };
        let mut planes = vec![axis(0, 1.0, LARGEST_PUSH)];
        planes.extend((1..).zip(&most).map(|(tie, most)| axis(tie, 1.0, *most)));
        planes.extend((0..width).map(|index| axis(index, -1.0, 0.0)));
        // Of forces that are as good, the least.
        let mut goal = DVector::repeat(width, -LESS_FORCE);
        goal[0] = 1.0;
        // The first corner has the largest push and no forces; its slopes are their own inverse.
        let mut inverse = -DMatrix::identity(width, width);
        inverse[(0, 0)] = 1.0;
        Self {
            most,
            basis: [0].into_iter().chain(width + 1..2 * width).collect(),
            planes,
            inverse,
            goal,
        }
    }

    /// The push and the forces; `None` if there are none.
    fn find(&mut self) -> Option<(f64, Vec<f64>)> {
        for exchange in 1..=MOST_EXCHANGES {
            if exchange % EXACT_EXCHANGES == 0 {
                let width = self.basis.len();
                let slopes = DMatrix::from_fn(width, width, |row, column| {
                    self.planes[self.basis[row]].slopes[column]
                });
                self.inverse = slopes.try_inverse()?;
            }
            let at = self.corner();
            let Some(entering) = self.most_violated(&at) else {
                let ties = self.most.iter().enumerate();
                let forces = ties.map(|(tie, most)| at[1 + tie].clamp(0.0, *most));
                return Some((at[0], forces.collect()));
            };
            self.exchange(entering)?;
        }
        None
    }

    /// The point at which the constraints of the basis meet.
    fn corner(&self) -> DVector<f64> {
        let basis = || self.basis.iter().map(|index| &self.planes[*index]);
        let width = self.basis.len();
        let bounds = DVector::from_iterator(width, basis().map(|plane| plane.most));
        let at = &self.inverse * bounds;
        // The inverse has lost digits in exchanges.
        let left = basis().map(|plane| plane.most - plane.slopes.dot(&at));
        let left = DVector::from_iterator(width, left);
        at + &self.inverse * left
    }

    /// The constraint that a point violates most; `None` if there is none.
    fn most_violated(&self, at: &DVector<f64>) -> Option<usize> {
        let mut worst = (0.0, None);
        for (index, plane) in self.planes.iter().enumerate() {
            let (mut sum, mut size) = (-plane.most, plane.most.abs());
            for (slope, place) in plane.slopes.iter().zip(at.iter()) {
                sum += slope * place;
                size += (slope * place).abs();
            }
            let excess = sum - ROUNDING * size;
            if excess > worst.0 && !self.basis.contains(&index) {
                worst = (excess, Some(index));
            }
        }
        worst.1
    }

    /// Takes a constraint into the basis for one that leaves; `None` if none can.
    fn exchange(&mut self, entering: usize) -> Option<()> {
        let multipliers = self.inverse.tr_mul(&self.goal);
        let shares = self.inverse.tr_mul(&self.planes[entering].slopes);
        let (leaving, _) = (0..shares.len())
            .filter(|index| shares[*index] > 1e-11)
            .map(|index| (index, multipliers[index].max(0.0) / shares[index]))
            .min_by(|one, other| one.1.total_cmp(&other.1))?;
        self.basis[leaving] = entering;
        let column = self.inverse.column(leaving) / shares[leaving];
        for (index, mut other) in self.inverse.column_iter_mut().enumerate() {
            other.axpy(-shares[index], &column, 1.0);
        }
        self.inverse.set_column(leaving, &column);
        Some(())
    }
}

/// Integral of the velocities over the masses.
fn work(row: &Row, placement: &Placement, velocities: &[Twist]) -> Vector2<f64> {
    let blocks = row.blocks.iter().zip(&placement.centres_m).zip(velocities);
    let each = blocks.map(|((block, centre_m), twist)| twist.at(*centre_m) * block.mass_kg);
    each.sum()
}

/// A row under loads.
struct Trial<'a> {
    row: &'a Row,
    placement: &'a Placement,
    program: Program,
    load: Load,
    lines: Vec<TieLine>,
    /// Forces of the ties, over gravity.
    ties_kg: Vec<f64>,
}

impl<'a> Trial<'a> {
    fn new(row: &'a Row, stance: &'a Stance) -> Self {
        let placement = &stance.placement;
        let mut program = Program::new(row);
        program.place(placement);
        let ties_kg = stance.forces_n().map(|force_n| force_n / row.gravity_m_s2);
        Self {
            row,
            placement,
            program,
            load: Load::none(row),
            lines: stance.lines(row).collect(),
            ties_kg: ties_kg.collect(),
        }
    }

    /// The mechanism of the last trial, as that of this push.
    fn onset(&self, acceleration_g: f64) -> RowOnset {
        RowOnset {
            acceleration_g,
            openings: self.openings(),
            velocities: self.program.velocities.to_vec(),
            lengthening: self.lengthening(),
        }
    }

    /// Integral of the velocities over the masses, if the row moves under a load per unit mass.
    fn moves(
        &mut self,
        load: Vector2<f64>,
        with_ties: bool,
    ) -> Result<Option<Vector2<f64>>, ContactError> {
        let ties = self.lines.iter().zip(self.ties_kg.iter().copied());
        let pulling = ties.filter(|_| with_ties);
        self.load.push(self.row, self.placement, load, pulling);
        let fastest = (self.program).fastest(&self.load, self.row, self.placement)?;
        Ok((fastest > STANDSTILL * load.norm()).then(|| self.work()))
    }

    /// Integral of the velocities of the last trial over the masses.
    fn work(&self) -> Vector2<f64> {
        work(self.row, self.placement, &self.program.velocities)
    }

    /// Rates at which the ties lengthen in the last trial.
    fn lengthening(&self) -> Vec<f64> {
        let velocities = &self.program.velocities;
        let rates = self.lines.iter().map(|line| line.lengthening(velocities));
        rates.collect()
    }

    fn openings(&self) -> Vec<Opening> {
        let rates = || self.program.open_joints();
        let most = rates().flat_map(|(_, rates)| rates).fold(0.0, f64::max);
        let opens = rates().filter(|(_, rates)| rates.iter().any(|rate| *rate > 1e-9 * most));
        let openings = opens.map(|(joint, rates)| Opening {
            joint,
            hinge: match self.program.active[joint] {
                [true, _] => Some(Edge::Intrados),
                [_, true] => Some(Edge::Extrados),
                _ => None,
            },
            rates,
        });
        openings.collect()
    }
}
