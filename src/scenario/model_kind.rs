//! Names and properties of a model of motion, and its options in a table of the scenario.

use std::fmt::Debug;
use std::sync::Arc;

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::prelude::*;
use super::structure::{ModelError, Structure};
use crate::dynamics::Variation;
use crate::mechanics::Movements;
use crate::{ImpactLaw, Model, Request};

/// A model of motion: its names, its properties, and the reader of its options.
#[derive(Debug)]
pub struct ModelKind {
    /// Name of the model in the command-line option `--hinges`.
    pub option: &'static str,
    /// Name of the model in results; four links of a column are named `column`.
    pub name: &'static str,
    /// Scenario table with the options of the model.
    pub table: &'static str,
    /// Name of the model in sentences.
    pub label: &'static str,
    /// Its assumptions and its accuracy, in words.
    pub assumptions: &'static str,
    /// True if the structure is a row of blocks with joints.
    pub has_joints: bool,
    /// True if the structure is one mechanism at a time, which has a restitution, and a critical rotation: that of its unstable equilibrium.
    pub has_mechanism: bool,
    /// True if histories are computed in steps, and repeated with other steps.
    pub is_repeated: bool,
    /// True if joints have a stiffness, which is varied; otherwise they are rigid.
    pub has_stiffness: bool,
    /// True if several motions are computed faster together.
    pub has_lanes: bool,
    /// Message about a table that the model ignores; `None` if it ignores no table.
    pub ignored: Option<&'static str>,
    /// Fault of a scenario without the table; `None` if all options have defaults.
    pub(super) lacking: Option<&'static str>,
    /// Reader of the table.
    pub(super) read: fn(&mut Table<'_>) -> ReadResult<Arc<dyn ModelOptions>>,
}

/// Kinds are equal if their names are.
impl PartialEq for ModelKind {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Serialize for ModelKind {
    /// Writes the name of the option `--hinges`.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.option)
    }
}

impl<'de> Deserialize<'de> for &'static ModelKind {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = String::deserialize(deserializer)?;
        let unknown = || D::Error::custom(format!("unknown model of motion {name:?}"));
        ModelKind::of_option(&name).ok_or_else(unknown)
    }
}

/// A model of motion, or the reason why the structure has none.
pub(crate) type AnyModel = Result<Box<dyn Model>, ModelError>;

/// The conditions under which a structure stands at time 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Site {
    /// Movements of the supports before time 0, from `[supports]`.
    pub(super) supports: Movements,
    /// Acceleration of gravity, in m/s2, from `[simulation]`.
    pub(super) gravity_m_s2: f64,
}

/// The options of a model of motion, from its table.
pub(crate) trait ModelOptions: Debug + Send + Sync {
    /// Contents of the scenario table of the model.
    fn to_json(&self) -> Value;

    /// Makes the model of a structure.
    ///
    /// # Errors
    /// When the structure does not rock as four links, or is not a row of blocks that can stand.
    fn model(&self, structure: &Structure, site: &Site) -> AnyModel;

    /// Options that depend on the structure, once it is known; `None` if none do.
    fn for_structure(&self, _: &Structure, _: &Site) -> Option<Arc<dyn ModelOptions>> {
        None
    }

    /// Makes models with other, equally likely properties.
    ///
    /// # Errors
    /// As [`ModelOptions::model`].
    fn variations(&self, _: &Structure, _: &Site) -> Result<Vec<Variation>, ModelError> {
        Ok(Vec::new())
    }

    /// Impact law; `None` if impacts follow from the blocks, or if there are none.
    fn law(&self) -> Option<ImpactLaw> {
        None
    }

    /// Coulomb's coefficient of friction; `None` if joints cannot slip.
    fn friction_coefficient(&self) -> Option<f64> {
        None
    }

    /// Compressive strength of joints that may crush, in MPa; otherwise `None`.
    fn compressive_strength_mpa(&self) -> Option<f64> {
        None
    }

    /// Longest step of the motion, in seconds; `None` if a tolerance determines the steps, or if the structure cannot stand.
    fn longest_step_s(&self, _: &Structure, _: &Site, _: &Request) -> Option<f64> {
        None
    }

    /// Rejects options that do not fit the structure. `end_s` is the end of the history, if it is known.
    fn check(
        &self,
        _: &mut Table<'_>,
        _: &Structure,
        _: &Site,
        _end_s: Option<f64>,
    ) -> ReadResult<()> {
        Ok(())
    }
}
