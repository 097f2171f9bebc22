"""The package computes the same as the program, to the last bit."""

from __future__ import annotations

import csv
import inspect
import json
import math
import random
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from archrock import Arch, Column, Ground, History, Pulse, Record, Scenario, Structure, simulate

from .conftest import ROOT, Program

RECORDS = ROOT / "scenarios" / "records"
KINDS = (
    "rectangular",
    "step_pair",
    "half_sine",
    "one_sine",
    "one_cosine",
    "triangular",
    "ricker",
    "antisymmetric_ricker",
    "mavroeidis_papageorgiou",
    "gabor",
    "windowed_sine",
)


def any_structure(rng: random.Random, free: bool) -> Structure | None:
    """A structure, if these numbers give one that stands."""
    size: dict[str, Any] = {}
    if rng.random() < 0.5:
        size = {"depth_m": rng.uniform(0.5, 3.0), "density_kg_m3": rng.uniform(1500.0, 2600.0)}
    shape = rng.choice(("arch", "arch", "column", "pointed_arch" if free else "arch"))
    try:
        if shape == "column":
            drums = rng.randint(1, 3) if free else None
            return Column(rng.uniform(1.0, 6.0), rng.uniform(0.3, 1.2), drums=drums, **size)
        voussoirs = rng.randint(5, 12) if free or rng.random() < 0.3 else None
        if shape == "arch":
            return Arch(
                rng.uniform(1.0, 10.0),
                rng.uniform(0.1, 0.2),
                rng.uniform(120.0, 180.0),
                voussoirs=voussoirs,
                **size,
            )
        span_m = rng.uniform(3.0, 6.0)
        pointed = {
            "span_m": span_m,
            "rise_m": span_m * rng.uniform(0.6, 0.9),
            "thickness_m": span_m * rng.uniform(0.1, 0.2),
            "voussoirs": voussoirs,
        }
        return Structure(pointed_arch=pointed)
    except ValueError:
        return None


def any_ground(rng: random.Random) -> Ground | None:
    if rng.random() < 0.2:
        path = rng.choice(sorted(RECORDS.glob("*.at2")))
        return Record.read(path, peak_g=rng.uniform(0.2, 1.0))
    if rng.random() < 0.2:
        time = np.cumsum([rng.uniform(0.01, 0.05) for _ in range(60)])
        acceleration = [rng.gauss(0.0, 3.0) for _ in time]
        name = f"made-{rng.randrange(10**9)}.csv"
        return Record(time, acceleration, unit="m/s2", name=name, scale=rng.choice((1.0, -0.7)))
    vertical_g = rng.choice((0.0, rng.uniform(-0.5, 0.5)))
    return Pulse(
        rng.choice(KINDS),
        amplitude_g=rng.uniform(-1.5, 1.5),
        duration_s=rng.uniform(0.1, 1.0),
        start_s=rng.choice((0.0, rng.uniform(0.0, 0.5))),
        vertical_amplitude_g=vertical_g,
    )


def any_case(rng: random.Random, free: bool) -> tuple[Structure, Ground | None, dict[str, Any]]:
    structure = None
    while structure is None:
        structure = any_structure(rng, free)
    settings: dict[str, Any] = {
        "duration_s": rng.uniform(0.5, 1.5) if free else rng.uniform(2.0, 8.0),
        "output_step_s": rng.choice((0.01, rng.uniform(0.005, 0.05))),
        "gravity_m_s2": rng.choice((9.81, rng.uniform(3.0, 12.0))),
    }
    if free:
        settings["model"] = "free_hinges"
        if rng.random() < 0.3:
            settings["longest_step_s"] = 2e-4
        if rng.random() < 0.3:
            settings["friction_coefficient"] = rng.uniform(0.5, 0.8)
    else:
        settings["relative_tolerance"] = rng.choice((1e-9, 1e-7))
        impact = rng.choice(("max_restitution", "same_sections", "mirrored", "prescribed"))
        settings["impact"] = impact
        if impact == "prescribed":
            settings["restitution"] = rng.uniform(0.2, 1.0)
        if rng.random() < 0.2:
            settings["initial_sway"] = rng.choice(("left", "right"))
            settings["initial_rotation_rad"] = rng.uniform(1e-4, 1e-3)
    return structure, any_ground(rng), settings


