"""Types: the package, its examples and these tests under ``mypy --strict``; docstrings that run."""

from __future__ import annotations

import doctest
import importlib
import inspect
import subprocess
import sys
from pathlib import Path

import archrock

PYTHON = Path(__file__).resolve().parents[1]


def test_mypy_is_content() -> None:
    command = [sys.executable, "-m", "mypy", "--strict", "package/archrock", "tests", "examples"]
    checked = subprocess.run(command, cwd=PYTHON, capture_output=True, text=True, check=False)
    assert checked.returncode == 0, checked.stdout + checked.stderr


def test_docstrings_say_what_is_true() -> None:
    attempted = 0
    for name in ("", "._structure", "._ground", "._studies"):
        module = importlib.import_module(f"archrock{name}")
        results = doctest.testmod(module, extraglobs=vars(archrock))
        assert results.failed == 0
        attempted += results.attempted
    assert attempted >= 9


def test_everything_public_is_documented() -> None:
    for name in archrock.__all__:
        one = getattr(archrock, name)
        assert inspect.getdoc(one), name
        if inspect.isclass(one):
            for attribute, value in vars(one).items():
                public = not attribute.startswith("_")
                if public and (callable(value) or isinstance(value, (property, classmethod))):
                    assert inspect.getdoc(getattr(one, attribute)), f"{name}.{attribute}"
