//! A structure in words: dimensions, frame of reference and positions of ties.

use super::Structure;
use super::dimensions::{circular_arch, measured_line, metres};
use crate::mechanics::masonry::{FillLevel, Spread};
use crate::mechanics::{MasonryShape, MeasuredAt, PlacedLoad, Tie};
use crate::{Arch, Column, Masonry};

impl Structure {
    /// Structure in words, with properties that its drawing does not show.
    pub fn describe(&self) -> String {
        let (depth_m, density_kg_m3) = self.depth_and_density();
        let mut parts = Vec::new();
        match self {
            Self::Arch(arch) => {
                let thick_m = arch.mean_radius_m * arch.thickness_ratio;
                let [degrees, thick] = [arch.embrace_deg, thick_m].map(metres);
                parts.push(format!(
                    "circular arch of {degrees} degrees, {thick} m thick"
                ));
                parts.extend(arch.voussoirs.map(|count| format!("{count} voussoirs")));
                parts.extend(arch.measured_at.map(line_in_words));
            }
            Self::Column(column) => parts.extend(column_words(column)),
            Self::Masonry(masonry) => parts.extend(masonry_words(masonry)),
        }
        let [depth, density] = [depth_m, density_kg_m3].map(metres);
        parts.push(format!("{depth} m deep, {density} kg/m3"));
        parts.push(self.origin());
        parts.extend(self.ties_in_words());
        parts.join("; ")
    }

    /// Origin of the coordinates x and y, in words. Ties, loads, points and results use this frame.
    pub fn origin(&self) -> String {
        let circular = match self {
            Self::Arch(arch) => Some(arch),
            Self::Column(_) => None,
            Self::Masonry(masonry) => circular_arch(masonry),
        };
        if let Some(arch) = circular {
            let below = match springing_m(arch) {
                0.0 => "level with the springings".to_owned(),
                below_m => format!("{} m below the intrados of the springings", metres(below_m)),
            };
            return format!(
                "y = 0 at the centre of the circle, {below}; x = 0 in the middle of the span"
            );
        }
        let words = match self {
            Self::Column(_) => "y = 0 at the base, x = 0 in its middle",
            Self::Masonry(masonry) if matches!(masonry.shape, MasonryShape::Blocks(_)) => {
                "x and y as in the file of the joints"
            }
            _ => "y = 0 at the springings, x = 0 in the middle of the span",
        };
        words.to_owned()
    }

    /// Frame of reference and the position of each tie, one line each; empty without ties.
    pub fn tie_places(&self) -> Vec<String> {
        let mut places = self.ties_in_words();
        if !places.is_empty() {
            places.insert(0, self.origin());
        }
        places
    }

    /// Position of each tie in words: its ends, and its height above the springings of an arch.
    pub fn ties_in_words(&self) -> Vec<String> {
        let springing_m = match self {
            Self::Masonry(masonry) => masonry.springings().map(|[left, _]| left.intrados_m.y),
            Self::Arch(_) | Self::Column(_) => None,
        };
        let ties = self.ties().iter().enumerate();
        ties.map(|(index, tie)| format!("tie {} {}", index + 1, tie_position(tie, springing_m)))
            .collect()
    }
}

/// Line along which span and rise are measured, in words.
fn line_in_words(line: MeasuredAt) -> String {
    format!("span and rise {}", line.in_words())
}

fn column_words(column: &Column) -> Vec<String> {
    let wall = column.wall().map(|(wall, height_m)| {
        let (side, height) = (wall.side.name(), metres(height_m));
        format!(" against a wall of {height} m on its {side}")
    });
    let mut parts = match column.given {
        Some(body) => {
            let [mass, inertia] = [body.mass_kg, body.inertia_kg_m2].map(metres);
            let [x, y] = [column.body().centre_m.x, body.centre_m.y].map(metres);
            vec![format!(
                "body of {mass} kg and {inertia} kg m2, centre at ({x}, {y}) m; drawn as a block"
            )]
        }
        None => vec![format!("column{}", wall.unwrap_or_default())],
    };
    parts.extend(column.top.map(|top| {
        let [weight_kn, x] = [1e-3 * top.weight_n, top.x_m].map(metres);
        format!("top held sideways by a floor of {weight_kn} kN at x = {x} m")
    }));
    parts.extend(column.placed_loads().map(|(load, at_m)| {
        let [x, y] = [at_m.x, at_m.y].map(metres);
        let load = load_in_words(load);
        format!("load at ({x}, {y}) m: {load}")
    }));
    parts
}

/// Weight and thrust of a load, each as a direction and in words. Directions: 0 downwards, 1 to the right, -1 to the left. A mass that does not
/// move with its block is a constant weight. Empty without forces.
pub fn forces_in_words(load: &PlacedLoad) -> Vec<(f64, String)> {
    let mut forces = Vec::new();
    if load.mass_kg > 0.0 {
        let mass = metres(load.mass_kg);
        forces.push(match load.moves {
            _ if load.live => (0.0, format!("{mass} kg live")),
            true => (0.0, format!("{mass} kg")),
            false => (0.0, format!("{mass} kg as constant weight")),
        });
    }
    if load.thrust_n != 0.0 {
        let side = if load.thrust_n > 0.0 { "right" } else { "left" };
        let thrust_kn = metres(load.thrust_n.abs() / 1e3);
        let thrust = format!("thrust of {thrust_kn} kN to the {side}");
        forces.push((load.thrust_n.signum(), thrust));
    }
    forces
}

