//! How far a springing may move until the arch falls, and what push it bears on the way: see [`crate::mechanics::settling`].

mod picture;
mod told;

use rayon::iter::{
    IndexedParallelIterator as _, IntoParallelRefIterator as _, ParallelIterator as _,
};
use thiserror::Error;

pub use self::told::{FILES, tell};
use crate::mechanics::blocks::{Row, RowError};
use crate::mechanics::geometry::pose::Pose;
use crate::mechanics::parts::Parts as _;
use crate::mechanics::settling::{
    Follower, Hinge, Movement, Movements, Reached, SettlingError, Snap, State,
};
use crate::mechanics::sway::Sway;
use crate::scenario::Scenario;

/// Equal parts of a way at which its states are told.
const STEPS: u32 = 20;
/// Both sides, right first.
const SIDES: [Sway; 2] = [Sway::Right, Sway::Left];
/// No way is longer than so many clear spans.
const LONGEST: f64 = 1.0;

named! {
    /// One of the two springings.
    pub enum Springing {
        /// The left one.
        Left = "left",
        /// The right one.
        Right = "right",
    }
}

/// In which direction a springing moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Way {
    /// Which one moves; the other stands still.
    pub springing: Springing,
    /// From outwards (0) over down (90) to inwards (180); up is -90.
    pub angle_deg: f64,
}

impl Way {
    /// Outwards, inwards and down.
    pub const USUAL_DEG: [f64; 3] = [0.0, 180.0, 90.0];

    /// Its name for people.
    #[must_use]
    pub fn words(&self) -> String {
        match self.angle_deg {
            0.0 => "outwards".to_owned(),
            90.0 => "down".to_owned(),
            180.0 => "inwards".to_owned(),
            -90.0 => "up".to_owned(),
            angle_deg => format!("at {angle_deg} degrees"),
        }
    }

    /// So far along it, in metres.
    #[must_use]
    pub fn movements(&self, movement_m: f64) -> Movements {
        // Quarters of a turn have no rounding.
        let [outwards, down] = match self.angle_deg {
            0.0 => [1.0, 0.0],
            90.0 => [0.0, 1.0],
            180.0 => [-1.0, 0.0],
            -90.0 => [0.0, -1.0],
            angle_deg => {
                let (sin, cos) = angle_deg.to_radians().sin_cos();
                [cos, sin]
            }
        };
        let movement = Movement {
            spread_m: movement_m * outwards,
            settlement_m: movement_m * down,
            rotation_rad: 0.0,
        };
        match self.springing {
            Springing::Left => Movements {
                left: movement,
                ..Movements::default()
            },
            Springing::Right => Movements {
                right: movement,
                ..Movements::default()
            },
        }
    }
}

/// The arch when a springing has moved so far.
#[derive(Clone, Debug, PartialEq)]
pub struct Stage {
    /// By how much it has moved, in metres.
    pub movement_m: f64,
    /// Hinges and forces; `None` where nothing has moved yet, and they are not determined.
    pub state: Option<State>,
    /// Where the blocks are.
    pub poses: Vec<Pose>,
    /// By how much the crown is lower than undeformed, in metres.
    pub crown_drop_m: f64,
    /// The horizontal ground acceleration, in units of gravity, that makes hinges give way, to the right and to the left; `None` where none
    /// does. With three hinges open it is small, and says nothing of safety.
    pub first_motion_g: [Option<f64>; 2],
    /// The horizontal ground acceleration that makes the arch fall, likewise.
    pub capacity_g: [Option<f64>; 2],
    /// Pushes that are `None` because they were not found.
    pub not_found: Vec<NotFound>,
}

named! {
    /// One of the two pushes to a side.
    pub enum Push {
        /// The one that makes hinges give way.
        FirstMotion = "first motion",
        /// The one that makes the arch fall.
        Capacity = "capacity",
    }
}

/// A push that was not found.
#[derive(Clone, Debug, PartialEq)]
pub struct NotFound {
    /// Which push.
    pub push: Push,
    /// To which side.
    pub sway: Sway,
    /// Why.
    pub reason: SettlingError,
}

/// What an arch does while a springing moves one way.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// The way.
    pub way: Way,
    /// The arch at equal parts of it.
    pub stages: Vec<Stage>,
    /// Where hinges gave way to others, in metres; the last one may be its fall.
    pub snaps: Vec<Snap>,
    /// Where it falls, in metres; `None`: not within the clear span, or not known.
    pub falls_at_m: Option<f64>,
    /// Why it was not followed beyond its last stage, if it neither fell nor came to the end of its way.
    pub lost: Option<SettlingError>,
}

/// An arch on springings that move.
#[derive(Clone, Debug, PartialEq)]
pub struct SpreadPaths {
    /// Its blocks.
    pub row: Row,
    /// Distance of the springings at the intrados, in metres.
    pub clear_span_m: f64,
    /// One for every way.
    pub paths: Vec<Path>,
}

