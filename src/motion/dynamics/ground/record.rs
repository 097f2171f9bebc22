//! Recorded ground motion, linear between samples.

use nalgebra::Vector2;

use super::error::{ACCELERATION_M_S2, CLOCK_S, GroundError, TIME_S};
use super::motion::GroundMotion;
use super::piece::Formula;
use crate::argument::require_within;

/// Smallest spacing of samples, in seconds.
const MIN_STEP_S: f64 = 1e-8;
/// Corners of the two components closer than this, in seconds, are merged.
const MIN_CORNER_SPACING_S: f64 = 1e-9;

impl GroundMotion {
    /// Motion of horizontal accelerations in m/s2, one every `step_s` (1e-8 to 1e9) from time zero on; linear between samples, zero after
    /// the last.
    ///
    /// ```
    ///
    /// # use archrock_motion::dynamics::{GroundError, GroundMotion};
    /// let ground = GroundMotion::from_samples(0.01, &[0.0, 0.8, -1.2, 0.3])?;
    /// assert_eq!(ground.peaks_m_s2(f64::INFINITY).x, 1.2);
    ///
    /// # Ok::<(), GroundError>(())
    /// ```
    ///
    /// # Errors
    /// When there are fewer than two samples, or a number is outside its range.
    pub fn from_samples(step_s: f64, horizontal_m_s2: &[f64]) -> Result<Self, GroundError> {
        require_within("step_s", step_s, MIN_STEP_S..=1e9)?;
        let samples: Vec<_> = horizontal_m_s2
            .iter()
            .enumerate()
            .map(|(index, acceleration)| (index as f64 * step_s, *acceleration))
            .collect();
        check("horizontal_m_s2", &samples)?;
        Ok(Self::polylines(&samples, &[], 0.0))
    }

    /// Recorded motion, linear between samples `(time in s, acceleration in m/s2)`, zero before the first and after the last. One of the
    /// two components may be empty.
    ///
    /// Times count from `start_s` (0 to 1e9); they rise by at least 1e-8 s, and none falls before time zero.
    /// Times are at most 1e9 in magnitude, accelerations 1e12.
    ///
    /// # Errors
    /// When both components are empty, one has a single sample, or a time or an acceleration is out of
    /// bounds.
    pub fn record(
        horizontal: &[(f64, f64)],
        vertical: &[(f64, f64)],
        start_s: f64,
    ) -> Result<Self, GroundError> {
        require_within("start_s", start_s, TIME_S)?;
        // Of two empty components, the error names the first.
        if !horizontal.is_empty() || vertical.is_empty() {
            check("horizontal", horizontal)?;
        }
        if !vertical.is_empty() {
            check("vertical", vertical)?;
        }
        let first_s = [horizontal, vertical]
            .into_iter()
            .filter_map(|samples| Some(samples.first()?.0))
            .fold(f64::INFINITY, f64::min);
        require_within("start_s + first time", start_s + first_s, TIME_S)?;
        Ok(Self::polylines(horizontal, vertical, start_s))
    }

    /// Recorded motion of samples that are known to be in bounds. At a jump of the acceleration two samples have the same time.
    pub fn polylines(horizontal: &[(f64, f64)], vertical: &[(f64, f64)], start_s: f64) -> Self {
        let mut corners: Vec<f64> = horizontal.iter().chain(vertical).map(|s| s.0).collect();
        corners.sort_unstable_by(f64::total_cmp);
        corners.dedup_by(|later, earlier| *later - *earlier < MIN_CORNER_SPACING_S);
        let mut components = [horizontal, vertical];
        let lines = corners.windows(2).map(|ends| {
            let [x, y] = components.each_mut().map(|samples| line(samples, ends));
            let formula = Formula::Linear(Vector2::new(x.0, y.0), Vector2::new(x.1, y.1));
            (start_s + ends[1], start_s + ends[0], formula)
        });
        let first_s = start_s + corners.first().copied().unwrap_or(0.0);
        Self::join(first_s, lines)
    }
}

/// Checks that samples can be joined by lines.
fn check(argument: &'static str, samples: &[(f64, f64)]) -> Result<(), GroundError> {
    if samples.len() < 2 {
        let why = format!(
            "has too few samples ({}): it must have at least 2",
            samples.len()
        );
        return Err(GroundError(format!("`{argument}` {why}")));
    }
    let mut before_s = f64::NEG_INFINITY;
    for (index, &(time_s, acceleration)) in samples.iter().enumerate() {
        let sample = format_args!("sample {index} of `{argument}`");
        require_within("time_s", time_s, CLOCK_S)
            .and(require_within(
                "acceleration_m_s2",
                acceleration,
                ACCELERATION_M_S2,
            ))
            .map_err(|fault| GroundError(format!("{sample}: {fault}")))?;
        // Times computed as multiples of a step may be slightly less than a step apart.
        if time_s - before_s < 0.999 * MIN_STEP_S {
            return Err(GroundError(format!(
                "{sample} is at {time_s:?} s and the one before at {before_s:?} s: times must rise by at least 1e-8 s"
            )));
        }
        before_s = time_s;
    }
    Ok(())
}

/// Value at the first of two times, and the slope; no sample lies between the two times. Drops earlier samples.
fn line(samples: &mut &[(f64, f64)], ends: &[f64]) -> (f64, f64) {
    let middle = 0.5 * (ends[0] + ends[1]);
    while samples.len() > 1 && samples[1].0 <= middle {
        *samples = &samples[1..];
    }
    match **samples {
        [(t0, a0), (t1, a1), ..] if t0 <= middle => {
            let slope = (a1 - a0) / (t1 - t0);
            (a0 + slope * (ends[0] - t0), slope)
        }
        _ => (0.0, 0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_are_straight_lines_between_their_samples() {
        let horizontal = [(0.5, 1.0), (1.0, -2.0), (1.5, 0.5)];
        let vertical = [(0.75, 4.0), (1.0 + 1e-12, 2.0), (3.0, 0.0)];
        let ground = GroundMotion::record(&horizontal, &vertical, 0.25).unwrap();
        let corners: Vec<_> = ground.pieces.iter().map(|p| p.start_s).collect();
        assert_eq!(corners, [0.0, 0.75, 1.0, 1.25, 1.75, 3.25]);
        let at = |time: f64| {
            let piece = ground.pieces.iter().rfind(|p| p.start_s <= time).unwrap();
            piece.acceleration_and_rate(time).0
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
    }
}
