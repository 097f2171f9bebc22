//! Positions of the blocks of a row, from the gaps of its joints.
//!
//! A joint without slip or overlap has two coordinates, the gaps `g_I, g_E >= 0` at its corners. Let `s` be the handedness of the row and `t` the
//! thickness of the joint. The right face is rotated relative to the left one by `s delta`, `delta = (g_E - g_I)/t`. The smaller gap separates the
//! nearer corners along the normal of the joint in the mean direction of its faces. At a hinge this gap is zero, so the hinge is an exact pin at its
//! corner at any rotation. The larger gap is the arc `t |delta|`, not the chord.
//!
//! Positions are computed from left to right. In an arch, the blocks right of the last open joint are fixed to the right support, and the rotation of
//! that joint closes the row. The remaining gap between its two faces, due to rounding errors, is the [`Placement::closure_error`]. Supports are in
//! their original or a moved position.

use nalgebra::{Vector2, Vector3};

use crate::mechanics::geometry::field::quarter_turn;
use crate::mechanics::geometry::pose::{product, unit};
use crate::mechanics::{Edge, Joint, Pose, Row, Supports, Twist};

/// Gap, over the thickness, below which a corner of a joint counts as closed.
pub const SHUT_RATIO: f64 = 1e-12;

/// Contact line of a joint in its current position.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Frame {
    /// Intrados corner of the line. It is midway between the intrados corners of the two faces if these are the nearer ones; otherwise it is one
    /// thickness along the joint from the midpoint of the extrados corners.
    pub intrados_m: Vector2<f64>,
    /// Unit vector to the extrados.
    pub tangent: Vector2<f64>,
    /// Unit normal towards the right block.
    pub normal: Vector2<f64>,
    /// Thickness in metres.
    pub thickness_m: f64,
}

impl Frame {
    /// Corner on an edge, in metres.
    pub fn corner_m(&self, edge: Edge) -> Vector2<f64> {
        match edge {
            Edge::Intrados => self.intrados_m,
            Edge::Extrados => self.intrados_m + self.tangent * self.thickness_m,
        }
    }
}

/// Constants of a joint, computed once.
#[derive(Clone, Copy, Debug)]
struct Face {
    joint: Joint,
    middle: Vector2<f64>,
    tangent: Vector2<f64>,
    thickness: f64,
}

/// Positions of all blocks and joints of a row.
#[derive(Clone, Debug)]
pub struct Placement {
    faces: Vec<Face>,
    undeformed_m: Vec<Vector2<f64>>,
    handedness: f64,
    supports: Supports,
    /// Poses of the left and the right support.
    pub support_poses: [Pose; 2],
    /// Gaps of every joint at intrados and extrados, in metres.
    pub gaps_m: Vec<[f64; 2]>,
    /// Poses of the blocks.
    pub poses: Vec<Pose>,
    /// Centres of gravity of the blocks, in metres.
    pub centres_m: Vec<Vector2<f64>>,
    /// Contact lines of the joints.
    pub frames: Vec<Frame>,
    /// Closure error at the last open joint of an arch; `None` for stacks, and if all joints are closed.
    pub closure: Option<Closure>,
}

/// Closure error between the two parts of an arch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closure {
    /// Index of the last open joint.
    pub joint: usize,
    /// Vector from the end of the left part to the start of the right part, in metres.
    pub error_m: Vector2<f64>,
}

impl Placement {
    /// Placement of the undeformed row.
    pub fn new(row: &Row) -> Self {
        let faces: Vec<Face> = row
            .joints
            .iter()
            .map(|joint| Face {
                joint: *joint,
                middle: joint.middle_m(),
                tangent: joint.direction(),
                thickness: joint.thickness_m(),
            })
            .collect();
        let undeformed_m: Vec<_> = row.blocks.iter().map(|block| block.centre_m).collect();
        let mut placement = Self {
            handedness: row.handedness,
            supports: row.supports,
            support_poses: [Pose::UNDEFORMED; 2],
            gaps_m: vec![[0.0; 2]; faces.len()],
            poses: vec![Pose::UNDEFORMED; undeformed_m.len()],
            centres_m: undeformed_m.clone(),
            frames: vec![Frame::default(); faces.len()],
            closure: None,
            faces,
            undeformed_m,
        };
        placement.update_positions();
        placement
    }

    /// Sets the poses of the supports without changing the gaps. The next [`Placement::change_gaps`] or [`Placement::turn`] places the blocks between them.
    pub const fn move_supports(&mut self, poses: [Pose; 2]) {
        self.support_poses = poses;
    }

