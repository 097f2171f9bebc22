"""Hinges, and the onset of motion that opens them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar

from ._summary import Part, Untyped

if TYPE_CHECKING:
    from ._keys import ImpactImpactsKeys, LimitKeys
else:
    ImpactImpactsKeys = LimitKeys = Untyped


class Hinge(Part):
    """A place where one part of a structure turns relative to another, or to the ground.

    It has those of these keys that apply to its structure; the others are ``None``:

    - ``angle_deg``: section of an arch, in degrees from the left springing.
    - ``edge``: ``"intrados"`` or ``"extrados"``; for a joint ``None`` if both edges open.
    - ``toe``: for a column the side of the toe, ``"left"`` or ``"right"``.
    - ``joint``: for a row of blocks the joint, from 0 at the left springing or the base.
    """

    __slots__ = ()

    angle_deg: float | None
    edge: str | None
    toe: str | None
    joint: int | None

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            if name in ("angle_deg", "edge", "toe", "joint"):
                return self.get(name)
            return super().__getattr__(name)


class Mechanism(Part):
    """A mechanism of a structure: ``sway``, and ``hinges`` from left to right, as ``impacts.before`` of ``archrock impact``."""

    __slots__ = ()

    sway: str
    hinges: tuple[Hinge, ...]

    _parts: ClassVar[Mapping[str, type[Part]]] = {"hinges": Hinge}


class ChainLink(ImpactImpactsKeys, Part):
    """An impact in the chain of mechanisms that follow each other from impact to impact.

    Its keys are those of ``impacts`` of ``archrock impact``, such as ``index``, ``restitution``, ``before`` and ``after``.
    """

    __slots__ = ()
    _parts: ClassVar[Mapping[str, type[Part]]] = {"before": Mechanism, "after": Mechanism}


class Onset(Part):
    """The onset of motion of a structure to one side.

    - ``acceleration_g``: horizontal ground acceleration at which motion starts, in units of gravity; ``None`` if no acceleration starts
      it.
    - ``hinges``: the hinges that open, from left to right.
    """

    __slots__ = ()

    acceleration_g: float | None
    hinges: tuple[Hinge, ...]

    _parts: ClassVar[Mapping[str, type[Part]]] = {"hinges": Hinge}


class _BySide(Part):
    __slots__ = ()

    right: Any
    left: Any

    _parts: ClassVar[Mapping[str, type[Part]]] = {"right": Hinge, "left": Hinge}


class Limit(LimitKeys, Part):
    """Onset of rocking by limit analysis: its keys are those of ``archrock limit --format json``."""

    __slots__ = ()
    _parts: ClassVar[Mapping[str, type[Part]]] = {"mechanism": _BySide}

    def _onset(self, side: str) -> Onset:
        return Onset(
            acceleration_g=self.incipient_acceleration_g[side], hinges=self.mechanism[side] or ()
        )

    @property
    def right(self) -> Onset:
        """The onset to the right."""
        return self._onset("right")

    @property
    def left(self) -> Onset:
        """The onset to the left."""
        return self._onset("left")

    @property
    def details(self) -> dict[str, Any]:
        """Everything in the output of ``archrock limit --format json``."""
        return self.to_dict()
