//! Studies: many histories, and what they say together. Pure functions, no files.
//!
//! A study is a list of cases, and each case depends on nothing but what defines it; so cases may be computed
//! in any order, by any number of threads, on several machines, and today or tomorrow.

pub mod fragility;
pub mod impact_free;
pub mod specimen;
pub mod survey;
