//! Motion of a row of rigid blocks whose joints open and shut anywhere, at any time.
//!
//! The state is the gaps of the joints ([`crate::mechanics::joints`]) and the velocities of the pieces that move
//! as one; `engine` steps them.

mod course;
mod engine;
mod model;
mod sliding;
pub mod spread;

use std::ops::ControlFlow;
use std::time::Duration;

use thiserror::Error;

pub use model::{DOUBTFUL_ENERGY_ERROR, FreeHinges, FreeHingesError, RowOptions};

use self::engine::Engine;
use super::ground::GroundMotion;
use crate::mechanics::blocks::Row;
use crate::mechanics::chain::Hinge;
use crate::mechanics::contact::ContactError;
use crate::mechanics::geometry::pose::Pose;
use crate::mechanics::joints::{Frame, Placement};
use crate::mechanics::sway::Sway;

/// The shortest step over the longest one, where it is not given.
const SHORTEST_STEP_RATIO: f64 = 1.0 / 30.0;
/// Impacts within the shortest step after which the next landings are merged: without end they would stop time.
const CROWDED_IMPACTS: usize = 50;
/// A row whose joints do not slip has overturned when it is lower than at rest by this part of weight times size.
const FALLEN_ENERGY_RATIO: f64 = 1e-3;

/// How a motion is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Longest step in seconds.
    pub longest_step_s: f64,
    /// Where landings crowd within this time, in seconds, they are taken as one.
    pub shortest_step_s: f64,
    /// Number of impacts within the shortest step after which landings crowd.
    pub merged_after: usize,
    /// When to stop at the latest, in seconds.
    pub end_s: f64,
    /// Time between samples in seconds; without it there are none. Steps end there whether or not samples are asked for.
    pub output_step_s: Option<f64>,
    /// Coulomb's coefficient of friction at every joint; without it joints do not slip.
    pub friction_coefficient: Option<f64>,
}

impl Settings {
    /// Steps that end at landings: on a size of 10 m at most about 0.35 ms. With other sizes they follow the square root of size
    /// over gravity. The shortest step is a thirtieth of that.
    #[must_use]
    pub fn to_landings(row: &Row, gravity_m_s2: f64, end_s: f64) -> Self {
        let longest_step_s = 3.4e-4 * (row.size_m() / gravity_m_s2).sqrt();
        Self {
            longest_step_s,
            shortest_step_s: SHORTEST_STEP_RATIO * longest_step_s,
            merged_after: CROWDED_IMPACTS,
            end_s,
            output_step_s: None,
            friction_coefficient: None,
        }
    }

    /// Equal steps, for joints that slip: 0.1 ms on a size of 10 m.
    #[must_use]
    pub fn equal(row: &Row, gravity_m_s2: f64, end_s: f64) -> Self {
        let step_s = 1e-4 * (row.size_m() / gravity_m_s2).sqrt();
        Self {
            longest_step_s: step_s,
            shortest_step_s: step_s,
            ..Self::to_landings(row, gravity_m_s2, end_s)
        }
    }

    /// The same with all steps multiplied.
    #[must_use]
    pub fn times(&self, factor: f64) -> Self {
        Self {
            longest_step_s: self.longest_step_s * factor,
            shortest_step_s: self.shortest_step_s * factor,
            ..*self
        }
    }
}

