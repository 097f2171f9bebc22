//! `run --point`: displacements of points of blocks, with every model of motion.

use std::fs;
use std::path::Path;

use nalgebra::{Rotation2, Vector2};

use crate::common::program::{printed, refused};
use crate::common::results::{Table, data_of, summary, texts};

const ARCH: &str = "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 180.0\nvoussoirs = 7\n\
                    [ground.rectangular]\namplitude_g = -0.27\nduration_s = 0.25\n[simulation]\nduration_s = 1.0\n";
const COLUMN: &str = "[column]\nheight_m = 4.0\nwidth_m = 0.8\n[ground.rectangular]\namplitude_g = -0.3\nduration_s = 0.3\n\
                      [simulation]\nduration_s = 2.0\n";
const ELASTIC: &str = "[elastic_joints]\nnormal_stiffness_gpa_m = 10.0\n";

/// Runs a scenario into the folder `o` with points and options; returns its table of samples and its words.
fn run(folder: &Path, scenario: &str, points: &[&str], options: &[&str]) -> (Table, String) {
    fs::write(folder.join("s.toml"), scenario).unwrap();
    let mut arguments = vec!["run", "s.toml", "--out", "o", "--no-report"];
    for point in points {
        arguments.extend(["--point", point]);
    }
    let said = printed(folder, &[&arguments, options].concat());
    (Table::read(folder.join("o/rotations.csv")), said)
}

/// Housner's block turns about its toes: the middle of its top moves accordingly, to rounding.
#[test]
fn the_top_of_a_column_turns_about_its_toes() {
    let folder = tempfile::tempdir().unwrap();
    let (table, said) = run(folder.path(), COLUMN, &["0,4"], &[]);
    let top = Vector2::new(0.0, 4.0);
    let mut peak_m: f64 = 0.0;
    for row in &table.rows {
        let rotation_rad = row.number("rotation_rad");
        // Clockwise means to the right.
        let toe = Vector2::new(-0.4 * rotation_rad.signum(), 0.0);
        let due_m = toe + Rotation2::new(rotation_rad) * (top - toe) - top;
        let displaced_m = Vector2::new(row.number("point_x_m"), row.number("point_y_m"));
        assert!(
            (displaced_m - due_m).norm() < 1e-12,
            "{displaced_m} {due_m}"
        );
        peak_m = peak_m.max(due_m.x.abs());
    }
    assert!(peak_m > 0.01);
    let of_summary = summary(&folder.path().join("o"))["points"][0]["peak_x_m"]
        .as_f64()
        .unwrap();
    // The summary has the largest displacement of all steps, not of the rows alone.
    let between_m = of_summary.abs() - peak_m;
    assert!((-1e-12..1e-4 * peak_m).contains(&between_m), "{between_m}");
    let words = format!(
        "the point 0,4 moves by up to {:.3} mm",
        1e3 * of_summary.abs()
    );
    assert!(said.contains(&words), "{said}");
}

/// Largest displacements and the required friction are those of all steps: they hardly depend on the output step. A displacement that stays
/// constant has the time at which it is reached.
#[test]
fn peaks_do_not_depend_on_the_output_step() {
    let folder = tempfile::tempdir().unwrap();
    let elastic = format!("{ELASTIC}damping_time_s = 1e-3\n");
    for (scenario, least) in [
        (COLUMN.to_owned(), 0.999),
        (ARCH.to_owned(), 0.999),
        (format!("{ARCH}[free_hinges]\n"), 0.93),
        (format!("{COLUMN}{elastic}"), 0.93),
    ] {
        let results = ["0.5", "0.005"].map(|step_s| {
            let set = format!("simulation.output_step_s={step_s}");
            let place = if scenario.starts_with(ARCH) {
                "0,5"
            } else {
                "0,4"
            };
            let options = ["--set", &set, "--no-repeat"];
            let is_row =
                scenario.contains("[free_hinges]") || scenario.contains("[elastic_joints]");
            let given = &options[..2 + usize::from(is_row)];
            run(folder.path(), &scenario, &[place], given);
            let told = summary(&folder.path().join("o"));
            let lasting = told["lasting_friction_demand"].as_f64();
            let friction = lasting.or(told["largest_friction_demand"].as_f64());
            [
                told["points"][0]["peak_x_m"].as_f64().unwrap().abs(),
                friction.unwrap(),
            ]
        });
        for (rough, fine) in results[0].iter().zip(results[1]) {
            let ratio = rough.min(fine) / rough.max(fine);
            assert!(ratio > least, "{scenario}: {results:?}");
        }
    }
}

