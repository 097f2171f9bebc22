//! Time integration of a hybrid system.
//!
//! A hybrid system moves smoothly in one of several **modes** until a **guard** fires; a **reset** then changes the mode. The engine uses no other
//! property of the system. It restarts at the corners of the forcing, checks the guards in every step, and ends a step at the time of an event.

use std::ops::ControlFlow;

use thiserror::Error;

use super::integrator::{IntegrationTask, IntegratorError, IntegratorStep, State, integrate};
use crate::dynamics::Cost;

/// State of a system at one time.
#[derive(Clone, Copy, Debug)]
pub struct SystemState<M, const N: usize> {
    /// Time, in seconds.
    pub time_s: f64,
    /// Index of the piece of the forcing.
    pub piece: usize,
    /// Discrete state.
    pub mode: M,
    /// Continuous state.
    pub state: State<N>,
}

impl<M: Copy, const N: usize> SystemState<M, N> {
    /// State at time zero, at the start of a motion.
    pub const fn start(mode: M, state: State<N>) -> Self {
        let (time_s, piece) = (0.0, 0);
        Self {
            time_s,
            piece,
            mode,
            state,
        }
    }

    /// Another time and state in the same mode and on the same piece.
    pub const fn at(&self, time_s: f64, state: &State<N>) -> Self {
        Self {
            time_s,
            state: *state,
            ..*self
        }
    }
}

/// A system that moves smoothly in modes and jumps between them.
///
/// The forcing is cut into consecutive pieces, starting at time zero, within which it is smooth.
pub trait HybridSystem<const N: usize> {
    /// Discrete state.
    type Mode: Copy;
    /// Name of an event.
    type Guard: Copy + 'static;

    /// End of a piece of the forcing, in seconds; infinite for the last.
    fn piece_end_s(&self, piece: usize) -> f64;

    /// Whether no guard of this mode can fire from this piece on.
    fn is_over(&self, mode: Self::Mode, piece: usize) -> bool;

    /// Whether the state is constant in this mode.
    fn is_still(&self, mode: Self::Mode) -> bool;

    /// Rate of change of the state, per second. Times are in the piece, its ends included.
    fn slope(&self, now: &SystemState<Self::Mode, N>) -> State<N>;

    /// State within a step by interpolation. Near the end of the step it is as accurate as the end; elsewhere it serves to find
    /// events.
    fn interpolate(&self, step: &IntegratorStep<N>, time_s: f64) -> State<N>;

    /// Scales of the state's components in the future motion, to which tolerances refer.
    fn scale(&self, now: &SystemState<Self::Mode, N>) -> State<N>;

    /// Suitable first step in seconds, and the longest one for which the search for guards is reliable.
    fn step_sizes_s(&self, now: &SystemState<Self::Mode, N>, relative_tolerance: f64)
    -> (f64, f64);

    /// Guards of a mode.
    fn guards(&self, mode: Self::Mode) -> &'static [Self::Guard];

    /// Value of a guard, which fires when it falls below zero, and its rate of change, per second.
    fn guard_value(&self, guard: Self::Guard, now: &SystemState<Self::Mode, N>) -> (f64, f64);

    /// Guard that has already fired at the start of a piece or mode, if any.
    fn fired_at_once(&self, now: &SystemState<Self::Mode, N>) -> Option<Self::Guard>;

    /// Mode and state after the event of a guard.
    fn reset(&self, guard: Self::Guard, now: &SystemState<Self::Mode, N>)
    -> (Self::Mode, State<N>);
}

/// Event of a guard, with the modes and states before and after.
#[derive(Clone, Copy, Debug)]
pub struct Transition<M, G, const N: usize> {
    /// Time of the event, in seconds.
    pub time_s: f64,
    /// Guard that fired.
    pub guard: G,
    /// Mode before the event.
    pub from: M,
    /// Mode after the event.
    pub to: M,
    /// State before the event.
    pub before: State<N>,
    /// State after the event.
    pub after: State<N>,
}

