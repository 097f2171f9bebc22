//! Models of motion: their tables, and their models of a structure.

use super::elastic_joints::ElasticTable;
use super::free_hinges::FreeTable;
use super::hinges::Hinges;
use super::prelude::*;
use super::structure::{DRUM_KEYS, ModelError, Structure};
use super::{free_hinges, impact, supports};
use crate::dynamics::Variation;
use crate::mechanics::Movements;
use crate::{ImpactLaw, ImpactModel, Model, Request, RowOptions};

/// A model of motion with its options.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Motion {
    /// [`Hinges::Four`], with the impact law of `[impact]`.
    FourLinks(ImpactLaw),
    /// [`Hinges::Free`], with `[free_hinges]`.
    FreeHinges(FreeTable),
    /// [`Hinges::Elastic`], with `[elastic_joints]`.
    ElasticJoints(ElasticTable),
}

type AnyModel = Result<Box<dyn Model>, ModelError>;

impl Motion {
    /// Returns the name of the model.
    pub const fn hinges(&self) -> Hinges {
        match self {
            Self::FourLinks(_) => Hinges::Four,
            Self::FreeHinges(_) => Hinges::Free,
            Self::ElasticJoints(_) => Hinges::Elastic,
        }
    }

    /// Returns true if the model computes several motions faster together: see [`Model::is_elastic`].
    pub const fn is_faster_together(&self) -> bool {
        matches!(self, Self::ElasticJoints(_))
    }

    /// Returns the name of the model in sentences.
    pub const fn label(&self) -> &'static str {
        self.hinges().model().label
    }

    /// Returns the name of the model of a structure in results.
    pub(super) const fn name(&self, structure: &Structure) -> &'static str {
        match self {
            Self::FourLinks(_) if !structure.thrusts() => "column",
            _ => self.hinges().model().name,
        }
    }

    /// Makes the model of a structure.
    ///
    /// # Errors
    /// As [`Structure::model`] or [`Structure::free_hinges`].
    pub fn model(&self, structure: &Structure) -> AnyModel {
        Ok(match self {
            Self::FourLinks(law) => structure.model(*law)?,
            Self::FreeHinges(free) => Box::new(free.model(structure)?),
            Self::ElasticJoints(joints) => Box::new(joints.model(structure)?),
        })
    }

    /// Makes models of a structure with other stiffness and contact, and one with rigid joints; empty unless joints are elastic.
    ///
    /// # Errors
    /// As [`Motion::model`].
    pub fn variations(&self, structure: &Structure) -> Result<Vec<Variation>, ModelError> {
        let Self::ElasticJoints(joints) = self else {
            return Ok(Vec::new());
        };
        let mut variations = joints.model(structure)?.variations();
        let rigid = FreeTable {
            options: RowOptions {
                friction_coefficient: joints.friction_coefficient,
                ..RowOptions::default()
            },
            supports: joints.supports,
        };
        variations.push(Variation {
            name: "rigid joints (free hinges)".to_owned(),
            model: match rigid.model(structure) {
                Ok(rigid) => Ok(Box::new(rigid)),
                Err(error) => Err(error.to_string()),
            },
        });
        Ok(variations)
    }

    /// Makes the model of a structure for a study of many cases: see [`FreeHinges::for_many_cases`](crate::FreeHinges::for_many_cases) and
    /// [`ElasticJoints::for_many_cases`](crate::ElasticJoints::for_many_cases).
    ///
    /// # Errors
    /// As [`Motion::model`].
    pub fn model_for_many_cases(&self, structure: &Structure) -> AnyModel {
        match self {
            Self::FourLinks(_) => self.model(structure),
            Self::ElasticJoints(joints) => Ok(Box::new(joints.model(structure)?.for_many_cases())),
            Self::FreeHinges(free) => Ok(Box::new(free.model(structure)?.for_many_cases())),
        }
    }

    /// Returns the impact law of four links; the theoretical law for models without four links.
    pub fn impact(&self) -> ImpactLaw {
        match self {
            Self::FourLinks(law) => *law,
            Self::FreeHinges(_) | Self::ElasticJoints(_) => ImpactModel::MaxRestitution.into(),
        }
    }

    /// Returns Coulomb's coefficient of friction; `None` if joints cannot slip.
    pub const fn friction_coefficient(&self) -> Option<f64> {
        match self {
            Self::FourLinks(_) => None,
            Self::FreeHinges(free) => free.options.friction_coefficient,
            Self::ElasticJoints(joints) => joints.friction_coefficient,
        }
    }

    /// Returns the longest step of the motion of a structure, in seconds; `None` if a tolerance determines the steps, or if the structure cannot
    /// stand.
    pub(super) fn longest_step_s(&self, structure: &Structure, request: &Request) -> Option<f64> {
        match self {
            Self::FourLinks(_) => None,
            Self::FreeHinges(free) => Some(free.model(structure).ok()?.longest_step_s(request)),
            Self::ElasticJoints(joints) => joints.longest_step_s(structure),
        }
    }

    /// Rejects options that do not fit a structure. `until` is gravity in m/s2 and the end of the history in s, if they are known.
    pub(super) fn check(
        &self,
        table: &mut Table<'_>,
        structure: &Structure,
        until: Option<(f64, f64)>,
    ) -> ReadResult<()> {
        if let Some(movements) = self.supports() {
            supports::check(table, structure, movements)?;
        }
        let coefficient = self.friction_coefficient();
        if let Some(coefficient) = coefficient {
            free_hinges::carries(structure, coefficient).map_err(|wrong| {
                table.wrong_in(&[self.table_name()], "friction_coefficient", wrong)
            })?;
        }
        match self {
            Self::FreeHinges(free) if self.supports().is_some() && coefficient.is_some() => {
                free_hinges::holds(table, structure, free)
            }
            Self::ElasticJoints(joints) => {
                until.map_or(Ok(()), |until| joints.check(table, structure, until))
            }
            Self::FourLinks(_) | Self::FreeHinges(_) => Ok(()),
        }
    }

    /// Returns the movements of the supports before time 0; `None` without movements.
    pub fn supports(&self) -> Option<Movements> {
        let supports = match self {
            Self::FourLinks(_) => return None,
            Self::FreeHinges(free) => free.supports,
            Self::ElasticJoints(joints) => joints.supports,
        };
        (!supports.is_none()).then_some(supports)
    }

    /// Returns the compressive strength of joints that may crush, in MPa; otherwise `None`.
    pub const fn compressive_strength_mpa(&self) -> Option<f64> {
        match self {
            Self::FourLinks(_) | Self::FreeHinges(_) => None,
            Self::ElasticJoints(joints) => joints.compressive_strength_mpa,
        }
    }

    /// Returns the name of the scenario table of the model.
    pub const fn table_name(&self) -> &'static str {
        self.hinges().model().table
    }

    /// Returns the contents of the scenario table of the model.
    pub(super) fn table(&self) -> Value {
        match self {
            Self::FourLinks(law) => impact::to_json(law),
            Self::FreeHinges(free) => json!(free.options),
            Self::ElasticJoints(joints) => json!(joints),
        }
    }
}

