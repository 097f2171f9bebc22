"""Structures, grounds, scenarios and histories as objects: natural use, error messages, copies and comparison."""

from __future__ import annotations

import copy
import json
import os
import pickle
import re
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import archrock
from archrock import Arch, Body, Column, Event, Pulse, Record, Scenario, Structure, simulate

from .conftest import ROOT, Program

SCENARIOS = ROOT / "scenarios"


def test_the_arch_of_the_paper(arch: Arch, pulse: Pulse) -> None:
    limit = arch.limit()
    assert limit.right.acceleration_g == pytest.approx(0.14432644, abs=1e-8)
    assert [round(h.angle_deg or 0.0, 3) for h in limit.right.hinges] == [24.014, 81.787, 139.561, 180.0]
    assert [h.edge for h in limit.right.hinges] == ["intrados", "extrados", "intrados", "extrados"]
    assert arch.chain(2)[0].restitution == pytest.approx(0.681186, abs=1e-6)

    history = simulate(arch, pulse)
    assert (history.outcome, history.overturning_sway) == ("rest", None)
    assert history.impacts[0].time_s == pytest.approx(1.0279, abs=1e-4)
    assert len(history.impacts) == history.summary["impacts"] == 78
    assert history.events[0].kind == "uplift" and isinstance(history.events[0], Event)
    assert history.bodies == ("left", "middle", "right")
    assert history.rotations.shape == history.rates.shape == (675, 3)
    assert history.poses.shape == (675, 3, 3) and history.gaps.shape == (675, 0, 2)
    assert np.array_equal(history.poses[:, :, 0], history.rotations)
    assert history.time[1] == 0.005 and len(history) == 675
    assert set(history.state) == {"right", "left", "rest"}
    assert history.phase[-1] == len(history.events)
    assert repr(history) == "<History: came to rest at 3.3656 s after 78 impacts; 675 samples>"


def test_overturning_names_the_side(arch: Arch) -> None:
    history = simulate(arch, Pulse.one_cosine(amplitude_g=0.6, duration_s=0.8))
    assert history.outcome == "overturned" and history.overturning_sway in ("left", "right")
    assert str(history.overturning_sway) in repr(history)


def test_a_column_moves_away_from_the_wall_behind_it() -> None:
    sine = Pulse.one_sine(amplitude_g=-0.25, duration_s=1.0)
    history = simulate(Column(8.0, 0.6, back={"side": "left"}), sine, duration_s=20.0)
    # A sway to the right turns clockwise, and impacts leave the side.
    assert history.outcome == "rest" and history.rotations.max() <= 0.0 < -history.rotations.min()
    slenderness_rad = np.arctan(0.6 / 8.0)
    rate_ratio = (1.0 - 1.5 * np.sin(slenderness_rad) ** 2) ** 2 * (1.5 * np.cos(slenderness_rad) ** 2 - 1.0)
    impacts = history.impacts
    assert len(impacts) > 1
    assert all(impact.restitution == pytest.approx(rate_ratio**2, rel=1e-9) for impact in impacts)
    free = simulate(Column(8.0, 0.6), sine, duration_s=20.0)
    assert free.rotations.max() > 0.0
    drums = Column(8.0, 0.6, drums=4, back={"side": "left"})
    free_limit = Column(8.0, 0.6, drums=4).limit()
    assert drums.limit().right == free_limit.right and drums.limit().left.acceleration_g is None
    with pytest.raises(ValueError, match="would stop the column"):
        simulate(drums, sine, model="free_hinges")
    elastic = simulate(drums, sine, model="elastic_joints", normal_stiffness_gpa_m=10.0, friction_coefficient=0.7, duration_s=1.0)
    assert elastic.rotations.max() < 0.01 < -elastic.rotations.min()
    with pytest.raises(ValueError, match="top drum"):
        Column(8.0, 0.6, drums=4, back={"side": "left", "height_m": 6.0})
    with pytest.raises(ValueError, match="choose \"left\""):
        Column(8.0, 0.6, back={"side": "right"}).chain()
    no_wall = Column(8.0, 0.6, drums=4, back={"side": "left", "height_m": 0.0})
    assert no_wall.limit() == Column(8.0, 0.6, drums=4).limit()


def test_a_body_rocks_about_its_toes() -> None:
    body = Body(mass_kg=1200.0, inertia_kg_m2=500.0, centre_m=np.array([0.05, 0.9]), toes_x_m=[-0.4, 0.4])
    assert body.limit().right.acceleration_g == pytest.approx(0.35 / 0.9, rel=1e-12)
    assert body.limit().left.acceleration_g == pytest.approx(0.45 / 0.9, rel=1e-12)
    # The numbers of a column.
    column = Column(4.0, 0.8)
    mass_kg = 2000.0 * 4.0 * 0.8
    same = Body(mass_kg=mass_kg, inertia_kg_m2=mass_kg * (16.0 + 0.64) / 12.0, centre_m=[0.0, 2.0], toes_x_m=[-0.4, 0.4])
    push = Pulse.half_sine(amplitude_g=0.4, duration_s=0.5)
    rocks = [simulate(one, push, duration_s=2.0).rotations for one in (column, same)]
    assert rocks[0].any() and rocks[1] == pytest.approx(rocks[0], abs=1e-12)
    with pytest.raises(ValueError, match="falls by itself"):
        body.replace(centre_m=[0.5, 0.9])


