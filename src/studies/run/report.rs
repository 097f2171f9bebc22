//! `report.html`: a self-contained page with the structure in motion, curves over time, and the printed words.
//!
//! The page needs no network. Frames are encoded in base 64: times as 64-bit numbers, motion of the ground as 32-bit numbers, rotations,
//! displacements and thrust as 16-bit multiples of a unit, states and joints as 8-bit numbers. Frames and curves are thinned, so that the page
//! of a row of a few dozen blocks is smaller than half a megabyte.

use askama::Template;
use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use super::animation::Animation;
use super::packed::{
    DrawnPiece, LARGEST_I16, body_number, byte_rounded_up, curve, encoded, encoded_f32, layouts,
    piece as drawn_piece, quantized,
};
use super::picture::LARGEST_EXCESS;
use super::points::{ObservedPoints, PointCurves};
use super::title;
use crate::dynamics::{Direction, FallEnd, GroundVelocity};
use crate::mechanics::{BodyPoint, Edge};
use crate::output::caption::ground_in_words;
use crate::output::ground::curve_g;
use crate::output::page::{
    BASE, PLAYER, PLOT_LICENCE, PLOT_SCRIPT, PLOT_STYLE, PLOTS, PROGRAM, STAGE, STYLE, script_safe,
};
use crate::output::scene::FARTHEST;
use crate::output::{Envelope, Piece, Scene, filters, render};
use crate::scenario::{DimensionSide, Language, Unlikely, Varied};
use crate::{GroundMotion, Hinge, Model, OpenHinge, Pose, Sample, Scenario, State, Summary, Sway};

/// Largest size of the frames of a page, in bytes.
const FRAME_BYTES: usize = 280_000;
/// Largest number of frames of a page: one every hundredth of a second, for ten seconds.
const MAX_FRAMES: usize = 1001;
/// Smallest limit on the number of frames, for any number of blocks.
const MIN_FRAMES: usize = 101;
/// Ratio of the largest number of frames of a history to that of its fall.
const FALL_SHARE: usize = 6;
/// Number of columns to which a curve is thinned.
const CURVE_COLUMNS: usize = 700;
/// Coordinates are rounded to this fraction of the size of the structure.
const COORDINATE_RATIO: f64 = 5e-5;
/// Code of a section without compression.
const NO_THRUST: i16 = i16::MIN;

const CURVES: &str = include_str!("report/curves.js");

/// Collects and thins the samples of a history for its page.
#[derive(Clone, Debug)]
pub struct Report {
    scene: Scene,
    bodies: Vec<String>,
    gravity_m_s2: f64,
    /// About unlikely numbers of the scenario.
    warnings: Vec<String>,
    motion: Animation,
    /// The fall after the structure has overturned.
    fall: Animation,
    fall_end: Option<FallEnd>,
    energy: Envelope,
    in_barriers: bool,
    excess_ratio: Envelope,
}

/// The page: its words, and all data that it draws. Encoded numbers are in base 64.
#[derive(Debug, Serialize, Deserialize, Template)]
#[template(path = "studies/run/report/page.html")]
struct PageContents {
    /// Direction of the ground motion.
    direction: Direction,
    /// The history in the other direction, which is not worse; absent without a second direction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    other: Option<Box<Self>>,
    title: String,
    uncertainty: String,
    verdict: String,
    warnings: Vec<String>,
    what: String,
    words: String,
    scenario: String,
    bodies: Vec<String>,
    largest_body: usize,
    /// Rotation of each body at rest, as on moved supports: results are relative to it, and poses are not.
    standing_rad: Vec<f64>,
    unit_m: f64,
    frame_m: [Vector2<f64>; 2],
    dimensions: Vec<Size>,
    opens_s: f64,
    /// The end of the history; the frames of the fall follow.
    end_s: f64,
    fall_end: Option<String>,
    /// Undeformed and moved faces of the supports.
    supports: [Vec<[f64; 4]>; 2],
    ties: Vec<[Point; 2]>,
    ties_broken_s: Vec<Option<f64>>,
    sections: Vec<[f64; 4]>,
    /// Intrados with its body, and extrados.
    joints: Vec<(i64, f64, f64, f64, f64)>,
    across: Vec<Vector2<f64>>,
    layouts: Vec<Layout>,
    frames: Frames,
    points: Option<Vec<PointCurves>>,
    energy_label: String,
    curves: Curves,
}

