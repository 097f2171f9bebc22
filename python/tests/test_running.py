"""Threads, Ctrl-C, memory, and absurd arguments."""

from __future__ import annotations

import itertools
import math
import os
import random
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from archrock import (
    Arch,
    Column,
    Pulse,
    Record,
    Scenario,
    Structure,
    compute_part,
    merge,
    overturning_map,
    simulate,
    span,
    suite,
    threshold,
    threshold_along,
)


def test_the_lock_of_the_interpreter_is_free_while_computing() -> None:
    """Another thread keeps running, at its own pace, while a history is computed."""
    arch = Arch(5.0, 0.15, 180.0, voussoirs=24)
    pulse = Pulse.rectangular(-0.30, 0.20)
    ticks: list[float] = []
    over = threading.Event()

    def tick() -> None:
        while not over.wait(0.002):
            ticks.append(time.perf_counter())

    ticking = threading.Thread(target=tick)
    ticking.start()
    begun = time.perf_counter()
    simulate(arch, pulse, model="free_hinges", duration_s=2.0)
    took_s = time.perf_counter() - begun
    over.set()
    ticking.join()
    within = [at for at in ticks if begun <= at <= begun + took_s]
    # If the lock were held, the other thread would not have run.
    assert took_s > 0.05 and len(within) > 5


