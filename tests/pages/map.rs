//! `map.html`: every cell that it shows is compared with the table, in a real browser, and its commands with a run.

use crate::common::browser;
use crate::common::results::{Row, Table, data_of};
use std::fs;
use std::path::Path;
use std::process::Command;

use crate::common::program::{archrock, done, files, stderr};
use archrock::dynamics::MODEL_LIMIT;
use serde_json::{Value, json};

const SCENARIO: &str = "[arch]\nmean_radius_m = 5.0\nthickness_m = 0.75\nembrace_deg = 180.0\n\
                        [ground.one_cosine]\namplitude_g = 0.5\nduration_s = 0.8\n";

/// A map in a folder: returns its page, and the rows of its table.
fn map(folder: &Path, axes: &str, more: &[&str]) -> (String, Vec<Row>) {
    fs::write(
        folder.join("my arch.toml"),
        format!("{SCENARIO}[map]\n{axes}"),
    )
    .unwrap();
    let output = archrock(
        folder,
        &[&["map", "my arch.toml", "--out", "."], more].concat(),
    );
    assert!(output.status.success(), "{}", stderr(&output));
    (
        fs::read_to_string(folder.join("map.html")).unwrap(),
        Table::read(folder.join("map.csv")).rows,
    )
}

/// Runs the page's command, with the values of a row, in a shell; returns its summary.
fn run(folder: &Path, page: &str, row: &Row) -> Value {
    let [x, y] = [0, 1].map(|column| row.number(column));
    let command = data_of(page)["command"].as_str().unwrap().to_owned();
    let filled = command
        .replace("{cell.x}", &x.to_string())
        .replace("{cell.y}", &y.to_string())
        .replace("{1/cell.x}", &(1.0 / x).to_string());
    let multiple = |(before, after): (&str, &str)| {
        let (before, factor) = before.rsplit_once('{').unwrap();
        format!("{before}{}{after}", x * factor.parse::<f64>().unwrap())
    };
    let filled = filled
        .split_once("*cell.x}")
        .map_or(filled.clone(), multiple);
    let own = env!("CARGO_BIN_EXE_archrock");
    let has_joints = filled.contains("[free_hinges]") || filled.contains("[elastic_joints]");
    let repeat = if has_joints { " --no-repeat" } else { "" };
    let run = format!("{own} run - --format json --no-report{repeat}");
    let line = filled.replacen("archrock run -", &run, 1);
    let output = Command::new("sh")
        .arg("-c")
        .arg(&line)
        .current_dir(folder)
        .output()
        .unwrap();
    assert!(output.status.success(), "{line}: {}", stderr(&output));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn commands_run_their_cells() {
    for (axes, more) in [
        (
            "duration_s = [0.3, 0.8]\namplitude_g = [0.1, 0.5, 3.0]\n",
            &[][..],
        ),
        (
            "frequency_hz = [0.8, 4.0]\namplitude_g = [0.5, 3.0]\n",
            &["--hinges", "four"],
        ),
        (
            "pgv_over_pga_s = [0.05, 0.2]\namplitude_g = [0.5, 3.0]\n",
            &[],
        ),
        ("mean_radius_m = [2.0, 20.0]\namplitude_g = [0.5]\n", &[]),
        (
            "thickness_ratio = [0.12, 0.2]\nembrace_deg = [150.0, 180.0]\n",
            &["--set", "title={it's \"mine\"}"],
        ),
        (
            "duration_s = [0.3, 0.8]\nrestitution = [0.5, 0.9]\n",
            &[
                "--set",
                "impact.model=prescribed",
                "--set",
                "impact.restitution=0.7",
            ],
        ),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let (page, rows) = map(folder.path(), axes, more);
        for row in &rows {
            assert_eq!(run(folder.path(), &page, row)["outcome"], row[2], "{row:?}");
        }
    }
}

/// A number of each table varies over a map: each cell is the history that the page's command computes with `--set`. Several scenarios give another
/// key of the same quantity. Tables and summaries have at least nine digits.
#[test]
fn cells_of_every_table_are_runs_with_set() {
    let free = "[free_hinges]\nlongest_step_s = 1e-3\n";
    let elastic = "[elastic_joints]\nlongest_step_s = 2e-5\nnormal_stiffness_gpa_m = 1\n";
    let ring = "[arch]\nmean_radius_m = 5\nthickness_ratio = 0.15\nembrace_deg = 180\n";
    let measured =
        "span_m = 6\nrise_m = 2\nthickness_m = 0.6\nmeasured_at = 'intrados'\nvoussoirs = 9\n";
    let pointed = "[pointed_arch]\nspan_m = 4\nrise_m = 3\nthickness_m = 0.5\nvoussoirs = 8\n";
    let column = "[column]\nheight_m = 4\nwidth_m = 0.8\n";
    for (text, key, values) in [
        (ring.to_owned(), "arch.thickness_m", [0.7, 0.8]),
        (format!("[arch]\n{measured}"), "arch.rise_m", [1.9, 2.1]),
        (
            format!("[basket_arch]\n{measured}"),
            "basket_arch.span_m",
            [6.0, 6.2],
        ),
        (
            format!("{pointed}[piers]\nheight_m = 1\nwidth_m = 1\n{free}"),
            "piers.height_m",
            [0.5, 1.5],
        ),
        (
            format!("{pointed}[fill]\nabove_crown_m = 0.1\ndensity_kg_m3 = 1500\n{free}"),
            "fill.height_m",
            [2.0, 3.5],
        ),
        (
            format!("{pointed}[[load]]\nmass_kg = 100\nx_m = 0.5\n{free}"),
            "load.1.mass_kg",
            [200.0, 500.0],
        ),
        (
            format!("{column}drum_heights_m = [1, 1, 2]\n{free}"),
            "column.drums",
            [1.0, 4.0],
        ),
        (
            format!("{column}drum_heights_m = [2, 2]\n{elastic}"),
            "column.height_m",
            [4.0, 5.0],
        ),
        (
            format!(
                "{column}drums = 2\n{elastic}damping_ratio = 0.05\ndamping_frequency_hz = 20\n"
            ),
            "elastic_joints.damping_time_s",
            [1e-4, 1e-3],
        ),
        (
            format!("{pointed}[[tie]]\nheight_m = 1\narea_mm2 = 300\nmodulus_gpa = 200\n{free}"),
            "tie.1.stiffness_n_m",
            [1e6, 1e7],
        ),
        (
            format!("{pointed}{free}"),
            "supports.right.spread_m",
            [0.0, 0.02],
        ),
        (
            format!("{pointed}{free}"),
            "free_hinges.friction_coefficient",
            [0.5, 0.7],
        ),
        (
            format!("{ring}voussoirs = 9\n{free}"),
            "ground.right.delay_s",
            [0.0, 0.05],
        ),
        (column.to_owned(), "simulation.gravity_m_s2", [1.62, 9.81]),
        (
            format!("{column}[column.back]\nside = 'left'\n"),
            "column.width_m",
            [0.7, 0.8],
        ),
        (
            format!("{ring}[impact]\nmodel = 'prescribed'\nrestitution = 0.8\n"),
            "impact.restitution",
            [0.5, 0.9],
        ),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let [from, to] = values;
        // Thick rings start to move under strong pulses.
        let amplitude_g = if text.contains("'intrados'") {
            1.0
        } else {
            0.45
        };
        let text = format!(
            "{text}[ground.one_sine]\namplitude_g = 0.4\nduration_s = 0.4\n[simulation]\nduration_s = 1.0\n\
             [map]\n'{key}' = [{from:?}, {to:?}]\namplitude_g = [{amplitude_g:?}]\n"
        );
        fs::write(folder.path().join("s.toml"), text).unwrap();
        let output = archrock(folder.path(), &["map", "s.toml", "--out", "."]);
        assert!(output.status.success(), "{key}: {}", stderr(&output));
        let page = fs::read_to_string(folder.path().join("map.html")).unwrap();
        let rows = Table::read(folder.path().join("map.csv")).rows;
        let mut peaks = Vec::new();
        for row in &rows {
            let summary = run(folder.path(), &page, row);
            assert_eq!(summary["outcome"], row[2], "{key} {row:?}");
            let mut cells = row.cells();
            let of_blocks =
                cells.any(|(name, cell)| name == "peak_rotation_rad" && !cell.is_empty());
            let [of_row, of_run] = match of_blocks {
                true => ["peak_rotation_rad", "largest_peak_rotation_rad"],
                false => ["peak_rotation_over_critical"; 2],
            };
            let (peak, due) = (row.number(of_row), summary[of_run].as_f64().unwrap());
            assert!((peak / due - 1.0).abs() < 1e-8, "{key}: {peak} {due}");
            peaks.push(peak);
        }
        assert_ne!(peaks[0], peaks[1], "{key}");
    }
}

/// A map of piers in parts: the merged results are those that are computed at once.
#[test]
fn merged_parts_of_a_map_of_piers_are_the_map() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let text = "[pointed_arch]\nspan_m = 4\nrise_m = 3\nthickness_m = 0.5\nvoussoirs = 8\n[piers]\nheight_m = 1\nwidth_m = 1\n\
                [ground.one_sine]\namplitude_g = 0.4\nduration_s = 0.4\n[simulation]\nduration_s = 1.0\n[free_hinges]\nlongest_step_s = 1e-3\n\
                [map]\n'piers.height_m' = [0.5, 1.0, 1.5]\namplitude_g = [0.4]\n";
    fs::write(path.join("s.toml"), text).unwrap();
    done(path, &["map", "s.toml", "--out", "whole"]);
    for shard in ["1/2", "2/2"] {
        done(path, &["map", "s.toml", "--shard", shard, "--out", "parts"]);
    }
    let parts = ["parts/map-1-of-2.part", "parts/map-2-of-2.part"];
    done(path, &[&["merge", "--out", "merged"], &parts[..]].concat());
    assert_eq!(files(&path.join("merged")), files(&path.join("whole")));
    let rows = Table::read(path.join("merged/map.csv")).rows;
    assert_ne!(rows[0]["peak_rotation_rad"], rows[2]["peak_rotation_rad"]);
}