def test_a_wall_whose_top_is_held_bends() -> None:
    wall = Column(3.5, 0.45, density_kg_m3=1900.0, top={"weight_n": 25e3, "x_m": -0.1})
    limit = wall.limit()
    right, left = limit.right.acceleration_g, limit.left.acceleration_g
    assert right is not None and left is not None and right < left
    assert eval(repr(wall), {"Column": Column}) == wall
    with pytest.raises(ValueError, match="no model of motion"):
        simulate(wall, Pulse.half_sine(amplitude_g=0.4, duration_s=0.5))


def test_a_column_carries_loads() -> None:
    roof = {"mass_kg": 1500.0, "x_m": -0.15}
    vault = {"thrust_n": 1500.0, "height_m": 5.0}
    column = Column(8.0, 0.6, load=[roof, vault])
    # Moments about the right and the left toe, over the moment of the masses.
    tall = 9600.0 * 4.0 + 1500.0 * 8.0
    thrust = 1500.0 / 9.81 * 5.0
    right = (9600.0 * 0.3 + 1500.0 * 0.45 - thrust) / tall
    left = (9600.0 * 0.3 + 1500.0 * 0.15 + thrust) / tall
    assert column.limit().right.acceleration_g == pytest.approx(right, rel=1e-9)
    assert column.limit().left.acceleration_g == pytest.approx(left, rel=1e-9)
    assert eval(repr(column), {"Column": Column}) == column
    sine = Pulse.one_sine(amplitude_g=-0.25, duration_s=1.0)
    loaded, bare = (simulate(one, sine, duration_s=4.0) for one in (column, Column(8.0, 0.6)))
    assert abs(loaded.rotations).max() != abs(bare.rotations).max()
    with pytest.raises(ValueError, match="overturns the column to the right"):
        Column(8.0, 0.6, load=[{"thrust_n": 9000.0}])


def test_free_hinges_and_columns_of_drums(pulse: Pulse) -> None:
    arch = Arch(5.0, 0.15, 180.0, voussoirs=12)
    history = simulate(arch, pulse, model="free_hinges", duration_s=0.5)
    assert history.rotations.shape[1] == len(history.bodies) == 12
    assert history.gaps.shape[1:] == (13, 2)
    drums = Column(4.0, 0.8, drum_heights_m=np.array([1.0, 1.0, 2.0]))
    half_sine = Pulse.half_sine(amplitude_g=0.4, duration_s=0.5)
    assert simulate(drums, half_sine, model="free_hinges", duration_s=0.5).rotations.shape[1] == 3
    assert history.offsets.shape == (len(history), 0), "its joints do not slip"
    slips = simulate(drums, half_sine, model="free_hinges", duration_s=0.5, friction_coefficient=0.15)
    assert slips.offsets.shape == (len(slips), 3) and slips.offsets.any()
    released = simulate(arch, model="free_hinges", initial_sway="left", initial_rotation_rad=0.01, duration_s=0.1)
    assert released.rotations[0].any()


def test_structures_may_start_with_a_rate_or_a_blow() -> None:
    block = Column(4.0, 1.0)
    inertia_kg_m2 = 2000.0 * 4.0 * (4.0**2 + 1.0**2) / 3.0
    blow = simulate(block, initial_sway="left", initial_impulse_n_s=4000.0, initial_height_m=3.0, duration_s=3.0)
    rate = simulate(block, initial_sway="left", initial_rate_rad_s=4000.0 * 3.0 / inertia_kg_m2, duration_s=3.0)
    assert blow.rotations.max() == pytest.approx(rate.rotations.max(), rel=1e-12)
    assert 0.0 < blow.rotations.max() < np.arctan(0.25)
    back = simulate(block, initial_sway="left", initial_rotation_rad=0.05, initial_rate_rad_s=-0.1, duration_s=3.0)
    assert back.rotations.max() == back.rotations[0, 0] == 0.05
    elastic = simulate(block, model="elastic_joints", normal_stiffness_gpa_m=10.0, initial_sway="left", initial_rate_rad_s=0.2, duration_s=1.0)
    assert elastic.rotations.max() > 0.01
    with pytest.raises(ValueError, match="one block"):
        simulate(Column(4.0, 1.0, drums=2), model="free_hinges", initial_sway="left", initial_impulse_n_s=1.0, initial_height_m=3.0)


def test_other_shapes_by_their_tables(tmp_path: Path) -> None:
    pointed = {"span_m": 4.0, "rise_m": 3.0, "thickness_m": 0.5, "voussoirs": 10}
    on_piers = Structure(pointed_arch=pointed, piers={"height_m": 1.0, "width_m": 1.0, "blocks": 1})
    assert on_piers.limit().right.acceleration_g
    assert "piers" in on_piers.tables
    history = simulate(on_piers, Pulse.half_sine(0.3, 0.3), model="free_hinges", duration_s=0.3)
    assert history.rotations.shape[1] == len(history.bodies) > 10
    # Blocks from a file, whose contents are kept: the structure can be used anywhere.
    angles = np.linspace(np.pi, 0.0, 9)
    corners = [(r * np.cos(a), r * np.sin(a)) for a in angles for r in (4.6, 5.4)]
    joints = tmp_path / "joints.csv"
    joints.write_text("".join(f"{i[0]!r},{i[1]!r},{e[0]!r},{e[1]!r}\n" for i, e in zip(
        [tuple(map(float, c)) for c in corners[::2]], [tuple(map(float, c)) for c in corners[1::2]]
    )))
    blocks = Structure(blocks={"joints": str(joints)})
    joints.unlink()
    again = pickle.loads(pickle.dumps(blocks))
    assert again == blocks and again.limit() == blocks.limit()


