//! `[initial]`: rates, blows on columns, and errors.

use std::fs;

use archrock::{Scenario, Sway};

use crate::common::parsed;
use crate::common::program::printed;
use crate::common::results::Table;
use serde_json::Value;

const COLUMN: &str = "[column]\nheight_m = 4\nwidth_m = 1\ndepth_m = 2\n";

fn refusal(text: &str) -> String {
    Scenario::parse(text, "s.toml").unwrap_err().to_string()
}

/// `w = J z / I_O` with `I_O = m (height^2 + width^2) / 3` for a rectangle about its corner.
#[test]
fn a_blow_gives_the_rate_of_the_angular_impulse() {
    let inertia_kg_m2 = 2000.0 * 8.0 * (16.0 + 1.0) / 3.0;
    for (height_m, model) in [
        (4.0, ""),
        (2.5, "[free_hinges]\n"),
        (0.1, "[elastic_joints]\nnormal_stiffness_gpa_m = 1\n"),
    ] {
        let text = format!(
            "{COLUMN}{model}[initial]\nsway = 'left'\nimpulse_n_s = 5000\nheight_m = {height_m}\n"
        );
        let scenario = parsed(&text);
        let initial = scenario.request().initial.unwrap();
        let due_rad_s = 5000.0 * height_m / inertia_kg_m2;
        assert!((initial.rate_rad_s / due_rad_s - 1.0).abs() < 1e-12);
        assert_eq!((initial.sway, initial.rotation_rad), (Sway::Left, 0.0));
        let resolved = scenario.to_toml();
        assert!(
            resolved.contains("impulse_n_s = 5000.0") && !resolved.contains("rate_rad_s"),
            "{resolved}"
        );
        assert_eq!(parsed(&resolved), scenario);
    }
    // With an eccentric load each toe has its own moment of inertia.
    for (sway, arm_m) in [("left", 0.2), ("right", 0.8)] {
        let text = format!(
            "{COLUMN}[[load]]\nmass_kg = 1500\nx_m = -0.3\n[initial]\nsway = '{sway}'\nimpulse_n_s = 5000\nheight_m = 3\n"
        );
        let with_load = inertia_kg_m2 + 1500.0 * (arm_m * arm_m + 16.0);
        let rate_rad_s = parsed(&text).initial.unwrap().rate_rad_s;
        assert!(
            (rate_rad_s / (5000.0 * 3.0 / with_load) - 1.0).abs() < 1e-12,
            "{sway}"
        );
    }
    // A taper has another centre of gravity and inertia: that of a trapezium by its parts, a rectangle and two triangles.
    let [bottom, top, height] = [1.0, 0.4, 4.0];
    let tapered = format!(
        "{COLUMN}top_width_m = {top}\n[free_hinges]\n[initial]\nsway = 'right'\nimpulse_n_s = 100\nheight_m = 4\n"
    );
    let strips = 20_000;
    let about_toe = (0..strips).map(|strip| {
        let y = height * (f64::from(strip) + 0.5) / f64::from(strips);
        let width = bottom + (top - bottom) * y / height;
        let mass = 2000.0 * 2.0 * width * height / f64::from(strips);
        mass * (width * width / 12.0 + 0.25 * bottom * bottom + y * y)
    });
    let due_rad_s = 100.0 * 4.0 / about_toe.sum::<f64>();
    let rate_rad_s = parsed(&tapered).initial.unwrap().rate_rad_s;
    assert!(
        (rate_rad_s / due_rad_s - 1.0).abs() < 1e-6,
        "{rate_rad_s} {due_rad_s}"
    );
}

#[test]
fn a_rate_without_rotation_is_read_and_written() {
    let text = format!("{COLUMN}[initial]\nsway = 'right'\nrate_rad_s = 0.2\n");
    let scenario = parsed(&text);
    assert_eq!(scenario.initial.unwrap().rate_rad_s, 0.2);
    assert_eq!(parsed(&scenario.to_toml()), scenario);
    let rotated = text.replace("0.2", "-0.2\nrotation_rad = 0.1");
    assert_eq!(parsed(&rotated).initial.unwrap().rate_rad_s, -0.2);
    let at_rest = rotated.replace("rate_rad_s = -0.2\n", "");
    assert!(!parsed(&at_rest).to_toml().contains("rate_rad_s"));
}

