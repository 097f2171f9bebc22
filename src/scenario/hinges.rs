//! The models of motion, by name.

named! {
    /// A model of motion.
    pub enum Hinges {
        /// One mechanism of one degree of freedom at a time: four links, or Housner's column.
        Four = "four",
        /// A row of rigid blocks whose joints open and close anywhere.
        Free = "free",
        /// A row of blocks with elastic joints.
        Elastic = "elastic",
    }
}

/// Names and properties of a model of motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ModelEntry {
    /// Name of the model in results; four links of a column are named `column`.
    pub name: &'static str,
    /// Scenario table with the options of the model.
    pub table: &'static str,
    /// Name of the model in sentences.
    pub label: &'static str,
    /// True: the structure is a row of blocks with joints. False: it is one mechanism at a time.
    pub has_joints: bool,
    /// True: blocks and joints are rigid. False: joints have a stiffness.
    pub is_rigid: bool,
    /// Message about a table that the model ignores; `None` if it ignores no table.
    pub ignored: Option<&'static str>,
}

/// All models of motion in the order of [`Hinges`], the least trustworthy first.
pub const MODELS: [ModelEntry; 3] = [
    ModelEntry {
        name: "four_links",
        table: "impact",
        label: "four links",
        has_joints: false,
        is_rigid: true,
        ignored: None,
    },
    ModelEntry {
        name: "free_hinges",
        table: "free_hinges",
        label: "free hinges",
        has_joints: true,
        is_rigid: true,
        ignored: Some("[impact] is ignored: with free hinges impacts follow from the blocks"),
    },
    ModelEntry {
        name: "elastic_joints",
        table: "elastic_joints",
        label: "elastic joints",
        has_joints: true,
        is_rigid: false,
        ignored: Some("[impact] is ignored: elastic joints have no impacts"),
    },
];

impl Hinges {
    /// Returns the entry of the model in [`MODELS`].
    pub const fn model(self) -> &'static ModelEntry {
        &MODELS[self as usize]
    }

    /// Returns true for free hinges and elastic joints: see [`ModelEntry::has_joints`].
    pub const fn has_joints(self) -> bool {
        self.model().has_joints
    }
}
