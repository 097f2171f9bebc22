//! The quasi-static capacity of a mechanism at finite displacements, and its equivalent oscillator.
//!
//! Held at the rotation `q`, the first mechanism is in equilibrium under gravity and the horizontal acceleration
//! `a(q) = S_y(q) / S_x(q)` (in g). This follows from virtual power, as at the onset, where `a(0) = A_L`. The acceleration
//! falls to zero at the unstable equilibrium. Drawn against the horizontal displacement `d` of a control point it is the
//! capacity curve; `d` at its end is the ultimate displacement.
//!
//! The equivalent oscillator is that of the kinematic approach to masonry (reviewed by Casapulla, Giresini and Lourenço,
//! Rocking and kinematic approaches for rigid block analysis of masonry walls, Buildings 7, 69, 2017), defined
//! here as follows. With `m_i` the masses of the blocks at their centres of gravity, `u_i` the horizontal velocities of these
//! as the mechanism starts and `u_c` that of the control point,
//!
//! - participating mass `M* = (sum m u)^2 / sum m u^2`, fraction `e* = M* / sum m`;
//! - acceleration `a* = a / e*`: `M* a*` is the force `a sum m`;
//! - displacement `d* = d sum m u^2 / (u_c sum m u)`;
//! - secant period `T = 2 pi sqrt(d* / (g a*))`.
//!
//! The sums run over the blocks that the mechanism moves. One block has `e* = 1`.

use nalgebra::Vector2;
use serde::Serialize;
use thiserror::Error;

use super::chain::{Mechanism as _, MechanismChain, Motion};
use super::geometry::field::Twist;
use super::geometry::pose::Pose;
use super::sway::Sway;
use super::virtual_work::{MovingBody, Participation};

/// A structure displaced along its first mechanism.
#[derive(Clone, Debug, PartialEq)]
pub struct Displaced {
    /// The coordinate of the mechanism, in radians.
    pub q_rad: f64,
    /// Horizontal acceleration of the ground, against the sway, that holds it in equilibrium, in units of gravity.
    pub acceleration_g: f64,
    /// Poses of its bodies from left to right, in metres, in the frame of the ground.
    pub poses: Vec<Pose>,
    /// Positions of its hinges from left to right, likewise.
    pub hinges_m: Vec<Vector2<f64>>,
    /// Friction coefficient below which it would slide there, held at rest by that acceleration.
    pub friction: f64,
}

