//! Drawing in SVG: a few shapes, and colours for print and for colour-blind readers.
//!
//! Plotting libraries need fonts and backends, while a few strings are enough here. Marks of results have their name in `data-name`, for scripts
//! and tests.

use std::fmt::{self, Write as _};
use std::str::FromStr;

use nalgebra::Vector2;

use crate::text::{FONTS, TEXT_PX, Text, escaped};

/// Dark colours that colour-blind people can distinguish (Okabe and Ito).
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
    /// For text and axes on a dark background.
    pub const WHITE: &str = "#ffffff";
    /// For things in the background.
    pub const GREY: &str = "#999999";
}

/// Colours and dashes of the curves of a chart; either distinguishes the curves.
pub const CURVES: [Stroke; 6] = [
    Stroke::new(color::BLUE, 1.6, ""),
    Stroke::new(color::VERMILION, 1.6, "7 3"),
    Stroke::new(color::GREEN, 1.6, "2 2"),
    Stroke::new(color::PURPLE, 1.6, "9 3 2 3"),
    Stroke::new(color::ORANGE, 1.6, "12 4"),
    Stroke::new(color::BLACK, 1.6, "4 2 1 2"),
];

/// Stroke of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Colour.
    pub color: &'static str,
    /// Width in pixels.
    pub width: f64,
    /// Lengths of dashes and gaps; empty for a solid line.
    pub dash: &'static str,
}

impl Stroke {
    /// Makes a stroke with these properties.
    pub const fn new(color: &'static str, width: f64, dash: &'static str) -> Self {
        Self { color, width, dash }
    }
}

/// Alignment of a text to its point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// The text begins at the point.
    Start,
    /// The middle of the text is at the point.
    Middle,
    /// The text ends at the point.
    End,
}

/// Colour behind a picture: red, green and blue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Background(pub [u8; 3]);

impl Background {
    /// White.
    pub const WHITE: Self = Self([255; 3]);

    /// Returns the colour of texts and lines that can be seen on this colour: black or white.
    pub fn ink(self) -> &'static str {
        // Weights of ITU-R BT.601.
        let [red, green, blue] = self.0.map(f64::from);
        let is_dark = 0.299 * red + 0.587 * green + 0.114 * blue < 128.0;
        if is_dark { color::WHITE } else { color::BLACK }
    }
}

impl fmt::Display for Background {
    /// Writes the colour for SVG.
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [red, green, blue] = self.0;
        write!(to, "#{red:02x}{green:02x}{blue:02x}")
    }
}

impl FromStr for Background {
    type Err = String;

    /// Parses `white`, `black` or six hexadecimal digits, with or without `#`.
    fn from_str(text: &str) -> Result<Self, String> {
        let digits = match text {
            "white" => "ffffff",
            "black" => "000000",
            text => text.trim_start_matches('#'),
        };
        let number = u32::from_str_radix(digits, 16).ok();
        let number = number.filter(|_| digits.len() == 6 && !digits.starts_with('+'));
        let wrong = "give white, black or a colour as rrggbb, such as f5f0e6";
        let [_, rest @ ..] = number.ok_or(wrong)?.to_be_bytes();
        Ok(Self(rest))
    }
}

/// A mark with words that a browser shows under the pointer.
#[derive(Clone, Debug, PartialEq)]
pub struct Symbol {
    /// Attributes of the mark in the notation of SVG, for styles and scripts of a page.
    pub attributes: String,
    /// The words.
    pub words: String,
    /// Shapes around zero, in the notation of SVG.
    pub shapes: String,
}

/// A rectangle in pixels, y downwards.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
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

impl Frame {
    /// Returns left, top, width and height.
    pub(crate) const fn parts(&self) -> [f64; 4] {
        [self.left, self.top, self.width, self.height]
    }
}

/// A drawing.
#[derive(Clone, Debug, Default)]
pub struct Drawing(String);

