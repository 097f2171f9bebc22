//! Points of a structure, such as the crown, and the bodies that carry them.

use std::f64::consts::TAU;

use nalgebra::Vector2;

use super::scene::{Mark, Scene, link, sections_rad};
use crate::dynamics::history::OpenHinge;
use crate::mechanics::parts::Outline;

/// A point of a structure. The body that carries it may depend on which hinges are open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Its position in the undeformed structure, in metres.
    pub at_m: Vector2<f64>,
    part: Part,
}

/// The part of the structure to which a point belongs.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Part {
    /// A block, by its index.
    Block(usize),
    /// A section of a ring, in radians from the left springing.
    Section(f64),
}

impl Scene {
    /// The point of the structure at this place, undeformed, in metres. A place just outside counts as a point of the nearest
    /// block, within the error of rounding and of drawing curves as straight lines.
    ///
    /// # Errors
    /// If the place is outside the structure; the error is the nearest place inside.
    pub fn point(&self, at_m: impl Into<Vector2<f64>>) -> Result<Point, Vector2<f64>> {
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
                let left = ring.radial(0.0);
                let angle_rad = -left.perp(&at_m).atan2(left.dot(&at_m));
                // Down to this angle a point lies just below the left springing; beyond, it has gone round the other way.
                let before_rad = 0.5 * (ring.embrace_rad - TAU);
                let turns = if angle_rad < before_rad { TAU } else { 0.0 };
                Part::Section((angle_rad + turns).clamp(0.0, ring.embrace_rad))
            }
            Outline::Block { .. } | Outline::Row { .. } => Part::Block(index),
        };
        Ok(Point { at_m, part })
    }

    /// A point with the body that carries it while these hinges are open.
    #[must_use]
    pub fn mark(&self, point: &Point, hinges: &[OpenHinge]) -> Mark {
        let body = match (point.part, &self.outline) {
            (Part::Section(angle_rad), _) => link(&sections_rad(hinges), angle_rad),
            (Part::Block(block), _) => self.body_of(block, hinges),
        };
        Mark {
            body,
            at_m: point.at_m,
        }
    }
}

/// A point this near to the structure, relative to its size, belongs to it.
const BESIDE_RATIO: f64 = 5e-3;

/// The point nearest to a place, on or inside an outline.
fn nearest(outline_m: &[Vector2<f64>], at_m: Vector2<f64>) -> Vector2<f64> {
    let sides = || {
        let next = outline_m.iter().cycle().skip(1);
        outline_m.iter().zip(next)
    };
    // From a point inside, a line to the right crosses the outline an odd number of times.
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
