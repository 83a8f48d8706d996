"""The public functions: what they are given of the wrong type is refused in one line."""

from collections.abc import Callable
from importlib import metadata, resources
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import loomfmu
from loomfmu import LoomfmuError, evaluate, judge, run, sweep

SIMS = Path(__file__).parents[2] / "sims"
DEMO: Any = SIMS / "wl680_3600.toml"
SHORT = {"revolutions": 2, "steps_per_revolution": 90}


def short() -> loomfmu.Evaluation:
    return evaluate(DEMO, set=SHORT)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: run(3), "scene = 3 is not a path"),
        (lambda: run(None), "scene = None is not a path"),
        (lambda: run(["a"]), "scene = ['a'] is not a path"),
        (lambda: run(np.zeros((50, 50))), "scene = array("),
        (lambda: evaluate(3), "scene = 3 is not a path"),
        (lambda: sweep(3), "sweep = 3 is not a path"),
        (lambda: run(DEMO, set=3), "set = 3 is not a dictionary such as"),
        (lambda: run(DEMO, set=["shaft.speed"]), "set = ['shaft.speed'] is not a dictionary such as"),
        (lambda: run(DEMO, set={3: 4}), "set = {3: 4} is not a dictionary such as"),
        (lambda: run(DEMO, set={"shaft.speed": None}), f"{DEMO}: shaft.speed: None is not a quantity"),
        (lambda: run(DEMO, set={"machine": ["a"]}), f"{DEMO}: weft.machine = ['a'] is not a name in quotes"),
        (lambda: run(DEMO, output=3), "output = 3 is not a path"),
        (lambda: run(DEMO, flavour=3), "there is no flavour 3; known: live, native"),
        (lambda: run(DEMO, flavour=["live"]), "there is no flavour ['live']"),
        (lambda: evaluate(DEMO, flavour=None), "there is no flavour None"),
        (lambda: evaluate(DEMO, values=3), "values = 3 is not a list such as"),
        (lambda: evaluate(DEMO, values="belt.margin"), "values = 'belt.margin' is not a list such as"),
        (lambda: sweep(DEMO, processes="a"), "processes = 'a' must be 1 or more"),
        (lambda: sweep(DEMO, processes=0), "processes = 0 must be 1 or more"),
        (lambda: sweep(DEMO, scheduler=3), "scheduler = 3 is not an address such as"),
        (lambda: sweep(SIMS / "sweeps" / "safe_speed.toml", output=3), "output = 3 is not a path"),
        (lambda: run(Path(DEMO).read_text()), ("scene = 'title = ", 'scene = "title = ')),
        (lambda: judge(short(), kind="lowest_margin", bound=0), "trace = <Evaluation wl680_3600: all"),
        (lambda: judge("v.h5", kind="lowest_margin", bound=0), "trace = 'v.h5' is not a trace, such as"),
        (
            lambda: judge(short().trace, kind="above", signal=None, bound=0),
            "claim 'above': signal = None is not a name in quotes",
        ),
        (lambda: short().trace[3], "wl680_3600: signal 3 is not recorded"),
        (lambda: short().trace[["a"]], "wl680_3600: signal ['a'] is not recorded"),
    ],
)
def test_what_is_of_the_wrong_type_is_refused_in_one_line(
    call: Callable[[], Any], said: str | tuple[str, ...]
) -> None:
    with pytest.raises(LoomfmuError) as raised:
        call()
    assert str(raised.value).startswith(said)
    assert "\n" not in str(raised.value) and len(str(raised.value)) < 350


def test_a_result_is_shown_in_a_few_lines() -> None:
    found = evaluate(DEMO, set=SHORT | {"shaft.speed": "700 rpm"})
    first, *failing = repr(found).splitlines()
    assert first == f"<Evaluation wl680_3600: {len(failing)} of {len(found.claims)} claims fail:"
    assert len(failing) == 2 and all(line.startswith("  FAILS: the ") for line in failing)
    assert repr(evaluate(DEMO, set=SHORT)) == "<Evaluation wl680_3600: all claims hold>"
    assert repr(found.scene).startswith("<Scene wl680_3600: ")
    assert repr(found.trace).startswith("<Recording wl680_3600: ")


def test_the_package_lists_its_public_names() -> None:
    public = {name for name in dir(loomfmu) if not name.startswith("_")}
    found: dict[str, Any] = {}
    exec("from loomfmu import *", found)
    assert public <= set(found)
    assert {"run", "evaluate", "sweep", "judge", "Trace", "design", "report", "live_page"} <= public
    assert not {"annotations", "Any", "TYPE_CHECKING"} & public
    assert loomfmu.design.loom.safe_speed("WL680-3600").speed > 0.0
    assert all(hasattr(loomfmu.__getattr__(each), "write") for each in ("report", "live_page"))
    assert loomfmu.__version__ == metadata.version("loomfmu")


def test_a_result_is_true_where_all_claims_hold(tmp_path: Path) -> None:
    for speed, holds in (("400 rpm", True), ("700 rpm", False)):
        changed = SHORT | {"shaft.speed": speed}
        for found in (run(DEMO, set=changed, output=tmp_path / "x.h5"), evaluate(DEMO, set=changed)):
            assert bool(found) is found.holds is holds


def test_numbers_of_numpy_are_numbers() -> None:
    changed: dict[str, Any] = SHORT | {"shaft.speed": np.float32(50.0), "steps_per_revolution": np.int64(90)}
    assert evaluate(DEMO, set=changed).scene.speed == 50.0


def test_types_are_exported() -> None:
    assert resources.files(loomfmu).joinpath("py.typed").is_file()


def test_of_extremes_that_only_the_steps_tell_apart_the_first_is_named() -> None:
    # equal in all revolutions; 720 steps in one tell them apart by 6e-9
    found = evaluate(DEMO, set={"shaft.speed": "650 rpm", "steps_per_revolution": 720, "revolutions": 4})
    assert found.claims[0].revolution == 1
