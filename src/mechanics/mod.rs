//! Mechanics of the ring: pure functions, no time, no files.
pub mod field;
pub mod ring;
