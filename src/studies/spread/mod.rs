//! The movement of a springing at which the arch collapses, and the pushes that the arch resists before: see [`crate::mechanics::settling`].

mod picture;
mod report;

use askama::Template;
use nalgebra::Vector2;
use serde::{Deserialize, Serialize};
use serde_json::Value;

pub use self::report::{FILES, report};
use super::StudyError;
use super::report::{Report, Warnings};
use super::runner::in_parallel;
use crate::argument::format_fixed;
use crate::mechanics::settling::{HingeState, Movement, Pin, Snap};
use crate::mechanics::{Follower, Movements, Parts as _, SettlingError, Sides};
use crate::output::filters;
use crate::scenario::Varied;
use crate::{Pose, Row, Scenario, Sway};

/// Number of equal parts of a movement, with a stage at the end of each.
const STEPS: u32 = 20;
/// Indices of the stages that words show.
const PARTS: [usize; 5] = [0, 5, 10, 15, 20];
/// Largest meaningful thrust, over the weight of the arch: beyond it three hinges are on one line.
const LARGEST_THRUST: f64 = 1e5;
/// Reason why a stage with a larger thrust has no pushes.
const ALIGNED: &str = "its three hinges lie on one line, and the thrust grows beyond all bounds";
/// Largest movement, in clear spans.
const LONGEST_RATIO: f64 = 1.0;

/// Direction in which a springing moves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpringingDirection {
    /// The springing that moves; the other one is fixed.
    pub springing: Sway,
    /// Angle in degrees: outwards (0), down (90), inwards (180), up (-90).
    pub angle_deg: f64,
}

impl SpringingDirection {
    /// Default directions: outwards, inwards and down.
    pub const DEFAULT_DEG: [f64; 3] = [0.0, 180.0, 90.0];

    /// Name of the direction in words.
    pub fn label(&self) -> String {
        match self.angle_deg {
            0.0 => "outwards".to_owned(),
            90.0 => "down".to_owned(),
            180.0 => "inwards".to_owned(),
            -90.0 => "up".to_owned(),
            angle_deg => format!("at {angle_deg} degrees"),
        }
    }

    /// Movements of both springings for a distance along this direction, in metres.
    pub fn movements(&self, movement_m: f64) -> Movements {
        let (sin, cos) = libm::sincos(self.angle_deg.to_radians());
        // Removes rounding errors of right angles.
        let is_quarter = self.angle_deg % 90.0 == 0.0;
        let [outwards, down] = [cos, sin].map(|part| if is_quarter { part.round() } else { part });
        let movement = Movement {
            spread_m: movement_m * outwards,
            settlement_m: movement_m * down,
            rotation_rad: 0.0,
        };
        let (left, right) = match self.springing {
            Sway::Left => (movement, Movement::default()),
            Sway::Right => (Movement::default(), movement),
        };
        Movements { left, right }
    }
}

/// The arch at a movement of a springing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stage {
    /// Movement of the support from its initial position, undeformed or that of `[supports]`, in metres.
    pub movement_m: f64,
    /// Open hinges; none before the first movement.
    pub hinges: Vec<HingeOpening>,
    /// Horizontal force between springings and arch, in N. `None` before the first movement, because it is not determined, and with three hinges
    /// on one line, because it is infinite.
    pub thrust_n: Option<f64>,
    /// Horizontal force between springings and arch, over the weight of the arch; `None` as `thrust_n`.
    pub thrust_ratio: Option<f64>,
    /// Force of the right support on the arch, in N; `None` as `thrust_n`.
    pub right_support_force_n: Option<Vector2<f64>>,
    /// Smallest coefficient of friction with which no joint slides; `None` before the first movement.
    pub friction_demand: Option<f64>,
    /// Drop of the crown from its undeformed position, in metres.
    pub crown_drop_m: f64,
    /// The horizontal ground acceleration at which the arch first moves, in units of gravity; `None` if no acceleration moves it. With three
    /// open hinges it is small, and is not a safety margin.
    pub first_motion_g: Sides<Option<f64>>,
    /// The horizontal ground acceleration at which the arch collapses, in units of gravity; `None` if the arch does not collapse below 100 g, or
    /// the push was not found.
    pub capacity_g: Sides<Option<f64>>,
    /// Pushes that were not found; their values are `None`.
    pub not_found: Vec<MissingPush>,
    /// Forces and rotations; `None` before the first movement.
    #[serde(skip)]
    pub state: Option<HingeState>,
    /// Positions of the blocks.
    #[serde(skip)]
    pub poses: Vec<Pose>,
}

