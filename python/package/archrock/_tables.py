"""Tables of a scenario: dictionaries in Python, TOML text for the library, which checks them."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

Tables = dict[str, Any]
"""Tables of a scenario: its keys, units included, with their values."""


def plain(value: Any) -> Any:
    """A value in the types of TOML: NumPy's numbers and arrays, tuples and mappings become Python's own.

    Keys whose value is ``None`` are left out.

    Raises:
        TypeError: when the value has another type.
    """
    if isinstance(value, (bool, str)):
        return value
    if isinstance(value, np.generic):
        return plain(value.item())
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, (int, float)):
        return value
    if isinstance(value, Mapping):
        return {_key(key): plain(one) for key, one in value.items() if one is not None}
    if isinstance(value, Sequence) and not isinstance(value, (bytes, bytearray)):
        return [plain(one) for one in value]
    if hasattr(value, "__array__"):
        return plain(np.asarray(value))
    raise TypeError(f"a scenario has no values of type {type(value).__name__}: {value!r}")


def _key(key: Any) -> str:
    if isinstance(key, str):
        return key
    raise TypeError(f"keys of a scenario are texts, not {key!r}")


def plain_table(value: Any) -> Tables:
    """A table in plain types.

    Raises:
        TypeError: when it is not a mapping, or has values of other types.
    """
    if not isinstance(value, Mapping):
        raise TypeError(f"tables are mappings of keys to values, not {type(value).__name__}")
    table: Tables = plain(value)
    return table


def to_toml(tables: Mapping[str, Any]) -> str:
    """The TOML text of tables, one line each.

    Raises:
        TypeError: as for :func:`plain_table`.
    """
    entries = plain_table(tables).items()
    return "".join(f"{_quoted(key)} = {_value(one)}\n" for key, one in entries)


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return _quoted(value)
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, list):
        return "[" + ", ".join(map(_value, value)) + "]"
    entries = (f"{_quoted(key)} = {_value(one)}" for key, one in value.items())
    return "{ " + ", ".join(entries) + " }"


def _quoted(text: str) -> str:
    text.encode("utf-8")  # A text that is not valid Unicode cannot be written to a file.
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def arguments(table: Mapping[str, Any]) -> str:
    """Entries of a table as keyword arguments."""
    return ", ".join(f"{key}={value!r}" for key, value in table.items())
