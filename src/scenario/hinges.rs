//! The models of motion, by name.

named! {
    /// A model of motion.
    pub enum Hinges {
        /// Mechanisms with one degree of freedom, one after another: four links, or Housner's column.
        Four = "four",
        /// A row of blocks whose joints open and shut anywhere.
        Free = "free",
        /// A row of blocks with elastic joints.
        Elastic = "elastic",
    }
}

/// Names and words of a model of motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ModelEntry {
    /// Its name in results; four links of a column are called `column`.
    pub name: &'static str,
    /// The table of the scenario with its options.
    pub table: &'static str,
    /// Its name in sentences.
    pub words: &'static str,
    /// Whether it moves a row of blocks that open at their joints.
    pub has_joints: bool,
    /// Why its outcome is believed if no other model that was run is more trustworthy.
    pub trusted_because: &'static str,
}

/// All models of motion in the order of [`Hinges`]; each is more trustworthy than those before it.
pub const MODELS: [ModelEntry; 3] = [
    ModelEntry {
        name: "four_links",
        table: "impact",
        words: "four links",
        has_joints: false,
        trusted_because: "it is the only one",
    },
    ModelEntry {
        name: "free_hinges",
        table: "free_hinges",
        words: "free hinges",
        has_joints: true,
        trusted_because: "hinges open at any joint",
    },
    ModelEntry {
        name: "elastic_joints",
        table: "elastic_joints",
        words: "elastic joints",
        has_joints: true,
        trusted_because: "the outcome is the same with the other stiffnesses and contact",
    },
];

impl Hinges {
    /// Its entry in the table of models.
    #[must_use]
    pub const fn model(self) -> &'static ModelEntry {
        &MODELS[self as usize]
    }

    /// Whether it moves a row of blocks that open at their joints.
    #[must_use]
    pub const fn has_joints(self) -> bool {
        self.model().has_joints
    }
}