/// An arch that cannot stand has one outcome, however the key is spelled.
#[test]
fn arches_that_cannot_stand_have_one_outcome() {
    for (structure, axis) in [
        ("", "thickness_ratio = [0.09, 0.15]"),
        ("", "'arch.thickness_ratio' = [0.09, 0.15]"),
        ("", "'arch.thickness_m' = [0.45, 0.75]"),
        (
            "voussoirs = 12\n[free_hinges]\n",
            "thickness_ratio = [0.05, 0.15]",
        ),
        (
            "voussoirs = 12\n[free_hinges]\n",
            "'arch.thickness_m' = [0.25, 0.75]",
        ),
        (
            "voussoirs = 12\n[[load]]\nmass_kg = 10\nx_m = 0\n",
            "'arch.thickness_m' = [0.25, 0.75]",
        ),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let text = format!(
            "[arch]\nmean_radius_m = 5\nthickness_ratio = 0.15\nembrace_deg = 180\n{structure}[ground.one_sine]\namplitude_g = 0.1\n\
             duration_s = 0.4\n[simulation]\nduration_s = 0.6\n[map]\n{axis}\namplitude_g = [0.1]\n"
        );
        fs::write(folder.path().join("s.toml"), text).unwrap();
        done(folder.path(), &["map", "s.toml", "--out", "."]);
        let rows = Table::read(folder.path().join("map.csv")).rows;
        assert_eq!(rows[0]["outcome"], "cannot_stand", "{structure}{axis}");
        assert_ne!(rows[1]["outcome"], "cannot_stand", "{structure}{axis}");
    }
}

