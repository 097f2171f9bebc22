"""Studies: many histories evaluated together, on all processors, or in parts on several machines."""

from __future__ import annotations

import csv
import html
import io
import math
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeVar, Union

import numpy as np

from . import _native
from ._described import read_file
from ._ground import Ground, Pulse, Record
from ._history import _axes
from ._samples import Held, Samples
from ._scenario import Scenario
from ._structure import Structure
from ._summary import Summarised, Summary, Untyped
from ._warnings import in_python, warn

if TYPE_CHECKING:
    import numpy.typing as npt
    import pandas
    from matplotlib.axes import Axes

    from ._keys import (
        CapacityResult,
        EnsembleUncertainMapResult,
        EnsembleUncertainRunResult,
        EnsembleUncertainSuiteResult,
        EnsembleUncertainThresholdResult,
        MapResult,
        SuiteResult,
        ThresholdAlongResult,
        ThresholdModelsKeys,
        ThresholdResult,
        VerifyResult,
    )

    class _ThresholdKeys(ThresholdModelsKeys, ThresholdResult):
        pass

else:
    CapacityResult = EnsembleUncertainMapResult = EnsembleUncertainRunResult = EnsembleUncertainSuiteResult = EnsembleUncertainThresholdResult = Untyped
    MapResult = SuiteResult = ThresholdAlongResult = VerifyResult = _ThresholdKeys = Untyped

Progress = Callable[[int, int], object]
"""Called with the number of cases done and of all cases; an exception that it raises ends the work."""

Values = Any
"""Increasing numbers, anything like an array, or a :func:`span`."""

Study = Literal[
    "map", "suite", "uncertain", "uncertain_threshold", "uncertain_suite", "uncertain_map"
]


def span(
    start: float,
    end: float,
    count: int,
    spacing: Literal["linear", "logarithmic"] = "linear",
) -> dict[str, Any]:
    """Numbers from ``start`` to ``end``, both included, bit-identical to the program's ``{ from, to, count, spacing }``."""
    return {"from": start, "to": end, "count": count, "spacing": spacing}


class Files(Summarised):
    """Files as the program writes them, held in memory. The keys of :attr:`summary` are attributes too."""

    __slots__ = ("_answer", "_files", "_origin", "_texts")

    _json: str

    def __init__(
        self,
        files: Iterable[tuple[str, bytes]],
        origin: str,
        texts: Iterable[tuple[str, Sequence[str]]] = (),
        answer: str = "",
    ) -> None:
        self._answer = answer
        self._files = tuple((name, bytes(contents)) for name, contents in files)
        self._origin = origin
        self._texts = {name: frozenset(columns) for name, columns in texts}

    @property
    def files(self) -> dict[str, bytes]:
        """The files by their names, byte-identical to those that the program writes."""
        return dict(self._files)

    def save(self, folder: str | os.PathLike[str]) -> None:
        """Writes the files into a folder, all of them or none.

        They replace everything that the last run of this study left there. Results of other studies stay; if they come from another
        scenario, that is an :class:`ArchrockWarning`.

        Raises:
            OSError: when they cannot be written, or another run is writing to the folder.
        """
        warn(_native.save(folder, self._files, self._origin))

    @property
    def summary(self) -> Summary:
        """The JSON file: the scenario with all defaults, numbers, and failures."""
        return Summary._parse(self.files[self._json])

    def _numbers(self) -> Summary:
        return self.summary

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Files):
            return NotImplemented
        return self._files == other._files

    def __hash__(self) -> int:
        return hash(self._files)

    def __reduce__(self) -> tuple[Any, ...]:
        texts = tuple((name, tuple(columns)) for name, columns in self._texts.items())
        return type(self), (self._files, self._origin, texts, self._answer)

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {self._answer.partition(chr(10))[0]}>"

    def __str__(self) -> str:
        """The answer with its conditions and main numbers, as the program prints it."""
        return f"{type(self).__name__}:\n  {in_python(self._answer)}"


class Results(Files):
    """Results of a study: tables, a picture and a summary."""

    __slots__ = ()

    _picture: str
    _table: str

    def columns(self, file: str | None = None) -> dict[str, npt.NDArray[Any]]:
        """The columns of a table, by default the study's main one; empty cells of numbers are NaN."""
        file = file or self._table
        header, *rows = csv.reader(io.StringIO(self.files[file].decode()))
        texts = self._texts.get(file, frozenset())
        columns = zip(header, zip(*rows)) if rows else ((name, ()) for name in header)
        return {name: _column(cells, name in texts) for name, cells in columns}

    def to_pandas(self, file: str | None = None) -> pandas.DataFrame:
        """A table of the study, by default its main one. Needs pandas."""
        import pandas

        table: pandas.DataFrame = pandas.DataFrame(self.columns(file))
        return table

    def to_parquet(self, path: str | os.PathLike[str], file: str | None = None) -> None:
        """Writes a table of the study, by default its main one, as Parquet. Needs pandas with pyarrow or fastparquet.

        Raises:
            ImportError: when one of them is not installed.
            OSError: when it cannot be written.
        """
        self.to_pandas(file).to_parquet(path)

    def _repr_svg_(self) -> str:
        return self.files[self._picture].decode()


