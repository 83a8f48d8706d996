"""Findings of our own: what the equations say of the published machines and the sources do not."""

import math

from ..components.belt_monitor import BeltMonitor
from ..components.belt_wrap import BeltWrap
from ..components.heald_damper import HealdDamper
from ..components.heald_frame import HealdFrame
from ..components.pattern_lock import PatternLock
from ..components.warp_tension import WarpTension
from ..design import loom
from ..machines import HEADS, MACHINES, parameters, table
from ..physics.belt import elastica_deflection
from ..physics.rotor_laws.rotor import SLOPED_SINE, UNIFORM, rotor_law
from . import belt, belt_guide, belt_motion, cam, loads, rotor
from .chain import RPM, carrier
from .lock import limit as lock_limit
from .sections import Chapter, Row, Section, number

SPEEDS = (200.0, 225.0, 250.0, 275.0, 300.0, 400.0, 500.0, 600.0)
PICKS = 4
LOOM = "WL680-3600"


def chapter() -> Chapter:
    """All of them."""
    return Chapter(
        "Findings of our own",
        "",
        (
            damper(),
            against_the_tables(),
            belt_design(),
            over_speed(),
            *belt_motion.sections(),
            belt_guide.section(),
            belt_guide.in_motion(),
            loads.weft(),
            shed(),
            limits(),
            unconnected(),
        ),
    )


def first_contact(law: int) -> float:
    """Lowest speed at which the default carrier touches a stop within its first picks [rev/min]."""
    low, high = 100.0, 1000.0
    if carrier(high, PICKS, law=law).stop_contacts == 0:
        return math.inf
    while high - low > 0.01:
        middle = 0.5 * (low + high)
        if carrier(middle, PICKS, law=law).stop_contacts > 0:
            high = middle
        else:
            low = middle
    return high


def _damper_row(rpm: float) -> Row:
    plain, woven = carrier(rpm, PICKS), carrier(rpm, PICKS, warp=True)
    lasting = carrier(rpm, 10 * PICKS, steps=90)
    fixed = plain.carrier_mass * plain.peak_frame
    cells = (
        number(rpm, 0), str(plain.stop_contacts), str(lasting.stop_contacts), number(plain.peak_load, 0),
        number(fixed, 0), number(plain.acceleration_ratio, 1), str(woven.stop_contacts),
        number(woven.peak_load, 0),
    )  # fmt: skip
    return Row(cells)


def damper() -> Section:
    """The stops of the damper."""
    frequency = math.sqrt(4.0 * 5960.0 / HealdDamper().carrier_mass) / (2.0 * math.pi)
    touched, cosine = (min(first_contact(law), 1000.0) for law in (SLOPED_SINE, UNIFORM))
    return Section(
        "With the source's springs the carrier hits its stops",
        (
            "rev/min", f"contacts in {PICKS} picks", f"in {10 * PICKS}", "peak load, N", "load if fixed, N",
            "peak acceleration over the frame's", "contacts with warp", "peak load with warp, N",
        ),
        tuple(_damper_row(rpm) for rpm in SPEEDS),
        intro="Plain weave from the closed shed, the frame rising first; default drive, damper and warp."
        f" Everything but the second count is for the first {PICKS} picks.",
        remarks=(
            f"The carrier touches a stop from {number(touched, 0)} rev/min on; with the uniform law, the"
            f" closest to the source's test at 300 rev/min, from {number(cosine, 0)} rev/min on (1000: none"
            " below). It has half of the published mass of a frame, an assumption: with all of it, as in the"
            " source's design formula, it touches a stop from about 230 rev/min on.",
            f"The natural frequency of the suspension is {number(frequency, 2)} Hz: three times that of a"
            f" frame in plain weave at {number(frequency * 120.0 / 3.0, 0)} rev/min, and equal to it at"
            f" {number(frequency * 120.0, 0)} rev/min.",
            "Peak loads depend on the stops. The source gives nothing on them; 2000 N/mm and a restitution of"
            " 0.5 are assumed.",
        ),
    )  # fmt: skip


def against_the_tables() -> Section:
    """Entries of the belt's tables that their own neighbours contradict."""
    return Section(
        "Entries of the belt's tables that contradict their own neighbours, rev/min",
        ("entry", "published", "computed", "from its neighbours"),
        (_widest(), _widest_case("III"), _widest_case("IV"), _odd_one()),
    )


