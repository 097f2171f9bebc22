//! `history.svg`: a history at a glance, over a shared time axis.

use nalgebra::Vector2;

use super::svg::{Anchor, Axes, CURVES, Drawing, Frame, Scale, Stroke, color};
use crate::dynamics::history::{Event, Sample, State, impacts};
use crate::mechanics::sway::Sway;

/// Columns that a curve is thinned to, at most: about two to a pixel.
pub(super) const COLUMNS: usize = 1600;

/// Marks and bands narrower than this many pixels are not told apart.
const NARROWEST_PX: f64 = 1.0;

/// Where the excess of the thrust line is cut off, in parts of the thickness: a structure that falls has
/// values that would hide all others.
pub(super) const LARGEST_EXCESS: f64 = 1.0;

/// A long series of values thinned to the least and largest of each of equal groups.
#[derive(Clone, Debug)]
pub(super) struct Envelope {
    /// Columns that it is thinned to.
    most: usize,
    group: usize,
    /// Samples in the last column.
    in_last: usize,
    /// Time and value of the least and the largest of each column.
    columns: Vec<[(f64, f64); 2]>,
    last: Option<(f64, f64)>,
}

impl Envelope {
    const fn new() -> Self {
        Self::of_columns(COLUMNS)
    }

    /// One that is thinned to so many columns at most.
    pub(super) const fn of_columns(most: usize) -> Self {
        Self {
            most,
            group: 1,
            in_last: 0,
            columns: Vec::new(),
            last: None,
        }
    }

    pub(super) fn push(&mut self, time_s: f64, value: f64) {
        let point = (time_s, value);
        self.last = Some(point);
        if self.in_last < self.group
            && let Some(column) = self.columns.last_mut()
        {
            *column = joined(*column, [point; 2]);
            self.in_last += 1;
            return;
        }
        if self.columns.len() == self.most {
            self.columns = self
                .columns
                .chunks(2)
                .map(|pair| joined(pair[0], pair[pair.len() - 1]))
                .collect();
            self.group *= 2;
        }
        self.columns.push([point; 2]);
        self.in_last = 1;
    }

    /// The points to draw, in the order of time.
    pub(super) fn points(&self) -> impl Iterator<Item = (f64, f64)> {
        let mut points: Vec<(f64, f64)> = Vec::new();
        let extremes = self.columns.iter().flat_map(|[low, high]| {
            if low.0 <= high.0 {
                [*low, *high]
            } else {
                [*high, *low]
            }
        });
        for point in extremes.chain(self.last) {
            if points.last().is_none_or(|last| last.0 < point.0) {
                points.push(point);
            }
        }
        points.into_iter()
    }

    pub(super) fn values(&self) -> impl Iterator<Item = f64> {
        self.columns.iter().flatten().map(|(_, value)| *value)
    }
}

fn joined(a: [(f64, f64); 2], b: [(f64, f64); 2]) -> [(f64, f64); 2] {
    let low = if b[0].1 < a[0].1 { b[0] } else { a[0] };
    let high = if b[1].1 > a[1].1 { b[1] } else { a[1] };
    [low, high]
}

/// A half cycle that comes near the unstable equilibrium, or passes it.
#[derive(Clone, Copy, Debug)]
struct FarCycle {
    phase: usize,
    /// The body that carries the coordinate.
    body: usize,
    from_s: f64,
    to_s: f64,
    /// Its rotation at the unstable equilibrium, with its sign.
    unstable_rad: f64,
}

/// Part of the unstable rotation from which on a half cycle is far.
const FAR: f64 = 0.25;

/// Index of the panel of rotations.
const ROTATIONS: usize = 1;

/// The look of the unstable rotation of a body: in the colour of its curve.
const fn unstable(body: usize) -> Stroke {
    Stroke::new(CURVES[body % CURVES.len()].color, 1.0, "1 3")
}

