//! Ground motion: acceleration as smooth, monotone pieces between known corners.
//!
//! An integrator must not step over a corner, and a search for the instant at which the ground gets
//! strong enough must not step over a peak. So a ground motion is cut at every jump, kink and extremum,
//! and each piece owns its one-sided formula: at a corner two pieces give two values.
//!
//! The ground may also move vertically. Within a piece either both components are straight lines, or they
//! are multiples of one monotone shape: **every linear combination of the two is monotone**, and so is the
//! distance from the onset of rocking.

mod error;
pub mod intensity;
mod motion;
mod piece;
mod pulse;
mod record;
mod shape;
mod velocity;

pub use error::GroundError;
pub use motion::GroundMotion;
pub use piece::Piece;
pub use pulse::{Pulse, PulseShape};
pub use shape::WaveTrain;
pub(in crate::dynamics) use velocity::FeetApart;
pub use velocity::GroundVelocity;
