//! `history.svg` for a row of blocks: a history at a glance, with the joints that are open.

use super::picture::{FAR, Picture};
use super::points::Points;
use crate::dynamics::history::{Outcome, Sample, State, Summary};
use crate::mechanics::blocks::{Row, Supports};
use crate::mechanics::chain::Hinge;
use crate::mechanics::geometry::ring::Edge;
use crate::output::Figure;
use crate::output::axes::Scale;
use crate::output::chart::{Mark, Shape};
use crate::output::envelope::{COLUMNS, Envelope};
use crate::output::figure::Panel;
use crate::output::panels::{MAIN, Panels, States, Subject, around, overturning, overturns};
use crate::output::sheet::{Key, Sign};
use crate::output::svg::{Stroke, color};

/// Number of columns for all curves of rotations together, so that long rows do not make huge files.
const COLUMNS_OF_ALL: usize = 16_000;
/// Least number of columns for one of them.
const LEAST_COLUMNS: usize = 200;
/// Height of the strip of a joint below which it is not divided by edges.
const NARROW_PX: f64 = 5.0;
/// Number of columns in the panel of joints: about one per pixel.
const JOINT_COLUMNS: usize = 800;

/// Collects the samples of a history, thinned, and draws them.
#[derive(Clone, Debug)]
pub(super) struct RowTimeline {
    rotations_rad: Vec<Envelope>,
    energy: Envelope,
    /// Displacement of the right foot relative to the left one, to the right and upwards, in millimetres.
    feet_mm: [Envelope; 2],
    /// Slips in millimetres, if joints slip.
    slips_mm: Vec<Envelope>,
    /// Whether energies are relative to a barrier; otherwise they are in J.
    in_barriers: bool,
    joints: OpenJoints,
    /// Names of the hinges at the two edges.
    edges: [&'static str; 2],
    end_s: f64,
}

impl RowTimeline {
    /// An empty timeline for this row.
    pub(super) fn new(row: &Row) -> Self {
        let blocks = row.blocks.len();
        let columns = (COLUMNS_OF_ALL / blocks).clamp(LEAST_COLUMNS, COLUMNS);
        Self {
            rotations_rad: vec![Envelope::of_columns(columns); blocks],
            energy: Envelope::default(),
            feet_mm: [Envelope::default(), Envelope::default()],
            slips_mm: Vec::new(),
            in_barriers: false,
            joints: OpenJoints::new(row.joints.len()),
            edges: match row.supports {
                Supports::Both => ["hinge at the intrados", "hinge at the extrados"],
                Supports::Left => ["hinge at the left edge", "hinge at the right edge"],
            },
            end_s: 0.0,
        }
    }
}

impl Picture for RowTimeline {
    fn sample(&mut self, sample: &Sample) {
        let time_s = sample.time_s;
        self.end_s = time_s;
        let envelopes = self.rotations_rad.iter_mut();
        for (envelope, rotation) in envelopes.zip(&sample.rotations_rad) {
            envelope.push(time_s, *rotation);
        }
        self.in_barriers = sample.energy_ratio.is_some();
        let energy = sample.energy_ratio.unwrap_or(sample.energy_j);
        self.energy.push(time_s, energy);
        for (envelope, apart_m) in self.feet_mm.iter_mut().zip(sample.feet_apart_m.iter()) {
            envelope.push(time_s, 1e3 * apart_m);
        }
        let joints = sample.offsets_m.len();
        if self.slips_mm.is_empty() && joints > 0 {
            let columns = (COLUMNS_OF_ALL / joints).clamp(LEAST_COLUMNS, COLUMNS);
            self.slips_mm = vec![Envelope::of_columns(columns); joints];
        }
        for (envelope, offset_m) in self.slips_mm.iter_mut().zip(&sample.offsets_m) {
            envelope.push(time_s, 1e3 * offset_m);
        }
        self.joints.push(sample);
    }

