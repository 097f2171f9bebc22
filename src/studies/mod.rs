//! Studies: the report of one history, or the evaluation of many together.
//!
//! A [study](runner::Study) is a list of cases. Each case depends only on its definition, so the cases can be
//! computed in any order, by any number of threads, on several machines, and resumed later. The
//! [runner](runner::Runner) computes them in memory, or in [files](part) that can be resumed and merged. The result
//! of a case is a row, which stays a typed value from the computation to the last file.
//!
//! - [`run`]: one history, with all its reports;
//! - [`map`]: overturning or survival under pulses, over two quantities;
//! - [`threshold`]: the ranges of factors by which a ground motion overturns the structure, with the safe gaps between them, and the lowest
//!   overturning factor [along](threshold::along) a range of values of one key;
//! - [`suite`]: overturning under the records of a suite at several levels, and the [`fragility`](suite::fragility) curve;
//! - [`survival`](threshold::survival): a brief report of the strengths of a motion that a structure survives;
//! - [`capacity`]: static capacity curves, without a history;
//! - [`spread`]: the movement of a springing at which the arch collapses, without a history;
//! - [`verify`]: a check of local mechanisms by the Circolare 7/2019, with a printed page.

pub mod capacity;
pub mod catalogue;
pub mod ending;
pub mod ensemble;
pub mod impact;
pub mod limit;
pub mod map;
mod outcome_colors;
pub mod part;
pub mod peaks;
pub mod pictures;
pub mod quotable;
pub mod record;
mod remarks;
pub mod results;
pub mod run;
pub mod runner;
pub mod spread;
pub mod statistics;
pub mod suite;
pub mod threshold;
pub mod verify;

use ending::{Ending, NoAnswer, NoHistory, Verdict};
use quotable::ModelAnswer;
use remarks::{CaseSummary, ModelCheck, OutcomeCounts, Remark, Remarks, no_verdict};
use results::{ReportedStudy, Results, StudyError, Style};
use runner::{Progress, Runner, RunnerError, Study, Task, Watch};
use threshold::{rounded, rounded_down};
