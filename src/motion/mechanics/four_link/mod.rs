//! The arch as a four-link mechanism: its start, its motion, and its impacts.
pub mod certificate;
pub mod chain;
pub mod impact;
pub mod impulse_line;
pub(crate) mod jointed;
pub mod limit;
pub(crate) mod linkage;
pub mod mechanism;
pub mod resultant;
mod search;
pub(crate) mod self_weight;
pub(crate) mod thrust;

pub use self::linkage::Linkage;
pub use self::self_weight::carries_its_weight;
pub use self::thrust::ThrustLine;
