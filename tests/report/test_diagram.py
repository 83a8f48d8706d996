"""The timing diagram: in the report it follows the cursor, as a file it is a picture."""

from collections.abc import Callable
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from browser import NARROW

import loomfmu
from loomfmu import LoomfmuError, report
from loomfmu.cli import main
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.report import diagram, occasions, shapes
from loomfmu.report.section import Subject
from loomfmu.traces import Trace

SIMS = Path(__file__).parents[2] / "sims"
Open = Callable[..., Any]
Written = Callable[..., Path]
BEGINNINGS = {".svg": b"<svg", ".png": b"\x89PNG", ".pdf": b"%PDF"}


def test_a_click_moves_the_cursor_to_its_angle(demo: Trace, written: Written, opened: Open) -> None:
    page = opened(written(demo))
    for picture, across in (("straight", 110 + 0.25 * 770), ("round", None)):
        box = page.locator(f"#diagram-{picture}").bounding_box()
        scale = box["width"] / (900 if across else 690)
        x, y = (across * scale, 50) if across else (box["width"] * 0.9, box["height"] / 2)
        page.keyboard.press("Home")
        page.locator(f"#diagram-{picture}").click(position={"x": x, "y": y})
        assert page.evaluate("loomfmu.position") == pytest.approx(1.5708, abs=0.01)


def test_the_drawing_is_that_of_the_revolution_under_the_cursor(
    whole: Trace, written: Written, opened: Open
) -> None:
    page = opened(written(whole))
    visible = "#diagram-straight g[data-drawing]:not([hidden])"
    first = page.locator(visible).get_attribute("data-drawing")
    page.evaluate("loomfmu.seek(5.5 * 2 * Math.PI)")
    assert page.locator(visible).count() == 1
    assert page.locator(visible).get_attribute("data-drawing") != first  # another pick of the twill


@pytest.mark.few(2)
@pytest.mark.parametrize("suffix", BEGINNINGS)
@pytest.mark.parametrize("shape", [[], ["--round"]])
def test_it_is_written_as_a_picture(copied: Path, suffix: str, shape: list[str]) -> None:
    output = copied.with_name(f"picture{suffix}")
    assert main(["diagram", str(copied), *shape, "--output", str(output)]) == 0
    content = output.read_bytes()
    assert content.startswith(BEGINNINGS[suffix])
    if suffix == ".svg":
        ElementTree.fromstring(content)
    assert main(["diagram", str(copied), *shape, "--output", str(output)]) == 0  # ours is replaced


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["--revolution", "9"], "revolution = 9 is outside [1, 3]"),
        (["--output", "picture.gif"], "'.gif' is not a suffix of a picture; use .svg, .png or .pdf"),
        (["--output", "picture"], "the file has no suffix"),
    ],
)
def test_what_cannot_be_drawn_is_said_in_one_line(
    copied: Path, arguments: list[str], reason: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["diagram", str(copied), *arguments]) == 2
    said = capsys.readouterr().err.strip()
    assert reason in said and "\n" not in said


