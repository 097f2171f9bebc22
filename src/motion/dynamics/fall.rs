//! The fall of a structure that has overturned. It is computed for pictures only and is no part of a history, whose results end where
//! the structure can no longer come back.

use std::f64::consts::FRAC_PI_4;
use std::fmt;

use super::history::Sample;

/// A fall is followed until a body has turned by this, in radians ...
pub const TURNED_RAD: f64 = FRAC_PI_4;
/// ... or for this long, in seconds.
pub const LONGEST_S: f64 = 5.0;
/// Longest time between the samples of a fall, in seconds.
pub(super) const SAMPLED_S: f64 = 0.01;
/// Most steps of a fall: blocks that come apart may land on one another without end.
pub(super) const MOST_STEPS: usize = 20_000;

/// Why a fall was followed no further.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FallEnd {
    /// A body has turned by [`TURNED_RAD`].
    Turned,
    /// The fall took longer than [`LONGEST_S`], or too many steps.
    Slow,
    /// Its model moves it no further, for this reason.
    Model(String),
}

impl fmt::Display for FallEnd {
    /// The end of the computed fall, in words.
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Turned => write!(to, "until a block has turned by 45 degrees"),
            Self::Slow => write!(to, "for {LONGEST_S} s at most, since it is slow"),
            Self::Model(reason) => write!(to, "as far as its model goes: {reason}"),
        }
    }
}

/// Whether a fall ends with this sample, and why.
pub(super) fn end_at(sample: &Sample) -> Option<FallEnd> {
    let turned = |rotation_rad: &f64| rotation_rad.abs() >= TURNED_RAD;
    let any = sample.rotations_rad.iter().any(turned);
    any.then_some(FallEnd::Turned)
}
