//! Quasi-static capacity of a mechanism at finite displacements, and its equivalent oscillator.
//!
//! At the rotation `q`, the first mechanism is in equilibrium under gravity, constant forces and the horizontal acceleration
//! `a(q) = (S_y(q) + S_f(q)) / S_x(q)` (in multiples of gravity). This follows from virtual power. At the onset, `a(0) = A_L`. The acceleration
//! decreases to zero at the unstable equilibrium. The capacity curve is `a` against the horizontal displacement `d` of a control point. The value of
//! `d` at its end is the ultimate displacement.
//!
//! The equivalent oscillator is that of the kinematic approach to masonry (reviewed by Casapulla, Giresini and Lourenço, Rocking and kinematic
//! approaches for rigid block analysis of masonry walls, Buildings 7, 69, 2017), defined here as follows. Let `m_i` be the masses of the blocks at
//! their centres of gravity, `u_i` their horizontal velocities at the start of the mechanism, and `u_c` that of the control point:
//!
//! - participating mass `M* = (sum m u)^2 / sum m u^2`, fraction `e* = M* / sum m`;
//! - acceleration `a* = a / e*`: `M* a*` is the force `a sum m`;
//! - displacement `d* = d sum m u^2 / (u_c sum m u)`;
//! - secant period `T = 2 pi sqrt(d* / (g a*))`.
//!
//! The sums include the blocks that the mechanism moves. A single block has `e* = 1`.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::chain::MechanismState;
use super::virtual_work::Participation;
use crate::mechanics::{
    BodyPoint, Mechanism as _, MechanismChain, MovingBody, MovingForce, Pose, Sway, Twist,
};

/// Structure displaced along its first mechanism, in equilibrium with a horizontal acceleration.
#[derive(Clone, Debug, PartialEq)]
pub struct Displaced {
    /// Rotation of the body at the end away from which the structure sways, without sign, in radians: of the left body if it sways to the right.
    pub q_rad: f64,
    /// Horizontal ground acceleration against the sway at which the structure is in equilibrium, in multiples of gravity.
    pub acceleration_g: f64,
    /// Poses of its bodies from left to right, in metres, in the frame of the ground.
    pub poses: Vec<Pose>,
    /// Positions of its hinges from left to right, in metres, in the frame of the ground.
    pub hinges_m: Vec<Vector2<f64>>,
    /// Friction coefficient required to prevent sliding in this equilibrium.
    pub friction: f64,
}

/// First mechanism to a side at a fraction `part` of the rotation at its unstable equilibrium. `None` without such a mechanism.
pub fn displaced_mechanism<C: MechanismChain>(
    structure: &C,
    sway: Sway,
    part: f64,
) -> Option<Displaced> {
    let link = structure.link_from(sway, 0)?;
    let q_rad = part * link.critical_rad;
    let coefficients = link.mechanism.coefficients(q_rad);
    let acceleration_g = coefficients.potential_slope() / coefficients.s_x;
    let held = MechanismState {
        q_rad,
        rate: 0.0,
        acceleration: 0.0,
        body_force_g: Vector2::new(acceleration_g, -1.0),
    };
    let (mut poses, mut hinges_m) = (Vec::new(), Vec::new());
    let (mechanism, displaced) = (&link.mechanism, (q_rad, sway));
    structure.place_m(mechanism, displaced, &mut poses, &mut hinges_m);
    Some(Displaced {
        q_rad,
        acceleration_g,
        poses,
        hinges_m,
        friction: structure.demand(mechanism, &held).friction,
    })
}

/// Rigid bodies of the first mechanism to a side, from left to right, with their virtual displacements per radian of its coordinate, in
/// metres. Parts at rest are omitted. `None` without such a mechanism.
pub fn moving_bodies<C: MechanismChain>(structure: &C, sway: Sway) -> Option<Vec<MovingBody>> {
    let mechanism = &structure.link_from(sway, 0)?.mechanism;
    let (mut poses, mut hinges) = (Vec::new(), Vec::new());
    mechanism.write_poses(0.0, &mut poses, &mut hinges);
    let rates = mechanism.rotation_rates(0.0);
    // Every hinge adds a rotation about itself to the motion of the body before it.
    let mut twist = Twist::ZERO;
    let bodies = mechanism.moments().into_iter().zip(&hinges);
    let mut moving: Vec<MovingBody> = bodies
        .zip(rates.as_ref())
        .map(|((moments, hinge), rate)| {
            twist = twist + Twist::rotation(*hinge, rate - twist.rate);
            let centre = moments.centroid();
            MovingBody {
                mass_kg: moments.mass * structure.mass_unit_kg(),
                centre_m: Vector2::new(sway.sign() * centre.x, centre.y) * structure.length_m(),
                displacement: twist.velocity_at(centre) * structure.length_m(),
                rotation: -rate,
            }
        })
        .collect();
    if sway == Sway::Left {
        moving.reverse();
    }
    Some(moving)
}

