//! Figures for print: they have the requested size, and no text is cut off, overlaps another text or is crossed by a line.

use std::fs;
use std::path::Path;

use crate::common::program::{archrock, refusal, scenarios, stderr};
use crate::common::results::{named, points, texts};
use archrock::output::text_px;
use roxmltree::{Document, Node};

/// A rectangle in pixels: left, top, right, bottom.
type Box = [f64; 4];

/// Height of letters above the baseline, relative to the size of the text.
const ABOVE: f64 = 0.72;
/// Depth of letters below the baseline, relative to the size of the text.
const BELOW: f64 = 0.21;

fn number(node: &Node<'_, '_>, name: &str) -> f64 {
    let text = node.attribute(name).unwrap_or_else(|| panic!("{name}"));
    text.trim_end_matches("mm").parse().unwrap()
}

/// A text and its rectangle.
fn extents(text: &Node<'_, '_>, font_px: f64) -> (String, Box) {
    let (x, y) = (number(text, "x"), number(text, "y"));
    let words = text.text().unwrap_or_default().to_owned();
    let long = text_px(&words);
    let before = match text.attribute("text-anchor").unwrap() {
        "start" => 0.0,
        "middle" => 0.5 * long,
        _ => long,
    };
    let place = match text.attribute("transform") {
        None => [
            x - before,
            y - ABOVE * font_px,
            x - before + long,
            y + BELOW * font_px,
        ],
        // Rotated by a quarter turn, reading upwards.
        Some(turned) => {
            assert!(turned.starts_with("rotate(-90 "), "{turned}");
            [
                x - ABOVE * font_px,
                y + before - long,
                x + BELOW * font_px,
                y + before,
            ]
        }
    };
    (words, place)
}

/// The straight lines of a path.
fn segments(path: &str) -> Vec<[[f64; 2]; 2]> {
    const COMMANDS: &str = "MLHVhvAZz";
    let mut segments = Vec::new();
    let (mut first, mut last) = ([0.0; 2], [0.0; 2]);
    for (at, command) in path.match_indices(|c: char| COMMANDS.contains(c)) {
        let after = &path[at + 1..];
        let end = after.find(|c: char| COMMANDS.contains(c));
        let numbers = after[..end.unwrap_or(after.len())].split([' ', ',']);
        let numbers: Vec<f64> = numbers
            .filter(|text| !text.is_empty())
            .map(|text| text.parse().unwrap())
            .collect();
        let points = || numbers.chunks_exact(2).map(|to| [to[0], to[1]]);
        let mut ends: Vec<[f64; 2]> = match command {
            "H" => vec![[numbers[0], last[1]]],
            "V" => vec![[last[0], numbers[0]]],
            "h" => vec![[last[0] + numbers[0], last[1]]],
            "v" => vec![[last[0], last[1] + numbers[0]]],
            "A" => arc(last, &numbers),
            "Z" | "z" => vec![first],
            _ => points().collect(),
        };
        if command == "M" {
            first = ends.remove(0);
            last = first;
        }
        for to in ends {
            segments.push([last, to]);
            last = to;
        }
    }
    segments
}

/// Points of a circular arc from a given point. The numbers are radii, a zero, whether it is the longer arc, its direction and
/// its end.
fn arc(from: [f64; 2], numbers: &[f64]) -> Vec<[f64; 2]> {
    let (radius, longer, direction) = (numbers[0], numbers[3] != 0.0, numbers[4] != 0.0);
    let to = [numbers[5], numbers[6]];
    let half = [0, 1].map(|axis| 0.5 * (to[axis] - from[axis]));
    let chord = half[0].hypot(half[1]);
    let away = (radius * radius - chord * chord).max(0.0).sqrt() / chord;
    let side = if longer == direction { -away } else { away };
    let centre = [
        from[0] + half[0] - side * half[1],
        from[1] + half[1] + side * half[0],
    ];
    let angle = |point: [f64; 2]| (point[1] - centre[1]).atan2(point[0] - centre[0]);
    let turn = (angle(to) - angle(from)).rem_euclid(std::f64::consts::TAU);
    let turn = if direction {
        turn
    } else {
        turn - std::f64::consts::TAU
    };
    let at = |part: i32| {
        let angle = angle(from) + turn * f64::from(part) / 60.0;
        [
            centre[0] + radius * angle.cos(),
            centre[1] + radius * angle.sin(),
        ]
    };
    (1..60).map(at).chain([to]).collect()
}

