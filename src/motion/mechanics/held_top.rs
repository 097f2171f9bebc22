//! Vertical bending: a wall whose top is held sideways and may rise under the weight of a floor.
//!
//! A push opens two hinges, one at the face towards which it pushes (at the base of a uniform wall), one above it at the other face. The lower body
//! turns towards the push, the upper one back, because its top stays on its vertical line. With the horizontal reaction `R` of the floor at the height
//! `H`, the static theorem of limit analysis asks for a push `a` and an `R` for which the resultant stays within all sections. The moments of the loads
//! above a section about its two edges, `h` below the top, bound `R` by lines in `a`:
//!
//! `R >= (a A - S) / h` at the edge towards which the wall is pushed, and `R <= (a A + S') / h` at the other one,
//!
//! with the moment `A` of the masses, and the moments `S` and `S'` of all vertical loads and constant forces. The largest push is at the intersection
//! of two lines, the two hinges. Newton's method for the least distance of the bounds finds it from above (Dinkelbach 1967, see
//! [`stability`](super::stability)): every step is the push of a mechanism, so the kinematic theorem gives the same number.
//!
//! Without drums a hinge may lie at any height. Between two loads `A` is a quadratic and `S` a linear function of `h`, so the first bound is largest at
//! an end of such a stretch, and the second one is least there or at a height in closed form.
//!
//! At finite rotations the hinges stay in the same sections, and the point of the floor's weight on its vertical line.

use std::f64::consts::FRAC_PI_2;

use nalgebra::Vector2;
use thiserror::Error;

use super::capacity::CapacityError;
use super::chain::LEAST_LOAD;
use super::settling::Pin;
use crate::bisection::{Width, bisect};
use crate::mechanics::{
    Column, Displaced, Edge, Hinge, Momentum, MovingBody, MovingForce, Pose, Row, RowError, Sway,
    Twist, load_multiplier,
};

/// Reason why a column with a held top has no mechanism.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum HeldTopError {
    /// Its drums do not form a row.
    #[error(transparent)]
    Row(#[from] RowError),
    /// The top of the column is free.
    #[error("its top is free")]
    Free,
    /// The column cannot carry its loads, even without a push.
    #[error(
        "the resultant of its weight and its loads leaves a section, without ground motion; give less load or eccentricity, or a wider column"
    )]
    CannotStand,
    /// The linkage has no unstable equilibrium.
    #[error(transparent)]
    Locks(#[from] CapacityError),
    /// The forces of its ties change.
    #[error(
        "the forces of ties change as the wall bends, and are not followed: leave the ties out, or run `limit`"
    )]
    Ties,
}

/// Rotation of the lower body in a step of the search for the unstable equilibrium, in radians.
const STEP_RAD: f64 = 1e-3;
/// Distance below a load, relative to its height, of the highest section that carries it. [`Column::drum_at`] tolerates a tenth of it.
const BELOW_LOAD: f64 = 1e-8;
/// Relative decrease of the push that counts as none.
const ROUNDING: f64 = 1e-14;

/// Bound of the reaction `R` in N, `value + slope a`, as a function of the push `a` in multiples of gravity.
#[derive(Clone, Copy, Debug)]
struct Bound {
    slope: f64,
    value: f64,
    /// Height of its section, in metres.
    height_m: f64,
}

/// Lower and upper bound of the reaction.
type Bounds = [Bound; 2];

impl Bound {
    fn at_push(&self, push_g: f64) -> f64 {
        self.value + self.slope * push_g
    }
}

/// Push at which two bounds meet.
fn meeting_g([lower, upper]: &Bounds) -> f64 {
    (upper.value - lower.value) / (lower.slope - upper.slope)
}

/// Largest of the lower and least of the upper bounds of several sections, for a push.
fn tightest(sections: &[Bounds], push_g: f64) -> Bounds {
    let force_n = |bound: &Bound| bound.at_push(push_g);
    let first = sections[0];
    sections.iter().fold(first, |[lower, upper], [low, high]| {
        [
            if force_n(low) > force_n(&lower) {
                *low
            } else {
                lower
            },
            if force_n(high) < force_n(&upper) {
                *high
            } else {
                upper
            },
        ]
    })
}

