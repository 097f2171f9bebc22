"""Warnings about unlikely numbers and about limits of the results."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterable


class ArchrockWarning(UserWarning):
    """An input is unlikely, or a result is of limited reliability.

    ``warnings.simplefilter("ignore", ArchrockWarning)`` silences these warnings, ``"error"`` turns them into exceptions. Results keep
    them as ``summary["warnings"]``.
    """


def warn(texts: Iterable[str]) -> None:
    """Issues warnings at the line that called the package."""
    for text in texts:
        level, frame = 1, sys._getframe()
        while frame.f_back is not None and frame.f_globals.get("__package__") == __package__:
            level, frame = level + 1, frame.f_back
        warnings.warn(text, ArchrockWarning, stacklevel=level)
