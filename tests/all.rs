//! All integration tests, as one program: shared code is compiled once, and the library is linked once.
//! Each line here is a file of tests; `cargo test --test all limit::` runs those of one file.
#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

mod browser;
mod common;
mod motions;
mod program;
mod results;

mod capacity;
mod caveats;
mod certain;
mod certificate;
mod check_record;
mod cli;
mod column;
mod column_results;
mod drawing_data;
mod elastic_joint_mechanics;
mod elastic_joints;
mod elastic_joints_run;
mod elastic_joints_studies;
mod energy_balance;
mod equivalent;
mod figures;
mod four_link_rows;
mod fragility;
mod free_hinges;
mod free_hinges_run;
mod free_hinges_studies;
mod ground;
mod history;
mod how_close;
mod impact;
mod impact_of_rows;
mod impulse_line;
mod init;
mod integration;
mod keys;
mod landings;
mod limit;
mod long_work;
mod map;
mod map_accuracy;
mod map_axes;
mod map_page;
mod model;
mod motion;
mod names;
mod one_story;
mod outcomes;
mod pictures;
mod points;
mod properties;
mod readme;
mod records;
mod report;
mod rest;
mod results_folder;
mod robustness;
mod rows;
mod run_input;
mod runner;
mod scenario;
mod set;
mod settled;
mod settling;
mod shapes;
mod sliding;
mod sliding_impacts;
mod span;
mod suite;
mod threshold;
mod threshold_along;
mod thrust;
mod ties;
mod ties_in_motion;
mod tour;
mod two_feet;
mod two_feet_rigid;
mod uncertain;
mod validation;
mod verify;
mod verify_formulas;
mod verify_histories;
mod vertical;

#[test]
fn every_file_of_tests_is_compiled() {
    let here = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    let own = include_str!("all.rs");
    for entry in std::fs::read_dir(here).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        if let Some(name) = name.strip_suffix(".rs").filter(|name| *name != "all") {
            assert!(
                own.contains(&format!("mod {name};")),
                "tests/{name}.rs is not in tests/all.rs"
            );
        }
    }
}
