//! A wall behind a column: transverse walls or floors, against which a façade stands. The column moves away from it only.
//!
//! # Default restitution
//!
//! It exists for a homogeneous block that is held over its full height. The column turns back about its outer toe `O` and strikes three times in turn, each time at one place (Sorrentino, AlShawa and Decanini, The
//! relevance of energy damping in unreinforced masonry rocking mechanisms, Bulletin of Earthquake Engineering 9, 2011):
//!
//! 1. at the base: the rotation passes from `O` to the inner toe `I`,
//! 2. at the top of the wall `C`, above `I`: it passes from `I` to `C`, and reverses if `C` is high enough,
//! 3. at the base: it passes from `I` to `O`.
//!
//! A body of mass `m`, radius of gyration `k` and centre of gravity `G` that turns about `A` at the rate `w` has the momentum
//! `m w (k^2 + (G - A).(G - B))` about `B`. An impact at `B` conserves it. With `<A, B> = k^2 + (G - A).(G - B)` the rate becomes
//! `w <A, B> / <B, B>`, and the energy is multiplied by the squared cosine `c(A, B)^2`, where `c(A, B) = <A, B> / sqrt(<A, A> <B, B>)`.
//!
//! After impact 2 the foot of the wall stops the base, which moves towards the wall, and the rotation about `C` becomes a rotation about `I`. At the
//! full height of a block this passage keeps the energy and the rate. At a lower wall, or with loads that move, it would be an assumption: models of the
//! contacts contradict it, and have larger ratios. Then there is no default. The body turns about `O` before and after, so the ratio of rates is
//!
//! `-c(O, I) c(I, C) c(I, O) = -c(O, I)^2 c(I, C)`.
//!
//! It never exceeds 1. For a rectangular block of slenderness `alpha`, held over its full height, `c(O, I) = 1 - 1.5 sin^2(alpha)` and
//! `c(I, C) = 1 - 1.5 cos^2(alpha)`, which gives the published ratio.
//!
//! Further assumptions: column, wall and ground are rigid, contacts neither slip nor pull, wall and ground move as one, and the three impacts take no
//! time.
//!
//! If `c(I, C)` is not negative, the rotation does not reverse: the column would turn over the top of the wall. This is so if the block is wider than
//! 0.7071 of its height. Then there is no default either.
//!
//! # Lowest wall
//!
//! A push of `a` times gravity towards a wall of height `c` acts at `G`, at the height `h` and the distance `b` from the wall. A rotation towards the
//! wall enters neither wall nor ground if its pole is at `C`, or higher or further behind. In a virtual rotation `d` about `C` the push does the work
//! `m a g (h - c) d` and the weight `-m g b d`; about the other poles both do less. So without friction at the base the push turns the column over if
//! `a (h - c) > b`. If `c >= h`, no push does. Walls below `G` are refused.

use nalgebra::Vector2;
use serde::Serialize;
use thiserror::Error;

use crate::argument::plain;
use crate::mechanics::{MassMoments, Sway, Twist};

/// Reason why an impact on the wall behind a column has no default ratio of rates.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum NoWallRatio {
    /// The wall is lower than the column; heights in metres.
    #[error("the wall behind the column is {} m high, the column {} m: {REMEDY}", plain(*.wall_m), plain(*.column_m))]
    Low {
        /// Height of the wall.
        wall_m: f64,
        /// Height of the column.
        column_m: f64,
    },
    /// Loads of this mass in kg move with the column.
    #[error("{} kg of loads move with the column before the wall: {REMEDY}", plain(*.0))]
    Loads(f64),
    /// The column has this ratio of width to height, and three impacts do not throw it back.
    #[error("the column before the wall is {} times as wide as high, and above 0.7071 three impacts do not throw it back: {REMEDY}", plain(*.0))]
    Wide(f64),
}

/// Remedy for a missing ratio of rates.
const REMEDY: &str = "the default restitution is that of a homogeneous block held over its full height; give `restitution` of [column.back], a \
                      measured ratio of rates, or run `archrock threshold FILE --along column.back.restitution=0.2..0.9:8` and quote its lowest value";

/// Wall behind a column.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BackWall {
    /// Side of the column on which the wall stands.
    pub side: Sway,
    /// Height of the wall, in metres; `None` for the height of the column. At height zero there is no wall.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub height_m: Option<f64>,
    /// Rate after the column has struck the wall over the rate before, from 0 to 1, the key `restitution` of scenarios; `None` for three impacts in
    /// turn, of a homogeneous block that is held over its full height. Its square is the restitution coefficient of [`Link`](crate::mechanics::Link) and `[impact]`, a ratio of energies.
    #[serde(rename = "restitution", skip_serializing_if = "Option::is_none")]
    pub rate_ratio: Option<f64>,
}

