//! Motion of bodies with elastic joints, several motions in parallel, by the leapfrog method.

use nalgebra::Vector3;
use pulp::{Arch, Simd, WithSimd};

use crate::mechanics::elastic_joint::{BodyPosition, ElasticJoint, Fibre, Gap, Memory};
use crate::mechanics::lanes::{both, remembered};
use crate::mechanics::{Block, ElasticStructure, Equilibrium, Lanes, Real, TieMemory};

/// Moving body.
#[derive(Clone, Copy)]
pub struct BodyState<R> {
    pub place: BodyPosition<R>,
    pub angle_rad: R,
    /// Velocity of the centre half a step before, in m/s, and rotation rate.
    velocity_m_s: [R; 2],
    rate_rad_s: R,
    /// Force and moment at the current position.
    force_n: [R; 2],
    moment_n_m: R,
}

remembered!(BodyState { angle_rad, rate_rad_s, moment_n_m; velocity_m_s, force_n; place: BodyPosition });

impl<R: Real> BodyState<R> {
    /// Adds a force and a moment.
    #[inline(always)]
    fn add_force(&mut self, force_n: [R; 2], moment_n_m: R) {
        let before = self.force_n;
        self.force_n = both!(i: before[i] + force_n[i]);
        self.moment_n_m += moment_n_m;
    }
}

/// Indices of the bodies of a joint; the supports are the last two bodies.
#[inline(always)]
pub fn joint_bodies(structure: &ElasticStructure, joint: &ElasticJoint) -> [usize; 2] {
    let right = structure.bodies.len() + 1;
    both!(end: joint.geometry.bodies[end].min(right))
}

/// Parallel motions, one per lane. Lanes do not affect each other.
pub struct ElasticMotion<'a, const L: usize> {
    pub structure: &'a ElasticStructure,
    gravity_m_s2: f64,
    arch: Arch,
    /// Bodies, then the left and the right support.
    pub bodies: Vec<BodyState<Lanes<L>>>,
    /// Reference displacements and rotations of the bodies: those at rest if the supports have moved, otherwise zero.
    datum: Vec<[f64; 3]>,
    /// Inverse of the mass, and of the moment of inertia, of each body.
    inverses: Vec<[f64; 2]>,
    pub memories: Vec<Memory<Lanes<L>>>,
    /// Gaps and forces of a group of joints.
    forces: [JointForces<Lanes<L>>; JOINTS_PER_GROUP],
    /// States of crushing at the positions along the joints, joint by joint.
    fibres: Vec<Fibre<Lanes<L>>>,
    pub ties: Vec<TieMemory<Lanes<L>>>,
    energies: EnergyTerms<Lanes<L>>,
}

/// Number of joints whose forces are computed as a group. Each part of the contact law is computed for the whole group before the next part. The
/// iterations of such short loops are independent, so the processor executes several in parallel; larger groups exceed its cache.
const JOINTS_PER_GROUP: usize = 12;

/// Gap and forces of a joint.
#[derive(Clone, Copy)]
struct JointForces<R> {
    gap: Gap<R>,
    edges_n: [R; 2],
    shear_n: R,
}

remembered!(JointForces { shear_n; edges_n; gap: Gap });

/// Energies dissipated and work done since the start, in J.
#[derive(Clone, Copy, Debug)]
pub struct EnergyTerms<R> {
    pub friction_j: R,
    /// Energy lost by slip in the balance of the discrete motion, in J.
    pub slip_balance_j: R,
    pub damped_j: R,
    pub crushed_j: R,
    /// Energy dissipated by yield and break of ties, in J.
    pub ties_j: R,
    /// Work of the moving ground, in J.
    pub ground_j: R,
    /// Work of the right support due to its motion relative to the left one, in J.
    pub feet_j: R,
}

remembered!(EnergyTerms {
    friction_j,
    slip_balance_j,
    damped_j,
    crushed_j,
    ties_j,
    ground_j,
    feet_j
});

/// Step of all lanes. A lane with zero values does not change.
#[derive(Clone, Copy)]
pub struct ElasticStep<R> {
    /// Time between successive positions, in s.
    pub drift_s: R,
    /// Time between successive velocities, in s.
    pub kick_s: R,
    /// Damping time over the drift time.
    pub damping: R,
    /// Change of the ground velocity during the kick, in m/s.
    pub ground_change_m_s: [R; 2],
    /// Displacement of the right support relative to the left one in the drift, in m.
    pub feet_apart_change_m: [R; 2],
}

remembered!(ElasticStep { drift_s, kick_s, damping; ground_change_m_s, feet_apart_change_m });

