//! Largest kinetic energy after an impact: projection onto all admissible fields.
//!
//! The paper selects the mechanism after an impact among those with four hinges; a motion with more hinges may keep more energy. Let `K` be the
//! velocity fields that open joints of the ring and never close them, without sliding: any number of opening rotations about the edge points of
//! joints. `K` is a convex cone. The velocity `w` of the closing mechanism has a unique nearest field `P w` in `K`, the motion after the perfectly
//! inelastic impact of Moreau. No four-link mechanism with hinges at these joints exceeds its restitution `r = <Pw, Pw> / <w, w>`.
//!
//! For a ring cut into rigid voussoirs, the projection is a convex quadratic program. Its multipliers are the impulses at the edges of the joints.
//! Compression at both edges means that the resultant passes inside the ring. The optimality conditions are therefore the theorem of the paper in its
//! exact form: a motion is the projection if and only if its impulse line is admissible (Moreau's decomposition of `w` into polar parts).

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, SolverStatus};
use nalgebra::Vector2;
use thiserror::Error;

use super::mechanism::{FourLink, HingeSites};
use super::resultant::SectionResultant;
use crate::mechanics::{Edge, Field, Profile, Twist, cone_program};

/// Default number of equal parts for the projection of a continuous ring. The error of `r` decreases with the square of this number; here it is about
/// 1e-6, by test.
pub const DEFAULT_JOINTS: usize = 720;

/// The field nearest to the closing velocity, over all admissible fields.
#[derive(Clone, Debug)]
pub struct Projection {
    /// Restitution coefficient: kinetic energy after over before.
    pub restitution: f64,
    /// Rates and impulses of each joint, from the left springing to the right one.
    pub joints: Vec<Joint>,
}

impl Projection {
    /// Joints that open: index, edge about which the joint opens, and rotation rate. Rotations below 0.1 % of the largest one are
    /// omitted.
    ///
    /// In a continuous ring whole zones open, where the impulse line follows an edge.
    pub fn opening_joints(&self) -> impl Iterator<Item = (usize, Edge, f64)> {
        let rates = self.joints.iter().flat_map(|joint| joint.opening_rates);
        let threshold = MIN_OPENING * rates.fold(MIN_OPENING, f64::max);
        let joints = self.joints.iter().enumerate();
        joints.flat_map(move |(index, joint)| {
            let rates = [Edge::Intrados, Edge::Extrados]
                .into_iter()
                .zip(joint.opening_rates);
            let opening = rates.filter(move |(_, rate)| *rate > threshold);
            opening.map(move |(edge, rate)| (index, edge, rate))
        })
    }
}

/// Rotation of a joint, over the largest rotation or the rate of the closing mechanism, below which the joint counts as closed. The solver leaves
/// such errors at the ends of zones, where both opening and impulse are zero.
const MIN_OPENING: f64 = 1e-3;

/// A joint at the impact; rates and impulses are per unit rate of the closing mechanism.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint {
    /// Section, in radians from the left springing.
    pub angle_rad: f64,
    /// Opening rotation rates about the intrados point and the extrados point, not negative.
    pub opening_rates: [f64; 2],
    /// Impulse of the part before on the part after.
    pub impulse: SectionResultant,
}

/// Reason why the projection was not computed: the solver did not converge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error(
    "the motion of largest restitution was not found with {joints} joints ({reason}): try another number of joints"
)]
pub struct ProjectionError {
    joints: usize,
    reason: SolverStatus,
}

/// Joints at which the projection may open the ring: those of the voussoirs, or the springings and the sections between `count` equal
/// parts.
///
/// In a continuous ring the hinges of `mechanism`, if given, replace the joints nearest to them. The cone then contains this mechanism, and bounds
/// its restitution coefficient from above for any number of joints.
pub fn joints_rad(
    profile: &dyn Profile,
    sites: HingeSites,
    count: usize,
    mechanism: Option<&FourLink>,
) -> Vec<f64> {
    match sites {
        HingeSites::Voussoirs(voussoirs) => profile.sections(voussoirs),
        HingeSites::Anywhere => {
            let mut joints = profile.sections(count);
            let (spacing, end) = (joints[1], profile.end());
            let mut hinges: Vec<f64> = mechanism.map_or(Vec::new(), |m| m.hinges_rad.to_vec());
            // A hinge at a springing already has a joint; a body between the two would have no mass.
            hinges.retain(|hinge| *hinge > 1e-6 * spacing && end - hinge > 1e-6 * spacing);
            joints.retain(|joint| {
                let apart = |hinge: &f64| (hinge - joint).abs() > 0.5 * spacing;
                *joint == 0.0 || *joint == end || hinges.iter().all(apart)
            });
            joints.append(&mut hinges);
            joints.sort_by(f64::total_cmp);
            joints
        }
    }
}