/// Constant forces on the first body of the first mechanism to a side, with their virtual displacements per radian of its coordinate, in
/// metres. `None` without such a mechanism.
pub fn moving_forces<C: MechanismChain>(structure: &C, sway: Sway) -> Option<Vec<MovingForce>> {
    let mechanism = &structure.link_from(sway, 0)?.mechanism;
    let (mut poses, mut hinges) = (Vec::new(), Vec::new());
    mechanism.write_poses(0.0, &mut poses, &mut hinges);
    let rates = mechanism.rotation_rates(0.0);
    let twist = Twist::rotation(hinges[0], rates.as_ref()[0]);
    let forces = mechanism
        .constant_forces()
        .into_iter()
        .map(|(at, force)| MovingForce {
            at_m: Vector2::new(sway.sign() * at.x, at.y) * structure.length_m(),
            force_kg: force * structure.mass_unit_kg(),
            displacement: twist.velocity_at(at) * structure.length_m(),
        });
    Some(forces.collect())
}

impl BodyPoint {
    /// Horizontal displacement of the point, in metres.
    fn shift_m(&self, poses: &[Pose]) -> f64 {
        let pose = self.body.and_then(|body| poses.get(body));
        pose.map_or(0.0, |pose| (pose.current_position(self.at_m) - self.at_m).x)
    }
}

/// Control point, whose displacement is reported: a point of the structure, or the common centre of several points.
#[derive(Clone, Debug, PartialEq)]
pub struct Control {
    /// Position in the undeformed structure, in metres.
    pub at_m: Vector2<f64>,
    /// Points with their weights; the weights sum to one.
    points: Vec<(f64, BodyPoint)>,
}

impl Control {
    /// Control point at a point of the structure.
    pub fn point(point: BodyPoint) -> Self {
        Self {
            at_m: point.at_m,
            points: vec![(1.0, point)],
        }
    }

    /// Common centre of the moving masses, given in kg, as control point.
    pub fn centre_of(masses: &[(f64, BodyPoint)]) -> Self {
        let moving = || masses.iter().filter(|(_, point)| point.body.is_some());
        let whole_kg: f64 = moving().map(|(mass_kg, _)| mass_kg).sum();
        let points: Vec<(f64, BodyPoint)> = moving()
            .map(|(mass_kg, point)| (mass_kg / whole_kg, *point))
            .collect();
        let at_m = points.iter().map(|(part, point)| point.at_m * *part).sum();
        Self { at_m, points }
    }

    /// Horizontal displacement of the control point, in metres.
    fn shift_m(&self, poses: &[Pose]) -> f64 {
        let points = self.points.iter();
        let shifts_m = points.map(|(part, point)| part * point.shift_m(poses));
        shifts_m.sum()
    }
}

/// Point of the capacity curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvePoint {
    /// Rotation of the body at the end away from which the structure sways, in radians; see [`Displaced::q_rad`].
    pub q_rad: f64,
    /// Displacement of the control point in the direction of the sway, in metres.
    pub displacement_m: f64,
    /// Acceleration `a`, in g.
    pub acceleration_g: f64,
    /// Displacement `d*` of the equivalent oscillator, in metres.
    pub oscillator_displacement_m: f64,
    /// Acceleration `a*` of the equivalent oscillator, in multiples of gravity.
    pub oscillator_acceleration_g: f64,
    /// Secant period of the oscillator in seconds, 0 at rest; `None` at the unstable equilibrium, where the period is infinite.
    pub secant_period_s: Option<f64>,
    /// Friction coefficient required to prevent sliding.
    pub friction: f64,
}