/// Movements of the ground in a step of any lane. Absent movements are not computed.
#[derive(Clone, Copy, Default)]
pub struct GroundActivity {
    /// True if the ground shakes.
    pub ground_moves: bool,
    /// True if the feet move differently.
    pub feet_move_apart: bool,
}

/// Support along whose joint the whole structure may slide.
pub struct SlidingSupport {
    pub joint: usize,
    /// 1 if the structure is after the joint, -1 if it is before.
    pub sense: f64,
    /// True if the support extends beyond the joint.
    pub extends: bool,
    /// Displacement of the centre of gravity to the right for a unit slip of the joint.
    pub along_x: f64,
}

/// Quantities of the motions at one time.
#[derive(Clone, Copy)]
pub struct Observation<R> {
    pub kinetic_j: R,
    /// Potential energy of gravity above the undeformed structure, in J.
    pub potential_j: R,
    pub elastic_j: R,
    pub energies: EnergyTerms<R>,
    /// Horizontal displacement of the centre of gravity times the mass, in kg m.
    pub sway_kg_m: R,
    /// Square of the largest displacement of a body, without the slip of the structure along either support, in m2.
    pub largest_displacement_m2: R,
    /// Largest rotation of a body, in radians.
    pub largest_rotation_rad: R,
    /// Largest compressive stress in Pa, and the index of its joint.
    pub largest_stress: [R; 2],
}

remembered!(Observation {
    kinetic_j, potential_j, elastic_j, sway_kg_m, largest_displacement_m2, largest_rotation_rad; largest_stress; energies: EnergyTerms
});

impl<'a, const L: usize> ElasticMotion<'a, L> {
    pub fn new(structure: &'a ElasticStructure, gravity_m_s2: f64) -> Self {
        let joints = structure.joints.len();
        let ties = structure
            .ties
            .iter()
            .map(|bound| TieMemory::undeformed(&bound.tie));
        let inverse = |body: &Block| [1.0 / body.mass_kg, 1.0 / body.inertia_kg_m2];
        Self {
            structure,
            gravity_m_s2,
            arch: Arch::new(),
            bodies: vec![BodyState::none(); structure.bodies.len() + 2],
            datum: vec![[0.0; 3]; structure.bodies.len()],
            inverses: structure.bodies.iter().map(inverse).collect(),
            memories: vec![Memory::none(); joints],
            forces: [JointForces::none(); JOINTS_PER_GROUP],
            fibres: vec![Fibre::none(); joints * structure.fibres()],
            ties: ties.collect(),
            energies: EnergyTerms::none(),
        }
    }

    /// Starts the motion of a lane from rest.
    pub fn start_from_rest(&mut self, lane: usize, rest: &Equilibrium) {
        let alone = ElasticMotion::at_rest(self.structure, self.gravity_m_s2, rest);
        if self.structure.has_settled() {
            self.datum.clone_from(&rest.moved);
        }
        for (body, from) in self.bodies.iter_mut().zip(&alone.bodies) {
            body.set(lane, from);
        }
        for (memory, alone) in self.memories.iter_mut().zip(&alone.memories) {
            memory.set(lane, alone);
        }
        for (fibre, alone) in self.fibres.iter_mut().zip(&alone.fibres) {
            fibre.set(lane, alone);
        }
        for (tie, alone) in self.ties.iter_mut().zip(&alone.ties) {
            tie.set(lane, alone);
        }
        self.energies.set(lane, &EnergyTerms::none());
    }

    /// Sets the velocities (m/s) and rotation rates of the bodies of a lane at the time of their positions; without any, it stays at rest.
    pub fn set_velocities(&mut self, lane: usize, velocities: &[Vector3<f64>]) {
        for (body, velocity) in self.bodies.iter_mut().zip(velocities) {
            body.velocity_m_s[0].0[lane] = velocity.x;
            body.velocity_m_s[1].0[lane] = velocity.y;
            body.rate_rad_s.0[lane] = velocity.z;
        }
    }

    /// Takes one step of all lanes, with the widest vectors of the processor. The vector width does not change the results.
    pub fn step(&mut self, step: &ElasticStep<Lanes<L>>, activity: GroundActivity) {
        let arch = self.arch;
        arch.dispatch(LeapfrogStep {
            motion: self,
            step,
            activity,
        });
    }

    #[inline(always)]
    fn leapfrog(&mut self, step: &ElasticStep<Lanes<L>>, activity: GroundActivity) {
        self.kick(step, activity.ground_moves);
        self.drift(step.drift_s);
        if activity.feet_move_apart {
            self.move_right_support(step);
        } else {
            self.update_forces(step.damping);
        }
    }