    /// Length of the closure error in metres.
    pub fn closure_error(&self) -> f64 {
        self.closure.map_or(0.0, |closure| closure.error_m.norm())
    }

    /// Whether both corners of a joint are in contact.
    pub(crate) fn is_shut(&self, joint: usize) -> bool {
        self.gaps_m[joint] == [0.0; 2]
    }

    /// First joint that is open at both edges.
    pub(crate) fn parted_joint(&self) -> Option<usize> {
        let mut gaps_m = self.gaps_m.iter();
        gaps_m.position(|gaps| gaps.iter().all(|gap| *gap > 0.0))
    }

    /// Number of open corners.
    pub(crate) fn open_corners(&self) -> usize {
        let corners = self.gaps_m.iter().flatten();
        corners.filter(|gap| **gap > 0.0).count()
    }

    /// Largest gap over the thickness of its joint.
    pub(crate) fn largest_gap_ratio(&self) -> f64 {
        let corners = self.gaps_m.iter().zip(&self.faces);
        let ratios = corners.flat_map(|(gaps, face)| gaps.map(|gap| gap / face.thickness));
        ratios.fold(0.0, f64::max)
    }

    /// Closes the corners with gaps below this fraction of the thickness, and updates the positions. Returns false if there are none.
    pub(crate) fn shut_below(&mut self, ratio: f64) -> bool {
        let mut found = false;
        for (gaps, face) in self.gaps_m.iter_mut().zip(&self.faces) {
            for gap in gaps.iter_mut().filter(|gap| **gap > 0.0) {
                if *gap < ratio * face.thickness {
                    *gap = 0.0;
                    found = true;
                }
            }
        }
        if found {
            self.update_positions();
        }
        found
    }

    /// Copies the positions of another placement of the same row.
    pub fn copy_from(&mut self, other: &Self) {
        self.gaps_m.copy_from_slice(&other.gaps_m);
        self.poses.copy_from_slice(&other.poses);
        self.centres_m.copy_from_slice(&other.centres_m);
        self.frames.copy_from_slice(&other.frames);
        self.support_poses = other.support_poses;
        self.closure = other.closure;
    }

    /// Sets the gaps of hinges for given rotations of the blocks in radians. Every joint stays closed at one corner.
    pub fn turn(&mut self, rotations_rad: &[f64]) {
        let [first, last] = self.support_poses.map(|pose| pose.rotation_rad());
        for joint in 0..self.faces.len() {
            let at = |block: usize| rotations_rad.get(block).copied();
            let left = joint.checked_sub(1).and_then(at).unwrap_or(first);
            let opening = self.handedness * (at(joint).unwrap_or(last) - left);
            self.gaps_m[joint] = hinge_gaps_m(opening * self.faces[joint].thickness, 0.0);
        }
        self.update_positions();
    }

    /// Edge about which a joint turns when it opens at this rate, in rad/s: the edge in contact, or in a closed joint the edge that stays
    /// in contact.
    fn pivot(&self, joint: usize, opening_rad_s: f64) -> Edge {
        let [intrados, extrados] = self.gaps_m[joint];
        let open = match intrados == extrados {
            true => opening_rad_s,
            false => extrados - intrados,
        };
        match open > 0.0 {
            true => Edge::Intrados,
            false => Edge::Extrados,
        }
    }

    /// Motions of the blocks for given rotation rates in rad/s, and the edge about which each joint turns; `None` for joints that do not
    /// turn.
    pub fn motions(&self, rates_rad_s: &[f64]) -> (Vec<Twist>, Vec<Option<Edge>>) {
        let mut motions = Vec::with_capacity(self.poses.len());
        let mut left = Twist::ZERO;
        let pivot = |joint: usize| {
            let rate_rad_s = rates_rad_s.get(joint).unwrap_or(&0.0) - left.rate;
            let edge = self.pivot(joint, self.handedness * rate_rad_s);
            if joint < self.poses.len() {
                let corner_m = self.frames[joint].corner_m(edge);
                left = left + Twist::rotation(corner_m, rate_rad_s);
                motions.push(left);
            }
            (rate_rad_s != 0.0).then_some(edge)
        };
        let pivots = (0..self.faces.len()).map(pivot).collect();
        (motions, pivots)
    }

    /// Velocities of the centres, in m/s, and the rotation rates of the blocks for given rotation rates in rad/s.
    pub fn velocities(&self, rates_rad_s: &[f64]) -> Vec<Vector3<f64>> {
        let (motions, _) = self.motions(rates_rad_s);
        let moving = motions.iter().zip(&self.centres_m);
        let velocities =
            moving.map(|(motion, centre_m)| motion.velocity_at(*centre_m).push(motion.rate));
        velocities.collect()
    }

