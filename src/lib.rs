//! wip
#![allow(missing_docs)]
pub mod mechanics;
pub mod scenario;