/// The part of a line that is in a box.
fn clipped([from, to]: [[f64; 2]; 2], [left, top, right, bottom]: Box) -> Option<[[f64; 2]; 2]> {
    let along = [to[0] - from[0], to[1] - from[1]];
    let (mut enters, mut leaves) = (0.0_f64, 1.0_f64);
    for (axis, low, high) in [(0, left, right), (1, top, bottom)] {
        if along[axis] == 0.0 {
            if from[axis] < low || from[axis] > high {
                return None;
            }
            continue;
        }
        let ends = [low, high].map(|edge| (edge - from[axis]) / along[axis]);
        enters = enters.max(ends[0].min(ends[1]));
        leaves = leaves.min(ends[0].max(ends[1]));
    }
    let at = |part: f64| [0, 1].map(|axis| from[axis] + part * along[axis]);
    (enters < leaves).then(|| [at(enters), at(leaves)])
}

fn frame(svg: &Node<'_, '_>) -> Box {
    let [x, y, width, height] = ["x", "y", "width", "height"].map(|name| number(svg, name));
    [x, y, x + width, y + height]
}

/// The parts of these lines outside a box.
fn outside(lines: &[[[f64; 2]; 2]], covered: Box) -> Vec<[[f64; 2]; 2]> {
    let parts = |line: &[[f64; 2]; 2]| match clipped(*line, covered) {
        None => vec![*line],
        Some([enters, leaves]) => vec![[line[0], enters], [leaves, line[1]]],
    };
    lines.iter().flat_map(parts).collect()
}

/// The visible lines of a picture.
fn lines(document: &Document<'_>) -> Vec<[[f64; 2]; 2]> {
    let mut lines = Vec::new();
    for path in document
        .descendants()
        .filter(|node| node.has_tag_name("path"))
    {
        if path.attribute("data-name") == Some("paper") {
            let corners = segments(path.attribute("d").unwrap()).concat();
            let axis = |axis: usize| corners.iter().map(move |corner| corner[axis]);
            let low = [0, 1].map(|of| axis(of).fold(f64::INFINITY, f64::min));
            let high = [0, 1].map(|of| axis(of).fold(f64::NEG_INFINITY, f64::max));
            lines = outside(&lines, [low[0], low[1], high[0], high[1]]);
            continue;
        }
        if path.attribute("stroke") == Some("none") || number(&path, "stroke-width") == 0.0 {
            continue;
        }
        let frames: Vec<Box> = path
            .ancestors()
            .filter(|node| node.has_tag_name("svg") && node.has_attribute("x"))
            .map(|node| frame(&node))
            .collect();
        for segment in segments(path.attribute("d").unwrap()) {
            let seen = frames
                .iter()
                .try_fold(segment, |segment, frame| clipped(segment, *frame));
            lines.extend(seen);
        }
    }
    lines
}

