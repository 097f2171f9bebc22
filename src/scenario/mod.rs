//! The scenario: what stands, how the ground moves, and how the motion is computed.
//!
//! A scenario is read from a TOML text. Every value is checked, and all that is wrong with the text
//! is said at once, each error with its line, its column and what is allowed instead:
//!
//! ```
//! use archrock::scenario::Scenario;
//!
//! let text = "
//! [arch]
//! mean_radius_m = 5.0
//! thickness_ratio = 0.15
//! embrace_deg = 180.0
//!
//! [ground.rectangular]
//! amplitude_g = -0.30
//! duration_s = 0.20
//! ";
//! let scenario = Scenario::parse(text, "semicircle.toml").expect("a valid scenario");
//! assert_eq!(scenario.simulation.gravity_m_s2, 9.81);
//!
//! let errors = Scenario::parse(&text.replace("-0.30", "-3000.0"), "semicircle.toml").unwrap_err();
//! assert!(errors.to_string().starts_with("semicircle.toml:8:15: `amplitude_g = -3000.0` is out of"));
//! ```
//!
//! Field names are the keys of the file, units included.

mod error;
mod keys;
mod map;
mod record;
mod sequence;
mod spectrum;
mod suite;
mod table;

use std::fs::File;
use std::io::Read as _;
use std::path::Path;

use nalgebra::Vector2;

use crate::dynamics::ground::{GroundMotion, Pulse, PulseShape, WaveTrain};
use crate::dynamics::model::{self, MechanismModel, Request};
use crate::mechanics::arch;
use crate::mechanics::column::{self, RockingColumn};
use crate::mechanics::four_link::arch::{FourLinkArch, FourLinkError};
use crate::mechanics::four_link::impact::ImpactModel;
use crate::mechanics::four_link::limit::{Incipient, LimitError, incipient};
use crate::mechanics::four_link::linkage::Linkage;
use crate::mechanics::four_link::mechanism::{HingeSites, Sway};
use crate::mechanics::geometry::ring::Ring;
use error::Fault;
pub use error::{Place, ScenarioError, ScenarioErrors};
pub(crate) use keys::LARGEST_G;
pub use map::{Axis, Map, Quantity};
pub use record::{
    Component, Format, Layout, LineFault, Record, Scaling, Series, TableColumn, Unit,
};
pub use sequence::{Sequence, Spacing};
pub use spectrum::Spectrum;
pub(crate) use spectrum::block;
pub use suite::{Measure, Suite};
use table::Writer;

/// What to simulate, every default resolved.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// Free text for the results.
    pub title: Option<String>,
    /// What stands on the ground.
    pub structure: Structure,
    /// How the ground moves; `None`: it stays still.
    pub ground: Option<Ground>,
    /// What happens when the hinges close.
    pub impact: ImpactModel,
    /// Where the motion starts from; `None`: from rest.
    pub initial: Option<Initial>,
    /// How the motion is computed.
    pub simulation: Simulation,
    /// What varies over an overturning map.
    pub map: Option<Map>,
    /// What is tried for an overturning spectrum; `None`: the defaults.
    pub spectrum: Option<Spectrum>,
    /// Which records shake the structure for its fragility.
    pub suite: Option<Suite>,
}

/// What stands on the ground.
#[derive(Clone, Debug, PartialEq)]
pub enum Structure {
    /// A circular arch, from `[arch]`.
    Arch(Arch),
    /// A free-standing column, from `[column]`.
    Column(Column),
}

/// A circular arch of constant thickness.
#[derive(Clone, Debug, PartialEq)]
pub struct Arch {
    /// Radius of the middle line, in 0.001 to 1e6.
    pub mean_radius_m: f64,
    /// Thickness over mean radius, at least 1e-6 and below 2. The file may give `thickness_m` instead.
    pub thickness_ratio: f64,
    /// Angle from springing to springing, in 1 to 180.
    pub embrace_deg: f64,
    /// Length out of plane, in 0.001 to 1e6.
    pub depth_m: f64,
    /// Density, in 0.001 to 1e6.
    pub density_kg_m3: f64,
    /// Number of equal voussoirs whose joints are the only places of hinges, 3 to 200; `None`:
    /// hinges open anywhere. Two voussoirs have three joints, and a mechanism has four hinges.
    pub voussoirs: Option<usize>,
}

impl Arch {
    /// The shape.
    fn ring(&self) -> Ring {
        Ring::new(self.thickness_ratio, self.embrace_deg.to_radians())
            .expect("the ranges of the keys are those of a ring")
    }

