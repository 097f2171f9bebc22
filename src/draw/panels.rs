//! Plots below one another over a common x axis.

use crate::axes::Scale;
use crate::chart::{Chart, Mark, PANEL_LEFT_PX};
use crate::figure::Figure;
use crate::sheet::{Key, Sheet};
use crate::svg::Frame;

/// Gap between panels.
const GAP_PX: f64 = 30.0;

/// A picture of panels, one below the other, over time.
pub struct Panels {
    figure: Figure,
    title: String,
    /// The common time axis, in seconds.
    pub x: Scale,
    panels: Vec<Chart>,
    /// Entries of the legend.
    pub keys: Vec<Key>,
}

impl Panels {
    /// Makes panels over this range of times, in seconds.
    pub fn new(figure: Figure, title: &str, [start_s, end_s]: [f64; 2]) -> Self {
        let end_s = end_s.max(start_s + f64::MIN_POSITIVE);
        Self {
            figure,
            title: title.to_owned(),
            x: Scale::exactly(start_s, end_s, figure.ticks(10)),
            panels: Vec::new(),
            keys: Vec::new(),
        }
    }

    /// Returns the width of a panel, in pixels.
    pub fn width_px(&self) -> f64 {
        self.figure.right_of(PANEL_LEFT_PX, Frame::default()).width
    }

    /// Adds a panel below the others, with this height on the screen, and with marks below and above its grid.
    pub fn panel(
        &mut self,
        label: &str,
        height_px: f64,
        y: Scale,
        below: Vec<Mark>,
        marks: Vec<Mark>,
    ) {
        self.panels.push(Chart {
            is_panel: true,
            below,
            marks,
            ..Chart::new(height_px, ("", self.x), (label, y))
        });
    }

    /// Draws the picture, with the time axis and the legend below the panels.
    pub fn finish(mut self) -> String {
        if let Some(last) = self.panels.last_mut() {
            last.x.0 = "Time (s)".to_owned();
        }
        let mut sheet = Sheet::new(self.figure, &self.title);
        sheet.gap(20.0);
        for panel in self.panels {
            panel.add_plot(&mut sheet);
            sheet.gap(GAP_PX);
        }
        sheet.gap(30.0);
        sheet.legend(PANEL_LEFT_PX, self.keys);
        sheet.gap(12.0);
        sheet.finish()
    }
}

/// Returns a scale that contains curves, further values and zero, with a small margin so that no curve coincides with the frame.
pub fn scale_around(curves: &[Mark], more: impl IntoIterator<Item = f64>, ticks: u32) -> Scale {
    let values = curves.iter().flat_map(Mark::points).map(|point| point.1);
    let values = values.chain(more).filter(|value| value.is_finite());
    Scale::around(values.map(|value| 1.03 * value).chain([0.0]), ticks)
}
