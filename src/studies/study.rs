//! The trait of studies of many cases.

use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

use super::part::{Header, ROW_FORMAT, Shard};
use super::results::{Results, Style};
use crate::output::OutputError;
use crate::scenario::Scenario;

/// A study: many cases, each a function of its index alone. So the cases can be computed in any order, by any number of threads, on several
/// machines.
pub trait Study: Sync {
    /// The result of a case. A failed case also has a row; the row holds the reason.
    type Row: Serialize + DeserializeOwned + Send;

    /// Name of the study, in part files and in their names.
    const NAME: &'static str;

    /// Names of all files that its results may have, the seal last.
    const FILES: &'static [&'static str];

    /// Returns the scenario of the cases; `None` for a study without a scenario.
    fn base(&self) -> Option<&Scenario> {
        None
    }

    /// Returns the scenario as TOML with every default filled in. Apart from options and inputs, the rows depend only on the scenario.
    fn scenario(&self) -> String {
        self.base().map_or(String::new(), Scenario::to_toml)
    }

    /// Returns the options of the study, null without options. The rows depend on them.
    fn options(&self) -> Value {
        Value::Null
    }

    /// Returns the other input on which the rows depend: name and checksum of each file that the scenario names, separated by a space.
    fn inputs(&self) -> Vec<String> {
        self.base().map_or(Vec::new(), Scenario::record_checksums)
    }

    /// Returns the number of cases.
    fn count(&self) -> usize;

    /// Returns the family of a case; `None` if the case is computed alone. Cases of one family are computed faster together.
    fn family(&self, _index: usize) -> Option<usize> {
        None
    }

    /// Computes the rows of some cases of one family, in their order; their indices are below [`Study::count`]. No row depends on the other
    /// cases.
    fn rows(&self, indices: &[usize]) -> Vec<Self::Row>;

    /// Makes the report and the other files of the rows of all cases.
    ///
    /// # Errors
    /// When a value is not finite.
    fn results(&self, rows: Vec<Self::Row>, style: Style) -> Result<Results, OutputError>;
}

impl Header {
    /// Returns the header for a shard of a study, with the version of this program.
    pub fn new<S: Study>(study: &S, shard: Shard) -> Self {
        Self {
            program: env!("CARGO_PKG_NAME").to_owned(),
            row_format: ROW_FORMAT,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            study: S::NAME.to_owned(),
            cases: study.count(),
            shard,
            scenario: study.scenario(),
            options: study.options(),
            inputs: study.inputs(),
        }
    }
}
