//! The arch as a four-link mechanism: its start, its motion, and its impacts.
pub mod certificate;
pub mod chain;
pub mod impact;
pub mod impulse_line;
pub(crate) mod jointed;
pub mod limit;
pub mod linkage;
pub mod mechanism;
pub mod resultant;
mod search;
pub mod self_weight;
pub mod thrust;
