//! The report of limit analysis: the summary as JSON, from which the words follow.

use std::iter;

use askama::Template;
use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use super::live::LiveLimit;
use super::yielding::motion_in_words;
use crate::argument::format_fixed;
use crate::mechanics::friction::YieldingJoint;
use crate::mechanics::settling::Pin;
use crate::mechanics::{Edge, Equivalent, HeldMechanism, RowOnset, Sides};
use crate::output::mechanisms::{HINGES, by_body, columns, degrees};
use crate::output::{Named, Scene, filters};
use crate::studies::report::{Report, Warnings};
use crate::{Hinge, MechanismModel, Row, Sway};

/// The onset of motion of a structure, to either side.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, Template)]
#[template(path = "studies/limit/words/words.txt")]
pub struct LimitSummary {
    /// Ground acceleration that starts the structure, in units of gravity: `A_L`, or the first motion with moved springings. Null if no push
    /// starts the structure.
    pub incipient_acceleration_g: Sides<Option<f64>>,
    /// Ground acceleration that starts the structure, in m/s2; null if no push starts it.
    pub incipient_acceleration_m_s2: Sides<Option<f64>>,
    /// The reason why no push starts an arch into which a straight line fits; absent otherwise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub no_push_because: Option<String>,
    /// Hinges of the mechanism that starts, from left to right.
    pub mechanism: Sides<Vec<MechanismHinge>>,
    /// Smallest coefficient of friction with which no joint slides at rest, or before this mechanism starts; null if no push starts the structure, or the
    /// coefficient was not found.
    pub friction_demand: Sides<Option<f64>>,
    /// Rotations of the bodies at the unstable equilibrium of the first mechanism to the right, or to the only side to which it moves, in radians;
    /// absent unless the structure moves as four links or as a column.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unstable_rotations: Option<Named<f64>>,
    /// Equivalent free-standing blocks; absent unless the structure moves as four links or as a column.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub equivalent_block: Option<Equivalent>,
    /// The first mechanism to the left, if loads make it differ from that to the right; absent otherwise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to_the_left: Option<FourLinkSide>,
    /// The push at which a structure on moved springings collapses, in units of gravity; absent without moved springings.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub capacity_g: Option<Sides<Option<f64>>>,
    /// The reason why the push at collapse was not found; null if it was found, or if there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub capacity_not_found: Option<Sides<Option<String>>>,
    /// Side of the wall behind a column, towards which no push moves it; absent without a wall.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wall_behind: Option<Sway>,
    /// Hinges on which a structure on moved springings stands; absent without moved springings.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hinges: Option<Vec<Pin>>,
    /// Tie forces, and the pushes that depend on ties; absent without ties.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ties: Option<Ties>,
    /// Horizontal force of the floor on a wall whose top it holds when the mechanism starts, in N, positive against the push; absent if the top is free.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub top_reaction_n: Option<Sides<f64>>,
    /// The first mechanism of a row as four links; absent unless the structure is an arch of blocks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub four_links: Option<FourLinkAnswer>,
    /// The onset of motion with slipping joints; absent unless joints may slip.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction: Option<Friction>,
    /// Collapse under live loads, or under a vehicle; the other answers are those without them. Absent without live loads and vehicle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub live: Option<LiveLimit>,
    /// The warnings.
    #[serde(flatten)]
    pub warnings: Warnings,
    /// Names of the bodies of the first mechanism, from left to right; absent unless the structure moves as four links or as a column.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bodies: Vec<String>,
    /// Frame of reference, and the position of each tie, in words; absent without ties.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tie_places: Vec<String>,
}

/// A hinge of the mechanism that starts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum MechanismHinge {
    /// A joint of a row that opens.
    Joint {
        /// The joint, from 0 at the left springing or the base.
        joint: usize,
        /// Edge about which the joint opens; null if both edges open.
        edge: Option<Edge>,
        /// Horizontal position of that edge, in metres.
        x_m: f64,
        /// Vertical position of that edge, in metres.
        y_m: f64,
    },
    /// A hinge of four links or of a column: it has no position, so that it is read last.
    Link(Hinge),
}

/// Tie forces, and the pushes that depend on ties.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ties {
    /// Force of each tie at rest, in N.
    pub forces_at_rest_n: Vec<f64>,
    /// Limit analysis without ties and with yielding ties; absent with moved springings.
    #[serde(flatten)]
    pub limits: Option<TieLimits>,
    /// True if a structure on moved springings is a mechanism without its ties; absent without moved springings.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mechanism_without: Option<bool>,
}

