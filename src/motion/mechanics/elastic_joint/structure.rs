//! Rigid bodies and the elastic joints between them.

use std::ops::RangeInclusive;

use nalgebra::{Matrix3, Vector2, Vector3};

use super::contact::{
    Contact, ContactLaw, ContactSection, ElasticJoint, Fibre, Memory, NormalForces, ShearForce,
};
use super::kinematics::{Action, BodyPosition, JointGeometry};
use super::tie::BoundTie;
use crate::argument::{ArgumentError, require, require_within};
use crate::mechanics::tie::square_frequency;
use crate::mechanics::{Block, Joint, Lanes, Real, Row, Supports, Sway};

/// Stiffness of an interface per area, in Pa/m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointStiffness {
    /// Normal stiffness, against penetration.
    pub normal_pa_m: f64,
    /// Shear stiffness, against slip.
    pub shear_pa_m: f64,
}

/// Materials that determine the stiffness of joints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Materials {
    /// Young's modulus of the blocks, in Pa.
    pub stone_modulus_pa: f64,
    /// Young's modulus of the mortar in Pa, and its thickness in m; `None` for dry joints.
    pub mortar: Option<[f64; 2]>,
    /// Ratio of shear stiffness to normal stiffness.
    pub shear_ratio: f64,
}

/// Stiffness of the joints of a structure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stiffness {
    /// One stiffness for all joints.
    Uniform(JointStiffness),
    /// Stone and mortar in series: `1/kn = t_m/E_m + L/E_s`. `L` is the distance between the centres of the two blocks across the joint; at a
    /// support, between the centre of the block and the joint.
    Materials(Materials),
}

/// Properties of elastic joints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElasticProperties {
    /// Stiffness of the joints.
    pub stiffness: Stiffness,
    /// Width of the structure out of its plane, in m.
    pub depth_m: f64,
    /// Coulomb's coefficient of friction; `None` prevents permanent slip.
    pub friction_coefficient: Option<f64>,
    /// Damping time in s: a damping force is this time multiplied by the rate of the elastic force.
    pub damping_time_s: f64,
    /// Compressive strength of the joints in Pa; `None` prevents crushing.
    pub compressive_strength_pa: Option<f64>,
    /// Method to integrate the stress.
    pub contact: Contact,
}

impl ElasticProperties {
    /// Range of normal stiffness, in Pa/m. Stiffer joints need too many explicit steps and behave as rigid ones; with softer joints no structure is
    /// stable.
    pub const NORMAL_STIFFNESS_PA_M: RangeInclusive<f64> = 1e6..=1e14;
    /// Range of the ratio of shear stiffness to normal stiffness.
    pub(crate) const SHEAR_RATIO: RangeInclusive<f64> = 1e-2..=1e2;
    /// Range of Young's moduli in Pa, from soft rubber to beyond diamond.
    pub const MODULUS_PA: RangeInclusive<f64> = 1e5..=1e13;
    /// Range of the thickness of mortar, in m.
    pub const MORTAR_M: RangeInclusive<f64> = 0.0..=1.0;
    /// Range of friction coefficients; stone joints have 0.5 to 0.8.
    pub const FRICTION_COEFFICIENT: RangeInclusive<f64> = 1e-3..=1e3;
    /// Range of damping times in s; 0.05 s is that of a very viscous base.
    pub const DAMPING_TIME_S: RangeInclusive<f64> = 0.0..=1.0;
    /// Range of compressive strengths, in Pa.
    pub const STRENGTH_PA: RangeInclusive<f64> = 1e3..=1e12;
    /// Range of the number of contact points; a single point does not support a block.
    pub const CONTACT_POINTS: RangeInclusive<usize> = 2..=100;

    /// Joints with this normal stiffness and default properties: shear stiffness 0.4 of it (shear modulus over Young's modulus), friction
    /// coefficient 0.7, damping time 0.1 ms, continuous contact, no crushing, depth 1 m.
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

