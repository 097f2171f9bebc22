//! Virtual work of a mechanism of rigid bodies: load multiplier of the first motion, and participating mass.
//!
//! The mass of each body, with what the body carries, is lumped at its centre of gravity. Virtual displacements are measured from the undeformed
//! position, up to a common factor that does not affect the results.

use nalgebra::Vector2;

/// Rigid body of a mechanism, with its virtual displacement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovingBody {
    /// Mass of the body and of its load, in kg.
    pub mass_kg: f64,
    /// Centre of gravity in the undeformed structure, in metres.
    pub centre_m: Vector2<f64>,
    /// Virtual displacement of its centre: x in the direction of the sway, y upwards.
    pub displacement: Vector2<f64>,
    /// Virtual rotation, towards the side of the sway; per metre if the displacements have no unit.
    pub rotation: f64,
}

impl MovingBody {
    /// Virtual displacement, in the direction of the sway, of a point of the body at a height in metres.
    pub fn displacement_at(&self, height_m: f64) -> f64 {
        self.displacement.x + self.rotation * (height_m - self.centre_m.y)
    }
}

/// Tie of a mechanism.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovingTie {
    /// Tie force over gravity, in kg.
    pub force_kg: f64,
    /// Lengthening of the tie due to the virtual displacements of the bodies.
    pub lengthening: f64,
}

/// Constant force on a body of a mechanism.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovingForce {
    /// Point of the force in the undeformed structure, in metres.
    pub at_m: Vector2<f64>,
    /// Force over gravity, in kg: x in the direction of the sway, y upwards.
    pub force_kg: Vector2<f64>,
    /// Virtual displacement of its point: x in the direction of the sway, y upwards.
    pub displacement: Vector2<f64>,
}

/// Load multiplier `alpha0`: the horizontal acceleration, in multiples of gravity, at which the work of the inertia forces equals the
/// work against weights, ties and constant forces, `(sum P delta_y + sum T delta_l - sum F . delta_F) / sum P delta_x`.
pub fn load_multiplier(bodies: &[MovingBody], ties: &[MovingTie], forces: &[MovingForce]) -> f64 {
    let work = |component: fn(&MovingBody) -> f64| -> f64 {
        let each = bodies.iter().map(|body| body.mass_kg * component(body));
        each.sum()
    };
    let held = ties.iter().map(|tie| tie.force_kg * tie.lengthening);
    let pushing = forces
        .iter()
        .map(|force| force.force_kg.dot(&force.displacement));
    let held = held.sum::<f64>() - pushing.sum::<f64>();
    (work(|body| body.displacement.y) + held) / work(|body| body.displacement.x)
}

/// Participation of masses in a motion with given horizontal virtual displacements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Participation {
    /// Moving mass, in kg.
    pub moving_mass_kg: f64,
    /// Participating mass `M* = (sum m delta)^2 / sum m delta^2`, in kg.
    pub participating_mass_kg: f64,
    /// Participating mass over moving mass, `e*`.
    pub mass_fraction: f64,
    /// `sum m delta^2 / sum m delta`. This value over the virtual displacement of the control point is the factor from displacements of the control
    /// point to those of the equivalent oscillator.
    pub oscillator_displacement: f64,
}

impl Participation {
    /// Computes the participation of moving masses in kg, each with its horizontal virtual displacement.
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

    /// Computes the participation of rigid bodies.
    pub fn of_bodies(bodies: &[MovingBody]) -> Self {
        let bodies = bodies.iter();
        Self::of(bodies.map(|body| (body.mass_kg, body.displacement.x)))
    }
}

/// Factor on virtual displacements for which the centre of all masses moves by one.
pub fn displacement_factor(bodies: &[MovingBody]) -> f64 {
    let mass_kg: f64 = bodies.iter().map(|body| body.mass_kg).sum();
    let first = bodies.iter().map(|body| body.mass_kg * body.displacement.x);
    mass_kg / first.sum::<f64>()
}
