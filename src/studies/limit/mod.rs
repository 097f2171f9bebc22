//! Limit analysis of a scenario: the ground acceleration that starts the structure, and its mechanism.

mod live;
mod page;
mod report;
mod yielding;

use self::live::live_limit;
pub use self::live::{LiveAnswer, LiveLimit, PlacedAxle, VehiclePosition};
pub(super) use self::page::{FILES, results};
pub use self::report::{
    FourLinkAnswer, FourLinkSide, Friction, FrictionLimit, FrictionSide, LimitSummary, TieLimits,
    Ties, YieldingTies,
};
use self::report::{held_hinges, open_joints};
use super::StudyError;
use super::report::Warnings;
use super::results::PrintedResult;
use crate::mechanics::friction::{self, FrictionOnset};
use crate::mechanics::stability::{is_straight, limit_with_yielding_ties, onset, onset_at};
use crate::mechanics::{
    Follower, FrictionError, HeldMechanism, Movements, RowOnset, Sides, StabilityError,
};
use crate::scenario::Varied;
use crate::{FourLinkError, Row, RowModelError, Scenario, Structure, Sway};

/// The reason why no push starts an arch in which limit analysis has no mechanism.
const STRAIGHT: &str = "a straight line fits into it, along which any thrust may act";

/// Computes the onset of motion of the structure of a scenario, to both sides, and the coefficient of friction that it needs; with slipping joints,
/// also the onset for their coefficient of friction.
/// With moved springings, also the hinges on which the structure stands, and the push at which it collapses.
///
/// # Errors
/// When the structure cannot stand, or the analysis does not apply or fails.
pub fn limit(scenario: &Scenario) -> Result<PrintedResult, StudyError> {
    Ok(PrintedResult::of(&summary(scenario)?)?)
}

impl From<FrictionError> for StudyError {
    fn from(error: FrictionError) -> Self {
        match error {
            FrictionError::NotSolved(_) => Self::failed(error),
            _ => Self::scenario(error),
        }
    }
}

fn summary(scenario: &Scenario) -> Result<LimitSummary, StudyError> {
    Ok(LimitSummary {
        live: live_limit(scenario)?,
        warnings: Warnings::new(
            scenario.unlikely_in(&Varied::default()),
            scenario.default_density_in_words(),
        ),
        ..summary_of_pushes(scenario)?
    })
}

/// Summary without live loads and warnings.
fn summary_of_pushes(scenario: &Scenario) -> Result<LimitSummary, StudyError> {
    if let Some(mechanisms) = held_mechanisms(&scenario.structure)? {
        return Ok(summary_of_held_top(scenario, &mechanisms));
    }
    let row = || {
        let row = scenario.structure.row().map_err(RowModelError::from);
        row.map_err(StudyError::scenario)
    };
    let coefficient = scenario.motion.options.friction_coefficient();
    if let Some(movements) = scenario.motion.supports() {
        return compute_moved_row(scenario, &row()?, &movements, coefficient);
    }
    let mut summary = match scenario.row().map_err(StudyError::scenario)? {
        Some(row) => compute_row(scenario, &row).map_err(StudyError::scenario)?,
        None => {
            let model = scenario
                .mechanisms_without_impacts()
                .map_err(StudyError::scenario)?;
            LimitSummary {
                wall_behind: scenario.structure.wall_behind(),
                ..LimitSummary::of_mechanism(&*model, scenario.gravity_m_s2())
            }
        }
    };
    summary.friction_demand = match scenario.structure.row() {
        Ok(row) => friction_demand(&summary, |push_g, sway| {
            friction::demand(&row, push_g, sway)
        }),
        // An arch without joints may slide at any section.
        Err(_) => {
            let model = scenario.mechanisms().map_err(StudyError::scenario)?;
            Sides::of(|sway| Some(model.displaced_mechanism(sway, 0.0)?.friction))
        }
    };
    if let Some(coefficient) = coefficient {
        summary.friction = Some(with_friction(&row()?, coefficient, summary.wall_behind)?);
    }
    Ok(summary)
}

