//! Simulation of one motion of a row with rigid joints.

use super::landing::LandingStepper;
use super::sliding::SlidingStepper;
use crate::dynamics::recorder::Recorder;
use crate::dynamics::row::stepper;
use crate::dynamics::{RowMotionError, Summary, Task};
use crate::mechanics::Stance;

/// Maximum number of steps of a motion, about a month of computing. Many more steps would be shorter than the rounding error of time.
const MOST_STEPS: f64 = 1e12;

/// Computes the motion of a row from any state in equilibrium.
pub fn motion(
    task: Task<'_>,
    standing: &Stance,
    initial_rad: Option<&[f64]>,
    recorder: Option<&mut dyn Recorder>,
) -> Result<Summary, RowMotionError> {
    let remedy = "give a longer `longest_step_s` in [free_hinges]";
    task.settings.within(MOST_STEPS, remedy)?;
    // The cast shortens the lifetime of the recorder to that of the task.
    let recorder = recorder.map(|recorder| recorder as _);
    let released = |recorder| LandingStepper::new(task, standing, initial_rad, recorder);
    let Some(coefficient) = task.settings.friction_coefficient else {
        return stepper::run(released(recorder)?);
    };
    let placement = released(None)?.placement;
    let stepper = SlidingStepper::new(standing, &placement, task, coefficient, recorder);
    stepper::run(stepper)
}
