//! The momentum theorems of the paper, solved in their printed form.

use archrock::mechanics::four_link::FourLink;
use archrock::mechanics::{Field, Momentum, Profile};
use nalgebra::{Matrix5, Vector2, Vector5};

/// The solution of the five equations (7)-(10) of the paper.
///
/// Masses are in units of `rho d R^2` and lengths in `R`: impulses are per unit rate of the closing
/// mechanism times `rho d R^3`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MomentumTheorems {
    /// Impulse on the ring at the first hinge of the new mechanism.
    pub impulse_first: Vector2<f64>,
    /// Impulse on the ring at the last hinge of the new mechanism.
    pub impulse_last: Vector2<f64>,
    /// Rate of the new mechanism.
    pub rate: f64,
}

impl MomentumTheorems {
    /// Solves Eqs. (7)-(10) for a ring that moves with `before` when the hinges of `mechanism` form.
    ///
    /// They are linear momentum along x and y and angular momentum about the centre for the part between
    /// the outer hinges, and angular momentum of each end body about its inner hinge.
    pub fn solve(mechanism: &FourLink, before: &Field, profile: &dyn Profile) -> Self {
        let [a, b, c, d] = mechanism.hinges_rad;
        let [point_a, point_b, point_c, point_d] = mechanism.points;
        let after = mechanism.field();
        let part = |field: &Field, from: f64, to: f64| {
            field.momentum_to(profile, to) - field.momentum_to(profile, from)
        };
        let theorems = |whole: Momentum, first: Momentum, last: Momentum| {
            Vector5::new(
                whole.linear.x,
                whole.linear.y,
                whole.angular,
                first.moment_about(point_b),
                last.moment_about(point_c),
            )
        };
        let of_field =
            |field: &Field| theorems(part(field, a, d), part(field, a, b), part(field, c, d));
        let at_first = |direction| {
            let impulse = Momentum::applied_at(point_a, direction);
            theorems(impulse, impulse, Momentum::ZERO)
        };
        let at_last = |direction| {
            let impulse = Momentum::applied_at(point_d, direction);
            theorems(impulse, Momentum::ZERO, impulse)
        };
        let matrix = Matrix5::from_columns(&[
            at_first(Vector2::x()),
            at_first(Vector2::y()),
            at_last(Vector2::x()),
            at_last(Vector2::y()),
            -of_field(&after),
        ]);
        let solution = matrix
            .lu()
            .solve(&-of_field(before))
            .expect("an admissible mechanism is determinate: its hinges are in convex position");
        Self {
            impulse_first: Vector2::new(solution[0], solution[1]),
            impulse_last: Vector2::new(solution[2], solution[3]),
            rate: solution[4],
        }
    }
}
