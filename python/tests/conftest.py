"""What the tests share: the program, with whose results those of the package are compared."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from archrock import Arch, Pulse

ROOT = Path(__file__).resolve().parents[2]

Program = Callable[..., "subprocess.CompletedProcess[str]"]


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
        return subprocess.run(command, capture_output=True, text=True, check=False)

    return run


@pytest.fixture(scope="session")
def arch() -> Arch:
    """The arch of the paper."""
    return Arch(mean_radius_m=5.0, thickness_ratio=0.15, embrace_deg=180.0)


@pytest.fixture(scope="session")
def pulse() -> Pulse:
    """The pulse of the README."""
    return Pulse.rectangular(amplitude_g=-0.30, duration_s=0.20)
