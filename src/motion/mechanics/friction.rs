//! Limit analysis of a row with sliding joints by Coulomb's law.
//!
//! A joint carries compression at its two corners, `N_I, N_E >= 0`, and a shear force `|T| <= mu (N_I + N_E)`. The largest push in equilibrium with
//! such forces is the solution of a linear program. Its multipliers are the mechanism: which joints open, about which edge, and which slip. They obey
//! the associated flow rule: a joint that slips also opens, by `mu` times the slip. Stone joints do not dilate, so the push is an upper bound of the
//! capacity. It is exact if no joint of the mechanism slips.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, SolverStatus};
use nalgebra::Vector2;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::cone_program;
use crate::bisection::{Width, try_bisect};
use crate::mechanics::{Edge, Row, RowState, Sway, Weight};

/// Rate, over the largest one, that counts as zero.
const LEAST_RATE: f64 = 1e-4;
/// Tolerance of the least coefficient of friction.
const COEFFICIENT_TOLERANCE: f64 = 1e-7;
/// Coefficient of friction that is assumed to prevent all slip.
const LARGEST_COEFFICIENT: f64 = 100.0;
/// Part of a push, or of gravity if the push is smaller, by which a computed push may be too small.
const PUSH_TOLERANCE: f64 = 1e-7;
/// Excess of friction over its bound, over the weight, that counts as zero.
const FRICTION_EXCESS_TOLERANCE: f64 = 1e-8;
/// Normal force, over the largest one, from which on a joint has a thrust point.
const LEAST_NORMAL: f64 = 1e-6;

/// Joint that opens or slips in a mechanism.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct YieldingJoint {
    /// The joint, from 0 at the left springing or the base.
    pub joint: usize,
    /// True if the joint opens at the intrados by more than dilatancy due to slipping.
    pub opens_intrados: bool,
    /// True if the joint opens at the extrados by more than dilatancy due to slipping.
    pub opens_extrados: bool,
    /// The edge towards which the right block slips; `None` if the joint does not slip.
    pub slips_towards: Option<Edge>,
}

/// Push of the first motion of a row with sliding joints.
#[derive(Clone, Debug, PartialEq)]
pub struct FrictionOnset {
    /// Ground acceleration, without its sign, in multiples of gravity: upper bound by the associated flow rule.
    pub acceleration_g: f64,
    /// Joints that open or slip, from left to right.
    pub yields: Vec<YieldingJoint>,
}

impl FrictionOnset {
    /// Whether a joint of the mechanism slips.
    pub fn sliding_governs(&self) -> bool {
        self.yields
            .iter()
            .any(|joint| joint.slips_towards.is_some())
    }
}

/// Collapse of a row under live loads.
#[derive(Clone, Debug, PartialEq)]
pub struct LiveCollapse {
    /// Factor on the live loads: with friction an upper bound by the associated flow rule.
    pub multiplier: f64,
    /// Joints that open or slip, from left to right.
    pub yields: Vec<YieldingJoint>,
    /// Thrust line at collapse: its point in each joint, in metres; `None` without compression.
    pub thrust_m: Vec<Option<Vector2<f64>>>,
}

/// Reason why there is no such push.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum FrictionError {
    /// No joint forces are in equilibrium with the weight for this coefficient.
    #[error(
        "with a coefficient of friction of {0:?} the row cannot carry its own weight; give a larger friction_coefficient"
    )]
    CannotStand(f64),
    /// The row falls with any coefficient.
    #[error("the row cannot carry its own weight, whatever the friction")]
    NeverStands,
    /// The linear program was not solved.
    #[error(
        "the limit analysis with friction was not solved ({0}): give another friction_coefficient"
    )]
    NotSolved(SolverStatus),
}

/// Computes the largest horizontal push to a side that an undeformed row carries, and its mechanism; `None` if the row carries any push.
///
/// # Errors
/// If the row is not stable with this coefficient, or the linear program is not solved.
pub fn onset(
    row: &Row,
    coefficient: f64,
    sway: Sway,
) -> Result<Option<FrictionOnset>, FrictionError> {
    onset_at(row, &RowState::undeformed(row), coefficient, sway)
}

/// Computes the largest horizontal push that a row in a given state carries, with the tie forces of this state.
///
/// # Errors
/// Those of [`onset`].
pub fn onset_at(
    row: &Row,
    stance: &RowState,
    coefficient: f64,
    sway: Sway,
) -> Result<Option<FrictionOnset>, FrictionError> {
    if !stands_at(row, stance, coefficient)? {
        return Err(FrictionError::CannotStand(coefficient));
    }
    onset_of_standing(row, stance, coefficient, sway)
}