def _column(cells: Sequence[str], is_text: bool) -> npt.NDArray[Any]:
    if is_text:
        return np.array(cells)
    return np.array([float(cell) if cell else np.nan for cell in cells])


class _Plane(Results):
    """Cells over two quantities."""

    __slots__ = ()

    @property
    def axes(self) -> tuple[str, str]:
        """The quantities along x and y, by their keys in ``[map]``."""
        x, y, *_ = self.columns()
        return x, y

    def _draw(self, ax: Axes | None, cells: npt.NDArray[Any], **look: Any) -> tuple[Axes, Any]:
        """Draws cells of shape ``(len(x), len(y))``; returns the axes and the mesh."""
        ax = _axes(ax)
        mesh = ax.pcolormesh(self.x, self.y, cells.T, shading="nearest", **look)
        for name, values, axis in zip(self.axes, (self.x, self.y), ("x", "y")):
            # Values in a constant ratio have a logarithmic axis.
            if len(values) > 2 and values[0] > 0.0 and np.ptp(values[1:] / values[:-1]) < 1e-6:
                getattr(ax, f"set_{axis}scale")("log")
            getattr(ax, f"set_{axis}label")(name)
        return ax, mesh

    def _plane(self, name: str) -> npt.NDArray[Any]:
        columns = self.columns()
        cells: npt.NDArray[Any] = columns[name].reshape(len(self.x), len(self.y))
        return cells

    @property
    def x(self) -> npt.NDArray[np.float64]:
        """Values along x."""
        values = self.columns()[self.axes[0]]
        first: npt.NDArray[np.float64] = values[:: len(self.y)]
        return first

    @property
    def y(self) -> npt.NDArray[np.float64]:
        """Values along y."""
        columns = self.columns()
        x, y = self.axes
        of_first: npt.NDArray[np.float64] = columns[y][columns[x] == columns[x][0]]
        return of_first


_OUTCOMES = {
    "never_moved": "#b0b0b0",
    "vibrates": "#dfe8c8",
    "rest": "#a9d3f5",
    "still_rocking": "#6f8ba0",
    "overturned": "#d55e00",
    "incomplete": "#8c7aa0",
    "uncertain": "#009e73",
    "cannot_stand": "#ffffff",
    "failed": "#000000",
}
"""Colours of outcomes; those of ``map.svg``, where overturned cells are divided by their number of impacts."""


class OverturningMap(MapResult, _Plane):
    """An overturning map: a history for every cell of a plane of two quantities."""

    __slots__ = ()

    _picture = "map.svg"
    _table = "map.csv"
    _json = "map.json"

    @property
    def outcome(self) -> npt.NDArray[np.str_]:
        """The outcome of each cell, as in ``map.csv``, ``uncertain`` included, shape ``(len(x), len(y))``."""
        return self._plane("outcome")

    @property
    def direction(self) -> npt.NDArray[np.str_]:
        """The direction of the ground motion to which the numbers of each cell belong, ``as_given`` or ``mirrored``, shape ``(len(x), len(y))``."""
        return self._plane("direction")

    @property
    def uncertain(self) -> npt.NDArray[np.bool_]:
        """Whether overturning is uncertain, for each cell, shape ``(len(x), len(y))``."""
        return np.asarray(self.outcome == "uncertain")

    @property
    def impacts(self) -> npt.NDArray[np.float64]:
        """Number of impacts of each cell, NaN without a history, shape ``(len(x), len(y))``."""
        return self._plane("impacts")

    def plot(self, ax: Axes | None = None) -> Axes:
        """The outcome of each cell over the two quantities, which are named by their keys. Needs matplotlib.

        Args:
            ax: axes to draw into; ``None``: those of a new figure.

        Returns:
            The axes.
        """
        from matplotlib.colors import ListedColormap
        from matplotlib.patches import Patch

        found, cells = np.unique(self.outcome, return_inverse=True)
        colors = [_OUTCOMES.get(name, "0.85") for name in found]
        look = {"cmap": ListedColormap(colors), "vmin": -0.5, "vmax": len(found) - 0.5}
        ax, _ = self._draw(ax, cells.reshape(self.outcome.shape), **look)
        x, y = np.nonzero(self.uncertain)
        ax.plot(self.x[x], self.y[y], "k.", ms=3)
        labels = [name.replace("_", " ") for name in found]
        ax.legend(handles=[Patch(color=color, label=label) for color, label in zip(colors, labels)])
        return ax


class ThresholdAlong(ThresholdAlongResult, Results):
    """The least factor that overturns a structure, for each value of a key."""

    __slots__ = ()

    _picture = "threshold_along.svg"
    _table = "threshold_along.csv"
    _json = "threshold_along.json"

    def plot(self, ax: Axes | None = None) -> Axes:
        """The factors that surely overturn, are uncertain and surely survive, over the value of the key. Needs matplotlib.

        Args:
            ax: axes to draw into; ``None``: those of a new figure.

        Returns:
            The axes.
        """
        ax = _axes(ax)
        columns = self.columns()
        key = next(iter(columns))
        for name, label in (
            ("overturns_from_factor", "overturns from"),
            ("uncertain_from_factor", "uncertain from"),
            ("survives_up_to_factor", "survives up to"),
            ("no_impact_factor", "overturns without impact from"),
        ):
            if name in columns and np.isfinite(columns[name]).any():
                ax.plot(columns[key], columns[name], "o-", mfc="none", label=label)
        ax.set_xlabel(key)
        ax.set_ylabel("factor on the ground motion")
        ax.legend()
        return ax


