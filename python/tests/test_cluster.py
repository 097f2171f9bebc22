"""A map on a Dask cluster of two workers, one of which is killed on the way."""

from __future__ import annotations

import os
import signal
import sys
import time
from pathlib import Path

import pytest

from archrock import Arch, Pulse, map_scenario, overturning_map, span

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
distributed = pytest.importorskip("distributed")


def test_a_cluster_that_loses_a_worker_computes_the_map_of_one_process(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(EXAMPLES))
    monkeypatch.setenv("PYTHONPATH", str(EXAMPLES))
    import map_on_a_cluster as example

    scenario = map_scenario(
        Arch(5.0, 0.15, 180.0),
        Pulse.one_cosine(0.5, 0.8),
        {"duration_s": span(0.4, 1.2, 40), "amplitude_g": span(0.12, 2.0, 40, "logarithmic")},
        duration_s=20.0,
    )
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
    ) as cluster, distributed.Client(cluster) as client:
        first = {name: worker["pid"] for name, worker in _workers(client).items()}
        assert len(first) == 2
        parts = client.map(
            _slow_part, example.shards(12), scenario=scenario, retries=3, pure=False
        )
        _wait_until(lambda: sum(part.status == "finished" for part in parts) >= 2)
        victim = next(iter(first.values()))
        os.kill(victim, signal.SIGKILL)
        done = client.gather(parts)
        assert len(done) == 12
        computed_by = {pid for _, pid in done}
        assert victim not in {worker["pid"] for worker in _workers(client).values()}
        # Its parts were lost with it, and other workers computed them again.
        assert victim not in computed_by and len(computed_by) >= 1
        merged = example.joined((part for part, _ in done), scenario)
        again = example.compute(client, scenario, 5)
    whole = overturning_map(scenario)
    assert merged.files == whole.files
    assert again.files == whole.files


def _workers(client: object) -> dict[str, dict[str, int]]:
    workers = client.run(lambda: {"pid": os.getpid()})  # type: ignore[attr-defined]
    return dict(workers)


def _slow_part(shard: tuple[int, int], scenario: object) -> tuple[tuple[str, bytes], int]:
    """A part that takes long enough to be killed."""
    import map_on_a_cluster as example

    time.sleep(0.3)
    return example.part(scenario, shard), os.getpid()  # type: ignore[arg-type]


def _wait_until(true: object, for_s: float = 60.0) -> None:
    end = time.monotonic() + for_s
    while not true():  # type: ignore[operator]
        assert time.monotonic() < end, "nothing happens"
        time.sleep(0.02)


assert sys.platform != "win32", "workers are killed by a signal"