/// An open hinge with its rotation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct HingeOpening {
    /// Position of the hinge.
    #[serde(flatten)]
    pub hinge: Pin,
    /// Relative rotation of the part on its right to the part on its left, anticlockwise, in radians.
    pub rotation_rad: f64,
}

named! {
    /// One of the two pushes of a stage to a side.
    pub enum Push {
        /// The push at which the arch first moves.
        FirstMotion = "first motion",
        /// The push at which the arch collapses.
        Capacity = "capacity",
    }
}

/// A push that was not found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MissingPush {
    /// The push.
    pub push: Push,
    /// Direction of the push.
    #[serde(rename = "side")]
    pub sway: Sway,
    /// The reason.
    pub reason: String,
}

/// The arch while a springing moves in one direction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpreadPath {
    /// The direction of the movement.
    #[serde(flatten)]
    pub direction: SpringingDirection,
    /// Movement from the initial position at which the arch collapses, in metres; `None` if it exceeds the clear span or is unknown.
    pub falls_at_m: Option<f64>,
    /// Movement at which the arch collapses, over the clear span; `None` as `falls_at_m`.
    pub falls_at_part_of_clear_span: Option<f64>,
    /// Joints at which the thrust line reaches an edge at collapse, or which close.
    pub falls_by: Vec<Pin>,
    /// Reason why the path could not be computed to collapse or to the full movement.
    pub lost: Option<String>,
    /// Snaps: changes to other hinges. The last one may be the collapse.
    pub snaps: Vec<Snap>,
    /// The arch at equal parts of the movement.
    pub stages: Vec<Stage>,
}

/// An arch on springings that move.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Template)]
#[template(path = "studies/spread/words.txt")]
pub struct SpreadSummary {
    /// Distance between the springings at the intrados, in metres.
    pub clear_span_m: f64,
    /// Weight of the arch, in N.
    pub weight_n: f64,
    /// Name of the supports: `springing`, `foot` of a pier, or `support` of given blocks.
    pub support: String,
    /// Coefficient of friction of the scenario; absent if joints cannot slip.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction_coefficient: Option<f64>,
    /// The path for each direction.
    pub paths: Vec<SpreadPath>,
    /// The warnings.
    #[serde(flatten)]
    pub warnings: Warnings,
    /// The scenario with all defaults.
    pub scenario: Value,
}

/// Moves a springing of the arch of a scenario in each of these directions, from the undeformed position or the position of `[supports]`.
///
/// # Errors
/// When the structure is not a row of blocks between two supports, or cannot stand. If a movement cannot be computed further, its path ends
/// there.
pub fn spread(
    scenario: &Scenario,
    directions: &[SpringingDirection],
) -> Result<SpreadSummary, StudyError> {
    let row = scenario.structure.row().map_err(StudyError::scenario)?;
    let weight_n = row.mass_kg() * scenario.gravity_m_s2();
    let joints = &row.joints;
    let across = joints[joints.len() - 1].intrados_m - joints[0].intrados_m;
    let clear_span_m = across.norm();
    let settled = scenario.motion.supports().unwrap_or_default();
    let sizes = [clear_span_m, weight_n];
    let compute = |direction: &SpringingDirection| path(&row, settled, *direction, sizes);
    let paths = in_parallel(directions, compute)
        .into_iter()
        .collect::<Result<_, _>>();
    Ok(SpreadSummary {
        paths: paths.map_err(StudyError::scenario)?,
        clear_span_m,
        weight_n,
        support: scenario.structure.support_name().to_owned(),
        warnings: Warnings::new(scenario.unlikely_in(&Varied::default()), []),
        scenario: scenario.to_json(),
        friction_coefficient: scenario.motion.options.friction_coefficient(),
    })
}

