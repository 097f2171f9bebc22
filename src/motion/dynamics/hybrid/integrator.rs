//! Interface to the crate [`ode_solvers`].
//!
//! Only `Dopri5` with sparse output is used. In `ode_solvers` 0.6.2 `Dop853` evaluates its last two stages at the wrong time, `OutputType::Dense` can
//! return an extrapolated last point and passes an inconsistent state and time to `solout`, and continuous output takes the absolute value of the
//! time. Sparse `Dopri5` has none of these errors. The solver's `solout` receives every accepted step and can only stop the integration, so the
//! caller searches inside steps.

use std::cell::Cell;
use std::ops::ControlFlow;

use crate::dynamics::Cost;
use nalgebra::SVector;
use ode_solvers::dop_shared::{IntegrationError, OutputType};
use ode_solvers::{Dopri5, System};
use thiserror::Error;

/// Continuous state of a system: a vector of `N` numbers.
pub type State<const N: usize> = SVector<f64, N>;

/// A smooth stretch of motion between two instants, with the states and their rates at both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntegratorStep<const N: usize> {
    /// Start, in seconds.
    pub start_s: f64,
    /// End, in seconds.
    pub end_s: f64,
    /// State at the start.
    pub start: State<N>,
    /// State at the end.
    pub end: State<N>,
    /// Rate of change of the state at the start, per second.
    pub start_slope: State<N>,
    /// Rate of change of the state at the end, per second.
    pub end_slope: State<N>,
}

/// The task of an integration.
#[derive(Clone, Copy, Debug)]
pub struct IntegrationTask<const N: usize> {
    /// Start, in seconds.
    pub start_s: f64,
    /// End, in seconds.
    pub end_s: f64,
    /// State at the start.
    pub start: State<N>,
    /// Rate of change of the state at the start, per second.
    pub start_slope: State<N>,
    /// Scales of the components: smaller values have an absolute error tolerance.
    pub scale: State<N>,
    /// Error allowed in a step, relative to the larger of a component and its scale.
    pub relative_tolerance: f64,
    /// First step to try, in seconds.
    pub first_step_s: f64,
    /// Longest step, in seconds.
    pub longest_step_s: f64,
}

/// Reason why an integration failed.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum IntegratorError {
    /// The right-hand side gave no finite number at this time, in seconds, however short the step.
    #[error("the motion has no finite acceleration at {0:?} s")]
    NotFinite(f64),
    /// The step fell below the spacing of numbers at this time, in seconds, or too many were needed.
    #[error("the relative tolerance cannot be met at {0:?} s: allow a larger one")]
    ToleranceNotMet(f64),
}

/// Maximum number of steps of one call of the solver. The first hop limits the steps of a call, and may be 1e-5 s or less. A push that grows in
/// this hop may hold the structure up for seconds, so a call may need some 1e5 steps.
const MAX_STEPS: u32 = 1_000_000;

