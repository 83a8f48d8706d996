"""The loom in motion: its parts are where the physics has them, at the position of the cursor."""

import json
import math
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from belt_loom import shape
from browser import NARROW

import loomfmu
from loomfmu import report
from loomfmu.components.reed_beat_up import ReedBeatUp
from loomfmu.components.weft_insertion import WeftInsertion
from loomfmu.cosim import reading
from loomfmu.cosim.reading import checked
from loomfmu.cosim.scenes import scene
from loomfmu.physics.belt import complete_elliptic, elastica_deflection
from loomfmu.report.drawings import sections
from loomfmu.report.drawings.belt import elastica, half_slope
from loomfmu.report.drawings.drive import BALL, planar, spherical
from loomfmu.report.drawings.reed import joints
from loomfmu.report.drawings.side import HEAD
from loomfmu.report.drawings.tracks import BUDGET, Tracks
from loomfmu.report.rules import evaluated
from loomfmu.report.section import TURN, Section, Subject
from loomfmu.traces import Trace

Open = Callable[..., Any]
SIMS = Path(__file__).parents[2] / "sims"
ANGLES = (0.0, 37.0, 100.0, 180.0, 271.0, 359.0)  # deg
MOTION = SIMS / "belt_motion.toml"
MODES, ENDS = [f"mode_{number}" for number in range(1, 7)], ["guide_shape", "head_shape"]
PAIR = ("belt", "belt_2")
STEP = 0.011  # mm: keyframes are rounded to 0.01 mm, points to a thousandth


@pytest.fixture(scope="module")
def pages(whole: Trace, fast: Trace, written: Callable[..., Path]) -> dict[str, Path]:
    return {"whole": written(whole), "buckled": written(fast)}


def made(trace: Trace) -> Section:
    """All drawings of a trace as one section."""
    *whole, details = sections(Subject([trace]))
    return replace(details, html="".join(each.html for each in (*whole, details)))


def seek(page: Any, degrees: float) -> None:
    page.evaluate(f"loomfmu.seek({math.radians(degrees)!r})")


def points(page: Any, figure: str, role: str, place: int = 0) -> list[tuple[float, float]]:
    text = page.locator(f"#motion-{figure} .{role}").nth(place).get_attribute("points")
    numbers = [float(word) for word in text.split()]
    return list(zip(numbers[::2], numbers[1::2], strict=True))


# ---- against the physics


@pytest.mark.slow
def test_the_drive_is_where_its_equations_have_it(pages: dict[str, Path], opened: Open) -> None:
    page, weft = opened(pages["whole"]), WeftInsertion()
    assert weft.initialize(0.0) == 0  # the defaults are those of the scene's machine
    for degrees in ANGLES:
        seek(page, 720.0 + degrees)
        (_c, d, k, g), angle = points(page, "drive-weft", "link.weft", 2), math.radians(degrees)
        np.testing.assert_allclose([d, k], planar(weft, angle), atol=STEP)
        assert math.dist(d, k) == pytest.approx(1000.0 * weft.coupler_length, abs=2.0 * STEP)
        assert math.dist(k, g) == pytest.approx(1000.0 * weft.output_length, abs=2.0 * STEP)
        np.testing.assert_allclose(
            points(page, "drive-weft", "link.weft", 0), spherical(weft, angle), atol=STEP
        )


def test_the_links_keep_their_lengths_between_keyframes(pages: dict[str, Path], opened: Open) -> None:
    page, weft = opened(pages["whole"]), WeftInsertion()
    for degrees in (10.5, 200.5, 300.5):
        seek(page, degrees)
        _c, d, k, _g = points(page, "drive-weft", "link.weft", 2)
        # a chord of one degree of the shaft is off by at most 150 mm * (1 deg)^2 / 8 = 0.006 mm
        assert math.dist(d, k) == pytest.approx(1000.0 * weft.coupler_length, abs=2.0 * STEP + 0.012)


def test_the_spherical_linkage_satisfies_its_equation() -> None:
    weft = WeftInsertion()
    for degrees in ANGLES:
        a, *_arc, b = (np.array(place) / BALL for place in spherical(weft, math.radians(degrees)))
        alpha = math.atan2(b[1], b[0])
        # A and B are on the unit sphere, B in the plane of the drawing: equation (1) is their dot product
        assert math.hypot(*b) == pytest.approx(1.0)
        assert a @ b == pytest.approx(math.cos(weft.rocker_angle))
        turned = -math.sin(weft.crank_cone) * math.cos(math.radians(degrees))
        assert a[1] == pytest.approx(turned)
        assert 0.0 < alpha < math.pi