/// A page of a run, in one or both directions of its ground motion.
#[derive(Debug)]
pub struct ReportPage(PageContents);

impl ReportPage {
    /// Page that opens with this one, and has the history of the other direction beside it.
    #[must_use]
    pub fn with_other_direction(mut self, other: Self) -> Self {
        self.0.other = Some(Box::new(other.0));
        self
    }

    /// Page as HTML.
    pub fn html(&self) -> String {
        render(&self.0)
    }
}

/// The number of a body, and a position.
type Point = (i64, f64, f64);

/// A dimension of the structure.
#[derive(Debug, Serialize, Deserialize)]
struct Size {
    ends_m: [f64; 4],
    side: DimensionSide,
    text: String,
}

/// Outlines and hinges while the same hinges are open.
#[derive(Debug, Serialize, Deserialize)]
struct Layout {
    pieces: Vec<DrawnPiece>,
    fill: Vec<DrawnPiece>,
    /// Point, width in metres, label, and direction: 0 downwards, 1 to the right, -1 to the left.
    loads: Vec<(i64, f64, f64, f64, String, f64)>,
    hinges: Vec<(i64, f64, f64, u8)>,
    section_bodies: Vec<i64>,
    point_bodies: Vec<i64>,
}

/// Encoded numbers of all frames, as multiples of a unit where there is one.
#[derive(Debug, Serialize, Deserialize)]
struct Frames {
    times_s: String,
    rotations: String,
    rotation_unit_rad: f64,
    shifts: String,
    shift_unit_m: f64,
    layouts: String,
    ground_m: String,
    ground_g: String,
    right_foot_m: Option<String>,
    thrust_unit: Option<f64>,
    thrust: String,
    largest_stress_pa: Option<f64>,
    pressed: String,
    joints: String,
    states: String,
    count: usize,
}

/// Encoded curves over time.
#[derive(Debug, Serialize, Deserialize)]
struct Curves {
    ground_g: String,
    energy: String,
    excess: Option<String>,
}

/// Renders a page of a run again from the JSON inside it.
///
/// # Errors
/// When the JSON is not that of a page.
pub fn page_of(data: &str) -> serde_json::Result<String> {
    serde_json::from_str::<PageContents>(data).map(|page| render(&page))
}

impl Report {
    /// Makes an empty page for the structure of a scenario and its model of motion.
    pub fn new(scenario: &Scenario, model: &dyn Model) -> Self {
        let (scene, bodies) = (super::scene(scenario, model), model.bodies());
        let pressed = model.row().filter(|_| model.has_pressures());
        let pressing = pressed.map_or(0, |row| row.joints.len());
        // Rotation and displacement of each body, each section, each closed joint, time, ground and the rest, in base 64.
        let bytes = 4 * (6 * bodies.len() + 3 * (scene.sections.len() + pressing) + 24) / 3;
        let most = (FRAME_BYTES / bytes).clamp(MIN_FRAMES, MAX_FRAMES);
        let unlikely = scenario.unlikely_in(&Varied::of_model(model));
        Self {
            scene,
            bodies,
            gravity_m_s2: scenario.gravity_m_s2(),
            warnings: Unlikely::sentences(&unlikely),
            motion: Animation::new(most),
            fall: Animation::new(most / FALL_SHARE),
            fall_end: None,
            energy: Envelope::of_columns(CURVE_COLUMNS),
            in_barriers: false,
            excess_ratio: Envelope::of_columns(CURVE_COLUMNS),
        }
    }

