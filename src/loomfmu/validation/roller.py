"""Study of the detaching rollers of the comber JSFA588: Tables 1 and 2."""

import math
from dataclasses import dataclass
from functools import cache

from ..components.detaching_roller import DetachingRoller
from ..physics.detaching_roller import drafting_force, top_roller_torque
from .sections import COMPUTED, DERIVED, Chapter, Pair, Row, Section, consistent, number

ROLLER, TOP = 12.5e-3, 12.25e-3
ROLLER_INERTIA, TOP_INERTIA = 135.64e-6, 33.98e-6
NIPS = math.pi / 30.0
POINTS = 4000  # in a nip
LOAD = "whether 300 N load a side or a whole top roller was chosen by it"

TORQUES = {
    "M11": "drafting_torque",
    "M12": "top_roller_torque",
    "M13": "inertia_torque",
    "M1": "back_torque",
    "M2": "front_torque",
    "M": "unit_torque",
    "M0": "machine_torque",
}
# Table 1, N m: peak and valley; the valleys with the minus sign that they have lost
TABLE_1 = {
    "M11": ("0.68", ""),
    "M12": ("0.31", "-0.14"),
    "M13": ("1.18", "-0.53"),
    "M1": ("1.36", "-0.46"),
    "M2": ("1.36", "-0.61"),
}
# Table 2, N m: nips/min, torque, peak and valley
TABLE_2 = (
    ("300", "M", "2.73", "-1"), ("300", "M0", "21.84", "-8"),
    ("400", "M", "4.85", "-1.9"), ("400", "M0", "38.80", "-15.2"),
    ("500", "M", "7.57", "-3.06"), ("500", "M0", "60.56", "-24.48"),
)  # fmt: skip


@dataclass(frozen=True)
class Extremes:
    """Highest and lowest value of a torque over a nip [N m]."""

    peak: float
    valley: float


@cache
def extremes(nips: float) -> dict[str, Extremes]:
    """Extremes of every torque with the built-in motion."""
    machine = DetachingRoller(speed=nips * NIPS)
    machine.initialize(0.0)
    step = 2.0 * math.pi / (nips * NIPS) / POINTS
    found: dict[str, list[float]] = {name: [] for name in TORQUES}
    for n in range(POINTS):
        machine.step(n * step, 0.0)
        for name, variable in TORQUES.items():
            found[name].append(getattr(machine, variable))
    return {name: Extremes(max(values), min(values)) for name, values in found.items()}


def chapter() -> Chapter:
    """All of the detaching rollers."""
    return Chapter(
        "Detaching rollers of a comber (Cotton Textile Technology (2020) no. 4, article 5)",
        "The motion of the rollers and the fibres in the nip are in figures that are lost. The first table"
        " has the torques that follow from the published ones by the source's own equations, the next two"
        " those of the built-in motion, an assumption that matches the peak and the valley of M13.",
        (from_table(), built_in(), table_2(), against_itself()),
    )


def from_table() -> Section:
    """Torques that follow from the published extremes of M13."""
    rows = []
    acceleration = {"peak": 1.18 / ROLLER_INERTIA, "valley": -0.53 / ROLLER_INERTIA}
    m12 = {k: top_roller_torque(e, ROLLER, TOP, TOP_INERTIA) for k, e in acceleration.items()}
    m11 = ROLLER * drafting_force(1.0, 0.33, 300.0, m12["valley"] / ROLLER)
    rows.append(Row(("M12, peak, (11)", Pair("0.31", m12["peak"], 4))))
    rows.append(Row(("M12, valley", Pair("-0.14", m12["valley"], 4)), "printed without its sign: see Errata"))
    rows.append(
        Row(("M11, largest number of fibres, M12 = -0.138 N m, (19)", Pair("0.68", m11, 4, used=True)), LOAD)
    )
    rows.append(Row(("M2, peak, (13)", Pair("1.36", 1.18 + m12["peak"], 4, misprint=True))))
    rows.append(Row(("M2, valley", Pair("-0.61", -0.53 + m12["valley"], 4, misprint=True))))
    return Section(
        "Table 1: torques that follow from M13 = 1.18 and -0.53 N m, N m", ("quantity", ""), tuple(rows)
    )


