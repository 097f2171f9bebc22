//! How a picture is laid out: its width and height, the size of its text, what of it is drawn.

use std::fmt;
use std::ops::RangeInclusive;
use std::str::FromStr;

use super::svg::Frame;

/// How wide a picture is. It is laid out in pixels, with text of 13; a wider one has room for more, not larger text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figure {
    width_px: f64,
    /// Width in print, where that is given.
    width_mm: Option<f64>,
    /// Height in print, where that is given.
    height_mm: Option<f64>,
    /// What heights of plots are multiplied by, so that the picture gets the height it is to have.
    stretch: f64,
    has_title: bool,
    /// The panels of a history; `None`: all, and in a narrow picture the three that matter most.
    panels: Option<PanelSet>,
}

/// Size of text in pixels.
pub(crate) const TEXT_PX: f64 = 13.0;
/// The same in print.
const TEXT_PT: f64 = 8.0;
const MM_PER_PT: f64 = 25.4 / 72.0;

/// From the baseline of a line of text to that of the next.
pub(crate) const LINE_PX: f64 = 17.0;

/// Characters that a word is cut at.
const LONGEST_WORD: usize = 130;

/// Below this width, in mm, a picture is one of a column of a journal.
const COLUMN_MM: f64 = 100.0;
/// How high such a picture is at most, in mm, unless its height is given.
const COLUMN_HEIGHT_MM: f64 = 120.0;
/// No picture has less room than one of 60 mm with text of 8 pt.
const LEAST_WIDTH_PX: f64 = 60.0 / (MM_PER_PT * TEXT_PT) * TEXT_PX;

/// A picture of one height is drawn so many times at most, until it has that height.
const DRAWINGS: u32 = 12;
/// Plots are stretched and squeezed that much.
const STRETCH: RangeInclusive<f64> = 0.15..=20.0;

/// A panel of the picture of a history.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Panel {
    /// How the ground accelerates.
    Ground,
    /// How far the bodies have turned.
    Rotation,
    /// Which joints are open.
    Joints,
    /// How far joints have slipped.
    Slip,
    /// How far watched points are displaced.
    Points,
    /// The energy, over the barrier where that is known.
    Energy,
    /// How far the line of thrust leaves the structure.
    Thrust,
}

impl Panel {
    /// All, from above.
    pub const ALL: [Self; 7] = [
        Self::Ground,
        Self::Rotation,
        Self::Joints,
        Self::Slip,
        Self::Points,
        Self::Energy,
        Self::Thrust,
    ];

    /// What it is asked for by.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ground => "ground",
            Self::Rotation => "rotation",
            Self::Joints => "joints",
            Self::Slip => "slip",
            Self::Points => "points",
            Self::Energy => "energy",
            Self::Thrust => "thrust",
        }
    }
}

impl fmt::Display for Panel {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

impl FromStr for Panel {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|panel| panel.name() == text);
        found.ok_or_else(|| format!("the panels are {}", Self::ALL.map(Self::name).join(", ")))
    }
}

/// Some of the panels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct PanelSet(u8);

impl PanelSet {
    fn of(panels: &[Panel]) -> Self {
        Self(panels.iter().fold(0, |set, panel| set | Self::bit(*panel)))
    }

    const fn bit(panel: Panel) -> u8 {
        1 << panel as u8
    }

    const fn has(self, panel: Panel) -> bool {
        self.0 & Self::bit(panel) != 0
    }
}

impl Figure {
    /// For the screen: 900 pixels.
    pub const SCREEN: Self = Self {
        width_px: 900.0,
        width_mm: None,
        height_mm: None,
        stretch: 1.0,
        has_title: true,
        panels: None,
    };

    /// Widths for print, in mm.
    const WIDTHS_MM: RangeInclusive<f64> = 60.0..=500.0;
    /// Heights for print, in mm.
    const HEIGHTS_MM: RangeInclusive<f64> = 20.0..=700.0;

    /// For print at this width, in mm, at which text is 8 pt.
    fn of_width_mm(width_mm: f64) -> Self {
        Self {
            width_px: width_mm / (MM_PER_PT * TEXT_PT) * TEXT_PX,
            width_mm: Some(width_mm),
            ..Self::SCREEN
        }
    }

