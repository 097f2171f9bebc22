"""Studies: files byte-identical to the program's, parts, progress, results as arrays."""

from __future__ import annotations

import json
import os
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from archrock import (
    Arch,
    Column,
    FirstFactors,
    OverturningMap,
    ProbabilityMap,
    Pulse,
    Record,
    Results,
    Scenario,
    capacity,
    compute_part,
    ensemble,
    map_scenario,
    merge,
    overturning_map,
    span,
    suite,
    threshold,
    threshold_along,
    verify,
)

from .conftest import ROOT, Program, issued

RECORDS = ROOT / "scenarios" / "records"
COSINE = Pulse.one_cosine(amplitude_g=0.5, duration_s=0.8)
AXES: dict[str, Any] = {
    "duration_s": span(0.4, 1.2, 5),
    "amplitude_g": span(0.12, 2.0, 6, "logarithmic"),
}


def assert_files(results: Results, folder: Path) -> None:
    files = results.files
    assert files
    for name, contents in files.items():
        assert (folder / name).read_bytes() == contents, name


def by_program(program: Program, folder: Path, command: str, text: str, *options: object) -> Path:
    """The folder with the results of a scenario, whose records lie beside it."""
    folder.mkdir(exist_ok=True)
    (folder / "s.toml").write_text(text)
    ran = program(command, folder / "s.toml", "--out", folder / "out", *options)
    assert ran.returncode == 0, ran.stderr
    return folder / "out"


def test_a_map_is_that_of_the_program(program: Program, tmp_path: Path, arch: Arch) -> None:
    found = overturning_map(arch, COSINE, AXES, duration_s=20.0)
    scenario = map_scenario(arch, COSINE, AXES, duration_s=20.0)
    assert overturning_map(scenario) == found
    assert_files(found, by_program(program, tmp_path, "map", scenario.to_toml()))

    assert found.axes == ("duration_s", "amplitude_g")
    assert found.x.tolist() == pytest.approx([0.4, 0.6, 0.8, 1.0, 1.2])
    assert len(found.y) == 6 and found.outcome.shape == found.impacts.shape == (5, 6)
    assert set(found.outcome.ravel()) == {"never_moved", "rest", "overturned"}
    assert found._repr_svg_().startswith("<svg") or "<svg" in found._repr_svg_()
    assert pickle.loads(pickle.dumps(found)) == found
    table = found.to_pandas()
    assert len(table) == 30 and list(table["outcome"]) == found.outcome.ravel().tolist()
    found.save(tmp_path / "saved")
    assert_files(found, tmp_path / "saved")
    # Each cell has the colour of its outcome.
    ax = found.plot()
    (mesh,) = ax.collections
    mesh.update_scalarmappable()
    colors = [tuple(color) for color in np.asarray(mesh.get_facecolor()).tolist()]
    outcomes = found.outcome.T.ravel()
    assert len(set(colors)) == 3 and len(set(zip(colors, outcomes))) == 3
    assert sorted(legend(ax)) == ["never moved", "overturned", "rest"]
    assert (ax.get_xlabel(), ax.get_ylabel()) == found.axes


def test_axes_are_anything_like_an_array() -> None:
    column = Column(4.0, 0.8)
    values = np.array([0.3, 0.6], dtype=np.float32)
    found = overturning_map(column, COSINE, {"duration_s": (0.5, 1.0), "amplitude_g": values})
    assert found.y.tolist() == values.astype(float).tolist()
    with pytest.raises(ValueError, match="does not ascend"):
        overturning_map(column, COSINE, {"duration_s": [1.0, 0.5], "amplitude_g": values})
    with pytest.raises(ValueError, match="exactly two"):
        overturning_map(column, COSINE, {"amplitude_g": values})


