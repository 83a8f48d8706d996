"""The weft of a standard loom: `yarn = true` wires it to head and belt and changes nothing else."""

import numpy as np
import pytest
from scene_texts import parsed

from loomfmu import LoomfmuError, evaluate

PLAIN = '[loom]\nmachine = "WL680-3600"\n'
WITH_YARN = PLAIN + "yarn = true\n"


def wires(text: str) -> dict[str, str]:
    return {".".join(wire.sink): ".".join(wire.source) for wire in parsed(text).wires}


def test_its_wires() -> None:
    added = wires(WITH_YARN).items() - wires(PLAIN).items()
    assert dict(added) == {
        **{f"yarn.{name}": f"weft.{name}" for name in ("travel", "velocity", "acceleration")},
        **{f"yarn.shaft_{name}": f"shaft.{name}" for name in ("angle", "velocity", "acceleration")},
        "belt.yarn_tension": "yarn.tension",
    }
    assert wires(PLAIN).items() <= wires(WITH_YARN).items()
    cut = wires(WITH_YARN + '[wires]\n"belt.yarn_tension" = false\n')
    assert "belt.yarn_tension" not in cut


def test_a_tension_that_is_given_and_wired_is_refused() -> None:
    with pytest.raises(LoomfmuError, match=r"belt\.yarn_tension"):
        parsed(WITH_YARN, '[belt]\nyarn_tension = "50 cN"\n')


def test_its_tension_is_what_loads_the_belt() -> None:
    values = ["weft.velocity", "yarn.tension", "belt.axial_force", "belt.inertia_force"]
    trace = evaluate(parsed(WITH_YARN, revolutions=1, steps_per_revolution=180), values=values).trace
    inward = trace["weft.velocity"] > 0.0
    carried = np.where(inward, trace["yarn.tension"], 0.0)
    assert carried.max() > 0.5
    # the same sum, the other way round: a rounding of the larger force
    np.testing.assert_allclose(
        trace["belt.axial_force"] - trace["belt.inertia_force"], carried, rtol=0, atol=1e-12
    )
