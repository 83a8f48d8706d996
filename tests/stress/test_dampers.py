"""HealdDamper over twelve orders of magnitude: energy, exact swings, contacts beyond number."""

from math import fabs, inf, isfinite, pi, sqrt

import mpmath
import numpy as np
import pytest
from damper_reference import frame
from hypothesis import given, settings
from hypothesis import strategies as st

from loomfmu.components import HealdDamper
from loomfmu.components.heald_damper import MOST_CONTACTS, MOST_PIECES

MP = mpmath.mp.clone()
MP.dps = 40

STIFFNESSES = [10.0**power for power in range(-2, 11, 2)]  # of one spring, N/m
MASSES = [1e-3, 15.0, 1e3]
RATIOS = [0.0, 1e-6, 0.05, 0.999, 1.0, 1.001, 10.0, 100.0]


def released(
    stiffness: float, mass: float, ratio: float, displacement: float, time: float
) -> tuple[float, float]:
    """Displacement and rate after a time, from rest: the closed solution, in 40 digits."""
    own = MP.sqrt(MP.mpf(4) * stiffness / mass)
    decay = MP.mpf(ratio) * own
    root = MP.sqrt(MP.mpc(decay * decay - own * own))
    if root == 0:
        fade = MP.exp(-decay * time)
        return float(displacement * (1 + decay * time) * fade), float(-displacement * own**2 * time * fade)
    one, other = -decay + root, -decay - root
    grown, faded = MP.exp(one * time), MP.exp(other * time)
    return (
        float((displacement * (one * faded - other * grown) / (one - other)).real),
        float((displacement * one * other * (faded - grown) / (one - other)).real),
    )


# Swings with a closed solution


@pytest.mark.few(6)
@pytest.mark.parametrize("ratio", RATIOS)
@pytest.mark.parametrize("mass", MASSES)
def test_a_released_carrier_is_where_the_closed_solution_has_it(mass, ratio):
    for stiffness in STIFFNESSES:
        own = sqrt(4.0 * stiffness / mass)
        damper = HealdDamper(
            carrier_mass=mass,
            spring_stiffness=stiffness,
            damping_ratio=ratio,
            acceleration=0.0,
            free_travel=1.0,
            start_displacement=0.01,
        )
        damper.initialize(0.0)
        time = 0.0
        for size in (1e-9 / own, 0.3 / own, 2.0 / own, 20.0 / own, 1e-3 / own):
            assert damper.step(time, size) == 0
            time += size
            exact, rate = released(stiffness, mass, ratio, 0.01, time)
            # in pieces of half a radian of its own motion, or as short against its damping: up to 2 * 20 (1 +
            # 2 * 100) pieces, each rounded a few times
            assert damper.displacement == pytest.approx(exact, abs=1e-2 * 1e-12)
            assert damper.rate == pytest.approx(rate, abs=1e-2 * own * 1e-12)
        assert damper.stop_contacts == 0


@pytest.mark.few(3)
@pytest.mark.parametrize("ratio", [1.0, 1.001, 10.0, 100.0])
@pytest.mark.parametrize("stiffness", [1e-2, 1e4, 1e10])
def test_an_overcritical_carrier_does_not_overshoot(stiffness, ratio):
    damper = HealdDamper(
        spring_stiffness=stiffness, damping_ratio=ratio, acceleration=0.0, start_displacement=0.01
    )
    damper.initialize(0.0)
    own = sqrt(4.0 * stiffness / HealdDamper().carrier_mass)
    before = damper.displacement
    for n in range(300):
        assert damper.step(n / own, 1.0 / own) == 0
        assert 0.0 <= damper.displacement <= before
        before = damper.displacement
    # what is left of the slow mode after 300 / own: exp(-300 / (2 ratio)) and more
    assert before < 0.01 * max(1.05 * np.exp(-300.0 / (2.0 * ratio)), 1e-12)


# Energy


def energy(damper: HealdDamper) -> float:
    """Stored in springs, stops and motion relative to the frame."""
    deep = max(fabs(damper.displacement) - damper.free_travel, 0.0)
    stop = 0.5 * damper.stop_stiffness * deep * deep if damper.on_stop() else 0.0
    springs = 0.5 * 4.0 * damper.spring_stiffness * damper.displacement**2
    return springs + stop + 0.5 * damper.carrier_mass * damper.rate**2


