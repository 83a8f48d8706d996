"""What notebooks and xarray are given."""

import sys
from functools import partial
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest
from drawn_runs import drawn, turning

import loomfmu
from loomfmu import LoomfmuError
from loomfmu.declaring.variables import Beside
from loomfmu.display import progress
from loomfmu.traces import Channel, Recording, Verdict

SCENE = """
title = "a <b>bold</b> title"
revolutions = 2.5
steps_per_revolution = 360
record = ["belt.margin", "belt.at_risk", "heald_1.lift"]
[loom]
machine = "WL680-3600"
head = "G6300 left"
weave = "10/01"
[[claims]]
name = "<script>"
kind = "lowest_margin"
bound = 0.1
"""


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory, fmu_cache: None) -> loomfmu.Result:
    path = tmp_path_factory.mktemp("notebook") / "loom.toml"
    path.write_text(SCENE)
    return loomfmu.run(path, output=path.with_suffix(".h5"))


@pytest.mark.parametrize(
    "asked",
    [
        partial(loomfmu.evaluate),
        partial(loomfmu.gradient, of="belt.lowest_margin", by="shaft.speed"),
        partial(loomfmu.limit, vary="belt.guide_clearance", points=3),
    ],
    ids=lambda asked: asked.func.__name__,
)
def test_a_number_that_was_probably_meant_in_another_unit_is_seen(asked, result) -> None:
    found = asked(result.scene, set={"shaft.speed": 600, "revolutions": 1})
    (warning,) = found.warnings
    assert warning.startswith("shaft.speed = 600 is read as 600 rad/s = 5729.578 rev/min")
    assert repr(found).endswith(f"\nwarning: {warning}")
    assert "warning: shaft.speed = 600 is read as" in found._repr_html_()


def test_a_dataset_has_units_and_the_shaft_angle(result: loomfmu.Result) -> None:
    dataset = result.trace.to_xarray()
    assert set(dataset.data_vars) == set(result.trace)
    np.testing.assert_array_equal(dataset["belt.margin"], result.trace["belt.margin"])
    assert dataset["belt.margin"].dims == ("time",) and "shaft_angle" in dataset["belt.margin"].coords
    assert dataset["heald_1.lift"].attrs["units"] == "m" and dataset["shaft_angle"].attrs["units"] == "rad"
    assert dataset["belt.at_risk"].dtype == bool
    with pytest.raises(LoomfmuError, match=r"did you mean 'belt\.margin'"):
        result.trace.to_xarray("belt.margn")
    memory = loomfmu.evaluate(result.scene, values=["heald_1.lift"]).trace
    assert memory.to_xarray("heald_1.lift")["heald_1.lift"].attrs["units"] == "m"


def test_a_folded_dataset_has_whole_revolutions(result: loomfmu.Result) -> None:
    folded = result.trace.to_xarray("belt.margin", "belt.at_risk", fold=True)
    assert dict(folded.sizes) == {"revolution": 2, "angle": 360}
    np.testing.assert_array_equal(folded["revolution"], [1, 2])
    # the samples themselves: nothing is interpolated
    np.testing.assert_array_equal(folded["belt.margin"].values.ravel(), result.trace["belt.margin"][:720])
    np.testing.assert_array_equal(folded["belt.at_risk"].values.ravel(), result.trace["belt.at_risk"][:720])
    for wrong in (-3, 0, 0.5):
        with pytest.raises(LoomfmuError, match=f"fold = {wrong} must be true or a number of angles, 1 or"):
            result.trace.to_xarray("belt.margin", fold=wrong)
    other = result.trace.to_xarray("heald_1.lift", fold=500)
    turned = result.trace.shaft_angle / (2 * np.pi)
    exact = np.interp(np.arange(1000) / 500, turned, result.trace["heald_1.lift"])
    # angles are the same to rounding, and the frame moves by less than a metre in a revolution
    np.testing.assert_allclose(other["heald_1.lift"].values.ravel(), exact, rtol=0, atol=1e-9)


def test_a_revolution_that_was_not_recorded_whole_is_left_out() -> None:
    angle = 2 * np.pi * np.linspace(1.25, 4.25, 1081)  # 360 samples in a revolution
    run = drawn(np.linspace(0.0, 0.3, 1081), turning(angle, 20.0 * np.pi) | {"belt.x": ("m", np.sin(angle))})
    folded = run.to_xarray("belt.x", fold=True)
    assert dict(folded.sizes) == {"revolution": 2, "angle": 360}
    np.testing.assert_array_equal(folded["revolution"], [2, 3])  # the first one began at 90 deg
    np.testing.assert_array_equal(folded["belt.x"].values.ravel(), run["belt.x"][270:990])


