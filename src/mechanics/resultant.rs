//! Lines of resultants: the thrust line of a load and the impulse line of an impact.
//!
//! Cut the ring at a section. What the part before it hands on to the part after it is the reaction
//! at the left springing plus the whole load in between: a force with a line of action, or, when
//! the load is a change of velocity, an impulse. The points where these lines cross their sections
//! make the thrust line (the impulse line). Through a hinge it passes by definition.

use nalgebra::{Matrix3, Vector3};

use super::field::{Field, Momentum, Twist};
use super::mechanism::{EDGES, FourLink};
use super::ring::{Edge, Ring};

/// The resultants over all sections of a ring under a load per unit mass.
#[derive(Clone, Debug)]
pub struct ResultantLine {
    ring: Ring,
    load: Field,
    start: Momentum,
}

/// Resultant at one section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectionResultant {
    /// Along the axis, positive in compression.
    pub normal: f64,
    /// Along the section, positive when the part before pushes the part after outwards.
    pub tangential: f64,
    /// Moment of the normal component about the axis, positive when it lies outwards.
    pub moment: f64,
    /// Where the line of action crosses the section, outwards from the axis, over the thickness:
    /// within -0.5 (intrados) to 0.5 (extrados) inside the ring.
    pub eccentricity_ratio: f64,
}

impl SectionResultant {
    /// Components and position, at a section, of a force with its moment about the centre of the ring.
    #[must_use]
    pub fn new(ring: &Ring, angle_rad: f64, resultant: &Momentum) -> Self {
        let (radial, tangent) = (ring.radial(angle_rad), ring.tangent(angle_rad));
        let normal = resultant.linear.dot(&tangent);
        // A force N at distance e outwards from the axis has the moment -e N about its point there.
        let moment = -resultant.about(radial);
        Self {
            normal,
            tangential: resultant.linear.dot(&radial),
            moment,
            eccentricity_ratio: moment / (normal * ring.thickness_ratio()),
        }
    }
}

impl ResultantLine {
    /// The line through three hinges of `mechanism` (A, B and D), under `load`.
    ///
    /// A mechanism makes the ring statically determinate but for one number: the line passes through
    /// C as well when the load does no work on the mechanism.
    #[must_use]
    pub fn through_hinges(ring: &Ring, mechanism: &FourLink, load: Field) -> Self {
        let hinges = [0, 1, 3];
        let points = mechanism.points();
        let matrix = Matrix3::from_fn(|row, column| {
            let point = points[hinges[row]];
            [-point.y, point.x, -1.0][column]
        });
        let moments = Vector3::from_fn(|row, _| {
            let hinge = hinges[row];
            load.momentum_to(ring, mechanism.hinges_rad()[hinge])
                .about(points[hinge])
        });
        let start = matrix
            .lu()
            .solve(&moments)
            .expect("three hinges of an admissible mechanism are not on one line");
        Self {
            ring: *ring,
            load,
            start: Momentum {
                linear: start.xy(),
                angular: start.z,
            },
        }
    }

    /// Force (impulse) at a section, with its moment about the centre of the ring.
    #[must_use]
    pub fn at(&self, angle_rad: f64) -> Momentum {
        self.start + self.load.momentum_to(&self.ring, angle_rad)
    }

    /// Components and position at a section.
    #[must_use]
    pub fn section(&self, angle_rad: f64) -> SectionResultant {
        SectionResultant::new(&self.ring, angle_rad, &self.at(angle_rad))
    }

    /// Derivative with respect to the angle of the moment about the edge point of the section, where
    /// the load is `local`. Zero where the line touches the edge.
    fn edge_moment_slope(&self, angle_rad: f64, edge: Edge, local: Twist) -> f64 {
        let slice = local.momentum(&self.ring.slice(angle_rad));
        let along_edge = self.ring.tangent(angle_rad) * self.ring.radius(edge);
        slice.about(self.ring.point(angle_rad, edge)) - along_edge.perp(&self.at(angle_rad).linear)
    }

    /// Derivative of the power of the load on `mechanism` (at `q' = 1`) with respect to the sections
    /// of its hinges, the rotations following so that the mechanism stays closed.
    ///
    /// A moved hinge changes the rotations at all four, but the line has no moment at any of them: only
    /// the moment that the moved point itself picks up counts. `local` is the load at each hinge.
    pub(crate) fn power_gradient(&self, mechanism: &FourLink, local: [Twist; 4]) -> [f64; 4] {
        let (hinges, openings) = (mechanism.hinges_rad(), mechanism.openings());
        std::array::from_fn(|i| {
            -openings[i] * self.edge_moment_slope(hinges[i], EDGES[i], local[i])
        })
    }

    /// How far the line leaves the ring, in parts of the thickness, over the given sections: the
    /// largest `|e|/t - 0.5`, infinite where the ring would be in tension.
    pub fn largest_excess(&self, sections_rad: impl Iterator<Item = f64>) -> f64 {
        sections_rad
            .map(|angle| {
                let section = self.section(angle);
                if section.normal > 0.0 {
                    section.eccentricity_ratio.abs() - 0.5
                } else {
                    f64::INFINITY
                }
            })
            .fold(f64::NEG_INFINITY, f64::max)
    }
}
