//! Panels over a common time axis, for all pictures of histories.

use super::axes::Scale;
use super::chart::{Chart, Mark, PANEL_LEFT_PX, Shape};
use super::figure::Figure;
use super::ground;
use super::sheet::{Key, Sheet, Sign};
use super::svg::{Frame, Stroke, color};
use crate::{GroundMotion, State, Sway};

/// Smallest width of a band, in pixels; narrower ones cannot be distinguished.
const NARROWEST_PX: f64 = 1.0;

/// Gap between panels.
const GAP_PX: f64 = 30.0;

/// The subject of the picture of a history.
#[derive(Clone, Copy, Debug)]
pub struct Subject<'a> {
    /// Title of the picture.
    pub title: &'a str,
    /// The ground motion.
    pub ground: &'a GroundMotion,
    /// Gravity, in m/s2.
    pub gravity_m_s2: f64,
    /// Accelerations that start the structure to the right and to the left, in g; `None` if no acceleration starts it.
    pub incipient_g: [Option<f64>; 2],
}

pub(crate) const MAIN: Stroke = Stroke::new(color::BLACK, 1.4, "");
const INCIPIENT: Stroke = Stroke::new(color::PURPLE, 1.3, "6 4");
const OVERTURNING: Stroke = Stroke::new(color::VERMILION, 1.8, "8 3 2 3");

/// The states of the structure over time, for shading.
#[derive(Clone, Debug, Default)]
pub(crate) struct StateHistory {
    pub(crate) start: State,
    pub(crate) changes: Vec<(f64, State)>,
}

/// A picture of panels, one below the other.
pub(crate) struct Panels {
    figure: Figure,
    title: String,
    /// The common time axis.
    x: Scale,
    panels: Vec<Chart>,
    /// Entries of the legend that are specific to this picture.
    pub(crate) keys: Vec<Key>,
    /// True if there are hops too short to distinguish.
    hops: bool,
    /// True if the accelerations that start the structure are drawn.
    incipient: bool,
}

impl Panels {
    /// Makes panels over this range of times.
    pub(crate) fn new(figure: Figure, title: &str, [start_s, end_s]: [f64; 2]) -> Self {
        let end_s = end_s.max(start_s + f64::MIN_POSITIVE);
        Self {
            figure,
            title: title.to_owned(),
            x: Scale::exactly(start_s, end_s, figure.ticks(10)),
            panels: Vec::new(),
            keys: Vec::new(),
            hops: false,
            incipient: false,
        }
    }

    /// Adds a panel below the others, with this height on the screen, shaded by the states of the structure.
    pub(crate) fn panel(
        &mut self,
        label: &str,
        height_px: f64,
        y: Scale,
        states: Option<&StateHistory>,
        marks: Vec<Mark>,
    ) {
        let mut shades = Vec::new();
        if let Some(states) = states {
            let hops;
            (shades, hops) = shade(self.x, self.figure, states);
            self.hops |= hops;
        }
        self.panels.push(Chart {
            is_panel: true,
            below: shades,
            marks,
            ..Chart::new(height_px, ("", self.x), (label, y))
        });
    }

    /// Adds a panel with these curves, on a scale that contains all of them; nothing if all curves are zero.
    pub(crate) fn curves(
        &mut self,
        label: &str,
        height_px: f64,
        curves: Vec<Mark>,
        states: Option<&StateHistory>,
    ) {
        if !curves.iter().all(Mark::is_flat) {
            let ticks = if height_px > 200.0 { 6 } else { 3 };
            let y = scale_around(&curves, [], ticks);
            self.panel(label, height_px, y, states, curves);
        }
    }

    /// Adds the panel of the ground, with the accelerations that start the structure; nothing if the ground does not move.
    pub(crate) fn ground(
        &mut self,
        height_px: f64,
        subject: &Subject<'_>,
        states: Option<&StateHistory>,
    ) {
        let points = ground::curve_g(subject.ground, subject.gravity_m_s2, self.x.high);
        let sizes_g = points.iter().map(|point| point.1.abs());
        let largest = sizes_g.fold(0.0, f64::max);
        let [right, left] = subject.incipient_g;
        // Ground that accelerates to the left pushes to the right. Levels far beyond the ground motion would flatten its curve.
        let levels = [right.map(|g| -g), left].into_iter().flatten();
        let mut curves: Vec<Mark> = levels
            .filter(|level| level.abs() < 4.0 * largest)
            .map(|level| {
                let ends = [self.x.low, self.x.high].map(|time_s| (time_s, level));
                Mark::curve("A_L", INCIPIENT, ends)
            })
            .collect();
        self.incipient |= !curves.is_empty();
        curves.push(Mark::curve("ground", MAIN, points));
        self.curves("Ground (g)", height_px, curves, states);
    }

