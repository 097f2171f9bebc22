"""Types: the package, its examples and these tests under ``mypy --strict``; docstrings that run."""

from __future__ import annotations

import doctest
import importlib
import inspect
import subprocess
import sys
from pathlib import Path
from typing import get_args

import archrock
from archrock._native import MODELS
from archrock._structure import Model

PYTHON = Path(__file__).resolve().parents[1]


def test_mypy_reports_no_errors() -> None:
    command = [sys.executable, "-m", "mypy", "--strict", "package/archrock", "tests", "examples"]
    checked = subprocess.run(command, cwd=PYTHON, capture_output=True, text=True, check=False)
    assert checked.returncode == 0, checked.stdout + checked.stderr


def test_models_have_the_names_of_the_library() -> None:
    assert list(get_args(Model)) == [name for names in MODELS for name in names]


def test_examples_in_docstrings_are_correct() -> None:
    attempted = 0
    for name in ("", "._structure", "._ground", "._studies"):
        module = importlib.import_module(f"archrock{name}")
        results = doctest.testmod(module, extraglobs=vars(archrock))
        assert results.failed == 0
        attempted += results.attempted
    assert attempted >= 9


def assert_typed(name: str, function: object) -> None:
    """Asserts that every argument and the return value have a type."""
    assert callable(function), name
    signature = inspect.signature(function)
    assert signature.return_annotation is not inspect.Signature.empty, name
    for argument in list(signature.parameters.values()):
        if argument.name not in ("self", "cls"):
            assert argument.annotation is not inspect.Parameter.empty, f"{name}({argument.name})"


def test_everything_public_is_documented_and_typed() -> None:
    for name in archrock.__all__:
        one = getattr(archrock, name)
        text = inspect.getdoc(one)
        assert text, name
        if not inspect.isclass(one):
            assert_typed(name, one)
            continue
        for attribute, value in vars(one).items():
            if attribute.startswith("_"):
                continue
            if isinstance(value, property):
                assert inspect.getdoc(value), f"{name}.{attribute}"
                assert_typed(f"{name}.{attribute}", value.fget)
            elif callable(value) or isinstance(value, (classmethod, staticmethod)):
                assert inspect.getdoc(getattr(one, attribute)), f"{name}.{attribute}"
                assert_typed(f"{name}.{attribute}", getattr(one, attribute))