/// Why a motion could not be computed.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum FreeHingeError {
    /// A setting is out of range.
    #[error("{name} is {value}: {allowed}")]
    Setting {
        /// Which one, with its unit.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it may be.
        allowed: &'static str,
    },
    /// The initial rotations are not one finite number per block.
    #[error("initial rotations: {given} finite numbers for {blocks} blocks")]
    Rotations {
        /// How many were given that are finite.
        given: usize,
        /// How many blocks there are.
        blocks: usize,
    },
    /// The initial rotations do not close an arch.
    #[error(
        "with the initial rotations the ends of the arch miss each other by {error_m:.3e} m: give rotations of the blocks \
         with which it stays closed; a smaller `rotation_rad` in [initial] may do"
    )]
    Open {
        /// By how much.
        error_m: f64,
    },
    /// The velocities of a step were not found.
    #[error("at {time_s} s {reason}, or give another `longest_step_s` in [free_hinges]")]
    Contact {
        /// When, in seconds.
        time_s: f64,
        /// Why.
        reason: ContactError,
    },
    /// Friction was not found.
    #[error(
        "at {time_s} s the bound of friction at a joint is wrong by {error:.1e} of the largest one: give another \
         longest_step_s in [free_hinges], or a friction_coefficient farther from the least one with which the row stands"
    )]
    Friction {
        /// When, in seconds.
        time_s: f64,
        /// By how much.
        error: f64,
    },
    /// Energy was created or lost.
    #[error(
        "the energy balance is wrong by {:.2} % of the largest energy of the motion, which says nothing then: give a \
         longest_step_s in [free_hinges] of at most {:.1e} s, and look again at amplitudes and coefficients that no masonry \
         meets",
        1e2 * .error, 0.2 * .longest_step_s
    )]
    Energy {
        /// By how much of the larger of the barrier and the largest kinetic energy.
        error: f64,
        /// The longest step, in seconds.
        longest_step_s: f64,
    },
    /// The ends of an arch parted in the computation.
    #[error(
        "at {time_s} s the ends of the arch miss each other by {error_m:.3e} m: give a shorter `longest_step_s` in \
         [free_hinges]"
    )]
    Closure {
        /// When, in seconds.
        time_s: f64,
        /// By how much.
        error_m: f64,
    },
}

/// The state at an output time.
#[derive(Clone, Copy, Debug)]
pub struct Sample<'a> {
    /// Time in seconds.
    pub time_s: f64,
    /// Rotations of the blocks in radians.
    pub rotations_rad: &'a [f64],
    /// Their rates in rad/s.
    pub rates_rad_s: &'a [f64],
    /// Gaps of the joints at intrados and extrados in metres; the larger one is an arc.
    pub gaps_m: &'a [[f64; 2]],
    /// Placements of the blocks.
    pub poses: &'a [Pose],
    /// Where the joints are.
    pub frames: &'a [Frame],
    /// Number of joints that are open.
    pub open_joints: usize,
    /// Offset of the right face of every joint towards the extrados, in metres; none where joints do not slip.
    pub offsets_m: &'a [f64],
    /// Number of joints that slip.
    pub slipping_joints: usize,
    /// Largest ratio of tangential to normal force at a joint that is pressed, in the step before.
    pub friction_demand: f64,
    /// Least normal force at a joint in the step before, in newtons.
    pub least_normal_n: f64,
    /// Impulses that press the joints now, at intrados and extrados, all over the same short time.
    pub corner_impulses_n_s: &'a [[f64; 2]],
    /// Kinetic energy in joules.
    pub kinetic_j: f64,
    /// Potential energy above the undeformed row in joules.
    pub potential_j: f64,
    /// To which side the row sways, without what it slid along the ground: the side of its centre of gravity or, where that is at its
    /// undeformed place, the one to which it goes.
    pub sway: Sway,
    /// Whether it has overturned.
    pub overturned: bool,
}

/// Joints open where all were shut.
#[derive(Clone, Copy, Debug)]
pub struct Uplift<'a> {
    /// Time in seconds, to within a step: when they were shut last.
    pub time_s: f64,
    /// Joints that open, with the edge about which they turn; none where they part.
    pub opened: &'a [Hinge],
    /// To which side the centre of gravity goes.
    pub sway: Sway,
    /// Rotations of the blocks in radians; not zero only where joints have slipped.
    pub rotations_rad: &'a [f64],
    /// Their rates in rad/s, as the rotations.
    pub rates_rad_s: &'a [f64],
    /// Kinetic energy, and potential energy above the undeformed row, in joules.
    pub energy_j: f64,
}

