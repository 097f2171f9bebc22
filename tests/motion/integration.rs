//! The integrator and the engine on systems other than arches, with exact solutions.

use std::ops::ControlFlow;

use archrock::dynamics::Cost;
use archrock_motion::internals::hybrid::engine::{
    EngineError, EngineSettings, Finish, HybridSystem, Observer, SystemState, Transition, simulate,
};
use archrock_motion::internals::hybrid::integrator;
use archrock_motion::internals::hybrid::integrator::{
    IntegrationTask, IntegratorError, IntegratorStep, State,
};

fn task<const N: usize>(
    start_s: f64,
    end_s: f64,
    start: State<N>,
    tolerance: f64,
) -> IntegrationTask<N> {
    IntegrationTask {
        start_s,
        end_s,
        start,
        start_slope: State::zeros(),
        scale: State::repeat(1.0),
        relative_tolerance: tolerance,
        first_step_s: 0.01,
        longest_step_s: f64::INFINITY,
    }
}

/// Integrates after filling in the slope at the start.
fn integrate<const N: usize>(
    task: &IntegrationTask<N>,
    slope: impl Fn(f64, &State<N>) -> State<N>,
    watch: impl FnMut(&IntegratorStep<N>) -> ControlFlow<()>,
    cost: &mut Cost,
) -> Result<State<N>, IntegratorError> {
    let start_slope = slope(task.start_s, &task.start);
    integrator::integrate(
        &IntegrationTask {
            start_slope,
            ..*task
        },
        slope,
        watch,
        cost,
    )
}

/// `y' = -2 t y^2`, `y(0) = 1`: `y = 1 / (1 + t^2)`. The slope depends on time itself, so a method with
/// wrong nodes fails.
fn bell(time_s: f64, state: &State<1>) -> State<1> {
    State::<1>::new(-2.0 * time_s * state[0] * state[0])
}

#[test]
fn a_slope_that_depends_on_time() {
    for tolerance in [1e-6, 1e-9, 1e-12] {
        let task = task(0.0, 3.0, State::<1>::new(1.0), tolerance);
        let mut steps = Vec::new();
        let watch = |step: &IntegratorStep<1>| {
            steps.push(*step);
            ControlFlow::Continue(())
        };
        let mut cost = Cost::default();
        let end = integrate(&task, bell, watch, &mut cost).unwrap();
        // Local errors of some tens of steps accumulate.
        assert!(
            (end[0] - 0.1).abs() < 30.0 * tolerance,
            "{tolerance}: {end}"
        );
        assert_eq!(steps.len() as u64, cost.steps);
        // Time, state and slope passed to the watcher belong together, and steps follow each other without gaps.
        let (mut time, mut state) = (0.0, State::<1>::new(1.0));
        for step in &steps {
            assert!(step.start_s == time && step.start == state && step.end_s > time);
            assert!((step.end[0] - 1.0 / (1.0 + step.end_s.powi(2))).abs() < 30.0 * tolerance);
            assert!((step.end_slope - bell(step.end_s, &step.end)).norm() < 1e-14);
            assert!((step.start_slope - bell(step.start_s, &step.start)).norm() < 1e-14);
            (time, state) = (step.end_s, step.end);
        }
        // The last point is the requested end, not beyond it.
        assert!((time - 3.0).abs() < 1e-15 && state == end);
    }
}

#[test]
fn the_error_falls_with_the_fifth_power_of_the_step() {
    // Fixed steps: a tolerance that never limits the steps, and a longest step that always does.
    let error = |count: f64| {
        let mut task = task(0.0, 2.0, State::<1>::new(1.0), 1e3);
        task.longest_step_s = 2.0 / count;
        task.first_step_s = task.longest_step_s;
        let mut cost = Cost::default();
        let end = integrate(&task, bell, |_| ControlFlow::Continue(()), &mut cost).unwrap();
        (end[0] - 0.2).abs()
    };
    let (coarse, fine) = (error(32.0), error(64.0));
    let order = (coarse / fine).log2();
    assert!(order > 4.6 && order < 6.0, "{order}: {coarse} {fine}");
}

#[test]
fn the_last_state_is_that_of_the_end_and_not_an_extrapolation() {
    // For a constant slope one long step would be enough, but the end must still be exact.
    for end_s in [0.3, 1.0 / 3.0, 7.123_456_789] {
        let task = task(0.0, end_s, State::<1>::new(0.0), 1e-9);
        let mut last_s = 0.0;
        let watch = |step: &IntegratorStep<1>| {
            last_s = step.end_s;
            ControlFlow::Continue(())
        };
        let slope = |_: f64, _: &State<1>| State::<1>::new(2.0);
        let end = integrate(&task, slope, watch, &mut Cost::default()).unwrap();
        // A few additions of steps: rounding only.
        assert!((end[0] - 2.0 * end_s).abs() < 1e-14);
        assert!((last_s - end_s).abs() <= 2.0 * f64::EPSILON * end_s);
    }
}

