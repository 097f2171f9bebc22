//! Rigid motions, their momenta, and the mass moments of bodies.

use nalgebra::Vector2;

/// Implements `+`, `-` and multiplication by a number for a struct with these fields.
macro_rules! linear {
    ($type:ident { $($field:ident),+ }) => {
        impl std::ops::Add for $type {
            type Output = Self;
            fn add(self, other: Self) -> Self {
                Self { $($field: self.$field + other.$field),+ }
            }
        }

        impl std::ops::Sub for $type {
            type Output = Self;
            fn sub(self, other: Self) -> Self {
                Self { $($field: self.$field - other.$field),+ }
            }
        }

        impl std::ops::Mul<f64> for $type {
            type Output = Self;
            fn mul(self, factor: f64) -> Self {
                Self { $($field: self.$field * factor),+ }
            }
        }
    };
}
pub(crate) use linear;

/// `k x v`: `v` turned by a right angle anticlockwise.
pub fn quarter_turn(v: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-v.y, v.x)
}

/// Mirror image of `v` about the y axis.
pub(crate) fn mirrored(v: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-v.x, v.y)
}

/// Instantaneous rigid motion: velocity of the point at the centre of the ring, and angular rate
/// (positive anticlockwise).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Twist {
    /// Velocity at the centre of the ring.
    pub at_center: Vector2<f64>,
    /// Angular rate.
    pub rate: f64,
}

impl Twist {
    /// No motion.
    pub const ZERO: Self = Self {
        at_center: Vector2::new(0.0, 0.0),
        rate: 0.0,
    };

    /// Rotation at `rate` about `pole`.
    pub fn rotation(pole: Vector2<f64>, rate: f64) -> Self {
        Self {
            at_center: -quarter_turn(pole) * rate,
            rate,
        }
    }

    /// Translation, with the same velocity everywhere.
    pub const fn translation(velocity: Vector2<f64>) -> Self {
        Self {
            at_center: velocity,
            rate: 0.0,
        }
    }

    /// Velocity at `point`.
    pub fn velocity_at(&self, point: Vector2<f64>) -> Vector2<f64> {
        self.at_center + quarter_turn(point) * self.rate
    }

    /// Momentum of a body of the given moments that moves with this twist.
    pub fn momentum(&self, body: &MassMoments) -> Momentum {
        Momentum {
            linear: self.at_center * body.mass + quarter_turn(body.first) * self.rate,
            angular: body.first.perp(&self.at_center) + body.polar * self.rate,
        }
    }

    /// Power of `momentum` (or of a wrench) on this motion.
    pub fn power(&self, momentum: &Momentum) -> f64 {
        self.at_center.dot(&momentum.linear) + self.rate * momentum.angular
    }

    /// Mirror image about the y axis.
    pub(super) fn mirrored(&self) -> Self {
        Self {
            at_center: mirrored(self.at_center),
            rate: -self.rate,
        }
    }
}

linear!(Twist { at_center, rate });

/// Linear momentum and angular momentum about the centre of the ring; likewise a force or an
/// impulse with its moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Momentum {
    /// Linear momentum (force, impulse).
    pub linear: Vector2<f64>,
    /// Angular momentum (moment) about the centre of the ring.
    pub angular: f64,
}

impl Momentum {
    /// No momentum.
    pub const ZERO: Self = Self {
        linear: Vector2::new(0.0, 0.0),
        angular: 0.0,
    };

    /// Force `linear` applied at `point`.
    pub fn applied_at(point: Vector2<f64>, linear: Vector2<f64>) -> Self {
        Self {
            linear,
            angular: point.perp(&linear),
        }
    }

    /// Angular momentum (moment) about `pole`.
    pub fn moment_about(&self, pole: Vector2<f64>) -> f64 {
        self.angular - pole.perp(&self.linear)
    }
}

linear!(Momentum { linear, angular });

/// Mass, first moment and polar moment about the centre of the ring.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MassMoments {
    /// Mass.
    pub mass: f64,
    /// First moment: mass times centre of gravity.
    pub first: Vector2<f64>,
    /// Polar moment of inertia about the centre of the ring.
    pub polar: f64,
}

impl MassMoments {
    /// Moments of a body from its mass, its centre of gravity and its polar moment about that centre (Steiner).
    pub(crate) fn of_body(mass: f64, centre: Vector2<f64>, central_polar: f64) -> Self {
        Self {
            mass,
            first: centre * mass,
            polar: central_polar + mass * centre.norm_squared(),
        }
    }

    /// Centre of gravity.
    pub fn centroid(&self) -> Vector2<f64> {
        self.first / self.mass
    }

    /// Polar moment of inertia about the centre of gravity (Steiner).
    pub fn central_polar(&self) -> f64 {
        self.polar - self.first.norm_squared() / self.mass
    }
}

linear!(MassMoments { mass, first, polar });
