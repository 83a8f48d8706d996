"""Limits that hold at all corners of tolerances: those of the closed form at the worst corner."""

import math
import re
from pathlib import Path

import pytest
from scene_texts import SAFE, loom, table

from loomfmu import LoomfmuError, limit
from loomfmu.cli import main
from loomfmu.cosim.scenes.scene import Scene, parse
from loomfmu.design import loom as design

TEXT = "revolutions = 1\nsteps_per_revolution = 1440\n" + loom(
    table("shaft", speed="600 rev/min"), SAFE, "[tolerances]\n"
)
CORNERS = '"belt.guide_clearance" = ["0.2 mm", "0.5 mm"]\n"belt.head_mass" = ["105 g", "116 g"]\n'
SPEEDS = "shaft.speed=400rpm..800rpm"


def scene(tolerances: str) -> Scene:
    return parse(TEXT + tolerances, "loom")


def test_the_limit_is_that_of_the_worst_corner() -> None:
    found = limit(scene(CORNERS + '"shaft.speed" = ["590 rpm", "610 rpm"]'), vary=SPEEDS, corners=True)
    worst = design.safe_speed("WL680-3600", clearance=0.5e-3, mass=0.116).speed
    (at,) = found.claims[0].limits
    assert at.value == pytest.approx(worst, rel=1e-8) and at.error < 1e-6 * worst  # roots are found to 1e-9
    assert found.title.endswith("in the worst of 5 cases")  # the speed itself has no corners
    assert "case belt.guide_clearance = 0.5 mm, belt.head_mass = 116 g" in found.claims[0].verdict.note
    assert found.runs == 5 * (found.runs // 5)
    alone = limit(scene(CORNERS), vary=SPEEDS)
    assert alone.claims[0].limits[0].value > at.value and "case" not in alone.claims[0].verdict.note


def test_corners_count_at_each_value_of_a_second_variable() -> None:
    varied = [SPEEDS, "belt.guide_clearance=0.2mm..0.5mm"]
    found = limit(scene(CORNERS), vary=varied, rows=2, points=5, corners=True)
    highest = [row.claims[0].limits[0].value for row in found.rows]  # type: ignore[union-attr]
    expected = [
        design.safe_speed("WL680-3600", clearance=each, mass=0.116).speed for each in (0.2e-3, 0.5e-3)
    ]
    assert highest == pytest.approx(expected, rel=1e-8)


@pytest.mark.parametrize(
    ("tolerances", "given", "why"),
    [
        ("", {}, r"corners: the scene states no \[tolerances\]$"),
        ('"shaft.speed" = ["590 rpm", "610 rpm"]', {}, r"states no \[tolerances\] of anything else"),
        (CORNERS, {"prove": True}, "limits at corners are not proven; loomfmu tolerances --prove"),
    ],
)
def test_what_has_no_corners_is_refused(tolerances: str, given: dict[str, bool], why: str) -> None:
    with pytest.raises(LoomfmuError, match=why):
        limit(scene(tolerances), vary=SPEEDS, corners=True, **given)


def test_the_command_finds_them(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "loom.toml"
    path.write_text(TEXT + CORNERS)
    assert main(["limit", str(path), "--vary", SPEEDS, "--points", "5", "--corners"]) == 0
    worst = design.safe_speed("WL680-3600", clearance=0.5e-3, mass=0.116).speed * 30.0 / math.pi
    said = capsys.readouterr().out
    assert "in the worst of 5 cases" in said
    found = re.search(r"All claims hold from 400 to ([\d.]+) rev/min\.", said)
    assert found and worst - 1e-4 < float(found[1]) <= worst  # rounded to seven digits, to no more
