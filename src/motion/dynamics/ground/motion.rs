//! Ground motion under both feet, as a sequence of pieces.

use std::sync::Arc;

use nalgebra::Vector2;

use super::error::{GroundError, TIME_S};
use super::piece::{Formula, GroundPiece};
use crate::argument::{ArgumentError, require_within};
use crate::bisection::{Width, bisect, middle};
use crate::mechanics::{Row, Supports};

/// Ground acceleration from [`GroundMotion::start_s`] on, zero after the last corner.
///
/// The acceleration is that of the whole ground, or of the ground under the left foot if the right foot moves differently.
#[readonly::make]
#[derive(Clone, Debug, PartialEq)]
pub struct GroundMotion {
    /// The pieces in order, without gaps, from [`GroundMotion::start_s`] to infinity.
    pub pieces: Vec<GroundPiece>,
    /// True if the ground stops after the last corner; otherwise it keeps its velocity.
    pub(super) stops: bool,
    /// Ground under the right foot; `None` if both feet move alike.
    right: Option<Arc<Self>>,
}

impl GroundMotion {
    /// Ground without motion.
    pub fn still() -> Self {
        Self::from_pieces(0.0, Vec::new())
    }

    /// Motion of pieces given by their ends and formulas, both in the time since `start_s`.
    pub(super) fn from_pieces(start_s: f64, formulas: Vec<(f64, Formula)>) -> Self {
        let placed = |(end, formula)| (start_s + end, start_s, formula);
        Self::join(start_s, formulas.into_iter().map(placed))
    }

    /// Motion of pieces given by end, origin and formula. The ground is quiet before `start_s` (from time zero, or from `start_s` if
    /// negative) and after the last piece.
    pub(super) fn join(start_s: f64, moving: impl Iterator<Item = (f64, f64, Formula)>) -> Self {
        let quiet = |end_s: f64| (end_s, start_s, Formula::constant(Vector2::zeros()));
        let all = [quiet(start_s)]
            .into_iter()
            .chain(moving)
            .chain([quiet(f64::INFINITY)]);
        let mut pieces = Vec::new();
        let mut piece_start_s = start_s.min(0.0);
        for (end_s, origin_s, formula) in all {
            // A piece shorter than the resolution of floating-point times vanishes.
            if end_s > piece_start_s {
                pieces.push(GroundPiece {
                    start_s: piece_start_s,
                    end_s,
                    origin_s,
                    formula,
                });
                piece_start_s = end_s;
            }
        }
        Self {
            pieces,
            stops: false,
            right: None,
        }
    }

    /// Motion of two feet: this motion under the left foot, `right` under the right foot. Both start from rest at the earlier one of their
    /// starts. The distance between the feet is constant after the later one of their ends.
    #[must_use]
    pub fn with_right_foot(self, right: Self) -> Self {
        let start_s = self.start_s().min(right.start_s());
        Self {
            right: Some(Arc::new(right.quiet_from(start_s))),
            ..self.quiet_from(start_s)
        }
    }

    /// Motion of two feet: this motion under the left foot, and the same motion with a delay under the right foot. The delay is in seconds,
    /// from -1e9 to 1e9. With a negative delay the right foot starts earlier. If its acceleration then begins before time zero, the motion of both
    /// feet [starts](Self::start_s) at this negative time. The times of the left foot do not change.
    ///
    /// # Errors
    /// When the delay is out of range.
    pub fn with_delayed_right_foot(self, delay_s: f64) -> Result<Self, GroundError> {
        let right = if delay_s >= 0.0 {
            self.delayed_by(delay_s)?
        } else {
            require_within("-delay_s", -delay_s, TIME_S)?;
            self.advanced_by(-delay_s)
        };
        Ok(self.with_right_foot(right))
    }

    /// Time at which the motion begins, in seconds: zero, or negative if the right foot accelerates before time zero.
    pub fn start_s(&self) -> f64 {
        self.pieces.first().map_or(0.0, |piece| piece.start_s)
    }

    /// Index of the piece at a time not before the start; at a corner, of the later piece.
    pub(in crate::dynamics) fn piece_at(&self, time_s: f64) -> usize {
        let starts = |piece: &GroundPiece| piece.start_s <= time_s;
        self.pieces.partition_point(starts).max(1) - 1
    }