def _widest() -> Row:
    """WL450-5400 at mu = 0.9."""
    row = next(r for r in table("safe_speed_by_length_factor") if r["machine"] == "WL450-5400")
    others = " and ".join(number(float(row[f"n_mu_{mu}"]) * float(mu) / 0.9, 1) for mu in ("0.8", "1.0"))
    found = number(belt.rpm(belt.safe("WL450-5400", "G6300 left", 0.9)), 1)
    entry = "Table 5, WL450-5400, mu = 0.9"
    return Row((entry, row["n_mu_0.9"], found, f"{others} by n mu = const, from mu = 0.8 and 1.0"))


def _widest_case(case: str) -> Row:
    """WL450-5400 with another head."""
    row = next(r for r in table("safe_speed_by_case") if r["machine"] == "WL450-5400")
    mass = {c: float(HEADS[head]["mass_g"]) for c, head in belt.CASE_HEADS.items()}
    others = " and ".join(
        number(float(row[f"n_{c}"]) * math.sqrt(mass[c] / mass[case]), 1) for c in ("I", "II")
    )
    found = number(belt.rpm(belt.safe("WL450-5400", belt.CASE_HEADS[case], 0.8)), 1)
    entry = f"Table 6, WL450-5400, case {case}"
    return Row(
        (entry, row[f"n_{belt.PRINTED[case]}"], found, f"{others} by n sqrt(m) = const, from cases I and II")
    )


def _odd_one() -> Row:
    """WL450-4000."""
    row = next(r for r in table("safe_speed_by_length_factor") if r["machine"] == "WL450-4000")
    found, *neighbours = (
        number(belt.rpm(belt.safe(name, "G6300 left", 0.8)), 1)
        for name in ("WL450-4000", "WL450-3800", "WL450-4600")
    )
    around = f"{' and '.join(neighbours)} computed for the neighbouring widths, 3.8 and 4.6 m"
    return Row(("Table 5, WL450-4000, mu = 0.8", row["n_mu_0.8"], found, around))


def belt_design() -> Section:
    """What a given speed requires."""
    rows = []
    for rpm in (600.0, 650.0, 700.0, 750.0):
        speed = rpm * RPM
        cells = (
            number(rpm, 0), number(1e3 * loom.clearance_for(speed, LOOM), 3),
            number(1e3 * loom.mass_for(speed, LOOM), 1), number(loom.stiffness_for(speed, LOOM), 4),
        )  # fmt: skip
        rows.append(Row(cells))
    return Section(
        f"What a given safe speed requires ({LOOM}, case I; one change at a time)",
        ("rev/min", "largest clearance, mm", "largest head mass, g", "smallest bending stiffness, N m2"),
        tuple(rows),
        remarks=(
            "Unchanged: clearance 0.3 mm, head 110.5 g, 0.25 N m2, safe up to"
            f" {number(belt.rpm(belt.safe(LOOM, 'G6300 left', 0.8)), 1)} rev/min.",
        ),
    )


def over_speed() -> Section:
    """How fast the deflection of a buckled belt grows."""
    found = belt.safe(LOOM, "G6300 left", 0.8)
    length = belt.free_length(LOOM, found.angle)
    rows = []
    for excess in (0.01, 0.1, 0.5, 1.0, 2.0):
        bent = elastica_deflection((1.0 + 0.01 * excess) ** 2, length)
        rows.append(Row((number(excess, 2), number(1e3 * bent, 1))))
    two = 0.0
    low, high = 0.0, 0.01
    for _ in range(60):
        two = 0.5 * (low + high)
        low, high = (two, high) if elastica_deflection((1.0 + two) ** 2, length) < 2e-3 else (low, two)
    return Section(
        f"Deflection of a belt that runs above its safe speed ({LOOM}, mu = 0.8; exact elastica)",
        ("above the limit, %", "deflection, mm"),
        tuple(rows),
        remarks=(
            f"The 2 mm that the source allows are reached {number(100.0 * two, 3)} % above the limit, which"
            f" is {number(two * belt.rpm(found), 2)} rev/min. Permitting a deflection adds no safety.",
        ),
    )


def _entry(machine: str) -> float:
    """Shaft angle at which the rapier head enters the shed, its idle travel done [rad]."""
    from scipy.optimize import brentq

    idle = float(parameters("BeltMonitor", machine=machine)["idle_travel"])
    return float(brentq(lambda x: belt.travel(machine, x)[0] - idle, 1e-6, math.pi, xtol=1e-14))


