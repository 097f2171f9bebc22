//! Where a row goes that gives way slowly: down the steepest way of its potential energy.
//!
//! The blocks move as in a viscous fluid that resists as their masses do. Their velocities are then those nearest to the load,
//! of all that the joints allow: the program of a step of a motion ([`crate::mechanics::contact`]). Descents that weighted
//! rotations ten and a hundred times as much led to the same hinges.

use nalgebra::Vector2;

use super::Condition;
use crate::mechanics::blocks::Row;
use crate::mechanics::contact::closing::Closer;
use crate::mechanics::contact::{ContactError, Load, Program};
use crate::mechanics::geometry::field::Twist;
use crate::mechanics::geometry::pose::Pose;
use crate::mechanics::joints::Placement;

/// Velocities below this part of those without contact count as zero.
const STANDSTILL: f64 = 1e-9;
/// No point moves by more than this part of the size in a step.
const STEP: f64 = 1e-3;
/// A block that moves by this part of the size in a descent falls.
const FALLEN: f64 = 0.5;
/// An arch whose ends miss each other by more than this part of its size has fallen apart.
const PARTED: f64 = 1e-6;
/// Steps of a descent: none needs as many, unless it goes to and fro.
const MOST_STEPS: usize = 20_000;

/// The descent of a row, with all the memory that it needs.
#[derive(Clone, Debug)]
pub(super) struct Descent<'a> {
    row: &'a Row,
    program: Program,
    closer: Closer,
    free: Vec<Twist>,
    jumps: Vec<Twist>,
    touching: Vec<[bool; 2]>,
}

impl<'a> Descent<'a> {
    pub fn new(row: &'a Row) -> Self {
        let joints = row.joints().len();
        Self {
            row,
            program: Program::new(row),
            closer: Closer::new(row),
            free: vec![Twist::ZERO; row.blocks().len()],
            jumps: vec![Twist::ZERO; joints],
            touching: vec![[true; 2]; joints],
        }
    }

    /// Takes a row from one condition to the next, a little further on, and lets it come to rest there. False where it falls instead. A
    /// push of `tilt_g` makes it choose a side.
    pub fn settle(
        &mut self,
        placement: &mut Placement,
        from: &Condition,
        to: &Condition,
        tilt_g: f64,
    ) -> Result<bool, ContactError> {
        let size_m = self.row.size_m();
        let force_g = to.force_g + Vector2::new(tilt_g, 0.0);
        self.program.reset();
        self.nudge(placement, from, to, force_g * size_m)?;
        self.jumps.fill(Twist::ZERO);
        let start_m = placement.centres_m().to_vec();
        let start_rad: Vec<f64> = placement.poses().iter().map(Pose::rotation_rad).collect();
        for _ in 0..MOST_STEPS {
            self.free.fill(Twist::translation(force_g));
            let fastest = self.solve(placement)?;
            if fastest <= STANDSTILL {
                return Ok(true);
            }
            let (length, shut) = self.first_shut(placement, STEP * size_m / fastest);
            self.go_on(placement, length, shut);
            let fallen = placement.closure_error() > PARTED * size_m
                || start_m
                    .iter()
                    .zip(placement.centres_m())
                    .any(|(start, now)| (now - start).norm() > FALLEN * size_m)
                || start_rad
                    .iter()
                    .zip(placement.poses())
                    .any(|(start, now)| (now.rotation_rad() - start).abs() > FALLEN);
            if fallen {
                return Ok(false);
            }
        }
        Ok(false)
    }

    /// Moves the supports, and the row by the velocities that they force on it while the load decides: from one joint that shuts on the
    /// way to the next.
    fn nudge(
        &mut self,
        placement: &mut Placement,
        from: &Condition,
        to: &Condition,
        load: Vector2<f64>,
    ) -> Result<(), ContactError> {
        let mut here = from.supports;
        let last = self.jumps.len() - 1;
        for _ in 0..=2 * last {
            if here == to.supports {
                break;
            }
            let moved = [0, 1].map(|side| between(&here[side], &to.supports[side]));
            self.jumps.fill(Twist::ZERO);
            self.jumps[0] = moved[0];
            self.jumps[last] = self.jumps[last] - moved[1];
            self.free.fill(Twist::translation(load));
            self.solve(placement)?;
            let (part, shut) = self.first_shut(placement, 1.0);
            here = match shut {
                None => to.supports,
                Some(_) => [0, 1].map(|side| partway(&here[side], &to.supports[side], part)),
            };
            placement.move_supports(here);
            self.go_on(placement, part, shut);
        }
        Ok(())
    }

    /// Velocities where the row is; the fastest of them.
    fn solve(&mut self, placement: &Placement) -> Result<f64, ContactError> {
        for (touching, gaps) in self.touching.iter_mut().zip(placement.gaps_m()) {
            *touching = gaps.map(|gap| gap == 0.0);
        }
        self.program.place(placement);
        self.program.solve(&Load {
            free: &self.free,
            jumps: &self.jumps,
            touching: &self.touching,
        })?;
        let velocities = self.program.velocities().iter();
        let speeds = velocities
            .zip(placement.centres_m())
            .map(|(twist, centre)| {
                let turning = twist.rate.abs() * self.row.size_m();
                twist.at(*centre).norm().max(turning)
            });
        Ok(speeds.fold(0.0, f64::max))
    }

    /// How long the last velocities may go on, at most for so long, and the corner that shuts then.
    fn first_shut(&self, placement: &Placement, longest: f64) -> (f64, Option<(usize, usize)>) {
        let mut length = longest;
        let mut first = None;
        let gaps_m = placement.gaps_m();
        for (joint, rates) in self.program.open_joints() {
            for edge in 0..2 {
                let gap = gaps_m[joint][edge];
                if gap > 0.0 && gap + length * rates[edge] < 0.0 {
                    length = -gap / rates[edge];
                    first = Some((joint, edge));
                }
            }
        }
        (length, first)
    }

    /// Goes on with the last velocities for so long, until this corner shuts.
    fn go_on(&mut self, placement: &mut Placement, length: f64, shut: Option<(usize, usize)>) {
        let gaps_m = placement.gaps_m();
        let mut change = vec![[0.0; 2]; gaps_m.len()];
        for (joint, rates) in self.program.open_joints() {
            change[joint] = rates.map(|rate| rate * length);
        }
        if let Some((joint, edge)) = shut {
            change[joint][edge] = -gaps_m[joint][edge];
        }
        placement.open(|joint| change[joint]);
        self.closer.close(placement);
    }
}

/// The pose after this part of the motion from one pose to another near by.
fn partway(from: &Pose, to: &Pose, part: f64) -> Pose {
    let between = |from: f64, to: f64| from + part * (to - from);
    let translation = from.translation + (to.translation - from.translation) * part;
    Pose::new(between(from.rotation_rad(), to.rotation_rad()), translation)
}

/// The motion, over one unit of time, that takes a body from one pose to another near by.
fn between(from: &Pose, to: &Pose) -> Twist {
    let rate = to.rotation_rad() - from.rotation_rad();
    Twist {
        at_center: to.translation
            - from.translation
            - Twist::rotation(Vector2::zeros(), rate).at(from.translation),
        rate,
    }
}
