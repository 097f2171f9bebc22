//! Limit analysis of an arch under live loads, or under a vehicle that crosses it: the factor on their weight at which it collapses.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use super::yielding::motion_in_words;
use crate::argument::format_fixed;
use crate::mechanics::friction::{YieldingJoint, live_collapse};
use crate::mechanics::masonry::{LoadedExtrados, Masonry, Vehicle};
use crate::mechanics::{FrictionError, PlacedLoad};
use crate::output::{CURVES, Chart, Figure, Mark, OutputError, Table, column, fields};
use crate::studies::StudyError;
use crate::studies::runner::in_parallel;
use crate::{Scenario, Structure, Sway};

/// Number of equal steps of a vehicle from where its front axle comes onto the arch to where its last one leaves it.
const STEPS: usize = 200;
/// Number of positions of a vehicle in words.
const PRINTED: usize = 12;
/// Largest multiplier in pictures and words, over the least one.
const MOST_SHOWN: f64 = 5.0;
/// Number of refinements of the worst position of a vehicle, each with steps a tenth as long.
const FINER: i32 = 5;

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

/// The least multiplier, with its mechanism. A load at a point on a joint is on the side of the joint where it is worse.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LiveAnswer {
    /// The coefficient of friction; null without sliding.
    pub friction_coefficient: Option<f64>,
    /// Factor on the live loads at which the structure collapses; null if it carries any factor.
    pub multiplier: Option<f64>,
    /// Weight of the live loads on the arch at collapse, in N; null if it carries any factor.
    pub weight_n: Option<f64>,
    /// Side to which the vehicle drives; absent without a vehicle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub towards: Option<Sway>,
    /// Axles of the vehicle from the front one on; absent without a vehicle.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub axles: Vec<PlacedAxle>,
    /// Joints of the mechanism; empty if the structure carries any factor.
    pub mechanism: Vec<YieldingJoint>,
    /// Thrust line at collapse: x and y of its point in each joint, in metres, null without compression; empty if the structure carries any factor.
    pub thrust_line_m: Vec<Option<[f64; 2]>>,
}

/// An axle of a vehicle at its worst position.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlacedAxle {
    /// Its position, in metres.
    pub x_m: f64,
    /// Mass of the axle that acts on the arch, in kg; zero for an axle off the arch.
    pub on_arch_kg: f64,
}

/// A position of a vehicle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct VehiclePosition {
    /// Side to which the vehicle drives.
    pub towards: Sway,
    /// Position of its front axle, in metres.
    pub x_m: f64,
    /// Factor on the axles at which the structure collapses without sliding; null if it carries any factor.
    pub multiplier: Option<f64>,
    /// Factor on the axles at which the structure collapses with the coefficient of friction of the scenario; null if it carries any factor, or joints
    /// do not slip.
    pub multiplier_with_friction: Option<f64>,
}

/// An arch with live loads.
struct Loaded<'m> {
    masonry: &'m Masonry,
    extrados: LoadedExtrados,
    gravity_m_s2: f64,
}

impl Loaded<'_> {
    /// Computes the collapse under live loads. Loads on joints stand on the worse side.
    fn collapse(
        &self,
        loads: &[PlacedLoad],
        coefficient: Option<f64>,
    ) -> Result<LiveAnswer, StudyError> {
        let placed = self.extrados.beside_joints(loads).into_iter();
        let answers = placed.map(|loads| self.collapse_under(&loads, coefficient));
        Ok(least(answers.collect::<Result<_, _>>()?))
    }

    fn collapse_under(
        &self,
        loads: &[PlacedLoad],
        coefficient: Option<f64>,
    ) -> Result<LiveAnswer, StudyError> {
        let weights = self.extrados.weights(loads);
        let mass_kg: f64 = weights.iter().map(|weight| weight.mass_kg).sum();
        let none = LiveAnswer {
            friction_coefficient: coefficient,
            ..LiveAnswer::default()
        };
        if mass_kg == 0.0 {
            return Ok(none);
        }
        let found = live_collapse(&self.masonry.row, coefficient, &weights);
        let found = found.map_err(|error| match error {
            FrictionError::NotSolved(status) => StudyError::failed(format!(
                "the limit analysis under live loads was not solved ({status}): move the live load, or change the spacing of the axles, by a millimetre"
            )),
            error => error.into(),
        })?;
        let Some(found) = found else { return Ok(none) };
        let thrust_m = found.thrust_m.iter();
        Ok(LiveAnswer {
            multiplier: Some(found.multiplier),
            weight_n: Some(found.multiplier * mass_kg * self.gravity_m_s2),
            mechanism: found.yields,
            thrust_line_m: thrust_m.map(|at_m| at_m.map(Into::into)).collect(),
            ..none
        })
    }

    /// Computes the collapse under a vehicle at a position.
    fn collapse_at(
        &self,
        vehicle: &Vehicle,
        (x_m, towards): Position,
        coefficient: Option<f64>,
    ) -> Result<LiveAnswer, StudyError> {
        let loads = self.extrados.axles(vehicle, x_m, towards);
        let on_arch_kg = |load: &PlacedLoad| {
            let weights = self.extrados.weights(&[*load]);
            weights.iter().map(|weight| weight.mass_kg).sum()
        };
        let axles = loads.iter().map(|load| PlacedAxle {
            x_m: load.x_m,
            on_arch_kg: on_arch_kg(load),
        });
        Ok(LiveAnswer {
            towards: Some(towards),
            axles: axles.collect(),
            ..self.collapse(&loads, coefficient)?
        })
    }
}