def shed() -> Section:
    """The rapier's stay in the shed against the dwell."""
    rows = []
    for name in MACHINES:
        entry = _entry(name)
        angle, _first, _second = rotor_law(SLOPED_SINE, math.pi - entry, 0.5)
        gone = 100.0 * 0.5 * (1.0 - math.cos(0.5 * angle))
        stay = 360.0 - 2.0 * math.degrees(entry)
        rows.append(Row((name, number(math.degrees(entry), 2), number(stay, 2), number(gone, 1))))
    dwell = number(math.degrees(rotor.drive("sloped sine", 0.5).dwell_angle), 1)
    return Section(
        "The rapier is in the shed far longer than the frames dwell",
        (
            "machine", "head enters at, deg", "head is in the shed for, deg",
            "travel left to a frame at the entry, % of its stroke",
        ),
        tuple(rows),
        intro="Entry: the head's travel equals the idle travel. Frames: default drive (sloped sine, zeta ="
              f" 0.5, slow point at 180 deg), which dwells for {dwell} deg.",
        remarks=(
            "The stay is symmetric about the transfer at 180 deg: when the head leaves, a changing frame has"
            " moved as far as it had left to go when the head entered. What counts is the height of the warp"
            " at the head: `rapier_in_open_shed` judges it in a scene.",
        ),
    )  # fmt: skip


def limits() -> Section:
    """Which mechanism limits the speed of the loom."""
    lock = PatternLock()
    lock.initialize(0.0)
    crest = rotor.STROKE * rotor.largest_lift_rate("sloped sine", 0.5)
    spline = cam.frame_span() * cam.drive().highest_acceleration
    rows = (
        Row(("belt, clearance 0.3 mm", number(belt.rpm(belt.safe(LOOM, "G6300 left", 0.8)), 1))),
        Row(("belt, worn to 0.8 mm", number(belt.rpm(belt.safe(LOOM, "G6300 left", 1.0)), 1))),
        Row(("pattern lock, torque of its spring", number(lock.torque_speed_limit / RPM, 1))),
        Row(("pattern lock, constant torque as in the source", number(lock_limit(lock.whole_turn), 1))),
        Row(("pattern lock, release time", number(lock.release_speed_limit / RPM, 1))),
        Row(("frames at 40 m/s2, default drive, stroke 98 mm", number(math.sqrt(40.0 / crest) / RPM, 1))),
        Row(("frames at 40 m/s2, spline cam", number(math.sqrt(40.0 / spline) / RPM, 1))),
    )
    return Section(
        f"Speed limits of a {LOOM} with the default dobby, rev/min",
        ("limited by", "limit"),
        rows,
        remarks=(
            "40 m/s2 is the acceleration for which the source designs its springs: it limits that design,"
            " not the mechanism.",
        ),
    )


def unconnected() -> Section:
    """What an FMU shows in a tool with nothing wired."""
    monitor, frame, wrap = BeltMonitor(), HealdFrame(), BeltWrap()
    for component in (monitor, frame, wrap):
        component.initialize(0.0)
        component.step(0.0, 0.0)
    damper = HealdDamper()
    damper.initialize(0.0)
    lowest = 0.0
    for n in range(20000):
        damper.step(1e-3 * n, 1e-3)
        lowest = min(lowest, damper.displacement)
    threads = WarpTension()
    threads.initialize(0.0)
    first = threads.tension
    for n in range(2000):
        threads.step(1e-2 * n, 1e-2)
    rows = (
        Row(("BeltMonitor", "free length, mm", number(1e3 * monitor.free_length, 1))),
        Row(("BeltMonitor", "margin", number(monitor.margin, 3))),
        Row(("BeltMonitor", "speed limit, rev/min", number(monitor.speed_limit / RPM, 1))),
        Row(("HealdFrame", "velocity, m/s", number(frame.velocity, 2))),
        Row(("HealdDamper", "lowest displacement, mm", number(1e3 * lowest, 1))),
        Row(("HealdDamper", "displacement after 20 s, mm", number(1e3 * damper.displacement, 2))),
        Row(("WarpTension", "tension at the start, N", number(first, 3))),
        Row(("WarpTension", "tension after 20 s, N", number(threads.tension, 3))),
        Row(("BeltWrap", "restraint load, N", number(wrap.restraint_load, 2))),
    )
    return Section("What an FMU shows with nothing wired to its inputs", ("FMU", "output", "value"), rows)
