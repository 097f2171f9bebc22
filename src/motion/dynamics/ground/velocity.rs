//! Velocity of the ground: exact integral of its acceleration.

use std::cell::Cell;

use nalgebra::Vector2;

use super::motion::GroundMotion;
use crate::mechanics::Row;

/// Velocity of the ground, which starts from rest at [`GroundMotion::start_s`].
#[derive(Clone, Debug)]
pub struct GroundVelocity<'a> {
    ground: &'a GroundMotion,
    /// Velocities at the starts of the pieces, in m/s.
    at_starts_m_s: Vec<Vector2<f64>>,
    /// Piece of the latest time: times ascend in small steps, so the next one is mostly in the same piece or the next.
    last: Cell<usize>,
}

impl<'a> GroundVelocity<'a> {
    /// Velocity of a ground motion.
    pub fn new(ground: &'a GroundMotion) -> Self {
        let (mut velocity_m_s, mut at_starts_m_s) = (Vector2::zeros(), Vec::new());
        for piece in &ground.pieces {
            at_starts_m_s.push(velocity_m_s);
            if piece.end_s.is_finite() {
                velocity_m_s += piece.velocity_gained_m_s(piece.end_s);
            }
        }
        if let Some(last) = at_starts_m_s.last_mut().filter(|_| ground.stops) {
            *last = Vector2::zeros();
        }
        Self {
            ground,
            at_starts_m_s,
            last: Cell::new(0),
        }
    }

    /// Velocity in m/s, horizontal and vertical (positive to the right and upwards), at a time not before the start. For feet that move
    /// differently it is that of the left foot.
    pub fn velocity_at(&self, time_s: f64) -> Vector2<f64> {
        let last = self.last.get();
        let is_near = |index: &usize| {
            let starts = |at: usize| self.ground.pieces.get(at).map(|piece| piece.start_s);
            let later = starts(index + 1).is_none_or(|start_s| time_s < start_s);
            later && starts(*index).is_some_and(|start_s| start_s <= time_s)
        };
        let near = [last, last + 1].into_iter().find(is_near);
        let index = near.unwrap_or_else(|| self.ground.piece_at(time_s));
        self.last.set(index);
        self.at_starts_m_s[index] + self.ground.pieces[index].velocity_gained_m_s(time_s)
    }

    /// Displacements of the ground at ascending times from the start on, in m from its position at the start. Simpson's rule is applied
    /// between times and corners; it is exact for records and constant accelerations.
    pub fn displacements_m(&self, times_s: &[f64]) -> Vec<Vector2<f64>> {
        let mut path = Path::new(self.clone());
        times_s
            .iter()
            .map(|time_s| path.advance_to(*time_s))
            .collect()
    }
}

impl GroundMotion {
    /// Displacement of the right foot relative to the left one, to the right and upwards in m, at ascending times from the start on; zero
    /// if both feet move alike.
    pub fn feet_apart_m(&self, times_s: &[f64]) -> Vec<Vector2<f64>> {
        let Some(right) = self.right_foot() else {
            return vec![Vector2::zeros(); times_s.len()];
        };
        let mut feet = FeetApart::between([self, right]);
        times_s
            .iter()
            .map(|time_s| feet.advance_to(*time_s))
            .collect()
    }
}

/// Position of the ground, advanced from its start.
#[derive(Clone, Debug)]
struct Path<'a> {
    velocity: GroundVelocity<'a>,
    /// Current piece, time and position.
    piece: usize,
    time_s: f64,
    at_m: Vector2<f64>,
}

impl<'a> Path<'a> {
    fn new(velocity: GroundVelocity<'a>) -> Self {
        Self {
            piece: 0,
            time_s: velocity.ground.start_s(),
            velocity,
            at_m: Vector2::zeros(),
        }
    }

    /// Advances to a time not before the last one, and returns the position.
    fn advance_to(&mut self, time_s: f64) -> Vector2<f64> {
        (self.piece, self.at_m) = self.position_and_piece_at(time_s);
        self.time_s = self.time_s.max(time_s);
        self.at_m
    }

    /// Position of the ground at a later time, and the piece of that time.
    fn position_and_piece_at(&self, time_s: f64) -> (usize, Vector2<f64>) {
        let pieces = &self.velocity.ground.pieces;
        let (mut index, mut from_s, mut at_m) = (self.piece, self.time_s, self.at_m);
        while from_s < time_s {
            let piece = &pieces[index];
            let to_s = piece.end_s.min(time_s);
            let start_m_s = self.velocity.at_starts_m_s[index];
            let at = |time_s: f64| start_m_s + piece.velocity_gained_m_s(time_s);
            let sum = at(from_s) + at(0.5 * (from_s + to_s)) * 4.0 + at(to_s);
            at_m += sum * ((to_s - from_s) / 6.0);
            from_s = to_s;
            if to_s == piece.end_s {
                index += 1;
            }
        }
        (index, at_m)
    }
}

/// Displacement of the right foot of a structure relative to its left foot.
#[derive(Clone, Debug)]
pub(in crate::dynamics) struct FeetApart<'a> {
    paths: [Path<'a>; 2],
    /// Time at which the relative motion ends, in seconds.
    end_s: f64,
}

impl<'a> FeetApart<'a> {
    /// Relative motion of the feet of a row; `None` if both feet move alike, or the row has only one.
    pub(in crate::dynamics) fn of(row: &Row, ground: &'a GroundMotion) -> Option<Self> {
        let right = ground.right_foot_of(row)?;
        Some(Self::between([ground, right]))
    }

