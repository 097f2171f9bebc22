//! The profile of a row of blocks, whose hinges sit at its joints.

use std::sync::Arc;

use crate::mechanics::{Edge, Joint, MassMoments, Profile, Row, Supports};
use nalgebra::Vector2;

/// A row of blocks between two supports, whose sections are its joints. Its units are its size and its whole mass.
#[derive(Clone, Debug, PartialEq)]
pub struct JointedProfile {
    joints: Vec<Joint>,
    /// Moments before every joint.
    moments: Vec<MassMoments>,
    /// Outlines of every block; shared, because every linkage keeps its profile.
    outlines: Arc<[Vec<Vector2<f64>>]>,
}

impl JointedProfile {
    /// Profile of a row; `None` for a stack, which has no right support.
    pub fn new(row: &Row) -> Option<Self> {
        if row.supports == Supports::Left {
            return None;
        }
        let (per_m, per_kg) = (row.size_m.recip(), row.mass_kg().recip());
        let mut before = MassMoments::default();
        let mut moments = vec![before];
        for block in &row.blocks {
            let mut own = block.moments_at(block.centre_m);
            own.mass *= per_kg;
            own.first *= per_kg * per_m;
            own.polar *= per_kg * per_m * per_m;
            before = before + own;
            moments.push(before);
        }
        let joints = row.joints.iter().map(|joint| Joint {
            intrados_m: joint.intrados_m * per_m,
            extrados_m: joint.extrados_m * per_m,
        });
        let outlines = row
            .outlines_m
            .iter()
            .map(|outline| outline.iter().map(|corner| corner * per_m).collect());
        Some(Self {
            joints: joints.collect(),
            moments,
            outlines: outlines.collect(),
        })
    }

    /// Joint at a section.
    fn index(&self, section: f64) -> usize {
        (section.round().max(0.0) as usize).min(self.joints.len() - 1)
    }

    fn joint_at(&self, section: f64) -> &Joint {
        &self.joints[self.index(section)]
    }
}

impl Profile for JointedProfile {
    fn end(&self) -> f64 {
        (self.joints.len() - 1) as f64
    }

    fn point(&self, section: f64, edge: Edge) -> Vector2<f64> {
        self.joint_at(section).corner_m(edge)
    }

    fn outward_direction(&self, section: f64) -> Vector2<f64> {
        self.joint_at(section).direction()
    }

    fn thickness(&self, section: f64) -> f64 {
        self.joint_at(section).thickness_m()
    }

    fn moments_to(&self, section: f64) -> MassMoments {
        self.moments[self.index(section)]
    }

    fn sections(&self, _: usize) -> Vec<f64> {
        (0..self.joints.len()).map(|joint| joint as f64).collect()
    }

    fn joint(&self, section: f64) -> Option<usize> {
        Some(self.index(section))
    }

    fn outlines(&self, from: f64, to: f64) -> Option<&[Vec<Vector2<f64>>]> {
        self.outlines.get(self.index(from)..self.index(to))
    }

    fn to_shared(&self) -> Arc<dyn Profile> {
        Arc::new(self.clone())
    }
}