def test_thresholds_along_a_key_are_those_of_the_program(program: Program, tmp_path: Path) -> None:
    column, pulse = Column(4.0, 0.8), Pulse.one_sine(0.5, 0.5)
    scenario = Scenario.of(column, pulse)
    how: dict[str, Any] = {"key": "column.width_m", "start": 0.6, "end": 1.0, "count": 3, "no_impact": True, "stride": 0.1}
    found = threshold_along(column, pulse, **how)
    assert threshold_along(scenario, **how) == found
    options = ("--along", "column.width_m=0.6..1:3", "--no-impact", "--stride", "0.1")
    assert_files(found, by_program(program, tmp_path, "threshold", scenario.to_toml(), *options))
    assert found.columns()["column.width_m"].tolist() == [0.6, 0.8, 1.0]
    ax = found.plot()
    assert np.array_equal(ax.get_lines()[0].get_ydata(), found.columns()["overturns_from_factor"])
    assert legend(ax) == ["overturns from", "survives up to", "overturns without impact from"]


def test_an_ensemble_is_that_of_the_program(program: Program, tmp_path: Path) -> None:
    uncertain = {
        "samples": 40,
        "column.width_m": {"deviation": 0.04},
        "ground.one_cosine.amplitude_g": {"from": 0.3, "to": 0.9},
    }
    scenario = Scenario.of(Column(4.0, 0.8), COSINE, uncertain=uncertain)
    found = ensemble(scenario)
    folder = by_program(program, tmp_path, "run", scenario.to_toml())
    assert_files(found, folder / "uncertain")
    assert found.keys == ("column.width_m", "ground.one_cosine.amplitude_g")
    assert found.values.shape == (40, 2) and len(found.outcome) == len(found.peak_rotation) == 40
    overturned = int(np.count_nonzero(found.outcome == "overturned"))
    share = found.probability
    assert share["count"] == overturned and share["low"] < overturned / 40 < share["high"]
    assert len(found.to_pandas()) == 41
    assert found.bands["time_s"][0] == 0.0
    part = compute_part(scenario, "uncertain_threshold", (1, 1), tmp_path / "parts")
    factors = merge([part])
    assert isinstance(factors, FirstFactors) and len(factors.first_factor) == 40


def test_a_map_of_probability_is_that_of_the_program(program: Program, tmp_path: Path) -> None:
    table = "samples = 16\n'column.width_m' = { from = 0.7, to = 0.9 }\n"
    text = map_scenario(Column(4.0, 0.8), COSINE, AXES).to_toml() + f"[uncertain]\n{table}"
    scenario = Scenario.parse(text)
    parts = [compute_part(scenario, "uncertain_map", (part, 2), tmp_path / "parts") for part in (1, 2)]
    found = merge(parts)
    assert isinstance(found, ProbabilityMap)
    assert_files(found, by_program(program, tmp_path, "map", scenario.to_toml()) / "uncertain_map")
    low, high = found.interval
    assert found.probability.shape == low.shape == (len(found.x), len(found.y))
    assert (low <= found.probability).all() and (found.probability <= high).all()
    assert len(found.lines["overturned_50"]) == len(found.x)
    shown = found.plot().collections[0].get_array()
    assert shown is not None and np.array_equal(np.ravel(shown), found.probability.T.ravel())


