//! Steps, reports and evaluates parallel motions.

use std::cell::OnceCell;

use nalgebra::{Vector2, Vector3};

use super::lane::Lane;
use super::motion::{
    ElasticMotion, ElasticStep, GroundActivity, Observation, SlidingSupport, joint_bodies,
};
use crate::dynamics::history::{JointPressure, Stress};
use crate::dynamics::recorder::Recorder;
use crate::dynamics::row::observer::{OVERTURNED_RAD, OVERTURNED_RATIO, REST_ENERGY_RATIO};
use crate::dynamics::row::stepper::open_hinge;
use crate::dynamics::until::EndCondition;
use crate::dynamics::{
    MotionInput, MotionObserver, RowMotionError, Sample, Sliding, Stepper, Summary, TieSample,
};
use crate::mechanics::{Edge, ElasticStructure, Equilibrium, Hinge, Lanes, Pose, Row, Supports};

/// Energy, over the elastic energy under self-weight, below which a row only vibrates: by less than a third of the deflection under self-weight.
const VIBRATION_STRAIN_RATIO: f64 = 0.1;
/// Energy, over the barrier of the first mechanism, below which a row only vibrates.
const VIBRATION_BARRIER_RATIO: f64 = 0.03;
/// Sway, over the mean displacement under self-weight, below which the side of the motion does not change.
const SIDE_RATIO: f64 = 0.1;
/// Part of a joint in contact below which the joint is drawn as a hinge.
const HINGE_RATIO: f64 = 0.5;

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
            along_x: part * sense * row.joints[joint].direction().x,
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
    pub fn begin_motion(
        &mut self,
        lane: usize,
        (input, velocities): (MotionInput<'a>, &[Vector3<f64>]),
        until: EndCondition,
        recorder: Option<&'a mut dyn Recorder>,
    ) {
        self.motion.start_from_rest(lane, self.rest);
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
        let observation = self.motion.observe(&ElasticStep::none(), &self.supports);
        self.record_lane(lane, &observation);
    }

    /// Whether motions may start: where all other lanes are between strides. Most lanes are then observed at the same steps.
    pub fn may_begin(&self) -> bool {
        let mut lanes = self.lanes.iter().flatten();
        lanes.all(Lane::ends_stride)
    }

    /// Steps all lanes until at least one motion has been observed.
    pub fn stride(&mut self) {
        let damping_time_s = self.structure.damping_time_s;
        loop {
            let mut step = ElasticStep::none();
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
                self.record_lane(index, &observation);
            }
        }
    }

    /// Half kick from the velocities to the positions.
    fn half_kick(&self) -> ElasticStep<Lanes<L>> {
        let mut half = ElasticStep::none();
        for (index, lane) in self.lanes.iter().enumerate() {
            if let Some(lane) = lane {
                half.set(index, &lane.kick(lane.observer.time).0);
            }
        }
        half
    }

    /// Records the observed quantities of the motion of a lane.
    fn record_lane(&mut self, index: usize, observation: &Observation<Lanes<L>>) {
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
            .record_step(time, [kinetic, potential], rotations, peak_rad);
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

    /// Friction coefficient without which joints would slide at this instant.
    fn friction_demand(&self) -> f64 {
        let least_n = self.observer().least_load_n();
        let pressures = (0..self.structure.row_joints().len()).map(|joint| self.pressure(joint));
        let loaded = pressures.filter(|pressure| pressure.normal_n >= least_n);
        let needed = loaded.map(|pressure| pressure.shear_n.abs() / pressure.normal_n);
        needed.fold(0.0, f64::max)
    }

    /// Elastic forces and stresses of a joint.
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
        let ties = self
            .structure
            .ties
            .iter()
            .zip(&motion.ties)
            .filter(|(bound, _)| !bound.tie.is_constant_force())
            .map(|(bound, memory)| TieSample::of(&bound.tie, memory));
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

    /// Joint that is in contact on less than half of its length as a hinge; `None` for other joints.
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
        self.pose(geometry.bodies[end]).current_position(corner_m)
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