/// Limit analysis without ties and with yielding ties.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TieLimits {
    /// True if the structure stands without its ties.
    pub stands_without: bool,
    /// The push that starts the structure without its ties, in units of gravity; null if no push starts it, or the structure cannot stand.
    pub without: Sides<Option<f64>>,
    /// Plastic limit: the largest push if each tie has its best force, at most its yield force.
    pub yielding: Sides<YieldingTies>,
}

/// Plastic limit to one side: the largest push if each tie has its best force, at most its yield force.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct YieldingTies {
    /// The push, in units of gravity; null if there is no limit while ties hold.
    pub incipient_acceleration_g: Option<f64>,
    /// The smallest tie forces that give this push, in N; null if there is no limit while ties hold.
    pub forces_n: Option<Vec<f64>>,
    /// Hinges of the mechanism.
    pub mechanism: Vec<MechanismHinge>,
}

/// The first mechanism of a row as four links.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum FourLinkAnswer {
    /// The row does not move as four links.
    None {
        /// The reason.
        none_because: String,
    },
    /// The mechanisms to the right and to the left.
    Sides(Sides<FourLinkSide>),
}

/// The first mechanism of four links, or of a column, to one side.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FourLinkSide {
    /// Hinges from left to right.
    pub hinges: Vec<Hinge>,
    /// Rotations of the bodies at the unstable equilibrium, in radians, from left to right.
    pub unstable_equilibrium_rad: Vec<f64>,
    /// Equivalent free-standing blocks.
    pub equivalent_block: Option<Equivalent>,
}

/// The onset of motion of a row whose joints slip.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Friction {
    /// The coefficient of friction of the scenario.
    pub coefficient: f64,
    /// The onset of motion of the row.
    #[serde(flatten)]
    pub onset: FrictionLimit,
}

/// The onset of motion of a row with slipping joints.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum FrictionLimit {
    /// The undeformed row.
    Undeformed {
        /// The smallest coefficient with which the row stands.
        least_coefficient: f64,
        /// The mechanisms to the right and to the left.
        #[serde(flatten)]
        sides: Sides<FrictionSide>,
    },
    /// A row on moved springings.
    Moved {
        /// The push of the first motion, in units of gravity; null if no push starts the row.
        incipient_acceleration_g: Sides<Option<f64>>,
    },
}

/// The onset to one side of a row whose joints slip.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FrictionSide {
    /// The push, in units of gravity, an upper bound if sliding governs; null if no push starts the row.
    pub incipient_acceleration_g: Option<f64>,
    /// True if a joint of the mechanism slips.
    pub sliding_governs: bool,
    /// Joints of the mechanism; null if no push starts the row.
    pub mechanism: Option<Vec<YieldingJoint>>,
}

impl Report for LimitSummary {
    const IS_TABLE: bool = true;

    fn verdict(&self) -> String {
        let friction = self.friction.as_ref().map(|friction| {
            let [right, left] = Sides::of(|sway| friction.start_in_words(&sway)).into();
            format!("{}: {right}; {left}", friction.heading())
        });
        if let Some(live) = &self.live {
            let answers = live.in_words().into_iter();
            return answers
                .map(|words| words.join("; "))
                .collect::<Vec<_>>()
                .join("; ");
        }
        let all = self
            .pushes_in_words()
            .into_iter()
            .chain(self.needs_friction())
            .chain(friction);
        all.collect::<Vec<_>>().join("; ")
    }

    fn warnings(&self) -> &Warnings {
        &self.warnings
    }
}

impl LimitSummary {
    /// Makes a summary of the push that starts the structure and its mechanism.
    pub(super) fn new(
        incipient_acceleration_g: Sides<Option<f64>>,
        mechanism: Sides<Vec<MechanismHinge>>,
        gravity_m_s2: f64,
    ) -> Self {
        let in_m_s2 = |push_g: &Option<f64>| push_g.map(|push_g| push_g * gravity_m_s2);
        Self {
            incipient_acceleration_g,
            incipient_acceleration_m_s2: incipient_acceleration_g.map(in_m_s2),
            mechanism,
            ..Self::default()
        }
    }

