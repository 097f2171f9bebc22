//! The model of motion: which tables it has, and what it makes of a structure.

use serde_json::{Value, json};

use super::structure::{ModelError, Structure};
use super::table::{Reading, Table};
use super::{free_hinges, impact};
use crate::dynamics::free_hinges::RowOptions;
use crate::dynamics::model::{Model, Request};
use crate::mechanics::four_link::impact::{ImpactLaw, ImpactModel};

named! {
    /// A model of motion.
    pub enum Hinges {
        /// Mechanisms of one degree of freedom that follow one another: four links, or Housner's column.
        Four = "four",
        /// A row of blocks whose joints open and shut anywhere.
        Free = "free",
    }
}

impl Hinges {
    /// Whether it moves a row of blocks at its joints.
    #[must_use]
    pub const fn has_joints(self) -> bool {
        match self {
            Self::Four => false,
            Self::Free => true,
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
}

impl Motion {
    /// Which model it is.
    #[must_use]
    pub const fn hinges(&self) -> Hinges {
        match self {
            Self::FourLinks(_) => Hinges::Four,
            Self::FreeHinges(_) => Hinges::Free,
        }
    }

    /// Its name for people.
    #[must_use]
    pub const fn words(&self) -> &'static str {
        match self {
            Self::FourLinks(_) => "four links",
            Self::FreeHinges(_) => "free hinges",
        }
    }

    /// The name in results of the model of a structure.
    pub(super) const fn name(&self, structure: &Structure) -> &'static str {
        match self {
            Self::FreeHinges(_) => "free_hinges",
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
        })
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
            Self::FourLinks(_) => self.model(structure),
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
            Self::FreeHinges(_) => ImpactModel::MaxRestitution.into(),
        }
    }

    /// Coulomb's coefficient of friction of joints that slip; `None` where none does.
    #[must_use]
    pub const fn friction_coefficient(&self) -> Option<f64> {
        match self {
            Self::FourLinks(_) => None,
            Self::FreeHinges(options) => options.friction_coefficient,
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
        }
    }

    /// Refuses options that do not go with a structure.
    pub(super) fn check(&self, table: &mut Table<'_>, structure: &Structure) -> Reading<()> {
        match self {
            Self::FourLinks(_) => Ok(()),
            Self::FreeHinges(options) => free_hinges::carries(table, structure, *options),
        }
    }

    /// Its table, by its key.
    pub(super) fn table(&self) -> (&'static str, Value) {
        match self {
            Self::FourLinks(law) => ("impact", impact::to_json(law)),
            Self::FreeHinges(options) => ("free_hinges", json!(options)),
        }
    }
}

/// What a scenario says of its model of motion.
pub(super) struct Tables {
    pub(super) hinges: Hinges,
    asked: bool,
    free_hinges: Reading<Option<RowOptions>>,
}

impl Tables {
    /// Reads which model it is, unless that is `asked` for, and the tables of rows.
    pub(super) fn read(table: &mut Table<'_>, asked: Option<Hinges>) -> Self {
        let free_hinges = table.table("free_hinges", free_hinges::read);
        let chosen = if table.gives_table("free_hinges") {
            Hinges::Free
        } else {
            Hinges::Four
        };
        Self {
            hinges: asked.unwrap_or(chosen),
            asked: asked.is_some(),
            free_hinges,
        }
    }

    /// Reads what happens at impacts. Returns the model, and whether there is an `[impact]` that does not count.
    pub(super) fn complete(self, table: &mut Table<'_>) -> Reading<(Motion, bool)> {
        let law = table.table_or_defaults("impact", impact::read);
        if !self.asked && table.gives("free_hinges") && table.gives("impact") {
            let wrong = "cannot be combined with [free_hinges], whose impacts follow from the blocks; leave one out";
            return Err(table.wrong("impact", wrong));
        }
        let (law, free_hinges) = (law?, self.free_hinges?);
        let motion = match self.hinges {
            Hinges::Four => Motion::FourLinks(law),
            Hinges::Free => Motion::FreeHinges(free_hinges.unwrap_or_default()),
        };
        Ok((motion, law != motion.impact()))
    }
}