/// Relations between the tables of different models of motion.
const ALONE: &[Relation<'_>] = &[
    Excludes("elastic_joints", "free_hinges", ONE_MODEL),
    Excludes("elastic_joints", "impact", ELASTIC_IMPACT),
    Excludes("free_hinges", "impact", FREE_IMPACT),
];
const ONE_MODEL: &str =
    "cannot be combined with [elastic_joints]; leave one out, or choose the model of motion";
const ELASTIC_IMPACT: &str =
    "cannot be combined with [elastic_joints], which have no impacts; leave one out";
const FREE_IMPACT: &str =
    "cannot be combined with [free_hinges], whose impacts follow from the blocks; leave one out";

/// Returns true if the structure needs a model with joints: it has drums, or moved springings.
fn needs_joints(table: &Table<'_>) -> bool {
    table.gives("supports") || DRUM_KEYS.iter().any(|key| table.gives_in("column", key))
}

/// The tables of a scenario that concern its model of motion.
pub(super) struct Tables {
    pub(super) hinges: Hinges,
    /// True if the user chose the model, so that tables of other models are ignored.
    is_set: bool,
    free_hinges: ReadResult<Option<RowOptions>>,
    elastic_joints: ReadResult<Option<ElasticTable>>,
    supports: ReadResult<Option<Movements>>,
}

impl Tables {
    /// Reads the tables of rows of blocks. They choose the model unless it is `set`. In static analysis drums and moved springings need no
    /// table; their model is free hinges.
    pub(super) fn read(table: &mut Table<'_>, set: Option<Hinges>, statics: bool) -> Self {
        let free_hinges = table.given_table("free_hinges", free_hinges::read);
        let elastic_joints = table.given_table("elastic_joints", ElasticTable::read);
        let supports = table.given_table("supports", supports::read);
        let chosen = if table.gives_table("elastic_joints") {
            Hinges::Elastic
        } else if table.gives_table("free_hinges") || (statics && needs_joints(table)) {
            Hinges::Free
        } else {
            Hinges::Four
        };
        Self {
            hinges: set.unwrap_or(chosen),
            is_set: set.is_some(),
            free_hinges,
            elastic_joints,
            supports,
        }
    }

    /// Reads the impact law. Returns the model, and true if the model ignores an `[impact]` of the text.
    pub(super) fn complete(self, table: &mut Table<'_>) -> ReadResult<(Motion, bool)> {
        let law = table.table_or_defaults("impact", impact::read);
        if !self.is_set {
            table.relate(ALONE)?;
        }
        let (law, free_hinges, elastic_joints) = (law?, self.free_hinges?, self.elastic_joints?);
        let supports = self.supports?;
        let follow = self.hinges.has_joints();
        let wrong = "needs joints that follow: four links start undeformed; choose [free_hinges] or [elastic_joints], or leave it out";
        table.refuse(supports.is_some() && !follow, "supports", wrong)?;
        let supports = supports.unwrap_or_default();
        let options = free_hinges.unwrap_or_default();
        let motion = match (self.hinges, elastic_joints) {
            (Hinges::Four, _) => Motion::FourLinks(law),
            (Hinges::Free, _) => Motion::FreeHinges(FreeTable { options, supports }),
            (Hinges::Elastic, Some(joints)) => {
                Motion::ElasticJoints(ElasticTable { supports, ..joints })
            }
            (Hinges::Elastic, None) => {
                return Err(table.wrong_itself(
                    "lacks [elastic_joints] with a stiffness: give `normal_stiffness_gpa_m` there; \
                     docs/elastic-joints.md explains how to choose",
                ));
            }
        };
        Ok((motion, law != motion.impact()))
    }
}
