//! Mechanics of arches and columns: pure functions, no time, no files.
pub mod arch;
pub mod blocks;
pub mod capacity;
pub mod chain;
pub mod column;
// Internals of rows of blocks, public for tests only.
#[doc(hidden)]
pub mod complementarity;
#[doc(hidden)]
pub mod contact;
#[doc(hidden)]
pub mod coulomb;
pub mod elastic_joint;
pub mod equivalent;
pub mod four_link;
pub mod friction;
pub mod geometry;
#[doc(hidden)]
pub mod joints;
#[doc(hidden)]
pub mod lanes;
pub mod masonry;
pub mod parts;
pub mod settling;
#[doc(hidden)]
pub mod slip;
pub mod stability;
#[doc(hidden)]
pub mod stance;
pub mod sway;
pub mod tie;
pub mod virtual_work;