/// The first mechanism to a side, displaced by this fraction of the way to its unstable equilibrium.
#[must_use]
pub fn displaced<C: MechanismChain>(structure: &C, sway: Sway, part: f64) -> Option<Displaced> {
    let link = structure.link_from(sway, 0)?;
    let q_rad = part * link.critical_rad;
    let coefficients = link.mechanism.coefficients(q_rad);
    let acceleration_g = coefficients.s_y / coefficients.s_x;
    let held = Motion {
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

/// The rigid bodies of the first mechanism to a side, from left to right, with their virtual displacements for one radian of
/// its coordinate, in metres. Parts that stand still are left out.
#[must_use]
pub fn moving_bodies<C: MechanismChain>(structure: &C, sway: Sway) -> Option<Vec<MovingBody>> {
    let mechanism = &structure.link_from(sway, 0)?.mechanism;
    let (mut poses, mut hinges) = (Vec::new(), Vec::new());
    mechanism.place(0.0, &mut poses, &mut hinges);
    let rates = mechanism.rotation_rates(0.0);
    // Every hinge adds a rotation about itself to the motion of the body before it.
    let mut twist = Twist::ZERO;
    let bodies = mechanism.moments().into_iter().zip(&hinges);
    let moving = bodies.zip(rates.as_ref()).map(|((moments, hinge), rate)| {
        twist = twist + Twist::rotation(*hinge, rate - twist.rate);
        let centre = moments.centroid();
        MovingBody {
            mass_kg: moments.mass * structure.mass_unit_kg(),
            centre_m: Vector2::new(sway.sign() * centre.x, centre.y) * structure.length_m(),
            displacement: twist.at(centre) * structure.length_m(),
            rotation: -rate,
        }
    });
    let mut moving: Vec<MovingBody> = moving.collect();
    if sway == Sway::Left {
        moving.reverse();
    }
    Some(moving)
}

/// A point that moves with a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Carried {
    /// Its position in the undeformed structure, in metres.
    pub at_m: Vector2<f64>,
    /// Index of the body; `None`: it stands still.
    pub body: Option<usize>,
}

impl Carried {
    /// Its horizontal displacement in metres.
    fn shift_m(&self, poses: &[Pose]) -> f64 {
        let pose = self.body.and_then(|body| poses.get(body));
        pose.map_or(0.0, |pose| (pose.of(self.at_m) - self.at_m).x)
    }
}

/// The point whose displacement is reported: a point of the structure, or the common centre of several.
#[derive(Clone, Debug, PartialEq)]
pub struct Control {
    /// Its position in the undeformed structure, in metres.
    pub at_m: Vector2<f64>,
    /// The points with their weights, which add up to one.
    points: Vec<(f64, Carried)>,
}

impl Control {
    /// A point of the structure.
    #[must_use]
    pub fn point(point: Carried) -> Self {
        Self {
            at_m: point.at_m,
            points: vec![(1.0, point)],
        }
    }

    /// The common centre of the masses, in kg, that move.
    #[must_use]
    pub fn centre_of(masses: &[(f64, Carried)]) -> Self {
        let moving = || masses.iter().filter(|(_, point)| point.body.is_some());
        let whole_kg: f64 = moving().map(|(mass_kg, _)| mass_kg).sum();
        let points = moving().map(|(mass_kg, point)| (mass_kg / whole_kg, *point));
        let points: Vec<(f64, Carried)> = points.collect();
        let at_m = points.iter().map(|(part, point)| point.at_m * *part).sum();
        Self { at_m, points }
    }

    /// Its horizontal displacement in metres.
    fn shift_m(&self, poses: &[Pose]) -> f64 {
        let points = self.points.iter();
        let shifts_m = points.map(|(part, point)| part * point.shift_m(poses));
        shifts_m.sum()
    }
}

/// A point of the capacity curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvePoint {
    /// The coordinate of the mechanism, in radians.
    pub q_rad: f64,
    /// Displacement of the control point in the direction of the sway, in metres.
    pub displacement_m: f64,
    /// Acceleration `a`, in g.
    pub acceleration_g: f64,
    /// Displacement `d*` of the oscillator, in metres.
    pub oscillator_displacement_m: f64,
    /// Its acceleration `a*`, in g.
    pub oscillator_acceleration_g: f64,
    /// Its secant period in seconds, 0 at rest; `None` at the unstable equilibrium, where it is infinite.
    pub secant_period_s: Option<f64>,
    /// Friction coefficient below which it would slide there.
    pub friction: f64,
}

/// The capacity of the first mechanism to a side.
#[derive(Clone, Debug, PartialEq)]
pub struct Capacity {
    /// To which side.
    pub sway: Sway,
    /// The control point.
    pub control: Control,
    /// Participating mass `M*` in kg.
    pub participating_mass_kg: f64,
    /// `e*`: the participating mass as a fraction of the mass that moves.
    pub mass_fraction: f64,
    /// Factor from displacements of the control point to those of the oscillator.
    pub to_oscillator: f64,
    /// From rest to the unstable equilibrium, at equal steps of the coordinate, and where ties yield or break.
    pub curve: Vec<CurvePoint>,
    /// Points of the way at which its ties give way; empty without ties.
    pub ties: Vec<TieOnTheWay>,
}

/// Parts of the way to the unstable equilibrium at which a tie yields or breaks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GivesWay {
    /// The part of the way at which it first yields, if it does.
    pub yields: Option<f64>,
    /// The last at which it is whole and the first at which it is broken, if it breaks.
    pub breaks: Option<[f64; 2]>,
}

/// Displacements of the control point at which a tie yields or breaks, in metres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TieOnTheWay {
    /// Displacement at which it yields, if it does.
    pub yields_at_m: Option<f64>,
    /// Displacement at which it breaks, if it does.
    pub breaks_at_m: Option<f64>,
}

/// Why there is no capacity curve.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum CapacityError {
    /// The control point stands still, or moves against the sway.
    #[error(
        "the control point ({:?}, {:?}) m does not move to the {side} with the mechanism: choose a point of a block that does",
        .at_m.x, .at_m.y, side = .sway.name()
    )]
    Control {
        /// Its position.
        at_m: Vector2<f64>,
        /// The side.
        sway: Sway,
    },
    /// There is no unstable equilibrium.
    #[error(
        "the linkage that sways to the {side} comes to the end of its way before it loses its strength: it has no ultimate \
         displacement", side = .sway.name()
    )]
    Locks {
        /// The side.
        sway: Sway,
    },
}