class Suite(SuiteResult, Results):
    """A suite of records, and the fragility curve of its cases; without levels each record acts once, unscaled, and there is no curve."""

    __slots__ = ()

    _picture = "suite.svg"
    _table = "suite.csv"
    _json = "fragility.json"

    @property
    def fragility(self) -> dict[str, npt.NDArray[Any]]:
        """For each intensity: cases, how many overturned, and the curve with its 95 % band, as in ``fragility.csv``.

        With free hinges also the number of uncertain cases, and columns ``..._with_uncertain`` that count these as overturned.
        """
        return self.columns("fragility.csv")

    @property
    def uncertain(self) -> npt.NDArray[np.bool_]:
        """Whether overturning is uncertain, one entry for each row of ``suite.csv``."""
        return np.asarray(self.columns()["outcome"] == "uncertain")

    def _plot_outcomes(self, ax: Axes) -> Axes:
        table = self.columns()
        gravity = self.summary["scenario"]["simulation"]["gravity_m_s2"]
        ratios = table["peak_velocity_m_s"] / (table["peak_g"] * gravity)
        overturned, uncertain = table["outcome"] == "overturned", self.uncertain
        for label, marker, chosen in (
            ("overturns", "x", overturned),
            ("uncertain", "D", uncertain),
            ("survives, or no verdict", "o", ~(overturned | uncertain)),
        ):
            ax.scatter(table["peak_g"][chosen], ratios[chosen], marker=marker, label=label)
        ax.set(xscale="log", yscale="log")
        ax.set_xlabel("peak ground acceleration (g)")
        ax.set_ylabel("peak velocity / peak acceleration (s)")
        ax.legend()
        return ax

    def plot(self, ax: Axes | None = None) -> Axes:
        """The fraction of cases that overturn over the intensity, the curve and its 95 % band. Needs matplotlib.

        Intensities are peak accelerations in g, or factors on the records, as in ``fragility.csv``. Without levels: the outcomes of
        the records over two measures.

        Args:
            ax: axes to draw into; ``None``: those of a new figure.

        Returns:
            The axes.
        """
        ax = _axes(ax)
        if self.summary["as_recorded"] is not None:
            return self._plot_outcomes(ax)
        table = self.fragility
        intensity = next(iter(table))
        levels = table[intensity]
        ax.plot(levels, table["fraction"], "o", mfc="none", label="fraction of cases")
        median, dispersion = self.summary["median"], self.summary["dispersion"]
        if median is not None and dispersion is not None:
            along = np.geomspace(levels[0], levels[-1], 200)
            curve = [0.5 * math.erfc(-math.log(x / median) / (dispersion * math.sqrt(2.0))) for x in along]
            ax.plot(along, curve, label="lognormal curve")
            low, high = table["probability_low"], table["probability_high"]
            ax.vlines(levels, low, high, color="C1", alpha=0.25, lw=5, label="95 % band")
        ax.set_xscale("log")
        names = {"peak_g": "peak ground acceleration (g)", "scale": "factor on the records"}
        ax.set_xlabel(names.get(intensity, intensity))
        ax.set_ylabel("fraction that overturns")
        ax.set_ylim(-0.02, 1.02)
        ax.legend()
        return ax


class Threshold(_ThresholdKeys, Results):
    """Factors on a ground motion that overturn a structure: bands, safe gaps between them, and uncertain ranges.

    The keys of the first of ``models`` in ``threshold.json`` are attributes: ``lowest_factor``, ``None`` if no factor overturns, and the lists
    ``bands``, ``gaps``, ``uncertain`` and ``incomplete``, whose ranges have ``from`` and ``to``. ``lowest_factor`` and ``survives_up_to_factor``
    are the lower ones of both directions of the ground motion, ``direction`` is the one that governs; the lists are those of the motion as given.
    ``mirrored`` has the lists of the mirrored motion, if the structure has a second direction.
    """

    __slots__ = ()

    _picture = "threshold.svg"
    _table = "threshold.csv"
    _json = "threshold.json"

    def _numbers(self) -> Summary:
        summary = self.summary
        return Summary({**summary, **summary.models[0]})

    def plot(self, ax: Axes | None = None) -> Axes:
        """The largest rotation over the factor on the ground motion, with the factors that overturn. Needs matplotlib.

        Rotations are over the critical one where that is known, else in rad. Overturned histories have no largest rotation.

        Args:
            ax: axes to draw into; ``None``: those of a new figure.

        Returns:
            The axes.
        """
        ax = _axes(ax)
        table = self.columns()
        ratio, rad = table["peak_rotation_over_critical"], table["peak_rotation_rad"]
        known = bool(np.isfinite(ratio).any())
        peak = np.where(table["outcome"] == "overturned", np.nan, ratio if known else rad)
        mirrored = self.summary.models[0].get("mirrored") or {}
        for direction, style, which in (("as_given", "-", ""), ("mirrored", "--", ", mirrored")):
            rows = table["direction"] == direction
            if rows.any():
                ax.plot(table["factor"][rows], peak[rows], style, color="k", label=f"largest rotation{which}")
        looks: tuple[tuple[Sequence[Mapping[str, Any]], str, str, str | None], ...] = (
            (self.bands, "overturns", "C3", None),
            (self.uncertain, "uncertain", "C2", "//"),
            (mirrored.get("bands", []), "overturns, mirrored", "C1", None),
            (mirrored.get("uncertain", []), "uncertain, mirrored", "C0", "\\\\"),
        )
        for ranges, label, color, hatch in looks:
            for index, band in enumerate(ranges):
                name = label if index == 0 else None
                ax.axvspan(band["from"], band["to"], color=color, alpha=0.3, hatch=hatch, label=name)
        ax.set_xscale("log")
        ax.set_xlabel("factor on the ground motion")
        ax.set_ylabel("largest / critical rotation" if known else "largest rotation (rad)")
        ax.legend()
        return ax


