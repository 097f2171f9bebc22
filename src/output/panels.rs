//! Panels over a shared time axis, as in all pictures of histories.

use super::ground;
use super::svg::{Axes, Drawing, Figure, Key, Scale, Sign, Stroke, color};
use crate::dynamics::ground::GroundMotion;
use crate::dynamics::history::State;
use crate::mechanics::sway::Sway;

/// Bands narrower than this, in pixels, cannot be told apart.
const NARROWEST_PX: f64 = 1.0;

/// Gap between panels.
const GAP_PX: f64 = 30.0;

/// The subject of the picture of a history.
#[derive(Clone, Copy, Debug)]
pub struct Subject<'a> {
    /// Text above the picture.
    pub title: &'a str,
    /// The ground motion.
    pub ground: &'a GroundMotion,
    /// Gravity.
    pub gravity_m_s2: f64,
    /// Accelerations that start the structure to the right and to the left, in g, if they exist.
    pub incipient_g: [Option<f64>; 2],
}

/// A curve over time.
pub(crate) struct Curve {
    pub(crate) name: String,
    pub(crate) points: Vec<(f64, f64)>,
    pub(crate) stroke: Stroke,
}

pub(crate) const MAIN: Stroke = Stroke::new(color::BLACK, 1.4, "");
const INCIPIENT: Stroke = Stroke::new(color::PURPLE, 1.3, "6 4");
const OVERTURNING: Stroke = Stroke::new(color::VERMILION, 1.8, "8 3 2 3");

impl Curve {
    pub(crate) fn new(
        name: impl Into<String>,
        points: impl IntoIterator<Item = (f64, f64)>,
        stroke: Stroke,
    ) -> Self {
        Self {
            name: name.into(),
            points: points.into_iter().collect(),
            stroke,
        }
    }

    /// Whether the curve is zero throughout.
    pub(crate) fn is_flat(&self) -> bool {
        self.points.iter().all(|(_, value)| *value == 0.0)
    }
}

/// The states of the structure over time, for shading.
#[derive(Clone, Debug)]
pub(crate) struct States {
    pub(crate) start: State,
    pub(crate) changes: Vec<(f64, State)>,
}

/// A picture of panels, one below the other.
pub(crate) struct Panels {
    figure: Figure,
    drawing: Drawing,
    start_s: f64,
    end_s: f64,
    top: f64,
    /// The axes of the lowest panel, which get the time labels.
    last: Option<Axes>,
    /// Whether there were hops too short to tell apart.
    hops: bool,
    /// Whether the accelerations that start the structure are drawn.
    incipient: bool,
}

impl Panels {
    /// Panels over this range of times.
    pub(crate) fn new(figure: Figure, title: &str, [start_s, end_s]: [f64; 2]) -> Self {
        let end_s = end_s.max(start_s + f64::MIN_POSITIVE);
        let mut drawing = Drawing::new(figure);
        let top = drawing.title(title) + 20.0;
        Self {
            figure,
            drawing,
            start_s,
            end_s,
            top,
            last: None,
            hops: false,
            incipient: false,
        }
    }

    /// Adds the next panel, of this height on the screen: first the shades, then the axes, then what `draw` draws.
    pub(crate) fn panel(
        &mut self,
        label: &str,
        height_px: f64,
        y: Scale,
        doing: Option<&States>,
        draw: impl FnOnce(&mut Drawing, &Axes),
    ) {
        let height = self.figure.height_px(height_px);
        let axes = Axes {
            frame: self.figure.panel(self.top, height),
            x: Scale::exactly(self.start_s, self.end_s, self.figure.ticks(10)),
            y,
        };
        if let Some(doing) = doing {
            self.hops |= shade(&mut self.drawing, &axes, self.end_s, doing);
        }
        axes.draw_panel(&mut self.drawing, label);
        draw(&mut self.drawing, &axes);
        self.top += height + GAP_PX;
        self.last = Some(axes);
    }

    /// Adds a panel with these curves, on a scale that holds them all.
    pub(crate) fn curves(
        &mut self,
        label: &str,
        height_px: f64,
        curves: &[Curve],
        doing: Option<&States>,
    ) {
        let values = curves.iter().flat_map(|curve| &curve.points);
        let y = around(values.map(|point| point.1), ticks(height_px));
        self.panel(label, height_px, y, doing, |drawing, axes| {
            draw_curves(drawing, axes, curves);
        });
    }

    /// Adds the panel of the ground, with the accelerations that start the structure; nothing if the ground stays still.
    pub(crate) fn ground(&mut self, height_px: f64, subject: &Subject<'_>, doing: Option<&States>) {
        let Subject {
            ground,
            gravity_m_s2,
            ..
        } = *subject;
        let curve = Curve::new(
            "ground",
            ground::curve_g(ground, gravity_m_s2, self.end_s),
            MAIN,
        );
        if curve.is_flat() {
            return;
        }
        let largest = curve
            .points
            .iter()
            .fold(0.0_f64, |most, point| most.max(point.1.abs()));
        let [right, left] = subject.incipient_g;
        // Ground that accelerates to the left pushes to the right. Levels far beyond the ground motion would flatten its curve.
        let levels = [right.map(|g| -g), left].into_iter().flatten();
        let levels: Vec<f64> = levels.filter(|level| level.abs() < 4.0 * largest).collect();
        let values = curve.points.iter().map(|point| point.1);
        let y = around(values.chain(levels.iter().copied()), ticks(height_px));
        self.incipient |= !levels.is_empty();
        self.panel("Ground (g)", height_px, y, doing, |drawing, axes| {
            for level in levels {
                let ends = [axes.x.low, axes.x.high].map(|time_s| axes.place(time_s, level));
                drawing.curve("A_L", ends, INCIPIENT);
            }
            draw_curves(drawing, axes, &[curve]);
        });
    }