/// Capacity of the first mechanism to a side.
#[derive(Clone, Debug, PartialEq)]
pub struct Capacity {
    /// Side to which the structure sways.
    pub sway: Sway,
    /// The control point.
    pub control: Control,
    /// Participating mass `M*` in kg.
    pub participating_mass_kg: f64,
    /// Participating mass over moving mass, `e*`.
    pub mass_fraction: f64,
    /// Factor from displacements of the control point to those of the equivalent oscillator.
    pub to_oscillator: f64,
    /// Capacity curve from rest to the unstable equilibrium, at equal steps of the coordinate and at yield or break of ties.
    pub curve: Vec<CurvePoint>,
    /// Displacements at which each tie yields or breaks; empty without ties.
    pub ties: Vec<TieEventDisplacements>,
}

/// Fractions of the rotation at the unstable equilibrium at which a tie yields or breaks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TieEventFractions {
    /// Fraction at which the tie first yields; `None` if it does not.
    pub yields: Option<f64>,
    /// Last fraction at which the tie is intact and first one at which it is broken; `None` if it does not break.
    pub breaks: Option<[f64; 2]>,
}

/// Displacements of the control point at which a tie yields or breaks, in metres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TieEventDisplacements {
    /// Displacement at which the tie yields; `None` if it does not.
    pub yields_at_m: Option<f64>,
    /// Displacement at which the tie breaks; `None` if it does not.
    pub breaks_at_m: Option<f64>,
}

/// Reason why there is no capacity curve.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum CapacityError {
    /// The control point at this position, in metres, does not move, or moves against the sway to this side.
    #[error(
        "the control point ({:?}, {:?}) m does not move to the {side} with the mechanism: choose a point of a block that does",
        .0.x, .0.y, side = .1.name()
    )]
    Control(Vector2<f64>, Sway),
    /// There is no unstable equilibrium to this side.
    #[error(
        "the linkage that sways to the {side} reaches its limit position before its strength is zero: it has no ultimate \
         displacement", side = .0.name()
    )]
    Locks(Sway),
}

/// Number of intervals of a capacity curve.
const INTERVALS: u32 = 100;

/// Step of the central differences for the initial velocities, as a fraction of the rotation at the unstable equilibrium. Their error is of the
/// order of its square.
const START: f64 = 1e-5;

impl Capacity {
    /// Computes the capacity of a mechanism. `displaced` returns its positions at fractions of the rotation at the unstable equilibrium; `masses`
    /// are in kg.
    ///
    /// # Errors
    /// If the control point does not move, or the acceleration does not decrease to zero.
    pub fn new(
        sway: Sway,
        displaced: impl Fn(f64) -> Displaced,
        masses: &[(f64, BodyPoint)],
        control: Control,
        gravity_m_s2: f64,
    ) -> Result<Self, CapacityError> {
        let near = [-START, START].map(&displaced);
        let velocity = |shift_m: &dyn Fn(&[Pose]) -> f64| {
            let [before_m, after_m] = [0, 1].map(|at| shift_m(&near[at].poses));
            sway.sign() * (after_m - before_m) / (near[1].q_rad - near[0].q_rad)
        };
        let control_velocity = velocity(&|poses| control.shift_m(poses));
        let moving: Vec<(f64, f64)> = masses
            .iter()
            .filter(|(_, point)| point.body.is_some())
            .map(|(mass_kg, point)| (*mass_kg, velocity(&|poses| point.shift_m(poses))))
            .collect();
        let speeds = moving.iter().map(|(_, velocity)| velocity.abs());
        let fastest = speeds.fold(0.0, f64::max);
        if control_velocity <= 1e-9 * fastest {
            return Err(CapacityError::Control(control.at_m, sway));
        }
        let participation = Participation::of(moving);
        let to_oscillator = participation.oscillator_displacement / control_velocity;
        // At the end of the path the acceleration may be NaN.
        let [start_g, end_g] = [0.0, 1.0].map(|part| displaced(part).acceleration_g);
        if end_g.is_nan() || end_g.abs() > 1e-6 * start_g {
            return Err(CapacityError::Locks(sway));
        }
        let mut capacity = Self {
            sway,
            control,
            participating_mass_kg: participation.participating_mass_kg,
            mass_fraction: participation.mass_fraction,
            to_oscillator,
            curve: Vec::new(),
            ties: Vec::new(),
        };
        let curve = (0..=INTERVALS).map(|step| {
            let part = f64::from(step) / f64::from(INTERVALS);
            capacity.point(part, &displaced(part), gravity_m_s2)
        });
        capacity.curve = curve.collect();
        Ok(capacity)
    }

