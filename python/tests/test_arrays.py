"""Arrays: anything array-like goes in; arrays that come out are the memory itself."""

from __future__ import annotations

import gc
import pickle
from typing import Any

import numpy as np
import pytest

from archrock import Arch, Column, Pulse, Record, Scenario, simulate
from archrock._samples import Samples

COLUMN: dict[str, Any] = {"column": {"height_m": 4.0, "width_m": 0.8}}
TIME = np.arange(50) * 0.02
ACCELERATION = np.round(np.sin(7.0 * TIME), 3)


def unaligned(values: Any) -> Any:
    """An array whose numbers lie at odd addresses, as in network frames."""
    data = b"x" + np.asarray(values, dtype=np.float64).tobytes()
    array = np.frombuffer(data, dtype=np.uint8)[1:].view(np.float64)
    assert not array.flags.aligned and not array.flags.writeable
    return array


def read_only(values: Any) -> Any:
    array = np.array(values)
    array.flags.writeable = False
    return array


class ArrayLike:
    """An object that is not an array but converts to one, like series of pandas and arrays of Dask."""

    def __array__(self, dtype: Any = None, copy: Any = None) -> Any:
        return np.array(ACCELERATION, dtype=dtype)


LIKE = {
    "list": ACCELERATION.tolist(),
    "tuple": tuple(ACCELERATION.tolist()),
    "strided": np.repeat(ACCELERATION, 3)[::3],
    "reversed": ACCELERATION[::-1].copy()[::-1],
    "column of a table": np.column_stack([TIME, ACCELERATION])[:, 1],
    "read-only": read_only(ACCELERATION),
    "unaligned": unaligned(ACCELERATION),
    "big endian": ACCELERATION.astype(">f8"),
    "long double": ACCELERATION.astype(np.longdouble),
    "protocol": ArrayLike(),
}


@pytest.mark.parametrize("like", LIKE)
def test_anything_like_an_array_is_the_same_record(like: str) -> None:
    plain = Record(TIME, ACCELERATION, unit="m/s2")
    record = Record(unaligned(TIME), LIKE[like], unit="m/s2")
    assert record == plain
    assert record.acceleration.tolist() == ACCELERATION.tolist()


def test_smaller_numbers_are_widened_exactly() -> None:
    single = ACCELERATION.astype(np.float32)
    assert Record(TIME, single, unit="g").acceleration.tolist() == single.astype(float).tolist()
    whole = np.arange(50, dtype=np.int16)
    assert Record(whole, whole, unit="cm/s2").time.tolist() == list(map(float, range(50)))


def test_series_of_pandas_are_arrays() -> None:
    import pandas

    table = pandas.DataFrame({"t": TIME, "a": ACCELERATION})
    assert Record(table["t"], table["a"], unit="m/s2") == Record(TIME, ACCELERATION, unit="m/s2")


@pytest.mark.parametrize("wrong", ["text", ["a", "b"], [1 + 2j, 2.0], None, object(), [[1.0], [1.0, 2.0]], [None, 1.0]])
def test_values_that_are_not_numeric_arrays_are_refused(wrong: Any) -> None:
    with pytest.raises((TypeError, ValueError), match="`acceleration`"):
        Record([0.0, 1.0], wrong, unit="g")


@pytest.mark.parametrize(
    ("time", "acceleration", "words"),
    [
        ([0.0, 1.0], [0.1, np.nan], "the record \"mine\" is faulty: sample 2: `nan` is not a finite number"),
        ([0.0, 1.0, 1.0], [0.1, 0.2, 0.3], "the record \"mine\" is faulty: sample 3: the time does not increase"),
        ([0.0], [0.1], "the number of samples is 1; must be at least 2"),
        ([0.0, 1.0], [0.1, 1e5], "the record \"mine\" reaches"),
        ([-1.0, 1.0], [0.1, 0.2], "the record \"mine\" begins at -1 s"),
    ],
)
def test_messages_about_arrays_name_samples_and_no_file(time: Any, acceleration: Any, words: str) -> None:
    with pytest.raises(ValueError) as caught:
        Record(time, acceleration, unit="g", name="mine")
    assert words in str(caught.value) and "file" not in str(caught.value), str(caught.value)


def test_samples_stay_arrays_until_a_file_is_needed() -> None:
    count = 1_000_000
    record = Record(np.arange(count) * 0.001, np.sin(np.arange(count)), unit="m/s2")
    samples = record._files["record"]
    # Two numbers a sample, without a text.
    assert isinstance(samples, Samples) and samples.table.nbytes == 16 * count
    assert len(pickle.dumps(record)) < 17 * count
    assert pickle.loads(pickle.dumps(record)) == record
    small = Record(TIME, ACCELERATION, unit="m/s2")
    rows = small.files["record"].decode().splitlines()
    assert [tuple(map(float, row.split(","))) for row in rows] == list(zip(TIME, ACCELERATION))
    # The same record from a file with these contents.
    tables = small.tables["record"]
    assert Scenario({**COLUMN, "ground": small.tables}, files=small.files) == Scenario.of(Column(4.0, 0.8), small)
    assert tables["format"] == "csv"


def test_a_file_that_never_ends_is_refused() -> None:
    with pytest.raises(ValueError, match="larger than 64 MiB, too large for a record"):
        Record.read("/dev/zero", format="csv", unit="g")
    with pytest.raises(ValueError, match="larger than 1 MiB, too large for a scenario"):
        Scenario.read("/dev/zero")


def test_arrays_are_taken_and_not_copied(arch: Arch, pulse: Pulse) -> None:
    history = simulate(arch, pulse)
    for name in ("time", "rotations", "rates", "poses", "energy_j", "ground_acceleration_m_s2"):
        array = getattr(history, name)
        again = getattr(history, name)
        assert again.__array_interface__["data"] == array.__array_interface__["data"], name
        assert array.dtype == np.float64 and array.flags.c_contiguous and array.flags.aligned
        # NumPy did not allocate the memory: its owner is the object that took it from Rust.
        owner = array
        while isinstance(owner.base, np.ndarray):
            owner = owner.base
        assert not owner.flags.owndata and "PySliceContainer" in type(owner.base).__name__, name
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0
    assert np.shares_memory(history.rotations, history.rotations[:, 1])


def test_arrays_outlive_their_history(arch: Arch, pulse: Pulse) -> None:
    history = simulate(arch, pulse)
    rotations, expected = history.rotations, history.rotations.tolist()
    del history
    gc.collect()
    # Reuses any memory that was freed.
    for _ in range(20):
        simulate(arch, pulse, duration_s=0.5)
    assert rotations.tolist() == expected


def test_unknown_energies_are_nan_and_nothing_else_is() -> None:
    drums = Column(4.0, 0.8, drums=3)
    history = simulate(drums, Pulse.half_sine(0.4, 0.4), model="free_hinges", duration_s=0.5)
    for name in ("time", "rotations", "rates", "poses", "gaps", "energy_j", "friction_demand"):
        assert np.isfinite(getattr(history, name)).all(), name
    assert history.open_hinges.max() >= 1
