"""The page as a whole: it opens in silence, asks no host for anything, and follows its cursor."""

import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from browser import until

from loomfmu import LoomfmuError, report, run
from loomfmu.cli import main
from loomfmu.cosim.scenes.scene import parse
from loomfmu.report.claims import side_by_side
from loomfmu.report.document import page
from loomfmu.report.section import Subject
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
    assert found.inner_text("#cursor-place").startswith("rev. 3, 360.0°")
    assert found.inner_text("#diagram-revolution") == "3"
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


def test_the_command_writes_it_beside_the_trace_and_replaces_nothing_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    run(parse("revolutions = 1\nsteps_per_revolution = 45\n[weft]\n[shaft]\n"), output="demo.h5")
    os.link("demo.h5", "new.h5")
    page = Path("demo.html")
    assert main(["report", "demo.h5"]) == 0
    assert capsys.readouterr().out == "written: demo.html\n"
    assert main(["report", "demo.h5"]) == 0  # one of ours is replaced
    page.write_text("my notes")
    assert main(["report", "demo.h5", "new.h5"]) == 0
    assert capsys.readouterr().out.endswith("written: demo_and_new.html\n")
    for arguments, reason in {
        "": "--force (overwrite=True in Python) replaces it",
        "--output demo.h5 --force": "(it is an input of this command)",
        "--output x.pdf": "ends in .html; name it x.html, and print the page to PDF in a browser",
    }.items():
        assert main(["report", "demo.h5", *arguments.split()]) == 2
        assert capsys.readouterr().err.strip().endswith(reason)
    assert page.read_text() == "my notes" and not Path("x.pdf").exists()


def test_a_report_of_two_traces_shows_the_one_that_fails_and_says_so(
    demo: Trace, fast: Trace, written: Callable[..., Path], opened: Open
) -> None:
    """It opened at the moment in which the second buckles, and drew the first, whose belt was straight."""
    for traces in ([demo, fast], [fast, demo]):
        found = opened(written(*traces))
        for section in ("diagram", "motion", "provenance"):
            said = found.inner_text(f"#{section}")
            assert "Of fast.h5 alone, the trace with the worst claim." in said
        for section in ("claims", "plots"):
            assert "alone" not in found.inner_text(f"#{section}")
        bent = found.locator("#motion-belt-belt output").nth(1)  # the deflection
        assert float(bent.inner_text()) > 10.0


def test_a_report_of_two_traces_judges_both(demo: Trace, fast: Trace, written: Callable[..., Path]) -> None:
    for traces in ([demo, fast], [fast, demo]):
        page = written(*traces).read_text()
        outcomes = dict(re.findall(r'class="outcome (\w+)"><span [^>]*></span>([^<]*)<', page))
        assert outcomes == {"holds": "demo.h5: all 6 claims hold", "fails": "fast.h5: 4 of 6 claims hold"}
        assert page.count(">FAILS</strong>") == 2 and page.count(">holds</strong>") == 10


def test_a_claim_that_a_trace_does_not_have_is_not_judged_there(demo: Trace, fast: Trace) -> None:
    first, *others = demo.verdicts
    rows = side_by_side([others, fast.verdicts, [first]])
    assert [row[2] for row in rows] == [None] * 5 + [first] and rows[-1] == [None, fast.verdicts[0], first]
    assert all(one is not None and one.claim == two.claim for one, two, _ in rows[:-1] if two is not None)


def test_without_a_trace_there_is_nothing_to_report() -> None:
    with pytest.raises(LoomfmuError, match="name at least one"):
        report.write([])