/// Collects the samples of a history, thinned, and draws them.
#[derive(Clone, Debug)]
pub struct Timeline {
    gravity_m_s2: f64,
    bodies: Vec<String>,
    ground_g: Envelope,
    rotations_rad: Vec<Envelope>,
    excess_ratio: Envelope,
    energy_ratio: Envelope,
    /// The last phase, and when it began.
    phase: usize,
    phase_from_s: f64,
    /// Half cycles that went far.
    far: Vec<FarCycle>,
    /// What the structure does at first.
    start: State,
    end_s: f64,
}

impl Timeline {
    /// An empty one, for bodies of these names.
    #[must_use]
    pub fn new(bodies: &[String], gravity_m_s2: f64) -> Self {
        Self {
            gravity_m_s2,
            bodies: bodies.to_vec(),
            ground_g: Envelope::new(),
            rotations_rad: vec![Envelope::new(); bodies.len()],
            excess_ratio: Envelope::new(),
            energy_ratio: Envelope::new(),
            phase: 0,
            phase_from_s: 0.0,
            far: Vec::new(),
            start: State::Rest,
            end_s: 0.0,
        }
    }

    /// Takes a sample. Samples come in the order of time.
    pub fn push(&mut self, sample: &Sample) {
        let time_s = sample.time_s;
        if sample.phase == 0 {
            self.start = sample.state;
        }
        self.end_s = time_s;
        let ground_g = sample.ground_acceleration_m_s2 / self.gravity_m_s2;
        self.ground_g.push(time_s, ground_g);
        let envelopes = self.rotations_rad.iter_mut();
        for (envelope, rotation) in envelopes.zip(&sample.rotations_rad) {
            envelope.push(time_s, *rotation);
        }
        let excess_ratio = sample.demand.excess_ratio.min(LARGEST_EXCESS);
        self.excess_ratio.push(time_s, excess_ratio);
        self.note_if_far(sample);
        self.energy_ratio
            .push(time_s, sample.energy_ratio.unwrap_or(0.0));
    }

    /// Notes how far a half cycle goes, when it goes far.
    fn note_if_far(&mut self, sample: &Sample) {
        if sample.phase != self.phase {
            (self.phase, self.phase_from_s) = (sample.phase, sample.time_s);
        }
        let (State::Rocking(sway), Some(ratio)) = (sample.state, sample.rotation_over_critical)
        else {
            return;
        };
        // The body that carries the coordinate is that at the end the structure leans away from.
        let body = match sway {
            Sway::Right => 0,
            Sway::Left => sample.rotations_rad.len() - 1,
        };
        let last = self.far.last_mut();
        match last.filter(|cycle| cycle.phase == sample.phase) {
            Some(cycle) => cycle.to_s = sample.time_s,
            None if ratio.abs() >= FAR => self.far.push(FarCycle {
                phase: sample.phase,
                body,
                from_s: self.phase_from_s,
                to_s: sample.time_s,
                unstable_rad: sample.rotations_rad[body] / ratio.abs(),
            }),
            None => {}
        }
    }

