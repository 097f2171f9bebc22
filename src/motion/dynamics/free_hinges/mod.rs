//! Motion of a row of rigid blocks whose joints open and close anywhere, at any time.
//!
//! The driver of rows moves the blocks by a stepper: `landing`, with steps that end at landings, or `sliding`, with equal steps and sliding joints.

mod landing;
mod model;
pub(crate) mod motion;
mod rest;
mod right_support;
mod settings;
mod sliding;
mod ties;

pub use model::{DOUBTFUL_ENERGY_ERROR, FreeHinges, RowOptions};