@pytest.mark.parametrize("path", sorted(SCENARIOS.glob("*.toml")), ids=lambda path: path.stem)
def test_every_scenario_file_can_be_read_printed_and_pickled(path: Path, program: Program) -> None:
    scenario = Scenario.read(path)
    # The program also prints notes, and when a history ends if the file leaves that open.
    checked = re.sub("^# .*\n", "", program("check", path).stdout, flags=re.MULTILINE)
    if "duration_s" not in scenario.tables["simulation"]:
        checked = re.sub(r"(\[simulation\]\n)duration_s = .*\n", r"\1", checked)
    assert scenario.to_toml() == checked
    sent = pickle.loads(pickle.dumps(scenario))
    assert sent == scenario and hash(sent) == hash(scenario)
    assert sent.to_toml() == scenario.to_toml()
    assert Scenario(scenario.tables, files=sent.files) == scenario


def test_changes_of_a_scenario_equal_those_of_the_program() -> None:
    path = SCENARIOS / "semicircle-pulse.toml"
    changed = Scenario.read(path, changes=["arch.thickness_ratio=0.12", "impact.model=mirrored"])
    assert changed.tables["arch"]["thickness_ratio"] == 0.12
    assert changed != Scenario.read(path)
    free = Scenario.read(path, model="free_hinges", changes=["arch.voussoirs=12"])
    assert "free_hinges" in free.tables and pickle.loads(pickle.dumps(free)) == free


def test_pickled_objects_do_not_need_their_files(tmp_path: Path) -> None:
    """Pickles hold the files; read back on a machine without them, they are simulated with bit-identical results."""
    records = [tmp_path / f"{foot}-{way}.at2" for foot in ("left", "right") for way in ("x", "y")]
    for record in records:
        record.write_bytes((SCENARIOS / "synthetic.at2").read_bytes())
    text = (
        "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 180.0\nvoussoirs = 5\n"
        "[elastic_joints]\nnormal_stiffness_gpa_m = 1.0\n[simulation]\nduration_s = 0.5\n"
        '[ground.record]\nfile = "left-x.at2"\npeak_g = 0.5\nvertical = { file = "left-y.at2", peak_g = 0.2 }\n'
        '[ground.right.record]\nfile = "right-x.at2"\npeak_g = 0.4\nvertical = { file = "right-y.at2", peak_g = 0.3 }\n'
    )
    (tmp_path / "s.toml").write_text(text)
    scenario = Scenario.read(tmp_path / "s.toml")
    history = scenario.run()
    data = pickle.dumps((scenario, history))
    for record in records:
        record.unlink()
    sent, restored = pickle.loads(data)
    assert sent == scenario and restored == history and sent.run() == history
    assert restored.report_html() == history.report_html()


def test_units_come_from_the_header(tmp_path: Path) -> None:
    header = "SAMPLING_INTERVAL_S: 0.1\nUNITS: cm/s^2\n"
    (tmp_path / "r.asc").write_text(header + "0\n98.1\n-49.05\n")
    record = Record.read(tmp_path / "r.asc")
    assert record.unit == "cm/s2" and record.acceleration.tolist() == [0.0, 98.1, -49.05]
    same = Record(record.time, record.acceleration / 981, unit="g")
    column = Column(4.0, 0.2)
    suites = [archrock.suite(column, [one], scales=[1.0, 9.0], duration_s=1.0) for one in (record, same)]
    peaks = [one.to_pandas()["peak_rotation_over_critical"].to_numpy() for one in suites]
    assert peaks[0].max() > 0.0 and np.allclose(peaks[0], peaks[1], rtol=1e-9)


def test_rows_of_several_samples_are_read(tmp_path: Path) -> None:
    (tmp_path / "r.txt").write_text("0 0.1 0.2\n0.3 0.2 0.1\n0.0\n")
    record = Record.read(tmp_path / "r.txt", unit="g", dt_s=0.1, wrapped=True)
    assert record.acceleration.tolist() == [0.0, 0.1, 0.2, 0.3, 0.2, 0.1, 0.0]
    (tmp_path / "r.txt").write_text("0 0.1 0.2\n0.3 0.2 0.1\n")
    with pytest.raises(ValueError, match="there are 3 columns: set `acceleration_column` to"):
        Record.read(tmp_path / "r.txt", unit="g", dt_s=0.1)
    record = Record.read(tmp_path / "r.txt", unit="g", dt_s=0.1, wrapped=True)
    assert len(record.time) == 6


def test_a_record_of_velocities_equals_its_accelerations() -> None:
    """A triangle of velocity is a constant acceleration and its opposite: nearly so in steep lines."""
    velocities = Record([0.0, 0.3, 0.6], [0.0, 150.0, 0.0], unit="cm/s", quantity="velocity")
    assert velocities.unit == "cm/s" and velocities.velocity.tolist() == [0.0, 150.0, 0.0]
    with pytest.raises(ValueError, match="is a record of velocity: see `velocity`"):
        _ = velocities.acceleration
    steep = Record([0.0, 0.3, 0.300001, 0.6], [5.0, 5.0, -5.0, -5.0], unit="m/s2")
    column = Column(4.0, 0.8)
    histories = [simulate(column, one, duration_s=3.0) for one in (velocities, steep)]
    peaks = [np.abs(history.rotations).max() for history in histories]
    assert peaks[0] > 0.01 and abs(peaks[0] / peaks[1] - 1.0) < 1e-4
    assert pickle.loads(pickle.dumps(velocities)) == velocities
    with pytest.raises(ValueError, match='give `quantity = "velocity"`'):
        Record([0.0, 1.0], [0.0, 1.0], unit="cm/s")


