//! The mechanism to one side as a chain of rigid bodies: its onset, its masses, and its capacity curve if there is one.

use std::collections::BTreeMap;

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use super::{CheckInput, NoCurve, VerifyError};
use crate::bisection::{Width, bisect};
use crate::mechanics::settling::Held;
use crate::mechanics::stability::onset;
use crate::mechanics::{
    Anchor, BodyPoint, Capacity, Control, Displaced, Edge, FrictionError, HeldMechanism,
    MovingBody, MovingForce, MovingTie, Participation, Parts as _, RowOnset, displacement_factor,
    friction, load_multiplier,
};
use crate::scenario::{CheckedSides, Structure};
use crate::studies::capacity::Bodies;
use crate::{Hinge, MechanismModel, Row, Sway};

/// A hinge with its position.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlacedHinge {
    /// The hinge.
    #[serde(flatten)]
    pub hinge: Hinge,
    /// Horizontal position in the undeformed structure, in metres.
    pub x_m: f64,
    /// Vertical position in the undeformed structure, in metres.
    pub y_m: f64,
}

/// A rigid body of a mechanism, with its virtual displacement per unit displacement of the common centre.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MechanismBody {
    /// Mass of the body, with the fill and loads that it carries, in kg.
    pub mass_kg: f64,
    /// Weight of the body, in kN.
    pub weight_kn: f64,
    /// Horizontal position of the centre of gravity in the undeformed structure, in metres.
    pub x_m: f64,
    /// Vertical position of the centre of gravity in the undeformed structure, in metres.
    pub y_m: f64,
    /// Virtual displacement of the centre in the direction of the sway.
    pub delta_x: f64,
    /// Virtual displacement of the centre upwards.
    pub delta_y: f64,
    /// Virtual rotation towards the side of the sway, per metre.
    pub rotation_per_m: f64,
    /// Numbers of its first and last block, from 1; absent for a ring.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub blocks: Option<[usize; 2]>,
}

/// A tie of a mechanism.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct HeldTie {
    /// Prestress of the tie, in kN.
    pub force_kn: f64,
    /// Elongation of the tie for the virtual displacement of the mechanism.
    pub delta_l: f64,
    /// Positions of its ends in the undeformed structure, in metres.
    pub ends_m: [Vector2<f64>; 2],
    /// Numbers of the blocks at its ends, from 1; null for a support.
    pub blocks: [Option<usize>; 2],
}

/// A constant force on a mechanism: a thrust, or a weight without inertia.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConstantForce {
    /// Horizontal position of its point in the undeformed structure, in metres.
    pub x_m: f64,
    /// Vertical position of its point in the undeformed structure, in metres.
    pub y_m: f64,
    /// Horizontal force in the direction of the sway, in kN.
    pub force_x_kn: f64,
    /// Vertical force upwards, in kN.
    pub force_y_kn: f64,
    /// Virtual displacement of its point in the direction of the sway.
    pub delta_x: f64,
    /// Virtual displacement of its point upwards.
    pub delta_y: f64,
}

impl ConstantForce {
    /// Force with the displacement of its point, multiplied by `scale`.
    fn new(force: &MovingForce, scale: f64, gravity_m_s2: f64) -> Self {
        let force_kn = force.force_kg * (gravity_m_s2 / 1000.0);
        Self {
            x_m: force.at_m.x + 0.0,
            y_m: force.at_m.y + 0.0,
            force_x_kn: force_kn.x + 0.0,
            force_y_kn: force_kn.y + 0.0,
            delta_x: force.displacement.x * scale,
            delta_y: force.displacement.y * scale,
        }
    }
}

/// Joints that slide before the mechanism without sliding forms.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Slide {
    /// Friction coefficient of the joints.
    pub coefficient: f64,
    /// Upper bound of the acceleration at which joints slide, in g, by associated limit analysis; zero if they slide under the weight of the
    /// structure.
    pub bound_g: f64,
}

/// The mechanism at a displacement of its capacity curve.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Position {
    /// Displacement over that at the unstable equilibrium.
    pub part_of_d0: f64,
    /// Displacement of the oscillator, in metres.
    pub displacement_m: f64,
    /// Acceleration of the oscillator, not divided, in g.
    pub acceleration_g: f64,
    /// Positions of the hinges, in metres.
    pub hinges_m: Vec<Vector2<f64>>,
    /// Positions of the centres of the bodies, in metres.
    pub centres_m: Vec<Vector2<f64>>,
}