    /// Moves the right support and computes the forces. The work of the support is the mean of its forces before and after times its displacement.
    #[inline(always)]
    fn move_right_support(&mut self, step: &ElasticStep<Lanes<L>>) {
        let right = self.structure.bodies.len() + 1;
        let by_m = step.feet_apart_change_m;
        let support = &mut self.bodies[right];
        let (before, moved) = (support.force_n, support.place.moved_m);
        support.place.moved_m = both!(i: moved[i] + by_m[i]);
        self.update_forces(step.damping);
        let after = self.bodies[right].force_n;
        let work = both!(i: (before[i] + after[i]) * by_m[i]);
        self.energies.feet_j -= (work[0] + work[1]) * 0.5;
    }

    /// Updates the velocities to half a step after the positions.
    #[inline(always)]
    fn kick(&mut self, step: &ElasticStep<Lanes<L>>, ground_moves: bool) {
        let mut work = Lanes([0.0; L]);
        let constants = &self.structure.bodies;
        let mut index = 0;
        while index < constants.len() {
            let [x, y, rate] = self.velocity(index, step);
            let (after, body) = ([x, y], &mut self.bodies[index]);
            if ground_moves {
                let before = body.velocity_m_s;
                let by_axis = both!(i: (before[i] + after[i]) * step.ground_change_m_s[i]);
                work += (by_axis[0] + by_axis[1]) * (0.5 * constants[index].mass_kg);
            }
            (body.velocity_m_s, body.rate_rad_s) = (after, rate);
            index += 1;
        }
        self.energies.ground_j -= work;
    }

    #[inline(always)]
    fn drift(&mut self, drift_s: Lanes<L>) {
        let mut index = 0;
        while index < self.structure.bodies.len() {
            let body = &mut self.bodies[index];
            index += 1;
            let moved = body.place.moved_m;
            body.place.moved_m = both!(i: moved[i] + body.velocity_m_s[i] * drift_s);
            let angle = body.rate_rad_s * drift_s;
            body.angle_rad += angle;
            body.place.half_turn = turn_angle(body.place.half_turn, angle * 0.5);
        }
    }

    /// Computes the forces at the current positions, and updates the states of the joints.
    #[inline(always)]
    fn update_forces(&mut self, damping: Lanes<L>) {
        let zero = Lanes([0.0; L]);
        let mut index = 0;
        while index < self.bodies.len() {
            let body = &mut self.bodies[index];
            index += 1;
            body.force_n = [zero; 2];
            body.moment_n_m = zero;
        }
        let structure = self.structure;
        let damps = structure.damping_time_s > 0.0;
        let damping = if damps { Some(damping) } else { None };
        let (law, each) = (&structure.law, structure.fibres());
        let (mut friction_j, mut balance_j, mut damped_j, mut crushed_j) = (zero, zero, zero, zero);
        for (part, joints) in structure.joints.chunks(JOINTS_PER_GROUP).enumerate() {
            let first = part * JOINTS_PER_GROUP;
            let memories = &mut self.memories[first..first + joints.len()];
            let forces = &mut self.forces[..joints.len()];
            for (joint, forces) in joints.iter().zip(forces.iter_mut()) {
                let [one, other] = joint_bodies(structure, joint);
                let (one, other) = (&self.bodies[one].place, &self.bodies[other].place);
                forces.gap = joint.geometry.gap(one, other);
            }
            let each_joint = joints.iter().zip(memories.iter_mut()).zip(&mut *forces);
            for (index, ((joint, memory), forces)) in each_joint.enumerate() {
                let from = (first + index) * each;
                let fibres = &mut self.fibres[from..from + each];
                let normal = law.normal_forces(joint, damping, &forces.gap, memory, fibres);
                damped_j += normal.damped_j;
                crushed_j += normal.crushed_j;
                forces.edges_n = normal.edges_n;
            }
            let each_joint = joints.iter().zip(memories.iter_mut()).zip(&mut *forces);
            for ((joint, memory), forces) in each_joint {
                let (gap, edges_n) = (&forces.gap, forces.edges_n);
                let shear = law.shear_force(joint, damping, gap, edges_n, memory);
                friction_j += shear.friction_j;
                balance_j += shear.balance_j;
                damped_j += shear.damped_j;
                forces.shear_n = shear.shear_n;
            }
            for (joint, forces) in joints.iter().zip(&*forces) {
                let (gap, edges_n) = (&forces.gap, forces.edges_n);
                let action = joint.geometry.action(gap, edges_n, forces.shear_n);
                let [one, other] = joint_bodies(structure, joint);
                self.bodies[one].add_force(both!(i: -action.force_n[i]), action.moments_n_m[0]);
                self.bodies[other].add_force(action.force_n, action.moments_n_m[1]);
            }
        }
        self.energies.friction_j += friction_j;
        self.energies.slip_balance_j += balance_j;
        self.energies.damped_j += damped_j;
        self.energies.crushed_j += crushed_j;
        self.add_tie_forces();
    }

