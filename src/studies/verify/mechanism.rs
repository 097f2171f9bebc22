//! The mechanism to one side as a chain of rigid bodies: its onset, its masses, and its capacity curve if it has one.

use nalgebra::Vector2;

use super::NoCheck;
use super::notes::FRICTION;
use crate::dynamics::model::MechanismModel;
use crate::mechanics::blocks::Row;
use crate::mechanics::capacity::{Capacity, Carried, Control};
use crate::mechanics::chain::Hinge;
use crate::mechanics::four_link::impact::ImpactModel;
use crate::mechanics::friction::{self, FrictionError};
use crate::mechanics::geometry::ring::Edge;
use crate::mechanics::stability::{RowOnset, onset};
use crate::mechanics::sway::Sway;
use crate::mechanics::virtual_work::{
    MovingBody, MovingTie, Participation, load_multiplier, per_displacement_of_centre,
};
use crate::scenario::Structure;
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
}

/// The motion of a mechanism up to its unstable equilibrium.
#[derive(Clone, Debug, PartialEq)]
pub struct Way {
    /// With the common centre of its bodies as control point.
    pub centre: Capacity,
    /// With the crown as control point; `None` if the crown does not move to that side.
    pub crown: Option<Capacity>,
}

impl Way {
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
        let masses: Vec<(f64, Carried)> = (0..)
            .zip(&bodies)
            .map(|(index, body)| {
                let at_m = body.centre_m;
                let body_of = Some(index);
                (
                    body.mass_kg,
                    Carried {
                        at_m,
                        body: body_of,
                    },
                )
            })
            .collect();
        let curve = |control| {
            let displaced = |part| {
                let displaced = model.displaced(sway, part);
                displaced.expect("a structure has its first mechanism")
            };
            Capacity::new(sway, displaced, &masses, control, gravity_m_s2)
        };
        let crown = capacity::crown_of(structure.as_parts(), model, sway);
        let way = curve(Control::centre_of(&masses))
            .map(|centre| Way {
                centre,
                crown: curve(Control::point(crown)).ok(),
            })
            .map_err(|error| error.to_string());
        Some(Self::new(
            sway,
            hinges,
            (bodies, Vec::new()),
            Vec::new(),
            way,
        ))
    }

    /// The mechanism of a row at rest, from limit analysis.
    fn of_onset(row: &Row, sway: Sway, onset: &RowOnset, why_no_way: &str) -> Self {
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
        Self::new(
            sway,
            hinges.collect(),
            (bodies.collect(), ties.collect()),
            body_of_block,
            Err(why_no_way.to_owned()),
        )
    }
}

/// The acceleration at which the joints of a row slide to one side, by the associated bound, if they slide before any of them
/// opens; zero if they slide under the weight of the row.
fn slides_at_g(row: &Row, sway: Sway) -> Option<f64> {
    match friction::onset(row, FRICTION, sway) {
        Ok(Some(onset)) => onset.sliding_governs().then_some(onset.acceleration_g),
        Err(FrictionError::CannotStand(_)) => Some(0.0),
        Ok(None) | Err(_) => None,
    }
}

/// The mechanisms of a structure to these sides.
///
/// # Errors
/// When the structure does not stand, no acceleration moves it to a side, or, if it has no curve, joints slide first.
pub(super) fn mechanisms(
    structure: &Structure,
    sides: &[Sway],
    gravity_m_s2: f64,
) -> Result<Vec<Mechanism>, NoCheck> {
    let none =
        |sway: Sway| NoCheck::NoMechanism(format!("no push moves it to the {}", sway.name()));
    let why = match structure.model(ImpactModel::MaxRestitution) {
        Ok(model) => {
            let of = |sway: &Sway| {
                Mechanism::of_model(structure, &*model, *sway, gravity_m_s2)
                    .ok_or_else(|| none(*sway))
            };
            return sides.iter().map(of).collect();
        }
        Err(why) => why.to_string(),
    };
    let why = if structure.ties().is_empty() {
        why
    } else {
        "what ties pull with changes along the way, which the verification does not follow; `archrock capacity` does".to_owned()
    };
    let row = structure.row();
    let row = &row.map_err(|error| NoCheck::NoMechanism(error.to_string()))?;
    let of = |sway: &Sway| {
        let found = onset(row, *sway).map_err(|error| NoCheck::NoMechanism(error.to_string()))?;
        let found = found.ok_or_else(|| none(*sway))?;
        let mechanism = Mechanism::of_onset(row, *sway, &found, &why);
        match slides_at_g(row, *sway) {
            Some(at_g) => Err(NoCheck::Slides {
                sway: *sway,
                at_g,
                alpha0: mechanism.alpha0,
            }),
            None => Ok(mechanism),
        }
    };
    sides.iter().map(of).collect()
}