/// Parts of the ultimate displacement at which positions are printed, besides those of the limit states.
const PRINTED_PARTS: [f64; 3] = [0.4, 0.6, 1.0];

/// The mechanism that starts to one side.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CheckedMechanism {
    /// Hinges from left to right.
    pub hinges: Vec<PlacedHinge>,
    /// Rigid bodies from left to right; the virtual displacement of their common centre is one.
    pub bodies: Vec<MechanismBody>,
    /// Ties, with their elongation for that displacement.
    pub ties: Vec<HeldTie>,
    /// Constant forces, with the displacements of their points; absent without such forces.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub forces: Vec<ConstantForce>,
    /// Sum of the tie forces at rest times their elongation, minus the work of the constant forces, in kN.
    pub sum_f_delta_l_kn: f64,
    /// Sum of the weights, in kN.
    pub sum_p_kn: f64,
    /// Sum of the weights times horizontal virtual displacements, in kN.
    pub sum_p_delta_x_kn: f64,
    /// Sum of the weights times squares of horizontal virtual displacements, in kN.
    pub sum_p_delta_x2_kn: f64,
    /// Sum of the weights times vertical virtual displacements, in kN.
    pub sum_p_delta_y_kn: f64,
    /// Load multiplier [C8.7.1.1].
    pub alpha0: f64,
    /// Moving mass, in kg.
    pub moving_mass_kg: f64,
    /// Participating mass `M*` as a fraction of the moving mass.
    pub e_star: f64,
    /// Participating mass `M*` [C8.7.1.5], in kg.
    pub m_star_kg: f64,
    /// `a_0 / FC = alpha0 / (e* FC)`, in g. Loads are part of the bodies that carry them, which is on the safe side.
    pub a0_over_fc_g: f64,
    /// `a_0 / FC` with the loads as separate weights in `e*`, in g; absent without such loads. It is larger and not used.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub a0_with_separate_loads_over_fc_g: Option<f64>,
    /// Displacement of the common centre at the unstable equilibrium, in metres; `None` without a capacity curve.
    pub d_c0_m: Option<f64>,
    /// Displacement of the oscillator at the unstable equilibrium, in metres.
    pub d0_m: Option<f64>,
    /// Displacement of the crown (or the top) at the unstable equilibrium, in metres; `None` without a curve, or if the crown does not move to
    /// that side.
    pub d_c0_crown_m: Option<f64>,
    /// Displacement of the oscillator at the unstable equilibrium with the crown as control point, in metres.
    pub d0_crown_m: Option<f64>,
    /// Displacement at which the elastic branch meets the divided curve, in metres; `None` if walls hold the structure.
    pub d_y_m: Option<f64>,
    /// Divided acceleration at displacement `d_y_m`, in g; `None` if walls hold the structure.
    pub a_y_over_fc_g: Option<f64>,
    /// The largest friction coefficient needed up to the largest displacement that a limit state allows.
    pub friction: Option<f64>,
    /// Displacements in metres and accelerations in g of the oscillator.
    pub curve_m_g: Option<Vec<[f64; 2]>>,
    /// Positions at the displacements of the limit states and at the unstable equilibrium; absent without a capacity curve.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub positions: Vec<Position>,
    /// The reason why there is no capacity curve.
    pub no_curve: Option<NoCurve>,
    /// Joints that slide before this mechanism forms, so that it does not count; absent unless they do.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sliding: Option<Slide>,
    /// Horizontal force of the floor on a wall whose top it holds when the mechanism starts, in kN, positive against the sway; absent if the top is free.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub top_reaction_kn: Option<f64>,
    /// Blocks of a wall whose top is held, cut at its hinges if it has no drums.
    #[serde(skip)]
    pub held_row: Option<Row>,
    /// The body to which each block of a row belongs; for pictures of a mechanism without a curve.
    #[serde(skip)]
    pub body_of_block: Vec<Option<usize>>,
    /// Motion of the mechanism up to the unstable equilibrium; `None` without a capacity curve.
    #[serde(skip)]
    pub curves: Option<CapacityCurves>,
}

