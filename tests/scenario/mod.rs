//! Scenario files and records: their contents and errors.

mod changes;
mod check_record;
mod corrections;
mod doubtful_records;
mod files;
mod files_in_memory;
mod formats;
mod initial;
pub mod keys;
mod records;
mod set;
mod span;
mod suite_records;
mod unknown_records;
mod unlikely;