    /// Adds quiet ground before the motion, from `start_s` on, which is not later than its start.
    fn quiet_from(mut self, start_s: f64) -> Self {
        match self.pieces.first_mut() {
            Some(first) if start_s < first.start_s && first.is_quiet() => first.start_s = start_s,
            Some(first) if start_s < first.start_s => {
                let quiet = GroundPiece {
                    start_s,
                    end_s: first.start_s,
                    origin_s: start_s,
                    formula: Formula::constant(Vector2::zeros()),
                };
                self.pieces.insert(0, quiet);
            }
            _ => {}
        }
        self
    }

    /// Motion under the right foot; `None` if both feet move alike.
    pub fn right_foot(&self) -> Option<&Self> {
        self.right.as_deref()
    }

    /// Motion under the right foot of a row; `None` if both feet move alike, or for a stack, which has only a left foot.
    pub(in crate::dynamics) fn right_foot_of(&self, row: &Row) -> Option<&Self> {
        let right = self.right_foot();
        right.filter(|_| row.supports == Supports::Both)
    }

    /// This motion for a structure whose feet move differently: the ground stops at its end, at any velocity.
    #[must_use]
    pub fn stopping(mut self) -> Self {
        self.stops = true;
        self
    }

    /// This motion with both feet delayed by a time in seconds, from 0 to 1e9.
    ///
    /// # Errors
    /// When the delay is out of range.
    pub fn delayed_by(&self, delay_s: f64) -> Result<Self, GroundError> {
        require_within("delay_s", delay_s, TIME_S)?;
        let right = self.right_foot().map(|right| right.delayed_by(delay_s));
        let mut delayed = self.shifted_by(delay_s, self.start_s());
        delayed.right = right.transpose()?.map(Arc::new);
        Ok(delayed)
    }

    /// Motion of this foot, earlier by a time in seconds. The motion starts at its first acceleration if this is before time zero.
    fn advanced_by(&self, lead_s: f64) -> Self {
        let begins = self.pieces.iter().find(|piece| !piece.is_quiet());
        self.shifted_by(-lead_s, begins.map_or(lead_s, |piece| piece.start_s))
    }

    /// Pieces from `from_s` on, with all times changed by a delay.
    fn shifted_by(&self, delay_s: f64, from_s: f64) -> Self {
        let pieces = self.pieces.iter();
        let moving = pieces.filter(|piece| !piece.stays_still() && piece.start_s >= from_s);
        let moved = moving.map(|piece| {
            let (end_s, origin_s) = (piece.end_s + delay_s, piece.origin_s + delay_s);
            (end_s, origin_s, piece.formula)
        });
        Self {
            stops: self.stops,
            ..Self::join(from_s + delay_s, moved)
        }
    }

    /// Largest horizontal and vertical acceleration up to a time, without sign, in m/s2. Pieces are monotone, so the largest values are
    /// at ends of pieces, or at that time.
    pub fn peaks_m_s2(&self, until_s: f64) -> Vector2<f64> {
        let ends = self.ends_until_m_s2(until_s);
        ends.fold(Vector2::zeros(), |peaks, at| peaks.sup(&at.abs()))
    }

    /// Largest accelerations up to a time that push a structure to the right and to the left, in m/s2: those of the ground to the left
    /// and to the right.
    pub fn pushes_m_s2(&self, until_s: f64) -> [f64; 2] {
        let ends = self.ends_until_m_s2(until_s);
        ends.fold([0.0; 2], |[right, left], at| {
            [f64::max(right, -at.x), f64::max(left, at.x)]
        })
    }

    /// Accelerations at the ends of the pieces that begin before a time, and at that time.
    fn ends_until_m_s2(&self, until_s: f64) -> impl Iterator<Item = Vector2<f64>> {
        let pieces = self.pieces.iter();
        let moving = pieces.filter(move |piece| piece.start_s < until_s && !piece.stays_still());
        moving.flat_map(move |piece| {
            [piece.start_s, piece.end_s.min(until_s)]
                .map(|time_s| piece.acceleration_and_rate(time_s).0)
        })
    }

    /// End of the ground motion, in seconds; afterwards the acceleration is zero under both feet.
    pub fn end_s(&self) -> f64 {
        let [left_s, right_s] = self.ends_s();
        left_s.max(right_s)
    }

