//! `--figure-width`: every picture fits its sheet, with text of 8 pt at the requested width.

use std::fs;
use std::path::Path;

use crate::program::{archrock, scenarios, stderr};
use roxmltree::Document;

/// Least width of a character, in pixels: a text that leaves the sheet even at this width is cut off.
const NARROW_PX: f64 = 5.2;

fn check(picture: &Path, width_mm: f64) {
    let text = fs::read_to_string(picture).unwrap();
    let document = Document::parse(&text).unwrap();
    let root = document.root_element();
    let box_px: Vec<f64> = root
        .attribute("viewBox")
        .unwrap()
        .split(' ')
        .map(|number| number.parse().unwrap())
        .collect();
    let (width_px, height_px) = (box_px[2], box_px[3]);
    assert_eq!(
        root.attribute("width"),
        Some(format!("{width_mm}mm").as_str())
    );
    let height = root
        .attribute("height")
        .unwrap()
        .strip_suffix("mm")
        .unwrap();
    let height_mm: f64 = height.parse().unwrap();
    assert!((height_mm / height_px - width_mm / width_px).abs() < 1e-4);
    let font_px: f64 = root.attribute("font-size").unwrap().parse().unwrap();
    let points = font_px * width_mm / width_px / 25.4 * 72.0;
    assert!((points - 8.0).abs() < 1e-3, "{points} pt");
    let mut texts = 0;
    for node in document
        .descendants()
        .filter(|node| node.has_tag_name("text"))
    {
        let number = |name: &str| node.attribute(name).unwrap().parse::<f64>().unwrap();
        let (x, y, words) = (number("x"), number("y"), node.text().unwrap_or_default());
        #[expect(clippy::cast_precision_loss, reason = "the length of a label")]
        let long_px = NARROW_PX * words.chars().count() as f64;
        let before = match node.attribute("text-anchor").unwrap() {
            "start" => 0.0,
            "middle" => 0.5,
            _ => 1.0,
        };
        let name = picture.display();
        if node.attribute("transform").is_some() {
            // Rotated by a quarter turn, upwards.
            let low = y + before * long_px;
            assert!(low <= height_px && low - long_px >= 0.0, "{name}: {words}");
        } else {
            let left = x - before * long_px;
            assert!(left >= 0.0 && left + long_px <= width_px, "{name}: {words}");
            assert!(y > 0.0 && y < height_px, "{name}: {words}");
        }
        texts += 1;
    }
    assert!(texts > 1);
}

#[test]
fn pictures_fit_a_column_and_a_page() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = |name: &str| scenarios().join(name).to_str().unwrap().to_owned();
    let map = folder.path().join("map.toml");
    let text = fs::read_to_string(scenarios().join("semicircle-map.toml")).unwrap();
    fs::write(
        &map,
        text.replace("count = 76", "count = 6")
            .replace("count = 80", "count = 7"),
    )
    .unwrap();
    let map = map.to_str().unwrap();
    for width_mm in [85.0, 170.0] {
        let width = format!("{width_mm}mm");
        for (arguments, pictures) in [
            (
                vec![
                    "run",
                    &scenario("semicircle-pulse.toml"),
                    "--snapshots",
                    "0.5,1.1,2",
                    "--exaggerate",
                    "3",
                ],
                &["history.svg", "snapshots.svg"][..],
            ),
            (
                vec!["run", &scenario("overturning-after-impacts.toml")],
                &["history.svg"],
            ),
            (
                vec![
                    "run",
                    &scenario("free-hinges.toml"),
                    "--no-spread",
                    "--hinges",
                    "both",
                ],
                &["overlay.svg", "four/history.svg", "free/history.svg"],
            ),
            (vec!["map", map], &["map.svg"]),
            (
                vec!["suite", &scenario("column-suite.toml")],
                &["suite.svg", "ida.svg"],
            ),
            (
                vec!["chart", &scenario("voussoirs-step-pair.toml")],
                &["chart.svg"],
            ),
            (
                vec![
                    "threshold",
                    &scenario("column-pulse.toml"),
                    "--stride",
                    "0.1",
                ],
                &["threshold.svg"],
            ),
        ] {
            let out = folder.path().join("out");
            let more = ["--out", out.to_str().unwrap(), "--figure-width", &width];
            let arguments: Vec<&str> = arguments.iter().map(AsRef::as_ref).chain(more).collect();
            let output = archrock(folder.path(), &arguments);
            assert!(output.status.success(), "{arguments:?} {}", stderr(&output));
            for picture in pictures {
                check(&out.join(picture), width_mm);
            }
        }
        for command in ["limit", "impact"] {
            let own = scenario("semicircle-pulse.toml");
            let output = archrock(
                folder.path(),
                &[
                    command,
                    &own,
                    "--plot",
                    "plot.svg",
                    "--figure-width",
                    &width,
                ],
            );
            assert!(output.status.success(), "{}", stderr(&output));
            check(&folder.path().join("plot.svg"), width_mm);
        }
        let record = scenario("synthetic.at2");
        let output = archrock(
            folder.path(),
            &[
                "check",
                &record,
                "--plot",
                "plot.svg",
                "--figure-width",
                &width,
            ],
        );
        assert!(output.status.success(), "{}", stderr(&output));
        check(&folder.path().join("plot.svg"), width_mm);
    }
    let own = scenario("semicircle-pulse.toml");
    let output = archrock(folder.path(), &["run", &own, "--figure-width", "85"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr(&output).contains("such as 85mm"),
        "{}",
        stderr(&output)
    );
}
