//! Mechanics and motion of masonry that rocks: what `archrock` computes with. Nothing here reads or writes a file.
//!
//! - [`mechanics`]: pure functions of shapes, rigid bodies, joints and mechanisms.
//! - [`dynamics`]: motion in time: the ground, models of motion and their histories.

#[macro_use]
mod named;
pub mod argument;
pub mod bisection;
pub mod dynamics;
pub mod mechanics;
mod work;

/// Parts below the models of motion, for tests and benchmarks. They are not for users, and may change with any release.
#[doc(hidden)]
pub mod internals {
    pub mod complementarity {
        pub use crate::mechanics::complementarity::*;
    }
    pub mod contact {
        pub use crate::mechanics::contact::*;
    }
    pub mod coulomb {
        pub use crate::mechanics::coulomb::*;
    }
    pub mod free_hinges {
        pub use crate::dynamics::free_hinges::motion::simulate;
        pub use crate::dynamics::row::clock::Settings;
    }
    pub mod hybrid {
        pub use crate::dynamics::hybrid::*;
    }
    pub mod joints {
        pub use crate::mechanics::joints::*;
    }
    pub mod lanes {
        pub use crate::mechanics::lanes::*;
    }
    pub mod slip {
        pub use crate::mechanics::slip::*;
    }
}
