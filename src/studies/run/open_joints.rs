//! The open joints of a row of blocks over time, as a panel of `history.svg`.

use crate::mechanics::{Edge, Supports};
use crate::output::{Figure, Key, Mark, Panels, Scale, Shape, Sign, Stroke, Thinned, color};
use crate::{Hinge, Row, Sample};

/// Height of the strip of a joint below which the strip is not divided by edges.
const NARROW_PX: f64 = 5.0;
/// Number of columns in the panel of joints: about one per pixel.
const JOINT_COLUMNS: usize = 800;

/// States of an open joint: name and colour of the marks, and the lower and upper end of the marks in the strip of the joint.
const KINDS: [(&str, &str, [f64; 2]); 3] = [
    ("intrados", color::BLUE, [-0.42, 0.0]),
    ("extrados", color::VERMILION, [0.0, 0.42]),
    ("parted", color::BLACK, [-0.42, 0.42]),
];

/// The open joints over time, thinned to columns. A column has all open states of a joint in any of its samples.
#[derive(Clone, Debug)]
pub(super) struct OpenJoints {
    count: usize,
    /// Names of the hinges at the two edges.
    edges: [&'static str; 2],
    /// The time at which each column begins, and for each joint one bit for each of [`KINDS`].
    thinned: Thinned<(f64, Vec<u8>)>,
}

/// Adds the bits of a column to those of another column.
fn join_columns((_, bits): &mut (f64, Vec<u8>), (_, after): (f64, Vec<u8>)) {
    for (own, after) in bits.iter_mut().zip(after) {
        *own |= after;
    }
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
            thinned: Thinned::new(JOINT_COLUMNS),
        }
    }

    /// True if a joint is ever open in one of these ways.
    fn has_kinds(&self, kinds: u8) -> bool {
        let mut columns = self.thinned.columns.iter();
        columns.any(|(_, bits)| bits.iter().any(|bits| bits & kinds != 0))
    }

    pub(super) fn push(&mut self, sample: &Sample) {
        let mut bits = vec![0; self.count];
        for open in &sample.hinges {
            if let Hinge::Joint { joint, edge } = open.hinge {
                bits[joint] |= match edge {
                    Some(Edge::Intrados) => 1,
                    Some(Edge::Extrados) => 2,
                    None => 4,
                };
            }
        }
        let own = (sample.time_s, bits);
        match self.thinned.next(join_columns) {
            Some(column) => join_columns(column, own),
            None => self.thinned.columns.push(own),
        }
    }

    /// Adds the panel of the joints if a joint is ever open.
    pub(super) fn add_to(&self, panels: &mut Panels, figure: Figure, end_s: f64) {
        if !self.has_kinds(u8::MAX) {
            return;
        }
        let height_px = (14.0 * self.count as f64).clamp(60.0, 260.0);
        let is_narrow = figure.height_px(height_px) < NARROW_PX * self.count as f64;
        let [intrados, extrados] = self.edges;
        let texts = [(1, intrados), (2, extrados), (4, "parted")];
        let mut marks = Vec::new();
        for ((bit, text), (name, fill, part)) in texts.into_iter().zip(KINDS) {
            // Divided strips of this height would look pale.
            let part = if is_narrow { [-0.5, 0.5] } else { part };
            let boxes = (0..self.count).flat_map(|joint| {
                let [low, high] = part.map(|part| joint as f64 + part);
                let stretches = self.stretches(joint, bit, end_s).into_iter();
                stretches.map(move |[from_s, to_s]| [(from_s, high), (to_s, low)])
            });
            let boxes = Shape::Boxes(boxes.collect());
            marks.push(Mark::new(name, Stroke::new(fill, 0.0, ""), boxes));
            if self.has_kinds(bit) {
                panels.keys.push(Key::new(text, Sign::Band(fill, 1.0)));
            }
        }
        let ticks = u32::try_from(self.count.min(6)).unwrap_or(6);
        let y = Scale::exactly(-0.5, self.count as f64 - 0.5, ticks);
        panels.panel("Open joint", height_px, y, Vec::new(), marks);
    }

    /// Intervals of time in which a joint is open in this way.
    fn stretches(&self, joint: usize, bit: u8, end_s: f64) -> Vec<[f64; 2]> {
        let is_open = |(_, bits): &&(f64, Vec<u8>)| bits[joint] & bit != 0;
        let mut columns = self.thinned.columns.iter();
        let mut stretches = Vec::new();
        while let Some((from_s, _)) = columns.find(is_open) {
            let end = columns.find(|column| !is_open(column));
            stretches.push([*from_s, end.map_or(end_s, |(to_s, _)| *to_s)]);
        }
        stretches
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::OpenHinge;
    use nalgebra::Vector2;

    /// Sample in which joint 1 of 3 is open at the intrados; if `parted`, joint 2 is open at both edges.
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
        let columns = &joints.thinned.columns;
        assert!((JOINT_COLUMNS / 2..=JOINT_COLUMNS).contains(&columns.len()));
        assert!(columns.iter().all(|(_, bits)| bits.len() == 3));
        assert!(columns.is_sorted_by(|one, next| one.0 < next.0));
        assert!(columns.iter().all(|(_, bits)| bits[0] == 0));
        assert!(columns.iter().all(|(_, bits)| bits[1] == 1));
        let parted: Vec<_> = columns.iter().filter(|(_, bits)| bits[2] == 4).collect();
        assert_eq!(parted.len(), 1);
        let width_s = columns[1].0 - columns[0].0;
        assert!((0.0..width_s).contains(&(7_777.0 - parted[0].0)));
    }
}
