//! Virtual work of a mechanism of rigid bodies: the load multiplier that starts it, and its participating mass.
//!
//! Each body, with what it carries, is lumped at its centre of gravity. Virtual displacements start from the
//! undeformed position, up to a common factor, which nothing here depends on.

use nalgebra::Vector2;

/// A rigid body of a mechanism, with its virtual displacement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovingBody {
    /// Its mass and that of what it carries, in kg.
    pub mass_kg: f64,
    /// Its centre of gravity in the undeformed structure, in metres.
    pub centre_m: Vector2<f64>,
    /// Virtual displacement of its centre: x in the direction of the sway, y upwards.
    pub displacement: Vector2<f64>,
    /// Virtual rotation, towards the side of the sway; per metre if the displacements have no unit.
    pub rotation: f64,
}

/// A tie of a mechanism.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovingTie {
    /// The force it pulls with over gravity, in kg.
    pub force_kg: f64,
    /// Lengthening by the virtual displacement of the bodies.
    pub lengthening: f64,
}

/// The load multiplier `alpha0`: the horizontal acceleration, in units of gravity, at which the work of the inertia of all
/// bodies equals that against their weights and against ties, `(sum P delta_y + sum F delta_l) / sum P delta_x`.
#[must_use]
pub fn load_multiplier(bodies: &[MovingBody], ties: &[MovingTie]) -> f64 {
    let work = |component: fn(&MovingBody) -> f64| -> f64 {
        let each = bodies.iter().map(|body| body.mass_kg * component(body));
        each.sum()
    };
    let held = ties.iter().map(|tie| tie.force_kg * tie.lengthening);
    (work(|body| body.displacement.y) + held.sum::<f64>()) / work(|body| body.displacement.x)
}

/// The masses that take part in a motion, given with their horizontal virtual displacements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Participation {
    /// All of the mass that moves, in kg.
    pub moving_mass_kg: f64,
    /// Participating mass `M* = (sum m delta)^2 / sum m delta^2`, in kg.
    pub participating_mass_kg: f64,
    /// `e*`: the participating mass as a fraction of the mass that moves.
    pub mass_fraction: f64,
    /// `sum m delta^2 / sum m delta`. Divided by the virtual displacement of the control point, it is the factor from
    /// displacements of the control point to those of the oscillator.
    pub oscillator_displacement: f64,
}

impl Participation {
    /// The participation of masses in kg, each with its horizontal virtual displacement. All of them move.
    #[must_use]
    pub fn of(masses: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let (mut whole, mut first, mut second) = (0.0, 0.0, 0.0);
        for (mass_kg, displacement) in masses {
            whole += mass_kg;
            first += mass_kg * displacement;
            second += mass_kg * displacement * displacement;
        }
        let participating_mass_kg = first * first / second;
        Self {
            moving_mass_kg: whole,
            participating_mass_kg,
            mass_fraction: participating_mass_kg / whole,
            oscillator_displacement: second / first,
        }
    }

    /// The participation of rigid bodies.
    #[must_use]
    pub fn of_bodies(bodies: &[MovingBody]) -> Self {
        let bodies = bodies.iter();
        Self::of(bodies.map(|body| (body.mass_kg, body.displacement.x)))
    }
}

/// The factor on virtual displacements with which the centre of all masses moves by one.
#[must_use]
pub fn per_displacement_of_centre(bodies: &[MovingBody]) -> f64 {
    let mass_kg: f64 = bodies.iter().map(|body| body.mass_kg).sum();
    let first = bodies.iter().map(|body| body.mass_kg * body.displacement.x);
    mass_kg / first.sum::<f64>()
}
