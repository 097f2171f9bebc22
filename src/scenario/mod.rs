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

mod assignment;
mod error;
mod free_hinges;
mod ground;
mod impact;
mod initial;
mod listing;
mod map;
mod masonry;
mod record;
mod sequence;
mod shown;
mod simulation;
mod source;
mod span;
mod spectrum;
mod structure;
mod suite;
mod table;
mod toml_text;
mod unlikely;
mod variant;
mod verify;

use std::path::Path;
use std::sync::Arc;

use serde::Serialize;
use serde_json::Value;

use crate::dynamics::free_hinges::RowOptions;
use crate::dynamics::ground::GroundMotion;
use crate::dynamics::model::{Initial, Model, Request};
use crate::mechanics::blocks::Row;
use crate::mechanics::four_link::impact::ImpactLaw;
pub use assignment::Assignment;
pub use error::{Place, ScenarioError, ScenarioErrors};
pub(crate) use ground::MAX_ACCELERATION_G;
pub use ground::{Ground, PulseGround};
pub use map::{Axis, Map, Quantity};
pub use record::{
    Component, Contents, Decimal, Form, Format, Layout, LineFault, Record, Recorded, Sampling,
    Scaling, Series, TableColumn, TableLayout, Times, Unit,
};
pub use sequence::{Sequence, Spacing};
pub use shown::{shown, shown_lines};
pub use simulation::Simulation;
pub use source::Source;
pub use spectrum::Spectrum;
pub(crate) use spectrum::block;
pub use structure::{ModelError, Structure};
pub use suite::{Measure, Suite};
use table::{Reading, Table, Text};
pub(crate) use toml_text::toml_text;
pub use verify::{
    BEHAVIOUR_FACTOR, BuildingMode, ByState, CONFIDENCE_FACTOR, CodeDemand, Demand, FreeStanding,
    Height, LimitState, ModeState, PointDemand, Records, Relief, Sides, StateRule, Verify,
};

named! {
    /// A model of motion.
    pub enum Hinges {
        /// Mechanisms of one degree of freedom that follow one another: four links, or Housner's column.
        Four = "four",
        /// A row of blocks whose joints open and shut anywhere.
        Free = "free",
    }
}

/// What changes a scenario as it is read.
///
/// With free hinges asked for, the steps are those of `[free_hinges]` if that is there, and `[impact]` is not asked
/// for; with four links `[free_hinges]` is not asked for.
#[derive(Clone, Copy, Debug, Default)]
pub struct Changes<'a> {
    /// The model of motion; `None`: the one that the scenario chooses.
    pub hinges: Option<Hinges>,
    /// Values that take the place of those in the text; of two for one key, the later.
    pub set: &'a [Assignment],
}

/// What to simulate, every default resolved.
///
/// A scenario is read from text, which checks it; it is serialized as it is read, to TOML by
/// [`Scenario::to_toml`] and to JSON by [`Scenario::to_json`].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scenario {
    /// Free text for the results, as it is [shown](fn@shown).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub title: Option<String>,
    /// What stands on the ground.
    #[serde(flatten)]
    pub structure: Structure,
    /// Options of the model whose joints open and shut anywhere; `None`: four links.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub free_hinges: Option<RowOptions>,
    /// How the ground moves; `None`: it stays still.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ground: Option<Ground>,
    /// What happens when the hinges of four links close; nothing that is asked of free hinges.
    #[serde(serialize_with = "impact::serialize")]
    pub impact: ImpactLaw,
    /// Where the motion starts from; `None`: from rest.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub initial: Option<Initial>,
    /// How the motion is computed.
    pub simulation: Simulation,
    /// What varies over an overturning map.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub map: Option<Map>,
    /// What is tried for an overturning spectrum; `None`: the defaults.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spectrum: Option<Spectrum>,
    /// Which records shake the structure for its fragility.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub suite: Option<Suite>,
    /// What is demanded of it in a check.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub demand: Option<Demand>,
    /// How it is checked; `None`: by the defaults.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub verify: Option<Verify>,
    /// The motion of `ground`, built when that was read.
    #[serde(skip)]
    motion: Arc<GroundMotion>,
}

