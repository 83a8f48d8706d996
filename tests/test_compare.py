"""Two traces compared: what counts as a difference, where it is, and what no grid can tell."""

import json
import math
import tracemalloc
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import h5py
import numpy as np
import pytest
from made_traces import made, verdict

import loomfmu
from loomfmu import LoomfmuError, cli
from loomfmu.traces import comparing

RPM = 600.0
SPEED = RPM * math.pi / 30.0


def trace(
    path: Path,
    values: Any = np.sin,
    steps: int = 720,
    turns: float = 2.0,
    unit: str = "m",
    worst: float = 0.5,
    clearance: float = 3e-4,
    more: bool = False,
    speed: float = SPEED,
) -> Path:
    """A trace of one smooth signal over the shaft's angle, and a count of revolutions."""
    angle = np.linspace(0.0, 2.0 * math.pi * turns, round(steps * turns) + 1)
    picks = np.floor(angle / (2.0 * math.pi) + 1e-9).astype(int)
    signals = {"belt.x": values(angle), "belt.pick": picks} | ({"belt.y": values(angle)} if more else {})
    belt = {"fmu": "BeltMonitor", "guide_clearance": clearance}
    about = {"unit": unit, "groups": {"belt": belt | {"parameter_units": '{"guide_clearance": "m"}'}}}
    verdicts = [verdict("x stays", "belt.x", worst)]
    return made(path, signals, time=angle / speed, angle=angle, verdicts=verdicts, **about).path


def pair(folder: Path, values: Any = np.sin, **changes: Any) -> tuple[Path, Path]:
    """A trace, and one that differs from it."""
    return trace(folder / "a.h5"), trace(folder / "b.h5", values, **changes)


def test_equal_traces_are_equal_to_the_last_bit(tmp_path: Path) -> None:
    found = loomfmu.compare(*pair(tmp_path), tolerance=0.0)
    assert found and found.equal and found.compared == 2
    assert "exactly equal" in found.summary and found.how == "compared at equal shaft angles, at 1441 samples"


def test_a_difference_is_found_where_it_begins_and_where_it_is_largest(tmp_path: Path) -> None:
    def bumped(angle: Any) -> Any:
        values = np.sin(angle)
        values[800] += 0.01  # 40 deg of the second revolution
        values[810] -= 0.03
        return values

    a, b = pair(tmp_path, bumped)
    found = loomfmu.compare(a, b)
    (one,) = found.differences
    assert not found and not found.changes and one.signal == "belt.x"
    assert (one.first.revolution, round(math.degrees(one.first.angle), 6)) == (2, 40.0)
    assert one.first.time == pytest.approx(800 / 720 * 60.0 / RPM, rel=1e-12)
    assert one.values[1] - one.values[0] == pytest.approx(0.01, rel=1e-9)
    assert (one.largest, round(math.degrees(one.at.angle), 6)) == (pytest.approx(0.03), 45.0)
    assert one.relative == pytest.approx(0.03, rel=1e-4) and one.scale == pytest.approx(1.0)
    for equal in ({"tolerance": 0.0301}, {"absolute": {"belt.?": "31 mm"}}, {"ignore": ["belt.x"]}):
        assert loomfmu.compare(a, b, **equal)
    assert not loomfmu.compare(a, b, absolute={"belt.x": "29 mm"})
    with pytest.raises(LoomfmuError, match=r"ignore = \['\*'\] leaves out all signals"):
        loomfmu.compare(a, b, ignore=["*"])


@pytest.mark.parametrize("turns", [2.0, 0.0])  # 1441 samples, or one
def test_the_first_sample_counts(tmp_path: Path, turns: float) -> None:
    def begun(angle: Any) -> Any:
        return np.sin(angle) + 0.01 * (angle == 0.0)

    paths = trace(tmp_path / "a.h5", turns=turns), trace(tmp_path / "b.h5", begun, turns=turns)
    (change,) = loomfmu.compare(*paths, over="time").differences
    assert change.signal == "belt.x" and change.largest == pytest.approx(0.01)


def test_a_value_that_one_trace_lacks_is_a_difference_and_one_that_both_lack_is_not(tmp_path: Path) -> None:
    def lacking(angle: Any) -> Any:
        return np.where(angle > 7.0, np.nan, np.sin(angle))

    assert loomfmu.compare(trace(tmp_path / "a.h5", lacking), trace(tmp_path / "b.h5", lacking))
    found = loomfmu.compare(tmp_path / "a.h5", trace(tmp_path / "c.h5"), tolerance=1.0)
    assert found.differences[0].largest == math.inf
    assert "no value" in repr(found)