/// Lower and upper bound that meet at the largest push with a reaction between all bounds. `sections` returns the bounds that may be the tightest ones for
/// a push, from the base up; the search starts with those of the first and the last one.
///
/// # Errors
/// When no reaction lies between the bounds without a push.
fn active_bounds(
    sections: impl Fn(f64) -> Result<Vec<Bounds>, HeldTopError>,
) -> Result<Bounds, HeldTopError> {
    let at_rest = sections(0.0)?;
    let [least, most] = tightest(&at_rest, 0.0);
    if least.value > most.value {
        return Err(HeldTopError::CannotStand);
    }
    let mut active = [at_rest[0][0], at_rest[at_rest.len() - 1][1]];
    loop {
        let push_g = meeting_g(&active);
        let next = tightest(&sections(push_g)?, push_g);
        // Every push is that of another mechanism, so the search ends.
        let falls = next[0].at_push(push_g) > next[1].at_push(push_g)
            && meeting_g(&next) < push_g * (1.0 - ROUNDING);
        if !falls {
            return Ok(active);
        }
        active = next;
    }
}

/// Drums of a wall with a held top, in the frame of a sway to the right.
#[derive(Clone, Debug)]
struct PushedWall {
    /// Mass in kg and centre in metres of each drum.
    drums: Vec<(f64, Vector2<f64>)>,
    /// Constant forces, and tie forces at rest, in N, each after its drum and its point in metres; the weight of the floor comes last.
    forces: Vec<(usize, Vector2<f64>, Vector2<f64>)>,
    /// Corners of each joint in metres: that towards which the wall sways, and the opposite one.
    joints_m: Vec<[Vector2<f64>; 2]>,
    /// Point of the weight of the floor, in metres.
    top_m: Vector2<f64>,
    gravity_m_s2: f64,
}

impl PushedWall {
    fn new(column: &Column, row: &Row, sway: Sway) -> Result<Self, HeldTopError> {
        let top = column.top.ok_or(HeldTopError::Free)?;
        let seen = |at_m: Vector2<f64>| sway.seen(at_m);
        let drums = row.blocks.iter();
        let drums = drums.map(|drum| (drum.mass_kg, seen(drum.centre_m)));
        let ties = row.ties.iter().filter(|tie| tie.prestress_n > 0.0);
        let pulls = ties.flat_map(|tie| {
            let pull_n = seen(tie.force_at_rest_n());
            let ends = tie.ends.into_iter().zip([pull_n, -pull_n]);
            ends.filter_map(move |(end, pull_n)| Some((end.block?, seen(end.at_m), pull_n)))
        });
        let top_m = seen(Vector2::new(top.x_m, column.height_m));
        let weight_n = Vector2::new(0.0, -top.weight_n);
        let floor = (row.blocks.len() - 1, top_m, weight_n);
        let corners_m = row.joints.iter().map(|joint| {
            let [toe, heel] = edges(sway);
            [seen(joint.corner_m(toe)), seen(joint.corner_m(heel))]
        });
        Ok(Self {
            drums: drums.collect(),
            forces: pulls.chain([floor]).collect(),
            joints_m: corners_m.collect(),
            top_m,
            gravity_m_s2: column.gravity_m_s2,
        })
    }

    /// Loads above a joint, and the inertia forces there for a push of 1 g, in N with their moments about the origin. Each point of a drum is at the
    /// position `moved`.
    fn above(
        &self,
        joint: usize,
        moved: impl Fn(usize, Vector2<f64>) -> Vector2<f64>,
    ) -> [Momentum; 2] {
        let [mut rest, mut push] = [Momentum::ZERO; 2];
        for (drum, (mass_kg, centre_m)) in self.drums.iter().enumerate().skip(joint) {
            let (at_m, weight_n) = (moved(drum, *centre_m), mass_kg * self.gravity_m_s2);
            rest = rest + Momentum::applied_at(at_m, Vector2::new(0.0, -weight_n));
            push = push + Momentum::applied_at(at_m, Vector2::new(weight_n, 0.0));
        }
        for (drum, at_m, force_n) in self.forces.iter().filter(|(drum, ..)| *drum >= joint) {
            rest = rest + Momentum::applied_at(moved(*drum, *at_m), *force_n);
        }
        [rest, push]
    }