impl Scenario {
    /// Reads a scenario from TOML text; `name` stands for the file in the errors. Records of ground motion
    /// are read from files relative to the folder of `name`.
    ///
    /// # Errors
    ///
    /// All that is wrong with the text and with its records. After twenty lines that are not TOML it stops
    /// looking.
    pub fn parse(text: &str, name: &str) -> Result<Self, ScenarioErrors> {
        Self::of(&Source::of_text(text, name), &Changes::default())
    }

    /// Reads a scenario file.
    ///
    /// # Errors
    ///
    /// As [`Scenario::parse`] and [`Source::of_file`].
    pub fn read(path: &Path) -> Result<Self, ScenarioErrors> {
        Self::of(&Source::of_file(path)?, &Changes::default())
    }

    /// Reads a scenario, changed.
    ///
    /// # Errors
    ///
    /// As [`Scenario::parse`], and when a change does not go with the rest. Errors in an assignment have no place but
    /// the assignment, which stands for the file.
    pub fn of(source: &Source, changes: &Changes<'_>) -> Result<Self, ScenarioErrors> {
        let Source { folder, text, .. } = source;
        table::read_text(text, changes.set, |table| {
            Self::read_table(table, folder, changes.hinges)
        })
        .map_err(|faults| ScenarioErrors::placed(source, changes.set, faults))
    }

    /// Reads a scenario whose files are relative to `folder`.
    fn read_table(table: &mut Table<'_>, folder: &Path, hinges: Option<Hinges>) -> Reading<Self> {
        let title = table.optional("title", &Text);
        let steps = table.table("free_hinges", free_hinges::read);
        let free = match hinges {
            Some(hinges) => hinges == Hinges::Free,
            None => table.gives_table("free_hinges"),
        };
        let structure = Structure::read(table, folder, free);
        let simulation = table.table_or_defaults("simulation", Simulation::read);
        let gravity_m_s2 = match &simulation {
            Ok(simulation) => Ok(simulation.gravity_m_s2),
            Err(reported) => Err(*reported),
        };
        let ground = table.table("ground", |table| Ground::read(table, folder, gravity_m_s2));
        let (ground, motion) = match ground {
            Ok(Some((ground, motion))) => (Ok(Some(ground)), motion),
            Ok(None) => (Ok(None), GroundMotion::still()),
            Err(reported) => (Err(reported), GroundMotion::still()),
        };
        if hinges.is_none() && table.gives("free_hinges") && table.gives("impact") {
            let wrong = "cannot be combined with [free_hinges], whose impacts follow from the blocks; leave one out";
            return Err(table.wrong("impact", wrong));
        }
        let impact = table.table_or_defaults("impact", impact::read);
        let initial = table.table("initial", |table| {
            Initial::read(table, structure.as_ref().ok())
        });
        let map = table.table("map", |table| {
            let (structure, ground) = (structure.as_ref().ok(), ground.as_ref().ok());
            let impact = impact.as_ref().ok().map(|law| &law.model);
            let simulation = simulation.as_ref().ok();
            Map::read(table, structure, free, ground, impact, simulation)
        });
        let spectrum = table.table("spectrum", |table| {
            let structure = structure.as_ref().ok();
            Spectrum::read(table, structure, ground.as_ref().ok(), gravity_m_s2)
        });
        let suite = table.table("suite", |table| {
            Suite::read(table, folder, simulation.as_ref().ok())
        });
        let verify = table.table("verify", |table| Verify::read(table, folder, gravity_m_s2));
        let demand = table.table("demand", |table| {
            let factor =
                |verify: &Option<Verify>| verify.clone().unwrap_or_default().confidence_factor;
            Demand::read(
                table,
                folder,
                verify.as_ref().map(factor).map_err(|reported| *reported),
            )
        });
        let (verify, demand) = (verify?, demand?);
        if let Some(verify) = &verify {
            verify.suits(table, demand.as_ref())?;
        }
        let (steps, structure) = (steps?, structure?);
        if let Some(options) = steps.filter(|_| free) {
            free_hinges::carries(table, &structure, options)?;
        }
        Ok(Self {
            title: title?.map(|title| shown(&title)),
            structure,
            free_hinges: free.then(|| steps.unwrap_or_default()),
            ground: ground?,
            impact: impact?,
            initial: initial?,
            simulation: simulation?,
            map: map?,
            spectrum: spectrum?,
            suite: suite?,
            demand,
            verify,
            motion: Arc::new(motion),
        })
    }

