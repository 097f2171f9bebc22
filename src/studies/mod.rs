//! Studies: many histories, and what they say together.
//!
//! A [study](runner::Study) is a list of cases, and each case depends on nothing but what defines it; so cases may be
//! computed in any order, by any number of threads, on several machines, and today or tomorrow. The
//! [runner](runner::Runner) does so, in memory or in [files](part) that can be resumed and merged. What is known of
//! a case is a row: a value from the computation to the last file.
//!
//! - [`map`]: which pulses overturn, over two quantities; [`boundary`]: from where on they do so without impact;
//! - [`spectrum`]: how strong a pulse must be, over the size of a structure;
//! - [`threshold`]: by which factors a ground motion overturns, in bands with safe gaps between them;
//! - [`suite`]: what records overturn, at several levels, and the [`fragility`] that this makes;
//! - [`survey`]: arches of many shapes compared, without a history.

pub mod boundary;
pub mod ending;
pub mod fragility;
mod impact_free;
pub mod map;
pub mod part;
pub mod runner;
pub mod spectrum;
pub mod suite;
pub mod survey;
pub mod threshold;