@pytest.mark.parametrize(
    "described",
    [
        Arch(5.0, 0.15, 180.0, voussoirs=7),
        Column(4.0, 0.8, drums=3),
        Body(mass_kg=1200.0, inertia_kg_m2=500.0, centre_m=[0.05, 0.9], toes_x_m=[-0.4, 0.4]),
        Pulse.gabor(0.5, 0.4, gamma=3.0, phase_deg=30.0),
        Record([0.0, 0.1, 0.2], [0.0, 1.0, 0.0], unit="m/s2", name="three", start_s=0.5),
    ],
    ids=lambda described: type(described).__name__,
)
def test_structures_grounds_and_scenarios_compare_by_value(described: Any) -> None:
    for same in (pickle.loads(pickle.dumps(described)), copy.copy(described), copy.deepcopy(described)):
        assert same == described and hash(same) == hash(described) and repr(same) == repr(described)
    tables = described.tables
    tables.clear()
    assert described.tables, "the property returns a copy"
    assert described != 3 and described is not None


def test_reprs_recreate_the_object(arch: Arch, pulse: Pulse) -> None:
    body = Body(mass_kg=1200.0, inertia_kg_m2=500.0, centre_m=[0.05, 0.9], toes_x_m=[-0.4, 0.4], load=[{"mass_kg": 100.0, "height_m": 0.5}])
    for one in (arch, Column(4.0, 0.8, drums=2), body, pulse):
        assert eval(repr(one), vars(archrock)) == one


def test_different_objects_are_not_equal(arch: Arch, pulse: Pulse) -> None:
    assert arch != Arch(5.0, 0.16, 180.0) and pulse != Pulse.rectangular(-0.30, 0.21)
    assert simulate(arch, pulse, duration_s=1.0) != simulate(arch, pulse, duration_s=1.1)
    record = Record([0.0, 1.0], [1.0, 2.0], unit="g")
    assert record != Record([0.0, 1.0], [1.0, 2.5], unit="g")
    assert arch != Structure(arch={"mean_radius_m": 5.0, "thickness_ratio": 0.15, "embrace_deg": 180.0})


def test_histories_can_be_pickled(arch: Arch, pulse: Pulse) -> None:
    history = simulate(arch, pulse)
    restored = pickle.loads(pickle.dumps(history))
    assert restored == history and repr(restored) == repr(history)
    assert restored.rotations.tobytes() == history.rotations.tobytes() and not restored.rotations.flags.writeable
    assert restored.events == history.events and restored.scenario.run() == history
    assert restored.to_pandas().equals(history.to_pandas())


def test_a_trace_of_obspy_is_a_record() -> None:
    """A stand-in with the used parts of a trace: ObsPy itself is not a dependency."""
    data = np.ma.masked_array(np.array([0.0, 0.1, -0.2, 0.0], dtype=np.float32), mask=False)
    trace = SimpleNamespace(data=data, stats=SimpleNamespace(delta=0.02), id="IT.MZAR..HGE")
    record = Record.from_obspy(trace, unit="m/s2", peak_g=0.4)
    assert record.name == "IT.MZAR..HGE" and record.unit == "m/s2"
    assert record.time.tolist() == [0.0, 0.02, 0.04, 0.06]
    assert record.acceleration.tolist() == [float(np.float32(one)) for one in (0.0, 0.1, -0.2, 0.0)]
    data[2] = np.ma.masked
    with pytest.raises(ValueError, match="3: `nan` is not a finite number"):
        Record.from_obspy(trace, unit="m/s2")
    whole = np.ma.masked_array([0, 1, -2, 0], mask=[False, False, True, False])
    with pytest.raises(ValueError, match="3: `nan` is not a finite number"):
        Record([0.0, 0.1, 0.2, 0.3], whole, unit="m/s2")
    assert Record([0.0, 0.1], whole[:2], unit="m/s2").acceleration.tolist() == [0.0, 1.0]


def test_records_equal_those_of_the_program() -> None:
    record = Record.read(SCENARIOS / "records" / "wave-1.at2", scale=2.0)
    assert record.unit == "g" and record.name == "wave-1.at2"
    assert len(record.time) == len(record.acceleration) > 100
    same = Record(record.time, record.acceleration, unit="g", scale=2.0)
    path = SCENARIOS / "records" / "wave-1.at2"
    both = Record.read(path, scale=2.0, vertical=str(path))
    assert both == Record.read(path, scale=2.0, vertical=Record.read(path)) != record
    with pytest.raises(TypeError, match="`vertical` must be a Record or the path of its file, not int"):
        Record.read(path, vertical=3)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="'wave-1.at2' is a record of acceleration: see `acceleration`"):
        _ = record.velocity
    column = Column(4.0, 0.8)
    assert simulate(column, same).rotations.tobytes() == simulate(column, record).rotations.tobytes()


WRONG: list[tuple[Any, str]] = [
    (lambda: Arch(5.0, 0.01, 180.0), "`thickness_ratio = 0.01` makes an arch that cannot carry its own weight"),
    (lambda: Arch(float("nan"), 0.15, 180.0), "`mean_radius_m = nan` is not finite"),
    (lambda: Arch(5.0, 0.15, 180.0, foo=1), "unknown key `foo` in [arch]"),
    (lambda: Arch(5.0, 0.15), "[arch] needs exactly one of the keys rise_m, embrace_deg"),
    (lambda: Arch(5.0, 0.15, 180.0, voussoirs=2), "`voussoirs = 2` is out of range"),
    (lambda: Column(4.0, 0.8, drums=3, drum_heights_m=[4.0]), "cannot be combined with `drums`"),
    (lambda: Pulse("half_cosine", amplitude_g=1.0, duration_s=1.0), "half_cosine"),
    (lambda: Pulse.half_sine(2000.0, 1.0), "`amplitude_g = 2000.0` is out of range"),
    (lambda: Pulse.half_sine(0.1, 1.0, vertical_amplitude_g=-1.5), "fall as fast as a free body"),
    (lambda: Record([0.0, 0.0], [1.0, 2.0], unit="g"), "the time does not increase"),
    (lambda: Record([0.0], [1.0], unit="g"), "record"),
    (lambda: Record([0.0, 1.0], [1.0, 2.0], unit="km/s2"), '`unit = "km/s2"` is unknown'),  # type: ignore[arg-type]
    (lambda: Record([0.0, 1.0], [[1.0, 2.0]], unit="g"), "shape (1, 2)"),
    (lambda: Record([0.0, 1.0], [1.0], unit="g"), "2 samples"),
    (lambda: Record([0.0, 1.0], [1.0, 2.0], unit="g", name="../x"), "no name of a file"),
    (lambda: Structure(), "exactly one"),
]


