"""Race board on one side of the belt: it pushes back where the belt is pressed into its cover."""

from math import cos, pi, sin

from .belt_modes import dot, harmonics
from .belt_moving import Belt

PLACES = 24  # equal parts of the belt, between which it is looked at


def _sines() -> tuple[float, ...]:
    """Sines of 1 to 6 times the angle of each place from the head to the middle."""
    found: tuple[float, ...] = ()
    for place in range(1, PLACES // 2 + 1):
        c1, s1 = cos(pi * place / PLACES), sin(pi * place / PLACES)
        found += (s1, *harmonics(c1, s1)[5:])
    return found


SINES = _sines()


def board_forces(belt: Belt, length: float, q: list[float]) -> tuple[list[float], float]:
    """Forces of the board on the modes [N], and the energy of its cover [J].

    By its stiffness k per length of belt, its distance d from the head's line, and the side s on which it is,
    a belt in whose guide the exit is off by y has the energy

        k / 2 int max(0, s (u + y X / L) - d)^2 dX

    summed over equal parts.
    """
    board = belt.board
    q1, q2, q3, q4, q5, q6 = q
    f1, f2, f3, f4, f5, f6 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    squares = 0.0
    for pair in range(PLACES // 2):
        s1, s2, s3 = SINES[6 * pair], SINES[6 * pair + 1], SINES[6 * pair + 2]
        s4, s5, s6 = SINES[6 * pair + 3], SINES[6 * pair + 4], SINES[6 * pair + 5]
        x = (pair + 1) * (1.0 / PLACES)
        # x and its mirror image have the same sines but for the signs of the even ones
        odd = q1 * s1 + q3 * s3 + q5 * s5
        even = q2 * s2 + q4 * s4 + q6 * s6
        near = board.side * (odd + even + belt.offset * x) - board.distance
        far = board.side * (odd - even + belt.offset * (1.0 - x)) - board.distance
        if near <= 0.0 and far <= 0.0:
            continue
        weight = 0.5 if 2 * (pair + 1) == PLACES else 1.0
        near = near if near > 0.0 else 0.0
        far = far if far > 0.0 else 0.0
        squares = squares + weight * (near * near + far * far)
        odd = weight * (near + far)
        even = weight * (near - far)
        f1 = f1 + odd * s1
        f2 = f2 + even * s2
        f3 = f3 + odd * s3
        f4 = f4 + even * s4
        f5 = f5 + odd * s5
        f6 = f6 + even * s6
    share = board.stiffness * length * (1.0 / PLACES)
    push = -board.side * share
    return [push * f1, push * f2, push * f3, push * f4, push * f5, push * f6], 0.5 * share * squares


def board_matrix(belt: Belt, length: float, q: list[float]) -> list[float]:
    """Rates of the forces of `board_forces`, by the modes and with the opposite sign, row by row [N/m]."""
    board = belt.board
    share = board.stiffness * length * (1.0 / PLACES)
    found = [0.0] * 36
    for place in range(1, PLACES):
        x = place * (1.0 / PLACES)
        pair = place - 1 if 2 * place <= PLACES else PLACES - 1 - place
        even = 1.0 if 2 * place <= PLACES else -1.0
        sines = [SINES[6 * pair + n] * (1.0 if n % 2 == 0 else even) for n in range(6)]
        if board.side * (dot(q, sines) + belt.offset * x) <= board.distance:
            continue
        for row in range(6):
            for column in range(6):
                found[6 * row + column] = found[6 * row + column] + share * sines[row] * sines[column]
    return found
