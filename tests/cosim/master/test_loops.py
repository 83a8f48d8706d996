"""Loops: watched for instability while they lag, and cured by iteration with rollback of states."""

import ctypes
import itertools
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from odd_components import odd
from scene_texts import unsolved
from scipy.integrate import solve_ivp
from stepped import same_bits, stepped

import loomfmu
from loomfmu import LoomfmuError
from loomfmu.components import COMPONENTS
from loomfmu.cosim.importing import fmus
from loomfmu.cosim.importing.built import file_of
from loomfmu.cosim.importing.calls import Call
from loomfmu.cosim.importing.logged import Logged
from loomfmu.cosim.importing.slave import Ended
from loomfmu.cosim.master import loops
from loomfmu.cosim.master.grid import Span
from loomfmu.cosim.master.loops import Broyden, CompiledIteration, Growth, Iteration, Loop
from loomfmu.cosim.master.steppers import Action, Memory, Rows
from loomfmu.cosim.reading import in_flavour
from loomfmu.cosim.run import Evaluation
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.cosim.scenes.graph import Wire
from loomfmu.fmi.native.platforms import host
from loomfmu.fmi.system.loops import RULE

__all__ = ["odd"]

needs_compiler = pytest.mark.skipif(
    find_spec("ziglang") is None, reason="there is no compiler to build the stepper with"
)

LOOP = """
revolutions = {revolutions}
steps_per_revolution = {steps}
coupling = "{coupling}"
[loom]
machine = "WL680-3600"
[shaft]
component = "DrivenShaft"
speed = "400 rpm"
torque_slope = "40 N.m.s/rad"
inertia = "{inertia} kg.m2"
"""
WIRES = "weft.shaft_torque -> shaft.torque_1, weft.shaft_work -> shaft.work_1"
# the head's mass seen from the shaft is at most 0.1985 kg.m2: a lighter shaft is unstable while the loop lags
LIGHT, LIGHTEST, HEAVY = 0.1, 0.002, 2.0


def looped(coupling: str, inertia: float, steps: int, revolutions: float) -> str:
    """A scene of a head and a shaft that feels it."""
    return LOOP.format(coupling=coupling, inertia=inertia, steps=steps, revolutions=revolutions)


def driven(
    coupling: str, inertia: float, steps: int = 720, revolutions: float = 2.0, flavour: str = "native"
) -> Evaluation:
    scene = scenes.parse(looped(coupling, inertia, steps, revolutions), "loop")
    return loomfmu.evaluate(scene, values=["shaft.velocity", "weft.shaft_torque"], flavour=flavour)


def exact(inertia: float, time: np.ndarray) -> np.ndarray:
    """Velocity of the shaft: `(J + m s'^2) w' + m s' s'' w^2 = k (w0 - w)`, with tight tolerances."""
    scene = scenes.parse(looped("lagged", inertia, 90, 1))
    weft = COMPONENTS["WeftInsertion"](**scene.instances["weft"].values)
    mass = weft.moving_mass + weft.wheel_inertia / (0.5 * weft.wheel_diameter) ** 2

    def slopes(angle: float) -> tuple[float, float]:
        weft.shaft_angle, weft.shaft_velocity, weft.shaft_acceleration = angle, 1.0, 0.0
        weft.initialize(0.0)
        return weft.velocity, weft.acceleration

    def rates(_time: float, state: np.ndarray) -> tuple[float, float]:
        first, second = slopes(state[0])
        torque = 40.0 * (scene.speed - state[1]) - mass * first * second * state[1] ** 2
        return state[1], torque / (inertia + mass * first**2)

    start = (0.0, scene.speed)
    found = solve_ivp(rates, (0.0, time[-1]), start, method="DOP853", rtol=1e-12, atol=1e-12, t_eval=time)
    return found.y[1]


# ---- lagged


@pytest.mark.parametrize(
    ("inertia", "steps", "flavour"),
    [
        *((inertia, 720, flavour) for inertia in (LIGHT, LIGHTEST) for flavour in fmus.FLAVOURS),
        (LIGHT, 23040, "native"),  # no step is small enough
    ],
)
def test_an_unstable_lagged_loop_is_reported_with_its_remedy(
    inertia: float, steps: int, flavour: str
) -> None:
    with pytest.raises(LoomfmuError) as raised:
        driven("lagged", inertia, steps, 1.0, flavour)
    said = str(raised.value)
    assert said.startswith(f"loop {WIRES} is unstable, growing by a factor of ")
    assert said.endswith('; set coupling = "iterated"') and "\n" not in said


