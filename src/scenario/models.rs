//! All models of motion, and the choice of a scenario.

use std::sync::Arc;

use super::elastic_joints::ELASTIC_JOINTS;
use super::free_hinges::FREE_HINGES;
use super::impact::FOUR_LINKS;
use super::model_kind::{ModelKind, ModelOptions, Site};
use super::prelude::*;
use super::structure::{DRUM_KEYS, Structure};
use super::{free_hinges, supports};
use crate::mechanics::Movements;
use crate::{ImpactLaw, ImpactModel, Request};

/// All models of motion, the least trustworthy first.
pub static MODELS: [&ModelKind; 3] = [&FOUR_LINKS, &FREE_HINGES, &ELASTIC_JOINTS];

impl ModelKind {
    /// Model with this name of the option `--hinges`.
    pub fn of_option(name: &str) -> Option<&'static Self> {
        MODELS.into_iter().find(|model| model.option == name)
    }

    /// Position in [`MODELS`], the order of trust.
    pub fn rank(&self) -> Option<usize> {
        MODELS.into_iter().position(|model| model == self)
    }
}

/// The model of motion of a scenario, with its options.
#[derive(Clone, Debug)]
pub struct MotionModel {
    /// Names and properties of the model.
    pub kind: &'static ModelKind,
    /// Options of the model.
    pub(crate) options: Arc<dyn ModelOptions>,
    /// The conditions at time 0.
    pub(super) site: Site,
    /// True if the scenario has a table `[elastic_joints]` that another model, chosen by the user, ignores.
    pub(crate) ignores_elastic_joints: bool,
}

impl PartialEq for MotionModel {
    fn eq(&self, other: &Self) -> bool {
        let parts = |one: &Self| (one.kind, one.site, one.options.to_json());
        parts(self) == parts(other)
    }
}

impl MotionModel {
    /// Impact law of four links; the theoretical law for models without four links.
    pub fn impact(&self) -> ImpactLaw {
        self.options
            .law()
            .unwrap_or(ImpactModel::MaxRestitution.into())
    }

    /// This model with the options that follow from the structure.
    pub(super) fn for_structure(mut self, structure: &Structure) -> Self {
        let options = self.options.for_structure(structure, &self.site);
        self.options = options.unwrap_or(self.options);
        self
    }

    /// Rejects options that do not fit a structure. `end_s` is the end of the history, if it is known.
    pub(super) fn check(
        &self,
        table: &mut Table<'_>,
        structure: &Structure,
        end_s: Option<f64>,
    ) -> ReadResult<()> {
        if let Some(movements) = self.supports() {
            supports::check(table, structure, movements)?;
        }
        if let Some(coefficient) = self.options.friction_coefficient() {
            free_hinges::check_friction(structure, coefficient).map_err(|wrong| {
                table.reject_in(&[self.kind.table], "friction_coefficient", wrong)
            })?;
        }
        let site = &self.site;
        self.options.check(table, structure, site, end_s)
    }

    /// Movements of the supports before time 0; `None` without movements.
    pub fn supports(&self) -> Option<Movements> {
        Some(self.site.supports).filter(|moved| !moved.is_none())
    }
}

