"""Limit analysis and capacity of scenarios that cannot be simulated."""

from __future__ import annotations

import json
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from archrock import (
    Arch,
    Capacity,
    Column,
    Limit,
    Pulse,
    Scenario,
    capacity,
    compute_part,
    ensemble,
    overturning_map,
    threshold,
    verify,
)

from .conftest import Program

ARCH = "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 180.0\nvoussoirs = 15\n"
DRUMS = "[column]\nheight_m = 4.0\nwidth_m = 0.8\ndrums = 4\n"
SITE = '[demand]\nsoil = "B"\ntopography = "T1"\nslv = { ag_g = 0.25, f0 = 2.40, tc_star_s = 0.35 }\n'
WAVE = "[ground.half_sine]\namplitude_g = 0.3\nduration_s = 0.5\n"
MISSING = '[ground.record]\nfile = "none.at2"\n'
PLANE = "[map]\nduration_s = [0.2, 0.3]\namplitude_g = [0.2, 0.4]\n"
UNKNOWN = '[uncertain]\nsamples = 4\n"arch.depth_m" = { deviation = 0.1 }\n'

FILES = {
    "missing": ARCH + MISSING + UNKNOWN,
    "faulty": ARCH + '[ground.record]\nfile = "faulty.at2"\n',
    "right": ARCH + '[free_hinges]\n' + WAVE + '[ground.right.record]\nfile = "none.at2"\n',
    "drums": DRUMS + WAVE + PLANE,
    "moved": ARCH + WAVE + "[supports.right]\nspread_m = 0.02\n",
    "both": DRUMS + MISSING + SITE,
}


@pytest.fixture(params=list(FILES))
def path(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """A scenario that cannot be simulated."""
    path = tmp_path / f"{request.param}.toml"
    path.write_text(FILES[request.param])
    (tmp_path / "faulty.at2").write_text("no record\n")
    return path


def answers(scenario: Scenario) -> tuple[Limit, Capacity | None]:
    return scenario.limit(), None if "supports" in scenario.tables else capacity(scenario)


def test_limit_and_capacity_are_those_of_the_program(path: Path, program: Program, tmp_path: Path) -> None:
    scenario = Scenario.read(path)
    limit, curves = answers(scenario)
    printed = json.loads(program("limit", path, "--format", "json").stdout)
    assert limit.details == printed
    if curves is not None:
        assert program("capacity", path, "--out", tmp_path / "o").returncode == 0
        for name, contents in curves.files.items():
            if not name.endswith(".svg"):
                assert (tmp_path / "o" / name).read_bytes() == contents, name
    sent = pickle.loads(pickle.dumps(scenario))
    assert sent == scenario and answers(sent) == (limit, curves)


def test_simulations_raise_the_error_of_the_program(path: Path, program: Program, tmp_path: Path) -> None:
    scenario = Scenario.read(path)
    sent = pickle.loads(pickle.dumps(scenario))
    printed = program("run", path, "--out", tmp_path / "o").stderr.removeprefix("error: ").strip()
    assert printed.startswith(f"{path}:")
    moves: list[Callable[[Scenario], Any]] = [
        Scenario.run,
        Scenario.memory_gb,
        threshold,
        overturning_map,
        ensemble,
        lambda of: compute_part(of, "map", (1, 2), tmp_path / "parts"),
    ]
    for move in moves:
        for of in (scenario, sent):
            with pytest.raises(ValueError) as caught:
                move(of)
            assert str(caught.value) == printed


def test_a_check_needs_no_motion(path: Path, program: Program, tmp_path: Path) -> None:
    scenario = Scenario.read(path)
    if "demand" not in scenario.tables:
        with pytest.raises(ValueError, match="demand|supports"):
            verify(scenario)
        return
    assert program("verify", path, "--out", tmp_path / "o").returncode == 0
    assert verify(scenario).files["verify.json"] == (tmp_path / "o" / "verify.json").read_bytes()


def test_errors_that_concern_statics_are_raised_on_reading(tmp_path: Path) -> None:
    for wrong in ("thickness_ratio = 5.0", "thicknes_ratio = 0.15"):
        text = ARCH.replace("thickness_ratio = 0.15", wrong) + MISSING
        with pytest.raises(ValueError) as caught:
            Scenario.parse(text, str(tmp_path / "s.toml"))
        # All errors are reported together, that of the record too.
        assert wrong.split()[0] in str(caught.value) and "none.at2" in str(caught.value)
    for wrong in ('format = 3', "scael = 2.0"):
        with pytest.raises(ValueError, match=wrong.split()[0]):
            Scenario.parse(ARCH + MISSING + wrong)


def test_statics_of_objects_need_no_motion(pulse: Pulse) -> None:
    drums = Column(height_m=4.0, width_m=0.8, drums=4)
    whole = Column(height_m=4.0, width_m=0.8)
    limit = drums.limit().right.acceleration_g
    assert limit is not None and limit == pytest.approx(0.2, abs=1e-9)
    onset = capacity(drums).side("right")["acceleration_g"][0]
    assert onset == pytest.approx(capacity(whole).side("right")["acceleration_g"][0])
    scenario = Scenario.of(drums, pulse)
    assert scenario.limit() == drums.limit() and capacity(scenario) is not None
    with pytest.raises(ValueError, match="free_hinges"):
        scenario.run()
    moved = Scenario.of(
        Arch(mean_radius_m=5.0, thickness_ratio=0.15, embrace_deg=180.0, voussoirs=15),
        supports={"right": {"spread_m": 0.02}},
    )
    assert moved.limit().right.acceleration_g is not None
    # A model that the caller chooses must suit the structure.
    with pytest.raises(ValueError, match="free_hinges"):
        Scenario.of(drums, pulse, model="four_links")


def test_moved_springings_are_not_ignored() -> None:
    """Capacity and check apply to the undeformed structure only, so moved springings are an error."""
    moved = Scenario.parse(ARCH + SITE + "[free_hinges]\n[supports.right]\nspread_m = 0.02\n")
    answers: list[Callable[[Scenario], Any]] = [capacity, verify]
    for answer in answers:
        with pytest.raises(ValueError, match=r"leave \[supports\] out"):
            answer(moved)