    /// Adds a sample. Samples come in the order of time.
    pub fn push(&mut self, sample: &Sample) {
        let time_s = sample.time_s;
        self.motion.push(sample);
        self.in_barriers = sample.energy_ratio.is_some();
        let energy = sample.energy_ratio.unwrap_or(sample.energy_j);
        self.energy.push(time_s, energy);
        let excess_ratio = sample.demand.excess_ratio.min(LARGEST_EXCESS);
        self.excess_ratio.push(time_s, excess_ratio);
    }

    /// Adds a sample of the fall after the structure has overturned.
    pub fn push_fall(&mut self, sample: &Sample) {
        self.fall.push(sample);
    }

    /// Adds the end of the fall.
    pub fn end_fall(&mut self, end: FallEnd) {
        self.fall_end = Some(end);
    }

    /// Makes the page of a scenario. `uncertainty` is the text about the samples of `[uncertain]`, empty without samples; `verdict` and `words`
    /// are printed by `run`.
    pub fn page(
        &self,
        scenario: &Scenario,
        history: &Summary,
        points: Option<&ObservedPoints>,
        [uncertainty, verdict]: [&str; 2],
        words: &str,
    ) -> ReportPage {
        let ground = scenario.ground_motion();
        let mut frames = self.motion.frames();
        let fall_from = frames.len();
        frames.extend(self.fall.frames());
        let [low_m, high_m] = self.scene.bounds_m();
        let unit_m = COORDINATE_RATIO * (high_m - low_m).amax();
        let (hinges, layout_of) = layouts(&self.scene, &frames);
        let layout = |open: &&[OpenHinge]| self.layout(open, points, unit_m);
        let joints: Vec<_> = (0..).map_while(|joint| self.joint(joint)).collect();
        let across = (0..joints.len()).filter_map(|joint| self.scene.across(joint));
        let sections = self.scene.sections.iter();
        let faces = |exaggeration| {
            let faces = self.scene.supports_m(exaggeration).into_iter();
            faces.map(flatten_corners).collect()
        };
        let dimensions = self.scene.dimensions.iter().map(|dimension| Size {
            ends_m: flatten_corners(dimension.ends_m),
            side: dimension.side,
            text: dimension.label(Language::English),
        });
        let ties = self.scene.ties(&[]).into_iter();
        let of_row = history.row().into_iter();
        let broken_s = of_row.flat_map(|row| row.ties.iter().map(|tie| tie.broken_s));
        let leaves = self.excess_ratio.points().any(|(_, ratio)| ratio > 0.0);
        let end_s = frames[..fall_from]
            .last()
            .map_or(ground.start_s(), |frame| frame.time_s);
        // A structure that has turned far enough when it overturns does not fall any further.
        let falls = frames.last().is_some_and(|frame| frame.time_s > end_s);
        let fall_end = self.fall_end.as_ref();
        let fall_end = fall_end.filter(|end| falls || **end != FallEnd::Turned);
        let (structure, shaken) = (scenario.structure.describe(), ground_in_words(scenario));
        ReportPage(PageContents {
            direction: scenario.simulation.direction.first(),
            other: None,
            title: title(scenario).to_owned(),
            uncertainty: uncertainty.trim_end().to_owned(),
            verdict: verdict.trim_end().to_owned(),
            warnings: self.warnings.clone(),
            what: format!("{structure}; {shaken}"),
            words: words.trim_end().to_owned(),
            scenario: scenario.to_toml(),
            bodies: self.bodies.clone(),
            largest_body: history.largest_body(),
            standing_rad: frames
                .first()
                .map_or_else(Vec::new, |frame| standing_rad(frame)),
            unit_m,
            frame_m: self.scene.frame_m(),
            dimensions: dimensions.collect(),
            opens_s: opening_time_s(&frames[..fall_from], history),
            end_s,
            fall_end: fall_end.map(FallEnd::to_string),
            supports: [0.0, 1.0].map(faces),
            ties: ties.map(|ends| ends.map(point)).collect(),
            ties_broken_s: broken_s.collect(),
            sections: sections
                .map(|one| flatten_corners([one.middle_m, one.across_m]))
                .collect(),
            frames: self.frames(ground, &frames, layout_of, joints.len()),
            joints,
            across: across.collect(),
            layouts: hinges.iter().map(layout).collect(),
            points: points.map(ObservedPoints::page_curves),
            energy_label: self.energy_label(history),
            curves: Curves {
                ground_g: curve(curve_g(ground, self.gravity_m_s2, end_s)),
                energy: curve(self.energy.points()),
                excess: leaves.then(|| curve(self.excess_ratio.points())),
            },
        })
    }

