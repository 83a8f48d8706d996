"""Plots of signals: no extreme is lost, they follow the page's cursor, and they are written as pictures."""

import hashlib
import os
import subprocess
import sys
import tracemalloc
from base64 import b64decode
from collections.abc import Callable
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import matplotlib
import numpy as np
import pytest
from browser import NARROW, until
from made_traces import made

from loomfmu import LoomfmuError
from loomfmu.cli import main
from loomfmu.report import pictures, plots
from loomfmu.report.section import Subject
from loomfmu.report.templates import text
from loomfmu.traces import Trace

Open = Callable[..., Any]
Written = Callable[..., Path]
SIMS = Path(__file__).parents[2] / "sims"


def recorded(path: Path, reals: np.ndarray, counts: np.ndarray) -> Trace:
    """A trace of reals r0, r1, ... [mm] and a count, over time alone."""
    signals = {f"a.r{k}": column for k, column in enumerate(reals.T)} | {"a.count": counts.astype(int)}
    return made(path, signals, display="mm", groups={"a": {"fmu": "A"}})


def unpacked(packed: str) -> np.ndarray:
    return np.frombuffer(b64decode(packed), "<f4")


# ---- thinned


@pytest.mark.parametrize("points", [4, 200, 5000])
def test_every_bucket_keeps_its_extremes(tmp_path: Path, points: int) -> None:
    random = np.random.default_rng(1)
    values = random.normal(size=(100_001, 1))
    values[70_000] = 50.0  # one sample
    found = plots.outline(recorded(tmp_path / "r.h5", values, np.zeros(100_001)), "a.r0", points)
    assert len(found.places) <= points + 2
    np.testing.assert_array_equal(found.values, values[found.places, 0])
    assert (found.lowest, found.highest, found.last) == (values.min(), 50.0, values[-1, 0])
    size = -(-100_001 // max(1, points // 2 - 1))
    for start in range(0, 100_001, size):
        inside = values[start : start + size, 0]
        kept = found.values[(found.places >= start) & (found.places < start + size)]
        assert (kept.min(), kept.max()) == (inside.min(), inside.max())


def test_a_count_changes_where_it_did_and_a_gap_stays(tmp_path: Path) -> None:
    reals = np.arange(9000.0)[:, None]
    reals[3000:6000] = np.nan
    trace = recorded(tmp_path / "c.h5", reals, np.arange(9000) >= 4500)
    count, real = (plots.outline(trace, f"a.{name}", 18_002) for name in ("count", "r0"))
    assert count.places.tolist() == [0, 4499, 4500, 8999] and not count.continuous
    assert np.isnan(real.values).sum() == 2 and (real.lowest, real.highest) == (0.0, 8999.0)


def test_values_come_in_the_unit_that_people_read(tmp_path: Path) -> None:
    trace = recorded(tmp_path / "u.h5", np.array([[0.25], [np.inf]]), np.zeros(2))
    made = plots.section(Subject([trace]))
    assert made is not None
    signal = made.data["signals"]["a.r0"]
    assert signal["unit"] == "mm"
    np.testing.assert_array_equal(unpacked(signal["curves"][0][1]), [250.0, np.nan])


@pytest.mark.slow
def test_a_long_trace_is_read_in_bounded_memory(tmp_path: Path) -> None:
    wave = np.sin(np.arange(1_000_000) * 0.01)
    trace = recorded(tmp_path / "long.h5", np.repeat(wave[:, None], 12, axis=1), np.zeros(1_000_000))
    tracemalloc.start()
    made = plots.section(Subject([trace]))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert made is not None
    # time and shaft angle are 16 MB, twelve signals would be 96 MB more; blocks take a few MB
    assert peak < 32e6


# ---- on the page


@pytest.fixture
def page(demo: Trace, fast: Trace, written: Written, opened: Open) -> Any:
    return opened(written(demo, fast))


def line(page: Any, name: str) -> float:
    """Where the cursor's line is in a plot [px]."""
    found = page.locator(f"figure[data-name='{name}'] .cursor-line").evaluate("e => e.style.transform")
    return float(found.removeprefix("translateX(").removesuffix("px)"))


def test_signals_of_claims_are_shown_first(page: Any, demo: Trace) -> None:
    names = page.locator("#plots figure").evaluate_all("all => all.map(each => each.dataset.name)")
    assert names[:2] == ["belt.margin", "belt.speed_limit"]  # not their extremes so far
    assert names[2:] == list(dict.fromkeys(verdict.signal for verdict in demo.verdicts[2:]))


def test_the_value_at_a_claim_is_that_of_the_claim(page: Any, fast: Trace) -> None:
    """The lowest margin lies between two samples, and the line between these is above it."""
    page.locator("#claims .place").nth(1).click()
    shown = page.inner_text("figure[data-name='belt.margin'] output").split(" | ")
    assert float(shown[1]) == pytest.approx(fast.verdicts[0].worst, abs=5e-6)  # five digits are shown


def test_plots_and_cursor_move_one_another(page: Any, demo: Trace) -> None:
    plot = page.locator("figure[data-name='belt.margin'] .u-over")
    box = plot.bounding_box()
    page.evaluate("loomfmu.seek(3 * Math.PI)")
    assert line(page, "belt.margin") == pytest.approx(box["width"] / 2, abs=1.0)  # pixels
    plot.click(position={"x": box["width"] / 3, "y": 30})
    # 6 pi over some 1000 pixels: a click is right to a pixel
    assert page.evaluate("loomfmu.position") == pytest.approx(2 * np.pi, abs=0.03)
    value = page.inner_text("figure[data-name='belt.margin'] output").split(" | ")[0]
    # five digits are shown
    assert float(value) == pytest.approx(
        demo["belt.margin"][np.searchsorted(demo.shaft_angle, 2 * np.pi)], rel=1e-4
    )


def test_dragging_zooms_all_plots_and_leaves_the_cursor(page: Any) -> None:
    page.evaluate("document.getElementById('plots').scrollIntoView()")
    box = page.locator("figure[data-name='belt.margin'] .u-over").bounding_box()
    before, kept = line(page, "heald_1.lift"), page.evaluate("loomfmu.position")
    page.mouse.move(box["x"] + 5, box["y"] + 30)
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] / 3, box["y"] + 30, steps=3)
    page.mouse.up()
    until(page, lambda: line(page, "heald_1.lift") != before)
    assert page.evaluate("loomfmu.position") == kept
    page.get_by_role("button", name="Whole run").click()
    until(page, lambda: line(page, "heald_1.lift") == before)


