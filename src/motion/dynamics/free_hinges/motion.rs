//! Simulation of one motion of a row with rigid joints.

use super::landing::LandingStepper;
use super::sliding::SlidingStepper;
use crate::dynamics::recorder::Recorder;
use crate::dynamics::row::standing::Release;
use crate::dynamics::row::stepper;
use crate::dynamics::{MotionInput, RowMotionError, Summary};
use crate::mechanics::RowState;

/// Maximum number of steps of a motion, about a month of computing. Many more steps would be shorter than the rounding error of time.
const MOST_STEPS: f64 = 1e12;

/// Computes the motion of a row from any state in equilibrium.
pub fn motion(
    input: MotionInput<'_>,
    standing: &RowState,
    release: Option<&Release>,
    recorder: Option<&mut dyn Recorder>,
) -> Result<Summary, RowMotionError> {
    let remedy = "give a longer `longest_step_s` in [free_hinges]";
    input.settings.within(MOST_STEPS, remedy)?;
    // The cast shortens the lifetime of the recorder to that of the input.
    let recorder = recorder.map(|recorder| recorder as _);
    let released = |recorder| LandingStepper::new(input, standing, release, recorder);
    let Some(coefficient) = input.settings.friction_coefficient else {
        return stepper::step_to_end(released(recorder)?);
    };
    let placement = released(None)?.placement;
    let start = (standing, &placement, release.filter(|one| one.has_rate()));
    let stepper = SlidingStepper::new(start, input, coefficient, recorder);
    stepper::step_to_end(stepper)
}
