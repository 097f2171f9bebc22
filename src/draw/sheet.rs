//! The layout of a picture: parts below one another, whose heights are known before drawing starts.

use nalgebra::Vector2;

use crate::figure::Figure;
use crate::svg::{Anchor, Drawing, Frame, Stroke, color};
use crate::text::{LINE_PX, TEXT_PX, Text};

/// Largest number of lines of a title; the rest is omitted.
const TITLE_LINES: usize = 3;
/// Space below the baseline of the last line of a text.
const BELOW_TEXT_PX: f64 = 8.0;
/// Limits of the stretch of plots.
const LEAST_STRETCH: f64 = 0.15;
const MOST_STRETCH: f64 = 20.0;

/// A picture to be drawn.
pub struct Sheet<'a> {
    /// The size of the picture.
    pub figure: Figure,
    parts: Vec<(PartHeight, Draw<'a>)>,
}

/// Draws a part into its frame, which is as wide as the sheet.
type Draw<'a> = Box<dyn FnOnce(&mut Drawing, Frame) + 'a>;

/// The height of a part in pixels.
#[derive(Clone, Copy, Debug)]
pub enum PartHeight {
    /// Texts and gaps.
    Fixed(f64),
    /// A plot, which is stretched to give the picture its height.
    Plot(f64),
    /// The drawing of a structure, which is stretched up to the second height, at which it fills the width.
    Structure(f64, f64),
}

impl PartHeight {
    fn at(self, stretch: f64) -> f64 {
        match self {
            Self::Fixed(height_px) => height_px,
            Self::Plot(height_px) => stretch * height_px,
            Self::Structure(height_px, most_px) => (stretch * height_px).min(most_px),
        }
    }
}

/// A picture, and the frames of its parts.
pub struct FinishedSheet {
    /// The picture as SVG.
    pub svg: String,
    /// Its height in pixels.
    pub height_px: f64,
    /// The frames of its parts, in order.
    pub frames: Vec<Frame>,
}

impl<'a> Sheet<'a> {
    /// Makes a sheet with a title of at most a few lines.
    pub fn new(figure: Figure, title: &str) -> Self {
        let mut sheet = Self {
            figure,
            parts: Vec::new(),
        };
        if figure.has_title && !title.is_empty() {
            let mut lines = Text::lines(title, figure.width_px - 20.0);
            if lines.len() > TITLE_LINES {
                lines.truncate(TITLE_LINES);
                lines[TITLE_LINES - 1] = format!("{} ...", lines[TITLE_LINES - 1].shown).into();
            }
            sheet.paragraphs(26.0, vec![(0.5 * figure.width_px, lines)]);
        } else {
            sheet.gap(4.0);
        }
        sheet
    }

    /// Adds a part; returns its index.
    pub fn part(
        &mut self,
        height: PartHeight,
        draw: impl FnOnce(&mut Drawing, Frame) + 'a,
    ) -> usize {
        self.parts.push((height, Box::new(draw)));
        self.parts.len() - 1
    }

    /// Adds a gap.
    pub fn gap(&mut self, height_px: f64) {
        self.part(PartHeight::Fixed(height_px), |_, _| ());
    }

    /// Adds a centred text with as many lines as necessary. The first baseline is `above_px` below the last part.
    pub fn caption(&mut self, above_px: f64, text: &str) {
        self.captions(above_px, &[text]);
    }

    /// Adds centred texts side by side.
    pub fn captions(&mut self, above_px: f64, texts: &[&str]) {
        let cell_px = self.figure.width_px / texts.len() as f64;
        let margin_px = if texts.len() == 1 { 20.0 } else { 16.0 };
        let cells = texts.iter().enumerate().map(|(index, text)| {
            let middle = (index as f64 + 0.5) * cell_px;
            (middle, Text::lines(text, cell_px - margin_px))
        });
        self.paragraphs(above_px, cells.collect());
    }

    /// Adds lines of text centred at each of these positions.
    fn paragraphs(&mut self, above_px: f64, paragraphs: Vec<(f64, Vec<Text>)>) {
        let most = paragraphs.iter().map(|(_, lines)| lines.len()).max();
        let below_first = LINE_PX * most.unwrap_or(0).saturating_sub(1) as f64;
        let height_px = above_px + below_first + BELOW_TEXT_PX;
        self.part(PartHeight::Fixed(height_px), move |drawing, frame| {
            for (middle, lines) in paragraphs {
                let at = Vector2::new(middle, frame.top + above_px);
                draw_lines(drawing, at, Anchor::Middle, lines);
            }
        });
    }

