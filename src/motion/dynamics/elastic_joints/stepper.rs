//! Steps, reports and evaluates parallel motions.

use std::cell::OnceCell;

use nalgebra::{Vector2, Vector3};

use super::motion::{
    ElasticMotion, GroundActivity, Observation, SlidingSupport, Step, joint_bodies,
};
use super::stillness::Stillness;
use crate::dynamics::ground::FeetApart;
use crate::dynamics::history::{JointPressure, Stress};
use crate::dynamics::recorder::Recorder;
use crate::dynamics::repeatability::LARGEST_LOSS_RATIO;
use crate::dynamics::row::clock::Marks;
use crate::dynamics::row::observer::{OVERTURNED_RAD, OVERTURNED_RATIO, REST_ENERGY_RATIO};
use crate::dynamics::row::stepper::{equal_step, open_hinge};
use crate::dynamics::until::{EndCondition, comparable_slip_m};
use crate::dynamics::{
    EventKind, GroundVelocity, MotionInput, MotionObserver, RowMotionError, Sample, Sliding,
    Stepper, Summary, TieSample,
};
use crate::mechanics::{Edge, ElasticStructure, Equilibrium, Hinge, Lanes, Pose, Row, Supports};

/// Number of steps between observations of a motion: one to four periods of the fastest vibration. The structure rocks much more slowly.
const STRIDE: u64 = 16;
/// Energy, over the elastic energy under self-weight, below which a row only vibrates: by less than a third of the deflection under self-weight.
const VIBRATION_STRAIN_RATIO: f64 = 0.1;
/// Energy, over the barrier of the first mechanism, below which a row only vibrates.
const VIBRATION_BARRIER_RATIO: f64 = 0.03;
/// Energy, over the barrier, below which a row on quiet ground cannot overturn.
const SAFE: f64 = 0.5;
/// Energy, over the largest one up to now, below which no block exceeds its largest rotation.
const DECAYED: f64 = 0.25;
/// Factor by which energy is assumed to decay more slowly than up to now.
const SLOWER: f64 = 4.0;
/// Longest observation of a row that cannot overturn, to predict whether it comes to rest, over the duration of small energy at rest.
const OBSERVED_RESTS: f64 = 8.0;
/// Duration of vibration alone after which a motion is calm, over the duration of small energy at rest. A row that comes to rest soon has then done
/// so.
const CALM_RESTS: f64 = 4.0;
/// Sway, over the mean displacement under self-weight, below which the side of the motion does not change.
const SIDE_RATIO: f64 = 0.1;
/// Part of a joint in contact below which the joint is drawn as a hinge.
const HINGE_RATIO: f64 = 0.5;

/// One motion of a group.
struct Lane<'a> {
    observer: MotionObserver<'a>,
    until: EndCondition,
    velocity: GroundVelocity<'a>,
    /// Relative motion of the feet, and their current relative displacement; `None` if both feet move alike.
    feet: Option<FeetApart<'a>>,
    feet_apart_m: Vector2<f64>,
    quiet_from_s: f64,
    /// Time up to which the lane steps without interruption, in seconds.
    until_s: f64,
    /// True if the current position has been observed.
    is_observed: bool,
    /// Time up to which the kicks have been applied, and ground velocity at this time.
    kicked_s: f64,
    ground_m_s: Vector2<f64>,
    monitor: MotionMonitor,
    /// Barrier with rigid joints in J, if known; otherwise that with elastic joints, once computed.
    barrier_j: Option<f64>,
    /// Last time at which the row moved more than by vibration, in seconds.
    quiet_since_s: f64,
    stillness: Stillness,
    marks: Marks,
    /// Error that ends the motion.
    error: Option<RowMotionError>,
    /// Events of ties since the last observation.
    tie_events: Vec<(usize, EventKind)>,
}