/// Computes the largest push of a row that is known to be stable in a given state with this coefficient. Open joints are in contact only at their
/// closed corner.
pub(crate) fn onset_of_standing(
    row: &Row,
    stance: &RowState,
    coefficient: f64,
    sway: Sway,
) -> Result<Option<FrictionOnset>, FrictionError> {
    let program = FrictionProgram::new(row, stance, coefficient, Objective::Push);
    let found = program.solve(-sway.sign(), FrictionError::CannotStand(coefficient))?;
    Ok(found.map(|found| FrictionOnset {
        acceleration_g: sway.sign() * found.objective,
        yields: found.yields,
    }))
}

/// Computes the largest factor on live loads that an undeformed row carries beside its own weight and its tie forces at rest, with a coefficient of
/// friction, or without slip (`None`). Live loads act down and have no inertia. `None` if the row carries any factor.
///
/// # Errors
/// If the row is not stable without the live loads, or the linear program is not solved.
pub fn live_collapse(
    row: &Row,
    coefficient: Option<f64>,
    live: &[Weight],
) -> Result<Option<LiveCollapse>, FrictionError> {
    let coefficient = coefficient.unwrap_or(LARGEST_COEFFICIENT);
    let stance = RowState::undeformed(row);
    // The program is well scaled for live loads as heavy as the row.
    let live_kg: f64 = live.iter().map(|weight| weight.mass_kg).sum();
    let scale = row.mass_kg() / live_kg;
    let scaled = live.iter().map(|weight| Weight {
        mass_kg: weight.mass_kg * scale,
        ..*weight
    });
    let scaled: Vec<Weight> = scaled.collect();
    let program = FrictionProgram::new(row, &stance, coefficient, Objective::Live(&scaled));
    let found = program.solve(-1.0, FrictionError::CannotStand(coefficient))?;
    Ok(found.map(|found| {
        let normal = |corners: &[f64; 2]| corners[0] + corners[1];
        let largest = found.corners.iter().map(normal).fold(0.0, f64::max);
        let joints = row.joints.iter().zip(&found.corners);
        let thrust_m = joints.map(|(joint, corners)| {
            let part = corners[1].max(0.0) / normal(corners);
            let across_m = joint.extrados_m - joint.intrados_m;
            (normal(corners) > LEAST_NORMAL * largest)
                .then(|| joint.intrados_m + across_m * part.min(1.0))
        });
        LiveCollapse {
            multiplier: found.objective * scale,
            yields: found.yields,
            thrust_m: thrust_m.collect(),
        }
    }))
}

/// Whether an undeformed row carries its own weight with this coefficient.
///
/// # Errors
/// If the row falls with any coefficient, or the linear program is not solved.
pub fn stands(row: &Row, coefficient: f64) -> Result<bool, FrictionError> {
    stands_at(row, &RowState::undeformed(row), coefficient)
}

/// Whether a row in a given state carries its own weight. Open joints are in contact only at their closed corner.
///
/// # Errors
/// Those of [`stands`].
pub(crate) fn stands_at(
    row: &Row,
    stance: &RowState,
    coefficient: f64,
) -> Result<bool, FrictionError> {
    let program = FrictionProgram::new(row, stance, coefficient, Objective::FrictionExcess);
    let found = program.solve(1.0, FrictionError::NeverStands)?;
    Ok(found.is_none_or(|found| found.objective <= FRICTION_EXCESS_TOLERANCE))
}

/// Least coefficient of friction for which a row carries its own weight, with a tolerance of 1e-7.
///
/// # Errors
/// If the row falls with any coefficient, or a linear program is not solved.
pub fn least_coefficient(row: &Row) -> Result<f64, FrictionError> {
    if !stands(row, LARGEST_COEFFICIENT)? {
        return Err(FrictionError::NeverStands);
    }
    let width = Width::Absolute(COEFFICIENT_TOLERANCE);
    let (_, least) = try_bisect(0.0, LARGEST_COEFFICIENT, width, |coefficient| {
        stands(row, coefficient)
    })?;
    Ok(least)
}