    /// The same with text of this size, in points.
    ///
    /// # Errors
    /// In words, when the picture has no width in print, or is too narrow for such text.
    pub fn with_text_pt(self, text_pt: f64) -> Result<Self, String> {
        let Some(width_mm) = self.width_mm else {
            return Err("a size of text in points goes with a width in print".to_owned());
        };
        let width_px = width_mm / (MM_PER_PT * text_pt) * TEXT_PX;
        if width_px < LEAST_WIDTH_PX * (1.0 - 1e-9) {
            return Err(format!(
                "{width_mm} mm are too narrow for text of {text_pt} pt: up to {:.1} pt have room",
                width_px / LEAST_WIDTH_PX * text_pt
            ));
        }
        Ok(Self { width_px, ..self })
    }

    /// The same of this height: plots become as high as that takes, as far as their text allows.
    #[must_use]
    pub const fn with_height(self, height: Height) -> Self {
        Self {
            height_mm: Some(height.0),
            ..self
        }
    }

    /// The same without a title, for a caption of its own.
    #[must_use]
    pub const fn without_title(self) -> Self {
        Self {
            has_title: false,
            ..self
        }
    }

    /// The same with these panels of a history alone.
    #[must_use]
    pub fn with_panels(self, panels: &[Panel]) -> Self {
        Self {
            panels: Some(PanelSet::of(panels)),
            ..self
        }
    }

    /// Whether a title is drawn.
    #[must_use]
    pub const fn has_title(&self) -> bool {
        self.has_title
    }

    /// Whether a panel of a history is drawn. Of points that are `watched`, their displacements are.
    #[must_use]
    pub fn shows(&self, panel: Panel, watched: bool) -> bool {
        match (self.panels, panel) {
            (Some(panels), panel) => panels.has(panel),
            (None, Panel::Ground | Panel::Rotation) => true,
            (None, Panel::Points) => watched,
            // A column has room for three.
            (None, Panel::Energy) => !(self.is_column() && watched),
            (None, Panel::Joints | Panel::Slip | Panel::Thrust) => !self.is_column(),
        }
    }

    fn is_column(&self) -> bool {
        self.width_mm.is_some_and(|width_mm| width_mm < COLUMN_MM)
    }

    /// Width in pixels.
    #[must_use]
    pub const fn width_px(&self) -> f64 {
        self.width_px
    }

    /// Width in print, in mm, where that is given.
    pub(crate) const fn width_mm(&self) -> Option<f64> {
        self.width_mm
    }

    /// A height that goes with the width, of what is this high on the screen, in pixels.
    #[must_use]
    pub fn height_px(&self, on_screen_px: f64) -> f64 {
        let with_width = 0.35 + 0.65 * self.width_px / Self::SCREEN.width_px;
        self.stretch * on_screen_px * with_width
    }

    /// What is this wide where there is room, less where the picture is to be lower.
    #[must_use]
    pub fn squeezed_px(&self, width_px: f64) -> f64 {
        width_px * self.stretch.min(1.0)
    }

    /// Draws a picture as high as it is to be: again and again, with plots stretched.
    pub fn fitted(self, draw: impl Fn(Self) -> String) -> String {
        let picture = draw(self);
        let Some(mm_per_px) = self.width_mm.map(|width_mm| width_mm / self.width_px) else {
            return picture;
        };
        let natural_px = height_px(&picture);
        let wanted_px = match self.height_mm {
            Some(height_mm) => height_mm / mm_per_px,
            None if self.is_column() => natural_px.min(COLUMN_HEIGHT_MM / mm_per_px),
            None => return picture,
        };
        // Heights are nearly a constant and a part that is stretched.
        let (mut one, mut other) = ((1.0, natural_px), (0.0, 0.0));
        let mut best = picture;
        for drawing in 0..DRAWINGS {
            let miss_px = wanted_px - one.1;
            if miss_px.abs() < 0.05 {
                break;
            }
            let slope = match drawing {
                0 => one.1,
                _ => (one.1 - other.1) / (one.0 - other.0),
            };
            let next = if slope > 0.0 {
                one.0 + miss_px / slope
            } else {
                break;
            };
            let next = next.clamp(*STRETCH.start(), *STRETCH.end());
            if next == one.0 {
                break;
            }
            best = draw(Self {
                stretch: next,
                ..self
            });
            (other, one) = (one, (next, height_px(&best)));
        }
        best
    }

