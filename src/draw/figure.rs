//! The layout of a picture: width and height, size of text, and drawn parts.

use std::ops::RangeInclusive;
use std::str::FromStr;

use crate::svg::{Background, Frame};
use crate::text::TEXT_PX;

/// The size of a picture. The layout is in pixels, with text of 13 pixels. Wider pictures have more space, not larger text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figure {
    /// Width in pixels.
    pub width_px: f64,
    /// Width in print, in mm; `None` for the screen.
    pub(crate) width_mm: Option<f64>,
    /// Height in print; `None` for the natural height. Plots are stretched to this height within limits.
    pub height: Option<Height>,
    /// True to draw a title.
    pub has_title: bool,
    /// Colour behind everything.
    pub background: Background,
    /// Decimal mark of the numbers at ticks.
    pub decimal_mark: &'static str,
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

impl Figure {
    /// Picture for the screen: 900 pixels wide.
    pub const SCREEN: Self = Self {
        width_px: 900.0,
        width_mm: None,
        height: None,
        has_title: true,
        background: Background::WHITE,
        decimal_mark: ".",
    };

    /// Picture on a page, below its title.
    pub const PAGE: Self = Self {
        has_title: false,
        ..Self::SCREEN
    };
    /// Picture on a page on a phone, whose text is not smaller than that of the page.
    pub const PHONE: Self = Self {
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
    pub fn of_frame(size_px: [u32; 2], background: Background) -> Self {
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

    /// Returns true if it is for a single column of a journal.
    pub fn is_column(&self) -> bool {
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
    pub fn right_of(&self, left: f64, part: Frame) -> Frame {
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
