"""Outcomes: a history that ends before its ground motion has no verdict, in histories and in studies."""

from __future__ import annotations

import json
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from archrock import (
    Arch,
    Column,
    History,
    Pulse,
    Record,
    Scenario,
    overturning_map,
    simulate,
    threshold,
)

from .conftest import Program, issued, run_by

ARCH = Arch(mean_radius_m=3.0, thickness_ratio=0.15, embrace_deg=150.0, voussoirs=13)


@pytest.fixture
def late() -> Record:
    """A record that is quiet for 11 s, and then strong for 1.2 s."""
    shaking_s = 0.02 * np.arange(61)
    time_s = np.concatenate([[0.0], 11.0 + shaking_s, [12.22]])
    push_g = np.concatenate([[0.0], 1.1 * np.sin(5.0 * shaking_s), [0.0]])
    return Record(time_s, push_g, unit="g")


def test_a_run_lasts_until_a_late_record_has_ended(late: Record, program: Program, tmp_path: Path) -> None:
    scenario = Scenario.of(ARCH, late)
    histories = [simulate(ARCH, late), scenario.run()]
    for history in histories:
        assert history.outcome == "overturned" and history.outcome_time_s > 11.0
        assert history.summary["verdict"] == "overturns"
    assert histories[0] == histories[1]
    run_by(program, scenario, tmp_path)
    by_program = json.loads((tmp_path / "o" / "summary.json").read_text())
    assert (by_program["verdict"], by_program["outcome_time_s"]) == ("overturns", histories[0].outcome_time_s)


@pytest.mark.parametrize("model", ["four_links", "free_hinges"])
@pytest.mark.parametrize("duration_s", [10.0, 11.2])
def test_a_history_that_ends_too_early_has_no_verdict(late: Record, model: Any, duration_s: float) -> None:
    histories: list[Callable[[], History]] = [
        lambda: simulate(ARCH, late, model=model, duration_s=duration_s),
        lambda: Scenario.of(ARCH, late, model=model, duration_s=duration_s).run(),
    ]
    for compute in histories:
        (warned,) = (one for one in issued(compute) if one.startswith("NO VERDICT"))
        assert f"the run ends at {duration_s:.4f} s and the ground moves until 12.2200 s" in warned
        history = compute()
        assert warned in history.summary["warnings"]
        assert (history.outcome, history.summary["verdict"]) == ("incomplete", "incomplete")
        assert history.overturning_sway is None and "incomplete at" in repr(history)
        assert "survives" not in history.report_html()
        assert pickle.loads(pickle.dumps(history)) == history


def test_studies_warn_of_histories_without_a_verdict(late: Record) -> None:
    def factors(duration_s: float | None) -> Any:
        return threshold(ARCH, late, from_factor=0.3, to_factor=1.5, duration_s=duration_s)

    whole = factors(None)
    assert whole.lowest_factor is not None and whole.lowest_factor < 1.0 and whole.incomplete == []
    assert not any("no verdict" in one for one in issued(lambda: factors(None)))
    (warned,) = (one for one in issued(lambda: factors(10.0)) if "no verdict" in one)
    cut = factors(10.0)
    assert warned in cut.summary["warnings"] and warned.startswith("no verdict from ")
    assert cut.lowest_factor is None and cut.bands == []
    assert [(one["from"], one["to"]) for one in cut.incomplete] == [(0.3, 1.5)]

    # After 1 s the row of the second cell still has more than a quarter of the energy that overturns it.
    row = Arch(mean_radius_m=5.0, thickness_ratio=0.15, embrace_deg=180.0, voussoirs=9)
    pulse = Pulse.rectangular(amplitude_g=0.3, duration_s=0.2)
    axes = {"duration_s": [0.2], "amplitude_g": [0.1, 0.3]}

    def cells(duration_s: float | None) -> Any:
        return overturning_map(row, pulse, axes, model="free_hinges", duration_s=duration_s)

    (warned,) = (one for one in issued(lambda: cells(1.0)) if "no verdict" in one)
    assert warned.startswith("no verdict from 1 of 2 histories")
    assert cells(1.0).outcome.tolist() == [["never_moved", "incomplete"]]
    assert not any("no verdict" in one for one in issued(lambda: cells(None)))


def test_elastic_joints_that_do_not_open_vibrate() -> None:
    column = Column(height_m=7.25, width_m=1.85)
    joints: dict[str, Any] = {"model": "elastic_joints", "normal_stiffness_gpa_m": 1.0, "duration_s": 3.0}
    history = simulate(column, Pulse.half_sine(amplitude_g=0.03, duration_s=0.274), **joints)
    assert history.outcome == "vibrates" and history.verdict == history.summary["verdict"] == "survives"
    assert repr(history) == f"<History: vibrated without opening; {len(history)} samples>"
    assert "it vibrates, and no joint opens" in history.report_html()


def test_the_verdict_is_that_of_the_program(program: Program, tmp_path: Path) -> None:
    # Steps decide whether the strong pulse overturns the arch.
    shape: dict[str, Any] = {"mean_radius_m": 4.609197050803642, "thickness_ratio": 0.13306427265472975, "embrace_deg": 157.5}
    arch, duration_s = Arch(**shape, voussoirs=5), 0.46925101434657324
    verdicts = []
    for amplitude_g in (0.5, 0.808543):
        pulse = Pulse.one_sine(amplitude_g, duration_s)
        history = simulate(arch, pulse, model="free", friction_coefficient=0.5969922684006939)
        run_by(program, history.scenario, tmp_path)
        by_program = json.loads((tmp_path / "o" / "summary.json").read_text())
        restored = pickle.loads(pickle.dumps(history))
        assert history.verdict == by_program["verdict"] == restored.verdict
        assert history.repeatability() == by_program["repeatability"] == restored.repeatability()
        assert ("UNCERTAIN" in history.report_html()) == (history.verdict == "uncertain")
        verdicts.append(history.verdict)
    assert verdicts == ["survives", "uncertain"]


def test_the_largest_body_is_that_of_the_program(program: Program, tmp_path: Path) -> None:
    pulse = Pulse.one_sine(amplitude_g=0.6, duration_s=0.5)
    drums = Column(height_m=4.0, width_m=0.8, drums=4)
    largest = set()
    for structure in (ARCH, drums):
        scenario = Scenario.of(structure, pulse, model="free_hinges", duration_s=2.0)
        history = scenario.run()
        said = run_by(program, scenario, tmp_path).stdout
        block = history.bodies[history.largest_body]
        assert f", of block {block} of {len(history.bodies)}\n" in said
        peaks_rad = [history.summary[f"peak_rotation_{block}_rad"] for block in history.bodies]
        assert peaks_rad[history.largest_body] == max(peaks_rad) == history.summary["largest_peak_rotation_rad"]
        assert pickle.loads(pickle.dumps(history)).largest_body == history.largest_body
        largest.add(history.largest_body)
    labels = [line.get_label() for line in simulate(ARCH, pulse, model="free_hinges", duration_s=2.0).plot().get_lines()]
    assert any(str(label).endswith(", which turns most") for label in labels)
    assert len(largest) == 2, "not one index for all"
