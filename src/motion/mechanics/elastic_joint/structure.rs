//! Rigid bodies and the elastic joints between them.

use std::ops::RangeInclusive;

use nalgebra::{Matrix3, Vector2, Vector3};

use super::contact::{Contact, ElasticJoint, Fibre, Law, Memory, Pressing, Rubbing, Section};
use super::kinematics::{Action, Link, Place};
use super::tie::BoundTie;
use crate::argument::{ArgumentError, allow, within};
use crate::mechanics::blocks::{Row, Supports};
use crate::mechanics::lanes::{Lanes, Real};
use crate::mechanics::tie::square_frequency;

/// Stiffness of an interface per area, in Pa/m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointStiffness {
    /// Against penetration.
    pub normal_pa_m: f64,
    /// Against slip.
    pub shear_pa_m: f64,
}

/// Materials that determine the stiffness of joints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Materials {
    /// Young's modulus of the blocks, in Pa.
    pub stone_modulus_pa: f64,
    /// Young's modulus of the mortar, in Pa, and its thickness, in m, if there is any.
    pub mortar: Option<[f64; 2]>,
    /// Stiffness against slip over that against penetration.
    pub shear_ratio: f64,
}

/// The stiffness of the joints of a structure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stiffness {
    /// One stiffness for all joints.
    Uniform(JointStiffness),
    /// Blocks and mortar in series: `1/kn = t_m/E_m + L/E_b`, with the distance `L` between the centres of the two blocks across the
    /// joint; at a support, from the centre of the block to the joint.
    Materials(Materials),
}

/// Properties of elastic joints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElasticProperties {
    /// Their stiffness.
    pub stiffness: Stiffness,
    /// Width of the structure out of its plane, in m.
    pub depth_m: f64,
    /// Coulomb's coefficient of friction; if `None`, nothing slips permanently.
    pub friction_coefficient: Option<f64>,
    /// Damping time in s: damping forces are this times the rates of the elastic ones.
    pub damping_time_s: f64,
    /// Stress at which joints crush, in Pa; if `None`, they do not.
    pub compressive_strength_pa: Option<f64>,
    /// Integration of the stress.
    pub contact: Contact,
}

impl ElasticProperties {
    /// Above this range explicit steps are too many, and joints as good as rigid; below it nothing stands.
    pub const NORMAL_STIFFNESS_PA_M: RangeInclusive<f64> = 1e6..=1e14;
    /// Stiffness against slip over that against penetration.
    pub(crate) const SHEAR_RATIO: RangeInclusive<f64> = 1e-2..=1e2;
    /// From soft rubber to beyond diamond, in Pa.
    pub const MODULUS_PA: RangeInclusive<f64> = 1e5..=1e13;
    /// Thickness of mortar, in m.
    pub const MORTAR_M: RangeInclusive<f64> = 0.0..=1.0;
    /// Joints of stone have 0.5 to 0.8.
    pub const FRICTION_COEFFICIENT: RangeInclusive<f64> = 1e-3..=1e3;
    /// Damping times, in s. One of 0.05 s is that of a very viscous base.
    pub const DAMPING_TIME_S: RangeInclusive<f64> = 0.0..=1.0;
    /// Strengths, in Pa.
    pub const STRENGTH_PA: RangeInclusive<f64> = 1e3..=1e12;
    /// Numbers of contact points. One does not hold a block.
    pub const CONTACT_POINTS: RangeInclusive<usize> = 2..=100;

    /// Joints of this stiffness against penetration, and 0.4 of it against slip (the shear modulus over Young's); friction 0.7, a
    /// damping time of 0.1 ms, continuous contact, no crushing; a metre wide.
    #[must_use]
    pub const fn of_stiffness(normal_pa_m: f64) -> Self {
        Self {
            stiffness: Stiffness::Uniform(JointStiffness {
                normal_pa_m,
                shear_pa_m: 0.4 * normal_pa_m,
            }),
            depth_m: 1.0,
            friction_coefficient: Some(0.7),
            damping_time_s: 1e-4,
            compressive_strength_pa: None,
            contact: Contact::Continuous,
        }
    }