/// A mechanism with virtual displacements of arbitrary scale.
struct VirtualMechanism {
    hinges: Vec<(Hinge, Vector2<f64>)>,
    bodies: Vec<MovingBody>,
    ties: Vec<MovingTie>,
    /// Ends of the ties.
    ends: Vec<[Anchor; 2]>,
    forces: Vec<MovingForce>,
    body_of_block: Vec<Option<usize>>,
    curves: Result<CapacityCurves, NoCurve>,
    held_top: Option<HeldMechanism>,
}

/// The motion of a mechanism up to its unstable equilibrium, as capacity curves.
#[derive(Clone, Debug, PartialEq)]
pub struct CapacityCurves {
    /// Capacity curve with the common centre of the bodies as control point.
    pub centre: Capacity,
    /// Capacity curve with the crown (or the top) as control point; `None` if the crown does not move to that side.
    pub crown: Option<Capacity>,
    /// Positions at the displacements of the limit states and at the unstable equilibrium.
    pub positions: Vec<Position>,
}

impl CapacityCurves {
    /// Computes the curves of bodies. `displaced` returns their positions at a fraction of the motion up to the unstable equilibrium.
    fn new(
        sway: Sway,
        displaced: impl Fn(f64) -> Displaced,
        bodies: &[MovingBody],
        crown: Option<BodyPoint>,
        input: &CheckInput<'_>,
    ) -> Result<Self, NoCurve> {
        let gravity_m_s2 = input.gravity_m_s2;
        let masses: Vec<(f64, BodyPoint)> = (0..)
            .map(Some)
            .zip(bodies)
            .map(|(body, own)| {
                let at_m = own.centre_m;
                (own.mass_kg, BodyPoint { at_m, body })
            })
            .collect();
        let curve = |control| Capacity::new(sway, &displaced, &masses, control, gravity_m_s2);
        let centre = curve(Control::centre_of(&masses))?;
        let mut parts: Vec<f64> = input.parts_of_d0().chain(PRINTED_PARTS).collect();
        parts.sort_by(f64::total_cmp);
        parts.dedup();
        let end_m = centre.end().oscillator_displacement_m;
        let whole_kg: f64 = bodies.iter().map(|body| body.mass_kg).sum();
        let centres_m = |at: &Displaced| {
            let centres = at
                .poses
                .iter()
                .zip(bodies)
                .map(|(pose, body)| pose.current_position(body.centre_m));
            centres.collect::<Vec<_>>()
        };
        let oscillator_m = |at: &Displaced| {
            let shifts_m = centres_m(at)
                .into_iter()
                .zip(bodies)
                .map(|(at_m, body)| (at_m - body.centre_m).x * body.mass_kg);
            sway.sign() * shifts_m.sum::<f64>() / whole_kg * centre.to_oscillator
        };
        let positions = parts.iter().map(|part| {
            let goes = |way: f64| oscillator_m(&displaced(way)) >= part * end_m;
            let is_end = *part == 1.0;
            let way = match is_end {
                true => 1.0,
                false => bisect(0.0, 1.0, Width::Rounding, goes).1,
            };
            let at = displaced(way);
            Position {
                part_of_d0: *part,
                displacement_m: oscillator_m(&at),
                acceleration_g: match is_end {
                    true => 0.0,
                    false => at.acceleration_g / centre.mass_fraction,
                },
                centres_m: centres_m(&at),
                hinges_m: at.hinges_m,
            }
        });
        Ok(Self {
            positions: positions.collect(),
            crown: crown.and_then(|crown| curve(Control::point(crown)).ok()),
            centre,
        })
    }

    /// Displacements in metres and accelerations in g of the oscillator.
    fn points_m_g(&self) -> Vec<[f64; 2]> {
        let points = self
            .centre
            .curve
            .iter()
            .map(|one| (one.oscillator_displacement_m, one.oscillator_acceleration_g));
        points.map(Into::into).collect()
    }

    /// Largest friction coefficient needed up to a fraction of the ultimate displacement.
    pub fn friction_up_to(&self, part: f64) -> f64 {
        let end_m = part * self.centre.end().oscillator_displacement_m;
        let points = self.centre.curve.iter();
        points
            .take_while(|point| point.oscillator_displacement_m <= end_m)
            .map(|point| point.friction)
            .fold(0.0, f64::max)
    }
}