def test_a_suite_is_that_of_the_program(program: Program, tmp_path: Path) -> None:
    """Records held in memory, compared with the same records in files."""
    column = Column(4.0, 0.8)
    records = [Record.read(path) for path in sorted(RECORDS.glob("wave-*.at2"))[:4]]
    levels = span(0.3, 3.0, 6, "logarithmic")
    found = suite(column, records, peaks_g=levels, duration_s=30.0)
    names = ", ".join(f'"{record.name}"' for record in records)
    for record in records:
        (tmp_path / record.name).write_bytes((RECORDS / record.name).read_bytes())
    text = (
        "[column]\nheight_m = 4.0\nwidth_m = 0.8\n[simulation]\nduration_s = 30.0\n"
        f"[suite]\nrecords = [{names}]\n"
        'peaks_g = { from = 0.3, to = 3.0, count = 6, spacing = "logarithmic" }\n'
    )
    folder = by_program(program, tmp_path, "suite", text)
    assert (folder / "suite.csv").read_bytes() == found.files["suite.csv"]
    assert (folder / "fragility.csv").read_bytes() == found.files["fragility.csv"]
    assert (folder / "suite.svg").read_bytes() == found.files["suite.svg"]
    assert found.fragility["overturned"].max() == 4
    assert found.summary["median"] > 0.0
    # The mirrored motion of a symmetric block is its mirror image, so it has no rows.
    assert len(found.columns()["record"]) == 4 * 6
    ax = found.plot()
    assert np.array_equal(ax.get_lines()[0].get_ydata(), found.fragility["fraction"])
    assert legend(ax) == ["fraction of cases", "lognormal curve", "95 % band"]

    given = Record.read(RECORDS / records[0].name, peak_g=1.0)
    wrong: list[tuple[Any, str]] = [
        ([given], "has no effect beside `peaks_g`"),
        ([records[0], records[0]], "the name of two records"),
        ([], "records"),
    ]
    for some, words in wrong:
        with pytest.raises(ValueError, match=words):
            suite(column, some, peaks_g=levels)


def test_records_without_levels_act_once(program: Program, tmp_path: Path) -> None:
    """The same cases as by the program, and a mark for each in the picture."""
    records = [Record.read(path) for path in sorted(RECORDS.glob("wave-*.at2"))[:4]]
    found = suite(Column(4.0, 0.8), records, duration_s=30.0)
    names = ", ".join(f'"{record.name}"' for record in records)
    for record in records:
        (tmp_path / record.name).write_bytes((RECORDS / record.name).read_bytes())
    text = f"[column]\nheight_m = 4.0\nwidth_m = 0.8\n[simulation]\nduration_s = 30.0\n[suite]\nrecords = [{names}]\n"
    folder = by_program(program, tmp_path, "suite", text)
    assert (folder / "suite.csv").read_bytes() == found.files["suite.csv"]
    outcomes = found.columns()["outcome"]
    assert len(outcomes) == 4
    assert found.summary["as_recorded"].records_that_overturn == np.sum(outcomes == "overturned")
    marks = found.plot().collections
    assert [np.shape(mark.get_offsets())[0] for mark in marks] == [np.sum(outcomes == "overturned"), 0, np.sum(outcomes != "overturned")]


def test_records_are_corrected() -> None:
    times = np.arange(1001) * 0.01
    values = np.sin(3.0 * times) + 0.3
    mean = Record(times, values, unit="m/s2", baseline="mean")
    ends = np.sum(0.5 * (mean.acceleration[1:] + mean.acceleration[:-1]) * 0.01)
    assert abs(ends) < 1e-12
    assert mean == Record(times, values, unit="m/s2", remove_mean=True)
    filtered = Record(times, values, unit="m/s2", baseline="linear", high_pass_hz=1.0, start_s=3.0)
    assert (len(filtered.time), filtered.time[0]) == (1601, -3.0)
    with pytest.raises(ValueError, match="`start_s` of at least 3"):
        Record(times, values, unit="m/s2", high_pass_hz=1.0)


def test_records_of_a_suite_may_have_their_own_unit_and_scale() -> None:
    column = Column(4.0, 0.8)
    plain = [Record.read(path) for path in sorted(RECORDS.glob("wave-*.at2"))[:2]]
    times, values = plain[1].time, plain[1].acceleration
    other = Record(times, values * (9.81 / 2.0), unit="m/s2", scale=2.0, name=plain[1].name)
    levels = [0.5, 1.0, 2.0]
    found = suite(column, [other, plain[0]], scales=levels, duration_s=30.0).columns()
    expected = suite(column, plain, scales=levels, duration_s=30.0).columns()
    assert list(found["record"]) == list(expected["record"])
    assert list(found["outcome"]) == list(expected["outcome"])
    assert np.allclose(found["peak_g"], expected["peak_g"], rtol=1e-12)


