"""Onset of rocking and restitution of circular arches, against their thickness, for several embrace angles.

    python shapes_of_arches.py > shapes.csv

A table for a spreadsheet or a plot: `A_L` is the ground acceleration that starts the arch, the restitution is that of its first impact.
"""

from __future__ import annotations

from collections.abc import Iterator

from archrock import Arch

EMBRACES_DEG = [180.0, 170.0, 157.5, 140.0, 120.0]
THICKNESS_RATIOS = [0.05 + 0.01 * step for step in range(26)]


def shapes() -> Iterator[tuple[float, float, float, float | None]]:
    """Embrace angle, thickness ratio, `A_L` in g, and restitution (`None` if the impact stops the arch) of each arch that stands."""
    for embrace_deg in EMBRACES_DEG:
        for thickness_ratio in THICKNESS_RATIOS:
            try:
                arch = Arch(1.0, thickness_ratio, embrace_deg)
                links = arch.chain(count=1)
            except ValueError:
                continue  # Too thin to carry its own weight, or too thick to rock as four links.
            incipient_g = arch.limit().right.acceleration_g
            if incipient_g is not None:
                yield embrace_deg, thickness_ratio, incipient_g, links[0].restitution if links else None


if __name__ == "__main__":
    print("embrace_deg,thickness_ratio,incipient_acceleration_g,first_restitution")
    for row in shapes():
        print(",".join("" if value is None else f"{value:.6g}" for value in row))
