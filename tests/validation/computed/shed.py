"""Korolev, section 4.1: the shed that an air stream needs."""

from loomfmu.design import shed
from validation.digits import number

CONFUSER = 0.010  # m, diameter D_k
GAPS = (0.005, 0.0015)  # m, above and below it, Table 4.1


def height() -> float:
    """Height of the shed on the axis of the air stream, (4.2) [m]."""
    return CONFUSER + sum(GAPS)


def warp(part: str, gap: float) -> float:
    """Height of the upper or lower warp with a gap to the confuser, (4.4) to (4.7) [m]."""
    middle, half = 0.5 * height(), 0.5 * CONFUSER
    return middle + half + gap if part == "upper" else middle - half - gap


def stream_height() -> float:
    """The same by the design function [m]."""
    return shed.stream_shed_height(CONFUSER, *GAPS)


def angle(near: float) -> float:
    """Angle of the shed with the stream that far from the fell, (4.1) [rad]."""
    return shed.shed_angle(stream_height(), near)


def greatest(near: float) -> float:
    """Greatest height at the healds, six times as far, (4.3) [m]."""
    return shed.greatest_height(angle(near), 6.0 * near)


def _within_pick(*rows: int) -> str:
    """Angles of control points of Table 4.2, the second one in the second pick [deg]."""
    first, second = (float(shed.TABLE_4_2[row].split()[0]) for row in rows)
    return f"{number(first, 0)} and {number(second - 360.0, 0)}"


def entry() -> str:
    """Pick's angle of the weft's entry, raised and lowered warp."""
    return _within_pick(1, 3)


def leave() -> str:
    """Pick's angle of its exit, raised and lowered warp."""
    first, second = _within_pick(0, 2).split(" and ")
    return f"{second} and {first}"
