//! Recorded ground motion: straight lines between samples.

use nalgebra::Vector2;

use super::GroundMotion;
use super::piece::Formula;

/// Corners of a record that are closer than this, in seconds, are one.
const LEAST_SPACING_S: f64 = 1e-9;

impl GroundMotion {
    /// Recorded motion: straight lines between samples `(time in s, acceleration in m/s2)`, zero before the
    /// first and after the last. Either component may be empty.
    ///
    /// Times count from `start_s`; they increase, and none falls before time zero.
    #[must_use]
    pub fn record(horizontal: &[(f64, f64)], vertical: &[(f64, f64)], start_s: f64) -> Self {
        let mut corners: Vec<f64> = horizontal.iter().chain(vertical).map(|s| s.0).collect();
        corners.sort_unstable_by(f64::total_cmp);
        corners.dedup_by(|later, earlier| *later - *earlier < LEAST_SPACING_S);
        let mut components = [Polyline::new(horizontal), Polyline::new(vertical)];
        let lines = corners.windows(2).map(|ends| {
            let [x, y] = components
                .each_mut()
                .map(|component| component.line(ends[0], ends[1]));
            let formula = Formula::Linear {
                at_origin: Vector2::new(x.0, y.0),
                slope: Vector2::new(x.1, y.1),
            };
            (start_s + ends[1], start_s + ends[0], formula)
        });
        let first_s = start_s + corners.first().copied().unwrap_or(0.0);
        Self::join(first_s, lines)
    }
}

/// Straight lines between samples, asked for from left to right.
struct Polyline<'a> {
    samples: &'a [(f64, f64)],
}

impl<'a> Polyline<'a> {
    const fn new(samples: &'a [(f64, f64)]) -> Self {
        Self { samples }
    }

    /// Value at `start` and slope of the line that holds between two times, which no sample parts.
    fn line(&mut self, start: f64, end: f64) -> (f64, f64) {
        let middle = 0.5 * (start + end);
        while self.samples.len() > 1 && self.samples[1].0 <= middle {
            self.samples = &self.samples[1..];
        }
        match *self.samples {
            [(t0, a0), (t1, a1), ..] if t0 <= middle => {
                let slope = (a1 - a0) / (t1 - t0);
                (a0 + slope * (start - t0), slope)
            }
            _ => (0.0, 0.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_are_straight_lines_between_their_samples() {
        let horizontal = [(0.5, 1.0), (1.0, -2.0), (1.5, 0.5)];
        let vertical = [(0.75, 4.0), (1.0 + 1e-12, 2.0), (3.0, 0.0)];
        let ground = GroundMotion::record(&horizontal, &vertical, 0.25);
        let corners: Vec<_> = ground.pieces().iter().map(|p| p.start_s).collect();
        assert_eq!(corners, [0.0, 0.75, 1.0, 1.25, 1.75, 3.25]);
        let at = |time: f64| {
            let piece = ground.pieces().iter().rfind(|p| p.start_s <= time).unwrap();
            piece.at(time).0
        };
        for (time, x, y) in [
            (0.7, 0.0, 0.0),
            (0.75, 1.0, 0.0),
            (1.0, -0.5, 4.0),
            (1.125, -1.25, 3.0),
            (1.25, -2.0, 2.0),
            (1.5, -0.75, 1.75),
            (1.75, 0.0, 1.5),
            (2.25, 0.0, 1.0),
            (3.25, 0.0, 0.0),
        ] {
            assert!((at(time) - Vector2::new(x, y)).norm() < 1e-11, "{time}");
        }
        assert!(ground.has_vertical() && ground.peaks_m_s2(f64::INFINITY).x == 2.0);
        let none = GroundMotion::record(&[], &[], 0.25);
        assert!(none.pieces().len() == 2 && !none.has_vertical());
    }
}
