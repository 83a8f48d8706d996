"""Zhu and Zhou 2021, the rapier belt outside its guide: Tables 1 to 7, Figure 10, the deflection."""

import math
from functools import cache

from ..components.weft_insertion import WeftInsertion
from ..design import loom
from ..design.buckling import LengthFactor, fit_length_factor
from ..machines import HEADS, MACHINES, parameters, table
from ..physics import belt as physics
from ..units import STANDARD_GRAVITY
from .sections import COMPUTED, DERIVED, Chapter, Pair, Row, Section, consistent, number

CASES = ("I", "II", "III", "IV")
# Tables 6 and 7 print the columns III and IV the other way round: printed column of each case
PRINTED = {"I": "I", "II": "II", "III": "IV", "IV": "III"}
CASE_HEADS = dict(zip(CASES, HEADS, strict=True))
CLEARANCES = ("0", "0.30", "0.50", "0.75", "0.80")
FACTORS = ("0.8", "0.9", "1.0")


@cache
def _weft(machine: str) -> WeftInsertion:
    weft = WeftInsertion(**parameters("WeftInsertion", machine=machine))  # type: ignore[arg-type]
    weft.speed = 1.0
    weft.initialize(0.0)
    return weft


def travel(machine: str, angle: float) -> tuple[float, float, float]:
    """Travel of a machine's rapier head and its derivatives by the shaft angle [m]."""
    weft = _weft(machine)
    weft.step(angle, 0.0)
    return weft.travel, weft.velocity, weft.acceleration


def free_length(machine: str, angle: float) -> float:
    """Length of the belt outside guide and head [m]; negative inside the guide."""
    where = parameters("BeltMonitor", machine=machine)
    return travel(machine, angle)[0] - float(where["head_length"]) - float(where["idle_travel"])


@cache
def safe(machine: str, head: str, factor: float, tension: float = 0.0) -> loom.SafeSpeed:
    """Safe speed of a machine, found once."""
    return loom.safe_speed(machine, head, length_factor=factor, tension=tension)


def rpm(found: loom.SafeSpeed) -> float:
    """Its speed in rev/min."""
    return found.speed / loom.RPM


def chapter() -> Chapter:
    """All tables of the belt."""
    return Chapter(
        "Rapier belt outside its guide (Zhu and Zhou, J. Zhejiang Sci-Tech Univ. 45 (2021) 497)",
        "Figure 2 of the source, which defines its axes, is lost. The order and signs of the pivot's printed"
        " coordinates, the assembly and the crank phase (0 or 180 deg) were identified; all lengths and"
        " angles are as printed. Three published numbers of each machine were used for that and decide it:"
        " both ends of its window in Table 1, and its safe speed for mu = 0.8 and case I in Table 5, which"
        " Table 6 and Figure 10 repeat. Free lengths, loads, the other columns and Table 7 are predicted. But"
        " by (9) the speeds for other length factors and heads differ from the used one by a known factor:"
        " they test (9) and say little about the mechanism.",
        (table_1(), table_2(), table_3(), figure_10(), *table_5(), *table_6(), table_7(), deflection()),
    )


def table_1() -> Section:
    """Window of each machine."""
    rows = []
    for name, row in MACHINES.items():
        start, end = loom.window(name)
        printed_end = math.radians(float(row["published_accel_end_deg"]))
        cells = (
            Pair(row["published_accel_end_deg"], math.degrees(end), 2, place=True, used=True),
            Pair(row["published_free_start_deg"], math.degrees(start), 2, place=True, used=True),
            number(1e3 * free_length(name, end), 1),
            Pair(row["published_free_length_max_mm"], 1e3 * free_length(name, printed_end), 1),
        )
        rows.append(Row((name, *cells)))
    return Section(
        "Table 1: end of the positive acceleration, angle at which the belt leaves its guide, longest free"
        " length",
        (
            "machine", "end, deg", "leaves its guide, deg", "longest free length at the computed end, mm",
            "at the published end, mm",
        ),
        tuple(rows),
        split=False,
        remarks=(
            "The published longest free length is the one at the published end, which is printed in whole"
            f" degrees; a degree there changes it by {' to '.join(number(each, 0) for each in _growth())}"
            " mm.",
        ),
        figures=(
            ("travel.png", "Travel, velocity and acceleration of the rapier head at 400 rev/min (Figure 3)"),
        ),
    )  # fmt: skip


def _growth() -> tuple[float, float]:
    """Least and most that the free length grows in a degree at the end of the windows [mm]."""
    slopes = [1e3 * math.radians(travel(name, loom.window(name)[1])[1]) for name in MACHINES]
    return min(slopes), max(slopes)


@cache
def fits() -> dict[str, LengthFactor]:
    """Length factor of each clearance, fitted to the measured loads of Table 2 by least squares."""
    rows = table("belt_buckling_experiment")
    lengths = [1e-3 * float(row["free_length_mm"]) for row in rows]
    return {c: fit_length_factor(lengths, [float(row[f"c_{c}"]) for row in rows]) for c in CLEARANCES}