/// One or more corners land.
#[derive(Clone, Copy, Debug)]
pub struct Impact<'a> {
    /// Time in seconds.
    pub time_s: f64,
    /// To which side the row sways after the impact: the side of its centre of gravity or, where that is at its undeformed
    /// place, the one to which it goes; `None` at rest.
    pub sway: Option<Sway>,
    /// Joints that shut, also where they open again at once, with the edge that landed; both, where none is named.
    pub shut: &'a [Hinge],
    /// Joints that open at once; those among them that shut go on about their other edge.
    /// The edge is that about which they turn; none where they part.
    pub opened: &'a [Hinge],
    /// Kinetic energy before, in joules.
    pub energy_before_j: f64,
    /// Kinetic energy taken, also by friction, in joules.
    pub energy_taken_j: f64,
    /// The part of it that friction takes in the step of the impact, in joules, where joints slip.
    pub friction_j: Option<f64>,
    /// Rotations of the blocks in radians.
    pub rotations_rad: &'a [f64],
    /// Rotation rates of the blocks after the impact, in rad/s.
    pub rates_after_rad_s: &'a [f64],
    /// Gaps of the joints at intrados and extrados in metres.
    pub gaps_m: &'a [[f64; 2]],
    /// Potential energy above the undeformed row in joules.
    pub potential_j: f64,
    /// Whether the row has overturned.
    pub overturned: bool,
}

/// Who listens to a motion.
pub trait Recorder {
    /// Whether it listens to samples.
    fn wants_samples(&self) -> bool {
        true
    }
    /// At every output time, and at the end. To break ends the motion.
    fn sample(&mut self, _: &Sample) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
    /// Whenever it starts to move from rest. To break ends the motion.
    fn uplift(&mut self, _: &Uplift) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
    /// At every impact. To break ends the motion.
    fn impact(&mut self, _: &Impact) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// Nobody does.
impl Recorder for () {
    fn wants_samples(&self) -> bool {
        false
    }
}

/// How a motion ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// No joint opened.
    NeverMoved,
    /// At rest from this time on, in seconds: ground quiet for good, both energies negligible.
    Rest {
        /// When.
        time_s: f64,
    },
    /// Overturned: lower than at rest, whose potential energy is a minimum. Where joints slip: a joint has no overlap left, a block has
    /// turned by 0.8 rad, or it has moved by 0.6 of the size, besides what the row slid along a support.
    Overturned {
        /// To which side.
        sway: Sway,
        /// When the potential energy was last highest, in seconds; where joints slip, that and what friction took of it: from then on
        /// gravity gave more than friction took.
        time_s: f64,
    },
    /// Still rocking at the end.
    Rocking,
}

/// From one passage of the centre of gravity through its undeformed place to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfCycle {
    /// To which side.
    pub sway: Sway,
    /// When it began, in seconds.
    pub start_s: f64,
    /// How long it took, in seconds; of the last one, until the motion ended.
    pub duration_s: f64,
    /// Largest rotation of a block, in radians.
    pub peak_rad: f64,
    /// Energy at its end over that at its beginning; of the first and the last one unknown.
    pub energy_ratio: Option<f64>,
}

/// What a motion has cost.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cost {
    /// Steps.
    pub steps: usize,
    /// Programs solved.
    pub programs: usize,
    /// Systems of pin forces solved.
    pub iterations: usize,
    /// How often the tolerance of a program had to be relaxed.
    pub relaxed: usize,
    /// Impacts that steps ended at.
    pub impacts: usize,
    /// Steps with more than one landing, or with landings too close to end at.
    pub merged: usize,
    /// Most iterations in one step.
    pub most_iterations: usize,
    /// Time that the longest step took to compute, where samples are made.
    pub longest_step: Elapsed,
}

/// Time that a computation took; `None` where it was not measured. It belongs to no result: any two are equal.
#[derive(Clone, Copy, Debug, Default)]
pub struct Elapsed(pub Option<Duration>);

impl PartialEq for Elapsed {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

/// What slipped in a motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Sliding {
    /// Energy that friction took, in joules.
    pub friction_j: f64,
    /// Offsets at the end: of the right face of every joint towards the extrados, in metres.
    pub offsets_m: Vec<f64>,
    /// Largest magnitudes of the offsets, in metres.
    pub largest_offsets_m: Vec<f64>,
    /// Steps whose bounds of friction did not converge.
    pub unconverged: usize,
    /// The largest error of such a bound, as part of the largest bound.
    pub bound_error: f64,
}

