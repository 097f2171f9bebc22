//! Histories of sequences of mechanisms, by the hybrid engine.

use std::ops::ControlFlow;

use super::engine::{
    EngineSettings, Finish, HybridSystem, Observer, Transition, falling_root, resume, simulate,
};
use super::friction::FrictionCollector;
use super::integrator::IntegratorStep;
use super::posture::{StructureState, posture, seen_from_ground, state};
use super::rocking::{Guard, Mode, Phase, Rocking, RockingState, Swing};
use super::sampler::{Sampler, instants};
use crate::dynamics::history::{Impact, MechanismSummary};
use crate::dynamics::model::{Initial, Recorder, check};
use crate::dynamics::request::later_end_s;
use crate::dynamics::thrust::STRONG;
use crate::dynamics::until::SAFE;
use crate::dynamics::{
    Details, Event, EventKind, GroundMotion, MechanismModel, Model, Outcome, Request,
    SimulationError, Summary,
};
use crate::mechanics::capacity::{displaced_mechanism, moving_bodies, moving_forces};
use crate::mechanics::column::RockingColumn;
use crate::mechanics::equivalent::equivalent_towards;
use crate::mechanics::{
    Displaced, Equivalent, FourLinks, Hinge, Link, Mechanism, MechanismChain, MovingBody,
    MovingForce, Sides, Sway,
};

/// Maximum number of transitions of a history; more would be chatter.
const MAX_TRANSITIONS: usize = 1_000_000;
/// Implements the model traits for each sequence of mechanisms, so that the engine is compiled here and not in every crate that uses it.
macro_rules! models {
    ($($chain:ty),+) => {$(
        impl Model for $chain {
            fn bodies(&self) -> Vec<String> {
                let bodies = <Self as MechanismChain>::Mechanism::BODIES.iter();
                bodies.map(|body| (*body).to_owned()).collect()
            }

            fn as_mechanisms(&self) -> Option<&dyn MechanismModel> {
                Some(self)
            }

            fn incipient_acceleration_g(&self, sway: Sway) -> Option<f64> {
                let first = self.link_from(sway, 0);
                first.map(|_| self.incipient_towards_g(sway))
            }

            fn covers_mirrored(&self) -> bool {
                self.is_symmetric()
            }

            fn simulate(
                &self,
                ground: &GroundMotion,
                request: &Request,
                recorder: Option<&mut dyn Recorder>,
            ) -> Result<Summary, SimulationError> {
                history_of(self, ground, request, recorder)
            }
        }

        impl MechanismModel for $chain {
            fn restitution_from(&self, first: Sway, impacts: usize) -> Option<f64> {
                self.link_from(first, impacts).map(|link| link.restitution)
            }

            fn sway_after(&self, first: Sway, impacts: usize) -> Sway {
                MechanismChain::sway_after(self, first, impacts)
            }

            fn hinges_after(&self, impacts: usize, sway: Sway) -> Vec<Hinge> {
                self.hinges(impacts, sway)
            }

            fn critical_rotations_rad(&self, sway: Sway) -> Vec<f64> {
                let Some(first) = self.link_from(sway, 0) else {
                    return Vec::new();
                };
                let rotations = first.mechanism.rotations(first.critical_rad);
                let seen = seen_from_ground::<Self>(sway, rotations, 1.0);
                seen.as_ref().to_vec()
            }

            fn limit_rad(&self, sway: Sway) -> f64 {
                self.link_from(sway, 0).map_or(0.0, |first| first.limit_rad)
            }

            fn equivalent(&self, sway: Sway, gravity_m_s2: f64) -> Option<Equivalent> {
                equivalent_towards(self, sway, gravity_m_s2)
            }

            fn displaced_mechanism(&self, sway: Sway, part: f64) -> Option<Displaced> {
                displaced_mechanism(self, sway, part)
            }

            fn moving_bodies(&self, sway: Sway) -> Option<Vec<MovingBody>> {
                moving_bodies(self, sway)
            }

            fn moving_forces(&self, sway: Sway) -> Option<Vec<MovingForce>> {
                moving_forces(self, sway)
            }

            fn overturns_without_impact(
                &self,
                ground: &GroundMotion,
                request: &Request,
            ) -> Result<Option<Sway>, SimulationError> {
                first_fall(self, ground, request)
            }
        }
    )+};
}

models!(FourLinks, RockingColumn);

