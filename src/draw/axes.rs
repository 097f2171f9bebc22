//! Scales, their ticks, and the frame of a plot with its labels.

use nalgebra::Vector2;

use crate::figure::RIGHT_PX;
use crate::svg::{Anchor, Drawing, Frame, Stroke, color};
use crate::text::{LINE_PX, TEXT_PX, Text};

/// A range of values along an axis, widened to its outer ticks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// Value at the start of the axis.
    pub low: f64,
    /// Value at the end of the axis.
    pub high: f64,
    spacing: TickSpacing,
}

/// The spacing of ticks.
#[derive(Clone, Copy, Debug, PartialEq)]
enum TickSpacing {
    /// Equal differences.
    Linear(f64),
    /// About equal ratios; on the axis equal ratios have equal distances.
    Logarithmic,
}

impl Scale {
    /// Makes a scale that contains all `values`, with about `ticks` ticks; from 0 to 1 without values.
    pub fn around(values: impl IntoIterator<Item = f64>, ticks: u32) -> Self {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in values {
            (low, high) = (low.min(value), high.max(value));
        }
        if low > high {
            (low, high) = (0.0, 1.0);
        }
        // The margin of a constant is half its value; the margin of zero is one.
        if high - low <= 1e-9 * high.abs().max(low.abs()) {
            let room = if high == 0.0 { 1.0 } else { 0.5 * high.abs() };
            (low, high) = (low - room, high + room);
        }
        let step = tick_step(high - low, ticks);
        Self {
            low: (low / step + 1e-9).floor() * step,
            high: (high / step - 1e-9).ceil() * step,
            spacing: TickSpacing::Linear(step),
        }
    }

    /// Makes a scale from `low` to `high` exactly, with about `ticks` ticks.
    pub fn exactly(low: f64, high: f64, ticks: u32) -> Self {
        Self {
            low,
            high,
            spacing: TickSpacing::Linear(tick_step(high - low, ticks)),
        }
    }

    /// Makes a logarithmic scale from `low` to `high` exactly; `low` is raised to the smallest positive number if necessary.
    pub const fn logarithmic(low: f64, high: f64) -> Self {
        Self {
            low: low.max(f64::MIN_POSITIVE),
            high,
            spacing: TickSpacing::Logarithmic,
        }
    }

    /// Returns the positions of the ticks with their texts.
    pub fn ticks(&self) -> Vec<(f64, String)> {
        match self.spacing {
            TickSpacing::Linear(step) => self.linear_ticks(step),
            TickSpacing::Logarithmic => self.logarithmic_ticks(),
        }
    }

    /// Returns ticks at powers of ten and multiples of them; the more powers, the fewer multiples.
    fn logarithmic_ticks(&self) -> Vec<(f64, String)> {
        let decades = libm::log10(self.high / self.low);
        let digits: &[u32] = match decades {
            _ if decades < 1.0 => &[1, 2, 3, 4, 5, 6, 7, 8, 9],
            _ if decades < 2.0 => &[1, 2, 3, 5, 7],
            _ if decades < 4.0 => &[1, 2, 5],
            _ => &[1],
        };
        let [first, last] = [self.low, self.high].map(|end| libm::log10(end).floor() as i32);
        (first..=last)
            .flat_map(|exponent| digits.iter().map(move |digit| (*digit, exponent)))
            .filter_map(|(digit, exponent)| {
                let text = format!("{digit}e{exponent}");
                let value: f64 = text.parse().ok()?;
                let within = value >= self.low * (1.0 - 1e-9) && value <= self.high * (1.0 + 1e-9);
                let plain = (-4..5).contains(&exponent);
                within.then(|| (value, if plain { value.to_string() } else { text }))
            })
            .collect()
    }