#[test]
fn a_late_start_changes_nothing() {
    // The same motion 1000 s later, with a slope in the time since its start: times there are rounded to
    // 1e-13.
    let run = |start_s: f64| {
        let task = task(start_s, start_s + 2.0, State::<1>::new(1.0), 1e-9);
        let slope = |time_s: f64, state: &State<1>| bell(time_s - start_s, state);
        let mut cost = Cost::default();
        let end = integrate(&task, slope, |_| ControlFlow::Continue(()), &mut cost).unwrap();
        (end[0], cost)
    };
    let (now, later) = (run(0.0), run(1000.0));
    assert!((now.0 - later.0).abs() < 1e-12);
    assert_eq!(now.1, later.1);
}

#[test]
fn an_observer_stops_the_integration_at_its_step() {
    let task = task(0.0, 3.0, State::<1>::new(1.0), 1e-9);
    let mut seen = None;
    let watch = |step: &IntegratorStep<1>| {
        seen = Some(*step);
        if step.end_s > 1.0 {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let end = integrate(&task, bell, watch, &mut Cost::default()).unwrap();
    let step = seen.unwrap();
    assert!(step.end == end && step.start_s <= 1.0 && step.end_s < 3.0);
}

#[test]
fn a_slope_that_is_not_a_number_is_reported() {
    let broken = |time_s: f64, state: &State<1>| {
        State::<1>::new(if time_s > 0.5 { f64::NAN } else { state[0] })
    };
    let run = |slope: &dyn Fn(f64, &State<1>) -> State<1>| {
        let task = task(0.0, 1.0, State::<1>::new(1.0), 1e-9);
        integrate(
            &task,
            slope,
            |_| ControlFlow::Continue(()),
            &mut Cost::default(),
        )
    };
    let Err(IntegratorError::NotFinite(time_s)) = run(&broken) else {
        panic!("{:?}", run(&broken))
    };
    assert!((time_s - 0.5).abs() < 1e-6, "{time_s}");
    let always = |_: f64, _: &State<1>| State::<1>::new(f64::NAN);
    assert!(matches!(run(&always), Err(IntegratorError::NotFinite(_))));
}

/// A ball that falls on a floor and rebounds with a fraction of its velocity, until almost none is left.
/// From `wind_s.0` to `wind_s.1` a wind with the acceleration `wind` blows upwards.
struct Ball {
    restitution: f64,
    gravity: f64,
    wind: f64,
    wind_s: (f64, f64),
    stop_rate: f64,
    longest_step_s: f64,
}

const BALL: Ball = Ball {
    restitution: 0.5,
    gravity: 9.81,
    wind: 0.0,
    wind_s: (f64::INFINITY, f64::INFINITY),
    stop_rate: 1e-9,
    longest_step_s: f64::INFINITY,
};

impl HybridSystem<2> for Ball {
    /// Whether it lies on the floor.
    type Mode = bool;
    type Guard = ();

    fn piece_end_s(&self, piece: usize) -> f64 {
        [self.wind_s.0, self.wind_s.1, f64::INFINITY][piece]
    }

    fn is_over(&self, lies: bool, _: usize) -> bool {
        lies
    }

    fn is_still(&self, lies: bool) -> bool {
        lies
    }

    fn slope(&self, now: &SystemState<bool, 2>) -> State<2> {
        let wind = if now.piece == 1 { self.wind } else { 0.0 };
        State::<2>::new(now.state[1], wind - self.gravity)
    }

    fn interpolate(&self, step: &IntegratorStep<2>, time_s: f64) -> State<2> {
        let since = time_s - step.start_s;
        let acceleration = step.start_slope[1];
        State::<2>::new(
            step.start[0] + since * (step.start[1] + 0.5 * acceleration * since),
            step.start[1] + acceleration * since,
        )
    }

    fn scale(&self, _: &SystemState<bool, 2>) -> State<2> {
        State::<2>::repeat(1.0)
    }

    fn step_sizes_s(&self, _: &SystemState<bool, 2>, _: f64) -> (f64, f64) {
        // So long that a whole hop fits into one step.
        (self.longest_step_s.min(10.0), self.longest_step_s)
    }

    fn guards(&self, lies: bool) -> &'static [()] {
        if lies { &[] } else { &[()] }
    }

    fn guard_value(&self, (): (), now: &SystemState<bool, 2>) -> (f64, f64) {
        (now.state[0], now.state[1])
    }

    fn fired_at_once(&self, _: &SystemState<bool, 2>) -> Option<()> {
        None
    }

    fn reset(&self, (): (), now: &SystemState<bool, 2>) -> (bool, State<2>) {
        let rate = -self.restitution * now.state[1];
        if rate < self.stop_rate {
            (true, State::<2>::zeros())
        } else {
            (false, State::<2>::new(0.0, rate))
        }
    }
}

/// Logs everything, and breaks after a given number of bounces.
#[derive(Default)]
struct Log {
    bounces: Vec<(f64, State<2>, State<2>)>,
    steps: Vec<IntegratorStep<2>>,
    most_bounces: Option<usize>,
    most_steps: Option<usize>,
}

fn until(count: usize, most: Option<usize>) -> ControlFlow<()> {
    if most.is_some_and(|most| count >= most) {
        ControlFlow::Break(())
    } else {
        ControlFlow::Continue(())
    }
}

impl Observer<Ball, 2> for Log {
    fn step(&mut self, _: &SystemState<bool, 2>, step: &IntegratorStep<2>) -> ControlFlow<()> {
        self.steps.push(*step);
        until(self.steps.len(), self.most_steps)
    }

    fn transition(&mut self, transition: &Transition<bool, (), 2>) -> ControlFlow<()> {
        self.bounces
            .push((transition.time_s, transition.before, transition.after));
        until(self.bounces.len(), self.most_bounces)
    }
}

fn throw(ball: &Ball, state: State<2>, end_s: f64) -> (Log, Result<f64, EngineError>) {
    let mut log = Log::default();
    let finish = throw_and_log(ball, state, end_s, &mut log);
    (log, finish.map(|finish| finish.now.time_s))
}

fn throw_and_log(
    ball: &Ball,
    state: State<2>,
    end_s: f64,
    log: &mut Log,
) -> Result<Finish<bool, 2>, EngineError> {
    let settings = EngineSettings {
        end_s,
        relative_tolerance: 1e-10,
        max_transitions: 200,
    };
    simulate(ball, false, state, &settings, log)
}

#[test]
fn an_observer_that_breaks_ends_the_simulation_there() {
    let ball = Ball {
        longest_step_s: 0.05,
        ..BALL
    };
    let height = State::<2>::new(1.3, 0.0);
    let (whole, _) = throw(&ball, height, 100.0);
    for most_bounces in [1, 5] {
        let mut log = Log {
            most_bounces: Some(most_bounces),
            ..Log::default()
        };
        let finish = throw_and_log(&ball, height, 100.0, &mut log).unwrap();
        let (time_s, _, after) = whole.bounces[most_bounces - 1];
        assert!(finish.stopped && log.bounces.len() == most_bounces);
        assert_eq!((finish.now.time_s, finish.now.state), (time_s, after));
    }
    for most_steps in [1, 7, 40] {
        let mut log = Log {
            most_steps: Some(most_steps),
            ..Log::default()
        };
        let finish = throw_and_log(&ball, height, 100.0, &mut log).unwrap();
        let last = &whole.steps[most_steps - 1];
        assert!(finish.stopped && log.steps.len() == most_steps);
        assert_eq!(
            (finish.now.time_s, finish.now.state),
            (last.end_s, last.end)
        );
    }
}

#[test]
fn a_ball_bounces_when_it_should_and_comes_to_rest() {
    for longest_step_s in [f64::INFINITY, 0.05] {
        let ball = Ball {
            longest_step_s,
            ..BALL
        };
        let height = 1.3;
        let (log, finish) = throw(&ball, State::<2>::new(height, 0.0), 100.0);
        // Bounce n is at t_1 (1 + 2 (e + e^2 + ... + e^n)): infinitely many by 3 t_1.
        let first = (2.0 * height / ball.gravity).sqrt();
        assert!(log.bounces.len() > 25);
        let mut expected = first;
        for (n, (time_s, before, after)) in log.bounces.iter().enumerate() {
            let n = i32::try_from(n).unwrap();
            assert!(
                (time_s - expected).abs() < 1e-10,
                "{n}: {}",
                time_s - expected
            );
            // The state is that of the instant: on the floor, at the speed of the fall.
            let speed = ball.gravity * first * ball.restitution.powi(n);
            assert!(before[0].abs() < 1e-12);
            assert!((before[1] + speed).abs() < 1e-9 * (1e-3 + speed), "{n}");
            assert!(after[1] == 0.0 || (after[1] - 0.5 * speed).abs() < 1e-9 * (1e-3 + speed));
            expected += 2.0 * first * ball.restitution.powi(n + 1);
        }
        assert!((finish.unwrap() - 3.0 * first).abs() < 1e-8);
        // No time between the steps is lost or counted twice.
        assert!(log.steps[0].start_s == 0.0);
        assert!(
            log.steps
                .windows(2)
                .all(|pair| pair[0].end_s == pair[1].start_s)
        );
    }
}

#[test]
fn a_whole_hop_inside_one_step_is_not_missed() {
    // Thrown up from the floor: the level is zero at the start, and the first step is ten seconds long.
    let ball = Ball {
        restitution: 0.0,
        ..BALL
    };
    for speed in [1e-6, 1e-2, 3.0, 40.0] {
        let (log, finish) = throw(&ball, State::<2>::new(0.0, speed), 20.0);
        let exact = 2.0 * speed / ball.gravity;
        assert_eq!(log.bounces.len(), 1);
        assert!(
            (finish.unwrap() - exact).abs() < 1e-10 * (exact + 1e-3),
            "{speed}"
        );
    }
}

#[test]
fn a_dip_below_the_floor_inside_a_step_is_not_missed() {
    // With gravity upwards the ball dives and comes back by itself; both ends of the step are above the floor.
    let ball = Ball {
        gravity: -1.0,
        restitution: 0.0,
        stop_rate: 1e-9,
        ..BALL
    };
    for depth in [1e-9, 1e-3, 0.2] {
        // Lowest point -depth, at time 1.
        let (log, _) = throw(&ball, State::<2>::new(0.5 - depth, -1.0), 2.5);
        assert_eq!(log.bounces.len(), 1, "{depth}");
        let exact = 1.0 - (2.0 * depth).sqrt();
        // At the bottom of a shallow dip the error of the instant is the square root of rounding.
        let tolerance = 1e-10_f64.max(1e-15 / (2.0 * depth).sqrt());
        assert!(
            (log.bounces[0].0 - exact).abs() < tolerance,
            "{depth} {}",
            log.bounces[0].0 - exact
        );
    }
    // A ball that stays just above the floor does not bounce.
    let (log, _) = throw(&ball, State::<2>::new(0.5 + 1e-9, -1.0), 2.5);
    assert!(log.bounces.is_empty());
}

#[test]
fn a_short_gust_inside_a_step_is_not_missed() {
    // A gust of a microsecond changes the speed by 0.5 m/s; a step of ten seconds must not skip it.
    let ball = Ball {
        wind: 0.5e6,
        wind_s: (0.1, 0.1 + 1e-6),
        restitution: 0.0,
        ..BALL
    };
    let (log, finish) = throw(&ball, State::<2>::new(1.0, 0.0), 10.0);
    let (height, speed): (f64, f64) = (1.0 - 0.5 * 9.81 * 0.01, -0.981 + 0.5);
    let exact = 0.1 + (speed + (speed * speed + 2.0 * 9.81 * height).sqrt()) / 9.81;
    // Accurate to first order in the length of the gust.
    assert!((finish.unwrap() - exact).abs() < 1e-5);
    assert_eq!(log.bounces.len(), 1);
    // One step ends and another begins at either corner.
    for corner in [0.1, 0.1 + 1e-6] {
        assert!(log.steps.iter().any(|step| step.end_s == corner));
        assert!(log.steps.iter().any(|step| step.start_s == corner));
    }
}

#[test]
fn more_bounces_than_allowed_are_an_error() {
    let ball = Ball {
        stop_rate: 0.0,
        restitution: 0.999,
        ..BALL
    };
    let (_, finish) = throw(&ball, State::<2>::new(1.0, 0.0), 1e6);
    assert!(matches!(
        finish,
        Err(EngineError::TooManyTransitions(_, 200))
    ));
}

#[test]
fn integration_ends_exactly_at_the_end() {
    let (log, finish) = throw(&BALL, State::<2>::new(1.0, 0.0), 0.25);
    assert!(finish.unwrap() == 0.25 && log.bounces.is_empty());
    let last = log.steps.last().unwrap();
    assert!(last.end_s == 0.25);
    assert!((last.end[0] - (1.0 - 0.5 * 9.81 * 0.0625)).abs() < 1e-12);
}