def test_the_reed_is_where_the_trace_has_it(whole: Trace, pages: dict[str, Path], opened: Open) -> None:
    page = opened(pages["whole"])
    reed = ReedBeatUp(servo=True, run_angle=whole.parameter("reed.run_angle"))
    assert reed.initialize(0.0) == 0
    for degrees in ANGLES:
        seek(page, 1080.0 + degrees)
        _pivot, arm, tip = points(page, "reed-reed", "link.reed", 3)
        np.testing.assert_allclose([arm, tip], joints(reed, math.radians(degrees))[2:], atol=STEP)
        position = np.interp(math.radians(1080.0 + degrees), whole.shaft_angle, whole["reed.position"])
        # the trace is sampled every quarter degree, and between samples interpolated
        assert tip[0] == pytest.approx(1000.0 * position, abs=2.0 * STEP)
        assert math.dist(arm, tip) == pytest.approx(1000.0 * reed.rod_length, abs=2.0 * STEP)


def test_the_head_has_its_place_between_fell_and_reed(whole: Trace) -> None:
    (judged,) = (each for each in whole.verdicts if "the reed is out" in each.claim)
    station = whole.parameter("heald_1.warp_ratio") * whole.parameter("warp_1.front_length")
    assert judged and judged.bound >= station + 0.001 * HEAD


def test_frames_and_carriers_are_at_their_recorded_places(
    whole: Trace, pages: dict[str, Path], opened: Open
) -> None:
    page = opened(pages["whole"])
    for degrees in (100.0, 1234.0, 2100.0):
        seek(page, degrees)
        for n in range(1, 5):
            for track, signal in (("lift_mm", f"heald_{n}.lift"), ("eye", f"damper_{n}.carrier_lift")):
                moved = page.locator(f'#motion-side g[data-shift$="heald_{n}.{track}"]').first
                *_x, y = (float(word) for word in re.findall(r"-?[\d.]+", moved.get_attribute("transform")))
                there = 1000.0 * np.interp(math.radians(degrees), whole.shaft_angle, whole[signal])
                # equal frames of two revolutions may be two steps apart and are kept once
                assert y == pytest.approx(there - 49.0 * (track == "eye"), abs=0.03)


def test_the_head_has_the_room_that_its_claim_judges(
    whole: Trace, pages: dict[str, Path], opened: Open
) -> None:
    page = opened(pages["whole"])
    (judged,) = (each for each in whole.verdicts if "room in the shed" in each.claim)
    seek(page, math.degrees(Subject([whole]).position(judged) or 0.0))
    eyes = []
    for n in range(4):
        _fell, eye, *_back = points(page, "side", "sheet", n)
        carrier = np.interp(judged.time, whole.time, whole[f"damper_{n + 1}.carrier_lift"])
        assert eye == pytest.approx((-250.0, 1000.0 * carrier - 49.0), abs=0.03)
        eyes.append(abs(eye[1]))
    # the worst value lies between samples, and may lie in the degree in which the head enters
    worst = pytest.approx(1000.0 * judged.worst, abs=0.1)
    assert 2.0 * 0.35 * min(eyes) == worst
    opening, least, room = (each.inner_text() for each in page.locator("#motion-shed output").all())
    assert (float(opening), least) == (worst, judged.shown_worst)
    assert float(room) == pytest.approx(1000.0 * judged.worst - 17.0, abs=0.1)


def test_the_names_of_the_sector_gears_are_beside_the_wheels(pages: dict[str, Path], opened: Open) -> None:
    figure = opened(pages["whole"]).locator("#motion-front-transfer")
    wheels = sorted(each.bounding_box()["x"] for each in figure.locator("circle.body").all())
    width = figure.locator("circle.body").first.bounding_box()["width"]
    names = [each.bounding_box() for each in figure.get_by_text("sector gear").all()]
    left, right = sorted((name["x"], name["x"] + name["width"]) for name in names)
    assert wheels[0] + width < left[0] and right[1] < wheels[-1]


