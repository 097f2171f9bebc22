//! Studies: the report of one history, or the evaluation of many together.
//!
//! A [study](runner::Study) is a list of cases. Each case depends only on its definition, so the cases can be
//! computed in any order, by any number of threads, on several machines, and resumed later. The
//! [runner](runner::Runner) computes them in memory, or in [files](part) that can be resumed and merged. The result
//! of a case is a row, which stays a typed value from the computation to the last file.
//!
//! - [`run`]: one history, with all its reports;
//! - [`map`]: which pulses overturn, over two quantities;
//! - [`threshold`]: by which factors a ground motion overturns, in bands with safe gaps between them; and the first of them
//!   [along](threshold::along) a range of values of one key;
//! - [`suite`]: which records overturn, at several levels, and their [`fragility`](suite::fragility) curve;
//! - [`survival`](threshold::survival): the strengths of a motion that a structure survives, in brief;
//! - [`capacity`]: capacity curves, without a history;
//! - [`spread`]: the movement of a springing at which the arch falls, without a history;
//! - [`verify`]: a check of local mechanisms by the Circolare 7/2019, with its own numbers, words and page.

pub mod capacity;
pub mod catalogue;
pub mod ending;
pub mod ensemble;
pub mod impact;
pub mod kept;
mod kind;
pub mod limit;
pub mod map;
pub mod part;
pub mod peaks;
pub mod pictures;
mod remarks;
pub mod results;
pub mod run;
pub mod runner;
pub mod spread;
pub mod statistics;
pub mod suite;
pub mod threshold;
pub mod verify;
