"""Python issues the warnings of the program about unlikely numbers and about limits of the results."""

from __future__ import annotations

import pickle
import subprocess
import sys
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from archrock import (
    Arch,
    ArchrockWarning,
    Column,
    History,
    Pulse,
    Record,
    Scenario,
    capacity,
    ensemble,
    overturning_map,
    simulate,
    suite,
    threshold,
    threshold_along,
    verify,
)

from .conftest import ROOT, Program, issued, run_by

GUIDE = "four links are a rough guide, not on the safe side"
OUTSIDE = "are outside the model of four links"
LOOKING = "a map of four links is for looking"
WEAK = Pulse.rectangular(amplitude_g=0.3, duration_s=0.2)
STRONG = Pulse.rectangular(amplitude_g=30.0, duration_s=0.2)


def test_unlikely_numbers_cause_warnings(program: Program, tmp_path: Path) -> None:
    arch = Arch(mean_radius_m=500.0, thickness_ratio=0.15, embrace_deg=180.0)
    unlikely = [
        "the mean radius is 500 m: is it in centimetres?",
        "the pulse peaks at 30 g: is its amplitude in units of gravity? It looks like per cent of gravity",
    ]
    scenario = Scenario.of(arch, STRONG)
    runs: list[Callable[[], History]] = [lambda: simulate(arch, STRONG), scenario.run]
    for compute in runs:
        warned = issued(compute)
        assert warned[:2] == unlikely
        history = compute()
        assert history.summary["warnings"] == warned == list(history.warnings)
        assert [(one.key, one.value, one.likely) for one in history.unlikely] == [
            ("arch.mean_radius_m", 500.0, "centimetres"),
            ("ground.rectangular.amplitude_g", 30.0, "per cent of gravity"),
        ]
        # A restored history issues no second warning.
        assert issued(lambda: pickle.loads(pickle.dumps(history))) == []
    assert issued(lambda: threshold(arch, STRONG, from_factor=0.5, to_factor=1.0, stride=0.5))[:2] == unlikely
    assert issued(scenario.limit) == unlikely
    assert issued(lambda: capacity(arch)) == unlikely[:1]
    said = run_by(program, scenario, tmp_path).stderr
    assert [f"warning: {one}" for one in unlikely] == said.splitlines()[:2]


def test_four_links_are_a_rough_guide(arch: Arch, pulse: Pulse) -> None:
    column = Column(height_m=4.0, width_m=0.8)
    assert issued(lambda: simulate(column, WEAK)) == []
    history = simulate(arch, pulse)
    (warned, *others) = issued(lambda: simulate(arch, pulse))
    assert warned.startswith(f"{GUIDE}: the thrust line leaves the arch by up to ")
    assert history.summary["warnings"] == [warned, *others]
    axes = {"duration_s": [0.4, 0.8], "amplitude_g": [0.2, 0.6]}
    records = [Record.read(ROOT / "scenarios" / "records" / "wave-1.at2")]
    studies: list[Callable[[Any], Any]] = [
        lambda of: overturning_map(of, WEAK, axes),
        lambda of: threshold(of, WEAK, from_factor=0.5, to_factor=2.0, stride=0.5, duration_s=60.0),
        lambda of: threshold_along(of, WEAK, key="ground.rectangular.duration_s", start=0.5, end=1.0, count=2, to_factor=2.0, stride=0.5, duration_s=60.0),
        lambda of: suite(of, records, peaks_g=[0.2, 0.8], duration_s=60.0),
    ]
    # Histories inside the model of four links need no warning.
    found = []
    for study in studies:
        found.append(issued(lambda: study(arch)))
        assert all(any(known in one for known in (GUIDE, OUTSIDE, LOOKING, "friction coefficient")) for one in found[-1])
        assert study(arch).summary["warnings"] == found[-1]
        assert issued(lambda: study(column)) == []
    assert any(GUIDE in one for one in found[0])
    assert [any(LOOKING in one for one in warned) for warned in found] == [True, False, False, False]
    unknown = {"samples": 2, "arch.thickness_ratio": {"deviation": 0.001}}
    strong = Pulse.rectangular(amplitude_g=-0.6, duration_s=0.8)
    (warned, *others) = issued(lambda: ensemble(Scenario.of(arch, strong, uncertain=unknown)))
    assert all("friction coefficient" in one for one in others)
    assert GUIDE in warned or OUTSIDE in warned