/// Computes the history of a sequence of mechanisms.
fn history_of<C: MechanismChain + MechanismModel>(
    chain: &C,
    ground: &GroundMotion,
    request: &Request,
    recorder: Option<&mut dyn Recorder>,
) -> Result<Summary, SimulationError> {
    let rocking = checked(chain, ground, request)?;
    let mode = |initial: Initial| rocking.released_mode(initial.sway);
    let mode = request.initial.map_or(Phase::Rest, mode);
    let start = |initial: Initial| RockingState::new(initial.rotation_rad, initial.rate_rad_s, 0.0);
    let state = request.initial.map_or_else(RockingState::zeros, start);
    let mut settings = EngineSettings {
        end_s: request.end_s,
        relative_tolerance: request.relative_tolerance,
        max_transitions: MAX_TRANSITIONS,
    };
    let every_s = request.output_step_s;
    let energy = |swing: Swing<'_, C::Mechanism>| rocking.energy(swing.link, &state);
    let mut collector = SummaryCollector {
        rocking: &rocking,
        sampler: recorder.map(|recorder| Sampler::new(&rocking, every_s, recorder)),
        impacts: 0,
        peaks: (vec![0.0; C::Mechanism::BODIES.len()], 0.0),
        shifts_kg_m: Sides::default(),
        excess_ratio: 0.0,
        excess_at_peak: 0.0,
        last_passage: None,
        last_rest_s: None,
        energy_without_work: mode.swing().map_or(0.0, energy),
        largest_defect: 0.0,
        friction: FrictionCollector::new(),
    };
    collector.note_start(mode, state);
    let start = (mode, state);
    let finish = simulate_lengthened(start, &mut settings, &mut collector, request.outcome_by_s)?;
    let now = &finish.now;
    if let Some(sampler) = collector.sampler.as_mut().filter(|_| !finish.stopped) {
        // The history ends here in any case.
        let _ = sampler.finish(now);
        sampler.follow_fall(now);
    }
    collector.note_peak(now.mode, &now.state);
    collector.check_energy(now.mode, &now.state);
    let is_shaken = now.time_s < ground.end_s();
    let is_incomplete = is_shaken || collector.may_overturn(now);
    let remaining_over_barrier = collector.remaining_over_barrier(now);
    let outcome = outcome_of(now.mode, is_incomplete, collector.last_rest_s.is_some());
    let excess_ratio = collector.excess_of(outcome);
    let (mut outcome_time_s, mut peaks) = (now.time_s, collector.peaks);
    match (now.mode, collector.last_passage, collector.last_rest_s) {
        (Phase::Overturned(_), Some(passage), _) => (outcome_time_s, peaks) = passage,
        (Phase::Rest, _, Some(time_s)) => outcome_time_s = time_s,
        _ => {}
    }
    let (peak_rotations_rad, peak_over_critical) = peaks;
    let moves = matches!(now.mode, Phase::Rocking(_));
    let friction = collector.friction.record(&rocking, outcome, moves);
    let sampler = collector.sampler.as_ref();
    let demanding = sampler.filter(|sampler| sampler.recorder.wants_demand());
    Ok(Summary {
        outcome,
        outcome_time_s,
        end_s: now.time_s,
        is_cut: false,
        impacts: collector.impacts,
        peak_rotations_rad,
        energy_defect_ratio: collector.largest_defect / rocking.barrier,
        thrust: demanding.map(|sampler| match outcome {
            Outcome::Overturned(_) => sampler.thrust_before_critical,
            _ => sampler.thrust,
        }),
        friction: Some(friction),
        cost: finish.cost,
        details: Details::Mechanisms(MechanismSummary {
            peak_over_critical,
            thrust_excess_ratio: C::THRUSTS.then_some(excess_ratio),
            remaining_over_barrier: remaining_over_barrier.filter(|_| !is_incomplete),
            largest_shifts_kg_m: collector.shifts_kg_m,
        }),
    })
}

/// Outcome of a motion that ends in this mode.
const fn outcome_of<M>(mode: Mode<'_, M>, is_incomplete: bool, has_rested: bool) -> Outcome {
    match mode {
        Phase::Overturned(swing) => Outcome::Overturned(swing.sway),
        _ if is_incomplete => Outcome::Incomplete,
        Phase::Rocking(_) => Outcome::StillRocking,
        Phase::Rest if has_rested => Outcome::Rest,
        Phase::Rest => Outcome::NeverMoved,
    }
}

