//! Input of the motion of a row.

use nalgebra::Vector2;

use crate::dynamics::{GroundMotion, Settings};
use crate::mechanics::{Edge, Joint, Row, Supports};

/// Input of the motion of a row.
#[derive(Clone, Copy)]
pub struct MotionInput<'a> {
    pub row: &'a Row,
    pub ground: &'a GroundMotion,
    pub gravity_m_s2: f64,
    pub settings: Settings,
    /// Energy in J that the first mechanism needs to overturn; `None` if unknown.
    pub barrier_j: Option<f64>,
    /// Energy barrier of the undeformed row with rigid joints and without ties, in J; an estimate if unknown.
    pub undeformed_barrier_j: f64,
    /// Scale of errors of the energy balance, in J, if the motion has less energy.
    pub energy_scale_j: f64,
}

impl<'a> MotionInput<'a> {
    /// Input with energy scales from the blocks alone.
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
            undeformed_barrier_j: estimated_barrier_j(row, gravity_m_s2),
            energy_scale_j: 0.0,
        }
    }
}

/// Estimated energy barrier of an arch, over weight times size.
const BARRIER_RATIO: f64 = 1e-3;

/// Estimate of the energy barrier of a row without ties, in J. For a stack: the least energy to overturn the part above one of its joints
/// as one block.
fn estimated_barrier_j(row: &Row, gravity_m_s2: f64) -> f64 {
    if row.supports == Supports::Both {
        return BARRIER_RATIO * row.mass_kg() * gravity_m_s2 * row.size_m;
    }
    let above = |(index, joint): (usize, &Joint)| {
        let blocks = &row.blocks[index..];
        let mass_kg: f64 = blocks.iter().map(|block| block.mass_kg).sum();
        let moments = blocks.iter().map(|block| block.centre_m * block.mass_kg);
        let centre_m = moments.sum::<Vector2<f64>>() / mass_kg;
        mass_kg * gravity_m_s2 * rise_to_overturn_m(centre_m, joint, Edge::ALL)
    };
    let joints = row.joints.iter().enumerate();
    joints.map(above).fold(f64::INFINITY, f64::min)
}

/// Rise of a centre of gravity, in m, to the position above the nearest of these edges of the joint about which its block turns.
pub(super) fn rise_to_overturn_m(centre_m: Vector2<f64>, joint: &Joint, edges: &[Edge]) -> f64 {
    let rises = edges.iter().map(|edge| {
        let arm_m = centre_m - joint.corner_m(*edge);
        arm_m.norm() - arm_m.y
    });
    rises.fold(f64::INFINITY, f64::min)
}
