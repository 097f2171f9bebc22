//! The page to try, in a browser. `web/build` makes it; ARCHROCK_WEB is its folder, and without that nothing is tested.

use std::fs;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::{TcpListener, TcpStream};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::mpsc::{self, Sender};
use std::thread;
use std::time::Duration;

use archrock::output::Figure;
use archrock::scenario::{Scenario, Source};
use archrock::studies::run::{FILES, Sinks};
use archrock::studies::{Computation, Options, StudyKind, Style, Work};
use archrock::{Pulse, Runner};
use serde_json::{Value, json};

use crate::common::Random;
use crate::common::browser::browser;
use crate::common::program::scenarios;

const SCRIPT: &str = include_str!("web.js");

/// Scenarios of all models; the third has more than 100 impacts, the last ones have a record.
const COMPARED: [&str; 11] = [
    "semicircle-pulse.toml",
    "free-rocking.toml",
    "column-pulse.toml",
    "overturning-after-impacts.toml",
    "pointed-arch-on-piers.toml",
    "facade.toml",
    "tie.toml",
    "free-hinges.toml",
    "two-feet.toml",
    "drums-step-pair.toml",
    "semicircle-record.toml",
];

/// An arch with elastic joints: the one of the repository has a table of joints as a file.
const ELASTIC: &str = "[arch]\nmean_radius_m = 5\nthickness_ratio = 0.15\nembrace_deg = 180\nvoussoirs = 17\n\
    [elastic_joints]\nnormal_stiffness_gpa_m = 10\n[ground.half_sine]\namplitude_g = -0.2\nduration_s = 0.25\n\
    [simulation]\nduration_s = 1.5\n";

fn pages() -> Option<PathBuf> {
    let folder = std::env::var_os("ARCHROCK_WEB").map(PathBuf::from);
    if folder.is_none() {
        skip_without_page();
    }
    folder
}

#[expect(clippy::print_stderr, reason = "the reader of the test")]
fn skip_without_page() {
    eprintln!("ARCHROCK_WEB is not set: build the page by web/build to test it");
}

/// A file of a scenario folder as the page holds it.
fn file(name: &str) -> String {
    fs::read_to_string(scenarios().join(name)).unwrap()
}

/// The files of a study as this build of the library computes them.
fn computed(study: &str, text: &str, files: &[(&str, String)], no_repeat: bool) -> Value {
    try_computed(study, text, files, no_repeat).unwrap()
}

/// The files of a study as this build of the library computes them; `None` if the library refuses the scenario.
fn try_computed(
    study: &str,
    text: &str,
    files: &[(&str, String)],
    no_repeat: bool,
) -> Option<Value> {
    let held = files
        .iter()
        .map(|(name, text)| (PathBuf::from(name), text.clone().into_bytes()));
    let source = Source::of_text(text, "scenario.toml").with_files(held);
    let scenario = Scenario::of(&source, &Default::default()).ok()?;
    let mut options = Options::default();
    options.run.no_repeat = no_repeat;
    let names = FILES.map(str::to_owned);
    let sinks = Sinks {
        in_memory: &names,
        ..Sinks::default()
    };
    let watch = &mut |_| ControlFlow::Continue(());
    let work = Work {
        runner: Runner::default(),
        task: None,
        watch,
    };
    let kind = StudyKind::of_name(study).unwrap();
    let done = kind
        .compute(
            &[scenario],
            &options,
            Style::of(Figure::SCREEN),
            work,
            sinks,
        )
        .ok()?;
    let Computation::Complete(results, _) = done else {
        panic!("{study} is incomplete");
    };
    let tables = results
        .files
        .iter()
        .filter(|(name, _)| name.ends_with(".csv"));
    let tables =
        tables.map(|(name, bytes)| ((*name).to_owned(), String::from_utf8_lossy(bytes).into()));
    let mut summary = results.summary;
    summary.as_object_mut().unwrap().remove("longest_step_us");
    let answer = results.statement.answer(true);
    Some(
        json!({ "summary": summary, "words": results.words, "answer": answer, "tables": Value::Object(tables.collect()) }),
    )
}