    /// Ticks along the width where there are so many on the screen.
    #[must_use]
    pub fn ticks(&self, on_screen: u32) -> u32 {
        let ticks = (f64::from(on_screen) * self.width_px / Self::SCREEN.width_px).round() as u32;
        ticks.max(3)
    }

    /// How many things stand side by side that are at least so wide, of `wanted` at most.
    #[must_use]
    pub fn columns(&self, wanted: usize, least_px: f64) -> usize {
        let fit = (self.width_px / least_px) as usize;
        fit.clamp(1, wanted)
    }

    /// The frame of a plot over the whole width, below `top`, with room for its labels.
    #[must_use]
    pub fn plot(&self, top: f64, height: f64) -> Frame {
        self.right_of(85.0, top, height)
    }

    /// The same of a panel, whose label is above it.
    #[must_use]
    pub fn panel(&self, top: f64, height: f64) -> Frame {
        self.right_of(66.0, top, height)
    }

    fn right_of(&self, left: f64, top: f64, height: f64) -> Frame {
        Frame {
            left,
            top,
            width: self.width_px - left - 25.0,
            height,
        }
    }
}

/// The height of a picture of this program, in pixels.
fn height_px(picture: &str) -> f64 {
    let sheet = picture.split_once("viewBox=\"0 0 ");
    let sheet = sheet.and_then(|(_, after)| after.split_once('"'));
    let height = sheet.and_then(|(sheet, _)| sheet.split_once(' ')?.1.parse().ok());
    height.expect("a picture begins with its sheet")
}

impl FromStr for Figure {
    type Err = String;

    /// A width with its unit, such as `85mm` or `8.5cm`.
    fn from_str(text: &str) -> Result<Self, String> {
        let fits = length_mm(text).filter(|width_mm| Self::WIDTHS_MM.contains(width_mm));
        fits.map(Self::of_width_mm)
            .ok_or_else(|| "give a width from 60mm to 500mm, such as 85mm or 17cm".to_owned())
    }
}

/// How high a picture is in print, in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Height(f64);

impl FromStr for Height {
    type Err = String;

    /// A height with its unit, such as `60mm`.
    fn from_str(text: &str) -> Result<Self, String> {
        let fits = length_mm(text).filter(|height_mm| Figure::HEIGHTS_MM.contains(height_mm));
        fits.map(Self)
            .ok_or_else(|| "give a height from 20mm to 700mm, such as 60mm or 9cm".to_owned())
    }
}

/// A length with its unit, in mm.
fn length_mm(text: &str) -> Option<f64> {
    let units = [("mm", 1.0), ("cm", 10.0), ("in", 25.4)];
    units.into_iter().find_map(|(unit, mm)| {
        let number: f64 = text.trim().strip_suffix(unit)?.trim().parse().ok()?;
        // Without the residue of rounding.
        Some((number * mm * 1e6).round() / 1e6)
    })
}

/// Text broken into lines of at most this width, in pixels. A very long word is cut.
pub(crate) fn lines(text: &str, width_px: f64) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let mut shown: String = word.chars().take(LONGEST_WORD).collect();
        if shown.len() < word.len() {
            shown.push_str("...");
        }
        let last = lines.len() - 1;
        let line = &mut lines[last];
        if line.is_empty() {
            *line = shown;
        } else if text_px(&format!("{line} {shown}")) <= width_px {
            *line += &format!(" {shown}");
        } else {
            lines.push(shown);
        }
    }
    lines
}

/// Width of a text in Helvetica, or in fonts made to its measures, such as Arial and Liberation Sans, in pixels.
#[must_use]
pub fn text_px(text: &str) -> f64 {
    let thousandths: u32 = text.chars().map(advance).sum();
    TEXT_PX * f64::from(thousandths) / 1000.0
}

/// Whether the width of this text is known: of other scripts it is a guess.
pub(crate) fn is_measured(text: &str) -> bool {
    !text.is_empty() && text.chars().all(|character| character <= '\u{24f}')
}

