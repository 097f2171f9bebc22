//! Pages in a real browser, if there is one.
#![allow(clippy::print_stderr)]

use std::fs;
use std::path::Path;
use std::process::Command;

const BROWSERS: [&str; 4] = [
    "chromium-headless-shell",
    "chromium",
    "chromium-browser",
    "google-chrome",
];

/// The installed browser, if any.
fn browser() -> Option<&'static str> {
    let browser = BROWSERS.into_iter().find(|name| {
        let version = Command::new(name).arg("--version").output();
        version.is_ok_and(|output| output.status.success())
    });
    if browser.is_none() {
        eprintln!("no browser here ({BROWSERS:?}): the page is not checked in one");
    }
    browser
}

/// The result of a page's own script `check`, which has `data` and calls `verify(true or false, "what")`;
/// `None`, with a message, if there is no browser. Errors on the console count as failed checks.
///
/// `settings` are arguments of the browser. Its time is virtual and it draws no frames, so a timer replaces
/// them.
pub fn checked(page: &Path, check: &str, data: &str, settings: &[&str]) -> Option<String> {
    let browser = browser()?;
    let html = fs::read_to_string(page).unwrap();
    let before = "<script>window.failures = []; window.passed = 0;\
        window.verify = (holds, what) => { if (holds) passed += 1; else failures.push(what); };\
        window.addEventListener('error', (event) => verify(false, `error: ${event.message}`));\
        window.addEventListener('unhandledrejection', (event) => verify(false, `error: ${event.reason}`));\
        window.requestAnimationFrame = (tick) => setTimeout(() => tick(performance.now()), 16);\
        const error = console.error; console.error = (...words) => { verify(false, `console: ${words}`); };\
        </script>";
    let after = format!(
        "<script>const check = async () => {{ const data = {data};\n{check}\n}};\
         check().catch((error) => verify(false, `${{error}} ${{error.stack}}`)).then(() => {{\
         const verdict = document.createElement('pre'); verdict.id = 'verdict';\
         verdict.textContent = `${{passed}} passed\\n` + failures.join('\\n'); document.body.append(verdict); }});\
         </script>"
    );
    let html = html.replacen("<head>", &format!("<head>{before}"), 1);
    let html = html.replacen("</body>", &format!("{after}</body>"), 1);
    let copy = page.with_extension("checked.html");
    fs::write(&copy, html).unwrap();
    let output = Command::new(browser)
        .args([
            "--no-sandbox",
            "--disable-gpu",
            "--window-size=1100,1400",
            "--virtual-time-budget=20000",
            "--dump-dom",
        ])
        .args(settings)
        .arg(format!("file://{}", copy.display()))
        .output()
        .unwrap();
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
    let output = Command::new(browser()?)
        .args(["--no-sandbox", "--disable-gpu", "--no-pdf-header-footer"])
        .arg(format!("--print-to-pdf={}", pdf.display()))
        .arg(format!("file://{}", page.display()))
        .output()
        .unwrap();
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