    /// Ends of the motion of the left and of the right foot, in seconds.
    pub fn ends_s(&self) -> [f64; 2] {
        let own_s = self.pieces.last().map_or(0.0, |piece| piece.start_s);
        [own_s, self.right_foot().map_or(own_s, Self::end_s)]
    }

    /// Whether the ground ever moves vertically, under either foot.
    pub fn has_vertical(&self) -> bool {
        let mut ends = self.pieces.iter().flat_map(GroundPiece::ends_m_s2);
        ends.any(|end| end.y != 0.0) || self.right_foot().is_some_and(Self::has_vertical)
    }

    /// Whether the ground ever moves horizontally, under either foot.
    pub fn has_horizontal(&self) -> bool {
        let mut ends = self.pieces.iter().flat_map(GroundPiece::ends_m_s2);
        ends.any(|end| end.x != 0.0) || self.right_foot().is_some_and(Self::has_horizontal)
    }

    /// First time at which the ground accelerates downwards as fast as a free body, `g + a_v <= 0`, so that it no longer carries a
    /// structure; `None` if that does not happen. With two feet, the first time of either foot.
    pub fn free_fall_s(&self, gravity_m_s2: f64) -> Option<f64> {
        let right = self.right_foot();
        let right_s = right.and_then(|right| right.free_fall_s(gravity_m_s2));
        let own_s = self.own_free_fall_s(gravity_m_s2);
        own_s.into_iter().chain(right_s).reduce(f64::min)
    }

    fn own_free_fall_s(&self, gravity_m_s2: f64) -> Option<f64> {
        let falls = |acceleration: Vector2<f64>| gravity_m_s2 + acceleration.y <= 0.0;
        let mut pieces = self.pieces.iter();
        let piece = pieces.find(|piece| piece.ends_m_s2().into_iter().any(falls))?;
        if falls(piece.ends_m_s2()[0]) {
            return Some(piece.start_s);
        }
        let (before_s, after_s) = bisect(piece.start_s, piece.end_s, Width::Rounding, |time_s| {
            falls(piece.acceleration_and_rate(time_s).0)
        });
        Some(middle(before_s, after_s))
    }

    /// Factor on this motion from which the ground falls as fast as a free body at some time, under either foot; `None` if it never
    /// accelerates downwards.
    pub fn free_fall_factor(&self, gravity_m_s2: f64) -> Option<f64> {
        let ends = self.pieces.iter().flat_map(GroundPiece::ends_m_s2);
        let down_m_s2 = ends.fold(0.0, |most, end| f64::max(most, -end.y));
        let own = (down_m_s2 > 0.0).then(|| gravity_m_s2 / down_m_s2);
        let right = self.right_foot();
        let right = right.and_then(|right| right.free_fall_factor(gravity_m_s2));
        own.into_iter().chain(right).reduce(f64::min)
    }

    /// This motion with all accelerations multiplied by a factor, from -1e9 to 1e9, under both feet.
    ///
    /// # Errors
    /// When the factor is outside that range.
    pub fn scaled(&self, factor: f64) -> Result<Self, ArgumentError> {
        require_within("factor", factor, -1e9..=1e9)?;
        let pieces = self.pieces.iter().map(|piece| GroundPiece {
            formula: piece.formula.scaled(factor),
            ..*piece
        });
        let right = self.right_foot().map(|right| right.scaled(factor));
        Ok(Self {
            pieces: pieces.collect(),
            stops: self.stops,
            right: right.transpose()?.map(Arc::new),
        })
    }

    /// Mirror image of this motion: the horizontal accelerations of both feet change sign. Vertical accelerations and delays stay.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        let pieces = self.pieces.iter().map(|piece| GroundPiece {
            formula: piece.formula.mirrored(),
            ..*piece
        });
        Self {
            pieces: pieces.collect(),
            stops: self.stops,
            right: self.right_foot().map(|right| Arc::new(right.mirrored())),
        }
    }

    /// This motion with additional corners at given times, where the integration begins a new step.
    pub fn cut_at(&self, times_s: &[f64]) -> Self {
        let mut cut = self.clone();
        for time_s in times_s {
            let within = |piece: &GroundPiece| piece.start_s < *time_s && *time_s < piece.end_s;
            if let Some(index) = cut.pieces.iter().position(within) {
                let mut rest = cut.pieces[index];
                cut.pieces[index].end_s = *time_s;
                rest.start_s = *time_s;
                cut.pieces.insert(index + 1, rest);
            }
        }
        cut
    }
}

