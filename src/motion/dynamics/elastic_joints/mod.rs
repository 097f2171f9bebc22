//! Motion of a row of rigid blocks with elastic joints.
//!
//! `motion` is the leapfrog of one or several parallel histories. `lane` is one history: its clock, and when it ends.
//! `stepper` advances and evaluates each history, for the driver of all rows. `stillness` decides when a row is at rest.

mod lane;
mod model;
mod motion;
mod rebound;
mod stepper;
mod stillness;

pub use model::ElasticJoints;
