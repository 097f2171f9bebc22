//! Ground motion: acceleration as smooth, monotone pieces between known corners.
//!
//! An integrator must not step over a corner. A search for the time at which the ground becomes strong enough must not step over a peak. A ground
//! motion is therefore cut at every jump, kink and extremum, and each piece has its own one-sided formula: at a corner two pieces give two values.
//!
//! The ground may also move vertically. In a piece, either both components are linear, or they are multiples of one monotone shape. **Every linear
//! combination of the two is therefore monotone**, as is the margin to the onset of rocking.

mod error;
mod intensity;
mod motion;
mod piece;
mod pulse;
mod record;
mod shape;
mod velocity;

pub use error::GroundError;
pub use intensity::Intensity;
pub use motion::GroundMotion;
pub use piece::GroundPiece;
pub use pulse::{Pulse, PulseShape};
pub use shape::WaveTrain;
pub(in crate::dynamics) use velocity::FeetApart;
pub use velocity::GroundVelocity;
