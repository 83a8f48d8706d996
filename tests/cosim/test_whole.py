"""A scene as one FMU gives the bits of its run, in whatever steps a host takes."""

import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
import sharing
from foreign_motors import motor2
from hypothesis import given, settings
from hypothesis import strategies as st
from motor_scenes import MOTOR
from odd_components import odd
from scene_texts import unsolved
from whole_fmus import Instance, Signals, Whole, exported

from loomfmu import LoomfmuError, Result, run
from loomfmu.cosim import whole
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.cosim.scenes.scene import Scene
from loomfmu.fmi.native import compiler, platforms

__all__ = ["odd"]

SIMS = Path(__file__).parents[2] / "sims"
SCENES = sorted([*SIMS.glob("*.toml"), *SIMS.glob("beyond_the_limit/*.toml")])
LARGE = {"belt_motion", "driven_loom", "full_loom"}  # each takes seconds to compile
DEMO = SIMS / "wl680_3600.toml"
LOOPED = SIMS / "light_shaft.toml"
pytestmark = [
    pytest.mark.skipif(find_spec("ziglang") is None, reason="ziglang is not installed: no native FMU"),
    pytest.mark.skipif(not sys.platform.startswith("linux"), reason="native FMUs are tested on Linux alone"),
]


def loaded(path: Path, **overrides: Any) -> Scene:
    """A scene with other values."""
    return scenes.load(path, {key.replace("__", "."): value for key, value in overrides.items()})


def ran(scene: Scene, directory: Path) -> Result:
    return run(scene, output=directory / "run.h5", flavour="native")


def traced(scene: Scene, directory: Path) -> Signals:
    """All that a run of the scene records."""
    trace = ran(scene, directory).trace
    return {signal: np.asarray(trace[signal], dtype=float) for signal in trace}


def same(found: Signals, expected: Signals, every: int = 1) -> None:
    """Every signal is there, with the same bits."""
    assert found.keys() == expected.keys()
    for signal, values in found.items():
        kept = expected[signal][::every][: len(values)]
        np.testing.assert_array_equal(values, kept, err_msg=signal)


@pytest.fixture(scope="module")
def demo(fmu_cache: None, tmp_path_factory: pytest.TempPathFactory) -> Whole:
    """The demonstration as one FMU."""
    directory = tmp_path_factory.mktemp("demo")
    return Whole(exported(loaded(DEMO), directory), directory / "unpacked")


@pytest.fixture(scope="module")
def demo_run(fmu_cache: None, tmp_path_factory: pytest.TempPathFactory) -> Signals:
    """All that the run of the demonstration records."""
    return traced(loaded(DEMO), tmp_path_factory.mktemp("run"))


@pytest.fixture(scope="module", params=[2, 3])
def belt(request: pytest.FixtureRequest, fmu_cache: None, tmp_path_factory: pytest.TempPathFactory) -> Whole:
    """A belt alone, whose inputs are those of the FMU."""
    directory = tmp_path_factory.mktemp("belt")
    scene = scenes.parse("duration = 1\nstep = 0.01\n[belt]\n", "open")
    return Whole(exported(scene, directory, request.param), directory / "unpacked")


of_fmi_2 = pytest.mark.parametrize("belt", [2], indirect=True)


# ---- the bits of a run


