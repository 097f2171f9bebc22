//! Shapes, and the rigid motions of their parts.
pub(crate) mod curve;
pub(crate) mod field;
pub(crate) mod hull;
pub(crate) mod pose;
pub(crate) mod profile;
pub(crate) mod rigid;
pub(crate) mod ring;