    fn draw(
        &self,
        figure: Figure,
        subject: &Subject<'_>,
        summary: &Summary,
        points: &Points,
    ) -> String {
        let span_s = [subject.ground.start_s(), self.end_s];
        let mut panels = Panels::new(figure, subject.title, span_s);
        let states = states(summary);
        let states = Some(&states);
        let shows = |panel| figure.shows(panel, points.any());
        if shows(Panel::Ground) {
            panels.ground(110.0, subject, states);
            self.add_feet(&mut panels, states);
        }
        if shows(Panel::Rotation) {
            self.add_rotations(&mut panels, states, summary);
        }
        if shows(Panel::Joints) && self.joints.any() {
            self.joints
                .add_to(&mut panels, figure, self.edges, self.end_s);
        }
        if shows(Panel::Slip) {
            let slips = self.slips_mm.iter().enumerate();
            let slips = slips
                .map(|(joint, slip)| Mark::curve(format!("slip {joint}"), BLOCK, slip.points()));
            let slips = slips.filter(|slip| !slip.is_flat()).collect();
            panels.curves("Slip (mm)", 120.0, slips, states);
        }
        if shows(Panel::Points) {
            points.draw(&mut panels, states);
        }
        let energy = Mark::curve("energy", MAIN, self.energy.points());
        if shows(Panel::Energy) && !energy.is_flat() {
            let label = if self.in_barriers {
                "Total energy / barrier"
            } else {
                "Energy (J)"
            };
            let mut curves = vec![energy];
            // A barrier far above the curve would flatten it.
            let over_barrier = summary.peak_potential_over_barrier();
            if over_barrier.is_some_and(|peak| peak >= FAR) {
                let ends = span_s.map(|time_s| (time_s, 1.0));
                curves.push(Mark::curve("barrier", BARRIER, ends));
                let words = "gravity alone overturns the first mechanism";
                panels.keys.push(Key::line(words, BARRIER));
            }
            panels.curves(label, 120.0, curves, states);
        }
        if shows(Panel::Rotation) && summary.overturned_s().is_some() {
            panels.keys.push(overturns());
        }
        panels.finish(summary.outcome != Outcome::NeverMoved)
    }
}

impl RowTimeline {
    /// Adds the panel of the right foot, if it moves.
    fn add_feet(&self, panels: &mut Panels, states: Option<&States>) {
        let names = ["right foot to the right", "right foot upwards"];
        let feet = names.into_iter().zip(&self.feet_mm).zip([MAIN, UPWARDS]);
        let feet = feet.map(|((name, foot), stroke)| Mark::curve(name, stroke, foot.points()));
        let feet: Vec<Mark> = feet.filter(|foot| !foot.is_flat()).collect();
        if feet.len() > 1 {
            let keys = feet.iter();
            panels.keys.extend(keys.map(Mark::key));
        }
        panels.curves("Right foot (mm)", 110.0, feet, states);
    }