def test_an_instance_that_one_trace_lacks_is_one_change(tmp_path: Path) -> None:
    """Not one for each of its values and signals."""
    a, b = pair(tmp_path)
    with h5py.File(b, "r+") as file:
        file.move("belt", "belt_2")
    found = loomfmu.compare(a, b)
    assert [change.row for change in found.changes if change.what != "claim"] == [
        ("instance", "belt", "recorded", "missing"),
        ("instance", "belt_2", "missing", "recorded"),
    ]
    assert "2 instances in one trace only" in found.summary


def test_signals_claims_values_and_lengths_that_changed(tmp_path: Path) -> None:
    a, b = pair(tmp_path, more=True, worst=-0.5, clearance=5e-4, turns=1.5)
    changes = {change.what: change for change in loomfmu.compare(a, b).changes}
    assert changes["signal"].row == ("signal", "belt.y", "missing", "recorded")
    assert changes["claim"].row == ("claim", "x stays", "holds, 0.5 m, bound 0 m", "FAILS, -0.5 m, bound 0 m")
    assert changes["value"].row == ("value", "belt.guide_clearance", "0.3 mm", "0.5 mm")
    assert changes["run"].row == ("run", "shaft angle", "0 to 720 deg", "0 to 540 deg")


def judged(path: Path, *verdicts: tuple[str, str, float]) -> Path:
    """A trace of two signals with verdicts on claims: text, signal, worst value."""
    still = {"belt.x": np.zeros(2), "belt.y": np.zeros(2)}
    return made(path, still, angle=np.arange(2.0), verdicts=[verdict(*each) for each in verdicts]).path


def test_a_claim_whose_worst_frame_changes_is_listed_once(tmp_path: Path) -> None:
    text = "room: the shed is open for the rapier head"
    frames = ("2 |heald_1.warp_height|", "2 |heald_2.warp_height|")
    a, b, near = (
        judged(tmp_path / f"{place}.h5", (text, frames[place > 0], worst))
        for place, worst in enumerate((0.017, -0.016, 0.01701))
    )
    (change,) = loomfmu.compare(a, b).changes
    assert change.row == (
        "claim",
        text,
        "holds (2 |heald_1.warp_height|), 0.017 m, bound 0 m",
        "FAILS (2 |heald_2.warp_height|), -0.016 m, bound 0 m",
    )
    assert loomfmu.compare(a, near, tolerance=1e-3)  # which frame it is is not a value of its own


