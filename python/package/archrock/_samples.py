"""Samples of records, which go to the library as arrays."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Union

import numpy as np
import numpy.typing as npt

from . import _native


class Samples:
    """The samples of a record: an array with a column of times and one of values. It takes the place of a file."""

    __slots__ = ("table",)

    table: npt.NDArray[np.float64]

    def __init__(self, table: npt.NDArray[np.float64]) -> None:
        self.table = table
        self.table.flags.writeable = False

    @classmethod
    def of(cls, time: npt.ArrayLike, acceleration: npt.ArrayLike) -> Samples:
        """The samples of anything like arrays.

        Raises:
            ValueError: when the arrays have several dimensions, or different lengths.
            TypeError: when they hold no real numbers.
        """
        times, accelerations = _column("time", time), _column("acceleration", acceleration)
        if len(times) != len(accelerations):
            raise ValueError(
                f"`time` has {len(times)} samples and `acceleration` {len(accelerations)}: give one for each"
            )
        return cls(np.column_stack((times, accelerations)))

    def file(self) -> bytes:
        """The contents of a file with these samples, one per line; every number keeps all its digits."""
        return _native.file_of(self)

    def __eq__(self, other: object) -> bool:
        if isinstance(other, bytes):
            return self.file() == other
        if not isinstance(other, Samples):
            return NotImplemented
        return np.array_equal(self.table, other.table)

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.table,)


Held = dict[str, Union[bytes, Samples]]
"""Contents of files that are held in memory, by the names that a scenario uses."""


def as_files(held: Mapping[str, bytes | Samples]) -> dict[str, bytes]:
    """The contents as bytes of files."""
    return {name: one.file() if isinstance(one, Samples) else one for name, one in held.items()}


def _column(name: str, values: npt.ArrayLike) -> npt.NDArray[np.float64]:
    try:
        if isinstance(values, np.ma.MaskedArray):
            # The library refuses samples that are no numbers, with their place.
            values = np.ma.filled(values.astype(np.float64), np.nan)
        array = np.asarray(values)
        if array.dtype.kind not in "fiub":
            raise TypeError
        array = array.astype(np.float64, casting="unsafe")
    except (TypeError, ValueError):
        raise TypeError(f"`{name}` is no array of real numbers: {type(values).__name__}") from None
    if array.ndim != 1:
        raise ValueError(f"`{name}` has shape {array.shape}: it must be (samples,)")
    return array
