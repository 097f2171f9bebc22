//! Stability of a row under its own weight, and the push of its first motion, by limit analysis with any number of hinges.
//!
//! Under a load per unit mass, the admissible velocities nearest to that load are computed (`contact`). The row gives way if they are not zero. The
//! velocities then form a mechanism. The load at which this mechanism does no work is an upper bound of the strength. If the row is stable under this
//! load, the bound is the strength; otherwise the next mechanism gives a lower bound. The number of mechanisms is finite and convergence is
//! superlinear (Dinkelbach, "On nonlinear fractional programming", Management Science 13, 1967): a few quadratic programs suffice.

use nalgebra::{DMatrix, DVector, Vector2};
use thiserror::Error;

use super::contact::{ContactError, ContactProgram, Load};
use super::geometry::hull::are_apart;
use crate::mechanics::{Edge, Joint, Placement, Row, RowState, Supports, Sway, TieLine, Twist};

/// Velocities below this fraction of those without contact count as zero.
const STANDSTILL: f64 = 1e-9;
/// Distance between the hulls of all intrados and of all extrados corners, over the thickness of the thinnest joint, from which on a straight line
/// fits between them.
const STRAIGHT_RATIO: f64 = 1e-9;

/// Joint that opens in a mechanism.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpeningJoint {
    /// Index of the joint.
    pub joint: usize,
    /// Corner about which the joint opens; `None` if it opens at both edges.
    pub hinge: Option<Edge>,
    /// Rates of the gaps at intrados and extrados, up to a common factor.
    pub rates: [f64; 2],
}

/// Push of the first motion of a row, with its mechanism.
#[derive(Clone, Debug, PartialEq)]
pub struct RowOnset {
    /// Ground acceleration, without its sign, in units of gravity.
    pub acceleration_g: f64,
    /// Opening joints of the mechanism, from left to right.
    pub openings: Vec<OpeningJoint>,
    /// Velocities of the blocks from left to right, in metres up to a common factor, at the origin.
    pub velocities: Vec<Twist>,
    /// Rates at which the ties lengthen, in metres up to the same factor.
    pub lengthening: Vec<f64>,
}

/// Reason why a row has no push of first motion.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum StabilityError {
    /// The row does not carry its own weight.
    #[error("the row cannot carry its own weight")]
    CannotStand(Vec<OpeningJoint>),
    /// The velocities of a trial mechanism were not found.
    #[error(transparent)]
    Contact(#[from] ContactError),
}

/// Mechanism in which an undeformed row falls under its own weight; `None` if it is stable.
///
/// # Errors
/// When the velocities under the weight are not found.
pub fn collapse_mechanism(row: &Row) -> Result<Option<Vec<OpeningJoint>>, ContactError> {
    collapse_mechanism_at(row, &RowState::undeformed(row))
}

/// Mechanism in which a row falls under its own weight from a given state; `None` if it is in equilibrium.
///
/// # Errors
/// When the velocities under the weight are not found.
pub(crate) fn collapse_mechanism_at(
    row: &Row,
    stance: &RowState,
) -> Result<Option<Vec<OpeningJoint>>, ContactError> {
    let mut trial = Trial::new(row, stance);
    let moves = trial.motion_of_masses(Vector2::new(0.0, -1.0), true)?;
    Ok(moves.map(|_| trial.openings()))
}

/// Whether a straight line fits into an undeformed row between two supports, inside all its joints. No load moves such a row without sliding:
/// the thrust along that line can be as large as the load needs.
///
/// There is no mechanism either. Its hinges would turn by `w > 0` at the intrados and by `-w` at the extrados, and the supports stay, so that both
/// kinds have the same sum of `w` and of `w` times position: a point in both convex hulls. Between these is the line.
pub fn is_straight(row: &Row) -> bool {
    let [intrados, extrados] = [Edge::Intrados, Edge::Extrados].map(|edge| {
        let corners = row.joints.iter().map(|joint| joint.corner_m(edge));
        corners.collect::<Vec<_>>()
    });
    let thicknesses_m = row.joints.iter().map(Joint::thickness_m);
    let thinnest_m = thicknesses_m.fold(f64::INFINITY, f64::min);
    row.supports == Supports::Both && are_apart([&intrados, &extrados], STRAIGHT_RATIO * thinnest_m)
}