    fn linear_ticks(&self, step: f64) -> Vec<(f64, String)> {
        let first = (self.low / step - 1e-6).ceil();
        let count = (self.high / step + 1e-6).floor() - first;
        let largest = self.low.abs().max(self.high.abs());
        // Very large and very small values are written as powers of ten.
        let exponent = libm::log10(step).floor();
        let plain = largest < 1e5 && exponent >= -5.0;
        let (count, digits) = (count.max(0.0) as u32, (-exponent).max(0.0) as usize);
        (0..=count)
            .map(|i| {
                let value = (first + f64::from(i)) * step + 0.0;
                let text = match plain {
                    true => format!("{value:.digits$}"),
                    false => format!("{value:.1e}"),
                };
                (value, text)
            })
            .collect()
    }

    /// Returns the value at a fraction of the axis, from 0 to 1.
    pub fn at(&self, part: f64) -> f64 {
        match self.spacing {
            TickSpacing::Linear(_) => self.low + part * (self.high - self.low),
            TickSpacing::Logarithmic => self.low * libm::pow(self.high / self.low, part),
        }
    }

    fn part(&self, value: f64) -> f64 {
        match self.spacing {
            TickSpacing::Linear(_) => (value - self.low) / (self.high - self.low),
            TickSpacing::Logarithmic => {
                libm::log(value / self.low) / libm::log(self.high / self.low)
            }
        }
    }
}

/// Returns a tick distance, 1, 2 or 5 times a power of ten, that divides `span` into about `ticks` parts.
fn tick_step(span: f64, ticks: u32) -> f64 {
    let rough = span / f64::from(ticks.max(1));
    let power = libm::pow(10.0, libm::log10(rough).floor());
    let digit = rough / power;
    power
        * match digit {
            _ if digit < 1.5 => 1.0,
            _ if digit < 3.5 => 2.0,
            _ if digit < 7.5 => 5.0,
            _ => 10.0,
        }
}

/// A frame with scales, which converts values to positions on the sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axes {
    /// Position of the frame.
    pub frame: Frame,
    /// Scale along the lower side.
    pub x: Scale,
    /// Scale along the left side.
    pub y: Scale,
}

impl Axes {
    /// Returns the position of a pair of values.
    pub fn place(&self, x: f64, y: f64) -> Vector2<f64> {
        let [left, top, width, height] = self.frame.parts();
        let x = left + width * self.x.part(x);
        Vector2::new(x, top + height * (1.0 - self.y.part(y)))
    }

    /// Draws frame, ticks and the label of the y axis. The label of a panel is above the frame.
    pub(crate) fn draw(
        &self,
        drawing: &mut Drawing,
        decimal_mark: &str,
        y_label: &str,
        is_panel: bool,
    ) {
        let widest_px = self.grid(drawing, decimal_mark);
        let [left, top, _, height] = self.frame.parts();
        if is_panel {
            let at = Vector2::new(left, top - 7.0);
            return drawing.label(at, Anchor::Start, 0.0, y_label);
        }
        // Left of the tick texts, in as many lines as necessary.
        let mut x = (left - TICK_TEXT_PX - widest_px - 6.0).min(left - 54.0);
        for line in Text::lines(y_label, height.max(120.0)).into_iter().rev() {
            let at = Vector2::new(x, top + 0.5 * height);
            drawing.label(at, Anchor::Middle, 90.0, line);
            x -= LINE_PX;
        }
    }

    /// Draws frame and ticks, and the texts of the y axis. Returns the width of the widest text.
    fn grid(&self, drawing: &mut Drawing, decimal_mark: &str) -> f64 {
        let thin = Stroke::new(color::BLACK, 0.8, "");
        let faint = Stroke::new("#dddddd", 0.6, "");
        let [left, top, width, height] = self.frame.parts();
        let (right, bottom) = (left + width, top + height);
        let mut widest_px: f64 = 0.0;
        // Texts are drawn from bottom to top; overlapping ones are omitted.
        let mut highest = f64::INFINITY;
        for (value, text) in self.y.ticks() {
            let y = self.place(self.x.low, value).y;
            drawing.line(Vector2::new(left, y), Vector2::new(right, y), faint);
            drawing.line(Vector2::new(left - 5.0, y), Vector2::new(left, y), thin);
            if highest - y >= TEXT_PX {
                let text = Text::from(text.replace('.', decimal_mark));
                widest_px = widest_px.max(text.px());
                let at = Vector2::new(left - TICK_TEXT_PX, y + 4.5);
                drawing.label(at, Anchor::End, 0.0, text);
                highest = y;
            }
        }
        for (value, _) in self.x.ticks() {
            let x = self.place(value, self.y.low).x;
            drawing.line(Vector2::new(x, bottom), Vector2::new(x, bottom + 5.0), thin);
        }
        let frame = format!("M{left} {top}H{right}V{bottom}H{left}Z");
        drawing.path("", &frame, "none", thin);
        widest_px
    }