#[test]
fn cells_in_a_browser() {
    let folder = tempfile::tempdir().unwrap();
    let axes = "duration_s = { from = 0.2, to = 1.6, count = 5 }\n\
                amplitude_g = { from = 0.12, to = 3.0, count = 6, spacing = 'logarithmic' }\n";
    let (page, rows) = map(folder.path(), axes, &[]);
    for foreign in ["src=", "@import", "<link", "url("] {
        assert!(!page.contains(foreign), "{foreign}");
    }
    let script = "
const map = document.getElementById('map');
const numbers = () => document.getElementById('numbers').textContent;
data.rows.forEach((row, index) => {
  const [column, line] = [Math.floor(index / 6), index % 6];
  archrock.show([column, line]);
  const text = numbers();
  verify(text.includes(`pulse duration (s) ${Number(Number(row[0]).toPrecision(6))}`), `${text} ${row}`);
  verify(text.includes(`pulse amplitude (g) ${Number(Number(row[1]).toPrecision(6))}`), `${text} ${row}`);
  const words = { never_moved: 'never moves', rest: 'comes to rest', overturned: 'overturns' }[row[2]];
  verify(text.includes(words), `${text} ${row}`);
  verify(text.includes(Number(row[4]) === 1 ? ', 1 impact,' : `, ${Number(row[4])} impacts,`), `${text} ${row}`);
  verify(text.includes('outside the model') === Number(row[9]) > data.limit, `${text} ${row}`);
  verify(text.includes(`ends at ${Number(Number(row[6]).toPrecision(4))} s`), `${text} ${row}`);
  verify(!text.includes('_') && !text.includes('energy defect'), text);
  const command = document.getElementById('command').textContent;
  verify(command.includes(`duration_s=${Number(row[0])} `), `${command} ${row}`);
  verify(command.includes(`amplitude_g=${Number(row[1])} `), `${command} ${row}`);
});
// The middle of the cell under the pointer lies in the rectangle that marks it.
const box = map.querySelector('svg').getBoundingClientRect();
const [xs, ys] = archrock.data.sheets[0].edges_px;
const scale = box.width / archrock.data.sheets[0].width_px;
const at = { clientX: box.left + scale * (xs[3] + xs[4]) / 2, clientY: box.top + scale * (ys[1] + ys[2]) / 2, bubbles: true };
map.dispatchEvent(new PointerEvent('pointermove', at));
verify(archrock.chosen().join() === '3,1', archrock.chosen().join());
const mark = document.getElementById('cell').getBoundingClientRect();
verify(mark.left < at.clientX && mark.right > at.clientX && mark.top < at.clientY && mark.bottom > at.clientY, 'mark');
map.dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowUp', bubbles: true }));
verify(archrock.chosen().join() === '3,2', 'up');
map.dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowLeft', shiftKey: true, bubbles: true }));
verify(archrock.chosen().join() === '0,2', 'far left');
map.dispatchEvent(new PointerEvent('pointermove', at));
verify(archrock.chosen().join() === '0,2', 'stays');
";
    let page = folder.path().join("map.html");
    let cells = rows.iter().map(|row| row.cells().map(|(_, cell)| cell));
    let cells: Vec<Vec<&str>> = cells.map(Iterator::collect).collect();
    browser::assert_checked(
        &page,
        script,
        &json!({ "rows": cells, "limit": MODEL_LIMIT }).to_string(),
        &[],
        150,
    );
}

