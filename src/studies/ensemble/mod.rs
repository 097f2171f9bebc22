//! Studies of the samples of a scenario with uncertain numbers.
//!
//! The first case of such a study is the scenario itself; each other case is a sample of [`Uncertain`]. The answer of a case is its history
//! (`uncertain_run`), the first factor that overturns it (`uncertain_threshold`), or the intensity of each record that overturns it
//! (`uncertain_suite`). Cases, shares and influences are common to these studies. The cases of a map of samples (`uncertain_map`) are cells.

mod influence;
mod page;
mod report;
mod samples;
mod sensitivity;
pub(super) mod uncertain_map;
pub(super) mod uncertain_run;
pub(super) mod uncertain_suite;
pub(super) mod uncertain_threshold;

pub use self::samples::{SampleRow, Samples};
pub use self::sensitivity::{sensitivities, total_indices};
pub use self::uncertain_map::{CellsOfSamples, UncertainMapSummary};
pub use self::uncertain_run::{Histories, HistoryAnswer, UncertainRunSummary};
pub use self::uncertain_suite::UncertainSuiteSummary;
pub use self::uncertain_threshold::UncertainThresholdSummary;
pub use super::ending::NoAnswer;
use crate::scenario::{Scenario, Uncertain};

/// The cases of a study of samples: the scenario itself, and then its samples.
#[derive(Clone, Copy, Debug)]
struct SampleCases<'a> {
    scenario: &'a Scenario,
    uncertain: &'a Uncertain,
}

impl<'a> SampleCases<'a> {
    /// Takes the samples of a scenario, or returns the error that it has no table `[uncertain]`.
    fn of(scenario: &'a Scenario) -> Result<Self, String> {
        let uncertain = scenario.uncertain.as_ref().ok_or(
            "the scenario has no [uncertain]: give it a table such as\n\n\
             [uncertain]\n\
             samples = 100\n\
             \"arch.thickness_ratio\" = { deviation = 0.003 }",
        )?;
        Ok(Self {
            scenario,
            uncertain,
        })
    }

    fn count(self) -> usize {
        1 + self.uncertain.cases()
    }

    /// Returns the values of a case; none for the scenario itself.
    fn values(self, case: usize) -> Vec<f64> {
        let sample = case.checked_sub(1);
        sample.map_or(Vec::new(), |sample| self.uncertain.values(sample))
    }

    /// Makes the scenario of a case, or returns the reason why its values give none.
    fn scenario_of(self, case: usize) -> Result<Scenario, String> {
        match case {
            0 => Ok(self.scenario.clone()),
            _ => self.uncertain.scenario(self.scenario, &self.values(case)),
        }
    }

    /// Computes the answers of cases. The second argument of `answer` is true for the scenario itself, whose answer may be more accurate.
    fn rows<A>(
        self,
        cases: &[usize],
        answer: impl Fn(&Scenario, bool) -> Result<A, NoAnswer>,
    ) -> Vec<SampleRow<A>> {
        let row = |case: &usize| {
            let scenario = self.scenario_of(*case).map_err(NoAnswer::Invalid);
            SampleRow {
                values: self.values(*case),
                answer: scenario.and_then(|scenario| answer(&scenario, *case == 0)),
            }
        };
        cases.iter().map(row).collect()
    }
}
