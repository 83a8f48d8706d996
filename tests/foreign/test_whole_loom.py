"""A whole loom as one FMU under third-party masters: the bits of our own run."""

from pathlib import Path

import numpy as np
import pytest
from fmpy.validation import validate_fmu
from masters import ALONE, check_by_fmutool, demo, ours
from whole_fmus import exported

from loomfmu.cosim.importing.fmus import Fmu
from loomfmu.cosim.scenes import scene as scenes

STEPS = 1000  # in a revolution of 0.1 s: a step is a whole number of nanoseconds
LOOPED = Path(__file__).parents[2] / "sims" / "light_shaft.toml"  # whose loop is iterated inside
SPEED = {"shaft.speed": "600 rpm", "steps_per_revolution": STEPS, "revolutions": 1}


@pytest.mark.slow
@pytest.mark.usefixtures("natives")
@pytest.mark.parametrize("master", ["libcosim", "ecos"])
@pytest.mark.parametrize("looped", [False, True])
def test_it_gives_our_bits(tmp_path: Path, master: str, looped: bool) -> None:
    scene = scenes.load(LOOPED, SPEED) if looped else demo(STEPS)
    expected = ours(scene, tmp_path)
    found = ALONE[master](exported(scene, tmp_path), list(expected), STEPS)
    for signal, values in found.items():
        np.testing.assert_array_equal(values, expected[signal][1:], err_msg=signal)


@pytest.mark.slow
@pytest.mark.parametrize("fmi", [2, 3])
def test_checkers_find_no_fault(natives: dict[str, Fmu], tmp_path: Path, fmi: int) -> None:
    path = exported(demo(STEPS), tmp_path, fmi)
    assert validate_fmu(str(path)) == []
    check_by_fmutool(path, fmi)