/// Least coefficient of friction with which an undeformed row carries its weight and a push, in multiples of gravity, with a tolerance
/// of 1e-7; `None` if none is found. With the push that starts the row without slip, this is the coefficient with which no joint slips before. It
/// is the largest ratio of shear to normal force over all joints; if the joint forces are not unique, the least of these ratios.
///
/// # Errors
/// If the row falls with any coefficient, or a linear program is not solved.
pub fn demand(row: &Row, push_g: f64, sway: Sway) -> Result<Option<f64>, FrictionError> {
    demand_at(row, &RowState::undeformed(row), push_g, sway)
}

/// Least coefficient of friction with which a row in a given state carries its weight and a push; see [`demand`].
///
/// # Errors
/// Those of [`demand`].
pub fn demand_at(
    row: &Row,
    stance: &RowState,
    push_g: f64,
    sway: Sway,
) -> Result<Option<f64>, FrictionError> {
    let carries = |coefficient: f64| match onset_at(row, stance, coefficient, sway) {
        Ok(onset) => {
            let least_g = push_g - PUSH_TOLERANCE * push_g.abs().max(1.0);
            Ok(onset.is_none_or(|onset| onset.acceleration_g >= least_g))
        }
        Err(FrictionError::CannotStand(_)) => Ok(false),
        Err(error) => Err(error),
    };
    // A stone structure rarely needs a coefficient above one.
    for largest in [1.0, LARGEST_COEFFICIENT] {
        if carries(largest)? {
            let width = Width::Absolute(COEFFICIENT_TOLERANCE);
            let (_, least) = try_bisect(0.0, largest, width, carries)?;
            return Ok(Some(least));
        }
    }
    Ok(None)
}

/// Objective of a linear program.
#[derive(Clone, Copy, PartialEq)]
enum Objective<'a> {
    /// Largest push, in multiples of gravity.
    Push,
    /// Largest factor on live loads.
    Live(&'a [Weight]),
    /// Least excess of friction over its bound, common to all joints, for which the row is stable; in units of the weight.
    FrictionExcess,
}

/// Solution of a linear program.
struct Found {
    objective: f64,
    yields: Vec<YieldingJoint>,
    /// Normal forces at intrados and extrados of each joint, over the weight.
    corners: Vec<[f64; 2]>,
}

/// Linear program. Unknowns: the objective, then `N_I`, `N_E` and `T` of every joint in units of the weight. Rows: equilibrium of every block, zero
/// forces at open corners, then four conditions per joint.
struct FrictionProgram {
    matrix: CscMatrix,
    right: Vec<f64>,
    /// Number of rows that are equations.
    equations: usize,
    joints: usize,
}

/// Loads of the blocks, three numbers each: weights minus tie forces. The joint forces balance them.
fn loads(row: &Row, stance: &RowState) -> Vec<f64> {
    let (size_m, mass_kg, centres_m) = (row.size_m, row.mass_kg(), &stance.placement.centres_m);
    let weights = row.blocks.iter().map(|block| block.mass_kg / mass_kg);
    let mut loads: Vec<f64> = weights.flat_map(|weight| [0.0, weight, 0.0]).collect();
    for (line, force_n) in stance.lines(row).zip(stance.forces_n()) {
        let pull = line.direction * (force_n / (row.gravity_m_s2 * mass_kg));
        for (end, pull) in [pull, -pull].into_iter().enumerate() {
            if let Some(number) = line.ends[end] {
                let moment = (line.ends_m[end] - centres_m[number]).perp(&pull) / size_m;
                for (axis, value) in [pull.x, pull.y, moment].into_iter().enumerate() {
                    loads[3 * number + axis] -= value;
                }
            }
        }
    }
    loads
}