/// Integrates `slope(time_s, state)` for a task, and passes every accepted step to `watch`, which may end the integration. Returns the last state.
///
/// The solver uses the time since the start of the task, so that a motion does not depend on its absolute time. States are in units of their scale,
/// so that one tolerance applies to all components.
///
/// # Errors
/// When the right-hand side is not finite, or the tolerance cannot be met.
pub fn integrate<const N: usize>(
    task: &IntegrationTask<N>,
    slope: impl Fn(f64, &State<N>) -> State<N>,
    watch: impl FnMut(&IntegratorStep<N>) -> ControlFlow<()>,
    cost: &mut Cost,
) -> Result<State<N>, IntegratorError> {
    let span_s = task.end_s - task.start_s;
    let not_finite = Cell::new(false);
    let problem = Problem {
        task,
        per_scale: task.scale.map(f64::recip),
        slope,
        watch,
        last: (task.start_s, task.start, task.start_slope),
        not_finite: &not_finite,
    };
    let tolerance = task.relative_tolerance;
    let (safety, beta, least_factor, largest_factor) = (0.9, 0.04, 0.2, 10.0);
    let never_test_stiffness = u32::MAX;
    let mut solver = Dopri5::from_param(
        problem,
        0.0,
        span_s,
        span_s,
        task.start.component_div(&task.scale),
        tolerance,
        tolerance,
        safety,
        beta,
        least_factor,
        largest_factor,
        task.longest_step_s.min(span_s),
        task.first_step_s.min(task.longest_step_s).min(span_s),
        MAX_STEPS,
        never_test_stiffness,
        OutputType::Sparse,
    );
    match solver.integrate() {
        Ok(stats) => {
            // The first evaluation is the slope at the start, which is given.
            cost.evaluations += u64::from(stats.num_eval) - 1;
            cost.steps += u64::from(stats.accepted_steps);
            let last = solver.y_out().last().expect("the start is always stored");
            Ok(last.component_mul(&task.scale))
        }
        Err(error) => {
            let (IntegrationError::MaxNumStepReached { x, .. }
            | IntegrationError::StepSizeUnderflow { x }
            | IntegrationError::StiffnessDetected { x }) = error;
            let time_s = task.start_s + x;
            Err(if not_finite.get() {
                IntegratorError::NotFinite(time_s)
            } else {
                IntegratorError::ToleranceNotMet(time_s)
            })
        }
    }
}

/// A task in the form that `ode_solvers` needs.
struct Problem<'a, F, W, const N: usize> {
    task: &'a IntegrationTask<N>,
    /// Inverse of the scale, stored because it is used much more often than it changes.
    per_scale: State<N>,
    slope: F,
    watch: W,
    /// Time, state and slope at the end of the last accepted step.
    last: (f64, State<N>, State<N>),
    not_finite: &'a Cell<bool>,
}

impl<F, W, const N: usize> System<f64, State<N>> for Problem<'_, F, W, N>
where
    F: Fn(f64, &State<N>) -> State<N>,
    W: FnMut(&IntegratorStep<N>) -> ControlFlow<()>,
{
    fn system(&self, x: f64, y: &State<N>, dy: &mut State<N>) {
        let slope = if x == 0.0 {
            self.task.start_slope
        } else {
            let state = y.component_mul(&self.task.scale);
            (self.slope)(self.task.start_s + x, &state)
        };
        *dy = slope.component_mul(&self.per_scale);
        // The error estimate of a trial step that goes too far is NaN as well, so the step is rejected and shortened. If this never ends, this flag
        // gives the reason.
        self.not_finite.set(!dy.sum().is_finite());
    }

    fn solout(&mut self, x: f64, y: &State<N>, dy: &State<N>) -> bool {
        let (start_s, start, start_slope) = self.last;
        let step = IntegratorStep {
            start_s,
            end_s: self.task.start_s + x,
            start,
            end: y.component_mul(&self.task.scale),
            start_slope,
            end_slope: dy.component_mul(&self.task.scale),
        };
        self.last = (step.end_s, step.end, step.end_slope);
        (self.watch)(&step).is_break()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // A million steps are slow without the optimisation of this package.
    #[test]
    fn a_slope_that_jumps_forever_cannot_meet_a_tolerance() {
        let noise = |time_s: f64, _: &State<1>| {
            let up = (time_s.to_bits() >> 3).is_multiple_of(2);
            State::<1>::new(if up { 1e9 } else { -1e9 })
        };
        let task = IntegrationTask {
            start_s: 0.0,
            end_s: 1.0,
            start: State::<1>::new(1.0),
            start_slope: State::<1>::new(1e9),
            scale: State::<1>::new(1.0),
            relative_tolerance: 1e-9,
            first_step_s: 0.01,
            longest_step_s: f64::INFINITY,
        };
        let watch = |_: &IntegratorStep<1>| ControlFlow::Continue(());
        let end = integrate(&task, noise, watch, &mut Cost::default());
        assert!(matches!(end, Err(IntegratorError::ToleranceNotMet(_))));
    }
}