/// Observations of a motion up to now.
#[derive(Default)]
struct MotionMonitor {
    /// Potential and elastic energy at the start, and kinetic energy, in J; `None` before the first observation.
    start_j: Option<(f64, f64)>,
    rest_sway_kg_m: f64,
    /// Gaps above which a joint counts as open, at intrados and extrados, in m; empty before the first observation, at rest.
    opening_m: Vec<[f64; 2]>,
    /// Largest energy of a row that only vibrates, in J.
    vibration_j: f64,
    /// Largest energy, in J.
    largest_j: f64,
    /// True while the centre of gravity moves back to its position at rest.
    moves_back: bool,
    /// Time and energy of the first observation on quiet ground.
    quiet: Option<(f64, f64)>,
}

/// Group of parallel motions.
pub struct Group<'a, const L: usize> {
    row: &'a Row,
    structure: &'a ElasticStructure,
    /// Equilibrium from which all motions start.
    rest: &'a Equilibrium,
    /// Computes the least energy above that at rest at which the structure overturns without slip, if known. This takes time.
    find_barrier_j: &'a dyn Fn() -> Option<f64>,
    motion: ElasticMotion<'a, L>,
    lanes: [Option<Lane<'a>>; L],
    /// Energy barrier, computed at the first request.
    barrier_j: OnceCell<Option<f64>>,
    /// Supports along which the row may slide as a whole.
    supports: Vec<SlidingSupport>,
}

impl<'a> Lane<'a> {
    fn new(
        input: MotionInput<'a>,
        until: EndCondition,
        recorder: Option<&'a mut dyn Recorder>,
    ) -> Self {
        let velocity = GroundVelocity::new(input.ground);
        let start_s = input.ground.start_s();
        Self {
            until,
            ground_m_s: velocity.at(start_s),
            velocity,
            feet: FeetApart::of(input.row, input.ground),
            feet_apart_m: Vector2::zeros(),
            quiet_from_s: input.ground.end_s(),
            until_s: start_s,
            is_observed: false,
            kicked_s: start_s,
            monitor: MotionMonitor::default(),
            barrier_j: input.barrier_j,
            quiet_since_s: start_s,
            stillness: Stillness::new(
                input.undeformed_barrier_j,
                REST_ENERGY_RATIO * input.row.mass_kg() * input.gravity_m_s2 * input.row.size_m,
            ),
            marks: Marks::new(input.settings, start_s),
            error: None,
            tie_events: Vec::new(),
            observer: MotionObserver::new(input, None, recorder),
        }
    }

    /// Advances the clock by one step, and returns the step.
    fn next(&mut self, damping_time_s: f64) -> Step<Lanes<1>> {
        let step_s = equal_step(
            self.observer.time,
            self.until_s,
            self.observer.longest_step_s,
        );
        let to_s = self.observer.time + 0.5 * step_s;
        let (mut step, ground_m_s) = self.kick(to_s);
        step.drift_s = Lanes([step_s]);
        step.damping = Lanes([damping_time_s / step_s]);
        (self.kicked_s, self.ground_m_s) = (to_s, ground_m_s);
        // Set the end of the last of equal steps exactly, without rounding error.
        let left_s = self.until_s - self.observer.time;
        self.observer.time = if step_s > 0.75 * left_s {
            self.until_s
        } else {
            self.observer.time + step_s
        };
        if let Some(feet) = &mut self.feet {
            let feet_apart_m = feet.at(self.observer.time);
            let by_m = feet_apart_m - self.feet_apart_m;
            step.feet_apart_change_m = [Lanes([by_m.x]), Lanes([by_m.y])];
            self.feet_apart_m = feet_apart_m;
        }
        self.observer.cost.steps += 1;
        self.is_observed = false;
        step
    }

    /// Returns a kick up to `to_s`, and the ground velocity at this time, which is constant once the ground is quiet.
    fn kick(&self, to_s: f64) -> (Step<Lanes<1>>, Vector2<f64>) {
        let ground_m_s = if self.is_shaken() {
            self.velocity.at(to_s)
        } else {
            self.ground_m_s
        };
        let shift = ground_m_s - self.ground_m_s;
        let step = Step {
            kick_s: Lanes([to_s - self.kicked_s]),
            ground_change_m_s: [Lanes([shift.x]), Lanes([shift.y])],
            ..Step::none()
        };
        (step, ground_m_s)
    }

