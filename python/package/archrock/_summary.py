"""Results of the library as objects: the keys of its JSON are attributes."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, NoReturn

from ._tables import arguments


class Summary(dict[str, Any]):
    """A result as the program writes it in JSON: a dictionary whose keys are attributes too.

    ``summary.steps`` is ``summary["steps"]``, and ``summary.dimensionless.p_rad_s`` lies one level deeper. The keys follow from the types of
    the library; ``docs/json.md`` explains them with their units. A key that is a word of Python is read as ``band["from"]``.
    """

    __slots__ = ()

    @classmethod
    def _parse(cls, text: str | bytes) -> Summary:
        summary: Summary = json.loads(text, object_hook=cls)
        return summary

    if not TYPE_CHECKING:
        # Type checkers know the keys from `_keys.pyi`, and find misspelt ones.
        def __getattr__(self, name: str) -> Any:
            try:
                return self[name]
            except KeyError:
                kind, keys = type(self).__name__, ", ".join(self)
                raise AttributeError(f"this {kind} has no key {name!r}; its keys are: {keys}") from None

    def __dir__(self) -> Iterable[str]:
        return [*super().__dir__(), *self]

    def __repr__(self) -> str:
        return f"{type(self).__name__}({arguments(self)})"

    def to_dict(self) -> dict[str, Any]:
        """A copy that consists of plain dictionaries and lists."""
        copy: dict[str, Any] = json.loads(json.dumps(self))
        return copy


class Untyped:
    """The base of results in place of the classes of ``_keys.pyi``, which type checkers alone read."""

    __slots__ = ()


class Part(Summary):
    """A part of a result that cannot be changed: lists are tuples, and it has a hash."""

    __slots__ = ()

    _parts: ClassVar[Mapping[str, type[Part]]] = {}
    """Types of the parts inside it, by their keys; those of other keys are plain parts."""

    def __init__(self, values: Mapping[str, Any] = {}, **keys: Any) -> None:
        super().__init__(values, **keys)
        for key, value in self.items():
            if isinstance(value, (dict, list, tuple)):
                super().__setitem__(key, _fixed(value, self._parts.get(key, Part)))

    def _refuse(self, *_: Any, **__: Any) -> NoReturn:
        raise TypeError(f"a {type(self).__name__} cannot be changed; `to_dict` returns a copy that can")

    __setitem__ = __delitem__ = __ior__ = _refuse
    clear = pop = popitem = setdefault = update = _refuse

    def __hash__(self) -> int:  # type: ignore[override]
        return hash(frozenset(self.items()))

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (dict(self),)


def _fixed(value: Any, part: type[Part]) -> Any:
    if isinstance(value, dict):
        return value if isinstance(value, Part) else part(value)
    if isinstance(value, (list, tuple)):
        # Lists hold either numbers and texts alone, or none.
        nested = value and isinstance(value[0], (dict, list, tuple))
        return tuple([_fixed(one, part) for one in value] if nested else value)
    return value


class Summarised:
    """An object with a summary, whose keys are its own attributes too."""

    __slots__ = ()

    def _numbers(self) -> Summary:
        """The summary, or the part of it whose keys are attributes."""
        raise NotImplementedError

    def _attribute(self, name: str) -> Any:
        # No key begins with an underscore, and an object that is being restored has no attributes yet.
        if not name.startswith("_"):
            numbers = self._numbers()
            if name in numbers:
                return numbers[name]
        raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            return self._attribute(name)

    def __dir__(self) -> Iterable[str]:
        return [*super().__dir__(), *self._numbers()]
