//! The scenario: the structure, the ground motion, and the options of the computation.
//!
//! A scenario is read from a TOML text. Every value is checked, and all errors are reported
//! together, each with its line, its column and the allowed values:
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
//! assert_eq!(scenario.gravity_m_s2(), 9.81);
//!
//! let errors = Scenario::parse(&text.replace("-0.30", "-3000.0"), "semicircle.toml").unwrap_err();
//! assert!(errors.to_string().starts_with("semicircle.toml:8:15: `amplitude_g = -3000.0` is out of"));
//! ```
//!
//! Field names are the keys of the file, units included.

mod assignment;
mod back_wall;
mod bounds;
mod change;
mod document;
mod elastic_joints;
mod error;
mod files;
mod free_hinges;
mod given;
mod ground;
mod held_top;
mod impact;
mod initial;
mod input_file;
mod listing;
mod load;
mod map;
mod masonry;
mod meanings;
mod model_kind;
mod models;
mod prelude;
mod record;
mod relation;
mod right_foot;
mod rule;
mod sequence;
mod simulation;
mod source;
mod span;
mod structure;
mod study_table;
mod suite;
mod supports;
mod table;
mod tie;
mod toml_text;
mod uncertain;
mod unlikely;
mod variant;
mod verify;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

pub use archrock_text::{shown, shown_lines};

use crate::dynamics::{Direction, Directions, Variation};
use crate::{
    Column, FourLinkError, GroundMotion, ImpactModel, Initial, MechanismModel, Model, Request, Row,
    RowModelError,
};
pub use assignment::Assignment;
use document::Entries;
pub use elastic_joints::ELASTIC_JOINTS;
pub use error::{ScenarioError, ScenarioErrors, TextPosition};
pub use files::FileContents;
pub use free_hinges::FREE_HINGES;
use given::Given;
pub use ground::{Ground, PulseGround};
pub use impact::FOUR_LINKS;
use initial::Blow;
pub use input_file::InputFile;
use input_file::InputFiles;
pub(crate) use input_file::sha256;
pub use map::{Axis, Map, Quantity};
pub use model_kind::ModelKind;
pub use models::{MODELS, MotionModel};
use prelude::*;
use record::KnownRecords;
pub use record::{
    Baseline, Component, Contents, Decimal, Format, Layout, LineFault, Record, RecordedQuantity,
    Sampling, Scaling, Series, TableColumn, Times, Unit, describes_tables, format_of_file,
    unknown_format,
};
pub use right_foot::RightFoot;
pub use sequence::{Sequence, Spacing};
pub use simulation::Simulation;
pub use source::Source;
pub use structure::{Dimension, DimensionSide, ModelError, Structure, metres};
pub(crate) use structure::{forces_in_words, load_in_words};
pub(crate) use study_table::StudyTable;
pub(crate) use suite::UnitGround;
pub use suite::{Measure, Spectral, Suite};
pub use tie::{TieEnds, TieTable};
pub(crate) use toml_text::toml_text;
pub use uncertain::{Distribution, DistributionForm, MAX_DEVIATIONS, Uncertain, UncertainKey};
pub use unlikely::{Unlikely, Varied};
pub(crate) use variant::replaces;
pub use verify::{
    BEHAVIOUR_FACTOR, Building, BuildingMode, ByState, CONFIDENCE_FACTOR, CheckedSides, CodeDemand,
    Demand, FreeStanding, Language, LimitState, ModeState, PointDemand, Records, SiteTopography,
    StateRule, Verify,
};

/// Changes that are made to a scenario while it is read.
///
/// If `model` is set, tables of other models are ignored: free hinges ignore `[impact]`, and four links ignore `[free_hinges]`.
#[derive(Clone, Copy, Debug, Default)]
pub struct ReadOptions<'a> {
    /// The model of motion; `None` if the tables of the scenario choose it.
    pub model: Option<&'static ModelKind>,
    /// Values that replace those in the text. If a key is set twice, the later value counts.
    pub set: &'a [Assignment],
    /// True for static analysis. If files of `[ground]` are missing or faulty, the ground does not move; drums and moved springings need no
    /// table of a model.
    pub statics: bool,
}

