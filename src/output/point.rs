//! Points of a structure, such as the crown, and the bodies that carry them.

use std::f64::consts::TAU;

use nalgebra::Vector2;

use super::scene::{Scene, link, sections_rad};
use crate::OpenHinge;
use crate::mechanics::BodyPoint;
use crate::mechanics::Outline;

/// A point of a structure. The body that carries the point may depend on the open hinges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StructurePoint {
    /// Position in the undeformed structure, in metres.
    pub at_m: Vector2<f64>,
    part: PointLocation,
}

/// The part of the structure to which a point belongs.
#[derive(Clone, Copy, Debug, PartialEq)]
enum PointLocation {
    /// A block, by its index.
    Block(usize),
    /// A section of a ring, in radians from the left springing.
    Section(f64),
}

impl Scene {
    /// Finds the point of the structure at this undeformed position, in metres. A position just outside belongs to the nearest block, within
    /// rounding errors and the error of curves drawn as straight lines.
    ///
    /// # Errors
    /// When the position is outside the structure; the error is the nearest position inside.
    pub fn point(&self, at_m: impl Into<Vector2<f64>>) -> Result<StructurePoint, Vector2<f64>> {
        let at_m = at_m.into();
        let pieces = self.pieces(&[]).into_iter().enumerate();
        let near = pieces.map(|(index, piece)| (index, nearest(&piece.outline_m, at_m)));
        let away_m = |near_m: &Vector2<f64>| (near_m - at_m).norm();
        let nearest = near.min_by(|a, b| away_m(&a.1).total_cmp(&away_m(&b.1)));
        let (index, near_m) = nearest.expect("a structure has bodies");
        let [low_m, high_m] = self.bounds_m();
        if away_m(&near_m) > BESIDE_RATIO * (high_m - low_m).amax() {
            return Err(near_m);
        }
        let part = match &self.outline {
            Outline::Ring { ring, .. } => {
                let left = ring.radial_direction(0.0);
                let angle_rad = -libm::atan2(left.perp(&at_m), left.dot(&at_m));
                // Points just below the left springing have angles down to this one; smaller angles are beyond the right springing.
                let before_rad = 0.5 * (ring.embrace_rad - TAU);
                let turns = if angle_rad < before_rad { TAU } else { 0.0 };
                PointLocation::Section((angle_rad + turns).clamp(0.0, ring.embrace_rad))
            }
            Outline::Block(_) | Outline::Row(_) => PointLocation::Block(index),
        };
        Ok(StructurePoint { at_m, part })
    }

    /// Returns a point with the body that carries it while these hinges are open.
    pub fn body_point(&self, point: &StructurePoint, hinges: &[OpenHinge]) -> BodyPoint {
        let body = match (point.part, &self.outline) {
            (PointLocation::Section(angle_rad), _) => link(&sections_rad(hinges), angle_rad),
            (PointLocation::Block(block), _) => self.body_of(block, hinges),
        };
        BodyPoint {
            body,
            at_m: point.at_m,
        }
    }
}

/// Largest distance of a position from the structure that still belongs to it, over the size of the structure.
const BESIDE_RATIO: f64 = 5e-3;

/// Returns the point on or inside an outline that is nearest to a position.
fn nearest(outline_m: &[Vector2<f64>], at_m: Vector2<f64>) -> Vector2<f64> {
    let sides = || {
        let next = outline_m.iter().cycle().skip(1);
        outline_m.iter().zip(next)
    };
    // A line to the right of a point inside crosses the outline an odd number of times.
    let crossings = sides().filter(|(a, b)| {
        (a.y > at_m.y) != (b.y > at_m.y)
            && at_m.x < a.x + (b.x - a.x) * (at_m.y - a.y) / (b.y - a.y)
    });
    if crossings.count() % 2 == 1 {
        return at_m;
    }
    let on_side = |(a, b): (&Vector2<f64>, &Vector2<f64>)| {
        let along = b - a;
        let part = (at_m - a).dot(&along) / along.norm_squared();
        // Two corners that coincide form no side.
        a + along * if part > 0.0 { part.min(1.0) } else { 0.0 }
    };
    let away_m = |near_m: &Vector2<f64>| (near_m - at_m).norm();
    let nearest = sides()
        .map(on_side)
        .min_by(|a, b| away_m(a).total_cmp(&away_m(b)));
    nearest.expect("an outline has corners")
}
