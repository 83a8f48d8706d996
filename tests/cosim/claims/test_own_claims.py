"""Claims of one's own: a class in a Python file beside the scene."""

import json
import math
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from drawn_runs import drawn, turning
from scene_texts import claim, loom, parsed

import loomfmu
from loomfmu.claim import OwnClaim, Quantity, Signals, argument
from loomfmu.cosim.claims.claims import kinds
from loomfmu.cosim.scenes.scene import files_of
from loomfmu.cosim.ssp.export import export
from loomfmu.declaring.variables import Beside
from loomfmu.errors import LoomfmuError

MEAN = '''"""Claims."""
import numpy as np
from loomfmu.claim import Name, OwnClaim, Quantity, Signals, argument

class Dwell(OwnClaim):  # the name of a kind of the package
    """The mean of a lift."""
    at_most: float = argument(Quantity("m", "mm", usual=0.05))
    heald: str = argument(Name(), "heald_1")
    needs = ("heald.lift",)

    def value(self, run: Signals) -> float:
        lift = run[f"{self.heald}.lift"]
        return float(np.trapezoid(lift, run.time) / (run.time[-1] - run.time[0]))
'''
LOOM = loom('weave = "10/01"\n')


def scene(folder: Path, text: str = MEAN, kind: str = "own.py:Dwell", **arguments: Any) -> Any:
    """A scene with a claim of such a file."""
    (folder / "own.py").write_text(text)
    given = {"at_most": "60 mm"} | arguments
    return parsed(LOOM, claim(kind, **given), directory=folder, revolutions=2, steps_per_revolution=180)


def test_its_number_is_judged_with_an_error_in_runs_and_searches(tmp_path: Path) -> None:
    package = dict(kinds())
    with loomfmu.prepare(scene(tmp_path)) as ready:
        found = ready.evaluate().claims[0]
        assert (found.word, found.claim, found.signal) == ("holds", "dwell", "own.py:Dwell")
        # the frame dwells at either end for as long, so that its mean is half of its stroke of 98 mm; to the
        # rectangle of the last step, 0.5 % of it
        assert math.isclose(found.worst, 0.049, rel_tol=6e-3)
        assert 0.0 < found.error < 1e-3 and found.display_unit == "mm"
        assert ready.evaluate({"heald_1.stroke": "150 mm"}).claims[0].word == "FAILS"
        result = ready.run(output=tmp_path / "own.h5")
    assert result.claims[0].worst == found.worst
    assert json.loads(result.trace.attributes["files"]) == {"own.py": MEAN}
    assert dict(kinds()) == package  # it takes the place of none


def test_its_file_is_an_input_and_a_package_refuses_it(tmp_path: Path) -> None:
    made = scene(tmp_path)
    assert tmp_path / "own.py" in files_of(made)
    with pytest.raises(LoomfmuError, match=r"own.py:Dwell judges a claim, and a system package holds no"):
        export(made, tmp_path / "own.ssp")
    found = loomfmu.prove(made).claims[0]
    assert found.why == "it is judged by Python code of its own"


@pytest.mark.parametrize(
    ("old", "new", "why"),
    [
        ("Quantity(", "Quantitty(", "own.py, line 7: NameError: name 'Quantitty' is not defined"),
        ('= argument(Quantity("m", "mm", usual=0.05))', "= 0.0", "line 5: Dwell.at_most is not declared by"),
        ("at_most", "bound", "line 5: Dwell must have one bound: at_most or at_least"),
        ("def value", "def worth", "own.py:Dwell': Dwell has no method value"),
        ("Dwell(", "Well(", "own.py: it has no claim 'Dwell'; did you mean 'Well'?"),
        ('"heald.lift"', '"heald.left"', "heald_1 has no output 'left'; did you mean 'lift'?"),
        ("run.time[0]))", "run.time[0])", "own.py, line 13: '(' was never closed"),
        ("lift = run", "lift = run / 0 *", "own.py, line 12: TypeError: unsupported operand"),
        ("return float", "return str", "own.py:Dwell: value = '0.04"),
        ("[0]))", "[0])), 1, 2", "is neither a number nor a number and its time"),
    ],
)
def test_each_mistake_gives_one_line_with_its_place(tmp_path: Path, old: str, new: str, why: str) -> None:
    with pytest.raises(LoomfmuError) as error:
        loomfmu.evaluate(scene(tmp_path, MEAN.replace(old, new)))
    assert why in str(error.value)


def test_arguments_are_read_and_doubted_as_those_of_any_kind(tmp_path: Path) -> None:
    with pytest.raises(LoomfmuError, match=r"claim 'own.py:Dwell' has no 'healt'; did you mean 'heald'\?"):
        loomfmu.evaluate(scene(tmp_path, healt="heald_2"))
    with pytest.raises(LoomfmuError, match="at_most: '3 s' is in s, which does not fit m"):
        loomfmu.evaluate(scene(tmp_path, at_most="3 s"))
    assert any("is read as 60 m" in note for note in loomfmu.evaluate(scene(tmp_path, at_most=60)).warnings)


def test_only_a_scene_names_a_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "own.py").write_text("import os\nos.environ['OWN_RAN'] = 'yes'\n")
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("OWN_RAN", raising=False)
    trace = drawn(np.linspace(0.0, 1.0, 9), turning(np.linspace(0.0, 7.0, 9), 7.0))
    with pytest.raises(LoomfmuError, match="only the file of a scene can name a Python file"):
        loomfmu.judge(trace, kind="own.py:Dwell", at_most=1.0)  # type: ignore[arg-type]
    assert "OWN_RAN" not in os.environ


class Last(OwnClaim):
    """The last value of a signal."""

    at_least: float = argument(Quantity("m", "mm"))

    def signals(self, scene: Any) -> list[str]:
        return ["a.x"]

    def value(self, run: Signals) -> tuple[float, float]:
        return run["a.x"][-1], run.time[-1]


def test_a_class_judges_a_run_and_nothing_holds_where_its_signals_are_not_known() -> None:
    time = np.linspace(0.0, 1.0, 101)
    shaft = turning(2.0 * math.pi * time, 2.0 * math.pi)
    known = drawn(time, {"a.x": ("m", time), **shaft})
    found = Last(at_least=0.5).judge(known)
    assert (found.word, found.worst, found.time, found.sense) == ("holds", 1.0, 1.0, 1)
    assert Last(at_least=1.5).judge(known).word == "FAILS"
    unsure = {"a.x": ("m", time, {"beside": Beside(valid_if="sure")}), "a.sure": ("1", time > 0.5)}
    found = Last(at_least=0.5).judge(drawn(time, {**unsure, **shaft}))
    assert (found.word, found.note) == (
        "undecided",
        "not known throughout the run, as a.sure is false in part of it",
    )
    short = drawn(time, {"a.x": ("m", time), **turning(time, 1.0)}, lambda *_: None, {}, {"a": "X"})
    assert Last(at_least=0.5).judge(short).word == "undecided"  # not a whole revolution
