//! Motion in time: ground motion, models of motion and their histories.
pub mod demand;
pub(crate) mod direction;
pub(crate) mod elastic_joints;
pub(crate) mod fall;
pub(crate) mod free_hinges;
pub(crate) mod ground;
pub(crate) mod history;
pub(crate) mod hybrid;
pub(crate) mod model;
pub(crate) mod peak;
mod recorder;
pub(crate) mod recording;
pub mod repeatability;
mod request;
pub(crate) mod row;
pub(crate) mod thrust;
pub(crate) mod until;
pub(crate) mod variation;

pub use self::demand::{GroundSpectrum, Site};
pub use self::direction::{Direction, Directions};
pub use self::elastic_joints::ElasticJoints;
pub use self::fall::FallEnd;
pub use self::free_hinges::{DOUBTFUL_ENERGY_ERROR, FreeHinges, RowOptions};
pub use self::ground::{
    GroundError, GroundMotion, GroundPiece, GroundVelocity, Intensity, Pulse, PulseShape, WaveTrain,
};
pub use self::history::{
    Cost, Details, ElasticSummary, Event, EventKind, HalfCycle, Impact, JointPressure,
    MechanismSummary, OpenHinge, Outcome, OutcomeKind, RowSummary, Sample, Sliding, State, Stress,
    Summary, TieSample, TieSummary,
};
pub use self::model::{
    Case, FEET_NEED_JOINTS, Initial, Job, Jobs, MechanismModel, Model, Recorder, Repetition,
    Request, SimulationError, WithoutDemand,
};
pub use self::peak::{NO_RISE, Peak};
pub use self::recording::{History, MEMORY_BYTES, MemoryError, Recording, Samples};
pub use self::repeatability::{OutcomeCount, Repeatability, Verdict};
pub(crate) use self::row::clock::Settings;
pub use self::row::error::{ReboundError, RowModelError, RowMotionError};
pub(crate) use self::row::input::MotionInput;
pub(crate) use self::row::observer::MotionObserver;
pub(crate) use self::row::stepper::Stepper;
pub use self::thrust::{EXCESS_LEVELS, FrictionRecord, LASTING, MODEL_LIMIT, ThrustRecord};
pub use self::until::EndCondition;
pub use self::variation::{Variation, VariationResult, Variations};