def test_a_record_named_like_a_number_keeps_its_name() -> None:
    record = Record.read(RECORDS / "wave-1.at2")
    named = Record(record.time, record.acceleration, unit="g", name="00123456789")
    columns = suite(Column(4.0, 0.8), [named], scales=[0.5, 1.0], duration_s=30.0).columns()
    assert set(columns["record"]) == {"00123456789"}
    assert set(columns["sign"]) <= {1.0, -1.0}


def test_a_threshold_is_that_of_the_program(program: Program, tmp_path: Path) -> None:
    column, pulse = Column(1.0, 0.2), Pulse.one_cosine(0.3, 0.5)
    found = threshold(column, pulse, from_factor=0.5, to_factor=6.0, stride=0.1)
    scenario = Scenario.of(column, pulse)
    assert threshold(scenario, from_factor=0.5, to_factor=6.0, stride=0.1) == found
    options = ("--from", 0.5, "--to", 6.0, "--stride", 0.1)
    assert_files(found, by_program(program, tmp_path, "threshold", scenario.to_toml(), *options))
    assert found.lowest_factor == found.bands[0]["from"] and found.gaps == found.summary["models"][0]["gaps"]
    with pytest.raises(ValueError, match="`stride = 0.0`"):
        threshold(column, pulse, stride=0.0)
    # Overturned factors have no largest rotation and are shaded.
    ax = found.plot()
    peak = np.asarray(ax.get_lines()[0].get_ydata(), dtype=float)
    assert np.array_equal(np.isnan(peak), found.columns()["outcome"] == "overturned")
    assert legend(ax)[:2] == ["largest rotation", "overturns"]


def test_a_capacity_is_that_of_the_program(program: Program, tmp_path: Path, arch: Arch) -> None:
    found = capacity(arch)
    scenario = Scenario.of(arch, COSINE)
    assert capacity(scenario).files["capacity.csv"] == found.files["capacity.csv"]
    assert_files(capacity(scenario), by_program(program, tmp_path, "capacity", scenario.to_toml()))
    right = found.side("right")
    assert right["acceleration_g"][0] == pytest.approx(arch.limit().right.acceleration_g, rel=1e-9)
    ax = found.plot()
    assert np.array_equal(ax.get_lines()[0].get_xdata(), right["displacement_m"])
    assert legend(ax) == ["to the right", "to the left"]
    with pytest.raises(TypeError, match="not str"):
        capacity("arch")  # type: ignore[arg-type]


def legend(ax: Any) -> list[str]:
    return [text.get_text() for text in ax.get_legend().get_texts()]


def test_parts_join_to_the_bytes_of_the_whole(program: Program, tmp_path: Path, arch: Arch) -> None:
    scenario = map_scenario(arch, COSINE, AXES, duration_s=20.0)
    whole = overturning_map(scenario)
    parts = [compute_part(scenario, "map", (index, 3), tmp_path) for index in (3, 1, 2)]
    # A part that exists is not computed again.
    before = parts[0].read_bytes()
    assert compute_part(scenario, "map", (3, 3), tmp_path) == parts[0]
    assert parts[0].read_bytes() == before
    merged = merge(parts)
    assert isinstance(merged, OverturningMap) and merged == whole
    ran = program("merge", *parts, "--out", tmp_path / "out")
    assert ran.returncode == 0, ran.stderr
    assert_files(whole, tmp_path / "out")

    with pytest.raises(ValueError, match="1 of 3 parts missing"):
        merge(parts[:2])
    with pytest.raises(ValueError, match="no parts"):
        merge([])
    with pytest.raises(ValueError, match="is not a part"):
        compute_part(scenario, "map", (4, 3), tmp_path)
    other = map_scenario(arch, COSINE, AXES, duration_s=21.0)
    with pytest.raises(ValueError, match="another study"):
        compute_part(other, "map", (3, 3), tmp_path)