/// Rate about `to`, for a unit rate about `from`, after an impact at `to`. The motion before is projected in the kinetic-energy metric onto
/// the motion after, which conserves the angular momentum about `to`.
pub(super) fn rate_passed(moments: &MassMoments, from: Vector2<f64>, to: Vector2<f64>) -> f64 {
    product(moments, to, from) / product(moments, to, to)
}

/// Product of the rotations about two points in the kinetic-energy metric, `m <A, B>` above.
fn product(moments: &MassMoments, a: Vector2<f64>, b: Vector2<f64>) -> f64 {
    Twist::rotation(a, 1.0).power(&Twist::rotation(b, 1.0).momentum(moments))
}

/// Cosine between the rotations about two points in the kinetic-energy metric, `c(A, B)` above.
fn cosine(moments: &MassMoments, [a, b]: [Vector2<f64>; 2]) -> f64 {
    product(moments, a, b) / (product(moments, a, a) * product(moments, b, b)).sqrt()
}

/// Ratio of rates after and before three impacts in turn of a rigid body, from its outer and inner toe and the contact at the top of the
/// wall. `None` if they do not throw it back.
pub fn three_impacts(
    moments: &MassMoments,
    [outer, inner, contact]: [Vector2<f64>; 3],
) -> Option<f64> {
    let at_base = cosine(moments, [outer, inner]);
    let at_wall = cosine(moments, [inner, contact]);
    (at_base > 0.0 && at_wall < 0.0).then_some(-at_base * at_base * at_wall)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A body by its mass, centre of gravity and radius of gyration.
    fn body(mass: f64, centre: Vector2<f64>, gyration: f64) -> MassMoments {
        MassMoments {
            mass,
            first: centre * mass,
            polar: mass * (gyration * gyration + centre.norm_squared()),
        }
    }

    proptest! {
        #[test]
        fn a_block_held_over_its_height_has_the_published_ratio(alpha in 0.01_f64..0.6) {
            let (sin, cos) = alpha.sin_cos();
            let block = body(3.0, Vector2::new(0.0, cos), (1.0_f64 / 3.0).sqrt());
            let points = [(sin, 0.0), (-sin, 0.0), (-sin, 2.0 * cos)];
            let found = three_impacts(&block, points.map(|(x, y)| Vector2::new(x, y)));
            let at_base = 1.0 - 1.5 * sin * sin;
            let published = -at_base * at_base * (1.0 - 1.5 * cos * cos);
            match found {
                Some(ratio) => prop_assert!((ratio - published).abs() < 1e-14),
                None => prop_assert!(published < 1e-14),
            }
        }

        /// Each impact is computed from the velocity of the centre of gravity and the momentum about the new point.
        #[test]
        fn a_general_body_conserves_momenta_and_never_gains_energy(
            x in -0.4_f64..0.4, y in 0.2_f64..2.0, gyration in 0.05_f64..1.5, wall in 0.05_f64..3.0,
        ) {
            let centre = Vector2::new(x, y);
            let moments = body(1.7, centre, gyration);
            let [outer, inner] = [Vector2::new(0.5, 0.0), Vector2::new(-0.5, 0.0)];
            let contact = Vector2::new(-0.5, wall);
            let about = |pole: Vector2<f64>| gyration * gyration + (centre - pole).norm_squared();
            let impact = |rate: f64, from: Vector2<f64>, to: Vector2<f64>| {
                let arm = centre - from;
                let velocity = Vector2::new(-arm.y, arm.x) * rate;
                let momentum = (centre - to).perp(&velocity) + gyration * gyration * rate;
                momentum / about(to)
            };
            let first = impact(1.0, outer, inner);
            let second = impact(first, inner, contact);
            let passed = second * (about(contact) / about(inner)).sqrt();
            let third = impact(passed, inner, outer);
            prop_assert!((rate_passed(&moments, outer, inner) - first).abs() < 1e-13);
            // The centre of percussion of the rotation about the inner toe.
            let highest = about(inner) / y;
            let found = three_impacts(&moments, [outer, inner, contact]);
            if (first.abs() > 1e-9) && (wall - highest).abs() > 1e-9 {
                prop_assert_eq!(found.is_some(), first > 0.0 && wall > highest);
            }
            if let Some(ratio) = found {
                prop_assert!((ratio + third).abs() < 1e-13);
                prop_assert!(ratio > 0.0 && ratio <= 1.0 + 1e-15);
            }
        }
    }
}
