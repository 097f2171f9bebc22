//! A rocking history: what happened, and when.

use std::ops::ControlFlow;

use super::hybrid::engine::{
    EngineError, HybridSystem, Level, Observer, Settings, Transition, falling_root, simulate,
};
use super::hybrid::integrator::{Cost, Step};
use super::hybrid::rocking::{Guard, Mode, Rocking, RockingState};
use super::thrust::ThrustRecord;
use crate::mechanics::four_link::mechanism::Sway;
use crate::mechanics::structure::{Demand, Link, Mechanism, Structure};

/// Rotations of the bodies of a structure, from left to right, anticlockwise, in radians; or their rates.
pub type Rotations<S> = <<S as Structure>::Mechanism as Mechanism>::Rotations;

/// How a history ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// The structure never left the rest.
    NeverMoved,
    /// It moved and came to rest.
    Rest,
    /// It overturned, to this side.
    Overturned(Sway),
    /// It was still moving when the time was over.
    StillRocking,
}

impl Outcome {
    /// The name in machine-readable results.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::NeverMoved => "never_moved",
            Self::Rest => "rest",
            Self::Overturned(_) => "overturned",
            Self::StillRocking => "still_rocking",
        }
    }
}

/// One impact of a history.
pub struct ImpactEvent<'a, S: Structure> {
    /// Instant in seconds.
    pub time_s: f64,
    /// Sway of the mechanism that closed.
    pub sway_before: Sway,
    /// Link that closed.
    pub before: &'a Link<S::Mechanism>,
    /// Impacts since the structure last left the rest, this one included: index of the next link.
    pub impacts: usize,
    /// Link that follows; `None` if the impact stops the structure because no mechanism can follow.
    pub after: Option<&'a Link<S::Mechanism>>,
    /// Rate of `q` just before, negative.
    pub rate_before_rad_s: f64,
    /// Rate of `q` just after, of the new mechanism, also where it is too small to go on.
    pub rate_after_rad_s: f64,
}

impl<'a, S: Structure> ImpactEvent<'a, S> {
    fn new(structure: &'a S, transition: &RockingTransition<'a, S>) -> Option<Self> {
        let Mode::Rocking {
            sway,
            impacts,
            link,
        } = transition.from
        else {
            return None;
        };
        if transition.guard != Guard::Closing {
            return None;
        }
        let after = structure.link(impacts + 1);
        let rate_before_rad_s = transition.before[1].min(0.0);
        Some(Self {
            time_s: transition.time_s,
            sway_before: sway,
            before: link,
            impacts: impacts + 1,
            after,
            rate_before_rad_s,
            rate_after_rad_s: after.map_or(0.0, |link| -rate_before_rad_s * link.rate_ratio),
        })
    }

    /// Kinetic energies before and after, in the unit of [`Rocking::barrier`].
    #[must_use]
    pub fn energies(&self) -> (f64, f64) {
        let kinetic =
            |link: &Link<S::Mechanism>, rate: f64| 0.5 * link.at_zero.inertia * rate * rate;
        let after = self
            .after
            .map_or(0.0, |link| kinetic(link, self.rate_after_rad_s));
        (kinetic(self.before, self.rate_before_rad_s), after)
    }

    /// Rotation rates of the bodies before and after, in rad/s.
    #[must_use]
    pub fn rates_rad_s(&self) -> (Rotations<S>, Rotations<S>) {
        let rates = |link: &Link<S::Mechanism>, sway, rate| {
            seen_from_ground::<S>(sway, link.mechanism.rotation_rates(0.0), rate)
        };
        let sway_after = self.sway_before.opposite();
        let after = self.after.unwrap_or(self.before);
        (
            rates(self.before, self.sway_before, self.rate_before_rad_s),
            rates(after, sway_after, self.rate_after_rad_s),
        )
    }
}

named! {
    /// What a transition is.
    pub enum EventKind {
        /// The ground lifts a structure at rest off.
        Uplift = "uplift",
        /// The hinges close, and another mechanism opens.
        Impact = "impact",
        /// The hinges close, and the structure comes to rest.
        Rest = "rest",
        /// The structure is lost.
        Overturned = "overturned",
    }
}

/// A transition of a history, and the state that it leads to.
#[derive(Clone, Copy, Debug)]
pub struct Event<R> {
    /// Instant in seconds.
    pub time_s: f64,
    /// What happened.
    pub kind: EventKind,
    /// Side to which the structure sways from here on; `None` at rest.
    pub sway: Option<Sway>,
    /// Impacts since it last left the rest, which is the index of its mechanism; `None` at rest.
    pub mechanism: Option<usize>,
    /// Rotations of the bodies.
    pub rotations_rad: R,
    /// Rotation rates of the bodies just after.
    pub rates_rad_s: R,
    /// Kinetic and potential energy just after, in the unit of [`Rocking::barrier`].
    pub energy: f64,
}

