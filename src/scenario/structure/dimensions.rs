//! Dimensions of a structure for its drawing.

use nalgebra::Vector2;

use super::Structure;
use crate::mechanics::masonry::{CircularArch, Pier, Piers};
use crate::mechanics::{MasonryShape, MeasuredAt};
use crate::scenario::Language;
use crate::{Arch, Column, Masonry, Row, Sway};

/// A dimension of a structure.
#[derive(Clone, Debug, PartialEq)]
pub struct Dimension {
    /// Ends, in metres: of a width from left to right, of a height from bottom to top.
    pub ends_m: [Vector2<f64>; 2],
    /// Side of the structure on which the dimension is drawn.
    pub side: DimensionSide,
    /// Value with its unit.
    length: String,
    /// Name in the label, in English and Italian; `None` if the position is not ambiguous.
    label: Option<[&'static str; 2]>,
    /// Name and value in words.
    pub words: String,
}

named! {
    /// Side of the structure on which a dimension is drawn.
    pub enum DimensionSide {
        /// Below the structure, for a width.
        Below = "below",
        /// Left of the structure, for a height.
        Left = "left",
        /// Right of the structure, for a height.
        Right = "right",
    }
}

/// Ends of a line, in metres.
type Ends = [Vector2<f64>; 2];

impl Dimension {
    fn new(side: DimensionSide, ends_m: Ends, name: &str) -> Self {
        let along_m = ends_m[1] - ends_m[0];
        let length_m = match side {
            DimensionSide::Below => along_m.x,
            DimensionSide::Left | DimensionSide::Right => along_m.y,
        };
        let length = format!("{} m", metres(length_m));
        Self {
            ends_m,
            side,
            words: format!("{name} {length}"),
            length,
            label: None,
        }
    }