    fn is_shaken(&self) -> bool {
        self.kicked_s < self.quiet_from_s
    }

    fn ends_stride(&self) -> bool {
        self.observer.cost.steps.is_multiple_of(STRIDE)
    }

    fn is_due(&self) -> bool {
        self.ends_stride() || self.observer.time >= self.until_s
    }

    /// Returns whether a joint is open beyond its state at rest, by more than the largest penetration under self-weight.
    fn is_open(&mut self, penetrations_m: impl Iterator<Item = [f64; 2]>) -> bool {
        if self.monitor.opening_m.is_empty() {
            let at_rest: Vec<[f64; 2]> = penetrations_m.collect();
            let most_m = at_rest.iter().flatten().copied().fold(0.0, f64::max);
            self.observer.elastic.opening_tolerance_m = most_m;
            let opens = |end: f64| (-end).max(0.0) + most_m;
            self.monitor.opening_m = at_rest.iter().map(|ends| ends.map(opens)).collect();
            return false;
        }
        let mut joints = penetrations_m.zip(&self.monitor.opening_m);
        joints.any(|(ends, from)| (0..2).any(|end| -ends[end] > from[end]))
    }

    /// Records open and slipped joints of the lane with this index. Returns the slip of the structure along its supports, in m to the right.
    fn note_joints<const L: usize>(
        &mut self,
        index: usize,
        motion: &ElasticMotion<'_, L>,
        supports: &[SlidingSupport],
    ) -> f64 {
        if self.observer.has_rocked != Some(true) {
            let edges = motion.memories.iter().map(|edges| edges.penetrations_m);
            let edges = edges.take(motion.structure.row_joints().len());
            let is_open = self.is_open(edges.map(|ends| ends.map(|end| end.0[index])));
            let slips =
                self.observer.elastic.friction_j > REST_ENERGY_RATIO * self.observer.energy_unit;
            self.observer.has_rocked = Some(is_open || slips);
        }
        let observer = &mut self.observer;
        let mut slid = 0.0;
        for (joint, with_joint) in motion.structure.row_joints().iter().enumerate() {
            let permanent_slip_m = motion.memories[joint].permanent_slip_m.0[index];
            if let Some(sliding) = &mut observer.row_summary.sliding {
                sliding.friction_j = observer.elastic.friction_j;
                sliding.offsets_m[joint] = permanent_slip_m;
                let largest = &mut sliding.largest_offsets_m[joint];
                *largest = largest.max(permanent_slip_m.abs());
            }
            // A block can slide off a support that ends at the joint: it has fallen after a slip by the length of the joint.
            let on_support = |support: &&SlidingSupport| support.joint == joint && support.extends;
            match supports.iter().find(on_support) {
                Some(support) => slid += permanent_slip_m * support.along_x,
                None => {
                    observer.overturned |= permanent_slip_m.abs() >= with_joint.geometry.length_m
                }
            }
        }
        slid
    }

    /// Records whether the row moves more than by vibration.
    fn note_vibration(&mut self, kinetic_j: f64, potential_j: f64) {
        let most_j = self.monitor.vibration_j;
        let vibrates = kinetic_j < most_j && potential_j < most_j;
        // A row without motion that stands higher than before is held by friction.
        if !vibrates && kinetic_j >= REST_ENERGY_RATIO * self.observer.energy_unit {
            self.quiet_since_s = self.observer.time;
            self.observer.moved = true;
        }
        let since_s = self.quiet_since_s;
        self.observer.elastic.vibrates_since_s = self.lasts(since_s).then_some(since_s);
    }

    /// Returns whether the row has been in a state since this time for long enough, on quiet ground.
    fn lasts(&self, since_s: f64) -> bool {
        self.observer.is_quiet(since_s.max(self.quiet_from_s))
    }

