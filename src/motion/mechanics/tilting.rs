//! A column as one rigid block, with its loads, that rotates about a toe of its base.
//!
//! Let `m` be the mass of block and moving loads, `G` their common centre of gravity at the distance `a` behind the toe and at the height `h`, and `I`
//! their moment of inertia about the toe. Constant forces `F` act at points `r` from the toe; let `T` be the sum of their moments about the toe,
//! clockwise, and `V` the sum of `F . r`. After a clockwise rotation `q`,
//!
//! `I q'' + m (g + a_y) (a cos q - h sin q) + m a_x (h cos q + a sin q) + V sin q - T cos q = 0`.
//!
//! So a push of `(a - T / (m g)) / h` times gravity starts the rotation, and the column is in unstable equilibrium at
//! `tan q = (a - T / (m g)) / (h - V / (m g))`.

use std::f64::consts::FRAC_PI_2;

use nalgebra::Vector2;

use super::back_wall::rate_passed;
use super::chain::{Coefficients, MechanismState};
use super::geometry::pose::{product, unit};
use super::geometry::rigid::mirrored;
use crate::mechanics::four_link::thrust::PartLoad;
use crate::mechanics::{Block, MassMoments, Mechanism, Momentum, PlacedLoad, Pose, Sway};

/// Load of a block, in the frame in which it sways right.
#[derive(Clone, Copy, Debug)]
struct CarriedLoad {
    /// Position from the middle of the base, in half diagonals.
    at: Vector2<f64>,
    /// Moving mass, in masses of the block.
    mass: f64,
    /// Constant force, in weights of the block.
    force: Vector2<f64>,
}

/// Column that rotates about its right toe; lengths in half diagonals, unit density and depth.
#[derive(Clone, Debug)]
pub struct Tilting {
    /// Sine and cosine of the slenderness, computed from the sides: the angle of a flat column would lose the height in rounding errors.
    sin: f64,
    cos: f64,
    /// Mass of the block.
    block: f64,
    /// Moments of the block about the middle of the base, in its masses; `None` for a prism.
    given: Option<MassMoments>,
    /// Moments of block and moving loads about the middle of the base, in masses of the block.
    body: MassMoments,
    /// Vector from the common centre of gravity to the toe, turned upwards: distance of the toe to its right, and height of the centre.
    arm: Vector2<f64>,
    /// Moment of inertia about the toe, in masses of the block.
    inertia: f64,
    loads: Vec<CarriedLoad>,
    /// Clockwise moment `T` of the constant forces about the toe, in weights of the block.
    moment: f64,
    /// Sum `V` of the products of constant forces and their positions from the toe, in weights of the block.
    virial: f64,
}

