//! Limit analysis of an arch under live loads, or under a vehicle that crosses it: the factor on their weight at which it collapses.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use super::yielding::motion_in_words;
use crate::argument::format_fixed;
use crate::mechanics::friction::{LiveCollapse, YieldingJoint, live_collapse};
use crate::mechanics::masonry::{LoadedExtrados, Masonry, Vehicle};
use crate::mechanics::{FrictionError, PlacedLoad};
use crate::output::{CURVES, Chart, Figure, Mark, OutputError, Table, column, fields};
use crate::studies::StudyError;
use crate::studies::runner::in_parallel;
use crate::{Scenario, Structure, Sway};

/// Number of equal steps of a vehicle from where its first axle comes onto the arch to where its last one leaves it.
const STEPS: usize = 200;
/// Number of positions of a vehicle in words.
const PRINTED: usize = 12;
/// Number of times that the worst position of a vehicle is sought again on steps a tenth as long.
const FINER: i32 = 3;

/// Collapse under live loads, or under a vehicle at its worst position.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LiveLimit {
    /// Without sliding.
    pub without_sliding: LiveAnswer,
    /// With the coefficient of friction of the scenario, an upper bound if a joint slips; absent unless joints may slip.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub with_friction: Option<LiveAnswer>,
    /// The multiplier along the way of the vehicle, to the right first; absent without a vehicle.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub positions: Vec<VehiclePosition>,
}

/// The least multiplier, with its mechanism.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LiveAnswer {
    /// Factor on the live loads at which the structure collapses; null if it carries any factor.
    pub multiplier: Option<f64>,
    /// Weight of the live loads on the structure at collapse, in N; null if it carries any factor.
    pub weight_n: Option<f64>,
    /// Position of the first axle of the vehicle, in metres; absent without a vehicle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub x_m: Option<f64>,
    /// Side to which the vehicle drives; absent without a vehicle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub towards: Option<Sway>,
    /// Joints of the mechanism; empty if the structure carries any factor.
    pub mechanism: Vec<YieldingJoint>,
    /// Thrust line at collapse: x and y of its point in each joint, in metres, null without compression; empty if the structure carries any factor.
    pub thrust_line_m: Vec<Option<[f64; 2]>>,
}

/// A position of a vehicle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct VehiclePosition {
    /// Side to which the vehicle drives.
    pub towards: Sway,
    /// Position of its first axle, in metres.
    pub x_m: f64,
    /// Factor on the axles at which the structure collapses without sliding; null if it carries any factor.
    pub multiplier: Option<f64>,
    /// The same with the coefficient of friction of the scenario; null if it carries any factor, or joints do not slip.
    pub multiplier_with_friction: Option<f64>,
}

/// An arch with live loads.
struct Loaded<'m> {
    masonry: &'m Masonry,
    extrados: LoadedExtrados,
    gravity_m_s2: f64,
}

impl Loaded<'_> {
    /// Computes the collapse under live loads.
    fn collapse(
        &self,
        loads: &[PlacedLoad],
        coefficient: Option<f64>,
    ) -> Result<LiveAnswer, FrictionError> {
        let weights = self.extrados.weights(loads);
        let mass_kg: f64 = weights.iter().map(|weight| weight.mass_kg).sum();
        if mass_kg == 0.0 {
            return Ok(LiveAnswer::default());
        }
        let found = live_collapse(&self.masonry.row, coefficient, &weights)?;
        let answer = |found: LiveCollapse| LiveAnswer {
            multiplier: Some(found.multiplier),
            weight_n: Some(found.multiplier * mass_kg * self.gravity_m_s2),
            mechanism: found.yields,
            thrust_line_m: found
                .thrust_m
                .iter()
                .map(|at_m| at_m.map(Into::into))
                .collect(),
            ..LiveAnswer::default()
        };
        Ok(found.map(answer).unwrap_or_default())
    }

    /// Computes the collapse under a vehicle at a position.
    fn collapse_at(
        &self,
        vehicle: &Vehicle,
        (x_m, towards): (f64, Sway),
        coefficient: Option<f64>,
    ) -> Result<LiveAnswer, FrictionError> {
        let axles = self.extrados.axles(vehicle, x_m, towards);
        Ok(LiveAnswer {
            x_m: Some(x_m),
            towards: Some(towards),
            ..self.collapse(&axles, coefficient)?
        })
    }
}