class Capacity(CapacityResult, Results):
    """The quasi-static capacity of the first mechanism to both sides: acceleration against displacement."""

    __slots__ = ()

    _picture = "capacity.svg"
    _table = "capacity.csv"
    _json = "capacity.json"

    def side(self, sway: Literal["right", "left"]) -> dict[str, npt.NDArray[np.float64]]:
        """The curve to a side: ``displacement_m`` of the control point, ``acceleration_g``, and the other columns of ``capacity.csv``."""
        columns = self.columns()
        own = columns["sway"] == sway
        return {name: values[own] for name, values in columns.items() if name != "sway"}

    def plot(self, ax: Axes | None = None) -> Axes:
        """Acceleration in g against displacement of the control point in m, to both sides. Needs matplotlib.

        Args:
            ax: axes to draw into; ``None``: those of a new figure.

        Returns:
            The axes.
        """
        ax = _axes(ax)
        for own, line, label in (
            (self.side("right"), "-", "to the right"),
            (self.side("left"), "--", "to the left"),
        ):
            ax.plot(own["displacement_m"], own["acceleration_g"], line, label=label)
        ax.set_xlabel("displacement of the control point (m)")
        ax.set_ylabel("acceleration (g)")
        ax.legend()
        return ax


class Ensemble(Results):
    """The consequences of the uncertain numbers of a scenario: the history of every sample and its end.

    ``what_matters`` has for each answer the part of the variance and the rank correlation of each uncertain number, with intervals.
    """

    __slots__ = ()

    _picture = "bands.svg"
    _table = "samples.csv"
    _json = "uncertain.json"

    def _samples(self, name: str) -> npt.NDArray[Any]:
        """A column without its first row, which belongs to the scenario itself."""
        column: npt.NDArray[Any] = self.columns()[name][1:]
        return column

    @property
    def keys(self) -> tuple[str, ...]:
        """The keys of the uncertain numbers."""
        names = list(self.columns())
        return tuple(name for name in names if "." in name)

    @property
    def values(self) -> npt.NDArray[np.float64]:
        """Their values, shape ``(samples, keys)``."""
        return np.column_stack([self._samples(key) for key in self.keys])


class Histories(EnsembleUncertainRunResult, Ensemble):
    """An ensemble of histories."""

    __slots__ = ()

    @property
    def outcome(self) -> npt.NDArray[np.str_]:
        """The outcome of each sample, as in ``samples.csv``; ``outside_model`` outside the model of four links."""
        return self._samples("outcome")

    @property
    def peak_rotation(self) -> npt.NDArray[np.float64]:
        """Largest rotation of any body in each sample, in radians; NaN without a history."""
        return self._samples("peak_rotation_rad")

    @property
    def probability(self) -> dict[str, float]:
        """The fraction of samples that overturn, and its 95 % interval: ``share``, ``low``, ``high``, ``count``, ``of``.

        ``no_verdict`` samples count in the interval only. Report the interval alone if few have a verdict.
        """
        share: dict[str, float] = self.summary["outcomes"]["overturned"]
        return share

    @property
    def bands(self) -> dict[str, npt.NDArray[Any]]:
        """The rotation over time: of the scenario itself, and the 5 %, 50 % and 95 % quantiles, as in ``bands.csv``."""
        return self.columns("bands.csv")


class FirstFactors(EnsembleUncertainThresholdResult, Ensemble):
    """An ensemble of the first factors on the ground motion that overturn.

    ``to_quote`` has the answer that may be quoted, and ``lower_limit_factor`` its factor: the lower 95 % confidence limit of the factor that
    95 % of the structures survive, ``None`` with fewer than 59 samples.
    """

    __slots__ = ()

    _picture = "probability.svg"

    @property
    def first_factor(self) -> npt.NDArray[np.float64]:
        """The first factor of each sample; NaN if none overturns it."""
        return self._samples("first_factor")

    @property
    def probability(self) -> dict[str, npt.NDArray[Any]]:
        """The probability of overturning against the factor, with its 95 % interval, as in ``probability.csv``."""
        return self.columns("probability.csv")


class Fragilities(EnsembleUncertainSuiteResult, Ensemble):
    """An ensemble of the intensities from which the records of a suite overturn.

    ``fragility`` has median and dispersion with their intervals: ``record_to_record``, ``uncertain_data`` and ``both``. ``to_quote``
    has those that may be quoted, in words.
    """

    __slots__ = ()

    _picture = "fragility.svg"


