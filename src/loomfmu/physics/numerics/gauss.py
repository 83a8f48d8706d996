"""Gauss-Legendre method of order 6, for second-order equations with stiff modes.

Its stages lie at FIRST, 1/2 and LAST of the step. A stage has the rates `v + h A a` and the values
`q + c h v + h^2 A^2 a`, with the accelerations a of all three: `GAUSS` is A, `SQUARE` its square.
"""

GAUSS_11 = 0.1388888888888889
GAUSS_12 = -0.0359766675249389
GAUSS_13 = 0.009789444015308325
GAUSS_21 = 0.30026319498086457
GAUSS_22 = 0.2222222222222222
GAUSS_23 = -0.022485417203086815
GAUSS_31 = 0.26798833376246944
GAUSS_32 = 0.48042111196938336
GAUSS_33 = 0.1388888888888889
SQUARE_11 = 0.011111111111111112
SQUARE_12 = -0.008288518804609265
SQUARE_13 = 0.0035282403831273087
SQUARE_21 = 0.10240254647510301
SQUARE_22 = 0.027777777777777776
SQUARE_23 = -0.00518032425288079
SQUARE_31 = 0.21869398183909491
SQUARE_32 = 0.16384407436016482
SQUARE_33 = 0.011111111111111112
FIRST = 0.1127016653792583  # (5 - sqrt(15)) / 10
LAST = 0.8872983346207417
OUTER = 5.0 / 18.0  # weights of the first and the last stage in the rate at the end of the step
INNER = 4.0 / 9.0
PLACE_A = 0.24647175961687222  # weights of the stages in the value at the end, (5 + sqrt(15)) / 36
PLACE_B = 2.0 / 9.0
PLACE_C = 0.03130601816090556


def corrected(stiff: float, first: float, second: float, third: float) -> tuple[float, float, float]:
    """Change of the three accelerations of a Gauss step of a mode for what they are off by.

    Solves `(1 + z A^2) d = r` with A the matrix of the Gauss-Legendre method of order 6.

    Args:
        stiff: z, the square of the mode's frequency times that of the step, not negative [1]
        first, second, third: what the accelerations at the three stages are off by [m/s2]

    >>> corrected(0.0, 1.0, 2.0, 3.0)
    (1.0, 2.0, 3.0)
    """
    return solved(
        1.0 + stiff * SQUARE_11,
        stiff * SQUARE_12,
        stiff * SQUARE_13,
        stiff * SQUARE_21,
        1.0 + stiff * SQUARE_22,
        stiff * SQUARE_23,
        stiff * SQUARE_31,
        stiff * SQUARE_32,
        1.0 + stiff * SQUARE_33,
        first,
        second,
        third,
    )


def solved(
    a11: float,
    a12: float,
    a13: float,
    a21: float,
    a22: float,
    a23: float,
    a31: float,
    a32: float,
    a33: float,
    first: float,
    second: float,
    third: float,
) -> tuple[float, float, float]:
    """Solution of three linear equations, by the adjugate.

    >>> solved(2.0, 0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 0.0, 8.0, 2.0, 4.0, 8.0)
    (1.0, 1.0, 1.0)
    """
    m1 = a22 * a33 - a23 * a32
    m2 = a23 * a31 - a21 * a33
    m3 = a21 * a32 - a22 * a31
    whole = a11 * m1 + a12 * m2 + a13 * m3
    return (
        (m1 * first + (a13 * a32 - a12 * a33) * second + (a12 * a23 - a13 * a22) * third) / whole,
        (m2 * first + (a11 * a33 - a13 * a31) * second + (a13 * a21 - a11 * a23) * third) / whole,
        (m3 * first + (a12 * a31 - a11 * a32) * second + (a11 * a22 - a12 * a21) * third) / whole,
    )


def held(
    weight: float,
    y11: float,
    y12: float,
    y13: float,
    y21: float,
    y22: float,
    y23: float,
    y31: float,
    y32: float,
    y33: float,
    s1: float,
    s2: float,
    s3: float,
) -> tuple[float, float, float]:
    """Reactions r at the three stages of a spring that ties modes together: `r = weight (s - y r)`.

    Args:
        weight: of the spring
        y11 .. y33: how far its end yields to its reactions
        s1 .. s3: how far it would move without it

    >>> held(1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 2.0, 4.0, 6.0)
    (1.0, 2.0, 3.0)
    """
    return solved(
        1.0 + weight * y11,
        weight * y12,
        weight * y13,
        weight * y21,
        1.0 + weight * y22,
        weight * y23,
        weight * y31,
        weight * y32,
        1.0 + weight * y33,
        weight * s1,
        weight * s2,
        weight * s3,
    )


def stage(
    by_rate: float,
    by_a: float,
    by_b: float,
    by_c: float,
    q1: float,
    q2: float,
    q3: float,
    q4: float,
    q5: float,
    q6: float,
    v1: float,
    v2: float,
    v3: float,
    v4: float,
    v5: float,
    v6: float,
    a1: float,
    a2: float,
    a3: float,
    a4: float,
    a5: float,
    a6: float,
    b1: float,
    b2: float,
    b3: float,
    b4: float,
    b5: float,
    b6: float,
    c1: float,
    c2: float,
    c3: float,
    c4: float,
    c5: float,
    c6: float,
) -> tuple[float, float, float, float, float, float]:
    """Six values at a stage: `q + by_rate v + by_a a + by_b b + by_c c`.

    Args:
        by_rate, by_a, by_b, by_c: share of the step and a row of `SQUARE`, times the step and its square; for
            rates 0 and a row of `GAUSS`, times the step
        q1 .. q6: values at the start of the step, or rates
        v1 .. v6: rates at the start
        a1 .. c6: accelerations at the three stages

    >>> stage(1.0, 1.0, 1.0, 1.0, *range(6), *range(6), *range(6), *range(6), *range(6))
    (0.0, 5.0, 10.0, 15.0, 20.0, 25.0)
    """
    return (
        q1 + (by_rate * v1 + (by_a * a1 + by_b * b1 + by_c * c1)),
        q2 + (by_rate * v2 + (by_a * a2 + by_b * b2 + by_c * c2)),
        q3 + (by_rate * v3 + (by_a * a3 + by_b * b3 + by_c * c3)),
        q4 + (by_rate * v4 + (by_a * a4 + by_b * b4 + by_c * c4)),
        q5 + (by_rate * v5 + (by_a * a5 + by_b * b5 + by_c * c5)),
        q6 + (by_rate * v6 + (by_a * a6 + by_b * b6 + by_c * c6)),
    )
