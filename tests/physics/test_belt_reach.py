"""The most that a belt may be deflected by with an energy, against finite elements."""

import math

import numpy as np
import pytest
from belt_reference import FiniteElements

from loomfmu.components.belt_dynamics import BeltDynamics
from loomfmu.physics.belt_moving import instant
from loomfmu.physics.belt_reach import may_reach

LENGTH, BACK = 0.1, -20.0


def reached(guided, share, draw=None):
    """Largest deflection of elements under a point load, or a random one; what their energy may reach."""
    belt = BeltDynamics(bow=0.0, head_end=2 if guided else 1).given()
    motion = (LENGTH, BACK, 0.0)
    elements = FiniteElements(
        lambda _t: motion, lambda x, _length: 0.0 * x, stiffness=belt.stiffness, elements=20, guided=guided
    )
    load = share * belt.stiffness * (math.pi / LENGTH) ** 2
    bending, squeezed = elements.matrices(LENGTH)
    places = elements.places(401)
    if draw is None:
        loads = places[1:-1].T
    else:
        loads = draw.standard_normal((elements.free, 1))
    bent = np.linalg.solve(bending - load * squeezed, loads)
    farthest = np.abs(places @ bent).max(axis=0)
    energy = 0.5 * LENGTH * np.einsum("ni,nm,mi->i", bent, bending, bent)
    at = instant(belt, *motion, 0.0)
    return farthest, np.array([may_reach(belt, at, each, load) for each in energy])


@pytest.mark.parametrize("guided", [False, True])
def test_a_force_at_the_weakest_place_deflects_a_belt_as_far_as_its_energy_can(guided):
    farthest, allowed = reached(guided, 0.0)
    # the constant has four digits, and the weakest place lies between two of 401
    assert (farthest / allowed).max() == pytest.approx(1.0, abs=2e-4)


@pytest.mark.parametrize("guided", [False, True])
@pytest.mark.parametrize("share", [0.0, 0.25, 0.5])
def test_no_shape_exceeds_what_its_energy_can(guided, share):
    draw = np.random.default_rng(7)
    for _ in range(100):
        (farthest,), (allowed,) = reached(guided, share, draw)
        assert farthest <= allowed


def test_nothing_is_known_on_the_way_out_or_under_a_large_push():
    belt = BeltDynamics().given()
    euler = belt.stiffness * (math.pi / LENGTH) ** 2
    assert may_reach(belt, instant(belt, LENGTH, 20.0, 0.0, 0.0), 1e-6, 0.0) == math.inf
    assert may_reach(belt, instant(belt, LENGTH, BACK, 0.0, 0.0), 1e-6, 0.51 * euler) == math.inf
    assert may_reach(belt, instant(belt, LENGTH, BACK, 0.0, 0.0), 1e-6, 0.49 * euler) < 1e-3


def test_a_belt_at_rest_has_its_bow_and_its_weight():
    for given in ({}, {"gravity": 9.81}, {"guide_offset": 1e-4}):
        belt = BeltDynamics(bow_of=2, **given)
        belt.travel, belt.velocity = belt.idle_travel + belt.head_length + LENGTH, BACK
        assert belt.initialize(0.0) == 0
        at = instant(belt.given(), LENGTH, BACK, 0.0, 0.0)
        allowed = may_reach(belt.given(), at, belt.energy, 0.0)
        assert belt.deflection <= allowed < 3.0 * belt.deflection
