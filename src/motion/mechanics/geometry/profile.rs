//! Profile that hinges divide into rigid parts: a continuous ring, or a row of blocks with joints.
//!
//! Sections are numbered from left to right, from zero to [`Profile::end`]: by the angle of a ring, or by the index of a joint. A hinge is on one of
//! the two edges of a section.

use std::fmt::Debug;
use std::sync::Arc;

use nalgebra::Vector2;

use super::rigid::{MassMoments, quarter_turn};
use crate::mechanics::{Edge, Ring};

/// Sections with two edges each, and the mass before each of them.
///
/// Lengths are in the size of the structure, masses in a unit of its own.
pub trait Profile: Debug + Send + Sync {
    /// Last section; the first one is zero.
    fn end(&self) -> f64;

    /// Point of a section on an edge.
    fn point(&self, section: f64, edge: Edge) -> Vector2<f64>;

    /// Middle of a section.
    fn middle(&self, section: f64) -> Vector2<f64> {
        (self.point(section, Edge::Intrados) + self.point(section, Edge::Extrados)) * 0.5
    }

    /// Unit vector from the intrados to the extrados.
    fn outward_direction(&self, section: f64) -> Vector2<f64>;

    /// Unit normal of a section towards the right support.
    fn onward_normal(&self, section: f64) -> Vector2<f64> {
        -quarter_turn(self.outward_direction(section))
    }

    /// Distance of the edges at a section.
    fn thickness(&self, section: f64) -> f64;

    /// Mass moments of the part before a section.
    fn moments_to(&self, section: f64) -> MassMoments;

    /// Mass moments between two sections.
    fn sector(&self, from: f64, to: f64) -> MassMoments {
        self.moments_to(to) - self.moments_to(from)
    }

    /// Mass moments per unit of the section's number; zero if hinges are possible at joints only.
    fn slice(&self, _section: f64) -> MassMoments {
        MassMoments::default()
    }

    /// Derivative of the point on an edge by the section's number; zero if hinges are possible at joints only.
    fn edge_slope(&self, _section: f64, _edge: Edge) -> Vector2<f64> {
        Vector2::zeros()
    }

    /// Sections that divide the profile into equal parts, including the supports. A row returns its joints for any number of parts.
    fn sections(&self, parts: usize) -> Vec<f64>;

    /// Joint at a section; `None` if sections are angles.
    fn joint(&self, _section: f64) -> Option<usize> {
        None
    }

    /// Closed polygons to draw between two sections, one for each block; `None` if the edges are arcs about the origin.
    fn outlines(&self, _from: f64, _to: f64) -> Option<&[Vec<Vector2<f64>>]> {
        None
    }

    /// This profile with shared ownership.
    fn to_shared(&self) -> Arc<dyn Profile>;
}

impl Profile for Ring {
    fn end(&self) -> f64 {
        self.embrace_rad
    }

    fn point(&self, section: f64, edge: Edge) -> Vector2<f64> {
        Self::point(self, section, edge)
    }

    fn middle(&self, section: f64) -> Vector2<f64> {
        self.radial_direction(section)
    }

    fn outward_direction(&self, section: f64) -> Vector2<f64> {
        self.radial_direction(section)
    }

    fn onward_normal(&self, section: f64) -> Vector2<f64> {
        self.tangent(section)
    }

    fn thickness(&self, _: f64) -> f64 {
        self.thickness_ratio
    }

    fn moments_to(&self, section: f64) -> MassMoments {
        Self::moments_to(self, section)
    }

    fn slice(&self, section: f64) -> MassMoments {
        Self::slice(self, section)
    }

    fn edge_slope(&self, section: f64, edge: Edge) -> Vector2<f64> {
        self.tangent(section) * self.radius(edge)
    }

    fn sections(&self, parts: usize) -> Vec<f64> {
        Self::sections(self, parts)
    }

    fn to_shared(&self) -> Arc<dyn Profile> {
        Arc::new(*self)
    }
}
