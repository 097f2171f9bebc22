//! The tables of studies and of the check.

use super::prelude::*;

named! {
    /// A table of a study or of the check. All others describe the structure and its motion.
    pub(crate) enum StudyTable {
        Map = "map",
        Suite = "suite",
        Demand = "demand",
        Verify = "verify",
        Uncertain = "uncertain",
    }
}

impl StudyTable {
    /// Reads this table of a scenario; `None` without it.
    pub(super) fn read<T>(
        self,
        scenario: &mut Table<'_>,
        read: impl Reader<T>,
    ) -> ReadResult<Option<T>> {
        scenario.given_table(self.name(), read)
    }

    /// True for the name of such a table.
    pub(crate) fn is_name(name: &str) -> bool {
        Self::ALL.iter().any(|table| table.name() == name)
    }
}