/// State of a structure at an instant of the output.
#[derive(Clone, Copy, Debug)]
pub struct Sample<R> {
    /// Time in seconds.
    pub time_s: f64,
    /// Ground acceleration, positive to +x.
    pub ground_acceleration_m_s2: f64,
    /// Vertical ground acceleration, positive upwards.
    pub vertical_acceleration_m_s2: f64,
    /// Transitions so far.
    pub phase: usize,
    /// `rest`, `right`, `left` or `overturned`.
    pub state: &'static str,
    /// Rotations of the bodies.
    pub rotations_rad: R,
    /// Rotation rates of the bodies.
    pub rates_rad_s: R,
    /// What the internal forces ask of the sections.
    pub demand: Demand,
    /// Kinetic and potential energy over the energy barrier.
    pub energy_ratio: f64,
    /// Rotation of the body that carries `q` over that at the unstable equilibrium of the mechanism that
    /// moves, anticlockwise: below -1 or above 1 gravity overturns the structure.
    pub rotation_over_critical: f64,
}

/// What is to be simulated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request {
    /// Upper bound of the time, in seconds.
    pub end_s: f64,
    /// Relative tolerance of the integration.
    pub relative_tolerance: f64,
    /// Released from this sway and `q` in radians, at zero rate; at rest if `None`.
    pub initial: Option<(Sway, f64)>,
    /// Interval of the samples, in seconds; none are taken if `None`.
    pub output_step_s: Option<f64>,
}

/// Result of a simulation.
pub struct History<'a, S: Structure> {
    /// How it ended.
    pub outcome: Outcome,
    /// When that was decided: the last outward passage of the unstable equilibrium, the last coming to
    /// rest, or the end of the simulation.
    pub outcome_time_s: f64,
    /// When the simulation ended.
    pub end_s: f64,
    /// All transitions, impacts included: the phase that follows the `i`-th is `i + 1`.
    pub events: Vec<Event<Rotations<S>>>,
    /// All impacts.
    pub impacts: Vec<ImpactEvent<'a, S>>,
    /// Largest magnitudes of the rotations.
    pub peak_rotations_rad: Rotations<S>,
    /// Largest rotation over that at the unstable equilibrium of the mechanism that moved: from 1 on, gravity
    /// alone overturns.
    pub peak_over_critical: f64,
    /// Largest difference between the energy of the structure and its initial energy plus the work of
    /// the ground minus what the impacts took, over the energy barrier.
    pub energy_defect_ratio: f64,
    /// The demands over all samples, if any were asked for; of a structure that overturns, over those before
    /// it passes the unstable equilibrium for the last time.
    pub thrust: Option<ThrustRecord>,
    /// Work done by the integrator.
    pub cost: Cost,
}

/// Transitions that a history may have; only a chattering that the model does not know could need more.
const MOST_TRANSITIONS: usize = 1_000_000;

/// Simulates, and hands the samples asked for to `sink`, in the order of time: one at every multiple of
/// the output step from zero on, and a last one at the end. Where the sink breaks, the history ends.
///
/// # Errors
/// When the integration fails.
pub fn history<'a, S: Structure>(
    rocking: &Rocking<'a, S>,
    request: &Request,
    sink: impl FnMut(&Sample<Rotations<S>>) -> ControlFlow<()>,
) -> Result<History<'a, S>, EngineError> {
    let (mode, state) = match request.initial {
        Some((sway, rotation_rad)) => (
            rocking.released(sway),
            RockingState::new(rotation_rad, 0.0, 0.0),
        ),
        None => (Mode::Rest, RockingState::zeros()),
    };
    let settings = Settings {
        end_s: request.end_s,
        relative_tolerance: request.relative_tolerance,
        most_transitions: MOST_TRANSITIONS,
    };
    let mut recorder = Recorder::new(rocking, mode, &state);
    let mut sampler = request
        .output_step_s
        .map(|output_step_s| Sampler::new(output_step_s, sink));
    let finish = simulate(
        rocking,
        mode,
        state,
        &settings,
        &mut (&mut recorder, &mut sampler),
    )?;
    if let Some(sampler) = &mut sampler
        && !finish.stopped
    {
        // It ends here anyway.
        let _ = sampler.finish(rocking, finish.mode, finish.time_s, &finish.state);
    }
    recorder.note_peak(finish.mode, &finish.state);
    recorder.check_energy(rocking, finish.mode, &finish.state);
    let (outcome, outcome_time_s) = match finish.mode {
        Mode::Overturned { sway, .. } => (
            Outcome::Overturned(sway),
            recorder.last_outward_s.unwrap_or(finish.time_s),
        ),
        Mode::Rest => recorder
            .last_rest_s
            .map_or((Outcome::NeverMoved, finish.time_s), |time_s| {
                (Outcome::Rest, time_s)
            }),
        Mode::Rocking { .. } => (Outcome::StillRocking, finish.time_s),
    };
    Ok(History {
        outcome,
        outcome_time_s,
        end_s: finish.time_s,
        events: recorder.events,
        impacts: recorder.impacts,
        peak_rotations_rad: recorder.peak_rotations_rad,
        peak_over_critical: recorder.peak_over_critical,
        energy_defect_ratio: recorder.largest_defect / rocking.barrier(),
        thrust: sampler.map(|sampler| match outcome {
            Outcome::Overturned(_) => sampler.thrust_before_critical,
            _ => sampler.thrust,
        }),
        cost: finish.cost,
    })
}