    /// This capacity with additional points: at yield of each tie, and just before and after its break.
    #[must_use]
    pub fn with_ties(
        mut self,
        fractions: &[TieEventFractions],
        displaced: impl Fn(f64) -> Displaced,
        gravity_m_s2: f64,
    ) -> Self {
        for TieEventFractions { yields, breaks } in fractions {
            let point = |part: f64| self.point(part, &displaced(part), gravity_m_s2);
            let yields = yields.map(point);
            let breaks = breaks.map(|around| around.map(point));
            self.ties.push(TieEventDisplacements {
                yields_at_m: yields.map(|point| point.displacement_m),
                breaks_at_m: breaks.map(|[_, broken]| broken.displacement_m),
            });
            let points = yields.into_iter().chain(breaks.into_iter().flatten());
            self.curve.extend(points);
        }
        (self.curve).sort_by(|one, other| one.q_rad.total_cmp(&other.q_rad));
        self.curve.dedup_by(|one, other| one.q_rad == other.q_rad);
        self
    }

    /// Point of the curve at a fraction of the path.
    fn point(&self, part: f64, here: &Displaced, gravity_m_s2: f64) -> CurvePoint {
        // Rounding errors may change the sign of the first displacement and of the last acceleration.
        let (first, last) = (part == 0.0, part == 1.0);
        let shift_m = self.sway.sign() * self.control.shift_m(&here.poses);
        let displacement_m = if first { 0.0 } else { shift_m };
        let acceleration_g = if last { 0.0 } else { here.acceleration_g };
        let oscillator_displacement_m = displacement_m * self.to_oscillator;
        let oscillator_acceleration_g = acceleration_g / self.mass_fraction;
        let square_s2 = oscillator_displacement_m / (gravity_m_s2 * oscillator_acceleration_g);
        CurvePoint {
            q_rad: here.q_rad,
            displacement_m,
            acceleration_g,
            oscillator_displacement_m,
            oscillator_acceleration_g,
            friction: here.friction,
            secant_period_s: (!last).then(|| 2.0 * std::f64::consts::PI * square_s2.sqrt()),
        }
    }

    /// First point of the curve: `a(0) = A_L`, and `a0*`.
    ///
    /// # Panics
    /// Never: a curve has points.
    pub fn first_point(&self) -> &CurvePoint {
        self.curve.first().expect("a curve has points")
    }

    /// Last point of the curve: the ultimate displacement, and `d0*`.
    ///
    /// # Panics
    /// Never: a curve has points.
    pub fn end(&self) -> &CurvePoint {
        self.curve.last().expect("a curve has points")
    }

    /// Acceleration of the equivalent oscillator, in multiples of gravity, at a fraction of `d0*` between 0 and 1, by linear
    /// interpolation of the curve.
    pub fn oscillator_acceleration_g(&self, part: f64) -> f64 {
        let wanted_m = part * self.end().oscillator_displacement_m;
        let mut pairs = self.curve.windows(2);
        let pair = pairs.find(|pair| pair[1].oscillator_displacement_m >= wanted_m);
        let Some([low, high]) = pair else {
            return self.end().oscillator_acceleration_g;
        };
        let share = (wanted_m - low.oscillator_displacement_m)
            / (high.oscillator_displacement_m - low.oscillator_displacement_m);
        low.oscillator_acceleration_g
            + share * (high.oscillator_acceleration_g - low.oscillator_acceleration_g)
    }

    /// Secant period, in seconds, at a fraction of the ultimate displacement between 0 and 1; `None` at the end of the curve.
    pub fn secant_period_s(&self, part: f64, gravity_m_s2: f64) -> Option<f64> {
        let wanted_m = part * self.end().oscillator_displacement_m;
        let acceleration_g = self.oscillator_acceleration_g(part);
        let square_s2 = wanted_m / (gravity_m_s2 * acceleration_g);
        (acceleration_g > 0.0).then(|| 2.0 * std::f64::consts::PI * square_s2.sqrt())
    }
}