    /// The picture, with all events of the history.
    #[must_use]
    pub fn draw(&self, title: &str, events: &[Event]) -> String {
        let (left, width) = (85.0, 790.0);
        let mut drawing = Drawing::new(900.0, 884.0);
        drawing.title(title);
        let time = Scale::exactly(0.0, self.end_s.max(f64::MIN_POSITIVE), 10);
        let bodies = self.bodies.iter().map(|body| match body.as_str() {
            "" => "rotation",
            body => body,
        });
        let rotations = bodies
            .zip(&self.rotations_rad)
            .zip(CURVES)
            .map(|((name, envelope), stroke)| (name, envelope, stroke))
            .collect::<Vec<_>>();
        let black = Stroke::new(color::BLACK, 1.4, "");
        let panels = [
            ("Ground (g)", 130.0, vec![("ground", &self.ground_g, black)]),
            ("Rotation (rad)", 260.0, rotations),
            (
                "Energy / barrier",
                120.0,
                vec![("energy", &self.energy_ratio, black)],
            ),
            (
                "Excess / t (up to 1)",
                120.0,
                vec![("excess", &self.excess_ratio, black)],
            ),
        ];
        let mut top = 70.0;
        let mut rocking_panel = None;
        let mut drawing_hops = false;
        let last = panels.len() - 1;
        for (index, (label, height, curves)) in panels.into_iter().enumerate() {
            let frame = Frame {
                left,
                top,
                width,
                height,
            };
            let unstable = (index == ROTATIONS)
                .then_some(&self.far)
                .into_iter()
                .flatten();
            let unstable = unstable.map(|cycle| cycle.unstable_rad);
            // A little room, so that no curve runs along the frame.
            let values = curves
                .iter()
                .flat_map(|(_, envelope, _)| envelope.values())
                .chain(unstable)
                .map(|value| 1.03 * value);
            let axes = Axes {
                frame,
                x: time,
                y: Scale::around(values.chain([0.0]), if height > 200.0 { 6 } else { 3 }),
            };
            let changes = events.iter().map(|event| (event.time_s, event.state));
            drawing_hops |= shade(&mut drawing, &axes, self.end_s, self.start, changes);
            let time_label = (index == last).then_some("Time (s)");
            axes.draw(&mut drawing, time_label, label);
            for (name, envelope, stroke) in curves {
                let points = envelope.points().map(|(t, value)| axes.place(t, value));
                drawing.curve(name, points, stroke);
            }
            if index == ROTATIONS {
                self.draw_unstable(&mut drawing, &axes);
                rocking_panel = Some(axes);
            }
            top += height + 22.0;
        }
        if let Some(axes) = rocking_panel {
            mark_impacts(
                &mut drawing,
                &axes,
                impacts(events).map(|(time_s, _)| time_s),
            );
        }
        self.explain(&mut drawing, top + 44.0, drawing_hops);
        drawing.finish()
    }

    /// The unstable rotation of the mechanism of each half cycle that went far.
    fn draw_unstable(&self, drawing: &mut Drawing, axes: &Axes) {
        for cycle in &self.far {
            let ends = [cycle.from_s, cycle.to_s].map(|t| axes.place(t, cycle.unstable_rad));
            drawing.curve("unstable", ends, unstable(cycle.body));
        }
    }

    /// The legend.
    fn explain(&self, drawing: &mut Drawing, y: f64, hops: bool) {
        if let Some(cycle) = self.far.first() {
            let at = Vector2::new(85.0, y + 24.0);
            let words = match self.bodies.len() {
                1 => "unstable rotation",
                _ => "unstable rotation of the body of that colour, of the mechanism that moves",
            };
            drawing.legend(at, 0.0, [(words, unstable(cycle.body))]);
        }
        let bodies = self.bodies.iter().zip(CURVES);
        let named = bodies.filter(|(body, _)| !body.is_empty());
        let at = Vector2::new(85.0, y);
        drawing.legend(
            at,
            90.0,
            named.map(|(body, stroke)| (body.as_str(), stroke)),
        );
        explain_shades(drawing, Vector2::new(365.0, y), hops);
        let mark = Vector2::new(740.0, y + 6.0);
        draw_mark(drawing, "", mark);
        let at = Vector2::new(752.0, y + 4.5);
        drawing.label(at, Anchor::Start, 0.0, "impacts");
    }
}

/// The legend of what is shaded.
pub(super) fn explain_shades(drawing: &mut Drawing, at: Vector2<f64>, hops: bool) {
    let (mut x, y) = (at.x, at.y);
    let keys = [
        (SWAYS_RIGHT, "sways right"),
        (SWAYS_LEFT, "sways left"),
        (HOPS, "hops"),
    ];
    for ((_, fill), text) in keys.into_iter().take(if hops { 3 } else { 2 }) {
        let frame = Frame {
            left: x,
            top: y - 7.0,
            width: 24.0,
            height: 14.0,
        };
        drawing.band("key", &frame, fill, OPACITY);
        let at = Vector2::new(x + 30.0, y + 4.5);
        drawing.label(at, Anchor::Start, 0.0, text);
        x += 125.0;
    }
}

/// Name and colour of a band.
type Shade = (&'static str, &'static str);

