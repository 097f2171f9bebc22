//! Drawing in SVG: a few shapes, axes with ticks and labels, colours for print and for the colour-blind.
//!
//! A whole plotting library would bring fonts and backends for what is a few strings here. Marks that
//! stand for a result carry its name in `data-name`, for scripts and tests.

use std::fmt::Write as _;

use nalgebra::Vector2;

/// Colours that the colour-blind can tell apart (Okabe and Ito), the dark ones.
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
    /// For what stands behind.
    pub const GREY: &str = "#999999";
}

/// Colours and dashes of the curves of a chart: told apart by either.
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
    /// A line of that look.
    #[must_use]
    pub const fn new(color: &'static str, width: f64, dash: &'static str) -> Self {
        Self { color, width, dash }
    }
}

/// Where a text begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// At the point.
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

/// A drawing.
#[derive(Clone, Debug)]
pub struct Drawing {
    width: f64,
    text: String,
}

/// Size of text in pixels.
const TEXT_PX: f64 = 13.0;

/// Characters of a title that fit even if they are wide.
const MAX_TITLE: usize = 90;

impl Drawing {
    /// A white sheet, in pixels.
    #[must_use]
    pub fn new(width: f64, height: f64) -> Self {
        let mut text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\" font-family=\"Helvetica, Arial, sans-serif\" \
             font-size=\"{TEXT_PX}\">\n"
        );
        let _ = writeln!(
            text,
            "<rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>"
        );
        Self { width, text }
    }

    /// A title in the middle above all else; a long one is cut.
    pub fn title(&mut self, title: &str) {
        let mut shown: String = title.chars().take(MAX_TITLE).collect();
        if title.chars().nth(MAX_TITLE).is_some() {
            shown.push_str("...");
        }
        let at = Vector2::new(0.5 * self.width, 26.0);
        self.label(at, Anchor::Middle, 0.0, &shown);
    }

    /// The file.
    #[must_use]
    pub fn finish(mut self) -> String {
        self.text += "</svg>\n";
        self.text
    }

    /// A polyline named `name`; nothing for less than two points.
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

    /// What `draw` draws, as far as it is within a frame.
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
        let _ = writeln!(
            self.text,
            "<text x=\"{:.2}\" y=\"{:.2}\" text-anchor=\"{anchor}\"{turn}>{}</text>",
            at.x,
            at.y,
            escaped(text),
        );
    }

    /// A legend of lines, one beside the other from `at` to the right; `advance_px` apart.
    pub fn legend<'a>(
        &mut self,
        at: Vector2<f64>,
        advance_px: f64,
        entries: impl IntoIterator<Item = (&'a str, Stroke)>,
    ) {
        let mut x = at.x;
        for (text, stroke) in entries {
            let start = Vector2::new(x, at.y);
            self.line(start, start + Vector2::new(30.0, 0.0), stroke);
            self.label(start + Vector2::new(36.0, 4.5), Anchor::Start, 0.0, text);
            x += advance_px;
        }
    }
}

/// The name of a mark that stands for a result; nothing for others.
fn name_attribute(name: &str) -> String {
    if name.is_empty() {
        String::new()
    } else {
        format!(" data-name=\"{}\"", escaped(name))
    }
}

/// Text with the characters that mean something in XML replaced; control characters are left out.
pub(super) fn escaped(text: &str) -> String {
    let mut escaped = String::new();
    for character in text.chars() {
        match character {
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '&' => escaped += "&amp;",
            '"' => escaped += "&quot;",
            character if character.is_control() || matches!(character, '\u{fffe}' | '\u{ffff}') => {
            }
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

/// How ticks follow one another.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Steps {
    /// By the same difference.
    Linear(f64),
    /// By about the same ratio; equal ratios are equal distances.
    Logarithmic,
}

impl Scale {
    /// The scale that holds all `values`, with about `ticks` ticks; from 0 to 1 for none.
    #[must_use]
    pub fn around(values: impl IntoIterator<Item = f64>, ticks: u32) -> Self {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in values {
            (low, high) = (low.min(value), high.max(value));
        }
        if low > high {
            (low, high) = (0.0, 1.0);
        }
        // A constant gets room of its own size; zero gets room one.
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

    /// The logarithmic scale from `low` to `high` exactly; from the least positive number if that is more.
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

    /// Powers of ten with their multiples, fewer the more of them there are.
    fn logarithmic_ticks(&self) -> Vec<(f64, String)> {
        let decades = (self.high / self.low).log10();
        let digits: &[u32] = match decades {
            _ if decades < 1.0 => &[1, 2, 3, 4, 5, 6, 7, 8, 9],
            _ if decades < 2.0 => &[1, 2, 3, 5, 7],
            _ if decades < 4.0 => &[1, 2, 5],
            _ => &[1],
        };
        #[expect(clippy::cast_possible_truncation, reason = "exponents of an f64")]
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
        // Powers of ten outside the range of plain reading.
        let exponent = step.log10().floor();
        let plain = largest < 1e5 && exponent >= -5.0;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "small whole numbers"
        )]
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

    /// The value at a part of the axis, from 0 to 1.
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

/// The distance 1, 2 or 5 times a power of ten that cuts `span` into about `ticks` parts.
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
    /// Where it is.
    pub frame: Frame,
    /// Along the lower side.
    pub x: Scale,
    /// Along the left side.
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

    /// Draws frame, ticks and labels; without `x_label` the lower side has ticks only.
    pub fn draw(&self, drawing: &mut Drawing, x_label: Option<&str>, y_label: &str) {
        let thin = Stroke::new(color::BLACK, 0.8, "");
        let faint = Stroke::new("#dddddd", 0.6, "");
        let Frame {
            left,
            top,
            width,
            height,
        } = self.frame;
        let (right, bottom) = (left + width, top + height);
        for (value, text) in self.y.ticks() {
            let y = self.place(self.x.low, value).y;
            drawing.line(Vector2::new(left, y), Vector2::new(right, y), faint);
            drawing.line(Vector2::new(left - 5.0, y), Vector2::new(left, y), thin);
            let at = Vector2::new(left - 8.0, y + 4.5);
            drawing.label(at, Anchor::End, 0.0, &text);
        }
        for (value, text) in self.x.ticks() {
            let x = self.place(value, self.y.low).x;
            drawing.line(Vector2::new(x, bottom), Vector2::new(x, bottom + 5.0), thin);
            if x_label.is_some() {
                let at = Vector2::new(x, bottom + 19.0);
                drawing.label(at, Anchor::Middle, 0.0, &text);
            }
        }
        let frame = format!("M{left} {top}H{right}V{bottom}H{left}Z");
        drawing.path("", &frame, "none", thin);
        let at = Vector2::new(left - 58.0, top + 0.5 * height);
        drawing.label(at, Anchor::Middle, 90.0, y_label);
        if let Some(label) = x_label {
            let at = Vector2::new(left + 0.5 * width, bottom + 38.0);
            drawing.label(at, Anchor::Middle, 0.0, label);
        }
    }
}

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
    fn text_is_escaped() {
        let mut drawing = Drawing::new(10.0, 10.0);
        let text = "a < b & \"c\" \u{7}";
        drawing.label(Vector2::zeros(), Anchor::Start, 0.0, text);
        assert!(
            drawing
                .finish()
                .contains("a &lt; b &amp; &quot;c&quot; </text>")
        );
    }
}
