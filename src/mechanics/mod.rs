//! Mechanics of arches and columns: pure functions, no time, no files.
pub mod arch;
pub mod blocks;
pub mod capacity;
pub mod chain;
pub mod column;
pub(crate) mod complementarity;
pub(crate) mod contact;
pub(crate) mod coulomb;
pub mod elastic_joint;
pub mod equivalent;
pub mod four_link;
pub mod friction;
pub mod geometry;
pub(crate) mod joints;
pub(crate) mod lanes;
pub mod masonry;
pub mod parts;
pub mod settling;
pub(crate) mod slip;
pub mod stability;
#[doc(hidden)]
pub mod stance;
pub mod sway;
pub mod tie;
pub mod virtual_work;
