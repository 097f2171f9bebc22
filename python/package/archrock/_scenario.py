"""Scenarios, and their simulation."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path, PurePosixPath
from typing import Any, Literal, cast

from ._described import Described, read_file
from ._ground import Ground, Record
from ._hinge import Limit
from ._history import History
from ._native import MEMORY_GB
from ._native import History as NativeHistory
from ._native import Scenario as NativeScenario
from ._samples import Held, Samples
from ._settings import Settings, long_name
from ._structure import Model, Structure
from ._tables import Tables, to_toml
from ._warnings import warn


class Scenario(Described):
    """A scenario with every default filled in: everything that a TOML file of the program can contain.

    Args:
        tables: the tables of a scenario, such as ``{"arch": {...}, "ground": {"half_sine": {...}}}``.
        files: contents of the files that the tables name. If none are given, files are read from the working folder.
        model: the model of motion; ``None``: the one that the tables choose.

    Raises:
        ValueError: all errors of the scenario, in the library's words.

    Limit analysis and capacity need no motion: a scenario is read although the record of its ``[ground]`` is missing or faulty, or
    although drums or moved springings have no model of motion. Then :meth:`limit` and :func:`capacity` work, and everything that moves
    the structure raises the error.

    A scenario is pickled with the contents of the files that it names, unless these lie outside the scenario's
    own folder: such files must exist where the scenario is used again.
    """

    __slots__ = ("_folder", "_model", "_native")

    _native: NativeScenario
    _folder: str | None
    _model: str | None

    def __init__(
        self,
        tables: Mapping[str, Any],
        *,
        files: Mapping[str, bytes | Samples] | None = None,
        model: Model | None = None,
    ) -> None:
        held: Held = dict(files or {})
        self._take(NativeScenario(to_toml(tables), None, held, model, ()), held, None, model)

    def _take(
        self,
        native: NativeScenario,
        files: Held,
        folder: str | None,
        model: str | None,
    ) -> None:
        self._native = native
        self._folder = folder
        self._model = model
        self._describe(json.loads(native.to_json()), files)

    @classmethod
    def read(
        cls,
        path: str | Path,
        *,
        model: Model | None = None,
        changes: Sequence[str] = (),
    ) -> Scenario:
        """Reads a scenario file.

        Args:
            path: the file; records are read from files relative to its folder.
            model: the model of motion; overrides the choice of the file.
            changes: values that replace those in the file, as with the program's ``--set``:
                ``"arch.thickness_ratio=0.12"``.

        Raises:
            OSError: when the file cannot be read.
            TypeError: when ``path`` is not a path.
            ValueError: all errors of the scenario, each with line and column.
        """
        # `open` alone would also take a number, for the descriptor of an open file, and close that file.
        path = Path(path)
        text = read_file(path, "scenario", 1).decode("utf-8")
        return cls.parse(text, str(path), model=model, changes=changes)

    @classmethod
    def parse(
        cls,
        text: str,
        name: str = "scenario.toml",
        *,
        model: Model | None = None,
        changes: Sequence[str] = (),
    ) -> Scenario:
        """Reads the TOML text of a scenario; ``name`` stands for its file, and records are relative to the folder of that.

        Raises:
            ValueError: all errors of the scenario, each with line and column.
        """
        scenario = cls.__new__(cls)
        native = NativeScenario(text, name, {}, model, list(changes))
        scenario._take(native, {}, str(Path(name).absolute().parent), model)
        return scenario

    @classmethod
    def of(
        cls,
        structure: Structure,
        ground: Ground | None = None,
        *,
        right: Record | Mapping[str, Any] | None = None,
        supports: Mapping[str, Mapping[str, float]] | None = None,
        title: str | None = None,
        map: Mapping[str, Any] | None = None,
        suite: Mapping[str, Any] | None = None,
        demand: Mapping[str, Any] | None = None,
        verify: Mapping[str, Any] | None = None,
        uncertain: Mapping[str, Any] | None = None,
        files: Mapping[str, bytes | Samples] | None = None,
        **settings: Any,
    ) -> Scenario:
        """The scenario of a structure on a ground.

        Args:
            structure: the structure.
            ground: the ground motion.
            right: ground motion under the right foot, for models with joints: a record, or table ``[ground.right]``, such as
                ``{"delay_s": 0.05}`` or ``{"apparent_velocity_m_s": 300.0}`` for a delay of ``ground``.
            supports: table ``[supports]``: movement of the springings before time 0, for models with joints, such as
                ``{"right": {"spread_m": 0.02, "settlement_m": 0.01, "rotation_rad": 0.0}}``.
            title: free text for the results.
            map: table ``[map]``: two axes.
            suite: table ``[suite]``.
            demand: table ``[demand]``.
            verify: table ``[verify]``.
            uncertain: table ``[uncertain]``: samples, seed, and the distribution of each key such as ``"column.width_m"``.
            files: contents of the files that the tables name.
            settings: how to simulate it, as for :func:`simulate`.

        Raises:
            ValueError: all errors of the scenario, in the library's words.
        """
        if not isinstance(structure, Structure):
            raise _not_a_structure(structure)
        if not isinstance(ground, (Ground, type(None))):
            raise _not_a_ground(ground)
        chosen = Settings(**settings)
        tables: Tables = {"title": title, **structure._tables, **chosen.tables()}
        held = {**structure._files, **(files or {})}
        if ground is not None:
            tables["ground"] = dict(ground._tables)
            held.update(ground._files)
        if right is not None:
            if ground is None:
                raise ValueError("`right` is how one foot moves while the other does by `ground`: give that too")
            if isinstance(right, Record):
                own, files_of_right = right._as_right(ground)
                held.update(files_of_right)
                right = own
            tables["ground"]["right"] = right
        tables["supports"] = supports
        tables.update(map=map, suite=suite, demand=demand, verify=verify)
        tables.update(uncertain=uncertain)
        # Statics of drums and of moved springings need no model: the tables choose the model unless the caller gives one.
        return cls(tables, files=held, model=cast(Model, long_name(chosen.model)) if "model" in settings else None)

    def run(self, *, memory_gb: float = MEMORY_GB, repeat: bool = True) -> History:
        """Simulates the scenario and returns its history.

        Args:
            memory_gb: memory that the history may take, in units of 1e9 bytes; see :meth:`memory_gb`.
            repeat: whether its verdict rests on repetitions; see :attr:`History.summary`.

        Raises:
            ValueError: when nothing moves the structure, its record or its model of motion could not be read, or the motion cannot be
                computed.
            MemoryError: when the history takes more memory than allowed; raised before the computation if that is known.
            KeyboardInterrupt: on Ctrl-C, within a second.
        """
        native = NativeHistory.of(self._native, None, _bytes(memory_gb))
        return _history(native, self._files, repeat, self._folder)

    def memory_gb(self) -> float:
        """Largest memory that the samples of its history take, in units of 1e9 bytes; events need some more.

        Raises:
            ValueError: when the structure has no such model of motion.
        """
        return self._native.memory_bytes() / 1e9

    def limit(self) -> Limit:
        """The ground acceleration that starts the structure to either side, by limit analysis, as ``archrock limit``.

        Raises:
            ValueError: when the library cannot find such an onset.
        """
        found = Limit(json.loads(self._native.limit_json()))
        warn(found["warnings"])
        return found

    def to_toml(self) -> str:
        """The scenario as the text of a file of the program.

        Every default is written out, except ``duration_s``, whose default follows the ground motion.
        """
        return self._native.to_toml()

    def _read(self, tables: Tables, files: Held) -> None:
        raise NotImplementedError("scenarios are restored with their folder")

    def __reduce__(self) -> tuple[Any, ...]:
        unmovable = self._native.unmovable()
        files = self._files or _contents(self._tables, self._folder, missing=unmovable is not None)
        return _restored, (self._tables, files, self._folder, self._model, unmovable)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Scenario):
            return NotImplemented
        return self._native == other._native

    def __hash__(self) -> int:
        # Equal scenarios may be given by different keys, but all have the same keys of [simulation].
        return hash(to_toml({"simulation": self._tables["simulation"]}))

    def __repr__(self) -> str:
        title = self._tables.get("title")
        stands = ", ".join(key for key in self._tables if key not in ("title", "simulation", "impact"))
        return f"<Scenario {title!r}: {stands}>" if title else f"<Scenario: {stands}>"


def _restored(
    tables: Tables,
    files: Held,
    folder: str | None,
    model: str | None,
    unmovable: str | None = None,
) -> Scenario:
    scenario = Scenario.__new__(Scenario)
    name = None if files or folder is None else str(Path(folder) / "scenario.toml")
    # The tables have all defaults filled in, so they choose the model themselves.
    native = NativeScenario(to_toml(tables), name, files, None, (), unmovable)
    scenario._take(native, files, folder, model)
    return scenario


def _names(tables: Tables) -> list[str]:
    """The files that the tables of a scenario name."""
    record = tables.get("ground", {}).get("record", {})
    blocks = tables.get("blocks", {})
    right = tables.get("ground", {}).get("right", {}).get("record", {})
    names = [of.get("file") for of in (record, right)]
    names += [of.get("vertical", {}).get("file") for of in (record, right)]
    names += [blocks.get("joints"), blocks.get("outlines")]
    suite = tables.get("suite", {})
    names += suite.get("records", []) + [entry.get("file") for entry in suite.get("record", [])]
    states = tables.get("demand", {}).values()
    names += [state.get("spectrum") for state in states if isinstance(state, dict)]
    check = tables.get("verify", {})
    names += check.get("slv_records", []) + check.get("slc_records", [])
    return [name for name in names if name is not None]


def _contents(tables: Tables, folder: str | None, *, missing: bool) -> Held:
    """The contents of all files that the tables name, empty if some lie outside the folder; without missing files if ``missing``."""
    names = _names(tables)
    if any(".." in PurePosixPath(name).parts or Path(name).is_absolute() for name in names):
        return {}
    paths = {name: Path(folder or ".") / name for name in names}
    return {name: read_file(path) for name, path in paths.items() if path.is_file() or not missing}


def _bytes(memory_gb: float) -> int:
    if not 0.0 < memory_gb <= 1e6:
        raise ValueError(f"`memory_gb = {memory_gb}` is not allowed: it must be above 0, and at most 1e6")
    return int(memory_gb * 1e9)


def _not_a_structure(given: object) -> TypeError:
    name = type(given).__name__
    return TypeError(f"`structure` must be an Arch, a Column, a Body or a Structure, not {name}")


def _not_a_ground(given: object) -> TypeError:
    return TypeError(f"`ground` must be a Pulse or a Record, not {type(given).__name__}")


def _history(native: NativeHistory, files: Held, repeat: bool, folder: str | None = None) -> History:
    """A history that can make its scenario."""

    def scenario(native: NativeScenario) -> Scenario:
        made = Scenario.__new__(Scenario)
        made._take(native, files, folder, None)
        return made

    return History(native, scenario, repeat)


def simulate(
    structure: Structure,
    ground: Ground | None = None,
    *,
    right: Record | Mapping[str, Any] | None = None,
    supports: Mapping[str, Mapping[str, float]] | None = None,
    model: Model = "four_links",
    impact: str = "max_restitution",
    restitution: float | None = None,
    restitution_factor: float | None = None,
    initial_sway: Literal["right", "left"] | None = None,
    initial_rotation_rad: float | None = None,
    initial_rate_rad_s: float | None = None,
    initial_impulse_n_s: float | None = None,
    initial_height_m: float | None = None,
    longest_step_s: float | None = None,
    shortest_step_s: float | None = None,
    friction_coefficient: float | None = None,
    normal_stiffness_gpa_m: float | None = None,
    shear_stiffness_gpa_m: float | None = None,
    stone_modulus_gpa: float | None = None,
    mortar_modulus_gpa: float | None = None,
    mortar_thickness_m: float | None = None,
    damping_time_s: float | None = None,
    damping_ratio: float | None = None,
    damping_frequency_hz: float | None = None,
    rebound_ratio: float | None = None,
    compressive_strength_mpa: float | None = None,
    contact: Literal["continuous"] | None = None,
    contact_points: int | None = None,
    duration_s: float | None = None,
    output_step_s: float = 0.005,
    relative_tolerance: float = 1e-9,
    rest_energy_ratio: float = 1e-8,
    gravity_m_s2: float = 9.81,
    direction: Literal["both", "as_given", "mirrored"] = "both",
    point: tuple[float, float] | None = None,
    memory_gb: float = MEMORY_GB,
    repeat: bool = True,
) -> History:
    """The history of a structure on moving ground, bit-identical to the program's.

    The interpreter's lock is released meanwhile, so histories in several threads run on several processors. A
    structure caches results that do not depend on the ground. So many histories of one structure are fastest with a single
    object and equal settings.

    Args:
        structure: the structure.
        ground: the ground motion; ``None`` for a release from a rotated position, or a start with a rate.
        right: ground motion under the right foot, as for :meth:`Scenario.of`, for models with joints.
        supports: movement of the springings before time 0, as for :meth:`Scenario.of`, for models with joints. With this or ``right``
            the structure caches nothing from call to call.
        model: ``"four_links"`` (or Housner's column), or ``"free_hinges"``: blocks whose joints open and shut anywhere,
            or ``"elastic_joints"``: blocks with elastic joints; these need a stiffness.
        impact: impact model of four links: ``"max_restitution"``, ``"same_sections"``, ``"mirrored"`` or
            ``"prescribed"``.
        restitution: energy after over before an impact, with ``"prescribed"``.
        restitution_factor: factor on the restitution of the impact model, as measured over predicted; ``None``: 1.
        initial_sway: side to which it is rotated or starts with a rate, ``"right"`` or ``"left"``.
        initial_rotation_rad: magnitude of that rotation, for the body whose rotation is the coordinate.
        initial_rate_rad_s: rate of that rotation, positive away from the position at rest.
        initial_impulse_n_s: impulse of a blow on a column of one block at rest, instead of the rate, with ``initial_height_m``.
        initial_height_m: height of that blow above the base.
        longest_step_s: longest step, with free hinges and elastic joints.
        shortest_step_s: after more than 50 impacts within this time the next landings count as one, with free hinges.
        friction_coefficient: Coulomb's coefficient at every joint, with free hinges and elastic joints; ``None``: joints do not
            slip.
        normal_stiffness_gpa_m: stiffness of elastic joints against penetration, per area, in GPa/m.
        shear_stiffness_gpa_m: stiffness against slip; ``None``: 0.4 times the stiffness against penetration.
        stone_modulus_gpa: Young's modulus of the blocks, which gives the stiffness instead of ``normal_stiffness_gpa_m``.
        mortar_modulus_gpa: Young's modulus of the mortar, with ``mortar_thickness_m``.
        mortar_thickness_m: thickness of the mortar.
        damping_time_s: damping forces are this time multiplied by the rates of the elastic forces; ``None``: the default, 1e-4.
        damping_ratio: share of critical damping at ``damping_frequency_hz``, instead of ``damping_time_s``.
        damping_frequency_hz: frequency of that share.
        rebound_ratio: ratio of the rates of a column of one block after and before an impact, instead of ``damping_time_s``.
        compressive_strength_mpa: stress at which elastic joints crush; ``None``: they do not crush.
        contact: ``"continuous"``: the whole joint carries stress, the default.
        contact_points: number of points that carry the stress of a joint, instead.
        duration_s: longest time to simulate; ``None``: until the end of the ground motion, and then for the larger of 10 s and
            20 times the square root of size over gravity.
        output_step_s: time between samples.
        relative_tolerance: error that the integrator of four links may make in a step.
        rest_energy_ratio: the structure is at rest when its energy falls below this fraction of the energy barrier.
        gravity_m_s2: acceleration of gravity.
        direction: directions of the horizontal ground motion. With ``"both"`` the history is that of the motion as given, and
            :attr:`History.verdict` is the worse of both directions. ``"mirrored"`` gives all horizontal accelerations the opposite sign.
        point: a point of the undeformed structure, ``(x, y)`` in m, to observe: see :attr:`History.point`.
        memory_gb: memory that the history may take, in units of 1e9 bytes.
        repeat: whether the verdict rests on repetitions; see :attr:`History.summary`.

    Returns:
        The history.

    Raises:
        ValueError: when an argument is not allowed, or the motion cannot be computed, with the library's explanation.
        TypeError: when an argument has the wrong type.
        MemoryError: when the history takes more memory than allowed; raised before the computation if that is known.
        KeyboardInterrupt: on Ctrl-C, within a second.
    """
    key = (
        model,
        impact,
        restitution,
        restitution_factor,
        initial_sway,
        initial_rotation_rad,
        initial_rate_rad_s,
        initial_impulse_n_s,
        initial_height_m,
        longest_step_s,
        shortest_step_s,
        friction_coefficient,
        normal_stiffness_gpa_m,
        shear_stiffness_gpa_m,
        stone_modulus_gpa,
        mortar_modulus_gpa,
        mortar_thickness_m,
        damping_time_s,
        damping_ratio,
        damping_frequency_hz,
        rebound_ratio,
        compressive_strength_mpa,
        contact,
        contact_points,
        duration_s,
        output_step_s,
        relative_tolerance,
        rest_energy_ratio,
        gravity_m_s2,
        direction,
    )
    if right is not None or supports is not None:
        settings = Settings(*key)._asdict()
        scenario = Scenario.of(structure, ground, right=right, supports=supports, **settings)
        return _history(NativeHistory.of(scenario._native, None, _bytes(memory_gb), point), scenario._files, repeat)
    try:
        base = structure._bases[key]
    except (KeyError, TypeError, AttributeError):
        if not isinstance(structure, Structure):
            raise _not_a_structure(structure) from None
        base = structure._base(key)
    memory_bytes = _bytes(memory_gb)
    if ground is None:
        return _history(NativeHistory.of(base, None, memory_bytes, point), structure._files, repeat)
    if not isinstance(ground, Ground):
        raise _not_a_ground(ground)
    native = NativeHistory.of(base, ground._native, memory_bytes, point)
    return _history(native, {**structure._files, **ground._files}, repeat)
