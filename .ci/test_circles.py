"""Tests the groups of .ci/circles on a small crate: `python3 .ci/test_circles.py`."""
import pathlib
import subprocess
import sys
import tempfile

CIRCLES = pathlib.Path(__file__).with_name("circles").resolve()
CRATE = {
    "src/lib.rs": "mod a;\nmod b;\nmod c;\nmod d;\nmod e;\npub use d::{Deep, Other as Renamed};\n",
    # A circle through a module below: a > b > a.
    "src/a/mod.rs": "mod below;\n",
    "src/a/below.rs": "use crate::{b::B};\n",
    "src/b.rs": "fn f() -> super::a::A {\n}\n",
    # A circle through a re-export: c > d > c.
    "src/c.rs": "use crate::Renamed;\n",
    "src/d.rs": "use super::c;\n",
    # Comments, texts and unit tests use nothing.
    "src/e.rs": '// crate::a\nconst A: &str = "crate::a";\nuse super::a::A;\n#[cfg(test)]\nmod tests {\n    use crate::a;\n}\n',
}

with tempfile.TemporaryDirectory() as folder:
    for name, text in CRATE.items():
        path = pathlib.Path(folder, name)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    pathlib.Path(folder, "src/a/below.rs").write_text("use crate::{b::B};\n#[cfg(test)]\nmod tests {\n    use crate::e;\n}\n")

    found = subprocess.run([sys.executable, CIRCLES, "src"], cwd=folder, capture_output=True, text=True)
    assert found.stdout.splitlines() == [
        "src {a, b}",
        "    a uses b: src/a/below.rs:1",
        "    b uses a: src/b.rs:1",
        "src {c, d}",
        "    c uses d: src/c.rs:1",
        "    d uses c: src/d.rs:1",
    ], found
    assert found.returncode == 1

    pathlib.Path(folder, "src/b.rs").write_text("")
    pathlib.Path(folder, "src/d.rs").write_text("")
    found = subprocess.run([sys.executable, CIRCLES, "src"], cwd=folder, capture_output=True, text=True)
    assert (found.returncode, found.stdout) == (0, ""), found