impl Tilting {
    /// Block of this height and width in metres, with loads at points in metres from the middle of its base. It is a prism, or a body with the given
    /// moments. It sways to this side.
    pub(super) fn new<'l>(
        [height_m, width_m]: [f64; 2],
        (own, is_given): (&Block, bool),
        loads: impl Iterator<Item = (&'l PlacedLoad, Vector2<f64>)>,
        gravity_m_s2: f64,
        sway: Sway,
    ) -> Self {
        let diagonal_m = libm::hypot(height_m, width_m);
        let (sin, cos) = (width_m / diagonal_m, height_m / diagonal_m);
        let towards = |v: Vector2<f64>| match sway {
            Sway::Right => v,
            Sway::Left => mirrored(v),
        };
        let (block_kg, half_m) = (own.mass_kg, 0.5 * diagonal_m);
        let loads = loads.map(|(load, at_m)| CarriedLoad {
            at: towards(at_m) / half_m,
            mass: load.moving_mass_kg() / block_kg,
            force: towards(load.constant_force_n(gravity_m_s2)) / (block_kg * gravity_m_s2),
        });
        // A load of zero must not change any bit.
        let loads: Vec<CarriedLoad> = loads
            .filter(|load| load.mass > 0.0 || load.force != Vector2::zeros())
            .collect();
        let toe = Vector2::new(sin, 0.0);
        // Housner's block has an inertia of 1/3 about its centre, and of 4/3 about its toe.
        let mut body = MassMoments::of_body(1.0, Vector2::new(0.0, cos), 1.0 / 3.0);
        let mut inertia = 4.0 / 3.0;
        let given = is_given.then(|| {
            let (centre, central) = (
                towards(own.centre_m) / half_m,
                own.inertia_kg_m2 / (block_kg * half_m * half_m),
            );
            inertia = central + (centre - toe).norm_squared();
            body = MassMoments::of_body(1.0, centre, central);
            body
        });
        let (mut moment, mut virial) = (0.0, 0.0);
        for load in &loads {
            let from_toe = load.at - toe;
            body = body + load.moments();
            inertia += load.mass * from_toe.norm_squared();
            moment -= from_toe.perp(&load.force);
            virial += from_toe.dot(&load.force);
        }
        let centre = body.centroid();
        Self {
            sin,
            cos,
            block: 4.0 * sin * cos,
            given,
            body,
            arm: Vector2::new(sin - centre.x, centre.y),
            inertia,
            loads,
            moment,
            virial,
        }
    }

    /// Moments of block and moving loads about the middle of the base, in masses of the block and half diagonals.
    pub(super) const fn body(&self) -> &MassMoments {
        &self.body
    }

    /// Toe about which it rotates, as seen from the middle of the base.
    pub(super) const fn toe(&self) -> Vector2<f64> {
        Vector2::new(self.sin, 0.0)
    }

    /// Push that starts the rotation, in multiples of gravity; not positive if the loads alone start it.
    pub(super) fn incipient_g(&self) -> f64 {
        (self.arm.x - self.moment / self.body.mass) / self.arm.y
    }

    /// Rotation at the unstable equilibrium, at most a right angle. `slenderness_rad` is that of the column without loads.
    pub(super) fn critical_rad(&self, slenderness_rad: f64) -> f64 {
        if self.loads.is_empty() && self.given.is_none() {
            return slenderness_rad;
        }
        let mass = self.body.mass;
        let rise = mass * self.arm.x - self.moment;
        let fall = mass * self.arm.y - self.virial;
        libm::atan2(rise, fall).min(FRAC_PI_2)
    }

    /// Rate of this rotation after an impact on the base, for a unit rate of the opposite rotation before it. The closing motion, a
    /// rotation about the other toe, is projected in the kinetic-energy metric onto the rotation about this toe. This conserves angular momentum about
    /// this toe, and gives `1 - 3/2 sin^2(alpha)` for a block without loads.
    ///
    /// That rate is not positive from `sin^2(alpha) = 2/3` on, a width of `sqrt(2)` heights: the old toe of such a flat column would move into the
    /// ground. The column stops instead.
    pub(super) fn base_rate_ratio(&self) -> f64 {
        let toe = self.toe();
        rate_passed(&self.body, -toe, toe)
    }

    /// Moment of inertia about the toe, in masses of the block.
    pub(super) const fn unit_inertia(&self) -> f64 {
        self.inertia
    }

    /// Arm of the centre of gravity after a rotation: its distance behind the toe, and its height.
    fn arm_at(&self, q_rad: f64) -> Vector2<f64> {
        let (sin, cos) = libm::sincos(q_rad);
        Vector2::new(
            self.arm.x * cos - self.arm.y * sin,
            self.arm.y * cos + self.arm.x * sin,
        )
    }

    /// Ground reaction per unit weight while the column moves; it acts at the toe.
    pub(super) fn reaction(&self, motion: &MechanismState) -> Vector2<f64> {
        // Acceleration of the centre of gravity, on its circle about the toe.
        let arm = self.arm_at(motion.q_rad);
        let along = Vector2::new(arm.y, arm.x) * motion.acceleration;
        let inward = Vector2::new(arm.x, -arm.y) * (motion.rate * motion.rate);
        along + inward - motion.body_force_g - self.constant_force()
    }

