"""The example with fifty variants gives the table of docs/recipes.md."""

from __future__ import annotations

from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
pytest.importorskip("pandas")


@pytest.mark.filterwarnings("ignore::archrock.ArchrockWarning")
def test_variants_have_the_verdicts_of_the_recipe(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "python" / "examples"))
    import fifty_variants as example

    page = (ROOT / "docs" / "recipes.md").read_text(encoding="utf-8")
    below = page.partition("thickness_m  ")[2].splitlines()
    thicknesses_m = [float(word) for word in below[0].split()]
    assert thicknesses_m == example.THICKNESSES_M
    rows = {float(row.split()[0]): row.split()[1:] for row in below[2:12]}
    assert list(rows) == pytest.approx(example.AMPLITUDES_G)
    # Both sides of each edge.
    edges = [(0.34, 0.55), (0.34, 0.60), (0.37, 0.65), (0.37, 0.70), (0.40, 0.75), (0.40, 0.80), (0.43, 0.85), (0.43, 0.90)]
    for thickness_m, amplitude_g in edges:
        verdict = example.variant((thickness_m, amplitude_g))["verdict"]
        assert verdict == rows[amplitude_g][thicknesses_m.index(thickness_m)], (thickness_m, amplitude_g)
