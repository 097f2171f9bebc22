//! Rocking of masonry arches under ground motion.
//!
//! A horizontal acceleration of the ground beyond the **incipient acceleration** `A_L` turns a masonry
//! arch into a four-link mechanism that sways to one side. When the arch swings back, all hinges close at
//! once: an **impact**. The arch then sways to the other side along another mechanism, with less
//! energy. This crate follows the arch through all its impacts until it rests or overturns.
//!
//! Three models of motion implement [`Model`]. **Four links** ([`FourLinks`], and for a column [`RockingColumn`]) move as one mechanism at a
//! time. With **free hinges** ([`FreeHinges`]) the structure is a row of rigid blocks ([`mechanics::Row`]), and any joint may open, close and slip
//! at any time. **Elastic joints** ([`ElasticJoints`]) have a stiffness as well. The latter two cost more and are computed in steps; repetitions
//! ([`Model::repetitions`]) show how far the answer depends on these. A history, a [threshold](studies::threshold) and a
//! [map](studies::map) take any model.
//!
//! The modules, from the bottom up:
//!
//! - [`mechanics`]: pure functions. Shapes and rigid motions of their parts; the arch
//!   ([`Arch`]) and the column ([`Column`]); arches of other shapes, on piers, with fill and loads
//!   ([`mechanics::masonry`]), as rows of blocks ([`mechanics::Row`]); four-link mechanisms
//!   ([`mechanics::four_link`]): onset, finite motion, impact, the chain of mechanisms through which
//!   impacts lead, and the certificate of its restitution; limit analysis of joints that open ([`mechanics::stability`]) and slip ([`mechanics::friction`]).
//! - [`dynamics`]: motion in time. The ground ([`GroundMotion`]), models of motion ([`Model`]) and
//!   their histories ([`History`]); rows of blocks with rigid joints ([`FreeHinges`]) and with elastic joints
//!   ([`ElasticJoints`]).
//! - [`scenario`]: what to simulate, read from a TOML file. [`studies`]: a [run](studies::run), and many histories evaluated together.
//!   [`output`]: results as CSV, JSON and pictures.
//!
//! The arch of the paper, and the history of `docs/start.md`:
//!
//! ```
//! use archrock::{Arch, FourLinks, ImpactModel, Model, Outcome, Pulse, Request};
//!
//! // Mean radius in m, thickness over it, embrace angle in degrees.
//! let arch = Arch::new(5.0, 0.15, 180.0)?;
//! assert!((arch.incipient()?.acceleration_g - 0.14432644).abs() < 1e-8);
//!
//! let model = FourLinks::of_arch(&arch, ImpactModel::MaxRestitution)?;
//! // -0.30 g for 0.20 s, from the start.
//! let ground = Pulse::Rectangular.lasting_s(0.20).horizontal_m_s2(-0.30 * 9.81)?;
//! let history = model.history(&ground, &Request::default())?;
//! assert_eq!(history.summary.outcome, Outcome::Rest);
//! let (time_s, impact) = history.impacts().next().expect("an impact");
//! assert!((time_s - 1.0279).abs() < 1e-4 && (impact.restitution - 0.681186).abs() < 1e-6);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! An arch of 36 voussoirs with free hinges:
//!
//! ```
//! use archrock::{Arch, FreeHinges, Model, Outcome, Pulse, Request, Sway};
//!
//! let model = FreeHinges::of_arch(&Arch::new(5.0, 0.15, 180.0)?.with_voussoirs(36)?)?;
//! assert!((model.incipient_acceleration_g(Sway::Right).expect("a push moves it") - 0.144800).abs() < 1e-6);
//! let ground = Pulse::Rectangular.lasting_s(0.20).horizontal_m_s2(-0.14 * 9.81)?;
//! let summary = model.simulate(&ground, &Request::default(), None)?;
//! assert_eq!(summary.outcome, Outcome::NeverMoved);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Conventions
//!
//! x to the right, y upwards, rotations positive anticlockwise. Sections are named by their angle from the
//! left springing. The ground acceleration is positive to the right, so that a negative one pushes the
//! arch to the right. The restitution coefficient is the ratio of kinetic energies after and before an
//! impact. [`mechanics`] works in mean radii, unit density and the frame in which a mechanism sways right;
//! SI units begin with [`Arch`] and [`Column`], and [`scenario`] converts
//! accelerations given in g.
//!
//! # Sources
//!
//! "The paper" in this documentation is *Impacts analysis in the rocking of masonry circular arches*; it is
//! quoted by its equation numbers. Where a result is derived here instead, the documentation says so.
// Tests compare with tolerances.
#![cfg_attr(test, allow(clippy::disallowed_methods))]

#[macro_use]
extern crate archrock_text;

use archrock_motion::{argument, bisection, work};

mod clock;
pub mod output;
pub mod scenario;
pub mod studies;

#[doc(inline)]
pub use archrock_motion::{dynamics, mechanics};

pub use argument::ArgumentError;
pub use dynamics::{
    Case, Direction, Directions, ElasticJoints, EndCondition, Event, EventKind, FreeHinges,
    GroundError, GroundMotion, History, Impact, Initial, Job, Jobs, MEMORY_BYTES, MechanismModel,
    MemoryError, Model, OpenHinge, Outcome, Pulse, PulseShape, Recorder, Request, RowModelError,
    RowMotionError, RowOptions, Sample, Samples, SimulationError, State, Summary, WaveTrain,
};
pub use mechanics::elastic_joint::{
    Contact, ElasticProperties, JointStiffness, Materials, Stiffness,
};
pub use mechanics::{
    Arch, BackWall, Column, FourLinkError, FourLinks, Hinge, ImpactLaw, ImpactModel, Masonry, Pose,
    RockingColumn, Row, Sway,
};
pub use scenario::{Scenario, Structure};
pub use studies::map::OverturningMap;
pub use studies::threshold::{Factors, Threshold, threshold};
pub use studies::{Counted, Progress, Runner};
pub use studies::{Ending, NoHistory, Verdict};

/// The tasks of the document compile and run.
#[cfg(doctest)]
#[doc = include_str!("../docs/library.md")]
struct Library;