/// Why there are no such paths.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum NoSpread {
    /// It is no row of blocks.
    #[error(transparent)]
    Row(#[from] RowError),
    /// It cannot be followed.
    #[error(transparent)]
    Settling(#[from] SettlingError),
}

/// Moves a springing of the arch of a scenario along each of these ways, from where it was built or `[supports]` has it.
///
/// # Errors
/// When it is no row of blocks between two supports, or does not stand. Ways on which it is lost end there.
pub fn spread(scenario: &Scenario, ways: &[Way]) -> Result<SpreadPaths, NoSpread> {
    let row = scenario.structure().row()?;
    let joints = row.joints();
    let across = joints[joints.len() - 1].intrados_m - joints[0].intrados_m;
    let clear_span_m = across.norm();
    let settled = scenario.motion().supports().unwrap_or_default();
    let longest_m = LONGEST * clear_span_m;
    let paths = ways.par_iter().with_max_len(1);
    let paths = paths.map(|way| path(&row, settled, *way, longest_m));
    Ok(SpreadPaths {
        paths: paths.collect::<Result<_, _>>()?,
        clear_span_m,
        row: row.clone(),
    })
}

/// First how far it goes, then the stages on the way there.
fn path(row: &Row, settled: Movements, way: Way, longest_m: f64) -> Result<Path, SettlingError> {
    let movements = |movement_m: f64| settled + way.movements(movement_m);
    let mut start = Follower::new(row)?;
    // That it stands there was seen when the scenario was read.
    start.move_supports(|part| settled * part, 0.0, 1.0)?;
    let before = start.snaps.len();
    let mut scout = start.clone();
    let (end_m, falls_at_m, mut lost) = match scout.move_supports(movements, 0.0, longest_m) {
        Ok(Reached::Falls(at_m)) => (at_m, Some(at_m), None),
        Ok(Reached::End) => (longest_m, None, None),
        // Where that is not known, the stages below end before it.
        Err(error) => (error.at().unwrap_or(longest_m), None, Some(error)),
    };
    let mut follower = start;
    let mut places = vec![(follower.clone(), 0.0)];
    let mut here_m = 0.0;
    for step in 1..=STEPS {
        let next_m = end_m * f64::from(step) / f64::from(STEPS);
        if next_m <= here_m {
            break;
        }
        let reached = match follower.move_supports(movements, here_m, next_m) {
            Ok(reached) => reached,
            Err(error) => {
                lost = lost.or(Some(error));
                break;
            }
        };
        places.push((follower.clone(), next_m));
        // Rounding may let it fall just before its end.
        if reached != Reached::End {
            break;
        }
        here_m = next_m;
    }
    // The pushes of one place do not depend on those of another.
    let stages = places.par_iter().with_max_len(1);
    let stages = stages.map(|(follower, movement_m)| stage(follower, *movement_m));
    Ok(Path {
        way,
        stages: stages.collect(),
        snaps: scout.snaps[before..].to_vec(),
        falls_at_m,
        lost,
    })
}

fn stage(follower: &Follower<'_>, movement_m: f64) -> Stage {
    let row = follower.row;
    let (place, crown_m) = row.crown();
    let block = place as usize;
    let poses = &follower.placement().poses;
    let mut not_found = Vec::new();
    let mut found = |push, sway, result: Result<Option<f64>, SettlingError>| {
        result.unwrap_or_else(|reason| {
            not_found.push(NotFound { push, sway, reason });
            None
        })
    };
    let pushes = SIDES.map(|sway| {
        let first_g = follower.first_motion_g(sway).map_err(SettlingError::from);
        let first_g = found(Push::FirstMotion, sway, first_g);
        let capacity_g = match first_g {
            Some(first_g) => found(Push::Capacity, sway, follower.capacity_g(sway, first_g)),
            None => None,
        };
        [first_g, capacity_g]
    });
    Stage {
        movement_m,
        state: follower.state(),
        poses: poses.to_vec(),
        crown_drop_m: (crown_m - poses[block].of(crown_m)).y,
        first_motion_g: pushes.map(|[first_g, _]| first_g),
        capacity_g: pushes.map(|[_, capacity_g]| capacity_g),
        not_found,
    }
}

impl Stage {
    /// Horizontal force between springings and arch, over its weight; `None` where it is not determined.
    #[must_use]
    pub fn thrust_ratio(&self) -> Option<f64> {
        let state = self.state.as_ref()?;
        Some(state.right_reaction.linear.x.abs())
    }

    /// The hinges, none where nothing has moved.
    #[must_use]
    pub fn hinges(&self) -> &[Hinge] {
        self.state.as_ref().map_or(&[], |state| &state.hinges)
    }

    /// A push to the right and to the left.
    fn sides(&self, push: Push) -> [Option<f64>; 2] {
        match push {
            Push::FirstMotion => self.first_motion_g,
            Push::Capacity => self.capacity_g,
        }
    }

    /// The lesser of a push to the right and one to the left; `None` where none moves the arch, or one of them was not found.
    fn least(&self, push: Push) -> Option<f64> {
        // Without its first motion a capacity is not sought.
        let mut missing = self.not_found.iter();
        if missing.any(|missing| missing.push == push || missing.push == Push::FirstMotion) {
            return None;
        }
        self.sides(push).into_iter().flatten().reduce(f64::min)
    }
}
