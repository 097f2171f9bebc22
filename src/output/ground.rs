//! The ground acceleration as a curve, including its jumps.

use super::{COLUMNS, Envelope};
use crate::GroundMotion;

/// Number of parts into which a curved piece is divided.
const POINTS: u32 = 24;

/// Returns times in seconds up to an end, and horizontal accelerations in g. A jump has two points at the same time.
pub(crate) fn curve_g(ground: &GroundMotion, gravity_m_s2: f64, end_s: f64) -> Vec<(f64, f64)> {
    let mut points = Vec::new();
    let pieces = ground.pieces.iter();
    for piece in pieces.take_while(|piece| piece.start_s < end_s) {
        let to_s = piece.end_s.min(end_s);
        let straight = piece.stays_still() || piece.longest_step_s() == f64::INFINITY;
        let parts = if straight { 1 } else { POINTS };
        points.extend((0..=parts).map(|i| {
            let time_s = piece.start_s + (to_s - piece.start_s) * (f64::from(i) / f64::from(parts));
            let ground_m_s2 = if piece.stays_still() {
                0.0
            } else {
                piece.acceleration_m_s2(time_s)
            };
            (time_s, ground_m_s2 / gravity_m_s2)
        }));
    }
    points.dedup();
    if points.len() <= 2 * COLUMNS {
        return points;
    }
    // Thins longer curves: those of records and long wave trains.
    let mut envelope = Envelope::default();
    for (time_s, ground_g) in points {
        envelope.push(time_s, ground_g);
    }
    envelope.points().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::Pulse;

    #[test]
    fn a_rectangle_has_upright_edges_and_ends_where_the_history_does() {
        let ground = Pulse::Rectangular
            .lasting_s(0.2)
            .starting_at_s(0.1)
            .horizontal_m_s2(-5.0)
            .unwrap();
        let rectangle = [(0.0, 0.0), (0.1, 0.0), (0.1, -0.5), (0.3, -0.5), (0.3, 0.0)];
        let near = |curve: &[(f64, f64)], due: &[(f64, f64)]| {
            assert_eq!(curve.len(), due.len(), "{curve:?}");
            for (point, due) in curve.iter().zip(due) {
                let miss = (point.0 - due.0).abs() + (point.1 - due.1).abs();
                assert!(miss < 1e-12, "{curve:?}");
            }
        };
        near(
            &curve_g(&ground, 10.0, 2.0),
            &[&rectangle[..], &[(2.0, 0.0)]].concat(),
        );
        // If the history ends within the pulse, the curve does not return to zero.
        near(
            &curve_g(&ground, 10.0, 0.2),
            &[&rectangle[..3], &[(0.2, -0.5)]].concat(),
        );
    }

    #[test]
    fn a_long_record_is_thinned_and_keeps_its_peak() {
        let samples: Vec<(f64, f64)> = (0..50_000)
            .map(|i| (0.005 * f64::from(i), if i == 33_333 { 7.0 } else { 0.1 }))
            .collect();
        let ground = GroundMotion::record(&samples, &[], 0.0).unwrap();
        let curve = curve_g(&ground, 10.0, 250.0);
        assert!(curve.len() <= 2 * COLUMNS + 1);
        assert!(curve.iter().any(|point| (point.1 - 0.7).abs() < 1e-12));
    }
}