    /// An error if a property is out of range. The stiffness is checked for each joint later.
    fn check(&self) -> Result<(), ArgumentError> {
        if let Stiffness::Materials(materials) = self.stiffness {
            let modulus_pa = materials.stone_modulus_pa;
            require_within("stone_modulus_pa", modulus_pa, Self::MODULUS_PA)?;
            if let Some([modulus_pa, thickness_m]) = materials.mortar {
                require_within("mortar_modulus_pa", modulus_pa, Self::MODULUS_PA)?;
                require_within("mortar_thickness_m", thickness_m, Self::MORTAR_M)?;
            }
            require_within("shear_ratio", materials.shear_ratio, Self::SHEAR_RATIO)?;
        }
        require_within("depth_m", self.depth_m, 1e-6..=1e6)?;
        if let Some(coefficient) = self.friction_coefficient {
            let range = Self::FRICTION_COEFFICIENT;
            require_within("friction_coefficient", coefficient, range)?;
        }
        require_within("damping_time_s", self.damping_time_s, Self::DAMPING_TIME_S)?;
        if let Some(strength_pa) = self.compressive_strength_pa {
            require_within("compressive_strength_pa", strength_pa, Self::STRENGTH_PA)?;
        }
        if let Contact::Points(count) = self.contact {
            let is_allowed = Self::CONTACT_POINTS.contains(&count);
            let allowed = "2 to 100: one point does not hold a block";
            require(is_allowed, "contact_points", count as f64, allowed)?;
        }
        Ok(())
    }

    /// These properties with all stiffnesses multiplied by a factor.
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

    /// Joint of this geometry, with a length of stone in metres between the centres of its bodies.
    fn joint(&self, geometry: JointGeometry, stone_m: f64) -> Result<ElasticJoint, ArgumentError> {
        let stiffness = match self.stiffness {
            Stiffness::Uniform(stiffness) => stiffness,
            Stiffness::Materials(materials) => in_series(&materials, stone_m),
        };
        check_stiffness(stiffness)?;
        let area_m2 = self.depth_m * geometry.length_m;
        let strength_pa = self.compressive_strength_pa;
        Ok(ElasticJoint {
            geometry,
            normal_n_m: stiffness.normal_pa_m * area_m2,
            shear_n_m: stiffness.shear_pa_m * area_m2,
            crushing_penetration_m: strength_pa
                .map_or(f64::INFINITY, |pa| pa / stiffness.normal_pa_m),
            area_m2,
        })
    }
}

fn check_stiffness(stiffness: JointStiffness) -> Result<(), ArgumentError> {
    let range = ElasticProperties::NORMAL_STIFFNESS_PA_M;
    let normal_pa_m = stiffness.normal_pa_m;
    require_within("normal_stiffness_pa_m", normal_pa_m, range)?;
    let shear_ratio = stiffness.shear_pa_m / normal_pa_m;
    require_within("shear_ratio", shear_ratio, ElasticProperties::SHEAR_RATIO).map(|_| ())
}

/// Rigid bodies with elastic joints between them. In a joint, the index after the last body is the left (or only) support; larger indices are the
/// right support.
#[derive(Clone, Debug, PartialEq)]
pub struct ElasticStructure {
    /// Rigid bodies.
    pub bodies: Vec<Block>,
    /// Displacements (m) and rotations (rad) of the supports.
    pub supports: [[f64; 3]; 2],
    /// Elastic joints; contacts with a wall behind a column are the last ones, between the support and the block.
    pub joints: Vec<ElasticJoint>,
    /// Side and height in metres of a wall behind a column.
    pub wall: Option<(Sway, f64)>,
    /// Number of contacts with the wall.
    wall_contacts: usize,
    /// Ties between bodies, or between a body and the ground.
    pub ties: Vec<BoundTie>,
    /// Upper bound of the contribution of ties to the square of the highest angular frequency, in rad2/s2.
    ties_square_frequency: f64,
    /// Contact law of all joints.
    pub(crate) law: ContactLaw,
    /// Damping time in s.
    pub damping_time_s: f64,
}

