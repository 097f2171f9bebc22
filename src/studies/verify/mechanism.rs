//! The mechanism to one side as a chain of rigid bodies: its onset, its masses, and its capacity curve if it has one.

use nalgebra::Vector2;

use super::NoCheck;
use super::notes::FRICTION;
use crate::dynamics::model::MechanismModel;
use crate::mechanics::blocks::Row;
use crate::mechanics::capacity::{Capacity, CapacityError, Carried, Control, Displaced};
use crate::mechanics::chain::Hinge;
use crate::mechanics::four_link::impact::ImpactModel;
use crate::mechanics::friction::{self, FrictionError};
use crate::mechanics::geometry::ring::Edge;
use crate::mechanics::settling::Held;
use crate::mechanics::stability::{RowOnset, onset};
use crate::mechanics::sway::Sway;
use crate::mechanics::virtual_work::{
    MovingBody, MovingTie, Participation, load_multiplier, per_displacement_of_centre,
};
use crate::scenario::{Scenario, Structure};
use crate::studies::capacity;

/// A hinge with its position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedHinge {
    /// The hinge.
    pub hinge: Hinge,
    /// Its position in the undeformed structure, in metres.
    pub at_m: Vector2<f64>,
}

/// The mechanism that starts to one side.
#[derive(Clone, Debug, PartialEq)]
pub struct Mechanism {
    /// The side.
    pub sway: Sway,
    /// Its hinges from left to right.
    pub hinges: Vec<PlacedHinge>,
    /// Its rigid bodies from left to right; the virtual displacement of their common centre is one.
    pub bodies: Vec<MovingBody>,
    /// Its ties, with their lengthening for that displacement.
    pub ties: Vec<MovingTie>,
    /// The body to which each block of a row belongs; used if there is no curve.
    pub body_of_block: Vec<Option<usize>>,
    /// Load multiplier [C8.7.1.1].
    pub alpha0: f64,
    /// Participating masses [C8.7.1.5].
    pub participation: Participation,
    /// Its motion up to the unstable equilibrium, or why that is unknown.
    pub way: Result<Way, String>,
    /// The acceleration at which joints of the allowed friction coefficient slide first, in g, by the associated bound; `None` if they do
    /// not, or if the motion is known.
    pub slides_at_g: Option<f64>,
}

/// The motion of a mechanism up to its unstable equilibrium.
#[derive(Clone, Debug, PartialEq)]
pub struct Way {
    /// With the common centre of its bodies as control point.
    pub centre: Capacity,
    /// With the crown (or the top) as control point; `None` if it does not move to that side.
    pub crown: Option<Capacity>,
}

impl Way {
    /// The motion of bodies that are given by their positions at fractions of the way to the unstable equilibrium.
    fn new(
        sway: Sway,
        displaced: impl Fn(f64) -> Displaced,
        bodies: &[MovingBody],
        crown: Carried,
        gravity_m_s2: f64,
    ) -> Result<Self, CapacityError> {
        let masses = (0..).zip(bodies).map(|(index, body)| {
            let (at_m, body_of) = (body.centre_m, Some(index));
            let point = Carried {
                at_m,
                body: body_of,
            };
            (body.mass_kg, point)
        });
        let masses: Vec<(f64, Carried)> = masses.collect();
        let curve = |control| Capacity::new(sway, &displaced, &masses, control, gravity_m_s2);
        Ok(Self {
            centre: curve(Control::centre_of(&masses))?,
            crown: curve(Control::point(crown)).ok(),
        })
    }

    /// The motion of a row of blocks without ties, or why that is unknown.
    fn of_row(
        row: &Row,
        sway: Sway,
        bodies: &[MovingBody],
        gravity_m_s2: f64,
    ) -> Result<Self, String> {
        let held = Held::new(row, sway).map_err(|error| error.to_string())?;
        let crown = capacity::crown_of_row(row, &held);
        let displaced = |part| held.displaced(part);
        Self::new(sway, displaced, bodies, crown, gravity_m_s2).map_err(|error| error.to_string())
    }

