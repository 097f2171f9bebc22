"""Objects described by tables of a scenario and by the files that these tables name."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any, TypeVar

from ._samples import Held, Samples, as_files
from ._tables import Tables, plain, to_toml

Self = TypeVar("Self", bound="Described")


class Described:
    """Tables of a scenario with the contents of the files that they name.

    Such objects are immutable. They are equal if their contents are, and can be pickled with their files.
    """

    __slots__ = ("_files", "_tables", "_text")

    _tables: Tables
    _files: Held
    _text: str

    def _describe(self, tables: Mapping[str, Any], files: Mapping[str, bytes | Samples]) -> None:
        self._tables = plain(tables)
        self._files = dict(files)
        self._text = to_toml(self._tables)

    @property
    def tables(self) -> Tables:
        """Its contents with every default filled in, with the keys of a scenario (a copy)."""
        copy: Tables = plain(self._tables)
        return copy

    @property
    def files(self) -> dict[str, bytes]:
        """The files that the tables name and that are held in memory, by their names (a copy)."""
        return as_files(self._files)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Described) or type(other) is not type(self):
            return NotImplemented
        return self._tables == other._tables and self._files == other._files

    def __hash__(self) -> int:
        return hash((type(self), self._text))

    @classmethod
    def _restored(cls: type[Self], tables: Tables, files: Held) -> Self:
        described = cls.__new__(cls)
        described._read(tables, files)
        return described

    def _read(self, tables: Tables, files: Held) -> None:
        """Restores an object from its tables and files."""
        raise NotImplementedError

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self)._restored, (self._tables, self._files)


def read_file(path: str | os.PathLike[str], what: str = "record", mib: int = 64) -> bytes:
    """The contents of a file of at most ``mib`` MiB.

    Raises:
        OSError: when it cannot be read.
        ValueError: when it is larger, as a device that never ends.
    """
    most = mib << 20
    with open(os.fspath(path), "rb") as file:
        contents = file.read(most + 1)
    if len(contents) > most:
        raise ValueError(f"{path} is larger than {mib} MiB, too large for a {what}")
    return contents
