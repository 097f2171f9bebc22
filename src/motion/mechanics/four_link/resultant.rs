//! Lines of resultants: the thrust line of a load and the impulse line of an impact.
//!
//! Consider a section of the ring. The part before the section transmits to the part after it the reaction at the left springing plus all loads in
//! between. This is a force with a line of action or, if the load is a change of velocity, an impulse. The points where these lines cross their
//! sections form the thrust line (impulse line). It passes through every hinge by definition.

use std::sync::Arc;

use nalgebra::{Matrix3, Vector3};

use super::mechanism::{EDGES, FourLink, HingeSites};
use crate::mechanics::{Field, Momentum, Profile, Twist};

/// Tolerance for lines outside the ring, over the thickness: hinges are accurate to about 1e-8 rad, and the line touches the edges there.
pub const EDGE_TOLERANCE: f64 = 1e-6;

/// The resultants over all sections of a ring under a load per unit mass.
#[derive(Clone, Debug)]
pub struct ResultantLine {
    pub(super) profile: Arc<dyn Profile>,
    load: Field,
    start: Momentum,
}

/// Resultant at one section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectionResultant {
    /// Along the axis, positive in compression.
    pub normal: f64,
    /// Along the section, positive when the part before pushes the part after outwards.
    pub tangential: f64,
    /// Moment of the normal component about the axis, positive when it lies outwards.
    pub moment: f64,
    /// Crossing of the line of action with the section, outwards from the axis, over the thickness:
    /// within -0.5 (intrados) to 0.5 (extrados) inside the ring.
    pub eccentricity_ratio: f64,
    /// Thickness of the section.
    pub thickness: f64,
}

impl SectionResultant {
    /// Components and position, at a section, of a force with its moment about the centre of the ring.
    pub fn new(profile: &dyn Profile, angle_rad: f64, resultant: &Momentum) -> Self {
        let normal = resultant.linear.dot(&profile.onward_normal(angle_rad));
        // A force N at distance e outwards from the axis has the moment -e N about its point there.
        let moment = -resultant.moment_about(profile.middle(angle_rad));
        let thickness = profile.thickness(angle_rad);
        Self {
            normal,
            tangential: resultant.linear.dot(&profile.outward_direction(angle_rad)),
            moment,
            eccentricity_ratio: moment / (normal * thickness),
            thickness,
        }
    }
}

/// An extreme value and the section where it is found, in radians from the left springing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extremum {
    /// Extreme value.
    pub value: f64,
    /// Section of this value.
    pub angle_rad: f64,
}

/// Extremes of a line, for a ring without tensile strength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extremes {
    /// Largest `|e|/t`: 0.5 at the edges, infinite if there is tension.
    pub eccentricity_ratio: Extremum,
    /// Smallest normal resultant.
    pub normal: Extremum,
    /// Largest ratio of the tangential to the normal resultant, the friction coefficient required to prevent sliding; infinite if there is tension.
    pub friction_ratio: Extremum,
}

impl Extremes {
    /// Whether the line is compressive and stays inside the ring, to `EDGE_TOLERANCE`.
    pub fn is_admissible(&self) -> bool {
        self.normal.value > 0.0 && self.eccentricity_ratio.value <= 0.5 + EDGE_TOLERANCE
    }
}

impl ResultantLine {
    /// Line through three hinges of `mechanism` (A, B and D), under `load`.
    ///
    /// A mechanism makes the ring statically determinate except for one number: the line passes through C
    /// as well when the load does no work on the mechanism.
    pub fn through_hinges(profile: &dyn Profile, mechanism: &FourLink, load: Field) -> Self {
        let hinges = [0, 1, 3];
        let points = mechanism.points;
        let matrix = Matrix3::from_fn(|row, column| {
            let point = points[hinges[row]];
            [-point.y, point.x, -1.0][column]
        });
        let moments = Vector3::from_fn(|row, _| {
            let hinge = hinges[row];
            load.momentum_to(profile, mechanism.hinges_rad[hinge])
                .moment_about(points[hinge])
        });
        let start = matrix
            .lu()
            .solve(&moments)
            .expect("three hinges of an admissible mechanism are not on one line");
        let (linear, angular) = (start.xy(), start.z);
        Self {
            profile: profile.to_shared(),
            load,
            start: Momentum { linear, angular },
        }
    }

    /// Force (impulse) at a section, with its moment about the centre of the ring.
    pub fn resultant_at(&self, angle_rad: f64) -> Momentum {
        self.start + self.load.momentum_to(&*self.profile, angle_rad)
    }

    /// Components and position of the resultant at a section.
    pub fn section(&self, angle_rad: f64) -> SectionResultant {
        SectionResultant::new(&*self.profile, angle_rad, &self.resultant_at(angle_rad))
    }