    /// Refuses properties out of range; the stiffness of joints is checked joint by joint.
    fn check(&self) -> Result<(), ArgumentError> {
        if let Stiffness::Materials(materials) = self.stiffness {
            let modulus_pa = materials.stone_modulus_pa;
            within("stone_modulus_pa", modulus_pa, Self::MODULUS_PA)?;
            if let Some([modulus_pa, thickness_m]) = materials.mortar {
                within("mortar_modulus_pa", modulus_pa, Self::MODULUS_PA)?;
                within("mortar_thickness_m", thickness_m, Self::MORTAR_M)?;
            }
            within("shear_ratio", materials.shear_ratio, Self::SHEAR_RATIO)?;
        }
        within("depth_m", self.depth_m, 1e-6..=1e6)?;
        if let Some(coefficient) = self.friction_coefficient {
            let range = Self::FRICTION_COEFFICIENT;
            within("friction_coefficient", coefficient, range)?;
        }
        within("damping_time_s", self.damping_time_s, Self::DAMPING_TIME_S)?;
        if let Some(strength_pa) = self.compressive_strength_pa {
            within("compressive_strength_pa", strength_pa, Self::STRENGTH_PA)?;
        }
        if let Contact::Points(count) = self.contact {
            let is_allowed = Self::CONTACT_POINTS.contains(&count);
            let allowed = "2 to 100: one point does not hold a block";
            allow(is_allowed, "contact_points", count as f64, allowed)?;
        }
        Ok(())
    }

    /// These properties or this structure with all stiffness multiplied.
    #[must_use]
    pub(crate) fn stiffness_times(mut self, factor: f64) -> Self {
        match &mut self.stiffness {
            Stiffness::Uniform(stiffness) => {
                stiffness.normal_pa_m *= factor;
                stiffness.shear_pa_m *= factor;
            }
            Stiffness::Materials(materials) => {
                materials.stone_modulus_pa *= factor;
                if let Some([modulus_pa, _]) = &mut materials.mortar {
                    *modulus_pa *= factor;
                }
            }
        }
        self
    }
}

fn check_stiffness(stiffness: JointStiffness) -> Result<(), ArgumentError> {
    let (normal_pa_m, range) = (
        stiffness.normal_pa_m,
        ElasticProperties::NORMAL_STIFFNESS_PA_M,
    );
    within("normal_stiffness_pa_m", normal_pa_m, range)?;
    let shear_ratio = stiffness.shear_pa_m / normal_pa_m;
    within("shear_ratio", shear_ratio, ElasticProperties::SHEAR_RATIO).map(|_| ())
}

/// A rigid body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// Mass in kg.
    pub mass_kg: f64,
    /// Polar moment of inertia about the centre, in kg m2.
    pub inertia_kg_m2: f64,
}

/// Rigid bodies with elastic joints between them. The body after the last one is the left support (or the only one), and
/// whatever joints name beyond that is the right one.
#[derive(Clone, Debug, PartialEq)]
pub struct ElasticStructure {
    /// The bodies.
    pub bodies: Vec<Body>,
    /// Displacements (m) and rotations (rad) of the supports.
    pub supports: [[f64; 3]; 2],
    /// The joints.
    pub joints: Vec<ElasticJoint>,
    /// The ties.
    pub ties: Vec<BoundTie>,
    /// The most that ties add to the square of the highest frequency.
    ties_square_frequency: f64,
    /// The law of its joints.
    pub(crate) law: Law,
    /// Damping time in s.
    pub damping_time_s: f64,
}

impl ElasticStructure {
    /// A row of blocks.
    ///
    /// # Errors
    /// When a property is out of range.
    pub fn of_row(row: &Row, properties: &ElasticProperties) -> Result<Self, ArgumentError> {
        properties.check()?;
        let blocks = &row.blocks;
        let ground = blocks.len();
        let bodies = blocks.iter().map(|block| Body {
            mass_kg: block.mass_kg,
            inertia_kg_m2: block.inertia_kg_m2,
        });
        let joint = |(index, joint): (usize, &crate::mechanics::blocks::Joint)| {
            let right = if index < ground { index } else { ground + 1 };
            let pair = [index.checked_sub(1).unwrap_or(ground), right];
            let middle_m = joint.middle_m();
            let along = joint.along();
            let centres = pair.map(|body| blocks.get(body).map(|block| block.centre_m));
            // The support's centre is the middle of its joint.
            let arms_m = centres.map(|centre| middle_m - centre.unwrap_or(middle_m));
            let across_m = |centre: Option<Vector2<f64>>| {
                centre.map_or(0.0, |centre| along.perp(&(centre - middle_m)).abs())
            };
            let length_m = joint.thickness_m();
            let stiffness = match properties.stiffness {
                Stiffness::Uniform(stiffness) => stiffness,
                Stiffness::Materials(materials) => {
                    in_series(&materials, centres.map(across_m).iter().sum())
                }
            };
            check_stiffness(stiffness)?;
            let area_m2 = properties.depth_m * length_m;
            let strength_pa = properties.compressive_strength_pa;
            let arms_m = arms_m.map(|arm| [arm.x, arm.y]);
            let along = [along.x, along.y];
            Ok(ElasticJoint {
                link: Link::new(pair, arms_m, along, row.handedness, length_m),
                normal_n_m: stiffness.normal_pa_m * area_m2,
                shear_n_m: stiffness.shear_pa_m * area_m2,
                strength_m: strength_pa.map_or(f64::INFINITY, |pa| pa / stiffness.normal_pa_m),
                area_m2,
            })
        };
        debug_assert!(row.supports == Supports::Both || row.joints.len() == ground);
        let joints: Result<_, ArgumentError> = row.joints.iter().enumerate().map(joint).collect();
        let feet_m = row.feet_m();
        let ties = row.ties.iter();
        let ties = ties.map(|tie| BoundTie::new(*tie, blocks, feet_m));
        Ok(Self {
            ties: ties.collect(),
            ties_square_frequency: square_frequency(&row.ties, blocks),
            ..Self::new(bodies.collect(), joints?, properties)
        })
    }