@pytest.mark.parametrize(("make", "words"), WRONG, ids=lambda one: one if isinstance(one, str) else "")
def test_errors_have_the_words_of_the_library(make: Any, words: str) -> None:
    with pytest.raises(ValueError) as caught:
        make()
    assert words in str(caught.value)
    assert "/tmp" not in str(caught.value) and "the arguments" not in str(caught.value)


def test_numbers_of_numpy_are_numbers(arch: Arch, pulse: Pulse) -> None:
    simulated = simulate(arch, pulse, duration_s=np.float64(1.0), output_step_s=np.float32(0.25))
    assert simulated == simulate(arch, pulse, duration_s=1.0, output_step_s=0.25)
    assert Arch(np.int64(5), np.float64(0.15), 180) == arch


def test_invalid_settings_are_refused(arch: Arch, pulse: Pulse) -> None:
    drums = Column(4.0, 0.8, drums=3)
    wrong: list[tuple[Any, str]] = [
        (lambda: simulate(arch, pulse, duration_s=-1.0), "`duration_s = -1.0` is out of range"),
        (lambda: simulate(arch, pulse, output_step_s=20.0), "longer than the run"),
        (lambda: simulate(arch, pulse, output_step_s=1e-6, duration_s=1e3), "rows of output"),
        (lambda: simulate(arch, pulse, model="rigid"), "`model = 'rigid'`"),  # type: ignore[arg-type]
        (lambda: simulate(arch, pulse, model="free_hinges"), "lacks `voussoirs`"),
        (lambda: simulate(arch, pulse, impact="elastic"), "elastic"),
        (lambda: simulate(arch, pulse, restitution=0.5), "prescribed"),
        (lambda: simulate(arch, pulse, longest_step_s=1e-4), "longest_step_s"),
        (lambda: simulate(drums, pulse, model="free_hinges", restitution=0.5), "free hinges"),
        (lambda: simulate(drums, pulse), "[free_hinges]"),
        (lambda: simulate(arch), "nothing moves the structure"),
        (lambda: simulate(arch, initial_sway="right"), "rotation_rad"),
        (lambda: simulate(arch, initial_sway="right", initial_rotation_rad=3.0), "limit position"),
    ]
    for make, words in wrong:
        with pytest.raises(ValueError) as caught:
            make()
        assert words in str(caught.value), str(caught.value)
    for make in (lambda: simulate(3, pulse), lambda: simulate(arch, "pulse"), lambda: simulate(arch, pulse, duration_s={})):  # type: ignore[arg-type]
        with pytest.raises((TypeError, ValueError)):
            make()


def test_dimensions_stay_as_given(pulse: Pulse, program: Program, tmp_path: Path) -> None:
    arch = Arch(span_m=4.2, rise_m=1.4, thickness_m=0.4, measured_at="intrados")
    given = "span_m=4.2, rise_m=1.4, measured_at='intrados'"
    assert given in repr(arch) and "mean_radius_m" not in repr(arch)
    assert arch.tables["arch"]["span_m"] == 4.2 and pickle.loads(pickle.dumps(arch)) == arch
    # The bits are those of a file with these dimensions.
    path = tmp_path / "s.toml"
    path.write_text('[arch]\nspan_m = 4.2\nrise_m = 1.4\nthickness_m = 0.4\nmeasured_at = "intrados"\n')
    assert arch.limit().details == json.loads(program("limit", path, "--format", "json").stdout)
    assert Scenario.of(arch, pulse).tables["arch"] == arch.tables["arch"] == Scenario.read(path).tables["arch"]
    assert "span_m" in Scenario.of(arch, pulse).run().scenario.tables["arch"]


def test_a_file_descriptor_is_refused_as_a_file() -> None:
    # A number that is taken for an open file would close that file.
    with open(os.devnull, encoding="ascii") as file:
        for path in (file.fileno(), 1, 2.5, None):
            with pytest.raises(TypeError):
                Scenario.read(path)  # type: ignore[arg-type]
        os.fstat(file.fileno())


def test_errors_in_files_name_their_place(program: Program, tmp_path: Path) -> None:
    path = tmp_path / "wrong.toml"
    path.write_text("[arch]\nmean_radius_m = -5.0\nthicknes_ratio = 0.15\n[ground.half_sine]\namplitude_g = 1e9\n")
    with pytest.raises(ValueError) as caught:
        Scenario.read(path)
    words = str(caught.value)
    assert f"{path}:2:17: `mean_radius_m = -5.0`" in words and len(words.splitlines()) >= 4
    for line in words.splitlines():
        assert line in program("check", path).stderr
    with pytest.raises(OSError):
        Scenario.read(tmp_path / "none.toml")
    with pytest.raises(OSError):
        Record.read(tmp_path / "none.at2")