/// How far a character goes, in thousandths of the size of the text.
const fn advance(character: char) -> u32 {
    match character {
        'i' | 'j' | 'l' | '\'' => 222,
        '|' => 260,
        ' ' | '!' | ',' | '.' | '/' | ':' | ';' | 'I' | '[' | '\\' | ']' | 'f' | 't' => 278,
        '(' | ')' | '-' | 'r' | '`' | '{' | '}' => 333,
        '"' => 355,
        '*' => 389,
        '^' => 469,
        'J' | 'c' | 'k' | 's' | 'v' | 'x' | 'y' | 'z' => 500,
        '+' | '<' | '=' | '>' | '~' => 584,
        'F' | 'T' | 'Z' => 611,
        '&' | 'A' | 'B' | 'E' | 'K' | 'P' | 'S' | 'V' | 'X' | 'Y' => 667,
        'C' | 'D' | 'H' | 'N' | 'R' | 'U' | 'w' => 722,
        'G' | 'O' | 'Q' => 778,
        'M' | 'm' => 833,
        '%' => 889,
        'W' => 944,
        '@' => 1015,
        // Digits and most small letters; of others about as much.
        '\0'..='\u{24f}' => 556,
        _ => 1000,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::svg::Drawing;

    #[test]
    fn text_is_8_points_at_the_width_of_a_figure() {
        for (text, width_mm) in [("85mm", 85.0), ("17 cm", 170.0), ("3.5in", 88.9)] {
            let figure: Figure = text.parse().unwrap();
            let sheet = Drawing::new(figure).finish(figure.width_px());
            // A square sheet is as high as it is wide.
            let size = format!("width=\"{width_mm}mm\" height=\"{width_mm:.3}mm\"");
            assert!(sheet.contains(&size), "{sheet}");
            for text_pt in [7.0, 8.0, 9.5] {
                let figure = figure.with_text_pt(text_pt).unwrap();
                let points = TEXT_PX / figure.width_px() * width_mm / MM_PER_PT;
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
    fn a_picture_becomes_as_high_as_it_is_to_be() {
        // Two plots with gaps, and text that does not stretch.
        let draw = |figure: Figure| {
            let high = 90.0 + figure.height_px(130.0) + figure.height_px(260.0);
            Drawing::new(figure).finish(high)
        };
        let height_mm = |figure: Figure| {
            let picture = figure.fitted(draw);
            let (_, after) = picture.split_once("height=\"").unwrap();
            after.split_once("mm").unwrap().0.parse::<f64>().unwrap()
        };
        let figure: Figure = "120mm".parse().unwrap();
        for wanted in ["40mm", "70 mm", "18cm"] {
            let height: Height = wanted.parse().unwrap();
            let miss_mm = height_mm(figure.with_height(height)) - height.0;
            assert!(miss_mm.abs() < 0.05, "{wanted}: {miss_mm}");
        }
        // It cannot be lower than its text.
        let low: Height = "20mm".parse().unwrap();
        assert!(height_mm(figure.with_height(low)) > 20.0);
        for wrong in ["70", "5mm", "-7cm", "8000mm"] {
            assert!(wrong.parse::<Height>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_column_has_three_panels() {
        let shown = |figure: Figure, watched| {
            let shown = Panel::ALL.into_iter();
            shown
                .filter(|panel| figure.shows(*panel, watched))
                .collect::<Vec<_>>()
        };
        let [narrow, wide] = ["84mm", "120mm"].map(|width| width.parse::<Figure>().unwrap());
        let three = [Panel::Ground, Panel::Rotation, Panel::Energy];
        assert_eq!(shown(narrow, false), three);
        let three = [Panel::Ground, Panel::Rotation, Panel::Points];
        assert_eq!(shown(narrow, true), three);
        assert_eq!(shown(wide, true), Panel::ALL);
        let one = narrow.with_panels(&["thrust".parse().unwrap()]);
        assert_eq!(shown(one, true), [Panel::Thrust]);
        assert!("thrusts".parse::<Panel>().is_err());
    }

    #[test]
    fn text_is_as_wide_as_in_helvetica() {
        // By its published measures: H 722, e 556, l 222, l 222, o 556.
        assert!((text_px("Hello") - 13.0 * 2.278).abs() < 1e-12);
        assert!((text_px("-0.05") - 13.0 * 2.279).abs() < 1e-12);
    }
}
