"""Rocking of masonry arches, and of free-standing columns, under ground motion.

>>> from archrock import Arch, Pulse, simulate
>>> arch = Arch(mean_radius_m=5.0, thickness_ratio=0.15, embrace_deg=180.0)
>>> history = simulate(arch, Pulse.rectangular(amplitude_g=-0.30, duration_s=0.20))
>>> history
<History: came to rest at 3.3656 s after 78 impacts; 675 samples>
>>> history.rotations.shape
(675, 3)

The Rust library archrock computes everything; results are bit-identical to the program's. Lengths are in
metres, times in seconds, and ground accelerations in units of gravity if their name ends in ``_g``. x is to the right,
rotations are positive anticlockwise. An invalid value raises ``ValueError`` with the library's explanation. An unlikely value, or
a limit of the trust in a result, issues an :class:`ArchrockWarning`.
"""

from importlib.metadata import version as _version

from ._ground import Ground, Pulse, Record
from ._hinge import ChainLink, Hinge, Limit, Mechanism, Onset
from ._history import Event, History, Impact
from ._scenario import Scenario, simulate
from ._structure import Arch, Body, Column, Structure
from ._studies import (
    Capacity,
    Check,
    Ensemble,
    FirstFactors,
    Fragilities,
    Histories,
    OverturningMap,
    ProbabilityMap,
    Results,
    Suite,
    Threshold,
    ThresholdAlong,
    capacity,
    compute_part,
    ensemble,
    map_scenario,
    merge,
    overturning_map,
    span,
    suite,
    suite_scenario,
    threshold,
    threshold_along,
    verify,
)
from ._summary import Summary
from ._warnings import ArchrockWarning

__all__ = [
    "Arch",
    "ArchrockWarning",
    "Capacity",
    "ChainLink",
    "Check",
    "Body",
    "Column",
    "Ensemble",
    "Event",
    "FirstFactors",
    "Fragilities",
    "Ground",
    "Hinge",
    "Histories",
    "History",
    "Impact",
    "Limit",
    "Mechanism",
    "Onset",
    "OverturningMap",
    "ProbabilityMap",
    "Pulse",
    "Record",
    "Results",
    "Scenario",
    "Structure",
    "Suite",
    "Summary",
    "Threshold",
    "ThresholdAlong",
    "capacity",
    "compute_part",
    "ensemble",
    "map_scenario",
    "merge",
    "overturning_map",
    "simulate",
    "span",
    "suite",
    "suite_scenario",
    "threshold",
    "threshold_along",
    "verify",
]

__version__ = _version("archrock")

_REPLACED = {
    "spectrum": "`threshold_along`",
    "Spectrum": "`ThresholdAlong`",
}


def __getattr__(name: str) -> object:
    if name in _REPLACED:
        raise AttributeError(f"`archrock.{name}` was removed: use {_REPLACED[name]}")
    raise AttributeError(f"module 'archrock' has no attribute {name!r}")