    /// Where hinges may form.
    #[must_use]
    pub fn sites(&self) -> HingeSites {
        self.voussoirs
            .map_or(HingeSites::Anywhere, HingeSites::Voussoirs)
    }

    fn incipient(&self) -> Result<Incipient, LimitError> {
        incipient(&self.ring(), self.sites())
    }

    /// The arch, ready to rock.
    ///
    /// # Errors
    /// When it cannot stand or no four-link mechanism governs; never for an arch that was read from a
    /// file, where this is checked.
    pub fn build(&self, model: ImpactModel) -> Result<FourLinkArch, FourLinkError> {
        let mut arch = arch::Arch::new(self.mean_radius_m, self.thickness_ratio, self.embrace_deg)?
            .with_depth_m(self.depth_m)?
            .with_density_kg_m3(self.density_kg_m3)?;
        if let Some(voussoirs) = self.voussoirs {
            arch = arch.with_voussoirs(voussoirs)?;
        }
        FourLinkArch::new(arch, model)
    }
}

/// A free-standing column: a rectangular block on rigid ground, which does not slide.
///
/// It may have any proportions. A column wider than `sqrt(2)` times its height stops at its first impact;
/// and one that starts to rock from rest needs a friction coefficient of its width over its height.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Height, in 0.001 to 1e6.
    pub height_m: f64,
    /// Width in the plane of the motion, in 0.001 to 1e6.
    pub width_m: f64,
    /// Length out of plane, in 0.001 to 1e6.
    pub depth_m: f64,
    /// Density, in 0.001 to 1e6.
    pub density_kg_m3: f64,
}

impl Column {
    /// The column, ready to rock.
    ///
    /// # Errors
    /// When a size is out of range; never for a column that was read from a file.
    pub fn build(&self, model: ImpactModel) -> Result<RockingColumn, FourLinkError> {
        let column = column::Column::new(self.height_m, self.width_m)?
            .with_depth_m(self.depth_m)?
            .with_density_kg_m3(self.density_kg_m3)?;
        Ok(RockingColumn::new(&column, model)?)
    }
}

impl Structure {
    /// The model of its motion.
    ///
    /// # Errors
    /// When it does not rock as four links.
    pub fn model(&self, impact: ImpactModel) -> Result<Box<dyn MechanismModel>, FourLinkError> {
        Ok(match self {
            Self::Arch(arch) => Box::new(arch.build(impact)?),
            Self::Column(column) => Box::new(column.build(impact)?),
        })
    }

    /// `q` at the limit position of the mechanism that starts, for a structure that stands.
    fn limit_rad(&self) -> f64 {
        match self {
            Self::Arch(arch) => arch.incipient().map_or(0.0, |incipient| {
                Linkage::new(&arch.ring(), &incipient.mechanism).limit_rad()
            }),
            Self::Column(_) => self
                .model(ImpactModel::MaxRestitution)
                .map_or(0.0, |model| model.limit_rad()),
        }
    }
}

/// How the ground moves.
#[derive(Clone, Debug, PartialEq)]
pub enum Ground {
    /// As a single pulse.
    Pulse(PulseGround),
    /// As recorded, from `[ground.record]`.
    Record(Record),
}

/// A pulse of ground acceleration; before and after it the ground moves uniformly.
#[derive(Clone, Debug, PartialEq)]
pub struct PulseGround {
    /// Shape of the pulse.
    pub kind: Pulse,
    /// Peak acceleration, positive to the right, in -1000 to 1000.
    pub amplitude_g: f64,
    /// Peak of the vertical acceleration, positive upwards, with the same shape at the same time, in -1000
    /// to 1000; the ground must not fall as fast as a free body.
    pub vertical_amplitude_g: f64,
    /// Length of the part of the pulse that its kind names, in 1e-6 to 1e6.
    pub duration_s: f64,
    /// When the pulse starts, in 0 to 1e6.
    pub start_s: f64,
    /// Length of a wave train in periods, from `gamma` (above 1 and at most 100) or `cycles` (1 to 100).
    pub cycles: f64,
    /// Phase of a wave train, in -360 to 360.
    pub phase_deg: f64,
}

impl Ground {
    /// The ground motion under the given gravity.
    fn motion(&self, gravity_m_s2: f64) -> GroundMotion {
        match self {
            Self::Pulse(pulse) => pulse.motion(gravity_m_s2),
            Self::Record(record) => record.motion(gravity_m_s2),
        }
    }
}