    /// A structure of any bodies and joints, without ties.
    #[must_use]
    pub fn new(
        bodies: Vec<Body>,
        joints: Vec<ElasticJoint>,
        properties: &ElasticProperties,
    ) -> Self {
        let crushes = properties.compressive_strength_pa.is_some();
        let friction = match properties.friction_coefficient {
            Some(coefficient) => [coefficient, 0.0],
            None => [0.0, f64::INFINITY],
        };
        Self {
            bodies,
            supports: [[0.0; 3]; 2],
            joints,
            ties: Vec::new(),
            ties_square_frequency: 0.0,
            law: Law {
                section: Section::new(properties.contact, crushes),
                crushes,
                friction,
            },
            damping_time_s: properties.damping_time_s,
        }
    }

    /// This structure on supports moved by these displacements (m) and rotations (rad), those of a row about the middle of its
    /// first and last joint.
    #[must_use]
    pub const fn on_supports(mut self, moved: [[f64; 3]; 2]) -> Self {
        self.supports = moved;
        self
    }

    /// Those of the support that joints name so.
    #[must_use]
    pub fn support(&self, body: usize) -> &[f64; 3] {
        &self.supports[usize::from(body > self.bodies.len())]
    }

    /// Whether a support has moved.
    #[must_use]
    pub fn has_settled(&self) -> bool {
        self.supports != [[0.0; 3]; 2]
    }

    /// This structure with both supports moved as the left one has, without rotation.
    pub(super) fn moved_along(&self) -> ([f64; 2], Self) {
        let [x, y, _] = self.supports[0];
        ([x, y], self.clone().on_supports([[x, y, 0.0]; 2]))
    }

    /// This structure when its supports have gone this part of their way from where they moved along.
    pub(super) fn on_part_of_the_way(&self, part: f64) -> Self {
        let from = self.moved_along().1.supports;
        let between = |from: f64, to: f64| to - (1.0 - part) * (to - from);
        let on_way =
            |side: usize, axis: usize| between(from[side][axis], self.supports[side][axis]);
        (self.clone()).on_supports([0, 1].map(|side| [0, 1, 2].map(|axis| on_way(side, axis))))
    }

    /// Whether joints slip for good.
    #[must_use]
    pub const fn slips(&self) -> bool {
        self.law.friction[1] == 0.0
    }

    /// Mass of all bodies, in kg.
    #[must_use]
    pub fn mass_kg(&self) -> f64 {
        self.bodies.iter().map(|body| body.mass_kg).sum()
    }

    /// Number of places along each joint that remember crushing.
    #[must_use]
    pub fn fibres(&self) -> usize {
        self.law.section.fibres()
    }

    /// This structure without bounds of friction.
    pub(super) fn without_slip(&self) -> Self {
        let mut other = self.clone();
        other.law.friction = [0.0, f64::INFINITY];
        other
    }

    /// This structure without crushing.
    pub(super) fn without_crushing(&self) -> Self {
        let mut other = self.clone();
        other.law.crushes = false;
        other
    }

    /// This structure with continuous contact, without crushing.
    pub(super) fn continuous(&self) -> Self {
        let mut other = self.without_crushing();
        other.law.section = Section::Whole;
        other
    }

    /// These properties or this structure with all stiffness multiplied.
    pub(super) fn stiffness_times(&self, factor: f64) -> Self {
        let mut other = self.clone();
        for joint in &mut other.joints {
            joint.normal_n_m *= factor;
            joint.shear_n_m *= factor;
            joint.strength_m /= factor;
        }
        for tie in &mut other.ties {
            tie.tie.stiffness_n_m *= factor;
        }
        other
    }

    /// Forces of a joint with its bodies at these places, and its action on them; its memory is updated. `damping` is the damping time over
    /// the length of the step.
    #[inline(always)]
    pub fn act<R: Real>(
        &self,
        joint: &ElasticJoint,
        places: [&Place<R>; 2],
        damping: Option<R>,
        memory: &mut Memory<R>,
        fibres: &mut [Fibre<R>],
    ) -> (Action<R>, Pressing<R>, Rubbing<R>) {
        let gap = joint.link.gap(places[0], places[1]);
        let pressing = self.law.press(joint, damping, &gap, memory, fibres);
        let rubbing = self.law.rub(joint, damping, &gap, pressing.edges_n, memory);
        let action = joint.link.action(&gap, pressing.edges_n, rubbing.shear_n);
        (action, pressing, rubbing)
    }

