//! Stability of a ring under its own weight, by statics only.
//!
//! The static theorem: a ring without tensile strength is stable if and only if a thrust line under its weight
//! stays inside it at every section (at every joint, for voussoirs, which are rigid). Ring and weight are
//! symmetric, and the mean of an admissible line and its mirror image is admissible: so only symmetric lines
//! matter, whose resultant at the crown is horizontal. That leaves two unknowns, the thrust `h` and its moment
//! `k` about the centre, in units of the weight per radian and of the mean radius.
//!
//! At the angle `phi` from the crown the resultant has the normal component `N = h cos phi + phi sin phi` and the
//! moment `k + c (1 - cos phi)` about the centre, where `c = 1 + t^2/12` is the distance of a slice's weight from
//! the centre. It acts inside the ring, in compression, if
//!
//! ```text
//! r_i N <= k + c (1 - cos phi) <= r_e N
//! ```
//!
//! with `r_i` and `r_e` the radii of intrados and extrados: a linear program in two variables. For a given
//! `h` the sections bound `k` from below by a convex function of `h` and from above by a concave one; the ring
//! is stable if there is an interval between them at the best `h`. If hinges may be anywhere, the governing sections are
//! known in closed form or by one equation, so the answer is exact to rounding for both kinds of ring.
//!
//! A thicker ring is stable if a thinner one is: the line of the thinner one is inside, since by the right-hand
//! inequality `r_e N` grows with `t` faster than `c (1 - cos phi)` up to `t = 2`.

use super::mechanism::HingeSites;
use crate::bisection::{Width, bisect};
use crate::mechanics::{Edge, Ring};

/// Whether the ring is stable under its own weight.
pub fn carries_its_weight(ring: &Ring, sites: HingeSites) -> bool {
    let margin = SymmetricLines::new(ring, sites).largest_margin();
    margin.is_none_or(|margin| margin > 0.0)
}

/// Symmetric thrust lines of a ring under its own weight.
struct SymmetricLines {
    ring: Ring,
    sites: HingeSites,
    /// Angles from the crown, ascending: the joints of half the ring, or its crown and springing.
    sections_rad: Vec<f64>,
    /// Distance `c` of the weight of a slice from the centre.
    slice_radius: f64,
}

/// Bound on `k`, with its derivative by `h`.
#[derive(Clone, Copy)]
struct Bound {
    value: f64,
    slope: f64,
}

impl SymmetricLines {
    fn new(ring: &Ring, sites: HingeSites) -> Self {
        let half = 0.5 * ring.embrace_rad;
        let sections_rad = match sites {
            HingeSites::Anywhere => vec![0.0, half],
            HingeSites::Voussoirs(count) => {
                let joints = ring.sections(count).into_iter().skip(count.div_ceil(2));
                joints.map(|angle| angle - half).collect()
            }
        };
        Self {
            ring: *ring,
            sites,
            sections_rad,
            slice_radius: 1.0 + ring.thickness_ratio.powi(2) / 12.0,
        }
    }

    /// `k` for which the thrust line with thrust `h` meets an edge at a section.
    fn touching_k(&self, edge: Edge, h: f64, angle_rad: f64) -> Bound {
        let (sin, cos) = libm::sincos(angle_rad);
        // This form of 1 - cos phi avoids cancellation in shallow rings.
        let drop = 2.0 * libm::sin(0.5 * angle_rad).powi(2);
        let radius = self.ring.radius(edge);
        Bound {
            value: radius * (h * cos + angle_rad * sin) - self.slice_radius * drop,
            slope: radius * cos,
        }
    }

    /// Smallest `k` of a thrust line with thrust `h` that is nowhere below the intrados.
    fn least_k(&self, h: f64) -> Bound {
        let inside = match self.sites {
            HingeSites::Anywhere => Some(self.haunch_rad(h)),
            HingeSites::Voussoirs(_) => None,
        };
        let sections = self.sections_rad.iter().copied().chain(inside);
        let bounds = sections.map(|angle| self.touching_k(Edge::Intrados, h, angle));
        let least = bounds.max_by(|a, b| a.value.total_cmp(&b.value));
        least.expect("a ring has a springing")
    }

    /// Largest `k` of a thrust line with thrust `h` that is nowhere above the extrados.
    ///
    /// From crown to springing [`Self::touching_k`] may first increase, and then decreases (see [`Self::haunch_rad`]): its minimum is at one of the
    /// two.
    fn largest_k(&self, h: f64) -> Bound {
        let sections = self.sections_rad.iter();
        let bounds = sections.map(|angle| self.touching_k(Edge::Extrados, h, *angle));
        let largest = bounds.min_by(|a, b| a.value.total_cmp(&b.value));
        largest.expect("a ring has a springing")
    }

    /// Section of a continuous ring at which a thrust line with thrust `h` above the intrados touches the intrados: where
    /// [`Self::touching_k`] is largest.
    ///
    /// Its slope is zero where `tan phi / phi = r / (r (h - 1) + c)`. The left-hand side increases from 1 to infinity between crown and 90 degrees.
    /// The slope therefore changes its sign at most once, from positive to negative.
    fn haunch_rad(&self, h: f64) -> f64 {
        let radius = self.ring.radius(Edge::Intrados);
        let rises = |angle: f64| {
            let (sin, cos) = libm::sincos(angle);
            radius * angle * cos > (radius * (h - 1.0) + self.slice_radius) * sin
        };
        find_last(0.0, 0.5 * self.ring.embrace_rad, rises)
    }

    /// Largest interval of `k` over all thrusts: positive if the ring is stable. `None` if it is unbounded, because a straight line fits
    /// into the ring.
    fn largest_margin(&self) -> Option<f64> {
        let (first, springing) = (self.sections_rad[0], 0.5 * self.ring.embrace_rad);
        let slope = |edge: Edge, angle: f64| self.touching_k(edge, 0.0, angle).slope;
        if slope(Edge::Extrados, springing) >= slope(Edge::Intrados, first) {
            return None;
        }
        // The margin is concave in h. Up to the first change of the section that bounds k from above it rises,
        // after the last change on either side it falls. Two sections change places at h = (phi sin phi - psi
        // sin psi) / (cos psi - cos phi) - c/r, where the quotient lies between 0 and 2 by Cauchy's mean value
        // theorem: the best thrust is in (0, 2).
        let rises = |h: f64| self.largest_k(h).slope > self.least_k(h).slope;
        let h = find_last(0.0, 2.0, rises);
        Some(self.largest_k(h).value - self.least_k(h).value)
    }
}

/// Last number, within rounding error, at which a condition holds that also holds for all smaller numbers.
fn find_last(low: f64, high: f64, holds: impl Fn(f64) -> bool) -> f64 {
    bisect(low, high, Width::Rounding, |at| !holds(at)).0
}