impl PulseGround {
    /// The pulse without its amplitudes.
    #[must_use]
    pub fn shape(&self) -> PulseShape {
        let train = WaveTrain {
            cycles: self.cycles,
            phase_rad: self.phase_deg.to_radians(),
        };
        PulseShape::new(self.kind, self.duration_s, self.start_s, train)
            .expect("the ranges of the keys are those of a ground motion")
    }

    fn motion(&self, gravity_m_s2: f64) -> GroundMotion {
        let amplitude_g = Vector2::new(self.amplitude_g, self.vertical_amplitude_g);
        let motion = self.shape().motion(amplitude_g * gravity_m_s2);
        motion.expect("the ranges of the keys are those of a ground motion")
    }
}

/// Says that a vertical acceleration is impossible for a structure that rests on the ground.
fn free_fall(time_s: f64) -> String {
    format!(
        "lets the ground fall as fast as a free body at {time_s:?} s, so that nothing presses the \
         structure on it; allowed are vertical accelerations above -1 g"
    )
}

/// A rotated position from which the structure is released without velocity.
#[derive(Clone, Debug, PartialEq)]
pub struct Initial {
    /// The mechanism that is open.
    pub sway: Sway,
    /// How far it is open: rotation of the body whose rotation is the generalised coordinate, above
    /// 0 and below pi.
    pub rotation_rad: f64,
}

/// How the motion is computed.
///
/// The output has at least one step and at most 1e7 of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Simulation {
    /// Longest time to simulate, in 1e-6 to 1e6.
    pub duration_s: f64,
    /// Time between rows of the output, at least 1e-6 and at most `duration_s`.
    pub output_step_s: f64,
    /// Error that the integrator may make, relative to the state, in 1e-13 to 1e-3.
    pub relative_tolerance: f64,
    /// Energy over energy barrier below which the structure is at rest, in 1e-16 to 0.1.
    pub rest_energy_ratio: f64,
    /// Acceleration of gravity, in 0.001 to 1000.
    pub gravity_m_s2: f64,
}

impl Scenario {
    /// Reads a scenario from TOML text; `name` stands for the file in the errors. Records of ground motion
    /// are read from files relative to the folder of `name`.
    ///
    /// # Errors
    ///
    /// All that is wrong with the text and with its records. After twenty lines that are no TOML it stops
    /// looking.
    pub fn parse(text: &str, name: &str) -> Result<Self, ScenarioErrors> {
        Self::parse_in(folder_of(Path::new(name)), text, name)
    }

    fn parse_in(folder: &Path, text: &str, name: &str) -> Result<Self, ScenarioErrors> {
        table::read_text(text, |table| Self::read_table(table, folder))
            .map_err(|faults| ScenarioErrors::placed(name, text, faults))
    }

    /// Reads a scenario file.
    ///
    /// # Errors
    ///
    /// As [`Scenario::parse`], and when there is no such file, it cannot be read, is not UTF-8
    /// text or is larger than 1 MiB.
    pub fn read(path: &Path) -> Result<Self, ScenarioErrors> {
        const MOST_BYTES: u64 = 1 << 20;
        let name = path.display().to_string();
        let unreadable = |message: String| ScenarioErrors::unreadable(&name, message);
        if path.is_dir() {
            return Err(unreadable("is a folder, not a scenario file".to_owned()));
        }
        let mut bytes = Vec::new();
        // The limit is on what is read, because not every file knows its size.
        File::open(path)
            .and_then(|file| file.take(MOST_BYTES + 1).read_to_end(&mut bytes))
            .map_err(|error| unreadable(format!("cannot be read: {error}")))?;
        if bytes.len() as u64 > MOST_BYTES {
            return Err(unreadable(
                "is larger than 1 MiB, too large for a scenario".to_owned(),
            ));
        }
        let text = String::from_utf8(bytes).map_err(|error| {
            // What precedes the fault is the same in the lossy text.
            let text = String::from_utf8_lossy(error.as_bytes());
            let fault = Fault {
                offset: error.utf8_error().valid_up_to(),
                message: "not UTF-8 text from here".to_owned(),
            };
            ScenarioErrors::placed(&name, &text, vec![fault])
        })?;
        Self::parse_in(folder_of(path), &text, &name)
    }

    /// The ground motion in m/s2.
    #[must_use]
    pub fn ground_motion(&self) -> GroundMotion {
        self.ground
            .as_ref()
            .map_or_else(GroundMotion::still, |ground| {
                ground.motion(self.simulation.gravity_m_s2)
            })
    }