    /// Draws the tick texts on the lower side and the label of the axis; nothing without a label.
    pub(crate) fn label_x(&self, drawing: &mut Drawing, decimal_mark: &str, label: &str) {
        if label.is_empty() {
            return;
        }
        let bottom = self.frame.top + self.frame.height;
        // Texts are drawn from left to right; overlapping ones are omitted.
        let mut farthest = f64::NEG_INFINITY;
        for (value, text) in self.x.ticks() {
            let text = Text::from(text.replace('.', decimal_mark));
            let half = 0.5 * text.px();
            let at = Vector2::new(self.place(value, self.y.low).x, bottom + 19.0);
            if at.x - half >= farthest {
                farthest = at.x + half + 5.0;
                drawing.label(at, Anchor::Middle, 0.0, text);
            }
        }
        // The label is centred, unless it would extend beyond the sheet.
        let label = Text::from(label);
        let middle = self.frame.left + 0.5 * self.frame.width;
        let most = self.frame.left + self.frame.width + RIGHT_PX - 0.5 * label.px() - 4.0;
        let at = Vector2::new(middle.min(most), bottom + 38.0);
        drawing.label(at, Anchor::Middle, 0.0, label);
    }
}

/// Distance from the y axis to the texts of its ticks.
const TICK_TEXT_PX: f64 = 8.0;

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(scale: Scale) -> Vec<String> {
        scale.ticks().into_iter().map(|(_, text)| text).collect()
    }

    #[test]
    fn ticks_are_round_numbers_that_hold_the_values() {
        assert_eq!(
            texts(Scale::around([-0.3, 0.05], 4)),
            ["-0.3", "-0.2", "-0.1", "0.0", "0.1"]
        );
        assert_eq!(
            texts(Scale::around([0.0, 3.4], 4)),
            ["0", "1", "2", "3", "4"]
        );
        assert_eq!(
            texts(Scale::exactly(0.0, 3.365, 8)),
            ["0.0", "0.5", "1.0", "1.5", "2.0", "2.5", "3.0"]
        );
        assert_eq!(texts(Scale::around([], 2)), ["0.0", "0.5", "1.0"]);
        assert_eq!(texts(Scale::around([0.0; 3], 2)), ["-1", "0", "1"]);
        assert_eq!(texts(Scale::around([2e-9, 4e-9], 2)).len(), 3);
    }

    #[test]
    fn logarithmic_ticks_are_digits_times_powers_of_ten() {
        assert_eq!(
            texts(Scale::logarithmic(0.05, 1.0)),
            ["0.05", "0.07", "0.1", "0.2", "0.3", "0.5", "0.7", "1"]
        );
        assert_eq!(
            texts(Scale::logarithmic(0.01, 2.0)),
            ["0.01", "0.02", "0.05", "0.1", "0.2", "0.5", "1", "2"]
        );
        assert_eq!(texts(Scale::logarithmic(0.3, 0.5)), ["0.3", "0.4", "0.5"]);
        assert_eq!(
            texts(Scale::logarithmic(1e-6, 1.0)),
            ["1e-6", "1e-5", "0.0001", "0.001", "0.01", "0.1", "1"]
        );
        let scale = Scale::logarithmic(0.1, 10.0);
        assert!((scale.part(1.0) - 0.5).abs() < 1e-15);
    }
}