def test_the_belt_leaves_its_wheel_at_the_height_of_its_guide(pages: dict[str, Path], opened: Open) -> None:
    belts = opened(pages["whole"]).locator("#motion-front-transfer .belt")
    # wound on it, and from there to the head
    wheel, way = (belts.nth(place).bounding_box() for place in range(2))
    assert wheel["y"] + wheel["height"] == pytest.approx(way["y"] + way["height"], abs=0.5)  # px
    assert wheel["x"] + wheel["width"] == pytest.approx(way["x"], abs=4.0)  # half a line's width each


def test_the_belt_in_motion_bends_where_the_trace_has_it(
    whole: Trace, pages: dict[str, Path], opened: Open
) -> None:
    page = opened(pages["whole"])
    for degrees in (105.0, 120.0, 230.0):
        seek(page, 1080.0 + degrees)
        text = page.locator("#motion-belt-belt_motion g[data-stretch]").first.get_attribute("transform")
        _x, _y, place, drawn = (float(word) for word in re.findall(r"-?[\d.]+", text))
        bend = drawn / times(page, "belt_motion")
        at = int(np.searchsorted(whole.shaft_angle, math.radians(1080.0 + degrees)))
        for drawn, signal in ((place, "deflection_place"), (bend, "deflection")):
            near = 1000.0 * whole[f"belt_motion.{signal}"][at - 5 : at + 6]  # keyframes are one a degree
            assert near.min() - STEP <= drawn <= near.max() + STEP


def times(page: Any, belt: str) -> float:
    """How many times the deflection of a belt in motion is drawn."""
    shown = page.inner_text(f'#motion-belt-{belt} output[data-value="{belt}.magnified"]')
    assert shown == f"{float(shown):g}"  # 20 times, not 20.0
    return float(shown)


def test_the_belt_in_motion_is_drawn_as_it_bends(tmp_path: Path, opened: Open) -> None:
    run = loomfmu.run(reading.drawn(checked(MOTION, {}, "native")), output=tmp_path / "run.h5")
    page, trace = opened(run.report()), run.trace
    for degrees in (100.0, 137.0, 170.0):
        seek(page, degrees)
        at = int(np.searchsorted(trace.shaft_angle, math.radians(degrees) - 1e-9))
        deflection, place = (1000.0 * trace[f"belt_motion.deflection{each}"][at] for each in ("", "_place"))
        modes, ends = ([trace[f"belt_motion.{each}"][at] for each in names] for names in (MODES, ENDS))
        along = 1000.0 * (trace["belt_motion.free_length"] - trace["belt_motion.shortening"])[at]
        x, y = np.array(points(page, "belt-belt_motion", "belt[data-curve]")).T
        # from the guide, with eight amplitudes that are each rounded to 1e-4 mm, as the places are
        np.testing.assert_allclose(x, np.linspace(0.0, along, len(x)), atol=STEP)
        exact = 1000.0 * shape(modes, ends, np.linspace(1.0, 0.0, len(x)))
        np.testing.assert_allclose(y / times(page, "belt_motion"), exact, atol=4.1e-4)
        worst = int(np.argmax(np.abs(y)))  # between two points it is flat: within 1 % of the deflection
        assert abs(y[worst]) / times(page, "belt_motion") == pytest.approx(deflection, rel=1e-2)
        assert x[worst] == pytest.approx(place, abs=along / len(x))


def test_the_shape_of_a_belt_is_recorded_only_for_a_drawing_or_by_its_names(tmp_path: Path) -> None:
    plain = checked(MOTION, {}, "native")
    more = [f"belt_motion.{each}" for each in (*MODES, *ENDS)]
    assert reading.drawn(plain).record == [*plain.record, *more] and not {*more} & {*plain.record}
    named = scene.parse(plain.text.replace('"belt_motion.*"', '"belt_motion.mode_*"'), "named", {}, SIMS)
    trace = loomfmu.run(named, output=tmp_path / "named.h5").trace
    assert [name for name in more if name in trace] == more[:6]


# ---- the weft