    /// Ground reaction per unit weight at rest, and its moment about the middle of the base, positive to the right. The column does not
    /// lean beyond its base towards a wall on the side `wall`.
    pub(super) fn reaction_at_rest(
        &self,
        body_force_g: Vector2<f64>,
        wall: Option<Sway>,
    ) -> (Vector2<f64>, f64) {
        let onto_base = self.pressing_forces(body_force_g, wall);
        let reaction = -onto_base(body_force_g + self.constant_force());
        let centre = self.body.centroid();
        let own = onto_base(body_force_g);
        let each = self.loads.iter().map(|load| {
            let force = onto_base(load.force) / self.body.mass;
            force.x * load.at.y - load.at.x * force.y
        });
        let moment = own.x * centre.y - centre.x * own.y + each.sum::<f64>();
        let most = reaction.y * self.sin;
        match wall {
            Some(wall) if wall.sign() * moment > most => (reaction, wall.sign() * most),
            _ => (reaction, moment),
        }
    }

    /// Thrust line at rest, in the form of [`Self::crossings`].
    pub(super) fn eccentricity_ratios_at_rest(
        &self,
        body_force_g: Vector2<f64>,
        wall: Option<Sway>,
    ) -> Vec<Option<f64>> {
        let onto_base = self.pressing_forces(body_force_g, wall);
        self.crossings(&PartLoad::uniform(onto_base(body_force_g)), onto_base)
    }

    /// Function of the forces at rest that returns their parts which press on the base. A wall on the side `wall` carries the horizontal
    /// forces, at their heights, if their sum points to it.
    fn pressing_forces(
        &self,
        body_force_g: Vector2<f64>,
        wall: Option<Sway>,
    ) -> impl Fn(Vector2<f64>) -> Vector2<f64> {
        let sum = body_force_g + self.constant_force();
        let is_held = wall.is_some_and(|wall| wall.sign() * sum.x > 0.0);
        move |force| match is_held {
            true => Vector2::new(0.0, force.y),
            false => force,
        }
    }

    /// Sum of the constant forces, in weights of block and moving loads.
    fn constant_force(&self) -> Vector2<f64> {
        let forces = self.loads.iter().map(|load| load.force);
        forces.sum::<Vector2<f64>>() / self.body.mass
    }

    /// Crossings of the thrust line with sections normal to the axis in motion; see [`Self::crossings`].
    pub(super) fn eccentricity_ratios(&self, motion: &MechanismState) -> Vec<Option<f64>> {
        // In the frame of the block, which has turned clockwise.
        let turn = unit(motion.q_rad);
        let body_force_g = product(turn, motion.body_force_g);
        let turning = (-motion.acceleration, motion.rate * motion.rate);
        let load = PartLoad::of_body(self.toe(), body_force_g, turning);
        self.crossings(&load, |force| product(turn, force))
    }

