"""A loom on its motor against one integration of its equations, and where its energy goes."""

import re
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import loomfmu
from loomfmu.components import COMPONENTS
from loomfmu.cosim.scenes import scene as scenes

ROOT = Path(__file__).parents[2]
GRAVITY = 9.80665
ROTOR = (
    "rotor_angle", "rotor_velocity", "rotor_acceleration", "lift_fraction", "lift_rate", "lift_acceleration",
)  # fmt: skip

WEFT = """
revolutions = 1
steps_per_revolution = {steps}
coupling = "{coupling}"
[loom]
machine = "WL680-3600"
[shaft]
component = "DrivenShaft"
"""
LOOM = WEFT.replace("[shaft]", 'weave = "1100/0110/0011/1001"\nreed = true\n[shaft]\ntorque_32 = "60 N.m"')


class Monolith:
    """The loom as one mechanism of one degree of freedom: Lagrange's equation in the shaft's angle.

        (J + M(x)) x'' + M'(x) x'^2 / 2 + V'(x) + T = k (w0 - x'),   M = sum of m s'^2

    Only positions come from the components, as derivatives by the angle: their torques and energies do not.
    """

    def __init__(self, scene):
        self.speed = scene.speed
        self.given = scene.instances["shaft"].values
        self.parts = {}
        for name, each in scene.instances.items():
            if name not in ("shaft", "belt"):
                self.parts[name] = COMPONENTS[each.fmu.name](**each.values)
        for part in self.parts.values():
            self.place(part, 0.0)
            assert part.initialize(0.0) == 0

    @staticmethod
    def place(part, angle):
        if hasattr(part, "shaft_angle"):
            part.shaft_angle, part.shaft_velocity, part.shaft_acceleration = angle, 1.0, 0.0

    def motions(self, angle):
        """Mass, first and second derivative of each motion by the shaft's angle, and its weight."""
        dobby = self.parts.get("dobby")
        for name, part in self.parts.items():
            self.place(part, angle)
            if name.startswith("heald"):
                for signal in ROTOR:
                    setattr(part, signal, getattr(dobby, signal))
            part.step(0.0, 0.0)
            if name == "weft":
                yield part.moving_mass, part.velocity, part.acceleration, 0.0
            elif name == "dobby":
                yield part.rotor_inertia, part.rotor_velocity, part.rotor_acceleration, 0.0
            elif name == "reed":
                yield part.reed_mass, part.velocity, part.acceleration, 0.0
            else:
                yield part.frame_mass, part.velocity, part.acceleration, part.frame_mass * GRAVITY

    def law(self, _time, state):
        angle, velocity = state
        inertia, torque = 2.0, 40.0 * (self.speed - velocity) - self.given.get("torque_32", 0.0)
        for mass, first, second, weight in self.motions(angle):
            inertia += mass * first * first
            torque -= mass * first * second * velocity * velocity + weight * first
        return velocity, torque / inertia

    def velocity(self, time):
        """Of the shaft, and its angle."""
        # steps no longer than 2 deg: the laws of the dobby are smooth in pieces
        found = solve_ivp(
            self.law, (0.0, time[-1]), [0.0, self.speed], method="DOP853", rtol=1e-12, atol=1e-12,
            t_eval=time, max_step=time[-1] / 180.0,
        )  # fmt: skip
        return found.y[1], found.y[0]


def largest_errors(text, steps, coupling="iterated"):
    """Largest errors of velocity and angle in the revolution, and at its end."""
    scene = scenes.parse(text.format(steps=steps, coupling=coupling), "driven")
    signals = ["shaft.velocity", "shaft.angle"]
    trace = loomfmu.evaluate(scene, values=signals, flavour="live").trace
    exact = Monolith(scene).velocity(trace.time)
    errors = [np.abs(trace[signal] - each) for signal, each in zip(signals, exact, strict=True)]
    return (*(float(e.max()) for e in errors), *(float(e[-1]) for e in errors))


