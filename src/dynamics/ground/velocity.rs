//! The velocity of the ground: the exact integral of its acceleration.

use nalgebra::Vector2;

use super::GroundMotion;

/// Velocity of the ground that starts from rest at time zero.
#[derive(Clone, Debug)]
pub struct GroundVelocity<'a> {
    ground: &'a GroundMotion,
    /// Velocities at the starts of the pieces.
    at_starts_m_s: Vec<Vector2<f64>>,
}

impl<'a> GroundVelocity<'a> {
    /// The velocity of a ground motion.
    #[must_use]
    pub fn new(ground: &'a GroundMotion) -> Self {
        let at_starts_m_s = ground
            .pieces()
            .iter()
            .scan(Vector2::zeros(), |velocity_m_s, piece| {
                let at_start = *velocity_m_s;
                if piece.end_s.is_finite() {
                    *velocity_m_s += piece.velocity_gained_m_s(piece.end_s);
                }
                Some(at_start)
            })
            .collect();
        Self {
            ground,
            at_starts_m_s,
        }
    }

    /// The velocity in m/s, horizontal and vertical (positive to the right and upwards), at a time that is not
    /// negative.
    #[must_use]
    pub fn at(&self, time_s: f64) -> Vector2<f64> {
        let pieces = self.ground.pieces();
        let after = pieces.partition_point(|piece| piece.start_s <= time_s);
        let index = after.max(1) - 1;
        self.at_starts_m_s[index] + pieces[index].velocity_gained_m_s(time_s)
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
                let ground = GroundMotion::pulse_along(*pulse, amplitude, 0.3, 0.1, train).unwrap();
                let exact = GroundVelocity::new(&ground);
                let (mut velocity, n) = (Vector2::zeros(), 400);
                for piece in ground.pieces().iter().filter(|p| p.end_s.is_finite()) {
                    let h = (piece.end_s - piece.start_s) / f64::from(n);
                    for i in 0..n {
                        let time = piece.start_s + h * f64::from(i);
                        let miss: Vector2<f64> = exact.at(time) - velocity;
                        assert!(miss.norm() < 1e-10, "{pulse:?} {train:?} {time} {miss}");
                        let at = |part: f64| piece.at(time + part * h).0;
                        velocity += (at(0.0) + at(0.5) * 4.0 + at(1.0)) * (h / 6.0);
                    }
                }
                assert!((exact.at(100.0) - velocity).norm() < 1e-10);
            }
        }
    }

    #[test]
    fn velocities_of_records_are_sums_of_trapezia() {
        let samples = [(0.5, 1.0), (1.0, -2.0), (1.5, 0.5)];
        let ground = GroundMotion::record(&samples, &[], 0.25).unwrap();
        let velocity = GroundVelocity::new(&ground);
        // -1/2 * 1/2 and -3/2 * 1/2.
        assert!((velocity.at(1.25).x + 0.25).abs() < 1e-15);
        assert!((velocity.at(9.0).x + 0.625).abs() < 1e-15);
        let cut = ground.cut_at(&[0.9, 1.4]).unwrap();
        let miss = GroundVelocity::new(&cut).at(1.6) - velocity.at(1.6);
        assert!(miss.norm() < 1e-15);
    }
}
