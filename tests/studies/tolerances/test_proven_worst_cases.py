"""Worst cases proven: enclosures hold the closed form, and are narrow."""

import math

import pytest

import loomfmu
from loomfmu.cosim.scenes.scene import Scene
from loomfmu.design import loom as design
from loomfmu.studies.tolerances.worst_cases import show


@pytest.mark.parametrize(("clearance", "status"), [(0.3, "proven"), (0.5, "refuted")])  # at most [mm]
def test_an_enclosure_holds_the_closed_form(
    loom: Scene, clearance: float, status: str, capsys: pytest.CaptureFixture[str]
) -> None:
    vary = ["shaft.speed=580rpm..620rpm", f"belt.guide_clearance=0.2mm..{clearance}mm"]
    found = loomfmu.tolerances(loom, vary=vary, prove=True)
    margin, safe, dwell, transfer, count = found.proofs
    safe_speed = design.safe_speed("WL680-3600", clearance=clearance * 1e-3).speed
    # 1e-12: rounding of the closed form
    assert margin.low - 1e-12 <= 0.9 - (620.0 * math.pi / 30.0 / safe_speed) ** 2 <= margin.high + 1e-12
    assert margin.high - margin.low <= 1e-7  # 1e-6 of the bound
    assert margin.status == safe.status == status
    assert safe.low <= safe_speed * (1 + 1e-12) - 620.0 * math.pi / 30.0 <= safe.high + 1e-9
    assert (dwell.status, transfer.status, count.status) == ("proven", "proven", "cannot be proven")
    show(found)
    said = capsys.readouterr().out
    assert f"{status}: margin, in the worst case {margin.low:.6f}"[:50] in said
    assert "not proven: count (belt.buckled depends on the run so far)" in said