/// A structure, its ground motion and the studies of it, with every default filled in.
///
/// A scenario is read from a text and checked. [`Scenario::to_toml`] and [`Scenario::to_json`] write it again.
#[readonly::make]
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// Title for the results, escaped by [`shown`](fn@shown).
    pub title: Option<String>,
    /// The structure that stands on the ground.
    pub structure: Structure,
    /// Ties of the structure, with the keys of the file.
    pub ties: Vec<TieTable>,
    /// The model of motion.
    pub motion: MotionModel,
    /// True if the text has an `[impact]` that the model of motion ignores.
    ignores_impact: bool,
    /// The ground motion; `None` if the ground does not move.
    pub ground: Option<Ground>,
    /// `[ground]` with the keys of the text; `None` unless its files are missing or faulty in static analysis.
    unread_ground: Option<Value>,
    /// Motion of the right foot; `None` if both feet move together.
    pub right_foot: Option<RightFoot>,
    /// Initial state of the motion; `None` at rest.
    pub initial: Option<Initial>,
    /// Blow from which the initial rate follows; `None` if the rate is given.
    blow: Option<Blow>,
    /// Settings of the computation.
    pub simulation: Simulation,
    /// The quantities that vary over an overturning map; `None` without `[map]`.
    pub map: Option<Map>,
    /// The records of a suite; `None` without `[suite]`.
    pub suite: Option<Suite>,
    /// The demand of a check; `None` without `[demand]`.
    pub demand: Option<Demand>,
    /// The options of a check; `None` for the defaults.
    pub verify: Option<Verify>,
    /// The uncertain numbers of the scenario; `None` without `[uncertain]`.
    pub uncertain: Option<Uncertain>,
    /// The tables with the keys that were given.
    given: Given,
    files: InputFiles,
    /// Motion of both feet.
    ground_motion: Arc<GroundMotion>,
}

/// The contents of the scenario.
impl Scenario {
    /// Records of the ground motion, of both feet.
    pub(crate) fn series(&self) -> impl Iterator<Item = &Series> {
        let record = match &self.ground {
            Some(Ground::Record(record)) => Some(&**record),
            Some(Ground::Pulse(_)) | None => None,
        };
        let right = self.right_foot.iter().filter_map(RightFoot::record);
        record.into_iter().chain(right).flat_map(Record::series)
    }

    /// True if the text gives a motion of the ground or of the structure, even one whose files cannot be read.
    pub fn gives_motion(&self) -> bool {
        let shakes = self.ground.is_some() || self.unread_ground.is_some();
        shakes || self.initial.is_some() || self.suite.is_some()
    }

    /// Name and checksum of each record file of the ground, of the suite and of the check, separated by a space.
    pub fn record_checksums(&self) -> Vec<String> {
        let named = |series: &Series| format!("{} {:08x}", series.file, series.checksum());
        let mut seen = BTreeSet::new();
        let mut all: Vec<String> = self.all_series().map(named).collect();
        // A record may be used several times.
        all.retain(|record| seen.insert(record.clone()));
        all
    }

    fn all_series(&self) -> impl Iterator<Item = &Series> {
        let suite = self.suite.iter().flat_map(|suite| &suite.records);
        let checked = self
            .verify
            .iter()
            .flat_map(|verify| verify.records.all_records());
        self.series().chain(suite).chain(checked)
    }

    /// Paths of all files from which the scenario was read.
    pub(crate) fn input_paths(&self) -> impl Iterator<Item = PathBuf> {
        let records = self.all_series().map(|series| &series.file);
        let files = self.files.files.iter().map(|input| &input.file);
        files.chain(records).map(|file| self.files.place.path(file))
    }

