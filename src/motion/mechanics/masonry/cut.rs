//! Arch between its intrados and its extrados, cut into voussoirs.

use nalgebra::Vector2;

use super::Material;
use crate::mechanics::{Block, Curve, Joint};

/// Number of points to draw the curved side of a voussoir.
const DRAWN_POINTS: u32 = 4;

/// Point of an edge: index of the piece, and fraction of its parameter.
#[derive(Clone, Copy, Debug)]
pub(super) struct EdgePosition {
    pub piece: usize,
    pub part: f64,
}

/// Edges of an arch from left to right, and the points at which its joints cut them.
#[derive(Clone, Debug)]
pub(super) struct CutArch {
    pub intrados: Vec<Curve>,
    pub extrados: Vec<Curve>,
    /// Points of every joint on the intrados and on the extrados, springings included.
    pub joints: Vec<[EdgePosition; 2]>,
}

impl CutArch {
    /// Number of voussoirs.
    pub fn voussoirs(&self) -> usize {
        self.joints.len() - 1
    }

    /// Joints, springings included.
    pub fn joints(&self) -> Vec<Joint> {
        let point = |edge: &[Curve], place: EdgePosition| edge[place.piece].point(place.part);
        let joints = self.joints.iter().map(|[intrados, extrados]| Joint {
            intrados_m: point(&self.intrados, *intrados),
            extrados_m: point(&self.extrados, *extrados),
        });
        joints.collect()
    }

    /// Ends of the extrados, in metres to the right.
    pub fn ends_m(&self) -> [f64; 2] {
        let joints = self.joints();
        [joints[0], joints[joints.len() - 1]].map(|joint| joint.extrados_m.x)
    }

    /// Extrados of a voussoir from left to right.
    pub(crate) fn extrados_of(&self, voussoir: usize) -> Vec<Curve> {
        let ends = [self.joints[voussoir][1], self.joints[voussoir + 1][1]];
        pieces_between(&self.extrados, ends)
    }

    /// Height of the highest point of the extrados, at or between joints, in metres.
    pub fn crown_m(&self) -> f64 {
        let pieces = (0..self.voussoirs()).flat_map(|voussoir| self.extrados_of(voussoir));
        let tops = pieces.map(|piece| piece.point(top(&piece)).y);
        tops.fold(f64::NEG_INFINITY, f64::max)
    }

    fn outline(&self, voussoir: usize) -> Vec<Curve> {
        let ends = [self.joints[voussoir][0], self.joints[voussoir + 1][0]];
        let intrados = pieces_between(&self.intrados, ends);
        let extrados = self.extrados_of(voussoir);
        let line =
            |from: &Curve, to: &Curve, part: f64| Curve::line(from.point(part), to.point(part));
        let (inner, outer) = (&intrados, &extrados);
        let mut outline = vec![line(&inner[0], &outer[0], 0.0)];
        outline.extend(outer);
        outline.push(line(&outer[outer.len() - 1], &inner[inner.len() - 1], 1.0));
        outline.extend(inner.iter().rev().map(Curve::reversed));
        outline
    }

    /// Voussoirs as rigid blocks.
    pub fn blocks(&self, material: Material) -> Vec<Block> {
        let joints = self.joints();
        let block = |voussoir: usize| {
            let (outline, pole_m) = (self.outline(voussoir), joints[voussoir].middle_m());
            Block::bounded(outline, pole_m, material.depth_m, material.density_kg_m3)
        };
        (0..self.voussoirs()).map(block).collect()
    }

    /// Corners of polygons to draw the voussoirs.
    pub(crate) fn outlines_for_drawing(&self) -> Vec<Vec<Vector2<f64>>> {
        let drawn = |curve: &Curve| {
            let points = match curve {
                Curve::Line { .. } => 1,
                Curve::Arc { .. } | Curve::Ellipse { .. } => DRAWN_POINTS,
            };
            let point = |i: u32| curve.point(f64::from(i) / f64::from(points));
            (0..points).map(point).collect::<Vec<_>>()
        };
        let outlines = (0..self.voussoirs()).map(|voussoir| self.outline(voussoir));
        let corners = outlines.map(|outline| outline.iter().flat_map(drawn).collect());
        corners.collect()
    }
}

/// Parameter (0 to 1) of the highest point of a piece of an extrados: one of its ends, or where its slope is zero.
pub(super) fn top(piece: &Curve) -> f64 {
    let falls = |part: f64| piece.point_and_derivative(part).1.y <= 0.0;
    match (falls(0.0), falls(1.0)) {
        (true, _) => 0.0,
        (false, false) => 1.0,
        (false, true) => piece.first(falls),
    }
}

fn pieces_between(edge: &[Curve], [from, to]: [EdgePosition; 2]) -> Vec<Curve> {
    let pieces = (from.piece..=to.piece).filter_map(|piece| {
        let start = if piece == from.piece { from.part } else { 0.0 };
        let end = if piece == to.piece { to.part } else { 1.0 };
        (start < end).then(|| edge[piece].between(start, end))
    });
    pieces.collect()
}