/// Faults of a picture of this width.
fn faults(picture: &str, width_mm: f64, height_mm: Option<f64>, text_pt: f64) -> Vec<String> {
    let document = Document::parse(picture).unwrap();
    let root = document.root_element();
    let sheet: Vec<f64> = root
        .attribute("viewBox")
        .unwrap()
        .split(' ')
        .map(|number| number.parse().unwrap())
        .collect();
    let (width_px, height_px) = (sheet[2], sheet[3]);
    let mut faults = Vec::new();
    let mut check = |holds: bool, what: String| {
        if !holds {
            faults.push(what);
        }
    };
    check(number(&root, "width") == width_mm, "width".to_owned());
    let own_mm = number(&root, "height");
    check(
        (own_mm / height_px - width_mm / width_px).abs() < 1e-4,
        "its height is not in proportion".to_owned(),
    );
    if let Some(height_mm) = height_mm {
        check(
            (own_mm - height_mm).abs() < 0.1,
            format!("{own_mm} mm high"),
        );
    } else if width_mm < 100.0 {
        check(own_mm < 120.1, format!("{own_mm} mm high"));
    }
    let font_px = number(&root, "font-size");
    let points = font_px * width_mm / width_px / 25.4 * 72.0;
    check((points - text_pt).abs() < 1e-3, format!("{points} pt"));
    let nodes = document.descendants();
    let nodes: Vec<_> = nodes.filter(|node| node.has_tag_name("text")).collect();
    for node in &nodes {
        // Every text is drawn with its measured length, whatever the font.
        let words = node.text().unwrap_or_default();
        let drawn_px = node
            .attribute("textLength")
            .map(|_| number(node, "textLength"));
        let fits = drawn_px.is_some_and(|drawn_px| (drawn_px - text_px(words)).abs() < 0.01);
        check(fits, format!("{words:?} is drawn {drawn_px:?} px long"));
    }
    let texts: Vec<(String, Box)> = nodes
        .into_iter()
        .map(|node| extents(&node, font_px))
        .collect();
    check(texts.len() > 1, "texts".to_owned());
    let lines = lines(&document);
    for (index, (words, [left, top, right, bottom])) in texts.iter().enumerate() {
        let inside = *left >= 0.0 && *right <= width_px && *top >= 0.0 && *bottom <= height_px;
        check(inside, format!("{words:?} leaves the sheet"));
        for (others, [l, t, r, b]) in &texts[..index] {
            let apart = right <= l || r <= left || bottom <= t || b <= top;
            check(apart, format!("{words:?} is on {others:?}"));
        }
        let within = [left + 1.0, top + 1.0, right - 1.0, bottom - 1.0];
        let struck = lines.iter().any(|line| clipped(*line, within).is_some());
        check(!struck, format!("{words:?} is struck through"));
    }
    faults
}

/// Pictures and the arguments that draw them into the folder `out`, or as `plot.svg`.
fn pictures(map: &str) -> Vec<(Vec<String>, Vec<&'static str>)> {
    let scenario = |name: &str| scenarios().join(name).to_str().unwrap().to_owned();
    let cases: [(&str, &str, &[&str], &[&str]); 16] = [
        ("check", "semicircle-pulse.toml", &[], &[]),
        ("check", "pointed-arch-on-piers.toml", &[], &[]),
        ("check", "free-hinges.toml", &[], &[]),
        (
            "run",
            "semicircle-pulse.toml",
            &["--snapshots", "0.5,1.1,2", "--exaggerate", "3"],
            &["history.svg", "snapshots.svg"],
        ),
        (
            "run",
            "overturning-after-impacts.toml",
            &[],
            &["history.svg"],
        ),
        (
            "run",
            "free-hinges.toml",
            &["--no-repeat", "--hinges", "both"],
            &["overlay.svg", "four/history.svg", "free/history.svg"],
        ),
        (
            "run",
            "pointed-arch-on-piers.toml",
            &["--no-repeat", "--point", "0,4.2", "--snapshots", "0.3"],
            &["history.svg", "snapshots.svg"],
        ),
        ("map", map, &[], &["map.svg"]),
        ("suite", "column-suite.toml", &[], &["suite.svg", "ida.svg"]),
        (
            "threshold",
            "column-pulse.toml",
            &["--stride", "0.1"],
            &["threshold.svg"],
        ),
        (
            "capacity",
            "pointed-arch-on-piers.toml",
            &[],
            &["capacity.svg"],
        ),
        ("limit", "semicircle-pulse.toml", &[], &[]),
        (
            "limit",
            "semicircle-pulse.toml",
            &[
                "--set",
                "arch.embrace_deg=120",
                "--set",
                "arch.thickness_ratio=0.11",
            ],
            &[],
        ),
        ("limit", "pointed-arch-on-piers.toml", &[], &[]),
        ("impact", "semicircle-pulse.toml", &[], &[]),
        ("check", "synthetic.at2", &[], &[]),
    ];
    cases
        .into_iter()
        .map(|(command, name, more, pictures)| {
            let name = if name == map {
                map.to_owned()
            } else {
                scenario(name)
            };
            let mut arguments = vec![command.to_owned(), name];
            arguments.extend(more.iter().map(|&argument| argument.to_owned()));
            let out = if pictures.is_empty() {
                ["--plot", "out/plot.svg"]
            } else {
                ["--out", "out"]
            };
            arguments.extend(out.map(str::to_owned));
            let pictures = if pictures.is_empty() {
                &["plot.svg"][..]
            } else {
                pictures
            };
            (arguments, pictures.to_vec())
        })
        .collect()
}