    /// The largest friction coefficient needed up to a fraction of the ultimate displacement.
    #[must_use]
    pub fn friction_up_to(&self, part: f64) -> f64 {
        let end_m = part * self.centre.end().oscillator_displacement_m;
        let points = self.centre.curve.iter();
        points
            .take_while(|point| point.oscillator_displacement_m <= end_m)
            .map(|point| point.friction)
            .fold(0.0, f64::max)
    }
}

impl Mechanism {
    fn new(
        sway: Sway,
        hinges: Vec<PlacedHinge>,
        (mut bodies, mut ties): (Vec<MovingBody>, Vec<MovingTie>),
        body_of_block: Vec<Option<usize>>,
        way: Result<Way, String>,
    ) -> Self {
        let alpha0 = load_multiplier(&bodies, &ties);
        let participation = Participation::of_bodies(&bodies);
        let scale = per_displacement_of_centre(&bodies);
        for body in &mut bodies {
            body.displacement *= scale;
            body.rotation *= scale;
        }
        for tie in &mut ties {
            tie.lengthening *= scale;
        }
        Self {
            sway,
            hinges,
            alpha0,
            participation,
            bodies,
            ties,
            body_of_block,
            way,
            slides_at_g: None,
        }
    }

    /// The mechanism, to one side, of a model that moves as one mechanism.
    fn of_model(
        structure: &Structure,
        model: &dyn MechanismModel,
        sway: Sway,
        gravity_m_s2: f64,
    ) -> Option<Self> {
        let bodies = model.moving_bodies(sway)?;
        let at_rest = model.displaced(sway, 0.0)?;
        let named = model.hinges_after(0, sway).into_iter();
        let hinges: Vec<PlacedHinge> = named
            .zip(at_rest.hinges_m)
            .map(|(hinge, at_m)| PlacedHinge { hinge, at_m })
            .collect();
        let displaced = |part| {
            let displaced = model.displaced(sway, part);
            displaced.expect("a structure has its first mechanism")
        };
        let crown = capacity::crown_of(structure.as_parts(), model, sway);
        let way = Way::new(sway, displaced, &bodies, crown, gravity_m_s2);
        let way = way.map_err(|error| error.to_string());
        Some(Self::new(
            sway,
            hinges,
            (bodies, Vec::new()),
            Vec::new(),
            way,
        ))
    }

    /// The mechanism of a row at rest, from limit analysis, and its motion if the row has no ties.
    fn of_onset(row: &Row, sway: Sway, onset: &RowOnset, gravity_m_s2: f64) -> Self {
        let opens = |joint: usize| onset.openings.iter().any(|open| open.joint == joint);
        let fastest = |block: usize| {
            let twist = onset.velocities[block];
            twist.at(row.blocks()[block].centre_m).norm() + twist.rate.abs() * row.size_m()
        };
        let blocks = row.blocks().len();
        let most = (0..blocks).map(fastest).fold(0.0, f64::max);
        let mut body_of_block = vec![None; blocks];
        let mut bodies: Vec<(f64, Vector2<f64>, usize)> = Vec::new();
        let mut current = None;
        for (block, body_of) in body_of_block.iter_mut().enumerate() {
            if opens(block) {
                current = None;
            }
            // A block that no open joint separates from the supports stands still.
            if fastest(block) <= 1e-7 * most {
                current = None;
                continue;
            }
            let index = *current.get_or_insert_with(|| {
                bodies.push((0.0, Vector2::zeros(), block));
                bodies.len() - 1
            });
            let own = &row.blocks()[block];
            bodies[index].0 += own.mass_kg;
            bodies[index].1 += own.centre_m * own.mass_kg;
            *body_of = Some(index);
        }
        let bodies = bodies.into_iter().map(|(mass_kg, first, block)| {
            let (centre_m, twist) = (first / mass_kg, onset.velocities[block]);
            let velocity = twist.at(centre_m);
            MovingBody {
                mass_kg,
                centre_m,
                displacement: Vector2::new(sway.sign() * velocity.x, velocity.y),
                rotation: -sway.sign() * twist.rate,
            }
        });
        let bodies: Vec<MovingBody> = bodies.collect();
        let hinges = onset.openings.iter().map(|open| PlacedHinge {
            hinge: Hinge::Joint {
                joint: open.joint,
                edge: open.hinge,
            },
            at_m: row.joints()[open.joint].corner_m(open.hinge.unwrap_or(Edge::Intrados)),
        });
        let ties = row.ties().iter().zip(&onset.lengthening);
        let ties = ties.map(|(tie, lengthening)| MovingTie {
            force_kg: tie.prestress_n / row.gravity_m_s2(),
            lengthening: *lengthening,
        });
        let way = if row.ties().is_empty() {
            Way::of_row(row, sway, &bodies, gravity_m_s2)
        } else {
            Err(
                "the forces of ties change as the structure moves; this check does not follow them, quasi-static capacity does"
                    .to_owned(),
            )
        };
        Self::new(
            sway,
            hinges.collect(),
            (bodies, ties.collect()),
            body_of_block,
            way,
        )
    }
}

