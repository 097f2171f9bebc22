//! Ranges of the dimensions of structures.

use std::ops::Bound::{Excluded, Included};

use super::rule::{Count, Number, between, within};
use crate::mechanics;

/// Range of lengths and densities.
pub(super) const MAGNITUDE: Number = within(&mechanics::MAGNITUDE);
pub(super) const THICKNESS_RATIO: Number = between(
    Included(mechanics::MIN_THICKNESS_RATIO),
    Excluded(mechanics::THICKNESS_RATIO_BOUND),
);
pub(super) const EMBRACE_DEG: Number = within(&mechanics::EMBRACE_DEG);
pub(super) const JOINT_DEG: Number = within(&(0.0..=*mechanics::EMBRACE_DEG.end()));
pub(super) const VOUSSOIRS: Count = Count(mechanics::VOUSSOIRS, "four hinges need four joints");
/// Embrace angles below this, in degrees, are probably in radians: a full circle has 6.28.
pub(super) const LIKELY_EMBRACE_DEG: f64 = 10.0;
