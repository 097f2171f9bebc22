//! Mechanics of the arch and the column: pure functions, no time, no files.
pub mod arch;
pub mod certificate;
pub mod chain;
pub mod column;
pub mod equivalent;
pub mod field;
pub mod impact;
pub mod impulse_line;
pub mod limit;
pub mod linkage;
pub mod mechanism;
pub mod resultant;
pub mod ring;
mod search;
pub mod structure;
pub mod thrust;
