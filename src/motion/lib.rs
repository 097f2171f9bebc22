//! Mechanics and motion of masonry that rocks: what `archrock` computes with. Nothing here reads or writes a file.
//!
//! - [`mechanics`]: pure functions of shapes, rigid bodies, joints and mechanisms.
//! - [`dynamics`]: motion in time: the ground, models of motion and their histories.
// Tests compare with tolerances.
#![cfg_attr(test, allow(clippy::disallowed_methods))]

#[macro_use]
extern crate archrock_text;

pub mod argument;
pub mod bisection;
pub mod dynamics;
pub mod mechanics;
pub mod work;

/// Parts below the models of motion, for tests and benchmarks. They are not for users, and may change with any release.
#[cfg(feature = "internals")]
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
        use crate::dynamics::free_hinges::motion::motion;
        use crate::dynamics::model::Recorder;
        pub use crate::dynamics::row::clock::Settings;
        use crate::dynamics::row::standing::Release;
        use crate::dynamics::{GroundMotion, MotionInput, RowMotionError, Summary};
        use crate::mechanics::{Row, RowState};

        /// Computes the motion of a row on moving ground, from rest or released at given rotations of its blocks (in radians; without slip only).
        ///
        /// # Errors
        /// If the initial rotations do not close the arch, or a step fails.
        pub fn simulate(
            row: &Row,
            ground: &GroundMotion,
            gravity_m_s2: f64,
            settings: &Settings,
            initial_rad: Option<&[f64]>,
            recorder: Option<&mut dyn Recorder>,
        ) -> Result<Summary, RowMotionError> {
            let input = MotionInput::new(row, ground, gravity_m_s2, *settings);
            let release = initial_rad.map(|rotations_rad| Release {
                rotations_rad: rotations_rad.to_vec(),
                rates_rad_s: vec![0.0; rotations_rad.len()],
            });
            let standing = RowState::undeformed(row);
            motion(input, &standing, release.as_ref(), recorder)
        }
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