class ProbabilityMap(EnsembleUncertainMapResult, _Plane):
    """The probability that each cell of a map overturns, estimated from samples of the uncertain numbers."""

    __slots__ = ()

    _picture = "map.svg"
    _table = "map.csv"
    _json = "uncertain.json"

    @property
    def probability(self) -> npt.NDArray[np.float64]:
        """The fraction of samples that overturn in each cell, NaN if none has a verdict, shape ``(len(x), len(y))``."""
        return self._plane("overturned")

    @property
    def interval(self) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
        """The ends of the 95 % interval of the probability, each of shape ``(len(x), len(y))``."""
        return self._plane("overturned_low"), self._plane("overturned_high")

    @property
    def lines(self) -> dict[str, npt.NDArray[Any]]:
        """The two cells between which the probability first reaches 5, 50 and 95 % along y, for each x, as in ``probability.csv``."""
        return self.columns("probability.csv")

    def plot(self, ax: Axes | None = None) -> Axes:
        """The probability that each cell overturns, with a scale of colours beside it. Needs matplotlib.

        Args:
            ax: axes to draw into; ``None``: those of a new figure.

        Returns:
            The axes.
        """
        ax, mesh = self._draw(ax, self.probability, vmin=0.0, vmax=1.0, cmap="cividis")
        ax.figure.colorbar(mesh, ax=ax, label="probability of overturning")
        return ax


class Check(VerifyResult, Files):
    """A check by the Circolare 7/2019: its numbers, and the page to be filed.

    ``zeta_e`` is the ratio of capacity to demand, the least of all limit states checked; ``verdict`` has ``passed``, ``not_passed``,
    ``no_answer`` or ``not_checked`` for each limit state. If joints slide before a mechanism without sliding forms, ``zeta_e`` is ``None``,
    ``no_zeta_e_because`` has the reason, and no limit state is ``passed``.
    """

    __slots__ = ()

    _json = "verify.json"

    @property
    def page(self) -> str:
        """The page, in HTML that prints on A4."""
        return self.files["verify.html"].decode()

    def _repr_html_(self) -> str:
        page = html.escape(self.page, quote=True)
        return f'<iframe srcdoc="{page}" style="width: 100%; height: 60em; border: 0"></iframe>'


_StudyResults = Union[OverturningMap, ProbabilityMap, ThresholdAlong, Suite, Ensemble]
_TextColumns = Iterable[tuple[str, Sequence[str]]]
_KINDS: dict[
    str, Callable[[Iterable[tuple[str, bytes]], str, _TextColumns, str], _StudyResults]
] = {
    "map": OverturningMap,
    "threshold_along": ThresholdAlong,
    "suite": Suite,
    "uncertain": Histories,
    "uncertain_threshold": FirstFactors,
    "uncertain_suite": Fragilities,
    "uncertain_map": ProbabilityMap,
}


def _allowed(threads: int | None) -> int | None:
    if threads is not None and not 1 <= threads <= 1024:
        raise ValueError(f"`threads = {threads}` is not allowed: it must be from 1 to 1024")
    return threads


_OfStudy = TypeVar("_OfStudy", bound=Files)


def _warned(results: _OfStudy) -> _OfStudy:
    """Issues the warnings of new results."""
    warn(results.summary.get("warnings", ()))
    return results


def _study(
    kind: str,
    scenario: Scenario | Structure,
    threads: int | None = None,
    progress: Progress | None = None,
    factors: tuple[float | None, float | None, float] | None = None,
    along: tuple[str, bool] | None = None,
) -> tuple[list[tuple[str, bytes]], str, list[tuple[str, list[str]]], str]:
    """The files of a study, their origin for the list of a folder, the columns with text of each table, and the answer in words."""
    if progress is not None and not callable(progress):
        raise TypeError("`progress` must be a function of two numbers")
    return _native.study(scenario._native, kind, factors, along, _allowed(threads), progress)


def _whole(of: Structure | Scenario, others: Mapping[str, Any]) -> bool:
    """Whether the argument is a complete scenario, which allows no other arguments."""
    if isinstance(of, Structure):
        return False
    if not isinstance(of, Scenario):
        raise TypeError(f"give a structure or a scenario, not {type(of).__name__}")
    given = [name for name, value in others.items() if value is not None]
    if given:
        raise ValueError(
            f"a scenario says everything itself: leave {', '.join(given)} out, or give a structure"
        )
    return True


def _complete(of: Structure | Scenario, ground: Ground | None, settings: Mapping[str, Any]) -> Scenario:
    """The given scenario, or the scenario of a structure with its ground and settings."""
    if _whole(of, {"ground": ground, **settings}):
        assert isinstance(of, Scenario)
        return of
    assert isinstance(of, Structure)
    return Scenario.of(of, ground, **settings)


def map_scenario(
    structure: Structure,
    ground: Ground,
    axes: Mapping[str, Values],
    *,
    repeat: bool = False,
    **settings: Any,
) -> Scenario:
    """The scenario of the map that :func:`overturning_map` computes, to be computed in parts.

    Raises:
        ValueError: as for :func:`overturning_map`.
    """
    if "spread" in settings:
        raise TypeError("`spread` is now called `repeat`")
    table = {**axes, "repeat": True} if repeat else axes
    return Scenario.of(structure, ground, map=table, **settings)


