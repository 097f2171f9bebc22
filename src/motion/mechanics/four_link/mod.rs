//! The arch as a four-link mechanism: its start, its motion, and its impacts.
pub(crate) mod certificate;
pub(crate) mod chain;
pub(crate) mod impact;
pub(crate) mod impulse_line;
pub(crate) mod jointed;
pub(crate) mod limit;
pub(crate) mod linkage;
pub(crate) mod mechanism;
pub(crate) mod resultant;
mod search;
pub(crate) mod self_weight;
pub(crate) mod thrust;

pub use self::certificate::{
    DEFAULT_JOINTS, Joint, Projection, ProjectionError, joints_rad, project,
};
pub use self::chain::{ArchLink, Chain};
pub use self::impact::{Impact, ImpactLaw, ImpactModel, closing_field, impact, projection};
pub use self::impulse_line::ImpulseLine;
pub use self::limit::{Incipient, LimitError, acceleration_g, incipient, least_thickness_ratio};
pub use self::linkage::Linkage;
pub use self::mechanism::{EDGES, FourLink, HingeSites};
pub use self::resultant::{Extremes, Extremum, ResultantLine, SectionResultant};
pub use self::self_weight::carries_its_weight;
pub use self::thrust::ThrustLine;
