//! Motion in time: ground motion, models of motion and their histories.
pub mod demand;
pub mod elastic_joints;
pub mod fall;
pub mod free_hinges;
pub mod ground;
pub mod history;
pub(crate) mod hybrid;
pub mod model;
pub mod peak;
mod recorder;
pub mod recording;
pub mod repeatability;
mod request;
pub mod row;
pub mod thrust;
pub mod until;
pub mod variation;
