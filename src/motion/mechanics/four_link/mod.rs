//! The arch as a four-link mechanism: how it starts, moves, closes, and goes on.
pub mod arch;
pub mod certificate;
pub mod chain;
pub mod impact;
pub mod impulse_line;
pub mod limit;
pub mod linkage;
pub mod mechanism;
pub mod resultant;
pub mod row;
mod search;
pub mod self_weight;
pub mod thrust;
