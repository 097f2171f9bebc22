"""Histories: samples as arrays, events, summary, pictures."""

from __future__ import annotations

import html
import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, NoReturn, cast

import numpy as np

from . import _native
from ._hinge import Hinge
from ._summary import Part, Summarised, Summary, Untyped
from ._warnings import in_python, warn

if TYPE_CHECKING:
    import numpy.typing as npt
    import pandas
    from matplotlib.axes import Axes

    from ._keys import EventImpactKeys, EventKeys, Run, RunResult
    from ._scenario import Scenario

    Floats = npt.NDArray[np.float64]
    Whole = npt.NDArray[np.int64]
else:
    EventImpactKeys = EventKeys = RunResult = Untyped


class Impact(EventImpactKeys, Part):
    """An impact. Its keys are those of ``impact`` in the table of events of ``docs/json.md``, ``time_s`` and ``sway_after``.

    Rates are those of the bodies in rad/s, anticlockwise, just before and just after; hinges that ``closed`` and ``opened`` are in order from
    left to right.
    """

    __slots__ = ()
    _parts: ClassVar[Mapping[str, type[Part]]] = {"closed": Hinge, "opened": Hinge}

    time_s: float
    sway_after: str | None


class Event(EventKeys, Part):
    """An event of a history, and the state just after it. Its keys are in the table of events of ``docs/json.md``."""

    __slots__ = ()
    _parts: ClassVar[Mapping[str, type[Part]]] = {"hinges": Hinge, "impact": Impact}

    impact: Impact | None  # type: ignore[assignment]


def _axes(ax: Axes | None) -> Axes:
    """The given axes, or those of a new figure of pyplot, which a notebook and ``show()`` display."""
    from matplotlib import pyplot

    return pyplot.subplots(figsize=(9.0, 5.0), layout="constrained")[1] if ax is None else ax