/// Rotations (or rates) of a mechanism in its own frame, times `factor`, in the frame of the ground: a
/// sway to the left is seen in a mirror, which swaps the bodies and turns their rotations round.
fn seen_from_ground<S: Structure>(
    sway: Sway,
    mut rotations: Rotations<S>,
    factor: f64,
) -> Rotations<S> {
    if sway == Sway::Left {
        rotations.as_mut().reverse();
    }
    for rotation in rotations.as_mut() {
        // Adding zero makes a negative zero positive.
        *rotation = *rotation * (sway.sign() * factor) + 0.0;
    }
    rotations
}

/// Rotations of the bodies and their rates, in the frame of the ground.
fn posture<S: Structure>(
    rocking: &Rocking<'_, S>,
    mode: Mode<'_, S::Mechanism>,
    state: &RockingState,
) -> (Rotations<S>, Rotations<S>) {
    let seen = |sway, link: &Link<S::Mechanism>, q_rad, moved, rate| {
        (
            seen_from_ground::<S>(sway, link.mechanism.rotations(q_rad), moved),
            seen_from_ground::<S>(sway, link.mechanism.rotation_rates(q_rad), rate),
        )
    };
    match mode {
        Mode::Rocking { sway, link, .. } | Mode::Overturned { sway, link } => {
            seen(sway, link, state[0], 1.0, state[1])
        }
        Mode::Rest => {
            let link = rocking.structure().link(0);
            let link = link.expect("a structure has its first mechanism");
            seen(Sway::Right, link, 0.0, 0.0, 0.0)
        }
    }
}

type RockingTransition<'a, S> = Transition<Mode<'a, <S as Structure>::Mechanism>, Guard, 3>;

/// Keeps what a summary needs.
struct Recorder<'a, S: Structure> {
    events: Vec<Event<Rotations<S>>>,
    impacts: Vec<ImpactEvent<'a, S>>,
    peak_rotations_rad: Rotations<S>,
    peak_over_critical: f64,
    last_outward_s: Option<f64>,
    last_rest_s: Option<f64>,
    /// Initial energy minus what the impacts took.
    energy_without_work: f64,
    largest_defect: f64,
}

impl<'a, S: Structure> Recorder<'a, S> {
    fn new(rocking: &Rocking<'a, S>, mode: Mode<'a, S::Mechanism>, state: &RockingState) -> Self {
        let (none, _) = posture(rocking, Mode::Rest, state);
        let mut recorder = Self {
            events: Vec::new(),
            impacts: Vec::new(),
            peak_rotations_rad: none,
            peak_over_critical: 0.0,
            last_outward_s: None,
            last_rest_s: None,
            energy_without_work: match mode {
                Mode::Rocking { link, .. } => rocking.energy(link, state),
                Mode::Rest | Mode::Overturned { .. } => 0.0,
            },
            largest_defect: 0.0,
        };
        recorder.note_peak(mode, state);
        recorder
    }

    /// All rotations grow with `q`: the largest are where it turns round, or at the start or the end.
    fn note_peak(&mut self, mode: Mode<'a, S::Mechanism>, state: &RockingState) {
        if let Mode::Rocking { sway, link, .. } | Mode::Overturned { sway, link } = mode {
            let rotations = seen_from_ground::<S>(sway, link.mechanism.rotations(state[0]), 1.0);
            let peaks = self.peak_rotations_rad.as_mut().iter_mut();
            for (peak, rotation) in peaks.zip(rotations.as_ref()) {
                *peak = peak.max(rotation.abs());
            }
            self.peak_over_critical = self.peak_over_critical.max(state[0] / link.critical_rad);
        }
    }