impl CheckedMechanism {
    /// Makes the mechanism without sliding. If joints slide first, it has no capacity curve.
    fn new(mut found: VirtualMechanism, sliding: Option<Slide>, input: &CheckInput<'_>) -> Self {
        if sliding.is_some() {
            found.curves = Err(NoCurve::Slides);
        }
        let weight_kn = |mass_kg: f64| mass_kg * input.gravity_m_s2 / 1000.0;
        let alpha0 = found.alpha0();
        let participation = Participation::of_bodies(&found.bodies);
        let scale = displacement_factor(&found.bodies);
        let body = |(index, body): (usize, &MovingBody)| MechanismBody {
            mass_kg: body.mass_kg,
            weight_kn: weight_kn(body.mass_kg),
            // Adding zero makes a negative zero positive.
            x_m: body.centre_m.x + 0.0,
            y_m: body.centre_m.y + 0.0,
            delta_x: body.displacement.x * scale,
            delta_y: body.displacement.y * scale,
            rotation_per_m: body.rotation * scale,
            blocks: found.blocks_of(index),
        };
        let bodies: Vec<MechanismBody> = found.bodies.iter().enumerate().map(body).collect();
        let sum = |term: fn(&MechanismBody) -> f64| -> f64 {
            let terms = bodies.iter().map(|body| body.weight_kn * term(body));
            terms.sum()
        };
        let (ties, forces) = (found.ties.iter(), found.forces.iter());
        let held_kg = (ties.clone()).map(|tie| tie.force_kg * (tie.lengthening * scale));
        let pushing_kg =
            (forces.clone()).map(|force| force.force_kg.dot(&force.displacement) * scale);
        let held_kg = held_kg.sum::<f64>() - pushing_kg.sum::<f64>();
        let forces = forces.map(|force| ConstantForce::new(force, scale, input.gravity_m_s2));
        let curves = found.curves.as_ref().ok();
        let furthest_part = input.parts_of_d0().fold(0.0, f64::max);
        let crown = curves.and_then(|curves| Some(curves.crown.as_ref()?.end()));
        let end = curves.map(|curves| curves.centre.end());
        let yielding = curves.and_then(|curves| input.find_yield_point(curves));
        let hinges = found.hinges.iter().map(|(hinge, at_m)| PlacedHinge {
            hinge: *hinge,
            x_m: at_m.x + 0.0,
            y_m: at_m.y + 0.0,
        });
        Self {
            hinges: hinges.collect(),
            sum_f_delta_l_kn: held_kg * input.gravity_m_s2 / 1000.0,
            sum_p_kn: sum(|_| 1.0),
            sum_p_delta_x_kn: sum(|body| body.delta_x),
            sum_p_delta_x2_kn: sum(|body| body.delta_x * body.delta_x),
            sum_p_delta_y_kn: sum(|body| body.delta_y),
            bodies,
            ties: ties
                .zip(&found.ends)
                .map(|(tie, ends)| HeldTie {
                    force_kn: weight_kn(tie.force_kg),
                    delta_l: tie.lengthening * scale,
                    ends_m: ends.map(|end| end.at_m),
                    blocks: ends.map(|end| Some(end.block? + 1)),
                })
                .collect(),
            positions: curves.map_or_else(Vec::new, |curves| curves.positions.clone()),
            forces: forces.collect(),
            alpha0,
            moving_mass_kg: participation.moving_mass_kg,
            e_star: participation.mass_fraction,
            m_star_kg: participation.participating_mass_kg,
            a0_over_fc_g: alpha0 / (participation.mass_fraction * input.settings.confidence_factor),
            a0_with_separate_loads_over_fc_g: found.a0_with_separate_loads_over_fc_g(input),
            d_c0_m: end.map(|end| end.displacement_m),
            d0_m: end.map(|end| end.oscillator_displacement_m),
            d_c0_crown_m: crown.map(|end| end.displacement_m),
            d0_crown_m: crown.map(|end| end.oscillator_displacement_m),
            d_y_m: yielding.map(|both| both.0),
            a_y_over_fc_g: yielding.map(|both| both.1),
            friction: curves.map(|curves| curves.friction_up_to(furthest_part)),
            curve_m_g: curves.map(CapacityCurves::points_m_g),
            no_curve: found.curves.as_ref().err().cloned(),
            sliding,
            top_reaction_kn: (found.held_top.as_ref()).map(|held| held.reaction_n / 1000.0),
            held_row: found.held_top.map(|held| held.row),
            body_of_block: found.body_of_block,
            curves: found.curves.ok(),
        }
    }
}

