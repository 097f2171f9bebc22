//! Samples of a sequence of mechanisms, and of its fall.

use std::mem;
use std::ops::ControlFlow;

use nalgebra::Vector2;

use super::engine::{HybridSystem, task};
use super::integrator::{IntegratorStep, integrate};
use super::posture::{StructureState, posture, state};
use super::rocking::{Phase, Rocking, RockingState, Swing, SystemState};
use crate::dynamics::recorder::Recorder;
use crate::dynamics::{Cost, FallEnd, OpenHinge, Sample, State, ThrustRecord, fall};
use crate::mechanics::{Mechanism, MechanismChain, Pose};

/// Relative error tolerance of a step of a fall, which is only drawn.
const FALL_TOLERANCE: f64 = 1e-6;

/// Longest time between instants at which the demand of a moving structure is computed, over the time scale of its fall.
const DEMAND_STEP_RATIO: f64 = 1.0 / 32.0;

/// Takes samples at multiples of the output step.
pub(super) struct Sampler<'r, 'a, C: MechanismChain> {
    rocking: &'r Rocking<'a, C>,
    output_step_s: f64,
    next: u64,
    pub(super) phase: usize,
    /// The last sample is held back, in case the end falls on it.
    last_sample: Option<Sample>,
    /// Reused, so that samples need no allocation.
    buffer: Sample,
    /// Positions of the hinges, also reused.
    hinges_m: Vec<Vector2<f64>>,
    pub(super) thrust: ThrustRecord,
    /// Thrust record up to the last sample before the unstable equilibrium.
    pub(super) thrust_before_critical: ThrustRecord,
    pub(super) recorder: &'r mut dyn Recorder,
}

/// Instants within a step at which the demand is computed; its ends are not among them.
pub(super) fn instants<'a, C: MechanismChain>(
    rocking: &Rocking<'a, C>,
    swing: Swing<'a, C::Mechanism>,
    step: &IntegratorStep<3>,
) -> impl Iterator<Item = f64> + use<C> {
    let (start_s, span_s) = (step.start_s, step.end_s - step.start_s);
    let parts = (span_s / (DEMAND_STEP_RATIO * rocking.fall_s(swing.link))).ceil();
    (1..parts as usize).map(move |part| start_s + span_s * (part as f64 / parts))
}

impl<'r, 'a, C: MechanismChain> Sampler<'r, 'a, C> {
    pub(super) fn new(
        rocking: &'r Rocking<'a, C>,
        output_step_s: f64,
        recorder: &'r mut dyn Recorder,
    ) -> Self {
        Self {
            rocking,
            output_step_s,
            next: 0,
            phase: 0,
            last_sample: None,
            buffer: Sample::default(),
            hinges_m: Vec::new(),
            thrust: ThrustRecord::default(),
            thrust_before_critical: ThrustRecord::default(),
            recorder,
        }
    }

    fn next_s(&self) -> f64 {
        self.next as f64 * self.output_step_s
    }

    fn emit_sample(&mut self, sample: &Sample) -> ControlFlow<()> {
        let moving = sample.state != State::Rest;
        self.thrust
            .add_sample(sample.time_s, moving, &sample.demand);
        self.note_return(sample);
        self.recorder.sample(sample)
    }

    fn sample(&mut self, now: &StructureState<'a, C>, thrust_line: bool) -> Sample {
        let rocking = self.rocking;
        let mut sample = mem::take(&mut self.buffer);
        let (ground_m_s2, _) = rocking.ground.pieces[now.piece].acceleration_and_rate(now.time_s);
        sample.reset_to_rest(now.time_s, ground_m_s2, self.phase);
        let (rotations, rates) = posture(rocking, now.mode, &now.state);
        sample.state = state(now.mode);
        sample.rotations_rad.extend(rotations.as_ref());
        sample.rates_rad_s.extend(rates.as_ref());
        let (mut rotation_over_critical, mut energy, mut barrier) = (0.0, 0.0, 1.0);
        let poses = &mut sample.poses;
        if let Some(swing) = now.mode.swing() {
            let (sway, link) = (swing.sway, swing.link);
            let (displaced, hinges_m) = ((now.state[0], sway), &mut self.hinges_m);
            (rocking.chain).place_m(&link.mechanism, displaced, poses, hinges_m);
            let seen = rocking.chain.hinges(swing.impacts, sway).into_iter();
            let open = seen.zip(hinges_m).map(|(hinge, at)| OpenHinge {
                hinge,
                position_m: *at,
            });
            sample.hinges.extend(open);
            // Adding zero makes a negative zero positive.
            rotation_over_critical = -sway.sign() * now.state[0] / link.critical_rad + 0.0;
            energy = rocking.energy(link, &now.state);
            barrier = rocking.barrier_of(link);
        } else {
            poses.resize(C::Mechanism::BODIES.len(), Pose::UNDEFORMED);
        }
        if thrust_line && self.recorder.wants_thrust_line() {
            sample.eccentricity_ratios = rocking.eccentricity_ratios(now);
        }
        if self.recorder.wants_demand() {
            sample.demand = rocking.demand(now);
        }
        sample.energy_j = energy * rocking.chain.joules_per_unit();
        sample.energy_ratio = Some(energy / barrier);
        sample.rotation_over_critical = Some(rotation_over_critical);
        sample
    }