def overturning_map(
    of: Structure | Scenario,
    ground: Ground | None = None,
    axes: Mapping[str, Values] | None = None,
    *,
    repeat: bool | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
    **settings: Any,
) -> OverturningMap:
    """The ground motions that overturn a structure, over two quantities.

    >>> found = overturning_map(
    ...     Arch(mean_radius_m=5.0, thickness_ratio=0.15, embrace_deg=180.0),
    ...     Pulse.one_cosine(amplitude_g=0.5, duration_s=0.8),
    ...     {"duration_s": span(0.1, 1.6, 16), "amplitude_g": span(0.12, 3.0, 16, "logarithmic")},
    ...     duration_s=30.0,
    ... )

    Args:
        of: the structure, or a scenario with a table ``[map]``, which gives everything else.
        ground: the ground motion; its other values do not vary.
        axes: two of the keys of ``[map]`` with increasing values: ``duration_s``, ``frequency_hz``, ``pgv_over_pga_s``, ``mean_radius_m``,
            ``thickness_ratio``, ``embrace_deg``, ``restitution``, ``amplitude_g``, for a record ``scale`` or ``peak_g``,
            or any number of the scenario by its table and key, such as ``column.width_m``.
        repeat: with free hinges, true: repeats every cell in full and counts its outcomes in the column ``outcomes``.
        threads: number of threads; ``None``: as many as there are processors.
        progress: called on this thread with the number of cells done and of all cells.
        settings: as for :func:`simulate`.

    Raises:
        ValueError: when there is no such map, with the library's explanation.
        KeyboardInterrupt: on Ctrl-C, within a second.
    """
    if _whole(of, {"ground": ground, "axes": axes, "repeat": repeat, **settings}):
        assert isinstance(of, Scenario)
        return _warned(OverturningMap(*_study("map", of, threads, progress)))
    assert isinstance(of, Structure)
    if ground is None or axes is None:
        raise ValueError("a map needs a ground motion and two axes")
    scenario = map_scenario(of, ground, axes, repeat=bool(repeat), **settings)
    return _warned(OverturningMap(*_study("map", scenario, threads, progress)))


def suite_scenario(
    structure: Structure,
    records: Sequence[Record],
    *,
    peaks_g: Values = None,
    scales: Values = None,
    both_signs: bool | None = None,
    **settings: Any,
) -> Scenario:
    """The scenario of the suite that :func:`suite` computes, to be computed in parts.

    Raises:
        ValueError: as for :func:`suite`.
    """
    entries, files = _record_files(records)
    layout = _one_layout(entries)
    own = {"record": entries} if layout is None else {"records": sorted(files), **layout}
    table = {**own, "peaks_g": peaks_g, "scales": scales}
    if both_signs is not None:
        direction = "both" if both_signs else "as_given"
        if settings.setdefault("direction", direction) != direction:
            raise ValueError(f"`both_signs` is the older name of direction={direction!r}: leave it out")
    if peaks_g is None and scales is None:
        # Without levels the default is that of the scenario file.
        settings.setdefault("direction", "as_given")
    return Scenario.of(structure, suite=table, files=files, **settings)


def suite(
    of: Structure | Scenario,
    records: Sequence[Record] | None = None,
    *,
    peaks_g: Values = None,
    scales: Values = None,
    both_signs: bool | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
    **settings: Any,
) -> Suite:
    """The probability that records of a given intensity overturn a structure: a history for every record at every level.

    Args:
        of: the structure, or a scenario with a table ``[suite]``, which gives everything else.
        records: the records, each with its own name.
        peaks_g: increasing peak accelerations to which each record is scaled; or give ``scales``, which multiply the
            scaling of the records. Without both, each record acts once, unscaled, and as given unless ``direction`` is named.
        scales: increasing factors on each record.
        both_signs: older name of ``direction``: true is ``"both"``, false is ``"as_given"``; ``None``: as ``direction``.
        threads: as for :func:`overturning_map`.
        progress: as for :func:`overturning_map`.
        settings: as for :func:`simulate`.

    Raises:
        ValueError: when there is no such suite, with the library's explanation.
        KeyboardInterrupt: on Ctrl-C, within a second.
    """
    others = {"records": records, "peaks_g": peaks_g, "scales": scales, "both_signs": both_signs}
    if _whole(of, {**others, **settings}):
        assert isinstance(of, Scenario)
        return _warned(Suite(*_study("suite", of, threads, progress)))
    assert isinstance(of, Structure)
    scenario = suite_scenario(
        of,
        records or (),
        peaks_g=peaks_g,
        scales=scales,
        both_signs=both_signs,
        **settings,
    )
    return _warned(Suite(*_study("suite", scenario, threads, progress)))


def threshold(
    of: Structure | Scenario,
    ground: Ground | None = None,
    *,
    from_factor: float | None = None,
    to_factor: float | None = None,
    stride: float = 0.02,
    threads: int | None = None,
    progress: Progress | None = None,
    **settings: Any,
) -> Threshold:
    """The factors by which a ground motion overturns a structure.

    Args:
        of: the structure, or a scenario, which gives structure, ground and settings.
        ground: the ground motion to be scaled.
        from_factor: smallest factor; by default the onset of motion, or 0.1 where it is unknown.
        to_factor: largest factor; by default the first one that certainly overturns the structure.
        stride: relative step from one factor to the next, up to the first edge; below it the steps are finer.
        threads: as for :func:`overturning_map`.
        progress: as for :func:`overturning_map`; for each step of the search.
        settings: as for :func:`simulate`.

    Raises:
        ValueError: when an argument is not allowed, with the library's explanation.
        KeyboardInterrupt: on Ctrl-C, within a second.
    """
    scenario = _complete(of, ground, settings)
    factors = (from_factor, to_factor, stride)
    return _warned(Threshold(*_study("threshold", scenario, threads, progress, factors)))


