//! Drawing in SVG: a few shapes, axes with ticks and labels, colours for print and for the colour-blind.
//!
//! A plotting library would bring fonts and backends where a few strings are enough. Marks that
//! stand for a result carry its name in `data-name`, for scripts and tests.

use std::fmt::Write as _;

use nalgebra::Vector2;

pub use super::figure::Figure;
use super::figure::{self, LINE_PX, TEXT_PX, lines, text_px};
use crate::scenario::shown_lines;

/// Colours that colour-blind people can tell apart (Okabe and Ito), the dark ones.
pub mod color {
    /// Blue.
    pub const BLUE: &str = "#0072b2";
    /// Vermilion.
    pub const VERMILION: &str = "#d55e00";
    /// Bluish green.
    pub const GREEN: &str = "#009e73";
    /// Reddish purple.
    pub const PURPLE: &str = "#cc79a7";
    /// Orange.
    pub const ORANGE: &str = "#e69f00";
    /// Sky blue.
    pub const SKY: &str = "#56b4e9";
    /// For text and axes.
    pub const BLACK: &str = "#000000";
    /// For things in the background.
    pub const GREY: &str = "#999999";
}

/// Colours and dashes of the curves of a chart; either is enough to tell them apart.
pub const CURVES: [Stroke; 6] = [
    Stroke::new(color::BLUE, 1.6, ""),
    Stroke::new(color::VERMILION, 1.6, "7 3"),
    Stroke::new(color::GREEN, 1.6, "2 2"),
    Stroke::new(color::PURPLE, 1.6, "9 3 2 3"),
    Stroke::new(color::ORANGE, 1.6, "12 4"),
    Stroke::new(color::BLACK, 1.6, "4 2 1 2"),
];

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Colour.
    pub color: &'static str,
    /// Width in pixels.
    pub width: f64,
    /// Lengths of dashes and gaps; empty: solid.
    pub dash: &'static str,
}

impl Stroke {
    /// A line with these properties.
    #[must_use]
    pub const fn new(color: &'static str, width: f64, dash: &'static str) -> Self {
        Self { color, width, dash }
    }
}

/// How a text is aligned to its point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// It begins at the point.
    Start,
    /// Its middle is at the point.
    Middle,
    /// It ends at the point.
    End,
}

/// A rectangle in pixels, y downwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Left side.
    pub left: f64,
    /// Upper side.
    pub top: f64,
    /// Width.
    pub width: f64,
    /// Height.
    pub height: f64,
}

/// Fonts of the measures that texts are laid out by.
pub(crate) const FONTS: &str = "Helvetica, Arial, Liberation Sans, Nimbus Sans, sans-serif";

/// Largest number of lines of a title; the rest is cut off.
const TITLE_LINES: usize = 3;
/// Where a drawing begins that has no title.
const NO_TITLE_PX: f64 = 4.0;

/// A drawing.
#[derive(Clone, Debug)]
pub struct Drawing {
    figure: Figure,
    text: String,
}

impl Drawing {
    /// A white sheet.
    #[must_use]
    pub const fn new(figure: Figure) -> Self {
        Self {
            figure,
            text: String::new(),
        }
    }

    /// A centred title above everything else, in a few lines; a very long one is cut off. Returns the position of its lower end.
    pub fn title(&mut self, title: &str) -> f64 {
        if !self.figure.has_title() {
            return NO_TITLE_PX;
        }
        let width_px = self.figure.width_px() - 20.0;
        let mut lines = lines(title, width_px);
        if lines.len() > TITLE_LINES {
            lines.truncate(TITLE_LINES);
            lines[TITLE_LINES - 1].push_str(" ...");
        }
        self.paragraph(&lines, Vector2::new(0.5 * self.figure.width_px(), 26.0))
    }

    /// Centred text below a title that ends at `top`; left out with the title. Returns the position of its lower end.
    pub fn subtitle(&mut self, top: f64, text: &str) -> f64 {
        if self.figure.has_title() {
            self.caption(top + 11.0, text)
        } else {
            top
        }
    }

    /// Centred text, its first baseline at `y`, in as many lines as it needs; returns the position of its lower end.
    pub fn caption(&mut self, y: f64, text: &str) -> f64 {
        let middle = Vector2::new(0.5 * self.figure.width_px(), y);
        self.caption_at(middle, self.figure.width_px() - 20.0, text)
    }