/// A point of a block moves with the pose of the block in `poses.csv`, with rigid and with elastic joints; `history.svg` and the
/// page have its curves.
#[test]
fn a_point_of_a_voussoir_moves_with_it() {
    let folder = tempfile::tempdir().unwrap();
    // The crown belongs to block 4 of 7; the other point to block 2, between 26 and 51 degrees from the left.
    let angle = 38_f64.to_radians();
    let other = Vector2::new(-5.1 * angle.cos(), 5.1 * angle.sin());
    let place = format!("{},{}", other.x, other.y);
    for model in ["[free_hinges]\n", ELASTIC] {
        let (table, _) = run(
            folder.path(),
            &format!("{ARCH}{model}"),
            &["0,5.375", &place],
            &["--poses", "--no-repeat"],
        );
        let poses = Table::read(folder.path().join("o/poses.csv"));
        for (row, pose) in table.rows.iter().zip(&poses.rows) {
            for (point, block, at_m) in [(1, 4, Vector2::new(0.0, 5.375)), (2, 2, other)] {
                let [x, y] = ["x", "y"].map(|axis| pose.number(&format!("{axis}_{block}_m")));
                let turn = Rotation2::new(pose.number(&format!("rotation_{block}_rad")));
                let due_m = Vector2::new(x, y) + turn * at_m - at_m;
                let [x, y] = ["x", "y"].map(|axis| row.number(&format!("point_{point}_{axis}_m")));
                assert!((Vector2::new(x, y) - due_m).norm() < 1e-12);
            }
        }
        let picture = fs::read_to_string(folder.path().join("o/history.svg")).unwrap();
        let picture = roxmltree::Document::parse(&picture).unwrap();
        let texts = texts(&picture);
        assert!(
            texts
                .iter()
                .any(|text| text == "point 0,5.375, to the right"),
            "{texts:?}"
        );
    }
    let output = printed(
        folder.path(),
        &[
            "run",
            "s.toml",
            "--out",
            "p",
            "--point",
            "0,5.375",
            "--no-repeat",
        ],
    );
    assert!(
        output.contains("0,5.375") || output.contains("point"),
        "{output}"
    );
    let page = fs::read_to_string(folder.path().join("p/report.html")).unwrap();
    let data = data_of(&page);
    assert_eq!(data["points"][0]["curves"].as_array().unwrap().len(), 2);
    assert_eq!(data["layouts"][0]["point_bodies"][0], 3);
}

/// If the ground moves to the other side, so does the mirrored point, with every model; with free hinges, up to the effect of
/// rounding on the order of landings.
#[test]
fn mirrored_points_have_mirrored_displacements() {
    let folder = tempfile::tempdir().unwrap();
    for model in ["", "[free_hinges]\n", ELASTIC] {
        let scenario = format!("{ARCH}{model}");
        let options: &[&str] = if model.is_empty() {
            &[]
        } else {
            &["--no-repeat"]
        };
        let (right, _) = run(folder.path(), &scenario, &["2,4.6"], options);
        let mirrored = scenario.replace("-0.27", "0.27");
        let (left, _) = run(folder.path(), &mirrored, &["-2,4.6"], options);
        assert_eq!(right.rows.len(), left.rows.len());
        let mut farthest_m: f64 = 0.0;
        for (right, left) in right.rows.iter().zip(&left.rows) {
            let [x, y] =
                ["point_x_m", "point_y_m"].map(|name| (right.number(name), left.number(name)));
            assert!(
                (x.0 + x.1).abs() < 1e-6 && (y.0 - y.1).abs() < 1e-6,
                "{model}: {x:?} {y:?}"
            );
            farthest_m = farthest_m.max(x.0.abs());
        }
        assert!(farthest_m > 1e-3, "{model}: {farthest_m}");
    }
}

#[test]
fn a_point_of_no_block_is_refused_with_the_nearest() {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in [
        ("ring", ARCH.replace("voussoirs = 7\n", "")),
        ("arch", ARCH.to_owned()),
        ("column", COLUMN.to_owned()),
    ] {
        fs::write(folder.path().join(format!("{name}.toml")), text).unwrap();
    }
    for (scenario, point, nearest) in [
        ("ring", "0,6", "of one is 0,5.375;"),
        ("arch", "0,4", "of one is 0,4.62"),
        ("arch", "9,0", "of one is 5.375,0;"),
        ("column", "1,2", "of one is 0.4,2;"),
    ] {
        let file = format!("{scenario}.toml");
        let arguments = ["run", &file, "--out", "o", "--point", point];
        refused(folder.path(), &arguments, &["is in no block", nearest]);
    }
    for point in ["1", "1,2,3", "a,b", "nan,0", "inf,1"] {
        let arguments = ["run", "arch.toml", "--point", point];
        refused(folder.path(), &arguments, &["two coordinates in metres"]);
    }
    let four: Vec<&str> = ["--point", "0,5"].repeat(4);
    let arguments = [&["run", "arch.toml"], &four[..]].concat();
    refused(folder.path(), &arguments, &["at most 3"]);
    assert!(!folder.path().join("o").exists());
}