/// The acceleration in g at which the joints of a row slide to one side, by the associated bound, if they slide before any of them
/// opens; zero if they slide under the weight of the row.
fn slides_at_g(row: &Row, coefficient: f64, sway: Sway) -> Option<f64> {
    match friction::onset(row, coefficient, sway) {
        Ok(Some(onset)) => onset.sliding_governs().then_some(onset.acceleration_g),
        Err(FrictionError::CannotStand(_)) => Some(0.0),
        Ok(None) | Err(_) => None,
    }
}

/// Friction coefficient with which the friction that a mechanism needs is compared: that of the Circolare for walls, or that of the
/// scenario if it is smaller.
pub(super) fn allowed_friction(scenario: &Scenario) -> f64 {
    let own = scenario.motion().friction_coefficient();
    own.map_or(FRICTION, |own| own.min(FRICTION))
}

/// The mechanisms of a structure to these sides.
///
/// # Errors
/// When the structure does not stand, no acceleration moves it to a side, or joints slide first. Sliding is checked if the scenario
/// has a friction coefficient, or if there is no curve along which the required friction is known; a linkage that locks is then not
/// refused, but has [`Mechanism::slides_at_g`].
pub(super) fn mechanisms(scenario: &Scenario, sides: &[Sway]) -> Result<Vec<Mechanism>, NoCheck> {
    let (structure, gravity_m_s2) = (scenario.structure(), scenario.gravity_m_s2());
    let coefficient = allowed_friction(scenario);
    let slips = scenario.motion().friction_coefficient().is_some();
    let none =
        |sway: Sway| NoCheck::NoMechanism(format!("no push moves it to the {}", sway.name()));
    let model = structure.model(ImpactModel::MaxRestitution);
    let row = structure
        .row()
        .map_err(|error| NoCheck::NoMechanism(error.to_string()));
    let of = |sway: &Sway| {
        let mechanism = if let Ok(model) = &model {
            Mechanism::of_model(structure, &**model, *sway, gravity_m_s2)
                .ok_or_else(|| none(*sway))?
        } else {
            let row = row.as_ref().map_err(NoCheck::clone)?;
            let found =
                onset(row, *sway).map_err(|error| NoCheck::NoMechanism(error.to_string()))?;
            let found = found.ok_or_else(|| none(*sway))?;
            Mechanism::of_onset(row, *sway, &found, gravity_m_s2)
        };
        let may_slide = row
            .as_ref()
            .ok()
            .filter(|_| slips || mechanism.way.is_err());
        let slides = may_slide.and_then(|row| slides_at_g(row, coefficient, *sway));
        match slides {
            Some(at_g) if slips || model.is_err() => Err(NoCheck::Slides {
                sway: *sway,
                coefficient,
                at_g,
                alpha0: mechanism.alpha0,
            }),
            slides_at_g => Ok(Mechanism {
                slides_at_g,
                ..mechanism
            }),
        }
    };
    sides.iter().map(of).collect()
}