    /// The same around the middle of its first baseline, with this width at most.
    pub fn caption_at(&mut self, middle: Vector2<f64>, width_px: f64, text: &str) -> f64 {
        self.paragraph(&lines(text, width_px), middle)
    }

    fn paragraph(&mut self, lines: &[String], middle: Vector2<f64>) -> f64 {
        let mut y = middle.y;
        for line in lines {
            let at = Vector2::new(middle.x, y);
            self.label(at, Anchor::Middle, 0.0, line);
            y += LINE_PX;
        }
        y - LINE_PX + 8.0
    }

    /// The complete file, with this height in pixels.
    #[must_use]
    pub fn finish(self, height: f64) -> String {
        let (width_px, width_mm) = (self.figure.width_px(), self.figure.width_mm());
        let thousandths = |length: f64| (length * 1e3).round() / 1e3;
        let (width_px, height) = (thousandths(width_px), thousandths(height));
        let (wide, high) = match width_mm {
            None => (width_px.to_string(), height.to_string()),
            Some(width_mm) => (
                format!("{width_mm}mm"),
                format!("{:.3}mm", height * width_mm / width_px),
            ),
        };
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{wide}\" height=\"{high}\" \
             viewBox=\"0 0 {width_px} {height}\" font-family=\"{FONTS}\" \
             font-size=\"{TEXT_PX}\">\n\
             <rect width=\"{width_px}\" height=\"{height}\" fill=\"#ffffff\"/>\n{}</svg>\n",
            self.text
        )
    }

    /// A polyline named `name`; nothing if there are fewer than two points.
    pub fn curve(
        &mut self,
        name: &str,
        points: impl IntoIterator<Item = Vector2<f64>>,
        stroke: Stroke,
    ) {
        let mut path = String::new();
        let mut count = 0;
        for point in points {
            let command = if count == 0 { "M" } else { " " };
            let _ = write!(path, "{command}{:.2} {:.2}", point.x, point.y);
            count += 1;
        }
        if count > 1 {
            self.path(name, &path, "none", stroke);
        }
    }

    /// A closed polygon.
    pub fn polygon(
        &mut self,
        name: &str,
        corners: impl IntoIterator<Item = Vector2<f64>>,
        fill: &str,
        stroke: Stroke,
    ) {
        let mut path = String::new();
        for corner in corners {
            let command = if path.is_empty() { "M" } else { " " };
            let _ = write!(path, "{command}{:.2} {:.2}", corner.x, corner.y);
        }
        path.push('Z');
        self.path(name, &path, fill, stroke);
    }

    /// A path in SVG's own notation.
    pub fn path(&mut self, name: &str, path: &str, fill: &str, stroke: Stroke) {
        let name = name_attribute(name);
        let dash = if stroke.dash.is_empty() {
            String::new()
        } else {
            format!(" stroke-dasharray=\"{}\"", stroke.dash)
        };
        let _ = writeln!(
            self.text,
            "<path{name} d=\"{path}\" fill=\"{fill}\" stroke=\"{}\" stroke-width=\"{}\"{dash} \
             stroke-linejoin=\"round\"/>",
            stroke.color, stroke.width,
        );
    }

    /// A straight line.
    pub fn line(&mut self, from: Vector2<f64>, to: Vector2<f64>, stroke: Stroke) {
        self.curve("", [from, to], stroke);
    }

    /// A circle, filled white so that it can be seen on lines.
    pub fn circle(&mut self, name: &str, center: Vector2<f64>, radius: f64, stroke: Stroke) {
        let _ = writeln!(
            self.text,
            "<circle{} cx=\"{:.3}\" cy=\"{:.3}\" r=\"{radius}\" fill=\"#ffffff\" \
             stroke=\"{}\" stroke-width=\"{}\"/>",
            name_attribute(name),
            center.x,
            center.y,
            stroke.color,
            stroke.width,
        );
    }

    /// A shaded rectangle.
    pub fn band(&mut self, name: &str, frame: &Frame, fill: &str, opacity: f64) {
        let _ = writeln!(
            self.text,
            "<rect{} x=\"{:.2}\" y=\"{:.2}\" width=\"{:.2}\" height=\"{:.2}\" \
             fill=\"{fill}\" fill-opacity=\"{opacity}\"/>",
            name_attribute(name),
            frame.left,
            frame.top,
            frame.width,
            frame.height,
        );
    }

    /// What `draw` draws, clipped to a frame.
    pub fn within(&mut self, frame: &Frame, draw: impl FnOnce(&mut Self)) {
        let Frame {
            left,
            top,
            width,
            height,
        } = frame;
        let _ = writeln!(
            self.text,
            "<svg x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"{left} {top} {width} {height}\">"
        );
        draw(self);
        self.text += "</svg>\n";
    }

    /// A line of text whose baseline is at `at`, turned anticlockwise by `turn_deg`.
    pub fn label(&mut self, at: Vector2<f64>, anchor: Anchor, turn_deg: f64, text: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let turn = if turn_deg == 0.0 {
            String::new()
        } else {
            format!(
                " transform=\"rotate({} {:.2} {:.2})\"",
                -turn_deg, at.x, at.y
            )
        };
        // Where no font has the measures of Helvetica the text is drawn with the measured length all the same.
        let long = match figure::is_measured(text) {
            true => format!(
                " textLength=\"{:.2}\" lengthAdjust=\"spacingAndGlyphs\"",
                text_px(text)
            ),
            false => String::new(),
        };
        let _ = writeln!(
            self.text,
            "<text x=\"{:.2}\" y=\"{:.2}\" text-anchor=\"{anchor}\"{turn}{long}>{}</text>",
            at.x,
            at.y,
            escaped(text),
        );
    }

    /// A legend below `top`, in as many rows as it needs. From `left` on, each entry has a sign, 24 pixels wide, and its
    /// text. Returns the position of the lower end.
    pub fn legend(&mut self, left: f64, top: f64, entries: &[Key<'_>]) -> f64 {
        if entries.is_empty() {
            return top;
        }
        let right = self.figure.width_px() - 15.0;
        let (mut x, mut y) = (left, top + 0.5 * LEGEND_ROW_PX);
        for (text, sign) in entries {
            let advance = KEY_PX + 6.0 + text_px(text) + 18.0;
            if x > left && x + advance > right {
                (x, y) = (left, y + LEGEND_ROW_PX);
            }
            let middle = Vector2::new(x + 0.5 * KEY_PX, y);
            match *sign {
                Sign::Line(stroke) => {
                    let half = Vector2::new(0.5 * KEY_PX, 0.0);
                    self.line(middle - half, middle + half, stroke);
                }
                Sign::LineOn(fill, name, stroke) => {
                    let frame = Frame {
                        left: x,
                        top: y - 7.0,
                        width: KEY_PX,
                        height: 14.0,
                    };
                    self.band("key", &frame, fill, 1.0);
                    let half = Vector2::new(0.5 * KEY_PX, 0.0);
                    self.curve(
                        &format!("key {name}"),
                        [middle - half, middle + half],
                        stroke,
                    );
                }
                Sign::Band(fill, opacity) => {
                    let frame = Frame {
                        left: x,
                        top: y - 7.0,
                        width: KEY_PX,
                        height: 14.0,
                    };
                    self.band("key", &frame, fill, opacity);
                    self.outline(&frame, Stroke::new(color::GREY, 0.6, ""));
                }
                Sign::Circle(radius, stroke) => self.circle("", middle, radius, stroke),
                Sign::Tick(stroke) => {
                    let half = Vector2::new(0.0, 5.0);
                    self.line(middle - half, middle + half, stroke);
                }
            }
            let at = Vector2::new(x + KEY_PX + 6.0, y + 4.5);
            // A text wider than the picture continues on the next line.
            let lines = lines(text, (right - at.x).max(TEXT_PX));
            for (number, line) in (0_u32..).zip(&lines) {
                let down = Vector2::new(0.0, LINE_PX * f64::from(number));
                self.label(at + down, Anchor::Start, 0.0, line);
                if number > 0 {
                    y += LINE_PX;
                }
            }
            x += advance;
        }
        y + 0.5 * LEGEND_ROW_PX
    }

    /// An unfilled rectangle.
    pub fn outline(&mut self, frame: &Frame, stroke: Stroke) {
        let Frame {
            left,
            top,
            width,
            height,
        } = frame;
        let path = format!("M{left:.2} {top:.2}h{width:.2}v{height:.2}h-{width:.2}Z");
        self.path("", &path, "none", stroke);
    }
}