    /// Relative motion of feet with given motions, left and right.
    fn between(feet: [&'a GroundMotion; 2]) -> Self {
        let [left_s, right_s] = feet.map(GroundMotion::end_s);
        Self {
            paths: feet.map(|ground| Path::new(GroundVelocity::new(ground))),
            end_s: left_s.max(right_s).max(0.0),
        }
    }

    /// Displacement at a time not before the last one, to the right and upwards, in m.
    pub(in crate::dynamics) fn advance_to(&mut self, time_s: f64) -> Vector2<f64> {
        let [left, right] = &mut self.paths;
        let time_s = time_s.min(self.end_s);
        right.advance_to(time_s) - left.advance_to(time_s)
    }

    /// Displacement at a later time, in m, without advancing.
    pub(in crate::dynamics) fn displacement_at(&self, time_s: f64) -> Vector2<f64> {
        let time_s = time_s.min(self.end_s);
        let [left_m, right_m] = self
            .paths
            .each_ref()
            .map(|path| path.position_and_piece_at(time_s).1);
        right_m - left_m
    }

    /// Velocity of the right foot relative to the left one at a time, in m/s.
    pub(in crate::dynamics) fn velocity_m_s(&self, time_s: f64) -> Vector2<f64> {
        if time_s >= self.end_s {
            return Vector2::zeros();
        }
        let [left_m_s, right_m_s] = self
            .paths
            .each_ref()
            .map(|path| path.velocity.velocity_at(time_s));
        right_m_s - left_m_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::ground::{Pulse, WaveTrain};

    /// Simpson's rule on fine parts that respect the corners errs by the fourth power of their length, below
    /// 1e-11.
    #[test]
    fn the_velocity_is_the_integral_of_the_acceleration() {
        let amplitude = Vector2::new(2.0, -0.7);
        for pulse in Pulse::ALL {
            for (cycles, phase_rad) in [(2.0, 0.0), (1.7, 0.4), (3.5, -2.0)] {
                let train = WaveTrain { cycles, phase_rad };
                let ground = pulse
                    .lasting_s(0.3)
                    .starting_at_s(0.1)
                    .with_train(train)
                    .inclined_m_s2(amplitude)
                    .unwrap();
                let exact = GroundVelocity::new(&ground);
                let (mut velocity, n) = (Vector2::zeros(), 400);
                for piece in ground.pieces.iter().filter(|p| p.end_s.is_finite()) {
                    let h = (piece.end_s - piece.start_s) / f64::from(n);
                    for i in 0..n {
                        let time = piece.start_s + h * f64::from(i);
                        let miss: Vector2<f64> = exact.velocity_at(time) - velocity;
                        assert!(miss.norm() < 1e-10, "{pulse:?} {train:?} {time} {miss}");
                        let at = |part: f64| piece.acceleration_and_rate(time + part * h).0;
                        velocity += (at(0.0) + at(0.5) * 4.0 + at(1.0)) * (h / 6.0);
                    }
                }
                assert!((exact.velocity_at(100.0) - velocity).norm() < 1e-10);
            }
        }
    }

    /// Closed forms: `a t^2 / 2` while a constant acceleration lasts, then a constant velocity; and a sine of
    /// frequency `w`, `a/w (t - sin(w t)/w)`.
    #[test]
    fn the_displacement_is_the_integral_of_the_velocity() {
        let ground = Pulse::Rectangular
            .lasting_s(0.3)
            .starting_at_s(0.1)
            .horizontal_m_s2(2.0)
            .unwrap();
        let at_m = GroundVelocity::new(&ground).displacements_m(&[0.0, 0.1, 0.25, 1.0]);
        for (at_m, due_m) in at_m.iter().zip([0.0, 0.0, 0.0225, 0.09 + 0.6 * 0.6]) {
            assert!((at_m.x - due_m).abs() < 1e-14, "{at_m} {due_m}");
        }
        let ground = Pulse::OneSine.lasting_s(0.8).horizontal_m_s2(3.0).unwrap();
        let times_s: Vec<f64> = (0..=160).map(|i| 0.005 * f64::from(i)).collect();
        let at_m = GroundVelocity::new(&ground).displacements_m(&times_s);
        let frequency = std::f64::consts::TAU / 0.8;
        for (at_m, time_s) in at_m.iter().zip(times_s) {
            let due_m = 3.0 / frequency * (time_s - (frequency * time_s).sin() / frequency);
            assert!((at_m.x - due_m).abs() < 1e-9, "{at_m} {due_m}");
        }
    }

    #[test]
    fn velocities_of_records_are_sums_of_trapezia() {
        let samples = [(0.5, 1.0), (1.0, -2.0), (1.5, 0.5)];
        let ground = GroundMotion::record(&samples, &[], 0.25).unwrap();
        let velocity = GroundVelocity::new(&ground);
        // -1/2 * 1/2 and -3/2 * 1/2.
        assert!((velocity.velocity_at(1.25).x + 0.25).abs() < 1e-15);
        assert!((velocity.velocity_at(9.0).x + 0.625).abs() < 1e-15);
        let cut = ground.cut_at(&[0.9, 1.4]);
        let miss = GroundVelocity::new(&cut).velocity_at(1.6) - velocity.velocity_at(1.6);
        assert!(miss.norm() < 1e-15);
    }
}