/// Runs a motion up to the end in the settings, and longer while it may overturn, up to `outcome_by_s` in seconds.
fn simulate_lengthened<'a, C: MechanismChain>(
    (mode, state): (Mode<'a, C::Mechanism>, RockingState),
    settings: &mut EngineSettings,
    collector: &mut SummaryCollector<'_, 'a, C>,
    outcome_by_s: Option<f64>,
) -> Result<Finish<Mode<'a, C::Mechanism>, 3>, SimulationError> {
    let rocking = collector.rocking;
    let mut finish = simulate(rocking, mode, state, settings, collector)
        .map_err(SimulationError::computation)?;
    while !finish.stopped
        && collector.may_overturn(&finish.now)
        && let Some(end_s) = later_end_s(outcome_by_s, rocking.ground, settings.end_s)
    {
        let cost = finish.cost;
        settings.end_s = end_s;
        finish = resume(rocking, finish.now, settings, collector)
            .map_err(SimulationError::computation)?;
        finish.cost.evaluations += cost.evaluations;
        finish.cost.steps += cost.steps;
    }
    Ok(finish)
}

/// Duration after the end of the ground motion in which the first fall ends, in seconds. Close to the unstable equilibrium a motion may last for some
/// forty of its time scales.
const AFTER_S: f64 = 1e6;

/// Side to which a structure at rest overturns before its hinges close for the first time; `None` if it does not. The result does not
/// depend on the impact model.
fn first_fall<C: MechanismChain + MechanismModel>(
    chain: &C,
    ground: &GroundMotion,
    request: &Request,
) -> Result<Option<Sway>, SimulationError> {
    let rocking = checked(chain, ground, request)?;
    let settings = EngineSettings {
        end_s: ground.end_s() + AFTER_S,
        relative_tolerance: request.relative_tolerance,
        // Two transitions: uplift, and the end of the first fall.
        max_transitions: 2,
    };
    let state = RockingState::zeros();
    let finish = simulate(&rocking, Phase::Rest, state, &settings, &mut FirstFall);
    match finish.map_err(SimulationError::computation)?.now.mode {
        Phase::Overturned(swing) => Ok(Some(swing.sway)),
        Phase::Rest | Phase::Rocking(_) => Ok(None),
    }
}

/// Observer that stops when the hinges close.
struct FirstFall;

impl<'a, C: MechanismChain> Observer<Rocking<'a, C>, 3> for FirstFall {
    fn transition(&mut self, transition: &RockingTransition<'a, C>) -> ControlFlow<()> {
        match transition.guard {
            Guard::Closing => ControlFlow::Break(()),
            Guard::Uplift(_) | Guard::Critical | Guard::Limit => ControlFlow::Continue(()),
        }
    }
}

/// Structure on its ground.
///
/// # Errors
/// If the request is not valid, or the feet move differently.
fn checked<'a, C: MechanismChain + MechanismModel>(
    chain: &'a C,
    ground: &'a GroundMotion,
    request: &Request,
) -> Result<Rocking<'a, C>, SimulationError> {
    check(ground, request)?;
    if let Some(initial) = request.initial {
        initial.check(chain.limit_rad(initial.sway))?;
    }
    if ground.right_foot().is_some() {
        return Err(SimulationError::Feet);
    }
    let (gravity_m_s2, rest_energy_ratio) = (request.gravity_m_s2, request.rest_energy_ratio);
    Ok(Rocking::new(chain, ground, gravity_m_s2, rest_energy_ratio))
}

type RockingTransition<'a, C> = Transition<Mode<'a, <C as MechanismChain>::Mechanism>, Guard, 3>;

/// Closing of a mechanism, and the mechanism that follows.
struct Closing<'a, C: MechanismChain> {
    before: Swing<'a, C::Mechanism>,
    /// Next mechanism; `None` if the impact stops the structure because no mechanism can follow.
    after: Option<&'a Link<C::Mechanism>>,
    /// Rate of `q` just before the impact, negative, in rad/s.
    rate_before_rad_s: f64,
    /// Rate of `q` of the new mechanism just after the impact, in rad/s; also if the structure then comes to rest.
    rate_after_rad_s: f64,
}