/// Least horizontal ground acceleration at which the undeformed row starts to sway to a side, with the tie forces at rest. `None` if no
/// push moves the row without sliding, as where a straight line fits into it.
///
/// # Errors
/// When the row does not stand, or the velocities of a trial are not found.
pub fn onset(row: &Row, sway: Sway) -> Result<Option<RowOnset>, StabilityError> {
    onset_at(row, &RowState::undeformed(row), sway)
}

/// Least horizontal ground acceleration at which a row in a given state starts to sway to a side, also on moved supports. Open joints are
/// in contact at one corner, and may open further or close again. The tie forces are those of the given state.
///
/// # Errors
/// Those of [`onset`].
pub fn onset_at(
    row: &Row,
    stance: &RowState,
    sway: Sway,
) -> Result<Option<RowOnset>, StabilityError> {
    let placement = &stance.placement;
    if placement.open_corners() == 0 && is_straight(row) {
        return Ok(None);
    }
    let mut trial = Trial::new(row, stance);
    if trial
        .motion_of_masses(Vector2::new(0.0, -1.0), true)?
        .is_some()
    {
        return Err(StabilityError::CannotStand(trial.openings()));
    }
    let mut load = Vector2::new(sway.sign(), 0.0);
    let mut found: Option<RowOnset> = None;
    // The first trial is an infinite push, compared with which ties have no effect.
    while let Some(work) = trial.motion_of_masses(load, found.is_some())? {
        let lengthening = trial.lengthening();
        let ties = lengthening.iter().zip(&trial.ties_kg);
        let resists: f64 = ties.map(|(rate, kg)| rate * kg).sum();
        let acceleration_g = (work.y + resists) / (sway.sign() * work.x);
        // The bounds decrease, except within rounding error.
        let falls = |found: &RowOnset| acceleration_g < found.acceleration_g * (1.0 - 1e-14);
        if !found.as_ref().is_none_or(falls) {
            break;
        }
        found = Some(trial.onset(acceleration_g));
        load = Vector2::new(sway.sign() * acceleration_g, -1.0);
    }
    Ok(found)
}

/// Strength of a row with yielding ties.
#[derive(Clone, Debug, PartialEq)]
pub struct TiedLimit {
    /// Push of the first motion under these tie forces, and its mechanism.
    pub onset: RowOnset,
    /// Tie forces at this push, in N.
    pub forces_n: Vec<f64>,
}

/// Computes the largest horizontal ground acceleration that a row with ties carries to a side, for any tie forces between zero and yield, and the
/// smallest tie forces at this push. The result does not depend on the forces at rest. `None` if the row carries any push.
///
/// Every mechanism bounds push and tie forces by a plane. All planes found so far form a small linear program for the next push and tie forces to
/// test. The iteration ends once these move nothing (Kelley, "The cutting-plane method for solving convex programs", J. SIAM 8, 1960).
///
/// # Errors
/// If the row is not stable with the forces at rest, or the velocities of a trial are not found.
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
    let largest_forces = ties.map(|tie| (tie.yield_force_n / weight_n).min(LARGEST_TIE_FORCE));
    let undeformed = RowState::undeformed(row);
    let mut trial = Trial::new(row, &undeformed);
    let work_at_rest = work(row, &undeformed.placement, &at_rest.velocities);
    let mut push_program = LargestPushProgram::new(largest_forces.collect());
    let at_rest = Plane::new(row, work_at_rest, &at_rest.lengthening, sway);
    push_program.planes.push(at_rest);
    let (mut push_g, mut forces) = (f64::INFINITY, Vec::new());
    for _ in 0..MOST_TRIALS {
        let Some((highest_g, next)) = push_program.solve() else {
            break;
        };
        if (highest_g, &next) == (push_g, &forces) {
            break;
        }
        (push_g, forces) = (highest_g, next);
        let ties_kg = forces.iter().map(|force| force * row.mass_kg());
        trial.ties_kg = ties_kg.collect();
        let mut lower_g = push_g;
        let known = push_program.planes.len();
        // Reduce the push at the same tie forces, down to the one that is carried.
        while trial.motion_of_masses(pushed(lower_g), true)?.is_some() {
            let plane = Plane::new(row, trial.work(), &trial.lengthening(), sway);
            let bound_g = plane.bound_g(&forces);
            push_program.planes.push(plane);
            let falls = |bound_g: &f64| *bound_g >= 0.0 && *bound_g < lower_g * (1.0 - 1e-14);
            let Some(bound_g) = bound_g.filter(falls) else {
                break;
            };
            lower_g = bound_g;
        }
        if push_program.planes.len() == known {
            break;
        }
    }
    // A push at the artificial limits of the linear program is unlimited.
    let mut strongest = row.ties.iter().zip(&forces);
    let unbounded = push_g >= 0.99 * LARGEST_PUSH
        || strongest.any(|(tie, force)| {
            tie.yield_force_n > force * weight_n && *force >= 0.99 * LARGEST_TIE_FORCE
        });
    if unbounded {
        return Ok(None);
    }
    // A slightly larger push shows the mechanism.
    trial.motion_of_masses(pushed(push_g * (1.0 + PUSH_INCREASE)), true)?;
    let ties = row.ties.iter().zip(&forces);
    let forces_n = ties.map(|(tie, force)| (force * weight_n).min(tie.yield_force_n));
    let (onset, forces_n) = (trial.onset(push_g), forces_n.collect());
    Ok(Some(TiedLimit { onset, forces_n }))
}