    /// Adds changes to the gaps, closes those below [`SHUT_RATIO`], and updates the positions.
    pub fn change_gaps(&mut self, change_m: impl Fn(usize) -> [f64; 2]) {
        for joint in 0..self.faces.len() {
            for (gap, change) in self.gaps_m[joint].iter_mut().zip(change_m(joint)) {
                *gap = closed_gap(*gap + change, &self.faces[joint]);
            }
        }
        self.update_positions();
    }

    /// Computes the positions from the gaps, from left to right.
    fn update_positions(&mut self) {
        let last_open = match self.supports {
            Supports::Left => None,
            Supports::Both => self.gaps_m.iter().rposition(|gaps| *gaps != [0.0; 2]),
        };
        self.closure = None;
        let [mut left, last] = self.support_poses;
        for joint in 0..self.faces.len() {
            let face = &self.faces[joint];
            let closing = last_open == Some(joint);
            let right = if closing {
                // The rotation of the closing joint follows from the rotation of the right support.
                let opening = self.handedness * (last.rotation_rad() - left.rotation_rad());
                let [intrados, extrados] = self.gaps_m[joint];
                let gaps = hinge_gaps_m(opening * face.thickness, intrados.min(extrados));
                self.gaps_m[joint] = gaps.map(|gap| closed_gap(gap, face));
                last
            } else if self.gaps_m[joint] == [0.0; 2] {
                left
            } else {
                let opening = (self.gaps_m[joint][1] - self.gaps_m[joint][0]) / face.thickness;
                let rotation_rad = left.rotation_rad() + self.handedness * opening;
                Pose::new(rotation_rad, Vector2::zeros())
            };
            let right = self.frame(joint, &left, right, closing);
            if let Some(pose) = self.poses.get_mut(joint) {
                *pose = right;
                self.centres_m[joint] = right.current_position(self.undeformed_m[joint]);
            }
            left = right;
        }
    }

    /// Computes the contact line of a joint, and completes the pose of its right block, whose rotation is given.
    fn frame(&mut self, joint: usize, left: &Pose, mut right: Pose, closing: bool) -> Pose {
        let face = &self.faces[joint];
        let s = self.handedness;
        let gaps = self.gaps_m[joint];
        if gaps == [0.0; 2] {
            let tangent = left.current_direction(face.tangent);
            self.frames[joint] = Frame {
                intrados_m: left.current_position(face.joint.intrados_m),
                tangent,
                normal: quarter_turn(tangent) * s,
                thickness_m: face.thickness,
            };
            return right;
        }
        let opening = (gaps[1] - gaps[0]) / face.thickness;
        let tangent = product(unit(left.rotation_rad() + 0.5 * s * opening), face.tangent);
        let normal = quarter_turn(tangent) * s;
        let chord = face.thickness * libm::sin(0.5 * opening.abs());
        let nearer = gaps[0].min(gaps[1]);
        let start = left.current_position(face.middle) + normal * (nearer + chord);
        if closing {
            let mut error_m = right.current_position(face.middle) - start;
            // In a joint that is open at both corners, a change of the gaps removes the normal part of the error.
            if nearer > 0.0 {
                let change = normal.dot(&error_m).max(-nearer);
                self.gaps_m[joint] = gaps.map(|gap| gap + change);
                error_m -= normal * change;
            }
            self.closure = Some(Closure { joint, error_m });
        } else {
            right.translation = start - right.current_direction(face.middle);
        }
        let gaps = self.gaps_m[joint];
        let (edge, offset) = match gaps[0] <= gaps[1] {
            true => (Edge::Intrados, 0.0),
            false => (Edge::Extrados, face.thickness),
        };
        let corner = left.current_position(face.joint.corner_m(edge));
        let nearer_corner = corner + normal * (0.5 * gaps[0].min(gaps[1]));
        self.frames[joint] = Frame {
            intrados_m: nearer_corner - tangent * offset,
            tangent,
            normal,
            thickness_m: face.thickness,
        };
        right
    }
}

/// Gaps of a joint that is open by `width_m` at the extrados (if negative, at the intrados), with an additional gap `nearer_m` at both
/// corners.
fn hinge_gaps_m(width_m: f64, nearer_m: f64) -> [f64; 2] {
    [nearer_m + (-width_m).max(0.0), nearer_m + width_m.max(0.0)]
}

/// Gap, or zero if it is below [`SHUT_RATIO`].
fn closed_gap(gap: f64, face: &Face) -> f64 {
    let least = SHUT_RATIO * face.thickness;
    if gap < least { 0.0 } else { gap }
}
