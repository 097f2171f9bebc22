//! Shared by all models of rows of blocks: `stepper`, the driver that steps a row and reports its motion; `course`, which
//! judges the motion; and `standing`,
//! what is known of a row of rigid blocks before it moves.

pub(crate) mod clock;
pub(super) mod course;
pub mod error;
pub(super) mod standing;
pub(super) mod stepper;
pub(super) mod task;
