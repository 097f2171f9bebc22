//! The dimensions of a structure, as a drawing has them, and the same in words.

use nalgebra::Vector2;

use super::Structure;
use crate::mechanics::arch::{Arch, MeasuredAt};
use crate::mechanics::column::Column;
use crate::mechanics::masonry::{FillLevel, Masonry, Pier, Shape};

/// A length of a structure.
#[derive(Clone, Debug, PartialEq)]
pub struct Dimension {
    /// Its ends, in metres: of a width from left to right, of a height from below.
    pub ends_m: [Vector2<f64>; 2],
    /// Where it is drawn.
    pub side: DimensionSide,
    /// Its value, with a name where its place does not tell which it is.
    pub text: String,
    /// Its name and value.
    pub words: String,
}

/// Where a dimension is drawn: outside the structure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DimensionSide {
    /// A width.
    Below,
    /// A height.
    Left,
    /// A height.
    Right,
}

impl Dimension {
    /// A dimension that has its name beside it.
    fn named(side: DimensionSide, ends_m: [Vector2<f64>; 2], name: &str) -> Self {
        let own = Self::plain(side, ends_m, name);
        Self {
            text: own.words.clone(),
            ..own
        }
    }

    /// A dimension whose place tells which it is.
    fn plain(side: DimensionSide, ends_m: [Vector2<f64>; 2], name: &str) -> Self {
        let [from, to] = ends_m;
        let length_m = match side {
            DimensionSide::Below => to.x - from.x,
            DimensionSide::Left | DimensionSide::Right => to.y - from.y,
        };
        let text = format!("{} m", metres(length_m));
        let words = format!("{name} {text}");
        Self {
            ends_m,
            side,
            text,
            words,
        }
    }
}

/// A number for a drawing: to a millimetre, or three digits.
#[must_use]
pub fn metres(length_m: f64) -> String {
    let rounded = if length_m.abs() < 0.1 {
        format!("{length_m:.2e}").parse().unwrap_or(length_m)
    } else {
        (length_m * 1e3).round() / 1e3
    };
    rounded.to_string()
}

impl Structure {
    /// Its dimensions.
    #[must_use]
    pub fn dimensions(&self) -> Vec<Dimension> {
        match self {
            Self::Arch(arch) => of_arch(arch),
            Self::Column(column) => of_column(column),
            Self::Masonry(masonry) => of_masonry(masonry),
        }
    }

    /// The structure in words, with what its drawing does not tell.
    #[must_use]
    pub fn described(&self) -> String {
        let (depth_m, density_kg_m3) = self.depth_and_density();
        let mut parts = Vec::new();
        match self {
            Self::Arch(arch) => {
                let thick_m = arch.mean_radius_m() * arch.thickness_ratio();
                parts.push(format!(
                    "circular arch of {} degrees, {} m thick",
                    metres(arch.embrace_deg()),
                    metres(thick_m)
                ));
                if let Some(voussoirs) = arch.voussoirs() {
                    parts.push(format!("{voussoirs} voussoirs"));
                }
                parts.extend(measured(arch));
            }
            Self::Column(_) => parts.push("column".to_owned()),
            Self::Masonry(masonry) => parts.extend(of_masonry_in_words(masonry)),
        }
        parts.push(format!(
            "{} m deep, {} kg/m3",
            metres(depth_m),
            metres(density_kg_m3)
        ));
        parts.push(self.origin());
        parts.extend(self.ties_in_words());
        parts.join("; ")
    }
}

/// Where its span and rise are measured, if the scenario gives them.
fn measured(arch: &Arch) -> Option<String> {
    let line = arch.measured_at()?;
    Some(format!("span and rise {}", line.in_words()))
}

fn of_arch(arch: &Arch) -> Vec<Dimension> {
    let ring = arch.ring();
    let line = arch.measured_at().unwrap_or(MeasuredAt::Mean);
    let radius_m = arch.radius_at_m(line);
    let ends = [0.0, ring.embrace_rad()].map(|angle_rad| ring.radial(angle_rad) * radius_m);
    span_and_rise(ends, radius_m, arch.measured_at()).into()
}

/// Span and rise between the ends of a line and the height of its crown. The words name the line if it was set.
fn span_and_rise(
    ends: [Vector2<f64>; 2],
    crown_m: f64,
    line: Option<MeasuredAt>,
) -> [Dimension; 2] {
    let crown = Vector2::new(ends[0].x, crown_m);
    [
        Dimension::named(DimensionSide::Below, ends, "span"),
        Dimension::named(DimensionSide::Left, [ends[0], crown], "rise"),
    ]
    .map(|dimension| match line {
        None => dimension,
        Some(line) => Dimension {
            words: format!("{} {}", dimension.words, line.in_words()),
            ..dimension
        },
    })
}

fn of_column(column: &Column) -> Vec<Dimension> {
    let half_m = 0.5 * column.width_m();
    let [left, right] = [-half_m, half_m].map(|x| Vector2::new(x, 0.0));
    let top = Vector2::new(-half_m, column.height_m());
    vec![
        Dimension::plain(DimensionSide::Below, [left, right], "width"),
        Dimension::plain(DimensionSide::Left, [left, top], "height"),
    ]
}

