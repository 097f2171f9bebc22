"""Fifty variants of an arch in one table: which thickness survives which pulse?

    python python/examples/fifty_variants.py

Writes variants.csv and variants.png into the current folder.
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pandas as pd

from archrock import Scenario

SCENARIO = Path(__file__).parents[2] / "scenarios" / "recipes" / "own-arch.toml"
THICKNESSES_M = [0.34, 0.37, 0.40, 0.43, 0.46]
AMPLITUDES_G = [0.50 + 0.05 * i for i in range(10)]


def variant(case: tuple[float, float]) -> dict[str, object]:
    """The row of a thickness and an amplitude."""
    thickness_m, amplitude_g = case
    changes = [f"arch.thickness_m={thickness_m}", f"ground.one_sine.amplitude_g=-{amplitude_g}"]
    history = Scenario.read(SCENARIO, changes=changes).run()
    return {
        "thickness_m": thickness_m,
        "amplitude_g": round(amplitude_g, 2),
        "verdict": history.verdict,
        "peak_rotation_rad": history.summary["largest_peak_rotation_rad"],
    }


def table() -> pd.DataFrame:
    """A row for each variant; histories use all processors."""
    cases = [(thickness_m, amplitude_g) for thickness_m in THICKNESSES_M for amplitude_g in AMPLITUDES_G]
    with ThreadPoolExecutor() as pool:
        found: pd.DataFrame = pd.DataFrame(list(pool.map(variant, cases)))
    return found


if __name__ == "__main__":
    rows = table()
    rows.to_csv("variants.csv", index=False)
    print(rows.pivot(index="amplitude_g", columns="thickness_m", values="verdict"))
    peaks = rows[rows.verdict == "survives"].pivot(index="amplitude_g", columns="thickness_m", values="peak_rotation_rad")
    axes = peaks.plot(marker="o", xlabel="amplitude (g)", ylabel="largest rotation (rad)")
    axes.figure.savefig("variants.png")
