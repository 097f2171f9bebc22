//! `map.html`: every cell that it shows is compared with the table, in a real browser, and its commands with a run.

use crate::common::browser;
use crate::common::results::{Row, Table, data_of};
use std::fs;
use std::path::Path;
use std::process::Command;

use crate::common::program::{archrock, stderr};
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

/// Runs the page's command, with the values of a row, in a shell; returns the outcome in its summary.
fn run(folder: &Path, page: &str, row: &Row) -> String {
    let [x, y] = [0, 1].map(|column| row.number(column));
    let command = data_of(page)["command"].as_str().unwrap().to_owned();
    let filled = command
        .replace("{cell.x}", &x.to_string())
        .replace("{cell.y}", &y.to_string())
        .replace("{1/cell.x}", &(1.0 / x).to_string());
    let own = env!("CARGO_BIN_EXE_archrock");
    let line = filled.replacen("archrock run -", &format!("{own} run - --format json"), 1);
    let output = Command::new("sh")
        .arg("-c")
        .arg(&line)
        .current_dir(folder)
        .output()
        .unwrap();
    assert!(output.status.success(), "{line}: {}", stderr(&output));
    let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
    summary["outcome"].as_str().unwrap().to_owned()
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
            assert_eq!(run(folder.path(), &page, row), row[2], "{row:?}");
        }
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
  verify(text.includes(`impacts ${Number(row[4])}`), `${text} ${row}`);
  verify(text.includes('outside the model') === Number(row[9]) > data.limit, `${text} ${row}`);
  verify(text.includes(`outcome time (s) ${Number(Number(row[6]).toPrecision(5))}`), `${text} ${row}`);
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