    /// This scenario without uncertain numbers.
    #[must_use]
    pub fn without_uncertain(self) -> Self {
        Self {
            uncertain: None,
            ..self
        }
    }

    /// Scenario file, the files of its structure, and those of `[demand]` and `[verify]`, with their hashes.
    pub fn files(&self) -> &[InputFile] {
        &self.files.files
    }

    /// Acceleration of gravity, in m/s2.
    pub const fn gravity_m_s2(&self) -> f64 {
        self.simulation.gravity_m_s2
    }

    /// Message about a table that the model of motion ignores; `None` if it ignores no table of the file.
    pub fn ignored_table(&self) -> Option<&'static str> {
        let message = self.motion.kind.ignored;
        message.filter(|_| self.ignores_impact)
    }
}

impl Scenario {
    /// Reads a scenario from TOML text. `name` is the file name in errors. Records of ground motion are read from files relative to the folder
    /// of `name`.
    ///
    /// # Errors
    ///
    /// All faults of the text and of its records. Parsing stops after twenty lines that are not TOML.
    pub fn parse(text: &str, name: &str) -> Result<Self, ScenarioErrors> {
        Self::of(&Source::of_text(text, name), &ReadOptions::default())
    }

    /// Reads a scenario file.
    ///
    /// # Errors
    ///
    /// As [`Scenario::parse`] and [`Source::of_file`].
    pub fn read(path: &Path) -> Result<Self, ScenarioErrors> {
        Self::of(&Source::of_file(path)?, &ReadOptions::default())
    }

    /// JSON schema of scenarios for editors: all tables and keys with their meanings, rules and defaults.
    pub fn schema() -> Value {
        let (mut schema, _) = Self::describe();
        schema["$schema"] = "http://json-schema.org/draft-07/schema#".into();
        schema["title"] = "Scenario of archrock".into();
        meanings::add(&mut schema, "");
        schema
    }

    /// JSON schema of all tables without meanings, and the keys that exclude or need each other.
    fn describe() -> (Value, Vec<document::KeyGroup>) {
        // With a set model, tables of several models are allowed together.
        let options = ReadOptions {
            model: Some(&FOUR_LINKS),
            ..ReadOptions::default()
        };
        table::describe(|table| Self::read_table(table, &[], &options, false))
    }

    /// Reads a scenario with options.
    ///
    /// # Errors
    ///
    /// As [`Scenario::parse`], and when an option does not fit the scenario. An error in an assignment has the assignment instead of the file,
    /// and no line.
    pub fn of(source: &Source, options: &ReadOptions<'_>) -> Result<Self, ScenarioErrors> {
        let text = &source.text;
        table::read_text((text, &source.files), options.set, |table| {
            let mut scenario = Self::read_table(table, &[], options, false)?;
            let mut files = vec![InputFile::of_scenario(&source.name, text)];
            files.append(&mut table.noted_files);
            let place = source.files.clone();
            scenario.files = InputFiles { files, place };
            Ok(scenario)
        })
        .map_err(|faults| ScenarioErrors::placed((text, &source.name), options.set, faults))
    }

