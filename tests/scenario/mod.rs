//! Scenario files and records: what is read, and what is an error.

mod check_record;
mod files;
pub mod keys;
mod records;
mod set;
mod span;