/// Relative increase of the push at the limit that shows its mechanism.
const PUSH_INCREASE: f64 = 1e-6;
/// Artificial limit of tie forces, in multiples of the weight.
const LARGEST_TIE_FORCE: f64 = 1e3;
/// Artificial limit of the push, in multiples of gravity.
const LARGEST_PUSH: f64 = 1e6;
/// Small cost of tie forces in the objective, which selects the smallest forces among equivalent ones.
const FORCE_COST: f64 = 1e-9;
/// Maximum number of simplex steps.
const MOST_EXCHANGES: usize = 10_000;
/// Number of simplex steps between recomputations of the inverse of the basis.
const EXACT_EXCHANGES: usize = 100;
/// Tolerance for violated constraints, relative to the sum of their terms.
const ROUNDING: f64 = 1e-14;
/// Maximum number of tested tie forces.
const MOST_TRIALS: usize = 200;

/// Linear bound of push and tie forces, as from a mechanism: `slopes` times (push, forces) is at most `bound`, in units of the weight.
struct Plane {
    slopes: DVector<f64>,
    bound: f64,
}

impl Plane {
    /// Bound of a mechanism. `work` is the integral of its velocities over the masses.
    fn new(row: &Row, work: Vector2<f64>, lengthening: &[f64], sway: Sway) -> Self {
        let work = work / row.mass_kg();
        let (push, weight) = (sway.sign() * work.x, work.y);
        let all = lengthening.iter().copied().chain([push, weight]);
        let largest = all.map(f64::abs).fold(0.0, f64::max);
        let tied = lengthening.iter().map(|rate| -rate);
        let slopes = [push].into_iter().chain(tied);
        Self {
            slopes: DVector::from_iterator(1 + lengthening.len(), slopes) / largest,
            bound: weight / largest,
        }
    }

    /// Largest push for given tie forces; `None` if the plane does not bound the push.
    fn bound_g(&self, forces: &[f64]) -> Option<f64> {
        let (push, pulls) = (self.slopes[0], self.slopes.iter().skip(1));
        let held: f64 = pulls.zip(forces).map(|(pull, force)| -pull * force).sum();
        (push > 0.0).then(|| (self.bound + held) / push)
    }
}

/// Linear program for the largest push below all planes, with the tie forces.
///
/// It is solved by the dual simplex method, from the corner of the artificial limits. Each step replaces one active constraint by the one that is
/// violated most. After a new plane is added, the last corner is the start of the next search.
struct LargestPushProgram {
    /// Largest tie forces.
    largest_forces: Vec<f64>,
    /// Constraints.
    planes: Vec<Plane>,
    /// Indices of the active constraints.
    basis: Vec<usize>,
    /// Inverse of the matrix with the slopes of the active constraints as rows.
    inverse: DMatrix<f64>,
    objective: DVector<f64>,
}