    /// The file, with the time axis below the panels and a legend: first these entries, then those that all pictures
    /// share.
    pub(crate) fn finish(mut self, keys: &[Key<'_>], shaded: bool) -> String {
        if let Some(axes) = self.last {
            axes.label_x(&mut self.drawing, "Time (s)");
        }
        let mut keys = keys.to_vec();
        if shaded {
            for ((_, fill), text) in [(SWAYS_RIGHT, "sways right"), (SWAYS_LEFT, "sways left")] {
                keys.push((text, Sign::Band(fill, OPACITY)));
            }
        }
        if self.hops {
            keys.push(("hops", Sign::Band(HOPS.1, OPACITY)));
        }
        if self.incipient {
            keys.push(("A_L, which starts it from rest", Sign::Line(INCIPIENT)));
        }
        let left = self.figure.panel(0.0, 0.0).left;
        let end = self.drawing.legend(left, self.top + 30.0, &keys);
        self.drawing.finish(end + 12.0)
    }
}

/// Number of ticks for a panel of this height on the screen.
fn ticks(height_px: f64) -> u32 {
    if height_px > 200.0 { 6 } else { 3 }
}

/// A scale that holds the values and zero, with a little margin, so that no curve runs along the frame.
pub(crate) fn around(values: impl Iterator<Item = f64>, ticks: u32) -> Scale {
    Scale::around(values.map(|value| 1.03 * value).chain([0.0]), ticks)
}

pub(crate) fn draw_curves(drawing: &mut Drawing, axes: &Axes, curves: &[Curve]) {
    for Curve {
        name,
        points,
        stroke,
    } in curves
    {
        let places = points.iter().map(|(t, value)| axes.place(*t, *value));
        drawing.curve(name, places, *stroke);
    }
}

/// Name and colour of a band.
type Shade = (&'static str, &'static str);

const SWAYS_RIGHT: Shade = ("right", color::SKY);
const SWAYS_LEFT: Shade = ("left", color::ORANGE);
const OVERTURNED: Shade = ("overturned", color::BLACK);
/// Hops to both sides that are too short to be seen one by one.
const HOPS: Shade = ("hops", color::GREY);

/// Opacity of the bands.
const OPACITY: f64 = 0.22;

const fn shade_of(state: State) -> Option<Shade> {
    match state {
        State::Rest => None,
        State::Rocking(Sway::Right) => Some(SWAYS_RIGHT),
        State::Rocking(Sway::Left) => Some(SWAYS_LEFT),
        State::Overturned(_) => Some(OVERTURNED),
    }
}

/// Shades the states of the structure from the beginning, and tells whether there are hops too short to tell apart.
/// A sequence of such hops gets one common shade.
fn shade(drawing: &mut Drawing, axes: &Axes, end_s: f64, doing: &States) -> bool {
    let place = |time_s: f64| axes.place(time_s.min(end_s), axes.y.low).x;
    let mut band = |(name, fill): Shade, left: f64, right: f64| {
        let mut frame = axes.frame;
        frame.left = left;
        frame.width = right - left;
        drawing.band(name, &frame, fill, OPACITY);
    };
    let changes = doing.changes.iter().copied();
    let ends_s = changes.clone().map(|(time_s, _)| time_s).chain([end_s]);
    // The right end of the last visible band.
    let mut drawn = place(axes.x.low);
    let mut hops = false;
    let states = [(axes.x.low, doing.start)].into_iter().chain(changes);
    for ((from_s, state), to_s) in states.zip(ends_s) {
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

/// The entry of a legend for the instant of overturning.
pub(crate) const OVERTURNS: Key<'static> = ("overturns", Sign::Line(OVERTURNING));

/// Marks the instant of overturning.
pub(crate) fn mark_overturning(drawing: &mut Drawing, axes: &Axes, time_s: f64) {
    let ends = [axes.y.low, axes.y.high].map(|y| axes.place(time_s, y));
    drawing.curve("overturning", ends, OVERTURNING);
}

/// The stroke that marks an impact.
pub(crate) const IMPACT: Stroke = Stroke::new(color::VERMILION, 1.0, "");
/// Marks closer together than this, in pixels, would merge.
const BETWEEN_MARKS_PX: f64 = 2.5;

/// Marks impacts with short upright lines along the lower side; leaves out a mark too close to the one before.
pub(crate) fn mark_impacts(
    drawing: &mut Drawing,
    axes: &Axes,
    impacts_s: impl Iterator<Item = f64>,
) {
    let mut last_px = f64::NEG_INFINITY;
    for time_s in impacts_s {
        let at = axes.place(time_s, axes.y.low);
        if at.x - last_px >= BETWEEN_MARKS_PX {
            let path = format!("M{:.2} {:.2}v-10", at.x, at.y);
            drawing.path("impact", &path, "none", IMPACT);
            last_px = at.x;
        }
    }
}