    /// Reads a scenario. `known` are records that need not be read from their files again. If `unproved`, the structure need not be able to stand:
    /// its model reports that.
    fn read_table(
        table: &mut Table<'_>,
        known: &[Series],
        options: &ReadOptions<'_>,
        unproved: bool,
    ) -> ReadResult<Self> {
        let title = table.optional("title", &text());
        let motion = models::Tables::read(table, options.model, options.statics);
        let kind = motion.kind;
        let simulation = table.table_or_defaults("simulation", Simulation::read);
        let simulated = simulation.as_ref().ok();
        let gravity_m_s2 = simulated.map(|it| it.gravity_m_s2);
        let lands = kind.has_joints && !kind.has_stiffness && !options.statics;
        let reading = (kind.has_joints, lands, unproved, motion.moves);
        let built = Structure::read(table, reading, gravity_m_s2);
        let structure = built.as_ref().ok().map(|(structure, _)| structure);
        let known = (known, gravity_m_s2, options.statics);
        let ground = GroundInput::read(table, known, options.statics);
        let motion = motion.read_remaining(table, gravity_m_s2);
        let right_foot = ground.as_ref().ok().and_then(|it| it.right_foot.as_ref());
        let right_foot_fits =
            right_foot.map_or(Ok(()), |it| it.check_model(table, structure, kind));
        let initial = table.given_table("initial", |table| initial::read(table, structure, kind));
        let moved = (kind, motion.as_ref().ok().map(|(motion, _)| motion));
        let map = StudyTable::Map.read(table, |table| Map::read(table, structure, moved));
        let suite = StudyTable::Suite.read(table, |table| Suite::read(table, simulated));
        let verify = StudyTable::Verify.read(table, |table| Verify::read(table, gravity_m_s2));
        let checked = verify.as_ref().ok().cloned().flatten().unwrap_or_default();
        let demand = Demand::read_given(table, &checked);
        let uncertain = StudyTable::Uncertain.read(table, Uncertain::read);
        let (verify, demand, ()) = (verify?, demand?, right_foot_fits?);
        if let Some(verify) = &verify {
            verify.check_demand(table, demand.as_ref())?;
        }
        let ((motion, ignores_impact), (structure, ties)) = (motion?, built?);
        let motion = motion.for_structure(&structure);
        let shaken_s = ground.as_ref().map_or(0.0, |it| it.motion.end_s());
        let end_s = simulated.map(|it| it.end_s(shaken_s, structure.size_m()));
        if !(unproved && kind.has_joints) {
            motion.check(table, &structure, end_s)?;
        }
        initial::check_structure(table, !ties.is_empty(), motion.supports().is_some())?;
        let ground = ground?;
        let (initial, blow) = initial?.unzip();
        let (simulation, (suite, named)) = (simulation?, suite?.unzip());
        let mut certain = Self {
            title: title.map(|title| shown(&title)),
            structure,
            ties,
            motion,
            ignores_impact,
            ground: ground.ground,
            unread_ground: ground.unread,
            right_foot: ground.right_foot,
            initial,
            blow: blow.flatten(),
            simulation,
            map: map?,
            suite,
            demand,
            verify,
            uncertain: None,
            given: Given::of(table, options),
            files: InputFiles {
                place: table.files().clone(),
                ..InputFiles::default()
            },
            ground_motion: Arc::new(GroundMotion::still()),
        };
        let own = certain.simulation.direction;
        if let Some(suite) = &certain.suite
            && let Some(directions) = suite.directions(table, own, named.flatten())?
        {
            certain = certain.in_directions(directions);
        }
        certain.ground_motion = Arc::new(certain.move_both_feet(ground.motion));
        let end_s = certain.request().end_s;
        certain.simulation.check_default_end(table, end_s)?;
        certain.with_uncertain(table, uncertain?)
    }

    /// This scenario with uncertain numbers, checked against it. Without its ground motion they cannot be checked.
    fn with_uncertain(
        self,
        table: &mut Table<'_>,
        uncertain: Option<Uncertain>,
    ) -> ReadResult<Self> {
        let checked = uncertain.map(|uncertain| match self.unread_ground {
            Some(_) => Ok(uncertain),
            None => uncertain.check(table, &self),
        });
        Ok(Self {
            uncertain: checked.transpose()?,
            ..self
        })
    }