def threshold_along(
    of: Structure | Scenario,
    ground: Ground | None = None,
    *,
    key: str,
    start: float,
    end: float,
    count: int,
    no_impact: bool = False,
    from_factor: float | None = None,
    to_factor: float | None = None,
    stride: float = 0.02,
    threads: int | None = None,
    progress: Progress | None = None,
    **settings: Any,
) -> ThresholdAlong:
    """The least factor by which a ground motion overturns a structure, for each value of a key, as ``archrock threshold --along``.

    Args:
        of: the structure, or a scenario, which gives structure, ground and settings.
        ground: the ground motion to be scaled.
        key: the key with its table, such as ``"arch.mean_radius_m"``.
        start: its first value.
        end: its last value.
        count: number of equally spaced values.
        no_impact: true: also finds the least factor that overturns before any impact, for four links and columns.
        from_factor: smallest factor; by default the onset of motion, or 0.1 where it is unknown.
        to_factor: largest factor; by default the first one that certainly overturns the structure.
        stride: relative step from one factor to the next, up to the first edge; below it the steps are finer.
        threads: as for :func:`overturning_map`.
        progress: as for :func:`overturning_map`, for values.
        settings: as for :func:`simulate`.

    Raises:
        ValueError: when an argument is not allowed, with the library's explanation.
        KeyboardInterrupt: on Ctrl-C, within a second.
    """
    scenario = _complete(of, ground, settings)
    along = f"{key}={start!r}..{end!r}:{count}"
    factors = (from_factor, to_factor, stride)
    found = _study("threshold_along", scenario, threads, progress, factors, (along, no_impact))
    return _warned(ThresholdAlong(*found))