    /// The same structure, simulated in the same way, on ground that moves like this; without the tables of studies,
    /// which go with the ground that they were read with.
    #[must_use]
    pub fn with_ground(&self, ground: Option<Ground>) -> Self {
        let motion = ground.as_ref().map_or_else(GroundMotion::still, |ground| {
            ground.motion_under(self.simulation.gravity_m_s2)
        });
        Self {
            ground,
            map: None,
            spectrum: None,
            suite: None,
            motion: Arc::new(motion),
            ..self.clone()
        }
    }

    /// The ground motion of a record under this scenario's gravity, multiplied by a factor.
    #[must_use]
    pub(crate) fn shaken_by(&self, series: &Series, factor: f64) -> GroundMotion {
        suite::shaking(series, Scaling::Factor(factor)).motion(self.simulation.gravity_m_s2)
    }

    /// The model of motion that the scenario chooses.
    ///
    /// # Errors
    /// As [`Structure::model`] or [`Structure::free_hinges`].
    pub fn model(&self) -> Result<Box<dyn Model>, ModelError> {
        Ok(match self.free_hinges {
            Some(steps) => Box::new(self.structure.free_hinges(steps)?),
            None => self.structure.model(self.impact)?,
        })
    }

    /// The name in results of the model of motion that the scenario chooses.
    #[must_use]
    pub const fn model_name(&self) -> &'static str {
        match (&self.free_hinges, &self.structure) {
            (Some(_), _) => "free_hinges",
            (None, Structure::Arch(_) | Structure::Masonry(_)) => "four_links",
            (None, Structure::Column(_)) => "column",
        }
    }

    /// Refuses a scenario that does not start from rest, as the histories of what is asked for do.
    ///
    /// # Errors
    /// In words, what to change.
    pub(crate) fn check_from_rest(&self, what: &str) -> Result<(), String> {
        match self.initial {
            None => Ok(()),
            Some(_) => Err(format!(
                "the histories of a {what} start from rest: leave [initial] out"
            )),
        }
    }

    /// The blocks of which limit analysis tells what starts them: of masonry, and of a column that is not the one block
    /// of Housner. `None` of what starts as one mechanism.
    ///
    /// # Errors
    /// As [`Structure::free_hinges`].
    pub fn row(&self) -> Result<Option<Row>, ModelError> {
        Ok(match &self.structure {
            Structure::Masonry(masonry) => Some(masonry.row().clone()),
            Structure::Column(column) if !column.is_one_prism() => {
                let drums = self.structure.free_hinges(RowOptions::default())?;
                Some(drums.row().clone())
            }
            Structure::Arch(_) | Structure::Column(_) => None,
        })
    }

    /// The ground motion, of still ground where the scenario has no `[ground]`.
    #[must_use]
    pub fn ground_motion(&self) -> &GroundMotion {
        &self.motion
    }

    /// Whether there is a history to simulate: the ground moves, or the structure is released from a rotated
    /// position.
    ///
    /// # Errors
    /// In words, what to add or which command is meant.
    pub fn check_for_run(&self) -> Result<(), String> {
        if self.ground.is_some() || self.initial.is_some() {
            return Ok(());
        }
        let give = "nothing moves the structure: give a table [ground.<kind>], such as [ground.rectangular], or \
                    [initial]";
        Err(match self.suite {
            Some(_) => format!("{give}; the records of [suite] are run by `archrock suite`"),
            None => give.to_owned(),
        })
    }

    /// What is asked of the simulation, samples at every output step included.
    #[must_use]
    pub fn request(&self) -> Request {
        Request {
            gravity_m_s2: self.simulation.gravity_m_s2,
            end_s: self.simulation.duration_s,
            output_step_s: self.simulation.output_step_s,
            initial: self.initial,
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
        match self.to_json() {
            Value::Object(table) => toml_text(&table),
            _ => unreachable!("a scenario is a table"),
        }
    }

    /// The scenario as JSON, every default written out, with the keys of the file.
    #[must_use]
    pub fn to_json(&self) -> Value {
        let mut table =
            serde_json::to_value(self).expect("a scenario consists of tables of numbers and texts");
        // Beside free hinges there is no `[impact]`.
        if let (Some(_), Some(table)) = (self.free_hinges, table.as_object_mut()) {
            table.shift_remove("impact");
        }
        table
    }
}
