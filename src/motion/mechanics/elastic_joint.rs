//! Elastic joints: interfaces of finite stiffness between two rigid bodies, without tension, with Coulomb friction, damping and
//! crushing.
//!
//! `kinematics` says how far the faces of a joint penetrate each other and slip, exactly at any rotation. `contact` gives the stress
//! that results, summed over the joint. `structure` collects bodies and the joints between them, and `statics` finds where they
//! rest.
//!
//! The code is written once for any [`Real`](super::lanes::Real): a motion alone, several side by side, or derivatives.

mod banded;
mod contact;
mod kinematics;
mod statics;
mod structure;
mod tie;

pub use contact::{Contact, ElasticJoint, Fibre, Memory, Pressing, Rubbing};
pub use kinematics::{Action, Gap, Link, Place};
pub use statics::{Rest, RestError};
pub use structure::{
    Body, ElasticProperties, ElasticStructure, JointStiffness, Materials, Stiffness,
};
pub use tie::BoundTie;