    /// The elastic stress of a joint at rest, summed up: forces at its edges and the shear force, in N.
    #[must_use]
    pub(crate) fn elastic_n(
        &self,
        joint: &ElasticJoint,
        places: [&Place<Lanes<1>>; 2],
        memory: &Memory<Lanes<1>>,
        fibres: &mut [Fibre<Lanes<1>>],
    ) -> ([f64; 2], f64) {
        let (_, pressing, rubbing) = self.act(joint, places, None, &mut memory.clone(), fibres);
        (pressing.edges_n.map(|edge| edge.0[0]), rubbing.shear_n.0[0])
    }

    /// Elastic energy of a joint, in J.
    #[inline(always)]
    pub fn energy_j<R: Real>(
        &self,
        joint: &ElasticJoint,
        memory: &Memory<R>,
        fibres: &[Fibre<R>],
    ) -> R {
        let pressing = self.law.section.energy(memory.penetrations_m, fibres);
        pressing * joint.normal_n_m + memory.shear_n * memory.shear_n * (0.5 / joint.shear_n_m)
    }

    /// A bound of the highest angular frequency, in rad/s, with any joints closed.
    ///
    /// Every joint is given a part of the mass of its bodies, in proportion to its stiffness. By Rayleigh's quotient the highest
    /// frequency of a joint with its part is then not below that of the whole (Irons and Treharne, "A bound theorem in eigenvalues and
    /// its practical applications", 1971). Joints that are partly open are softer than closed ones.
    #[must_use]
    pub(crate) fn frequency_bound_rad_s(&self) -> f64 {
        let mut held_n_m = vec![0.0; self.bodies.len()];
        for joint in &self.joints {
            for body in joint.link.bodies {
                if let Some(held) = held_n_m.get_mut(body) {
                    *held += joint.normal_n_m;
                }
            }
        }
        let squares = self.joints.iter().map(|joint| {
            let mut flexibility = Matrix3::zeros();
            let link = &joint.link;
            let along = Vector2::from(link.along);
            let normal = Vector2::new(-along.y, along.x) * link.handedness;
            for (body, arm_m) in link.bodies.into_iter().zip(link.arms_m) {
                let Some(of_body) = self.bodies.get(body) else {
                    continue;
                };
                let part = joint.normal_n_m / held_n_m[body];
                let arm = Vector2::from(arm_m);
                // Gap, slip and angle due to the motion of the body; signs drop out when squared.
                let by_x = Vector3::new(normal.x, along.x, 0.0);
                let by_y = Vector3::new(normal.y, along.y, 0.0);
                let by_turn = Vector3::new(arm.perp(&normal), arm.perp(&along), 1.0);
                let mass = part * of_body.mass_kg;
                flexibility += (by_x * by_x.transpose() + by_y * by_y.transpose()) / mass;
                flexibility += by_turn * by_turn.transpose() / (part * of_body.inertia_kg_m2);
            }
            let turning = self.law.section.second_moment() * link.length_m.powi(2);
            let (normal, shear) = (joint.normal_n_m, joint.shear_n_m);
            let roots = Vector3::new(normal.sqrt(), shear.sqrt(), (normal * turning).sqrt());
            let scaled = flexibility.component_mul(&(roots * roots.transpose()));
            scaled.symmetric_eigenvalues().max()
        });
        // That of a sum is at most the sum of those of its parts.
        (squares.fold(0.0, f64::max) + self.ties_square_frequency).sqrt()
    }

    /// The longest step, in s, for which central differences are stable, with damping that lags by half a step.
    ///
    /// With frequency `w` and `z = beta w/2` that is `2/w (sqrt(1 + z^2) - z)`, by Jury's criterion; it falls with `w`.
    #[must_use]
    pub fn stable_step_s(&self) -> f64 {
        let frequency = self.frequency_bound_rad_s();
        let z = 0.5 * self.damping_time_s * frequency;
        // The difference, written without cancellation.
        2.0 / frequency / (1.0_f64.hypot(z) + z)
    }
}

/// Stiffness of mortar and of a length of stone, in series.
fn in_series(materials: &Materials, length_m: f64) -> JointStiffness {
    let mortar = materials.mortar;
    let mortar = mortar.map_or(0.0, |[modulus, thickness]| thickness / modulus);
    let normal_pa_m = 1.0 / (mortar + length_m / materials.stone_modulus_pa);
    JointStiffness {
        normal_pa_m,
        shear_pa_m: materials.shear_ratio * normal_pa_m,
    }
}