def assert_same(history: History, folder: Path, name: str) -> None:
    """Asserts that a history is equal to the program's files, number by number."""
    with open(folder / "rotations.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    table = history.to_pandas()
    assert len(rows) == len(table) > 1, name
    compared = 0
    for column in rows[0]:
        cells = [row[column] for row in rows]
        if column == "state":
            assert cells == list(table["state"]), name
        else:
            # Equal as 64-bit numbers, including the signs of zeros.
            printed = np.array([float(cell) for cell in cells])
            assert printed.tobytes() == np.asarray(table[column], dtype=float).tobytes(), (name, column)
            compared += 1
    assert compared >= 6

    summary = json.loads((folder / "summary.json").read_text())
    # The time that the longest step of free hinges took is not part of the result.
    assert summary.pop("longest_step_us", 1.0) > 0.0
    assert summary.pop("verdict") == history.verdict or history.verdict == "uncertain", name
    # The answer to quote depends on the repetitions, as the verdict does.
    assert summary.pop("to_quote"), name
    # So does the friction that the history and its repetitions need.
    summary.pop("friction_demand", None)
    own_warnings, warnings = (
        [one for one in every if "friction coefficient" not in one]
        for every in (summary.pop("warnings"), history.summary["warnings"])
    )
    assert own_warnings == warnings, name
    repeated = ("verdict", "to_quote", "repeatability", "friction_demand", "warnings")
    assert summary == {key: value for key, value in history.summary.items() if key not in repeated}, name

    with open(folder / "impacts.csv", encoding="utf-8") as file:
        impacts = list(csv.DictReader(file))
    assert len(impacts) == len(history.impacts), name
    for row, impact in zip(impacts, history.impacts):
        for key in ("time_s", "energy_before_j", "energy_after_j"):
            assert float(row[key]) == getattr(impact, key), (name, key)


@pytest.mark.parametrize(("free", "count"), [(False, 70), (True, 30)])
def test_a_hundred_random_scenarios_have_the_bits_of_the_program(
    program: Program, tmp_path: Path, free: bool, count: int
) -> None:
    rng = random.Random(14 + free)
    histories: dict[str, History] = {}
    while len(histories) < count:
        structure, ground, settings = any_case(rng, free)
        try:
            history = simulate(structure, ground, **settings)
        except ValueError as error:
            # Both refuse what cannot be computed; other tests check the words.
            assert str(error)
            continue
        scenario = history.scenario
        name = f"case-{len(histories)}"
        (tmp_path / f"{name}.toml").write_text(scenario.to_toml())
        for file, contents in scenario.files.items():
            (tmp_path / file).write_bytes(contents)
        # The same, read from a file.
        assert Scenario.read(tmp_path / f"{name}.toml").run() == history, name
        histories[name] = history
    assert {history.outcome for history in histories.values()} >= {"rest", "overturned"}

    files = [tmp_path / f"{name}.toml" for name in histories]
    options = ["--no-repeat"] if free else []
    ran = program("run", *files, "--out", tmp_path / "results", "--no-report", *options)
    assert ran.returncode == 0, ran.stderr
    for name, history in histories.items():
        assert_same(history, tmp_path / "results" / name, name)


def test_gaps_are_those_of_joints_csv(program: Program, tmp_path: Path) -> None:
    pulse = Pulse.half_sine(amplitude_g=0.5, duration_s=0.4)
    history = simulate(Column(4.0, 0.8, drums=3), pulse, model="free_hinges", duration_s=1.0)
    path = tmp_path / "drums.toml"
    path.write_text(history.scenario.to_toml())
    ran = program("run", path, "--out", tmp_path / "out", "--no-report")
    assert ran.returncode == 0, ran.stderr
    joints = np.loadtxt(tmp_path / "out" / "joints.csv", delimiter=",", skiprows=1)
    assert np.array_equal(joints[:, 1:].reshape(history.gaps.shape), history.gaps)
    assert history.gaps.max() > 0.0
    # With half and double steps, as the program does by default.
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert history.repeatability() == summary["repeatability"]


def test_poses_are_those_of_the_program(program: Program, tmp_path: Path, arch: Arch, pulse: Pulse) -> None:
    history = simulate(arch, pulse, duration_s=1.5)
    path = tmp_path / "arch.toml"
    path.write_text(history.scenario.to_toml())
    ran = program("run", path, "--out", tmp_path / "out", "--no-report", "--poses")
    assert ran.returncode == 0, ran.stderr
    with open(tmp_path / "out" / "poses.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(history)
    for index, body in enumerate(history.bodies):
        for part, unit, place in (("rotation", "rad", 0), ("x", "m", 1), ("y", "m", 2)):
            names = [name for name in rows[0] if body in name and part in name and name.endswith(unit)]
            assert len(names) == 1, (names, list(rows[0]))
            printed = [float(row[names[0]]) for row in rows]
            assert printed == history.poses[:, index, place].tolist()


def test_limit_and_chain_are_those_of_the_program(program: Program, tmp_path: Path, arch: Arch, pulse: Pulse) -> None:
    path = tmp_path / "arch.toml"
    path.write_text(Scenario.of(arch, pulse).to_toml())
    printed = json.loads(program("limit", path, "--format", "json").stdout)
    limit = arch.limit()
    assert limit.details == printed
    assert limit.right.acceleration_g == printed["incipient_acceleration_g"]["right"]
    hinges = [(hinge.angle_deg, hinge.edge) for hinge in limit.right.hinges]
    assert hinges == [(one["angle_deg"], one["edge"]) for one in printed["mechanism"]["right"]]

    chain = arch.chain(7)
    printed = json.loads(program("impact", path, "--count", 7, "--format", "json").stdout)["impacts"]
    assert [link.restitution for link in chain] == [one["restitution"] for one in printed]
    for link, one in zip(chain, printed):
        assert (link.index, link.before.sway, link.after.sway) == (
            one["index"],
            one["before"]["sway"],
            one["after"]["sway"],
        )
        assert [hinge.angle_deg for hinge in link.after.hinges] == [
            hinge["angle_deg"] for hinge in one["after"]["hinges"]
        ]
    assert arch.chain(3, "left")[0].before.sway == "left"


def test_defaults_are_those_of_the_program(arch: Arch, pulse: Pulse) -> None:
    """A scenario without the tables that have defaults, compared with the signature of the function."""
    text = (
        "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 180.0\n"
        "[ground.rectangular]\namplitude_g = -0.30\nduration_s = 0.20\n"
    )
    plain = Scenario.parse(text)
    assert Scenario.of(arch, pulse) == plain
    defaults = {
        name: parameter.default
        for name, parameter in inspect.signature(simulate).parameters.items()
        if name in plain.tables["simulation"]
    }
    assert defaults == plain.tables["simulation"] and len(defaults) == 5
    assert inspect.signature(simulate).parameters["duration_s"].default is None
    assert simulate(arch, pulse) == plain.run()


def test_a_record_of_arrays_is_that_of_a_file(program: Program, tmp_path: Path, arch: Arch) -> None:
    """Units, scales, vertical components and clocks, from arrays and as the program reads them from files."""
    rng = random.Random(3)
    time = [index * 0.01 for index in range(200)]
    across = [rng.gauss(0.0, 1.0) for _ in time]
    up = [rng.gauss(0.0, 0.1) for _ in time]
    for unit, factor in (("g", 0.3), ("m/s2", 3.0), ("cm/s2", 300.0)):
        x = [factor * one for one in across]
        y = [factor * one for one in up]
        for name, values in (("x.csv", x), ("y.csv", y)):
            rows = "".join(f"{t!r},{a!r}\n" for t, a in zip(time, values))
            (tmp_path / name).write_text(rows)
        path = tmp_path / "s.toml"
        path.write_text(
            "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 180.0\n"
            "[simulation]\nduration_s = 3.0\ngravity_m_s2 = 9.7\n"
            f'[ground.record]\nfile = "x.csv"\nunit = "{unit}"\nscale = 1.3\nstart_s = 0.2\n'
            f'[ground.record.vertical]\nfile = "y.csv"\nunit = "{unit}"\npeak_g = 0.2\n'
        )
        vertical = Record(time, y, unit=unit, peak_g=0.2)  # type: ignore[arg-type]
        record = Record(time, x, unit=unit, scale=1.3, start_s=0.2, vertical=vertical)  # type: ignore[arg-type]
        history = simulate(arch, record, duration_s=3.0, gravity_m_s2=9.7)
        assert np.any(history.vertical_acceleration_m_s2)
        ran = program("run", path, "--out", tmp_path / "out", "--rotations", "-")
        assert ran.returncode == 0, ran.stderr
        rows_told = list(csv.DictReader(ran.stdout.splitlines()))
        for column in ("ground_acceleration_m_s2", "rotation_left_rad", "rate_right_rad_s"):
            assert [float(row[column]) for row in rows_told] == history.to_pandas()[column].tolist()
        assert not math.isnan(history.rotations.sum())