/// An entry of a legend: its text and its sign.
pub type Key<'a> = (&'a str, Sign);

/// The sign of an entry of a legend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sign {
    /// A line.
    Line(Stroke),
    /// A line on an area of this colour, with the name of what it marks: on dark pages both keep their colours.
    LineOn(&'static str, &'static str, Stroke),
    /// An area of this colour and opacity.
    Band(&'static str, f64),
    /// A circle of this radius in pixels.
    Circle(f64, Stroke),
    /// A short upright line.
    Tick(Stroke),
}

/// Width of a sign in a legend.
const KEY_PX: f64 = 24.0;
/// Height of a row of a legend.
const LEGEND_ROW_PX: f64 = 24.0;

/// The attribute that names a mark for a result; empty for other marks.
fn name_attribute(name: &str) -> String {
    if name.is_empty() {
        String::new()
    } else {
        format!(" data-name=\"{}\"", escaped(name))
    }
}

/// Text made safe to show, with its line ends and tabs, and with the special characters of XML escaped.
pub(crate) fn escaped(text: &str) -> String {
    let mut escaped = String::new();
    for character in shown_lines(text).chars() {
        match character {
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '&' => escaped += "&amp;",
            '"' => escaped += "&quot;",
            character => escaped.push(character),
        }
    }
    escaped
}