impl VirtualMechanism {
    /// Computes the load multiplier [C8.7.1.1].
    fn alpha0(&self) -> f64 {
        load_multiplier(&self.bodies, &self.ties, &self.forces)
    }

    /// `a_0 / FC` with the loads at points as separate weights, in g; `None` if no body carries such a load.
    fn a0_with_separate_loads_over_fc_g(&self, input: &CheckInput<'_>) -> Option<f64> {
        let fraction = self.fraction_with_separate_loads(&input.scenario.structure)?;
        Some(self.alpha0() / (fraction * input.settings.confidence_factor))
    }

    /// `e*` with the loads at points as separate weights [C8.7.1.5, with n + m weights]; `None` if no body carries such a load.
    fn fraction_with_separate_loads(&self, structure: &Structure) -> Option<f64> {
        if self.held_top.is_some() {
            return None;
        }
        let (outlines, loads) = structure.fill_and_loads();
        let carried = outlines.loads_m.iter().zip(loads);
        let points = carried.filter(|(_, load)| load.moves && load.width_m == 0.0);
        let mut weights: Vec<(f64, f64)> = Vec::new();
        let mut without: Vec<MovingBody> = self.bodies.clone();
        for ((block, at_m), load) in points.filter(|(_, load)| load.mass_kg > 0.0) {
            let carries = |body: &usize| match self.blocks_of(*body) {
                Some([first, last]) => (first..=last).contains(&(block + 1)),
                None => self.bodies.len() == 1,
            };
            let Some(body) = (0..self.bodies.len()).find(carries) else {
                continue;
            };
            let displacement = self.bodies[body].displacement_at(at_m.y);
            weights.push((load.mass_kg, displacement));
            let rest = &mut without[body];
            let mass_kg = rest.mass_kg - load.mass_kg;
            rest.displacement.x =
                (rest.mass_kg * rest.displacement.x - load.mass_kg * displacement) / mass_kg;
            rest.mass_kg = mass_kg;
        }
        let bodies = without
            .iter()
            .map(|body| (body.mass_kg, body.displacement.x));
        let all = || bodies.clone().chain(weights.iter().copied());
        (!weights.is_empty() && all().all(|(mass_kg, _)| mass_kg > 0.0))
            .then(|| Participation::of(all()).mass_fraction)
    }

    /// Numbers of the first and the last block of a body, from 1; `None` for a ring.
    fn blocks_of(&self, body: usize) -> Option<[usize; 2]> {
        if self.held_top.as_ref().is_some_and(|held| held.is_cut) {
            return None;
        }
        let of_body = |of: &Option<usize>| *of == Some(body);
        if let Some(first) = self.body_of_block.iter().position(of_body) {
            let last = self.body_of_block.iter().rposition(of_body);
            return Some([first + 1, last.unwrap_or(first) + 1]);
        }
        let joint = |hinge: usize| match self.hinges.get(hinge)?.0 {
            Hinge::Joint { joint, .. } => Some(joint),
            Hinge::Section { .. } | Hinge::Toe(_) | Hinge::Face { .. } => None,
        };
        joint(body)
            .zip(joint(body + 1))
            .map(|(from, to)| [from + 1, to])
    }

    /// Finds the mechanism to one side of a model that moves as one mechanism.
    fn of_model(
        structure: &Structure,
        model: &dyn MechanismModel,
        sway: Sway,
        input: &CheckInput<'_>,
    ) -> Option<Self> {
        let bodies = model.moving_bodies(sway)?;
        let at_rest = model.displaced_mechanism(sway, 0.0)?;
        let named = model.hinges_after(0, sway).into_iter();
        let displaced = |part| {
            let displaced = model.displaced_mechanism(sway, part);
            displaced.expect("a structure has its first mechanism")
        };
        let crown = Bodies::of_model(model, sway).body_point(structure.as_parts().crown());
        let curves = CapacityCurves::new(sway, displaced, &bodies, Some(crown), input);
        Some(Self {
            hinges: named.zip(at_rest.hinges_m).collect(),
            curves,
            bodies,
            ties: Vec::new(),
            ends: Vec::new(),
            forces: model.moving_forces(sway)?,
            body_of_block: Vec::new(),
            held_top: None,
        })
    }

