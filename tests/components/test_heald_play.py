"""HealdPlay: against flights in closed form, and against an integration with events."""

from math import pi

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from loomfmu.components import HealdPlay


def test_a_fall_from_bar_to_bar_and_its_rebounds():
    # free fall over the play: u = sqrt(2 g d); each rebound has e times the speed, and takes 2 e^k u / g
    play = HealdPlay(acceleration=0.0, play=0.004)
    play.initialize(0.0)
    play.side, play.displacement = 0, 0.002
    g, fall = play.gravity, 0.004
    speed = (2 * g * fall) ** 0.5
    first = speed / g
    assert play.step(0.0, first * (1.0 + 1e-9)) == 0
    assert play.blows == 1
    assert play.hardest_blow == pytest.approx(speed, rel=1e-12)
    assert play.largest_impulse == pytest.approx(1.5 * 0.003 * speed, rel=1e-12)
    assert play.step(first, 1.0) == 0
    expected = sum(0.5**k * speed >= play.least_speed for k in range(50))
    assert play.blows == expected
    # the way: the fall, and twice each rebound of height e^2k d, down to the last one that is counted
    assert play.travel == pytest.approx(
        fall + sum(2 * 0.25**k * fall for k in range(1, expected + 1)), rel=1e-9
    )
    assert (play.side, play.displacement, play.rate) == (-1, -0.002, 0.0)


def bars(time, w=60.0, a=0.01):
    return a * np.sin(w * time), a * w * np.cos(w * time), -a * w * w * np.sin(w * time)


def integrated(play, end):
    """Blows, hardest blow and last displacement by scipy; the heald starts in flight, half-way."""
    reach, e, time, state, blows, hardest = 0.5 * play.play, play.restitution, 0.0, np.zeros(2), 0, 0.0
    while time < end:
        up = lambda t, s: s[0] - reach  # noqa: E731
        down = lambda t, s: -s[0] - reach  # noqa: E731
        for event in (up, down):
            event.terminal, event.direction = True, 1.0
        run = solve_ivp(
            lambda t, s: (s[1], -play.gravity - bars(t)[2]),
            (time, end),
            state,
            method="DOP853",
            rtol=1e-12,
            atol=1e-15,
            max_step=1e-3,
            events=[up, down],
        )
        time, state = run.t[-1], run.y[:, -1]
        if run.status == 1:
            blows, hardest = blows + 1, max(hardest, abs(state[1]))
            state = np.array([np.sign(state[0]) * reach, -e * state[1]])
    return blows, hardest, state[0]


@pytest.mark.parametrize("steps", [60, 240])
def test_blows_on_shaken_bars_against_an_integration(steps):
    # shaken at 36 m/s2 the heald strikes one bar after the other; until it first comes to rest
    end = 0.5 * 2 * pi / 60.0
    play = HealdPlay(inputs_at_step_end=True, restitution=0.9, play=0.004)
    play.lift, play.velocity, play.acceleration = bars(0.0)
    play.initialize(0.0)
    play.side, play.displacement = 0, 0.0
    h = end / steps
    for n in range(steps):
        play.lift, play.velocity, play.acceleration = bars((n + 1) * h)
        assert play.step(n * h, h) == 0
    blows, hardest, displacement = integrated(play, end)
    assert play.blows == blows > 0
    # the quintic through the samples is off by (w h)^6 / 46080 of the amplitude: 1e-14
    assert play.hardest_blow == pytest.approx(hardest, rel=1e-9)
    assert play.displacement == pytest.approx(displacement, abs=1e-10)


def test_a_step_of_any_length_gives_the_same():
    found = []
    for steps in (1, 7):
        play = HealdPlay(acceleration=5.0)
        play.initialize(0.0)
        play.side, play.displacement = 0, 0.0
        for n in range(steps):
            play.step(n * 0.7 / steps, 0.7 / steps)
        found.append((play.blows, play.hardest_blow, play.travel))
    assert found[0] == pytest.approx(found[1], rel=1e-9)


def test_a_heald_leaves_its_bar_where_it_presses_no_more():
    # bars whose acceleration passes -g slowly: the heald leaves the lower bar with no acceleration at all
    def lowered(time):
        # y'' = -200 t: w'' = 200 t - g turns positive at g / 200
        return -200.0 * time**3 / 6.0, -100.0 * time**2, -200.0 * time

    play = HealdPlay(inputs_at_step_end=True, play=1.0)
    play.lift, play.velocity, play.acceleration = lowered(0.0)
    play.initialize(0.0)
    for n in range(100):
        play.lift, play.velocity, play.acceleration = lowered((n + 1) * 1e-3)
        assert play.step(n * 1e-3, 1e-3) == 0
    left = play.gravity / 200.0
    assert play.displacement + 0.5 == pytest.approx(200.0 * (0.1 - left) ** 3 / 6.0, rel=1e-9)
    assert play.blows == 0
