"""Tests the counts of .ci/lines on a package with code in every possible place: `python3 .ci/test_lines.py`."""
import pathlib
import subprocess
import sys
import tempfile

LINES = pathlib.Path(__file__).with_name("lines").resolve()
PACKAGE = {
    "Cargo.toml": '[package]\nname = "a"\n[dependencies]\nm = { path = "macros" }\n',
    "askama.toml": '[general]\ndirs = ["words"]\n',
    "build.rs": "fn main() {}\n",
    "macros/Cargo.toml": '[package]\nname = "m"\n',
    "macros/src/lib.rs": "fn m() {}\n",
    "words/answer.txt": "one{# comment #}\n\n{# comment\n of two lines #}\n",
    "page.html": "<!-- comment\n of two lines -->\n<p>one</p>\n",
    "vendor/plot.js": "vendored\n",
    "data.toml": "data = 1\n",
    "src/lib.rs": (
        "//! comment\n"
        'const A: &str = include_str!("../page.html");\n'
        'const B: &str = concat!(include_str!("../vendor/plot.js"), include_str!("../data.toml"));\n'
        "/* comment\n of two lines */ mod below;\n"
        "#[cfg(test)]\nmod far;\n#[cfg(test)]\nmod near {\n    fn test() {}\n}\n"
    ),
    "src/below.rs": "fn f() {\n" + "    a();\n" * 79 + "}\n",
    "src/far.rs": "fn test() {}\n",
    "src/page.js": "// comment\n/* comment */\none();\n",
    "src/page.css": "/* comment */\n.one {}\n",
}
COUNTED = {
    "build.rs": 1, "macros/src/lib.rs": 1, "words/answer.txt": 1, "page.html": 1,
    "src/lib.rs": 3, "src/below.rs": 81, "src/page.js": 1, "src/page.css": 1,
}  # fmt: skip


def run(folder: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, LINES, *arguments, "src"], cwd=folder, capture_output=True, text=True)


with tempfile.TemporaryDirectory() as folder:
    for name, text in PACKAGE.items():
        path = pathlib.Path(folder, name)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)

    rows = [line.split(maxsplit=1) for line in run(folder).stdout.splitlines()]
    files = {name: int(count) for count, name in rows if not name.endswith(("in all", "of Rust")) and name != "src"}
    assert files == COUNTED, files
    assert [int(count) for count, name in rows if name == "src"] == [sum(COUNTED.values())], rows
    # 6 of each of the two small functions, 37 of lib.rs, 322 of below.rs.
    assert ["371", "src, tokens of Rust"] in rows, rows

    limits = run(folder, "--limits")
    assert (limits.returncode, limits.stderr) == (1, "too long: src/below.rs: fn f: 81 lines\n"), limits

    built = pathlib.Path(folder, "a.d")
    built.write_text(f"{folder}/a: {folder}/src/lib.rs {folder}/data.toml {folder}/vendor/plot.js {folder}/page.html\n")
    assert run(folder, "--built", "a.d").returncode == 0
    built.write_text(f"{folder}/a: {folder}/src/lib.rs {folder}/hidden.inc\n")
    pathlib.Path(folder, "hidden.inc").touch()
    assert run(folder, "--built", "a.d").stderr == "built, but not counted: hidden.inc\n"