/// Negative amplitudes push to the right. The strongest is on top as among positive ones, and hatching falls to the right everywhere.
#[test]
fn the_strongest_pulse_is_on_top_whatever_its_sign() {
    let folder = tempfile::tempdir().unwrap();
    for (amplitudes, label) in [
        ("[0.2, 0.6, 2.0]", "pulse amplitude (g)"),
        ("[-2.0, -0.6, -0.2]", "minus pulse amplitude (g)"),
        ("[-2.0, 0.2, 0.6]", "pulse amplitude (g)"),
    ] {
        let axes = format!("duration_s = [0.3, 0.8]\namplitude_g = {amplitudes}\n");
        let (page, rows) = map(folder.path(), &axes, &[]);
        let data = data_of(&page);
        let edges: Vec<f64> =
            serde_json::from_value(data["sheets"][0]["edges_px"][1].clone()).unwrap();
        let values: Vec<f64> = serde_json::from_value(data["axes"][1]["values"].clone()).unwrap();
        assert_eq!(edges.len(), values.len() + 1);
        // Pixels count from the top.
        let height = |index: usize| 0.5 * (edges[index] + edges[index + 1]);
        let is_mixed = amplitudes.contains(", 0.2");
        for pair in [[0, 1], [1, 2]] {
            let [one, other] = pair.map(|index| match is_mixed {
                true => values[index],
                false => values[index].abs(),
            });
            assert_eq!(
                one < other,
                height(pair[0]) > height(pair[1]),
                "{amplitudes}"
            );
        }
        assert!(page.contains(&format!(">{label}<")), "{label}");
        assert_eq!(rows.len(), 6);
        let svg = fs::read_to_string(folder.path().join("map.svg")).unwrap();
        let drawing = roxmltree::Document::parse(&svg).unwrap();
        let hatching = drawing
            .descendants()
            .find(|node| node.attribute("data-name") == Some("outside-model"));
        let path = hatching.and_then(|node| node.attribute("d")).unwrap();
        let mut lines = path.split('M').skip(1).map(|line| {
            let numbers = line.split(|c: char| !(c.is_ascii_digit() || c == '.' || c == '-'));
            let numbers: Vec<f64> = numbers.filter_map(|word| word.parse().ok()).collect();
            [numbers[0], numbers[1], numbers[2], numbers[3]]
        });
        assert!(
            lines.all(|[x, y, to_x, to_y]| (to_x - x) * (to_y - y) > 0.0),
            "{path}"
        );
    }
}
