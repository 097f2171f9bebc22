//! Building blocks of HTML pages.

use archrock_text::shown_lines;
use serde::Serialize;

use super::{Mark, Symbol};

/// The name and version of the program, as pages show them.
pub(crate) const PROGRAM: &str = concat!(env!("CARGO_PKG_NAME"), " ", env!("CARGO_PKG_VERSION"));

/// Scripts and styles of pages with a moving structure and curves over time. The scripts share one scope, in this order; the script of a page follows
/// them and calls `createPlayer` with its motion and its curves.
pub(crate) const BASE: &str = include_str!("page/base.js");
pub(crate) const STAGE: &str = include_str!("page/stage.js");
pub(crate) const PLOTS: &str = include_str!("page/plots.js");
pub(crate) const PLAYER: &str = include_str!("page/player.js");
pub(crate) const STYLE: &str = include_str!("page/page.css");
pub(crate) const STUDY: &str = include_str!("page/study.js");
// uPlot, the library that draws the curves.
pub(crate) const PLOT_STYLE: &str = include_str!("../../vendor/uplot/uPlot.min.css");
pub(crate) const PLOT_SCRIPT: &str = include_str!("../../vendor/uplot/uPlot.iife.min.js");
pub(crate) const PLOT_LICENCE: &str = include_str!("../../vendor/uplot/LICENSE");

named! {
    /// The outcome of a case, as a page marks it.
    pub enum SpotKind {
        /// It certainly survives.
        Survives = "survives",
        /// It certainly overturns.
        Overturns = "overturns",
        /// It is uncertain whether it overturns.
        Uncertain = "uncertain",
        /// It has no verdict.
        Unknown = "unknown",
        /// A point of a curve, without an outcome.
        Point = "point",
        /// A hinge of a mechanism, without an outcome.
        Hinge = "hinge",
    }
}

impl SpotKind {
    /// Returns its shape in the notation of SVG, around zero. Shapes differ, so that no outcome is known by its colour alone.
    pub(crate) const fn shape(self) -> &'static str {
        match self {
            Self::Survives | Self::Point | Self::Hinge => "M4 0A4 4 0 1 0-4 0A4 4 0 1 0 4 0Z",
            Self::Overturns => "M-6-4L-4-6 0-2 4-6 6-4 2 0 6 4 4 6 0 2-4 6-6 4-2 0Z",
            Self::Uncertain => "M0-6L6 0 0 6-6 0Z",
            Self::Unknown => "M-5 0H5M0-5V5",
        }
    }

    /// Returns the colour of its outcome, the same for marks, cells and legends; empty without one outcome. Cells have further colours for the
    /// peak of a surviving case, and for the impacts before overturning.
    pub(crate) const fn fill(self) -> &'static str {
        match self {
            Self::Survives => "#a9d3f5",
            Self::Overturns => "#a6361c",
            Self::Uncertain => "#009e73",
            Self::Unknown | Self::Point | Self::Hinge => "",
        }
    }

    /// Returns its entry in the legend.
    pub(crate) const fn label(self) -> &'static str {
        match self {
            Self::Survives => "survives",
            Self::Overturns => "overturns",
            Self::Uncertain => "UNCERTAIN whether it overturns",
            Self::Unknown => "no verdict",
            Self::Point => "a row of the table",
            Self::Hinge => "a hinge",
        }
    }
}

/// The frame around a case outside the model of four links, in the notation of SVG.
pub(crate) const OUTSIDE_MODEL: &str = "M-8-8H8V8H-8Z";

/// A case in the picture of a page.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Spot {
    /// Number of its row in the table, from 0.
    pub(crate) row: usize,
    pub(crate) kind: SpotKind,
    /// True if it is outside the model of four links.
    pub(crate) outside: bool,
    /// The case and its outcome.
    pub(crate) words: String,
}

impl Spot {
    /// Returns its mark in a chart, whose lines are in the style of the page.
    pub(crate) fn mark(&self, at: (f64, f64)) -> Mark {
        Mark::symbol(self.symbol(), at)
    }

    /// Returns a bar of this height in a strip of outcomes, for a case without a place on a curve.
    pub(crate) fn bar(&self, at: (f64, f64), height_px: f64) -> Mark {
        let half_px = 0.5 * height_px;
        let mut symbol = self.symbol();
        symbol.attributes = symbol.attributes.replacen("spot ", "spot bar ", 1);
        let fill = self.kind.fill();
        symbol.shapes = format!("<path fill=\"{fill}\" d=\"M-1-{half_px}H1V{half_px}H-1Z\"/>");
        Mark::symbol(symbol, at)
    }

    /// Returns its symbol.
    pub(crate) fn symbol(&self) -> Symbol {
        let outside = match self.outside {
            true => format!("<path class=\"outside\" d=\"{OUTSIDE_MODEL}\"/>"),
            false => String::new(),
        };
        let fill = match self.kind.fill() {
            "" => String::new(),
            fill => format!(" fill=\"{fill}\""),
        };
        Symbol {
            attributes: format!(
                "class=\"spot {}\" data-row=\"{}\"",
                self.kind.name(),
                self.row
            ),
            words: self.words.clone(),
            shapes: format!("{outside}<path{fill} d=\"{}\"/>", self.kind.shape()),
        }
    }
}

/// Formats data as JSON for a script of a page: nothing in the text ends the script.
pub(crate) fn script_safe(data: &impl Serialize) -> String {
    let json = serde_json::to_string(data).expect("data of a page have names as keys");
    shown_lines(&json).replace('<', "\\u003c")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn data_cannot_end_its_script() {
        let text = script_safe(&serde_json::json!({ "title": "</script><b>" }));
        assert_eq!(text, r#"{"title":"\u003c/script>\u003cb>"}"#);
    }
}
