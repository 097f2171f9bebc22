//! Shapes, and the rigid motions of their parts.
pub mod curve;
pub mod field;
pub mod pose;
pub mod profile;
pub mod rigid;
pub mod ring;