/// Mechanisms of a column whose top is held; `None` for other structures.
fn held_mechanisms(structure: &Structure) -> Result<Option<Sides<HeldMechanism>>, StudyError> {
    let sides = structure
        .held_column()
        .map(|column| Sides::try_of(|sway| HeldMechanism::new(column, sway)));
    sides.transpose().map_err(StudyError::scenario)
}

/// Summary of a column whose top is held.
fn summary_of_held_top(scenario: &Scenario, mechanisms: &Sides<HeldMechanism>) -> LimitSummary {
    let starts_g = mechanisms.map(|one| Some(one.acceleration_g));
    let hinges = mechanisms.map(held_hinges);
    let mut summary = LimitSummary::new(starts_g, hinges, scenario.gravity_m_s2());
    summary.friction_demand = mechanisms.map(|one| Some(one.displaced(0.0).friction));
    summary.top_reaction_n = Some(mechanisms.map(|one| one.reaction_n));
    let bars = mechanisms.right.row.bars();
    summary.ties = (!bars.is_empty()).then(|| Ties {
        forces_at_rest_n: bars.iter().map(|tie| tie.prestress_n).collect(),
        limits: None,
        mechanism_without: None,
    });
    summary.tie_places = scenario.structure.tie_places();
    summary
}

/// Coefficients of friction with which no joint of a row slides before it starts. `demand` computes that for a push. A coefficient that
/// is not found is no error.
fn friction_demand(
    summary: &LimitSummary,
    demand: impl Fn(f64, Sway) -> Result<Option<f64>, FrictionError>,
) -> Sides<Option<f64>> {
    let starts_g = &summary.incipient_acceleration_g;
    Sides::of(|sway| demand((*starts_g.get(sway))?, sway).ok().flatten())
}

/// Computes the onset of an undeformed row by the static theorem of limit analysis.
fn compute_row(scenario: &Scenario, row: &Row) -> Result<LimitSummary, StabilityError> {
    let gravity_m_s2 = scenario.gravity_m_s2();
    let wall_behind = scenario.structure.wall_behind();
    let onsets = Sides::try_of(|sway| match wall_behind == Some(sway) {
        true => Ok(None),
        false => onset(row, sway),
    })?;
    let starts_g = onsets.map(|onset| onset.as_ref().map(|onset| onset.acceleration_g));
    let mechanism = onsets.map(|onset| open_joints(row, onset.as_ref()));
    let mut summary = LimitSummary {
        wall_behind,
        no_push_because: is_straight(row).then(|| STRAIGHT.to_owned()),
        ..LimitSummary::new(starts_g, mechanism, gravity_m_s2)
    };
    if !row.bars().is_empty() {
        summary.ties = Some(ties(row)?);
        summary.tie_places = scenario.structure.tie_places();
    }
    if !scenario.structure.has_horizontal_thrust() {
        return Ok(summary);
    }
    summary.four_links = Some(match scenario.mechanisms() {
        // Limit analysis of the row does not need four links.
        Err(error) => FourLinkAnswer::None {
            none_because: match error {
                FourLinkError::Ties => "with ties there is no equivalent block".to_owned(),
                FourLinkError::Limit(error) => error.to_string(),
                error => error.to_string(),
            },
        },
        Ok(model) => {
            summary.bodies = model.bodies();
            FourLinkAnswer::Sides(Sides::of(|sway| FourLinkSide {
                hinges: model.hinges_after(0, sway),
                unstable_equilibrium_rad: model.critical_rotations_rad(sway),
                equivalent_block: model.equivalent(sway, gravity_m_s2),
            }))
        }
    });
    Ok(summary)
}

/// Computes the tie forces at rest, and the pushes without ties and with yielding ties, of a row that stands with its ties.
fn ties(row: &Row) -> Result<Ties, StabilityError> {
    let untied = row.clone().without_ties();
    let without = Sides::try_of(|sway| onset(&untied, sway));
    let without = match without {
        Ok(onsets) => Some(onsets.map(|onset| onset.as_ref().map(|onset| onset.acceleration_g))),
        Err(StabilityError::CannotStand(_)) => None,
        Err(error) => return Err(error),
    };
    let yielding = Sides::try_of(|sway| {
        let limit = limit_with_yielding_ties(row, sway)?;
        let onset = limit.as_ref().map(|limit| &limit.onset);
        Ok::<_, StabilityError>(YieldingTies {
            incipient_acceleration_g: onset.map(|onset| onset.acceleration_g),
            mechanism: open_joints(row, onset),
            forces_n: limit.map(|limit| limit.forces_n),
        })
    })?;
    Ok(Ties {
        forces_at_rest_n: row.ties.iter().map(|tie| tie.prestress_n).collect(),
        limits: Some(TieLimits {
            stands_without: without.is_some(),
            without: without.unwrap_or_default(),
            yielding,
        }),
        mechanism_without: None,
    })
}

