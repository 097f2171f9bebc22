"""Both directions of the ground motion."""

from __future__ import annotations

import json

import numpy as np
import pytest

from archrock import Column, Pulse, Scenario, simulate

UNEVEN = """
[pointed_arch]
span_m = 6.0
rise_m = 4.0
thickness_m = 0.6
voussoirs = 13
[piers.right]
height_m = 2.0
width_m = 1.5
[free_hinges]
[ground.one_sine]
amplitude_g = 0.3
duration_s = 0.6
[simulation]
duration_s = 4.0
direction = "{}"
"""
ORDER = ["survives", "incomplete", "uncertain", "overturns"]


def test_the_verdict_is_that_of_the_worse_direction() -> None:
    both, given, turned = (Scenario.parse(UNEVEN.format(name)).run() for name in ("both", "as_given", "mirrored"))
    assert given.mirrored is None and turned.mirrored is None
    mirrored = both.mirrored
    assert mirrored is not None
    assert mirrored["verdict"] == turned.verdict and mirrored["outcome_time_s"] == turned.outcome_time_s
    assert both.verdict == max(given.verdict, turned.verdict, key=ORDER.index)
    # Arrays and outcome are those of the motion as given.
    np.testing.assert_array_equal(both.rotations, given.rotations)
    assert both.outcome == given.outcome
    # One of the two histories ends earlier.
    grounds = turned.ground_acceleration_m_s2, given.ground_acceleration_m_s2
    both_move = min(map(len, grounds))
    np.testing.assert_array_equal(grounds[0][:both_move], -grounds[1][:both_move])
    page = both.report_html()
    start = page.index('id="data">') + len('id="data">')
    data = json.loads(page[start : page.index("</script>", start)])
    assert {data["direction"], data["other"]["direction"]} == {"as_given", "mirrored"}


def test_a_mirrored_motion_is_that_of_the_negated_pulse() -> None:
    column = Column(height_m=4.0, width_m=0.8)
    negated = simulate(column, Pulse("half_sine", amplitude_g=-0.5, duration_s=0.4))
    mirrored = simulate(column, Pulse("half_sine", amplitude_g=0.5, duration_s=0.4), direction="mirrored")
    np.testing.assert_array_equal(mirrored.rotations, negated.rotations)
    # A symmetric column needs no second direction.
    assert negated.mirrored is None and mirrored.mirrored is None


def test_a_wrong_direction_is_refused() -> None:
    with pytest.raises(ValueError, match="direction"):
        simulate(Column(4.0, 0.8), Pulse("half_sine", amplitude_g=0.5, duration_s=0.4), direction="left")  # type: ignore[arg-type]