    /// Scenario with another ground motion, without tables of studies, because they were checked against the original ground.
    pub fn with_ground(&self, ground: Option<Ground>) -> Self {
        let left = ground.as_ref().map_or_else(GroundMotion::still, |ground| {
            ground.ground_motion_under(self.simulation.gravity_m_s2)
        });
        // A record of the right foot belongs to the original ground.
        let follows = |right: &RightFoot| ground.is_some() && right.record().is_none();
        let mut shaken = Self {
            right_foot: self.right_foot.clone().filter(follows),
            unread_ground: None,
            map: None,
            suite: None,
            ..self.clone().without_uncertain()
        };
        shaken.ground_motion = Arc::new(shaken.move_both_feet(left));
        shaken.ground = ground;
        let ground = shaken.resolved_values().get("ground").cloned();
        let tables = &mut shaken.given.tables;
        tables.shift_remove("ground");
        tables.extend(ground.map(|ground| ("ground".to_owned(), ground)));
        shaken
    }

    /// This scenario with other directions of its ground motion.
    #[must_use]
    pub fn in_directions(&self, directions: Directions) -> Self {
        let mut turned = self.clone();
        if directions.first() != self.simulation.direction.first() {
            turned.ground_motion = Arc::new(self.ground_motion.mirrored());
        }
        turned.simulation.direction = directions;
        let given = &mut turned.given.tables;
        let simulation = given.entry("simulation").or_insert_with(|| json!({}));
        if let Value::Object(keys) = simulation {
            keys.insert("direction".to_owned(), json!(directions));
        }
        // The older name of the key.
        if let Some(Value::Object(suite)) = given.get_mut("suite") {
            suite.shift_remove(change::BOTH_SIGNS);
        }
        turned
    }

    /// Motion of both feet for a motion of the left one, mirrored if only the mirrored direction is requested.
    pub(crate) fn move_both_feet(&self, left: GroundMotion) -> GroundMotion {
        self.move_both_feet_in(self.simulation.direction.first(), left)
    }

    /// Motion of both feet in a direction, for a motion of the left one as given.
    pub(crate) fn move_both_feet_in(
        &self,
        direction: Direction,
        left: GroundMotion,
    ) -> GroundMotion {
        let as_given = match &self.right_foot {
            None => left,
            Some(right) => {
                let row = self.structure.row();
                let apart_m = row.map_or(0.0, |row| {
                    let [from_m, to_m] = row.feet_m();
                    to_m.x - from_m.x
                });
                right.with_left_foot(left, apart_m, self.simulation.gravity_m_s2)
            }
        };
        match direction {
            Direction::AsGiven => as_given,
            Direction::Mirrored => as_given.mirrored(),
        }
    }

    /// One scenario for each record of the suite, by its name, with the record at level 1 as ground motion and without other studies.
    /// Empty without a suite.
    pub fn by_record(&self) -> Vec<(String, Self)> {
        let records = self.suite.iter().flat_map(|suite| &suite.records);
        records
            .map(|series| {
                let record = suite::scaled_record(series, Scaling::Factor(1.0));
                let scenario = self.with_ground(Some(Ground::Record(Box::new(record))));
                (series.name.clone(), scenario)
            })
            .collect()
    }

    /// Ground motion of a record multiplied by a factor, with both feet moving together, for the gravity of this scenario.
    pub(crate) fn record_motion(&self, series: &Series, factor: f64) -> GroundMotion {
        suite::scaled_record(series, Scaling::Factor(factor))
            .ground_motion(self.simulation.gravity_m_s2)
    }

    /// Makes the model of motion of the structure.
    ///
    /// # Errors
    /// When the structure has no such model.
    pub fn model(&self) -> Result<Box<dyn Model>, ModelError> {
        let MotionModel { options, site, .. } = &self.motion;
        Ok(self.repeated_mirrored(options.model(&self.structure, site)?))
    }

    /// Makes the model of the structure for a study of many cases: see [`Model::for_many_cases`].
    ///
    /// # Errors
    /// As [`Scenario::model`].
    pub fn model_for_many_cases(&self) -> Result<Box<dyn Model>, ModelError> {
        let model = self.model()?;
        Ok(model.for_many_cases().unwrap_or(model))
    }