    /// Mechanism of a wall whose top is held; ties count as forces, and the top, which does not move sideways, is no control point.
    fn of_held_top(held: HeldMechanism, sway: Sway, input: &CheckInput<'_>) -> Self {
        let (bodies, forces) = held.first_motion();
        let curves = held.end_rad().map_err(NoCurve::from).and_then(|end_rad| {
            let displaced = |part| held.displaced(part * end_rad);
            CapacityCurves::new(sway, displaced, &bodies, None, input)
        });
        let blocks = 0..held.row.blocks.len();
        Self {
            hinges: held.hinges().into_iter().zip(held.hinges_m()).collect(),
            ties: Vec::new(),
            ends: Vec::new(),
            forces,
            curves,
            bodies,
            body_of_block: blocks.map(|block| held.body_of(block)).collect(),
            held_top: Some(held),
        }
    }

    /// Finds the mechanism of a row at rest by limit analysis, and its motion if the row has no ties.
    fn of_onset(row: &Row, sway: Sway, onset: &RowOnset, input: &CheckInput<'_>) -> Self {
        let opens = |joint: usize| onset.openings.iter().any(|open| open.joint == joint);
        let fastest = |block: usize| {
            let twist = onset.velocities[block];
            twist.velocity_at(row.blocks[block].centre_m).norm() + twist.rate.abs() * row.size_m
        };
        let blocks = row.blocks.len();
        let most = (0..blocks).map(fastest).fold(0.0, f64::max);
        let mut body_of_block = vec![None; blocks];
        let mut bodies: Vec<(f64, Vector2<f64>, usize)> = Vec::new();
        let mut current = None;
        for (block, body_of) in body_of_block.iter_mut().enumerate() {
            if opens(block) {
                current = None;
            }
            // A block between the supports and the first open joint stands still.
            if fastest(block) <= 1e-7 * most {
                current = None;
                continue;
            }
            let index = *current.get_or_insert_with(|| {
                bodies.push((0.0, Vector2::zeros(), block));
                bodies.len() - 1
            });
            let own = &row.blocks[block];
            bodies[index].0 += own.mass_kg;
            bodies[index].1 += own.centre_m * own.mass_kg;
            *body_of = Some(index);
        }
        let towards = |v: Vector2<f64>| Vector2::new(sway.sign() * v.x, v.y);
        let bodies = bodies.into_iter().map(|(mass_kg, first, block)| {
            let (centre_m, twist) = (first / mass_kg, onset.velocities[block]);
            MovingBody {
                mass_kg,
                centre_m,
                displacement: towards(twist.velocity_at(centre_m)),
                rotation: -sway.sign() * twist.rate,
            }
        });
        let bodies: Vec<MovingBody> = bodies.collect();
        let hinges = onset.openings.iter().map(|open| {
            let (joint, edge) = (open.joint, open.hinge);
            let at_m = row.joints[joint].corner_m(edge.unwrap_or(Edge::Intrados));
            (Hinge::Joint { joint, edge }, at_m)
        });
        let forces = row.constant_forces().map(|force| {
            let (at_m, force_n) = (force.ends[0].at_m, force.force_at_rest_n());
            let block = force.ends[0].block.unwrap_or(0);
            MovingForce {
                at_m,
                force_kg: towards(force_n) / row.gravity_m_s2,
                displacement: towards(onset.velocities[block].velocity_at(at_m)),
            }
        });
        let ties = row.bars().iter().zip(&onset.lengthening);
        let ties = ties.map(|(tie, lengthening)| MovingTie {
            force_kg: tie.prestress_n / row.gravity_m_s2,
            lengthening: *lengthening,
        });
        let curves = || {
            if !row.bars().is_empty() {
                return Err(NoCurve::Ties);
            }
            let held = Held::new(row, sway)?;
            let crown = Bodies::of_row(&held).body_point(row.crown());
            let displaced = |part| held.displaced_mechanism(part);
            CapacityCurves::new(sway, displaced, &bodies, Some(crown), input)
        };
        Self {
            hinges: hinges.collect(),
            ties: ties.collect(),
            ends: row.bars().iter().map(|tie| tie.ends).collect(),
            forces: forces.collect(),
            curves: curves(),
            bodies,
            body_of_block,
            held_top: None,
        }
    }
}

