//! Sequences of mechanisms with one degree of freedom, linked by impacts: the four-link mechanisms of an arch, the two mechanisms of a free-standing
//! column.
//!
//! Lengths are relative to the structure's size, masses to its unit of mass. Every mechanism is described in the frame in which it sways right.

use std::collections::BTreeMap;

use nalgebra::Vector2;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::bisection::{Width, bisect, middle};
use crate::mechanics::{Edge, MassMoments, Pose, Sway};

/// Coefficients of the equation of motion of a system with one degree of freedom at a given `q`,
/// `M q'' + M'/2 q'^2 + (g + a_y) S_y + a_x S_x + g S_f = 0`, under gravity `g` and ground accelerations `a_x` and `a_y`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficients {
    /// `M`: generalised mass.
    pub inertia: f64,
    /// `M'`: derivative of the generalised mass with respect to `q`.
    pub inertia_slope: f64,
    /// `S_x`: sum of the masses times the derivatives of their horizontal positions.
    pub s_x: f64,
    /// `S_y`: sum of the masses times the derivatives of their vertical positions.
    pub s_y: f64,
    /// `S_f`: minus the sum of the constant forces, over gravity, times the derivatives of the positions of their points.
    pub s_f: f64,
}

impl Coefficients {
    /// Derivative of the potential energy of weights and constant forces with respect to `q`, over gravity.
    pub const fn potential_slope(&self) -> f64 {
        self.s_y + self.s_f
    }
}

/// State of a mechanism, in its own frame, with the length of the structure and gravity as units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MechanismState {
    /// The coordinate `q`.
    pub q_rad: f64,
    /// Rate of the coordinate, times `sqrt(L/g)`.
    pub rate: f64,
    /// Second derivative of the coordinate, times `L/g`.
    pub acceleration: f64,
    /// Force per unit mass in the frame of the ground, in g: gravity less the ground's acceleration.
    pub body_force_g: Vector2<f64>,
}

/// Thrust excess and friction demand of a structure; see [`ThrustLine`](crate::mechanics::four_link::ThrustLine).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Demand {
    /// Largest distance of the thrust line beyond the structure, over the thickness; zero if it stays inside.
    pub excess_ratio: f64,
    /// Friction coefficient required to prevent sliding: the largest value of all sections with at least `LEAST_LOAD`.
    pub friction: f64,
}

/// Least normal force of a section, over the weight of the structure, that counts in the friction demand. An almost unloaded section can show any
/// ratio, and its slip hardly matters.
pub const LEAST_LOAD: f64 = 0.01;

/// Mechanism with one degree of freedom `q >= 0` at finite rotations, swaying right.
pub trait Mechanism {
    /// Rotations of the bodies from left to right, anticlockwise, in radians; also the type of their rates.
    type Rotations: Copy + AsRef<[f64]> + AsMut<[f64]>;

    /// Names of the bodies, from left to right; one empty name for a single body.
    const BODIES: &'static [&'static str];

    /// Mass moments of the bodies, undeformed, from left to right.
    fn moments(&self) -> Vec<MassMoments>;
    /// Coefficients of the equation of motion at `q`.
    fn coefficients(&self, q_rad: f64) -> Coefficients;
    /// Mass times displacement of the centre of gravity at `q`.
    fn displacement(&self, q_rad: f64) -> Vector2<f64>;
    /// Potential energy of weights and constant forces at `q` over gravity, zero at `q = 0`.
    fn potential(&self, q_rad: f64) -> f64 {
        self.displacement(q_rad).y
    }
    /// Constant forces over gravity, each with the position of its point at `q = 0`. They act on the first body.
    fn constant_forces(&self) -> Vec<(Vector2<f64>, Vector2<f64>)> {
        Vec::new()
    }
    /// Rotations of the bodies at `q`.
    fn rotations(&self, q_rad: f64) -> Self::Rotations;
    /// Rotation rates of the bodies at `q` for `q' = 1`.
    fn rotation_rates(&self, q_rad: f64) -> Self::Rotations;
    /// Writes the poses of the bodies at `q`, from left to right, and the positions of the hinges into two lists, which are emptied first.
    fn write_poses(&self, q_rad: f64, poses: &mut Vec<Pose>, hinges: &mut Vec<Vector2<f64>>);
}

/// Mechanism in the sequence that impacts produce.
#[derive(Clone, Debug)]
pub struct Link<M> {
    /// The mechanism at finite rotations.
    pub mechanism: M,
    /// Coefficients at `q = 0`, where every arc of the motion begins and ends.
    pub at_zero: Coefficients,
    /// `q` at the unstable equilibrium under gravity alone.
    pub critical_rad: f64,
    /// Largest possible `q` of the mechanism.
    pub limit_rad: f64,
    /// Energy barrier: work against unit gravity and constant forces from `q = 0` to the unstable equilibrium, in the units of
    /// mass and length.
    pub barrier: f64,
    /// Rate of this mechanism for a unit closing rate of the one before; 1 for the first.
    pub rate_ratio: f64,
    /// Restitution coefficient of the impact that starts this mechanism, energy after over before; 1 for the first.
    pub restitution: f64,
}

