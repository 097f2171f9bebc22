//! The frame of reference of a structure, and where its ties are in it, in words.

use super::{Structure, metres};
use crate::mechanics::arch::{Arch, MeasuredAt};
use crate::mechanics::masonry::Shape;
use crate::mechanics::tie::Tie;

impl Structure {
    /// Where the coordinates x and y are zero. Ties, loads, points and results use this frame.
    #[must_use]
    pub fn origin(&self) -> String {
        if let Some(arch) = self.circular_shape() {
            let springing_m = springing_m(arch);
            let place = if springing_m > 0.0 {
                format!(
                    "{} m below the intrados of the springings",
                    metres(springing_m)
                )
            } else {
                "level with the springings".to_owned()
            };
            return format!(
                "y = 0 at the centre of the circle, {place}; x = 0 in the middle of the span"
            );
        }
        let words = match self {
            Self::Column(_) => "y = 0 at the base, x = 0 in its middle",
            Self::Masonry(masonry) if matches!(masonry.shape(), Shape::Blocks(_)) => {
                "x and y as in the file of the joints"
            }
            _ => "y = 0 at the springings, x = 0 in the middle of the span",
        };
        words.to_owned()
    }

    /// The frame of reference and where each tie is in it, a line each; empty without ties.
    #[must_use]
    pub fn tie_places(&self) -> Vec<String> {
        let mut places = self.ties_in_words();
        if !places.is_empty() {
            places.insert(0, self.origin());
        }
        places
    }

    /// Where each tie is: its ends, and its height above the springings of an arch.
    #[must_use]
    pub fn ties_in_words(&self) -> Vec<String> {
        let springing_m = match self {
            Self::Masonry(masonry) => masonry.springings().map(|[left, _]| left.intrados_m.y),
            Self::Arch(_) | Self::Column(_) => None,
        };
        let ties = self.ties().iter().enumerate();
        ties.map(|(index, tie)| format!("tie {} {}", index + 1, place(tie, springing_m)))
            .collect()
    }

    /// The circular arch, alone or with what stands or lies beside it.
    fn circular_shape(&self) -> Option<&Arch> {
        match self {
            Self::Arch(arch) => Some(arch),
            Self::Column(_) => None,
            Self::Masonry(masonry) => match masonry.shape() {
                Shape::Circular(circular) => Some(&circular.arch),
                _ => None,
            },
        }
    }
}

/// Height of the intrados of the springings above the centre of the circle, in metres; rounding of a semicircle counts as zero.
fn springing_m(arch: &Arch) -> f64 {
    let radius_m = arch.radius_at_m(MeasuredAt::Intrados);
    let [_, rise_m] = arch.span_and_rise_m(MeasuredAt::Intrados);
    let height_m = radius_m - rise_m;
    if height_m > 1e-9 * radius_m {
        height_m
    } else {
        0.0
    }
}

fn place(tie: &Tie, springing_m: Option<f64>) -> String {
    let [from_m, to_m] = tie.ends.map(|end| end.at_m);
    let point = |x: f64, y: f64| format!("({}, {})", metres(x + 0.0), metres(y + 0.0));
    let mut words = format!(
        "from {} m to {} m",
        point(from_m.x, from_m.y),
        point(to_m.x, to_m.y)
    );
    if let Some(springing_m) = springing_m {
        let above = [from_m.y, to_m.y].map(|y| height(y - springing_m));
        let above = if above[0] == above[1] {
            above[0].clone()
        } else {
            format!("its ends {} and {}", above[0], above[1])
        };
        words += &format!(", {above} the intrados of the springings");
    }
    words
}

/// A height beside a level, in words.
fn height(above_m: f64) -> String {
    // Heights closer than a micrometre are equal.
    if above_m.abs() < 1e-6 {
        "level with".to_owned()
    } else if above_m > 0.0 {
        format!("{} m above", metres(above_m))
    } else {
        format!("{} m below", metres(-above_m))
    }
}