/// Number of voussoirs into which an arch without joints is cut to find its sliding mechanism.
const CUT: usize = 60;

/// Relative difference of two bounds that is due to the linear program.
const BOUND_TOLERANCE: f64 = 1e-6;

/// Finds the slide of the joints of a row to one side, if its bound is below the load multiplier `alpha0` of the mechanism without sliding.
fn find_slide(row: &Row, coefficient: f64, sway: Sway, alpha0: f64) -> Option<Slide> {
    let bound_g = match friction::onset(row, coefficient, sway) {
        Ok(Some(onset)) => {
            let governs = onset.sliding_governs() && onset.acceleration_g < alpha0;
            governs.then_some(onset.acceleration_g)?
        }
        Err(FrictionError::CannotStand(_)) => 0.0,
        Ok(None) | Err(_) => return None,
    };
    Some(Slide {
        coefficient,
        bound_g,
    })
}

/// Gives both sides the larger of two bounds that differ only by the tolerance of the linear program.
fn equalise(mechanisms: &mut BTreeMap<Sway, CheckedMechanism>) {
    let mut slides: Vec<&mut Slide> = mechanisms
        .values_mut()
        .filter_map(|one| one.sliding.as_mut())
        .collect();
    if let [one, other] = &mut slides[..] {
        let larger_g = one.bound_g.max(other.bound_g);
        if (one.bound_g - other.bound_g).abs() <= BOUND_TOLERANCE * larger_g {
            (one.bound_g, other.bound_g) = (larger_g, larger_g);
        }
    }
}

/// Finds the mechanisms of a structure to the checked sides, and the sides to which joints slide first.
///
/// # Errors
/// When the structure cannot stand, or no acceleration moves it to a side.
pub(super) fn mechanisms(
    input: &CheckInput<'_>,
) -> Result<BTreeMap<Sway, CheckedMechanism>, VerifyError> {
    let structure = &input.scenario.structure;
    let coefficient = input.allowed_friction;
    let none =
        |sway: Sway| VerifyError::NoMechanism(format!("no push moves it to the {}", sway.name()));
    let model = input.scenario.mechanisms_without_impacts();
    let row = structure
        .row()
        .map_err(|error| VerifyError::NoMechanism(error.to_string()));
    // An arch without joints may slide at any section.
    let cut = match structure {
        Structure::Arch(arch) => {
            let arch = arch.clone().with_voussoirs(CUT);
            arch.ok().and_then(|arch| arch.row().ok())
        }
        _ => None,
    };
    let of = |sway: Sway| {
        if let Some(column) = structure.held_column() {
            let held = HeldMechanism::new(column, sway);
            let held = held.map_err(|error| VerifyError::NoMechanism(error.to_string()))?;
            let bound_g = held.slide_bound_g(coefficient);
            let slides = bound_g.map(|bound_g| Slide {
                coefficient,
                bound_g,
            });
            let found = VirtualMechanism::of_held_top(held, sway, input);
            return Ok((sway, CheckedMechanism::new(found, slides, input)));
        }
        let found = if let Ok(model) = &model {
            VirtualMechanism::of_model(structure, &**model, sway, input)
                .ok_or_else(|| none(sway))?
        } else {
            let row = row.as_ref().map_err(VerifyError::clone)?;
            let found = onset(row, sway)
                .map_err(|error| VerifyError::NoMechanism(error.to_string()))?
                .ok_or_else(|| none(sway))?;
            VirtualMechanism::of_onset(row, sway, &found, input)
        };
        let joints = row.as_ref().ok().or(cut.as_ref());
        let slides = joints.and_then(|row| find_slide(row, coefficient, sway, found.alpha0()));
        Ok((sway, CheckedMechanism::new(found, slides, input)))
    };
    let checked = match input.settings.sides {
        CheckedSides::Both => Sway::ALL,
        CheckedSides::Right => &[Sway::Right],
        CheckedSides::Left => &[Sway::Left],
    };
    let mut mechanisms = checked
        .iter()
        .copied()
        .map(of)
        .collect::<Result<BTreeMap<Sway, CheckedMechanism>, VerifyError>>()?;
    equalise(&mut mechanisms);
    Ok(mechanisms)
}
