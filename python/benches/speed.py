"""Speed of the package: histories on two threads compared with one, and the cost of a call in addition to its history.

    python benches/speed.py [HISTORIES]
"""

from __future__ import annotations

import statistics
import sys
import time
from concurrent.futures import ThreadPoolExecutor

from archrock import Arch, Column, Pulse, simulate


def on_threads(count: int, histories: int) -> tuple[float, float]:
    """Wall-clock seconds and processor seconds for this many histories on this many threads."""
    arch = Arch(mean_radius_m=5.0, thickness_ratio=0.15, embrace_deg=180.0)
    pulses = [Pulse.half_sine(0.2 + 0.3 * index / histories, 0.3) for index in range(histories)]
    simulate(arch, pulses[0], output_step_s=0.05)
    begun, of_processors = time.perf_counter(), time.process_time()
    with ThreadPoolExecutor(count) as pool:
        outcomes = list(pool.map(lambda pulse: simulate(arch, pulse, output_step_s=0.05).outcome, pulses))
    took_s = time.perf_counter() - begun, time.process_time() - of_processors
    assert len(outcomes) == histories and set(outcomes) <= {"rest", "never_moved", "overturned", "still_rocking", "incomplete"}
    return took_s


def of_a_call() -> float:
    """Microseconds per call, for a history of two samples of a column that never moves."""
    column, pulse = Column(4.0, 0.8), Pulse.half_sine(1e-6, 1e-3)

    def calls(count: int = 5000) -> float:
        # Processor time: other programs do not count.
        begun = time.process_time()
        for _ in range(count):
            simulate(column, pulse, duration_s=1e-3, output_step_s=1e-3)
        return (time.process_time() - begun) / count * 1e6

    calls()
    return statistics.median(calls() for _ in range(9))


def main(histories: int) -> None:
    """Measures and prints the speeds."""
    print(f"a call, its history of two samples included: {of_a_call():.2f} us")
    (one, of_one), (two, of_two) = (on_threads(count, histories) for count in (1, 2))
    print(f"{histories} histories: {one:.2f} s on one thread, {two:.2f} s on two, {one / two:.2f} times as fast")
    # If other programs use the processors, only this shows whether threads hinder each other.
    print(f"time of the processors: {of_one:.2f} s on one thread, {of_two:.2f} s on two")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 4000)
