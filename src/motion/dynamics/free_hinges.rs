//! Motion of a row of rigid blocks whose joints open and shut anywhere, at any time.
//!
//! The driver of rows moves the blocks by a stepper: `landing`, whose steps end where corners land, or `sliding`, in whose equal steps
//! joints may slip too.

mod landing;
mod model;
pub(crate) mod motion;
mod rest;
mod right_support;
mod settings;
mod sliding;
mod ties;

pub use model::{DOUBTFUL_ENERGY_ERROR, FreeHinges, RowOptions};