/// The impulse stays while the column varies, and an uncertain impulse is that of a single run.
#[test]
fn samples_keep_the_impulse() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let text = format!(
        "{COLUMN}[initial]\nsway = 'left'\nimpulse_n_s = 9000\nheight_m = 3\n[simulation]\nduration_s = 5\n"
    );
    for (key, from, to) in [
        ("column.height_m", 3.5, 4.5),
        ("initial.impulse_n_s", 5e3, 1e4),
    ] {
        let uncertain =
            format!("[uncertain]\nsamples = 4\n'{key}' = {{ from = {from}, to = {to} }}\n");
        fs::write(path.join("s.toml"), format!("{text}{uncertain}")).unwrap();
        printed(path, &["run", "s.toml"]);
        let samples = Table::read(path.join("results/s/uncertain/samples.csv")).rows;
        fs::write(path.join("s.toml"), &text).unwrap();
        for row in &samples[1..] {
            let set = format!("{key}={}", row[key]);
            let summary = printed(path, &["run", "s.toml", "--format", "json", "--set", &set]);
            let summary: Value = serde_json::from_str(&summary).unwrap();
            let peak_rad = summary["largest_peak_rotation_rad"].as_f64().unwrap();
            assert!((row.number("peak_rotation_rad") / peak_rad - 1.0).abs() < 1e-6);
        }
    }
}

#[test]
fn starts_that_are_not_computed_are_refused() {
    let initial = |keys: &str| format!("{COLUMN}[initial]\nsway = 'right'\n{keys}\n");
    let elastic = "[elastic_joints]\nnormal_stiffness_gpa_m = 1\n";
    for (text, parts) in [
        (initial(""), ["s.toml:5:1", "positive `rate_rad_s`"]),
        (initial("rate_rad_s = -0.1"), ["s.toml:5:1", "starts at rest"]),
        (initial("rate_rad_s = 101"), ["s.toml:7:14", "-100 to 100"]),
        (initial("impulse_n_s = 1"), ["s.toml:7:15", "height_m"]),
        (initial("impulse_n_s = 1\nheight_m = 4.1"), ["s.toml:8:12", "at most 4"]),
        (initial("impulse_n_s = 1e9\nheight_m = 4"), ["s.toml:7:15", "rad/s"]),
        (
            initial("rotation_rad = 0.1\nimpulse_n_s = 1\nheight_m = 4"),
            ["s.toml:8:15", "column at rest"],
        ),
        (
            initial("rate_rad_s = 0.1\nimpulse_n_s = 1\nheight_m = 4"),
            ["s.toml:8:15", "give one of them"],
        ),
        (
            initial("impulse_n_s = 1\nheight_m = 4").replace("depth_m = 2", "drums = 3\n[free_hinges]"),
            ["s.toml:8:15", "one block"],
        ),
        (
            initial("rotation_rad = 0.1\nrate_rad_s = 0.1") + elastic,
            ["s.toml:7:16", "give `rate_rad_s` alone"],
        ),
        (
            initial("rate_rad_s = 0.1") + "[column.back]\nside = 'right'\n",
            ["s.toml:6:8", "points to the wall"],
        ),
        (
            "[arch]\nmean_radius_m = 5\nthickness_ratio = 0.15\nembrace_deg = 157.5\n[initial]\nsway = 'left'\n\
             impulse_n_s = 1\nheight_m = 1\n"
                .to_owned(),
            ["s.toml:7:15", "give `rate_rad_s`"],
        ),
    ] {
        let wrong = refusal(&text);
        assert!(parts.iter().all(|part| wrong.contains(part)), "{text}{wrong}");
    }
    parsed(&(initial("rate_rad_s = 0.1") + elastic));
}
