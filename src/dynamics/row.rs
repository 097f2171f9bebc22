//! What every model of rows of blocks shares: `course`, the driver that steps a row, judges its motion and tells of it; and `standing`,
//! what is known of a row of rigid blocks before it moves.

pub(super) mod course;
pub(super) mod standing;