/// A position of the first axle, and the side to which the vehicle drives.
type Position = (f64, Sway);

impl Loaded<'_> {
    /// Computes the collapse at several positions of a vehicle.
    fn collapses(
        &self,
        vehicle: &Vehicle,
        positions: &[Position],
        coefficient: Option<f64>,
    ) -> Result<Vec<LiveAnswer>, FrictionError> {
        let at = |position: &Position| self.collapse_at(vehicle, *position, coefficient);
        in_parallel(positions, at).into_iter().collect()
    }

    /// Returns the worst of some answers, or a worse one between two steps of this length.
    fn worst(
        &self,
        vehicle: &Vehicle,
        (answers, mut step_m): (&[LiveAnswer], f64),
        coefficient: Option<f64>,
    ) -> Result<LiveAnswer, FrictionError> {
        let mut worst = least(answers.to_vec());
        for _ in 0..FINER {
            let (Some(x_m), Some(towards), Some(_)) = (worst.x_m, worst.towards, worst.multiplier)
            else {
                break;
            };
            step_m *= 0.1;
            let near = (-10..=10).map(|step| (x_m + f64::from(step) * step_m, towards));
            let near = self.collapses(vehicle, &near.collect::<Vec<_>>(), coefficient)?;
            worst = least(near.into_iter().chain([worst]).collect());
        }
        Ok(worst)
    }
}

/// Returns the answer with the least multiplier, the first of equal ones.
fn least(answers: Vec<LiveAnswer>) -> LiveAnswer {
    let multiplier = |answer: &LiveAnswer| answer.multiplier.unwrap_or(f64::INFINITY);
    let answers = answers.into_iter();
    let least = answers.min_by(|one, other| multiplier(one).total_cmp(&multiplier(other)));
    least.unwrap_or_default()
}

/// Computes the collapse of an arch under its live loads or its vehicle; `None` without them.
///
/// # Errors
/// If the springings have moved, or a linear program fails.
pub(super) fn live_limit(scenario: &Scenario) -> Result<Option<LiveLimit>, StudyError> {
    let Some(masonry) = scenario.structure.under_live_loads() else {
        return Ok(None);
    };
    if scenario.motion.supports().is_some() {
        let message = "live loads are computed for the structure on the springings that were built: leave [supports] out, or the live loads";
        return Err(StudyError::scenario(message));
    }
    let loaded = Loaded {
        masonry,
        extrados: masonry.loaded_extrados().map_err(StudyError::scenario)?,
        gravity_m_s2: scenario.gravity_m_s2(),
    };
    let coefficient = scenario.motion.options.friction_coefficient();
    // Without sliding, and with the coefficient of friction if there is one.
    let all = [None].into_iter().chain(coefficient.map(Some));
    let Some(vehicle) = &masonry.vehicle else {
        let mut answers = Vec::new();
        for coefficient in all {
            answers.push(loaded.collapse(&masonry.loads, coefficient)?);
        }
        return Ok(Some(LiveLimit::of(answers, Vec::new())));
    };
    let joints_m = loaded.extrados.joints_m();
    let (from_m, to_m) = (joints_m[0], joints_m[joints_m.len() - 1]);
    let length_m = vehicle.distances_m().last().unwrap_or(0.0);
    let step_m = (to_m - from_m + length_m) / STEPS as f64;
    // The multiplier has sharp minima where an axle passes a joint. The way to the left is the mirror image of one to the right.
    let way = |towards: Sway| {
        let side = towards.sign();
        let start_m = if towards == Sway::Right {
            from_m
        } else {
            -to_m
        };
        let steps = (0..=STEPS).map(|step| start_m + step_m * step as f64);
        let joints = joints_m.iter().map(|joint_m| side * joint_m);
        let axles = joints.flat_map(|joint_m| {
            vehicle
                .distances_m()
                .map(move |behind_m| joint_m + behind_m)
        });
        let mut way: Vec<f64> = steps.chain(axles).collect();
        way.sort_by(f64::total_cmp);
        way.dedup_by(|next, before| *next - *before < 1e-9 * step_m);
        way.into_iter()
            .map(move |along_m| (side * along_m, towards))
    };
    let way: Vec<Position> = Sway::ALL.iter().copied().flat_map(way).collect();
    let (mut worst, mut curves) = (Vec::new(), Vec::new());
    for coefficient in all {
        let answers = loaded.collapses(vehicle, &way, coefficient)?;
        worst.push(loaded.worst(vehicle, (&answers, step_m), coefficient)?);
        curves.push(answers);
    }
    let positions = way.iter().enumerate().map(|(index, (x_m, towards))| {
        let multiplier = |curve: Option<&Vec<LiveAnswer>>| curve?[index].multiplier;
        VehiclePosition {
            towards: *towards,
            x_m: *x_m,
            multiplier: multiplier(curves.first()),
            multiplier_with_friction: multiplier(curves.get(1)),
        }
    });
    let positions = positions.collect();
    Ok(Some(LiveLimit::of(worst, positions)))
}