    fn at_rest_since_s(&self) -> Option<f64> {
        let mut since_s = self.quiet_since_s;
        if self.observer.has_rocked == Some(true) {
            since_s = since_s.max(self.stillness.since_s);
        }
        self.lasts(since_s).then_some(since_s)
    }

    /// Ends the motion early if its end condition holds at this energy. On quiet ground a structure gains no energy.
    fn end_early(&mut self, energy_j: f64, barrier_j: impl Fn() -> Option<f64>) {
        if self.observer.time < self.quiet_from_s {
            return;
        }
        let (from_s, quiet_j) = *self
            .monitor
            .quiet
            .get_or_insert((self.observer.time, energy_j));
        let (observed_s, rest_s) = (self.observer.time - from_s, self.observer.rest_time_s());
        // Assume that the energy decays `SLOWER` times more slowly from now on.
        let rate = libm::log(quiet_j / energy_j) / observed_s;
        let rests_s = SLOWER * libm::log(energy_j / self.stillness.limit_j).max(0.0) / rate;
        let rested_s = self.observer.time + rests_s + rest_s;
        let settles = self.until == EndCondition::Settled;
        let rests = settles && rate > 0.0 && rested_s < self.observer.input.settings.end_s;
        // A calm row may still exceed its largest rotation a little, if that is as small.
        let decayed = energy_j < DECAYED * self.monitor.largest_j;
        let may_end = self.is_calm() && (decayed || !settles);
        if may_end && barrier_j().is_some_and(|barrier_j| self.keeps_barrier(barrier_j)) {
            self.observer.decide(rests);
            return;
        }
        // With feet that move apart, the barrier is unknown. A row beyond its barrier falls to that side, with any damping.
        if self.feet.is_some() || !self.monitor.moves_back {
            return;
        }
        let ends = match self.until {
            EndCondition::End | EndCondition::Calm => false,
            EndCondition::Settled => {
                self.observer.moved && decayed && (rests || observed_s > OBSERVED_RESTS * rest_s)
            }
            EndCondition::Safe => true,
        };
        let gone_j = self.observer.elastic.friction_j + self.observer.elastic.crushed_j;
        let is_safe =
            |barrier_j: f64| energy_j < SAFE * barrier_j && gone_j < LARGEST_LOSS_RATIO * barrier_j;
        if ends && barrier_j().is_some_and(is_safe) {
            self.observer.decide(rests);
        }
    }

    /// Returns whether the motion ends because the row has only vibrated for some time, if its barrier is that of the row before.
    fn is_calm(&self) -> bool {
        let ends = self.until != EndCondition::End || self.observer.input.settings.ends_calm();
        let calm_s = CALM_RESTS * self.observer.rest_time_s();
        let since_s = self.quiet_since_s.max(self.quiet_from_s);
        let has_lasted = self.observer.time - since_s > calm_s;
        // A row that stands lower than before may be falling slowly.
        let is_low = self.observer.potential < -self.monitor.vibration_j;
        ends && has_lasted && !is_low && self.feet.is_none() && self.at_rest_since_s().is_none()
    }

    /// Returns whether crushing and slip have hardly changed the barrier. A row that has crushed may continue to crush, and fall without much energy.
    fn keeps_barrier(&self, barrier_j: f64) -> bool {
        let (row, summary) = (self.observer.input.row, &self.observer.row_summary);
        let slips_little = |sliding: &Sliding| sliding.largest_m() < comparable_slip_m(row);
        let lost_j = LARGEST_LOSS_RATIO * barrier_j;
        self.observer.elastic.crushed_j < lost_j
            && (self.observer.elastic.friction_j < lost_j
                || summary.sliding.as_ref().is_none_or(slips_little))
    }
}