def test_over_time_the_cursor_is_at_its_time(page: Any, demo: Trace, fast: Trace) -> None:
    page.get_by_label("time", exact=True).check()
    page.evaluate("loomfmu.seek(3 * Math.PI)")
    width = page.locator("figure[data-name='heald_1.lift'] .u-over").bounding_box()["width"]
    assert line(page, "heald_1.lift") == pytest.approx(width / 2, abs=1.0)
    shown = page.inner_text("figure[data-name='heald_1.lift'] output").split(" | ")
    at = fast.time[-1] / 2  # the trace that is shown in motion
    for trace, value in zip((demo, fast), shown, strict=True):
        expected = np.interp(at, trace.time, 1000.0 * trace["heald_1.lift"])
        assert float(value.removesuffix(" mm")) == pytest.approx(expected, abs=0.01)  # mm: five digits


def test_any_signal_is_found_and_chosen_by_keyboard(page: Any) -> None:
    page.locator("#plots-choice summary").press("Enter")
    page.locator("#plots-search").fill("rapier travel")
    boxes = page.locator("#plots-choice input[type=checkbox]:visible")
    until(page, lambda: boxes.count() == 1)
    boxes.press("Space")
    assert page.locator("figure[data-name='weft.travel'] canvas").count() == 1
    boxes.press("Space")
    assert page.locator("figure[data-name='weft.travel']").count() == 0