def test_the_weft_reaches_to_the_head_and_is_red_where_it_hangs_slack(tmp_path: Path, opened: Open) -> None:
    # with a constant brake, it hangs slack before the taker releases it
    constant = {f"yarn.brake_program_{n}": 1 for n in range(1, 25)}
    trace = loomfmu.run(SIMS / "weft_tension.toml", set=constant, output=tmp_path / "weft.h5").trace
    page = opened(report.write([trace], tmp_path / "weft.html"))
    hung = page.locator("#motion-yarn-yarn g[data-shown]")
    for degrees in (100.0, 200.0, 310.0):
        seek(page, degrees)
        there = 1000.0 * np.interp(math.radians(degrees), trace.shaft_angle, trace["yarn.length"])
        _eye, head = points(page, "yarn-yarn", "link.weft", 1)
        assert head == (pytest.approx(there, abs=2.0 * STEP), 0.0)
        slack = np.interp(math.radians(degrees), trace.shaft_angle, trace["yarn.slack"]) > 0.5
        assert hung.evaluate("part => part.hasAttribute('hidden')") != slack
    assert slack


def test_the_weft_goes_with_the_giver_then_with_the_taker(
    whole: Trace, pages: dict[str, Path], opened: Open
) -> None:
    page = opened(pages["whole"])
    idle, stroke = 1000.0 * whole.parameter("belt.idle_travel"), 1000.0 * whole["weft.stroke"][0]
    for degrees, drawn in ((120.0, "weft.travel"), (250.0, "weft_2.travel")):
        seek(page, degrees)
        travel = 1000.0 * np.interp(math.radians(degrees), whole.shaft_angle, whole[drawn])
        _eyes, (end, _y) = points(page, "front-transfer", "sheet.weft")
        # the taker grips it where the giver has brought it
        tip = travel - idle if drawn == "weft.travel" else 2.0 * stroke - idle - travel
        assert end == pytest.approx(tip, abs=2.0 * STEP)


def test_both_heads_overlap_by_what_the_trace_has(whole: Trace, pages: dict[str, Path], opened: Open) -> None:
    page, lengths = opened(pages["whole"]), [whole.parameter(f"{each}.head_length") for each in PAIR]
    figure = page.locator("#motion-transfer-transfer")
    (apart,) = re.findall(r"translate\(([\d.]+) 0\) scale\(-1 1\)", figure.inner_html())
    for degrees in (120.0, 165.0, 180.0, 190.3, 300.0):
        seek(page, 1080.0 + degrees)
        place = math.radians(1080.0 + degrees)
        recorded = 1000.0 * np.interp(place, whole.shaft_angle, whole["transfer.overlap"])
        heads = [figure.locator(f'g[data-shift^="{each}.tail"]').get_attribute("transform") for each in PAIR]
        tails = [float(re.findall(r"-?[\d.]+", text)[0]) for text in heads]
        drawn = sum(tails) + 1000.0 * sum(lengths) - float(apart)
        # each head to a step; between keyframes of a degree the overlap, whose second derivative by the angle
        # is 2.5 m, leaves its chord by 2.5 m (1 deg)^2 / 8
        assert drawn == pytest.approx(recorded, abs=2.0 * STEP + 0.1), degrees
        shown = figure.locator('output[data-value="transfer.overlap_mm"]').inner_text()
        assert float(shown) == pytest.approx(drawn, abs=0.05 + 2.0 * STEP)  # a digit


def test_numbers_of_heads_with_buckled_belts_fit_their_overlap(tmp_path: Path, opened: Open) -> None:
    """The transfer counts belts as straight: so do the captions, which say so."""
    scene = SIMS / "both_rapiers.toml"
    trace = loomfmu.run(scene, set={"shaft.speed": "720rpm"}, output=tmp_path / "late.h5").trace
    page = opened(report.write([trace], tmp_path / "late.html"))
    idle = [trace.parameter(f"{each}.idle_travel") for each in PAIR]
    apart = 1000.0 * (trace.parameter("transfer.separation") - sum(idle))
    shown = page.locator("#motion-front-transfer output[data-value]")
    assert float(np.max(trace["belt.deflection"])) > 1e-3
    worst = int(np.argmax(trace["belt.deflection"]))
    page.evaluate(f"loomfmu.seek({float(trace.shaft_angle[worst])!r})")
    within = [float(each) for each in shown.all_inner_texts()]
    # as in the test of the overlap, of which the two shown lengths have a digit each
    recorded = 1000.0 * trace["transfer.overlap"][worst]
    assert sum(within) - apart == pytest.approx(recorded, abs=0.1 + 2.0 * STEP + 0.1)
    for figure in ("front", "transfer"):
        assert "of straight belts" in page.inner_text(f"#motion-{figure}-transfer")
    assert "giver's head into the shed" in page.inner_text("#motion-front-transfer")


# ---- the buckled belt