    fn check_energy(
        &mut self,
        rocking: &Rocking<'a, S>,
        mode: Mode<'a, S::Mechanism>,
        state: &RockingState,
    ) {
        if let Mode::Rocking { link, .. } = mode {
            let defect = rocking.energy(link, state) - self.energy_without_work - state[2];
            self.largest_defect = self.largest_defect.max(defect.abs());
        }
    }
}

impl<'a, S: Structure> Observer<Rocking<'a, S>, 3> for Recorder<'a, S> {
    fn step(
        &mut self,
        rocking: &Rocking<'a, S>,
        mode: Mode<'a, S::Mechanism>,
        _: usize,
        step: &Step<3>,
    ) -> ControlFlow<()> {
        let Mode::Rocking { link, .. } = mode else {
            return ControlFlow::Continue(());
        };
        // It may turn round in the very step in which it leaves the rest, at no rate.
        if step.start[1] >= 0.0 && step.end[1] <= 0.0 {
            let bend = step.end_slope[1] - step.start_slope[1];
            let turn_s = falling_root(step.start_s, step.end_s, |time_s| Level {
                value: rocking.between(step, time_s)[1],
                rate: step.start_slope[1]
                    + bend * (time_s - step.start_s) / (step.end_s - step.start_s),
            });
            self.note_peak(mode, &rocking.between(step, turn_s));
            self.check_energy(rocking, mode, &step.end);
        }
        if step.start[0] < link.critical_rad && step.end[0] >= link.critical_rad {
            let passage_s = falling_root(step.start_s, step.end_s, |time_s| {
                let state = rocking.between(step, time_s);
                Level {
                    value: link.critical_rad - state[0],
                    rate: -state[1],
                }
            });
            self.last_outward_s = Some(passage_s);
        }
        ControlFlow::Continue(())
    }

    fn transition(
        &mut self,
        rocking: &Rocking<'a, S>,
        _: usize,
        transition: &RockingTransition<'a, S>,
    ) -> ControlFlow<()> {
        self.check_energy(rocking, transition.from, &transition.before);
        if let Some(impact) = ImpactEvent::new(rocking.structure(), transition) {
            let (before, after) = impact.energies();
            let left = if matches!(transition.to, Mode::Rest) {
                0.0
            } else {
                after
            };
            self.energy_without_work -= before - left;
            self.impacts.push(impact);
        }
        self.events.push(event(rocking, transition));
        if let Mode::Rest = transition.to {
            self.last_rest_s = Some(transition.time_s);
            // At rest there is no energy; what is left is the defect so far, and goes on.
        }
        ControlFlow::Continue(())
    }
}

fn event<'a, S: Structure>(
    rocking: &Rocking<'a, S>,
    transition: &RockingTransition<'a, S>,
) -> Event<Rotations<S>> {
    let kind = match (transition.guard, transition.to) {
        (Guard::Uplift(_), _) => EventKind::Uplift,
        (Guard::Closing, Mode::Rest) => EventKind::Rest,
        (Guard::Closing, _) => EventKind::Impact,
        (Guard::Critical | Guard::Limit, _) => EventKind::Overturned,
    };
    let impacts = |mode| match mode {
        Mode::Rocking { impacts, .. } => Some(impacts),
        Mode::Rest | Mode::Overturned { .. } => None,
    };
    let (sway, mechanism, energy) = match transition.to {
        Mode::Rest => (None, None, 0.0),
        Mode::Rocking { sway, link, .. } | Mode::Overturned { sway, link } => (
            Some(sway),
            impacts(transition.to).or(impacts(transition.from)),
            rocking.energy(link, &transition.after),
        ),
    };
    let (rotations_rad, rates_rad_s) = posture(rocking, transition.to, &transition.after);
    Event {
        time_s: transition.time_s,
        kind,
        sway,
        mechanism,
        rotations_rad,
        rates_rad_s,
        energy,
    }
}

/// Takes samples at multiples of the output step.
struct Sampler<F, R> {
    output_step_s: f64,
    next: u64,
    phase: usize,
    /// The last sample is held back, in case the end falls on it.
    held: Option<Sample<R>>,
    thrust: ThrustRecord,
    /// The same up to the last sample before the unstable equilibrium.
    thrust_before_critical: ThrustRecord,
    sink: F,
}

