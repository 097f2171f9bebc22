//! Common parts of all models of rows of blocks.
//!
//! - `stepper` is the driver that steps a row and reports its motion.
//! - `observer` records and evaluates the motion; `events` holds its events back until they are no part of a fall.
//! - `standing` holds the properties of a row of rigid blocks before it moves.

pub(crate) mod clock;
pub(crate) mod error;
mod events;
pub(super) mod input;
pub(super) mod last_maximum;
pub(super) mod observer;
pub(crate) mod standing;
pub(super) mod stepper;