impl<'a, const L: usize> Group<'a, L> {
    pub fn new(
        row: &'a Row,
        (structure, rest): (&'a ElasticStructure, &'a Equilibrium),
        gravity_m_s2: f64,
        find_barrier_j: &'a dyn Fn() -> Option<f64>,
    ) -> Self {
        let [left, right] = row.supports_extend;
        let last = row.joints.len() - 1;
        // At the right support the block is on the left of the joint.
        let support = |joint: usize, sense: f64, extends: bool, part: f64| SlidingSupport {
            joint,
            sense,
            extends,
            along_x: part * sense * row.joints[joint].along().x,
        };
        let supports = match row.supports {
            Supports::Left => vec![support(0, 1.0, left, 1.0)],
            Supports::Both => vec![support(0, 1.0, left, 0.5), support(last, -1.0, right, 0.5)],
        };
        Self {
            row,
            structure,
            rest,
            find_barrier_j,
            motion: ElasticMotion::new(structure, gravity_m_s2),
            lanes: [const { None }; L],
            barrier_j: OnceCell::new(),
            supports,
        }
    }

    /// Starts a motion in a lane, at rest or with velocities of the blocks.
    pub fn begin(
        &mut self,
        lane: usize,
        (input, velocities): (MotionInput<'a>, &[Vector3<f64>]),
        until: EndCondition,
        recorder: Option<&'a mut dyn Recorder>,
    ) {
        self.motion.start(lane, self.rest);
        self.motion.set_velocities(lane, velocities);
        let mut begun = Lane::new(input, until, recorder);
        let weighted = self
            .row
            .blocks
            .iter()
            .zip(&self.rest.self_weight_displacements);
        let moved = weighted.map(|(block, moved)| block.mass_kg * libm::hypot(moved[0], moved[1]));
        let moved_kg_m: f64 = moved.sum();
        let none = || Sliding::none(self.structure.row_joints().len());
        begun.observer.row_summary.sliding = self.structure.slips().then(none);
        begun.observer.least_sway_kg_m =
            begun.observer.least_sway_kg_m.max(SIDE_RATIO * moved_kg_m);
        self.lanes[lane] = Some(begun);
        let observation = self.motion.observe(&Step::none(), &self.supports);
        self.note(lane, &observation);
    }

    /// Returns whether motions may start: where all other lanes are between strides. Most lanes are then observed at the same steps.
    pub fn may_begin(&self) -> bool {
        let mut lanes = self.lanes.iter().flatten();
        lanes.all(Lane::ends_stride)
    }

    /// Steps all lanes until at least one motion has been observed.
    pub fn stride(&mut self) {
        let damping_time_s = self.structure.damping_time_s;
        loop {
            let mut step = Step::none();
            let (mut activity, mut due) = (GroundActivity::default(), false);
            for (index, lane) in self.lanes.iter_mut().enumerate() {
                let Some(lane) = lane else {
                    continue;
                };
                activity.ground_moves |= lane.is_shaken();
                activity.feet_move_apart |=
                    lane.feet.is_some() && lane.observer.time < lane.quiet_from_s;
                step.set(index, &lane.next(damping_time_s));
                due |= lane.is_due();
            }
            self.motion.step(&step, activity);
            if due {
                break;
            }
        }
        let half = self.half_kick();
        let observation = self.motion.observe(&half, &self.supports);
        for index in 0..L {
            if self.lanes[index].as_ref().is_some_and(Lane::is_due) {
                self.note(index, &observation);
            }
        }
    }

    /// Returns the half kick from the velocities to the positions.
    fn half_kick(&self) -> Step<Lanes<L>> {
        let mut half = Step::none();
        for (index, lane) in self.lanes.iter().enumerate() {
            if let Some(lane) = lane {
                half.set(index, &lane.kick(lane.observer.time).0);
            }
        }
        half
    }

    /// Records the observed quantities of the motion of a lane.
    fn note(&mut self, index: usize, observation: &Observation<Lanes<L>>) {
        let (motion, supports) = (&self.motion, &self.supports);
        let Some(lane) = &mut self.lanes[index] else {
            return;
        };
        let of = |lanes: Lanes<L>| lanes.0[index];
        let observer = &mut lane.observer;
        lane.is_observed = true;
        let time = observer.time;
        let (kinetic, elastic) = (of(observation.kinetic_j), of(observation.elastic_j));
        let stored = of(observation.potential_j) + elastic;
        if !(kinetic.is_finite() && stored.is_finite()) {
            lane.error = Some(RowMotionError::Failed(format!(
                "at {time} s the motion has grown beyond all numbers: give a shorter longest_step_s"
            )));
            return;
        }
        let (rest_j, start_j) = *lane.monitor.start_j.get_or_insert_with(|| {
            lane.monitor.vibration_j = (REST_ENERGY_RATIO * observer.energy_unit)
                .max(VIBRATION_STRAIN_RATIO * elastic)
                .max(VIBRATION_BARRIER_RATIO * lane.barrier_j.unwrap_or(0.0));
            lane.monitor.rest_sway_kg_m = of(observation.sway_kg_m);
            (stored, kinetic)
        });
        let energies = &observation.energies;
        observer.elastic.elastic_j = elastic;
        observer.elastic.damped_j = of(energies.damped_j);
        observer.elastic.friction_j = of(energies.friction_j);
        observer.elastic.crushed_j = of(energies.crushed_j);
        observer.elastic.ties_j = of(energies.ties_j);
        let dissipated_with = |friction_j: f64| {
            let joints_j = observer.elastic.damped_j + friction_j + observer.elastic.crushed_j;
            joints_j + observer.elastic.ties_j
        };
        // The energy balance uses the slip of the discrete motion; the work of friction is an estimate of it.
        let dissipated_j = dissipated_with(of(energies.slip_balance_j));
        observer.row_summary.energy_taken_j = dissipated_with(observer.elastic.friction_j);
        let bound = self.structure.ties.iter().map(|bound| &bound.tie);
        let memories = motion.ties.iter().map(|tie| tie.lane(index));
        lane.tie_events = observer.note_ties(bound.zip(memories));
        let row_summary = &mut observer.row_summary;
        (row_summary.ground_j, row_summary.right_foot_j) =
            (of(energies.ground_j), of(energies.feet_j));
        let potential = stored - rest_j;
        let work_j = row_summary.ground_j + row_summary.right_foot_j;
        observer.note_defect((kinetic + potential - (work_j - dissipated_j) - start_j).abs());
        if of(observation.largest_stress[0]) > observer.elastic.largest_stress.stress_pa {
            observer.elastic.largest_stress = Stress {
                stress_pa: of(observation.largest_stress[0]),
                joint: of(observation.largest_stress[1]) as usize,
                time_s: time,
            };
        }
        // The middle between the feet moves half as far as the right foot.
        let slid = lane.note_joints(index, motion, supports) + 0.5 * lane.feet_apart_m.x;
        let observer = &mut lane.observer;
        let sway =
            of(observation.sway_kg_m) - lane.monitor.rest_sway_kg_m - self.row.mass_kg() * slid;
        let rotations = motion
            .rotations_and_rates(index)
            .map(|(rotation, _)| rotation);
        lane.monitor.moves_back = sway.abs() < observer.sway.abs();
        observer.observe(rotations.clone(), potential, kinetic, sway);
        let peak_rad = observer.largest_rotation_rad();
        lane.stillness
            .note(time, [kinetic, potential], rotations, peak_rad);
        let far = OVERTURNED_RATIO * self.row.size_m;
        observer.overturned |= of(observation.largest_rotation_rad) >= OVERTURNED_RAD
            || of(observation.largest_displacement_m2) >= far * far;
        let height = lane.feet.is_none().then_some(potential + dissipated_j);
        observer.note_height(height);
        lane.note_vibration(kinetic, potential);
        let observer = &mut lane.observer;
        let barrier_j = || *self.barrier_j.get_or_init(self.find_barrier_j);
        let (rigid_j, known_j) = (lane.barrier_j.unwrap_or(0.0), &mut lane.barrier_j);
        let scale_j = || *known_j.get_or_insert_with(|| barrier_j().unwrap_or(0.0));
        observer.halve_unbalanced_steps(rigid_j, scale_j);
        lane.monitor.largest_j = lane.monitor.largest_j.max(kinetic + potential);
        lane.end_early(kinetic + potential, barrier_j);
    }

    /// Continues a lane, or returns the result of its motion if it has ended. The lane then steps without interruption up to the next mark of its
    /// clock, with or without samples.
    pub fn continue_lane(&mut self, index: usize) -> Option<Result<Summary, RowMotionError>> {
        let lane = self.lanes[index].as_mut()?;
        if !lane.is_observed {
            return None;
        }
        if let Some(error) = lane.error.take() {
            self.lanes[index] = None;
            return Some(Err(error));
        }
        let observer = &lane.observer;
        let ending = observer.ending(observer.overturned_s(), || lane.at_rest_since_s());
        if let Some((outcome, time_s)) = ending {
            let Some(end_s) = lane.observer.lengthened_s(outcome) else {
                let mut ended = self.lanes[index].take()?;
                return Some(Ok(ended.observer.end(outcome, time_s)));
            };
            lane.marks.settings.end_s = end_s;
        }
        while lane.marks.is_due(lane.observer.time) {
            lane.marks.pass();
        }
        lane.until_s = lane.marks.next_s();
        None
    }
}

/// Group of a single motion, which may be recorded.
impl<'a> Group<'a, 1> {
    fn lane(&self) -> &Lane<'a> {
        self.lanes[0].as_ref().expect("it was begun")
    }

