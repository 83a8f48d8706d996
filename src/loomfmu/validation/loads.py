"""Loads on the drive: Korolev, section 3.2 and conclusions, and what the masses of the weft drive add."""

import math
from functools import cache

import numpy as np

from ..components.belt_dynamics import BeltDynamics
from ..components.weft_insertion import WeftInsertion
from ..design.loads import Loads, dobby_loads, least_loaded
from ..machines import parameters
from . import rotor
from .sections import Row, Section, number

SPEED = 280.0 * math.pi / 30.0  # of the measured loom, section 3.4
WARP = 1260 * 0.285  # N: threads of a frame by section 5.3, mean of the tensions measured in section 3.5
LAWS = {law: law.replace(" ", "_") for law in rotor.MODULATED}
REDUCTIONS = (0.0, 0.3, 0.4, 0.5, 0.6, 0.7)
MASSES = (4.0, 6.0, 6.5, 7.0, 7.5, 8.0, 15.0)
HIGHEST = 0.8  # zeta up to which the least load is looked for
LOOM = "WL680-3600"
BELT = {"belt_mass": BeltDynamics().belt_mass, "belt_length": 3.0}
WHEEL = {"wheel_inertia": 0.03}


@cache
def peaks(law: str, reduction: float, mass: float = 15.0, gravity: float = 0.0, warp: float = 0.0) -> Loads:
    """Peaks of the loads of one frame on the measured loom."""
    return dobby_loads(
        LAWS[law], reduction, speed=SPEED, stroke=rotor.STROKE, frame_mass=mass, gravity=gravity,
        warp_tension=warp,
    )  # fmt: skip


def sections() -> tuple[Section, ...]:
    """The loads on the dobby."""
    return by_reduction(), least()


def by_reduction() -> Section:
    """Peaks by law and zeta."""
    rows = []
    for law in LAWS:
        for reduction in REDUCTIONS:
            inertia, weight, warp = (
                peaks(law, reduction, **given) for given in ({}, {"gravity": 9.80665}, {"warp": WARP})
            )
            cells = (
                number(abs(inertia.frame_force.value), 0), number(abs(inertia.rotor_torque.value), 2),
                number(abs(inertia.shaft_torque.value), 2), number(abs(weight.frame_force.value), 0),
                number(abs(weight.rotor_torque.value), 2), number(abs(warp.frame_force.value), 0),
                number(abs(warp.rotor_torque.value), 2),
            )  # fmt: skip
            rows.append(Row((law, number(reduction, 1), *cells)))
    return Section(
        "Section 3.2: peaks of the loads of a frame on the dobby (computed; the measured ones are in lost"
        " figures)",
        (
            "law", "zeta", "inertia: frame, N", "inertia: rotor, N m", "inertia: shaft, N m",
            "and weight: frame, N", "and weight: rotor, N m", "inertia and warp: frame, N",
            "inertia and warp: rotor, N m",
        ),
        tuple(rows),
        intro="One frame of 15 kg with a stroke of 98 mm that changes at every pick, at 280 picks/min. The"
        " output lever bears the force on the frame. The modulator's rocker bears the torque on the rotor,"
        " if its differential has a constant ratio; arms and ratio are not published. Warp: 1260 threads of"
        " 0.285 N, held constant.",
        remarks=(
            "The source finds the loads on output lever and rocker least at zeta = 0.4 to 0.5 (section 3.2,"
            " conclusions of chapter 3 and of the thesis). The equations do not reproduce that: from 0.3 to"
            " 0.7 the force on the frame rises with zeta under every law, with weight and warp too. It is"
            " least at about 0.1, or at 0. The torque on the rotor rises from 0 on.",
            "The source contradicts itself: its section 3.5 asks for small accelerations to keep the loads"
            " small, and by its section 3.4 the accelerations grow by 28 % from zeta = 0.3 to 0.7.",
            "Play, elasticity and friction of the drive are left out, as are the rotor's own inertia, whose"
            " torque is proportional to zeta, and the chain of levers.",
        ),
        figures=(("dobby_loads.png", "Peaks of the loads of a frame on the dobby by speed reduction"),),
    )  # fmt: skip


@cache
def least_reduction(law: str, mass: float) -> float:
    """Zeta at which the torque on the rotor is least, of a frame with its warp."""
    return least_loaded(
        LAWS[law], "rotor_torque", highest=HIGHEST, speed=SPEED, stroke=rotor.STROKE, frame_mass=mass,
        gravity=0.0, warp_tension=WARP,
    )  # fmt: skip


def least() -> Section:
    """Where the torque on the rotor is least."""
    rows = [
        Row((number(mass, 1), *(number(least_reduction(law, mass), 2) for law in LAWS))) for mass in MASSES
    ]
    return Section(
        "Section 3.2: zeta at which the torque on the rotor is least, inertia and warp (computed)",
        ("mass of the frame, kg", *LAWS),
        tuple(rows),
        intro="The warp pulls a frame towards the middle of its stroke, so it does part of the work of"
        " stopping it. Loom and warp as above, zeta from 0 to 0.8.",
        remarks=(
            "A heavy frame is best without a modulator, a light one with the strongest. In between, where"
            " warp and inertia nearly balance, the least torque passes zeta = 0.4 to 0.5 within less than"
            " 1 kg of frame mass. So the source's statement may have been true of the rocker of its loom,"
            " whose frames it does not weigh; it is not true in general.",
        ),
    )


def weft_peaks(**masses: float) -> tuple[float, float, float]:
    """Mass reduced to the head [kg], largest shaft torque [N m] and kinetic energy [J] at 600 rev/min."""
    given = parameters("WeftInsertion", machine=LOOM, head="G6300 left")
    drive = WeftInsertion(**given | masses, speed=20.0 * math.pi)  # type: ignore[arg-type]
    drive.initialize(0.0)
    rows = []
    for place in range(1440):
        drive.step(place * 0.1 / 1440, 0.0)
        rows.append((drive.shaft_torque, drive.kinetic_energy, drive.velocity))
    torque, energy, velocity = np.abs(np.array(rows)).T
    return 2.0 * float(energy.max() / velocity.max() ** 2), float(torque.max()), float(energy.max())


def weft() -> Section:
    """What belt and wheel add to the shaft torque of the weft drive."""
    cases: tuple[tuple[str, dict[str, float]], ...] = (
        ("head alone (default)", {}),
        ("and belt, 3 m of 0.05 kg/m", BELT),
        ("and rapier wheel, 0.03 kg m2", BELT | WHEEL),
    )
    rows = []
    for name, masses in cases:
        mass, torque, energy = weft_peaks(**masses)
        rows.append(Row((name, number(mass, 3), number(torque, 0), number(energy, 0))))
    return Section(
        f"Shaft torque of the weft drive of the {LOOM} at 600 rev/min",
        ("moving masses", "mass reduced to the head, kg", "largest shaft torque, N m", "largest energy, J"),
        tuple(rows),
        remarks=(
            "The sources publish neither the belt's mass per length nor the wheel's inertia. These are"
            " assumptions: the belt of `BeltDynamics`, and a wheel with most of 0.8 kg at its rim.",
            "With these, the energy that goes to and fro between shaft and weft drive in every pick is nearly"
            " as large as that of a shaft of 2 kg m2 (the default of `DrivenShaft`) at 600 rev/min, 3948 J.",
        ),
    )