impl Drawing {
    /// Returns the complete file, with this width and height in pixels, this width in print, and this colour behind the shapes.
    pub fn finish(
        self,
        size_px: [f64; 2],
        width_mm: Option<f64>,
        background: Background,
    ) -> String {
        let [width_px, height_px] = size_px.map(|length| (length * 1e3).round() / 1e3);
        let [wide, high] = match width_mm {
            None => [width_px.to_string(), height_px.to_string()],
            Some(width_mm) => [
                format!("{width_mm}mm"),
                format!("{:.3}mm", height_px * width_mm / width_px),
            ],
        };
        // Only texts have no colour of their own.
        let ink = match background.ink() {
            color::BLACK => String::new(),
            ink => attribute("fill", ink),
        };
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{wide}\" height=\"{high}\" \
             viewBox=\"0 0 {width_px} {height_px}\" font-family=\"{FONTS}\" \
             font-size=\"{TEXT_PX}\"{ink}>\n\
             <rect width=\"{width_px}\" height=\"{height_px}\" fill=\"{background}\"/>\n{}</svg>\n",
            self.0
        )
    }

    /// Adds a polyline, interrupted at points that are not finite; nothing without two consecutive finite points.
    pub fn curve(
        &mut self,
        name: &str,
        points: impl IntoIterator<Item = Vector2<f64>>,
        stroke: Stroke,
    ) {
        let (mut path, mut command, mut has_line) = (String::new(), "M", false);
        for point in points {
            if !(point.x.is_finite() && point.y.is_finite()) {
                command = "M";
                continue;
            }
            let _ = write!(path, "{command}{:.2} {:.2}", point.x, point.y);
            has_line |= command == " ";
            command = " ";
        }
        if has_line {
            self.path(name, &path, "none", stroke);
        }
    }

    /// Adds a closed polygon.
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

    /// Adds boxes between opposite corners, as one path; nothing without boxes.
    pub fn boxes(
        &mut self,
        name: &str,
        boxes: impl IntoIterator<Item = [Vector2<f64>; 2]>,
        stroke: Stroke,
    ) {
        let mut path = String::new();
        for [from, to] in boxes {
            let _ = write!(
                path,
                "M{:.2} {:.2}H{:.2}V{:.2}H{:.2}Z",
                from.x, from.y, to.x, to.y, from.x
            );
        }
        if !path.is_empty() {
            self.path(name, &path, stroke.color, stroke);
        }
    }

    /// Adds a path in the notation of SVG.
    pub fn path(&mut self, name: &str, path: &str, fill: &str, stroke: Stroke) {
        let name = attribute("data-name", name);
        let dash = attribute("stroke-dasharray", stroke.dash);
        let _ = writeln!(
            self.0,
            "<path{name} d=\"{path}\" fill=\"{fill}\" stroke=\"{}\" stroke-width=\"{}\"{dash} \
             stroke-linejoin=\"round\"/>",
            stroke.color, stroke.width,
        );
    }

    /// Adds a straight line.
    pub fn line(&mut self, from: Vector2<f64>, to: Vector2<f64>, stroke: Stroke) {
        self.curve("", [from, to], stroke);
    }

    /// Adds a circle, filled white so that lines below it are hidden.
    pub fn circle(&mut self, name: &str, center: Vector2<f64>, radius: f64, stroke: Stroke) {
        let (name, [x, y]) = (attribute("data-name", name), [center.x, center.y]);
        let Stroke { color, width, .. } = stroke;
        let _ = writeln!(
            self.0,
            "<circle{name} cx=\"{x:.3}\" cy=\"{y:.3}\" r=\"{radius}\" fill=\"#ffffff\" \
             stroke=\"{color}\" stroke-width=\"{width}\"/>"
        );
    }

    /// Adds a symbol.
    pub fn symbol(&mut self, at: Vector2<f64>, symbol: &Symbol) {
        let Symbol {
            attributes,
            words,
            shapes,
        } = symbol;
        let _ = writeln!(
            self.0,
            "<g {attributes} transform=\"translate({:.2} {:.2})\"><title>{}</title>{shapes}</g>",
            at.x,
            at.y,
            escaped(words),
        );
    }

    /// Adds a shaded rectangle.
    pub fn band(&mut self, name: &str, frame: &Frame, fill: &str, opacity: f64) {
        let (name, [left, top, wide, high]) = (attribute("data-name", name), frame.parts());
        let _ = writeln!(
            self.0,
            "<rect{name} x=\"{left:.2}\" y=\"{top:.2}\" width=\"{wide:.2}\" height=\"{high:.2}\" \
             fill=\"{fill}\" fill-opacity=\"{opacity}\"/>"
        );
    }

    /// Adds the shapes of `draw`, clipped to a frame.
    pub fn within(&mut self, frame: &Frame, draw: impl FnOnce(&mut Self)) {
        let [left, top, width, height] = frame.parts();
        let _ = writeln!(
            self.0,
            "<svg x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"{left} {top} {width} {height}\">"
        );
        draw(self);
        self.0 += "</svg>\n";
    }

    /// Adds a line of text with its baseline at `at`, rotated anticlockwise by `turn_deg`.
    pub fn label(
        &mut self,
        at: Vector2<f64>,
        anchor: Anchor,
        turn_deg: f64,
        text: impl Into<Text>,
    ) {
        let text = text.into();
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let mut turn = String::new();
        if turn_deg != 0.0 {
            turn = format!("rotate({} {:.2} {:.2})", -turn_deg, at.x, at.y);
        }
        let turn = attribute("transform", &turn);
        // Fits other fonts than Helvetica to the computed width.
        let mut long = String::new();
        if text.is_measured() {
            let px = text.px();
            long = format!(" textLength=\"{px:.2}\" lengthAdjust=\"spacingAndGlyphs\"");
        }
        let _ = writeln!(
            self.0,
            "<text x=\"{:.2}\" y=\"{:.2}\" text-anchor=\"{anchor}\"{turn}{long}>{}</text>",
            at.x,
            at.y,
            escaped(&text.shown),
        );
    }

    /// Adds an unfilled rectangle.
    pub fn outline(&mut self, frame: &Frame, stroke: Stroke) {
        let [left, top, wide, high] = frame.parts();
        let path = format!("M{left:.2} {top:.2}h{wide:.2}v{high:.2}h-{wide:.2}Z");
        self.path("", &path, "none", stroke);
    }
}

/// Returns an attribute; empty without a value.
fn attribute(name: &str, value: &str) -> String {
    match value {
        "" => String::new(),
        value => format!(" {name}=\"{}\"", escaped(value)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_escaped() {
        let mut drawing = Drawing::default();
        let text = "a < b & \"c\" \u{7}\u{202e}";
        drawing.label(Vector2::zeros(), Anchor::Start, 0.0, text);
        assert!(
            drawing
                .finish([10.0; 2], None, Background::WHITE)
                .contains("a &lt; b &amp; &quot;c&quot; \\u0007\\u202e</text>")
        );
    }

    #[test]
    fn curves_are_interrupted_where_there_is_no_value() {
        let at = |x: f64| Vector2::new(x, 0.0);
        let stroke = Stroke::new(color::BLACK, 1.0, "");
        let drawn = |points: &[f64]| {
            let mut drawing = Drawing::default();
            drawing.curve("c", points.iter().map(|x| at(*x)), stroke);
            drawing.0
        };
        assert!(drawn(&[0.0, 1.0, f64::NAN, 2.0, 3.0]).contains("M0.00 0.00 1.00 0.00M2.00 0.00"));
        assert_eq!(drawn(&[0.0, f64::NAN, 2.0]), "");
    }
}
