//! wip
#![allow(missing_docs)]
pub mod dynamics;
pub mod mechanics;