impl LiveAnswer {
    /// Returns the joints of the mechanism in words, each after its hinge, in metres; the middle of a joint that opens at no single edge.
    pub(super) fn hinges_m(&self, structure: &Structure) -> Vec<(Vector2<f64>, String)> {
        let joints = structure
            .row()
            .map_or_else(|_| Vec::new(), |row| row.joints.clone());
        let hinges = self.mechanism.iter().map(|joint| {
            let at = &joints[joint.joint];
            let at_m = match (joint.opens_intrados, joint.opens_extrados) {
                (true, false) => at.extrados_m,
                (false, true) => at.intrados_m,
                _ => at.middle_m(),
            };
            (at_m, joint_in_words(joint))
        });
        hinges.collect()
    }
}

fn joint_in_words(joint: &YieldingJoint) -> String {
    format!("joint {} {}", joint.joint, motion_in_words(joint))
}

impl LiveLimit {
    /// Returns the structure with the axles of its vehicle at the worst position without sliding, as points, in place of the vehicle.
    pub(super) fn loaded(&self, structure: &Structure) -> Structure {
        let worst = self.without_sliding.x_m.zip(self.without_sliding.towards);
        let on_axles = |masonry: &Masonry| {
            let (vehicle, (x_m, towards)) = (masonry.vehicle.as_ref()?, worst?);
            let extrados = masonry.loaded_extrados().ok()?;
            let joints_m = extrados.joints_m();
            let (from_m, to_m) = (joints_m[0], joints_m[joints_m.len() - 1]);
            let mut loads = extrados.axles(vehicle, x_m, towards);
            loads.retain(|axle| (from_m..=to_m).contains(&axle.x_m));
            loads.iter_mut().for_each(|axle| axle.width_m = 0.0);
            loads.extend(&masonry.loads);
            Masonry::new(masonry.shape.clone(), masonry.piers, masonry.fill, loads).ok()
        };
        let loaded = structure.under_live_loads().and_then(on_axles);
        loaded.map_or_else(
            || structure.clone(),
            |loaded| Structure::Masonry(Box::new(loaded)),
        )
    }

    /// Makes the answer from that without sliding, and that with friction if there is one.
    fn of(answers: Vec<LiveAnswer>, positions: Vec<VehiclePosition>) -> Self {
        let mut answers = answers.into_iter();
        Self {
            without_sliding: answers.next().unwrap_or_default(),
            with_friction: answers.next(),
            positions,
        }
    }

    /// Returns the answers, each with its condition in words.
    pub(super) fn answers(&self) -> Vec<(&'static str, &LiveAnswer)> {
        let friction = self.with_friction.iter();
        let friction = friction.map(|answer| ("with the given coefficient of friction", answer));
        let all = [("without sliding", &self.without_sliding)].into_iter();
        all.chain(friction).collect()
    }