    /// Draws the picture, with the time axis below the panels and a legend: first the specific entries, then those common to all pictures.
    pub(crate) fn finish(self, shaded: bool) -> String {
        let (mut panels, mut keys) = (self.panels, self.keys);
        if shaded {
            for ((_, fill), text) in [(SWAYS_RIGHT, "sways right"), (SWAYS_LEFT, "sways left")] {
                keys.push(Key::new(text, Sign::Band(fill, OPACITY)));
            }
        }
        if self.hops {
            keys.push(Key::new("hops", Sign::Band(HOPS.1, OPACITY)));
        }
        if self.incipient {
            keys.push(Key::line("A_L, which starts it from rest", INCIPIENT));
        }
        if let Some(last) = panels.last_mut() {
            last.x.0 = "Time (s)".to_owned();
        }
        let mut sheet = Sheet::new(self.figure, &self.title);
        sheet.gap(20.0);
        for panel in panels {
            panel.add_plot(&mut sheet);
            sheet.gap(GAP_PX);
        }
        sheet.gap(30.0);
        sheet.legend(PANEL_LEFT_PX, keys);
        sheet.gap(12.0);
        sheet.finish()
    }
}

/// Returns a scale that contains curves, further values and zero, with a small margin so that no curve coincides with the frame.
pub(crate) fn scale_around(
    curves: &[Mark],
    more: impl IntoIterator<Item = f64>,
    ticks: u32,
) -> Scale {
    let values = curves.iter().flat_map(Mark::points).map(|point| point.1);
    let values = values.chain(more).filter(|value| value.is_finite());
    Scale::around(values.map(|value| 1.03 * value).chain([0.0]), ticks)
}

/// Name and colour of a band.
type Shade = (&'static str, &'static str);

const SWAYS_RIGHT: Shade = ("right", color::SKY);
const SWAYS_LEFT: Shade = ("left", color::ORANGE);
const OVERTURNED: Shade = ("overturned", color::BLACK);
/// Shade of hops to both sides that are too short to be visible one by one.
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

/// Returns the shades of the states of the structure, and true if there are hops too short to distinguish. A sequence of such hops has one
/// common shade.
fn shade(x: Scale, figure: Figure, states: &StateHistory) -> (Vec<Mark>, bool) {
    let (start_s, end_s) = (x.low, x.high);
    let width_px = figure.right_of(PANEL_LEFT_PX, Frame::default()).width;
    let least_s = NARROWEST_PX * (end_s - start_s) / width_px;
    let is_seen = |[from_s, to_s]: [f64; 2]| to_s - from_s >= least_s;
    let band = |(name, fill): Shade, ends| {
        let shape = Shape::Range(ends, OPACITY);
        Mark::new(name, Stroke::new(fill, 0.0, ""), shape)
    };
    let changes = states.changes.iter();
    let changes = changes.map(|(time_s, state)| (time_s.min(end_s), *state));
    let ends_s = changes.clone().map(|(time_s, _)| time_s).chain([end_s]);
    // The end of the last visible band.
    let mut drawn_s = start_s;
    let (mut bands, mut hops) = (Vec::new(), false);
    let begins = [(start_s, states.start)].into_iter().chain(changes);
    for ((from_s, state), to_s) in begins.zip(ends_s) {
        if !is_seen([from_s, to_s]) && to_s < end_s {
            continue;
        }
        if is_seen([drawn_s, from_s]) {
            bands.push(band(HOPS, [drawn_s, from_s]));
            hops = true;
            drawn_s = from_s;
        }
        if let Some(shade) = shade_of(state).filter(|_| is_seen([drawn_s, to_s])) {
            bands.push(band(shade, [drawn_s, to_s]));
        }
        drawn_s = to_s;
    }
    (bands, hops)
}

/// Returns the legend entry for the time of overturning.
pub(crate) fn overturns() -> Key {
    Key::line("overturns", OVERTURNING)
}

/// Returns the mark at the time of overturning.
pub(crate) fn overturning(time_s: f64, y: Scale) -> Mark {
    Mark::upright("overturning", OVERTURNING, time_s, y)
}
