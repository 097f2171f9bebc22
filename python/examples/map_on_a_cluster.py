"""An overturning map on a Dask cluster: workers compute the parts, parts of a worker that dies are retried, then all are joined.

    python map_on_a_cluster.py [ADDRESS]

Without the address of a scheduler it starts two workers of its own. Any worker computes any part, in any order; the
joined files are byte-identical to those of one process, and of `archrock map`. Workers need only the package: a part
comes back as the contents of its file, so no shared folder is necessary.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Iterable
from pathlib import Path

from distributed import Client, as_completed

from archrock import Arch, Pulse, Results, Scenario, compute_part, map_scenario, merge, span

SCENARIO = map_scenario(
    Arch(mean_radius_m=5.0, thickness_ratio=0.15, embrace_deg=180.0),
    Pulse.one_cosine(amplitude_g=0.5, duration_s=0.8),
    {"duration_s": span(0.1, 1.6, 76), "amplitude_g": span(0.12, 3.0, 80, "logarithmic")},
    duration_s=30.0,
    title="Semicircular arch under cosine pulses",
)


def part(scenario: Scenario, shard: tuple[int, int]) -> tuple[str, bytes]:
    """Computes a part on one thread, as Dask expects of a task, and returns its file."""
    with tempfile.TemporaryDirectory() as folder:
        path = compute_part(scenario, "map", shard, folder, threads=1)
        return path.name, path.read_bytes()


def shards(count: int) -> list[tuple[int, int]]:
    """The parts of a study that is divided into this many."""
    return [(index, count) for index in range(1, count + 1)]


def joined(parts: Iterable[tuple[str, bytes]], scenario: Scenario) -> Results:
    """The results of all parts of the map of a scenario."""
    with tempfile.TemporaryDirectory() as folder:
        paths = []
        for name, contents in parts:
            paths.append(Path(folder, name))
            paths[-1].write_bytes(contents)
        return merge(paths, scenario)


def compute(client: Client, scenario: Scenario, count: int) -> Results:
    """The map of a scenario, in this many parts. Several parts per worker even out the load."""
    sent = client.scatter(scenario, broadcast=True)
    tasks = client.map(lambda shard, of: part(of, shard), shards(count), of=sent, retries=3, pure=False)
    parts = []
    for done in as_completed(tasks):
        parts.append(done.result())
        print(f"{len(parts)} of {count} parts", file=sys.stderr)
    return joined(parts, scenario)


def main(address: str | None) -> None:
    """Computes the map and writes it to `results/cluster`."""
    local = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None}
    with Client(address) if address else Client(**local) as client:
        results = compute(client, SCENARIO, 16)
    results.save("results/cluster")
    print(f"results in results/cluster: {', '.join(results.files)}")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else None)