impl<'a, C: MechanismChain> Closing<'a, C> {
    /// Closing of a transition; `None` for other transitions.
    fn of(chain: &'a C, transition: &RockingTransition<'a, C>) -> Option<Self> {
        let (Guard::Closing, Phase::Rocking(before)) = (transition.guard, transition.from) else {
            return None;
        };
        let impacts = before.impacts;
        let after = chain.link_from(chain.sway_after(before.sway, impacts), impacts + 1);
        let rate_before_rad_s = transition.before[1].min(0.0);
        Some(Self {
            before,
            after,
            rate_before_rad_s,
            rate_after_rad_s: after.map_or(0.0, |link| -rate_before_rad_s * link.rate_ratio),
        })
    }

    /// Kinetic energies before and after, in the unit of [`Rocking::barrier`].
    fn energies(&self) -> (f64, f64) {
        let kinetic =
            |link: &Link<C::Mechanism>, rate: f64| 0.5 * link.at_zero.inertia * rate * rate;
        let after = |link| kinetic(link, self.rate_after_rad_s);
        let before = kinetic(self.before.link, self.rate_before_rad_s);
        (before, self.after.map_or(0.0, after))
    }

    fn impact(&self, chain: &C) -> Impact {
        let joule = chain.joules_per_unit();
        let (energy_before, energy_after) = self.energies();
        let rates = |link: &Link<C::Mechanism>, sway, rate| {
            let rates = link.mechanism.rotation_rates(0.0);
            let seen = seen_from_ground::<C>(sway, rates, rate);
            seen.as_ref().to_vec()
        };
        let (sway, impacts) = (self.before.sway, self.before.impacts);
        let (link, sway_after) = (self.before.link, chain.sway_after(sway, 1));
        let after = self.after.unwrap_or(link);
        let unit_n_s = chain.mass_unit_kg() * chain.length_m() * self.rate_before_rad_s.abs();
        let impulses = chain.hinge_impulses(impacts + 1, sway_after);
        Impact {
            sway_before: sway,
            strikes_wall: sway_after == sway,
            restitution: self.after.map_or(0.0, |link| link.restitution),
            energy_before_j: energy_before * joule,
            energy_after_j: energy_after * joule,
            friction_j: None,
            rates_before_rad_s: rates(link, sway, self.rate_before_rad_s),
            rates_after_rad_s: rates(after, sway_after, self.rate_after_rad_s),
            closed: chain.hinges(impacts, sway),
            opened: chain.hinges(impacts + 1, sway_after),
            impulses_n_s: impulses.into_iter().map(|i| i * unit_n_s).collect(),
        }
    }
}

/// Collects the data of a summary, and takes samples for a recorder.
struct SummaryCollector<'r, 'a, C: MechanismChain> {
    rocking: &'r Rocking<'a, C>,
    sampler: Option<Sampler<'r, 'a, C>>,
    impacts: usize,
    /// Largest rotations of the bodies, and largest rotation over the critical one.
    peaks: (Vec<f64>, f64),
    /// Largest sums of the masses times their horizontal displacements.
    shifts_kg_m: Sides<f64>,
    /// Largest excess of the thrust line up to now, over the thickness, at rotations below the critical one.
    excess_ratio: f64,
    /// Largest excess of the thrust line up to the largest rotation.
    excess_at_peak: f64,
    /// Time of the last outward passage of the unstable equilibrium, and the peaks up to then.
    last_passage: Option<(f64, (Vec<f64>, f64))>,
    last_rest_s: Option<f64>,
    /// Initial energy minus the energy dissipated by impacts.
    energy_without_work: f64,
    largest_defect: f64,
    friction: FrictionCollector<'a, C>,
}