/// A position of the front axle, and the side to which the vehicle drives.
type Position = (f64, Sway);

impl Loaded<'_> {
    /// Computes the collapse at several positions of a vehicle.
    fn collapses(
        &self,
        vehicle: &Vehicle,
        positions: &[Position],
        coefficient: Option<f64>,
    ) -> Result<Vec<LiveAnswer>, StudyError> {
        let at = |position: &Position| self.collapse_at(vehicle, *position, coefficient);
        in_parallel(positions, at).into_iter().collect()
    }

    /// Returns the worst of some answers, or a worse one between two steps of this length.
    fn worst(
        &self,
        vehicle: &Vehicle,
        (answers, mut step_m): (&[LiveAnswer], f64),
        coefficient: Option<f64>,
    ) -> Result<LiveAnswer, StudyError> {
        let mut worst = least(answers.to_vec());
        for _ in 0..FINER {
            let front_m = worst.axles.first().map(|axle| axle.x_m);
            let place = front_m.zip(worst.towards).zip(worst.multiplier);
            let Some(((x_m, towards), _)) = place else {
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
    /// Returns the answer with the least multiplier.
    pub(super) fn governing(&self) -> &LiveAnswer {
        self.answers()[0]
    }

    /// Returns the answers, that with the least multiplier first.
    pub(super) fn answers(&self) -> Vec<&LiveAnswer> {
        let multiplier = |answer: &&LiveAnswer| answer.multiplier.unwrap_or(f64::INFINITY);
        let both = [&self.without_sliding]
            .into_iter()
            .chain(&self.with_friction);
        let mut both: Vec<&LiveAnswer> = both.collect();
        both.sort_by(|one, other| multiplier(one).total_cmp(&multiplier(other)));
        both
    }

    /// Returns the structure with the axles at their worst position as live loads, in place of the vehicle. Patches end at the ends of the arch.
    pub(super) fn loaded(&self, structure: &Structure) -> Structure {
        let worst = self.governing();
        let on_axles = |masonry: &Masonry| {
            let vehicle = masonry.vehicle.as_ref()?;
            let extrados = masonry.loaded_extrados().ok()?;
            let joints_m = extrados.joints_m();
            let (from_m, to_m) = (joints_m[0], joints_m[joints_m.len() - 1]);
            let mut loads = extrados.axles(vehicle, worst.axles.first()?.x_m, worst.towards?);
            for (axle, placed) in loads.iter_mut().zip(&worst.axles) {
                let ends_m = [-0.5, 0.5].map(|part| axle.x_m + part * axle.width_m);
                let [low_m, high_m] = ends_m.map(|end_m| end_m.clamp(from_m, to_m));
                (axle.x_m, axle.width_m) = (0.5 * (low_m + high_m), high_m - low_m);
                axle.mass_kg = placed.on_arch_kg;
            }
            loads.retain(|axle| axle.mass_kg > 0.0);
            loads.extend(&masonry.loads);
            Masonry::new(masonry.shape.clone(), masonry.piers, masonry.fill, loads).ok()
        };
        let loaded = structure.under_live_loads().and_then(on_axles);
        let loaded = loaded.map(|loaded| Structure::Masonry(Box::new(loaded)));
        loaded.unwrap_or_else(|| structure.clone())
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

    /// Returns the answers in words: of each the factor, then the axles and the conditions.
    pub(super) fn in_words(&self) -> Vec<Vec<String>> {
        let answers = self.answers().into_iter();
        answers.map(|answer| self.answer_in_words(answer)).collect()
    }

    fn answer_in_words(&self, answer: &LiveAnswer) -> Vec<String> {
        let (what, on_arch) = match self.positions[..] {
            [] => ("live load", ""),
            _ => ("vehicle", " on the arch"),
        };
        let condition = match answer.friction_coefficient {
            Some(coefficient) => format!("with a friction coefficient of {coefficient:?}"),
            None => "without sliding".to_owned(),
        };
        let Some((multiplier, weight_n)) = answer.multiplier.zip(answer.weight_n) else {
            return vec![format!(
                "{condition}, no multiple of the {what} makes it collapse"
            )];
        };
        let fails = (multiplier < 1.0).then(|| format!("the arch does not carry this {what}"));
        let axles = answer.axles.iter().map(|axle| {
            let off = if axle.on_arch_kg > 0.0 {
                ""
            } else {
                " (off the arch)"
            };
            format!("{}{off}", format_fixed(axle.x_m, 3))
        });
        let axles = axles.collect::<Vec<_>>().join(", ");
        let place = answer
            .towards
            .map(|side| format!("axles at x = {axles} m, driving to the {}", side.name()));
        let slips = |joint: &YieldingJoint| joint.slips_towards.is_some();
        let bound = answer.mechanism.iter().any(slips);
        let bound = bound.then(|| {
            "the true factor may be lower: joints are assumed to open as they slip".to_owned()
        });
        let [multiplier, load] = [(multiplier, 4), (1e-3 * weight_n, 3)]
            .map(|(value, decimals)| format_fixed(value, decimals));
        let words = format!(
            "{condition}, it collapses under {multiplier} times the {what} ({load} kN{on_arch})"
        );
        [words]
            .into_iter()
            .chain(fails)
            .chain(place)
            .chain(bound)
            .collect()
    }

    /// Returns the joints of the mechanism of an answer in words.
    pub(super) fn joints_in_words(answer: &LiveAnswer) -> impl Iterator<Item = String> {
        answer.mechanism.iter().map(joint_in_words)
    }

    /// Returns a table with a heading: positions of the vehicle in its worst direction, with their factors. The position nearest to the worst one is
    /// among them. Empty if the structure carries any factor.
    pub(super) fn positions_in_words(&self) -> Vec<String> {
        let worst = self.governing();
        let place = worst.towards.zip(worst.multiplier).zip(worst.axles.first());
        let Some(((towards, least), front)) = place else {
            return Vec::new();
        };
        let way = self
            .positions
            .iter()
            .filter(|place| place.towards == towards);
        let least_of = |place: &VehiclePosition| {
            let multipliers = [place.multiplier, place.multiplier_with_friction];
            multipliers
                .into_iter()
                .flatten()
                .fold(f64::INFINITY, f64::min)
        };
        let near: Vec<_> = way
            .filter(|place| least_of(place) <= MOST_SHOWN * least)
            .collect();
        let nearest = near.iter().min_by(|one, other| {
            let away_m = |place: &VehiclePosition| (place.x_m - front.x_m).abs();
            away_m(one).total_cmp(&away_m(other))
        });
        let shown = near.iter().step_by(near.len().div_ceil(PRINTED).max(1));
        let mut shown: Vec<_> = shown.chain(nearest).collect();
        shown.sort_by(|one, other| {
            (one.x_m * towards.sign()).total_cmp(&(other.x_m * towards.sign()))
        });
        shown.dedup();
        let factor =
            |value: Option<f64>| value.map_or("any".to_owned(), |value| format_fixed(value, 3));
        let lines = shown.into_iter().map(|place| {
            let friction = self
                .with_friction
                .is_some()
                .then(|| format!(" {:>10}", factor(place.multiplier_with_friction)));
            let (x, friction) = (format_fixed(place.x_m, 3), friction.unwrap_or_default());
            format!("{x:>9} {:>10}{friction}", factor(place.multiplier))
        });
        let friction = if self.with_friction.is_some() {
            ", and with friction"
        } else {
            ""
        };
        let heading = format!(
            "x in m of the front axle, driving to the {}; factor without sliding{friction}",
            towards.name()
        );
        [heading].into_iter().chain(lines).collect()
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
            (", friction", |place| place.multiplier_with_friction),
        ];
        let all = Sway::ALL
            .iter()
            .flat_map(|side| conditions.map(|it| (*side, it)));
        // Near the springings the multiplier is many times as large.
        let least = self.governing().multiplier.unwrap_or(0.0);
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
                let name = format!("driving to the {}{condition}", side.name());
                let is_shown = points.iter().any(|(_, multiplier)| multiplier.is_finite());
                is_shown.then(|| Mark::curve(name, stroke, points))
            });
        let labels = [
            "position of the front axle (m)",
            &*format!("factor at collapse, up to {MOST_SHOWN} × least"),
        ];
        Chart::around(figure, 330.0, labels, curves.collect()).draw(figure, title)
    }
}
