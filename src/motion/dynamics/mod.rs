//! Motion in time: ground motion, models of motion and their histories.
pub mod demand;
pub mod elastic_joints;
pub mod fall;
pub mod free_hinges;
pub mod ground;
pub mod history;
pub(crate) mod hybrid;
pub mod model;
pub mod peak;
mod recorder;
pub mod recording;
pub mod repeatability;
mod request;
pub mod row;
pub mod thrust;
pub mod until;
pub mod variation;

pub use self::demand::ground::{GroundSpectrum, Site};
pub use self::fall::FallEnd;
pub use self::free_hinges::RowOptions;
pub use self::ground::{GroundMotion, GroundVelocity};
pub use self::history::{
    Cost, Details, Event, EventKind, HalfCycle, OpenHinge, Outcome, OutcomeKind, Sample, Sliding,
    State, Summary, TieSample,
};
pub use self::model::{MechanismModel, Model, Repetition, Request, SimulationError};
pub use self::repeatability::{OutcomeCount, Repeatability, Verdict};
pub(crate) use self::row::clock::Settings;
pub(crate) use self::row::course::Course;
pub use self::row::error::{RowModelError, RowMotionError};
pub(crate) use self::row::stepper::Stepper;
pub(crate) use self::row::task::Task;
pub use self::thrust::ThrustRecord;
pub use self::variation::Variation;
