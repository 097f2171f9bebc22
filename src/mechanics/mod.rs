//! Mechanics of arches and columns: pure functions, no time, no files.
pub mod arch;
pub mod blocks;
pub mod chain;
pub mod column;
pub mod contact;
pub mod equivalent;
pub mod four_link;
pub mod geometry;
pub mod joints;
pub mod stability;
