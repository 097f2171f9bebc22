"""Results follow from the JSON of the library: every key is an attribute, and the reference explains it."""

from __future__ import annotations

import copy
import json
import pickle
from pathlib import Path
from typing import Any

import pytest

from archrock import (
    Arch,
    Column,
    Event,
    Hinge,
    Pulse,
    Structure,
    Summary,
    capacity,
    simulate,
    threshold,
    verify,
)

from .conftest import ROOT

PULSE = Pulse.rectangular(amplitude_g=-0.30, duration_s=0.20)
BLOCKS = Arch(5.0, 0.15, 180.0, voussoirs=12)
SITE = {"soil": "B", "topography": "T1", "slv": {"ag_g": 0.25, "f0": 2.40, "tc_star_s": 0.35}}
CASES: dict[str, Any] = {
    "run": lambda: [
        simulate(Arch(5.0, 0.15, 180.0), PULSE, duration_s=2.0),
        simulate(BLOCKS, PULSE, model="free_hinges", duration_s=0.5),
        simulate(BLOCKS, PULSE, model="elastic_joints", normal_stiffness_gpa_m=1.0, duration_s=0.5),
    ],
    "capacity": lambda: [capacity(Column(4.0, 0.8))],
    "threshold": lambda: [threshold(Column(4.0, 0.8), PULSE, from_factor=1.0, to_factor=4.0, stride=0.2)],
    "verify": lambda: [verify(Column(4.0, 0.8), SITE)],
}


def reference(study: str) -> set[str]:
    """The keys in a table of ``docs/json.md``."""
    text = (ROOT / "docs" / "json.md").read_text(encoding="utf-8")
    table = text.split(f"\n### `{study}`\n")[1].split("\n### ")[0]
    return {line.split("`")[1] for line in table.splitlines() if line.startswith("| `")}


@pytest.mark.parametrize("study", CASES)
def test_keys_of_a_summary_are_attributes(study: str) -> None:
    known = reference(study)
    for results in CASES[study]():
        summary = results.summary
        assert isinstance(summary, Summary) and json.loads(json.dumps(summary)) == summary.to_dict() == summary
        assert "to_dict" in dir(summary) and set(summary) <= set(dir(results))
        for key, value in summary.items():
            # The names of the bodies are part of these keys.
            assert key in known or key.startswith("peak_rotation_"), key
            assert getattr(summary, key) == value
            # Attributes that the class has by itself come first.
            assert hasattr(type(results), key) or getattr(results, key) == value
        tables = summary.get("scenario") or results.scenario
        assert tables.simulation.gravity_m_s2 == 9.81
        for restored in (pickle.loads(pickle.dumps(results)), copy.deepcopy(results)):
            assert restored.summary == summary and set(dir(restored)) == set(dir(results))
        with pytest.raises(AttributeError, match="no attribute 'largest_frog'"):
            results.largest_frog
        with pytest.raises(AttributeError, match="this Summary has no key 'largest_frog'; its keys are: "):
            summary.largest_frog  # type: ignore[attr-defined]
        # It is a copy.
        summary.clear()
        assert results.summary


def test_keys_of_events_are_attributes() -> None:
    known = reference("event")
    four = simulate(Arch(5.0, 0.15, 180.0), PULSE, duration_s=2.0)
    free = simulate(BLOCKS, PULSE, model="free_hinges", duration_s=2.0, friction_coefficient=0.8)
    for history in (four, free):
        for event in history.events:
            assert isinstance(event, Event) and set(event) <= known
            assert all(getattr(event, key) == event[key] for key in event)
        for impact in history.impacts:
            assert {f"impact.{key}" for key in impact} - known == {"impact.time_s", "impact.sway_after"}
            assert {impact.sway_before, impact.sway_after} == {"left", "right"}
    assert four.impacts[0].opened[0].angle_deg == 0.0 and four.impacts[0].opened[0].joint is None
    assert all(impact.friction_j >= 0.0 for impact in free.impacts)
    assert all(0 <= hinge.joint <= 12 for event in free.events for hinge in event.hinges)


def test_events_of_ties_have_their_number() -> None:
    tie = {"height_m": 2.0, "stiffness_n_m": 1e7, "prestress_n": 1e3, "yield_force_n": 1.1e3}
    arch = {"mean_radius_m": 5.0, "thickness_ratio": 0.15, "embrace_deg": 180.0, "voussoirs": 12}
    history = simulate(Structure(arch=arch, tie=[tie]), PULSE, model="free_hinges", duration_s=0.5)
    assert [event.tie for event in history.events if event.kind == "tie_yields"] == [0]


def test_parts_of_summaries_compare_by_value() -> None:
    (event, *_) = simulate(Arch(5.0, 0.15, 180.0), PULSE, duration_s=2.0).events
    limit = BLOCKS.limit()
    parts: list[Any] = [event, event.hinges[0], limit, limit.right, BLOCKS.chain(1)[0]]
    for part in parts:
        for same in (pickle.loads(pickle.dumps(part)), copy.deepcopy(part)):
            assert same == part and hash(same) == hash(part) and type(same) is type(part) and repr(same) == repr(part)
        changes: list[Any] = [
            lambda part=part: part.update(a=1),
            lambda part=part: part.pop("edge"),
            lambda part=part: part.__setitem__("edge", 1),
            part.clear,
        ]
        for change in changes:
            with pytest.raises(TypeError, match="cannot be changed"):
                change()
        with pytest.raises(AttributeError):
            part.time_s = 1.0
    assert Hinge(joint=3, edge="intrados") in {Hinge({"joint": 3, "edge": "intrados"})}
    assert repr(Hinge(joint=3, edge=None)) == "Hinge(joint=3, edge=None)" and Hinge(joint=3).toe is None
    with pytest.raises(AttributeError, match="'corner'"):
        Hinge(joint=3).corner  # type: ignore[attr-defined]
    assert limit.right.hinges == limit["mechanism"]["right"] and limit.details["mechanism"]["left"]


def test_the_guide_names_keys_that_exist() -> None:
    guide = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
    named = {"run": ["dimensionless.p_rad_s"], "threshold": ["models.bands"], "verify": ["zeta_e", "verdict"]}
    for study, keys in named.items():
        for key in keys:
            assert key in reference(study) and key.rsplit(".", 1)[-1] in guide, key
    assert "json.md" in guide or "results.md" in guide