def test_parts_of_a_map_join_without_the_file_of_its_record(tmp_path: Path) -> None:
    record = Record.read(RECORDS / "wave-1.at2")
    axes = {"column.width_m": [0.6, 0.8], "peak_g": [0.3, 0.9]}
    column = Column(4.0, 0.8)
    scenario = map_scenario(column, record, axes, duration_s=30.0)
    parts = [compute_part(scenario, "map", (index, 2), tmp_path) for index in (1, 2)]
    joined = merge(parts, scenario)
    assert joined == overturning_map(column, record, axes, duration_s=30.0)
    with pytest.raises(ValueError, match="another scenario"):
        merge(parts, map_scenario(column, record, axes, duration_s=31.0))
    with pytest.raises(ValueError, match="wave-1.at2"):
        merge(parts)


def test_a_progress_callback_is_called_and_can_end_the_work(arch: Arch) -> None:
    seen: list[tuple[int, int]] = []
    overturning_map(arch, COSINE, AXES, duration_s=20.0, progress=lambda *at: seen.append(at))
    assert seen[-1] == (30, 30) and seen == sorted(seen)

    def stop(done: int, of_all: int) -> None:
        raise LookupError(f"enough at {done} of {of_all}")

    many = {**AXES, "duration_s": span(0.4, 1.2, 500)}
    with pytest.raises(LookupError, match="enough at"):
        overturning_map(arch, COSINE, many, duration_s=20.0, progress=stop)


def test_threads_do_not_change_results(arch: Arch) -> None:
    one = overturning_map(arch, COSINE, AXES, duration_s=20.0, threads=1)
    assert one == overturning_map(arch, COSINE, AXES, duration_s=20.0, threads=4)
    for threads in (-1, 0, 100_000, 10**30):
        with pytest.raises(ValueError, match="`threads ="):
            overturning_map(arch, COSINE, AXES, threads=threads)


def test_invalid_studies_are_refused(arch: Arch, pulse: Pulse) -> None:
    plain = Scenario.of(arch, pulse)
    wrong: list[tuple[Any, str]] = [
        (lambda: overturning_map(plain), "no [map]"),
        (lambda: suite(plain), "no [suite]"),
        (lambda: overturning_map(plain, pulse), "leave ground out"),
        (lambda: overturning_map(arch, pulse), "two axes"),
        (lambda: threshold_along(plain, key="arch.depht_m", start=1, end=2, count=2), "unknown key `depht_m`"),
        (lambda: threshold(arch), "needs a ground motion"),
        (lambda: compute_part(plain, "maps", (1, 1), "/nowhere"), "is no study"),  # type: ignore[arg-type]
    ]
    for make, words in wrong:
        with pytest.raises(ValueError) as caught:
            make()
        assert words in str(caught.value)
    with pytest.raises(TypeError):
        overturning_map("arch")  # type: ignore[arg-type]


def test_results_are_saved_whole_or_not_at_all(tmp_path: Path, arch: Arch) -> None:
    found = overturning_map(arch, COSINE, {"duration_s": [0.5], "amplitude_g": [0.5]})
    taken = tmp_path / "file"
    taken.write_text("taken")
    with pytest.raises(OSError):
        found.save(taken)
    assert taken.read_text() == "taken"