@pytest.mark.slow
@pytest.mark.parametrize(
    ("steps", "mass", "stiffness"),
    [
        (10**5, 15.0, 5960.0),
        *(
            pytest.param(10**6, *each, marks=pytest.mark.slow)
            for each in ((15.0, 5960.0), (1e-3, 1e9), (1e3, 1e-2))
        ),
    ],
)
def test_an_undamped_swing_keeps_its_energy_over_many_steps(steps, mass, stiffness):
    damper = HealdDamper(
        carrier_mass=mass,
        spring_stiffness=stiffness,
        damping_ratio=0.0,
        acceleration=0.0,
        start_displacement=0.01,
    )
    damper.initialize(0.0)
    start = energy(damper)
    size = 0.37 / sqrt(4.0 * stiffness / mass)
    for n in range(steps):
        damper.step(n * size, size)
    assert damper.stop_contacts == 0
    # steps of one length are rounded to one side, each by less than 1e-16: 2e-17 were seen
    assert energy(damper) == pytest.approx(start, rel=1e-16 * steps)


@pytest.mark.parametrize("stop_stiffness", [1e2, 1e6, 1e12])
@pytest.mark.parametrize("stiffness", [0.0, 5960.0])
@pytest.mark.parametrize("restitution", [1.0, 0.9, 0.15])
def test_stops_give_no_energy(stop_stiffness, stiffness, restitution):
    damper = HealdDamper(
        spring_stiffness=stiffness,
        damping_ratio=0.0,
        acceleration=0.0,
        start_rate=3.0,
        stop_stiffness=stop_stiffness,
        stop_restitution=restitution,
    )
    damper.initialize(0.0)
    before = start = energy(damper)
    # the displacement is rounded once in each of some ten pieces of a contact, and the stop's force, up to
    # sqrt(2 k E), makes energy of that
    deepest = damper.free_travel + sqrt(2.0 * start / stop_stiffness)
    rounding = 20 * 1.1e-16 * deepest * sqrt(2.0 * start * (stop_stiffness + 4.0 * stiffness))
    for n in range(3000):
        assert damper.step(n * 1e-3, 1e-3) == 0
        now = energy(damper)
        assert now <= before + rounding + 1e-15 * start
        before = now
    assert damper.stop_contacts >= 2
    if restitution == 1.0:
        contacts = damper.stop_contacts + 1
        assert before == pytest.approx(start, abs=contacts * rounding + 3000 * 4e-16 * start)


def boole(values: list[float], step: float) -> float:
    """Integral by Boole's rule, of sixth order."""
    found = np.asarray(values)
    blocks = 7 * (found[:-4:4] + found[4::4]) + 32 * (found[1::4] + found[3::4]) + 12 * found[2::4]
    return float(2.0 * step / 45.0 * np.sum(blocks))


@pytest.mark.parametrize("ratio", [0.0, 0.05, 1.0, 10.0])
@pytest.mark.parametrize("speed", [0.01, 20.0, 500.0])
@pytest.mark.parametrize("stiff", [1e-6, 1e-2, 0.3, 30.0, pytest.param(1e4, marks=pytest.mark.slow)])
def test_the_work_of_the_frame_is_stored_or_lost(stiff, speed, ratio):
    # springs from a millionth to ten thousand times as stiff as m w^2: over all speeds sixteen orders
    mass = 15.0
    stiffness = stiff * mass * speed**2 / 4.0
    damper = HealdDamper(
        carrier_mass=mass,
        spring_stiffness=stiffness,
        damping_ratio=ratio,
        free_travel=1.0,
        inputs_at_step_end=True,
    )
    damper.lift, damper.velocity, damper.acceleration = frame(0.0, speed)
    damper.initialize(0.0)
    # short against the motion of the frame, the carrier's own and its damping
    steps = 16 * round(max(720.0, 60.0 * sqrt(stiff) * max(1.0, 2.0 * ratio)) / 16)
    size = 2.0 * pi / speed / steps

    def stored() -> float:
        moving = 0.5 * mass * (damper.velocity + damper.rate) ** 2
        return moving + 0.5 * 4.0 * stiffness * damper.displacement**2

    def powers() -> tuple[float, float]:
        return -damper.transmitted_force * damper.velocity, damper.damping * damper.rate**2

    begun = stored()
    rows = [powers()]
    for n in range(steps):
        damper.lift, damper.velocity, damper.acceleration = frame((n + 1) * size, speed)
        assert damper.step(n * size, size) == 0
        rows.append(powers())
    work, lost = (boole(list(column), size) for column in zip(*rows, strict=True))
    exchanged = size * float(np.sum(np.abs(rows)))
    assert damper.stop_contacts == 0
    # Boole's rule leaves (2 w h)^6 / 945, w the faster of the carrier's own motion and of its damping, 60
    # steps in a turn of which: 1e-8; the jumps of the law's third rate fall on its nodes
    assert work == pytest.approx(stored() - begun + lost, abs=1e-8 * (exchanged + begun))