/// Observer of a simulation. Steps and transitions arrive in order of time; breaking ends the simulation.
pub trait Observer<S: HybridSystem<N>, const N: usize> {
    /// Receives a part of the motion without an event, in the mode and on the piece of its start.
    fn step(&mut self, _from: &SystemState<S::Mode, N>, _: &IntegratorStep<N>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// Receives an event.
    fn transition(&mut self, _: &Transition<S::Mode, S::Guard, N>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// Settings of a simulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EngineSettings {
    /// End of the simulation, in seconds.
    pub end_s: f64,
    /// Error tolerance of a step, relative to the state's components or to their scales.
    pub relative_tolerance: f64,
    /// Maximum number of transitions; more are an error.
    pub max_transitions: usize,
}

/// End of a simulation, and its computational effort.
#[derive(Clone, Copy, Debug)]
pub struct Finish<M, const N: usize> {
    /// State at the last transition, at the end of the simulation, or where an observer stopped it.
    pub now: SystemState<M, N>,
    /// True if an observer stopped the simulation.
    pub stopped: bool,
    /// Computational effort.
    pub cost: Cost,
}

/// Reason why a simulation failed.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum EngineError {
    /// The integration failed.
    #[error(transparent)]
    Integrator(#[from] IntegratorError),
    /// More events than allowed: time in seconds, and maximum number.
    #[error(
        "more than {1} transitions by {0:?} s: the motion chatters; raise rest_energy_ratio to bring \
         it to rest earlier, or shorten duration_s"
    )]
    TooManyTransitions(f64, usize),
}

/// Runs `system` from time zero as [`resume`].
///
/// # Errors
/// Those of [`resume`].
pub fn simulate<S: HybridSystem<N>, const N: usize>(
    system: &S,
    mode: S::Mode,
    state: State<N>,
    settings: &EngineSettings,
    observer: &mut impl Observer<S, N>,
) -> Result<Finish<S::Mode, N>, EngineError> {
    resume(system, SystemState::start(mode, state), settings, observer)
}

/// Runs `system` from a state until it is over, until the end in the settings, or until `observer` breaks.
///
/// # Errors
/// When the integration breaks down or the number of transitions passes its bound.
pub fn resume<S: HybridSystem<N>, const N: usize>(
    system: &S,
    now: SystemState<S::Mode, N>,
    settings: &EngineSettings,
    observer: &mut impl Observer<S, N>,
) -> Result<Finish<S::Mode, N>, EngineError> {
    let mut finish = Finish {
        now,
        stopped: false,
        cost: Cost::default(),
    };
    let mut transitions = 0;
    while !finish.stopped {
        let now = &mut finish.now;
        while now.time_s >= system.piece_end_s(now.piece) {
            now.piece += 1;
        }
        if now.time_s >= settings.end_s || system.is_over(now.mode, now.piece) {
            break;
        }
        let fired = match system.fired_at_once(now) {
            Some(guard) => Some(guard),
            None => advance(system, &mut finish, settings, observer)?,
        };
        let Some(guard) = fired.filter(|_| !finish.stopped) else {
            continue;
        };
        let now = &mut finish.now;
        transitions += 1;
        if transitions > settings.max_transitions {
            let most = settings.max_transitions;
            return Err(EngineError::TooManyTransitions(now.time_s, most));
        }
        let (to, after) = system.reset(guard, now);
        let transition = Transition {
            time_s: now.time_s,
            guard,
            from: now.mode,
            to,
            before: now.state,
            after,
        };
        (now.mode, now.state) = (to, after);
        finish.stopped = observer.transition(&transition).is_break();
    }
    Ok(finish)
}

/// Advances to the next event and returns it; `None` at the end of the piece, or if the observer stops the simulation.
fn advance<S: HybridSystem<N>, const N: usize>(
    system: &S,
    finish: &mut Finish<S::Mode, N>,
    settings: &EngineSettings,
    observer: &mut impl Observer<S, N>,
) -> Result<Option<S::Guard>, EngineError> {
    let from = finish.now;
    let end_s = system.piece_end_s(from.piece).min(settings.end_s);
    if system.is_still(from.mode) {
        let mut step = IntegratorStep {
            start_s: from.time_s,
            end_s,
            start: from.state,
            end: from.state,
            start_slope: State::zeros(),
            end_slope: State::zeros(),
        };
        let event = first_event(system, &from, &step);
        step.end_s = event.map_or(end_s, |(_, time_s)| time_s);
        finish.now.time_s = step.end_s;
        finish.stopped = observer.step(&from, &step).is_break();
        return Ok(event.map(|(guard, _)| guard));
    }
    let slope = |time_s: f64, state: &State<N>| system.slope(&from.at(time_s, state));
    let task = task(system, &from, end_s, settings.relative_tolerance);
    finish.cost.evaluations += 1;
    let mut event = None;
    let mut stopped_s = None;
    let watch = |step: &IntegratorStep<N>| match first_event(system, &from, step) {
        Some((guard, time_s)) => {
            event = Some((guard, time_s, *step));
            ControlFlow::Break(())
        }
        None => {
            let flow = observer.step(&from, step);
            if flow.is_break() {
                stopped_s = Some(step.end_s);
            }
            flow
        }
    };
    let last = integrate(&task, slope, watch, &mut finish.cost)?;
    let Some((guard, time_s, step)) = event else {
        finish.now = from.at(stopped_s.unwrap_or(end_s), &last);
        finish.stopped = stopped_s.is_some();
        return Ok(None);
    };
    let cost = &mut finish.cost;
    let landed = land(system, &from, &task, guard, time_s, &step, cost)?;
    finish.now = from.at(landed.end_s, &landed.end);
    finish.stopped = observer.step(&from, &landed).is_break();
    Ok(Some(guard))
}