def test_results_replace_those_of_the_same_study(arch: Arch, pulse: Pulse, program: Program, tmp_path: Path) -> None:
    """A folder holds the results of one run of a study; those of another study stay, with a warning if they are of another scenario."""
    axes = {"duration_s": [0.2, 0.8], "amplitude_g": [0.2, 0.9]}
    folder = tmp_path / "o"
    names = {"archrock.json", "map.csv", "map.html", "map.json", "map.svg"}
    uncertain = '[uncertain]\nsamples = 2\n"arch.depth_m" = { deviation = 0.01 }\n'
    table = {name: list(values) for name, values in axes.items()}
    (tmp_path / "s.toml").write_text(Scenario.of(arch, pulse, map=table, duration_s=5.0).to_toml() + uncertain)
    ran = program("map", tmp_path / "s.toml", "--out", folder)
    assert ran.returncode == 0, ran.stderr
    assert names | {"uncertain_map"} <= {path.name for path in folder.iterdir()}
    column = Column(height_m=4.0, width_m=0.8, drums=3)
    found = overturning_map(column, pulse, axes, model="free_hinges", duration_s=1.0)
    assert issued(lambda: found.save(folder)) == []
    assert {path.name for path in folder.iterdir()} == names == {"archrock.json", *found.files}

    (warned,) = issued(lambda: capacity(arch).save(folder))
    assert warned.startswith(f"{folder} holds results of `archrock map` from another scenario")
    assert {path.name for path in folder.iterdir()} == names | set(capacity(arch).files)
    assert issued(lambda: capacity(column).save(tmp_path / "other")) == []


def seal(folder: Path, command: str) -> dict[str, Any]:
    """The origin of the results of a command in a folder."""
    listed: dict[str, Any] = json.loads((folder / "archrock.json").read_text())["results"][command]
    assert listed["complete"] is True
    return {key: listed[key] for key in ("scenario", "records", "version")}


def test_seals_are_those_of_the_program(program: Program, tmp_path: Path) -> None:
    """The list of a folder has the scenario and its records, whether the program or Python writes it, at once or from parts."""
    (tmp_path / "spectrum.csv").write_text("period_s,acceleration_g\n0,0.2\n1,0.3\n4,0.1\n")
    names = []
    for index in range(3):
        names.append(f"r{index}.csv")
        (tmp_path / names[-1]).write_text("".join(f"{0.02 * i},{0.5 * (i % (7 + index)) - 1.5}\n" for i in range(200)))
    (tmp_path / "s.toml").write_text(
        "[column]\nheight_m = 4.0\nwidth_m = 0.8\n[simulation]\nduration_s = 5.0\n"
        f"[suite]\nrecords = {names}\nunit = 'm/s2'\npeaks_g = [0.1, 0.3]\n"
        f"[verify]\nslv_records = {names}\nunit = 'm/s2'\n"
        "[demand]\nsoil = 'B'\ntopography = 'T1'\n[demand.slv]\nag_g = 0.1\nf0 = 2.4\ntc_star_s = 0.3\n"
    )
    scenario = Scenario.read(tmp_path / "s.toml")
    for command, found in (("suite", suite(scenario)), ("verify", verify(scenario)), ("capacity", capacity(scenario))):
        ran = program(command, tmp_path / "s.toml", "--out", tmp_path / "o")
        assert ran.returncode == 0, ran.stderr
        found.save(tmp_path / "p")
        pickle.loads(pickle.dumps(found)).save(tmp_path / "q")
        own = seal(tmp_path / "o", command)
        assert own == seal(tmp_path / "p", command) == seal(tmp_path / "q", command)
        assert [name.split(" ")[0] for name in own["records"]] == names and "column" in own["scenario"]
    parts = [compute_part(scenario, "suite", (index, 2), tmp_path / "parts") for index in (1, 2)]
    merge(parts).save(tmp_path / "m")
    ran = program("merge", *parts, "--out", tmp_path / "n")
    assert ran.returncode == 0, ran.stderr
    assert seal(tmp_path / "m", "suite") == seal(tmp_path / "n", "suite") == seal(tmp_path / "o", "suite")


@pytest.mark.skipif(os.name == "nt", reason="folders cannot be locked")
def test_two_runs_do_not_write_into_one_folder(arch: Arch, tmp_path: Path) -> None:
    import fcntl

    found = capacity(arch)
    folder = tmp_path / "o"
    found.save(folder)
    held = os.open(folder, os.O_RDONLY)
    fcntl.flock(held, fcntl.LOCK_EX)
    for place in (folder, folder / "below"):
        with pytest.raises(OSError, match="is being written to by another run"):
            found.save(place)
    os.close(held)
    found.save(folder)
