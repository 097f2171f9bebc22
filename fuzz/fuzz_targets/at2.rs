//! The reader of AT2 files.
#![no_main]

mod common;

use archrock::scenario::Form;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|contents: &[u8]| common::check(&Form::At2 { unit: None }.into(), contents));
