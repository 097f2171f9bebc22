"""The installed package: its metadata, its licences, and the examples of the pages that describe it."""

from __future__ import annotations

import os
import subprocess
import sys
from importlib.metadata import files, metadata
from pathlib import Path

import pytest

from .conftest import ROOT


@pytest.mark.parametrize("page", ["python/README.md", "docs/python.md"])
def test_the_first_example_of_a_page_runs_as_printed(page: str, tmp_path: Path) -> None:
    code = (ROOT / page).read_text(encoding="utf-8").split("```python\n")[1].split("```")[0]
    command = [sys.executable, "-W", "ignore", "-c", code]
    environment = {**os.environ, "MPLBACKEND": "Agg"}
    ran = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
    printed = ran.stdout.splitlines()
    said_there = [line for line in code.splitlines() if line.startswith(("print(", "# "))]
    comments = [comment for comment in (line.partition("# ")[2] for line in said_there) if comment]
    assert comments and len(printed) == len(comments)
    for said, comment in zip(printed, comments):
        assert said.startswith(comment.partition("...")[0]), (said, comment)
    named = [word for word in code.split('"') if word.endswith((".png", ".gif", ".html"))]
    assert named and all((tmp_path / name).stat().st_size > 1000 for name in named)


def test_the_package_has_its_description_licences_and_extras() -> None:
    installed = files("archrock") or []

    def texts(name: str) -> list[str]:
        return [file.read_text(encoding="utf-8") for file in installed if file.name == name]

    assert "\n# archrock for Python\n" in texts("METADATA")[0]
    for name in ["LICENSE-MIT", "LICENSE-APACHE"]:
        assert texts(name) == [(ROOT / name).read_text(encoding="utf-8")]
    found = metadata("archrock")
    assert found["License-Expression"] == "MIT OR Apache-2.0"
    assert {"plot", "pandas", "cluster"} <= set(found.get_all("Provides-Extra") or [])