@pytest.mark.few(1)
@pytest.mark.parametrize(
    "path",
    [pytest.param(path, marks=[pytest.mark.slow] * (path.stem in LARGE), id=path.stem) for path in SCENES],
)
def test_it_gives_the_bits_of_the_run(tmp_path: Path, path: Path) -> None:
    scene = loaded(path)
    one = Whole(exported(scene, tmp_path), tmp_path / "unpacked")
    expected, some = traced(scene, tmp_path), min(scene.steps, 200)
    same(one.instance().along(some, scene.step_size), expected)
    every = next(n for n in range(scene.steps // 100, scene.steps) if scene.steps % n == 0)  # to the end
    same(one.instance().along(scene.steps, scene.step_size, every), expected, every)


def test_it_does_so_in_fmi_3(tmp_path: Path) -> None:
    scene = loaded(SIMS / "worn_belt.toml", revolutions=1)
    one = Whole(exported(scene, tmp_path, fmi=3), tmp_path / "unpacked")
    assert one.fmi == 3
    same(one.instance().along(scene.steps, scene.step_size), traced(scene, tmp_path))


def test_a_step_that_ends_off_the_grid_is_made_to_its_end(demo: Whole) -> None:
    """Ends of communication steps are further points of the grid, and steps of any length agree."""
    size = loaded(DEMO).step_size
    usual, other = demo.instance(), demo.instance()
    for step in range(137):
        usual.step(step * size, size)
    for step in range(100):
        other.step(step * 1.37 * size, 1.37 * size)
    expected, found = usual.all(), other.all()
    # the dampers add up steps: each rounds its ends of some 0.1 s and 100 m/s2 anew
    assert found == pytest.approx(expected, rel=1e-10, abs=1e-12)
    for at in (found, expected):
        assert at["belt.lowest_margin"] > 0.0
    other.step(137 * size, size)  # and it is back on the grid
    usual.step(137 * size, size)
    assert other.all() == pytest.approx(usual.all(), rel=1e-10, abs=1e-12)


def test_times_may_be_off_the_grid_by_what_a_host_rounds(demo: Whole, demo_run: Signals) -> None:
    scene = loaded(DEMO)
    instance, time = demo.instance(), 0.0
    for _ in range(1000):
        instance.step(time, scene.step_size)
        time += scene.step_size  # off by 1e-13 s at the end
    found = {signal: np.array([value]) for signal, value in instance.all().items()}
    same(found, {signal: values[1000:] for signal, values in demo_run.items()})


def test_fmpy_simulates_it(demo: Whole, demo_run: Signals) -> None:
    scene = loaded(DEMO)
    found = fmpy.simulate_fmu(
        str(demo.path),
        stop_time=100 * scene.step_size,
        output_interval=scene.step_size,
        output=["belt.margin", "heald_1.lift"],
    )
    for signal in ("belt.margin", "heald_1.lift"):
        np.testing.assert_array_equal(found[signal], demo_run[signal][: len(found)])


# ---- parameters, states, instances


@pytest.mark.slow
@settings(max_examples=8)
@given(
    speed=st.floats(30.0, 75.0),
    clearance=st.floats(0.0, 1e-3),
    stroke=st.floats(0.05, 0.12),
    steps=st.integers(90, 300),
)
def test_a_parameter_has_the_effect_of_set(
    tmp_path_factory: pytest.TempPathFactory,
    demo: Whole,
    speed: float,
    clearance: float,
    stroke: float,
    steps: int,
) -> None:
    values: dict[str, Any] = {
        "shaft__speed": speed,
        "belt__guide_clearance": clearance,
        "heald_2__stroke": stroke,
        "steps_per_revolution": steps,
    }
    scene = loaded(DEMO, revolutions=1, **values)
    instance = demo.instance(**values)
    found = instance.along(scene.steps, scene.step_size)
    instance.free()
    same(found, traced(scene, tmp_path_factory.mktemp("set")))


@pytest.fixture(scope="module")
def shaft(fmu_cache: None, tmp_path_factory: pytest.TempPathFactory) -> Whole:
    """A shaft that feels what it drives: an algebraic loop."""
    directory = tmp_path_factory.mktemp("shaft")
    return Whole(exported(loaded(LOOPED), directory, fmi=3), directory / "unpacked")


@pytest.mark.parametrize("path", [DEMO, LOOPED], ids=["demo", "looped"])
def test_a_state_is_saved_restored_and_serialized(path: Path, request: pytest.FixtureRequest) -> None:
    one = request.getfixturevalue("demo" if path == DEMO else "shaft")
    size = loaded(path).step_size
    instance, other = one.instance("one"), one.instance("other")
    instance.along(300, size)
    state, serialized = instance.save()
    ahead = [instance.step((300 + step) * size, size) or instance.all() for step in range(50)]
    instance.restore(state)
    again = [instance.step((300 + step) * size, size) or instance.all() for step in range(50)]
    other.restore(serialized)
    there = [other.step((300 + step) * size, size) or other.all() for step in range(50)]
    assert ahead == again == there


def test_a_reset_starts_again(demo: Whole) -> None:
    size = loaded(DEMO).step_size
    instance = demo.instance(shaft__speed=50.0)
    instance.along(100, size)
    instance.slave.reset()
    instance.initialize()
    same(instance.along(100, size), demo.instance().along(100, size))


def test_two_instances_know_nothing_of_each_other(demo: Whole) -> None:
    size = loaded(DEMO).step_size
    one, two = demo.instance("one"), demo.instance("two", shaft__speed=50.0)
    found: list[list[dict[str, float]]] = [[], []]
    for step in range(60):
        for each, rows in zip((one, two), found, strict=True):
            each.step(step * size, size)
            rows.append(each.all())
    for values, rows in zip(({}, {"shaft__speed": 50.0}), found, strict=True):
        alone = demo.instance(**values).along(60, size)
        assert [row["damper_1.displacement"] for row in rows] == list(alone["damper_1.displacement"][1:])


# ---- algebraic loops

SWITCHED = """
revolutions = 1
steps_per_revolution = 90
coupling = "iterated"
[odd]
component = "Switched"
[other]
component = "Switched"
[inputs]
"odd.gear" = [[0, 2], [0.4, -3]]
"other.engaged" = [[0, true], [0.2, false], [0.7, true]]
[wires]
"other.gear" = "odd.gear_in_use"
"other.ratio" = "odd.value"
"odd.engaged" = "other.running" # what closes the loop is not real
"""
UNSOLVED = unsolved(0.1, 0.2)


def test_a_loop_gives_the_bits_of_the_run_in_fmi_3(tmp_path: Path, shaft: Whole) -> None:
    scene = loaded(LOOPED, revolutions=1)
    same(shaft.instance().along(scene.steps, scene.step_size), traced(scene, tmp_path))


@pytest.mark.usefixtures("odd")
def test_a_loop_hands_on_what_is_not_real(tmp_path: Path) -> None:
    scene = scenes.parse(SWITCHED, "switched")
    one = Whole(exported(scene, tmp_path), tmp_path / "unpacked")
    expected = traced(scene, tmp_path)
    assert set(expected["other.value"]) == {0.0, 2.0, 4.5} and set(expected["odd.running"]) == {0.0, 1.0}
    same(one.instance().along(scene.steps, scene.step_size), expected)


def test_a_loop_that_does_not_converge_fails_the_step_or_the_start_and_is_named(tmp_path: Path) -> None:
    scene = scenes.parse(UNSOLVED, "unsolved")
    (warning,) = whole.export(scene, tmp_path / "unsolved.fmu", (platforms.host(),))
    assert warning.startswith("the FMU has no reference results, since the scene cannot run: loop damper_1")
    one = Whole(tmp_path / "unsolved.fmu", tmp_path / "unpacked")
    instance = one.instance()
    wire = "loop damper_1.carrier_acceleration -> belt.acceleration"
    with pytest.raises(LoomfmuError, match=wire) as raised:
        ran(scene, tmp_path)
    step = round(float(str(raised.value).partition(" at ")[2].partition(" s")[0]) / scene.step_size)
    instance.along(step, scene.step_size)
    before = instance.all()
    with pytest.raises(Exception, match=r"DoStep failed with status 2 \(discard\)"):
        instance.step(step * scene.step_size, scene.step_size)
    assert instance.log[-1].endswith(f"{wire} did not converge")
    assert instance.all() == before
    late = one.instance(start=30 * scene.step_size)  # a third of a revolution
    assert f"{wire}: the start values did not converge" in late.log


def test_a_loop_gives_no_derivatives_and_says_so(shaft: Whole) -> None:
    assert not shaft.description.coSimulation.providesDirectionalDerivative
    margin = shaft.variables["belt.margin"].valueReference
    speed = shaft.variables["shaft.speed"].valueReference
    with pytest.raises(Exception, match="fmi3GetDirectionalDerivative failed"):
        shaft.instance().slave.getDirectionalDerivative([margin], [speed], [1.0])


def test_a_lagged_loop_is_refused(tmp_path: Path) -> None:
    scene = loaded(LOOPED, coupling="lagged")
    with pytest.raises(LoomfmuError, match=r"torque_1 is lagged, and .* iterates: set coupling = 'iterated'"):
        exported(scene, tmp_path)


# ---- what is in it


def test_only_what_its_outputs_need_is_in_it(tmp_path: Path) -> None:
    text = 'record = ["weft.travel"]\n[loom]\nmachine = "WL680-3600"\nweave = "10/01"\n[shaft]\nspeed = 60\n'
    made = whole.system(scenes.parse(text, "lean"))
    assert [part.name for part in made.parts] == ["shaft", "weft"]
    assert made.outputs == {
        "shaft.angle",
        "shaft.velocity",
        "shaft.acceleration",
        "weft.travel",
        "weft.velocity",
        "weft.acceleration",
    }


@pytest.mark.slow
def test_the_same_scene_gives_the_same_bytes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compiler, "compiled_in", sharing.COMPILED_IN)
    scene = loaded(SIMS / "belt_alone.toml")
    first = exported(scene, tmp_path).read_bytes()
    assert exported(scene, tmp_path).read_bytes() == first


OWN = '''
from dataclasses import dataclass
from typing import ClassVar

from loomfmu.mechanism import Component, Problem, array, input_, output, parameter, state


@dataclass(slots=True)
class Gate(Component):
    """Lets through what it is given, or its table."""

    problems: ClassVar[tuple[Problem, ...]] = (Problem("{given} is odd", warning=True),)

    default: float = parameter("1", 0.5, "A name that C keeps for itself")
    short: tuple[int, ...] = array(parameter("1", start, "Entry") for start in (3, 1, 2))
    open: bool = input_("1", False, "Whether it is open")
    place: int = input_("1", 0, "Entry that is read")
    given: float = input_("1", 0.0, "What it is given", minimum=-1.5, maximum=1.5)
    passed: float = output("1", "What comes through")
    entry: int = output("1", "Entry", start=0)
    is_open: bool = output("1", "Whether it is open", start=False)
    count: int = state("1", "Steps", start=0)

    def initialize(self, time: float) -> int:
        """Show the start."""
        self.count = 0
        return self.step(time, 0.0)

    def step(self, time: float, step_size: float) -> int:
        """Let through."""
        self.passed = self.given + self.default if self.open else 0.0
        self.entry = self.short[self.place]
        self.is_open = self.open
        self.count = self.count + 1
        return 1 if self.given > 1.0 else 0
'''

GATES = """
duration = "1 s"
step = "10 ms"

[one]
component = "gate.py:Gate"
short_2 = 7

[two]
component = "gate.py:Gate"
default = 0.25

[wires]
"two.given" = "one.passed"
"two.open" = "one.is_open"

[inputs]
"one.given" = [[0, 0.0], [0.3, 0.9], [0.5, LAST]]
"one.open" = [[0, true], [0.105, false], [0.2, true]]
"one.place" = [[0, 0], [0.5, 1], [0.75, 2]]
"""


def gates(directory: Path, last: float = 0.1) -> Scene:
    """Two mechanisms of one's own, driven by tables of all types."""
    (directory / "gate.py").write_text(OWN)
    return scenes.parse(GATES.replace("LAST", str(last)), "double", directory=directory)


@pytest.mark.slow
def test_mechanisms_of_ones_own_and_tables_of_all_types(tmp_path: Path) -> None:
    scene = gates(tmp_path)
    one = Whole(exported(scene, tmp_path), tmp_path / "unpacked")
    assert one.description.modelName == "double_scene"  # which C keeps for itself
    # a run at 10 ms has a sample at 0.105 s, too, which the FMU passes over: one at 5 ms has the same times
    expected = traced(scenes.parse(scene.text, "fine", {"step": "5 ms"}, tmp_path), tmp_path)
    same(one.instance().along(scene.steps, scene.step_size), expected, every=2)
    assert set(expected["one.entry"]) == {3.0, 7.0, 2.0}
    steps = 2 * scene.steps  # on straight lines the value is half way between
    same(one.instance(step=scene.step_size / 2).along(steps, scene.step_size / 2), expected)


@pytest.mark.parametrize(
    ("path", "fmi"),
    [(None, 2), (LOOPED, 3), *(pytest.param(DEMO, fmi, marks=pytest.mark.slow) for fmi in (2, 3))],
)
def test_its_sources_compile_without_a_warning(tmp_path: Path, path: Path | None, fmi: int) -> None:
    if shutil.which("gcc") is None:
        pytest.skip("gcc is not installed")
    scene = loaded(path) if path else gates(tmp_path)
    one = Whole(exported(scene, tmp_path, fmi), tmp_path / "unpacked")
    warnings = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror"]
    options = ["-std=c99", "-O1", "-ffp-contract=off", "-fPIC", "-shared", "-o", str(tmp_path / "x.so")]
    command = ["gcc", *warnings, *options, f"fmi{fmi}.c", "-lm"]
    sources = Path(one.directory) / "sources"
    done = subprocess.run(command, cwd=sources, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr


# ---- failures, in the words of the run


def test_a_wired_value_outside_its_limits_ends_the_run(tmp_path: Path) -> None:
    scene = gates(tmp_path, last=1.4)
    with pytest.raises(LoomfmuError, match=r"two at .*given = 1.5\d* is outside \[-1.5, 1.5\]") as raised:
        ran(scene, tmp_path)
    at = float(str(raised.value).partition(" at ")[2].partition(" s")[0])
    one = Whole(exported(scene, tmp_path), tmp_path / "unpacked")
    instance = one.instance()
    before = round(at / scene.step_size)
    instance.along(before, scene.step_size)
    reached = instance.all()
    with pytest.raises(Exception, match="DoStep"):
        instance.step(before * scene.step_size, 5 * scene.step_size)
    assert instance.log[-1].startswith("two.given = 1.5") and "is outside [-1.5, 1.5]" in instance.log[-1]
    assert reached["two.passed"] > 1.0


def test_warnings_are_those_of_the_run(tmp_path: Path, demo: Whole) -> None:
    result = ran(loaded(DEMO, belt__guide_clearance="2 mm", revolutions=1), tmp_path)
    instance = demo.instance(belt__guide_clearance=2e-3)
    instance.along(10, 1e-4)
    assert instance.log == [text for text in result.warnings if text.startswith("belt: ")] != []


def test_a_shaft_that_stands_still_has_no_step(demo: Whole) -> None:
    with pytest.raises(Exception, match="fmi2ExitInitializationMode failed"):
        demo.instance(shaft__speed=0.0)


@of_fmi_2
def test_a_step_that_would_take_hours_is_refused(belt: Whole) -> None:
    instance = belt.instance(step=1e-12)
    with pytest.raises(Exception, match="fmi2DoStep failed"):
        instance.along(1, 1e-3)
    assert any("takes more than 1e7 steps of the components" in text for text in instance.log)


@of_fmi_2
def test_derivatives_of_inputs_are_refused(belt: Whole) -> None:
    assert belt.variables["belt.travel"].causality == "input"
    assert belt.description.coSimulation.canInterpolateInputs is False
    instance = belt.instance()
    with pytest.raises(Exception, match="fmi2SetRealInputDerivatives failed"):
        instance.slave.setRealInputDerivatives([belt.variables["belt.travel"].valueReference], [1], [0.0])
    assert instance.log[-1].endswith("belt.travel: input derivatives are not supported")


def test_outputs_of_a_step_have_derivatives(belt: Whole) -> None:
    """Through all steps of the components in a communication step, the last of which is shorter."""
    names = ["belt.margin", "belt.free_length"]
    travel, *outputs = (belt.variables[name].valueReference for name in ("belt.travel", *names))

    def stepped(value: float) -> Any:
        instance = belt.instance(belt__travel=0.9, belt__acceleration=50.0)
        instance.set({"belt.travel": value})
        instance.step(0.0, 0.025)
        return instance

    size = 1e-4
    (below, above) = ([*stepped(0.91 + side).get(names).values()] for side in (-size, size))
    found = stepped(0.91).slave.getDirectionalDerivative(outputs, [travel], [1.0])
    # second-order differences: (1e-4 / 0.9)^2
    assert found == pytest.approx(
        [(b - a) / (2.0 * size) for a, b in zip(below, above, strict=True)], rel=1e-6
    )


def test_outputs_of_its_start_have_derivatives_by_parameters(tmp_path: Path) -> None:
    """Tables of inputs lie along revolutions: at a later start the speed moves them, too."""
    one = Whole(exported(loaded(SIMS / "worn_belt.toml"), tmp_path, fmi=3), tmp_path / "unpacked")
    names = ["belt.margin", "belt.length_factor", "weft.velocity"]
    outputs = [one.variables[name].valueReference for name in names]
    speed, time = (one.variables[name].valueReference for name in ("shaft.speed", "time"))
    start, size, base = 0.42, 1e-4, 56.0

    def started(value: float, at: float = start) -> Any:
        instance = Instance(one, "tested")
        instance.set({"shaft.speed": value})
        instance.slave.enterInitializationMode(startTime=at)
        return instance

    here = started(base)
    for known, sides in (
        (speed, (started(base - size), started(base + size))),
        (time, (started(base, start - 1e-6), started(base, start + 1e-6))),
    ):
        below, above = ([*each.get(names).values()] for each in sides)
        width = 2.0 * size if known == speed else 2e-6
        found = here.slave.getDirectionalDerivative(outputs, [known], [1.0])
        # second-order differences of curves that turn 20 revolutions
        assert found == pytest.approx(
            [(b - a) / width for a, b in zip(below, above, strict=True)], rel=1e-5, abs=1e-6
        )
    (adjoint,) = here.slave.getAdjointDerivative(outputs, [speed], [1.0, 0.0, 0.0], 1)
    assert adjoint == here.slave.getDirectionalDerivative(outputs[:1], [speed], [1.0])[0]


def test_what_cannot_be_in_it_is_refused(tmp_path: Path) -> None:
    motor2(tmp_path)
    (tmp_path / "motor.toml").write_text(MOTOR)
    with pytest.raises(LoomfmuError, match=r"motor is an FMU file, .*Motor.fmu; .* use --ssp"):
        whole.export(scenes.load(tmp_path / "motor.toml"), tmp_path / "motor.fmu")
    assert not (tmp_path / "motor.fmu").exists()
    (tmp_path / "other").mkdir()
    (tmp_path / "other/gate.py").write_text(OWN.replace("0.5", "0.75"))
    gates(tmp_path)
    text = 'duration = 1\nstep = 0.1\n[one]\ncomponent = "gate.py:Gate"\n'
    text += '[two]\ncomponent = "other/gate.py:Gate"\n'
    scene = scenes.parse(text, "twice", directory=tmp_path)
    with pytest.raises(LoomfmuError, match="two components are called Gate; rename one of them"):
        whole.export(scene, tmp_path / "twice.fmu")