/// Computes the onset of motion of an undeformed row whose joints slip.
fn with_friction(
    row: &Row,
    coefficient: f64,
    wall_behind: Option<Sway>,
) -> Result<Friction, FrictionError> {
    let sides = Sides::try_of(|sway| {
        let onset = match wall_behind == Some(sway) {
            true => None,
            false => friction::onset(row, coefficient, sway)?,
        };
        Ok::<_, FrictionError>(FrictionSide {
            incipient_acceleration_g: onset.as_ref().map(|onset| onset.acceleration_g),
            sliding_governs: onset.as_ref().is_some_and(FrictionOnset::sliding_governs),
            mechanism: onset.map(|onset| onset.yields),
        })
    })?;
    Ok(Friction {
        coefficient,
        onset: FrictionLimit::Undeformed {
            least_coefficient: friction::least_coefficient(row)?,
            sides,
        },
    })
}

/// Computes the push of the first motion and the push at collapse of a row with moved springings: see [`crate::mechanics::settling`].
fn compute_moved_row(
    scenario: &Scenario,
    row: &Row,
    movements: &Movements,
    coefficient: Option<f64>,
) -> Result<LimitSummary, StudyError> {
    let mut follower = Follower::new(row).map_err(StudyError::scenario)?;
    // The reader of the scenario has checked that the row can follow these movements.
    let moved = follower.move_supports(|part| *movements * part, 0.0, 1.0);
    moved.map_err(StudyError::scenario)?;
    let stance = &follower.stance;
    let starts_g =
        Sides::try_of(|sway| follower.first_motion_g(sway)).map_err(StudyError::scenario)?;
    let mechanism = Sides::of(|sway| open_joints(row, mechanism(row, &follower, sway).as_ref()));
    let capacity = Sides::of(|sway| match *starts_g.get(sway) {
        Some(start_g) => follower.capacity_g(sway, start_g),
        None => Ok(None),
    });
    let mut summary = LimitSummary::new(starts_g, mechanism, scenario.gravity_m_s2());
    summary.capacity_g = Some(capacity.map(|found| found.as_ref().ok().copied().flatten()));
    summary.capacity_not_found =
        Some(capacity.map(|found| found.as_ref().err().map(ToString::to_string)));
    summary.friction_demand = friction_demand(&summary, |push_g, sway| {
        friction::demand_at(row, stance, push_g, sway)
    });
    let hinges = follower.hinges.as_ref().map(|pins| pins.hinges.clone());
    summary.hinges = Some(hinges.unwrap_or_default());
    if !row.bars().is_empty() {
        summary.tie_places = scenario.structure.tie_places();
        summary.ties = Some(Ties {
            forces_at_rest_n: stance.forces_n().collect(),
            limits: None,
            mechanism_without: Some(follower.is_held_by_ties()),
        });
    }
    if let Some(coefficient) = coefficient {
        let push_g = |sway| {
            let onset = friction::onset_at(row, stance, coefficient, sway)?;
            Ok::<_, FrictionError>(onset.map(|onset| onset.acceleration_g))
        };
        let onset = FrictionLimit::Moved {
            incipient_acceleration_g: Sides::try_of(push_g)?,
        };
        summary.friction = Some(Friction { coefficient, onset });
    }
    Ok(summary)
}

/// Mechanism of a row on moved springings under a push. `None` if any push moves the row, because ties hold it on more than three
/// hinges or it is about to collapse.
fn mechanism(row: &Row, follower: &Follower<'_>, sway: Sway) -> Option<RowOnset> {
    if follower.is_held_by_ties() {
        return None;
    }
    onset_at(row, &follower.stance, sway).ok().flatten()
}
