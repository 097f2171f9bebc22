//! Pages in a real browser, if there is one.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use super::program::skip_without;

const BROWSERS: [&str; 4] = [
    "chromium-headless-shell",
    "chromium",
    "chromium-browser",
    "google-chrome",
];

/// Arguments of every browser. A full browser opens a window and looks for updates unless told otherwise.
const ARGUMENTS: [&str; 8] = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
];

/// The installed browser with these further arguments for an address, and a new profile; `None`, with a message, if there is no browser.
pub fn browser(arguments: &[&str], address: &str) -> Option<(Command, tempfile::TempDir)> {
    let browser = BROWSERS.into_iter().find(|name| {
        let version = Command::new(name).arg("--version").output();
        version.is_ok_and(|output| output.status.success())
    });
    let Some(browser) = browser else {
        skip_without(&BROWSERS.join(" or "));
        return None;
    };
    let profile = tempfile::tempdir().unwrap();
    let mut command = Command::new(browser);
    command
        .args(ARGUMENTS)
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .args(arguments)
        .arg(address);
    Some((command, profile))
}

/// Setting of a page that may move by itself.
pub const IN_MOTION: &str = "--force-prefers-no-reduced-motion";

/// Output of the installed browser with these further arguments for a page; `None`, with a message, if there is no browser.
fn browse(arguments: &[&str], page: &Path) -> Option<Output> {
    let (mut command, _profile) = browser(arguments, &format!("file://{}", page.display()))?;
    Some(command.output().unwrap())
}

/// The result of a page's own script `check`, which has `data` and calls `verify(true or false, "what")`;
/// `None`, with a message, if there is no browser. Errors on the console count as failed checks.
///
/// `settings` are further arguments of the browser. A window size among them is that of a frame: the window of a full browser is
/// never as narrow as that of a phone. Time is virtual and nothing is drawn, so a timer replaces frames of an animation.
pub fn checked(page: &Path, check: &str, data: &str, settings: &[&str]) -> Option<String> {
    let html = fs::read_to_string(page).unwrap();
    // Animations do not start by themselves, unless `IN_MOTION` allows it.
    let in_motion = settings.contains(&IN_MOTION);
    let before = "<script>window.failures = []; window.passed = 0;\
        ((media) => { window.matchMedia = (query) =>\
        query.includes('reduced-motion') ? { matches: !IN_MOTION } : media(query); })(window.matchMedia.bind(window));\
        window.verify = (holds, what) => { if (holds) passed += 1; else failures.push(what); };\
        window.addEventListener('error', (event) => verify(false, `error: ${event.message}`));\
        window.addEventListener('unhandledrejection', (event) => verify(false, `error: ${event.reason}`));\
        window.requestAnimationFrame = (tick) => setTimeout(() => tick(performance.now()), 16);\
        const error = console.error; console.error = (...words) => { verify(false, `console: ${words}`); };\
        </script>";
    let before = before.replace("IN_MOTION", if in_motion { "true" } else { "false" });
    let after = format!(
        "<script>const check = async () => {{ await window.archrock?.ready; const data = {data};\n{check}\n}};\
         check().catch((error) => verify(false, `${{error}} ${{error.stack}}`)).then(() => {{\
         const verdict = document.createElement('pre'); verdict.id = 'verdict';\
         verdict.textContent = `${{passed}} passed\\n` + failures.join('\\n'); document.body.append(verdict);\
         parent.postMessage(verdict.textContent, '*'); }});\
         </script>"
    );
    let html = html.replacen("<head>", &format!("<head>{before}"), 1);
    let html = html.replacen("</body>", &format!("{after}</body>"), 1);
    let copy = page.with_extension("checked.html");
    fs::write(&copy, html).unwrap();
    let framed = page.with_extension("framed.html");
    let mut sizes = settings.iter();
    let size = sizes.find_map(|setting| setting.strip_prefix("--window-size=")?.split_once(','));
    let shown = match size {
        Some((width, height)) => {
            let frame = format!(
                "<!doctype html><html><head></head><body><script>addEventListener('message', ({{ data }}) => {{\
                 const verdict = document.createElement('pre'); verdict.id = 'verdict'; verdict.textContent = data;\
                 document.body.append(verdict); }});</script>\
                 <iframe src=\"{}\" width=\"{width}\" height=\"{height}\"></iframe></body></html>",
                copy.file_name().unwrap().to_str().unwrap()
            );
            fs::write(&framed, frame).unwrap();
            &framed
        }
        None => &copy,
    };
    let arguments = [
        "--virtual-time-budget=20000",
        "--dump-dom",
        "--window-size=1100,1400",
    ];
    let settings = settings.iter().copied();
    let settings = settings.filter(|setting| !setting.starts_with("--window-size="));
    let arguments: Vec<&str> = arguments.into_iter().chain(settings).collect();
    let output = browse(&arguments, shown)?;
    let dom = String::from_utf8_lossy(&output.stdout);
    let verdict = dom
        .split_once("<pre id=\"verdict\">")
        .and_then(|(_, after)| after.split_once("</pre>"));
    let (verdict, _) = verdict.unwrap_or_else(|| {
        panic!(
            "no verdict; the browser says {}",
            String::from_utf8_lossy(&output.stderr)
        )
    });
    Some(verdict.to_owned())
}

/// A check that every `<data>` of a page is a number of its JSON, rounded.
pub const DATA_ARE_IN_THE_JSON: &str = "
const known = new Set();
const walk = (value) => {
  if (typeof value === 'number') known.add(value);
  else if (value && typeof value === 'object') Object.values(value).forEach(walk);
};
walk(data);
document.querySelectorAll('data').forEach((element) => {
  const value = Number(element.value);
  const text = element.textContent;
  const decimals = (text.split('.')[1] ?? '').length;
  verify(known.has(value), `${element.value} is not in the JSON`);
  verify(Math.abs(Number(text) - value) <= 0.5000001 * 10 ** -decimals, `${text} ${element.value}`);
});
";

/// Number of sheets of paper on which a page is printed; `None`, with a message, if there is no browser.
pub fn sheets(page: &Path) -> Option<usize> {
    let pdf = page.with_extension("pdf");
    let print = format!("--print-to-pdf={}", pdf.display());
    let output = browse(&["--no-pdf-header-footer", &print], page)?;
    let printed =
        fs::read(&pdf).unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)));
    let printed = String::from_utf8_lossy(&printed);
    let pages = printed.matches("/Type /Page").count() - printed.matches("/Type /Pages").count();
    Some(pages)
}

/// Asserts that all checks of a page pass, at least this many.
pub fn assert_checked(page: &Path, check: &str, data: &str, settings: &[&str], least: usize) {
    if let Some(verdict) = checked(page, check, data, settings) {
        let (passed, failures) = verdict.split_once(" passed\n").unwrap();
        assert!(failures.is_empty(), "{failures}");
        assert!(passed.parse::<usize>().unwrap() >= least, "{verdict}");
    }
}
