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

import loomfmu
from loomfmu import LoomfmuError, cli
from loomfmu.traces import Channel, TraceWriter, Verdict, comparing

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
    channels = [
        Channel("belt", "x", unit, unit, "X", 0),
        Channel("belt", "pick", "1", "1", "Pick", 0, real=False),
    ]
    channels += [Channel("belt", "y", "m", "m", "Y", 0)] if more else []
    about = {
        "belt": {
            "fmu": "BeltMonitor",
            "guide_clearance": clearance,
            "parameter_units": '{"guide_clearance": "m"}',
        }
    }
    writer = TraceWriter(path, {"title": "made"}, channels, about)
    picks = np.floor(angle / (2.0 * math.pi) + 1e-9).astype("i4")
    writer.append(angle / speed, angle, values(angle)[:, None], picks[:, None])
    verdict = Verdict("x stays", "belt.x", worst > 0.0, 0.0, worst, "m", "m", 0.1, 1.0, 1, sense=1)
    writer.complete([verdict.as_dict()])
    return path


def test_equal_traces_are_equal_to_the_last_bit(tmp_path: Path) -> None:
    found = loomfmu.compare(trace(tmp_path / "a.h5"), trace(tmp_path / "b.h5"), tolerance=0.0)
    assert found and found.equal and found.compared == 2
    assert "exactly equal" in found.summary and found.how == "compared at equal shaft angles, at 1441 samples"


def test_a_difference_is_found_where_it_begins_and_where_it_is_largest(tmp_path: Path) -> None:
    def bumped(angle: Any) -> Any:
        values = np.sin(angle)
        values[800] += 0.01  # 40 deg of the second revolution
        values[810] -= 0.03
        return values

    found = loomfmu.compare(trace(tmp_path / "a.h5"), trace(tmp_path / "b.h5", bumped))
    (one,) = found.differences
    assert not found and not found.changes and one.signal == "belt.x"
    assert (one.first.revolution, round(math.degrees(one.first.angle), 6)) == (2, 40.0)
    assert one.first.time == pytest.approx(800 / 720 * 60.0 / RPM, rel=1e-12)
    assert one.values[1] - one.values[0] == pytest.approx(0.01, rel=1e-9)
    assert (one.largest, round(math.degrees(one.at.angle), 6)) == (pytest.approx(0.03), 45.0)
    assert one.relative == pytest.approx(0.03, rel=1e-4) and one.scale == pytest.approx(1.0)
    assert loomfmu.compare(tmp_path / "a.h5", tmp_path / "b.h5", tolerance=0.0301)
    assert loomfmu.compare(tmp_path / "a.h5", tmp_path / "b.h5", absolute={"belt.?": "31 mm"})
    assert loomfmu.compare(tmp_path / "a.h5", tmp_path / "b.h5", ignore=["belt.x"])
    assert not loomfmu.compare(tmp_path / "a.h5", tmp_path / "b.h5", absolute={"belt.x": "29 mm"})
    with pytest.raises(LoomfmuError, match=r"ignore = \['\*'\] leaves out all signals"):
        loomfmu.compare(tmp_path / "a.h5", tmp_path / "b.h5", ignore=["*"])


def test_a_value_that_one_trace_lacks_is_a_difference_and_one_that_both_lack_is_not(tmp_path: Path) -> None:
    def lacking(angle: Any) -> Any:
        return np.where(angle > 7.0, np.nan, np.sin(angle))

    assert loomfmu.compare(trace(tmp_path / "a.h5", lacking), trace(tmp_path / "b.h5", lacking))
    found = loomfmu.compare(tmp_path / "a.h5", trace(tmp_path / "c.h5"), tolerance=1.0)
    assert found.differences[0].largest == math.inf
    assert "no value" in repr(found)