def built_in() -> Section:
    """Table 1 with the built-in motion."""
    found = extremes(300.0)
    rows = []
    for name, (peak, valley) in TABLE_1.items():
        slip = name in ("M1", "M2")
        used = name in ("M11", "M13")
        known = DERIVED if name == "M12" else COMPUTED
        low: Pair | str = "0"
        if valley:
            low = Pair(valley, found[name].valley, 3, misprint=name == "M2", used=used, proves=known)
        high = Pair(peak, found[name].peak, 3, misprint=slip, used=used, proves=known)
        rows.append(Row((name, high, low)))
    return Section(
        "Table 1 and Figures 8 and 9: torques at 300 nips/min with the built-in motion, N m",
        ("torque", "peak", "valley"),
        tuple(rows),
        split=False,
        remarks=(
            "M13 proves nothing: the motion was made to match it. M12 follows from the inertias, as in the"
            " table before. The load of 300 N was taken as that of a whole top roller because that gives the"
            " published M11.",
            "Published valleys are shown with the minus signs that they have lost.",
        ),
        figures=(
            ("roller.png", "Torques of the detaching rollers with the built-in motion (Figures 8 and 9)"),
        ),
    )


def table_2() -> Section:
    """Torques of a unit and of the machine over the speed."""
    rows = []
    for nips, name, peak, valley in TABLE_2:
        found = extremes(float(nips))[name]
        high, low = (
            Pair(peak, found.peak, 2, misprint=True), Pair(valley, found.valley, 2, used=name == "M")
        )  # fmt: skip
        rows.append(Row((nips, name, high, low)))
    growth = [extremes(n)["M0"] for n in (300.0, 500.0)]
    return Section(
        "Table 2: torques over the speed with the built-in motion, N m",
        ("nips/min", "torque", "peak", "valley"),
        (
            *rows,
            Row(("growth from 300 to 500, %", "M0",
                 Pair("177", 100.0 * (growth[1].peak / growth[0].peak - 1.0), 1),
                 Pair("206", 100.0 * (growth[1].valley / growth[0].valley - 1.0), 1))),
        ),
        split=False,
        labels=2,
        remarks=(
            "All sums repeat the slip of Table 1: they use the printed M2, which is 9 % too low. The valleys"
            " also depend on the assumed motion.",
            "The three valleys of M were used to choose how the number of fibres falls off.",
        ),
    )  # fmt: skip


def against_itself() -> Section:
    """Rows of Table 2, computed from one another."""
    printed = {(nips, name): (high, low) for nips, name, high, low in TABLE_2}
    first = float(printed["300", "M"][0])
    rows = [
        Row(
            (
                f"peak of M at {nips} nips/min from that at 300, by the square of the speed",
                consistent(printed[nips, "M"][0], first * (float(nips) / 300.0) ** 2, 3),
            )
        )
        for nips in ("400", "500")
    ]
    for nips in ("300", "400", "500"):
        of_unit, of_machine = printed[nips, "M"], printed[nips, "M0"]
        for what, one, eight in zip(("peak", "valley"), of_unit, of_machine, strict=True):
            pair = consistent(eight, 8.0 * float(one), 3)
            rows.append(Row((f"{what} of M0 at {nips} nips/min, 8 M", pair)))
    rows.append(_middle_valley())
    for what, place, growth in (("peak", 0, "177"), ("valley", 1, "206")):
        slow, fast = (float(printed[nips, "M0"][place]) for nips in ("300", "500"))
        name = f"growth of the {what} of M0 from 300 to 500 nips/min, %"
        rows.append(Row((name, consistent(growth, 100.0 * (fast / slow - 1.0), 1))))
    return Section("Table 2 against itself, N m", ("quantity", ""), tuple(rows))


def _middle_valley() -> Row:
    """The valley at 400 nips/min by `friction - inertia (nips / 300)^2` through those at 300 and 500."""
    valley = {nips: float(low) for nips, name, _high, low in TABLE_2 if name == "M"}
    inertia = (valley["300"] - valley["500"]) / ((500.0 / 300.0) ** 2 - 1.0)
    friction = valley["300"] + inertia
    pair = consistent("-1.9", friction - inertia * (400.0 / 300.0) ** 2, 3)
    law = f"{number(friction, 3)} - {number(inertia, 3)} (nips / 300)^2"
    return Row(("valley of M at 400 nips/min from those at 300 and 500", pair), law)
