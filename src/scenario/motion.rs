//! The model of motion: which tables it has, and what it makes of a structure.

use serde_json::{Value, json};

use super::elastic_joints::ElasticTable;
use super::simulation::Simulation;
use super::structure::{ModelError, Structure};
use super::table::{Reading, Table};
use super::{free_hinges, impact};
use crate::dynamics::free_hinges::RowOptions;
use crate::dynamics::model::{Model, Request};
use crate::dynamics::variation::Variation;
use crate::mechanics::four_link::impact::{ImpactLaw, ImpactModel};

named! {
    /// A model of motion.
    pub enum Hinges {
        /// Mechanisms of one degree of freedom that follow one another: four links, or Housner's column.
        Four = "four",
        /// A row of blocks whose joints open and shut anywhere.
        Free = "free",
        /// A row of blocks whose joints give way.
        Elastic = "elastic",
    }
}

impl Hinges {
    /// Whether it moves a row of blocks at its joints.
    #[must_use]
    pub const fn has_joints(self) -> bool {
        match self {
            Self::Four => false,
            Self::Free | Self::Elastic => true,
        }
    }
}

/// A model of motion with its options.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Motion {
    /// [`Hinges::Four`], and what happens when hinges close: `[impact]`.
    FourLinks(ImpactLaw),
    /// [`Hinges::Free`]: `[free_hinges]`.
    FreeHinges(RowOptions),
    /// [`Hinges::Elastic`]: `[elastic_joints]`.
    ElasticJoints(ElasticTable),
}

impl Motion {
    /// Which model it is.
    #[must_use]
    pub const fn hinges(&self) -> Hinges {
        match self {
            Self::FourLinks(_) => Hinges::Four,
            Self::FreeHinges(_) => Hinges::Free,
            Self::ElasticJoints(_) => Hinges::Elastic,
        }
    }

    /// Whether its models compute several motions at once: [`Model::is_faster_together`].
    #[must_use]
    pub const fn is_faster_together(&self) -> bool {
        matches!(self, Self::ElasticJoints(_))
    }

    /// Its name for people.
    #[must_use]
    pub const fn words(&self) -> &'static str {
        match self {
            Self::FourLinks(_) => "four links",
            Self::FreeHinges(_) => "free hinges",
            Self::ElasticJoints(_) => "elastic joints",
        }
    }

    /// The name in results of the model of a structure.
    pub(super) const fn name(&self, structure: &Structure) -> &'static str {
        match self {
            Self::FreeHinges(_) => "free_hinges",
            Self::ElasticJoints(_) => "elastic_joints",
            Self::FourLinks(_) if structure.thrusts() => "four_links",
            Self::FourLinks(_) => "column",
        }
    }

    /// The model of a structure.
    ///
    /// # Errors
    /// As [`Structure::model`] or [`Structure::free_hinges`].
    pub fn model(&self, structure: &Structure) -> Result<Box<dyn Model>, ModelError> {
        Ok(match self {
            Self::FourLinks(law) => structure.model(*law)?,
            Self::FreeHinges(options) => Box::new(structure.free_hinges(*options)?),
            Self::ElasticJoints(joints) => Box::new(joints.model(structure)?),
        })
    }

    /// The structure with other properties that are as likely as its own; with elastic joints, also with rigid ones.
    ///
    /// # Errors
    /// As [`Motion::model`].
    pub fn variations(&self, structure: &Structure) -> Result<Vec<Variation>, ModelError> {
        let Self::ElasticJoints(joints) = self else {
            return Ok(Vec::new());
        };
        let mut variations = joints.model(structure)?.variations();
        let rigid = structure.free_hinges(RowOptions {
            friction_coefficient: joints.friction_coefficient,
            ..RowOptions::default()
        });
        variations.push(Variation {
            name: "rigid joints (free hinges)".to_owned(),
            model: match rigid {
                Ok(rigid) => Ok(Box::new(rigid)),
                Err(error) => Err(error.to_string()),
            },
        });
        Ok(variations)
    }

    /// The same for a study of many cases: see [`FreeHinges::for_many_cases`](crate::FreeHinges::for_many_cases).
    ///
    /// # Errors
    /// As [`Motion::model`].
    pub fn model_for_many_cases(
        &self,
        structure: &Structure,
    ) -> Result<Box<dyn Model>, ModelError> {
        match self {
            Self::FourLinks(_) | Self::ElasticJoints(_) => self.model(structure),
            Self::FreeHinges(options) => {
                let row = structure.free_hinges(*options)?;
                Ok(Box::new(row.for_many_cases()))
            }
        }
    }

    /// What happens when the hinges of four links close, also where the structure moves otherwise: then as in theory.
    #[must_use]
    pub fn impact(&self) -> ImpactLaw {
        match self {
            Self::FourLinks(law) => *law,
            Self::FreeHinges(_) | Self::ElasticJoints(_) => ImpactModel::MaxRestitution.into(),
        }
    }

    /// Coulomb's coefficient of friction of joints that slip; `None` where none does.
    #[must_use]
    pub const fn friction_coefficient(&self) -> Option<f64> {
        match self {
            Self::FourLinks(_) => None,
            Self::FreeHinges(options) => options.friction_coefficient,
            Self::ElasticJoints(joints) => joints.friction_coefficient,
        }
    }

    /// The longest step of a motion of a structure, in seconds; `None` where steps follow from a tolerance, or where it does not stand.
    pub(super) fn longest_step_s(&self, structure: &Structure, request: &Request) -> Option<f64> {
        match self {
            Self::FourLinks(_) => None,
            Self::FreeHinges(options) => {
                let model = structure.free_hinges(*options).ok()?;
                Some(model.longest_step_s(request))
            }
            Self::ElasticJoints(joints) => Some(joints.model(structure).ok()?.longest_step_s()),
        }
    }

    /// Refuses options that do not go with a structure.
    pub(super) fn check(
        &self,
        table: &mut Table<'_>,
        structure: &Structure,
        simulation: Option<&Simulation>,
    ) -> Reading<()> {
        match self {
            Self::FourLinks(_) => Ok(()),
            Self::FreeHinges(options) => free_hinges::carries(
                table,
                "free_hinges",
                structure,
                options.friction_coefficient,
            ),
            Self::ElasticJoints(joints) => {
                let coefficient = joints.friction_coefficient;
                free_hinges::carries(table, "elastic_joints", structure, coefficient)?;
                simulation.map_or(Ok(()), |simulation| {
                    joints.check(table, structure, simulation)
                })
            }
        }
    }

    /// The compressive strength of joints that crush, in MPa; `None` where none does.
    #[must_use]
    pub const fn compressive_strength_mpa(&self) -> Option<f64> {
        match self {
            Self::FourLinks(_) | Self::FreeHinges(_) => None,
            Self::ElasticJoints(joints) => joints.compressive_strength_mpa,
        }
    }

    /// The key of its table.
    #[must_use]
    pub const fn table_name(&self) -> &'static str {
        match self {
            Self::FourLinks(_) => "impact",
            Self::FreeHinges(_) => "free_hinges",
            Self::ElasticJoints(_) => "elastic_joints",
        }
    }

    /// Its table.
    pub(super) fn table(&self) -> Value {
        match self {
            Self::FourLinks(law) => impact::to_json(law),
            Self::FreeHinges(options) => json!(options),
            Self::ElasticJoints(joints) => json!(joints),
        }
    }
}