def test_the_drawn_belt_has_the_recorded_deflection_and_length(
    fast: Trace, pages: dict[str, Path], opened: Open
) -> None:
    page = opened(pages["buckled"])
    for degrees in (99.5, 100.0, 101.0):
        seek(page, degrees)
        place = math.radians(degrees)
        bow = np.array(points(page, "belt-belt", "risk"))
        bent, free = (
            1000.0 * np.interp(place, fast.shaft_angle, fast[f"belt.{name}"])
            for name in ("deflection", "free_length")
        )
        # the slope is rounded to 1e-4 rad, and interpolated between 41 shapes
        assert np.max(bow[:, 1]) == pytest.approx(bent, abs=0.05)
        # 32 chords are shorter than their curve by a share of (pi / 32)^2 / 24 at a slope of one
        assert np.sum(np.hypot(*np.diff(bow, axis=0).T)) == pytest.approx(free, rel=1e-3)
        head = page.locator("#motion-belt-belt g[data-shift]").last.get_attribute("transform")
        assert float(re.findall(r"[\d.]+", head)[0]) == pytest.approx(bow[-1, 0], abs=0.1)


def test_the_elastica_is_that_of_the_physics() -> None:
    for load in (1.0029, 1.05, 1.5, 3.0, 10.0):
        bend = np.array([elastica_deflection(load, 1.0)])
        (half,) = evaluated(half_slope("bend", 1.0, load), {"bend": bend}.__getitem__)
        modulus = math.sin(half)
        assert (2.0 * complete_elliptic(modulus) / math.pi) ** 2 == pytest.approx(load, rel=1e-4)
        x, y = elastica(modulus)
        assert np.max(y) == pytest.approx(bend[0], rel=1e-3)
        assert x[0] == 0.0 and x[16] == pytest.approx(0.5 * x[-1])  # symmetric about its middle
    x, y = elastica(0.0)  # a straight one
    assert x[-1] == pytest.approx(1.0) and np.all(y == 0.0)


# ---- what is drawn


def test_only_what_the_trace_records_is_drawn(demo: Trace, tmp_path: Path, opened: Open) -> None:
    assert "reed" not in made(demo).html
    trace = loomfmu.run(SIMS / "spline_cam.toml", output=tmp_path / "cam.h5").trace
    figures = re.findall(r'<figure id="motion-([^"]+)"', made(trace).html)
    assert figures == ["side", "shed"]
    page = opened(report.write([trace], tmp_path / "cam.html"))
    seek(page, 90.0)
    assert page.inner_text("#motion-place").startswith("rev. 1, 90.0°")


def test_drawings_do_not_hang_on_names(tmp_path: Path) -> None:
    """A carrier was drawn in its frame only if they were called heald_1 and damper_1."""

    def drawn(frame: str, damper: str) -> tuple[str, Trace]:
        text = (
            '[loom]\nmachine = "WL680-3600"\n[dobby]\n[{0}]\ncomponent = "HealdFrame"\npattern = "10"\n'
            '[{1}]\ncomponent = "HealdDamper"\n[wires]\n'
            + "".join(f'"{{1}}.{each}" = "{{0}}.{each}"\n' for each in ("lift", "velocity", "acceleration"))
            + '[[claims]]\nkind = "rapier_in_open_shed"\nhead_height = "17 mm"\n'
        )
        loom = scene.parse(text.format(frame, damper), "loom", {"steps_per_revolution": 180})
        trace = loomfmu.run(loom, output=tmp_path / f"{frame}.h5").trace
        return made(trace).html.replace(frame, "heald_1").replace(damper, "damper_1"), trace

    usual, _trace = drawn("heald_1", "damper_1")
    assert "healds in their frames with carriers" in usual
    assert "The rapier head has the 17 mm that its claim gives it." in usual
    renamed, trace = drawn("left_1", "swing_1")
    assert renamed == usual
    trace.wires = {}  # as traces of older versions have them
    assert "The trace does not say which carrier is in which frame: none is drawn." in made(trace).html


def test_the_belt_in_motion_has_a_drawing_of_its_own(tmp_path: Path) -> None:
    html = made(loomfmu.run(MOTION, output=tmp_path / "run.h5").trace).html
    assert '<figure id="motion-belt-belt_motion"' in html
    assert "loomfmu run --report records its whole shape" in html


