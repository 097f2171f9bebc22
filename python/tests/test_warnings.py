"""Warnings: what the program prints about unlikely numbers and about the trust in results, Python issues as warnings."""

from __future__ import annotations

import pickle
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
    spectrum,
    suite,
    threshold,
)

from .conftest import ROOT, Program

GUIDE = "four links are a rough guide, not on the safe side"
WEAK = Pulse.rectangular(amplitude_g=0.3, duration_s=0.2)


def issued(compute: Callable[[], Any]) -> list[str]:
    """The warnings of a computation; each names the line that called the package."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        compute()
    assert all(one.category is ArchrockWarning for one in caught)
    assert all(one.filename == __file__ for one in caught), [one.filename for one in caught]
    return [str(one.message) for one in caught]


def test_unlikely_numbers_are_warned_of(program: Program, tmp_path: Path) -> None:
    arch = Arch(mean_radius_m=500.0, thickness_ratio=0.15, embrace_deg=180.0)
    strong = Pulse.rectangular(amplitude_g=30.0, duration_s=0.2)
    unlikely = [
        "the mean radius is 500 m: is it in centimetres?",
        "the thickness is 75 m: is it in millimetres?",
        "the pulse peaks at 30 g: is its amplitude in units of gravity?",
    ]
    scenario = Scenario.of(arch, strong)
    runs: list[Callable[[], History]] = [lambda: simulate(arch, strong), scenario.run]
    for compute in runs:
        told = issued(compute)
        assert told[:3] == unlikely
        history = compute()
        assert history.summary["warnings"] == told
        # A history that is restored was warned of before.
        assert issued(lambda: pickle.loads(pickle.dumps(history))) == []
    assert issued(lambda: threshold(arch, strong, from_factor=0.5, to_factor=1.0, stride=0.5))[:3] == unlikely
    assert issued(scenario.limit) == unlikely
    assert issued(lambda: capacity(arch)) == unlikely[:2]
    (tmp_path / "s.toml").write_text(scenario.to_toml())
    said = program("run", tmp_path / "s.toml", "--out", tmp_path / "o", "--no-report").stderr
    assert [f"warning: {one}" for one in unlikely] == said.splitlines()[:3]


def test_four_links_are_a_rough_guide(arch: Arch, pulse: Pulse) -> None:
    column = Column(height_m=4.0, width_m=0.8)
    assert issued(lambda: simulate(column, WEAK)) == []
    history = simulate(arch, pulse)
    (told, *others) = issued(lambda: simulate(arch, pulse))
    assert told.startswith(f"{GUIDE}: the thrust line leaves the arch by up to ")
    assert history.summary["warnings"] == [told, *others]
    axes = {"duration_s": [0.4, 0.8], "amplitude_g": [0.2, 0.6]}
    records = [Record.read(ROOT / "scenarios" / "records" / "wave-1.at2")]
    studies: list[Callable[[Any], Any]] = [
        lambda of: overturning_map(of, WEAK, axes),
        lambda of: threshold(of, WEAK, from_factor=0.5, to_factor=2.0, stride=0.5, duration_s=60.0),
        lambda of: spectrum(of, WEAK, p_t=[1.0, 2.0], acceleration_over_incipient=[1.5, 3.0]),
        lambda of: suite(of, records, peaks_g=[0.2, 0.8], duration_s=60.0),
    ]
    for study in studies:
        (told,) = issued(lambda: study(arch))
        assert told.startswith(GUIDE)
        assert study(arch).summary["warnings"] == [told]
        assert issued(lambda: study(column)) == []
    unknown = {"samples": 2, "arch.thickness_ratio": {"deviation": 0.001}}
    (told,) = issued(lambda: ensemble(Scenario.of(arch, WEAK, uncertain=unknown)))
    assert told.startswith(GUIDE)


def test_warnings_can_be_errors(arch: Arch) -> None:
    strong = Pulse.rectangular(amplitude_g=30.0, duration_s=0.2)
    with warnings.catch_warnings():
        warnings.simplefilter("error", ArchrockWarning)
        with pytest.raises(ArchrockWarning, match="units of gravity"):
            simulate(arch, strong)