    /// Makes the summary of a structure that starts as a mechanism of one degree of freedom.
    pub(super) fn of_mechanism(model: &dyn MechanismModel, gravity_m_s2: f64) -> Self {
        let bodies = model.bodies();
        let side = model.first_side();
        let unstable_rad = model.critical_rotations_rad(side);
        let names = columns(&bodies, "rotation", "rad").into_iter();
        let hinges = |sway| {
            let hinges = model.hinges_after(0, sway);
            hinges.into_iter().map(MechanismHinge::Link).collect()
        };
        let starts_g = Sides::of(|sway| model.incipient_acceleration_g(sway));
        let differs = side == Sway::Right && starts_g.left != starts_g.right;
        let to_the_left = || FourLinkSide {
            hinges: model.hinges_after(0, Sway::Left),
            unstable_equilibrium_rad: model.critical_rotations_rad(Sway::Left),
            equivalent_block: model.equivalent(Sway::Left, gravity_m_s2),
        };
        Self {
            to_the_left: (differs && starts_g.left.is_some()).then(to_the_left),
            unstable_rotations: Some(Named(names.zip(unstable_rad).collect())),
            equivalent_block: model.equivalent(side, gravity_m_s2),
            bodies,
            ..Self::new(starts_g, Sides::of(hinges), gravity_m_s2)
        }
    }

    /// Coefficients of friction that the mechanisms need in words; `None` if none is known.
    fn needs_friction(&self) -> Option<String> {
        let needs: Vec<(String, &str)> = self
            .friction_demand
            .iter()
            .filter_map(|(sway, needed)| {
                let needed = format_fixed((*needed)?, 4);
                Some((needed, sway.name()))
            })
            .collect();
        let needs = match &needs[..] {
            [] => return None,
            [(right, _), (left, _)] if right == left => format!("{right} to either side"),
            sides => {
                let sides = sides
                    .iter()
                    .map(|(needed, side)| format!("{needed} to the {side}"));
                sides.collect::<Vec<_>>().join(" and ")
            }
        };
        Some(format!(
            "it needs a friction coefficient of {needs}; with a smaller one joints slide first"
        ))
    }

    /// Pushes that start the structure and those at which it falls in words, without slip.
    fn pushes_in_words(&self) -> Vec<String> {
        let sides = match self.wall_behind {
            Some(wall) if self.unstable_rotations.is_some() => [wall.opposite(), wall],
            _ => [Sway::Right, Sway::Left],
        };
        let each = |sway| iter::once(self.start_in_words(sway)).chain(self.fall_in_words(sway));
        let mut lines: Vec<String> = sides.iter().flat_map(each).collect();
        // One line for both sides of a structure that is its mirror image.
        lines.dedup();
        lines
    }

    /// Push that starts the structure to one side in words.
    fn start_in_words(&self, sway: &Sway) -> String {
        let name = sway.name();
        let shown = |starts: &Sides<Option<f64>>, decimals| {
            starts.get(*sway).map(|push| format_fixed(push, decimals))
        };
        let is_moved = self.hinges.is_some();
        match shown(&self.incipient_acceleration_g, 8) {
            None if self.wall_behind == Some(*sway) => {
                format!("no push to the {name} moves it: a wall stands there")
            }
            None => {
                let reason = self.no_push_because.as_ref();
                let reason = reason.map_or(String::new(), |reason| format!(": {reason}"));
                format!("no push to the {name} moves it without sliding{reason}")
            }
            Some(_) if is_moved && self.mechanism.get(*sway).is_empty() => {
                format!("any push to the {name} moves it")
            }
            Some(push_g) if is_moved => {
                format!("first motion to the {name}, where the hinges change: {push_g} g")
            }
            Some(push_g) => {
                let push_m_s2 = shown(&self.incipient_acceleration_m_s2, 6).unwrap_or_default();
                let is_one = self.wall_behind.is_none() && self.to_the_left.is_none();
                let side = match self.unstable_rotations {
                    Some(_) if is_one => ", either side".to_owned(),
                    _ => format!(" to the {name}"),
                };
                format!("incipient rocking acceleration A_L{side}: {push_g} g = {push_m_s2} m/s2")
            }
        }
    }

    /// Push at which a structure on moved springings falls to one side in words; `None` if no push starts it.
    fn fall_in_words(&self, sway: &Sway) -> Option<String> {
        let (name, pushes_g) = (sway.name(), self.capacity_g.as_ref()?);
        self.incipient_acceleration_g.get(*sway).as_ref()?;
        if let Some(reason) = self.capacity_not_found.as_ref()?.get(*sway) {
            return Some(format!("capacity to the {name} not found: {reason}"));
        }
        Some(
            match pushes_g.get(*sway).map(|push_g| format_fixed(push_g, 8)) {
                Some(push_g) => format!("capacity to the {name}: it falls at {push_g} g"),
                None => format!("no push to the {name} was found at which it falls"),
            },
        )
    }