    /// Model of motion whose first repetition is mirrored, if both directions are requested and the problem is symmetric.
    fn repeated_mirrored(&self, mut model: Box<dyn Model>) -> Box<dyn Model> {
        let is_alike = self.right_foot.is_none() && self.initial.is_none();
        if self.simulation.direction == Directions::Both && is_alike {
            model.repeat_mirrored();
        }
        model
    }

    /// Whether the motion of this scenario, by its own model, is also computed under the mirrored ground motion; see [`Directions::has_second`].
    pub fn has_second_direction(&self, model: &dyn Model) -> bool {
        let directions = self.simulation.direction;
        directions.has_second(model, &self.ground_motion, &self.request())
    }

    /// Makes models of this structure with other stiffness and contact, and with rigid joints; empty unless joints are elastic.
    ///
    /// # Errors
    /// When the structure has no such model.
    pub fn variations(&self) -> Result<Vec<Variation>, ModelError> {
        let MotionModel { options, site, .. } = &self.motion;
        options.variations(&self.structure, site)
    }

    /// Name of the model of motion in results; four links of a column are a `column`.
    pub fn model_name(&self) -> &'static str {
        match !self.motion.kind.has_mechanism || self.structure.has_horizontal_thrust() {
            true => self.motion.kind.name,
            false => "column",
        }
    }

    /// Makes the model of mechanisms of one degree of freedom, even if the scenario uses another model.
    ///
    /// # Errors
    /// As [`Structure::model`].
    pub fn mechanisms(&self) -> Result<Box<dyn MechanismModel>, FourLinkError> {
        self.structure.model(self.motion.impact())
    }

    /// Makes the model of mechanisms for a computation without impacts, which needs no restitution of a wall behind a column.
    ///
    /// # Errors
    /// As [`Structure::model`].
    pub(crate) fn mechanisms_without_impacts(
        &self,
    ) -> Result<Box<dyn MechanismModel>, FourLinkError> {
        match self.structure.wall_behind() {
            Some(_) => self
                .structure
                .model(ImpactModel::Prescribed { restitution: 0.0 }),
            None => self.mechanisms(),
        }
    }

    /// Rejects a column before a wall as one rigid block if the restitution of the wall is neither given nor has a default.
    ///
    /// # Errors
    /// The key to give, and the command that computes an answer without the key.
    pub fn check_restitution(&self) -> Result<(), String> {
        let column = self.structure.column().filter(|_| {
            let is_prescribed = self.motion.impact().model.is_prescribed();
            self.motion.kind == &FOUR_LINKS && !is_prescribed
        });
        let ratio = column.map_or(Ok(None), Column::wall_rate_ratio);
        ratio.map(drop).map_err(|error| error.to_string())
    }

    /// Rejects `[initial]` for a study named `what`, whose histories start from rest.
    ///
    /// # Errors
    /// The change that the scenario needs.
    pub(crate) fn check_from_rest(&self, what: &str) -> Result<(), String> {
        ensure(self.initial.is_none(), || {
            format!("the histories of a {what} start from rest: leave [initial] out")
        })
    }

    /// Row of blocks of masonry, of a column that is not Housner's single block, and of voussoirs that do not start as four links: limit
    /// analysis of the row finds their first mechanism. `None` for a structure that starts as one mechanism.
    ///
    /// # Errors
    /// As [`Structure::free_hinges`].
    pub fn row(&self) -> Result<Option<Row>, ModelError> {
        Ok(match &self.structure {
            Structure::Masonry(masonry) => Some(masonry.row.clone()),
            Structure::Column(column) if !column.is_one_prism() => {
                Some(self.structure.row().map_err(RowModelError::from)?)
            }
            Structure::Arch(_) if matches!(self.mechanisms(), Err(error) if error.is_other_mechanism()) => {
                self.structure.row().ok()
            }
            Structure::Arch(_) | Structure::Column(_) => None,
        })
    }

    /// Ground motion; it is zero if the scenario has no `[ground]`.
    pub fn ground_motion(&self) -> &GroundMotion {
        &self.ground_motion
    }

    /// Checks that there is a history to simulate: the ground moves, or the structure is released from a rotated position.
    ///
    /// # Errors
    /// The table or the key to add, or the command to use.
    pub fn check_for_run(&self) -> Result<(), String> {
        self.check_without_live_loads()?;
        if self.ground.is_some() || self.initial.is_some() {
            return self.check_restitution();
        }
        let give = "nothing moves the structure: give a table [ground.<kind>], such as [ground.rectangular], or \
                    [initial]";
        Err(match self.suite {
            Some(_) => {
                format!("{give}; the records of [suite] are run by `archrock suite SCENARIO`")
            }
            None => give.to_owned(),
        })
    }

    /// Rejects live loads and vehicles, for all studies but limit analysis.
    ///
    /// # Errors
    /// The tables to remove.
    pub fn check_without_live_loads(&self) -> Result<(), String> {
        ensure(self.structure.under_live_loads().is_none(), || {
            "live loads are computed by `limit` alone: for other studies leave out [vehicle], and each [[load]] with `live`".to_owned()
        })
    }

    /// Rejects moved springings, for computations on the undeformed structure.
    ///
    /// # Errors
    /// The table to remove.
    pub fn check_as_built(&self) -> Result<(), String> {
        let wrong = "this is computed for the structure on the springings that were built: leave [supports] out; the studies `limit` and \
                     `spread` compute its capacity on moved springings";
        ensure(self.motion.supports().is_none(), || wrong.to_owned())
    }

    /// Request for the simulation, with samples at every output step.
    pub fn request(&self) -> Request {
        self.request_under(&self.ground_motion)
    }

    /// Request for a simulation with another ground motion.
    pub fn request_under(&self, ground: &GroundMotion) -> Request {
        Request {
            initial: self.initial,
            ..self.request_on(ground, &self.structure)
        }
    }

    /// Request for a history of a structure from rest on a ground motion; `[initial]` is ignored.
    pub fn request_on(&self, ground: &GroundMotion, structure: &Structure) -> Request {
        let end_s = self.simulation.end_s(ground.end_s(), structure.size_m());
        Request {
            gravity_m_s2: self.simulation.gravity_m_s2,
            end_s,
            outcome_by_s: self.simulation.outcome_by_s(ground.end_s(), end_s),
            output_step_s: self.simulation.output_step_s,
            initial: None,
            relative_tolerance: self.simulation.relative_tolerance,
            rest_energy_ratio: self.simulation.rest_energy_ratio,
        }
    }

    /// Scenario as TOML text with all defaults. A default `duration_s` is omitted, because it depends on the ground motion.
    ///
    /// Reading the text of a valid scenario gives an equal scenario.
    pub fn to_toml(&self) -> String {
        toml_text(&self.to_json())
    }

    /// Scenario as TOML text as [`Scenario::to_toml`] does, with a default `duration_s` as a comment: a default in the text would no
    /// longer follow the ground motion and the structure.
    pub fn to_resolved_toml(&self) -> String {
        let text = self.to_toml();
        match self.simulation.duration_s {
            Some(_) => text,
            None => {
                let end_s = self.request().end_s;
                format!(
                    "# default duration_s of [simulation], from the ground motion and the size of the structure: {end_s:.4} s\n{text}"
                )
            }
        }
    }

    /// Scenario as JSON as [`Scenario::to_json`] does, with `duration_s` always written, to the nanosecond.
    pub fn to_resolved_json(&self) -> Value {
        let mut json = self.to_json();
        if let Some(Value::Object(simulation)) = json.get_mut("simulation") {
            let end_s = format!("{:.9}", self.request().end_s).parse::<f64>();
            simulation.shift_insert(0, "duration_s".to_owned(), json!(end_s.ok()));
        }
        json
    }

    /// Scenario as JSON with the given keys and all defaults. A default `duration_s` is omitted, because it depends on the ground
    /// motion.
    pub fn to_json(&self) -> Value {
        self.given.with_defaults(self.resolved_values())
    }

    /// Scenario as JSON. A circular arch has mean radius, thickness ratio and embrace angle, regardless of the keys in the file.
    pub(crate) fn resolved_values(&self) -> Value {
        let mut ground = self.unread_ground.clone();
        let ground = ground.get_or_insert_with(|| json!(self.ground));
        if let (Value::Object(ground), Some(right)) = (&mut *ground, &self.right_foot) {
            ground.insert("right".to_owned(), json!(right));
        }
        let ties = Some(&self.ties).filter(|ties| !ties.is_empty());
        // Masonry contains its loads.
        let loads = self.structure.column().map(|column| &column.loads);
        let loads = loads.filter(|loads| !loads.is_empty());
        let initial = self
            .blow
            .map_or_else(|| json!(self.initial), |blow| json!(blow));
        let mut tables = vec![
            ("tie", json!(ties)),
            ("supports", json!(self.motion.supports())),
            ("ground", ground.take()),
            ("initial", initial),
            ("simulation", json!(self.simulation)),
        ];
        tables.extend(StudyTable::ALL.iter().map(|table| {
            let json = match table {
                StudyTable::Map => json!(self.map),
                StudyTable::Suite => json!(self.suite),
                StudyTable::Demand => json!(self.demand),
                StudyTable::Verify => json!(self.verify),
                StudyTable::Uncertain => json!(self.uncertain),
            };
            (table.name(), json)
        }));
        // The options of rows of blocks come after the structure, those of mechanisms after the ground.
        let kind = self.motion.kind;
        let place = if kind.has_joints { 1 } else { 3 };
        tables.insert(place, (kind.table, self.motion.options.to_json()));
        let structure = json!(self.structure);
        let mut all = Entries::from_iter([("title".to_owned(), json!(self.title))]);
        all.extend(structure.as_object().cloned().unwrap_or_default());
        all.extend(loads.map(|loads| ("load".to_owned(), json!(load::with_defaults(loads)))));
        let tables = tables.into_iter();
        all.extend(tables.map(|(key, table)| (key.to_owned(), table)));
        given(Value::Object(all))
    }
}