def test_a_heavy_shaft_is_stable_and_not_reported() -> None:
    found = driven("lagged", HEAVY)
    assert found.warnings == tuple(
        f"loop: {wire} carries the value of the step before" for wire in WIRES.split(", ")
    )
    # one step late: of first order in the step
    assert np.max(np.abs(found.trace["shaft.velocity"] - exact(HEAVY, found.trace.time))) < 3e-2


# ---- iterated


@pytest.mark.parametrize("inertia", [HEAVY, 0.21, LIGHT, LIGHTEST])
def test_iterated_it_follows_the_exact_motion_in_fourth_order(inertia: float) -> None:
    errors = []
    for steps in (180, 360, 720):
        found = driven("iterated", inertia, steps)
        assert found.warnings == ()
        difference = found.trace["shaft.velocity"] - exact(inertia, found.trace.time)
        errors.append(np.max(np.abs(difference)))
    # the torque follows the parabola with the right ends and the right work: a sixteenth of the error for
    # half the step, down to where the iteration ends; a lagged loop has an error of 0.02. The lightest
    # shaft has a time constant of 50 us.
    assert errors[-1] < (1e-7 if inertia > LIGHTEST else 2e-5)
    for coarse, fine in itertools.pairwise(errors):
        assert coarse / fine > (12.0 if fine > 1e-9 and inertia > LIGHTEST else 5.0)


COUPLED = """
revolutions = 1
steps_per_revolution = 90
coupling = "iterated"
[odd]
component = "Switched"
[other]
component = "Switched"
[inputs]
"odd.engaged" = [[0, true]]
"other.engaged" = [[0, true]]
"odd.gear" = [[0, 2], [0.4, -3]]
"other.gear" = [[0, 0], [0.5, 1]]
[wires]
"other.ratio" = "odd.value"
"odd.ratio" = "other.value"
"""


@pytest.mark.few(3)
@needs_compiler
@pytest.mark.usefixtures("odd")
@pytest.mark.parametrize("flavour", fmus.FLAVOURS)
@pytest.mark.parametrize("inertia", [HEAVY, LIGHT, LIGHTEST, None])
def test_iterated_in_c_it_gives_the_same_bits(inertia: float | None, flavour: str) -> None:
    text = looped("iterated", inertia, 360, 1) if inertia else COUPLED
    scene = in_flavour(scenes.parse(text, "loop"), flavour)
    same_bits(stepped(scene, CompiledIteration), stepped(scene, Iteration))


@needs_compiler
def test_fmus_of_fmi_3_are_iterated_in_c_to_the_bits_of_fmi_2(tmp_path: Path) -> None:
    text = looped("iterated", LIGHT, 360, 1)
    files = {
        name: file_of(COMPONENTS[name], "native", (host(),), 3) for name in ("DrivenShaft", "WeftInsertion")
    }
    given = text.replace('component = "DrivenShaft"', f'fmu = "{files["DrivenShaft"]}"')
    given += f'[weft]\nfmu = "{files["WeftInsertion"]}"\n'
    fmi2, fmi3 = (in_flavour(scenes.parse(each, "loop"), "native") for each in (text, given))
    same_bits(stepped(fmi2, CompiledIteration), stepped(fmi3, CompiledIteration))