/// Load in words.
pub fn load_in_words(load: &PlacedLoad) -> String {
    let forces = forces_in_words(load).into_iter();
    let words: Vec<_> = forces.map(|(_, words)| words).collect();
    match words.is_empty() {
        true => "0 kg".to_owned(),
        false => words.join(", "),
    }
}

fn masonry_words(masonry: &Masonry) -> Vec<String> {
    let name = match masonry.shape {
        MasonryShape::Circular(_) => "circular arch",
        MasonryShape::PointedArch(_) => "pointed arch",
        MasonryShape::EllipticArch(_) => "elliptic arch",
        MasonryShape::BasketArch(_) => "basket-handle arch",
        MasonryShape::Blocks(_) => "blocks",
    };
    let thick = masonry.springings().map(|[left, _]| {
        let thick_m = (left.extrados_m - left.intrados_m).norm();
        format!(", {} m thick", metres(thick_m))
    });
    let mut parts = vec![format!("{name}{}", thick.unwrap_or_default())];
    parts.extend(measured_line(masonry).map(line_in_words));
    parts.push(format!("{} blocks", masonry.row.blocks.len()));
    parts.extend(masonry.fill.map(|fill| {
        let (height_m, line) = match fill.level {
            FillLevel::AboveSpringing(height_m) => (height_m, "springing"),
            FillLevel::AboveCrown(height_m) => (height_m, "crown"),
        };
        let [height, density] = [height_m, fill.density_kg_m3].map(metres);
        let piers = [", none on the piers", ""][usize::from(fill.on_piers)];
        format!("fill to {height} m above the {line}, {density} kg/m3{piers}")
    }));
    parts.extend(masonry.loads.iter().map(|load| {
        let [mass, width, x] = [load.mass_kg, load.width_m, load.x_m].map(metres);
        let over = match load.width_m {
            0.0 => String::new(),
            _ => format!(" over {width} m"),
        };
        let live = if load.live { "live " } else { "" };
        match (load.pier, load.moves && load.thrust_n == 0.0) {
            (None, true) => format!("{live}load of {mass} kg{over} at x = {x} m"),
            (None, false) => format!("load at x = {x} m: {}", load_in_words(load)),
            (Some(side), _) => {
                let at = match load.height_m.map(metres) {
                    Some(height) => format!("{height} m above its foot"),
                    None => "at its top".to_owned(),
                };
                let (side, load) = (side.name(), load_in_words(load));
                format!("load on the {side} pier {at}: {load}")
            }
        }
    }));
    parts.extend(masonry.vehicle.as_ref().map(|vehicle| {
        let axles = vehicle.axles_kg.iter().map(|axle_kg| metres(*axle_kg));
        let axles = axles.collect::<Vec<_>>().join(", ");
        let spread = match vehicle.spread {
            Spread::None => "",
            Spread::TwoToOne => ", spread 2:1 through the fill",
        };
        match &vehicle.spacing_m[..] {
            [] => format!("vehicle with one axle of {axles} kg{spread}"),
            spacing_m => {
                let apart = spacing_m.iter().map(|spacing_m| metres(*spacing_m));
                let apart = apart.collect::<Vec<_>>().join(", ");
                format!("vehicle with axles of {axles} kg, {apart} m apart{spread}")
            }
        }
    }));
    parts
}

/// Height of the intrados of the springings above the centre of the circle, in metres; zero for a semicircle with rounding errors.
fn springing_m(arch: &Arch) -> f64 {
    let radius_m = arch.radius_at_m(MeasuredAt::Intrados);
    let [_, rise_m] = arch.span_and_rise_m(MeasuredAt::Intrados);
    let height_m = radius_m - rise_m;
    match height_m > 1e-9 * radius_m {
        true => height_m,
        false => 0.0,
    }
}

fn tie_position(tie: &Tie, springing_m: Option<f64>) -> String {
    let ends_m = tie.ends.map(|end| end.at_m);
    let [from, to] = ends_m.map(|at| format!("({}, {})", metres(at.x + 0.0), metres(at.y + 0.0)));
    let above = springing_m.map_or_else(String::new, |springing_m| {
        let [one, other] = ends_m.map(|at| height(at.y - springing_m));
        let above = match one == other {
            true => one,
            false => format!("its ends {one} and {other}"),
        };
        format!(", {above} the intrados of the springings")
    });
    format!("from {from} m to {to} m{above}")
}

/// Height relative to a level, in words.
fn height(above_m: f64) -> String {
    // Heights up to a micrometre count as zero.
    let height = metres(above_m.abs());
    match above_m {
        -1e-6..1e-6 => "level with".to_owned(),
        0.0.. => format!("{height} m above"),
        _ => format!("{height} m below"),
    }
}