/// A motion as a whole.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// How it ended.
    pub outcome: Outcome,
    /// When, in seconds.
    pub end_s: f64,
    /// The longest step that it might take, in seconds.
    pub longest_step_s: f64,
    /// The time within which landings crowd, in seconds.
    pub shortest_step_s: f64,
    /// Largest rotation of every block, in radians.
    pub peaks_rad: Vec<f64>,
    /// Largest potential energy above the undeformed row, in joules.
    pub peak_potential_j: f64,
    /// Largest kinetic energy at the end of a step, in joules.
    pub largest_kinetic_j: f64,
    /// Half cycles.
    pub half_cycles: Vec<HalfCycle>,
    /// Least normal force at a joint outside impacts, in newtons.
    pub least_normal_n: f64,
    /// Largest ratio of tangential to normal force outside impacts.
    pub friction_demand: f64,
    /// Energy taken by impacts, in joules, without what friction takes.
    pub energy_taken_j: f64,
    /// Largest error of the energy balance at impacts and samples, or, where joints slip, the largest growth of energy less the
    /// work of the ground; over weight times size.
    pub energy_defect_ratio: f64,
    /// Largest error of closure in metres.
    pub closure_error_m: f64,
    /// What slipped; `None` where joints do not slip.
    pub sliding: Option<Sliding>,
    /// What it has cost.
    pub cost: Cost,
}

/// Computes the motion of a row on moving ground, from rest or released from given rotations of its blocks
/// (radians; hinges only).
///
/// # Errors
/// When a setting is out of range, the initial rotations do not fit, or a step fails.
pub fn simulate(
    row: &Row,
    ground: &GroundMotion,
    gravity_m_s2: f64,
    settings: &Settings,
    initial_rad: Option<&[f64]>,
    recorder: &mut impl Recorder,
) -> Result<Run, FreeHingeError> {
    check(gravity_m_s2, settings)?;
    let released = || -> Result<Engine, FreeHingeError> {
        let mut engine = Engine::new(row, ground, gravity_m_s2, settings);
        if let Some(rotations_rad) = initial_rad {
            engine.release(rotations_rad)?;
        }
        Ok(engine)
    };
    let Some(coefficient) = settings.friction_coefficient else {
        return course::run(released()?, ground, settings, recorder);
    };
    let placement = if initial_rad.is_some() {
        released()?.into_placement()
    } else {
        Placement::new(row)
    };
    let engine = sliding::Engine::new(&placement, row, ground, gravity_m_s2, settings, coefficient);
    course::run(engine, ground, settings, recorder)
}

/// Potential energy below which a row whose joints do not slip has overturned, in joules.
fn fallen_energy_j(row: &Row, gravity_m_s2: f64) -> f64 {
    -FALLEN_ENERGY_RATIO * row.mass_kg() * gravity_m_s2 * row.size_m()
}

fn check(gravity_m_s2: f64, settings: &Settings) -> Result<(), FreeHingeError> {
    let output_step_s = settings.output_step_s.unwrap_or(1.0);
    for (name, value) in [
        ("gravity in m/s2", gravity_m_s2),
        ("longest step in s", settings.longest_step_s),
        ("shortest step in s", settings.shortest_step_s),
        ("end in s", settings.end_s),
        ("output step in s", output_step_s),
        (
            "coefficient of friction",
            settings.friction_coefficient.unwrap_or(1.0),
        ),
    ] {
        if !(value > 0.0 && value < f64::INFINITY) {
            let allowed = "it must be positive and finite";
            return Err(FreeHingeError::Setting {
                name,
                value,
                allowed,
            });
        }
    }
    if settings.shortest_step_s > settings.longest_step_s {
        return Err(FreeHingeError::Setting {
            name: "shortest step in s",
            value: settings.shortest_step_s,
            allowed: "it must not exceed the longest step",
        });
    }
    Ok(())
}
