"""Lift law of the cam that moves the heald frames directly: a cubic spline through control points.

Source: Korolev, thesis on rotary dobbies (Moscow), section 4 and Appendix 2. Six points, over two picks;
a frame rises in the first and falls in the second, with no dwell of the rotor between.
"""

from math import pi

SPLINE_CAM = 7


def not_a_knot(x: list[float], y: list[float]) -> list[float]:
    """Second derivatives M1 to M6 at six points of the cubic spline with "cubic ends", Appendix 2.

    The first two pieces are one cubic, and so are the last two. With h the distances between the points
    and d the slopes of the chords, for i = 2..5

        h(i-1) M(i-1) + 2 (h(i-1) + h(i)) M(i) + h(i) M(i+1) = 6 (d(i) - d(i-1))

    with `M1 = M2 + (h1/h2)(M2 - M3)` and `M6 = M5 + (h5/h4)(M5 - M4)`; solved by elimination.

    Args:
        x: places, increasing
        y: values there

    >>> places = [0, 1, 2, 4, 5, 6]
    >>> [round(bend, 12) for bend in not_a_knot(places, [place**3 for place in places])]
    [0.0, 6.0, 12.0, 24.0, 30.0, 36.0]
    """
    x1, x2, x3, x4, x5, x6 = x
    y1, y2, y3, y4, y5, y6 = y
    h1 = x2 - x1
    h2 = x3 - x2
    h3 = x4 - x3
    h4 = x5 - x4
    h5 = x6 - x5
    d2 = (y3 - y2) / h2
    d3 = (y4 - y3) / h3
    d4 = (y5 - y4) / h4
    r2 = 6.0 * (d2 - (y2 - y1) / h1) / (h1 + h2)
    r3 = 6.0 * (d3 - d2)
    r4 = 6.0 * (d4 - d3)
    r5 = 6.0 * ((y6 - y5) / h5 - d4) / (h4 + h5)
    # first and last row over h1 + h2 and h4 + h5
    q2 = 2.0 + h1 / h2
    u2 = 1.0 - h1 / h2
    l5 = 1.0 - h5 / h4
    q3 = 2.0 * (h2 + h3) - h2 * u2 / q2
    r3 = r3 - h2 * r2 / q2
    q4 = 2.0 * (h3 + h4) - h3 * h3 / q3
    r4 = r4 - h3 * r3 / q3
    q5 = 2.0 + h5 / h4 - l5 * h4 / q4
    m5 = (r5 - l5 * r4 / q4) / q5
    m4 = (r4 - h4 * m5) / q4
    m3 = (r3 - h3 * m4) / q3
    m2 = (r2 - u2 * m3) / q2
    return [m2 + h1 / h2 * (m2 - m3), m2, m3, m4, m5, m5 + h5 / h4 * (m5 - m4)]


def cam_phase(x: float, top: float) -> tuple[float, float]:
    """Rotor angle as the phase of the cam [rad], its derivative by x [1]: linear to either side of the top.

    A frame driven by the cam has no crank; its rotor angle only shows the pick: 0 at the start of the
    spline, 2 pi at the highest point, 4 pi at the end of two picks.

    Args:
        x: shaft angle from the start of the spline, 0 to 4 pi [rad]
        top: shaft angle of the highest point, between 0 and 4 pi [rad]

    >>> cam_phase(pi, 2.0 * pi) == (pi, 1.0)
    True
    """
    if x <= top:
        rate = 2.0 * pi / top
        return rate * x, rate
    rate = 2.0 * pi / (4.0 * pi - top)
    return 2.0 * pi + rate * (x - top), rate