/// Relations between the tables of different models of motion.
const ONE_TABLE: &[Relation<'_>] = &[Excludes("elastic_joints", "free_hinges", ONE_MODEL)];
/// Relations of an impact law that is not the default.
const NO_IMPACT: &[Relation<'_>] = &[
    Excludes("elastic_joints", "impact", ELASTIC_IMPACT),
    Excludes("free_hinges", "impact", FREE_IMPACT),
];
const ONE_MODEL: &str =
    "cannot be combined with [elastic_joints]; leave one out, or choose the model of motion";
const ELASTIC_IMPACT: &str =
    "cannot be combined with [elastic_joints], which have no impacts; leave one out";
const FREE_IMPACT: &str =
    "cannot be combined with [free_hinges], whose impacts follow from the blocks; leave one out";

/// True if the structure needs a model with joints: it has drums, or moved springings.
fn needs_joints(table: &Table<'_>) -> bool {
    table.has_key("supports") || DRUM_KEYS.iter().any(|key| table.has_key_in("column", key))
}

/// The tables of a scenario that concern its model of motion.
pub(super) struct Tables {
    pub(super) kind: &'static ModelKind,
    /// True unless only statics follow, and no model with joints has a table.
    pub(super) moves: bool,
    /// True if the user chose the model, so that tables of other models are ignored.
    is_set: bool,
    /// Options of the models with joints that have a table.
    options: ReadResult<Vec<(&'static ModelKind, Arc<dyn ModelOptions>)>>,
    supports: ReadResult<Option<Movements>>,
}

impl Tables {
    /// Reads the tables of rows of blocks. They choose the model unless it is `set`. In static analysis drums and moved springings need no
    /// table; their model is free hinges.
    pub(super) fn read(
        table: &mut Table<'_>,
        set: Option<&'static ModelKind>,
        statics: bool,
    ) -> Self {
        let joints = MODELS.into_iter().filter(|kind| kind.has_joints);
        let read = joints.clone().map(|kind| {
            let options = table.given_table(kind.table, kind.read);
            options.map(|options| Some((kind, options?)))
        });
        // Every table is read, for its faults.
        let read: Vec<ReadResult<_>> = read.collect();
        let options: ReadResult<Vec<_>> = read.into_iter().collect();
        let supports = table.given_table("supports", supports::read);
        let given = joints.rev().find(|kind| table.has_table(kind.table));
        let rows = (statics && needs_joints(table)).then_some(&FREE_HINGES);
        Self {
            kind: set.or(given).or(rows).unwrap_or(&FOUR_LINKS),
            moves: !statics || given.is_some(),
            is_set: set.is_some(),
            options: options.map(|options| options.into_iter().flatten().collect()),
            supports,
        }
    }

    /// Reads the impact law. Returns the model, and true if the model ignores an `[impact]` of the text. `gravity_m_s2` is that of
    /// `[simulation]`, if it is known.
    pub(super) fn read_remaining(
        self,
        table: &mut Table<'_>,
        gravity_m_s2: Option<f64>,
    ) -> ReadResult<(MotionModel, bool)> {
        let kind = self.kind;
        let links = table.table_or_defaults(FOUR_LINKS.table, FOUR_LINKS.read);
        // The default law beside a model with joints says nothing that the model ignores.
        let is_default = links
            .as_ref()
            .is_ok_and(|links| links.law() == Some(ImpactModel::MaxRestitution.into()));
        if !self.is_set {
            table.apply_relations(ONE_TABLE)?;
        }
        if !self.is_set && !is_default {
            table.apply_relations(NO_IMPACT)?;
        }
        let (links, joints, supports) = (links?, self.options?, self.supports?);
        let law = links.law();
        let wrong = "needs joints that follow: four links start undeformed; choose [free_hinges] or [elastic_joints], or leave it out";
        table.refuse(supports.is_some() && !kind.has_joints, "supports", wrong)?;
        let has_elastic_joints = joints.iter().any(|(one, _)| *one == &ELASTIC_JOINTS);
        let mut given = joints.into_iter().chain([(&FOUR_LINKS, links)]);
        let options = match (given.find(|(one, _)| *one == kind), kind.lacking) {
            (Some((_, options)), _) => options,
            (None, Some(lacking)) => return Err(table.fault_of_table(lacking)),
            (None, None) => table.table_or_defaults(kind.table, kind.read)?,
        };
        let model = MotionModel {
            kind,
            options,
            site: Site {
                supports: supports.unwrap_or_default(),
                gravity_m_s2: gravity_m_s2.unwrap_or(Request::default().gravity_m_s2),
            },
            ignores_elastic_joints: has_elastic_joints && *kind != ELASTIC_JOINTS,
        };
        let ignores_impact = law != Some(model.impact());
        Ok((model, ignores_impact))
    }
}
