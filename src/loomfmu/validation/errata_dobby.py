"""Misprints in Korolev's other chapters: cam, pattern lock, warp, damper, tables of looms."""

import math

import numpy as np

from ..components.dobby.drive import DobbyDrive
from ..components.warp_tension import WarpTension
from ..design.cam import TURN, published_path
from ..machines import table
from ..physics.pattern_lock import available_time, largest_bend, pawl_turn, release_time
from ..physics.rotor_laws.shed_cam import SPLINE_CAM
from ..physics.warp import constant_rate_force
from . import arithmetic, cam, cyclograms, lock
from .sections import Row, Section, number

HEADINGS = ("where", "printed", "corrected", "what is wrong with the printed form")


def sections() -> tuple[Section, ...]:
    """All of them."""
    return (
        Section(
            "Dobby: energy, factors and cyclograms (Korolev, sections 1.1 and 2.2 to 2.5)",
            HEADINGS,
            (*arithmetic.misprints(), *cyclograms.misprints()),
        ),
        Section("Dobby: spline cam (Korolev, section 4, Appendices 2 and 3)", HEADINGS, of_cam()),
        Section("Dobby: pattern lock (Korolev, section 3.6.1)", HEADINGS, of_lock()),
        Section("Dobby: warp and heald carrier (Korolev, sections 3.5 and 5.3)", HEADINGS, of_warp()),
        Section("Looms: tables (Korolev, section 1.1, Appendix 1)", HEADINGS, of_tables()),
    )


def of_cam() -> tuple[Row, ...]:
    """Spline cam."""
    drive = DobbyDrive(law=SPLINE_CAM)
    drive.cam_height = (*drive.cam_height[:4], 0.657, drive.cam_height[5])
    drive.initialize(0.0)
    span = 1e3 * cam.frame_span()
    radii = 1e3 * np.hypot(*published_path().T)
    return (
        Row(("Table 4.2, Y row, 657 deg", "657", "1.5 mm, as in (4.4) and Appendix 2",
             f"the largest travel of the frame would be {number(6e3 * drive.cam_span, 0)} mm")),
        Row(("Appendix 2, scale of the cam", "largest travel 108 mm", f"{number(span, 2)} mm",
             f"the cam would reach {number(84.0 + 23.0 / 108.0 * span, 2)} mm, not the 107 mm it is"
             " designed for")),
        Row(("Appendix 3, program", "the cam of Appendix 2, lift 23 mm",
             f"lift {number(float(np.ptp(radii)), 2)} mm",
             "even scaled to the same lift and turned for the best fit, its points deviate from the listed"
             f" law by up to {number(_misfit(), 1)} mm")),
    )  # fmt: skip


def _misfit() -> float:
    """How far the program's points lie off the law, scaled and turned to fit best, either way round [mm]."""
    points = published_path()
    angle, radius = np.arctan2(points[:, 1], points[:, 0]), 1e3 * np.hypot(*points.T)
    path = cam.cam().path
    at, law = np.arctan2(path[:, 1], path[:, 0]) % TURN, np.hypot(*path.T)
    order = np.argsort(at)
    law = radius.min() + (law - law.min()) / np.ptp(law) * np.ptp(radius)

    def off(sense: int, shift: float) -> float:
        found = np.interp((sense * angle + shift) % TURN, at[order], law[order], period=TURN)
        return float(np.max(np.abs(found - radius)))

    return min(off(sense, TURN * k / 720) for sense in (1, -1) for k in range(720))


def of_lock() -> tuple[Row, ...]:
    """Pattern lock."""
    return *_of_torque(), *_of_release()