/// Integration task from a moment in its mode and on its piece, up to a time.
pub(super) fn task<S: HybridSystem<N>, const N: usize>(
    system: &S,
    from: &SystemState<S::Mode, N>,
    end_s: f64,
    relative_tolerance: f64,
) -> IntegrationTask<N> {
    let (first_step_s, longest_step_s) = system.step_sizes_s(from, relative_tolerance);
    IntegrationTask {
        start_s: from.time_s,
        end_s,
        start: from.state,
        start_slope: system.slope(from),
        scale: system.scale(from),
        relative_tolerance,
        first_step_s,
        longest_step_s,
    }
}

/// Step shortened to the time at which the guard fires.
///
/// Near the end of the step, interpolation is as accurate as the end. Elsewhere the interpolated time is approximate: the integration up to it gives
/// the state as accurately as any other step, and a last step along the tangent brings the guard to zero. This step is so short (`d`, about 1e-10 of
/// the step) that its curvature, of order `d^2`, is below rounding error.
fn land<S: HybridSystem<N>, const N: usize>(
    system: &S,
    from: &SystemState<S::Mode, N>,
    task: &IntegrationTask<N>,
    guard: S::Guard,
    time_s: f64,
    step: &IntegratorStep<N>,
    cost: &mut Cost,
) -> Result<IntegratorStep<N>, EngineError> {
    let span_s = time_s - step.start_s;
    let mut landed = IntegratorStep {
        end_s: time_s,
        end: system.interpolate(step, time_s),
        ..*step
    };
    let slope = |time_s: f64, state: &State<N>| system.slope(&from.at(time_s, state));
    let near_end = step.end_s - time_s < INTERPOLATED * span_s;
    // The solver needs a step that changes the floating-point time.
    if near_end || span_s <= 4.0 * f64::EPSILON * time_s {
        landed.end_slope = slope(time_s, &landed.end);
        cost.evaluations += 1;
        return Ok(landed);
    }
    let again = IntegrationTask {
        start_s: step.start_s,
        end_s: time_s,
        start: step.start,
        start_slope: step.start_slope,
        first_step_s: span_s,
        longest_step_s: span_s,
        ..*task
    };
    let watch = |last: &IntegratorStep<N>| {
        (landed.end, landed.end_slope) = (last.end, last.end_slope);
        ControlFlow::Continue(())
    };
    integrate(&again, slope, watch, cost)?;
    let (value, rate) = system.guard_value(guard, &from.at(time_s, &landed.end));
    let rest_s = -value / rate;
    if rest_s.abs() < CLOSED_BY_TANGENT * span_s {
        landed.end_s += rest_s;
        landed.end += landed.end_slope * rest_s;
    }
    Ok(landed)
}

/// Largest fraction of a step that may be cut off by interpolation alone. Its error is of the second order
/// in this fraction (of the third in what matters to guards) on top of the fourth in the step.
const INTERPOLATED: f64 = 2e-4;

/// Largest fraction of a step that may be closed along the tangent on landing.
const CLOSED_BY_TANGENT: f64 = 1e-4;

/// Time, with the value of a guard and its rate of change.
type Point = (f64, (f64, f64));

/// First guard to fire within a step, and its time.
fn first_event<S: HybridSystem<N>, const N: usize>(
    system: &S,
    from: &SystemState<S::Mode, N>,
    step: &IntegratorStep<N>,
) -> Option<(S::Guard, f64)> {
    let mut first: Option<(S::Guard, f64)> = None;
    for guard in system.guards(from.mode) {
        let point = |time_s: f64, state: &State<N>| -> Point {
            let at = system.guard_value(*guard, &from.at(time_s, state));
            (time_s, at)
        };
        let start = point(step.start_s, &step.start);
        let end = point(step.end_s, &step.end);
        let inside = |time_s: f64| point(time_s, &system.interpolate(step, time_s));
        if let Some(time_s) = first_crossing(start, end, HALVINGS, &inside)
            && first.is_none_or(|(_, earliest)| time_s < earliest)
        {
            first = Some((*guard, time_s));
        }
    }
    first
}