impl ElasticStructure {
    /// Structure of a row of blocks.
    ///
    /// # Errors
    /// If a property is out of range.
    pub fn of_row(row: &Row, properties: &ElasticProperties) -> Result<Self, ArgumentError> {
        properties.check()?;
        let blocks = &row.blocks;
        let ground = blocks.len();
        let joint = |(index, joint): (usize, &Joint)| {
            let right = if index < ground { index } else { ground + 1 };
            let pair = [index.checked_sub(1).unwrap_or(ground), right];
            let middle_m = joint.middle_m();
            let tangent = joint.direction();
            let centres = pair.map(|body| blocks.get(body).map(|block| block.centre_m));
            // The centre of a support is the middle of its joint.
            let arms_m = centres.map(|centre| middle_m - centre.unwrap_or(middle_m));
            let across_m = |centre: Option<Vector2<f64>>| {
                centre.map_or(0.0, |centre| tangent.perp(&(centre - middle_m)).abs())
            };
            let length_m = joint.thickness_m();
            let arms_m = arms_m.map(|arm| [arm.x, arm.y]);
            let tangent = [tangent.x, tangent.y];
            let geometry = JointGeometry::new(pair, arms_m, tangent, row.handedness, length_m);
            properties.joint(geometry, centres.map(across_m).iter().sum())
        };
        debug_assert!(row.supports == Supports::Both || row.joints.len() == ground);
        let joints: Result<_, ArgumentError> = row.joints.iter().enumerate().map(joint).collect();
        let feet_m = row.feet_m();
        let ties = row
            .ties
            .iter()
            .map(|tie| BoundTie::new(*tie, blocks, feet_m));
        Ok(Self {
            ties: ties.collect(),
            ties_square_frequency: square_frequency(&row.ties, blocks),
            ..Self::new(blocks.clone(), joints?, properties)
        })
    }

    /// This structure of a column with the wall behind it: its side, and its height in metres above the base; `None` without a wall. Each drum
    /// touches the wall with its face, without friction. The contact has the stiffness per area of a joint with half the width of the drum as stone.
    ///
    /// # Errors
    /// If the stiffness is out of range.
    pub fn with_wall(
        mut self,
        row: &Row,
        wall: Option<(Sway, f64)>,
        properties: &ElasticProperties,
    ) -> Result<Self, ArgumentError> {
        let Some((side, height_m)) = wall else {
            return Ok(self);
        };
        self.wall = wall;
        let foot_m = row.feet_m()[0];
        for (index, (block, base)) in row.blocks.iter().zip(&row.joints).enumerate() {
            let (bottom_m, width_m) = (base.middle_m().y, base.thickness_m());
            let corners = row.outlines_m[index].iter().map(|corner| corner.y);
            let top_m = corners.fold(bottom_m, f64::max).min(height_m);
            let length_m = top_m - bottom_m;
            if length_m <= 0.0 {
                break;
            }
            let middle_m = Vector2::new(0.5 * side.sign() * width_m, 0.5 * (bottom_m + top_m));
            let arms_m = [foot_m, block.centre_m].map(|centre_m| (middle_m - centre_m).into());
            let pair = [row.blocks.len(), index];
            let geometry = JointGeometry::new(pair, arms_m, [0.0, side.sign()], 1.0, length_m);
            let joint = properties.joint(geometry, 0.5 * width_m)?;
            self.joints.push(ElasticJoint {
                shear_n_m: 0.0,
                ..joint
            });
            self.wall_contacts += 1;
        }
        Ok(self)
    }

    /// Joints between the blocks, and between blocks and supports, without contacts with a wall.
    pub fn row_joints(&self) -> &[ElasticJoint] {
        &self.joints[..self.joints.len() - self.wall_contacts]
    }