    fn lane_mut(&mut self) -> &mut Lane<'a> {
        self.lanes[0].as_mut().expect("it was begun")
    }

    fn pose(&self, index: usize) -> Pose {
        let (centre_m, body) = (self.row.blocks[index].centre_m, &self.motion.bodies[index]);
        let moved_m = Vector2::from(body.place.moved_m.map(|part| part.0[0]));
        Pose::about(centre_m, centre_m + moved_m, body.angle_rad.0[0])
    }

    /// Returns the friction coefficient without which joints would slide at this instant.
    fn friction_demand(&self) -> f64 {
        let least_n = self.observer().least_load_n();
        let pressures = (0..self.structure.row_joints().len()).map(|joint| self.pressure(joint));
        let loaded = pressures.filter(|pressure| pressure.normal_n >= least_n);
        let needed = loaded.map(|pressure| pressure.shear_n.abs() / pressure.normal_n);
        needed.fold(0.0, f64::max)
    }

    /// Returns the elastic forces and stresses of a joint.
    fn pressure(&self, index: usize) -> JointPressure {
        let structure = self.structure;
        let joint = &structure.joints[index];
        let [first, second] =
            joint_bodies(structure, joint).map(|body| self.motion.bodies[body].place);
        let memory = self.motion.memories[index].lane(0);
        let mut fibres: Vec<_> = self.motion.fibres(index, 0).collect();
        let (edges_n, shear_n) =
            structure.elastic_n(joint, [&first, &second], &memory, &mut fibres);
        let [low, high] = memory.penetrations_m.map(|end| end.0[0]);
        let normal_n = edges_n[0] + edges_n[1];
        let stiffness_pa_m = joint.normal_n_m / joint.area_m2;
        let contact_ratio = match (low > 0.0, high > 0.0) {
            (true, true) => 1.0,
            (true, false) => low / (low - high),
            (false, true) => high / (high - low),
            (false, false) => 0.0,
        };
        JointPressure {
            normal_n,
            shear_n,
            eccentricity_ratio: (normal_n > 0.0)
                .then(|| 0.5 * (edges_n[1] - edges_n[0]) / normal_n),
            contact_ratio,
            edge_stresses_pa: [low, high]
                .map(|end| stiffness_pa_m * end.clamp(0.0, joint.crushing_penetration_m)),
        }
    }
}

