//! One motion of a row with rigid joints.

use super::landing::LandingStepper;
use super::sliding::SlidingStepper;
use crate::dynamics::ground::GroundMotion;
use crate::dynamics::history::Summary;
use crate::dynamics::recorder::Recorder;
use crate::dynamics::row::clock::Settings;
use crate::dynamics::row::error::RowMotionError;
use crate::dynamics::row::stepper;
use crate::dynamics::row::task::Task;
use crate::mechanics::blocks::Row;
use crate::mechanics::stance::Stance;

/// The most steps that a motion may have: a month of computing. Much shorter ones are lost in the rounding of the time.
const MOST_STEPS: f64 = 1e12;

/// Computes the motion of a row on moving ground, from rest or released from given rotations of its blocks
/// (radians; hinges only).
///
/// # Errors
/// When the initial rotations do not fit, or a step fails.
pub fn simulate(
    row: &Row,
    ground: &GroundMotion,
    gravity_m_s2: f64,
    settings: &Settings,
    initial_rad: Option<&[f64]>,
    recorder: Option<&mut dyn Recorder>,
) -> Result<Summary, RowMotionError> {
    let task = Task::new(row, ground, gravity_m_s2, *settings);
    motion(task, &Stance::undeformed(row), initial_rad, recorder)
}

/// Computes a motion of a row from any stance.
pub fn motion(
    task: Task<'_>,
    standing: &Stance,
    initial_rad: Option<&[f64]>,
    recorder: Option<&mut dyn Recorder>,
) -> Result<Summary, RowMotionError> {
    let remedy = "give a longer `longest_step_s` in [free_hinges]";
    task.settings.within(MOST_STEPS, remedy)?;
    // A recorder of any lifetime serves for as long as the task.
    let recorder = recorder.map(|recorder| recorder as _);
    let released = |recorder| LandingStepper::new(task, standing, initial_rad, recorder);
    let Some(coefficient) = task.settings.friction_coefficient else {
        return stepper::run(released(recorder)?);
    };
    let placement = released(None)?.placement;
    let stepper = SlidingStepper::new(standing, &placement, task, coefficient, recorder);
    stepper::run(stepper)
}