    /// Intrados of a joint, with its body, and the extrados.
    fn joint(&self, joint: usize) -> Option<(i64, f64, f64, f64, f64)> {
        let [intrados, extrados] = self.scene.joint(joint)?;
        let (body, x_m, y_m) = point(intrados);
        Some((body, x_m, y_m, extrados.at_m.x, extrados.at_m.y))
    }

    fn energy_label(&self, history: &Summary) -> String {
        let mechanism = match history.row() {
            None => "the mechanism that moves",
            Some(_) => "the first mechanism",
        };
        match self.in_barriers {
            true => format!("Kinetic and potential energy over the barrier of {mechanism}"),
            false => "Energy (J)".to_owned(),
        }
    }

    /// Outlines and hinges of a layout.
    fn layout(&self, hinges: &[OpenHinge], points: Option<&ObservedPoints>, unit_m: f64) -> Layout {
        let drawn = |piece: Piece| drawn_piece(&piece, unit_m);
        let pieces = self.scene.pieces(hinges).into_iter();
        let loads = self.scene.load_arrows(hinges).into_iter().map(|arrow| {
            let (body, x_m, y_m) = point(arrow.at);
            (body, x_m, y_m, arrow.width_m, arrow.label, arrow.sideways)
        });
        let marks = self
            .scene
            .hinges(hinges)
            .into_iter()
            .zip(hinges)
            .map(|(at, open)| {
                let code = match open.hinge {
                    Hinge::Section { edge, .. } => edge_code(Some(edge)),
                    Hinge::Toe(side) | Hinge::Face { side, .. } => edge_code(Some(match side {
                        Sway::Left => Edge::Intrados,
                        Sway::Right => Edge::Extrados,
                    })),
                    Hinge::Joint { edge, .. } => edge_code(edge),
                };
                let (body, x_m, y_m) = point(at);
                (body, x_m, y_m, code)
            });
        let bodies = self.scene.bodies_of_sections(hinges).into_iter();
        let points = points.into_iter().flat_map(|points| points.bodies(hinges));
        Layout {
            pieces: pieces.chain(self.scene.wall()).map(drawn).collect(),
            fill: self.scene.fill(hinges).into_iter().map(drawn).collect(),
            loads: loads.collect(),
            hinges: marks.collect(),
            section_bodies: bodies.map(body_number).collect(),
            point_bodies: points.map(body_number).collect(),
        }
    }