fn of_masonry(masonry: &Masonry) -> Vec<Dimension> {
    let outlines = || masonry.row().outlines_m().iter().flatten();
    let Some([left, right]) = masonry.springings() else {
        let empty = [f64::INFINITY, f64::NEG_INFINITY].map(|x| Vector2::new(x, x));
        let [low, high] = outlines().fold(empty, |[low, high], corner| {
            [low.inf(corner), high.sup(corner)]
        });
        return vec![
            Dimension::plain(
                DimensionSide::Below,
                [low, Vector2::new(high.x, low.y)],
                "width",
            ),
            Dimension::plain(
                DimensionSide::Left,
                [low, Vector2::new(low.x, high.y)],
                "height",
            ),
        ];
    };
    let circular = match masonry.shape() {
        Shape::Circular(circular) => Some(&circular.arch),
        _ => None,
    };
    let line = circular.and_then(Arch::measured_at);
    let ends = [left, right].map(|joint| match line {
        Some(MeasuredAt::Intrados) => joint.intrados_m,
        Some(MeasuredAt::Extrados) => joint.extrados_m,
        Some(MeasuredAt::Mean) | None => joint.middle_m(),
    });
    let rise_m = match masonry.shape() {
        Shape::PointedArch(dimensions) => dimensions.rise_m,
        Shape::EllipticArch(dimensions) => dimensions.rise_m,
        Shape::BasketArch(arch) => arch.dimensions.rise_m,
        Shape::Circular(circular) => {
            let [_, rise_m] = circular
                .arch
                .span_and_rise_m(line.unwrap_or(MeasuredAt::Mean));
            rise_m
        }
        // Blocks have no springings.
        Shape::Blocks(_) => 0.0,
    };
    let mut dimensions = Vec::from(span_and_rise(ends, ends[0].y + rise_m, line));
    let piers = [
        (masonry.piers.left, left.intrados_m, DimensionSide::Left),
        (masonry.piers.right, right.intrados_m, DimensionSide::Right),
    ];
    let same = masonry.piers.left == masonry.piers.right;
    for (pier, inner, side) in piers {
        let Some(pier) = pier.filter(|_| !(same && side == DimensionSide::Right)) else {
            continue;
        };
        dimensions.extend(of_pier(&pier, inner, side));
    }
    let fill = masonry.carried.fill_m.iter();
    let level_m = fill
        .flat_map(|(_, outline)| outline)
        .map(|corner| corner.y)
        .reduce(f64::max);
    if let Some(level_m) = level_m {
        let from = right.extrados_m;
        let to = Vector2::new(from.x, level_m);
        dimensions.push(Dimension::named(DimensionSide::Right, [from, to], "fill"));
    }
    dimensions
}

/// Height and width of a pier, whose inner corner at the springing is given.
fn of_pier(pier: &Pier, inner: Vector2<f64>, side: DimensionSide) -> [Dimension; 2] {
    let foot = inner - Vector2::new(0.0, pier.height_m);
    let base = match side {
        DimensionSide::Left => [foot - Vector2::new(pier.width_m, 0.0), foot],
        _ => [foot, foot + Vector2::new(pier.width_m, 0.0)],
    };
    [
        Dimension::plain(side, [foot, inner], "pier height"),
        Dimension::plain(DimensionSide::Below, base, "pier width"),
    ]
}

fn of_masonry_in_words(masonry: &Masonry) -> Vec<String> {
    let name = match masonry.shape() {
        Shape::Circular(_) => "circular arch",
        Shape::PointedArch(_) => "pointed arch",
        Shape::EllipticArch(_) => "elliptic arch",
        Shape::BasketArch(_) => "basket-handle arch",
        Shape::Blocks(_) => "blocks",
    };
    let mut parts = vec![match masonry.springings() {
        Some([left, _]) => {
            let thick_m = (left.extrados_m - left.intrados_m).norm();
            format!("{name}, {} m thick", metres(thick_m))
        }
        None => name.to_owned(),
    }];
    if let Shape::Circular(circular) = masonry.shape() {
        parts.extend(measured(&circular.arch));
    }
    parts.push(format!("{} blocks", masonry.row().blocks().len()));
    if let Some(fill) = masonry.fill {
        let level = match fill.level {
            FillLevel::AboveSpringing(height_m) => {
                format!("{} m above the springing", metres(height_m))
            }
            FillLevel::AboveCrown(height_m) => format!("{} m above the crown", metres(height_m)),
        };
        let density = metres(fill.density_kg_m3);
        parts.push(format!("fill to {level}, {density} kg/m3"));
    }
    for load in &masonry.loads {
        let over = match load.width_m {
            0.0 => String::new(),
            width_m => format!(" over {} m", metres(width_m)),
        };
        let (mass, x) = (metres(load.mass_kg), metres(load.x_m));
        parts.push(format!("load of {mass} kg{over} at x = {x} m"));
    }
    parts
}
