"""Runs that claims are judged on: of a small loom, and drawn curves."""

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scene_texts as texts
from drawn_runs import drawn, turning
from scene_texts import claim, parsed, verdicts

from loomfmu import Trace, Verdict
from loomfmu.cosim.run import run
from loomfmu.traces import Recording

TURN = 2 * math.pi
Looms = Callable[..., Trace]  # of a loom with other steps, weaves and values
LOOM = "revolutions = 3\n" + texts.LOOM + 'weave = "{weave}"\n{rest}'
DEMO = Path(__file__).parents[1] / "sims" / "wl680_3600.toml"
DAMPED = {"rest": "[damper_1]\n", "shaft__speed": "600 rpm"}


@pytest.fixture(scope="session")
def looms(tmp_path_factory: pytest.TempPathFactory, fmu_cache: None) -> Looms:
    """Traces of a loom: the same one is run once in a process."""
    known: dict[tuple[Any, ...], Trace] = {}
    directory = tmp_path_factory.mktemp("looms")

    def open_(steps: int = 360, weave: str = "10/01", rest: str = "", **values: Any) -> Trace:
        key = (steps, weave, rest, *values.items())
        if key not in known:
            text = LOOM.format(weave=weave, rest=rest)
            scene = replace(parsed(text, steps_per_revolution=steps, **values), name=f"loom_{len(known)}")
            known[key] = run(scene, output=directory / f"{scene.name}.h5").trace
        return known[key]

    return open_


def curve(
    time: np.ndarray,
    value: Callable[[np.ndarray], np.ndarray],
    rate: Callable[[np.ndarray], np.ndarray] | None,
    angle: Callable[[np.ndarray], np.ndarray] = lambda t: t,
) -> Recording:
    """A run of one signal `a.x`, perhaps with its rate, over the angle of a shaft."""
    signals = {"a.x": ("m", value(time), {"rate": "v"}), "a.v": ("m/s", rate(time))} if rate else {}
    signals = signals or {"a.x": ("m", value(time))}
    return drawn(time, {**signals, **turning(angle(time), np.gradient(angle(time), time), 0.0)})


WHOLE_LOOM = texts.loom('weave = "10/01"\nreed = true\nlocks = true\n')


def judged(kind: str, given: Any = (), **values: Any) -> Verdict:
    """The one verdict of a claim on a small loom."""
    usual = {"revolutions": 2, "steps_per_revolution": 180, "heald__warp_ratio": 0.35}
    usual["shaft__speed"] = "600 rev/min"
    (found,) = verdicts(WHOLE_LOOM, claim(kind, **dict(given)), **usual | values)
    return found