/// What a scenario says of its model of motion.
pub(super) struct Tables {
    pub(super) hinges: Hinges,
    asked: bool,
    free_hinges: Reading<Option<RowOptions>>,
    elastic_joints: Reading<Option<ElasticTable>>,
}

impl Tables {
    /// Reads which model it is, unless that is `asked` for, and the tables of rows.
    pub(super) fn read(table: &mut Table<'_>, asked: Option<Hinges>) -> Self {
        let free_hinges = table.table("free_hinges", free_hinges::read);
        let elastic_joints = table.table("elastic_joints", ElasticTable::read);
        let chosen = if table.gives_table("elastic_joints") {
            Hinges::Elastic
        } else if table.gives_table("free_hinges") {
            Hinges::Free
        } else {
            Hinges::Four
        };
        Self {
            hinges: asked.unwrap_or(chosen),
            asked: asked.is_some(),
            free_hinges,
            elastic_joints,
        }
    }

    /// Reads what happens at impacts. Returns the model, and whether there is an `[impact]` that does not count.
    pub(super) fn complete(self, table: &mut Table<'_>) -> Reading<(Motion, bool)> {
        let law = table.table_or_defaults("impact", impact::read);
        let (elastic, free) = (table.gives("elastic_joints"), table.gives("free_hinges"));
        if !self.asked && elastic && free {
            let wrong =
                "cannot be combined with [elastic_joints]; leave one out, or choose with --hinges";
            return Err(table.wrong("free_hinges", wrong));
        }
        if !self.asked && (elastic || free) && table.gives("impact") {
            let wrong = if elastic {
                "cannot be combined with [elastic_joints], which have no impacts; leave one out"
            } else {
                "cannot be combined with [free_hinges], whose impacts follow from the blocks; leave one out"
            };
            return Err(table.wrong("impact", wrong));
        }
        let (law, free_hinges, elastic_joints) = (law?, self.free_hinges?, self.elastic_joints?);
        let motion = match self.hinges {
            Hinges::Four => Motion::FourLinks(law),
            Hinges::Free => Motion::FreeHinges(free_hinges.unwrap_or_default()),
            Hinges::Elastic => match elastic_joints {
                Some(joints) => Motion::ElasticJoints(joints),
                None => {
                    return Err(table.wrong_itself(
                        "lacks [elastic_joints] with a stiffness: give `normal_stiffness_gpa_m` there; \
                         docs/elastic-joints.md tells how to choose",
                    ));
                }
            },
        };
        Ok((motion, law != motion.impact()))
    }
}
