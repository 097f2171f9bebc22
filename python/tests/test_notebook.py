"""The notebook from question to answer runs, on small sizes."""

from __future__ import annotations

from pathlib import Path

import pytest

nbclient = pytest.importorskip("nbclient")
nbformat = pytest.importorskip("nbformat")

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"


def test_the_notebook_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ARCHROCK_SMALL", "1")
    notebook = nbformat.read(EXAMPLES / "from_question_to_answer.ipynb", as_version=4)
    assert all(not cell.get("outputs") for cell in notebook.cells), "results are not kept"
    # An error of a cell is raised here.
    nbclient.NotebookClient(notebook, timeout=120).execute()
    text, kinds = "", set()
    for cell in notebook.cells:
        for output in cell.get("outputs", []):
            text += output.get("text", "")
            kinds |= set(output.get("data", {}))
    assert "starts to rock at 0.1443 g" in text
    assert "first impact at 1.0279 s" in text
    assert "overturns from" in text and "half of the records overturn it at" in text
    # An animated report, a map, curves.
    assert {"text/html", "image/svg+xml", "image/png"} <= kinds
