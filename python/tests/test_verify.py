"""The check by the Circolare 7/2019: the program's files, records and spectra in memory."""

from __future__ import annotations

import json
import pickle
from pathlib import Path
from typing import Any

import pytest

from archrock import Arch, Check, Column, Record, Scenario, Structure, verify

from .conftest import ROOT, Program

SITE: dict[str, Any] = {
    "soil": "B",
    "topography": "T1",
    "sld": {"ag_g": 0.10, "f0": 2.40, "tc_star_s": 0.28},
    "slv": {"ag_g": 0.25, "f0": 2.40, "tc_star_s": 0.35},
}
WAVES = sorted((ROOT / "scenarios" / "records").glob("wave-*.at2"))


def by_program(program: Program, folder: Path, text: str) -> Path:
    (folder / "s.toml").write_text(text)
    ran = program("verify", folder / "s.toml", "--out", folder / "out")
    assert ran.returncode == 0, ran.stderr
    return folder / "out"


def test_a_check_is_that_of_the_program(program: Program, tmp_path: Path, arch: Arch) -> None:
    found = verify(arch, SITE, title="Mine", sides="right")
    scenario = Scenario.of(arch, title="Mine", demand=SITE, verify={"sides": "right"})
    assert verify(scenario).summary == found.summary
    folder = by_program(program, tmp_path, scenario.to_toml())
    summary = json.loads((folder / "verify.json").read_text())
    page = (folder / "verify.html").read_text()
    # The text of the scenario has another name here; nothing else differs.
    name = found.summary["files"][0]["file"]
    assert page.replace("s.toml: SHA", f"{name}: SHA").replace(
        summary["files"][0]["sha256"], found.summary["files"][0]["sha256"]
    ) == found.page
    summary["files"] = found.summary["files"]
    assert summary == found.summary
    assert found.zeta_e == found.summary["states"]["slv"]["zeta_e"]
    assert found.verdict == {"sld": "passed", "slv": "not_passed"}
    assert pickle.loads(pickle.dumps(found)) == found
    assert "srcdoc" in found._repr_html_()
    found.save(tmp_path / "saved")
    assert (tmp_path / "saved" / "verify.html").read_text() == found.page


def test_any_structure_is_checked() -> None:
    pointed = Structure(
        pointed_arch={"span_m": 6.0, "rise_m": 4.0, "thickness_m": 0.6, "voussoirs": 14},
        piers={"height_m": 3.0, "width_m": 1.6},
    )
    zeta_e = verify(pointed, SITE).zeta_e
    assert zeta_e is not None and 0.0 < zeta_e < 2.0
    drums = verify(Column(4.0, 0.8, drums=5), SITE)
    assert drums.summary["states"]["slv"]["method"] == "displacement"
    assert drums.zeta_e == pytest.approx(0.97616, abs=5e-6)
    assert verify(Column(4.0, 0.8), SITE).zeta_e == pytest.approx(0.97616, abs=5e-6)


def test_joints_that_slide_first_have_no_ratio() -> None:
    found = verify(Column(4.0, 2.8), SITE)
    assert found.zeta_e is None and "0.577" in (found.no_zeta_e_because or "")
    assert found.verdict == {"sld": "no_answer", "slv": "no_answer"}
    sliding = found.summary["states"]["slv"]["right"]["sliding"]
    assert sliding["bound_g"] == pytest.approx(0.577, abs=1e-7) and sliding["verdict"] == "no_answer"
    assert "0.5770 g is an upper bound" in found.page and "never passed" in found.page
    needed = Column(4.0, 2.8).limit().friction_demand
    assert needed["right"] == pytest.approx(0.7, abs=1e-6)


def test_spectra_and_records_are_held_in_memory() -> None:
    column = Column(4.0, 0.8)
    periods = [0.0, 0.15, 0.5, 1.0, 2.0, 2.6, 4.0]
    accelerations = [0.29, 0.70, 0.70, 0.35, 0.20, 0.08, 0.03]
    points = verify(column, {"slv": {"spectrum": (periods, accelerations)}})
    assert points.zeta_e == pytest.approx(0.91768, abs=5e-6)
    assert points.summary["formulas"] is None
    records = [Record.read(path) for path in WAVES[:3]]
    found = verify(column, SITE, slv_records=records).summary["states"]["slv"]["histories"]
    assert [record["file"] for record in found["records"]] == sorted(one.name for one in records)


def test_scenarios_that_cannot_be_checked_are_refused(arch: Arch) -> None:
    with pytest.raises(ValueError, match="needs a demand"):
        verify(arch)
    with pytest.raises(ValueError, match="2.2 \\(NTC 2018, § 3.2.1\\)"):
        verify(arch, {**SITE, "slv": {"ag_g": 0.25, "f0": 2.0, "tc_star_s": 0.35}})
    with pytest.raises(ValueError, match="says everything itself"):
        verify(Scenario.of(arch, demand=SITE), SITE)
    with pytest.raises(ValueError, match="at least 3"):
        verify(arch, SITE, slv_records=[Record.read(WAVES[0])])
    assert isinstance(verify(arch, SITE), Check)
