//! Mechanics of arches and columns: pure functions, no time, no files.
pub mod arch;
pub mod chain;
pub mod column;
pub mod equivalent;
pub mod four_link;
pub mod geometry;