def test_a_whole_loom_follows_one_integration_of_its_equations():
    found = [largest_errors(LOOM, steps) for steps in (90, 180, 360)]
    # fourth order, but for the samples about which the dobby's law and its slow points are not smooth
    for coarse, fine in pairwise(found):
        assert coarse[0] / fine[0] > 6.0
    assert found[-1][0] < 1e-6
    assert found[-1][1] < 1e-8


TABLE = re.compile(r"\| (\d+) \| (repeated|previous step) \| (\S+) \| (\S+) \| (\S+) \| (\S+) \|")


@pytest.mark.parametrize(
    "row",
    TABLE.findall((ROOT / "fmus/driven_shaft/README.md").read_text()),
    ids=lambda row: f"{row[0]}-{row[1]}",
)
def test_the_table_of_errors_in_the_readme_is_true(row):
    steps, coupling, *printed = row
    found = largest_errors(WEFT, int(steps), "iterated" if coupling == "repeated" else "lagged")
    for value, text in zip(found, printed, strict=True):
        # two digits; where 1e-9 is reached, as far as the iteration goes
        assert value == pytest.approx(float(text), rel=0.06, abs=2e-10)


def test_the_readme_has_that_table():
    assert len(TABLE.findall((ROOT / "fmus/driven_shaft/README.md").read_text())) == 6


# Energy


@pytest.mark.parametrize("steps", [45, 360])
def test_no_energy_is_lost_in_a_revolution(steps):
    text = LOOM.format(steps=steps, coupling="iterated").replace("revolutions = 1", "revolutions = 2")
    text += '[[claims]]\nkind = "energy_balance"\n'
    found = loomfmu.evaluate(scenes.parse(text), flavour="live")
    # what two ends of the loop differ by, 1e-11 of the largest work, and rounding
    assert found.claims[0].holds
    assert found.claims[0].worst < 1e-10
    trace = found.trace
    taken = sum(trace[name] - trace[name][0] for name in trace if name.endswith(".shaft_work"))
    done = trace["shaft.load_work"] - trace["shaft.other_work"]
    np.testing.assert_allclose(done, taken, rtol=0.0, atol=1e-8)
    assert trace["shaft.load_work"][-1] > 500.0


def test_torques_that_are_a_step_late_do_not_balance():
    text = LOOM.format(steps=360, coupling="lagged") + '[[claims]]\nkind = "energy_balance"\n'
    claim = loomfmu.evaluate(scenes.parse(text), flavour="live").claims[0]
    assert not claim.holds
    assert claim.worst > 1e-4


def test_the_work_is_the_integral_of_torque_and_velocity():
    text = LOOM.format(steps=1440, coupling="iterated")
    values = [
        "shaft.load_torque",
        "shaft.velocity",
        "shaft.load_work",
        "shaft.motor_power",
        "shaft.motor_work",
    ]
    trace = loomfmu.evaluate(scenes.parse(text), values=values, flavour="live").trace
    size = trace.time[1]
    for power, work in (
        (trace["shaft.load_torque"] * trace["shaft.velocity"], trace["shaft.load_work"]),
        (trace["shaft.motor_power"], trace["shaft.motor_work"]),
    ):
        simpson = size / 3.0 * (power[:-2:2] + 4.0 * power[1:-1:2] + power[2::2]).sum()
        # Simpson's rule over samples 0.25 deg apart, across the kinks of the dobby's law
        assert work[-1] == pytest.approx(simpson, abs=1e-5)


def test_flavours_run_a_driven_loom_to_the_same_bit():
    scene = scenes.parse(LOOM.format(steps=90, coupling="iterated"))
    values = ["shaft.velocity", "shaft.motor_work", "shaft.load_work", "heald_1.shaft_torque"]
    live, native = (loomfmu.evaluate(scene, values=values, flavour=f).trace for f in ("live", "native"))
    for name in values:
        np.testing.assert_array_equal(live[name], native[name])