const SWAYS_RIGHT: Shade = ("right", color::SKY);
const SWAYS_LEFT: Shade = ("left", color::ORANGE);
const OVERTURNED: Shade = ("overturned", color::BLACK);
/// Hops to both sides, each too short to be seen.
const HOPS: Shade = ("hops", color::GREY);

/// So strong are the colours of bands.
const OPACITY: f64 = 0.22;

const fn shade_of(state: State) -> Option<Shade> {
    match state {
        State::Rest => None,
        State::Rocking(Sway::Right) => Some(SWAYS_RIGHT),
        State::Rocking(Sway::Left) => Some(SWAYS_LEFT),
        State::Overturned(_) => Some(OVERTURNED),
    }
}

/// Shades what the structure does from its beginning on, and tells whether there are hops too short to be told apart:
/// these get one shade together.
pub(super) fn shade(
    drawing: &mut Drawing,
    axes: &Axes,
    end_s: f64,
    start: State,
    changes: impl Iterator<Item = (f64, State)> + Clone,
) -> bool {
    let place = |time_s: f64| axes.place(time_s.min(end_s), axes.y.low).x;
    let mut band = |(name, fill): Shade, left: f64, right: f64| {
        let frame = Frame {
            left,
            width: right - left,
            ..axes.frame
        };
        drawing.band(name, &frame, fill, OPACITY);
    };
    let ends_s = changes.clone().map(|(time_s, _)| time_s).chain([end_s]);
    // Where the last band ends that is wide enough to be seen.
    let mut drawn = place(0.0);
    let mut hops = false;
    for ((from_s, state), to_s) in [(0.0, start)].into_iter().chain(changes).zip(ends_s) {
        let (left, right) = (place(from_s), place(to_s));
        if right - left < NARROWEST_PX && to_s < end_s {
            continue;
        }
        if left - drawn >= NARROWEST_PX {
            band(HOPS, drawn, left);
            hops = true;
            drawn = left;
        }
        if let Some(shade) = shade_of(state)
            && right - drawn >= NARROWEST_PX
        {
            band(shade, drawn, right);
        }
        drawn = right;
    }
    hops
}

/// Marks impacts along the lower side, those apart from the last mark.
fn mark_impacts(drawing: &mut Drawing, axes: &Axes, impacts_s: impl Iterator<Item = f64>) {
    let mut last_px = f64::NEG_INFINITY;
    for time_s in impacts_s {
        let at = axes.place(time_s, axes.y.low);
        if at.x - last_px >= NARROWEST_PX {
            draw_mark(drawing, "impact", at);
            last_px = at.x;
        }
    }
}

/// A small triangle that stands on its tip's opposite side, pointing upwards from `foot`.
fn draw_mark(drawing: &mut Drawing, name: &str, foot: Vector2<f64>) {
    let path = format!("M{:.2} {:.2}l4 0l-4 -11l-4 11Z", foot.x, foot.y);
    let stroke = Stroke::new(color::VERMILION, 0.8, "");
    drawing.path(name, &path, color::VERMILION, stroke);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_envelope_keeps_extremes_and_ends_in_few_points() {
        let mut envelope = Envelope::new();
        let count = 100_003;
        for i in 0..count {
            let spike = if i == 77_777 { 5.0 } else { 0.0 };
            envelope.push(f64::from(i), (f64::from(i) * 0.1).sin() + spike);
        }
        let points: Vec<_> = envelope.points().collect();
        assert!(points.len() <= 2 * COLUMNS + 1, "{}", points.len());
        assert!(points.is_sorted_by(|a, b| a.0 < b.0));
        assert!(points.iter().any(|point| point.0 == 77_777.0));
        assert_eq!(points[points.len() - 1].0, f64::from(count - 1));
        assert!(points[0].0 < 200.0);
    }

    #[test]
    fn a_short_series_is_kept_as_it_is() {
        let mut envelope = Envelope::new();
        let values = [(0.0, 1.0), (0.1, -2.0), (0.2, 3.0)];
        for (time_s, value) in values {
            envelope.push(time_s, value);
        }
        assert_eq!(envelope.points().collect::<Vec<_>>(), values);
    }
}