/// A scenario of any shape, pulse and model; some are refused.
fn random_scenario(random: &mut Random) -> String {
    let models = [
        "",
        "[free_hinges]",
        "[elastic_joints]\nnormal_stiffness_gpa_m = 10",
    ];
    let model = models[random.pick(3)];
    let blocks = format!("voussoirs = {}\n", 5 + random.pick(9));
    let span_m = random.within(2.0, 12.0);
    let mut part = |from: f64, to: f64| span_m * random.within(from, to);
    let [low, high, thickness_m, width_m] = [
        part(0.3, 0.5),
        part(0.55, 0.9),
        part(0.06, 0.12),
        part(0.1, 0.4),
    ];
    let embrace_deg = random.within(110.0, 180.0);
    let structure = match random.pick(4) {
        0 => {
            let cut = if model.is_empty() { "" } else { &blocks };
            let mean_radius_m = 0.5 * span_m;
            format!(
                "[arch]\nmean_radius_m = {mean_radius_m}\nthickness_m = {thickness_m}\nembrace_deg = {embrace_deg}\n{cut}"
            )
        }
        1 => format!(
            "[pointed_arch]\nspan_m = {span_m}\nrise_m = {high}\nthickness_m = {thickness_m}\n{blocks}"
        ),
        2 => format!(
            "[elliptic_arch]\nspan_m = {span_m}\nrise_m = {low}\nthickness_m = {thickness_m}\n{blocks}"
        ),
        _ => {
            let drums = if model.is_empty() { "" } else { "drums = 3\n" };
            format!("[column]\nheight_m = {span_m}\nwidth_m = {width_m}\n{drums}")
        }
    };
    let kind = Pulse::ALL[random.pick(Pulse::ALL.len())].name();
    let (amplitude_g, duration_s) = (random.within(-0.9, 0.9), random.within(0.1, 0.9));
    format!(
        "{structure}{model}\n[ground.{kind}]\namplitude_g = {amplitude_g}\nduration_s = {duration_s}\n\
         [simulation]\nduration_s = 1.5\n"
    )
}

/// Answers the browser, and passes on the verdict that the page sends.
fn serve(listener: &TcpListener, folder: &Path, html: &str, verdict: &Sender<String>) {
    for stream in listener.incoming().map_while(Result::ok) {
        let mut reader = BufReader::new(&stream);
        let (mut first, mut length) = (String::new(), 0);
        reader.read_line(&mut first).unwrap_or_default();
        loop {
            let mut line = String::new();
            if reader.read_line(&mut line).unwrap_or_default() < 3 {
                break;
            }
            if let Some(count) = line.to_lowercase().strip_prefix("content-length:") {
                length = count.trim().parse().unwrap();
            }
        }
        if first.starts_with("POST") {
            let mut body = vec![0; length];
            reader.read_exact(&mut body).unwrap();
            send(&stream, "text/plain", b"");
            verdict
                .send(String::from_utf8(body).unwrap())
                .unwrap_or_default();
        } else if first.contains("old/archrock.wasm") {
            // A module that the browser refuses, as one without SIMD refuses ours.
            send(&stream, "application/wasm", b"\0asm\x02\0\0\0");
        } else if first.contains("/single") {
            let page = fs::read(folder.join("archrock.html")).unwrap();
            send(&stream, "text/html; charset=utf-8", &page);
        } else if first.contains("archrock.wasm") {
            // A simple server does not know this type of file.
            let module = fs::read(folder.join("archrock.wasm")).unwrap();
            send(&stream, "application/octet-stream", &module);
        } else {
            send(&stream, "text/html; charset=utf-8", html.as_bytes());
        }
    }
}

fn send(mut stream: &TcpStream, kind: &str, body: &[u8]) {
    let head = format!(
        "HTTP/1.1 200 OK\r\nContent-Type: {kind}\r\nAccess-Control-Allow-Origin: *\r\nContent-Length: {}\r\nConnection: close\r\n\r\n",
        body.len()
    );
    // A browser that has gone wants nothing.
    let _ = stream
        .write_all(head.as_bytes())
        .and_then(|()| stream.write_all(body));
}

