//! Mechanics of arches and columns: pure functions, no time, no files.
pub(crate) mod arch;
pub(crate) mod back_wall;
mod block;
pub(crate) mod blocks;
pub(crate) mod capacity;
pub(crate) mod chain;
pub(crate) mod column;
pub(crate) mod complementarity;
mod cone_program;
pub(crate) mod contact;
pub(crate) mod coulomb;
pub mod elastic_joint;
pub(crate) mod equivalent;
pub mod four_link;
pub(crate) mod four_links;
pub mod friction;
pub(crate) mod geometry;
mod given_body;
mod held_top;
pub(crate) mod joints;
pub(crate) mod lanes;
mod load;
pub mod masonry;
pub(crate) mod parts;
pub(crate) mod row_state;
pub mod settling;
pub(crate) mod sides;
pub(crate) mod slip;
pub mod stability;
pub(crate) mod sway;
mod symmetry;
pub(crate) mod tie;
mod tilting;
pub(crate) mod virtual_work;

pub use self::arch::{
    Arch, DENSITY_KG_M3, DEPTH_M, EMBRACE_DEG, MAGNITUDE, MIN_THICKNESS_RATIO, MeasuredAt,
    THICKNESS_RATIO_BOUND, VOUSSOIRS,
};
pub use self::back_wall::{BackWall, NoWallRatio, three_impacts};
pub use self::blocks::{Block, Drum, Joint, MAX_BLOCKS, Row, RowError, Supports};
pub use self::capacity::{
    Capacity, CapacityError, Control, CurvePoint, Displaced, TieEventDisplacements,
};
pub use self::chain::{
    Coefficients, Demand, Hinge, Link, Mechanism, MechanismChain, MechanismState, critical_rad,
};
pub use self::column::{Column, ColumnLoadError, RockingColumn};
pub(crate) use self::contact::Corners;
pub use self::elastic_joint::{ElasticStructure, Equilibrium};
pub use self::equivalent::{Equivalent, equivalent_towards};
pub use self::four_link::impact::{ImpactLaw, ImpactModel};
pub use self::four_link::limit::LimitError;
pub use self::four_links::{FourLinkError, FourLinks};
pub use self::friction::FrictionError;
pub use self::geometry::curve::Curve;
pub use self::geometry::field::{Field, Momentum, Side, Twist, quarter_turn};
pub use self::geometry::pose::{BodyPoint, Pose};
pub use self::geometry::profile::Profile;
pub(crate) use self::geometry::rigid::mirrored;
pub use self::geometry::ring::{Edge, MassMoments, Ring};
pub use self::given_body::GivenBody;
pub use self::held_top::{HeldMechanism, HeldTopError};
pub(crate) use self::joints::Placement;
pub(crate) use self::lanes::{Lanes, Real};
pub use self::load::{HeldTop, LARGEST_THRUST_N, PlacedLoad, Weight};
pub use self::masonry::{Masonry, MasonryShape};
pub use self::parts::{Outline, Parts, StructureSection};
pub(crate) use self::row_state::RowState;
pub use self::settling::{Follower, Movements, SettlingError};
pub use self::sides::Sides;
pub use self::stability::{RowOnset, StabilityError};
pub use self::sway::Sway;
pub use self::tie::{Anchor, Tie, TieError, TieLine, TieMemory};
pub use self::virtual_work::{
    MovingBody, MovingForce, MovingTie, Participation, displacement_factor, load_multiplier,
};
