//! Studies: the report of one history, or the evaluation of many together.
//!
//! A [study](Study) is a list of cases. Each case depends only on its definition, so the cases can be
//! computed in any order, by any number of threads, on several machines, and resumed later. The
//! [runner](Runner) computes them in memory, or in [files](PartFile) that can be resumed and merged. The result
//! of a case is a row, which stays a typed value from the computation to the last file.
//!
//! - [`run`]: one history, with all its reports;
//! - [`map`]: overturning or survival under pulses, over two quantities;
//! - [`threshold`]: the ranges of factors by which a ground motion overturns the structure, with the safe gaps between them, and the lowest
//!   overturning factor [along](threshold::Along) a range of values of one key;
//! - [`suite`]: overturning under the records of a suite at several levels, and the [fragility](suite::Fragility) curve;
//! - [survival](threshold::Survival): a brief report of the strengths of a motion that a structure survives;
//! - [`capacity()`]: static capacity curves, without a history;
//! - [`spread()`]: the movement of a springing at which the arch collapses, without a history;
//! - [`verify`]: a check of local mechanisms by the Circolare 7/2019, with a printed page.

mod capacity;
mod catalogue;
mod comparison;
pub(crate) mod ending;
pub mod ensemble;
mod error;
mod impact;
mod intervals;
mod limit;
pub mod map;
mod outcome_colors;
mod page;
mod page_cases;
mod page_table;
mod part;
mod peaks;
mod pictures;
mod quotable;
mod record;
mod remarks;
mod report;
mod results;
pub mod run;
mod runner;
mod spread;
mod statistics;
mod study;
pub mod suite;
pub mod threshold;
pub mod verify;

pub use capacity::{CapacityCurveError, CapacitySummary, capacity};
pub use catalogue::{
    CAPACITY, Computation, LIMIT, MAP, Merged, Options, RUN, SPREAD, SUITE, StudyKind, THRESHOLD,
    THRESHOLD_ALONG, UNCERTAIN, UNCERTAIN_MAP, UNCERTAIN_SUITE, UNCERTAIN_THRESHOLD, VERIFY, Work,
    merge,
};
pub use comparison::Comparison;
use ending::NoAnswer;
pub use ending::{Ending, NoHistory, Steps, Verdict, outcome_name};
pub use error::StudyError;
pub use impact::{
    ImpactOptions, ImpactSummary, LinkImpact, chain as impact_chain, chain_result,
    four_links_result,
};
pub use limit::{LimitSummary, LiveAnswer, LiveLimit, PlacedAxle, VehiclePosition, limit};
pub use page::page_of as study_page_of;
pub use part::{
    Header, PartError, PartErrorKind, PartFile, Shard, merge as merge_parts, read_header, rows_in,
};
pub use peaks::{FILES as PEAKS_FILES, PeaksSummary, results as peak_results};
pub use pictures::{impact as draw_impact, limit as draw_limit};
pub use quotable::{ModelAnswer, quote_answers as quoted_in_words};
pub use record::record;
use remarks::{CaseSummary, ModelCheck, OutcomeCounts, Remark, Remarks, no_verdict, one_direction};
pub use report::{Report, Statement, Warnings};
pub use results::{Results, Style, words_of_json};
use runner::Watch;
pub use runner::{Counted, Progress, Runner, RunnerError, SearchStep, Task};
pub use spread::{SpreadSummary, SpringingDirection, spread};
pub use statistics::Share;
pub use study::Study;
use threshold::{format_edge, rounded_down};