def test_pictures(arch: Arch, pulse: Pulse, tmp_path: Path) -> None:
    history = simulate(arch, pulse, duration_s=1.0)
    rotations = history.plot()
    figure: Any = rotations.figure
    ground = figure.axes[0]
    # It stays open, so a notebook and show() display it.
    from matplotlib import pyplot

    assert figure.number in pyplot.get_fignums()
    assert [line.get_label() for line in rotations.get_lines()[:3]] == ["left", "middle", "right"]
    assert np.array_equal(rotations.get_lines()[2].get_ydata(), history.rotations[:, 2])
    # The arch still rocks, with less energy than its barrier.
    assert ground.get_title() == "still rocking at 1.0000 s without impact"
    figure.savefig(tmp_path / "history.png")
    assert ground.get_legend() is not None and rotations.get_legend() is not None
    # Into given axes.
    from matplotlib.figure import Figure

    own = Figure()
    one, other = own.subplots(1, 2)
    assert history.plot(ax=other) is other
    assert len(one.get_lines()) == 0
    assert other.get_xlabel() == "time (s)" and other.get_ylabel() == "rotation (rad)"
    key = other.get_legend()
    assert key is not None
    names = [text.get_text() for text in key.get_texts()]
    assert names == ["left", "middle", "right"]
    page = history.report_html()
    assert page.startswith("<!DOCTYPE html>") or page.lower().startswith("<!doctype html>")
    assert "survives: peak rotation 45 % of overturning" in page
    html = history._repr_html_()
    assert html.startswith("<iframe srcdoc=") and html.count("<iframe") == 1 and "<script" not in html
    history.save_report(tmp_path / "report.html")
    assert (tmp_path / "report.html").read_text(encoding="utf-8") == page


def test_a_film_is_that_of_the_program(arch: Arch, pulse: Pulse, program: Program, tmp_path: Path) -> None:
    history = simulate(arch, pulse, duration_s=0.4)
    (tmp_path / "arch.toml").write_text(history.scenario.to_toml())
    options = ("--speed", 0.5, "--size", "320x180", "--background", "f5f0e6", "--caption", "M", "--exaggerate", 5)
    made = program("film", tmp_path / "arch.toml", "--out", tmp_path / "a.gif", *options)
    how: dict[str, Any] = {"speed": 0.5, "size": (320, 180), "background": "f5f0e6", "caption": "M", "exaggerate": 5.0}
    history.film(tmp_path / "b.gif", **how)
    film = (tmp_path / "b.gif").read_bytes()
    assert film.startswith(b"GIF89a")
    # A program may be built without films.
    if made.returncode == 0:
        assert film == (tmp_path / "a.gif").read_bytes()
    else:
        assert "--features print" in made.stderr
    history.film(str(tmp_path / "b.gif"), **{**how, "speed": 1.0})
    assert len((tmp_path / "b.gif").read_bytes()) < len(film)
    for wrong, words in (({"size": (321, 180)}, "even numbers"), ({"speed": 0.0}, "from 0.001"), ({"background": "x"}, "rrggbb")):
        with pytest.raises(ValueError, match=words):
            history.film(tmp_path / "b.gif", **{**how, **wrong})
    with pytest.raises(ValueError, match="mp4, webm, gif and png"):
        history.film(tmp_path / "b.avi")
    with pytest.raises(OSError, match="none"):
        history.film(tmp_path / "none" / "b.gif")


def test_tables_for_pandas(arch: Arch, pulse: Pulse) -> None:
    table = simulate(arch, pulse, duration_s=0.5).to_pandas()
    assert list(table.columns) == [
        "time_s",
        "ground_acceleration_m_s2",
        "phase",
        "state",
        "rotation_left_rad",
        "rotation_middle_rad",
        "rotation_right_rad",
        "rate_left_rad_s",
        "rate_middle_rad_s",
        "rate_right_rad_s",
        "thrust_excess_ratio",
        "friction_demand",
        "vertical_acceleration_m_s2",
        "energy_j",
    ]
    assert "rotation_rad" in simulate(Column(4.0, 0.8), Pulse.half_sine(0.5, 0.5), duration_s=0.5).to_pandas()


