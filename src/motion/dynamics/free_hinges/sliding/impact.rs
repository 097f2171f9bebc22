//! Impacts of a row with sliding joints. An impact is complete one step after its corners land.

use nalgebra::Vector2;

use super::{APART_RATIO, SlidingStepper};
use crate::dynamics::Stepper as _;
use crate::mechanics::coulomb::{JointMode, TangentialMode};
use crate::mechanics::{Edge, Hinge};

/// Impact that began in the last step. Its energy is complete after the next step.
pub(super) struct Landing {
    /// Corners that landed, joint by joint.
    pub(super) corners: Vec<[bool; 2]>,
    /// Modes of the joints before the impact.
    pub(super) modes_before: Vec<JointMode>,
    pub(super) shut: Vec<Hinge>,
    /// Kinetic energy before the impact, in J.
    pub(super) energy_before_j: f64,
    pub(super) dissipation: Dissipation,
}

/// Energy dissipated by the impulses at joints, in J.
#[derive(Clone, Copy, Default)]
pub(super) struct Dissipation {
    pub(super) total_j: f64,
    /// Part dissipated by friction.
    pub(super) friction_j: f64,
}

impl Dissipation {
    pub(super) fn add(&mut self, other: Self) {
        self.total_j += other.total_j;
        self.friction_j += other.friction_j;
    }
}

impl SlidingStepper<'_> {
    /// Impact that begins in the solved step, without its energy; `None` if no corner lands.
    pub(super) fn find_landing(&self, step: f64) -> Option<Landing> {
        let (before, after) = (&self.modes_before, &self.program.modes);
        let lands = |joint: usize| {
            let gaps = &self.contacts[joint].coordinates_m;
            let rates = &self.rates_before[joint];
            let least = APART_RATIO * self.faces[joint].thickness_m;
            [0, 1].map(|end| {
                // A corner that reaches its face exactly at the end of the last step lands in this step.
                let was_apart = gaps[end] > least || -rates[end] * step > least;
                after[joint].pressed[end] && !before[joint].pressed[end] && was_apart
            })
        };
        let joints = 0..self.faces.len();
        if joints.clone().all(|joint| lands(joint) == [false; 2]) {
            return None;
        }
        let corners: Vec<_> = joints.map(lands).collect();
        let mut shut = Vec::new();
        for (joint, landed) in corners.iter().enumerate() {
            let (before, after) = (before[joint].pressed, after[joint].pressed);
            // A parted joint that lands on one corner does not close.
            if *landed != [false; 2] && (after == [true; 2] || before != [false; 2]) {
                let edge = Edge::only(before.map(|pressed| !pressed));
                shut.push(Hinge::Joint { joint, edge });
            }
        }
        Some(Landing {
            corners,
            modes_before: before.clone(),
            shut,
            energy_before_j: 0.0,
            dissipation: Dissipation::default(),
        })
    }

    /// Joints that open in an impact: they close in the impact or were closed before, and are open afterwards.
    fn find_opening_joints(
        shut: &[Hinge],
        before: &[JointMode],
        after: &[JointMode],
    ) -> Vec<Hinge> {
        let mut opened = Vec::new();
        for (joint, (before, after)) in before.iter().zip(after).enumerate() {
            let shuts = shut
                .iter()
                .any(|hinge| matches!(hinge, Hinge::Joint { joint: shuts, .. } if *shuts == joint));
            if (shuts || before.pressed == [true; 2]) && after.pressed != [true; 2] {
                let edge = Edge::only(after.pressed);
                opened.push(Hinge::Joint { joint, edge });
            }
        }
        opened
    }

    /// Energy dissipated in the solved step: first at the corners that landed in the step before, then by all other impulses. `mean_m_s`
    /// is the mean velocity of the right support.
    ///
    /// The work of an impulse is its product with the mean of the rates before and after. The sum over the steps of an impact does not depend on the
    /// distribution of the impulse over these steps.
    pub(super) fn dissipation(&self, mean_m_s: Vector2<f64>) -> [Dissipation; 2] {
        let landed_before = self.landing.as_ref().map(|landing| &landing.corners);
        let mut parts = [Dissipation::default(); 2];
        for (joint, impulse) in self.program.impulses.iter().enumerate() {
            let mean = (self.rates_before[joint] + self.program.joint_rate(joint)) * 0.5
                + self.right_support_rates(joint, mean_m_s);
            let by_row = impulse.component_mul(&mean);
            let late = landed_before.map_or([false; 2], |corners| corners[joint]);
            for end in 0..2 {
                parts[usize::from(!late[end])].total_j -= by_row[end];
            }
            let part = &mut parts[usize::from(late == [false; 2])];
            part.total_j -= by_row.z;
            let slips = |modes: &[JointMode]| modes[joint].tangential != TangentialMode::Stick;
            if slips(&self.modes_before) || slips(&self.program.modes) {
                // Below the tolerance of the rates the sign is a rounding error.
                part.friction_j += (-by_row.z).max(0.0);
            }
        }
        parts
    }

    /// Energy dissipated by friction in the solved step, with the rates at its end.
    pub(super) fn step_friction_j(&self) -> f64 {
        let mut step_friction_j = 0.0;
        for (joint, impulse) in self.program.impulses.iter().enumerate() {
            if let TangentialMode::Slip(_) = self.program.modes[joint].tangential {
                let rate = self.program.joint_rate(joint).z + self.position_errors[joint].z;
                // Below the tolerance of the rates the sign is a rounding error.
                step_friction_j += (-impulse.z * rate).max(0.0);
            }
        }
        step_friction_j
    }

    /// Completes and reports the impact of the last step, if there was one. `late` is the energy dissipated since then. The blocks still have the
    /// positions of that step, and the rates after the current one. `alone` is true if no corner lands in the current step.
    pub(super) fn end_landing(&mut self, late: Dissipation, alone: bool) {
        let Some(mut landing) = self.landing.take() else {
            return;
        };
        self.observer.subtract_late_dissipation(late.total_j);
        landing.dissipation.add(late);
        let (total_j, friction_j) = (landing.dissipation.total_j, landing.dissipation.friction_j);
        self.observer.row_summary.energy_taken_j += total_j - friction_j;
        if !self.observer.reports_events() {
            return;
        }
        let after = if alone {
            &self.program.modes
        } else {
            &self.modes_before
        };
        self.observer.opened =
            Self::find_opening_joints(&landing.shut, &landing.modes_before, after);
        self.observer.shut = landing.shut;
        let sticks = |mode: &JointMode| mode.tangential == TangentialMode::Stick;
        let moves = !(self.has_initial_contacts() && self.program.modes.iter().all(sticks));
        let stood = self
            .rotations_and_rates()
            .all(|(rotation_rad, _)| rotation_rad == 0.0);
        let energies_j = [landing.energy_before_j, total_j];
        self.report_impact([moves, stood], energies_j, Some(friction_j));
    }
}