    /// What is asked of the simulation, samples at every output step included.
    #[must_use]
    pub fn request(&self) -> Request {
        Request {
            gravity_m_s2: self.simulation.gravity_m_s2,
            end_s: self.simulation.duration_s,
            output_step_s: self.simulation.output_step_s,
            initial: self.initial.as_ref().map(|initial| model::Initial {
                sway: initial.sway,
                rotation_rad: initial.rotation_rad,
            }),
            relative_tolerance: self.simulation.relative_tolerance,
            rest_energy_ratio: self.simulation.rest_energy_ratio,
        }
    }

    /// The same from rest, whatever the scenario starts from: what studies ask of their histories.
    #[must_use]
    pub fn request_from_rest(&self) -> Request {
        Request {
            initial: None,
            ..self.request()
        }
    }

    /// The scenario as TOML text, every default written out.
    ///
    /// Reading the text of a valid scenario gives an equal scenario.
    #[must_use]
    pub fn to_toml(&self) -> String {
        let mut out = Writer::default();
        self.write(&mut out);
        out.finish()
    }

    /// The scenario as JSON, every default written out, with the keys of the file.
    #[must_use]
    pub fn to_json(&self) -> serde_json::Value {
        toml::from_str(&self.to_toml()).expect("`to_toml` writes TOML")
    }
}