/// Number of halvings of a step in search of an event: shorter excursions of a guard, a millionth of a step,
/// are missed.
const HALVINGS: u32 = 20;

/// First time after `start`, up to `end`, at which a guard falls below zero.
///
/// Between two points the guard is approximated by the cubic polynomial with their values and rates. The polynomial lies within the range of its
/// Bernstein coefficients, and is monotone if they are. In most cases they show that the guard does not fire, or only falls. Otherwise the interval
/// is halved. A guard that is negative at the start must rise above zero before it can fire.
fn first_crossing(
    start: Point,
    end: Point,
    halvings: u32,
    at: &impl Fn(f64) -> Point,
) -> Option<f64> {
    let ((start_s, (from, from_rate)), (end_s, (to, to_rate))) = (start, end);
    let third_s = (end_s - start_s) / 3.0;
    let bernstein = [from, from + third_s * from_rate, to - third_s * to_rate, to];
    let never_negative = bernstein.iter().all(|value| *value >= 0.0);
    if never_negative || bernstein.is_sorted() {
        return None;
    }
    let falls = bernstein.is_sorted_by(|earlier, later| earlier >= later);
    if falls || halvings == 0 {
        let crosses = from >= 0.0 && to < 0.0;
        return crosses.then(|| falling_root(start_s, end_s, |time_s| at(time_s).1));
    }
    let middle = at(0.5 * (start_s + end_s));
    first_crossing(start, middle, halvings - 1, at)
        .or_else(|| first_crossing(middle, end, halvings - 1, at))
}

/// Zero of a falling guard that is negative at the end and not at the start: Newton's method from the end, safeguarded by bisection.
pub(crate) fn falling_root(start_s: f64, end_s: f64, guard: impl Fn(f64) -> (f64, f64)) -> f64 {
    let (mut positive_s, mut negative_s) = (start_s, end_s);
    let mut guess_s = end_s;
    for _ in 0..200 {
        let (value, rate) = guard(guess_s);
        if value < 0.0 {
            negative_s = guess_s;
        } else {
            positive_s = guess_s;
        }
        let newton_s = guess_s - value / rate;
        let next_s = if newton_s >= positive_s && newton_s <= negative_s {
            newton_s
        } else {
            0.5 * (positive_s + negative_s)
        };
        if (next_s - guess_s).abs() <= f64::EPSILON * end_s {
            return next_s;
        }
        guess_s = next_s;
    }
    guess_s
}

#[cfg(test)]
mod tests {
    use super::*;

    fn crossing(end_s: f64, guard: impl Fn(f64) -> (f64, f64)) -> Option<f64> {
        let at = |time_s: f64| (time_s, guard(time_s));
        first_crossing(at(0.0), at(end_s), HALVINGS, &at)
    }

    fn is_at(found: Option<f64>, expected: f64) -> bool {
        found.is_some_and(|time_s| (time_s - expected).abs() < 1e-15)
    }

    #[test]
    fn a_guard_that_starts_at_zero_and_rises_fires_when_it_returns_to_zero() {
        let hop = |t: f64| (t * (1.0 - t), 1.0 - 2.0 * t);
        assert!(is_at(crossing(1.1, hop), 1.0));
        assert!(is_at(crossing(100.0, hop), 1.0));
        assert!(crossing(0.9, hop).is_none());
    }

    #[test]
    fn a_dip_below_zero_between_two_positive_ends_fires() {
        let dip = |floor: f64| move |t: f64| ((t - 0.3).powi(2) + floor, 2.0 * (t - 0.3));
        assert!(is_at(crossing(1.0, dip(-0.01)), 0.2));
        assert!(crossing(1.0, dip(-1e-10)).is_some());
        assert!(crossing(1.0, dip(0.0)).is_none());
        assert!(crossing(1.0, dip(1e-10)).is_none());
    }

    #[test]
    fn a_guard_that_starts_negative_fires_only_after_it_has_risen() {
        assert!(crossing(1.0, |t| (-1.0 - t, -1.0)).is_none());
        assert!(crossing(1.0, |t| (t - 0.5, 1.0)).is_none());
        let wave = |t: f64| (-(4.0 * t).cos(), 4.0 * (4.0 * t).sin());
        assert!(is_at(crossing(2.0, wave), 0.375 * std::f64::consts::PI));
    }

    #[test]
    fn the_first_of_several_crossings_fires() {
        let wave = |t: f64| ((5.0 * t).cos(), -5.0 * (5.0 * t).sin());
        assert!(is_at(crossing(1.0, wave), 0.1 * std::f64::consts::PI));
    }
}
