//! A motion of a row to compute.

use nalgebra::Vector2;

use super::clock::Settings;
use crate::dynamics::ground::GroundMotion;
use crate::mechanics::blocks::{Joint, Row, Supports};
use crate::mechanics::geometry::ring::Edge;

/// A motion to compute.
#[derive(Clone, Copy)]
pub struct Task<'a> {
    pub row: &'a Row,
    pub ground: &'a GroundMotion,
    pub gravity_m_s2: f64,
    pub settings: Settings,
    /// Energy that the first mechanism has to gain to overturn, where that is known.
    pub barrier_j: Option<f64>,
    /// Energy barrier of the row as built, with rigid joints and without ties, in J; estimated where it is not known.
    pub built_barrier_j: f64,
    /// Energy beside which errors of the balance are small or not, if the motion has less.
    pub energy_scale_j: f64,
}

impl<'a> Task<'a> {
    /// A task whose energies follow from the blocks alone.
    pub fn new(
        row: &'a Row,
        ground: &'a GroundMotion,
        gravity_m_s2: f64,
        settings: Settings,
    ) -> Self {
        Self {
            row,
            ground,
            gravity_m_s2,
            settings,
            barrier_j: None,
            built_barrier_j: estimated_barrier_j(row, gravity_m_s2),
            energy_scale_j: 0.0,
        }
    }
}

/// The energy barrier of an arch, if none is known, as a fraction of its weight times its size.
const BARRIER_RATIO: f64 = 1e-3;

/// An estimate of the energy that a row has to gain to overturn, in J, without its ties: of a stack, that by which the part above one of
/// its joints overturns as one block, where that is least.
fn estimated_barrier_j(row: &Row, gravity_m_s2: f64) -> f64 {
    if row.supports == Supports::Both {
        return BARRIER_RATIO * row.mass_kg() * gravity_m_s2 * row.size_m;
    }
    let above = |(index, joint): (usize, &Joint)| {
        let blocks = &row.blocks[index..];
        let mass_kg: f64 = blocks.iter().map(|block| block.mass_kg).sum();
        let moments = blocks.iter().map(|block| block.centre_m * block.mass_kg);
        let centre_m = moments.sum::<Vector2<f64>>() / mass_kg;
        mass_kg * gravity_m_s2 * rise_to_overturn_m(centre_m, joint)
    };
    let joints = row.joints.iter().enumerate();
    joints.map(above).fold(f64::INFINITY, f64::min)
}

/// Rise of a centre of gravity, in m, until it is above the nearer edge of the joint about which its block turns.
pub(super) fn rise_to_overturn_m(centre_m: Vector2<f64>, joint: &Joint) -> f64 {
    let rise = |edge: Edge| {
        let arm_m = centre_m - joint.corner_m(edge);
        arm_m.norm() - arm_m.y
    };
    rise(Edge::Intrados).min(rise(Edge::Extrados))
}
