//! The layout of a picture: width and height, size of text, and drawn parts.

use std::ops::RangeInclusive;
use std::str::FromStr;

use super::svg::{Background, Frame};
use super::text::TEXT_PX;
use crate::scenario::Language;

/// The size of a picture. The layout is in pixels, with text of 13 pixels. Wider pictures have more space, not larger text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figure {
    /// Width in pixels.
    pub(crate) width_px: f64,
    /// Width in print, in mm; `None` for the screen.
    pub(crate) width_mm: Option<f64>,
    /// Height in print; `None` for the natural height. Plots are stretched to this height within limits.
    pub height: Option<Height>,
    /// True to draw a title.
    pub has_title: bool,
    /// The panels of a history to draw; `None` for all, and for the three most important ones in a narrow picture.
    pub panels: Option<[bool; Panel::ALL.len()]>,
    /// Colour behind everything.
    pub background: Background,
    /// Language of its words and numbers.
    pub(crate) language: Language,
}

/// Size of text in print, in points.
const TEXT_PT: f64 = 8.0;
const MM_PER_PT: f64 = 25.4 / 72.0;
/// Smallest text in a film, in pixels of the film.
const LEAST_TEXT_PX: f64 = 11.0;

/// Width in print, in mm, below which a picture is for a single column of a journal.
const COLUMN_MM: f64 = 100.0;
/// Largest height of a picture for a single column, in mm, unless its height is given.
const COLUMN_HEIGHT_MM: f64 = 120.0;
/// Distance of plots from the right side of the picture.
pub(crate) const RIGHT_PX: f64 = 25.0;
/// Smallest width in pixels: that of 60 mm with text of 8 pt.
const LEAST_WIDTH_PX: f64 = 60.0 / (MM_PER_PT * TEXT_PT) * TEXT_PX;

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

impl Figure {
    /// Picture for the screen: 900 pixels wide.
    pub const SCREEN: Self = Self {
        width_px: 900.0,
        width_mm: None,
        height: None,
        has_title: true,
        panels: None,
        background: Background::WHITE,
        language: Language::English,
    };

    /// Picture on a page, below its title.
    pub(crate) const PAGE: Self = Self {
        has_title: false,
        ..Self::SCREEN
    };
    /// Picture on a page on a phone, whose text is not smaller than that of the page.
    pub(crate) const PHONE: Self = Self {
        width_px: 366.0,
        ..Self::PAGE
    };

    /// Widths for print, in mm.
    const WIDTHS_MM: RangeInclusive<f64> = 60.0..=500.0;
    /// Heights for print, in mm.
    const HEIGHTS_MM: RangeInclusive<f64> = 20.0..=700.0;

    /// Makes a picture for print with this width, in mm, and text of 8 pt.
    fn of_width_mm(width_mm: f64) -> Self {
        Self {
            width_px: width_mm / (MM_PER_PT * TEXT_PT) * TEXT_PX,
            width_mm: Some(width_mm),
            ..Self::SCREEN
        }
    }

    /// Makes a picture with the proportions of a frame of a film, in pixels of the film. Text is as large as on the screen if the longer side is
    /// 900 pixels, and grows with it; in smaller films it does not shrink below 11 pixels.
    pub(crate) fn of_frame(size_px: [u32; 2], background: Background) -> Self {
        let [width_px, height_px] = size_px.map(f64::from);
        let longer_px = width_px.max(height_px);
        let layout_px = Self::SCREEN
            .width_px
            .min(longer_px * TEXT_PX / LEAST_TEXT_PX);
        let [width, height] = [width_px, height_px].map(|side_px| side_px / longer_px * layout_px);
        Self {
            width_px: width,
            // One pixel of the layout is a millimetre, so the height is that of the frame.
            width_mm: Some(width),
            height: Some(Height(height)),
            background,
            ..Self::SCREEN
        }
    }

    /// Changes the language of words and numbers.
    pub(crate) const fn in_language(self, language: Language) -> Self {
        Self { language, ..self }
    }

    /// Changes the size of text, in points.
    ///
    /// # Errors
    /// When the picture has no width in print, or is too narrow for such text.
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