/// A range of values along an axis, widened to its outer ticks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// Value at the start of the axis.
    pub low: f64,
    /// Value at its end.
    pub high: f64,
    steps: Steps,
}

/// The spacing of ticks.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Steps {
    /// Equal differences.
    Linear(f64),
    /// About equal ratios; equal ratios have equal distances.
    Logarithmic,
}

impl Scale {
    /// The scale that holds all `values`, with about `ticks` ticks; from 0 to 1 if there are no values.
    #[must_use]
    pub fn around(values: impl IntoIterator<Item = f64>, ticks: u32) -> Self {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in values {
            (low, high) = (low.min(value), high.max(value));
        }
        if low > high {
            (low, high) = (0.0, 1.0);
        }
        // A constant gets a margin of half its size; zero gets a margin of one.
        if high - low <= 1e-9 * high.abs().max(low.abs()) {
            let room = if high == 0.0 { 1.0 } else { 0.5 * high.abs() };
            (low, high) = (low - room, high + room);
        }
        let step = tick_step(high - low, ticks);
        Self {
            low: (low / step + 1e-9).floor() * step,
            high: (high / step - 1e-9).ceil() * step,
            steps: Steps::Linear(step),
        }
    }

    /// The scale from `low` to `high` exactly, with about `ticks` ticks.
    #[must_use]
    pub fn exactly(low: f64, high: f64, ticks: u32) -> Self {
        Self {
            low,
            high,
            steps: Steps::Linear(tick_step(high - low, ticks)),
        }
    }

    /// The logarithmic scale from `low` to `high` exactly; `low` is raised to the least positive number if necessary.
    #[must_use]
    pub const fn logarithmic(low: f64, high: f64) -> Self {
        Self {
            low: low.max(f64::MIN_POSITIVE),
            high,
            steps: Steps::Logarithmic,
        }
    }

    /// Positions of the ticks with their texts.
    #[must_use]
    pub fn ticks(&self) -> Vec<(f64, String)> {
        match self.steps {
            Steps::Linear(step) => self.linear_ticks(step),
            Steps::Logarithmic => self.logarithmic_ticks(),
        }
    }

