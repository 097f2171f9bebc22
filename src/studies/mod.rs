//! Studies: what many histories say together. Pure functions, no files.
pub mod fragility;