@needs_compiler
def test_iterated_in_c_it_fails_as_in_python(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = in_flavour(scenes.parse(looped("iterated", LIGHT, 360, 1), "loop"), "native")
    monkeypatch.setattr(loops, "RULE", RULE._replace(most_exchanges=2))
    reasons = []
    for kind in (CompiledIteration, Iteration):
        with pytest.raises(LoomfmuError) as raised:
            stepped(scene, kind)
        reasons.append(str(raised.value))
    assert reasons[0] == reasons[1]
    assert "did not converge at 0" in reasons[0] and "in 2 exchanges" in reasons[0]


def iterated(
    text: str, monkeypatch: pytest.MonkeyPatch, tolerance: float | None = None
) -> tuple[np.ndarray, float]:
    """All samples of the reals, and how many exchanges a step took in the mean."""
    exchanges, settle = [], Broyden.settle

    def counted(self: Broyden, exchange: Callable[[], None]) -> bool:
        return settle(self, lambda: exchanges.append(None) or exchange())

    with monkeypatch.context() as patch:
        patch.setattr(Broyden, "settle", counted)
        if tolerance:
            patch.setattr(loops, "RULE", RULE._replace(tolerance=tolerance))
        reals = stepped(in_flavour(scenes.parse(text, "loop"), "native"), Iteration)[1]
    return reals, len(exchanges) / len(reals)


def test_a_slow_shaft_is_as_good_as_a_fast_one(monkeypatch: pytest.MonkeyPatch) -> None:
    text = looped("iterated", LIGHT, 720, 1)
    text = text.replace("400 rpm", "5 rpm")
    found, exact = (iterated(text, monkeypatch, tolerance)[0] for tolerance in (None, 1e-14))
    # its motor and its load cancel but for 1 in 400: their 1e-12 is 4e-10 of the acceleration, where 1e-11 of
    # the largest torque was 1.5e-9 of it
    error = np.max(np.abs(found - exact), axis=0)
    assert np.all(error <= 4e-10 * np.max(np.abs(exact), axis=0))


def test_a_step_of_an_ordinary_loop_takes_five_exchanges(monkeypatch: pytest.MonkeyPatch) -> None:
    text = looped("iterated", LIGHT, 720, 1)
    assert iterated(text, monkeypatch)[1] < 5.1  # 4.9; it took 5.3 for a tenth of the digits


def test_rolled_back_extremes_and_counters_are_those_of_the_last_try() -> None:
    scene = scenes.parse(looped("iterated", LIGHT, 360, 1))
    found = loomfmu.evaluate(scene, values=["belt.lowest_margin", "belt.margin"])
    lowest, margin = found.trace["belt.lowest_margin"], found.trace["belt.margin"]
    # the tries of a step reach far; were they not taken back, the latched value would lie below every sample
    assert np.all(lowest <= np.minimum.accumulate(margin) + 1e-15)
    # what a margin with a curvature of 90 falls within half a degree
    assert np.min(margin) - lowest[-1] < 4e-3


def test_a_loop_without_solution_is_told_with_place_and_time(tmp_path: Path) -> None:
    with pytest.raises(LoomfmuError) as raised:
        loomfmu.run(scenes.parse(unsolved(0.01, 0.02), "unsolved"), output=tmp_path / "unsolved.h5")
    said = str(raised.value)
    assert "damper_1.carrier_acceleration -> belt.acceleration" in said
    assert "in 50 exchanges" in said
    assert [path.name for path in tmp_path.iterdir()] == ["unsolved.h5.partial"]


# ---- the solver and the watch by themselves


class Solver(Broyden):
    """A solver of `function(values) = values`, with its exchanges and what the last one left."""

    def __init__(self, start: np.ndarray, function: Callable[[np.ndarray], np.ndarray]):
        self.values, self.function, self.exchanges, self.left = start, function, 0, np.zeros(len(start))
        super().__init__(start, np.zeros(1, dtype=np.int32), range(len(start)))

    def exchange(self) -> None:
        found = self.function(self.values.copy())
        self.left, self.exchanges = np.abs(found - self.values), self.exchanges + 1
        self.values[:] = found

    def solve(self) -> bool:
        self.exchanges = 0
        return self.settle(self.exchange)


@pytest.mark.parametrize("gain", [-1000.0, -10.0, -1.0, 0.0, 0.5, 0.99, 5.0])
def test_the_solver_finds_the_fixed_point_of_linear_loops_of_any_gain(gain: float) -> None:
    solver = Solver(np.zeros(1), lambda values: gain * values + 3.0)
    assert solver.solve()
    # the residual is below 1e-11 of the value, the value itself off by that over (1 - gain)
    assert solver.values[0] == pytest.approx(3.0 / (1.0 - gain), rel=1e-8)


def test_the_solver_finds_coupled_fixed_points_and_keeps_what_it_learnt() -> None:
    random = np.random.default_rng(2)
    matrix, constant = random.normal(size=(4, 4)) * 3.0, random.normal(size=4)
    solver = Solver(np.zeros(4), lambda values: matrix @ values + constant)
    assert solver.solve()
    expected = np.linalg.solve(np.eye(4) - matrix, constant)
    np.testing.assert_allclose(solver.values, expected, rtol=1e-8)
    first = solver.exchanges
    constant += 0.1
    assert solver.solve() and solver.exchanges <= first


@pytest.mark.parametrize("seed", range(8))
def test_the_solver_goes_on_while_what_is_left_falls(seed: int) -> None:
    random = np.random.default_rng(seed)
    matrix, constant = random.normal(size=(9, 9)), random.normal(size=9)
    solver = Solver(np.zeros(9), lambda values: matrix @ np.tanh(0.5 * values) + constant)
    assert solver.solve() and solver.exchanges > 9
    # far from 1e-9, which is for what rounding leaves: here it leaves 1e-15
    assert np.max(solver.left / np.abs(solver.values)) < 1e-11


def test_a_large_value_long_ago_does_not_loosen_the_tolerance() -> None:
    constant = 1e6
    solver = Solver(np.zeros(1), lambda values: constant * (1.0 + 0.5 * np.sin(values / constant)))
    for constant in (1e6, *(3.0 + 0.01 * np.arange(20.0) ** 2)):
        assert solver.solve()
        # 1e-14 of the largest value so far is what rounding may leave of its computation
        assert solver.left[0] <= max(1e-12 * constant, 1e-14 * 2e6)


def test_rounding_may_leave_more_in_a_loop_with_a_high_gain() -> None:
    random = np.random.default_rng(5)
    solver = Solver(np.ones(1), lambda values: 3.0 - 2.0 * values + 1e-10 * random.normal())
    assert solver.solve()
    assert solver.values[0] == pytest.approx(1.0, abs=1e-9)


def test_the_solver_gives_up_where_there_is_nothing_to_find() -> None:
    solver = Solver(np.ones(1), lambda values: values + 1.0)
    assert not solver.solve()
    assert np.isfinite(solver.values[0])


def growth() -> Growth:
    return Growth([Wire(("a", "y"), ("b", "u"))], [0])


@pytest.mark.parametrize("factor", [1.05, 1.5, 10.0])
@pytest.mark.parametrize("block", [3, 50, 400])
def test_a_growing_alternation_is_seen_whatever_the_blocks(factor: float, block: int) -> None:
    steps = np.arange(400)
    with np.errstate(over="ignore"):
        values = (1.0 + 1e-9 * (-factor) ** np.minimum(steps, 250.0))[:, None]
    watch = growth()
    with pytest.raises(LoomfmuError, match=rf"is unstable, growing by a factor of {factor:.3g} per step"):
        for start in range(0, 400, block):
            watch.check(steps[start : start + block] * 1e-3, values[start : start + block])


@pytest.mark.parametrize(
    "values",
    [
        np.sin(np.linspace(0.0, 60.0, 1000)),
        np.exp(np.linspace(0.0, 60.0, 1000)),
        np.random.default_rng(3).normal(size=1000),
        (-0.999) ** np.arange(1000),
        1.0 + 1e-13 * np.random.default_rng(4).normal(size=1000) * np.linspace(0.0, 1.0, 1000),
        np.zeros(1000),
        np.tile([1.0, -1.0], 500),
    ],
    ids=["sine", "growth", "noise", "fading", "rounding", "rest", "steady"],
)
def test_what_only_moves_is_no_swing(values: np.ndarray) -> None:
    watch = growth()
    for start in range(0, 1000, 100):
        watch.check(np.arange(start, start + 100) * 1e-3, values[start : start + 100, None])


class Ending:
    """An FMU in a loop that halves its input, counts its steps, and ends the simulation after two of them."""

    name = "halving"
    noted = Logged.noted

    def __init__(self, value: np.ndarray):
        self.value, self.steps, self.kept = value, 0, 0
        self.logged = ctypes.c_int64()

    def save(self) -> None:
        self.kept = self.steps

    def restore(self) -> None:
        self.steps = self.kept

    def step(self) -> int:
        self.steps += 1
        return 2 if self.steps == 2 else 0

    def get(self) -> int:
        self.value[0] = 0.5 * self.value[0] + self.steps
        return 0

    def failed(self, _status: int, _action: str, _time: float) -> LoomfmuError:
        return Ended(self.name, 2e-3)


def test_the_last_sample_counts_where_an_fmu_in_an_iterated_loop_ends_with_it() -> None:
    reals, integers = np.zeros(1), np.zeros(1, dtype=np.int32)
    fmu = Ending(reals)
    actions = [Action(fmu, Call(each, (), "")) for each in (fmu.step, fmu.get)]
    memory = Memory(reals, integers, (), (), ctypes.c_int32())
    loop = Loop(actions, 0, 2, "halving.y -> halving.u", [0])
    times = np.arange(5) * 1e-3
    span = Span(times[:-1], np.diff(times), times[1:], times[1:])
    driven, rows = (Rows(np.zeros((4, n)), np.zeros((4, n), dtype=np.int32)) for n in (0, 1))
    taken, ended = Iteration(loop, memory).advance(span, driven, rows)
    assert (taken, str(ended)) == (2, "halving ended the simulation at 0.002 s")
    np.testing.assert_allclose(rows.reals[:, 0], [2.0, 4.0, 0.0, 0.0], rtol=1e-9)  # y = y / 2 + steps
