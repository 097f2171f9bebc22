//! Panels over a common time axis, for all pictures of histories.

use std::str::FromStr;

use super::ground;
use super::{Figure, Key, Mark, Panels, Scale, Shape, Sign, Stroke, color, scale_around};
use crate::{GroundMotion, State, Sway};

/// Smallest width of a band, in pixels; narrower ones cannot be distinguished.
const NARROWEST_PX: f64 = 1.0;

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

named! {
    /// A panel of the picture of a history, in order from top to bottom.
    pub enum Panel {
        /// Acceleration of the ground.
        Ground = "ground",
        /// Rotations of the bodies.
        Rotation = "rotation",
        /// Open joints.
        Joints = "joints",
        /// Slips of the joints.
        Slip = "slip",
        /// Displacements of observed points.
        Points = "points",
        /// Energy, over the barrier if the barrier is known.
        Energy = "energy",
        /// Distance of the thrust line outside the structure.
        Thrust = "thrust",
    }
}

impl FromStr for Panel {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::ALL.iter().find(|panel| panel.name() == text);
        found.copied().ok_or_else(|| {
            let names: Vec<_> = Self::ALL.iter().map(|panel| panel.name()).collect();
            format!("the panels are {}", names.join(", "))
        })
    }
}

impl Panel {
    /// Returns true if the panel is among the chosen ones; without a choice, if the picture has space for it. `watched` is true if there are
    /// observed points.
    pub(crate) fn is_drawn(self, chosen: &[Self], figure: Figure, watched: bool) -> bool {
        match self {
            _ if !chosen.is_empty() => chosen.contains(&self),
            Self::Ground | Self::Rotation => true,
            Self::Points => watched,
            // A single column has space for three panels.
            Self::Energy => !(figure.is_column() && watched),
            Self::Joints | Self::Slip | Self::Thrust => !figure.is_column(),
        }
    }
}

/// The panels of a history, shaded by the states of the structure.
pub(crate) struct HistoryPanels<'a> {
    subject: &'a Subject<'a>,
    /// The picture, for panels without shades and for the legend.
    pub(crate) panels: Panels,
    /// Shades of the states.
    shades: Vec<Mark>,
    /// True if there are hops too short to distinguish.
    hops: bool,
    /// True if the accelerations that start the structure are drawn.
    incipient: bool,
}

impl<'a> HistoryPanels<'a> {
    /// Makes panels from the start of the ground motion to this time.
    pub(crate) fn new(
        figure: Figure,
        subject: &'a Subject<'a>,
        end_s: f64,
        states: Option<&StateHistory>,
    ) -> Self {
        let panels = Panels::new(figure, subject.title, [subject.ground.start_s(), end_s]);
        let shades = states.map_or_else(Vec::new, |states| shade(&panels, states));
        Self {
            subject,
            panels,
            shades,
            hops: false,
            incipient: false,
        }
    }

    /// Adds a panel below the others, with this height on the screen.
    pub(crate) fn panel(&mut self, label: &str, height_px: f64, y: Scale, marks: Vec<Mark>) {
        self.hops |= self.shades.iter().any(|mark| mark.name == HOPS.0);
        let shades = self.shades.clone();
        self.panels.panel(label, height_px, y, shades, marks);
    }

    /// Adds a panel with these curves, on a scale that contains all of them; nothing if all curves are zero.
    pub(crate) fn curves(&mut self, label: &str, height_px: f64, curves: Vec<Mark>) {
        if !curves.iter().all(Mark::is_flat) {
            let ticks = if height_px > 200.0 { 6 } else { 3 };
            let y = scale_around(&curves, [], ticks);
            self.panel(label, height_px, y, curves);
        }
    }

    /// Adds the panel of the ground, with the accelerations that start the structure; nothing if the ground does not move.
    pub(crate) fn ground(&mut self, height_px: f64) {
        let (subject, x) = (self.subject, self.panels.x);
        let points = ground::curve_g(subject.ground, subject.gravity_m_s2, x.high);
        let sizes_g = points.iter().map(|point| point.1.abs());
        let largest = sizes_g.fold(0.0, f64::max);
        let [right, left] = subject.incipient_g;
        // Ground that accelerates to the left pushes to the right. Levels far beyond the ground motion would flatten its curve.
        let levels = [right.map(|g| -g), left].into_iter().flatten();
        let mut curves: Vec<Mark> = levels
            .filter(|level| level.abs() < 4.0 * largest)
            .map(|level| {
                let ends = [x.low, x.high].map(|time_s| (time_s, level));
                Mark::curve("A_L", INCIPIENT, ends)
            })
            .collect();
        self.incipient |= !curves.is_empty();
        curves.push(Mark::curve("ground", MAIN, points));
        self.curves("Ground (g)", height_px, curves);
    }

    /// Draws the picture. Its legend has first the specific entries, then those common to all pictures.
    pub(crate) fn finish(mut self, shaded: bool) -> String {
        let keys = &mut self.panels.keys;
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
        self.panels.finish()
    }
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

/// Returns the shades of the states of the structure. A sequence of hops too short to distinguish has one common shade.
fn shade(panels: &Panels, states: &StateHistory) -> Vec<Mark> {
    let (start_s, end_s) = (panels.x.low, panels.x.high);
    let least_s = NARROWEST_PX * (end_s - start_s) / panels.width_px();
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
    let mut bands = Vec::new();
    let begins = [(start_s, states.start)].into_iter().chain(changes);
    for ((from_s, state), to_s) in begins.zip(ends_s) {
        if !is_seen([from_s, to_s]) && to_s < end_s {
            continue;
        }
        if is_seen([drawn_s, from_s]) {
            bands.push(band(HOPS, [drawn_s, from_s]));
            drawn_s = from_s;
        }
        if let Some(shade) = shade_of(state).filter(|_| is_seen([drawn_s, to_s])) {
            bands.push(band(shade, [drawn_s, to_s]));
        }
        drawn_s = to_s;
    }
    bands
}

/// Returns the legend entry for the time of overturning.
pub(crate) fn overturns() -> Key {
    Key::line("overturns", OVERTURNING)
}

/// Returns the mark at the time of overturning.
pub(crate) fn overturning(time_s: f64, y: Scale) -> Mark {
    Mark::upright("overturning", OVERTURNING, time_s, y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_has_three_panels() {
        let shown = |figure: Figure, watched| {
            let shown = Panel::ALL.iter().copied();
            shown
                .filter(|panel| panel.is_drawn(&[], figure, watched))
                .collect::<Vec<_>>()
        };
        let [narrow, wide] = ["84mm", "120mm"].map(|width| width.parse::<Figure>().unwrap());
        let three = [Panel::Ground, Panel::Rotation, Panel::Energy];
        assert_eq!(shown(narrow, false), three);
        let three = [Panel::Ground, Panel::Rotation, Panel::Points];
        assert_eq!(shown(narrow, true), three);
        assert_eq!(shown(wide, true), Panel::ALL);
        let chosen = [Panel::Thrust];
        assert!(Panel::Thrust.is_drawn(&chosen, narrow, true));
        assert!(!Panel::Ground.is_drawn(&chosen, narrow, true));
        assert!("thrusts".parse::<Panel>().is_err());
    }
}
