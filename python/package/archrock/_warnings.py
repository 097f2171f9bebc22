"""Warnings about unlikely numbers and about limits of the results."""

from __future__ import annotations

import re
import sys
import warnings
from collections.abc import Iterable


_NUMBER = re.compile(r"(?<![\w.-])-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?(?![\w.-]*\w)")

_COMMAND = re.compile(r"run `archrock [^`]* --set free_hinges\.(\w+)=([\d.]+)`")


class ArchrockWarning(UserWarning):
    """An input is unlikely, or a result is of limited reliability.

    Python shows a warning of one kind once in a loop over many arches, with the numbers of the first. ``numbers`` are the numbers of the
    sentence ``details``. Results keep the sentences as ``summary["warnings"]``.

    ``warnings.simplefilter("ignore", ArchrockWarning)`` silences these warnings, ``"error"`` turns them into exceptions.
    """

    def __init__(self, details: str = "") -> None:
        super().__init__(details)
        self.details = details
        self.numbers = tuple(map(float, _NUMBER.findall(details)))
        self._is_compared = False

    def __str__(self) -> str:
        # Python compares the texts of warnings, and prints by `format`.
        return _NUMBER.sub("...", self.details) if self._is_compared else self.details

    def __format__(self, format_spec: str) -> str:
        return format(self.details, format_spec)


def in_python(words: str) -> str:
    """Words of the program in which keyword arguments take the place of a command."""
    def arguments(command: re.Match[str]) -> str:
        model = ', model="free"' if "--hinges free" in command[0] else ""
        return f"compute it with {command[1]}={command[2]}{model}"

    return _COMMAND.sub(arguments, words)


def warn(texts: Iterable[str]) -> None:
    """Issues warnings at the line that called the package."""
    for text in texts:
        level, frame = 1, sys._getframe()
        while frame.f_back is not None and frame.f_globals.get("__package__") == __package__:
            level, frame = level + 1, frame.f_back
        warning = ArchrockWarning(text)
        warning._is_compared = True
        try:
            warnings.warn(warning, stacklevel=level)
        finally:
            warning._is_compared = False