def _of_torque() -> tuple[Row, ...]:
    """The pawl's law and the torque that it needs."""
    turn = math.radians(12.0)
    bend = largest_bend(lock.SPAN, turn)
    torque = lock.INERTIA * bend * (620.0 * lock.RPM) ** 2
    mistaken = math.sqrt(1.0 / (375e-6 * 0.32))
    limit = lock.limit(turn)
    start = 1.0 - 2.0 * math.pi / lock.SPAN
    return (
        Row(("(3.31)", "375e-6 kg m2 = 3750e-6", f"{number(1e6 * lock.INERTIA, 1)}e-6 kg m2",
             "the two numbers in one line differ by a factor of ten; the release time uses the second")),
        Row(("(3.33)", "1/T before the sine", "1/(2 pi)",
             f"the pawl would start at {number(start, 2)} times its mean speed (T in rad), not from rest;"
             " (3.34) is the second derivative of the corrected form")),
        Row(("after (3.34)", "2 pi phi0 / T^2 = 10 (24/75)^2 = 0.32", number(bend, 3),
             f"the product printed is {number(10.0 * (24.0 / 75.0) ** 2, 3)}")),
        Row(("limit from the torque", "91.29 1/s = 620 rev/min", f"{number(limit, 1)} rev/min",
             f"{number(mistaken, 2)} 1/s, which is right for 0.32, is {number(mistaken / lock.RPM, 0)}"
             f" rev/min; at 620 rev/min the pawl needs {number(torque, 3)} N m, and the spring gives 1.0")),
    )  # fmt: skip


def _of_release() -> tuple[Row, ...]:
    """The time that the pawl takes."""
    own = pawl_turn(lock.LENGTH, lock.WIDTH, 0.15)
    k_squared = lock.STIFFNESS * lock.ARM**2 / lock.INERTIA
    printed = lock.STIFFNESS * lock.ARM**2 / 3750e-6
    release, slow = (
        1e3 * release_time(inertia, own, 0.0, lock.STIFFNESS, lock.ARM) for inertia in (lock.INERTIA, 3750e-6)
    )
    left, measured = (1e3 * available_time(math.radians(dwell), 620.0 * lock.RPM) for dwell in (90.0, 80.0))
    return (
        Row(("before (3.38)", "k^2 = C R^2 / phi", "C R^2 / I",
             f"with phi it is {number(lock.STIFFNESS * lock.ARM**2 / own, 1)} N m/rad2, not the square of"
             f" a frequency; with I it is {number(k_squared, 0)} 1/s2")),
        Row(("(3.40), (3.41)", "A cos kt + B k sin kt; -A k^2 sin kt + B k^2 cos kt",
             "A k cos kt - B k sin kt; -A k^2 sin kt - B k^2 cos kt",
             f"by (3.38) the acceleration at t = 0 is -k^2 B = -{number(k_squared, 0)} B; as printed it is"
             f" +{number(k_squared, 0)} B, and the pawl would leave its slot")),
        Row(("k^2", "1700 1/s2", f"{number(k_squared, 0)} 1/s2",
             f"with the printed I it is {number(printed, 0)}")),
        Row(("release time", "pi / (2 k^2) = 0.001 s", f"pi / (2 k) = {number(release, 2)} ms",
             f"with k from the printed I it would be {number(slow, 1)} ms, more than the {number(left, 1)}"
             " ms available")),
        Row(("time for 90 deg at 620 rev/min", "0.01 s", f"{number(left, 2)} ms",
             "a quarter of a turn that takes 60/620 s")),
        Row(("dwell measured at the least speed reduction", "90 deg", "80 deg",
             f"Table 3.1 has 80 deg at 0.3, which take {number(measured, 2)} ms: the pawl is in time all the"
             " same")),
    )  # fmt: skip


def _thread_remainders() -> tuple[float, float]:
    """Residuals of (3.29) in the printed and in the corrected (3.28), over the largest of the terms."""
    b, n, r, t = 67.0, 5.0, 10.0, 0.1
    grown = math.exp(-n * t)
    x = (r * t + (1.0 - r / n) * (1.0 - grown)) / (b * n)  # for F = t
    rate = (r + (n - r) * grown) / (b * n)
    printed = (t + r) - (b * n * x + b * rate)
    right = (1.0 + r * t) - b * (rate + n * x)
    return abs(printed) / r, abs(right)