/// Computes a path: first its end, then its stages.
fn path(
    row: &Row,
    settled: Movements,
    direction: SpringingDirection,
    [clear_span_m, weight_n]: [f64; 2],
) -> Result<SpreadPath, SettlingError> {
    let longest_m = LONGEST_RATIO * clear_span_m;
    let movements = |movement_m: f64| settled + direction.movements(movement_m);
    let mut start = Follower::new(row)?;
    // The reader of the scenario has checked that the arch stands on the moved springings.
    start.move_supports(|part| settled * part, 0.0, 1.0)?;
    let before = start.snaps.len();
    let mut scout = start.clone();
    let (end_m, falls_at_m, mut lost) = match scout.move_supports(movements, 0.0, longest_m) {
        Ok(falls_at_m) => (falls_at_m.unwrap_or(longest_m), falls_at_m, None),
        // If the end is unknown, the loop below ends before it.
        Err(error) => (
            error.path_position().unwrap_or(longest_m),
            None,
            Some(error),
        ),
    };
    let mut follower = start;
    let mut places = vec![(follower.clone(), 0.0)];
    let mut here_m = 0.0;
    for step in 1..=STEPS {
        let next_m = end_m * f64::from(step) / f64::from(STEPS);
        if next_m <= here_m {
            break;
        }
        let falls_at_m = match follower.move_supports(movements, here_m, next_m) {
            Ok(falls_at_m) => falls_at_m,
            Err(error) => {
                lost = lost.or(Some(error));
                break;
            }
        };
        places.push((follower.clone(), next_m));
        // Due to rounding errors the arch may collapse just before its end.
        if falls_at_m.is_some() {
            break;
        }
        here_m = next_m;
    }
    // The pushes of one stage do not depend on those of another.
    let compute =
        |(follower, movement_m): &(Follower<'_>, f64)| stage(follower, *movement_m, weight_n);
    let stages = in_parallel(&places, compute);
    let snaps = scout.snaps[before..].to_vec();
    let fall = falls_at_m.and(snaps.last());
    Ok(SpreadPath {
        direction,
        falls_at_m,
        falls_at_part_of_clear_span: falls_at_m.map(|at_m| at_m / clear_span_m),
        falls_by: fall.map_or_else(Vec::new, |fall| fall.causes.clone()),
        lost: lost.map(|error| error.to_string()),
        snaps,
        stages,
    })
}

fn stage(follower: &Follower<'_>, movement_m: f64, weight_n: f64) -> Stage {
    let (place, crown_m) = follower.row.crown();
    let poses = &follower.stance.placement.poses;
    let state = follower.state();
    let reaction = state.as_ref().map(|state| state.right_reaction.linear);
    // A larger force is due to rounding errors of the height of three hinges on one line.
    let is_aligned = reaction.is_some_and(|force| force.x.abs() > LARGEST_THRUST);
    let reaction = reaction.filter(|_| !is_aligned);
    let mut not_found = Vec::new();
    let mut found = |push, sway, result: Result<Option<f64>, String>| {
        result.unwrap_or_else(|reason| {
            not_found.push(MissingPush { push, sway, reason });
            None
        })
    };
    let pushes = Sides::of(|sway| {
        let first_g = if is_aligned {
            Err(ALIGNED.to_owned())
        } else {
            let first_g = follower.first_motion_g(sway).map_err(SettlingError::from);
            first_g.map_err(|error| error.to_string())
        };
        let first_g = found(Push::FirstMotion, sway, first_g)?;
        let capacity_g = follower
            .capacity_g(sway, first_g)
            .map_err(|error| error.to_string());
        Some((first_g, found(Push::Capacity, sway, capacity_g)))
    });
    let open = |state: &HingeState| {
        let hinges = state.hinges.iter().zip(&state.hinge_rotations_rad);
        let open = hinges.map(|(hinge, rotation_rad)| HingeOpening {
            hinge: *hinge,
            rotation_rad: *rotation_rad,
        });
        open.collect()
    };
    Stage {
        movement_m,
        hinges: state.as_ref().map_or_else(Vec::new, open),
        thrust_n: reaction.map(|force| force.x.abs() * weight_n),
        thrust_ratio: reaction.map(|force| force.x.abs()),
        right_support_force_n: reaction.map(|force| force * weight_n),
        friction_demand: state.as_ref().map(|state| state.friction),
        crown_drop_m: (crown_m - poses[place as usize].current_position(crown_m)).y,
        first_motion_g: pushes.map(|pushes| pushes.map(|(first_g, _)| first_g)),
        capacity_g: pushes.map(|pushes| pushes.and_then(|(_, capacity_g)| capacity_g)),
        not_found,
        state,
        poses: poses.clone(),
    }
}

impl SpreadSummary {
    /// Whether the movement is further to that of `[supports]`.
    fn is_further(&self) -> bool {
        !self.scenario["supports"].is_null()
    }

    /// End of a path in words.
    fn end_of(&self, path: &SpreadPath) -> String {
        let (moving, span_m) = (
            path.movement_in_words(&self.support),
            format_fixed(self.clear_span_m, 3),
        );
        let further = match self.is_further() {
            true => ", further than `[supports]`",
            false => "",
        };
        let falls = path.falls_at_m.zip(path.falls_at_part_of_clear_span);
        let end = match (falls, &path.lost, path.stages.last()) {
            (Some((at_m, part)), ..) => {
                let (at_m, part) = (format_fixed(at_m, 6), format_fixed(part, 5));
                format!("falls at {at_m} m, {part} of the clear span of {span_m} m")
            }
            (None, Some(reason), Some(last)) => {
                let up_to_m = format_fixed(last.movement_m, 6);
                format!("stands up to {up_to_m} m, and cannot be followed further: {reason}")
            }
            _ => format!("does not fall up to the clear span of {span_m} m"),
        };
        format!("{moving}{further}: {end}")
    }
}

impl Report for SpreadSummary {
    const IS_TABLE: bool = true;

    fn verdict(&self) -> String {
        let ends = self.paths.iter().map(|path| self.end_of(path));
        ends.collect::<Vec<_>>().join("\n")
    }

    fn warnings(&self) -> &Warnings {
        &self.warnings
    }
}

impl Stage {
    /// Smaller push of both sides; `None` if no push moves the arch, or one of the pushes was not found.
    fn smaller_push(&self, push: Push) -> Option<f64> {
        // A capacity is not searched for if the first motion was not found.
        let mut missing = self.not_found.iter();
        if missing.any(|missing| missing.push == push || missing.push == Push::FirstMotion) {
            return None;
        }
        let sides = match push {
            Push::FirstMotion => self.first_motion_g,
            Push::Capacity => self.capacity_g,
        };
        <[_; 2]>::from(sides).into_iter().flatten().reduce(f64::min)
    }

    /// Hinges as numbers of joints with the initials of their edges.
    fn hinges_in_letters(&self) -> String {
        let letters = self.hinges.iter().map(|HingeOpening { hinge, .. }| {
            let edge = &hinge.edge.name()[..1];
            format!("{}{edge}", hinge.joint)
        });
        letters.collect::<Vec<_>>().join(" ")
    }
}

impl SpreadPath {
    /// Moving support, whose name is `support`, and its direction.
    fn movement_in_words(&self, support: &str) -> String {
        let SpringingDirection { springing, .. } = self.direction;
        format!("{} {support} {}", springing.name(), self.direction.label())
    }

    /// Stages that words show.
    fn shown_stages(&self) -> impl Iterator<Item = &Stage> {
        let last = self.stages.len() - 1;
        PARTS.iter().map(move |part| &self.stages[*part.min(&last)])
    }

    /// Each push that was not found, with the number of stages and the movement of the first stage.
    fn missing_pushes(&self) -> Vec<(usize, f64, &MissingPush)> {
        let mut missing: Vec<(usize, f64, &MissingPush)> = Vec::new();
        for stage in &self.stages {
            for one in &stage.not_found {
                let known = |(.., known): &&mut (_, _, &MissingPush)| {
                    (known.push, known.sway) == (one.push, one.sway)
                };
                match missing.iter_mut().find(known) {
                    Some((count, ..)) => *count += 1,
                    None => missing.push((1, stage.movement_m, one)),
                }
            }
        }
        missing.sort_by_key(|(.., one)| (one.push as u8, one.sway as u8));
        missing
    }

    /// Largest coefficient of friction that this path needs.
    fn friction_demand(&self) -> f64 {
        let demands = self.stages.iter().filter_map(|stage| stage.friction_demand);
        demands.fold(0.0, f64::max)
    }
}