def ensemble(
    scenario: Scenario,
    *,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Histories:
    """The consequences of the table ``[uncertain]`` of a scenario: a history for every sample.

    To find the factor from which samples overturn, or the records that overturn them, use :func:`compute_part` and :func:`merge`
    with the studies ``"uncertain_threshold"`` and ``"uncertain_suite"``.

    Args:
        scenario: a scenario with a table ``[uncertain]``.
        threads: as for :func:`overturning_map`.
        progress: as for :func:`overturning_map`, for samples.

    Raises:
        ValueError: when nothing in it is uncertain, or nothing moves the structure, with the library's explanation.
        KeyboardInterrupt: on Ctrl-C, within a second.
    """
    if not isinstance(scenario, Scenario):
        raise TypeError(f"`scenario` must be a Scenario, not {type(scenario).__name__}")
    return _warned(Histories(*_study("uncertain", scenario, threads, progress)))


def verify(
    of: Structure | Scenario,
    demand: Mapping[str, Any] | None = None,
    *,
    title: str | None = None,
    slv_records: Sequence[Record] | None = None,
    slc_records: Sequence[Record] | None = None,
    **how: Any,
) -> Check:
    """Checks the mechanism that starts to either side by the Circolare 7/2019, C8.7.1.2.1, with the spectra of NTC 2018.

    >>> arch = Arch(mean_radius_m=5.0, thickness_ratio=0.15, embrace_deg=180.0)
    >>> site = {"soil": "B", "topography": "T1", "slv": {"ag_g": 0.25, "f0": 2.40, "tc_star_s": 0.35}}
    >>> round(verify(arch, site).zeta_e, 3)
    0.487

    Args:
        of: the structure, or a scenario with a table ``[demand]``, which gives everything else.
        demand: the table ``[demand]``: soil, topography, the hazard of each limit state, and the position in a building. A
            spectrum by points is the path of its file, or a pair of periods in s and accelerations in g.
        title: free text for the page.
        slv_records: records for the dynamic route at SLV, all in one unit, each with its own name.
        slc_records: records for the dynamic route at SLC, likewise.
        how: keys of ``[verify]``: ``confidence_factor``, ``behaviour_factor``, ``sides``, ``free_standing``, ``language``.

    Raises:
        ValueError: when there is nothing to check, or a number is outside the range of the code, with the library's explanation.
        OSError: when a file cannot be read.
        KeyboardInterrupt: on Ctrl-C, within a second.
    """
    records = {"slv_records": slv_records, "slc_records": slc_records}
    if _whole(of, {"demand": demand, "title": title, **records, **how}):
        assert isinstance(of, Scenario)
        return _warned(Check(*_study("verify", of)))
    assert isinstance(of, Structure)
    if demand is None:
        raise ValueError("a check needs a demand")
    table, files = _with_points(demand)
    # The same record may be used at both limit states.
    given = {id(record): record for some in records.values() for record in some or ()}
    if given:
        entries, held = _record_files(list(given.values()))
        keys = _one_layout(entries)
        if keys is None:
            raise ValueError("the records must be in one unit, and not scaled: leave `scale` and `peak_g` out")
        named = {key: [one.name for one in some] for key, some in records.items() if some}
        how = {**how, **keys, **named}
        files.update(held)
    scenario = Scenario.of(
        of, title=title, demand=table, verify=how or None, files=files, model=of._model
    )
    return _warned(Check(*_study("verify", scenario)))


def _with_points(demand: Mapping[str, Any]) -> tuple[dict[str, Any], Held]:
    """The table ``[demand]``, and the contents of the files that it names."""
    table: dict[str, Any] = dict(demand)
    files: Held = {}
    for state in ("sld", "slv", "slc"):
        given = table.get(state)
        if not isinstance(given, Mapping) or "spectrum" not in given:
            continue
        points = given["spectrum"]
        if isinstance(points, (str, os.PathLike)):
            contents: bytes | Samples = read_file(points, "spectrum")
        else:
            contents = Samples.of(*points)
        name = f"{state}.csv"
        files[name] = contents
        table[state] = {**given, "spectrum": name}
    return table, files


def _record_files(records: Sequence[Record]) -> tuple[list[dict[str, Any]], Held]:
    """An entry for each record, by its name, and their samples by name."""
    files: Held = {}
    entries: list[dict[str, Any]] = []
    for record in records:
        if not isinstance(record, Record):
            raise TypeError(f"`records` are Records, not {type(record).__name__}")
        table = record._tables["record"]
        if "vertical" in table or table.get("component") == "vertical":
            raise ValueError(f"{record.name!r}: the records must be horizontal")
        if record.name in files:
            raise ValueError(f"{record.name!r} is the name of two records: give each its own")
        files[record.name] = Samples.of(*record._samples())
        keys = {"file": record.name, "format": "csv", "unit": record.unit, "quantity": record.quantity}
        entries.append({**keys, **{key: table[key] for key in ("scale", "peak_g") if key in table}})
    return sorted(entries, key=lambda entry: entry["file"]), files


def _one_layout(entries: Sequence[Mapping[str, Any]]) -> dict[str, Any] | None:
    """The keys that all entries share; ``None`` if they differ, or some are scaled."""
    layouts = [{"format": "csv", "unit": one["unit"], "quantity": one["quantity"]} for one in entries]
    scaled = any(one.get("scale") != 1.0 for one in entries)
    if scaled or any(layout != layouts[0] for layout in layouts):
        return None
    return layouts[0] if layouts else {"format": "csv", "unit": "g"}


def capacity(of: Structure | Scenario) -> Capacity:
    """The quasi-static capacity of the first mechanism to both sides, as ``archrock capacity``.

    >>> arch = Arch(mean_radius_m=5.0, thickness_ratio=0.15, embrace_deg=180.0)
    >>> round(float(capacity(arch).side("right")["acceleration_g"][0]), 8)
    0.14432644

    Args:
        of: a structure, or a scenario.

    Raises:
        ValueError: when it does not rock as a mechanism of one degree of freedom.
    """
    if not isinstance(of, (Structure, Scenario)):
        raise TypeError(f"give a structure or a scenario, not {type(of).__name__}")
    return _warned(Capacity(*_study("capacity", of)))


def compute_part(
    scenario: Scenario,
    study: Study,
    shard: tuple[int, int],
    folder: str | os.PathLike[str],
    *,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Path:
    """Computes one part of a study into a file, or continues an interrupted one.

    The parts may be computed anywhere, in any order and more than once; :func:`merge` joins them, and so does the
    program's ``merge``. The result is byte-identical to that of one process.

    Args:
        scenario: the scenario with the table of the study.
        study: ``"map"``, ``"suite"``, or for samples ``"uncertain"``, ``"uncertain_threshold"``,
            ``"uncertain_suite"`` and ``"uncertain_map"``.
        shard: the number of the part, from 1, and the number of parts: ``(2, 4)``.
        folder: folder of the file; created if necessary.
        threads: as for :func:`overturning_map`.
        progress: as for :func:`overturning_map`.

    Returns:
        The path of the file.

    Raises:
        ValueError: when the scenario has no such study, or the file belongs to another.
        OSError: when the file cannot be written.
        KeyboardInterrupt: on Ctrl-C, within a second; completed cases are kept.
    """
    if not isinstance(scenario, Scenario):
        raise TypeError(f"`scenario` must be a Scenario, not {type(scenario).__name__}")
    warn(scenario._native.unlikely())
    index, count = shard
    path = _native.compute_part(
        scenario._native, study, f"{index}/{count}", folder, _allowed(threads), progress
    )
    return Path(path)


def merge(
    parts: Iterable[str | os.PathLike[str]], scenario: Scenario | None = None
) -> _StudyResults:
    """Joins all parts of one study.

    Args:
        parts: their paths.
        scenario: the scenario of the parts; needed for maps with records that are not in the working folder.

    Raises:
        ValueError: when parts are missing, or do not belong to one study or to this scenario.
        OSError: when one cannot be read.
    """
    if not isinstance(scenario, (Scenario, type(None))):
        raise TypeError(f"`scenario` must be a Scenario, not {type(scenario).__name__}")
    native = None if scenario is None else scenario._native
    study, files, origin, texts, answer = _native.merge(list(parts), native)
    return _warned(_KINDS[study](files, origin, texts, answer))