def test_captions_of_a_belt_and_of_its_motion_do_not_contradict_one_another(whole: Trace) -> None:
    """It was said to stay straight, beside the same belt as it swings."""
    html = made(whole).html
    assert "In this run the belt does not buckle; it is drawn without vibration." in html
    assert "Belt in motion: belt_motion" in html and "straight in this run" not in html


def test_a_linkage_that_does_not_give_the_recorded_travel_is_not_drawn(
    demo: Trace, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert "motion-drive-weft" in made(demo).html
    parameter = Trace.parameter
    monkeypatch.setattr(
        Trace, "parameter", lambda self, name: parameter(self, name) * (1.01 if "coupler" in name else 1.0)
    )
    assert "motion-drive-weft" not in made(demo).html


def test_samples_too_far_apart_are_not_joined_to_a_motion(tmp_path: Path) -> None:
    coarse = {"steps_per_revolution": 30}
    found = made(loomfmu.run(SIMS / "wl680_3600.toml", set=coarse, output=tmp_path / "coarse.h5").trace)
    assert "the samples are up to 12° apart" in found.html and "<svg" not in found.html


def test_a_report_opens_at_the_worst_claim_of_all_traces(demo: Trace, fast: Trace) -> None:
    for traces in ([fast], [fast, demo], [demo, fast]):
        assert math.degrees(Subject(traces).start) == pytest.approx(100.139, abs=1e-3)
    nearest = min(demo.verdicts, key=lambda each: each.away)
    assert Subject([demo]).start == Subject([demo]).position(nearest)


def test_each_drawing_has_a_sentence(whole: Trace) -> None:
    html = made(whole).html
    labels = re.findall(r'<svg [^>]*role="img" aria-label="([^"]+)"', html)
    assert len(labels) == html.count("<figure ") == 12
    assert all(label.endswith(".") and len(label) > 40 for label in labels)


# ---- size


@pytest.mark.parametrize("name", ["demo", "whole", "fast"])
def test_the_section_is_small(name: str, request: pytest.FixtureRequest) -> None:
    found = made(request.getfixturevalue(name))
    assert len(found.html) + len(found.json) < 600_000


def test_equal_revolutions_are_kept_once_and_the_budget_is_kept(demo: Trace) -> None:
    subject = Subject([demo])
    tracks = Tracks(subject, 0.0)
    tracks.add("same", "weft.travel", 0.001)
    noise = np.random.default_rng(1).normal(size=len(subject.positions))
    for number in range(2 * BUDGET // 361):
        tracks.add(f"other {number}", noise)
    data = json.loads(Section("x", "x", "", data=tracks.data()).json)
    assert data["tracks"]["same"]["shown"] == [0, None, None]
    assert len(data["tracks"]["same"]["frames"]) == 1


# ---- in the page


def test_a_revolution_that_is_not_kept_says_so(
    demo: Trace, tmp_path: Path, opened: Open, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("loomfmu.report.drawings.tracks.BUDGET", 1000)
    page = opened(report.write([demo], tmp_path / "short.html"))
    kept = int(Subject([demo]).start / TURN)
    other = 0 if kept else 1
    seek(page, 360.0 * kept + 50.0)
    assert page.locator("#motion-missing").is_hidden()
    seek(page, 360.0 * other + 50.0)
    assert page.locator("#motion-missing").is_visible()


def test_play_moves_the_head(pages: dict[str, Path], opened: Open) -> None:
    page = opened(pages["buckled"])
    value = page.locator('#motion-front-belt output[data-value="belt.unbent"]')
    seek(page, 100.0)
    assert value.inner_text() == "720.4"
    page.keyboard.press("ArrowRight")
    assert float(value.inner_text()) > 727.0


def test_nothing_stands_out_on_a_narrow_screen(pages: dict[str, Path], opened: Open) -> None:
    page = opened(pages["buckled"], NARROW, color_scheme="dark")
    assert page.evaluate("document.documentElement.scrollWidth") == NARROW[0]
    for box in (each.bounding_box() for each in page.locator("#motion svg").all()):
        assert box["x"] >= 0.0 and box["x"] + box["width"] <= NARROW[0]


def test_it_opens_where_the_worst_claim_is(pages: dict[str, Path], opened: Open) -> None:
    page = opened(pages["buckled"])
    for media in ("screen", "print"):
        page.emulate_media(media=media)
        for place in ("#cursor-place", "#motion-place"):
            assert page.text_content(place).startswith("rev. 1, 100.1°")
