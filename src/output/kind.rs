//! Kinds of outcomes and their colours, the same in all pictures.

use nalgebra::Vector2;

use super::ending;
use super::svg::{Anchor, Drawing, Stroke, color};

/// Outcome of an arch that cannot carry its own weight.
pub(super) const CANNOT_STAND: &str = "cannot_stand";
/// Outcome of an arch that is too thick for four links.
pub(super) const NOT_FOUR_LINKS: &str = "not_four_links";
/// Outcome where the ground falls as fast as a free body.
pub(super) const GROUND_FALLS: &str = "ground_falls";

/// Kind of outcome, which sets the colour of a result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Kind {
    pub(super) name: &'static str,
    pub(super) label: &'static str,
    pub(super) fill: &'static str,
}

const fn kind(name: &'static str, label: &'static str, fill: &'static str) -> Kind {
    Kind { name, label, fill }
}

impl Kind {
    /// In the order of the legend.
    pub(super) const ALL: [Self; 12] = [
        kind("never_moved", "never moves", "#e4e4e4"),
        kind("rest", "comes to rest", "#bcdcf0"),
        kind("still_rocking", "still rocking", "#6f8ba0"),
        kind("overturned-0", "overturns without impact", color::VERMILION),
        kind("overturned-1", "overturns after 1 impact", color::ORANGE),
        kind("overturned-2", "overturns after 2 impacts", "#f0e442"),
        kind("overturned-more", "overturns after more", color::PURPLE),
        kind("overturned", "overturns", color::VERMILION),
        kind(CANNOT_STAND, "cannot stand", "#ffffff"),
        kind(NOT_FOUR_LINKS, "not four links", "#c8bfae"),
        kind(GROUND_FALLS, "the ground falls freely", "#ffffff"),
        kind(ending::FAILED, "failed", color::BLACK),
    ];

    /// That of an outcome by its name, with the number of impacts before overturning where all hinges close at
    /// once: the landings of free hinges, which come in cascades, tell no kinds apart.
    pub(super) fn of(outcome: &str, impacts: Option<usize>) -> Self {
        let name = match (outcome, impacts) {
            ("overturned", Some(0)) => "overturned-0",
            ("overturned", Some(1)) => "overturned-1",
            ("overturned", Some(2)) => "overturned-2",
            ("overturned", Some(_)) => "overturned-more",
            (outcome, _) => outcome,
        };
        let known = Self::ALL.into_iter().find(|kind| kind.name == name);
        known.unwrap_or(Self::ALL[Self::ALL.len() - 1])
    }
}

/// Height of a row of a legend.
pub(super) const LEGEND_ROW: f64 = 24.0;

/// What the colours of these kinds mean, in as many rows of that width as it takes; returns where these end.
pub(super) fn legend(drawing: &mut Drawing, at: Vector2<f64>, width: f64, kinds: &[Kind]) -> f64 {
    let (mut x, mut y) = (at.x, at.y);
    for kind in Kind::ALL.into_iter().filter(|kind| kinds.contains(kind)) {
        #[expect(clippy::cast_precision_loss, reason = "the length of a label")]
        let advance = 46.0 + 6.6 * kind.label.len() as f64;
        if x + advance > at.x + width {
            (x, y) = (at.x, y + LEGEND_ROW);
        }
        let swatch = format!("M{x} {y}h22v14h-22z");
        let outline = Stroke::new(color::GREY, 0.8, "");
        drawing.path("", &swatch, kind.fill, outline);
        drawing.label(
            Vector2::new(x + 28.0, y + 12.0),
            Anchor::Start,
            0.0,
            kind.label,
        );
        x += advance;
    }
    y + LEGEND_ROW
}