impl LargestPushProgram {
    fn new(largest_forces: Vec<f64>) -> Self {
        let width = 1 + largest_forces.len();
        let axis = |index: usize, slope: f64, bound: f64| {
            let mut slopes = DVector::zeros(width);
            slopes[index] = slope;
            Plane { slopes, bound }
        };
        let mut planes = vec![axis(0, 1.0, LARGEST_PUSH)];
        planes.extend(
            (1..)
                .zip(&largest_forces)
                .map(|(tie, bound)| axis(tie, 1.0, *bound)),
        );
        planes.extend((0..width).map(|index| axis(index, -1.0, 0.0)));
        // Among equivalent forces, prefer the smallest.
        let mut objective = DVector::repeat(width, -FORCE_COST);
        objective[0] = 1.0;
        // The first corner has the largest push and zero tie forces; its matrix is its own inverse.
        let mut inverse = -DMatrix::identity(width, width);
        inverse[(0, 0)] = 1.0;
        Self {
            largest_forces,
            basis: [0].into_iter().chain(width + 1..2 * width).collect(),
            planes,
            inverse,
            objective,
        }
    }

    /// Push and the tie forces; `None` if there are none.
    fn solve(&mut self) -> Option<(f64, Vec<f64>)> {
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
                let ties = self.largest_forces.iter().enumerate();
                let forces = ties.map(|(tie, bound)| at[1 + tie].clamp(0.0, *bound));
                return Some((at[0], forces.collect()));
            };
            self.exchange(entering)?;
        }
        None
    }

    /// Intersection of the active constraints.
    fn corner(&self) -> DVector<f64> {
        let basis = || self.basis.iter().map(|index| &self.planes[*index]);
        let width = self.basis.len();
        let bounds = DVector::from_iterator(width, basis().map(|plane| plane.bound));
        let at = &self.inverse * bounds;
        // One step of iterative refinement, because updates of the inverse lose digits.
        let left = basis().map(|plane| plane.bound - plane.slopes.dot(&at));
        let left = DVector::from_iterator(width, left);
        at + &self.inverse * left
    }

    /// Index of the constraint with the largest violation at a point; `None` if all are satisfied.
    fn most_violated(&self, at: &DVector<f64>) -> Option<usize> {
        let mut worst = (0.0, None);
        for (index, plane) in self.planes.iter().enumerate() {
            let (mut sum, mut size) = (-plane.bound, plane.bound.abs());
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

    /// Adds a constraint to the active ones in place of another; `None` if none can leave.
    fn exchange(&mut self, entering: usize) -> Option<()> {
        let multipliers = self.inverse.tr_mul(&self.objective);
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
    let each =
        blocks.map(|((block, centre_m), twist)| twist.velocity_at(*centre_m) * block.mass_kg);
    each.sum()
}

/// Row under trial loads.
struct Trial<'a> {
    row: &'a Row,
    placement: &'a Placement,
    program: ContactProgram,
    load: Load,
    lines: Vec<TieLine>,
    /// Tie forces divided by gravity, in kg.
    ties_kg: Vec<f64>,
}

impl<'a> Trial<'a> {
    fn new(row: &'a Row, stance: &'a RowState) -> Self {
        let placement = &stance.placement;
        let mut program = ContactProgram::new(row);
        program.set_positions(placement);
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

    /// Mechanism of the last trial, with a given push.
    fn onset(&self, acceleration_g: f64) -> RowOnset {
        RowOnset {
            acceleration_g,
            openings: self.openings(),
            velocities: self.program.velocities.to_vec(),
            lengthening: self.lengthening(),
        }
    }

    /// Integral of the velocities over the masses under a load per unit mass; `None` if the row does not move.
    fn motion_of_masses(
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

    fn openings(&self) -> Vec<OpeningJoint> {
        let rates = || self.program.open_joints();
        let fastest = rates().flat_map(|(_, rates)| rates).fold(0.0, f64::max);
        let opens = rates().filter(|(_, rates)| rates.iter().any(|rate| *rate > 1e-9 * fastest));
        let openings = opens.map(|(joint, rates)| OpeningJoint {
            joint,
            hinge: Edge::only(self.program.active[joint]),
            rates,
        });
        openings.collect()
    }
}