def test_long_names_keep_the_values_of_both_traces_apart(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    text = "they pass each other slowly enough: relative speed of the heads during the transfer"
    a, b = (
        str(judged(tmp_path / f"a_name_of_some_length_{place}.h5", (text, "belt.x", worst)))
        for place, worst in enumerate((0.017, -0.016))
    )
    assert cli.main(["compare", a, b]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert f"A: {a}, B: {b}" in lines
    place = lines.index("claim they pass each other slowly enough: relative speed of the heads during the")
    assert lines[place + 1 : place + 4] == [
        "  transfer",
        "  A: holds, 0.017 m, bound 0 m",
        "  B: FAILS, -0.016 m, bound 0 m",
    ]


def test_claims_of_one_text_belong_together_by_their_signals(tmp_path: Path) -> None:
    both, swapped, x, y = (
        judged(tmp_path / f"{names}.h5", *(("highest value", f"belt.{name}", 1.0) for name in names))
        for names in ("xy", "yx", "x", "y")
    )
    assert loomfmu.compare(both, swapped)
    (change,) = loomfmu.compare(both, y).changes
    assert change.row == ("claim", "highest value", "holds, 1 m, bound 0 m", "missing")
    (change,) = loomfmu.compare(y, x).changes
    assert change.row[2:] == ("holds (belt.y), 1 m, bound 0 m", "holds (belt.x), 1 m, bound 0 m")


class Counting(str):
    """The text of a claim that counts how often it is compared."""

    compared = 0
    __hash__ = str.__hash__

    def __eq__(self, other: object) -> bool:
        Counting.compared += 1
        return str.__eq__(self, other)


def test_many_claims_of_other_names_are_not_compared_each_with_each() -> None:
    first, second = (
        [SimpleNamespace(claim=Counting(f"{run} {number}"), signal="a.b") for number in range(300)]
        for run in "xy"
    )
    Counting.compared = 0
    pairs = list(comparing.paired(first, second))
    assert pairs == [*((one, None) for one in first), *((None, other) for other in second)]
    assert Counting.compared < 10 * 300


def test_causes_are_listed_first_and_few_signals(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The value that was set, before those that follow from it; then claims; then the ten worst signals."""
    paths = []
    angle = np.linspace(0.0, 2.0 * math.pi, 721)
    for number, stretch in enumerate((1.0, 1.1)):
        signals = {
            f"weft.x{each}": np.sin(angle) * (1.0 + number * 0.01 * (each + 1.0)) for each in range(12)
        }
        groups = {
            name: {"fmu": fmu, "speed": SPEED * stretch, "parameter_units": '{"speed": "rad/s"}'}
            for name, fmu in (("belt", "BeltMonitor"), ("shaft", "MainShaft"), ("weft", "WeftInsertion"))
        }
        about: dict[str, Any] = {"attributes": {"set": '{"shaft.speed": "660rpm"}' if number else "{}"}}
        about |= {"groups": groups, "verdicts": [verdict("x stays", "weft.x1", stretch)]}
        along = {"time": angle / SPEED, "angle": angle}
        paths.append(made(tmp_path / f"{number}.h5", signals, **along, **about).path)
    found = loomfmu.compare(*paths)
    assert [each.name for each in found.changes] == ["shaft.speed", "belt.speed", "weft.speed", "x stays"]
    assert found.changes[0].row == ("value", "shaft.speed", "600 rev/min", "660 rev/min")
    assert found.summary.endswith("3 values, 1 claim and 12 of 12 signals")
    assert [each.signal for each in found.differences] == [f"weft.x{each}" for each in range(11, -1, -1)]
    assert cli.main(["compare", *map(str, paths)]) == 1
    few = capsys.readouterr().out
    assert few.index("shaft.speed") < few.index("x stays") < few.index("signal weft.x11")
    assert "signal weft.x2\n" in few and "signal weft.x1\n" not in few
    assert "2 more signals with smaller relative differences; loomfmu compare --all lists all" in few
    assert cli.main(["compare", *map(str, paths), "--all"]) == 1
    assert "signal weft.x0\n" in capsys.readouterr().out


def test_a_whole_number_may_jump_at_a_sample_in_one_trace_and_before_the_next_in_the_other(
    tmp_path: Path,
) -> None:
    rows, angle = np.arange(21), np.linspace(0.0, 2.0 * math.pi, 21)
    a, b, later, pulse, never = (
        made(
            tmp_path / f"{begins}_{ends}.h5",
            {"dobby.pick": ((rows >= begins) & (rows < ends)).astype(int)},
            time=angle / SPEED,
            angle=angle,
        )
        for begins, ends in ((10, 99), (11, 99), (12, 99), (10, 11), (99, 99))
    )
    for one, other, equal in ((a, b, True), (a, later, False), (pulse, never, False)):
        assert bool(loomfmu.compare(one, other)) is bool(loomfmu.compare(other, one)) is equal
    assert not loomfmu.compare(a, b, tolerance=0.0)


def test_units_are_converted_or_do_not_fit(tmp_path: Path) -> None:
    a, b = pair(tmp_path, lambda angle: 1e3 * np.sin(angle), unit="mm")
    assert loomfmu.compare(a, b)
    found = loomfmu.compare(a, trace(tmp_path / "c.h5", unit="N"))
    assert [change.row for change in found.changes] == [("unit", "belt.x", "m", "N")]


def test_half_the_step_is_compared_without_interpolation(tmp_path: Path) -> None:
    found = loomfmu.compare(*pair(tmp_path, steps=1440), tolerance=1e-12)
    assert found and found.how.endswith(f"at the 1441 samples of {tmp_path}/a.h5")


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(("unit", "factor"), [("m", 1.0), ("mm", 1e3)])
def test_other_grids_are_interpolated_and_refused_where_that_does_not_tell(
    tmp_path: Path, unit: str, factor: float, turned: bool
) -> None:
    def compared(shift: float, **options: Any) -> Any:
        b = trace(tmp_path / "b.h5", lambda angle: np.sin(angle) + shift, steps=1000)
        return loomfmu.compare(*((b, a) if turned else (a, b)), **options)

    a = trace(tmp_path / "a.h5", lambda angle: factor * np.sin(angle), unit=unit)
    with pytest.raises(LoomfmuError, match=r"compared that closely.*allow a tolerance of") as refused:
        compared(0.0)
    needed = float(str(refused.value).rpartition(" ")[2])
    # the line between samples of sin is off by h^2 / 8
    assert (2.0 * math.pi / 1000) ** 2 / 8.0 < needed < (2.0 * math.pi / 1000) ** 2
    found = compared(0.0, tolerance=needed)
    assert found and "b.h5 is interpolated at" in found.how
    # and the line's error
    largest = compared(1e-3).differences[0].largest
    assert largest == pytest.approx(1e-3 * (1.0 if turned else factor), rel=0.01)


def test_looms_of_other_speeds_are_compared_by_angle_or_by_time(tmp_path: Path) -> None:
    a, b = pair(tmp_path, speed=1.1 * SPEED)
    assert [each.signal for each in loomfmu.compare(a, b).differences] == ["time"]
    by_time = {each.signal for each in loomfmu.compare(a, b, over="time").differences}
    assert {"shaft_angle", "belt.x"} <= by_time


def test_of_several_that_differ_first_the_shaft_is_named(tmp_path: Path) -> None:
    """The relatively largest difference is an effect of it; their order in the file is alphabetical."""
    wires = json.dumps({"belt.y": "weft.x", "weft.y": "shaft.x", "belt.z": "shaft.x"})
    angle = np.linspace(0.0, 2.0 * math.pi, 721)
    traces = []
    for number in (0, 1):
        larger = {"belt": 0.3, "shaft": 0.1, "weft": 0.2}
        signals = {f"{name}.x": np.cos(angle) * (1.0 + number * by) for name, by in larger.items()}
        path = tmp_path / f"{number}.h5"
        traces.append(made(path, signals, time=angle / SPEED, angle=angle, attributes={"wires": wires}))
    found = loomfmu.compare(*traces)
    assert [each.signal for each in found.differences] == ["belt.x", "weft.x", "shaft.x"]
    assert found.earliest is not None and found.earliest.signal == "shaft.x"
    assert "first to differ: shaft.x at 0 s" in repr(found)


@pytest.mark.parametrize(
    ("second", "tolerance", "said"),
    [
        ("a.h5", "0.1 mm", r"tolerance = '0\.1 mm': .*does not fit.*; give a share such as \"0\.1 %\""),
        ("a.h5", "much", r"tolerance = 'much': .* is not a quantity"),
        (5, 1e-9, "trace = 5 is not a path"),
    ],
)
def test_what_cannot_be_compared_is_refused_in_one_line(
    tmp_path: Path, second: Any, tolerance: Any, said: str
) -> None:
    first = trace(tmp_path / "a.h5")
    with pytest.raises(LoomfmuError, match=said):
        loomfmu.compare(first, first if second == "a.h5" else second, tolerance=tolerance)
    assert loomfmu.compare(first, first, tolerance="1 %").equal


def test_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    a, b = map(str, pair(tmp_path, lambda angle: 1.001 * np.sin(angle)))
    assert cli.main(["compare", a, a]) == 0
    assert cli.main(["compare", a, b]) == 1
    assert "1 of 2 signals" in capsys.readouterr().out
    given = {"0.1%": 0, "belt.x=1.1mm": 0, "belt.x=1N": 2, "nothing=1": 2, "5apples": 2}
    for tolerance, status in given.items():
        assert cli.main(["compare", a, b, "--tolerance", tolerance]) == status
    assert "--tolerance 5apples: unknown unit 'apples'" in capsys.readouterr().err
    assert cli.main(["compare", a, str(tmp_path / "none.h5")]) == 2
    capsys.readouterr()
    assert cli.main(["compare", a, a, "--report", "x.pdf"]) == 2  # before anything is printed
    said = capsys.readouterr()
    assert said.out == "" and "x.pdf: a report of loomfmu ends in .html" in said.err
    page = tmp_path / "page.html"
    assert cli.main(["compare", a, b, "--report", str(page)]) == 1
    text = page.read_text()
    assert text.startswith("<!DOCTYPE html>")
    first, _rest = text.partition('<section id="comparison"')[2].split("</section>", 1)
    assert (
        "1 of 2 signals" in first and "first to differ: belt.x" in first and ">largest difference<" in first
    )
    assert "a.h5: the claim holds" in text and "b.h5: the claim holds" in text


def test_memory_holds_a_few_columns_whatever_the_number_of_signals(tmp_path: Path) -> None:
    steps, count = 100_000, 20
    angle = np.linspace(0.0, 700.0, steps)
    for name in ("a.h5", "b.h5"):
        signals = {f"belt.x{number}": np.sin(angle) for number in range(count)}
        made(tmp_path / name, signals, time=angle, angle=angle)
    tracemalloc.start()
    assert loomfmu.compare(tmp_path / "a.h5", tmp_path / "b.h5")
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 2 * count * 8 * steps / 1.5  # all columns of both would be 2 * count


def test_a_notebook_shows_it_escaped(tmp_path: Path) -> None:
    a, b = trace(tmp_path / "a<b>.h5"), trace(tmp_path / "b.h5", np.cos)
    text = loomfmu.compare(a, b)._repr_html_()
    assert "a&lt;b&gt;.h5" in text and "<b>" not in text
