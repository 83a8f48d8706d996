"""The law with a plateau: integrated in fifty digits from its acceleration, closed, and its exact peaks."""

from math import pi, radians

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from reference import MP

from loomfmu.physics.rotor_laws.plateau import plateau_law, plateau_peaks

INFERRED = (0.25 * pi, radians(40.9))
CASES = [INFERRED, (0.0, 1.0), (1.0, pi - 1.0), (0.0, pi), (3.0, 0.02)]
reductions = st.floats(0.0, 1.0)
shapes = st.tuples(st.floats(0.0, 1.0), st.floats(0.02, 1.0)).map(
    lambda shares: (shares[0] * (pi - 0.05), shares[1] * (pi - shares[0] * (pi - 0.05)))
)


@pytest.mark.no_cover
@pytest.mark.parametrize("reduction", [0.3, 0.7, 1.0])
@pytest.mark.parametrize(("plateau", "ramp"), CASES)
def test_law_is_its_acceleration_integrated_twice(reduction, plateau, ramp):
    z, p, r = MP.mpf(reduction), MP.mpf(plateau), MP.mpf(ramp)

    def hump(x):  # of area 1, on the ramp alone
        return (1 - MP.cos(2 * MP.pi * (x - p) / r)) / r if p < x < p + r else MP.mpf(0)

    def part(weight, x):
        knots = [knot for knot in (0, p, p + r / 3, p + r / 2, p + r) if knot < x]
        return MP.quad(weight, [*knots, x]) if x > 0 else MP.mpf(0)

    def turned(x):  # without the scale of the hump
        return part(lambda t: (x - t) * hump(t), x)

    gain = z * MP.pi / turned(MP.pi)  # half a turn of the shaft is half a turn of the rotor
    for x in (0.0, 0.1, 0.5 * plateau, plateau, plateau + 0.3 * ramp, plateau + 0.9 * ramp, 2.5, 3.1):
        exact = MP.mpf(x)
        angle = (1 - z) * exact + gain * turned(exact)
        speed = 1 - z + gain * part(hump, exact)
        found = plateau_law(x, reduction, plateau, ramp)
        # a few roundings of angles up to pi, speeds up to 100 (a gain of z pi / r) and of 2 gain / r
        assert abs(found[0] - angle) < 2e-15 * max(1, gain)
        assert abs(found[1] - speed) < 2e-15 * max(1, gain)
        assert abs(found[2] - gain * hump(exact)) < 1e-14 * max(1, gain / r**2)


@given(reductions, shapes, st.floats(0.0, pi))
def test_law_closes_and_is_symmetric(reduction, shape, x):
    angle, speed, second = plateau_law(x, reduction, *shape)
    other = plateau_law(2.0 * pi - x, reduction, *shape)
    fastest, largest, steepest = plateau_peaks(reduction, *shape)
    # 2 pi - x is rounded to 4e-16 twice, times the next derivative
    assert angle + other[0] == pytest.approx(2.0 * pi, abs=4e-15 * max(1.0, fastest))
    assert other[1] == pytest.approx(speed, abs=2e-15 * (fastest + largest))
    assert other[2] == pytest.approx(-second, abs=2e-15 * (largest + steepest))
    assert 1.0 - reduction <= speed <= fastest * (1.0 + 1e-15)


@given(reductions, shapes)
def test_peaks_are_exact(reduction, shape):
    plateau, ramp = shape
    speed, acceleration, jerk = plateau_peaks(reduction, plateau, ramp)
    assert plateau_law(pi, reduction, plateau, ramp)[1] == pytest.approx(speed, rel=1e-15)
    # acceleration: in the middle of the ramp; jerk: at its first quarter, by a central difference, which
    # misses a sine of that wave by h^2 / 6 of (2 pi / r)^2; x is rounded to 4e-16
    middle, quarter, h = plateau + 0.5 * ramp, plateau + 0.25 * ramp, 1e-4 * ramp
    found = plateau_law(middle, reduction, plateau, ramp)[2]
    assert found == pytest.approx(acceleration, rel=1e-13)
    low, high = (plateau_law(quarter + side * h, reduction, plateau, ramp)[2] for side in (-1.0, 1.0))
    assert (high - low) / (2.0 * h) == pytest.approx(jerk, rel=1e-6, abs=1e-10)
    grid = np.linspace(0.0, 2.0 * pi, 2001)
    rates = np.array([plateau_law(float(x), reduction, plateau, ramp) for x in grid])
    assert rates[:, 1].max() <= speed * (1.0 + 1e-15)
    assert abs(rates[:, 2]).max() <= acceleration * (1.0 + 1e-15)
    assert abs(np.diff(rates[:, 2])).max() / grid[1] <= jerk * (1.0 + 1e-9) + 1e-9
