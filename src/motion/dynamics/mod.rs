//! Motion in time: ground motion, models of motion and their histories.
pub mod demand;
pub(crate) mod elastic_joints;
pub(crate) mod fall;
pub mod free_hinges;
pub mod ground;
pub mod history;
pub(crate) mod hybrid;
pub mod model;
pub mod peak;
mod recorder;
pub(crate) mod recording;
pub mod repeatability;
mod request;
pub(crate) mod row;
pub mod thrust;
pub(crate) mod until;
pub mod variation;

pub use self::demand::ground::{GroundSpectrum, Site};
pub use self::elastic_joints::ElasticJoints;
pub use self::fall::FallEnd;
pub use self::free_hinges::RowOptions;
pub use self::ground::{GroundMotion, GroundVelocity};
pub use self::history::{
    Cost, Details, Event, EventKind, HalfCycle, OpenHinge, Outcome, OutcomeKind, Sample, Sliding,
    State, Summary, TieSample,
};
pub use self::model::{MechanismModel, Model, Repetition, Request, SimulationError};
pub use self::recording::{History, MEMORY_BYTES, MemoryError, Recording, Samples};
pub use self::repeatability::{OutcomeCount, Repeatability, Verdict};
pub(crate) use self::row::clock::Settings;
pub use self::row::error::{RowModelError, RowMotionError};
pub(crate) use self::row::input::MotionInput;
pub(crate) use self::row::observer::MotionObserver;
pub(crate) use self::row::stepper::Stepper;
pub use self::thrust::ThrustRecord;
pub use self::until::EndCondition;
pub use self::variation::Variation;