    /// Structure of given bodies and joints, without ties.
    pub fn new(
        bodies: Vec<Block>,
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
            wall: None,
            wall_contacts: 0,
            ties: Vec::new(),
            ties_square_frequency: 0.0,
            law: ContactLaw {
                section: ContactSection::new(properties.contact, crushes),
                crushes,
                friction,
            },
            damping_time_s: properties.damping_time_s,
        }
    }

    /// This structure on supports with given displacements (m) and rotations (rad). In a row, supports rotate about the middle of the first
    /// and the last joint.
    #[must_use]
    pub const fn on_supports(mut self, moved: [[f64; 3]; 2]) -> Self {
        self.supports = moved;
        self
    }

    /// Displacements (m) and the rotation (rad) of the support with an index as in joints.
    pub fn support(&self, body: usize) -> &[f64; 3] {
        &self.supports[usize::from(body > self.bodies.len())]
    }

    /// Whether a support has moved.
    pub fn has_settled(&self) -> bool {
        self.supports != [[0.0; 3]; 2]
    }

    /// Displacement of the left support, in m, and this structure with both supports displaced by it, without rotation.
    pub(super) fn moved_along(&self) -> ([f64; 2], Self) {
        let [x, y, _] = self.supports[0];
        ([x, y], self.clone().on_supports([[x, y, 0.0]; 2]))
    }

    /// This structure with the supports at a fraction of their movement, which starts at the common displacement of [`Self::moved_along`].
    pub(super) fn at_movement_fraction(&self, part: f64) -> Self {
        let from = self.moved_along().1.supports;
        let between = |from: f64, to: f64| to - (1.0 - part) * (to - from);
        let on_way =
            |side: usize, axis: usize| between(from[side][axis], self.supports[side][axis]);
        (self.clone()).on_supports([0, 1].map(|side| [0, 1, 2].map(|axis| on_way(side, axis))))
    }

    /// Whether joints may slip permanently.
    pub const fn slips(&self) -> bool {
        self.law.friction[1] == 0.0
    }

    /// Mass of all bodies, in kg.
    pub fn mass_kg(&self) -> f64 {
        self.bodies.iter().map(|body| body.mass_kg).sum()
    }

    /// Number of positions along each joint with a state of crushing.
    pub fn fibres(&self) -> usize {
        self.law.section.fibres()
    }

    /// This structure with unlimited friction.
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
        other.law.section = ContactSection::Whole;
        other
    }

    /// This structure with all stiffnesses multiplied by a factor. The strength of the joints stays the same.
    pub(super) fn stiffness_times(&self, factor: f64) -> Self {
        let mut other = self.clone();
        for joint in &mut other.joints {
            joint.normal_n_m *= factor;
            joint.shear_n_m *= factor;
            joint.crushing_penetration_m /= factor;
        }
        for tie in &mut other.ties {
            tie.tie.stiffness_n_m *= factor;
        }
        other
    }

    /// Computes the forces of a joint for given positions of its bodies, and updates its state. `damping` is the damping time over the length of the
    /// step.
    #[inline(always)]
    pub fn act<R: Real>(
        &self,
        joint: &ElasticJoint,
        places: [&BodyPosition<R>; 2],
        damping: Option<R>,
        memory: &mut Memory<R>,
        fibres: &mut [Fibre<R>],
    ) -> (Action<R>, NormalForces<R>, ShearForce<R>) {
        let gap = joint.geometry.gap(places[0], places[1]);
        let normal = self.law.normal_forces(joint, damping, &gap, memory, fibres);
        let shear = self
            .law
            .shear_force(joint, damping, &gap, normal.edges_n, memory);
        let action = joint.geometry.action(&gap, normal.edges_n, shear.shear_n);
        (action, normal, shear)
    }

    /// Elastic forces of a joint at rest: the normal forces at its edges and the shear force, in N.
    pub(crate) fn elastic_n(
        &self,
        joint: &ElasticJoint,
        places: [&BodyPosition<Lanes<1>>; 2],
        memory: &Memory<Lanes<1>>,
        fibres: &mut [Fibre<Lanes<1>>],
    ) -> ([f64; 2], f64) {
        let (_, normal, shear) = self.act(joint, places, None, &mut memory.clone(), fibres);
        (normal.edges_n.map(|edge| edge.0[0]), shear.shear_n.0[0])
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
        let pressing_j = pressing * joint.normal_n_m;
        if joint.shear_n_m == 0.0 {
            return pressing_j;
        }
        pressing_j + memory.shear_n * memory.shear_n * (0.5 / joint.shear_n_m)
    }

    /// Upper bound of the highest angular frequency, in rad/s, for any set of closed joints.
    ///
    /// Each joint gets a part of the mass of its bodies, in proportion to its stiffness. By Rayleigh's quotient, the highest frequency of such a
    /// joint with its mass is not below the highest frequency of the structure (Irons and Treharne, "A bound theorem in eigenvalues and its practical
    /// applications", 1971). Partly open joints are softer than closed ones.
    pub(crate) fn frequency_bound_rad_s(&self) -> f64 {
        let mut held_n_m = vec![0.0; self.bodies.len()];
        for joint in &self.joints {
            for body in joint.geometry.bodies {
                if let Some(held) = held_n_m.get_mut(body) {
                    *held += joint.normal_n_m;
                }
            }
        }
        let squares = self.joints.iter().map(|joint| {
            let mut flexibility = Matrix3::zeros();
            let geometry = &joint.geometry;
            let tangent = Vector2::from(geometry.tangent);
            let normal = Vector2::new(-tangent.y, tangent.x) * geometry.handedness;
            for (body, arm_m) in geometry.bodies.into_iter().zip(geometry.arms_m) {
                let Some(of_body) = self.bodies.get(body) else {
                    continue;
                };
                let part = joint.normal_n_m / held_n_m[body];
                let arm = Vector2::from(arm_m);
                // Gap, slip and angle due to the motion of the body; signs cancel in the squares.
                let by_x = Vector3::new(normal.x, tangent.x, 0.0);
                let by_y = Vector3::new(normal.y, tangent.y, 0.0);
                let by_turn = Vector3::new(arm.perp(&normal), arm.perp(&tangent), 1.0);
                let mass = part * of_body.mass_kg;
                flexibility += (by_x * by_x.transpose() + by_y * by_y.transpose()) / mass;
                flexibility += by_turn * by_turn.transpose() / (part * of_body.inertia_kg_m2);
            }
            let turning = self.law.section.second_moment() * geometry.length_m.powi(2);
            let (normal, shear) = (joint.normal_n_m, joint.shear_n_m);
            let roots = Vector3::new(normal.sqrt(), shear.sqrt(), (normal * turning).sqrt());
            let scaled = flexibility.component_mul(&(roots * roots.transpose()));
            scaled.symmetric_eigenvalues().max()
        });
        // The largest eigenvalue of a sum is at most the sum of the largest eigenvalues.
        (squares.fold(0.0, f64::max) + self.ties_square_frequency).sqrt()
    }

    /// Longest step, in s, for which central differences are stable, with damping that lags by half a step.
    ///
    /// By Jury's criterion this is `2/w (sqrt(1 + z^2) - z)` for the frequency `w` and `z = beta w/2`, with the damping time `beta`; it decreases
    /// with `w`.
    pub fn stable_step_s(&self) -> f64 {
        let frequency = self.frequency_bound_rad_s();
        let z = 0.5 * self.damping_time_s * frequency;
        // Difference of square root and `z`, written without cancellation.
        2.0 / frequency / (libm::hypot(1.0, z) + z)
    }
}

/// Stiffness of mortar and a length of stone in series.
fn in_series(materials: &Materials, length_m: f64) -> JointStiffness {
    let mortar = materials
        .mortar
        .map_or(0.0, |[modulus, thickness]| thickness / modulus);
    let normal_pa_m = 1.0 / (mortar + length_m / materials.stone_modulus_pa);
    JointStiffness {
        normal_pa_m,
        shear_pa_m: materials.shear_ratio * normal_pa_m,
    }
}