    /// Bounds from the resultant at a joint, which stays between its corners.
    fn hinge_bounds(&self, joint: usize) -> Bounds {
        let [rest, push] = self.above(joint, |_, at_m| at_m);
        self.joints_m[joint].map(|corner_m| {
            let arm_m = self.top_m.y - corner_m.y;
            Bound {
                slope: -push.moment_about(corner_m) / arm_m,
                value: -rest.moment_about(corner_m) / arm_m,
                height_m: corner_m.y,
            }
        })
    }

    /// Bounds from the friction at a joint.
    fn slide_bounds(&self, joint: usize, coefficient: f64) -> Bounds {
        let [rest, push] = self.above(joint, |_, at_m| at_m);
        [coefficient, -coefficient].map(|coefficient| Bound {
            slope: push.linear.x,
            value: rest.linear.x + coefficient * rest.linear.y,
            height_m: self.joints_m[joint][0].y,
        })
    }
}

/// Edges of the lower and of the upper hinge of a wall that sways to a side.
const fn edges(sway: Sway) -> [Edge; 2] {
    match sway {
        Sway::Right => [Edge::Extrados, Edge::Intrados],
        Sway::Left => [Edge::Intrados, Edge::Extrados],
    }
}

/// Bounds of the sections of a wall without drums that may be the tightest ones for a push: at the ends of each stretch between forces, and
/// where the upper bound is stationary.
fn bounds_of_prism(column: &Column, sway: Sway, push_g: f64) -> Result<Vec<Bounds>, HeldTopError> {
    let section = |height_m: f64| {
        let row = column.cut_at(&[height_m]).row()?;
        let wall = PushedWall::new(column, &row, sway)?;
        Ok::<_, HeldTopError>((wall, row.blocks.len() - 1))
    };
    let weight_n_m = column.density_kg_m3 * column.depth_m * column.width_m * column.gravity_m_s2;
    let heel_m = Vector2::new(-0.5 * column.width_m, column.height_m);
    let mut sections = Vec::new();
    for ends_m in column.heights_of_forces_m().windows(2) {
        let (low_m, high_m) = (ends_m[0], ends_m[1] * (1.0 - BELOW_LOAD));
        // Moment of the forces and masses of loads about the heel of the top; over the depth below the top it is one term of the upper bound.
        let depth_m = column.height_m - low_m;
        let (wall, joint) = section(low_m)?;
        let [rest, push] = wall.above(joint, |_, at_m| at_m);
        let moment = rest.moment_about(heel_m) - weight_n_m * depth_m * heel_m.x
            + push_g * (push.moment_about(heel_m) - 0.5 * weight_n_m * depth_m * depth_m);
        let stationary_m = (-2.0 * moment / (push_g * weight_n_m)).sqrt();
        let between = column.height_m - stationary_m;
        let inside = (low_m < between && between < high_m).then_some(between);
        sections.push(wall.hinge_bounds(joint));
        for height_m in inside.into_iter().chain((high_m > low_m).then_some(high_m)) {
            let (wall, joint) = section(height_m)?;
            sections.push(wall.hinge_bounds(joint));
        }
    }
    Ok(sections)
}

/// Mechanism of vertical bending that a push to a side starts.
#[derive(Clone, Debug)]
pub struct HeldMechanism {
    /// The wall as drums; a wall without drums is cut at its hinges.
    pub row: Row,
    /// Lower and upper hinge: joints of this row.
    pub pins: [Pin; 2],
    /// Horizontal ground acceleration against the sway that starts it, in multiples of gravity.
    pub acceleration_g: f64,
    /// Horizontal force of the floor on the wall at that acceleration, in N, positive against the sway.
    pub reaction_n: f64,
    /// True for a wall without drums.
    pub is_cut: bool,
    sway: Sway,
    wall: PushedWall,
}