def test_an_instance_that_one_trace_lacks_is_one_change(tmp_path: Path) -> None:
    """Not one for each of its values and signals."""
    for name in ("a.h5", "b.h5"):
        trace(tmp_path / name)
    with h5py.File(tmp_path / "b.h5", "r+") as file:
        file.move("belt", "belt_2")
    found = loomfmu.compare(tmp_path / "a.h5", tmp_path / "b.h5")
    assert [change.row for change in found.changes if change.what != "claim"] == [
        ("instance", "belt", "recorded", "missing"),
        ("instance", "belt_2", "missing", "recorded"),
    ]
    assert "2 instances in one trace only" in found.summary


def test_signals_claims_values_and_lengths_that_changed(tmp_path: Path) -> None:
    a = trace(tmp_path / "a.h5")
    b = trace(tmp_path / "b.h5", more=True, worst=-0.5, clearance=5e-4, turns=1.5)
    changes = {change.what: change for change in loomfmu.compare(a, b).changes}
    assert changes["signal"].row == ("signal", "belt.y", "missing", "recorded")
    assert changes["claim"].row == ("claim", "x stays", "holds, 0.5 m, bound 0 m", "FAILS, -0.5 m, bound 0 m")
    assert changes["value"].row == ("value", "belt.guide_clearance", "0.3 mm", "0.5 mm")
    assert changes["run"].row == ("run", "shaft angle", "0 to 720 deg", "0 to 540 deg")


def judged(path: Path, *verdicts: tuple[str, str, float]) -> Path:
    """A trace of two signals with verdicts on claims: text, signal, worst value."""
    channels = [Channel("belt", name, "m", "m", name, place) for place, name in enumerate("xy")]
    writer = TraceWriter(path, {"title": "made"}, channels, {})
    writer.append(np.arange(2.0), np.arange(2.0), np.zeros((2, 2)), np.zeros((2, 0), dtype="i4"))
    found = (
        Verdict(*each[:2], each[2] > 0.0, 0.0, each[2], "m", "m", 0.1, 1.0, 1, sense=1) for each in verdicts
    )
    writer.complete([each.as_dict() for each in found])
    return path


def test_a_claim_whose_worst_frame_changes_is_listed_once(tmp_path: Path) -> None:
    text, frames = (
        "room: the shed is open for the rapier head",
        ("2 |heald_1.warp_height|", "2 |heald_2.warp_height|"),
    )
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
    both = judged(tmp_path / "both.h5", ("highest value", "belt.x", 1.0), ("highest value", "belt.y", 1.0))
    swapped = judged(
        tmp_path / "swapped.h5", ("highest value", "belt.y", 1.0), ("highest value", "belt.x", 1.0)
    )
    assert loomfmu.compare(both, swapped)
    one = judged(tmp_path / "one.h5", ("highest value", "belt.y", 1.0))
    (change,) = loomfmu.compare(both, one).changes
    assert change.row == ("claim", "highest value", "holds, 1 m, bound 0 m", "missing")
    (change,) = loomfmu.compare(one, judged(tmp_path / "x.h5", ("highest value", "belt.x", 1.0))).changes
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
    pairs = list(comparing._paired(first, second))
    assert pairs == [*((one, None) for one in first), *((None, other) for other in second)]
    assert Counting.compared < 10 * 300


