"""Rates of outputs that no output gives: claims on these outputs are judged between the samples."""

from pathlib import Path

import numpy as np
import pytest
from scene_texts import claim

import loomfmu
from loomfmu.cosim.master.grid import uniform
from loomfmu.cosim.planning.requested import Requested
from loomfmu.cosim.rates import Rates
from loomfmu.cosim.reading import requested
from loomfmu.cosim.scenes.scene import Scene, parse
from loomfmu.cosim.tangents import Tangents

LOOM = """
revolutions = 2
steps_per_revolution = 72
[loom]
machine = "WL680-3600"
weave = "10/01"
reed = true
locks = true
dampers = true
[shaft]
speed = "600 rev/min"
ripple_amplitude = 0.02
ripple_order = 2
"""
SIGNALS = [
    "weft.acceleration",
    "reed.shaft_torque",
    "heald_1.warp_height",
    "dobby.rotor_torque",
    "lock.inertia_torque",
]


def read(*parts: str) -> Scene:
    return requested(parse(LOOM + "".join(parts), "loom"), None, "native").scene


@pytest.mark.parametrize("signal", SIGNALS)
def test_a_rate_is_the_derivative_of_the_samples(signal: str) -> None:
    scene = read(claim("below", signal=signal, bound=1e9))
    fine = requested(scene, {"steps_per_revolution": 14400}, "native").scene
    tangents = _tangents(scene)
    assert tangents
    values, rates = tangents.rates(fine, uniform(fine))[signal]
    step = fine.step_size
    differences = (values[2:] - values[:-2]) / (2.0 * step)
    # at a corner by up to half of the jump; else by h^2 n^2 / 6 of the n-th harmonic: 8e-7 of the fifth
    off = np.abs(differences - rates[1:-1]) - 0.51 * np.abs(rates[2:] - rates[:-2])
    assert off.max() <= 1e-6 * np.abs(rates).max()


@pytest.mark.parametrize("signal", SIGNALS)
def test_the_worst_value_on_few_steps_is_as_near_the_truth_as_its_error(signal: str) -> None:
    scene = parse(LOOM + claim("below", signal=signal, bound=1e9) + claim("above", signal=signal, bound=-1e9))
    truth = loomfmu.evaluate(scene, set={"steps_per_revolution": 5760}).claims
    for verdict, true in zip(loomfmu.evaluate(scene).claims, truth, strict=True):
        assert verdict.holds and "samples" not in verdict.note
        assert abs(verdict.worst - true.worst) <= verdict.error + true.error


@pytest.mark.parametrize("flavour", ["native", "live"])
def test_a_claim_holds_in_a_run_of_either_flavour(tmp_path: Path, flavour: str) -> None:
    scene = parse(LOOM + claim("below", signal="reed.shaft_torque", bound="30 N.m"), "loom")
    with loomfmu.run(scene, output=tmp_path / "run.h5", flavour=flavour).trace as trace:
        (verdict,) = trace.verdicts
        assert verdict.holds
        assert not loomfmu.judge(trace, kind="below", signal="reed.shaft_torque", bound=30.0).decided


@pytest.mark.parametrize(
    ("signal", "more"),
    [
        ("damper_1.spring_force", ""),  # what happens within a step may not show at its ends
        ("belt.deflection", ""),  # the belt may buckle within a step: the extreme is held
        ("reed.shaft_torque", 'component = "DrivenShaft"'),
        (
            "heald_1.warp_height",
            '[wires]\n"heald_1.rotor_angle" = false\n[inputs]\n"heald_1.rotor_angle" = [[0, 0], [1, 6]]\n',
        ),
    ],
)
def test_rates_of_what_has_a_memory_or_a_table_are_not_known(signal: str, more: str) -> None:
    text = LOOM.split("ripple")[0] + more + "\n" if "component" in more else LOOM + more
    judged = claim("below", signal=signal, bound=1e9)
    assert _tangents(requested(parse(text + judged, "loom"), None, "native").scene) is None


def _tangents(scene: Scene) -> Tangents | None:
    asked = Requested(scene)
    return Rates(asked, asked.claims)._tangents