/// Asserts that the checks of a part of web.js pass on a page, at least this many. `single` is the page of one file, opened from disk.
fn assert_page(part: &str, single: bool, settings: &[&str], data: &Value, least: usize) {
    let Some(folder) = pages() else { return };
    let name = if single {
        "archrock.html"
    } else {
        "index.html"
    };
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    let address = format!("http://127.0.0.1:{port}/");
    let own = format!("const [data, part, address] = [{data}, {part:?}, {address:?}];\n{SCRIPT}");
    let own = own.replace("</", "<\\/");
    let before = "<script>window.errors = []; addEventListener('error', ({ message }) => errors.push(message));\
        addEventListener('unhandledrejection', ({ reason }) => errors.push(`${reason} ${reason.stack}`));</script>";
    let html = fs::read_to_string(folder.join(name)).unwrap();
    // The policy of the page forbids every connection: here it permits the verdict, the page as a text, and frames.
    let policy = "connect-src ";
    let permitted = format!("frame-src {address}; {policy}{address}verdict {address}single ");
    assert!(html.contains(policy), "the page has no policy");
    let html = html.replacen(policy, &permitted, 1);
    let html = html.replacen("single 'none'", "single", 1);
    let html = html.replacen("<head>", &format!("<head>{before}"), 1);
    let html = html.replacen(
        "</body>",
        &format!("<script type=\"module\">{own}</script></body>"),
        1,
    );
    let disk = tempfile::tempdir().unwrap();
    let file = disk.path().join("archrock.html");
    fs::write(&file, &html).unwrap();
    let (sender, receiver) = mpsc::channel();
    thread::spawn(move || serve(&listener, &folder, &html, &sender));
    let opened = match single {
        true => format!("file://{}", file.display()),
        false => address,
    };
    let size = ["--window-size=1280,1000"];
    let all = [settings, &size, &["--remote-debugging-port=0"]].concat();
    let Some((mut command, _profile)) = browser(&all, &opened) else {
        return;
    };
    // Debian's command is a script that starts the browser, so its whole group of processes is ended.
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    let output = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn();
    let mut browser = output.unwrap();
    let verdict = receiver.recv_timeout(Duration::from_secs(300));
    if cfg!(unix) {
        let group = format!("-{}", browser.id());
        let kill = Command::new("kill").args(["-KILL", "--", &group]).status();
        assert!(kill.unwrap().success());
    } else {
        browser.kill().unwrap();
    }
    browser.wait().unwrap();
    let verdict: Value =
        serde_json::from_str(&verdict.expect("the page sends its verdict")).unwrap();
    assert_eq!(verdict["failures"], json!([]), "{part}");
    assert!(
        verdict["passed"].as_u64().unwrap() as usize >= least,
        "{verdict}"
    );
}

/// Every number of the module is that of the program, to the last digit: a run, its tables and its words.
#[test]
fn the_page_computes_the_bits_of_the_program() {
    if pages().is_none() {
        return;
    }
    let mut all: Vec<Value> = Vec::new();
    let record = [("synthetic.at2", file("synthetic.at2"))];
    let texts = COMPARED.map(file).into_iter().chain([ELASTIC.to_owned()]);
    for (text, name) in texts.zip(COMPARED.into_iter().chain(["elastic"])) {
        let files = if name.contains("record") {
            &record[..]
        } else {
            &[]
        };
        let expected = computed("run", &text, files, true);
        let files: serde_json::Map<_, _> = files
            .iter()
            .map(|(name, text)| ((*name).to_owned(), text.clone().into()))
            .collect();
        all.push(json!({ "name": name, "study": "run", "scenario": text, "files": files, "expected": expected }));
    }
    for (study, name) in [
        ("map", "semicircle-map.toml"),
        ("threshold", "semicircle-pulse.toml"),
        ("limit", "tie.toml"),
    ] {
        let text = file(name);
        let expected = computed(study, &text, &[], false);
        all.push(json!({ "name": name, "study": study, "scenario": text, "files": {}, "expected": expected }));
    }
    assert!(
        all[2]["expected"]["words"]
            .as_str()
            .unwrap()
            .contains("152 impacts")
    );
    assert_eq!(rows_of_blocks(&all), 7);
    assert_page("bits", false, &[], &json!(all), 45);
}

/// The number of cases whose model is a row of blocks: their results have the same bits everywhere.
fn rows_of_blocks(cases: &[Value]) -> usize {
    let is_row = |case: &&Value| {
        let text = case["scenario"].as_str().unwrap();
        text.contains("[free_hinges]") || text.contains("[elastic_joints]")
    };
    cases.iter().filter(is_row).count()
}