impl<'a> Stepper<'a> for Group<'a, 1> {
    fn observer(&self) -> &MotionObserver<'a> {
        &self.lane().observer
    }

    fn observer_mut(&mut self) -> &mut MotionObserver<'a> {
        &mut self.lane_mut().observer
    }

    /// Takes steps up to the next observation of the motion.
    fn step(&mut self, until: f64) -> Result<(), RowMotionError> {
        let (stood, from_s) = (!self.observer().moved, self.observer().time);
        self.lane_mut().until_s = until;
        self.stride();
        if let Some(error) = self.lane_mut().error.take() {
            return Err(error);
        }
        if self.observer().has_recorder() {
            let demand = self.friction_demand();
            let observer = self.observer_mut();
            observer.note_friction(demand, observer.time - from_s);
        }
        let observer = self.observer_mut();
        if stood && observer.moved {
            let (time_s, energy_j) = (observer.time, observer.potential);
            observer.opened.clear();
            let rotations_and_rates = self.rotations_and_rates().unzip();
            self.report_uplift(time_s, energy_j, rotations_and_rates);
        }
        let tie_events = std::mem::take(&mut self.lane_mut().tie_events);
        self.report_ties(tie_events);
        Ok(())
    }

    fn write(&mut self, sample: &mut Sample, _: bool) -> Result<f64, RowMotionError> {
        let half = self.half_kick();
        let motion = &self.motion;
        for index in 0..self.row.blocks.len() {
            let [.., rate] = motion.velocity(index, &half);
            sample.rates_rad_s.push(rate.0[0]);
        }
        sample.feet_apart_m = self.lane().feet_apart_m;
        let observation = motion.observe(&half, &self.supports);
        for joint in 0..self.structure.row_joints().len() {
            let pressure = self.pressure(joint);
            sample.eccentricity_ratios.push(pressure.eccentricity_ratio);
            sample.pressures.push(pressure);
        }
        sample.demand.friction = self.friction_demand();
        let ties = self.structure.ties.iter().zip(&motion.ties);
        let ties = ties.filter(|(bound, _)| !bound.tie.is_constant_force());
        let ties = ties.map(|(bound, memory)| TieSample::of(&bound.tie, memory));
        sample.ties.extend(ties);
        if let Some(sliding) = &self.observer().row_summary.sliding {
            sample.offsets_m.extend(&sliding.offsets_m);
        }
        Ok(observation.kinetic_j.0[0])
    }

    fn rotations_and_rates(&self) -> impl Iterator<Item = (f64, f64)> {
        self.motion.rotations_and_rates(0)
    }

    fn poses(&self) -> impl Iterator<Item = Pose> {
        (0..self.row.blocks.len()).map(|index| self.pose(index))
    }

    fn gaps(&self, joint: usize) -> [f64; 2] {
        let memory = &self.motion.memories[joint];
        memory.penetrations_m.map(|end| (-end.0[0]).max(0.0))
    }

    /// Returns a joint that is in contact on less than half of its length as a hinge; `None` for other joints.
    fn hinge(&self, joint: usize) -> Option<Hinge> {
        let hinge = open_hinge(joint, self.gaps(joint));
        hinge.filter(|_| self.pressure(joint).contact_ratio < HINGE_RATIO)
    }

    fn corner(&self, joint: usize, edge: Edge) -> Vector2<f64> {
        let geometry = &self.structure.joints[joint].geometry;
        let blocks = &self.row.blocks;
        // The face of the block, or of the first of two.
        let end = usize::from(geometry.bodies[0] >= blocks.len());
        let corner_m = self.row.joints[joint].corner_m(edge);
        self.pose(geometry.bodies[end]).of(corner_m)
    }

    fn momentum(&self) -> Vector2<f64> {
        self.motion.momentum(0).into()
    }

    fn stands(&self, _: &Sample) -> bool {
        !self.observer().moved || self.at_rest_since_s().is_some()
    }

    fn at_rest_since_s(&self) -> Option<f64> {
        self.lane().at_rest_since_s()
    }
}
