"""Headings are made of the values of a run: no value that is set makes them untrue."""

import json
from pathlib import Path
from typing import Any

import pytest

import loomfmu
from loomfmu import live_page
from loomfmu.cli import main
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.cosim.scenes.headings import heading
from loomfmu.machines import HEADS, MACHINES
from loomfmu.report import diagram
from loomfmu.traces import Trace

SIMS = Path(__file__).parents[3] / "sims"
DEMO = SIMS / "wl680_3600.toml"
LOOM = "WL680-3600, G6300 left, weave 10/01/10/01, 600 rev/min"
OTHER = {"machine": "WL800-3600", "belt.guide_clearance": "0.5 mm"}
CHANGED = "WL800-3600, G6300 left, weave 10/01/10/01, 600 rev/min; belt.guide_clearance = 0.5 mm"


@pytest.mark.parametrize(
    ("overrides", "said"),
    [
        ({}, LOOM),
        (OTHER, CHANGED),
        ({"head": "GS900 right"}, LOOM.replace("G6300 left", "GS900 right")),
        ({"loom.head": "GS900 right"}, LOOM.replace("G6300 left", "GS900 right")),
        ({"shaft.speed": 65.0}, LOOM.replace("600 rev/min", "620.7043 rev/min")),
        ({"loom.weave": "1100/0011"}, LOOM.replace("10/01/10/01", "1100/0011")),
        ({"heald_2.pattern": "1"}, LOOM.replace("10/01/10", "10/1/10") + "; heald_2.pattern = 1"),
        ({"belt.guide_clearance": 5e-4}, f"{LOOM}; belt.guide_clearance = 0.5 mm"),
        ({"belt.head_mass": "120 g", "revolutions": 1}, f"{LOOM}; belt.head_mass = 120 g, revolutions = 1"),
        ({"weft.machine": "WL800-3600"}, f"WL800-3600 and {LOOM}; weft.machine = WL800-3600"),
        (
            {"loom.weave": "/".join(10 * ["11111111"])},
            LOOM.replace("10/01/10/01", "of 10 frames and 8 picks"),
        ),
    ],
)
def test_a_heading_says_what_the_values_are(overrides: dict[str, Any], said: str) -> None:
    assert heading(scenes.load(DEMO, overrides)) == said


def test_values_beside_those_of_the_machine_are_named_and_varied_ones_left_out() -> None:
    text = '[loom]\nmachine = "WL680-3600"\nhead = "G6300 left"\n[belt]\nhead_mass = "0.1 kg"\n'
    read = scenes.parse(text, "mine", {"weft.crank_length": "70 mm"})
    start = "WL680-3600, G6300 left, 400 rev/min"
    assert heading(read) == f"{start}; weft.crank_length = 70 mm, belt.head_mass = 100 g"
    varied = ["shaft.speed", "weft.crank_length"]
    assert heading(read, varied) == "WL680-3600, G6300 left; belt.head_mass = 100 g"
    assert heading(scenes.parse("[shaft]\n", "bare")) == "bare, 400 rev/min"
    by_default = '[loom]\nhead = "G6300 left"\n'
    assert heading(scenes.parse(by_default, "mine")) == start
    own = by_default + "[belt]\nidle_travel = 0.25\n[weft]\noutput_length = 0.12\n"
    assert heading(scenes.parse(own, "mine")) == "G6300 left, 400 rev/min"
    assert heading(scenes.load(SIMS / "driven_loom.toml")).endswith("nominally 412 rev/min")


@pytest.mark.parametrize("path", sorted(SIMS.rglob("*.toml")), ids=lambda path: path.stem)
def test_the_title_of_an_example_scene_names_nothing_that_can_be_set(path: Path) -> None:
    if path.parent.name not in ("sweeps", "studies"):  # which fix what they name
        title = scenes.load(path).title
        assert not any(name.split()[0] in title for name in (*MACHINES, *HEADS)), title
        assert "rev/min" not in title and "weave" not in title


@pytest.mark.slow
def test_run_show_report_diagram_and_plot_have_the_heading(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    few = {**OTHER, "revolutions": "1", "steps_per_revolution": "90"}
    said = f"{CHANGED}, revolutions = 1, steps_per_revolution = 90"
    overrides = [part for key, value in few.items() for part in ("--set", f"{key}={value}")]
    assert main(["run", str(DEMO), *overrides, "--output", "other.h5"]) in (0, 1)
    assert " ".join(capsys.readouterr().out.split()).startswith(f"{said}: 1 revolution, 90 steps")
    main(["show", "other.h5"])
    shown = capsys.readouterr().out.splitlines()
    assert " ".join(shown).startswith(f"{said} (loomfmu ")
    assert 'changed from the scene "Belt and healds of a published rapier loom"' in shown
    trace = Trace("other.h5")
    assert f"<h1>{said}</h1>" in loomfmu.report.write([trace]).read_text()
    drawn = diagram.write(trace, Path("other.svg")).read_text()
    assert f"<title>{said}: timing diagram, revolution 1</title>" in drawn
    assert main(["plot", "other.h5", "belt.margin", "--output", "plot.svg"]) == 0
    assert said in Path("plot.svg").read_text()
    assert said in trace._repr_html_()


def test_a_trace_of_an_older_version_quotes_the_title_and_says_what_differs(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    text = 'title = "Mine"\nrevolutions = 1\nsteps_per_revolution = 9\n[shaft]\n'
    trace = loomfmu.run(scenes.parse(text), output=tmp_path / "old.h5").trace
    older = {key: value for key, value in trace.attributes.items() if key != "heading"}
    monkeypatch.setattr(Trace, "attributes", older | {"set": json.dumps({"shaft.speed": "300 rpm"})})
    assert trace.heading == '"Mine"; shaft.speed = 300 rpm'


@pytest.mark.slow
def test_the_page_that_varies_a_value_names_none_of_it(tmp_path: Path) -> None:
    pytest.importorskip("ziglang")
    few = {"revolutions": 1, "steps_per_revolution": 90}
    page = live_page.write(DEMO, ["shaft.speed=500rpm..700rpm"], tmp_path / "page.html", few).read_text()
    said = "WL680-3600, G6300 left, weave 10/01/10/01; revolutions = 1, steps_per_revolution = 90"
    assert f"<h1>{said}; varied: shaft.speed</h1>" in page