/// The page computes forty random scenarios of all shapes, pulses and models as the program does.
#[test]
fn the_page_computes_the_bits_of_the_program_for_forty_random_scenarios() {
    if pages().is_none() {
        return;
    }
    let mut random = Random(40);
    let mut all = Vec::new();
    while all.len() < 40 {
        let text = random_scenario(&mut random);
        if let Some(expected) = try_computed("run", &text, &[], true) {
            all.push(json!({ "name": all.len(), "study": "run", "scenario": text, "files": {}, "expected": expected }));
        }
    }
    assert!((15..35).contains(&rows_of_blocks(&all)));
    for outcome in ["rest", "overturned", "never_moved"] {
        let has = |case: &Value| case["expected"]["summary"]["outcome"] == outcome;
        assert!(all.iter().any(has), "{outcome}");
    }
    assert_page("bits", false, &[], &json!(all), 120);
}

/// The reaction in hand holds the arch up to the push of the program's limit analysis. There its line passes through all four hinges, of which three
/// give it; and beyond it no reaction is left, wherever its foot is.
#[test]
fn statics_end_at_the_first_motion_of_limit_analysis() {
    if pages().is_none() {
        return;
    }
    let basket = "[basket_arch]\nspan_m = 10\nrise_m = 3.5\nthickness_m = 0.7\nvoussoirs = 21\n";
    let given = [
        file("free-hinges.toml"),
        file("pointed-arch-on-piers.toml"),
        basket.to_owned(),
    ];
    let mut random = Random(4);
    let others = std::iter::repeat_with(|| random_scenario(&mut random));
    let others = others.filter(|text| text.contains("voussoirs"));
    let cases = given.into_iter().chain(others).filter_map(|text| {
        let ground = if text.contains("[ground") {
            ""
        } else {
            "[ground.half_sine]\namplitude_g = 0.2\nduration_s = 0.3\n"
        };
        let text = format!("{text}{ground}");
        let limit = try_computed("limit", &text, &[], true)?;
        let starts_g = &limit["summary"]["incipient_acceleration_g"];
        let starts_g = [starts_g["right"].as_f64()?, starts_g["left"].as_f64()?];
        Some(json!({ "scenario": text, "starts_g": starts_g }))
    });
    let cases = cases.take(12).collect::<Vec<_>>();
    assert_page("statics", false, &[], &json!(cases), 150);
}

/// Sliders, choices, text, records, links, broken input, studies, stops and a page that is closed.
#[test]
fn the_page_answers_its_readers() {
    if pages().is_none() {
        return;
    }
    let arch = "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 180.0\nvoussoirs = 36\n\n[ground.half_sine]\n";
    let text = format!("{arch}amplitude_g = -0.35\nduration_s = 0.3\n");
    let record = file("synthetic.at2");
    let of_record = "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 180.0\nvoussoirs = 36\n\n[ground.record]\nfile = \"synthetic.at2\"\nscale = 1.0\n";
    let data = json!({
        "start": text,
        "slider": computed("run", &text, &[], true)["words"],
        "answer": computed("run", &text, &[], true)["answer"],
        "record": record,
        "of_record": computed("run", of_record, &[("synthetic.at2", record.clone())], true)["words"],
        "threshold": computed("threshold", &text, &[], false)["words"],
    });
    assert_page("readers", true, &[], &data, 40);
}

/// No verdict before it is certain, links with a check sum, files that are read before anything changes, and a way back from each change.
#[test]
fn the_page_says_what_is_true() {
    let start = "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 180.0\nvoussoirs = 36\n\n[ground.half_sine]\n\
        amplitude_g = -0.35\nduration_s = 0.3\n";
    let data = json!({ "start": start, "record": file("synthetic.at2") });
    assert_page("truth", true, &[], &data, 80);
}

/// An arch in motion, six questions, choices that move, comparisons and saves.
#[test]
fn the_page_shows_an_arch_in_motion_first() {
    let documents = fs::read_dir(scenarios().join("../docs")).unwrap();
    let documents =
        documents.filter_map(|file| Some(file.unwrap().path().file_stem()?.to_str()?.to_owned()));
    let data = json!({ "documents": documents.collect::<Vec<_>>() });
    assert_page("sight", false, &[], &data, 140);
}

/// The page connects to nothing, and says what a host refuses.
#[test]
fn the_page_explains_what_hosts_refuse() {
    assert_page("hosts", true, &[], &json!({}), 14);
}

/// A telephone in the dark: nothing is cut, no text is smaller than 12 pixels.
#[test]
fn the_page_fits_telephones() {
    assert_page("narrow", false, &["--force-dark-mode"], &json!({}), 28);
}