class History(RunResult, Summarised):
    """The motion of a structure: samples as arrays, events, and a summary.

    The keys of :attr:`summary` are attributes too, such as ``outcome``, ``outcome_time_s``, ``overturning_sway`` and
    ``largest_friction_demand``. Those of the same name come first: :attr:`impacts` are the impacts, and ``summary.impacts`` is their number;
    :attr:`friction_demand` is that of the samples, and ``summary.friction_demand`` that of the run and its repetitions.
    ``outcome`` is the end of this history alone; :attr:`verdict` compares it with repetitions.

    Arrays use the memory of the history itself, without copies, and cannot be written to: copy an array to change it. In
    shapes, ``samples`` is the number of samples and ``bodies`` that of :attr:`bodies`. Rotations are positive anticlockwise,
    x to the right, y upwards.
    """

    __slots__ = ("_cache", "_native", "_repeat", "_scenario")

    def __init__(self, native: _native.History, scenario: Callable[[_native.Scenario], Scenario], repeat: bool) -> None:
        self._native: _native.History | None = native
        self._repeat = repeat
        # Makes the scenario when it is needed.
        self._scenario: Callable[[_native.Scenario], Scenario] | None = scenario
        self._cache: dict[str, Any] | None = None
        warn(native.warnings())

    # Samples

    def _column(self, name: str) -> npt.NDArray[Any]:
        if self._native is not None:
            return self._native.column(name)
        column: npt.NDArray[Any] = self._kept["columns"][name]
        return column

    @property
    def _kept(self) -> dict[str, Any]:
        if self._cache is None:
            self._cache = {}
        return self._cache

    @property
    def time(self) -> Floats:
        """Times in s, shape ``(samples,)``."""
        return self._column("time_s")

    @property
    def ground_acceleration_m_s2(self) -> Floats:
        """Ground accelerations in m/s2, positive to the right, shape ``(samples,)``."""
        return self._column("ground_acceleration_m_s2")

    @property
    def vertical_acceleration_m_s2(self) -> Floats:
        """Vertical ground accelerations in m/s2, positive upwards, shape ``(samples,)``."""
        return self._column("vertical_acceleration_m_s2")

    @property
    def phase(self) -> Whole:
        """Number of events so far, shape ``(samples,)``."""
        return self._column("phase")

    @property
    def state(self) -> npt.NDArray[np.str_]:
        """States of the structure, ``"rest"``, ``"right"``, ``"left"`` or ``"overturned"``, shape ``(samples,)``."""
        names: npt.NDArray[np.str_] = np.array(_native.History.STATES)[self._column("state")]
        return names

    @property
    def rotations(self) -> Floats:
        """Rotations of the bodies in rad, shape ``(samples, bodies)``."""
        return self._column("rotations_rad")

    @property
    def rates(self) -> Floats:
        """Rotation rates of the bodies in rad/s, shape ``(samples, bodies)``."""
        return self._column("rates_rad_s")

    @property
    def poses(self) -> Floats:
        """Rotation in rad and displacement ``x``, ``y`` in m of every body, shape ``(samples, bodies, 3)``.

        A point of the undeformed structure is rotated about the origin, then displaced. The origin is the centre of a
        circular arch, or the middle of a column's base.
        """
        return self._column("poses")

    @property
    def gaps(self) -> Floats:
        """Gaps of the joints of a row of blocks at intrados and extrados in m, shape ``(samples, joints, 2)``.

        There are no joints with four links or Housner's column.
        """
        return self._column("gaps_m")

    @property
    def offsets(self) -> Floats:
        """Offsets of joints that slip in m, the right face towards the extrados, shape ``(samples, joints)``.

        There are no joints if joints cannot slip.
        """
        return self._column("offsets_m")

    @property
    def joint_forces(self) -> Floats:
        """Normal and shear force of elastic joints in N, shape ``(samples, joints, 2)``; compression is positive.

        The shear is positive if it keeps the right face from slipping towards the extrados. Other models have no joints here.
        """
        return self._column("pressures")[:, :, 0:2]

    @property
    def joint_eccentricities(self) -> Floats:
        """Distance of the normal force of elastic joints from the middle towards the extrados, relative to the thickness.

        Shape ``(samples, joints)``; NaN without compression.
        """
        return self._column("pressures")[:, :, 2]

    @property
    def joint_contacts(self) -> Floats:
        """Compressed fraction of elastic joints, 0 to 1, shape ``(samples, joints)``."""
        return self._column("pressures")[:, :, 3]

    @property
    def joint_stresses(self) -> Floats:
        """Compressive stress of elastic joints at intrados and extrados in Pa, shape ``(samples, joints, 2)``."""
        return self._column("pressures")[:, :, 4:6]

    @property
    def tie_forces(self) -> Floats:
        """Force of each tie in N, shape ``(samples, ties)``; ``tie_1_force_n`` of ``joints.csv`` is the first."""
        return self._column("ties")[:, :, 0]

    @property
    def tie_elongations(self) -> Floats:
        """Elongation of each tie from the undeformed structure in m, shape ``(samples, ties)``."""
        return self._column("ties")[:, :, 1]

    @property
    def feet_apart(self) -> Floats:
        """Displacement of the right foot relative to the left one, to the right and upwards in m, shape ``(samples, 2)``.

        Zero if both feet move alike.
        """
        return self._column("feet_apart_m")

    @property
    def point(self) -> Floats:
        """Displacement in m, to the right and upwards, of the ``point`` given to :func:`simulate`.

        Relative to the ground, from the undeformed structure; shape ``(samples, 2)``, or ``(samples, 0)`` if no point was given.
        """
        return self._column("point_m")

    @property
    def open_hinges(self) -> Whole:
        """Number of open hinges, shape ``(samples,)``."""
        return self._column("open_hinges")

    @property
    def thrust_excess_ratio(self) -> Floats:
        """Distance by which the thrust line leaves the structure, in thicknesses, shape ``(samples,)``."""
        return self._column("thrust_excess_ratio")

    @property
    def friction_demand(self) -> Floats:
        """Friction coefficient needed to prevent sliding, shape ``(samples,)``."""
        return self._column("friction_demand")

    @property
    def energy_j(self) -> Floats:
        """Kinetic and potential energy in J, shape ``(samples,)``."""
        return self._column("energy_j")

    @property
    def energy_ratio(self) -> Floats:
        """Energy over the barrier of the mechanism that moves, shape ``(samples,)``; NaN if that is unknown."""
        return self._column("energy_ratio")

    def __len__(self) -> int:
        """Number of samples."""
        return len(self.time)

    # Events and summary

    def _once(self, name: str, make: Any) -> Any:
        kept = self._kept
        if name not in kept:
            kept[name] = make(self._native)
        return kept[name]

    @property
    def bodies(self) -> tuple[str, ...]:
        """Names of the bodies, from left to right or from the base up; a single body has an empty name."""
        bodies: tuple[str, ...] = self._once("bodies", lambda native: tuple(native.bodies()))
        return bodies

    @property
    def largest_body(self) -> int:
        """Index in :attr:`bodies` of the body that turns most, over all time steps; the last one if several turn equally far."""
        index: int = self._once("largest_body", lambda native: native.largest_body())
        return index

    @property
    def events(self) -> tuple[Event, ...]:
        """All events: phase ``i + 1`` follows event ``i``."""

        def make(native: _native.History) -> tuple[Event, ...]:
            return tuple(map(Event, json.loads(native.events_json())))

        events: tuple[Event, ...] = self._once("events", make)
        return events

    @property
    def impacts(self) -> tuple[Impact, ...]:
        """The events that are impacts."""
        return tuple(event.impact for event in self.events if event.impact is not None)

    @property
    def summary(self) -> Run:
        """The contents of the program's ``summary.json`` (a copy), with :attr:`verdict` and ``repeatability``.

        At its first use a history with free hinges or elastic joints is simulated again in other, equally good ways, such as with double
        steps, and elastic joints with other stiffnesses, as the program does. Single numbers, such as ``history.steps``, need no
        repetitions. With ``repeat=False`` nothing is simulated again, and :attr:`to_quote` is no answer.
        """
        if "summary" not in self._kept:
            native = self._native or self.scenario.run(repeat=self._repeat)._native
            assert native is not None, "a history that was run is there"
            self._kept["summary"] = native.summary_json(self._repeat)
        return cast("Run", Summary._parse(self._kept["summary"]))

    @property
    def verdict(self) -> str:
        """The program's verdict: ``"survives"``, ``"overturns"``, ``"uncertain"`` or ``"incomplete"``.

        It is uncertain if the repetitions of :meth:`repeatability` disagree. If the motion was computed in both directions, it is the worse
        verdict of this history and of :attr:`mirrored`.
        """
        verdict: str = self.summary["verdict"]
        return verdict

    @property
    def mirrored(self) -> Summary | None:
        """The result under the mirrored ground motion, as ``mirrored`` of :attr:`summary`: its own ``verdict``, ``outcome``, largest rotation and
        ``certainty``. ``None`` without a second direction, as for a symmetric structure, or with ``direction="as_given"``. The columns of
        this history are those of the motion as given.
        """
        mirrored: Summary | None = self.summary.get("mirrored")
        return mirrored

    @property
    def to_quote(self) -> str:
        """The answer that may be quoted, in the words of the program: the outcome with its conditions, or why there is none."""
        to_quote: str = self.summary["to_quote"]
        return to_quote

    @property
    def variations(self) -> list[Summary]:
        """The results with other stiffness and contact of elastic joints, as ``variations`` of :attr:`summary`; empty for other histories."""
        variations: list[Summary] = self.summary.get("variations", [])
        return variations

    def _numbers(self) -> Summary:
        """The summary of the history alone, which has no verdict."""

        def make(native: _native.History) -> Summary:
            numbers = Summary._parse(native.summary_json(False))
            del numbers["verdict"], numbers["to_quote"]
            return numbers

        numbers: Summary = self._once("numbers", make)
        return numbers

    def _attribute(self, name: str) -> Any:
        if not name.startswith("_"):
            # These take negligible time to compute.
            ended = self._once("ended", lambda native: json.loads(native.ended_json()))
            if name in ended:
                return ended[name]
        return super()._attribute(name)

    def spread(self) -> NoReturn:
        """Replaced by :meth:`repeatability`."""
        raise AttributeError("`History.spread()` is now called `History.repeatability()`")

    def repeatability(self) -> Summary | None:
        """How a history of blocks depends on its steps, as ``repeatability`` of :attr:`summary`; ``None`` for other histories."""
        repeatability: Summary | None = self.summary.get("repeatability")
        return repeatability

    @property
    def scenario(self) -> Scenario:
        """The scenario: to be run again, or written as a file of the program."""

        def make(native: _native.History) -> Scenario:
            assert self._scenario is not None
            return self._scenario(native.scenario())

        scenario: Scenario = self._once("scenario", make)
        return scenario

    # Output

    def to_pandas(self) -> pandas.DataFrame:
        """The samples as a table: the columns of ``rotations.csv``, always with vertical accelerations, and energies.
        Needs pandas.
        """
        import pandas

        columns: dict[str, Any] = {
            "time_s": self.time,
            "ground_acceleration_m_s2": self.ground_acceleration_m_s2,
            "phase": self.phase,
            "state": self.state,
        }
        for quantity, unit, values in (
            ("rotation", "rad", self.rotations),
            ("rate", "rad_s", self.rates),
        ):
            for index, body in enumerate(self.bodies):
                name = "_".join(filter(None, (quantity, body, unit)))
                columns[name] = values[:, index]
        if self.gaps.shape[1] > 0:
            columns["open_joints"] = self.open_hinges
        else:
            columns["thrust_excess_ratio"] = self.thrust_excess_ratio
        columns["friction_demand"] = self.friction_demand
        columns["vertical_acceleration_m_s2"] = self.vertical_acceleration_m_s2
        if self.feet_apart.any():
            columns["right_foot_x_m"], columns["right_foot_y_m"] = self.feet_apart.T
        columns["energy_j"] = self.energy_j
        table: pandas.DataFrame = pandas.DataFrame(columns)
        return table

    def plot(self, ax: Axes | None = None) -> Axes:
        """Ground acceleration in g and rotations in rad over time in s. Needs matplotlib.

        Args:
            ax: axes to draw the rotations into, with a legend and without the ground; ``None``: a new figure with both.

        Returns:
            The axes of the rotations. Their ``figure`` stays open; its first axes are those of the ground.
        """
        if ax is not None:
            self._plot_rotations(ax)
            return ax
        from matplotlib import pyplot

        _, (ground, rotations) = pyplot.subplots(
            2, 1, sharex=True, height_ratios=(1, 2), figsize=(9.0, 6.0), layout="constrained"
        )
        gravity_m_s2 = self._numbers()["scenario"]["simulation"]["gravity_m_s2"]
        ground.plot(
            self.time, self.ground_acceleration_m_s2 / gravity_m_s2, color="0.3", label="ground"
        )
        ground.set_ylabel("ground acceleration (g)")
        ground.legend()
        self._plot_rotations(rotations)
        ground.set_title(self._words())
        axes: Axes = rotations
        return axes

    def _plot_rotations(self, ax: Axes) -> None:
        few = len(self.bodies) <= 6
        largest = self.largest_body
        for index, body in enumerate(self.bodies):
            label: str | None = body or "rotation"
            if not few:
                # Among many blocks only the one with the largest rotation is named.
                label = f"block {body}, which turns most" if index == largest else None
                if index == (largest + 1) % len(self.bodies):
                    label = "other blocks"
            look = {"lw": 1.2} if few else {"lw": 0.6, "color": "0.5"}
            if not few and index == largest:
                look = {"lw": 1.6, "color": "C0", "zorder": 3}
            ax.plot(self.time, self.rotations[:, index], label=label, **look)
        ax.axhline(0.0, color="0.8", lw=0.8, zorder=0)
        ax.set_ylabel("rotation (rad)")
        ax.set_xlabel("time (s)")
        ax.legend()

    def report_html(self) -> str:
        """The program's page ``report.html``: the structure in motion, with curves. Needs no network."""

        def make(native: _native.History) -> str:
            return native.report()

        return make(self._native) if self._native else self.scenario.run().report_html()

    def save_report(self, path: str | Path) -> None:
        """Writes :meth:`report_html` to a file.

        Raises:
            OSError: when it cannot be written.
        """
        Path(path).write_text(self.report_html(), encoding="utf-8")

    def film(
        self,
        path: str | Path,
        *,
        speed: float = 1.0,
        size: tuple[int, int] = (1280, 720),
        background: str = "white",
        caption: str | None = None,
        exaggerate: float = 1.0,
    ) -> None:
        """Writes a film of the moving structure, as ``archrock film``. Simulates the history again, with the line of thrust.

        Args:
            path: the file: ``.mp4`` and ``.webm`` need the program ffmpeg, ``.gif`` and ``.png`` (animated) do not.
            speed: relative to real time; 0.25 is slow motion.
            size: width and height in pixels, even numbers from 160 to 3840.
            background: ``"white"``, ``"black"`` or a colour such as ``"f5f0e6"``.
            caption: text below the structure in place of the legend.
            exaggerate: factor on the displacements.

        Raises:
            ValueError: when an argument is not allowed, or ffmpeg is missing.
            OSError: when the file cannot be written, or archrock did not write the file that is there.
            RuntimeError: when the encoder fails.
            KeyboardInterrupt: on Ctrl-C, within a second.
        """
        native = self._native or self.scenario.run(repeat=self._repeat)._native
        assert native is not None, "a history that was run is there"
        native.film(path, size, (speed, exaggerate), background, caption)

    def _repr_html_(self) -> str:
        page = html.escape(self.report_html(), quote=True)
        return f'<iframe srcdoc="{page}" style="width: 100%; height: 760px; border: 0"></iframe>'

    def _words(self) -> str:
        impacts = self._numbers()["impacts"]
        at = f"at {self.outcome_time_s:.4f} s"
        # Elastic contact lasts, so impacts are not counted.
        if impacts is not None:
            at += " without impact" if impacts == 0 else f" after {impacts} impact{'s'[: impacts > 1]}"
        vibrates = self._numbers().get("vibrates_since_s") is not None
        return {
            "never_moved": "never moved",
            "vibrates": "vibrated without opening",
            "incomplete": f"incomplete {at}",
            "rest": f"came to rest {at}",
            "overturned": f"overturned to the {self.overturning_sway} {at}",
            "still_rocking": f"still vibrates {at}" if vibrates else f"still rocking {at}",
        }[self.outcome]

    def __repr__(self) -> str:
        return f"<History: {self._words()}; {len(self)} samples>"

    def __str__(self) -> str:
        """The answer that may be quoted and its conditions, a line each."""
        return "\n".join([f"History: {self._words()}", *map(in_python, self.to_quote.split("; "))])

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, History):
            return NotImplemented
        columns = _native.History.COLUMNS
        return (
            self.scenario == other.scenario
            and self._numbers() == other._numbers()
            and all(
                np.array_equal(self._column(name), other._column(name), equal_nan=True)
                for name in columns
            )
            and self.events == other.events
        )

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[Any, ...]:
        kept = {
            "columns": {name: self._column(name) for name in _native.History.COLUMNS},
            "bodies": self.bodies,
            "largest_body": self.largest_body,
            "ended": {key: getattr(self, key) for key in ("outcome", "outcome_time_s", "overturning_sway")},
            "events": self.events,
            "numbers": self._numbers(),
            "scenario": self.scenario,
            "repeat": self._repeat,
        }
        if "summary" in self._kept:
            kept["summary"] = self._kept["summary"]
        return _restored, (kept,)


def _restored(kept: dict[str, Any]) -> History:
    for column in kept["columns"].values():
        column.flags.writeable = False
    history = History.__new__(History)
    history._native = None
    history._scenario = None
    history._repeat = kept["repeat"]
    history._cache = kept
    return history
