//! Common parts of all models of rows of blocks.
//!
//! - `stepper` is the driver that steps a row and reports its motion.
//! - `observer` records and evaluates the motion.
//! - `standing` holds the properties of a row of rigid blocks before it moves.

pub(crate) mod clock;
pub(crate) mod error;
pub(super) mod input;
pub(super) mod observer;
pub(crate) mod standing;
pub(super) mod stepper;