def test_a_shaft_that_turns_backwards_is_not_said_to_stand(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = 'revolutions = 1\nsteps_per_revolution = 90\n[loom]\n[shaft]\nspeed = "-400 rev/min"\n'
    trace = loomfmu.run(scenes.parse(text, "back"), output=tmp_path / "back.h5").trace
    assert main(["diagram", str(trace.path)]) == 2
    said = capsys.readouterr().err.strip()
    assert said.endswith("there is no timing diagram, as the shaft turns backwards")
    drawn = diagram.section(Subject([trace]))
    assert drawn is not None and "Not drawn: the shaft turns backwards" in drawn.html
    with pytest.raises(LoomfmuError, match="turns backwards, so nothing is plotted over its angle"):
        trace.plot("shaft.velocity", over="angle")


@pytest.mark.parametrize(
    ("steps", "shown"), [(24, "Not drawn: the samples are up to 15° apart"), (90, "up to 4.0° apart")]
)
def test_coarse_samples_are_not_shown_as_if_they_were_fine(
    tmp_path: Path, opened: Open, steps: int, shown: str
) -> None:
    values = {"steps_per_revolution": steps, "revolutions": 1}
    trace = loomfmu.run(SIMS / "wl680_3600.toml", set=values, output=tmp_path / "coarse.h5").trace
    assert shown in opened(report.write([trace])).inner_text("#diagram")
    if steps == 24:
        with pytest.raises(LoomfmuError, match="no timing diagram, as the samples are up to 15° apart"):
            diagram.write(trace, tmp_path / "coarse.svg")


def test_labels_can_be_read_on_a_narrow_screen(whole: Trace, written: Written, opened: Open) -> None:
    page = opened(written(whole), NARROW)
    for picture in ("straight", "round"):
        size = page.evaluate(
            "name => { const text = document.querySelector(`#diagram-${name} text`);"
            " return parseFloat(getComputedStyle(text).fontSize) * text.getScreenCTM().a; }",
            picture,
        )
        assert size >= 11.0
    names = page.locator("#diagram-straight text.text").all()
    frame = page.locator("#diagram-straight").bounding_box()
    assert all(name.bounding_box()["x"] >= frame["x"] for name in names if name.is_visible())


def test_a_picture_says_which_revolution_and_what_its_colours_mean(copied: Path) -> None:
    output = copied.with_name("picture.svg")
    diagram.write(Trace(copied), output, 2)
    shown = [each.text for each in ElementTree.parse(output).iter("{http://www.w3.org/2000/svg}text")]
    assert shown[0].endswith("600 rev/min: timing diagram, revolution 2")
    assert {"in the shed", "outside and compressed", "dwells"} <= {*shown}
    assert "buckled" not in shown and not any(each.startswith("worst value") for each in shown if each)


def test_a_long_title_has_several_lines() -> None:
    """It ran out of the picture."""
    size, title = (
        (600.0, 500.0),
        "WL680-3600, weave 10011001/11001100/01100110/00110011, 450 rev/min: revolution 2",
    )
    drawing, (_width, height) = shapes.headed(f"{title}, {title}", {}, [], size)
    lines = [each.text for each in drawing if isinstance(each, shapes.Text)]
    assert " ".join(lines) == f"{title}, {title}" and len(lines) > 1
    assert all(len(each) * shapes.CHARACTER < size[0] for each in lines) and height > size[1] + 18.0 * len(
        lines
    )


def test_a_legend_names_what_is_drawn_and_nothing_else(
    demo: Trace, fast: Trace, written: Written, tmp_path: Path
) -> None:
    failing = [each.revolution for each in fast.verdicts if not each]
    assert set(failing) == {1}
    for circular in (False, True):  # of the revolution of the worst failure
        text = diagram.write(fast, tmp_path / f"fast_{circular}.svg", None, circular).read_text()
        assert ": timing diagram, revolution 1</title>" in text
        assert (
            ">buckled</text>" in text and ">worst value of a claim that fails or is undecided</text>" in text
        )
        assert text.count('<polygon class="fails"') == len(failing) + 1  # and the legend's own
    for trace, others in ((fast, True), (demo, False)):
        page = written(trace).read_text()
        assert '<span class="swatch dwell"' in page
        assert ('<span class="swatch buckled"' in page) is ('<span class="swatch fails"' in page) is others


def test_no_two_things_have_one_colour(whole: Trace, yarn: Trace) -> None:
    known = {
        bar.label: bar.role
        for trace in (whole, yarn)
        for row in occasions.Occasions(Subject([trace])).rows
        for bar in row.bars
    }
    assert {"in the shed", "heads overlap enough", "brake opened", "in its front tenth"} <= {*known}
    colours = {shapes.COLOURS[role] for role in known.values()}
    assert len(colours) == len(known)


def test_claims_have_a_row_where_one_has_its_worst_value_in_the_revolution(
    demo: Trace, copied: Path, tmp_path: Path
) -> None:
    there = {each.revolution for each in demo.verdicts}
    assert there < {1, 2, 3}  # else there is nothing to tell apart
    heights = {}
    for number in (1, 2, 3):
        output = tmp_path / f"{number}.svg"
        diagram.write(Trace(copied), output, number)
        assert (">Claims<" in output.read_text()) == (number in there)
        heights[number in there] = float(ElementTree.parse(output).getroot().attrib["viewBox"].split()[3])
    assert heights[True] - heights[False] == diagram.ROW + shapes.LINE  # a line of the legend is theirs, too


def test_a_revolution_without_worst_values_says_where_they_are(
    demo: Trace, written: Written, opened: Open
) -> None:
    assert {each.revolution for each in demo.verdicts} == {1, 3}
    page = opened(written(demo))
    text = page.locator("#diagram-straight .elsewhere")
    assert text.is_hidden()  # it opens at the worst claim
    page.evaluate("loomfmu.seek(1.5 * 2 * Math.PI)")
    assert text.is_visible() and text.text_content() == "worst values in revolutions 1 and 3"


def test_a_report_without_claims_has_no_row_for_them(tmp_path: Path) -> None:
    scene = scenes.parse((SIMS / "wl680_3600.toml").read_text().partition("[[claims]]")[0])
    page = loomfmu.run(scene, output=tmp_path / "plain.h5").report().read_text()
    assert ">Claims</text>" not in page and "worst value of a claim" not in page


@pytest.mark.slow
def test_a_revolution_beyond_those_that_are_kept_is_not_drawn(
    whole: Trace, tmp_path: Path, opened: Open, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(diagram, "MOST_DRAWN", 1)
    page = opened(report.write([whole], tmp_path / "short.html"))
    assert page.inner_text("#diagram-revolution") == "2"  # that of the worst claim is kept, and the first
    for turn in (1.5, 0.5):
        page.evaluate(f"loomfmu.seek({turn} * 2 * Math.PI)")
        assert page.locator("#diagram-missing").is_hidden()
    page.evaluate("loomfmu.seek(2.5 * 2 * Math.PI)")
    assert page.locator("#diagram-missing").is_visible()
    assert page.locator("#diagram-straight g[data-drawing]:not([hidden])").count() == 0


def test_a_trace_without_mechanisms_says_what_a_diagram_needs(tmp_path: Path) -> None:
    scene = scenes.parse('record = ["shaft.angle"]\nsteps_per_revolution = 90\n[shaft]\n')
    trace = loomfmu.run(scene, output=tmp_path / "shaft.h5").trace
    with pytest.raises(LoomfmuError, match=r'records nothing that it shows; add "weft.travel"'):
        diagram.write(trace, tmp_path / "shaft.svg")