/// The ground motion of a scenario, read from `[ground]`.
struct GroundInput {
    ground: Option<Ground>,
    right_foot: Option<RightFoot>,
    /// Motion of the left foot.
    motion: GroundMotion,
    /// `[ground]` with the keys of the text; `None` unless its files are missing or faulty in static analysis.
    unread: Option<Value>,
}

impl GroundInput {
    fn read(table: &mut Table<'_>, known: KnownRecords<'_>, statics: bool) -> ReadResult<Self> {
        let faults = table.faults();
        let mut right_foot = Ok(None);
        let mut ground = table.given_table("ground", |table| {
            right_foot = table.given_table("right", |table| RightFoot::read(table, known));
            Ground::read(table, known)
        });
        let is_unread = ground.is_err() || right_foot.is_err();
        let mut unread = None;
        if statics && is_unread && table.drop_file_faults(faults) {
            unread = table.as_given("ground");
            (ground, right_foot) = (Ok(None), Ok(None));
        }
        let (ground, motion) = ground?.unzip();
        Ok(Self {
            ground,
            right_foot: right_foot?,
            motion: motion.unwrap_or_else(GroundMotion::still),
            unread,
        })
    }
}

/// Removes keys without a value from a table and from all tables in it.
fn given(value: Value) -> Value {
    match value {
        Value::Object(table) => {
            let some = table.into_iter().filter(|(_, value)| !value.is_null());
            Value::Object(some.map(|(key, value)| (key, given(value))).collect())
        }
        Value::Array(values) => values.into_iter().map(given).collect(),
        value => value,
    }
}