/// Hinge between two parts of a structure, or between a part and the ground.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Hinge {
    /// Hinge at an edge of a section of an arch.
    Section {
        /// Angle of the section from the left springing, in radians; in files `angle_deg`, in degrees.
        #[serde(
            rename = "angle_deg",
            serialize_with = "serialize_degrees",
            deserialize_with = "deserialize_degrees"
        )]
        angle_rad: f64,
        /// The edge.
        edge: Edge,
    },
    /// Hinge at the toe of a column's base on this side; `toe` in files.
    Toe(#[serde(serialize_with = "serialize_toe", deserialize_with = "deserialize_toe")] Sway),
    /// Hinge at a joint of a row of blocks.
    Joint {
        /// Index of the joint, from 0 at the left springing or the base.
        joint: usize,
        /// Edge about which the joint opens; `None` if it opens at both edges.
        edge: Option<Edge>,
    },
    /// Hinge on a face of a wall that is not cut into drums.
    Face {
        /// Height above the base, in metres.
        height_m: f64,
        /// The face.
        side: Sway,
    },
}

fn serialize_degrees<S: Serializer>(angle_rad: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    angle_rad.to_degrees().serialize(serializer)
}

fn deserialize_degrees<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    f64::deserialize(deserializer).map(f64::to_radians)
}

fn serialize_toe<S: Serializer>(side: &Sway, serializer: S) -> Result<S::Ok, S::Error> {
    BTreeMap::from([("toe", side)]).serialize(serializer)
}

fn deserialize_toe<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Sway, D::Error> {
    #[derive(Deserialize)]
    struct OfToe {
        toe: Sway,
    }
    OfToe::deserialize(deserializer).map(|of| of.toe)
}

impl<M: Mechanism> Link<M> {
    /// Link of a mechanism with its unstable equilibrium and its limit, and with the impact that starts it.
    pub fn new(
        mechanism: M,
        critical_rad: f64,
        limit_rad: f64,
        rate_ratio: f64,
        restitution: f64,
    ) -> Self {
        Self {
            at_zero: mechanism.coefficients(0.0),
            barrier: mechanism.potential(critical_rad),
            mechanism,
            critical_rad,
            limit_rad,
            rate_ratio,
            restitution,
        }
    }
}

/// Mechanisms by which a structure rocks under an impact model.
///
/// The mechanism after an impact depends on the mechanism before it, not on the velocity. The sequence therefore follows from the mechanism that
/// starts at the incipient acceleration. Every implementor is a [`Model`](crate::dynamics::Model).
pub trait MechanismChain: std::fmt::Debug + Send + Sync {
    /// Type of the mechanisms.
    type Mechanism: Mechanism + Send + Sync;

    /// Size of the structure: the unit of length of its mechanisms, in metres.
    fn length_m(&self) -> f64;
    /// Unit of mass of its mechanisms, in kg.
    fn mass_unit_kg(&self) -> f64;
    /// Unit of energy of the mechanisms in J.
    fn joules_per_unit(&self) -> f64 {
        self.mass_unit_kg() * self.length_m() * self.length_m()
    }

