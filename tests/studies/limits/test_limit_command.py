"""The command `loomfmu limit`: what it prints and writes, what it returns, what it refuses."""

import csv
import math
import re
from pathlib import Path

import pytest

from loomfmu.cli import main
from loomfmu.design import loom as design
from loomfmu.studies.limits.limits import POINTS, ROWS

DEMO = str(Path(__file__).parents[3] / "sims" / "wl680_3600.toml")
DAMPER = str(Path(__file__).parents[3] / "sims" / "damper.toml")
QUICK = ["--points", "5", "--set", "revolutions=2"]
SPEED = ["limit", DEMO, "--vary", "shaft.speed", "--from", "300rpm", "--to", "900rpm", *QUICK]
RANGES = ["--vary", "shaft.speed=300rpm..900rpm", "--vary", "belt.guide_clearance=0.2mm..0.8mm"]
BOTH = ["limit", DEMO, *RANGES, "--rows", "3", *QUICK]


def test_limits_are_printed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(SPEED) == 0
    printed = capsys.readouterr()
    shown = [line for line in printed.err.splitlines() if "the weave repeats after 2 picks" not in line]
    assert shown == []
    lines = printed.out.splitlines()
    assert lines[0].endswith(
        "weave 10/01/10/01; revolutions = 2: shaft.speed from 300 to 900 rev/min (given)"
    )
    assert "the belt keeps a margin of 10 %: holds up to 646.8164 rev/min" in lines
    assert "  (+125.6 % at 600 rev/min)" in lines
    assert "  (does not depend on shaft.speed; +7.402 % at 600 rev/min)" in lines
    above = "The first to fail is 'the belt keeps a margin of 10 %' above this range."
    assert f"All claims hold from 300 to 646.8164 rev/min. {above}" in lines
    effort = (
        r"\d+ runs; numerical error of the limits up to \de-0[5-7] rev/min;"
        " intervals narrower than 150 rev/min may be missed"
    )
    assert re.fullmatch(effort, lines[-1])


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ("=40..80", "from 381.9719 to 763.9437 rev/min (given; numbers without a unit are rad/s)"),
        (" --from 500rpm",
         "from 500 to 1200 rev/min (lower end given, upper end twice the scene's 600 rev/min)"),
        (" --to 500rpm", "from 300 to 500 rev/min (lower end half the scene's 600 rev/min, upper end given)"),
        # a value with a minus was taken for an option
        (" --vary=shaft.start_angle --from -10deg --to -.5deg", "from -10 to -0.5 deg (given)"),
    ],
)  # fmt: skip
def test_the_heading_says_where_the_range_comes_from(
    options: str, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    vary = options if "--vary" in options else f" --vary shaft.speed{options}"
    assert main(["limit", DEMO, *vary.split(), *QUICK]) in (0, 1)
    assert capsys.readouterr().out.splitlines()[0].endswith(said)


def test_the_help_states_the_defaults(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["limit", "--help"])
    said = " ".join(capsys.readouterr().out.split())
    assert f"values of the first that are tried first ({POINTS})" in said
    assert f"values of the second that are taken ({ROWS})" in said
    assert "Exit status: 0 all claims hold in some range; 1 in none; 2 bad input" in said


def test_a_wide_terminal_has_a_table(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    assert main(["limit", DAMPER, "--vary", "shaft.speed=300rpm..340rpm", "--points", "3"]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert lines[2].split("  ")[0] == "claim" and lines[2].endswith("distance at 200 rev/min")
    assert "jumps at 322.24" in lines[3] and "up to 322.24" in lines[3]
    assert "  nowhere  " in lines[4]
    assert any(
        line.startswith("There is no value from 300 to 340 rev/min at which all claims hold: ")
        for line in lines
    )
    assert any(line.startswith("Where a claim") for line in lines)
    assert "The scene's own value, 200 rev/min, is outside the range that was searched." in lines


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        (["shaft.speed=650rpm"], "650 rev/min, 'the belt keeps a margin of 10 %' fails."),
        # 0.0008 % from the bound, where 24 steps are off by 0.005 %
        (
            ["dobby.speed_reduction=0.41304", "steps_per_revolution=24"],
            "600 rev/min, 'the frames dwell long enough' and 'the weft transfer falls within the dwell'"
            " are undecided.",
        ),
    ],
)
def test_what_does_not_hold_at_the_scenes_own_value_is_said(
    settings: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([*SPEED, *(each for setting in settings for each in ("--set", setting))]) in (0, 1)
    assert f"At the scene's own value, {said}" in capsys.readouterr().out


def test_limits_are_written_as_a_table(capsys: pytest.CaptureFixture[str]) -> None:
    for _again in range(2):  # over a table of its own
        assert main([*SPEED, "--output", "limits.csv"]) == 0
    assert capsys.readouterr().out.endswith("written: limits.csv\n")
    with Path("limits.csv").open() as file:
        first, second = csv.DictReader(file)
    assert (first["claim"], first["begins"], first["unit"], first["jumps"]) == (
        "the belt keeps a margin of 10 %",
        "to fail",
        "rev/min",
        "false",
    )
    safe = design.safe_speed("WL680-3600", clearance="0.3 mm").speed * 30.0 / math.pi
    assert float(first["value"]) == pytest.approx(safe * math.sqrt(0.9), rel=1e-9)
    assert float(second["value"]) == pytest.approx(safe, rel=1e-9)
    assert float(first["low"]) <= float(first["value"]) <= float(first["high"])


def test_two_variables_give_a_boundary(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*BOTH, "--output", "boundary.csv"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[1] == "at 3 values of belt.guide_clearance from 0.2 to 0.8 mm (given)"
    assert "0.2 mm: 300 to 679.7492 rev/min; the belt keeps a margin of 10 %" in lines
    with Path("boundary.csv").open() as file:
        heading, *rows = csv.reader(file)
    assert heading[:3] == [
        "belt.guide_clearance [mm]",
        "low shaft.speed [rev/min]",
        "high shaft.speed [rev/min]",
    ]
    assert [row[0] for row in rows] == ["0.2", "0.5", "0.8"]
    assert main([*BOTH, "--output", "boundary.csv"]) == 0  # a table of its own is replaced


@pytest.mark.slow
@pytest.mark.parametrize("arguments", [SPEED, BOTH])
def test_pictures_are_written_and_repeat(arguments: list[str]) -> None:
    pytest.importorskip("matplotlib")
    for suffix, start in ((".png", b"\x89PNG"), (".svg", b"<?xml"), (".pdf", b"%PDF")):
        assert main([*arguments, "--output", f"picture{suffix}"]) == 0
        assert Path(f"picture{suffix}").read_bytes().startswith(start)
    first = Path("picture.svg").read_bytes()
    assert main([*arguments, "--output", "picture.svg"]) == 0
    assert Path("picture.svg").read_bytes() == first


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ([*SPEED, "--output", "limits.txt"], "limits.txt: use .csv for a table, or .svg, .png or .pdf"),
        ([*SPEED, "--output", "notes.csv"], "notes.csv: exists and is not a table of limits; --force"),
        (
            ["limit", DEMO, *["--vary", "a=1..2", "--vary", "b", "--vary", "c"]],
            "vary = ['a=1..2', 'b', 'c'] must be",
        ),
    ],
)
def test_mistakes_are_refused_in_one_line(
    capsys: pytest.CaptureFixture[str], arguments: list[str], said: str
) -> None:
    Path("notes.csv").write_text("mine\n")
    assert main(arguments) == 2
    printed = capsys.readouterr()
    assert printed.out == "" and printed.err.startswith(f"loomfmu: {said}") and printed.err.count("\n") == 1
    assert Path("notes.csv").read_text() == "mine\n"
