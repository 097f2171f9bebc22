//! Motion in time: the engine, the ground, and the rocking structure that the engine runs.
pub mod engine;
pub mod free_hinges;
pub mod ground;
pub mod history;
pub mod integrator;
pub mod rocking;
pub mod thrust;