    /// Powers of ten and multiples of them; the more powers, the fewer multiples.
    fn logarithmic_ticks(&self) -> Vec<(f64, String)> {
        let decades = (self.high / self.low).log10();
        let digits: &[u32] = match decades {
            _ if decades < 1.0 => &[1, 2, 3, 4, 5, 6, 7, 8, 9],
            _ if decades < 2.0 => &[1, 2, 3, 5, 7],
            _ if decades < 4.0 => &[1, 2, 5],
            _ => &[1],
        };
        let [first, last] = [self.low, self.high].map(|end| end.log10().floor() as i32);
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
        // Very large and very small values are written with powers of ten.
        let exponent = step.log10().floor();
        let plain = largest < 1e5 && exponent >= -5.0;
        let (count, digits) = (count.max(0.0) as u32, (-exponent).max(0.0) as usize);
        (0..=count)
            .map(|i| {
                let value = (first + f64::from(i)) * step + 0.0;
                let text = if plain {
                    format!("{value:.digits$}")
                } else {
                    format!("{value:.1e}")
                };
                (value, text)
            })
            .collect()
    }

    /// The value at a fraction of the axis, from 0 to 1.
    #[must_use]
    pub fn at(&self, part: f64) -> f64 {
        match self.steps {
            Steps::Linear(_) => self.low + part * (self.high - self.low),
            Steps::Logarithmic => self.low * (self.high / self.low).powf(part),
        }
    }

    fn part(&self, value: f64) -> f64 {
        match self.steps {
            Steps::Linear(_) => (value - self.low) / (self.high - self.low),
            Steps::Logarithmic => (value / self.low).ln() / (self.high / self.low).ln(),
        }
    }
}

/// The distance, 1, 2 or 5 times a power of ten, that divides `span` into about `ticks` parts.
fn tick_step(span: f64, ticks: u32) -> f64 {
    let rough = span / f64::from(ticks.max(1));
    let power = 10_f64.powf(rough.log10().floor());
    let digit = rough / power;
    power
        * match digit {
            _ if digit < 1.5 => 1.0,
            _ if digit < 3.5 => 2.0,
            _ if digit < 7.5 => 5.0,
            _ => 10.0,
        }
}

/// A frame with scales: places values on the sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axes {
    /// Its position.
    pub frame: Frame,
    /// Scale along the lower side.
    pub x: Scale,
    /// Scale along the left side.
    pub y: Scale,
}

impl Axes {
    /// The place of a pair of values.
    #[must_use]
    pub fn place(&self, x: f64, y: f64) -> Vector2<f64> {
        let Frame {
            left,
            top,
            width,
            height,
        } = self.frame;
        Vector2::new(
            left + width * self.x.part(x),
            top + height * (1.0 - self.y.part(y)),
        )
    }

    /// The corners of a curve that goes across the plot level, from this height, and rises at each x to the height given with it.
    pub(crate) fn staircase(
        &self,
        first: f64,
        rises: impl IntoIterator<Item = (f64, f64)>,
    ) -> Vec<Vector2<f64>> {
        let mut before = first;
        let mut corners = vec![self.place(self.x.low, before)];
        for (x, y) in rises {
            corners.extend([self.place(x, before), self.place(x, y)]);
            before = y;
        }
        corners.push(self.place(self.x.high, before));
        corners
    }

    /// Draws frame, ticks and labels, that of the y axis along it; without `x_label` the lower side has ticks only.
    pub fn draw(&self, drawing: &mut Drawing, x_label: Option<&str>, y_label: &str) {
        let widest = self.grid(drawing);
        let Frame {
            left, top, height, ..
        } = self.frame;
        // Beside the texts of the ticks, in as many lines as it takes.
        let lines = lines(y_label, height.max(120.0));
        let mut x = (left - TICK_TEXT_PX - widest - 6.0).min(left - 54.0);
        for line in lines.iter().rev() {
            let at = Vector2::new(x, top + 0.5 * height);
            drawing.label(at, Anchor::Middle, 90.0, line);
            x -= LINE_PX;
        }
        if let Some(label) = x_label {
            self.label_x(drawing, label);
        }
    }

    /// The same of a panel: the label of the y axis is above it.
    pub fn draw_panel(&self, drawing: &mut Drawing, y_label: &str) {
        self.grid(drawing);
        let at = Vector2::new(self.frame.left, self.frame.top - 7.0);
        drawing.label(at, Anchor::Start, 0.0, y_label);
    }

