"""What of the demonstration loom can be written as numpy arrays over all steps at once.

That is what follows from the shaft's angle by a formula. What has a memory cannot: the damper's carrier and
its contacts, the lowest margin and speed limit so far, which are sought between the samples. Nor can searches
that end at each sample on their own: the deflection of a buckled belt. What stays the same is left out.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from loomfmu.components import COMPONENTS
from loomfmu.cosim.scenes.scene import Scene
from loomfmu.physics.belt import NO_LIMIT, length_factor

Floats = NDArray[np.float64]
TURN = 2.0 * math.pi


def run(scene: Scene) -> dict[str, Any]:
    """Outputs of shaft, weft, belt, dobby and heald frames at all samples."""
    values = {name: COMPONENTS[each.fmu.name](**each.values) for name, each in scene.instances.items()}
    speed = values["shaft"].speed
    time = np.arange(scene.steps + 1) * scene.step_size
    theta = values["shaft"].start_angle + speed * time
    found = {
        "shaft.angle": theta,
        "shaft.velocity": np.full(len(time), speed),
        "shaft.acceleration": np.zeros(len(time)),
    }
    if "weft" in values:
        found |= _named("weft", weft(values["weft"], theta, speed))
    if "belt" in values:
        found |= _named("belt", belt(values["belt"], found, speed))
    if "dobby" in values:
        found |= _named("dobby", dobby(values["dobby"], theta, speed))
    for name in values:
        if name.startswith("heald_"):
            found |= _named(name, heald(values[name], found))
    return found


def _named(instance: str, signals: dict[str, Any]) -> dict[str, Any]:
    return {f"{instance}.{variable}": values for variable, values in signals.items()}


def weft(given: Any, theta: Floats, speed: float) -> dict[str, Any]:
    """Travel of the head and its rates, equations (1) to (6) of Zhu and Zhou."""
    angle, first, second = sector(given, theta)
    (start, middle), _first, _second = sector(given, np.array([0.0, math.pi]))
    swing = _wrapped(middle - start)
    per_angle = math.copysign(0.5 * given.gear_ratio * given.wheel_diameter, swing)
    first, second = per_angle * first, per_angle * second
    acceleration = second * speed * speed
    radius = 0.5 * given.wheel_diameter
    reflected = given.moving_mass + given.wheel_inertia / (radius * radius)
    return {
        "travel": per_angle * _wrapped(angle - start),
        "velocity": first * speed,
        "acceleration": acceleration,
        "shaft_torque": reflected * acceleration * first,
    }


def _wrapped(angle: Any) -> Any:
    return np.where(angle > math.pi, angle - TURN, np.where(angle < -math.pi, angle + TURN, angle))


def sector(given: Any, theta: Floats) -> tuple[Floats, Floats, Floats]:
    """Angle of the sector gear with its derivatives: spherical crank-rocker, then four-bar."""
    theta = theta + given.crank_phase + given.lead
    cosine, sine = math.cos(given.crank_cone), math.sin(given.crank_cone)
    b, turned = sine * np.cos(theta), sine * np.sin(theta)
    alpha = np.arccos(math.cos(given.rocker_angle) / np.sqrt(cosine * cosine + b * b)) - np.arctan2(b, cosine)
    sin_alpha, cos_alpha = np.sin(alpha), np.cos(alpha)
    by_alpha = cosine * sin_alpha + b * cos_alpha
    first = turned * sin_alpha / by_alpha
    bend = -b * sin_alpha + first * (-2.0 * turned * cos_alpha + first * (cosine * cos_alpha - b * sin_alpha))
    second = -bend / by_alpha
    if not given.planar_linkage:
        return alpha, first, second
    return _four_bar(given, alpha + given.rocker_offset, first, second)


def _four_bar(given: Any, psi: Floats, rate: Floats, bend: Floats) -> tuple[Floats, Floats, Floats]:
    crank, coupler, output = given.crank_length, given.coupler_length, given.output_length
    cos_psi, sin_psi = np.cos(psi), np.sin(psi)
    x, y = crank * cos_psi - given.pivot_x, crank * sin_psi - given.pivot_y
    square = x * x + y * y
    apex = np.arccos((square + output * output - coupler * coupler) / (2.0 * np.sqrt(square) * output))
    chi = np.arctan2(y, x) + given.assembly * apex
    cos_chi, sin_chi = np.cos(chi), np.sin(chi)
    rod_x, rod_y = x - output * cos_chi, y - output * sin_chi
    along_output = output * (rod_y * cos_chi - rod_x * sin_chi)
    along_crank = crank * (rod_y * cos_psi - rod_x * sin_psi)
    first = rate * along_crank / along_output
    slide_x = -crank * sin_psi * rate + output * sin_chi * first
    slide_y = crank * cos_psi * rate - output * cos_chi * first
    bend_x = -crank * cos_psi * rate * rate + output * cos_chi * first * first
    bend_y = -crank * sin_psi * rate * rate + output * sin_chi * first * first
    second = slide_x * slide_x + slide_y * slide_y + rod_x * bend_x + rod_y * bend_y + along_crank * bend
    return chi, first, second / along_output


def belt(given: Any, found: dict[str, Any], speed: float) -> dict[str, Any]:
    """Margin and speed limit of the belt, equations (7) to (12) of Zhu and Zhou."""
    free = found["weft.travel"] - given.idle_travel - given.head_length
    inwards = found["weft.velocity"] >= 0.0  # a giver carries the weft there, a taker on the way back
    weft = np.where(inwards != given.taker, given.yarn_tension * (1.0 - 2.0 * given.taker), 0.0)
    force = given.head_mass * found["weft.acceleration"] + weft
    factor = given.prescribed_length_factor
    if not given.prescribe_length_factor:
        factor = length_factor(given.guide_clearance)
    euler = math.pi * math.pi * given.bending_stiffness
    outside = free > 0.0
    bend = found["weft.acceleration"] / (speed * speed)
    critical = euler / (factor * np.maximum(free, 1e-3)) ** 2
    with np.errstate(divide="ignore", invalid="ignore"):
        spare = euler / (factor * free) ** 2 - weft
        limit = np.minimum(NO_LIMIT, np.sqrt(np.maximum(spare, 0.0) / (given.head_mass * bend)))
    return {
        "free_length": free,
        "inertia_force": given.head_mass * found["weft.acceleration"],
        "axial_force": force,
        "critical_force": critical,
        "length_factor": np.full(len(free), factor),
        "margin": np.where(outside, 1.0 - force * (factor * free) ** 2 / euler, 1.0),
        "speed_limit": np.where(outside & (bend > 0.0), limit, NO_LIMIT),
        "at_risk": outside & (force > 0.0),
    }


def dobby(given: Any, theta: Floats, speed: float) -> dict[str, Any]:
    """Rotor by the sloped sine, and the lift of a frame that changes at every pick, of Korolev."""
    turned = theta - given.slow_point
    turns = np.floor(turned / TURN)
    x = turned - TURN * turns
    mirrored = x > math.pi
    angle, first, second = _sloped_sine(np.where(mirrored, TURN - x, x), given.speed_reduction)
    angle = TURN * turns + np.where(mirrored, TURN - angle, angle)
    velocity = first * speed
    acceleration = np.where(mirrored, -second, second) * speed * speed
    share, rate, bend = _lift(angle, velocity, acceleration)
    return {
        "rotor_angle": angle,
        "rotor_velocity": velocity,
        "rotor_acceleration": acceleration,
        "lift_fraction": share,
        "lift_rate": rate,
        "lift_acceleration": bend,
        "pick": np.floor(theta / TURN),
    }


def _sloped_sine(x: Floats, reduction: float) -> tuple[Floats, Floats, Floats]:
    """The law over half a turn, equations (3.19) to (3.24): both pieces everywhere, the right one taken."""
    eta = math.pi * reduction / (math.pi - 0.25 + 49.0 * math.pi**2 / 48.0 - 49.0 / 16.0)
    end, reach, wave = 0.125 * math.pi, 0.875 * math.pi, 8.0 / 7.0
    slow, gain = 1.0 - reduction, 4.0 * eta / math.pi
    y, u = x - end, x - math.pi
    sin_end, cos_end = np.sin(4.0 * x), np.cos(4.0 * x)
    sin_wave, cos_wave = np.sin(wave * y), np.cos(wave * y)
    way = wave * ((u**3 + reach**3) / 6.0 - 0.5 * reach * reach * y) + (y - sin_wave / wave) / wave
    late = slow * end + 0.25 * eta * (4.0 * end - 1.0) + (slow + eta) * y - gain * way
    late_rate = slow + eta - gain * (0.5 * wave * (u * u - reach * reach) + (1.0 - cos_wave) / wave)
    early = x <= end
    return (
        np.where(early, slow * x + 0.25 * eta * (4.0 * x - sin_end), late),
        np.where(early, slow + eta * (1.0 - cos_end), late_rate),
        np.where(early, 4.0 * eta * sin_end, -gain * (wave * u + sin_wave)),
    )


def _lift(angle: Floats, velocity: Floats, acceleration: Floats) -> tuple[Floats, Floats, Floats]:
    sine, cosine = np.sin(0.5 * angle), np.cos(0.5 * angle)
    bend = 0.125 * cosine * velocity * velocity + 0.25 * sine * acceleration
    return 0.5 * (1.0 - cosine), 0.25 * sine * velocity, bend


def heald(given: Any, found: dict[str, Any]) -> dict[str, Any]:
    """Motion of a frame by its pattern, of sixteen picks at the most."""
    angle = found["dobby.rotor_angle"]
    pick = np.floor(angle / TURN)
    before, after = (
        (given.pattern_1 >> ((pick + ahead) % given.pattern_length).astype(int)) & 1 for ahead in (0, 1)
    )
    change = after - before
    share, rate, bend = _lift(
        angle - TURN * pick, found["dobby.rotor_velocity"], found["dobby.rotor_acceleration"]
    )
    lift = given.stroke * (before + change * share)
    acceleration = given.stroke * change * bend
    return {
        "lift": lift,
        "velocity": given.stroke * change * rate,
        "acceleration": acceleration,
        "warp_height": given.warp_ratio * (lift - 0.5 * given.stroke),
        "inertia_force": given.frame_mass * acceleration,
        "moving": change != 0,
    }
