//! The reader of AT2 files.
#![no_main]

mod common;

use archrock_records::{Format, Layout};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|contents: &[u8]| common::check(&Layout::new(Format::AT2), contents));