/// Draws all pictures and returns their faults.
fn drawn(folder: &Path, arguments: &[&str], facts: (f64, Option<f64>, f64)) -> Vec<String> {
    let map = folder.join("map.toml");
    let text = fs::read_to_string(scenarios().join("semicircle-map.toml")).unwrap();
    let text = text.replace("count = 76", "count = 6");
    fs::write(&map, text.replace("count = 80", "count = 7")).unwrap();
    fs::create_dir_all(folder.join("out")).unwrap();
    let (width_mm, height_mm, text_pt) = facts;
    let mut wrong = Vec::new();
    for (own, pictures) in pictures(map.to_str().unwrap()) {
        let all: Vec<&str> = own
            .iter()
            .map(String::as_str)
            .chain(arguments.iter().copied())
            .collect();
        let output = archrock(folder, &all);
        assert!(output.status.success(), "{all:?} {}", stderr(&output));
        for picture in pictures {
            let text = fs::read_to_string(folder.join("out").join(picture)).unwrap();
            // Lines of similar appearance are in the legend.
            if picture == "ida.svg" {
                assert!(
                    text.contains("data-name=\"critical\"") && text.contains(">critical rotation<")
                );
            }
            let faults = faults(&text, width_mm, height_mm, text_pt);
            let name = format!("{width_mm} mm, {} {picture}", own[..2].join(" "));
            wrong.extend(faults.into_iter().map(|fault| format!("{name}: {fault}")));
        }
    }
    wrong
}