    /// Returns true if a panel of a history is drawn. `watched` is true if there are observed points.
    pub fn shows(&self, panel: Panel, watched: bool) -> bool {
        match (self.panels, panel) {
            (Some(shown), panel) => shown[panel as usize],
            (None, Panel::Ground | Panel::Rotation) => true,
            (None, Panel::Points) => watched,
            // A single column has space for three panels.
            (None, Panel::Energy) => !(self.is_column() && watched),
            (None, Panel::Joints | Panel::Slip | Panel::Thrust) => !self.is_column(),
        }
    }

    fn is_column(&self) -> bool {
        self.width_mm.is_some_and(|width_mm| width_mm < COLUMN_MM)
    }

    /// Returns the height of a plot, from its height on the screen: a little less in narrow pictures.
    pub fn height_px(&self, on_screen_px: f64) -> f64 {
        let with_width = 0.35 + 0.65 * self.width_px / Self::SCREEN.width_px;
        on_screen_px * with_width
    }

    /// Returns the height of a picture, in pixels, from its natural height.
    pub(crate) fn wanted_px(&self, natural_px: f64) -> f64 {
        let Some(width_mm) = self.width_mm else {
            return natural_px;
        };
        let px_per_mm = self.width_px / width_mm;
        match self.height {
            Some(Height(height_mm)) => height_mm * px_per_mm,
            None if self.is_column() => natural_px.min(COLUMN_HEIGHT_MM * px_per_mm),
            None => natural_px,
        }
    }

    /// Returns the number of ticks along the width, from the number on the screen.
    pub fn ticks(&self, on_screen: u32) -> u32 {
        let ticks = (f64::from(on_screen) * self.width_px / Self::SCREEN.width_px).round() as u32;
        ticks.max(3)
    }

    /// Returns the number of columns of at least this width that fit side by side, at most `wanted`.
    pub fn columns(&self, wanted: usize, least_px: f64) -> usize {
        let fit = (self.width_px / least_px) as usize;
        fit.clamp(1, wanted)
    }

    /// Returns the frame of a plot in a part of the picture, at this distance from the left side.
    pub(crate) fn right_of(&self, left: f64, part: Frame) -> Frame {
        Frame {
            left,
            width: self.width_px - left - RIGHT_PX,
            ..part
        }
    }
}

impl FromStr for Figure {
    type Err = String;

    /// Parses a width with its unit, such as `85mm` or `8.5cm`.
    fn from_str(text: &str) -> Result<Self, String> {
        let fits = length_mm(text).filter(|width_mm| Self::WIDTHS_MM.contains(width_mm));
        fits.map(Self::of_width_mm)
            .ok_or_else(|| "give a width from 60mm to 500mm, such as 85mm or 17cm".to_owned())
    }
}

/// Height of a picture in print, in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Height(f64);

impl FromStr for Height {
    type Err = String;

    /// Parses a height with its unit, such as `60mm`.
    fn from_str(text: &str) -> Result<Self, String> {
        let fits = length_mm(text).filter(|height_mm| Figure::HEIGHTS_MM.contains(height_mm));
        fits.map(Self)
            .ok_or_else(|| "give a height from 20mm to 700mm, such as 60mm or 9cm".to_owned())
    }
}

/// Returns a length with its unit, in mm; `None` if it cannot be parsed.
fn length_mm(text: &str) -> Option<f64> {
    let units = [("mm", 1.0), ("cm", 10.0), ("in", 25.4)];
    units.into_iter().find_map(|(unit, mm)| {
        let number: f64 = text.trim().strip_suffix(unit)?.trim().parse().ok()?;
        // Removes rounding errors.
        Some((number * mm * 1e6).round() / 1e6)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_has_three_panels() {
        let shown = |figure: Figure, watched| {
            let shown = Panel::ALL.iter().copied();
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
        let mut panels = [false; Panel::ALL.len()];
        panels[Panel::Thrust as usize] = true;
        let one = Figure {
            panels: Some(panels),
            ..narrow
        };
        assert_eq!(shown(one, true), [Panel::Thrust]);
        assert!("thrusts".parse::<Panel>().is_err());
    }
}
