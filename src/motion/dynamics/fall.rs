//! Fall of an overturned structure. It is computed for pictures only and is no part of a history: results end where the structure cannot return.

use crate::dynamics::Sample;
use std::f64::consts::FRAC_PI_4;
use std::fmt;

/// Rotation of a body, in radians, at which the computed fall ends.
pub const TURNED_RAD: f64 = FRAC_PI_4;
/// Longest duration of a computed fall, in seconds.
pub const LONGEST_S: f64 = 5.0;
/// Longest time between the samples of a fall, in seconds.
pub(super) const SAMPLED_S: f64 = 0.01;
/// Maximum number of steps of a fall: separated blocks may collide again and again.
pub(super) const MOST_STEPS: usize = 20_000;

/// Reason for the end of a computed fall.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum FallEnd {
    /// A body has turned by 45 degrees.
    Turned,
    /// The fall took longer than 5 s, or too many steps.
    Slow,
    /// The model cannot continue; with the reason.
    Model(String),
}

impl fmt::Display for FallEnd {
    /// Writes the end of the fall in words.
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Turned => write!(to, "until a block has turned by 45 degrees"),
            Self::Slow => write!(to, "for {LONGEST_S} s at most, since it is slow"),
            Self::Model(reason) => write!(to, "as far as its model goes: {reason}"),
        }
    }
}

/// End of the fall if it ends with this sample; `None` otherwise.
pub(super) fn end_at(sample: &Sample) -> Option<FallEnd> {
    let turned = |rotation_rad: &f64| rotation_rad.abs() >= TURNED_RAD;
    let any = sample.rotations_rad.iter().any(turned);
    any.then_some(FallEnd::Turned)
}