/// Displaced bodies of a mechanism, in the frame of a sway to the right.
struct BentWall {
    /// Poses of the lower and the upper body.
    poses: [Pose; 2],
    /// Velocities of the bodies for a unit rate of the lower one.
    twists: [Twist; 2],
    /// Upper hinge, and point of the weight of the floor, in metres.
    hinge_m: Vector2<f64>,
    top_m: Vector2<f64>,
}

impl HeldMechanism {
    /// Finds the mechanism that a push to a side starts, with the tie forces at rest.
    ///
    /// # Errors
    /// When the top of the column is free, or the column cannot stand.
    pub fn new(column: &Column, sway: Sway) -> Result<Self, HeldTopError> {
        let is_cut = column.is_one_block();
        let active = match is_cut {
            true => active_bounds(|push_g| bounds_of_prism(column, sway, push_g))?,
            false => {
                let wall = PushedWall::new(column, &column.row()?, sway)?;
                let joints = 0..wall.joints_m.len();
                let sections: Vec<Bounds> = joints.map(|joint| wall.hinge_bounds(joint)).collect();
                active_bounds(|_| Ok(sections.clone()))?
            }
        };
        let heights_m = active.map(|bound| bound.height_m);
        let row = match is_cut {
            true => column.cut_at(&heights_m).row()?,
            false => column.row()?,
        };
        let near = |height_m: f64| {
            let away_m = |joint: &usize| (row.joints[*joint].intrados_m.y - height_m).abs();
            let joints = 0..row.joints.len();
            joints.min_by(|one, other| away_m(one).total_cmp(&away_m(other)))
        };
        let [low, high] = heights_m.map(|height_m| near(height_m).unwrap_or(0));
        let [toe, heel] = edges(sway);
        let acceleration_g = meeting_g(&active);
        Ok(Self {
            pins: [(low, toe), (high, heel)].map(|(joint, edge)| Pin { joint, edge }),
            acceleration_g,
            reaction_n: active[0].at_push(acceleration_g),
            is_cut,
            sway,
            wall: PushedWall::new(column, &row, sway)?,
            row,
        })
    }

    /// Hinges, the lower one first: joints between drums, and heights of a wall without drums.
    pub fn hinges(&self) -> [Hinge; 2] {
        self.pins.map(|Pin { joint, edge }| match self.is_cut {
            false => Hinge::Joint {
                joint,
                edge: Some(edge),
            },
            true => {
                let side = if edge == Edge::Intrados {
                    Sway::Left
                } else {
                    Sway::Right
                };
                match self.row.joints[joint].intrados_m.y {
                    0.0 => Hinge::Toe(side),
                    height_m => Hinge::Face { height_m, side },
                }
            }
        })
    }

    /// Positions of the hinges at rest, in metres.
    pub fn hinges_m(&self) -> [Vector2<f64>; 2] {
        self.pins
            .map(|pin| self.row.joints[pin.joint].corner_m(pin.edge))
    }

    /// Body of a drum, 0 for the lower and 1 for the upper one; `None` below the lower hinge, where the wall does not move.
    pub fn body_of(&self, drum: usize) -> Option<usize> {
        let below = self.pins.iter().filter(|pin| pin.joint <= drum).count();
        below.checked_sub(1)
    }