#[cfg(test)]
mod tests {
    use super::super::Pulse;
    use super::*;

    #[test]
    fn pieces_follow_one_another_from_zero_to_infinity() {
        for pulse in Pulse::ALL.iter().copied() {
            for start in [0.0, 0.7] {
                let ground = pulse
                    .lasting_s(0.3)
                    .starting_at_s(start)
                    .horizontal_m_s2(2.0)
                    .unwrap();
                let pieces = ground.pieces;
                assert!(pieces[0].start_s == 0.0);
                assert!(
                    pieces
                        .windows(2)
                        .all(|pair| pair[0].end_s == pair[1].start_s)
                );
                let last = pieces.last().unwrap();
                assert!(last.stays_still() && last.acceleration_m_s2(99.0) == 0.0);
            }
        }
    }

    #[test]
    fn free_fall_is_found_at_corners_and_within_pieces() {
        let ground = |vertical: &[(f64, f64)]| GroundMotion::record(&[], vertical, 0.0).unwrap();
        assert_eq!(ground(&[(0.0, 0.0), (1.0, -9.0)]).free_fall_s(9.81), None);
        let sloping = ground(&[(0.0, 0.0), (1.0, -20.0), (2.0, 5.0)]);
        assert!((sloping.free_fall_s(10.0).unwrap() - 0.5).abs() < 1e-15);
        assert_eq!(
            ground(&[(0.5, -12.0), (1.0, 0.0)]).free_fall_s(9.81),
            Some(0.5)
        );
        let wave = |a| {
            Pulse::OneSine
                .lasting_s(1.0)
                .inclined_m_s2(Vector2::new(1.0, a))
                .unwrap()
        };
        assert_eq!(wave(9.0).free_fall_s(9.81), None);
        // 20 sin(2 pi s) = -10 first at 7/12.
        assert!((wave(20.0).free_fall_s(10.0).unwrap() - 7.0 / 12.0).abs() < 1e-14);
    }

    #[test]
    fn scaled_motion_is_that_of_the_scaled_amplitude() {
        let record = |factor: f64| {
            let scaled = |samples: [(f64, f64); 3]| samples.map(|(t, a)| (t, factor * a));
            let horizontal = scaled([(0.5, 1.0), (1.0, -2.0), (1.5, 0.5)]);
            GroundMotion::record(
                &horizontal,
                &scaled([(0.0, 0.0), (0.7, 3.0), (2.0, 0.1)]),
                0.25,
            )
            .unwrap()
        };
        // Powers of two are exact.
        assert_eq!(record(1.0).scaled(-4.0), Ok(record(-4.0)));
        for pulse in Pulse::ALL.iter().copied() {
            let ground = |factor: f64| {
                let amplitude = Vector2::new(2.0, -0.7) * factor;
                pulse
                    .lasting_s(0.3)
                    .starting_at_s(0.1)
                    .inclined_m_s2(amplitude)
                    .unwrap()
            };
            assert_eq!(ground(1.0).scaled(0.5), Ok(ground(0.5)));
            let scaled = ground(1.0).scaled(1.7).unwrap();
            for (ours, direct) in scaled.pieces.iter().zip(ground(1.7).pieces) {
                let time_s = ours.start_s + 0.01;
                assert!(
                    (ours.acceleration_and_rate(time_s).0 - direct.acceleration_and_rate(time_s).0)
                        .norm()
                        < 1e-14
                );
                assert!((ours.start_s, ours.end_s) == (direct.start_s, direct.end_s));
            }
        }
        for factor in [f64::NAN, f64::INFINITY, -1e10] {
            let error = record(1.0).scaled(factor).unwrap_err();
            assert_eq!(error.argument, "factor");
        }
    }

    #[test]
    fn cuts_change_no_value() {
        let ground = Pulse::OneSine
            .lasting_s(0.3)
            .starting_at_s(0.1)
            .horizontal_m_s2(2.0)
            .unwrap();
        let cut = ground.cut_at(&[0.05, 0.11, 0.3, 5.0]);
        assert_eq!(cut.pieces.len(), ground.pieces.len() + 4);
        for piece in cut.pieces {
            let time = piece.start_s;
            let original = ground.pieces.iter().rfind(|p| p.start_s <= time).unwrap();
            assert!(piece.acceleration_m_s2(time) == original.acceleration_m_s2(time));
        }
    }
}