# Contacts and pieces beyond number


class Counted(HealdDamper):
    """A damper that counts its pieces of motion."""

    pieces = 0

    def move_piece(self, *arguments: float) -> float:
        Counted.pieces += 1
        return HealdDamper.move_piece(self, *arguments)


def step_of(size: float, **parameters: float) -> tuple[int, int, HealdDamper]:
    """Problem and number of pieces of one step."""
    damper = Counted(**parameters)
    assert damper.initialize(0.0) == 0
    Counted.pieces = 0
    return damper.step(0.0, size), Counted.pieces, damper


def test_a_step_that_would_need_too_many_pieces_is_refused_at_once():
    problem, pieces, damper = step_of(3600.0, spring_stiffness=1e12, carrier_mass=1e-3)
    assert (problem, pieces) == (1, 0)
    assert (damper.displacement, damper.rate) == (0.0, 0.0)
    assert "more than 10,000 contacts or pieces" in HealdDamper.problems[0].text
    # and one that needs just fewer is made
    own = sqrt(4.0 * 1e8 / HealdDamper().carrier_mass)
    problem, pieces, damper = step_of(
        0.01 * 0.499 * MOST_PIECES / own, spring_stiffness=1e8, damping_ratio=0.0
    )
    assert problem == 0
    assert pieces == pytest.approx(0.01 * 0.998 * MOST_PIECES, abs=1)


@pytest.mark.slow
def test_a_carrier_that_rattles_for_ever_is_given_up():
    # elastic stops, next to no way between them: a contact is a piece or more
    problem, pieces, damper = step_of(
        50.0,
        spring_stiffness=0.0,
        damping_ratio=0.0,
        stop_stiffness=1e9,
        stop_restitution=1.0,
        free_travel=1e-6,
        start_rate=1.0,
        acceleration=0.0,
    )
    assert (problem, pieces) == (1, MOST_PIECES)
    assert isfinite(damper.displacement)


def test_the_count_of_contacts_ends_where_an_integer_does():
    damper = HealdDamper(
        spring_stiffness=0.0, damping_ratio=0.0, stop_restitution=1.0, start_rate=2.0, acceleration=0.0
    )
    damper.initialize(0.0)
    damper.stop_contacts = MOST_CONTACTS - 3
    for n in range(300):
        assert damper.step(n * 1e-3, 1e-3) == 0
    assert damper.stop_contacts == MOST_CONTACTS == 2**31 - 1


logarithmic = st.floats(-12.0, 12.0).map(lambda power: 10.0**power)


@settings(max_examples=40)
@given(
    mass=st.floats(-3.0, 3.0).map(lambda power: 10.0**power),
    stiffness=st.one_of(st.just(0.0), logarithmic),
    ratio=st.sampled_from(RATIOS),
    travel=st.sampled_from([0.0, 5e-324, 1e-9, 1e-3, 1.0]),
    stop=st.floats(0.0, 12.0).map(lambda power: 10.0**power),
    restitution=st.sampled_from([0.15, 0.5, 1.0]),
    rate=st.sampled_from([0.0, 1e-9, -1.0, 1e3]),
    size=st.floats(-9.0, -2.0).map(lambda power: 10.0**power),
    at_end=st.booleans(),
)
def test_any_damper_moves_or_says_why_not(
    mass, stiffness, ratio, travel, stop, restitution, rate, size, at_end
):
    damper = HealdDamper(
        carrier_mass=mass,
        spring_stiffness=stiffness,
        damping_ratio=ratio,
        free_travel=travel,
        stop_stiffness=stop,
        stop_restitution=restitution,
        start_rate=rate,
        inputs_at_step_end=at_end,
    )
    assert damper.initialize(0.0) == 0
    peak = -inf
    for n in range(4):
        damper.lift, damper.velocity, damper.acceleration = frame((n + 1) * size, 40.0)
        problem = damper.step(n * size, size)
        assert problem in (0, 1)
        if problem:
            return
        shown = (damper.displacement, damper.rate, damper.transmitted_force, damper.acceleration_ratio)
        assert all(map(isfinite, (*shown, damper.peak_load, damper.peak_carrier)))
        assert damper.peak_load >= max(peak, fabs(damper.transmitted_force))
        peak = damper.peak_load
