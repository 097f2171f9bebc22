//! Rocking of masonry arches under ground motion.
//!
//! A horizontal acceleration of the ground beyond the **incipient acceleration** `A_L` turns a masonry
//! arch into a four-link mechanism that sways to one side. When it comes back all hinges close at once:
//! an **impact**, after which the arch sways on to the other side along another mechanism, with less
//! energy. This crate follows the arch through all its impacts until it rests or overturns.
//!
//! From the bottom up:
//!
//! - [`mechanics`]: pure functions. The ring and its sectors in closed form ([`mechanics::geometry::ring`]), rigid
//!   motions of its parts ([`mechanics::geometry::field`]), four-link mechanisms ([`mechanics::four_link::mechanism`]), the
//!   onset of rocking by limit analysis ([`mechanics::four_link::limit`]), the mechanism at finite rotations
//!   ([`mechanics::four_link::linkage`]), the impact ([`mechanics::four_link::impact`]), its impulses
//!   ([`mechanics::four_link::impulse_line`]) and what certifies it ([`mechanics::four_link::certificate`]), and the chain of
//!   mechanisms that impacts lead through ([`mechanics::four_link::chain`]). The thrust line in motion
//!   ([`mechanics::four_link::thrust`]) tells how far four links suffice. An arch ([`mechanics::arch`]) and
//!   Housner's column ([`mechanics::column`]) are structures of one kind ([`mechanics::structure`]).
//! - [`dynamics`]: motion in time. An engine for systems that jump between modes ([`dynamics::hybrid::engine`]),
//!   the ground ([`dynamics::ground`]), rocking as such a system ([`dynamics::hybrid::rocking`]) and its history
//!   ([`dynamics::history`]).
//! - [`studies`]: many histories, and what they say together. What is shaken and how it ends
//!   ([`studies::specimen`]), how likely an intensity overturns it ([`studies::fragility`]).
//! - [`scenario`]: what is to be simulated, as a TOML file. [`output`]: results as CSV, JSON and pictures.
//!
//! The arch of the paper, and the history of the README:
//!
//! ```
//! use std::ops::ControlFlow;
//!
//! use archrock::dynamics::ground::{GroundMotion, Pulse};
//! use archrock::dynamics::history::{Outcome, Request, history};
//! use archrock::dynamics::hybrid::rocking::Rocking;
//! use archrock::mechanics::arch::Arch;
//! use archrock::mechanics::four_link::chain::Chain;
//! use archrock::mechanics::four_link::impact::ImpactModel;
//! use archrock::mechanics::four_link::mechanism::HingeSites;
//! use archrock::mechanics::geometry::ring::Ring;
//!
//! let ring = Ring::new(0.15, std::f64::consts::PI)?;
//! let chain = Chain::new(ring, HingeSites::Anywhere, ImpactModel::MaxRestitution)?;
//! assert!((chain.incipient().acceleration_g - 0.14432644).abs() < 1e-8);
//! let arch = Arch {
//!     mean_radius_m: 5.0,
//!     depth_m: 1.0,
//!     density_kg_m3: 2000.0,
//!     chain: chain.into(),
//! };
//!
//! let gravity_m_s2 = 9.81;
//! let ground = GroundMotion::pulse(Pulse::Rectangular, -0.30 * gravity_m_s2, 0.20, 0.0);
//! let rocking = Rocking::new(&arch, &ground, gravity_m_s2, 1e-8);
//! let request = Request {
//!     end_s: 10.0,
//!     relative_tolerance: 1e-9,
//!     initial: None,
//!     output_step_s: None,
//! };
//! let history = history(&rocking, &request, |_| ControlFlow::Continue(()))?;
//! assert_eq!(history.outcome, Outcome::Rest);
//! assert!((history.impacts[0].time_s - 1.0279).abs() < 1e-4);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Conventions
//!
//! x to the right, y upwards, rotations positive anticlockwise. Sections are named by their angle from the
//! left springing. The ground acceleration is positive to the right, so that a negative one pushes the
//! arch to the right. The restitution coefficient is the ratio of kinetic energies after and before an
//! impact. [`mechanics`] works in mean radii, unit density and the frame in which a mechanism sways right;
//! SI units begin with [`mechanics::arch`], and units of gravity end at [`scenario`].
//!
//! # Sources
//!
//! "The paper" in this documentation is *Impacts analysis in the rocking of masonry circular arches*; it is
//! quoted by its equation numbers. What is derived here instead says so.

#[macro_use]
mod named;
mod bisection;
pub mod dynamics;
pub mod mechanics;
pub mod output;
pub mod scenario;
pub mod studies;
