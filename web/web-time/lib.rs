//! A clock that stands still. The solver that uses it only reports its computing time, which nobody reads here.

pub use std::time::Duration;

/// An instant.
#[derive(Clone, Copy, Debug)]
pub struct Instant;

impl Instant {
    /// The only instant.
    pub const fn now() -> Self {
        Self
    }

    /// Zero.
    pub const fn elapsed(self) -> Duration {
        Duration::ZERO
    }
}