    /// Returns the answers in words: of each the factor, then its place and its limits.
    pub(super) fn in_words(&self) -> Vec<Vec<String>> {
        let answers = self.answers().into_iter();
        let words = answers.map(|(condition, answer)| {
            let what = if answer.x_m.is_some() {
                "vehicle"
            } else {
                "live load"
            };
            let Some((multiplier, weight_n)) = answer.multiplier.zip(answer.weight_n) else {
                let words = format!("{condition}, no multiple of the {what} makes it collapse");
                return vec![words];
            };
            let place = answer.x_m.zip(answer.towards).map(|(x_m, towards)| {
                let (x, side) = (format_fixed(x_m, 3), towards.name());
                format!("its first axle is at x = {x} m, on the way to the {side}")
            });
            let slips = |joint: &YieldingJoint| joint.slips_towards.is_some();
            let is_bound = answer.mechanism.iter().any(slips);
            let bound = is_bound.then(|| "joints slip, so this is an upper bound".to_owned());
            let [multiplier, load] = [(multiplier, 4), (1e-3 * weight_n, 3)]
                .map(|(value, decimals)| format_fixed(value, decimals));
            let words =
                format!("{condition}, it collapses under {multiplier} times the {what}, {load} kN");
            [words].into_iter().chain(place).chain(bound).collect()
        });
        words.collect()
    }

    /// Returns the joints of the mechanism of an answer in words.
    pub(super) fn joints_in_words(answer: &LiveAnswer) -> impl Iterator<Item = String> {
        answer.mechanism.iter().map(joint_in_words)
    }

    /// Returns some positions of the vehicle on the way of the worst one, each with its factor without sliding, as a table.
    pub(super) fn positions_in_words(&self) -> Vec<String> {
        let towards = self.without_sliding.towards;
        let way = self
            .positions
            .iter()
            .filter(|place| Some(place.towards) == towards);
        let places: Vec<_> = way.filter(|place| place.multiplier.is_some()).collect();
        let shown = places.iter().step_by(places.len().div_ceil(PRINTED).max(1));
        let lines = shown.filter_map(|place| {
            let factor = format_fixed(place.multiplier?, 3);
            Some(format!("{:>8} {factor:>10}", format_fixed(place.x_m, 2)))
        });
        lines.collect()
    }

    /// Makes the table of the positions of the vehicle.
    pub(super) fn table(&self) -> Result<Table, OutputError> {
        type Place = VehiclePosition;
        let mut columns = vec![column("towards", |place: &Place| place.towards.name())];
        columns.extend(fields!(
            |place: &Place| place => x_m, multiplier, multiplier_with_friction
        ));
        Table::new(columns, &self.positions)
    }

    /// Draws the multiplier over the position of the vehicle.
    pub(super) fn draw_positions(&self, figure: Figure, title: &str) -> String {
        let conditions = [
            (
                "",
                (|place| place.multiplier) as fn(&VehiclePosition) -> Option<f64>,
            ),
            (", with friction", |place| place.multiplier_with_friction),
        ];
        let all = Sway::ALL
            .iter()
            .flat_map(|side| conditions.map(|it| (*side, it)));
        // Near the springings the multiplier is many times as large.
        let least = self.without_sliding.multiplier.unwrap_or(0.0);
        let curves = all
            .zip(CURVES)
            .filter_map(|((side, (condition, value)), stroke)| {
                let places = self.positions.iter().filter(|place| place.towards == side);
                let shown = |place: &VehiclePosition| {
                    let multiplier = value(place);
                    multiplier.filter(|multiplier| *multiplier <= MOST_SHOWN * least)
                };
                let points = places.map(|place| (place.x_m, shown(place).unwrap_or(f64::NAN)));
                let points: Vec<_> = points.collect();
                let name = format!("to the {}{condition}", side.name());
                let is_shown = points.iter().any(|(_, multiplier)| multiplier.is_finite());
                is_shown.then(|| Mark::curve(name, stroke, points))
            });
        let labels = [
            "position of the first axle (m)",
            "factor on the vehicle at collapse",
        ];
        Chart::around(figure, 330.0, labels, curves.collect()).draw(figure, title)
    }
}

/// Largest multiplier in the picture, over the least one.
const MOST_SHOWN: f64 = 5.0;