def test_feet_springings_and_ties() -> None:
    """Keywords give the same scenario as a file: the right foot by a table or a record, moved springings, ties."""
    arch = Structure(
        arch={"mean_radius_m": 5.0, "thickness_ratio": 0.15, "embrace_deg": 180.0, "voussoirs": 12},
        tie=[{"height_m": 2.0, "stiffness_n_m": 1e7, "prestress_n": 1e3}],
    )
    ground = Pulse.one_sine(amplitude_g=0.1, duration_s=0.2)
    joints: dict[str, Any] = {"model": "elastic_joints", "normal_stiffness_gpa_m": 1.0, "duration_s": 0.3}
    supports = {"right": {"spread_m": 0.02, "settlement_m": 0.01}}
    late = Scenario.of(arch, ground, right={"delay_s": 0.05}, supports=supports, **joints)
    text = (
        "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 180.0\nvoussoirs = 12\n"
        "[[tie]]\nheight_m = 2.0\nstiffness_n_m = 1e7\nprestress_n = 1e3\n"
        "[supports]\nright = { spread_m = 0.02, settlement_m = 0.01 }\n"
        "[ground.one_sine]\namplitude_g = 0.1\nduration_s = 0.2\n[ground.right]\ndelay_s = 0.05\n"
        "[elastic_joints]\nnormal_stiffness_gpa_m = 1.0\n[simulation]\nduration_s = 0.3\n"
    )
    history, other = late.run(), Scenario.parse(text).run()
    assert np.array_equal(history.rotations, other.rotations)
    assert np.array_equal(history.feet_apart, other.feet_apart) and np.abs(history.feet_apart).max() > 1e-3
    assert np.array_equal(history.tie_forces, other.tie_forces) and history.tie_forces[0, 0] > 2e3
    assert pickle.loads(pickle.dumps(late)) == late
    at_once = simulate(arch, ground, right={"delay_s": 0.05}, supports=supports, point=(0.0, 4.7), **joints)
    assert np.array_equal(history.rotations, at_once.rotations) and np.array_equal(history.poses, at_once.poses)
    assert np.array_equal(history.feet_apart, at_once.feet_apart) and at_once.point is not None
    assert np.array_equal(history.tie_forces, at_once.tie_forces) and history.summary == at_once.summary
    # Moved springings apply to this call only.
    settled = simulate(arch, ground, supports=supports, **joints)
    assert np.array_equal(settled.rotations, Scenario.of(arch, ground, supports=supports, **joints).run().rotations)
    built = simulate(arch, ground, **joints)
    assert np.array_equal(built.rotations, Scenario.of(arch, ground, **joints).run().rotations)
    assert not np.array_equal(built.rotations, settled.rotations)

    time = np.array([0.0, 0.1, 0.2])
    left, right = (Record(time, [0.0, peak, 0.0], unit="g") for peak in (0.1, 0.05))
    two = Scenario.of(arch, left, right=right, **joints)
    assert two.tables["ground"]["right"]["record"]["file"] == "right-record"
    assert np.abs(two.run().feet_apart).max() > 1e-4
    assert np.array_equal(simulate(arch, left, right=right, **joints).rotations, two.run().rotations)
    # The record of the right foot keeps its own file, for any name of the left one.
    up, down = (Record(time, [0.0, peak, 0.0], unit="g") for peak in (0.02, -0.03))
    left, right = (
        Record(time, [0.0, peak, 0.0], unit="g", vertical=vertical) for peak, vertical in ((0.1, up), (0.05, down))
    )
    both = Scenario.of(arch, left, right=right, **joints)
    assert both.tables["ground"]["right"]["record"]["vertical"]["file"] == "right-vertical-record"
    # The acceleration rises and falls linearly for 0.1 s each: the displacement is the peak acceleration times 0.1 s squared.
    x_m, y_m = both.run().feet_apart[np.searchsorted(both.run().time, 0.2)]
    assert x_m == pytest.approx(-0.05 * 9.81 * 0.01, rel=1e-6) and y_m == pytest.approx(-0.05 * 9.81 * 0.01, rel=1e-6)
    # Names stay unique even if a file has the name that another one would get.
    taken = Record(time, [0.0, 0.1, 0.0], unit="g", vertical=Record(time, time, unit="g", name="right-record"))
    assert set(Scenario.of(arch, taken, right=right, **joints).files) == {
        "record",
        "right-record",
        "right-right-record",
        "vertical-record",
    }
    with pytest.raises(ValueError, match="give that too"):
        Scenario.of(arch, right=right, **joints)
    with pytest.raises(ValueError, match="give that too"):
        simulate(arch, right=right, **joints)
    with pytest.raises(ValueError, match="supports"):
        simulate(arch, ground, supports=supports)


@pytest.mark.parametrize(("short", "long"), [("four", "four_links"), ("free", "free_hinges"), ("elastic", "elastic_joints")])
def test_models_have_the_names_of_the_program_too(short: Any, long: Any) -> None:
    arch, pulse = Arch(5.0, 0.15, 180.0, voussoirs=9), Pulse.half_sine(amplitude_g=0.2, duration_s=0.3)
    settings: dict[str, Any] = {"duration_s": 0.5, **({"normal_stiffness_gpa_m": 1.0} if short == "elastic" else {})}
    history = simulate(arch, pulse, model=short, **settings)
    assert history == simulate(arch, pulse, model=long, **settings) == Scenario.of(arch, pulse, model=short, **settings).run()
    peaks_rad = [history.summary[key] for key in history.summary if key.startswith("peak_rotation_") and key.endswith("_rad")]
    assert history.largest_peak_rotation_rad == max(map(abs, peaks_rad))


def test_keys_of_structures_are_attributes_and_can_be_replaced() -> None:
    arch = Arch(5.0, 0.15, 180.0, voussoirs=12)
    assert (arch.thickness_ratio, arch.voussoirs, arch.density_kg_m3) == (0.15, 12, 2000.0)
    with pytest.raises(AttributeError, match="'thickness_m'; it was given by: mean_radius_m, thickness_ratio"):
        arch.thickness_m
    thicker = arch.replace(thickness_ratio=None, thickness_m=1.0)
    assert type(thicker) is Arch and thicker == Arch(5.0, thickness_m=1.0, embrace_deg=180.0, voussoirs=12)
    assert thicker.limit() == Arch(5.0, 0.2, 180.0, voussoirs=12).limit()
    with pytest.raises(ValueError, match="voussoirs"):
        arch.replace(voussoirs=-1)
    roof = Column(6.0, 0.6, load=[{"mass_kg": 500.0, "x_m": -0.1}])
    assert roof.replace(width_m=0.8) == Column(6.0, 0.8, load=[{"mass_kg": 500.0, "x_m": -0.1}])
    for copied in (pickle.loads(pickle.dumps(roof)), copy.deepcopy(roof)):
        assert copied == roof and copied.width_m == 0.6
    piers = Structure(pointed_arch={"span_m": 4.0, "rise_m": 3.0, "thickness_m": 0.6, "voussoirs": 20})
    on_piers = piers.replace(piers={"height_m": 2.0, "width_m": 1.2})
    assert on_piers.tables["piers"]["height_m"] == 2.0 and on_piers.replace(piers=None) == piers


