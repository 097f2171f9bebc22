//! The open joints of a row of blocks over time, as a panel of `history.svg`.

use crate::dynamics::history::Sample;
use crate::mechanics::blocks::{Row, Supports};
use crate::mechanics::chain::Hinge;
use crate::mechanics::geometry::ring::Edge;
use crate::output::Figure;
use crate::output::axes::Scale;
use crate::output::chart::{Mark, Shape};
use crate::output::panels::Panels;
use crate::output::sheet::{Key, Sign};
use crate::output::svg::{Stroke, color};

/// Height of the strip of a joint below which it is not divided by edges.
const NARROW_PX: f64 = 5.0;
/// Number of columns in the panel of joints: about one per pixel.
const JOINT_COLUMNS: usize = 800;

/// The ways in which a joint can be open: name and colour of their marks, and the lower and upper ends of these in the strip of the joint.
const KINDS: [(&str, &str, [f64; 2]); 3] = [
    ("intrados", color::BLUE, [-0.42, 0.0]),
    ("extrados", color::VERMILION, [0.0, 0.42]),
    ("parted", color::BLACK, [-0.42, 0.42]),
];

/// The open joints over time, thinned to columns. A column has all ways in which a joint is open in any of its samples.
#[derive(Clone, Debug)]
pub(super) struct OpenJoints {
    count: usize,
    /// Names of the hinges at the two edges.
    edges: [&'static str; 2],
    /// Number of samples in a column, and in the last one.
    group: usize,
    in_last: usize,
    /// The time at which each column begins.
    starts_s: Vec<f64>,
    /// A bit for each of [`KINDS`], column by column.
    bits: Vec<u8>,
}

impl OpenJoints {
    pub(super) fn new(row: &Row) -> Self {
        let edges = match row.supports {
            Supports::Both => ["hinge at the intrados", "hinge at the extrados"],
            Supports::Left => ["hinge at the left edge", "hinge at the right edge"],
        };
        Self::of_joints(row.joints.len(), edges)
    }

    const fn of_joints(count: usize, edges: [&'static str; 2]) -> Self {
        Self {
            count,
            edges,
            group: 1,
            in_last: 0,
            starts_s: Vec::new(),
            bits: Vec::new(),
        }
    }

    /// Whether any joint is ever open in one of these ways.
    fn has(&self, kinds: u8) -> bool {
        self.bits.iter().any(|bits| bits & kinds != 0)
    }

    pub(super) fn push(&mut self, sample: &Sample) {
        if self.in_last == self.group || self.starts_s.is_empty() {
            if self.starts_s.len() == JOINT_COLUMNS {
                self.halve();
            }
            self.starts_s.push(sample.time_s);
            self.bits.resize(self.starts_s.len() * self.count, 0);
            self.in_last = 0;
        }
        self.in_last += 1;
        let first = (self.starts_s.len() - 1) * self.count;
        for open in &sample.hinges {
            if let Hinge::Joint { joint, edge } = open.hinge {
                self.bits[first + joint] |= match edge {
                    Some(Edge::Intrados) => 1,
                    Some(Edge::Extrados) => 2,
                    None => 4,
                };
            }
        }
    }

    /// Merges the columns in pairs.
    fn halve(&mut self) {
        self.group *= 2;
        self.starts_s = self.starts_s.iter().copied().step_by(2).collect();
        let pairs = self.bits.chunks(2 * self.count);
        self.bits = pairs
            .flat_map(|pair| {
                let (first, second) = pair.split_at(self.count);
                first.iter().zip(second).map(|(a, b)| a | b)
            })
            .collect();
    }

    /// Adds the panel of the joints; nothing if none is ever open.
    pub(super) fn add_to(&self, panels: &mut Panels, figure: Figure, end_s: f64) {
        if !self.has(u8::MAX) {
            return;
        }
        let height_px = (14.0 * self.count as f64).clamp(60.0, 260.0);
        let is_narrow = figure.height_px(height_px) < NARROW_PX * self.count as f64;
        let [intrados, extrados] = self.edges;
        let texts = [(1, intrados), (2, extrados), (4, "parted")];
        let mut marks = Vec::new();
        for ((bit, text), (name, fill, part)) in texts.into_iter().zip(KINDS) {
            // Divided strips this narrow would look pale.
            let part = if is_narrow { [-0.5, 0.5] } else { part };
            let boxes = (0..self.count).flat_map(|joint| {
                let [low, high] = part.map(|part| joint as f64 + part);
                let stretches = self.stretches(joint, bit, end_s).into_iter();
                stretches.map(move |[from_s, to_s]| [(from_s, high), (to_s, low)])
            });
            let boxes = Shape::Boxes(boxes.collect());
            marks.push(Mark::new(name, Stroke::new(fill, 0.0, ""), boxes));
            if self.has(bit) {
                panels.keys.push(Key::new(text, Sign::Band(fill, 1.0)));
            }
        }
        let ticks = u32::try_from(self.count.min(6)).unwrap_or(6);
        let y = Scale::exactly(-0.5, self.count as f64 - 0.5, ticks);
        panels.panel("Open joint", height_px, y, None, marks);
    }

    /// The times from which and to which a joint is open in this way.
    fn stretches(&self, joint: usize, bit: u8, end_s: f64) -> Vec<[f64; 2]> {
        let is_open = |column: &usize| self.bits[column * self.count + joint] & bit != 0;
        let mut columns = 0..self.starts_s.len();
        let mut stretches = Vec::new();
        while let Some(first) = columns.find(is_open) {
            let end = columns.find(|column| !is_open(column));
            let end_s = end.map_or(end_s, |end| self.starts_s[end]);
            stretches.push([self.starts_s[first], end_s]);
        }
        stretches
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::history::OpenHinge;
    use nalgebra::Vector2;

    /// A sample in which joint 1 of 3 is open at the intrados; if `parted`, joint 2 is open at both edges.
    fn sample(time_s: f64, parted: bool) -> Sample {
        let hinge = |joint, edge| OpenHinge {
            hinge: Hinge::Joint { joint, edge },
            position_m: Vector2::zeros(),
        };
        let mut hinges = vec![hinge(1, Some(Edge::Intrados))];
        if parted {
            hinges.push(hinge(2, None));
        }
        Sample {
            hinges,
            time_s,
            ..Sample::default()
        }
    }

    #[test]
    fn joints_are_thinned_to_few_columns_and_keep_what_was_open() {
        let mut joints = OpenJoints::of_joints(3, [""; 2]);
        for i in 0..10_001 {
            joints.push(&sample(f64::from(i), i == 7_777));
        }
        let columns = joints.starts_s.len();
        assert!((JOINT_COLUMNS / 2..=JOINT_COLUMNS).contains(&columns));
        assert_eq!(joints.bits.len(), 3 * columns);
        assert!(joints.starts_s.is_sorted());
        let of_joint = |joint: usize| joints.bits.iter().skip(joint).step_by(3).copied();
        assert!(of_joint(0).all(|bits| bits == 0));
        assert!(of_joint(1).all(|bits| bits == 1));
        let parted: Vec<_> = of_joint(2)
            .enumerate()
            .filter(|(_, bits)| *bits == 4)
            .collect();
        assert_eq!(parted.len(), 1);
        let start_s = joints.starts_s[parted[0].0];
        assert!((0.0..joints.group as f64).contains(&(7_777.0 - start_s)));
    }
}