def test_histories_do_not_depend_on_threads(arch: Arch) -> None:
    pulses = [Pulse.half_sine(0.2 + 0.02 * index, 0.4) for index in range(24)]
    alone = [simulate(arch, pulse, duration_s=1.0).rotations.tobytes() for pulse in pulses]
    together: list[bytes] = [b""] * len(pulses)

    def work(start: int) -> None:
        for index in range(start, len(pulses), 4):
            together[index] = simulate(arch, pulses[index], duration_s=1.0).rotations.tobytes()

    threads = [threading.Thread(target=work, args=(start,)) for start in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert together == alone


LONG = {
    "a history": """
arch = Arch(5.0, 0.15, 180.0, voussoirs=60)
simulate(arch, Pulse.one_cosine(0.6, 5.0), model="free_hinges", duration_s=200.0, longest_step_s=1e-6)
""",
    "a map": """
arch = Arch(5.0, 0.15, 180.0)
axes = {"duration_s": span(0.1, 2.0, 1000), "amplitude_g": span(0.1, 3.0, 1000)}
overturning_map(arch, Pulse.one_cosine(0.5, 0.8), axes, duration_s=30.0)
""",
    "a map of long cells": """
arch = Arch(5.0, 0.15, 180.0, voussoirs=60)
axes = {"duration_s": [1.0, 2.0], "amplitude_g": [0.5, 0.6]}
overturning_map(arch, Pulse.one_cosine(0.5, 0.8), axes, model="free_hinges", duration_s=200.0, longest_step_s=1e-6)
""",
}


@pytest.mark.parametrize("work", LONG)
def test_ctrl_c_ends_work_within_a_second(work: str) -> None:
    script = (
        # Started in the background of a shell, a process ignores the signal.
        "import signal, time\nsignal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "from archrock import *\nprint('begun', flush=True)\ntry:\n"
        + "".join(f"    {line}\n" for line in LONG[work].strip().splitlines())
        + "except KeyboardInterrupt:\n    print('interrupted', time.time(), flush=True)\n"
    )
    process = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    assert process.stdout.readline() == "begun\n"
    time.sleep(1.5)
    assert process.poll() is None, "it is still at work"
    sent = time.time()
    process.send_signal(signal.SIGINT)
    line = process.stdout.readline().split()
    assert line[0] == "interrupted" and float(line[1]) - sent < 1.0, line
    assert process.wait(5.0) == 0


def resident_bytes() -> int:
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


@pytest.mark.skipif(not os.path.exists("/proc/self/statm"), reason="memory is read from /proc")
def test_memory_is_steady_over_ten_thousand_calls() -> None:
    column, pulse = Column(4.0, 0.8), Pulse.half_sine(0.5, 0.5)

    def calls(count: int) -> None:
        for index in range(count):
            history = simulate(column, pulse, duration_s=0.2)
            history.rotations, history.poses, history.state, history.events
            if index % 10 == 0:
                Pulse.half_sine(0.5, 0.5 + 1e-3 * index)
                simulate(column, pulse, duration_s=0.2 + 1e-6 * index)

    calls(1_000)
    before = resident_bytes()
    calls(10_000)
    # A history has some 8 kB; if the histories were kept, they would take 80 MB.
    assert resident_bytes() - before < 4_000_000


def test_a_history_too_large_for_memory_is_refused(arch: Arch, pulse: Pulse) -> None:
    drums = Column(40.0, 8.0, drums=400)
    long: dict[str, Any] = {"model": "free_hinges", "duration_s": 1_000.0, "output_step_s": 0.005}
    # At least four numbers for every drum in every sample, eight bytes each.
    needed_gb = Scenario.of(drums, pulse, **long).memory_gb()
    assert 400 * 200_000 * 5 * 8 / 1e9 < needed_gb < 20.0
    with pytest.raises(MemoryError, match=f"takes {needed_gb:.1f} GB of memory, and 4.0 GB are allowed"):
        simulate(drums, pulse, **long)
    with pytest.raises(MemoryError, match=r"and 0\.1 MB are allowed: .*by `memory_gb`"):
        Scenario.of(arch, pulse, duration_s=2.0).run(memory_gb=1e-4)

    settings: dict[str, Any] = {"duration_s": 2.0, "output_step_s": 1e-3}
    needed_gb = Scenario.of(arch, pulse, **settings).memory_gb()
    history = simulate(arch, pulse, **settings, memory_gb=2.0 * needed_gb)
    assert history == simulate(arch, pulse, **settings)
    arrays = (history.time, history.rotations, history.rates, history.poses, history.energy_j, history.gaps)
    assert 0.3 * needed_gb < sum(array.nbytes for array in arrays) / 1e9 < needed_gb
    for bound in (0.0, -1.0, float("nan"), 1e7):
        with pytest.raises(ValueError, match="`memory_gb = "):
            simulate(arch, pulse, memory_gb=bound)


NAN, INFINITE = float("nan"), float("inf")
ODD: list[Any] = [
    NAN, INFINITE, -INFINITE, 0, -0.0, -1, 1e308, 1e-308, 5e-324, 10**30, -(10**400), 2**63, True, None,
    "", "x", "\x00", "\ud800", "é\x7f", "1" * 100_000, b"x", [], [NAN], [[]], {}, {"from": 1}, {1: 2}, (1, 2), 1j,
    np.float32("nan"), np.int8(-3), np.array(2.0), np.zeros((2, 2)), np.array([]), np.array(["a"]), object(), len,
    range(3), Pulse.half_sine(0.3, 0.3), Column(4.0, 0.8), slice(3), ...,
]  # fmt: skip


def refused(call: Callable[[], Any]) -> bool:
    """Whether a call raises one of the documented exceptions; others propagate."""
    try:
        call()
    except (ValueError, TypeError, OSError, OverflowError, MemoryError):
        return True
    except Exception as error:
        raise AssertionError(f"{call.__defaults__}: {error!r}") from error
    return False


def test_absurd_arguments_raise_exceptions(arch: Arch, pulse: Pulse) -> None:
    rng = random.Random(1)
    calls: list[tuple[Callable[..., Any], dict[str, Any]]] = [
        (Arch, {"mean_radius_m": 5.0, "thickness_ratio": 0.15, "embrace_deg": 180.0, "voussoirs": 7, "depth_m": 1.0}),
        (Column, {"height_m": 4.0, "width_m": 0.8, "drums": 2, "top_width_m": 0.7}),
        (Column, {"height_m": 4.0, "width_m": 0.8, "drum_heights_m": [2.0, 2.0]}),
        (Structure, {"arch": {"mean_radius_m": 5.0}, "column": {}, "piers": [], "load": [{}]}),
        (Pulse.gabor, {"amplitude_g": 0.3, "duration_s": 0.3, "gamma": 2.0, "start_s": 0.0}),
        (Pulse, {"kind": "half_sine", "amplitude_g": 0.3, "duration_s": 0.3}),
        (
            Record,
            {"time": [0.0, 1.0], "acceleration": [0.0, 1.0], "unit": "g", "name": "r", "peak_g": 0.3, "start_s": 0.0},
        ),
        (Scenario, {"tables": {"arch": {}}, "files": {}, "model": None}),
        (Scenario.parse, {"text": "[arch]", "name": "s.toml", "model": None, "changes": ["a=1"]}),
        (
            simulate,
            {
                "structure": arch,
                "ground": pulse,
                "duration_s": 0.1,
                "output_step_s": 0.01,
                "model": "four_links",
                "impact": "mirrored",
                "restitution": None,
                "gravity_m_s2": 9.81,
                "direction": "as_given",
                "initial_sway": None,
                "memory_gb": 1.0,
            },
        ),
        (overturning_map, {"of": arch, "ground": pulse, "axes": {"duration_s": [0.1], "amplitude_g": [0.2]}}),
        (suite, {"of": arch, "records": [], "peaks_g": [0.1], "both_signs": True}),
        (
            threshold_along,
            {"of": arch, "ground": pulse, "key": "arch.depth_m", "start": 1.0, "end": 2.0, "count": 2, "to_factor": 0.2, "stride": 0.5},
        ),
        (threshold, {"of": arch, "ground": pulse, "from_factor": 1.0, "to_factor": 1.1, "stride": 0.1}),
        (merge, {"parts": []}),
        (compute_part, {"scenario": Scenario.of(arch, pulse), "study": "map", "shard": (1, 2), "folder": "/dev/null"}),
    ]  # fmt: skip
    outcomes = {True: 0, False: 0}
    for call, good in calls:
        for name, odd in itertools.product(good, ODD):
            some = {**good, name: odd}
            outcomes[refused(lambda call=call, some=some: call(**some))] += 1  # type: ignore[misc]
        for _ in range(30):
            some = {name: rng.choice([value, rng.choice(ODD)]) for name, value in good.items()}
            outcomes[refused(lambda call=call, some=some: call(**some))] += 1  # type: ignore[misc]
    # Some odd arguments are allowed, such as None for an optional one.
    assert outcomes[True] > 1500 and outcomes[False] > 50


def test_limits_of_allowed_numbers_give_finite_histories() -> None:
    rng = random.Random(2)
    done = 0
    for _ in range(150):
        height_m = 10.0 ** rng.uniform(-3.0, 6.0)
        keys = (height_m, height_m * 10.0 ** rng.uniform(-2.0, 0.5))
        pulse = (10.0 ** rng.uniform(-3.0, 3.0), 10.0 ** rng.uniform(-6.0, 1.0))
        try:
            history = simulate(
                Column(*keys),
                Pulse.half_sine(*pulse),
                duration_s=10.0 ** rng.uniform(-6.0, 1.0),
                output_step_s=1e-2,
                gravity_m_s2=10.0 ** rng.uniform(-3.0, 3.0),
            )
        except ValueError:
            continue
        done += 1
        assert np.isfinite(history.rotations).all() and np.isfinite(history.time).all()
        assert math.isfinite(history.outcome_time_s)
    assert done > 50


def test_an_exception_in_a_callback_leaves_the_package_usable(arch: Arch, pulse: Pulse) -> None:
    """An exception in the callback of a study leaves everything usable."""
    axes = {"duration_s": span(0.1, 1.0, 50), "amplitude_g": span(0.1, 1.0, 50)}
    for _ in range(5):
        with pytest.raises(ZeroDivisionError):
            overturning_map(arch, pulse, axes, progress=lambda done, every: 1 // 0)
    assert simulate(arch, pulse).outcome == "rest"
