//! Shared by all models of rows of blocks: `course`, the driver that steps a row, judges its motion and reports it; and `standing`,
//! what is known of a row of rigid blocks before it moves.

pub(super) mod course;
pub mod error;
pub(super) mod standing;
