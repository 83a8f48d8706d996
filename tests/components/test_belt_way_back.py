"""BeltDynamics on its way back: it is let go once it cannot be deflected further than it was under a push."""

import math
import tempfile
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from belt_loom import Loom, ends, shape
from belt_reference import FiniteElements
from compiled import in_c

from loomfmu.components.belt_dynamics import BeltDynamics
from loomfmu.declaring.variables import variables_of
from loomfmu.physics.belt_moving import Belt, Instant

LIMITS = {"WL680-3600": 681.8, "WL800-3600": 553.3, "WL450-4600": 212.6, "WL450-5400": 137.5}  # rev/min


@dataclass(slots=True)
class Followed(BeltDynamics):
    """A belt that is never let go on its way back."""

    def over(self, belt: Belt, at: Instant, load: float) -> bool:
        return False


@cache
def followed():
    with tempfile.TemporaryDirectory(prefix="belt-") as folder:
        return in_c(Followed, Path(folder))


def drawn(number):
    """A random machine, its speed, and a belt in it."""
    draw = np.random.default_rng(number)
    machine = draw.choice(list(LIMITS))
    given = {name: int(draw.integers(1, 3)) for name in ("bow_of", "guide_end", "head_end")}
    given |= {"bow": draw.uniform(0.05e-3, 0.5e-3), "belt_mass": draw.uniform(0.04, 0.065)}
    given |= {"damping": draw.choice([0.0, 20.0]), "gravity": draw.choice([0.0, -9.8, 9.8])}
    given |= {"guide_offset": draw.choice([0.0, draw.uniform(-0.15e-3, 0.15e-3)])}
    return machine, draw.uniform(0.3, 1.3) * LIMITS[machine], given


@pytest.mark.few(8)
@pytest.mark.parametrize("number", range(150))
def test_a_belt_that_is_let_go_would_not_have_been_deflected_further(belt_in_c, number):
    machine, rpm, given = drawn(number)
    let_go, other = (
        Loom(each, rpm, 360, 180.0, machine=machine, **given) for each in (belt_in_c, followed())
    )
    ever, later = False, 0.0
    for degrees in range(182, 284):
        for loom in (let_go, other):
            loom.turn_to(degrees)
        if let_go.belt.released:
            ever = True
            later = max(later, other.belt.deflection)
    for name in ("largest_at_risk", "largest_deflection", "deflection_error"):
        assert getattr(let_go.belt, name) == getattr(other.belt, name), name
    assert later <= let_go.belt.largest_at_risk
    assert let_go.belt.largest_known or not ever  # one that is not let go may be lost
    assert let_go.belt.deflection_known and not let_go.belt.outside


@pytest.mark.slow
@pytest.mark.no_cover
@pytest.mark.parametrize(
    ("machine", "share", "bow_of"),
    [("WL680-3600", 0.88, 1), ("WL680-3600", 0.6, 2), ("WL450-4600", 1.0, 1), ("WL800-3600", 0.9, 2)],
)
def test_finite_elements_stay_within_what_a_belt_may_reach_on_its_way_back(belt_in_c, machine, share, bow_of):
    loom = Loom(belt_in_c, share * LIMITS[machine], 1440, 180.0, machine=machine, bow_of=bow_of, damping=20.0)
    while not loom.belt.released:
        kept = (
            loom.time,
            list(loom.belt.mode),
            list(loom.belt.mode_rate),
            *ends(loom.belt, *loom.motion(loom.time)[:2]),
        )
        loom.turn_to(math.degrees(loom.time * loom.weft.speed) + 0.25)
    start, modes, rates, end, end_rate = kept
    length = loom.motion(start)[0]
    times = [start]
    while loom.motion(times[-1])[0] > 0.3 * length:
        times.append(times[-1] + 0.02 * loom.step_size)
    belt = loom.belt
    wave = math.pi / (0.2 if bow_of == 1 else 1.0)
    elements = FiniteElements(
        loom.motion,
        lambda x, now: (
            -belt.bow
            * (wave / (1.0 if bow_of == 1 else now)) ** 2
            * np.sin((wave * (now - x)) if bow_of == 1 else wave * x / now)
        ),
        stiffness=belt.given().stiffness,
        drag=2.0 * belt.belt_mass * belt.damping,
        elements=8,
    )
    found = np.abs(
        elements.run(
            lambda x: shape(modes, end, 1.0 - x), lambda x: shape(rates, end_rate, 1.0 - x), times, 1e-5, 1e-9
        )
    ).max()
    assert 0.1 * belt.largest_at_risk < found <= belt.largest_at_risk


def test_a_belt_is_let_go_live_as_natively_to_the_same_bits(belt_in_c):
    live, native = (Loom(each, 600.0, 180, 250.0, bow=1e-3) for each in (BeltDynamics, belt_in_c))
    for loom in (live, native):
        loom.belt.largest_at_risk = 5e-3  # as after a stroke
        loom.turn_to(266.0)
        assert loom.belt.released and loom.belt.largest_known
    for variable in variables_of(BeltDynamics):
        assert getattr(live.belt, variable.name) == getattr(native.belt, variable.name), variable.name
