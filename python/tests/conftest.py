"""Fixtures of all tests, and the program with which the package is compared."""

from __future__ import annotations

import os
import subprocess
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from archrock import Arch, ArchrockWarning, Pulse, Scenario

ROOT = Path(__file__).resolve().parents[2]

Program = Callable[..., "subprocess.CompletedProcess[str]"]


def issued(compute: Callable[[], Any]) -> list[str]:
    """The warnings of a computation, with their numbers; each names the line of the tests that called the package."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        compute()
    assert all(one.category is ArchrockWarning for one in caught)
    tests = Path(__file__).parent
    assert all(Path(one.filename).parent == tests for one in caught), [one.filename for one in caught]
    warned = [one.message for one in caught]
    assert all(isinstance(one, ArchrockWarning) for one in warned)
    return [one.details for one in warned if isinstance(one, ArchrockWarning)]


def run_by(program: Program, scenario: Scenario, folder: Path) -> subprocess.CompletedProcess[str]:
    """The finished run of a scenario by the program, with files in ``folder`` and results in ``o`` there."""
    (folder / "s.toml").write_text(scenario.to_toml())
    for name, contents in scenario.files.items():
        (folder / name).write_bytes(contents)
    ran = program("run", folder / "s.toml", "--out", folder / "o", "--no-report", "--details")
    assert ran.returncode == 0, ran.stderr
    return ran


@pytest.fixture(scope="session")
def program() -> Program:
    """Runs the program of the same source with arguments; ``ARCHROCK_PROGRAM`` names one that is built already."""
    named = os.environ.get("ARCHROCK_PROGRAM")
    if named is None:
        subprocess.run(["cargo", "build", "--locked", "--quiet"], cwd=ROOT, check=True)
        target = os.environ.get("CARGO_TARGET_DIR", ROOT / "target")
        named = str(ROOT / Path(target) / "debug" / "archrock")

    def run(*arguments: object) -> subprocess.CompletedProcess[str]:
        command = [named, *map(str, arguments)]
        ran = subprocess.run(command, capture_output=True, text=True, check=False)
        # Long messages continue on indented lines.
        ran.stderr = ran.stderr.replace("\n  ", " ")
        return ran

    return run


@pytest.fixture(scope="session")
def arch() -> Arch:
    """The arch of the paper."""
    return Arch(mean_radius_m=5.0, thickness_ratio=0.15, embrace_deg=180.0)


@pytest.fixture(scope="session")
def pulse() -> Pulse:
    """The pulse of the README."""
    return Pulse.rectangular(amplitude_g=-0.30, duration_s=0.20)
