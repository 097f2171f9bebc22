//! Common parts of all models of rows of blocks.
//!
//! - `stepper` is the driver that steps a row and reports its motion.
//! - `course` records and evaluates the motion.
//! - `standing` holds the properties of a row of rigid blocks before it moves.

pub(crate) mod clock;
pub(super) mod course;
pub(crate) mod error;
pub(super) mod standing;
pub(super) mod stepper;
pub(super) mod task;
