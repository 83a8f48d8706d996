"""Gauss-Legendre method of order 6, for second-order equations with stiff modes.

Its stages lie at FIRST, 1/2 and LAST of the step. A stage has the rates `v + h A a` and the values
`q + c h v + h^2 A^2 a`, with the accelerations a of all three: `RATES` is A, `VALUES` its square, row by row,
and in the fourth row the weights at the end of the step. Accelerations of six modes at all stages are a list
of 18, stage by stage.
"""

FIRST = 0.1127016653792583  # (5 - sqrt(15)) / 10
LAST = 0.8872983346207417
SHARES = (FIRST, 0.5, LAST, 1.0)
OUTER = 5.0 / 18.0  # weights of the first and the last stage in the rate at the end of the step
INNER = 4.0 / 9.0
RATES = (
    *(0.1388888888888889, -0.0359766675249389, 0.009789444015308325),
    *(0.30026319498086457, 0.2222222222222222, -0.022485417203086815),
    *(0.26798833376246944, 0.48042111196938336, 0.1388888888888889),
    *(OUTER, INNER, OUTER),
)
VALUES = (
    *(0.011111111111111112, -0.008288518804609265, 0.0035282403831273087),
    *(0.10240254647510301, 0.027777777777777776, -0.00518032425288079),
    *(0.21869398183909491, 0.16384407436016482, 0.011111111111111112),
    *(0.24647175961687222, 2.0 / 9.0, 0.03130601816090556),
)


def corrected(stiff: float, off: list[float]) -> list[float]:
    """Change of the three accelerations of a Gauss step of a mode for what they are off by.

    Solves `(1 + z A^2) d = r` with A the matrix of the Gauss-Legendre method of order 6.

    Args:
        stiff: z, the square of the mode's frequency times that of the step, not negative [1]
        off: r, what the accelerations at the three stages are off by [m/s2]

    >>> corrected(0.0, [1.0, 2.0, 3.0])
    [1.0, 2.0, 3.0]
    """
    a = [stiff * VALUES[n] for n in range(9)]
    return solved(a, off)


def solved(a: list[float], b: list[float]) -> list[float]:
    """Solution x of `(1 + a) x = b`, three linear equations, by the adjugate; a is given row by row.

    >>> solved([1.0, 0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0, 7.0], [2.0, 4.0, 8.0])
    [1.0, 1.0, 1.0]
    """
    a11, a12, a13, a21, a22, a23, a31, a32, a33 = a
    first, second, third = b
    a11 = 1.0 + a11
    a22 = 1.0 + a22
    a33 = 1.0 + a33
    m1 = a22 * a33 - a23 * a32
    m2 = a23 * a31 - a21 * a33
    m3 = a21 * a32 - a22 * a31
    whole = a11 * m1 + a12 * m2 + a13 * m3
    return [
        (m1 * first + (a13 * a32 - a12 * a33) * second + (a12 * a23 - a13 * a22) * third) / whole,
        (m2 * first + (a11 * a33 - a13 * a31) * second + (a13 * a21 - a11 * a23) * third) / whole,
        (m3 * first + (a12 * a31 - a11 * a32) * second + (a11 * a22 - a12 * a21) * third) / whole,
    ]


def held(weight: float, y: list[float], s: list[float]) -> list[float]:
    """Reactions r at the three stages of a spring that ties modes together: `r = weight (s - y r)`.

    Args:
        weight: of the spring
        y: how far its end yields to its reactions, row by row
        s: how far it would move without it

    >>> held(1.0, [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0], [2.0, 4.0, 6.0])
    [1.0, 2.0, 3.0]
    """
    a = [weight * y[n] for n in range(9)]
    b = [weight * s[n] for n in range(3)]
    return solved(a, b)


def weighted(
    by_rate: float, weights: list[float], q: list[float], v: list[float], a: list[float]
) -> list[float]:
    """Six values `q + by_rate v +` the accelerations a at the three stages by their weights.

    >>> weighted(1.0, [1.0, 1.0, 1.0], [0.0] * 6, [1.0] * 6, [1.0] * 18)
    [4.0, 4.0, 4.0, 4.0, 4.0, 4.0]
    """
    by_a, by_b, by_c = weights
    return [q[n] + (by_rate * v[n] + (by_a * a[n] + by_b * a[n + 6] + by_c * a[n + 12])) for n in range(6)]


def at_stage(
    number: int, step: float, q: list[float], v: list[float], a: list[float]
) -> tuple[list[float], list[float]]:
    """Values and rates at a stage, 0 to 2, or at the end of the step, 3.

    Args:
        number: of the stage
        step: duration [s]
        q, v: values at the start of the step, and their rates
        a: accelerations at the stages

    >>> at_stage(3, 2.0, [0.0] * 6, [1.0] * 6, [0.0] * 18)[0]
    [2.0, 2.0, 2.0, 2.0, 2.0, 2.0]
    """
    square = step * step
    by_value = [square * VALUES[3 * number + n] for n in range(3)]
    by_rate = [step * RATES[3 * number + n] for n in range(3)]
    return weighted(step * SHARES[number], by_value, q, v, a), weighted(0.0, by_rate, v, v, a)


def foreseen(longer: float, a: list[float]) -> list[float]:
    """Accelerations at the stages of the next step, so much longer, on the parabola of those of the last.

    >>> foreseen(1.0, [1.0] * 18)[:2]
    [1.0, 1.0]
    """
    none = [0.0] * 6
    found = [0.0] * 18
    for stage in range(3):
        far = (1.0 + SHARES[stage] * longer - 0.5) / (LAST - 0.5)
        square = far * far
        ahead = weighted(0.0, [0.5 * (square - far), 1.0 - square, 0.5 * (square + far)], none, none, a)
        for n in range(6):
            found[6 * stage + n] = ahead[n]
    return found