    /// Crossings of the thrust line with sections normal to the axis, from the base up: the distance to the right over the width, for the
    /// resultant of the load on the part above. `force` returns a constant force in the frame of the block. `None` if the section would be in tension.
    ///
    /// If nothing is above a section, its value is the limit for a thin slice, which includes the inertia of the slice's rotation.
    fn crossings(
        &self,
        load: &PartLoad,
        force: impl Fn(Vector2<f64>) -> Vector2<f64>,
    ) -> Vec<Option<f64>> {
        let (width, height) = (2.0 * self.sin, 2.0 * self.cos);
        let crossing = |part: f64| {
            let section = Vector2::new(0.0, part * height);
            let above = height * (1.0 - part);
            let centre = section + Vector2::new(0.0, 0.5 * above);
            // Rounding must not lower a load at the top.
            let carried = |load: &&CarriedLoad| load.at.y >= section.y * (1.0 - 1e-12);
            let loads = || self.loads.iter().filter(carried);
            // Without loads the mass of the part cancels.
            let mass = loads().next().map_or(1.0, |_| 1.0 - part);
            let central = (width * width + above * above) / 12.0;
            let prism = MassMoments::of_body(1.0, centre, central);
            let own = self.given.unwrap_or(prism);
            let moments = loads().fold(own * mass, |sum, load| sum + load.moments());
            let resultant = loads().fold(load.resultant(&moments), |sum, load| {
                sum + Momentum::applied_at(load.at, force(load.force))
            });
            let normal = -resultant.linear.y;
            let eccentricity_ratio = -resultant.moment_about(section) / (normal * width);
            (normal > 0.0).then_some(eccentricity_ratio)
        };
        let parts = thrust_section_parts(self.given.is_some());
        parts.map(crossing).collect()
    }
}

impl CarriedLoad {
    /// Moments of the moving mass about the middle of the base, in masses of the block.
    fn moments(&self) -> MassMoments {
        MassMoments::of_body(self.mass, self.at, 0.0)
    }
}

/// Sections at which the thrust line is reported, as fractions of the height. The masses above other sections than the base are unknown for a body by its
/// numbers.
pub(super) fn thrust_section_parts(is_given: bool) -> impl Iterator<Item = f64> {
    let last = if is_given { 0 } else { 20_u8 };
    (0..=last).map(|section| f64::from(section) / 20.0)
}

impl Mechanism for Tilting {
    /// Rotation of the column.
    type Rotations = [f64; 1];
    const BODIES: &'static [&'static str] = &[""];

    fn moments(&self) -> Vec<MassMoments> {
        vec![self.body * self.block]
    }

    fn coefficients(&self, q_rad: f64) -> Coefficients {
        let (sin, cos) = libm::sincos(q_rad);
        let (arm, mass) = (self.arm_at(q_rad), self.block * self.body.mass);
        Coefficients {
            inertia: self.inertia * self.block,
            inertia_slope: 0.0,
            s_x: mass * arm.y,
            s_y: mass * arm.x,
            s_f: self.block * (self.virial * sin - self.moment * cos),
        }
    }

    /// Differences of sines and cosines are written as products, to avoid cancellation at small rotations.
    fn displacement(&self, q_rad: f64) -> Vector2<f64> {
        let chord = 2.0 * (self.block * self.body.mass) * libm::sin(0.5 * q_rad);
        let arm = self.arm_at(0.5 * q_rad);
        Vector2::new(chord * arm.y, chord * arm.x)
    }

    fn potential(&self, q_rad: f64) -> f64 {
        let half = libm::sin(0.5 * q_rad);
        let of_forces = 2.0 * self.virial * half * half - self.moment * libm::sin(q_rad);
        self.displacement(q_rad).y + self.block * of_forces
    }

    fn rotations(&self, q_rad: f64) -> [f64; 1] {
        [-q_rad]
    }

    fn rotation_rates(&self, _: f64) -> [f64; 1] {
        [-1.0]
    }

    /// Forces as momenta, in the unit of mass, with gravity as unit.
    fn constant_forces(&self) -> Vec<(Vector2<f64>, Vector2<f64>)> {
        let acts = |load: &&CarriedLoad| load.force != Vector2::zeros();
        let loads = self.loads.iter().filter(acts);
        let forces = loads.map(|load| (load.at, load.force * self.block));
        forces.collect()
    }

    /// Positions are relative to the middle of the base, the origin.
    fn write_poses(&self, q_rad: f64, poses: &mut Vec<Pose>, hinges: &mut Vec<Vector2<f64>>) {
        let toe = self.toe();
        poses.clear();
        hinges.clear();
        poses.push(Pose::about(toe, toe, -q_rad));
        hinges.push(toe);
    }
}