/// Intervals of a capacity curve.
const INTERVALS: u32 = 100;

/// Step of the central differences that give the velocities at the start, as a fraction of the way to the unstable
/// equilibrium: their error is its square.
const START: f64 = 1e-5;

impl Capacity {
    /// The capacity of a mechanism given by its positions at fractions of the way to the unstable equilibrium; `masses`
    /// are in kg.
    ///
    /// # Errors
    /// When the control point does not move, or the mechanism locks before its acceleration falls to zero.
    pub fn new(
        sway: Sway,
        displaced: impl Fn(f64) -> Displaced,
        masses: &[(f64, Carried)],
        control: Control,
        gravity_m_s2: f64,
    ) -> Result<Self, CapacityError> {
        let near = [-START, START].map(&displaced);
        let velocity = |shift_m: &dyn Fn(&[Pose]) -> f64| {
            let [before_m, after_m] = [0, 1].map(|at| shift_m(&near[at].poses));
            sway.sign() * (after_m - before_m) / (near[1].q_rad - near[0].q_rad)
        };
        let control_velocity = velocity(&|poses| control.shift_m(poses));
        let moving = masses.iter().filter(|(_, point)| point.body.is_some());
        let moving =
            moving.map(|(mass_kg, point)| (*mass_kg, velocity(&|poses| point.shift_m(poses))));
        let moving: Vec<(f64, f64)> = moving.collect();
        let speeds = moving.iter().map(|(_, velocity)| velocity.abs());
        let fastest = speeds.fold(0.0, f64::max);
        if control_velocity <= 1e-9 * fastest {
            let at_m = control.at_m;
            return Err(CapacityError::Control { at_m, sway });
        }
        let participation = Participation::of(moving);
        let to_oscillator = participation.oscillator_displacement / control_velocity;
        // At the end of the way the acceleration may be NaN.
        let [start_g, end_g] = [0.0, 1.0].map(|part| displaced(part).acceleration_g);
        if end_g.is_nan() || end_g.abs() > 1e-6 * start_g {
            return Err(CapacityError::Locks { sway });
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

    /// This capacity with points where ties yield, and just before and after they break.
    #[must_use]
    pub fn with_ties(
        mut self,
        give_way: &[GivesWay],
        displaced: impl Fn(f64) -> Displaced,
        gravity_m_s2: f64,
    ) -> Self {
        for GivesWay { yields, breaks } in give_way {
            let point = |part: f64| self.point(part, &displaced(part), gravity_m_s2);
            let yields = yields.map(point);
            let breaks = breaks.map(|around| around.map(point));
            self.ties.push(TieOnTheWay {
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

    /// The point at this part of the way.
    fn point(&self, part: f64, here: &Displaced, gravity_m_s2: f64) -> CurvePoint {
        // Rounding may leave the first displacement and the last acceleration on either side of zero.
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

    /// Its start: `a(0) = A_L`, and `a0*`.
    ///
    /// # Panics
    /// Never: a curve has points.
    #[must_use]
    pub fn start(&self) -> &CurvePoint {
        self.curve.first().expect("a curve has points")
    }

    /// Its end: the ultimate displacement, and `d0*`.
    ///
    /// # Panics
    /// Never: a curve has points.
    #[must_use]
    pub fn end(&self) -> &CurvePoint {
        self.curve.last().expect("a curve has points")
    }

    /// The acceleration of the oscillator, in g, at this fraction of `d0*`, between 0 and 1, interpolated linearly between
    /// the points of the curve.
    #[must_use]
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

    /// The secant period, in seconds, at this fraction of the ultimate displacement, between 0 and 1; `None` at its end.
    #[must_use]
    pub fn secant_period_s(&self, part: f64, gravity_m_s2: f64) -> Option<f64> {
        let wanted_m = part * self.end().oscillator_displacement_m;
        let acceleration_g = self.oscillator_acceleration_g(part);
        let square_s2 = wanted_m / (gravity_m_s2 * acceleration_g);
        (acceleration_g > 0.0).then(|| 2.0 * std::f64::consts::PI * square_s2.sqrt())
    }
}
