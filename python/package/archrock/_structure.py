"""Structures."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Literal, TypeVar

from ._described import Described, read_file
from ._hinge import ChainLink, Limit
from ._native import Scenario as NativeScenario
from ._samples import Held
from ._settings import Settings, long_name
from ._tables import Tables, arguments, plain_table, to_toml
from ._warnings import warn

_MOST_BASES = 64

Self = TypeVar("Self", bound="Structure")
OneTable = TypeVar("OneTable", bound="_OneTable")

Model = Literal["four", "four_links", "free", "free_hinges", "elastic", "elastic_joints"]


class Structure(Described):
    """A structure of any shape that a scenario allows, with its tables as keyword arguments.

    For circular arches, free-standing columns and rigid bodies there are :class:`Arch`, :class:`Column` and :class:`Body`.

    >>> pointed = Structure(
    ...     pointed_arch={"span_m": 4.0, "rise_m": 3.0, "thickness_m": 0.6, "voussoirs": 20},
    ...     piers={"height_m": 2.0, "width_m": 1.2},
    ... )

    Args:
        tables: tables such as ``arch``, ``column``, ``body``, ``pointed_arch``, ``elliptic_arch``, ``basket_arch``, ``blocks``,
            ``piers``, ``fill``, ``vehicle``, ``load`` and ``tie`` (lists), with their keys; ``blocks`` may name files, which are read now.

    Raises:
        ValueError: when the tables are wrong or the structure does not stand; all errors are reported together.
        OSError: when a file cannot be read.
    """

    __slots__ = ("_bases", "_model", "_native")

    _native: NativeScenario
    _bases: dict[Any, NativeScenario]
    _model: Model

    def __init__(self, **tables: Mapping[str, Any] | Sequence[Mapping[str, Any]]) -> None:
        read = plain_table(tables)
        files: Held = {}
        blocks = read.get("blocks")
        if isinstance(blocks, dict):
            for key in ("joints", "outlines"):
                if isinstance(blocks.get(key), str):
                    path = Path(blocks[key])
                    blocks[key] = path.name
                    files[path.name] = read_file(path)
        self._read(read, files)

    def _read(self, tables: Tables, files: Held) -> None:
        arch = tables.get("arch")
        whole = set(tables) == {"arch"} and isinstance(arch, dict)
        # If hinges may open anywhere, there are no blocks.
        four = whole and isinstance(arch, dict) and not {"voussoirs", "joints_deg"} & set(arch)
        # A wall behind one block applies to Housner's model; at height zero there is no wall. Drums are read for statics.
        column = tables.get("column")
        keys = column if isinstance(column, dict) else {}
        back = keys.get("back")
        one_block = keys.get("drums") is None and keys.get("drum_heights_m") is None
        held = isinstance(back, dict) and back.get("height_m") != 0 and one_block
        self._model = "four_links" if four or held else "free_hinges"
        self._native = NativeScenario(to_toml(tables), None, files, self._model, ())
        self._bases = {}
        self._describe(json.loads(self._native.structure_json()), files)

    def _base(self, key: tuple[Any, ...]) -> NativeScenario:
        """The structure with these settings, on still ground."""
        settings = Settings(*key)
        tables = {**self._tables, **settings.tables()}
        base = NativeScenario(to_toml(tables), None, self._files, long_name(settings.model), ())
        if len(self._bases) >= _MOST_BASES:
            self._bases.clear()
        self._bases[key] = base
        return base

    def replace(self: Self, **tables: Any) -> Self:
        """The same structure with other tables; ``None`` leaves a table out.

        Raises:
            ValueError: as for a new structure.
        """
        return self._restored(plain_table({**self._tables, **tables}), self._files)

    def limit(self) -> Limit:
        """The ground acceleration that starts it to either side, by limit analysis, as ``archrock limit``.

        Raises:
            ValueError: when the library cannot find such an onset.
        """
        found = Limit(json.loads(self._native.limit_json()))
        warn(found["warnings"])
        return found

    def chain(self, count: int = 5, sway: Literal["right", "left"] = "right") -> list[ChainLink]:
        """The mechanisms of the first ``count`` impacts, after a first sway to this side.

        They do not depend on the ground motion. The impacts follow the model ``max_restitution``; there are fewer if
        one of them stops the structure.

        Raises:
            ValueError: when it does not rock as a mechanism of one degree of freedom at a time, or a wall stands on
                this side.
        """
        if not 0 <= count <= 65535:
            raise ValueError(f"`count = {count}` is not allowed: it must be from 0 to 65535")
        return [ChainLink(link) for link in json.loads(self._native.chain_json(sway, count))]

    def __repr__(self) -> str:
        return f"{type(self).__name__}({arguments(self._tables)})"


class _OneTable(Structure):
    """A structure whose keys are those of one table. They are attributes too."""

    __slots__ = ()

    _table: ClassVar[str]

    if not TYPE_CHECKING:
        # Hidden from type checkers, which then find misspelt names.
        def __getattr__(self, name: str) -> Any:
            table = {} if name.startswith("_") else self._tables[self._table]
            if name in table:
                return table[name]
            given = f"; it was given by: {', '.join(table)}" if table else ""
            raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}{given}")

    def replace(self: OneTable, **keys: Any) -> OneTable:
        """The same structure with other values of these keys; ``None`` leaves a key out.

        >>> arch = Arch(mean_radius_m=5.0, thickness_ratio=0.15, embrace_deg=180.0)
        >>> arch.replace(thickness_ratio=None, thickness_m=0.8).thickness_m
        0.8

        Raises:
            ValueError: as for a new structure.
        """
        own = {**self._tables[self._table], **keys}
        return self._restored(plain_table({**self._tables, self._table: own}), self._files)

    def __repr__(self) -> str:
        beside = {table: keys for table, keys in self._tables.items() if table != self._table}
        return f"{type(self).__name__}({arguments({**self._tables[self._table], **beside})})"


class Arch(_OneTable):
    """A circular masonry arch of constant thickness.

    Args:
        mean_radius_m: radius of its middle line.
        thickness_ratio: thickness over mean radius; or give ``thickness_m``.
        embrace_deg: angle from springing to springing, 180 for a semicircle.
        thickness_m: thickness, instead of ``thickness_ratio``.
        voussoirs: number of equal voussoirs, at whose joints hinges open; ``None``: hinges may open anywhere.
        depth_m: length out of plane; ``None``: the default, 1.
        density_kg_m3: density; ``None``: the default, 2000.
        others: further keys of ``[arch]``.

    Raises:
        ValueError: when a number is not allowed, or the arch cannot stand, with the library's explanation.

    >>> arch = Arch(mean_radius_m=5.0, thickness_ratio=0.15, embrace_deg=180.0)
    >>> round(arch.limit().right.acceleration_g, 8)
    0.14432644
    >>> arch.thickness_ratio
    0.15
    """

    __slots__ = ()
    _table: ClassVar[str] = "arch"

    mean_radius_m: float
    thickness_ratio: float
    thickness_m: float
    span_m: float
    rise_m: float
    embrace_deg: float
    measured_at: str
    voussoirs: int
    joints_deg: list[float]
    depth_m: float
    density_kg_m3: float

    def __init__(
        self,
        mean_radius_m: float | None = None,
        thickness_ratio: float | None = None,
        embrace_deg: float | None = None,
        *,
        thickness_m: float | None = None,
        voussoirs: int | None = None,
        depth_m: float | None = None,
        density_kg_m3: float | None = None,
        **others: Any,
    ) -> None:
        arch = {
            "mean_radius_m": mean_radius_m,
            "thickness_ratio": thickness_ratio,
            "thickness_m": thickness_m,
            "embrace_deg": embrace_deg,
            "depth_m": depth_m,
            "density_kg_m3": density_kg_m3,
            "voussoirs": voussoirs,
            **others,
        }
        super().__init__(arch=arch)


class Column(_OneTable):
    """A free-standing column: Housner's block, or a stack of drums.

    Args:
        height_m: height.
        width_m: width in the plane of the motion.
        drums: number of equal drums; or give ``drum_heights_m``. Drums and a taper need a model of blocks.
        drum_heights_m: heights of drums from the base up, shape ``(drums,)``.
        top_width_m: width at the top, if it tapers.
        pedestal: true: it stands on a pedestal as wide as its base and can slide off; false or ``None``: the ground extends
            beyond the base.
        depth_m: length out of plane; ``None``: the default, 1.
        density_kg_m3: density; ``None``: the default, 2000.
        back: table ``[column.back]``: a wall behind the column, from which it can only move away, such as
            ``{"side": "left"}``, perhaps with ``height_m`` and ``restitution`` (ratio of rates), which one block before a lower wall
            or with moving loads needs; drums then need elastic joints.
            ``None``: it stands free.
        top: table ``[column.top]``: a floor that holds the top sideways and rises with it, such as ``{"weight_n": 25e3}``, perhaps
            with ``x_m``; for ``limit``, ``capacity`` and ``verify``.
        load: tables ``[[load]]``: roofs, floors and thrusts, such as ``[{"mass_kg": 1500.0, "x_m": -0.15}]``, perhaps with
            ``height_m``, ``moves`` and ``thrust_n``.

    Raises:
        ValueError: when a number is not allowed, with the library's explanation.
    """

    __slots__ = ()
    _table: ClassVar[str] = "column"

    height_m: float
    width_m: float
    drums: int
    drum_heights_m: list[float]
    top_width_m: float
    pedestal: bool
    depth_m: float
    density_kg_m3: float
    back: dict[str, Any]
    top: dict[str, Any]

    def __init__(
        self,
        height_m: float,
        width_m: float,
        *,
        drums: int | None = None,
        drum_heights_m: Any = None,
        top_width_m: float | None = None,
        pedestal: bool | None = None,
        depth_m: float | None = None,
        density_kg_m3: float | None = None,
        back: Mapping[str, Any] | None = None,
        top: Mapping[str, Any] | None = None,
        load: Sequence[Mapping[str, Any]] | None = None,
    ) -> None:
        column = {
            "height_m": height_m,
            "width_m": width_m,
            "drums": drums,
            "drum_heights_m": drum_heights_m,
            "top_width_m": top_width_m,
            "pedestal": pedestal,
            "depth_m": depth_m,
            "density_kg_m3": density_kg_m3,
            "back": back,
            "top": top,
        }
        super().__init__(column=column, **({"load": load} if load else {}))

class Body(_OneTable):
    """A rigid body by its numbers that rocks about two toes, such as a statue or a machine.

    >>> statue = Body(mass_kg=1200.0, inertia_kg_m2=500.0, centre_m=[0.05, 0.9], toes_x_m=[-0.4, 0.4])

    Args:
        mass_kg: mass.
        inertia_kg_m2: moment of inertia about the centre of gravity.
        centre_m: centre of gravity, ``[x, y]`` to the right and upwards, from any point of the ground.
        toes_x_m: the left and the right toe, to the right of that point.
        load: tables ``[[load]]``, as of a :class:`Column`.

    Raises:
        ValueError: when a number is not allowed, with the library's explanation.
    """

    __slots__ = ()
    _table: ClassVar[str] = "body"

    mass_kg: float
    inertia_kg_m2: float
    centre_m: list[float]
    toes_x_m: list[float]

    def __init__(
        self,
        *,
        mass_kg: float,
        inertia_kg_m2: float,
        centre_m: Any,
        toes_x_m: Any,
        load: Sequence[Mapping[str, Any]] | None = None,
    ) -> None:
        body = {"mass_kg": mass_kg, "inertia_kg_m2": inertia_kg_m2, "centre_m": centre_m, "toes_x_m": toes_x_m}
        super().__init__(body=body, **({"load": load} if load else {}))