def test_causes_are_listed_first_and_few_signals(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The value that was set, before those that follow from it; then claims; then the ten worst signals."""
    paths = []
    for number, stretch in enumerate((1.0, 1.1)):
        channels = [Channel("weft", f"x{each}", "m", "m", "X", each) for each in range(12)]
        about = {
            name: {"fmu": fmu, "speed": SPEED * stretch, "parameter_units": '{"speed": "rad/s"}'}
            for name, fmu in (("belt", "BeltMonitor"), ("shaft", "MainShaft"), ("weft", "WeftInsertion"))
        }
        paths.append(tmp_path / f"{number}.h5")
        attributes = {"title": "made", "set": '{"shaft.speed": "660rpm"}' if number else "{}"}
        writer = TraceWriter(paths[-1], attributes, channels, about)
        angle = np.linspace(0.0, 2.0 * math.pi, 721)
        columns = np.sin(angle)[:, None] * (1.0 + number * 0.01 * np.arange(1.0, 13.0))
        writer.append(angle / SPEED, angle, columns, np.zeros((721, 0), dtype="i4"))
        verdict = Verdict("x stays", "weft.x1", True, 0.0, stretch, "m", "m", 0.1, 1.0, 1, sense=1)
        writer.complete([verdict.as_dict()])
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
    def counted(path: Path, begins: int, ends: int) -> Path:
        writer = TraceWriter(
            path, {"title": "count"}, [Channel("dobby", "pick", "1", "1", "Pick", 0, real=False)], {}
        )
        angle = np.linspace(0.0, 2.0 * math.pi, 21)
        rows = np.arange(21)
        picks = ((rows >= begins) & (rows < ends)).astype("i4")
        writer.append(angle / SPEED, angle, np.zeros((21, 0)), picks[:, None])
        writer.complete([])
        return path

    a, b = counted(tmp_path / "a.h5", 10, 99), counted(tmp_path / "b.h5", 11, 99)
    assert loomfmu.compare(a, b) and loomfmu.compare(b, a)
    assert not loomfmu.compare(a, b, tolerance=0.0)
    later = counted(tmp_path / "later.h5", 12, 99)
    assert not loomfmu.compare(a, later) and not loomfmu.compare(later, a)
    pulse, never = counted(tmp_path / "pulse.h5", 10, 11), counted(tmp_path / "never.h5", 99, 99)
    assert not loomfmu.compare(pulse, never) and not loomfmu.compare(never, pulse)


def test_units_are_converted_or_do_not_fit(tmp_path: Path) -> None:
    a, b = trace(tmp_path / "a.h5"), trace(tmp_path / "b.h5", lambda angle: 1e3 * np.sin(angle), unit="mm")
    assert loomfmu.compare(a, b)
    found = loomfmu.compare(a, trace(tmp_path / "c.h5", unit="N"))
    assert [change.row for change in found.changes] == [("unit", "belt.x", "m", "N")]


def test_half_the_step_is_compared_without_interpolation(tmp_path: Path) -> None:
    found = loomfmu.compare(trace(tmp_path / "a.h5"), trace(tmp_path / "b.h5", steps=1440), tolerance=1e-12)
    assert found and found.how.endswith(f"at the 1441 samples of {tmp_path}/a.h5")


def test_other_grids_are_interpolated_and_refused_where_that_does_not_tell(tmp_path: Path) -> None:
    a, b = trace(tmp_path / "a.h5"), trace(tmp_path / "b.h5", steps=1000)
    with pytest.raises(
        LoomfmuError, match=r"cannot be compared that closely.*allow a tolerance of"
    ) as refused:
        loomfmu.compare(a, b)
    needed = float(str(refused.value).rpartition(" ")[2])
    # the line between samples of sin is off by h^2 / 8
    assert (2.0 * math.pi / 1000) ** 2 / 8.0 < needed < (2.0 * math.pi / 1000) ** 2
    found = loomfmu.compare(a, b, tolerance=needed)
    assert found and "b.h5 is interpolated at" in found.how
    off = trace(tmp_path / "c.h5", lambda angle: np.sin(angle) + 1e-3, steps=1000)
    assert loomfmu.compare(a, off).differences[0].largest == pytest.approx(
        1e-3, rel=0.01
    )  # and the line's error


def test_looms_of_other_speeds_are_compared_by_angle_or_by_time(tmp_path: Path) -> None:
    a, b = trace(tmp_path / "a.h5"), trace(tmp_path / "b.h5", speed=1.1 * SPEED)
    assert [each.signal for each in loomfmu.compare(a, b).differences] == ["time"]
    by_time = {each.signal for each in loomfmu.compare(a, b, over="time").differences}
    assert {"shaft_angle", "belt.x"} <= by_time


def test_of_several_that_differ_first_the_shaft_is_named(tmp_path: Path) -> None:
    """The relatively largest difference is an effect of it; their order in the file is alphabetical."""
    paths = []
    for number in (0, 1):
        channels = [
            Channel(name, "x", "m", "m", "X", at) for at, name in enumerate(("belt", "shaft", "weft"))
        ]
        wires = {"belt.y": "weft.x", "weft.y": "shaft.x", "belt.z": "shaft.x"}
        paths.append(tmp_path / f"{number}.h5")
        writer = TraceWriter(paths[-1], {"title": "made", "wires": json.dumps(wires)}, channels, {})
        angle = np.linspace(0.0, 2.0 * math.pi, 721)
        columns = np.cos(angle)[:, None] * (1.0 + number * np.array([0.3, 0.1, 0.2]))
        writer.append(angle / SPEED, angle, columns, np.zeros((721, 0), dtype="i4"))
        writer.complete([])
    found = loomfmu.compare(*paths)
    assert [each.signal for each in found.differences] == ["belt.x", "weft.x", "shaft.x"]
    assert found.earliest is not None and found.earliest.signal == "shaft.x"
    assert "first to differ: shaft.x at 0 s" in repr(found)


def test_a_tolerance_that_cannot_be_read_names_its_option(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    a = str(trace(tmp_path / "a.h5"))
    assert cli.main(["compare", a, a, "--tolerance", "5apples"]) == 2
    assert "--tolerance 5apples: unknown unit 'apples'" in capsys.readouterr().err


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
    a, b = str(trace(tmp_path / "a.h5")), str(trace(tmp_path / "b.h5", lambda angle: 1.001 * np.sin(angle)))
    assert cli.main(["compare", a, a]) == 0
    assert cli.main(["compare", a, b]) == 1
    assert "1 of 2 signals" in capsys.readouterr().out
    assert cli.main(["compare", a, b, "--tolerance", "0.1%"]) == 0
    assert cli.main(["compare", a, b, "--tolerance", "belt.x=1.1mm"]) == 0
    assert cli.main(["compare", a, b, "--tolerance", "belt.x=1N"]) == 2
    assert cli.main(["compare", a, b, "--tolerance", "nothing=1"]) == 2
    assert cli.main(["compare", a, str(tmp_path / "none.h5")]) == 2
    page = tmp_path / "page.html"
    assert cli.main(["compare", a, b, "--report", str(page)]) == 1
    text = page.read_text()
    assert text.startswith("<!DOCTYPE html>")
    first, rest = text.partition('<section id="comparison"')[2].split("</section>", 1)
    assert (
        "1 of 2 signals" in first and "first to differ: belt.x" in first and ">largest difference<" in first
    )
    assert "a.h5: The claim holds" in rest and "b.h5: The claim holds" in rest


def test_memory_holds_a_few_columns_whatever_the_number_of_signals(tmp_path: Path) -> None:
    steps, count = 100_000, 20
    channels = [Channel("belt", f"x{number}", "m", "m", "X", number) for number in range(count)]
    for name in ("a.h5", "b.h5"):
        writer = TraceWriter(tmp_path / name, {"title": "long"}, channels, {})
        angle = np.linspace(0.0, 700.0, steps)
        writer.append(angle, angle, np.tile(np.sin(angle)[:, None], count), np.zeros((steps, 0), dtype="i4"))
        writer.complete([])
    tracemalloc.start()
    assert loomfmu.compare(tmp_path / "a.h5", tmp_path / "b.h5")
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 2 * count * 8 * steps / 1.5  # all columns of both would be 2 * count


def test_a_notebook_shows_it_escaped(tmp_path: Path) -> None:
    a, b = trace(tmp_path / "a<b>.h5"), trace(tmp_path / "b.h5", np.cos)
    text = loomfmu.compare(a, b)._repr_html_()
    assert "a&lt;b&gt;.h5" in text and "<b>" not in text
    with h5py.File(a) as file:
        assert file["belt"].attrs["signal"] == "x"


def test_a_page_that_cannot_be_written_is_refused_before_anything_is_printed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = str(trace(tmp_path / "a.h5"))
    assert cli.main(["compare", path, path, "--report", "x.pdf"]) == 2
    said = capsys.readouterr()
    assert said.out == "" and "x.pdf: a report of loomfmu ends in .html" in said.err