def table_2() -> Section:
    """Measured buckling loads."""
    factors = {clearance: fit.factor for clearance, fit in fits().items()}
    rows = []
    for row in table("belt_buckling_experiment"):
        length = 1e-3 * float(row["free_length_mm"])
        loads = (
            Pair(row[f"c_{c}"], physics.critical_force(length, factors[c], 0.25), 1, measured=True, used=True)
            for c in CLEARANCES
        )
        rows.append(Row((row["free_length_mm"], *loads)))
    return Section(
        "Table 2: measured buckling loads, N",
        ("free length, mm", *(f"c = {c} mm" for c in CLEARANCES)),
        tuple(rows),
        intro="Computed: equation (8) with EI = 0.25 N m2 and the length factors of the next table, which are"
        " fitted to these loads.",
        split=False,
    )


def table_3() -> Section:
    """Length factors."""
    factors = {clearance: fit.factor for clearance, fit in fits().items()}
    printed = {row["clearance_mm"]: row["length_factor"] for row in table("length_factor")}
    rows = tuple(Row((c, consistent(printed[c], factors[c], 3))) for c in CLEARANCES)
    return Section(
        "Table 3: length factor fitted to Table 2",
        ("clearance, mm", ""),
        rows,
        intro="Computed: least squares on the loads of Table 2, by equation (8).",
        remarks=("`BeltMonitor` uses the published factors, not these.",),
    )


def figure_10() -> Section:
    """Where the limit lies."""
    found = safe("WL680-3400", "G6300 left", 0.8)
    return Section(
        "Figure 10 and section 4.1: the lowest speed limit (WL680-3400, mu = 0.8, case I)",
        ("quantity", ""),
        (
            Row(("shaft angle, deg", Pair("101.27", math.degrees(found.angle), 3, place=True))),
            Row(("safe speed, rev/min", Pair("864", rpm(found), 2, used=True))),
        ),
        figures=(
            ("belt_load.png", "Belt load and critical load over the window at the safe speed (Figure 10)"),
        ),
    )


def with_idle_travel(machine: str, idle_travel: float, factor: float) -> tuple[float, float, float]:
    """Safe speed [rev/min] and critical load [N], and where the belt leaves its guide [rad] (case I).

    For another idle travel [m] than the published one.
    """
    from scipy.optimize import brentq, minimize_scalar

    mass = float(parameters("BeltMonitor", head="G6300 left")["head_mass"])
    guide = idle_travel + float(parameters("BeltMonitor", machine=machine)["head_length"])

    def limit(angle: float) -> float:
        position, _first, second = travel(machine, angle)
        return physics.speed_limit(position - guide, second, factor, loom.BENDING_STIFFNESS, mass, 0.0)

    start = float(brentq(lambda angle: travel(machine, angle)[0] - guide, 0.0, math.pi, xtol=1e-14))
    end = loom.window(machine)[1]
    found = minimize_scalar(limit, bounds=(start, end), method="bounded", options={"xatol": 1e-12})
    load = physics.critical_force(travel(machine, float(found.x))[0] - guide, factor, loom.BENDING_STIFFNESS)
    return float(found.fun) / loom.RPM, load, start


def _other_idle_travel() -> str:
    """A possible explanation of the speeds and loads of the WL450-4000."""
    found = [with_idle_travel("WL450-4000", 0.386, float(mu)) for mu in FACTORS]
    speeds, loads = (", ".join(number(each[k], 1) for each in found) for k in (0, 1))
    longest = 1e3 * (free_length("WL450-4000", math.radians(104.0)) - 0.030)
    leaves = number(math.degrees(found[0][2]), 1)
    return (
        "WL450-4000, possible explanation (an inference): with an idle travel of 386 mm for the printed 356"
        f" mm the speeds would be {speeds} rev/min and the loads of the next table {loads} N, close to the"
        f" published ones. But Table 1 needs 356 mm: with 386 mm the belt would leave its guide at {leaves}"
        f" deg (published 89) and its longest free length would be {number(longest, 0)} mm (371). A larger"
        " wheel would do as well; the cause cannot be settled."
    )


def table_5() -> tuple[Section, Section]:
    """Safe speeds and loads over the length factor."""
    speeds, loads = [], []
    for row in table("safe_speed_by_length_factor"):
        name = row["machine"]
        found = {mu: safe(name, "G6300 left", float(mu)) for mu in FACTORS}
        pairs = (
            Pair(row[f"n_mu_{mu}"], rpm(found[mu]), 1, used=mu == "0.8", proves=DERIVED) for mu in FACTORS
        )
        speeds.append(Row((name, *pairs, number(math.degrees(found["0.8"].angle), 2))))
        loads.append(Row((name, *(_load(row, mu, found[mu].critical_force) for mu in FACTORS))))
    heads = tuple(f"mu = {mu}" for mu in FACTORS)
    title = "Table 5: safe speed over the length factor, rev/min (case I, 110.5 g)"
    remark = (
        "By (9) the angle does not depend on mu, and n mu is constant along a row; Errata shows how far the"
        " printed rows vary."
    )
    figures = (
        ("speed_over_width.png", "Safe speed against the width of the loom (Table 5)"),
        ("speed_over_clearance.png", "Safe speed over the clearance of the belt in its guide"),
    )
    return (
        Section(
            title, ("machine", *heads, "at shaft angle, deg"), tuple(speeds), split=False,
            remarks=(remark, _other_idle_travel()),
            figures=figures,
        ),
        Section(
            "Table 5: critical load at the safe speed, N", ("machine", *heads), tuple(loads), split=False,
            intro="By (8) the loads for the other length factors follow from those for 0.8.",
        ),
    )  # fmt: skip


