"""The page as a whole: it opens in silence, asks no host for anything, and follows its cursor."""

import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from browser import NARROW, until

import loomfmu
from loomfmu import LoomfmuError, report
from loomfmu.cli import main
from loomfmu.cosim.scenes.scene import parse
from loomfmu.report.document import MARK, page
from loomfmu.report.section import Subject, embedded
from loomfmu.traces import Trace

Open = Callable[..., Any]
MAIL = 4_000_000  # bytes that a mail takes


@pytest.fixture
def demo_page(written: Callable[..., Path], demo: Trace) -> Path:
    return written(demo)


def test_it_opens_and_tells_the_verdict(demo_page: Path, opened: Open) -> None:
    found = opened(demo_page)
    assert found.title() == "WL680-3600, G6300 left, weave 10/01/10/01, 600 rev/min"
    assert found.inner_text("header .about") == 'scene "Belt and healds of a published rapier loom"'
    assert found.inner_text(".outcome").endswith("All 6 claims hold")
    assert found.locator("table.claims tbody tr").count() == 6


def test_a_click_on_a_place_moves_the_cursor_there(demo_page: Path, opened: Open) -> None:
    found = opened(demo_page)
    found.locator("#claims .place").first.click()
    assert found.inner_text("#cursor-place").startswith("rev. 1, 100.1°")
    found.keyboard.press("ArrowRight")  # the button that was clicked keeps only Space and Enter
    assert found.inner_text("#cursor-place").startswith("rev. 1, 101.1°")


def test_the_cursor_follows_slider_keys_and_play(demo_page: Path, opened: Open) -> None:
    found = opened(demo_page)
    where = lambda: found.evaluate("loomfmu.position")  # noqa: E731
    found.keyboard.press("End")
    assert where() == found.evaluate("loomfmu.last")
    found.keyboard.press("Home")
    found.keyboard.press("ArrowRight")
    assert where() == pytest.approx(0.0174533, rel=1e-5)
    found.locator("#cursor-slider").fill("3")
    assert where() == pytest.approx(3.0)
    found.locator("#cursor-play").click()
    until(found, lambda: where() > 3.2)
    found.locator("#cursor-play").click()
    kept = where()
    found.wait_for_timeout(100)
    assert where() == kept


@pytest.mark.few(1)
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_nothing_stands_out_at_the_side_of_a_narrow_screen(
    demo_page: Path, opened: Open, scheme: str
) -> None:
    found = opened(demo_page, NARROW, color_scheme=scheme)
    assert found.evaluate("document.documentElement.scrollWidth") == NARROW[0]


def test_the_command_names_its_page_as_the_trace_was_named(
    demo: Trace, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    os.link(demo.path, tmp_path / "demo.h5")
    monkeypatch.chdir(tmp_path)
    assert main(["report", "demo.h5"]) == 0
    assert capsys.readouterr().out == "written: demo.html\n"


def test_it_is_small_enough_to_mail(demo_page: Path) -> None:
    assert demo_page.stat().st_size < MAIL


def test_foreign_text_is_shown_and_never_run(
    demo: Trace, tmp_path: Path, opened: Open, monkeypatch: pytest.MonkeyPatch
) -> None:
    nasty = "</title></script><script>console.log('run')</script><img src=x onerror=alert(1)>"
    attributes = demo.attributes | {"title": nasty, "heading": nasty, "scene": nasty}
    monkeypatch.setattr(Trace, "attributes", attributes)
    path = tmp_path / "nasty.html"
    path.write_text(page(Subject([demo])))
    assert opened(path).title() == nasty


def test_data_cannot_end_the_element_they_stand_in() -> None:
    assert "<" not in embedded({"a": ["</script>", float("nan"), float("inf")]})


def test_the_command_writes_it_beside_the_trace(
    demo: Trace, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    copy = tmp_path / "copy.h5"
    os.link(demo.path, copy)
    assert main(["report", str(copy)]) == 0
    assert capsys.readouterr().out.strip() == f"written: {tmp_path / 'copy.html'}"
    assert main(["report", str(copy)]) == 0  # one of ours is replaced
    (tmp_path / "copy.html").write_text("my notes")
    assert main(["report", str(copy)]) == 2
    assert (tmp_path / "copy.html").read_text() == "my notes"
    assert main(["report", str(copy), "--output", str(copy), "--force"]) == 2
    assert capsys.readouterr().err.strip().endswith("(it is an input of this command)")


def test_the_report_of_two_traces_leaves_that_of_the_first(
    demo: Trace, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    names = [str(tmp_path / name) for name in ("worn.h5", "new.h5")]
    for name in names:
        os.link(demo.path, name)
    (tmp_path / "worn.html").write_text(MARK)
    assert main(["report", *names]) == 0
    assert capsys.readouterr().out.strip() == f"written: {tmp_path / 'worn_and_new.html'}"
    assert (tmp_path / "worn.html").read_text() == MARK


def test_a_page_is_not_written_under_the_name_of_another_format(
    demo: Trace, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["report", str(demo.path), "--output", str(tmp_path / "x.pdf")]) == 2
    said = capsys.readouterr().err.strip()
    assert said.endswith("ends in .html; name it x.html, and print the page to PDF in a browser")
    assert not (tmp_path / "x.pdf").exists()


def test_the_end_of_a_run_is_the_end_of_its_last_revolution(demo_page: Path, opened: Open) -> None:
    found = opened(demo_page)
    found.keyboard.press("End")
    assert found.inner_text("#cursor-place").startswith("rev. 3, 360.0°")
    assert found.inner_text("#diagram-revolution") == "3"


def test_a_report_of_two_traces_says_what_is_of_the_first(demo: Trace, tmp_path: Path, opened: Open) -> None:
    copy = tmp_path / "copy.h5"
    os.link(demo.path, copy)
    found = opened(report.write([demo, copy], tmp_path / "both.html"))
    for section in ("diagram", "motion", "provenance"):
        assert "Of the first trace, demo.h5." in found.inner_text(f"#{section}")
    for section in ("claims", "plots"):
        assert "Of the first trace" not in found.inner_text(f"#{section}")


def test_a_report_of_two_traces_judges_both(demo: Trace, tmp_path: Path) -> None:
    text = '[loom]\nmachine = "WL680-3600"\nhead = "G6300 left"\n[[claims]]\nkind = "lowest_margin"\n'
    failing = loomfmu.run(
        parse(f"revolutions = 1\n{text}bound = 0.9\n"), output=tmp_path / "failing.h5"
    ).trace
    for traces in ([demo, failing], [failing, demo]):
        page = report.write(traces, tmp_path / "both.html").read_text()
        outcomes = dict(re.findall(r'class="outcome (\w+)"><span [^>]*></span>([^<]*)<', page))
        assert outcomes == {"holds": "demo.h5: All 6 claims hold", "fails": "failing.h5: 1 of 1 claims fails"}
        assert page.count(">FAILS</td>") == 1 and page.count('<table class="claims">') == 2


def test_without_a_trace_there_is_nothing_to_report() -> None:
    with pytest.raises(LoomfmuError, match="name at least one"):
        report.write([])