    /// Adds the panel of the rotations. The block that rotates most is drawn on top of the others.
    fn add_rotations(&self, panels: &mut Panels, states: Option<&States>, summary: &Summary) {
        let largest = summary.largest_body();
        let others = (0..self.rotations_rad.len()).filter(|block| *block != largest);
        let strokes = others
            .map(|block| (block, BLOCK))
            .chain([(largest, LARGEST)]);
        let curves = strokes.map(|(block, stroke)| {
            let points = self.rotations_rad[block].points();
            Mark::curve((block + 1).to_string(), stroke, points)
        });
        let mut marks: Vec<Mark> = curves.collect();
        let y = around(&marks, [], 6);
        let overturned_s = summary.overturned_s();
        marks.extend(overturned_s.map(|time_s| overturning(time_s, y)));
        panels.panel("Rotation (rad)", 240.0, y, states, marks);
        if self.rotations_rad.len() > 1 {
            let name = format!("block {}, which turns most", largest + 1);
            let keys = [Key::line(name, LARGEST), Key::line("others", BLOCK)];
            panels.keys.extend(keys);
        }
    }
}

/// The states: the half cycles, and the end.
fn states(summary: &Summary) -> States {
    let end = match summary.outcome {
        Outcome::Rest => Some(State::Rest),
        Outcome::Overturned(sway) => Some(State::Overturned(sway)),
        Outcome::NeverMoved | Outcome::Vibrates | Outcome::StillRocking | Outcome::Incomplete => {
            None
        }
    };
    let row = summary.row().into_iter();
    let changes = row
        .flat_map(|row| &row.half_cycles)
        .map(|cycle| (cycle.start_s, State::Rocking(cycle.sway)))
        .chain(end.map(|state| (summary.outcome_time_s, state)));
    States {
        start: State::Rest,
        changes: changes.collect(),
    }
}

const UPWARDS: Stroke = Stroke::new(color::GREEN, 1.6, "7 3");
const BARRIER: Stroke = Stroke::new(color::VERMILION, 1.0, "1 3");
const LARGEST: Stroke = Stroke::new(color::BLUE, 1.8, "");
const BLOCK: Stroke = Stroke::new(color::BLACK, 0.5, "");

/// A way in which a joint can be open, and its mark.
#[derive(Clone, Copy)]
struct Kind {
    name: &'static str,
    fill: &'static str,
    /// Lower and upper end of the mark in the strip of the joint.
    part: [f64; 2],
    bit: u8,
}

const fn kind(name: &'static str, fill: &'static str, part: [f64; 2], bit: u8) -> Kind {
    Kind {
        name,
        fill,
        part,
        bit,
    }
}

/// The ways in which a joint can be open.
const KINDS: [Kind; 3] = [
    kind("intrados", color::BLUE, [-0.42, 0.0], 1),
    kind("extrados", color::VERMILION, [0.0, 0.42], 2),
    kind("parted", color::BLACK, [-0.42, 0.42], 4),
];

/// The open joints over time, thinned to columns. A column has all ways in which a joint is open in any of its samples.
#[derive(Clone, Debug)]
struct OpenJoints {
    count: usize,
    /// Number of samples in a column, and in the last one.
    group: usize,
    in_last: usize,
    /// The time at which each column begins.
    starts_s: Vec<f64>,
    /// Bits of [`KINDS`], column by column.
    bits: Vec<u8>,
}

impl OpenJoints {
    const fn new(count: usize) -> Self {
        Self {
            count,
            group: 1,
            in_last: 0,
            starts_s: Vec::new(),
            bits: Vec::new(),
        }
    }

    /// Whether any joint is ever open.
    fn any(&self) -> bool {
        self.bits.iter().any(|bits| *bits != 0)
    }

    /// Whether any joint is ever open in this way.
    fn has(&self, bit: u8) -> bool {
        self.bits.iter().any(|bits| bits & bit != 0)
    }

    fn push(&mut self, sample: &Sample) {
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
                    Some(Edge::Intrados) => KINDS[0].bit,
                    Some(Edge::Extrados) => KINDS[1].bit,
                    None => KINDS[2].bit,
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

    /// Adds the panel of the joints, whose edges have these names.
    fn add_to(&self, panels: &mut Panels, figure: Figure, edges: [&str; 2], end_s: f64) {
        let height_px = (14.0 * self.count as f64).clamp(60.0, 260.0);
        let is_narrow = figure.height_px(height_px) < NARROW_PX * self.count as f64;
        let marks = KINDS.map(|kind| {
            // Divided strips this narrow would look pale.
            let part = if is_narrow { [-0.5, 0.5] } else { kind.part };
            let boxes = (0..self.count).flat_map(|joint| {
                let [low, high] = part.map(|part| joint as f64 + part);
                let stretches = self.stretches(joint, kind.bit, end_s).into_iter();
                stretches.map(move |[from_s, to_s]| [(from_s, high), (to_s, low)])
            });
            Mark::new(
                kind.name,
                Stroke::new(kind.fill, 0.0, ""),
                Shape::Boxes(boxes.collect()),
            )
        });
        let ticks = u32::try_from(self.count.min(6)).unwrap_or(6);
        let y = Scale::exactly(-0.5, self.count as f64 - 0.5, ticks);
        panels.panel("Open joint", height_px, y, None, marks.into());
        let texts = KINDS.into_iter().zip([edges[0], edges[1], "parted"]);
        let texts = texts.filter(|(kind, _)| self.has(kind.bit));
        let keys = texts.map(|(kind, text)| Key::new(text, Sign::Band(kind.fill, 1.0)));
        panels.keys.extend(keys);
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
        let mut joints = OpenJoints::new(3);
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