    /// Rotations with the names of their bodies.
    fn rotations_by_body(&self, rotations_rad: &[f64]) -> String {
        by_body(&self.bodies, rotations_rad)
    }

    /// Rotations at the unstable equilibrium with the names of their bodies.
    fn unstable_by_body(&self, Named(rotations_rad): &Named<f64>) -> String {
        let rotations_rad = rotations_rad.iter().map(|(_, value)| *value);
        self.rotations_by_body(&rotations_rad.collect::<Vec<_>>())
    }
}

impl Friction {
    fn heading(&self) -> String {
        let coefficient = self.coefficient;
        format!("with joints that slip at a coefficient of friction of {coefficient:?}")
    }

    /// Push that starts the row to one side in words.
    fn start_in_words(&self, sway: &Sway) -> String {
        let name = sway.name();
        let (push_g, slips) = match &self.onset {
            FrictionLimit::Moved {
                incipient_acceleration_g: pushes_g,
            } => (*pushes_g.get(*sway), None),
            FrictionLimit::Undeformed { sides, .. } => {
                let side = sides.get(*sway);
                (side.incipient_acceleration_g, Some(side.sliding_governs))
            }
        };
        match (push_g.map(|push_g| format_fixed(push_g, 8)), slips) {
            (None, _) => format!("no push to the {name} starts it"),
            (Some(push_g), None) => format!("first motion to the {name} at {push_g} g"),
            (Some(push_g), Some(false)) => {
                format!("a push of {push_g} g starts it to the {name}: no joint slips")
            }
            (Some(push_g), Some(true)) => format!(
                "a push of {push_g} g starts it to the {name}: sliding governs; this is an upper bound, because joints are assumed to \
                 open as they slip"
            ),
        }
    }
}

/// Joints of a row that open in a mechanism.
pub(super) fn open_joints(row: &Row, onset: Option<&RowOnset>) -> Vec<MechanismHinge> {
    let openings = onset.into_iter().flat_map(|onset| &onset.openings);
    let open = openings.map(|opening| {
        let corner = opening.hinge.unwrap_or(Edge::Intrados);
        let corner_m = row.joints[opening.joint].corner_m(corner);
        MechanismHinge::Joint {
            joint: opening.joint,
            edge: opening.hinge,
            x_m: corner_m.x,
            y_m: corner_m.y,
        }
    });
    open.collect()
}

/// Hinges of a wall whose top is held.
pub(super) fn held_hinges(mechanism: &HeldMechanism) -> Vec<MechanismHinge> {
    let hinges = mechanism.hinges().into_iter().zip(mechanism.hinges_m());
    let listed = hinges.map(|(hinge, at_m)| match hinge {
        Hinge::Joint { joint, edge } => MechanismHinge::Joint {
            joint,
            edge,
            x_m: at_m.x,
            y_m: at_m.y,
        },
        hinge => MechanismHinge::Link(hinge),
    });
    listed.collect()
}

impl MechanismHinge {
    /// Place of the hinge in the undeformed structure, in metres.
    pub(super) fn position_m(&self, scene: &Scene) -> Vector2<f64> {
        match self {
            Self::Joint { x_m, y_m, .. } => Vector2::new(*x_m, *y_m),
            Self::Link(hinge) => {
                let point = scene.hinge(*hinge);
                point.map_or_else(Vector2::zeros, |point| point.at_m)
            }
        }
    }

    /// Line about the hinge at this position in the mechanism, from 0.
    pub(super) fn words(&self, position: &usize) -> String {
        let named = |edge: &Option<Edge>, otherwise| edge.map_or(otherwise, Edge::name);
        match self {
            Self::Joint {
                joint,
                edge,
                x_m,
                y_m,
            } => format!(
                "joint {joint:>3} at x {:>10} m, y {:>10} m, {}",
                format_fixed(*x_m, 5),
                format_fixed(*y_m, 5),
                named(edge, "both edges")
            ),
            Self::Link(Hinge::Section { angle_rad, edge }) => format!(
                "{}  {:10.5} deg from the left springing, {}",
                HINGES.get(*position).unwrap_or(&""),
                degrees(*angle_rad),
                edge.name()
            ),
            Self::Link(Hinge::Toe(side)) => format!("the {} toe", side.name()),
            Self::Link(Hinge::Face { height_m, side }) => format!(
                "the {} face, {} m above the base",
                side.name(),
                format_fixed(*height_m, 4)
            ),
            Self::Link(Hinge::Joint { joint, edge }) => {
                format!("joint {joint}, {}", named(edge, "parted"))
            }
        }
    }
}