    /// Data of the frames, encoded in base 64, as multiples of a unit where the key has a unit.
    fn frames(
        &self,
        ground: &GroundMotion,
        frames: &[&Sample],
        layouts: Vec<u16>,
        joints: usize,
    ) -> Frames {
        let times_s: Vec<f64> = frames.iter().map(|frame| frame.time_s).collect();
        let poses = || frames.iter().flat_map(|frame| &frame.poses);
        let shifts = poses().flat_map(|pose| [pose.translation.x, pose.translation.y]);
        let (rotations, rotation_unit_rad) = quantized(poses().map(Pose::rotation_rad));
        let (shifts, shift_unit_m) = quantized(shifts);
        let ground_m = GroundVelocity::new(ground).displacements_m(&times_s);
        let ground_g = frames
            .iter()
            .map(|frame| frame.ground_acceleration_m_s2 / self.gravity_m_s2);
        let apart_m = frames
            .iter()
            .flat_map(|frame| [frame.feet_apart_m.x, frame.feet_apart_m.y]);
        let thrust_unit = FARTHEST / LARGEST_I16;
        let ratios = frames.iter().flat_map(|frame| &frame.eccentricity_ratios);
        let thrust = ratios.map(|ratio| match ratio {
            Some(ratio) => (ratio.clamp(-FARTHEST, FARTHEST) / thrust_unit).round() as i16,
            None => NO_THRUST,
        });
        let has_thrust = frames.iter().any(|one| !one.eccentricity_ratios.is_empty());
        let codes = frames.iter().flat_map(|frame| {
            let mut codes = vec![0; joints];
            for open in &frame.hinges {
                // Hinges of a row that moves as a few linked bodies are in the layout.
                if let Hinge::Joint { joint, edge } = open.hinge
                    && let Some(code) = codes.get_mut(joint)
                {
                    *code = edge_code(edge);
                }
            }
            codes
        });
        let pressures = || frames.iter().flat_map(|frame| &frame.pressures);
        let stresses_pa = pressures().flat_map(|pressure| pressure.edge_stresses_pa);
        let largest_pa = stresses_pa.fold(0.0, f64::max);
        let pressed = pressures().flat_map(|pressure| {
            let [intrados, extrados] = pressure.edge_stresses_pa.map(|pa| pa / largest_pa);
            [intrados, extrados, pressure.contact_ratio].map(byte_rounded_up)
        });
        let states = frames.iter().map(|frame| match frame.state {
            State::Rest => 0,
            State::Rocking(Sway::Right) => 1,
            State::Rocking(Sway::Left) => 2,
            State::Overturned(_) => 3,
        });
        Frames {
            times_s: encoded(times_s.iter().map(|time_s| time_s.to_le_bytes())),
            rotations,
            rotation_unit_rad,
            shifts,
            shift_unit_m,
            layouts: encoded(layouts.into_iter().map(u16::to_le_bytes)),
            ground_m: encoded_f32(ground_m.iter().flat_map(|at_m| [at_m.x, at_m.y])),
            ground_g: encoded_f32(ground_g),
            right_foot_m: ground.right_foot().map(|_| encoded_f32(apart_m)),
            thrust_unit: has_thrust.then_some(thrust_unit),
            thrust: encoded(thrust.map(i16::to_le_bytes)),
            largest_stress_pa: (largest_pa > 0.0).then_some(largest_pa),
            pressed: encoded(pressed.map(u8::to_le_bytes)),
            joints: encoded(codes.map(u8::to_le_bytes)),
            states: encoded(states.map(u8::to_le_bytes)),
            count: frames.len(),
        }
    }
}

/// Number of the body of a point, and its position.
fn point(point: BodyPoint) -> Point {
    (body_number(point.body), point.at_m.x, point.at_m.y)
}

fn flatten_corners([a, b]: [Vector2<f64>; 2]) -> [f64; 4] {
    [a.x, a.y, b.x, b.y]
}

/// Rotation of each body at rest, from a sample.
fn standing_rad(sample: &Sample) -> Vec<f64> {
    let bodies = sample.poses.iter().zip(&sample.rotations_rad);
    bodies
        .map(|(pose, rotation_rad)| pose.rotation_rad() - rotation_rad)
        .collect()
}

/// Time at which the page opens: that of overturning, or of the largest rotation.
fn opening_time_s(frames: &[&Sample], history: &Summary) -> f64 {
    if let Some(overturned_s) = history.overturned_s() {
        return overturned_s;
    }
    let body = history.largest_body();
    let turned = |frame: &&&Sample| {
        let rotation_rad = frame.rotations_rad.get(body);
        rotation_rad.map_or(0.0, |rotation_rad| rotation_rad.abs())
    };
    let farthest = frames.iter().max_by(|a, b| turned(a).total_cmp(&turned(b)));
    farthest.map_or(0.0, |frame| frame.time_s)
}

/// Code of an open joint; 0 means closed.
const fn edge_code(edge: Option<Edge>) -> u8 {
    match edge {
        Some(Edge::Intrados) => 1,
        Some(Edge::Extrados) => 2,
        None => 3,
    }
}
