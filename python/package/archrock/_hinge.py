"""Hinges, and the onset of motion that opens them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Hinge:
    """A place where one part of a structure turns relative to another, or to the ground.

    Attributes:
        angle_deg: section of an arch, in degrees from the left springing.
        edge: ``"intrados"`` or ``"extrados"``; for a joint ``None`` if both edges open.
        toe: for a column the side of the toe, ``"left"`` or ``"right"``.
        joint: for a row of blocks the joint, from 0 at the left springing or the base.
    """

    angle_deg: float | None = None
    edge: str | None = None
    toe: str | None = None
    joint: int | None = None

    @classmethod
    def _all(cls, hinges: list[dict[str, Any]]) -> tuple[Hinge, ...]:
        known = cls.__dataclass_fields__
        return tuple(
            cls(**{key: value for key, value in hinge.items() if key in known}) for hinge in hinges
        )


@dataclass(frozen=True)
class Mechanism:
    """A mechanism of a structure.

    Attributes:
        sway: the side to which it sways, ``"right"`` or ``"left"``.
        hinges: its hinges, from left to right.
    """

    sway: str
    hinges: tuple[Hinge, ...]

    @classmethod
    def _of(cls, values: Mapping[str, Any]) -> Mechanism:
        return cls(values["sway"], Hinge._all(values["hinges"]))


@dataclass(frozen=True)
class ChainLink:
    """An impact in the chain of mechanisms that follow each other from impact to impact.

    Attributes:
        index: number of the impact, from 1.
        restitution: kinetic energy after the impact over that before.
        before: the mechanism that closes.
        after: the mechanism that opens.
    """

    index: int
    restitution: float
    before: Mechanism
    after: Mechanism


@dataclass(frozen=True)
class Onset:
    """The onset of motion of a structure to one side.

    Attributes:
        acceleration_g: horizontal ground acceleration at which motion starts, in units of gravity; ``None`` if no
            acceleration starts it.
        hinges: the hinges that open, from left to right.
    """

    acceleration_g: float | None
    hinges: tuple[Hinge, ...]


@dataclass(frozen=True)
class Limit:
    """Onset of rocking by limit analysis, as from ``archrock limit``.

    Attributes:
        right: the onset to the right.
        left: the onset to the left.
        details: everything in the output of ``archrock limit --format json``.
    """

    right: Onset
    left: Onset
    details: dict[str, Any] = field(repr=False, compare=False)

    @classmethod
    def _of(cls, values: dict[str, Any]) -> Limit:
        def onset(side: str) -> Onset:
            hinges = values["mechanism"][side] or []
            return Onset(values["incipient_acceleration_g"][side], Hinge._all(hinges))

        return cls(onset("right"), onset("left"), values)
