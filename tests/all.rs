//! All integration tests, as one program: shared code is compiled once, and the library is linked once.
//! `cargo test --test all studies::limit::` runs the tests of one file.
#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]
#![allow(clippy::disallowed_methods, reason = "tests compare with tolerances")]

mod common;
mod mechanics;
mod motion;
mod pages;
mod program;
mod scenario;
mod studies;

#[test]
fn every_file_of_tests_is_compiled() {
    let tests = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    let names = common::program::names;
    for folder in names(&tests).iter().filter(|name| !name.contains('.')) {
        let module = tests.join(folder).join("mod.rs");
        let own = std::fs::read_to_string(module).unwrap_or_default();
        for name in names(&tests.join(folder)) {
            if let Some(name) = name.strip_suffix(".rs").filter(|name| *name != "mod") {
                assert!(
                    own.contains(&format!("mod {name};")),
                    "tests/{folder}/{name}.rs is not in tests/{folder}/mod.rs"
                );
            }
        }
    }
}