    /// Positions for a rotation of the lower body; `None` beyond the limit of the linkage.
    fn bent(&self, q_rad: f64) -> Option<BentWall> {
        let [toe_m, heel_m] = [0, 1].map(|at| self.wall.joints_m[self.pins[at].joint][at]);
        let lower = Pose::about(toe_m, toe_m, -q_rad);
        let hinge_m = lower.current_position(heel_m);
        let built_m = self.wall.top_m - heel_m;
        let apart_m = self.wall.top_m.x - hinge_m.x;
        let square_m2 = built_m.y.powi(2) + (built_m.x - apart_m) * (built_m.x + apart_m);
        let above_m = Some(square_m2).filter(|square_m2| *square_m2 > 0.0)?.sqrt();
        let turned_rad = libm::atan2(above_m, apart_m) - libm::atan2(built_m.y, built_m.x);
        let first = Twist::rotation(toe_m, -1.0);
        // The point of the floor's weight has no horizontal velocity.
        let rate = first.velocity_at(hinge_m).x / above_m;
        Some(BentWall {
            poses: [lower, Pose::about(heel_m, hinge_m, turned_rad)],
            twists: [first, first + Twist::rotation(hinge_m, rate + 1.0)],
            hinge_m,
            top_m: hinge_m + Vector2::new(apart_m, above_m),
        })
    }

    /// Bodies from the lower one up, and forces, with their virtual displacements in a displaced position.
    fn moving(&self, bent: &BentWall) -> (Vec<MovingBody>, Vec<MovingForce>) {
        let real = |at_m: Vector2<f64>| self.sway.seen(at_m);
        let displacement = |body: usize, at_m: Vector2<f64>| {
            bent.twists[body].velocity_at(bent.poses[body].current_position(at_m))
        };
        let bodies = [0, 1].map(|body| {
            let own = |drum: &usize| self.body_of(*drum) == Some(body);
            let drums = (0..self.wall.drums.len())
                .filter(own)
                .map(|drum| self.wall.drums[drum]);
            let mass_kg = drums.clone().map(|(mass_kg, _)| mass_kg).sum();
            let first: Vector2<f64> = drums.map(|(mass_kg, centre_m)| centre_m * mass_kg).sum();
            let centre_m = first / mass_kg;
            MovingBody {
                mass_kg,
                centre_m: real(centre_m),
                displacement: displacement(body, centre_m),
                rotation: -bent.twists[body].rate,
            }
        });
        let forces = self.wall.forces.iter().filter_map(|(drum, at_m, force_n)| {
            Some(MovingForce {
                at_m: real(*at_m),
                force_kg: force_n / self.wall.gravity_m_s2,
                displacement: displacement(self.body_of(*drum)?, *at_m),
            })
        });
        (bodies.into(), forces.collect())
    }

    /// Bodies and forces of the first motion, with their virtual displacements per radian of the lower body: constant forces, ties with their forces at
    /// rest, and last the weight of the floor.
    ///
    /// # Panics
    /// Never: the undeformed bodies meet.
    pub fn first_motion(&self) -> (Vec<MovingBody>, Vec<MovingForce>) {
        self.moving(&self.bent(0.0).expect("the undeformed bodies meet"))
    }

    /// Rotation of the lower body at the unstable equilibrium, in radians.
    ///
    /// # Errors
    /// When the linkage reaches its limit before, or the wall has ties.
    pub fn end_rad(&self) -> Result<f64, HeldTopError> {
        match self.row.bars().is_empty() {
            true => Ok(self.unstable_rad()?),
            false => Err(HeldTopError::Ties),
        }
    }

    /// Rotation of the lower body at which the push becomes zero with the forces at rest, in radians.
    ///
    /// # Errors
    /// When the linkage reaches its limit before.
    pub fn unstable_rad(&self) -> Result<f64, CapacityError> {
        let resists = |q_rad: f64| Some(self.push_g(&self.bent(q_rad)?) > 0.0);
        let steps = (1_u32..).map(|step| f64::from(step) * STEP_RAD);
        let mut steps = steps.take_while(|q_rad| *q_rad < FRAC_PI_2);
        match steps.find(|q_rad| resists(*q_rad) != Some(true)) {
            // Curves also need positions just before the start; with a hinge at the top there are none.
            Some(q_rad) if resists(q_rad) == Some(false) && self.bent(-1e-4 * q_rad).is_some() => {
                let falls = |q_rad| resists(q_rad) == Some(false);
                Ok(bisect(q_rad - STEP_RAD, q_rad, Width::Rounding, falls).1)
            }
            _ => Err(CapacityError::Locks(self.sway)),
        }
    }