def test_several_traces_have_a_legend_and_numbers(page: Any, fast: Trace) -> None:
    assert page.inner_text("#plots-legend").split() == ["demo.h5", "fast.h5"]
    page.locator("#plots-choice summary").click()
    row = page.locator("tr[data-name='belt.lowest_margin']").nth(1)
    assert f"{fast['belt.lowest_margin'].min():.6g}" in row.inner_text()


def test_colours_follow_the_system(demo: Trace, written: Written, opened: Open) -> None:
    page = opened(written(demo), NARROW)
    canvas = page.locator("figure canvas").first
    light = canvas.evaluate("each => each.toDataURL()")
    page.emulate_media(color_scheme="dark")
    until(page, lambda: canvas.evaluate("each => each.toDataURL()") != light)
    page.emulate_media(color_scheme="light")
    until(page, lambda: canvas.evaluate("each => each.toDataURL()") == light)


def test_the_library_is_the_published_one() -> None:
    licence, _, script = text("uplot/uPlot.js").partition("*/\n")
    assert "Copyright (c) 2022 Leon Sorokin" in licence
    published = "19c8d4c6ad88929a79f4ae49d6f7161566dfd0ba3d15cc495e974f787eb78f1f"  # of uplot 1.6.32 on npm
    assert hashlib.sha256(script.encode()).hexdigest() == published


# ---- pictures


@pytest.mark.few(1)
@pytest.mark.parametrize("suffix", [".png", ".svg", ".pdf"])
def test_a_picture_is_written_and_replaced(copied: Path, suffix: str) -> None:
    output = copied.with_name(f"picture{suffix}")
    arguments = ["plot", str(copied), "belt.margin", "heald_1.lift", "--fold", "--output", str(output)]
    assert main(arguments) == 0
    first = output.read_bytes()
    if suffix == ".svg":
        ElementTree.fromstring(first)
    for command in (arguments, ["diagram", str(copied), "--output", str(output)]):
        output.write_bytes(first.replace(b"loomfmu", b"another"))
        assert main(command) == 2 and b"another" in output.read_bytes()
        assert main([*command, "--force"]) == 0
    assert main(arguments) == 0  # ours is replaced
    assert output.read_bytes()[:4] == first[:4]


@pytest.mark.few(1)
@pytest.mark.parametrize(("command", "signals"), [("plot", ["belt.margin"]), ("diagram", [])])
def test_a_matplotlibrc_changes_no_picture(copied: Path, command: str, signals: list[str]) -> None:
    pictures = []
    for name, settings in (("plain", {}), ("styled", {"text.usetex": True, "axes.facecolor": "red"})):
        target = copied.with_name(f"{name}.png")
        with matplotlib.rc_context(settings):
            assert main([command, str(copied), *signals, "--output", str(target)]) == 0
        pictures.append(target.read_bytes())
    assert pictures[0] == pictures[1]


