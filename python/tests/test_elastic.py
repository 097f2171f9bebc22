"""Elastic joints and observed points."""

from __future__ import annotations

import json
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from archrock import Arch, Column, Pulse, Scenario, simulate

from .conftest import Program, run_by

PULSE = Pulse("rectangular", amplitude_g=-0.3, duration_s=0.2)
STACK = Column(height_m=4.0, width_m=0.8, drums=4, density_kg_m3=2000.0)


def test_joint_forces_at_rest_equal_the_weight() -> None:
    history = simulate(
        STACK, PULSE, model="elastic_joints", normal_stiffness_gpa_m=10.0, duration_s=1.0
    )
    weight_n = 4.0 * 0.8 * 2000.0 * 9.81
    above = weight_n * np.array([4, 3, 2, 1]) / 4
    assert history.joint_forces.shape == (len(history), 4, 2)
    np.testing.assert_allclose(history.joint_forces[0, :, 0], above, rtol=1e-9)
    np.testing.assert_allclose(history.joint_stresses[0], np.stack([above, above], 1) / 0.8, rtol=1e-6)
    assert np.all(history.joint_contacts[0] == 1.0)
    assert np.nanmax(np.abs(history.joint_eccentricities)) > 0.3
    assert history.joint_contacts.min() < 0.5
    # Elastic contact lasts, so impacts are not counted.
    assert repr(history) == f"<History: still rocking at 1.0000 s; {len(history)} samples>"
    assert "survives, the same mirrored and with other steps" in history.report_html()


def test_a_row_that_only_vibrates_says_so_as_the_program_does() -> None:
    column, pulse = Column(height_m=4.631, width_m=1.254), Pulse("rectangular", amplitude_g=0.3, duration_s=0.2)
    history = simulate(
        column, pulse, duration_s=8.0, model="elastic_joints", normal_stiffness_gpa_m=10.0, damping_time_s=1e-4
    )
    assert history.outcome == "still_rocking" and history.vibrates_since_s is not None
    assert repr(history).startswith("<History: still vibrates at 8.0000 s;")


def test_a_point_moves_with_its_block() -> None:
    for options in ({}, {"model": "free_hinges"}, {"model": "elastic_joints", "normal_stiffness_gpa_m": 10.0}):
        stack = STACK if options else Column(height_m=4.0, width_m=0.8)
        history = simulate(stack, PULSE, duration_s=1.0, point=(0.0, 4.0), **options)
        turn, x, y = np.moveaxis(history.poses[:, -1], 1, 0)
        due = np.stack([x - 4.0 * np.sin(turn), y + 4.0 * np.cos(turn) - 4.0], 1)
        np.testing.assert_allclose(history.point, due, atol=1e-12)
        assert np.abs(history.point[:, 0]).max() > 1e-3
    assert simulate(STACK, PULSE, model="free_hinges", duration_s=0.1).point.shape[1] == 0


def test_conflicting_arguments_are_refused() -> None:
    arch = Arch(mean_radius_m=5.0, thickness_ratio=0.15, embrace_deg=180.0, voussoirs=7)
    with pytest.raises(ValueError, match="is in no block"):
        simulate(arch, PULSE, point=(0.0, 1.0))
    with pytest.raises(ValueError, match="lacks a stiffness"):
        simulate(arch, PULSE, model="elastic_joints")
    with pytest.raises(ValueError, match="of elastic joints only"):
        simulate(arch, PULSE, model="free_hinges", contact_points=3)
    with pytest.raises(ValueError, match="of free hinges only"):
        simulate(arch, PULSE, model="elastic_joints", normal_stiffness_gpa_m=10.0, shortest_step_s=1e-5)


def test_tie_forces_equal_the_table_of_joints() -> None:
    text = """
        column = { height_m = 4.0, width_m = 0.8 }
        tie = [{ from_m = [-0.4, 3.5], to_m = [-3.4, 3.5], to_block = 0, stiffness_n_m = 1e7, prestress_n = 5000.0, yield_force_n = 12000.0 }]
        elastic_joints = { normal_stiffness_gpa_m = 1.0 }
        ground.half_sine = { amplitude_g = -0.6, duration_s = 0.4 }
        simulation.duration_s = 1.0
    """
    history = Scenario.parse(text).run()
    forces_n, elongations_m = history.tie_forces[:, 0], history.tie_elongations[:, 0]
    assert history.tie_forces.shape == (len(history), 1)
    assert forces_n.max() == 12000.0
    # Below yielding the tie is elastic.
    early = forces_n.argmax()
    np.testing.assert_allclose(forces_n[:early], 5000.0 + 1e7 * elongations_m[:early], rtol=1e-9)
    assert simulate(STACK, PULSE, model="free_hinges", duration_s=0.1).tie_forces.shape[1] == 0


def test_the_answer_rests_on_other_stiffnesses_as_in_the_program(program: Program, tmp_path: Path) -> None:
    joints: dict[str, Any] = {"model": "elastic_joints", "normal_stiffness_gpa_m": 10.0, "duration_s": 2.0}
    history = simulate(STACK, PULSE, **joints)
    run_by(program, history.scenario, tmp_path)
    told = json.loads((tmp_path / "o" / "summary.json").read_text())
    assert history.to_quote == told["to_quote"] and history.verdict == told["verdict"]
    variations = history.variations
    assert variations == told["variations"] and len(variations) > 1
    once = simulate(STACK, PULSE, repeat=False, **joints)
    assert once == history
    assert once.to_quote == "no answer with elastic joints: the run is not repeated"
    assert once.variations == [] and pickle.loads(pickle.dumps(once)).to_quote == once.to_quote