impl<R: Copy, F: FnMut(&Sample<R>) -> ControlFlow<()>> Sampler<F, R> {
    fn new(output_step_s: f64, sink: F) -> Self {
        Self {
            output_step_s,
            next: 0,
            phase: 0,
            held: None,
            thrust: ThrustRecord::default(),
            thrust_before_critical: ThrustRecord::default(),
            sink,
        }
    }

    #[expect(clippy::cast_precision_loss, reason = "sample counts are below 2^53")]
    fn next_s(&self) -> f64 {
        self.next as f64 * self.output_step_s
    }

    fn push(&mut self, sample: Sample<R>) -> ControlFlow<()> {
        match self.held.replace(sample) {
            Some(held) => self.emit(&held),
            None => ControlFlow::Continue(()),
        }
    }

    fn emit(&mut self, sample: &Sample<R>) -> ControlFlow<()> {
        self.thrust
            .note(sample.time_s, sample.state != "rest", &sample.demand);
        if sample.rotation_over_critical.abs() < 1.0 {
            self.thrust_before_critical = self.thrust;
        }
        (self.sink)(sample)
    }

    fn sample<S: Structure>(
        &self,
        rocking: &Rocking<'_, S>,
        mode: Mode<'_, S::Mechanism>,
        piece: usize,
        time_s: f64,
        state: &RockingState,
    ) -> Sample<R>
    where
        S::Mechanism: Mechanism<Rotations = R>,
        R: AsRef<[f64]> + AsMut<[f64]>,
    {
        let over_critical = |sway: Sway, link: &Link<S::Mechanism>| {
            -sway.sign() * state[0] / link.critical_rad + 0.0
        };
        let (name, rotation_over_critical, energy) = match mode {
            Mode::Rest => ("rest", 0.0, 0.0),
            Mode::Rocking { sway, link, .. } => (
                sway.name(),
                over_critical(sway, link),
                rocking.energy(link, state),
            ),
            Mode::Overturned { sway, link } => (
                "overturned",
                over_critical(sway, link),
                rocking.energy(link, state),
            ),
        };
        let (rotations_rad, rates_rad_s) = posture(rocking, mode, state);
        let (ground, _) = rocking.ground().pieces()[piece].at(time_s);
        Sample {
            time_s,
            // Adding zero makes a negative zero positive.
            ground_acceleration_m_s2: ground.x + 0.0,
            vertical_acceleration_m_s2: ground.y + 0.0,
            phase: self.phase,
            state: name,
            rotations_rad,
            rates_rad_s,
            demand: rocking.demand(mode, piece, time_s, state),
            energy_ratio: energy / rocking.barrier(),
            rotation_over_critical,
        }
    }

    /// The last sample, at the end of the simulation.
    fn finish<S: Structure>(
        &mut self,
        rocking: &Rocking<'_, S>,
        mode: Mode<'_, S::Mechanism>,
        time_s: f64,
        state: &RockingState,
    ) -> ControlFlow<()>
    where
        S::Mechanism: Mechanism<Rotations = R>,
        R: AsRef<[f64]> + AsMut<[f64]>,
    {
        let pieces = rocking.ground().pieces();
        let piece = pieces.partition_point(|piece| piece.start_s <= time_s) - 1;
        let last = self.sample(rocking, mode, piece, time_s, state);
        // A sample that rounding alone parts from the end is replaced.
        if let Some(held) = self.held.take()
            && held.time_s < time_s - 1e-9 * self.output_step_s
        {
            self.emit(&held)?;
        }
        self.emit(&last)
    }
}

impl<'a, S, F> Observer<Rocking<'a, S>, 3> for Option<Sampler<F, Rotations<S>>>
where
    S: Structure,
    F: FnMut(&Sample<Rotations<S>>) -> ControlFlow<()>,
{
    fn step(
        &mut self,
        rocking: &Rocking<'a, S>,
        mode: Mode<'a, S::Mechanism>,
        piece: usize,
        step: &Step<3>,
    ) -> ControlFlow<()> {
        let Some(sampler) = self else {
            return ControlFlow::Continue(());
        };
        while sampler.next_s() < step.end_s {
            let time_s = sampler.next_s().max(step.start_s);
            let state = rocking.between(step, time_s);
            let sample = sampler.sample(rocking, mode, piece, time_s, &state);
            sampler.next += 1;
            sampler.push(sample)?;
        }
        ControlFlow::Continue(())
    }

    fn transition(
        &mut self,
        _: &Rocking<'a, S>,
        _: usize,
        _: &RockingTransition<'a, S>,
    ) -> ControlFlow<()> {
        if let Some(sampler) = self {
            sampler.phase += 1;
        }
        ControlFlow::Continue(())
    }
}