impl<'a, C: MechanismChain> SummaryCollector<'_, 'a, C> {
    /// Records the state at the start, which may be a release.
    fn note_start(&mut self, mode: Mode<'a, C::Mechanism>, state: RockingState) {
        if C::THRUSTS {
            self.note_demand(&StructureState::<'a, C>::start(mode, state), true);
        }
        self.note_peak(mode, &state);
    }

    /// Updates the peaks. All rotations increase with `q`, so the largest occur at its turning points, at the start or at the end.
    fn note_peak(&mut self, mode: Mode<'_, C::Mechanism>, state: &RockingState) {
        if let Some(Swing { sway, link, .. }) = mode.swing() {
            let rotations = seen_from_ground::<C>(sway, link.mechanism.rotations(state[0]), 1.0);
            let (peaks, over_critical) = &mut self.peaks;
            for (peak, rotation) in peaks.iter_mut().zip(rotations.as_ref()) {
                *peak = peak.max(rotation.abs());
            }
            let unit_kg_m = self.rocking.chain.mass_unit_kg() * self.rocking.chain.length_m();
            let shift_kg_m = link.mechanism.displacement(state[0]).x * unit_kg_m;
            let largest_kg_m = self.shifts_kg_m.to_mut(sway);
            *largest_kg_m = largest_kg_m.max(shift_kg_m);
            let reached = state[0] / link.critical_rad;
            self.friction.note_rotation(reached);
            if reached > *over_critical {
                *over_critical = reached;
                self.excess_at_peak = self.excess_ratio;
            }
        }
    }

    /// Largest excess of the thrust line up to overturning, or else up to the largest rotation.
    const fn excess_of(&self, outcome: Outcome) -> f64 {
        match outcome {
            Outcome::Overturned(_) => self.excess_ratio,
            _ => self.excess_at_peak,
        }
    }

    /// Mechanism of a structure that rocks with more than a quarter of the energy barrier, or beyond its unstable equilibrium.
    fn energetic_swing(&self, now: &StructureState<'a, C>) -> Option<Swing<'a, C::Mechanism>> {
        let rocking = self.rocking;
        let rocks = |swing: &Swing<'a, C::Mechanism>| {
            now.state[0] >= swing.link.critical_rad
                || rocking.energy(swing.link, &now.state) > SAFE * rocking.barrier_ahead(*swing)
        };
        match now.mode {
            Phase::Rocking(swing) => Some(swing).filter(rocks),
            Phase::Rest | Phase::Overturned(_) => None,
        }
    }

    /// [`Rocking::energy_over_barriers`] of a structure that rocks with more than a quarter of the energy barrier.
    fn remaining_over_barrier(&self, now: &StructureState<'a, C>) -> Option<f64> {
        let (swing, defect) = (self.energetic_swing(now)?, self.largest_defect);
        self.rocking.energy_over_barriers(swing, &now.state, defect)
    }

    /// Whether a structure may still overturn on quiet ground: it rocks with more than a quarter of the energy barrier, and the barriers of
    /// the mechanisms that may follow do not prevent it.
    fn may_overturn(&self, now: &StructureState<'a, C>) -> bool {
        let remaining = || self.remaining_over_barrier(now);
        self.energetic_swing(now).is_some() && remaining().is_none_or(|ratio| ratio >= 1.0)
    }

    /// Updates the largest friction demand and, if it `follows` the thrust line, the largest excess.
    fn note_demand(&mut self, now: &StructureState<'a, C>, follows: bool) {
        let Phase::Rocking(swing) = now.mode else {
            return;
        };
        let is_below_critical = now.state[0] < swing.link.critical_rad;
        let demand = self.rocking.demand_at_sections(swing, now);
        (self.friction).add_demand(now.time_s, demand.friction, is_below_critical);
        if follows && is_below_critical {
            self.excess_ratio = self.excess_ratio.max(demand.excess_ratio);
        }
    }

    fn check_energy(&mut self, mode: Mode<'_, C::Mechanism>, state: &RockingState) {
        if let Phase::Rocking(Swing { link, .. }) = mode {
            let defect = self.rocking.energy(link, state) - self.energy_without_work - state[2];
            self.largest_defect = self.largest_defect.max(defect.abs());
        }
    }

    /// Records turning points, passages of the unstable equilibrium, and demands in a step.
    ///
    /// The excess of the thrust line is largest near impacts, at corners of the ground motion, and where the ground pushes most. Steps begin and end
    /// there, and are short compared with the motion between. After the largest rotation the excess does not count, so it is not computed once no
    /// larger one can follow; the friction demand is not computed once no half cycle can reach half of it.
    fn note_step(&mut self, from: &StructureState<'a, C>, step: &IntegratorStep<3>) {
        let mode = from.mode;
        let Phase::Rocking(swing @ Swing { link, .. }) = mode else {
            self.note_rest(from, step);
            return;
        };
        let rocking = self.rocking;
        let start = from.at(step.start_s, &step.start);
        let stays_below = |over_critical: f64| rocking.stays_below(over_critical, swing, &start);
        let is_strong = !stays_below(STRONG * self.peaks.1);
        let follows = C::THRUSTS && is_strong && !stays_below(self.peaks.1);
        if is_strong && step.start_s == from.time_s {
            self.note_demand(&start, follows);
        }
        // The first step after uplift starts at zero rate, and may contain a turning point.
        if step.start[1] >= 0.0 && step.end[1] <= 0.0 {
            let bend = step.end_slope[1] - step.start_slope[1];
            let turn_s = falling_root(step.start_s, step.end_s, |time_s| {
                let part = bend * (time_s - step.start_s) / (step.end_s - step.start_s);
                (
                    rocking.interpolate(step, time_s)[1],
                    step.start_slope[1] + part,
                )
            });
            let turned = from.at(turn_s, &rocking.interpolate(step, turn_s));
            if is_strong {
                self.note_demand(&turned, follows);
            }
            self.note_peak(mode, &turned.state);
            self.check_energy(mode, &step.end);
        }
        if step.start[0] < link.critical_rad && step.end[0] >= link.critical_rad {
            let passage_s = falling_root(step.start_s, step.end_s, |time_s| {
                let state = rocking.interpolate(step, time_s);
                (link.critical_rad - state[0], -state[1])
            });
            self.note_peak(mode, &rocking.interpolate(step, passage_s));
            self.last_passage = Some((passage_s, self.peaks.clone()));
        }
        if is_strong {
            for time_s in instants(rocking, swing, step) {
                self.note_demand(&from.at(time_s, &rocking.interpolate(step, time_s)), false);
            }
            self.note_demand(&from.at(step.end_s, &step.end), follows);
        }
    }

    /// Records the demand at rest, which is largest at an end of the step, or at an end of the piece of the ground motion.
    fn note_rest(&mut self, from: &StructureState<'a, C>, step: &IntegratorStep<3>) {
        if let Phase::Rest = from.mode {
            for (time_s, state) in [(step.start_s, &step.start), (step.end_s, &step.end)] {
                self.friction
                    .note_rest(self.rocking, &from.at(time_s, state));
            }
        }
    }
}