    /// Adds the forces of the ties, and updates their states.
    #[inline(always)]
    fn add_tie_forces(&mut self) {
        let ground = self.structure.bodies.len();
        let mut index = 0;
        while index < self.ties.len() {
            let (bound, memory) = (&self.structure.ties[index], &mut self.ties[index]);
            index += 1;
            let [first, second] = both!(end: bound.bodies[end].min(ground + 1));
            let places = [&self.bodies[first].place, &self.bodies[second].place];
            let span = bound.span(places);
            memory.stretch(&bound.tie, span.stretch_m);
            let action = bound.action(places, &span, memory.force_n);
            self.bodies[first].add_force(both!(i: -action.force_n[i]), action.moments_n_m[0]);
            self.bodies[second].add_force(action.force_n, action.moments_n_m[1]);
        }
    }

    /// Computes quantities at the positions, with velocities at the same time after another half kick.
    pub fn observe(
        &self,
        half: &ElasticStep<Lanes<L>>,
        supports: &[SlidingSupport],
    ) -> Observation<Lanes<L>> {
        let arch = self.arch;
        arch.dispatch(
            #[inline(always)]
            || self.observe_lanes(half, supports),
        )
    }

    #[inline(always)]
    fn observe_lanes(
        &self,
        half: &ElasticStep<Lanes<L>>,
        supports: &[SlidingSupport],
    ) -> Observation<Lanes<L>> {
        let structure = self.structure;
        let mut observation = Observation {
            energies: self.energies,
            ..Observation::none()
        };
        for (index, (constants, body)) in structure.bodies.iter().zip(&self.bodies).enumerate() {
            let datum = self.datum[index].map(|part| Lanes([part; L]));
            let (mass, inertia) = (constants.mass_kg, constants.inertia_kg_m2);
            let velocity = self.velocity(index, half);
            let before = [body.velocity_m_s[0], body.velocity_m_s[1], body.rate_rad_s];
            for axis in [0, 1, 2] {
                let half_mass = if axis < 2 { 0.5 * mass } else { 0.5 * inertia };
                observation.kinetic_j += velocity[axis] * velocity[axis] * half_mass;
            }
            for axis in [0, 1] {
                let work = (before[axis] + velocity[axis]) * half.ground_change_m_s[axis];
                observation.energies.ground_j -= work * (0.5 * mass);
            }
            let [x, y] = body.place.moved_m;
            observation.potential_j += y * (mass * self.gravity_m_s2);
            observation.sway_kg_m += x * mass;
            let mut nearest = Lanes([f64::INFINITY; L]);
            for slide in supports {
                let tangent = structure.joints[slide.joint].geometry.tangent;
                let slid = self.memories[slide.joint].permanent_slip_m * slide.sense;
                let of_support = self.support_displacement_m(usize::from(slide.joint > 0));
                let beside = [
                    x - datum[0] - of_support[0] - slid * tangent[0],
                    y - datum[1] - of_support[1] - slid * tangent[1],
                ];
                nearest = nearest.min(beside[0] * beside[0] + beside[1] * beside[1]);
            }
            observation.largest_displacement_m2 = observation.largest_displacement_m2.max(nearest);
            observation.largest_rotation_rad = observation
                .largest_rotation_rad
                .max((body.angle_rad - datum[2]).abs());
        }
        for (bound, memory) in structure.ties.iter().zip(&self.ties) {
            observation.elastic_j += memory.energy_j(&bound.tie);
            observation.energies.ties_j += memory.taken_j;
        }
        let each = structure.fibres();
        for (index, (joint, memory)) in structure.joints.iter().zip(&self.memories).enumerate() {
            let fibres = &self.fibres[index * each..(index + 1) * each];
            observation.elastic_j += structure.energy_j(joint, memory, fibres);
            if index >= structure.row_joints().len() {
                continue;
            }
            let deepest = memory.penetrations_m[0].max(memory.penetrations_m[1]);
            let stress = deepest.min(Lanes([joint.crushing_penetration_m; L]))
                * (joint.normal_n_m / joint.area_m2);
            let more = stress - observation.largest_stress[0];
            observation.largest_stress = [
                more.positive(stress, observation.largest_stress[0]),
                more.positive(Lanes([index as f64; L]), observation.largest_stress[1]),
            ];
        }
        observation
    }