    /// Push in equilibrium with weights and forces in a displaced position, in multiples of gravity.
    fn push_g(&self, bent: &BentWall) -> f64 {
        let (bodies, forces) = self.moving(bent);
        load_multiplier(&bodies, &[], &forces)
    }

    /// Mechanism at a rotation of the lower body, with the forces at rest.
    ///
    /// # Panics
    /// If the rotation is beyond the unstable equilibrium.
    pub fn displaced(&self, q_rad: f64) -> Displaced {
        let bent = self
            .bent(q_rad)
            .expect("the bodies meet up to the unstable equilibrium");
        let push_g = self.push_g(&bent);
        let real = |pose: Pose| match self.sway {
            Sway::Right => pose,
            Sway::Left => pose.mirrored(),
        };
        let toe_m = self.wall.joints_m[self.pins[0].joint][0];
        Displaced {
            q_rad,
            acceleration_g: push_g,
            poses: bent.poses.map(real).to_vec(),
            hinges_m: [toe_m, bent.hinge_m]
                .map(|at_m| self.sway.seen(at_m))
                .to_vec(),
            friction: self.friction(&bent, push_g),
        }
    }

    /// Friction coefficient that the joints need in equilibrium at a displaced position.
    fn friction(&self, bent: &BentWall, push_g: f64) -> f64 {
        let moved = |drum: usize, at_m: Vector2<f64>| {
            self.body_of(drum)
                .map_or(at_m, |body| bent.poses[body].current_position(at_m))
        };
        let loads = |joint: usize| {
            let [rest, push] = self.wall.above(joint, moved);
            rest + push * push_g
        };
        // The upper body is in equilibrium about its hinge.
        let about = loads(self.pins[1].joint).moment_about(bent.hinge_m);
        let reaction_n = -about / (bent.top_m.y - bent.hinge_m.y);
        let least_n = LEAST_LOAD * self.row.mass_kg() * self.wall.gravity_m_s2;
        let joints = (0..self.wall.joints_m.len()).map(|joint| {
            let force_n = loads(joint).linear - Vector2::new(reaction_n, 0.0);
            // A hinge has the mean direction of its faces.
            let turn = |drum: Option<usize>| {
                let body = drum.and_then(|drum| self.body_of(drum));
                body.map_or(0.0, |body| bent.poses[body].rotation_rad())
            };
            let turned_rad = 0.5 * (turn(joint.checked_sub(1)) + turn(Some(joint)));
            let tangent = Pose::new(turned_rad, Vector2::zeros()).current_direction(Vector2::x());
            let pressed_n = force_n.perp(&tangent);
            match pressed_n >= least_n {
                true => (force_n.dot(&tangent) / pressed_n).abs(),
                false => 0.0,
            }
        });
        joints.fold(0.0, f64::max)
    }

    /// Upper bound of the push at which joints slide, by associated limit analysis, in multiples of gravity; zero if they slide without a push. `None` if the
    /// mechanism without sliding starts first. A wall without drums slides at its hinges.
    pub fn slide_bound_g(&self, coefficient: f64) -> Option<f64> {
        let joints = 0..self.wall.joints_m.len();
        let hinges = joints.clone().map(|joint| self.wall.hinge_bounds(joint));
        let mut sections: Vec<Bounds> = hinges.collect();
        // The search starts with hinges at the first and the last joint.
        let slides = joints.map(|joint| self.wall.slide_bounds(joint, coefficient));
        sections.splice(1..1, slides);
        match active_bounds(|_| Ok(sections.clone())) {
            Ok(active) => Some(meeting_g(&active))
                .filter(|push_g| *push_g < self.acceleration_g * (1.0 - 1e-9)),
            Err(_) => Some(0.0),
        }
    }
}