def test_a_table_and_a_dataset_have_degrees(result: loomfmu.Result) -> None:
    with pytest.raises(LoomfmuError, match=r"\['belt.margin'\] is not the name of a signal"):
        result.trace.to_pandas(["belt.margin"])
    table = result.to_pandas("belt.at_risk")
    assert list(table.columns) == ["belt.at_risk", "shaft_angle", "degrees"] and table.index.name == "time"
    np.testing.assert_array_equal(table["degrees"], np.degrees(result.trace.shaft_angle))
    folded = result.to_xarray("belt.margin", fold=8)
    np.testing.assert_array_equal(folded["degrees"], np.arange(0, 360, 45))


def test_spans_of_angle_where_a_condition_is_met(result: loomfmu.Result) -> None:
    trace = result.trace
    lift, angle = trace["heald_1.lift"], np.degrees(trace.shaft_angle)
    for comparison in (">", "<="):
        spans = trace.angles_where(f"heald_1.lift {comparison} 40 mm")
        assert len(spans) and np.all(np.diff(spans.ravel()) > 0.0)
        inside = np.any((angle >= spans[:, :1]) & (angle <= spans[:, 1:]), axis=0)
        np.testing.assert_array_equal(inside, lift > 0.04 if comparison == ">" else lift <= 0.04)
        edges = [each for each in spans.ravel() if each not in (angle[0], angle[-1])]
        np.testing.assert_allclose(np.interp(edges, angle, lift), 0.04, atol=1e-12)  # rounding
    assert trace.angles_where("heald_1.lift > 40 m").shape == (0, 2)
    assert len(trace.angles_where("heald_1.lift > 0"))  # which is 0 in any unit
    at_risk = trace["belt.at_risk"]
    (begin, end), *_ = trace.angles_where("belt.at_risk>=1")
    first = int(np.argmax(at_risk))
    assert begin == angle[first] and end == angle[first + int(np.argmin(at_risk[first:]))]


def test_a_condition_is_not_met_where_the_signal_is_not_known() -> None:
    channels = [
        Channel("a", "x", "1", "1", "", 0, beside=Beside(valid_if="sure")),
        Channel("a", "sure", "1", "1", "", 0, real=False, boolean=True),
    ]
    angle = np.arange(6.0)
    run = Recording("known", channels, lambda *_: None)
    known = np.array([[1, 1, 0, 1, 1, 1]], dtype="i4").T
    run.append(angle, np.radians(angle), np.array([[1.0, 1, 1, 1, 0, 2]]).T, known)
    # at 3 it is known again; between 3 and 4, and 4 and 5, it passes 0.5
    np.testing.assert_allclose(run.angles_where("a.x > 0.5"), [[0, 2], [3, 3.5], [4.25, 5]], rtol=1e-15)


@pytest.mark.parametrize(
    ("condition", "message"),
    [
        ("heald_1.lift", "is not a signal, <, <=, > or >=, and a number with its unit"),
        ("heald_1.lift > 40 rpm", "the condition 'heald_1.lift > 40 rpm': "),
        ("heald_1.lift > 40", 'the condition .*: 40 has no unit; write "heald_1.lift > 40 mm"$'),
        ("heald_1.lfit > 40 mm", r"did you mean 'heald_1\.lift'"),
    ],
)
def test_other_conditions_are_refused(result: loomfmu.Result, condition: str, message: str) -> None:
    with pytest.raises(LoomfmuError, match=message):
        result.trace.angles_where(condition)


def test_what_is_shown_is_escaped(result: loomfmu.Result) -> None:
    for shown in (result, result.trace, result.claims[0], loomfmu.evaluate(result.scene)):
        text = shown._repr_html_()
        assert "<script>" not in text and "<b>" not in text
        assert "&lt;script&gt;" in text
        assert "background" not in text  # the notebook's own, light or dark
    verdict = Verdict("c", "a.b", False, 1.0, 0.5, "m", "mm", 0.1, 1.0, 1, sense=1)
    assert "✗" in verdict._repr_html_() and "500 mm" in verdict._repr_html_()


def test_a_result_writes_its_report(result: loomfmu.Result, tmp_path: Path) -> None:
    assert result.report() == result.path.with_suffix(".html")
    assert result.report(tmp_path / "page.html").read_bytes().startswith(b"<!DOCTYPE html>")


def test_a_bar_is_seen_in_a_notebook(monkeypatch: pytest.MonkeyPatch) -> None:
    shown: list[str] = []

    class Handle:
        def update(self, what: Any) -> None:
            shown.append(what._repr_html_())

    def display(what: Any, display_id: bool) -> Handle:
        assert display_id
        shown.append(what._repr_html_())
        return Handle()

    ipython, module = ModuleType("IPython"), ModuleType("IPython.display")
    ipython.get_ipython = lambda: SimpleNamespace(kernel=1)  # type: ignore[attr-defined]
    module.display = display  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "IPython", ipython)
    monkeypatch.setitem(sys.modules, "IPython.display", module)
    monkeypatch.setattr(progress, "SECONDS", 0.0)
    with progress.progress("<loom>", 10) as advance:
        advance(4)
    assert shown[0] == '<progress value="0" max="10"></progress> &lt;loom&gt;: 0 of 10'
    assert 'value="4"' in shown[1] and shown[-1] == ""