def test_a_backend_of_another_environment_is_not_asked_for(copied: Path, fast: Trace) -> None:
    """As a notebook of another environment sets it for every shell command."""
    arguments = ["plot", copied.name, str(fast.path), "belt.margin", "--over", "time"]
    environment = os.environ | {"MPLBACKEND": "module://matplotlib_inline.backend_inline"}
    command = [sys.executable, "-m", "loomfmu.cli", *arguments]
    done = subprocess.run(command, cwd=copied.parent, env=environment, capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (0, "written: demo_plot.png\n"), done.stderr  # beside its trace


def test_a_pattern_draws_all_signals_that_it_names(copied: Path) -> None:
    pictures = [copied.with_name(f"{name}.svg") for name in ("one", "other")]
    healds = [name for name in Trace(copied) if name.startswith("heald_") and name.endswith(".lift")]
    assert len(healds) > 1
    for output, names in zip(pictures, (["heald_*.lift"], healds), strict=True):
        assert main(["plot", str(copied), *names, "--output", str(output)]) == 0
    assert pictures[0].read_bytes() == pictures[1].read_bytes()


def test_a_range_shows_a_dip_beside_the_bound_of_its_claim(
    copied: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn: list[Any] = []
    monkeypatch.setattr(pictures, "save", lambda figure, path, *_more: (drawn.append(figure), path)[1])
    assert main(["plot", str(copied), "belt.margin", "--ylim", "0..0.5"]) == 0
    assert main(["plot", str(copied), "heald_1.lift", "--ylim", "0mm..20mm"]) == 0
    margin, lift = (each.axes[0] for each in drawn)
    assert main(["plot", str(copied), "belt.margin", "belt.speed_limit", "--revolution", "2"]) == 0
    margin_of_turn, limit = drawn.pop().axes
    assert margin_of_turn.get_xlim() == (0.0, 360.0)
    low, high = margin_of_turn.get_ylim()  # the margin goes up to 245
    assert low < 0.1 and 1.0 < high < 2.0
    assert "values go up to 24" in margin_of_turn.texts[0].get_text()
    assert np.isnan(limit.get_lines()[0].get_ydata()).any() and limit.get_ylim()[1] < 2000.0
    assert "no limit" in limit.get_legend_handles_labels()[1]
    assert margin.get_ylim() == (0.0, 0.5) and lift.get_ylim() == (0.0, 20.0)
    # of a claim on belt.lowest_margin, which is the extreme of this signal
    _curve, bound = margin.get_lines()
    assert bound.get_label() == "bound 0.1" and set(bound.get_ydata()) == {0.1}


def test_a_picture_of_two_traces_has_the_bounds_of_both(
    copied: Path, fast: Trace, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The bound of the first alone let the second seem to hold."""
    drawn: list[Any] = []
    monkeypatch.setattr(pictures, "save", lambda figure, path, *_more: (drawn.append(figure), path)[1])
    assert main(["plot", str(copied), str(fast.path), "belt.speed_limit", "belt.margin"]) == 0
    speeds, margins = ({each.get_label() for each in axes.get_lines()} for axes in drawn[0].axes)
    of = {f"bound 600 rev/min\nof {copied.name}", f"bound 700 rev/min\nof {fast.path.name}"}
    assert of <= speeds and "bound 0.1" in margins


def test_a_report_of_two_traces_has_the_bounds_of_both(demo: Trace, fast: Trace) -> None:
    """The bound of the worse one alone let the other seem to fail."""
    section = plots.section(Subject([demo, fast]))
    assert section and section.data
    speeds, margins = (
        section.data["signals"][f"belt.{each}"]["bounds"] for each in ("speed_limit", "margin")
    )
    of = {f"bound 600 rev/min of {demo.path.name}": True, f"bound 700 rev/min of {fast.path.name}": False}
    assert {each["text"]: each["holds"] for each in speeds} == of
    assert [each["text"] for each in margins] == ["bound 0.1", ""]  # said once


def test_a_legend_covers_no_curve(copied: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn: list[Any] = []
    monkeypatch.setattr(pictures, "save", lambda figure, path, *_more: (drawn.append(figure), path)[1])
    assert main(["plot", str(copied), "belt.margin", "heald_1.lift", "damper_1.carrier_lift"]) == 0
    drawn[0].draw_without_rendering()
    for axes in drawn[0].axes:
        assert axes.get_legend().get_window_extent().x0 >= axes.get_window_extent().x1


@pytest.mark.few(3)
@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["belt.marign"], "signal 'belt.marign' is not recorded; did you mean 'belt.margin'?"),
        (["nothing*"], "signal 'nothing*' is not recorded"),
        (["nothing.h5", "belt.margin"], "nothing.h5: there is no such file"),
        (["belt.margin", "--output", "x.gif"], "x.gif: '.gif' is not a suffix of a picture; use .svg, .png"),
        (["belt.margin", "--over", "time", "--fold"], "can be folded, not one over time"),
        (["belt.margin", "--output", "demo.h5"], "use .svg, .png or .pdf"),
        (["belt.margin", "--ylim", "1"], "ylim 1: the range is empty; write LOW..HIGH, such as 0..1 or"),
        (["belt.margin", "--ylim", "0mm..1mm"], "'0mm' is in mm, which does not fit a number without a unit"),
        (["belt.margin", "--ylim", "1000..2000"], "ylim: no value of belt.margin is within; they are "),
        (["belt.margin", "--revolution", "4"], "revolution = 4 is outside [1, 3] of"),
        (["belt.margin", "--revolution", "1", "--fold"], "leave it or --revolution out"),
        (
            ["belt.margin", "--from", "200", "--to", "90deg"],
            "200..90 deg is not a part of the axis, which",
        ),
        (["belt.margin", "--from", "3mm"], "--from 3mm: '3mm' is in mm, which does not fit rad"),
        (["belt.margin", "heald_1.lift", "--ylim", "0..1"], "are in different panels; plot them apart"),
    ],
)
def test_a_mistake_is_one_line(
    copied: Path, arguments: list[str], reason: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["plot", str(copied), *arguments]) == 2
    printed = capsys.readouterr().err.strip()
    assert reason in printed and "\n" not in printed


def test_axes_of_matplotlib_have_display_units(demo: Trace) -> None:
    from matplotlib.figure import Figure

    axes = demo.plot("heald_1.lift", "heald_2.lift", over="angle", axes=Figure().subplots())
    assert axes.get_xlabel() == "Shaft angle [deg]" and axes.get_ylabel() == "[mm]"
    one, other = axes.get_lines()
    assert one.get_linestyle() != other.get_linestyle()
    np.testing.assert_allclose(one.get_ydata(), 1000.0 * demo["heald_1.lift"], rtol=1e-15)  # one rounding
    np.testing.assert_array_equal(one.get_xdata(), np.degrees(demo.shaft_angle))


def test_a_folded_curve_stays_within_a_revolution(demo: Trace) -> None:
    from matplotlib.figure import Figure

    axes = demo.plot("weft.travel", fold=True, axes=Figure().subplots())
    along = axes.get_lines()[0].get_xdata()
    assert np.nanmin(along) == 0.0 and np.nanmax(along) == 360.0
    steps = np.diff(along)
    assert np.nanmin(steps) >= 0.0 and np.nanmax(steps) < 0.26  # samples are a quarter degree apart


def test_what_cannot_be_plotted_is_said(demo: Trace, tmp_path: Path) -> None:
    still = recorded(tmp_path / "still.h5", np.zeros((3, 1)), np.zeros(3))
    with pytest.raises(LoomfmuError, match="no shaft turns"):
        still.plot("a.r0", over="angle")
    with pytest.raises(LoomfmuError, match=r"heald_1\.lift is in mm and belt\.axial_force in N"):
        demo.plot("heald_1.lift", "belt.axial_force")
    with pytest.raises(LoomfmuError, match='choose "angle" or "time"'):
        demo.plot("heald_1.lift", over="speed")


def test_the_last_tick_is_that_of_the_end_of_the_run(yarn: Trace, written: Written, opened: Open) -> None:
    """Two revolutions are 719.9999999999999 deg by rounding."""
    assert np.degrees(yarn.shaft_angle[-1]) < 720.0
    page = opened(written(yarn), alone=True)
    page.add_init_script(
        "window.drawn = []; const { prototype } = CanvasRenderingContext2D, { fillText } = prototype;"
        "prototype.fillText = function (...given) { drawn.push(given[0]); fillText.apply(this, given); }"
    )
    page.reload()
    until(page, lambda: page.evaluate("drawn.includes('360')"))
    assert page.evaluate("drawn.includes('720')")