def test_records_have_a_step_or_a_stream() -> None:
    accelerations = [0.0, 0.3, -0.2, 0.0]
    timed = Record([0.0, 0.01, 0.02, 0.03], accelerations, unit="g", name="XX.STA")
    assert Record(0.01, accelerations, unit="g", name="XX.STA") == timed
    trace = SimpleNamespace(data=np.array(accelerations), stats=SimpleNamespace(delta=0.01), id="XX.STA")
    assert Record.from_obspy(trace, unit="g") == Record.from_obspy([trace], unit="g") == timed
    with pytest.raises(ValueError, match=re.escape("the stream has 2 traces: give one of them (stream[0] is XX.STA, stream[1] is XX.STA)")):
        Record.from_obspy([trace, trace], unit="g")


def test_ground_motions_are_sampled() -> None:
    times, sine = Pulse.half_sine(amplitude_g=0.3, duration_s=0.5, start_s=0.2).sample(0.01)
    inside = (times > 0.2 - 1e-9) & (times < 0.7 + 1e-9)
    assert times[-1] == pytest.approx(0.7) and inside.sum() == 51
    expected = np.where(inside, 0.3 * 9.81 * np.sin(np.pi * (times - 0.2) / 0.5), 0.0)
    assert sine == pytest.approx(expected, abs=1e-12)
    _, samples = Record(0.01, [0.0, 0.3, -0.2, 0.0], unit="g").sample(0.005)
    assert samples / 9.81 == pytest.approx([0.0, 0.15, 0.3, 0.05, -0.2, -0.1, 0.0], abs=1e-12)
    with pytest.raises(ValueError, match="`step_s = 0` must be positive"):
        Pulse.half_sine(0.3, 0.5).sample(0.0)


def test_simulate_takes_every_key_of_a_model(arch: Arch, pulse: Pulse) -> None:
    scaled = simulate(arch, pulse, restitution_factor=0.9).impacts[0]
    assert scaled.restitution == pytest.approx(0.9 * simulate(arch, pulse).impacts[0].restitution)
    stack = Column(2.0, 0.5, drums=2)
    joints: dict[str, Any] = {"model": "elastic", "normal_stiffness_gpa_m": 1.0, "duration_s": 0.5, "repeat": False}
    weak = Pulse.half_sine(0.3, 0.2)
    # A share of critical damping is the damping time at a frequency: ratio / (pi f).
    by_ratio = simulate(stack, weak, **joints, damping_ratio=0.01, damping_frequency_hz=20.0)
    by_time = simulate(stack, weak, **joints, damping_time_s=0.01 / (np.pi * 20.0))
    assert by_ratio.rotations == pytest.approx(by_time.rotations, abs=1e-9) and by_ratio.rotations.any()
    # A rebound finds the damping time of a single block; drums have none.
    single = Column(2.0, 0.5)
    rebound = simulate(single, weak, **joints, rebound_ratio=0.97)
    assert rebound.summary["damping_time_s"] != simulate(single, weak, **joints).summary["damping_time_s"]
    with pytest.raises(ValueError, match="the rebound of one block"):
        simulate(stack, weak, **joints, rebound_ratio=0.97)
    continuous = simulate(stack, weak, **joints, contact="continuous")
    assert np.array_equal(continuous.rotations, simulate(stack, weak, **joints).rotations)


def test_results_print_their_answer(arch: Arch, pulse: Pulse) -> None:
    history = simulate(arch, Pulse.rectangular(amplitude_g=-0.28, duration_s=0.20))
    assert str(history).splitlines() == [f"History: {repr(history)[10:].split(';')[0]}", *history.to_quote.split("; ")]
    found = archrock.threshold(arch, pulse, stride=0.2)
    answer = "SURVIVES up to "
    slips = simulate(Arch(3.0, 0.3, 120.0, voussoirs=12), Pulse.half_sine(-1.2, 0.3), model="free")
    assert "run `archrock" in slips.to_quote
    assert "compute it with friction_coefficient=0.6" in str(slips) and "`" not in str(slips)
    assert repr(found).startswith(f"<Threshold: {answer}") and f"Threshold:\n  {answer}" in str(found)
    assert pickle.loads(pickle.dumps(found)) == found and repr(pickle.loads(pickle.dumps(found))) == repr(found)
    assert "amplitude_g: peak acceleration" in (Pulse.gabor.__doc__ or "") and "gamma: length" in (Pulse.gabor.__doc__ or "")
    assert "gamma" not in (Pulse.ricker.__doc__ or "")


def test_misspelt_keys_of_results_are_found_by_type_checkers(tmp_path: Path) -> None:
    code = tmp_path / "misspelt.py"
    code.write_text(
        "from archrock import Arch, Pulse, simulate, threshold\n"
        "arch, pulse = Arch(5.0, 0.15, 180.0), Pulse.half_sine(0.3, 0.5)\n"
        "history, found = simulate(arch, pulse), threshold(arch, pulse)\n"
        "good = (arch.voussoirs, history.steps, history.summary.ground.peak_g, found.bands[0].from_peak_g, arch.limit().right.hinges[0].edge)\n"
        "arch.voussoir\nhistory.rotation\nhistory.summary.ground.peak\nfound.band\narch.limit().right.hinge\n"
    )
    checked = subprocess.run([sys.executable, "-m", "mypy", str(code)], cwd=tmp_path, capture_output=True, text=True, check=False)
    lines = [line.split(":")[1] for line in checked.stdout.splitlines() if "error" in line and "has no attribute" in line]
    assert lines == ["5", "6", "7", "8", "9"], checked.stdout
