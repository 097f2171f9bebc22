//! Shapes, and the rigid motions of their parts.
pub mod field;
pub mod pose;
pub mod ring;