    /// Adds a legend from `left` on, with as many rows as necessary; nothing without entries.
    pub fn legend(&mut self, left: f64, keys: Vec<Key>) {
        if keys.is_empty() {
            return;
        }
        let right = self.figure.width_px - 15.0;
        // In a narrow picture the legend has little space, and begins at its side.
        let ([left, right], row_px, sign_px, apart_px) = match self.figure.width_px < NARROW_PX {
            true => ([8.0, right + 15.0], NARROW_ROW_PX, 14.0, 9.0),
            false => ([left, right], LEGEND_ROW_PX, SIGN_PX, 18.0),
        };
        let text_px = sign_px + 6.0;
        let mut at = Vector2::new(left, 0.5 * row_px);
        let mut placed = Vec::new();
        for Key { text, sign } in keys {
            let advance = text_px + Text::from(&text).px() + apart_px;
            if at.x > left && at.x + advance > right {
                at = Vector2::new(left, at.y + row_px);
            }
            // A text wider than the picture continues on the next line.
            let lines = Text::lines(&text, (right - at.x - text_px).max(TEXT_PX));
            let more = LINE_PX * lines.len().saturating_sub(1) as f64;
            placed.push((at, sign, lines));
            at += Vector2::new(advance, more);
        }
        let height = PartHeight::Fixed(at.y + 0.5 * row_px);
        self.part(height, move |drawing, frame| {
            for (at, sign, lines) in placed {
                let at = at + Vector2::new(0.0, frame.top);
                sign.draw(drawing, at, sign_px);
                let at = at + Vector2::new(text_px, 4.5);
                draw_lines(drawing, at, Anchor::Start, lines);
            }
        });
    }

    /// Draws the picture with the height of the figure, within the limits of stretch.
    pub fn drawn(self) -> FinishedSheet {
        let Self { figure, parts } = self;
        let height = |stretch: f64| parts.iter().map(|(height, _)| height.at(stretch)).sum();
        let stretch = stretch(&height, figure.wanted_px(height(1.0)));
        let (mut drawing, mut frames, mut top) = (Drawing::default(), Vec::new(), 0.0);
        for (height, draw) in parts {
            let frame = Frame {
                left: 0.0,
                top,
                width: figure.width_px,
                height: height.at(stretch),
            };
            frames.push(frame);
            top += frame.height;
            draw(&mut drawing, frame);
        }
        FinishedSheet {
            svg: drawing.finish([figure.width_px, top], figure.width_mm, figure.background),
            height_px: top,
            frames,
        }
    }

    /// Draws the picture and returns its SVG.
    pub fn finish(self) -> String {
        self.drawn().svg
    }
}

/// Finds the stretch at which the height is nearest to the wanted one. `height` increases with the stretch.
fn stretch(height: &dyn Fn(f64) -> f64, wanted_px: f64) -> f64 {
    if height(1.0) == wanted_px {
        return 1.0;
    }
    let (mut low, mut high) = (LEAST_STRETCH, MOST_STRETCH);
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return high;
        }
        if height(middle) >= wanted_px {
            high = middle;
        } else {
            low = middle;
        }
    }
}

/// Draws lines of text below one another, the first at this position.
fn draw_lines(drawing: &mut Drawing, mut at: Vector2<f64>, anchor: Anchor, lines: Vec<Text>) {
    for line in lines {
        drawing.label(at, anchor, 0.0, line);
        at.y += LINE_PX;
    }
}

/// An entry of a legend.
#[derive(Clone, Debug, PartialEq)]
pub struct Key {
    /// The text beside the sign.
    pub text: String,
    /// The sign.
    pub sign: Sign,
}

impl Key {
    /// Makes an entry.
    pub fn new(text: impl Into<String>, sign: Sign) -> Self {
        let text = text.into();
        Self { text, sign }
    }

    /// Makes an entry for a line.
    pub fn line(text: impl Into<String>, stroke: Stroke) -> Self {
        Self::new(text, Sign::Line(stroke))
    }
}

/// The sign of an entry of a legend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sign {
    /// A line.
    Line(Stroke),
    /// A square of this colour with the name of its hatching, which rises to the right if the last value is true. On dark pages both keep their
    /// colours.
    Hatched(&'static str, &'static str, Stroke, bool),
    /// An area of this colour and opacity.
    Band(&'static str, f64),
    /// A circle of this radius in pixels.
    Circle(f64, Stroke),
    /// A short vertical line.
    Tick(Stroke),
}

/// Width of a sign in a legend.
const SIGN_PX: f64 = 24.0;
/// Height of a row of a legend.
const LEGEND_ROW_PX: f64 = 24.0;
/// Height of a row in a narrow picture.
const NARROW_ROW_PX: f64 = 17.0;
/// Width below which a picture is narrow, as for a single column of a journal.
const NARROW_PX: f64 = 460.0;

