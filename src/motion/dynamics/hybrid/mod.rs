//! One degree of freedom at a time: smooth motion in modes, and jumps between them.
pub mod engine;
mod friction;
pub mod integrator;
mod posture;
pub mod rocking;
mod sampler;
mod simulation;