    /// Displacement of a support (0 left, 1 right) since the start, in m.
    #[inline(always)]
    fn support_displacement_m(&self, support: usize) -> [Lanes<L>; 2] {
        let body = &self.bodies[self.structure.bodies.len() + support];
        let rest = &self.structure.supports[support];
        both!(i: body.place.moved_m[i] - Lanes([rest[i]; L]))
    }

    /// Velocity and the rotation rate of a body after another half kick.
    #[inline(always)]
    pub fn velocity(&self, body: usize, half: &ElasticStep<Lanes<L>>) -> [Lanes<L>; 3] {
        let [per_kg, per_kg_m2] = self.inverses[body];
        let moving = &self.bodies[body];
        let [sideways, upwards] = half.ground_change_m_s;
        let fall = [sideways, upwards + half.kick_s * self.gravity_m_s2];
        let per_mass = half.kick_s * per_kg;
        let [x, y] =
            both!(axis: moving.velocity_m_s[axis] + (moving.force_n[axis] * per_mass - fall[axis]));
        let turning = moving.moment_n_m * (half.kick_s * per_kg_m2);
        [x, y, moving.rate_rad_s + turning]
    }

    /// Rotations in a lane relative to the reference, and their rates half a step before.
    pub fn rotations_and_rates(&self, lane: usize) -> impl Iterator<Item = (f64, f64)> + Clone {
        let bodies = self.bodies.iter().zip(&self.datum);
        bodies
            .map(move |(body, datum)| (body.angle_rad.0[lane] - datum[2], body.rate_rad_s.0[lane]))
    }

    /// Momentum of a lane half a step before, in kg m/s.
    pub fn momentum(&self, lane: usize) -> [f64; 2] {
        let bodies = self.structure.bodies.iter().zip(&self.bodies);
        bodies.fold([0.0; 2], |sum, (constants, body)| {
            [0, 1].map(|axis| sum[axis] + constants.mass_kg * body.velocity_m_s[axis].0[lane])
        })
    }

    /// States of crushing along a joint in a lane.
    pub fn fibres(&self, joint: usize, lane: usize) -> impl Iterator<Item = Fibre<Lanes<1>>> {
        let each = self.structure.fibres();
        let own = &self.fibres[joint * each..(joint + 1) * each];
        own.iter().map(move |fibre| fibre.lane(lane))
    }
}

impl<'a> ElasticMotion<'a, 1> {
    fn at_rest(structure: &'a ElasticStructure, gravity_m_s2: f64, rest: &Equilibrium) -> Self {
        let mut motion = Self::new(structure, gravity_m_s2);
        for (body, moved) in motion.bodies.iter_mut().zip(&rest.moved) {
            body.place = BodyPosition::at(moved);
            body.angle_rad = Lanes([moved[2]]);
        }
        let supports = motion.bodies.iter_mut().skip(rest.moved.len());
        for (support, moved) in supports.zip(structure.supports) {
            support.place = BodyPosition::at(&moved);
        }
        motion.memories.copy_from_slice(&rest.memories);
        motion.fibres.copy_from_slice(&rest.fibres);
        motion.ties.copy_from_slice(&rest.ties);
        motion.update_forces(Lanes([0.0]));
        motion
    }
}

/// Step to be compiled once for every vector width; with a closure it is a tenth slower.
struct LeapfrogStep<'m, 'a, const L: usize> {
    motion: &'m mut ElasticMotion<'a, L>,
    step: &'m ElasticStep<Lanes<L>>,
    activity: GroundActivity,
}

impl<const L: usize> WithSimd for LeapfrogStep<'_, '_, L> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.motion.leapfrog(self.step, self.activity);
    }
}

/// Updates the cosine minus one and the sine of an angle that increases by `by`. The truncation error is below the rounding error for increments
/// below 0.01 rad; structures that have not fallen turn less in a step.
#[inline(always)]
fn turn_angle<const L: usize>([cos, sin]: [Lanes<L>; 2], by: Lanes<L>) -> [Lanes<L>; 2] {
    let one = Lanes([1.0; L]);
    let square = by * by;
    let step_sin = by * (one - square * (one * (1.0 / 6.0) - square * (1.0 / 120.0)));
    let step_cos = -(square * (one * 0.5 - square * (one * (1.0 / 24.0) - square * (1.0 / 720.0))));
    [
        cos + (step_cos + (cos * step_cos - sin * step_sin)),
        sin + (step_sin + (sin * step_cos + cos * step_sin)),
    ]
}
