//! Elastic joints: interfaces of finite stiffness between two rigid bodies, without tension, with Coulomb friction, damping and crushing.
//!
//! - `kinematics` computes penetration and slip of the faces of a joint, exactly at any rotation.
//! - `contact` integrates the resulting stress over the joint.
//! - `structure` holds the bodies and the joints between them.
//! - `statics` finds their equilibrium.
//!
//! The code is generic over a number type, `Real`: one motion, several motions in parallel, or derivatives.

mod banded;
mod contact;
mod kinematics;
mod statics;
mod structure;
mod tie;

pub use contact::{Contact, ElasticJoint, Fibre, Memory, NormalForces, ShearForce};
pub use kinematics::{Action, BodyPosition, Gap, JointGeometry};
pub use statics::{Equilibrium, RestError};
pub use structure::{ElasticProperties, ElasticStructure, JointStiffness, Materials, Stiffness};
pub use tie::BoundTie;