/// The folder that a file is in.
fn folder_of(file: &Path) -> &Path {
    file.parent().unwrap_or(Path::new(""))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const ARCH: &str = "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 180.0\n";

    const COLUMN: &str = "[column]\nheight_m = 4.0\nwidth_m = 0.8\n";

    fn parse(text: &str) -> Result<Scenario, ScenarioErrors> {
        Scenario::parse(text, "s.toml")
    }

    /// Asserts that the text has these errors and no other: line, column and words of the message.
    #[track_caller]
    fn assert_errors(text: &str, expected: &[(usize, usize, &[&str])]) {
        let errors = parse(text).expect_err("the text is faulty");
        assert_eq!(errors.as_slice().len(), expected.len(), "{errors}");
        for (error, &(line, column, words)) in errors.as_slice().iter().zip(expected) {
            assert_eq!(error.place, Some(Place { line, column }), "{error}");
            for word in words {
                assert!(error.message.contains(word), "{word:?} is not in: {error}");
            }
        }
    }

    /// As `assert_errors`, for lines that follow a valid `[arch]`, counted from 1.
    #[track_caller]
    fn assert_error_after_arch(lines: &str, (line, column): (usize, usize), words: &[&str]) {
        let before = ARCH.lines().count();
        assert_errors(&format!("{ARCH}{lines}"), &[(before + line, column, words)]);
    }

    #[test]
    fn defaults() {
        let scenario = parse(ARCH).expect("valid");
        let expected = Scenario {
            title: None,
            structure: Structure::Arch(Arch {
                mean_radius_m: 5.0,
                thickness_ratio: 0.15,
                embrace_deg: 180.0,
                depth_m: 1.0,
                density_kg_m3: 2000.0,
                voussoirs: None,
            }),
            ground: None,
            impact: ImpactModel::MaxRestitution,
            initial: None,
            simulation: Simulation {
                duration_s: 10.0,
                output_step_s: 0.005,
                relative_tolerance: 1e-9,
                rest_energy_ratio: 1e-8,
                gravity_m_s2: 9.81,
            },
            map: None,
            spectrum: None,
            suite: None,
        };
        assert_eq!(scenario, expected);
    }

    #[test]
    fn every_key() {
        let scenario = parse(
            r#"
            title = "all of it"
            arch = { mean_radius_m = 10, thickness_m = 1.5, embrace_deg = 157.5, depth_m = 2, density_kg_m3 = 0x7d0, voussoirs = 7 }
            [ground.step_pair]
            amplitude_g = -1_000
            duration_s = 0.5
            start_s = 1
            [impact]
            model = "prescribed"
            restitution = 1
            [initial]
            sway = "left"
            rotation_rad = 0.02
            [simulation]
            duration_s = 20
            output_step_s = 20
            relative_tolerance = 1e-6
            rest_energy_ratio = 0.1
            gravity_m_s2 = 1.62
            "#,
        );
        let expected = Scenario {
            title: Some("all of it".to_owned()),
            structure: Structure::Arch(Arch {
                mean_radius_m: 10.0,
                thickness_ratio: 0.15,
                embrace_deg: 157.5,
                depth_m: 2.0,
                density_kg_m3: 2000.0,
                voussoirs: Some(7),
            }),
            ground: Some(Ground::Pulse(PulseGround {
                kind: Pulse::StepPair,
                amplitude_g: -1000.0,
                vertical_amplitude_g: 0.0,
                duration_s: 0.5,
                start_s: 1.0,
                cycles: 2.0,
                phase_deg: 0.0,
            })),
            impact: ImpactModel::Prescribed { restitution: 1.0 },
            initial: Some(Initial {
                sway: Sway::Left,
                rotation_rad: 0.02,
            }),
            simulation: Simulation {
                duration_s: 20.0,
                output_step_s: 20.0,
                relative_tolerance: 1e-6,
                rest_energy_ratio: 0.1,
                gravity_m_s2: 1.62,
            },
            map: None,
            spectrum: None,
            suite: None,
        };
        assert_eq!(scenario, Ok(expected));
    }

    #[test]
    fn nothing_given() {
        for text in ["", "\n \n# nothing\n"] {
            assert_errors(text, &[(1, 1, &["needs exactly one of", "arch, column"])]);
        }
    }

    #[test]
    fn all_errors_in_one_go_in_the_order_of_the_file() {
        let text = r#"
title = 3
[simulation]
gravity_m_s2 = 0
duration_s = 1.0
output_step_s = 2.0
[impact]
model = "miror"
[arch]
mean_radius = 5.0
embrace_deg 180
thickness_ratio = "thin"
[ground.half_sine]
amplitude_g = 0.3
[ground.ricker]
amplitude_g = nan
duration_s = 1.0
"#;
        assert_errors(
            text,
            &[
                (2, 9, &["`title = 3`", "a whole number", "a string"]),
                (
                    4,
                    16,
                    &["`gravity_m_s2 = 0`", "at least 0.001 and at most 1000.0"],
                ),
                (
                    6,
                    17,
                    &["`output_step_s = 2.0`", "longer than the run of 1.0 s"],
                ),
                (
                    8,
                    9,
                    &["`model = \"miror\"`", "mirrored", "max_restitution"],
                ),
                (9, 1, &["[arch] lacks `mean_radius_m`", "at least 0.001"]),
                (10, 1, &["`mean_radius`", "did you mean `mean_radius_m`?"]),
                (11, 13, &["embrace_deg 180", "expected `=`"]),
                (
                    12,
                    19,
                    &["`thickness_ratio = \"thin\"` is a string", "below 2.0"],
                ),
                (
                    13,
                    1,
                    &["[ground.half_sine] lacks `duration_s`", "at least 1e-6"],
                ),
                (
                    15,
                    1,
                    &["`ricker` stands beside `half_sine`", "exactly one"],
                ),
                (
                    16,
                    15,
                    &["`amplitude_g = nan` is not finite", "at most 1000.0"],
                ),
            ],
        );
    }

    #[test]
    fn errors_display_as_file_line_column_message() {
        let errors = parse(&format!("titel = 'é'\n{ARCH}voussoirs = 2\n")).expect_err("two errors");
        assert_eq!(
            errors.to_string(),
            "s.toml:1:1: unknown key `titel` in the scenario, did you mean `title`?; allowed are \
             title, arch, column, simulation, ground, impact, initial, map, spectrum, suite\n\
             s.toml:6:13: `voussoirs = 2` is out of range; allowed is a whole number from 3 (four \
             hinges need four joints) to 200"
        );
    }

    #[test]
    fn columns_count_characters() {
        assert_errors(
            &format!("initial = {{ sway = 'é', rotation_rad = 9 }}\r\n{ARCH}"),
            &[
                (1, 20, &["`sway = 'é'` is unknown", "\"right\", \"left\""]),
                (1, 40, &["`rotation_rad = 9`", "below 3.14159"]),
            ],
        );
    }

    #[test]
    fn structures() {
        let beside: &[&str] = &["`column` stands beside `arch`", "exactly one"];
        assert_errors(&format!("{ARCH}{COLUMN}"), &[(5, 1, beside)]);
        assert_errors(
            "arch = 5",
            &[(1, 8, &["`arch = 5`", "a whole number", "a table"])],
        );
        assert_errors("[[arch]]\n", &[(1, 1, &["an array", "a table"])]);
    }

    #[test]
    fn columns() {
        let scenario = parse(COLUMN).expect("valid");
        let expected = Column {
            height_m: 4.0,
            width_m: 0.8,
            depth_m: 1.0,
            density_kg_m3: 2000.0,
        };
        assert_eq!(scenario.structure, Structure::Column(expected));
        assert_errors(
            "[column]\nheight = 4\nwidth_m = -0.8\nmean_radius_m = 5\n",
            &[
                (1, 1, &["[column] lacks `height_m`", "at least 0.001"]),
                (2, 1, &["`height` in [column], did you mean `height_m`?"]),
                (
                    3,
                    11,
                    &["`width_m = -0.8` is out of range", "at most 1000000.0"],
                ),
                (
                    4,
                    1,
                    &["`mean_radius_m` in [column]", "height_m, width_m, depth_m"],
                ),
            ],
        );
        let released = |rotation: &str| {
            parse(&format!(
                "{COLUMN}[initial]\nsway = 'left'\nrotation_rad = {rotation}"
            ))
        };
        assert!(released("1.57").is_ok());
        let flat = released("1.571").expect_err("lies on its side");
        let words = "s.toml:6:16: `rotation_rad = 1.571` is beyond the limit position";
        assert!(flat.to_string().starts_with(words), "{flat}");
        assert!(
            flat.to_string().ends_with("below 1.5707963267948966"),
            "{flat}"
        );
    }

    #[test]
    fn thickness() {
        let arch =
            |thickness: &str| format!("[arch]\nmean_radius_m = 5\nembrace_deg = 180\n{thickness}");
        let one = "exactly one of the keys thickness_ratio, thickness_m";
        assert_errors(&arch(""), &[(1, 1, &["[arch] needs", one])]);
        assert_errors(
            &arch("thickness_m = 0.75\nthickness_ratio = 0.15"),
            &[(
                5,
                19,
                &["`thickness_ratio` stands beside `thickness_m`", one],
            )],
        );
        assert_errors(
            &arch("thickness_m = 10"),
            &[(
                4,
                15,
                &["`thickness_m = 10`", "2.0 mean radii", "below 10.0"],
            )],
        );
        assert_errors(
            &arch("thickness_ratio = 0.0"),
            &[(
                4,
                19,
                &["`thickness_ratio = 0.0`", "at least 1e-6 and below 2.0"],
            )],
        );
    }

    #[test]
    fn numbers() {
        for (value, words) in [
            ("0", "`depth_m = 0` is out of range"),
            ("+inf", "`depth_m = +inf` is not finite"),
            ("1e999", "`depth_m = 1e999` is not finite"),
            (
                "99999999999999999999999999999999999999999",
                "is out of range",
            ),
            ("true", "`depth_m = true` is a boolean"),
            ("1979-05-27", "is a date or time"),
            ("[1, 2]", "`depth_m = [1, 2]` is an array"),
        ] {
            assert_error_after_arch(&format!("depth_m = {value}"), (1, 11), &[words]);
        }
        for value in ["7.0", "-7", "201", "99999999999999999999999"] {
            assert_error_after_arch(&format!("voussoirs = {value}"), (1, 13), &[value, "to 200"]);
        }
    }

    #[test]
    fn grounds() {
        for kind in Pulse::ALL {
            let name = kind.name();
            let text = format!("{ARCH}[ground.{name}]\namplitude_g = 1\nduration_s = 1");
            let ground = parse(&text).expect("valid").ground.expect("given");
            let Ground::Pulse(ground) = ground else {
                panic!("{name} is a pulse")
            };
            assert_eq!(ground.kind, *kind);
        }
        assert_error_after_arch(
            "[ground]",
            (1, 1),
            &["[ground] needs exactly one", "ricker"],
        );
        assert_errors(
            &format!("{ARCH}[ground.halfsine]"),
            &[
                (5, 2, &["[ground] needs exactly one"]),
                (
                    5,
                    9,
                    &[
                        "`halfsine` in [ground], did you mean `half_sine`?",
                        "record",
                    ],
                ),
            ],
        );
    }

    #[test]
    fn restitutions() {
        let other = "[impact]\nrestitution = 0.8";
        assert_error_after_arch(other, (2, 15), &["prescribed", "\"max_restitution\""]);
        let none = "[impact]\nmodel = 'prescribed'";
        assert_error_after_arch(
            none,
            (1, 1),
            &["[impact] lacks `restitution`", "at most 1.0"],
        );
        let high = "[impact]\nmodel = 'prescribed'\nrestitution = 1.5";
        assert_error_after_arch(high, (3, 15), &["`restitution = 1.5`", "at most 1.0"]);
    }

    #[test]
    fn output_steps_point_at_the_key_that_is_given() {
        let short = "[simulation]\nduration_s = 0.001";
        assert_error_after_arch(short, (2, 14), &["`duration_s = 0.001`", "step of 0.005 s"]);
        let long = "[simulation]\nduration_s = 1e5";
        assert_error_after_arch(long, (2, 14), &["20000000 rows", "at most 10000000"]);
        let fine = "[simulation]\noutput_step_s = 1e-9";
        assert_error_after_arch(fine, (2, 17), &["10000000000 rows"]);
    }

    #[test]
    fn syntax_errors_hide_nothing_and_breed_nothing() {
        // The key that is on a faulty line is not missing, and the default does not stand for it.
        assert_error_after_arch(
            "[simulation]\nduration_s = 60 s\noutput_step_s = 20",
            (2, 14),
            &["`duration_s = 60 s`"],
        );
        assert_errors(&ARCH.replace("0.15", "0,15"), &[(3, 20, &["0,15"])]);
        // The keys under a faulty header are not those of the table before.
        assert_error_after_arch("[initial\nsway = 'right'\n", (1, 9), &["expected `]`"]);
        let twice = format!("{ARCH}[impact]\n{ARCH}title = 1");
        assert_errors(&twice, &[(6, 2, &["duplicate key"])]);
        assert_errors(
            &format!("title = \"\"\"\n{ARCH}"),
            &[(6, 1, &["multi-line"])],
        );
    }

    #[test]
    fn messages_carry_no_control_characters_and_no_books() {
        let errors = parse(&format!("\"\\u001b[2J{}\" = 1", "x".repeat(500))).expect_err("unknown");
        assert!(errors.to_string().lines().all(|line| line.len() < 300));
        assert!(!errors.to_string().contains('\u{1b}'));
    }

    #[test]
    fn hostile_nesting_does_not_overflow_the_stack() {
        let dotted = format!("{}a = 1", "a.".repeat(79));
        let inline = format!(
            "a = {}1{}",
            format!("{{{}a=", "a.".repeat(79)).repeat(79),
            "}".repeat(79)
        );
        for text in [
            "[".repeat(100_000),
            format!("a = {}", "[".repeat(100_000)),
            format!("a = {}{}", "[".repeat(100_000), "]".repeat(100_000)),
            format!("a = {}", "{a=".repeat(100_000)),
            format!("{}a = 1", "a.".repeat(100_000)),
            format!("[{}a]", "a.".repeat(100_000)),
            "[[a]]\n".repeat(100_000),
            "a\n".repeat(100_000),
            dotted,
            inline,
        ] {
            let errors = parse(&text).expect_err("hostile");
            assert!(errors.as_slice().len() <= 40);
        }
    }

    #[test]
    fn many_errors_take_linear_time() {
        // Quadratic work would be 1e11 steps here.
        let keys: Vec<_> = (0..50_000).map(|i| format!("k{i}=1")).collect();
        let errors = parse(&format!("arch = {{ {} }}", keys.join(", "))).expect_err("unknown keys");
        assert!(errors.as_slice().len() > 50_000);
    }

    #[test]
    fn files() {
        let folder = std::env::temp_dir().join(format!("archrock-scenario-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder for the test");
        let read = |name: &str, bytes: &[u8]| {
            let path = folder.join(name);
            std::fs::write(&path, bytes).expect("a file for the test");
            Scenario::read(&path)
        };
        let message = |result: Result<Scenario, ScenarioErrors>| {
            let errors = result.expect_err("unreadable");
            assert_eq!(errors.as_slice().len(), 1, "{errors}");
            errors.to_string()
        };

        assert_eq!(read("good.toml", ARCH.as_bytes()), parse(ARCH));
        let latin = message(read("latin.toml", b"title = 'a'\n# \xe9t\xe9\n"));
        assert!(
            latin.ends_with("latin.toml:2:3: not UTF-8 text from here"),
            "{latin}"
        );
        let large = message(read("large.toml", &vec![b'#'; (1 << 20) + 1]));
        assert!(large.ends_with("large.toml: is larger than 1 MiB, too large for a scenario"));
        let none = message(Scenario::read(&folder.join("none.toml")));
        assert!(none.contains("none.toml: cannot be read: "), "{none}");
        let dir = message(Scenario::read(&folder));
        assert!(dir.ends_with(": is a folder, not a scenario file"), "{dir}");

        std::fs::remove_dir_all(&folder).expect("the folder of the test");
    }

    /// A number in `low..high` with a random exponent, so that all ways of writing it occur.
    fn magnitude(low: f64, high: f64) -> impl Strategy<Value = f64> {
        (low.ln()..high.ln()).prop_map(move |x| x.exp().clamp(low, high))
    }

    fn any_structure() -> impl Strategy<Value = Structure> {
        prop_oneof![any_arch(), any_column()]
    }

    fn any_column() -> impl Strategy<Value = Structure> {
        let size = || magnitude(1e-3, 1e6);
        (size(), size(), size(), size()).prop_map(|(height_m, width_m, depth_m, density_kg_m3)| {
            Structure::Column(Column {
                height_m,
                width_m,
                depth_m,
                density_kg_m3,
            })
        })
    }

    /// Arches that stand and start as four-link mechanisms.
    fn any_arch() -> impl Strategy<Value = Structure> {
        (
            magnitude(1e-3, 1e6),
            0.13..0.3,
            140.0..180.0,
            magnitude(1e-3, 1e6),
            magnitude(1e-3, 1e6),
            proptest::option::of(3..=20_usize),
        )
            .prop_map(
                |(
                    mean_radius_m,
                    thickness_ratio,
                    embrace_deg,
                    depth_m,
                    density_kg_m3,
                    voussoirs,
                )| Arch {
                    mean_radius_m,
                    thickness_ratio,
                    embrace_deg,
                    depth_m,
                    density_kg_m3,
                    voussoirs,
                },
            )
            .prop_filter("stands", |arch| arch.incipient().is_ok())
            .prop_map(Structure::Arch)
    }

    fn any_ground() -> impl Strategy<Value = Ground> {
        let kind = proptest::sample::select(Pulse::ALL);
        let train = (1.0001..100.0, -360.0..360.0_f64);
        let amplitudes = (-1e3..1e3, -0.9..0.9);
        (kind, amplitudes, magnitude(1e-9, 1e6), 0.0..1e6, train).prop_map(
            |(kind, (amplitude_g, vertical_amplitude_g), duration_s, start_s, train)| {
                Ground::Pulse(PulseGround {
                    kind,
                    amplitude_g,
                    vertical_amplitude_g,
                    duration_s,
                    start_s,
                    cycles: if kind.is_wave_train() { train.0 } else { 2.0 },
                    phase_deg: if kind.is_wave_train() { train.1 } else { 0.0 },
                })
            },
        )
    }

    fn any_impact() -> impl Strategy<Value = ImpactModel> {
        prop_oneof![
            Just(ImpactModel::MaxRestitution),
            Just(ImpactModel::SameSections),
            Just(ImpactModel::Mirrored),
            (0.0..=1.0).prop_map(|restitution| ImpactModel::Prescribed { restitution }),
        ]
    }

    fn any_initial() -> impl Strategy<Value = Initial> {
        let sway = proptest::sample::select(Sway::ALL);
        (sway, magnitude(1e-9, 0.05))
            .prop_map(|(sway, rotation_rad)| Initial { sway, rotation_rad })
    }

    fn any_simulation() -> impl Strategy<Value = Simulation> {
        (
            magnitude(1e-9, 1e6),
            magnitude(2e-7, 1.0),
            magnitude(1e-13, 1e-3),
            magnitude(1e-16, 0.1),
            magnitude(1e-3, 1e3),
        )
            .prop_map(
                |(duration_s, step, relative_tolerance, rest_energy_ratio, gravity_m_s2)| {
                    Simulation {
                        duration_s,
                        output_step_s: duration_s * step,
                        relative_tolerance,
                        rest_energy_ratio,
                        gravity_m_s2,
                    }
                },
            )
    }

    proptest! {
        #[test]
        fn to_toml_reads_back_the_same(
            title in proptest::option::of(any::<String>()),
            structure in any_structure(),
            ground in proptest::option::of(any_ground()),
            impact in any_impact(),
            initial in proptest::option::of(any_initial()),
            simulation in any_simulation(),
        ) {
            let scenario = Scenario { title, structure, ground, impact, initial, simulation, map: None, spectrum: None, suite: None };
            prop_assert_eq!(parse(&scenario.to_toml()), Ok(scenario));
        }

        #[test]
        fn noise_is_read_or_said_to_be_wrong(text in any::<String>()) {
            prop_assert!(parse(&text).map_or_else(|errors| !errors.as_slice().is_empty(), |_| true));
        }

        /// Damage to a valid text gets further into the reader than noise does.
        #[test]
        fn damage_is_read_or_said_to_be_wrong(
            damage in proptest::collection::vec((0..200_usize, proptest::sample::select(DAMAGE)), 1..8),
        ) {
            let mut text = format!(
                "title = 'a'\n{ARCH}[ground.ricker]\namplitude_g = 1.0\nduration_s = 1\n[initial]\n"
            );
            for (at, piece) in damage {
                if text.is_char_boundary(at) {
                    text.insert_str(at, piece);
                }
            }
            prop_assert!(parse(&text).map_or_else(|errors| !errors.as_slice().is_empty(), |_| true));
        }
    }

    const DAMAGE: &[&str] = &[
        "[", "]", "\"", "'", "\"\"\"", "=", "\n", "\r", ".", ",", "{", "}", "#", "é", "\\u12",
        "\u{feff}",
    ];
}