impl FrictionProgram {
    fn new(row: &Row, stance: &RowState, coefficient: f64, objective: Objective<'_>) -> Self {
        let placement = &stance.placement;
        let (blocks, joints) = (row.blocks.len(), row.joints.len());
        let centres_m = &placement.centres_m;
        let equations = 3 * blocks + placement.open_corners();
        let size_m = row.size_m;
        let mut entries = Vec::new();
        let mut put = |row, column, value: f64| entries.push((row, column, value));
        let mut right = loads(row, stance);
        match objective {
            Objective::Push => {
                for (index, block) in row.blocks.iter().enumerate() {
                    put(3 * index, 0, block.mass_kg / row.mass_kg());
                }
            }
            Objective::Live(live) => {
                for (index, centre_m) in centres_m.iter().enumerate() {
                    let own = live.iter().filter(|weight| weight.block == index);
                    let down = |weight: &Weight| -weight.mass_kg / row.mass_kg();
                    let turns = |weight: &Weight| down(weight) * (weight.x_m - centre_m.x);
                    put(3 * index + 1, 0, own.clone().map(down).sum());
                    put(3 * index + 2, 0, own.map(turns).sum::<f64>() / size_m);
                }
            }
            Objective::FrictionExcess => {}
        }
        for (index, gaps) in placement.gaps_m.iter().enumerate() {
            for edge in (0..2).filter(|edge| gaps[*edge] > 0.0) {
                put(right.len(), 1 + 3 * index + edge, 1.0);
                right.push(0.0);
            }
        }
        for (index, frame) in placement.frames.iter().enumerate() {
            let open = placement.gaps_m[index].map(|gap| gap > 0.0);
            let forces = [
                (frame.corner_m(Edge::Intrados), frame.normal),
                (frame.corner_m(Edge::Extrados), frame.normal),
                (frame.intrados_m, frame.tangent),
            ];
            for (block, side) in [(index.checked_sub(1), -1.0), (Some(index), 1.0)] {
                let Some((number, centre_m)) =
                    block.and_then(|number| Some((number, centres_m.get(number)?)))
                else {
                    continue;
                };
                for (kind, (point_m, force)) in forces.iter().enumerate() {
                    let moment = (point_m - centre_m).perp(force) / size_m;
                    for (axis, value) in [force.x, force.y, moment].into_iter().enumerate() {
                        put(3 * number + axis, 1 + 3 * index + kind, side * value);
                    }
                }
            }
            let [intrados, extrados, tangent] = [0, 1, 2].map(|kind| 1 + 3 * index + kind);
            let first = equations + 4 * index;
            for (edge, corner) in [intrados, extrados].into_iter().enumerate() {
                // A variable that is fixed to zero needs no other bound.
                if open[edge] {
                    right.push(1.0);
                } else {
                    put(first + edge, corner, -1.0);
                    right.push(0.0);
                }
            }
            for (slip, sign) in [(2, 1.0), (3, -1.0)] {
                put(first + slip, intrados, -coefficient);
                put(first + slip, extrados, -coefficient);
                put(first + slip, tangent, sign);
                if objective == Objective::FrictionExcess {
                    put(first + slip, 0, -1.0);
                }
            }
            right.extend([0.0; 2]);
        }
        let (height, width) = (equations + 4 * joints, 1 + 3 * joints);
        Self {
            matrix: cone_program::matrix(height, width, entries),
            right,
            equations,
            joints,
        }
    }

    /// Minimises `factor` times the objective; `None` if the objective is unbounded.
    ///
    /// # Errors
    /// `unbalanced` if no forces are in equilibrium with the row.
    fn solve(
        &self,
        factor: f64,
        unbalanced: FrictionError,
    ) -> Result<Option<Found>, FrictionError> {
        let width = 1 + 3 * self.joints;
        let mut objective = vec![0.0; width];
        objective[0] = factor;
        let settings = DefaultSettings::default();
        let matrices = [&CscMatrix::zeros((width, width)), &self.matrix];
        let solution =
            cone_program::solve(matrices, &objective, &self.right, self.equations, settings);
        match solution.status {
            SolverStatus::Solved | SolverStatus::AlmostSolved => {}
            SolverStatus::PrimalInfeasible | SolverStatus::AlmostPrimalInfeasible => {
                return Err(unbalanced);
            }
            SolverStatus::DualInfeasible | SolverStatus::AlmostDualInfeasible => return Ok(None),
            status => return Err(FrictionError::NotSolved(status)),
        }
        let rates = &solution.z[self.equations..];
        let largest = rates.iter().copied().fold(0.0, f64::max);
        let moves = |rate: f64| rate > LEAST_RATE * largest;
        let yields = rates
            .chunks(4)
            .enumerate()
            .map(|(joint, rates)| YieldingJoint {
                joint,
                opens_intrados: moves(rates[0]),
                opens_extrados: moves(rates[1]),
                // Friction at its bound acts against the slip.
                slips_towards: Edge::only([moves(rates[2]), moves(rates[3])]),
            });
        let yields = yields
            .filter(|it| it.opens_intrados || it.opens_extrados || it.slips_towards.is_some());
        let forces = solution.x[1..].chunks(3);
        Ok(Some(Found {
            objective: solution.x[0],
            yields: yields.collect(),
            corners: forces.map(|forces| [forces[0], forces[1]]).collect(),
        }))
    }
}