impl Sign {
    /// Draws the sign; `left` is the middle of its left side.
    fn draw(self, drawing: &mut Drawing, left: Vector2<f64>, width: f64) {
        let ends = [left, left + Vector2::new(width, 0.0)];
        let middle = 0.5 * (ends[0] + ends[1]);
        let frame = Frame {
            left: left.x,
            top: left.y - 7.0,
            width,
            height: 14.0,
        };
        match self {
            Self::Line(stroke) => drawing.curve("", ends, stroke),
            Self::Hatched(fill, name, stroke, rises) => {
                let side = frame.height;
                let left = middle.x - 0.5 * side;
                let square = Frame {
                    left,
                    width: side,
                    ..frame
                };
                drawing.band("key", &square, fill, 1.0);
                let at = |(x, y): (f64, f64)| {
                    let y = if rises { 1.0 - y } else { y };
                    Vector2::new(left + side * x, frame.top + side * y)
                };
                let gap = (f64::NAN, f64::NAN);
                let lines = [
                    (0.0, 0.5),
                    (0.5, 1.0),
                    gap,
                    (0.0, 0.0),
                    (1.0, 1.0),
                    gap,
                    (0.5, 0.0),
                    (1.0, 0.5),
                ];
                drawing.curve(&format!("key {name}"), lines.map(at), stroke);
                drawing.outline(&square, Stroke::new(color::GREY, 0.6, ""));
            }
            Self::Band(fill, opacity) => {
                drawing.band("key", &frame, fill, opacity);
                drawing.outline(&frame, Stroke::new(color::GREY, 0.6, ""));
            }
            Self::Circle(radius, stroke) => drawing.circle("", middle, radius, stroke),
            Self::Tick(stroke) => {
                let half = Vector2::new(0.0, 5.0);
                drawing.line(middle - half, middle + half, stroke);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the part of a picture between two texts.
    fn between<'p>(picture: &'p str, before: &str, after: &str) -> &'p str {
        let (_, rest) = picture.split_once(before).unwrap();
        rest.split_once(after).unwrap().0
    }

    fn height_px(sheet: Sheet<'_>) -> f64 {
        sheet.drawn().height_px
    }

    #[test]
    fn text_is_8_points_at_the_width_of_a_figure() {
        for (text, width_mm) in [("85mm", 85.0), ("17 cm", 170.0), ("3.5in", 88.9)] {
            let figure: Figure = text.parse().unwrap();
            let mut sheet = Sheet::new(figure, "");
            sheet.gap(figure.width_px - 4.0);
            let picture = sheet.finish();
            // A square sheet is as high as it is wide.
            assert_eq!(between(&picture, "width=\"", "mm"), width_mm.to_string());
            assert_eq!(
                between(&picture, "height=\"", "mm"),
                format!("{width_mm:.3}")
            );
            for text_pt in [7.0, 8.0, 9.5] {
                let figure = figure.with_text_pt(text_pt).unwrap();
                let points = TEXT_PX / figure.width_px * width_mm / 25.4 * 72.0;
                assert!((points - text_pt).abs() < 1e-12);
            }
            let wrong = figure.with_text_pt(14.0).is_err();
            assert_eq!(wrong, width_mm < 100.0);
        }
        for wrong in ["85", "5mm", "-85mm", "NaNmm", "infmm", "85 px", ""] {
            assert!(wrong.parse::<Figure>().is_err(), "{wrong}");
        }
        assert!(Figure::SCREEN.with_text_pt(8.0).is_err());
    }

    #[test]
    fn a_picture_has_the_height_of_its_figure() {
        let height_mm = |figure: Figure| {
            // Two plots with a gap are stretched; text is not.
            let mut sheet = Sheet::new(figure, "");
            sheet.part(PartHeight::Plot(figure.height_px(130.0)), |_, _| ());
            sheet.gap(90.0);
            sheet.part(PartHeight::Plot(figure.height_px(260.0)), |_, _| ());
            let picture = sheet.finish();
            between(&picture, "height=\"", "mm").parse::<f64>().unwrap()
        };
        let figure: Figure = "120mm".parse().unwrap();
        for wanted_mm in [40.0, 70.0, 180.0] {
            let height = format!("{wanted_mm} mm").parse().ok();
            assert!((height_mm(Figure { height, ..figure }) - wanted_mm).abs() < 1e-3);
        }
        // The height is at least that of the text.
        let height = "20mm".parse().ok();
        assert!(height_mm(Figure { height, ..figure }) > 20.0);
        for wrong in ["70", "5mm", "-7cm", "8000mm"] {
            assert!(wrong.parse::<crate::Height>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn titles_and_legends_take_the_rows_they_need() {
        let narrow: Figure = "85mm".parse().unwrap();
        let title =
            "An arch of thirty-six voussoirs on two piers under the second of seven records";
        let [short, long] =
            [Figure::SCREEN, narrow].map(|figure| height_px(Sheet::new(figure, title)));
        assert_eq!(long, short + LINE_PX);
        let stroke = Stroke::new(color::BLUE, 1.0, "");
        let legend_px = |figure: Figure, texts: &[&str]| {
            let mut sheet = Sheet::new(figure, "");
            sheet.legend(
                85.0,
                texts.iter().map(|text| Key::line(*text, stroke)).collect(),
            );
            height_px(sheet) - 4.0
        };
        let texts = ["left", "middle", "right", "sways right", "sways left"];
        assert_eq!(legend_px(Figure::SCREEN, &texts), LEGEND_ROW_PX);
        assert_eq!(legend_px(narrow, &texts), NARROW_ROW_PX);
        let long = ["a text of a legend that is wider than the picture of a single column of a journal is";
            2];
        assert_eq!(legend_px(narrow, &long), 2.0 * (NARROW_ROW_PX + LINE_PX));
    }
}
