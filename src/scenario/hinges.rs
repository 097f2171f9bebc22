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

impl Hinges {
    /// Whether it moves a row of blocks that open at their joints.
    #[must_use]
    pub const fn has_joints(self) -> bool {
        match self {
            Self::Four => false,
            Self::Free | Self::Elastic => true,
        }
    }
}