#[test]
fn no_text_is_cut_off_or_struck_through() {
    let folder = tempfile::tempdir().unwrap();
    let mut wrong = Vec::new();
    for width_mm in [84.0, 120.0, 174.0] {
        let width = format!("{width_mm}mm");
        let arguments = ["--figure-width", &width];
        wrong.extend(drawn(folder.path(), &arguments, (width_mm, None, 8.0)));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The structure as a drawing: blocks, joints, dimensions, fill and loads of the scenario, before anything is computed.
#[test]
fn a_structure_is_drawn_with_its_dimensions() {
    let folder = tempfile::tempdir().unwrap();
    let draw = |command: &[&str], scenario: &str| {
        let path = scenarios().join(scenario);
        let arguments = [command, &[path.to_str().unwrap(), "--plot", "plot.svg"]].concat();
        let output = archrock(folder.path(), &arguments);
        assert!(output.status.success(), "{}", stderr(&output));
        fs::read_to_string(folder.path().join("plot.svg")).unwrap()
    };
    let text = draw(&["check"], "pointed-arch-on-piers.toml");
    let picture = Document::parse(&text).unwrap();
    // 14 voussoirs on two piers of two blocks.
    assert_eq!(named(&picture, "block").len(), 18);
    let words = texts(&picture);
    for joint in 0..=18 {
        assert!(words.contains(&joint.to_string()), "joint {joint}");
    }
    for text in [
        "span 6 m", "rise 4 m", "3 m", "1.6 m", "fill 2 m", "1500 kg",
    ] {
        assert!(words.iter().any(|word| word == text), "{text}: {words:?}");
    }
    // The span is to scale with the width of a pier.
    let ends = named(&picture, "dimension")
        .into_iter()
        .map(|line| points(&line));
    let lengths: Vec<f64> = ends.map(|ends| (ends[1] - ends[0]).norm()).collect();
    assert!(lengths.iter().any(|one| {
        lengths
            .iter()
            .any(|other| (one / other - 6.0 / 1.6).abs() < 1e-3)
    }));
    // The fill is level at its top, 2 m above the springing of the extrados, and ends at the extrados below.
    let fill = named(&picture, "fill");
    let tops = fill.iter().map(|part| {
        points(part)
            .iter()
            .map(|at| at.y)
            .fold(f64::INFINITY, f64::min)
    });
    let tops: Vec<f64> = tops.collect();
    assert!(tops.len() >= 4 && tops.iter().all(|top| (top - tops[0]).abs() < 0.02));
    assert_eq!(named(&picture, "load").len(), 1);
    // The first mechanism carries it too, at rest and as it moves.
    let text = draw(&["limit"], "pointed-arch-on-piers.toml");
    let picture = Document::parse(&text).unwrap();
    assert_eq!(named(&picture, "fill").len(), 2 * fill.len());
    assert_eq!(named(&picture, "load").len(), 2);
    let text = draw(&["check"], "semicircle-pulse.toml");
    assert!(texts(&Document::parse(&text).unwrap()).contains(&"span 10 m".to_owned()));
}

/// A curve ends where the structure overturns, and narrow bands are seen and listed.
#[test]
fn curves_end_at_the_threshold() {
    let folder = tempfile::tempdir().unwrap();
    let own = scenarios().join("column-pulse.toml");
    let arguments = [
        "threshold",
        own.to_str().unwrap(),
        "--stride",
        "0.1",
        "--out",
        ".",
    ];
    let output = archrock(folder.path(), &arguments);
    assert!(output.status.success(), "{}", stderr(&output));
    let text = fs::read_to_string(folder.path().join("threshold.svg")).unwrap();
    let picture = Document::parse(&text).unwrap();
    let [overturns] = named(&picture, "column overturned-0")[..] else {
        panic!("one band")
    };
    let edge = number(&overturns, "x");
    let [curve] = named(&picture, "column peak")[..] else {
        panic!("one curve")
    };
    let last = points(&curve).last().unwrap().x;
    // The last factor that survives is a stride below, at most: a plot of 790 pixels spans two decades.
    let stride_px = 0.5 * 790.0 * 1.1_f64.log10();
    assert!(
        last <= edge + 0.05 && last > edge - stride_px,
        "{last} {edge}"
    );
}

#[test]
fn the_search_for_drawing_faults_finds_them() {
    let sheet = |inside: &str| {
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"84mm\" height=\"42mm\" viewBox=\"0 0 387 193.5\" \
             font-size=\"13\">{inside}<text x=\"300\" y=\"20\" text-anchor=\"end\" textLength=\"{}\">beside it</text></svg>",
            text_px("beside it")
        )
    };
    let text = |x: f64, y: f64| {
        format!(
            "<text x=\"{x}\" y=\"{y}\" text-anchor=\"start\" textLength=\"{}\">rotation</text>",
            text_px("rotation")
        )
    };
    let line = |path: &str| format!("<path d=\"{path}\" stroke=\"#000\" stroke-width=\"1\"/>");
    let found = |inside: &str| {
        let faults = faults(
            &sheet(inside),
            84.0,
            None,
            13.0 * 84.0 / 387.0 / 25.4 * 72.0,
        );
        faults.join("; ")
    };
    assert_eq!(found(&text(20.0, 100.0)), "");
    assert!(found(&text(350.0, 100.0)).contains("leaves the sheet"));
    assert!(found(&(text(20.0, 100.0) + &text(50.0, 108.0))).contains("is on \"rotation\""));
    for path in [
        "M0 97H300",
        "M40 20V180",
        "M0 0L80 200",
        "M10 90h60v6h-60Z",
        "M0 97 300 97",
    ] {
        assert!(
            found(&(text(20.0, 100.0) + &line(path))).contains("struck through"),
            "{path}"
        );
    }
    assert_eq!(found(&(text(20.0, 100.0) + &line("M0 106H300"))), "");
    // An arc above the text, whose chord would cross the text, and an arc that crosses it.
    assert_eq!(
        found(&(text(20.0, 100.0) + &line("M0 97A40 40 0 0 1 80 97"))),
        ""
    );
    assert!(found(&(text(20.0, 100.0) + &line("M0 127A30 30 0 0 1 60 127"))).contains("struck"));
}

#[test]
fn height_text_panels_and_title_can_be_chosen() {
    let folder = tempfile::tempdir().unwrap();
    let own = scenarios().join("semicircle-pulse.toml");
    let own = own.to_str().unwrap();
    let run = |more: &[&str]| {
        let arguments = [&["run", own, "--out", "out", "--no-report"], more].concat();
        let output = archrock(folder.path(), &arguments);
        assert!(output.status.success(), "{}", stderr(&output));
        fs::read_to_string(folder.path().join("out/history.svg")).unwrap()
    };
    let panels = [
        "Ground (g)",
        "Rotation (rad)",
        "Total energy / barrier",
        "Thrust line outside / t",
    ];
    let shown = |picture: &str| panels.map(|panel| picture.contains(&format!(">{panel}<")));
    for (height_mm, text_pt) in [(70.0, 7.0), (110.0, 8.0), (200.0, 9.0)] {
        let [height, size] = [format!("{height_mm}mm"), text_pt.to_string()];
        let picture = run(&[
            "--figure-width",
            "120mm",
            "--figure-height",
            &height,
            "--font-size",
            &size,
            "--panels",
            "ground,rotation",
        ]);
        let found = faults(&picture, 120.0, Some(height_mm), text_pt);
        assert!(found.is_empty(), "{found:?}");
        assert_eq!(shown(&picture), [true, true, false, false]);
    }
    assert_eq!(shown(&run(&[])), [true, true, true, true]);
    assert_eq!(
        shown(&run(&["--figure-width", "84mm"])),
        [true, true, true, false]
    );
    assert_eq!(
        shown(&run(&["--panels", "thrust"])),
        [false, false, false, true]
    );
    let title = "Semicircular arch";
    assert!(run(&[]).contains(title) && !run(&["--no-title"]).contains(title));
    for (more, reported) in [
        (&["--figure-width", "85"][..], "such as 85mm"),
        (&["--figure-height", "60mm"], "--figure-width"),
        (
            &["--figure-width", "85mm", "--figure-height", "60"],
            "such as 60mm",
        ),
        (
            &["--figure-width", "60mm", "--font-size", "9"],
            "too narrow",
        ),
        (
            &["--figure-width", "60mm", "--font-size", "90"],
            "from 5 to 14 points",
        ),
        (&["--panels", "ground,slips"], "ground, rotation, joints"),
        (&["--figure-format", "eps"], "svg, pdf and png"),
    ] {
        let arguments = [&["run", own], more].concat();
        let said = refusal(&archrock(folder.path(), &arguments));
        assert!(said.contains(reported), "{said}");
    }
}

/// With the feature `print` the files are written; without it the program prints how to get it.
#[test]
fn pictures_are_written_as_pdf_and_png() {
    let folder = tempfile::tempdir().unwrap();
    let own = scenarios().join("semicircle-pulse.toml");
    let own = own.to_str().unwrap();
    for (format, begins) in [("pdf", &b"%PDF-"[..]), ("png", b"\x89PNG")] {
        let plot = format!("plot.{format}");
        for (arguments, file) in [
            (vec!["limit", own, "--plot", &plot], plot.clone()),
            (
                vec!["run", own, "--out", "out", "--figure-format", format],
                format!("out/history.{format}"),
            ),
        ] {
            let output = archrock(folder.path(), &arguments);
            if cfg!(feature = "print") {
                assert!(output.status.success(), "{}", stderr(&output));
                assert!(
                    fs::read(folder.path().join(file))
                        .unwrap()
                        .starts_with(begins)
                );
            } else {
                assert!(refusal(&output).contains("--path . --locked --features print"));
            }
        }
    }
    if cfg!(feature = "print") {
        let output = archrock(folder.path(), &["run", own, "--out", "out"]);
        assert!(output.status.success(), "{}", stderr(&output));
        assert!(
            !folder.path().join("out/history.png").exists(),
            "the old file is removed"
        );
    }
}