def test_a_loop_shows_a_warning_of_one_kind_once() -> None:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("default")
        for radius_m in (200.0, 300.0, 4e3):
            Arch(radius_m, 0.01, 30.0, voussoirs=5).limit()
    assert [str(one.message) for one in caught] == [
        "the mean radius is 200 m: is it in centimetres?",
        "the mean radius is 4000 m: is it in millimetres?",
    ]
    (first, *_) = (one.message for one in caught)
    assert isinstance(first, ArchrockWarning)
    for same in (first, pickle.loads(pickle.dumps(first))):
        assert same.details == "the mean radius is 200 m: is it in centimetres?" and same.numbers == (200.0,)
    # Names of files keep their digits.
    wave = ArchrockWarning("wave-1.at2 and r2.csv peak at -3.5e-4 g (at 0.25 s).")
    assert wave.numbers == (-3.5e-4, 0.25)
    assert str(wave) == f"{wave}" == wave.details


def test_a_shown_warning_has_its_numbers() -> None:
    code = "from archrock import Arch\nfor radius_m in (200.0, 300.0):\n    Arch(radius_m, 0.01, 30.0, voussoirs=5).limit()\n"
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stderr
    assert shown.count("is it in centimetres?") == 1 and "ArchrockWarning: the mean radius is 200 m: is it" in shown
    failed = subprocess.run([sys.executable, "-W", "error", "-c", code], capture_output=True, text=True, check=False).stderr
    assert failed.rstrip().endswith("the mean radius is 200 m: is it in centimetres?")


def test_checks_issue_the_warnings_of_the_program() -> None:
    site = {"soil": "B", "topography": "T1", "slv": {"ag_g": 0.25, "f0": 2.40, "tc_star_s": 0.35}}
    arch = Arch(mean_radius_m=500.0, thickness_ratio=0.15, embrace_deg=150.0, voussoirs=15)
    warned = issued(lambda: verify(arch, site))
    assert "the mean radius is 500 m: is it in centimetres?" in warned
    assert verify(arch, site).summary["warnings"] == warned
    assert list(arch.limit().warnings) == issued(arch.limit) != []


def test_warnings_can_be_errors(arch: Arch) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error", ArchrockWarning)
        with pytest.raises(ArchrockWarning, match="units of gravity"):
            simulate(arch, STRONG)


def test_messages_name_no_options_of_the_program(arch: Arch, pulse: Pulse) -> None:
    history = simulate(arch, pulse)
    study = overturning_map(arch, pulse, {"duration_s": [0.4, 0.8], "amplitude_g": [0.2, 0.6]})
    warned = [*history.summary["warnings"], *study.summary["warnings"]]
    assert len(warned) >= 2 and all("compare with free hinges" in one for one in warned if GUIDE in one)
    late: dict[str, Any] = {"right": {"delay_s": 0.1}}
    wrong: list[Callable[[], Any]] = [
        lambda: simulate(arch, pulse, **late),
        lambda: Scenario.of(arch, pulse, **late),
        lambda: Scenario.parse(Scenario.of(arch, model="free_hinges").to_toml() + "[elastic_joints]\nnormal_stiffness_gpa_m = 1.0\n"),
    ]
    for make in wrong:
        with pytest.raises(ValueError) as caught:
            make()
        warned.append(str(caught.value))
    assert not any("--" in one or "archrock " in one for one in warned), warned
    with pytest.raises(ValueError) as caught:
        Scenario.parse(Scenario.of(arch).to_toml(), changes=["arch.thickness_ratio=5"])
    assert str(caught.value).startswith('changes "arch.thickness_ratio=5": `thickness_ratio = 5`'), caught.value