impl<'a, C: MechanismChain> Observer<Rocking<'a, C>, 3> for SummaryCollector<'_, 'a, C> {
    fn step(&mut self, from: &StructureState<'a, C>, step: &IntegratorStep<3>) -> ControlFlow<()> {
        self.note_step(from, step);
        let sampler = self.sampler.as_mut();
        sampler.map_or(ControlFlow::Continue(()), |one| one.step(from, step))
    }

    fn transition(&mut self, transition: &RockingTransition<'a, C>) -> ControlFlow<()> {
        self.check_energy(transition.from, &transition.before);
        let rests = matches!(transition.to, Phase::Rest);
        if let Some(closing) = Closing::of(self.rocking.chain, transition) {
            let (before, after) = closing.energies();
            self.energy_without_work -= before - if rests { 0.0 } else { after };
            self.impacts += 1;
            self.friction.end_half_cycle();
        }
        if let Phase::Rest = transition.from {
            self.friction.end_rest(self.rocking);
        }
        if rests {
            self.last_rest_s = Some(transition.time_s);
            // At rest the energy is zero, so the remaining balance is the accumulated error.
        }
        let Some(sampler) = &mut self.sampler else {
            return ControlFlow::Continue(());
        };
        sampler.phase += 1;
        sampler.recorder.event(&event(self.rocking, transition))
    }
}

fn event<'a, C: MechanismChain>(
    rocking: &Rocking<'a, C>,
    transition: &RockingTransition<'a, C>,
) -> Event {
    let kind = match (transition.guard, transition.to) {
        (Guard::Uplift(_), _) => EventKind::Uplift,
        (Guard::Closing, Phase::Rest) => EventKind::Rest,
        (Guard::Closing, _) => EventKind::Impact,
        (Guard::Critical | Guard::Limit, _) => EventKind::Overturned,
    };
    let chain = rocking.chain;
    let (rotations_rad, rates_rad_s) = posture(rocking, transition.to, &transition.after);
    let swing = transition.to.swing();
    let energy = swing.map_or(0.0, |swing| rocking.energy(swing.link, &transition.after));
    Event {
        mechanism: swing.map(|swing| swing.impacts),
        rotations_rad: rotations_rad.as_ref().to_vec(),
        rates_rad_s: rates_rad_s.as_ref().to_vec(),
        energy_j: energy * chain.joules_per_unit(),
        hinges: swing.map_or(Vec::new(), |swing| chain.hinges(swing.impacts, swing.sway)),
        impact: Closing::of(chain, transition).map(|closing| closing.impact(chain)),
        ..Event::new(transition.time_s, kind, state(transition.to))
    }
}