    /// Draws frame and ticks, those of the y axis with their texts; returns the width of the widest of these.
    fn grid(&self, drawing: &mut Drawing) -> f64 {
        let thin = Stroke::new(color::BLACK, 0.8, "");
        let faint = Stroke::new("#dddddd", 0.6, "");
        let Frame {
            left,
            top,
            width,
            height,
        } = self.frame;
        let (right, bottom) = (left + width, top + height);
        let mut widest: f64 = 0.0;
        // Texts come from below, and none is on another.
        let mut highest = f64::INFINITY;
        for (value, text) in self.y.ticks() {
            let y = self.place(self.x.low, value).y;
            drawing.line(Vector2::new(left, y), Vector2::new(right, y), faint);
            drawing.line(Vector2::new(left - 5.0, y), Vector2::new(left, y), thin);
            if highest - y >= TEXT_PX {
                let at = Vector2::new(left - TICK_TEXT_PX, y + 4.5);
                drawing.label(at, Anchor::End, 0.0, &text);
                widest = widest.max(text_px(&text));
                highest = y;
            }
        }
        for (value, _) in self.x.ticks() {
            let x = self.place(value, self.y.low).x;
            drawing.line(Vector2::new(x, bottom), Vector2::new(x, bottom + 5.0), thin);
        }
        let frame = format!("M{left} {top}H{right}V{bottom}H{left}Z");
        drawing.path("", &frame, "none", thin);
        widest
    }

    /// Draws the labels of the ticks on the lower side, and the label of the axis.
    pub fn label_x(&self, drawing: &mut Drawing, label: &str) {
        let bottom = self.frame.top + self.frame.height;
        // Texts come from the left, and none is on another.
        let mut farthest = f64::NEG_INFINITY;
        for (value, text) in self.x.ticks() {
            let at = Vector2::new(self.place(value, self.y.low).x, bottom + 19.0);
            let half = 0.5 * text_px(&text);
            if at.x - half >= farthest {
                drawing.label(at, Anchor::Middle, 0.0, &text);
                farthest = at.x + half + 5.0;
            }
        }
        // In the middle, unless it would leave the sheet.
        let middle = self.frame.left + 0.5 * self.frame.width;
        let half = 0.5 * text_px(label);
        let most = drawing.figure.width_px() - half - 4.0;
        let at = Vector2::new(middle.min(most), bottom + 38.0);
        drawing.label(at, Anchor::Middle, 0.0, label);
    }
}

/// Texts of ticks of the y axis end so far from it.
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

    #[test]
    fn titles_and_legends_take_the_rows_they_need() {
        let narrow: Figure = "85mm".parse().unwrap();
        let title =
            "An arch of thirty-six voussoirs on two piers under the second of seven records";
        let [short, long] =
            [Figure::SCREEN, narrow].map(|figure| Drawing::new(figure).title(title));
        assert_eq!(long, short + LINE_PX);
        let keys = ["left", "middle", "right", "sways right", "sways left"]
            .map(|text| (text, Sign::Line(CURVES[0])));
        let rows = |figure: Figure| Drawing::new(figure).legend(85.0, 0.0, &keys) / LEGEND_ROW_PX;
        assert_eq!(rows(Figure::SCREEN), 1.0);
        assert_eq!(rows(narrow), 2.0);
        let long = ["a text of a legend that is wider than the picture of a column is"; 2]
            .map(|text| (text, Sign::Line(CURVES[0])));
        let mut drawing = Drawing::new(narrow);
        let end = drawing.legend(85.0, 0.0, &long);
        assert_eq!(end, 2.0 * (LEGEND_ROW_PX + LINE_PX));
        assert_eq!(drawing.finish(end).matches("<text").count(), 4);
        let mut drawing = Drawing::new(narrow);
        drawing.title(&"x".repeat(1000));
        assert!(
            drawing.finish(9.0).len() < 1000,
            "a word without end is cut"
        );
    }

    #[test]
    fn text_is_escaped() {
        let mut drawing = Drawing::new(Figure::SCREEN);
        let text = "a < b & \"c\" \u{7}\u{202e}";
        drawing.label(Vector2::zeros(), Anchor::Start, 0.0, text);
        assert!(
            drawing
                .finish(10.0)
                .contains("a &lt; b &amp; &quot;c&quot; \\u0007\\u202e</text>")
        );
    }
}