    /// Makes a dimension whose label on the drawing contains its name.
    fn named(side: DimensionSide, ends_m: Ends, label: [&'static str; 2]) -> Self {
        Self {
            label: Some(label),
            ..Self::new(side, ends_m, label[0])
        }
    }

    /// Label on the drawing.
    pub(crate) fn label(&self, language: Language) -> String {
        let length = language.number(self.length.clone());
        match self.label {
            Some([english, italian]) => format!("{} {length}", language.choose(english, italian)),
            None => length,
        }
    }
}

/// Length for a drawing, rounded to a millimetre, or to three digits below 0.1.
pub fn metres(length_m: f64) -> String {
    let rounded = if length_m.abs() < 0.1 {
        format!("{length_m:.2e}").parse().unwrap_or(length_m)
    } else {
        (length_m * 1e3).round() / 1e3
    };
    rounded.to_string()
}

impl Structure {
    /// Dimensions of the structure.
    pub fn dimensions(&self) -> Vec<Dimension> {
        match self {
            Self::Arch(arch) => {
                let ring = arch.ring();
                let line = arch.measured_at;
                let radius_m = arch.radius_at_m(line.unwrap_or(MeasuredAt::Mean));
                let ends =
                    [0.0, ring.embrace_rad].map(|angle| ring.radial_direction(angle) * radius_m);
                span_and_rise(ends, radius_m, line).into()
            }
            Self::Column(column) => {
                let half_m = 0.5 * column.width_m;
                let high = Vector2::new(half_m, column.height_m);
                let own = width_and_height([Vector2::new(-half_m, 0.0), high]);
                own.into_iter().chain(wall_height(column)).collect()
            }
            Self::Masonry(masonry) => masonry_dimensions(masonry),
        }
    }
}

impl Structure {
    /// Outline of the wall behind a column for drawings, in metres, as thick as the column; `None` without a wall.
    pub fn wall_outline_m(&self) -> Option<[Vector2<f64>; 4]> {
        let column = self.column()?;
        let (wall, height_m) = column.wall()?;
        let [near_m, far_m] = [0.5, 1.5].map(|part| part * column.width_m * wall.side.sign());
        Some([
            Vector2::new(near_m, 0.0),
            Vector2::new(near_m, height_m),
            Vector2::new(far_m, height_m),
            Vector2::new(far_m, 0.0),
        ])
    }
}

/// Circular arch of masonry, which may have piers, fill and loads; `None` for other shapes.
pub(super) fn circular_arch(masonry: &Masonry) -> Option<&Arch> {
    match &masonry.shape {
        MasonryShape::Circular(circular) => Some(&circular.arch),
        _ => None,
    }
}

/// Line along which span and rise are given in drawings; `None` if there are none.
pub(super) fn measured_line(masonry: &Masonry) -> Option<MeasuredAt> {
    match masonry.shape {
        MasonryShape::Blocks(_) => None,
        _ => circular_arch(masonry).map_or(Some(MeasuredAt::Mean), |arch| arch.measured_at),
    }
}

/// Lowest and the highest coordinates of the blocks of a row.
pub(in crate::scenario) fn bounds_m(row: &Row) -> [Vector2<f64>; 2] {
    let corners = row.outlines_m.iter().flatten();
    let empty = [f64::INFINITY, f64::NEG_INFINITY].map(|x| Vector2::new(x, x));
    corners.fold(empty, |[low, high], corner| {
        [low.inf(corner), high.sup(corner)]
    })
}

/// Width and height between the lowest and the highest coordinates.
fn width_and_height([low, high]: [Vector2<f64>; 2]) -> [Dimension; 2] {
    let [right, top] = [Vector2::new(high.x, low.y), Vector2::new(low.x, high.y)];
    [
        Dimension::new(DimensionSide::Below, [low, right], "width"),
        Dimension::new(DimensionSide::Left, [low, top], "height"),
    ]
}

/// Span and rise from the ends of a line and the height of its crown. The words name the line if it was given.
fn span_and_rise(ends: Ends, crown_m: f64, line: Option<MeasuredAt>) -> [Dimension; 2] {
    let crown = Vector2::new(ends[0].x, crown_m);
    let mut dimensions = [
        Dimension::named(DimensionSide::Below, ends, ["span", "luce"]),
        Dimension::named(DimensionSide::Left, [ends[0], crown], ["rise", "freccia"]),
    ];
    let line = line.map_or_else(String::new, |line| format!(" {}", line.in_words()));
    for dimension in &mut dimensions {
        dimension.words += &line;
    }
    dimensions
}

/// Height of the wall behind a column if it is lower than the column.
fn wall_height(column: &Column) -> Option<Dimension> {
    let (wall, height_m) = column.wall()?;
    let x_m = 0.5 * column.width_m * wall.side.sign();
    let side = match wall.side {
        Sway::Right => DimensionSide::Right,
        Sway::Left => DimensionSide::Left,
    };
    let ends = [0.0, height_m].map(|y_m| Vector2::new(x_m, y_m));
    let wall = Dimension::named(side, ends, ["wall behind", "muro retrostante"]);
    Some(wall).filter(|_| height_m < column.height_m)
}

fn masonry_dimensions(masonry: &Masonry) -> Vec<Dimension> {
    let Some([start, end]) = masonry.springings() else {
        return width_and_height(bounds_m(&masonry.row)).into();
    };
    let line = measured_line(masonry);
    let ends = [start, end].map(|joint| match line {
        Some(MeasuredAt::Intrados) => joint.intrados_m,
        Some(MeasuredAt::Extrados) => joint.extrados_m,
        Some(MeasuredAt::Mean) | None => joint.middle_m(),
    });
    let rise_m = match &masonry.shape {
        MasonryShape::PointedArch(dimensions) | MasonryShape::EllipticArch(dimensions) => {
            dimensions.rise_m
        }
        MasonryShape::BasketArch(arch) => arch.dimensions.rise_m,
        MasonryShape::Circular(CircularArch { arch, .. }) => {
            arch.span_and_rise_m(line.unwrap_or(MeasuredAt::Mean))[1]
        }
        // Blocks have no springings.
        MasonryShape::Blocks(_) => 0.0,
    };
    let mut dimensions = Vec::from(span_and_rise(ends, ends[0].y + rise_m, line));
    let Piers { left: one, right } = masonry.piers;
    let other = right.filter(|_| one != right);
    let piers = [
        (one, start, DimensionSide::Left),
        (other, end, DimensionSide::Right),
    ];
    for (pier, joint, side) in piers {
        let pier = pier.map(|pier| pier_dimensions(&pier, joint.intrados_m, side));
        dimensions.extend(pier.into_iter().flatten());
    }
    let fill = masonry.load_outlines.fill_m.iter();
    let corners = fill.flat_map(|(_, outline)| outline);
    if let Some(level_m) = corners.map(|corner| corner.y).reduce(f64::max) {
        let from = end.extrados_m;
        let ends = [from, Vector2::new(from.x, level_m)];
        dimensions.push(Dimension::named(
            DimensionSide::Right,
            ends,
            ["fill", "riempimento"],
        ));
    }
    dimensions
}

/// Height and width of a pier, from the inner corner at its springing.
fn pier_dimensions(pier: &Pier, inner: Vector2<f64>, side: DimensionSide) -> [Dimension; 2] {
    let foot = inner - Vector2::new(0.0, pier.height_m);
    let base = match side {
        DimensionSide::Left => [foot - Vector2::new(pier.width_m, 0.0), foot],
        _ => [foot, foot + Vector2::new(pier.width_m, 0.0)],
    };
    [
        Dimension::new(side, [foot, inner], "pier height"),
        Dimension::new(DimensionSide::Below, base, "pier width"),
    ]
}
