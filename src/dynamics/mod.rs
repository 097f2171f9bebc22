//! Motion in time: the ground, the rocking structure, its history.
pub mod ground;
pub mod history;
pub mod hybrid;
pub mod model;
pub mod thrust;
