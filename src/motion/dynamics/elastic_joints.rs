//! Motion of a row of rigid blocks with elastic joints.
//!
//! `motion` is the leapfrog of one or several histories side by side; `stepper` drives and judges each of them, for the driver of
//! all rows.

mod model;
mod motion;
mod stepper;

pub use model::{ElasticJoints, ElasticOptions};