    /// Records the demand and the positions at several instants of a step.
    fn note_step(&mut self, from: &StructureState<'a, C>, step: &IntegratorStep<3>) {
        let span_s = step.end_s - step.start_s;
        let Some(swing) = from.mode.swing().filter(|_| span_s > 0.0) else {
            return;
        };
        for time_s in instants(self.rocking, swing, step).chain([step.end_s]) {
            let now = from.at(time_s, &self.rocking.interpolate(step, time_s));
            let sample = self.sample(&now, false);
            self.thrust.note_demand(time_s, &sample.demand);
            self.note_return(&sample);
            self.recorder.step(time_s, &sample.poses, &sample.hinges);
            self.buffer = sample;
        }
    }

    /// Records the thrust before the unstable equilibrium.
    fn note_return(&mut self, sample: &Sample) {
        let comes_back = |rotation: f64| rotation.abs() < 1.0;
        if sample.rotation_over_critical.is_some_and(comes_back) {
            self.thrust_before_critical = self.thrust;
        }
    }

    /// Takes the samples of a step.
    pub(super) fn step(
        &mut self,
        from: &StructureState<'a, C>,
        step: &IntegratorStep<3>,
    ) -> ControlFlow<()> {
        self.note_step(from, step);
        while self.next_s() < step.end_s {
            let time_s = self.next_s().max(step.start_s);
            let state = self.rocking.interpolate(step, time_s);
            let sample = self.sample(&from.at(time_s, &state), true);
            self.next += 1;
            if let Some(last_sample) = self.last_sample.replace(sample) {
                let flow = self.emit_sample(&last_sample);
                self.buffer = last_sample;
                flow?;
            }
        }
        ControlFlow::Continue(())
    }

    /// Takes the last sample, at the end of the simulation.
    pub(super) fn finish(&mut self, now: &StructureState<'a, C>) -> ControlFlow<()> {
        let piece = self.rocking.ground.piece_at(now.time_s);
        let last = self.sample(&SystemState { piece, ..*now }, true);
        // Replace a sample that differs from the end only by rounding error.
        if let Some(last_sample) = self.last_sample.take()
            && last_sample.time_s < now.time_s - 1e-9 * self.output_step_s
        {
            self.emit_sample(&last_sample)?;
        }
        self.emit_sample(&last)
    }

    /// Computes the fall of an overturned mechanism if the recorder wants it. The hinges stay the same, also beyond the limit position, where the
    /// first of them begins to close.
    pub(super) fn follow_fall(&mut self, from: &StructureState<'a, C>) {
        let rocking = self.rocking;
        let Phase::Overturned(swing) = from.mode else {
            return;
        };
        if !self.recorder.wants_fall() {
            return;
        }
        let every_s = self.output_step_s.min(fall::SAMPLED_S);
        self.output_step_s = every_s;
        self.next = (from.time_s / every_s) as u64 + 1;
        let until_s = from.time_s + fall::LONGEST_S;
        let mut now = SystemState {
            mode: Phase::Rocking(swing),
            ..*from
        };
        let mut ended = ControlFlow::Continue(());
        let mut end = FallEnd::Slow;
        for (piece, motion) in rocking.ground.pieces.iter().enumerate() {
            if motion.end_s <= now.time_s || now.time_s >= until_s || ended.is_break() {
                continue;
            }
            now.piece = piece;
            let end_s = motion.end_s.min(until_s);
            let task = task(rocking, &now, end_s, FALL_TOLERANCE);
            let overturned = SystemState { piece, ..*from };
            let watch = |step: &IntegratorStep<3>| {
                while self.next_s() <= step.end_s {
                    let time_s = self.next_s();
                    let state = rocking.interpolate(step, time_s);
                    let sample = self.sample(&overturned.at(time_s, &state), true);
                    self.next += 1;
                    ended = self.recorder.fall_sample(&sample);
                    if let Some(at) = fall::end_at(&sample) {
                        end = at;
                        ended = ControlFlow::Break(());
                    }
                    self.buffer = sample;
                    ended?;
                }
                ControlFlow::Continue(())
            };
            let slope = |time_s: f64, state: &RockingState| rocking.slope(&now.at(time_s, state));
            let Ok(last) = integrate(&task, slope, watch, &mut Cost::default()) else {
                end = FallEnd::Model("its links reach no farther".to_owned());
                break;
            };
            now = now.at(end_s, &last);
        }
        self.recorder.fall_end(end);
    }
}