def of_warp() -> tuple[Row, ...]:
    """Warp and damper."""
    printed, right = _thread_remainders()
    b, n, r, t = 67.0, 5.0, 10.0, 0.1
    stretched = constant_rate_force(t, 1.0, b, n, r)
    by_solution = t / (r / (b * n) + (1.0 - r / n) * (1.0 - math.exp(-n * t)) / (b * n * t))
    warp = WarpTension(lift=0.098, pretension=0.76, thread_stiffness=0.0, shed_offset=0.0)
    warp.initialize(0.0)
    load = -warp.frame_load
    eight = 1e3 * (957.6 - 600.0) / (8.0 * 5960.0)
    return (
        Row(("(3.28)", "F + r F' = b n x + b x'", "F' + r F = b (x' + n x)",
             f"(3.29) leaves a residual of {number(100.0 * printed, 0)} % of the largest term in the printed"
             f" form and {number(100.0 * right, 0)} % in the corrected one (b = 67 N/m, n = 5, r = 10 1/s, t"
             " = 0.1 s); and the source itself calls n and r rates")),
        Row(("(3.29)", "the solution", "the solution for a force that rises at a constant rate",
             "for an extension at a constant rate it is"
             f" {number(100.0 * (by_solution / stretched - 1.0), 1)} % off (same constants)")),
        Row(("(5.4)", "957.6 N, the tension of all threads", f"{number(load, 0)} N",
             f"a thread pulls its eye only with the sines of its two parts, {number(load / 957.6, 3)} of its"
             " tension with the assumed lengths and the shed open; that is less than the 600 N of inertia, so"
             " (5.6) would give a negative stiffness")),
        Row(("(5.6)", "5960 kg/m = 59.6 N/mm", "5960 N/m = 5.96 N/mm",
             f"springs of 59.6 N/mm would deflect by {number(1e3 * 357.6 / (4.0 * 59600.0), 1)} mm, not 15"
             " mm")),
        Row(("section 5.3", "four springs in (5.2), eight recommended", "four of 5.96 N/mm",
             f"eight would deflect by {number(eight, 1)} mm, not 15 mm")),
    )  # fmt: skip


def of_tables() -> tuple[Row, ...]:
    """Tables of looms."""
    rows = {row["machine"]: row for row in table("floor_space")}
    l5200 = rows["Sulzer Ruti L5200"]
    needed = float(l5200["rate_m_min"]) / float(l5200["width_m"])
    rate = float(l5200["width_m"]) * float(l5200["speed_rpm"])
    return (
        Row(("Table 1.1, looms TM", "coefficient 506 to 650.7", "400.0 to 280.0",
             "the column repeats the rate: 506 m/min over the square root of 1.6 m is"
             f" {number(506.0 / math.sqrt(1.6), 1)}")),
        Row(("Table 1.1, Jurgens", "width 11.6 m, coefficient 148.9", number(557.0 / math.sqrt(11.6), 1),
             f"148.9 belongs to a width of {number((557.0 / 148.9) ** 2, 1)} m")),
        Row(("Table 1.4, Sulzer Ruti L5200", "1.90 m at 450 rev/min, 1260 m/min", f"{number(rate, 0)} m/min",
             f"1260 m/min requires {number(needed, 0)} rev/min")),
        Row(("Table 1.4, Gunne", "5.25 m x 2.21 m = 12.68 m2", f"{number(5.25 * 2.21, 2)} m2",
             "the product of the two")),
        Row(("Appendix 1, Sulzer P7100 dress fabric", "193.1x1 cm, 1200 m/min", "193.1x2 cm",
             f"one web at 310 rev/min uses {number(1.931 * 310.0, 0)} m/min, two use"
             f" {number(2.0 * 1.931 * 310.0, 0)}")),
    )  # fmt: skip
