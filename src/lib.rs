//! wip
#![allow(missing_docs)]
#[macro_use]
mod named;
pub mod dynamics;
pub mod mechanics;
pub mod output;
pub mod scenario;