/// Field nearest to `before` among those that open the given joints and never close them.
///
/// The variables are the motions of the bodies between the joints, in axes in which their kinetic energy is half a sum of squares. The solution is
/// the point of a polyhedral cone nearest to a given point. Each joint couples two neighbours only, so the effort is proportional to the number of
/// joints.
///
/// # Errors
/// If the solver does not reach its tolerance.
///
/// # Panics
/// If there are fewer than two joints.
pub fn project(
    before: &Field,
    profile: &dyn Profile,
    joints_rad: &[f64],
) -> Result<Projection, ProjectionError> {
    assert!(joints_rad.len() >= 2, "a body lies between two joints");
    let energy_before = before.product(before, profile);
    let scale = energy_before.sqrt();
    let parts = joints_rad.windows(2);
    let bodies: Vec<[Twist; 3]> = parts
        .map(|ends| orthonormal_twists(profile, ends[0], ends[1]))
        .collect();
    let target = components(before, profile, joints_rad, &bodies, scale);

    // Rows: no sliding at each joint, then for each joint the gap at the intrados and at the extrados.
    let count = joints_rad.len();
    let mut entries = Vec::new();
    for (joint, angle) in joints_rad.iter().enumerate() {
        let (outward, onward) = (
            profile.outward_direction(*angle),
            profile.onward_normal(*angle),
        );
        let middle = profile.middle(*angle);
        let edges = [Edge::Intrados, Edge::Extrados].map(|edge| profile.point(*angle, edge));
        let neighbours = [(joint.checked_sub(1), -1.0), (Some(joint), 1.0)];
        for (body, side) in neighbours {
            let Some((body, twists)) = body.and_then(|body| Some((body, bodies.get(body)?))) else {
                continue;
            };
            for (axis, twist) in twists.iter().enumerate() {
                let velocities = [
                    (joint, twist.velocity_at(middle).dot(&outward)),
                    (count + 2 * joint, -twist.velocity_at(edges[0]).dot(&onward)),
                    (
                        count + 2 * joint + 1,
                        -twist.velocity_at(edges[1]).dot(&onward),
                    ),
                ];
                let entry = |(row, velocity)| (row, 3 * body + axis, side * velocity);
                entries.extend(velocities.map(entry));
            }
        }
    }
    let width = target.len();
    let matrix = cone_program::matrix(3 * count, width, entries);
    let matrices = [&CscMatrix::identity(width), &matrix];
    let minus_target: Vec<f64> = target.iter().map(|component| -component).collect();
    let right = vec![0.0; 3 * count];
    let solution = cone_program::solve(matrices, &minus_target, &right, count, settings());
    let (joints, reason) = (count, solution.status);
    if !matches!(reason, SolverStatus::Solved | SolverStatus::AlmostSolved) {
        return Err(ProjectionError { joints, reason });
    }

    let joints = joints_rad.iter().enumerate().map(|(joint, angle)| {
        let edge_rows = [count + 2 * joint, count + 2 * joint + 1];
        // Turning about one edge opens the other.
        let [gap_intrados, gap_extrados] = edge_rows.map(|row| solution.s[row] * scale);
        let [intrados, extrados] = edge_rows.map(|row| solution.z[row] * scale);
        let normal = intrados + extrados;
        let thickness = profile.thickness(*angle);
        Joint {
            angle_rad: *angle,
            opening_rates: [gap_extrados, gap_intrados].map(|gap| gap / thickness),
            impulse: SectionResultant {
                normal,
                tangential: -solution.z[joint] * scale,
                moment: 0.5 * (extrados - intrados) * thickness,
                eccentricity_ratio: 0.5 * (extrados - intrados) / normal,
                thickness,
            },
        }
    });
    Ok(Projection {
        restitution: solution.x.iter().map(|part| part * part).sum(),
        joints: joints.collect(),
    })
}

/// Components of a field, divided by `scale`, along the motions of the bodies between the joints.
fn components(
    field: &Field,
    profile: &dyn Profile,
    joints_rad: &[f64],
    bodies: &[[Twist; 3]],
    scale: f64,
) -> Vec<f64> {
    let mut passed = field.momentum_to(profile, joints_rad[0]);
    let parts = bodies.iter().zip(&joints_rad[1..]);
    let components = parts.flat_map(|(twists, end)| {
        let reached = field.momentum_to(profile, *end);
        let momentum = reached - passed;
        passed = reached;
        twists.map(|twist| twist.power(&momentum) / scale)
    });
    components.collect()
}

/// Motions of the part between two sections, orthogonal to each other and each with a kinetic energy of one half: two translations and the
/// rotation about its centre of gravity.
fn orthonormal_twists(profile: &dyn Profile, from_rad: f64, to_rad: f64) -> [Twist; 3] {
    let moments = profile.sector(from_rad, to_rad);
    let shift = 1.0 / moments.mass.sqrt();
    [
        Twist::translation(Vector2::new(shift, 0.0)),
        Twist::translation(Vector2::new(0.0, shift)),
        Twist::rotation(moments.centroid(), 1.0 / moments.central_polar().sqrt()),
    ]
}

/// Tolerances: the unknown is of unit length, so that they are errors of `r`. With thousands of joints rounding may leave only the
/// reduced ones.
fn settings() -> DefaultSettings<f64> {
    DefaultSettings {
        tol_gap_abs: 1e-11,
        tol_gap_rel: 1e-11,
        tol_feas: 1e-10,
        reduced_tol_gap_abs: 1e-9,
        reduced_tol_gap_rel: 1e-9,
        reduced_tol_feas: 1e-8,
        ..DefaultSettings::default()
    }
}