    /// Extremes over all sections where hinges may form anywhere, or over the joints of voussoirs, which are rigid: there the line may
    /// leave the ring between joints.
    pub fn extremes(&self, sites: HingeSites) -> Extremes {
        let mut normal = self.find_largest(sites, &|section| -section.normal);
        normal.value = -normal.value;
        let of_pressed = |of: &dyn Fn(&SectionResultant) -> f64| match normal {
            Extremum { value, angle_rad } if value <= 0.0 => Extremum {
                value: f64::INFINITY,
                angle_rad,
            },
            _ => self.find_largest(sites, of),
        };
        Extremes {
            eccentricity_ratio: of_pressed(&|section| section.eccentricity_ratio.abs()),
            normal,
            friction_ratio: of_pressed(&|section| (section.tangential / section.normal).abs()),
        }
    }

    /// Largest value of a quantity. The quantity is smooth where the load is rigid: it is sampled, then every maximum is refined.
    fn find_largest(&self, sites: HingeSites, of: &dyn Fn(&SectionResultant) -> f64) -> Extremum {
        let at = |angle_rad: f64| Extremum {
            value: of(&self.section(angle_rad)),
            angle_rad,
        };
        let sections = match sites {
            HingeSites::Voussoirs(count) => {
                return top(self.profile.sections(count).into_iter().map(at));
            }
            HingeSites::Anywhere => {
                let inside = |cut: &&f64| **cut > 0.0 && **cut < self.profile.end();
                let mut sections = self.profile.sections(SAMPLES);
                sections.extend(self.load.cuts_rad.iter().filter(inside));
                sections.sort_by(f64::total_cmp);
                sections
            }
        };
        let samples: Vec<Extremum> = sections.into_iter().map(at).collect();
        let is_top = |i: usize| {
            let near = &samples[i.saturating_sub(1)..(i + 2).min(samples.len())];
            near.iter().all(|other| other.value <= samples[i].value)
        };
        let near_tops = (1..samples.len()).filter(|i| is_top(i - 1) || is_top(*i));
        let refined = near_tops.map(|i| {
            let (from, to) = (samples[i - 1].angle_rad, samples[i].angle_rad);
            find_maximum(from, to, TOP_ACCURACY_RAD, &at)
        });
        top(refined.chain(samples.iter().copied()))
    }

    /// Derivative with respect to the angle of the moment about a hinge, where the load is `local`. Zero where the line touches the edge.
    fn edge_moment_slope(&self, mechanism: &FourLink, hinge: usize, local: Twist) -> f64 {
        let angle_rad = mechanism.hinges_rad[hinge];
        let slice = local.momentum(&self.profile.slice(angle_rad));
        let along_edge = self.profile.edge_slope(angle_rad, EDGES[hinge]);
        slice.moment_about(mechanism.points[hinge])
            - along_edge.perp(&self.resultant_at(angle_rad).linear)
    }

    /// Derivatives of the power of the load on `mechanism` (at `q' = 1`) by the sections of its hinges. The rotations change so that the
    /// mechanism stays closed.
    ///
    /// A moved hinge changes the rotations at all four hinges, but the line has no moment there. Only the moment about the moved point itself
    /// contributes. `local` is the load at each hinge.
    pub(crate) fn power_gradient(&self, mechanism: &FourLink, local: [Twist; 4]) -> [f64; 4] {
        std::array::from_fn(|i| {
            -mechanism.openings[i] * self.edge_moment_slope(mechanism, i, local[i])
        })
    }
}

/// Samples of a line over a continuous ring: fine enough to separate its maxima.
const SAMPLES: usize = 720;

/// Accuracy of the section of a maximum, in radians; the error of the value is of the order of its square.
const TOP_ACCURACY_RAD: f64 = 1e-9;

/// Largest value.
fn top(values: impl Iterator<Item = Extremum>) -> Extremum {
    let largest = values.max_by(|a, b| a.value.total_cmp(&b.value));
    largest.expect("a ring has sections")
}

/// Maximum of a smooth quantity with one maximum between two sections, to `accuracy_rad` of its section, by golden section.
pub(super) fn find_maximum(
    mut from: f64,
    mut to: f64,
    accuracy_rad: f64,
    at: &impl Fn(f64) -> Extremum,
) -> Extremum {
    let part = 0.5 * (3.0 - 5.0_f64.sqrt());
    let mut low = at(from + part * (to - from));
    let mut high = at(to - part * (to - from));
    while to - from > accuracy_rad {
        if low.value > high.value {
            (to, high) = (high.angle_rad, low);
            low = at(from + part * (to - from));
        } else {
            (from, low) = (low.angle_rad, high);
            high = at(to - part * (to - from));
        }
    }
    top([low, high].into_iter())
}