    /// Horizontal acceleration at which rocking starts from rest to a side to which the structure can sway, in multiples of gravity.
    fn incipient_towards_g(&self, sway: Sway) -> f64;
    /// Incipient acceleration to the right, in multiples of gravity; for symmetric structures, to either side.
    fn incipient_g(&self) -> f64 {
        self.incipient_towards_g(Sway::Right)
    }
    /// Writes the poses of the bodies of a mechanism displaced to a side, and the positions of its hinges, into two lists, from left to right and in
    /// metres.
    fn place_m(
        &self,
        mechanism: &Self::Mechanism,
        (q_rad, sway): (f64, Sway),
        poses: &mut Vec<Pose>,
        hinges_m: &mut Vec<Vector2<f64>>,
    ) {
        mechanism.write_poses(q_rad, poses, hinges_m);
        if sway == Sway::Left {
            poses.reverse();
            hinges_m.reverse();
        }
        for pose in poses {
            let placed = pose.scaled(self.length_m());
            *pose = match sway {
                Sway::Right => placed,
                Sway::Left => placed.mirrored(),
            };
        }
        for hinge in hinges_m {
            *hinge = Vector2::new(sway.sign() * hinge.x, hinge.y) * self.length_m();
        }
    }
    /// True if a thrust line runs through the structure, so that its excess is known.
    const THRUSTS: bool;
    /// Thrust excess and friction demand of a mechanism in motion, after a number of impacts and a first sway to this side. Faster than
    /// [`Self::demand`], and lower by some per cent for a continuous ring, whose sections are further apart.
    fn demand_at_sections(
        &self,
        _first: Sway,
        _impacts: usize,
        mechanism: &Self::Mechanism,
        motion: &MechanismState,
    ) -> Demand {
        self.demand(mechanism, motion)
    }
    /// Thrust excess and friction demand of a mechanism in motion.
    fn demand(&self, mechanism: &Self::Mechanism, motion: &MechanismState) -> Demand;
    /// Thrust excess and friction demand at rest, for a force per unit mass (gravity minus ground acceleration) in multiples of gravity.
    fn demand_at_rest(&self, body_force_g: Vector2<f64>) -> Demand;
    /// Thrust line of a mechanism in motion, section by section from left to right in the mechanism's frame: outward distance from the
    /// axis over the thickness. The sections of a column go from the base up, with distances to the right. `None` for a section without compression;
    /// empty if unknown.
    fn eccentricity_ratios(&self, _: &Self::Mechanism, _: &MechanismState) -> Vec<Option<f64>> {
        Vec::new()
    }
    /// Mirror image of a thrust line, with sections in reverse order. For a column the distances change sign instead.
    fn mirrored(&self, mut eccentricity_ratios: Vec<Option<f64>>) -> Vec<Option<f64>> {
        eccentricity_ratios.reverse();
        eccentricity_ratios
    }
    /// Thrust line at rest, in the form of [`Self::eccentricity_ratios`]; empty if unknown.
    fn eccentricity_ratios_at_rest(&self, _body_force_g: Vector2<f64>) -> Vec<Option<f64>> {
        Vec::new()
    }
    /// Side of the sway `impacts` impacts later or earlier than a sway to this side. Every impact changes the side, unless a wall stands
    /// behind the structure.
    fn sway_after(&self, sway: Sway, impacts: usize) -> Sway {
        sway.after(impacts)
    }
    /// Mechanism after a number of impacts and a first sway to this side; `None` if it cannot sway to that side, or if an earlier impact
    /// stops the structure.
    fn link_from(&self, first: Sway, impacts: usize) -> Option<&Link<Self::Mechanism>>;
    /// Mechanism after a number of impacts and a first sway to the right; for symmetric structures, to either side.
    fn link(&self, impacts: usize) -> Option<&Link<Self::Mechanism>> {
        self.link_from(Sway::Right, impacts)
    }
    /// Number of impacts, after a first sway to this side, from which on the mechanisms repeat in pairs; `None` while it is not known.
    fn repeats_from(&self, first: Sway) -> Option<usize>;
    /// Whether the energy barriers of the mechanisms are all that prevents overturning on quiet ground: false for a column that may turn over
    /// the top of a lower wall behind it, which no mechanism describes.
    fn barriers_decide(&self) -> bool {
        true
    }
    /// Least energy barrier of the mechanism after a number of impacts and a first sway to this side, and of all mechanisms that may follow
    /// it, in the unit of [`Link::barrier`]. `None` if [barriers do not decide](Self::barriers_decide), or without such a mechanism.
    ///
    /// **On quiet ground, a structure with less energy, whose mechanism is not beyond its unstable equilibrium `q_c`, cannot overturn.** Quiet ground does no work, so kinetic plus potential energy is constant between
    /// impacts. All mechanisms have the potential energy zero at `q = 0`, where impacts happen, and an impact leaves at most the kinetic energy before it
    /// (restitution coefficients are at most 1). So the energy never grows. A mechanism that overturns passes `q_c`, where its potential energy is its
    /// barrier, so its energy is at least that barrier. The mechanisms that may follow are those of the sequence after the present one, up to the end of
    /// the sequence or its repeating pair. At rest, the ground does not push, and the structure stays.
    ///
    /// The links that are not known yet are computed.
    fn least_barrier_from(&self, first: Sway, impacts: usize) -> Option<f64> {
        let link = |index: usize| self.link_from(first, index).map(|link| link.barrier);
        let mut least = link(impacts).filter(|_| self.barriers_decide())?;
        for index in impacts + 1.. {
            let Some(barrier) = link(index) else { break };
            least = least.min(barrier);
            // Both mechanisms of the pair have been compared.
            if self.repeats_from(first).is_some_and(|pair| index > pair) {
                break;
            }
        }
        Some(least)
    }
    /// Hinges of the mechanism after a number of impacts, from left to right, for a sway to the given side; empty without such a
    /// mechanism.
    fn hinges(&self, impacts: usize, sway: Sway) -> Vec<Hinge>;
    /// Impulses at the hinges in the impact that starts the mechanism, in the frame of the ground, for a unit closing rate, in the units
    /// of mass and length; empty if unknown.
    fn hinge_impulses(&self, impacts: usize, sway: Sway) -> Vec<Vector2<f64>>;
}

/// Unstable equilibrium under gravity: the first `q` in `(0, limit_rad)` at which the slope of the potential energy becomes zero.
/// The limit if there is none.
pub fn critical_rad(mechanism: &impl Mechanism, limit_rad: f64) -> f64 {
    let rise = |q| mechanism.coefficients(q).potential_slope();
    // The potential energy has one maximum before the limit; the scan only brackets it.
    let steps = 64;
    let at = |step: i32| limit_rad * f64::from(step) / f64::from(steps);
    let Some(first) = (1..steps).find(|step| rise(at(*step)) <= 0.0) else {
        return limit_rad;
    };
    let (low, high) = bisect(at(first - 1), at(first), Width::Rounding, |q| {
        rise(q) <= 0.0
    });
    middle(low, high)
}
