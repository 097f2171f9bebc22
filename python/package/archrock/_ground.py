"""Ground motions."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from ._described import Described, read_file
from ._native import Ground as NativeGround
from ._samples import Held, Samples
from ._tables import Tables, arguments, to_toml

if TYPE_CHECKING:
    import numpy.typing as npt

Unit = Literal["g", "m/s2", "cm/s2", "mm/s2", "mg", "g/10", "in/s2", "ft/s2", "m/s", "cm/s", "mm/s"]
Quantity = Literal["acceleration", "velocity"]
Baseline = Literal["mean", "linear"]


class Ground(Described):
    """A ground motion: a :class:`Pulse` or a :class:`Record`."""

    __slots__ = ("_native",)

    _native: NativeGround

    def _read(self, tables: Tables, files: Held) -> None:
        self._native = NativeGround(to_toml({"ground": tables}), files)
        self._describe(json.loads(self._native.to_json()), files)

    @property
    def kind(self) -> str:
        """Its kind, as named in a scenario."""
        return next(iter(self._tables))

    def sample(self, step_s: float = 0.005) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
        """Times in s from its start to its end, ``step_s`` apart, and horizontal accelerations in m/s2, each of shape ``(samples,)``.

        One g is 9.81 m/s2. At a jump the acceleration is that after it.

        >>> Pulse.rectangular(amplitude_g=0.1, duration_s=0.01).sample()[1].round(3)
        array([0.981, 0.981, 0.   ])

        Raises:
            ValueError: when ``step_s`` is not a positive number, or makes more than 1,800,000 samples.
        """
        return self._native.sample(step_s)


class Pulse(Ground):
    """A ground acceleration given by a formula, positive to the right. Each kind has a constructor.

    Amplitudes are peak accelerations in units of gravity. ``duration_s`` is the length of the part of the pulse to which
    its kind refers (see the program's documentation). The pulse begins at ``start_s``. ``vertical_amplitude_g`` is the peak
    of a vertical acceleration of the same shape, positive upwards.

    >>> Pulse.half_sine(amplitude_g=0.3, duration_s=0.5)
    Pulse.half_sine(amplitude_g=0.3, vertical_amplitude_g=0.0, duration_s=0.5, start_s=0.0)
    """

    __slots__ = ()

    def __init__(self, kind: str, **keys: Any) -> None:
        """The pulse of a kind, with these keys of its table.

        Raises:
            ValueError: when a key or number is not allowed, with the library's explanation.
        """
        self._read({kind: keys}, {})

    @classmethod
    def _of(
        cls,
        kind: str,
        amplitude_g: float,
        duration_s: float,
        start_s: float,
        vertical_amplitude_g: float,
        **keys: float,
    ) -> Pulse:
        return cls(
            kind,
            amplitude_g=amplitude_g,
            duration_s=duration_s,
            start_s=start_s,
            vertical_amplitude_g=vertical_amplitude_g,
            **keys,
        )

    def _value(self, key: str) -> float:
        value: float = self._tables[self.kind][key]
        return value

    @property
    def amplitude_g(self) -> float:
        """Peak acceleration, positive to the right."""
        return self._value("amplitude_g")

    @property
    def vertical_amplitude_g(self) -> float:
        """Peak of the vertical acceleration, positive upwards."""
        return self._value("vertical_amplitude_g")

    @property
    def duration_s(self) -> float:
        """Length of the part of the pulse to which its kind refers."""
        return self._value("duration_s")

    @property
    def start_s(self) -> float:
        """Time at which it starts."""
        return self._value("start_s")

    def __repr__(self) -> str:
        return f"Pulse.{self.kind}({arguments(self._tables[self.kind])})"

    @classmethod
    def rectangular(
        cls,
        amplitude_g: float,
        duration_s: float,
        *,
        start_s: float = 0.0,
        vertical_amplitude_g: float = 0.0,
    ) -> Pulse:
        """``a`` for the whole ``duration_s``."""
        return cls._of("rectangular", amplitude_g, duration_s, start_s, vertical_amplitude_g)

    @classmethod
    def step_pair(
        cls,
        amplitude_g: float,
        duration_s: float,
        *,
        start_s: float = 0.0,
        vertical_amplitude_g: float = 0.0,
    ) -> Pulse:
        """``a`` for ``duration_s``, then ``-a/2`` for twice as long; the final velocity is zero."""
        return cls._of("step_pair", amplitude_g, duration_s, start_s, vertical_amplitude_g)

    @classmethod
    def half_sine(
        cls,
        amplitude_g: float,
        duration_s: float,
        *,
        start_s: float = 0.0,
        vertical_amplitude_g: float = 0.0,
    ) -> Pulse:
        """Half a sine of ``duration_s``."""
        return cls._of("half_sine", amplitude_g, duration_s, start_s, vertical_amplitude_g)

    @classmethod
    def one_sine(
        cls,
        amplitude_g: float,
        duration_s: float,
        *,
        start_s: float = 0.0,
        vertical_amplitude_g: float = 0.0,
    ) -> Pulse:
        """A whole sine of ``duration_s``."""
        return cls._of("one_sine", amplitude_g, duration_s, start_s, vertical_amplitude_g)

    @classmethod
    def one_cosine(
        cls,
        amplitude_g: float,
        duration_s: float,
        *,
        start_s: float = 0.0,
        vertical_amplitude_g: float = 0.0,
    ) -> Pulse:
        """A whole cosine of ``duration_s``, from its peak."""
        return cls._of("one_cosine", amplitude_g, duration_s, start_s, vertical_amplitude_g)

    @classmethod
    def triangular(
        cls,
        amplitude_g: float,
        duration_s: float,
        *,
        start_s: float = 0.0,
        vertical_amplitude_g: float = 0.0,
    ) -> Pulse:
        """Up to ``a`` at half of ``duration_s`` and back, in straight lines."""
        return cls._of("triangular", amplitude_g, duration_s, start_s, vertical_amplitude_g)

    @classmethod
    def ricker(
        cls,
        amplitude_g: float,
        duration_s: float,
        *,
        start_s: float = 0.0,
        vertical_amplitude_g: float = 0.0,
    ) -> Pulse:
        """Symmetric Ricker wavelet; ``duration_s`` is the period of its central frequency."""
        return cls._of("ricker", amplitude_g, duration_s, start_s, vertical_amplitude_g)

    @classmethod
    def antisymmetric_ricker(
        cls,
        amplitude_g: float,
        duration_s: float,
        *,
        start_s: float = 0.0,
        vertical_amplitude_g: float = 0.0,
    ) -> Pulse:
        """Antisymmetric Ricker wavelet; ``duration_s`` is the period of its central frequency."""
        return cls._of("antisymmetric_ricker", amplitude_g, duration_s, start_s, vertical_amplitude_g)

    @classmethod
    def mavroeidis_papageorgiou(
        cls,
        amplitude_g: float,
        duration_s: float,
        *,
        gamma: float = 2.0,
        phase_deg: float = 0.0,
        start_s: float = 0.0,
        vertical_amplitude_g: float = 0.0,
    ) -> Pulse:
        """Pulse of Mavroeidis and Papageorgiou (2003); ``duration_s`` is its period and ``gamma`` its length in periods."""
        return cls._of(
            "mavroeidis_papageorgiou",
            amplitude_g,
            duration_s,
            start_s,
            vertical_amplitude_g,
            gamma=gamma,
            phase_deg=phase_deg,
        )

    @classmethod
    def gabor(
        cls,
        amplitude_g: float,
        duration_s: float,
        *,
        gamma: float = 2.0,
        phase_deg: float = 0.0,
        start_s: float = 0.0,
        vertical_amplitude_g: float = 0.0,
    ) -> Pulse:
        """Gabor wavelet; ``duration_s`` is its period and ``gamma`` its length in periods."""
        return cls._of(
            "gabor",
            amplitude_g,
            duration_s,
            start_s,
            vertical_amplitude_g,
            gamma=gamma,
            phase_deg=phase_deg,
        )

    @classmethod
    def windowed_sine(
        cls,
        amplitude_g: float,
        duration_s: float,
        *,
        cycles: float = 2.0,
        phase_deg: float = 0.0,
        start_s: float = 0.0,
        vertical_amplitude_g: float = 0.0,
    ) -> Pulse:
        """Sine in a Hann window; ``duration_s`` is its period and ``cycles`` its length in periods."""
        return cls._of(
            "windowed_sine",
            amplitude_g,
            duration_s,
            start_s,
            vertical_amplitude_g,
            cycles=cycles,
            phase_deg=phase_deg,
        )


_ARGUMENTS = """

Args:
    amplitude_g: peak acceleration in units of gravity, positive to the right.
    duration_s: length in s of the part of the pulse that the first line names.
{own}    start_s: time in s at which it begins.
    vertical_amplitude_g: peak of a vertical acceleration of the same shape in units of gravity, positive upwards.

Raises:
    ValueError: when a number is not allowed, with the library's explanation.
"""
_OWN = {
    "gamma": "    gamma: length in periods.\n",
    "cycles": "    cycles: length in periods.\n",
    "phase_deg": "    phase_deg: phase in degrees.\n",
}


def _explain(constructor: Any) -> None:
    """Adds the arguments, which most constructors share, to the help of a constructor."""
    own = "".join(text for name, text in _OWN.items() if name in constructor.__annotations__)
    constructor.__doc__ = constructor.__doc__ + _ARGUMENTS.format(own=own)


for _constructor in vars(Pulse).values():
    if isinstance(_constructor, classmethod) and _constructor.__func__.__doc__:
        _explain(_constructor.__func__)


class Record(Ground):
    """A recorded ground motion: straight lines between samples, zero before the first and after the last.

    Args:
        time: times in s, rising by at least a microsecond, shape ``(samples,)``, 2 to 1,800,000; anything like an
            array. Or a number: the time between samples, of which the first is at time zero.
        acceleration: accelerations in ``unit``, or velocities if ``quantity`` says so, shape ``(samples,)``.
        unit: ``"g"``, ``"mg"``, ``"g/10"``, ``"m/s2"``, ``"cm/s2"``, ``"mm/s2"``, ``"in/s2"`` or ``"ft/s2"``; ``"m/s"``,
            ``"cm/s"`` or ``"mm/s"`` for velocities.
        quantity: the quantity of the samples. Between samples of ``"velocity"`` the acceleration is constant.
        baseline: subtracted from the accelerations: their ``"mean"`` over time, or the ``"linear"`` line of least squares.
        high_pass_hz: corner of a high-pass filter of the accelerations; the record then begins before its time zero, so it
            needs ``start_s``.
        remove_mean: the older name of ``baseline="mean"``.
        name: its name in results and messages.
        scale: factor on the accelerations; or give ``peak_g``.
        peak_g: peak acceleration to which to scale, in units of gravity.
        start_s: time of the simulation at the record's time zero.
        component: direction of the accelerations, ``"horizontal"`` (positive to the right) or ``"vertical"``
            (upwards).
        vertical: a record of the vertical component, with its own scaling and the time zero of this record.

    Raises:
        ValueError: when samples are not valid, with the library's explanation; samples count from 1.
        TypeError: when samples are not numbers.
    """

    __slots__ = ()

    def __init__(
        self,
        time: npt.ArrayLike | float,
        acceleration: npt.ArrayLike,
        *,
        unit: Unit,
        quantity: Quantity | None = None,
        baseline: Baseline | None = None,
        high_pass_hz: float | None = None,
        remove_mean: bool | None = None,
        name: str = "record",
        scale: float | None = None,
        peak_g: float | None = None,
        start_s: float | None = None,
        component: Literal["horizontal", "vertical"] | None = None,
        vertical: Record | None = None,
    ) -> None:
        if not isinstance(name, str):
            raise TypeError(f"`name` must be a text, not {type(name).__name__}")
        if not isinstance(vertical, (Record, type(None))):
            raise TypeError(f"`vertical` must be a Record, not {type(vertical).__name__}")
        table: Tables = {
            "file": name,
            "format": "csv",
            "unit": unit,
            "quantity": quantity,
            "baseline": baseline,
            "high_pass_hz": high_pass_hz,
            "remove_mean": remove_mean,
            "scale": scale,
            "peak_g": peak_g,
        }
        times = np.arange(np.size(acceleration)) * float(time) if isinstance(time, (int, float)) else time
        files: Held = {name: Samples.of(times, acceleration)}
        if vertical is not None:
            table["vertical"], held = vertical._as_vertical(name)
            files.update(held)
        self._read({"record": {**table, "start_s": start_s, "component": component}}, files)

    def _as_vertical(self, beside: str) -> tuple[Tables, Held]:
        table: Tables = dict(self._tables["record"])
        if "vertical" in table:
            raise ValueError("`vertical` has a vertical record itself: give one record per direction")
        # It uses the clock of the horizontal record, and its place implies its direction.
        table.pop("start_s", None)
        table.pop("component", None)
        name = table["file"]
        if name == beside:
            table["file"] = f"vertical-{name}"
        return table, {table["file"]: self._files[name]}

    def _as_right(self, beside: Ground) -> tuple[Tables, Held]:
        """The table ``[ground.right]`` of this record, with its files under names that the other ground does not use."""
        table: Tables = dict(self._tables["record"])
        files: Held = {}

        def held(name: str) -> str:
            other = name
            while other in beside._files or other in files:
                other = f"right-{other}"
            files[other] = self._files[name]
            return other

        table["file"] = held(table["file"])
        if "vertical" in table:
            table["vertical"] = {**table["vertical"], "file": held(table["vertical"]["file"])}
        return {"record": table}, files

    @classmethod
    def read(
        cls,
        path: str | Path,
        *,
        vertical: Record | str | Path | None = None,
        **keys: Any,
    ) -> Record:
        """Reads a record from a file, as ``[ground.record]`` of a scenario does.

        Args:
            path: the file; its contents are kept.
            vertical: a record of the vertical component, or its file, which is then read in the same way.
            keys: keys of ``[ground.record]``: for tables at least ``unit``, perhaps ``time_column`` and
                ``acceleration_column``, or ``dt_s`` and ``wrapped``; ``format``, if it does not follow from the file; ``channel``,
                of files with several;
                ``quantity``, ``baseline``, ``high_pass_hz``; ``scale`` or ``peak_g``, ``start_s``, ``component``.

        Raises:
            OSError: when the file cannot be read.
            ValueError: when it is faulty, with the line.
        """
        name = Path(path).name
        files: Held = {name: read_file(path)}
        table: Tables = {"file": name, **keys}
        if isinstance(vertical, (str, Path)):
            own = ("scale", "peak_g", "start_s", "component", "acceleration_column", "channel")
            vertical = cls.read(vertical, **{key: value for key, value in keys.items() if key not in own})
        if not isinstance(vertical, (Record, type(None))):
            raise TypeError(f"`vertical` must be a Record or the path of its file, not {type(vertical).__name__}")
        if vertical is not None:
            table["vertical"], held = vertical._as_vertical(name)
            files.update(held)
        return cls._restored({"record": table}, files)

    @classmethod
    def from_obspy(cls, trace: Any, *, unit: Unit, **keys: Any) -> Record:
        """The record of a trace of ObsPy, of a stream with one trace, or of anything with its ``data``, ``stats.delta`` and ``id``.

        Times count from the first sample. A trace does not name its unit: remove the instrument response first.

        >>> from types import SimpleNamespace
        >>> trace = SimpleNamespace(data=[0.0, 0.1, 0.0], stats=SimpleNamespace(delta=0.01), id="XX.STA")
        >>> Record.from_obspy([trace], unit="g")
        <Record 'XX.STA': 3 samples in g until 0.02 s>

        Args:
            trace: the trace, or the stream.
            unit: unit of its data.
            keys: further arguments of :class:`Record`.

        Raises:
            ValueError: as for :class:`Record`, and for a stream with several traces, whose ids it names.
        """
        if not hasattr(trace, "data"):
            traces = list(trace)
            if len(traces) != 1:
                ids = ", ".join(f"stream[{index}] is {one.id}" for index, one in enumerate(traces))
                raise ValueError(f"the stream has {len(traces)} traces: give one of them ({ids})")
            trace = traces[0]
        return cls(float(trace.stats.delta), trace.data, unit=unit, **{"name": str(trace.id), **keys})

    @property
    def name(self) -> str:
        """Its name in results and messages."""
        name: str = self._tables["record"]["file"]
        return name

    @property
    def unit(self) -> str:
        """Unit of the samples in their file."""
        unit = self._native.unit()
        assert unit is not None, "a record has a unit"
        return unit

    @property
    def quantity(self) -> str:
        """The quantity of the samples: ``"acceleration"`` or ``"velocity"``."""
        quantity: str = self._tables["record"].get("quantity", "acceleration")
        return quantity

    def _samples(self) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
        samples = self._native.samples()
        assert samples is not None, "a record has samples"
        return samples

    @property
    def time(self) -> npt.NDArray[np.float64]:
        """Times of the samples in s, from the record's time zero, shape ``(samples,)``."""
        return self._samples()[0]

    @property
    def acceleration(self) -> npt.NDArray[np.float64]:
        """Accelerations in :attr:`unit`, not scaled, shape ``(samples,)``.

        Raises:
            ValueError: for a record of velocities.
        """
        return self._of("acceleration")

    @property
    def velocity(self) -> npt.NDArray[np.float64]:
        """Velocities in :attr:`unit`, not scaled, shape ``(samples,)``.

        Raises:
            ValueError: for a record of accelerations.
        """
        return self._of("velocity")

    def _of(self, quantity: Quantity) -> npt.NDArray[np.float64]:
        if self.quantity != quantity:
            raise ValueError(f"{self.name!r} is a record of {self.quantity}: see `{self.quantity}`")
        return self._samples()[1]

    def __repr__(self) -> str:
        count, last_s = len(self.time), self.time[-1]
        return f"<Record {self.name!r}: {count} samples in {self.unit} until {last_s:g} s>"