def _load(row: dict[str, str], factor: str, found: float) -> Pair | str:
    """A load of Table 5; one is not printed."""
    printed = row[f"load_mu_{factor}"]
    if not printed:
        return f"not printed / {number(found, 1)}"
    return Pair(printed, found, 1, proves=COMPUTED if factor == "0.8" else DERIVED)


def table_6() -> tuple[Section, Section]:
    """Safe speeds and loads of the four heads."""
    speeds, loads = [], []
    for row in table("safe_speed_by_case"):
        name = row["machine"]
        found = {case: safe(name, CASE_HEADS[case], 0.8) for case in CASES}
        limits = (
            Pair(row[f"n_{PRINTED[c]}"], rpm(found[c]), 1, used=c == "I", proves=DERIVED) for c in CASES
        )
        speeds.append(Row((name, *limits)))
        pairs = (Pair(row[f"load_{PRINTED[c]}"], found[c].critical_force, 1, proves=DERIVED) for c in CASES)
        loads.append(Row((name, *pairs)))
    heads = tuple(f"{c}, {HEADS[CASE_HEADS[c]]['mass_g'].rstrip('0').rstrip('.')} g" for c in CASES)
    return (
        Section(
            "Table 6: safe speed of the four heads, rev/min (mu = 0.8)",
            ("machine", *heads),
            tuple(speeds),
            intro="Columns III and IV are corrected: the source prints them interchanged. Column I repeats"
            " Table 5.",
            split=False,
        ),
        Section(
            "Table 6: critical load at the safe speed, N (mu = 0.8)",
            ("machine", *heads),
            tuple(loads),
            intro="Columns III and IV are corrected. By (8) to (10) the load cannot depend on the mass: the"
            " mass does not change the angle at which the limit is lowest. So all four columns are that of"
            " Table 5.",
            split=False,
        ),
    )


def table_7() -> Section:
    """Safe speeds under a weft tension."""
    rows = []
    for row in table("safe_speed_by_yarn_tension"):
        tension = 1e-3 * float(row["tension_gf"]) * STANDARD_GRAVITY
        pairs = (
            Pair(
                row[f"n_{PRINTED[c]}"],
                rpm(safe("WL680-3600", CASE_HEADS[c], 1.0, tension)),
                1,
                proves=COMPUTED if c == "I" else DERIVED,
            )
            for c in CASES
        )
        rows.append(Row((row["tension_gf"], *pairs)))
    return Section(
        "Table 7: safe speed under a weft tension, rev/min (WL680-3600, mu = 1)",
        ("tension, gf", *CASES),
        tuple(rows),
        intro="The tension is in gram-force (9.80665 mN). Columns III and IV are corrected. By (9) the"
        " columns II to IV follow from the first.",
        split=False,
    )


def printed_deflection(load_ratio: float, length: float) -> float:
    """Deflection by (11) as it is printed [m]."""
    root = math.sqrt(load_ratio)  # sqrt(F / F_cr)
    below = 2.0 * load_ratio + root / math.pi * math.sin(2.0 * math.pi * root)
    return 2.0 * math.sqrt(2.0) * length / math.pi * math.sqrt((1.0 - 1.0 / root) / below)


def deflection() -> Section:
    """Deflection of the belt at 686 rev/min."""
    found = safe("WL680-3600", "G6300 left", 0.8)
    length = free_length("WL680-3600", found.angle)
    published = (686.0 / 685.0) ** 2
    own = (686.0 / rpm(found)) ** 2
    bent = {ratio: 1e3 * physics.elastica_deflection(ratio, length) for ratio in (published, own)}
    return Section(
        "Section 4.2 and Figure 11: deflection at 686 rev/min (WL680-3600, mu = 0.8, case I)",
        ("quantity", ""),
        (
            Row(("exact elastica, with the published limit of 685 rev/min, mm",
                 Pair("8", bent[published], 1))),
            Row(
                (
                    "(11) as printed, with 685 rev/min, mm",
                    number(1e3 * printed_deflection(published, length), 1),
                ),
                "half of the exact deflection: see Errata",
            ),
            Row((f"exact elastica, with the computed limit of {number(rpm(found), 1)} rev/min, mm",
                 number(bent[own], 1))),
        ),
        remarks=(f"The free length at the lowest limit is {number(1e3 * length, 1)} mm.",),
    )  # fmt: skip
