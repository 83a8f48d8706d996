"""Inputs that are driven along a table."""

from fractions import Fraction

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from loomfmu.cosim.scenes.graph import Drive

VALUES = st.floats(-1e6, 1e6, allow_subnormal=False)


@given(
    places=st.lists(st.floats(-100.0, 100.0), min_size=1, max_size=5, unique=True).map(sorted),
    values=st.lists(VALUES, min_size=5, max_size=5),
    at=st.lists(st.floats(-120.0, 120.0), max_size=20),
)
def test_values_lie_on_straight_lines_and_are_held_outside(places, values, at) -> None:
    values = values[: len(places)]
    at = [*at, *places, *np.nextafter(places, -np.inf), *np.nextafter(places, np.inf)]
    found = Drive("belt", "guide_clearance", tuple(places), tuple(values)).along(np.array(at))
    for x, y in zip(at, found.tolist(), strict=True):
        if x <= places[0] or x >= places[-1] or x in places:
            nearest = min(max(x, places[0]), places[-1])
            assert y == values[places.index(nearest)]  # exactly: it may stand at a limit
            continue
        after = next(number for number, place in enumerate(places) if place > x)
        (start, end), (low, high) = (map(Fraction, each[after - 1 : after + 1]) for each in (places, values))
        exact = low + (high - low) * (Fraction(x) - start) / (end - start)
        # four operations, each with a rounding of 2**-53 of values no larger than twice the larger end
        assert abs(Fraction(y) - exact) <= 2 * 4 * 2.0**-53 * max(abs(low), abs(high)) + Fraction(5e-324)
