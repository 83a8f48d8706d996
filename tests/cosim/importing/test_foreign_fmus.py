"""Third-party FMUs, FMI 2.0 and 3.0, wired to ours: a motor in C with an exact solution."""

import re
from collections.abc import Iterator
from contextlib import nullcontext, suppress
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray
from foreign_motors import ARRAYS, description2, library, motor2, motor3, packed
from hypothesis import given
from hypothesis import strategies as st
from motor_scenes import LENGTH, MOTOR, SHAFT3, WEFT, exact, ran, refused

from loomfmu import LoomfmuError, Trace, evaluate, run
from loomfmu.cli import main
from loomfmu.components import WeftInsertion
from loomfmu.cosim.importing import fmus, pool
from loomfmu.cosim.importing.conversions import Definition, Stated, stated
from loomfmu.cosim.importing.ports import Port
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.cosim.scenes.graph import drive
from loomfmu.machines import parameters
from loomfmu.sweeps.varied import varied

# ---- they drive our mechanisms


@pytest.mark.parametrize("step", ["1 ms", "0.1 ms"])
def test_a_motor_of_fmi_2_drives_the_weft(place: Path, tmp_path: Path, step: str) -> None:
    trace = ran(place, MOTOR + WEFT, tmp_path, step=step).trace
    angle, velocity, acceleration = exact(trace.time)
    # some thousand roundings of sums that grow to 3 rad, 30 rad/s, 200 rad/s2
    np.testing.assert_allclose(trace["motor.flange_phi"], angle, rtol=0, atol=1e-12)
    np.testing.assert_allclose(trace["motor.flange_w"], velocity, rtol=0, atol=1e-11)
    np.testing.assert_allclose(trace["motor.flange_a"], acceleration, rtol=0, atol=1e-10)
    weft = WeftInsertion(**parameters("WeftInsertion", machine="WL680-3600"))
    weft.follow_shaft = weft.inputs_at_step_end = True
    for row in (0, 50, trace.rows - 1):
        weft.shaft_angle, weft.shaft_velocity, weft.shaft_acceleration = (
            float(trace[f"motor.flange_{signal}"][row]) for signal in ("phi", "w", "a")
        )
        assert weft.initialize(0.0) == 0
        assert weft.travel == pytest.approx(trace["weft.travel"][row], rel=1e-13, abs=1e-13)
        assert weft.acceleration == pytest.approx(trace["weft.acceleration"][row], rel=1e-12, abs=1e-10)


@pytest.mark.parametrize("isolated", ["true", "false"])
@pytest.mark.parametrize(
    ("tolerance", "said"),
    [("1e-4", ""), ("0.5", "motor: .*fmi2SetupExperiment"), ("0", "tolerance = 0 must be a finite number")],
)
def test_the_tolerance_that_an_fmu_states_is_passed_on_to_it(
    place: Path, tmp_path: Path, tolerance: str, said: str, isolated: str
) -> None:
    stated = f'<DefaultExperiment tolerance="{tolerance}"/><ModelVariables>'
    text = description2().replace("<ModelVariables>", stated)
    packed(place / "Strict.fmu", text, library("fmi2.c"), "Motor")  # it refuses tolerances above 0.1
    expected = pytest.raises(LoomfmuError, match=said) if said else nullcontext()
    with expected:
        ran(place, MOTOR.replace("Motor.fmu", "Strict.fmu") + f"isolated = {isolated}\n{WEFT}", tmp_path)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ("0.05", ""),
        ("0.5", "motor: .*fmi2SetupExperiment"),
        ("0", "motor.tolerance = 0 must be a finite number above 0"),
        ('"fine"', "motor.tolerance: 'fine' is not a quantity"),
    ],
)
def test_a_scene_sets_the_tolerance_of_an_fmu(place: Path, tmp_path: Path, given: str, said: str) -> None:
    stated = '<DefaultExperiment tolerance="0.5"/><ModelVariables>'
    text = description2().replace("<ModelVariables>", stated)
    packed(place / "Strict.fmu", text, library("fmi2.c"), "Motor")  # it refuses tolerances above 0.1
    with pytest.raises(LoomfmuError, match=said) if said else nullcontext():
        ran(place, MOTOR.replace("Motor.fmu", "Strict.fmu") + f"tolerance = {given}\n{WEFT}", tmp_path)


def test_a_boolean_input_of_fmi_3_is_driven(place: Path, tmp_path: Path) -> None:
    text = LENGTH + SHAFT3 + '[inputs]\n"shaft.stalled" = [[0, false], [0.1, true]]\n'
    with suppress(LoomfmuError):  # the motor ends the simulation when it stalls
        ran(place, text, tmp_path)
    (path,) = tmp_path.iterdir()
    with Trace(path) as trace:
        assert not np.any(trace["shaft.stalled"][:100])
        assert 100 <= trace.rows <= 101  # of 201: up to the step in which it is told


def test_a_motor_of_fmi_3_in_the_place_of_the_shaft_gives_the_same_bits(place: Path, tmp_path: Path) -> None:
    second = ran(place, MOTOR + WEFT, tmp_path).trace
    third = ran(place, LENGTH + SHAFT3 + '[weft]\nmachine = "WL680-3600"\n', tmp_path / "third").trace
    for one, other in (("flange_phi", "angle"), ("flange_w", "velocity"), ("flange_a", "acceleration")):
        np.testing.assert_array_equal(second[f"motor.{one}"], third[f"shaft.{other}"])
    np.testing.assert_array_equal(second["weft.acceleration"], third["weft.acceleration"])
    np.testing.assert_array_equal(third.shaft_angle, third["shaft.angle"])
    assert not np.any(second.shaft_angle)  # a scene without shaft has none, and says 0


@pytest.mark.slow
def test_a_loom_can_be_turned_by_a_motor_that_feels_it(place: Path, tmp_path: Path) -> None:
    text = LENGTH + '[loom]\nmachine = "WL680-3600"\nhead = "G6300 left"\nweave = "10"\n' + SHAFT3
    text += '[wires]\n"shaft.load" = "weft.shaft_torque"\n'
    text += '[[claims]]\nkind = "dwell"\nheald = "heald_1"\nat_least = "80 deg"\n'
    changed = {"duration": "1 s", "shaft__J": 5.0, "shaft__tau_stall": 400.0, "isolated": True}
    result = ran(place, text, tmp_path, **changed)
    assert "loop: weft.shaft_torque -> shaft.load carries the value of the step before" in result.warnings
    velocity = result.trace["shaft.velocity"]
    assert np.any(np.diff(velocity) < 0.0) and velocity[-1] > 40.0  # the head's inertia slows it now and then
    # the dwell is the law's angle, whatever the speed does meanwhile
    assert result.claims[0].holds and result.claims[0].worst == pytest.approx(np.radians(85.92125), abs=1e-6)


@pytest.mark.parametrize(
    ("file", "names"),
    [
        ("Motor.fmu", ("load_tau", "flange_phi", "flange_w", "flange_a")),
        ("Motor3.fmu", ("load", "angle", "velocity", "acceleration")),
    ],
)
def test_a_loop_with_an_fmu_that_keeps_no_state_cannot_be_iterated(
    place: Path, tmp_path: Path, file: str, names: tuple[str, ...]
) -> None:
    text = (
        LENGTH + f'coupling = "iterated"\n[weft]\nmachine = "WL680-3600"\n[motor]\nfmu = "{file}"\n[wires]\n'
    )
    text += f'"motor.{names[0]}" = "weft.shaft_torque"\n'
    inputs = ("shaft_angle", "shaft_velocity", "shaft_acceleration")
    text += "".join(f'"weft.{to}" = "motor.{name}"\n' for to, name in zip(inputs, names[1:], strict=True))
    with pytest.raises(LoomfmuError) as raised:
        ran(place, text, tmp_path)
    assert str(raised.value).startswith("motor cannot save its state, which an iterated loop requires: ")
    assert "\n" not in str(raised.value)


def test_integers_booleans_and_enumerations_come_through(place: Path, tmp_path: Path) -> None:
    text = LENGTH + SHAFT3 + '[motor]\nfmu = "Motor.fmu"\nmode = "no way back"\n'
    trace = ran(place, text, tmp_path, shaft__mode="no_way_back", shaft__w_free="100 rpm").trace
    np.testing.assert_array_equal(trace["motor.steps"], np.arange(201))
    np.testing.assert_array_equal(trace["shaft.steps"], np.arange(201))
    assert set(trace["shaft.mode_used"]) == {2}
    assert trace.parameter("motor.mode") == trace.parameter("shaft.mode") == 2
    turned = trace["shaft.velocity"] > 0.9 * np.pi / 30 * 100
    np.testing.assert_array_equal(trace["shaft.at_speed"], turned)
    assert 0 < np.count_nonzero(turned) < 201
    np.testing.assert_array_equal(trace["shaft.microradians"], np.int64(trace["shaft.angle"] * 1e6))
    np.testing.assert_array_equal(trace["shaft.velocity_32"], np.float32(trace["shaft.velocity"]))
    assert "motor.label" not in trace and "shaft.table" not in trace  # texts and arrays are not exchanged


def test_names_and_units_are_ours_where_they_can_be(place: Path, tmp_path: Path) -> None:
    trace = ran(place, MOTOR, tmp_path).trace
    names = ("flange_phi", "flange_w", "flange_a", "time_", "steps", "at_speed", "winding")
    assert set(trace) == {f"motor.{name}" for name in names}
    assert (trace.unit("motor.flange_w"), trace.rate("motor.flange_phi")) == ("rad/s", "motor.flange_w")
    assert (trace.unit("motor.flange_phi"), trace.display("motor.flange_phi")) == ("rad", "deg")
    assert (trace.unit("motor.winding"), trace.display("motor.winding")) == ("K", "K")
    ports = scenes.parse(MOTOR, directory=place).instances["motor"].fmu.ports
    assert ports["tau_stall"].unit == "N.m"  # Nm there, the same by its definition


def test_claims_on_other_makers_signals(place: Path, tmp_path: Path) -> None:
    text = MOTOR + '[[claims]]\nkind = "below"\nsignal = "motor.{}"\nbound = {}\n'
    assert ran(place, text.format("flange_w", '"600 rpm"'), tmp_path, isolated=True).holds
    result = ran(place, text.format("winding", "150"), tmp_path)
    assert not result.holds and "winding), 200 K at 0 s" in str(result.claims[0])
    with pytest.raises(
        LoomfmuError, match=r"^claim 'below': window is a shaft angle, but the scene has no sh"
    ):
        ran(place, text.format("winding", "150\nwindow = [0, 1]"), tmp_path)


def test_show_prints_units_that_are_not_ours(
    place: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    ran(place, MOTOR, tmp_path)
    assert main(["show", str(tmp_path / "motor.h5")]) == 0
    rows = {
        line.split()[0]: line.split() for line in capsys.readouterr().out.splitlines() if "motor." in line
    }
    assert rows["motor.winding"][2:] == ["200", "102.683", "K"]
    assert rows["motor.flange_phi"][-1] == "deg"


def test_run_says_how_long(place: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (place / "plain.toml").write_text('title = "A motor"\n' + MOTOR)
    trace = tmp_path / "x.h5"
    assert main(["run", str(place / "plain.toml"), "--output", str(trace), "--set", "step=2ms"]) == 0
    assert capsys.readouterr().out.splitlines()[:2] == [
        "plain; step = 2ms: 0.2 s in 100 steps of 0.002 s",
        'changed from the scene "A motor"',
    ]
    assert Trace(trace).attributes["step"] == 0.002


# ---- arrays of FMI 3, and locals

TABLE = LENGTH + 'record = ["*", "one.twice_*"]\n[one]\nfmu = "Motor3.fmu"\ntable = [3, 2]\n'


@pytest.mark.parametrize("isolated", [True, False])
def test_arrays_are_set_wired_and_recorded(tmp_path: Path, isolated: bool) -> None:
    motor3(tmp_path, description=ARRAYS)
    text = TABLE + 'u = [[1, 2], [3, 4]]\n[two]\nfmu = "Motor3.fmu"\n"u[2,1]" = 7\n'
    text += '[three]\nfmu = "Motor3.fmu"\n[wires]\n"three.u" = "one.y"\n'
    text += '"two.u[1,2]" = "one.y[2,1]"\n"two.u[2,2]" = "one.velocity"\n'
    trace = ran(tmp_path, text, tmp_path, isolated=isolated).trace
    speed = trace["one.velocity"]
    one, two, three = (
        [trace[f"{name}.y_{row}_{column}"] for row in (1, 2) for column in (1, 2)]
        for name in ("one", "two", "three")
    )
    np.testing.assert_array_equal(one, [3.0 * u + 2.0 * speed for u in (1.0, 2.0, 3.0, 4.0)])
    driving = [0.5, one[2], 7.0, speed]  # where nothing is said, the start value for all elements
    np.testing.assert_array_equal(two, [1.0 * u + 2.0 * speed for u in driving])
    np.testing.assert_array_equal(three, [1.0 * u + 2.0 * speed for u in one])
    np.testing.assert_array_equal(trace["one.twice_2"], np.float32(2.0 * speed))
    assert "two.twice_2" not in trace and "one.huge_1" not in trace
    whole = np.stack(one, axis=-1).reshape(-1, 2, 2)
    np.testing.assert_array_equal(trace.array("one.y"), whole)
    with h5py.File(trace.path) as file:
        np.testing.assert_array_equal(file["one/y"][:], whole)
        assert file["one/y"].attrs["UNIT"] == file["one/y_1_1"].attrs["UNIT"]
    with xarray.open_dataset(trace.path, group="one", engine="netcdf4") as read:
        assert read["y"].dims == ("time", "y_axis_1", "y_axis_2")
        np.testing.assert_array_equal(read["y"].values, whole)
    assert "one.y" not in trace and "one.y_axis_1" not in trace and "_arrays" not in trace.parameters
    with pytest.raises(LoomfmuError, match=r"signal 'one\.table' is not recorded"):
        trace.array("one.table")
    with h5py.File(trace.path, "r+") as file:
        file["one/y"].attrs["elements"] = "y_1_1 y_1_2 y_2_1"
    with pytest.raises(LoomfmuError, match="the file is damaged"):
        Trace(trace.path).array("one.y")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("u = [1, 2, 3]\n", "one.u is an array up to [2,2]: 4 values, not 3"),
        ("u_3_1 = 1\n", "one.u_3_1 is unknown: the array ends with u[2,2]"),
        ('"u[3,1]" = 1\n', "one.u[3,1] is unknown: the array ends with u[2,2]"),
        ("u = [1, 2, 3, true]\n", "one.u_2_2: True is not a quantity such as"),
        ("u = [[1, 2, 3], [4]]\n", "one.u is an array up to [2,2]: write it row by row"),
        ('[wires]\n"one.u" = "one.table"\n', "wire one.table -> one.u: 2 values for 4"),
        ('[wires]\n"one.u" = "one.velocity"\n', "wire one.velocity -> one.u: 1 values for 4"),
    ],
)
def test_arrays_of_another_size_are_refused(tmp_path: Path, text: str, said: str) -> None:
    motor3(tmp_path, description=ARRAYS)
    assert said in refused(tmp_path, TABLE + text)


@pytest.mark.parametrize("text", ["u = [1, 2, 3, 4]\n'u[2,1]' = 9\n", "'u[2,1]' = 9\nu = [[1, 2], [3, 4]]\n"])
def test_the_value_of_an_element_prevails_over_that_of_its_array(tmp_path: Path, text: str) -> None:
    motor3(tmp_path, description=ARRAYS)
    values = scenes.parse(TABLE + text, directory=tmp_path).instances["one"].values
    assert [values[f"u_{row}_{column}"] for row in (1, 2) for column in (1, 2)] == [1.0, 2.0, 9.0, 4.0]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('[wires]\n"one.u" = "two.y"\n"one.u[1,2]" = "two.velocity"\n',
         "one.u_1_2 is wired twice, to two.y_1_2 and two.velocity; keep one wire"),
        ('[wires]\n"one.u_1_2" = "two.y[1,1]"\n"one.u[1,2]" = "two.velocity"\n',
         "wires: 'one.u[1,2]' is one.u_1_2, which has a wire; keep one of them"),
        ('[inputs]\n"one.u_1_2" = [[0, 1]]\n"one.u[1,2]" = [[0, 2]]\n',
         "inputs.one.u[1,2] is a second table for one.u_1_2; keep one of them"),
    ],
)  # fmt: skip
def test_an_input_has_one_source_by_whatever_name(tmp_path: Path, text: str, said: str) -> None:
    motor3(tmp_path, description=ARRAYS)
    assert refused(tmp_path, TABLE + '[two]\nfmu = "Motor3.fmu"\n' + text) == said


def test_a_sweep_varies_tolerances_and_elements_of_arrays(tmp_path: Path) -> None:
    motor3(tmp_path, description=ARRAYS)
    scene = scenes.parse(TABLE, directory=tmp_path)
    assert varied(scene, "one.u_1_2").read("3") == 3.0
    assert varied(scene, "one.tolerance").needs_scene
    with pytest.raises(LoomfmuError, match=r"^one\.u is an array; vary one of its .*, such as one\.u_1_1"):
        varied(scene, "one.u")


def test_arrays_are_not_more_than_a_trace_can_hold(tmp_path: Path) -> None:
    large = "".join(
        f'<Float64 name="a{n}" valueReference="{100 + n}"><Dimension start="1000"/></Float64>'
        for n in range(101)
    )
    motor3(tmp_path, description=ARRAYS.replace("<String ", large + "<String "))
    assert refused(tmp_path, TABLE).endswith("cannot be read (its arrays have more than 100000 elements)")


def test_start_values_of_an_array_are_one_or_one_for_each_element(tmp_path: Path) -> None:
    motor3(tmp_path, description=ARRAYS.replace('start="0.5"', 'start="1 2 3"'))
    assert "'u' has 4 elements and 3 start values" in refused(tmp_path, TABLE)


def test_locals_are_recorded_when_they_are_asked_for(place: Path, tmp_path: Path) -> None:
    outputs = r'(name="(?:flange|time|steps|at_speed|winding)[^>]*causality=)"output"'
    inner = re.sub(outputs, r'\1"local"', description2())
    packed(tmp_path / "Inner.fmu", inner, library("fmi2.c"), "Motor")
    text = MOTOR.replace("Motor", "Inner")
    trace = ran(tmp_path, f'record = ["motor.*"]\n{text}', tmp_path).trace
    outer = ran(place, MOTOR, tmp_path / "outer").trace
    assert set(trace) == set(outer)
    np.testing.assert_array_equal(trace["motor.flange_w"], outer["motor.flange_w"])
    assert list(ran(tmp_path, f'record = ["motor.steps"]\n{text}', tmp_path).trace) == ["motor.steps"]
    assert not list(ran(tmp_path, text, tmp_path).trace)


# ---- units on wires: converted where both are known, never guessed


@pytest.fixture
def unitless(tmp_path: Path) -> Path:
    motor2(tmp_path, units=False)
    return tmp_path


def test_degrees_become_radians_on_a_wire(tmp_path: Path) -> None:
    motor2(tmp_path, phi="deg")
    trace = ran(tmp_path, MOTOR + WEFT, tmp_path).trace
    apart = ran(tmp_path, MOTOR + WEFT, tmp_path / "apart", isolated=True).trace
    for signal in trace:  # in C and in Python
        np.testing.assert_array_equal(trace[signal], apart[signal])
    weft = WeftInsertion(**parameters("WeftInsertion", machine="WL680-3600"))
    weft.follow_shaft = weft.inputs_at_step_end = True
    weft.shaft_angle = np.radians(trace["motor.flange_phi"][-1])
    assert weft.initialize(0.0) == 0 and weft.travel == pytest.approx(trace["weft.travel"][-1], rel=1e-13)


@pytest.mark.few(1)
@pytest.mark.parametrize("unit", ["rad", "deg", "rev"])
def test_a_claim_asks_for_steps_by_the_speed_of_a_shaft_in_any_unit(tmp_path: Path, unit: str) -> None:
    """Ten revolutions in a second, in steps of 36 deg: a sample is needed every 18 deg."""
    motor2(tmp_path, phi=unit)
    angle = {"rad": 20.0 * np.pi, "deg": 3600.0, "rev": 10.0}[unit]
    free = f"w_free = {angle}\ntau_stall = 1e9\n"  # it is at this speed at once, whatever its unit is
    claim = '[[claims]]\nkind = "below"\nsignal = "weft.travel"\nbound = "9 m"\n'
    text = MOTOR + free + WEFT + claim
    (found,) = ran(tmp_path, text, tmp_path, isolated=True, duration="0.3 s", step="10 ms").claims
    assert not found.decided and "set step = 0.005 s or less" in found.note


def test_nobody_knows_a_whole_turn_of_an_angle_in_an_unknown_unit(tmp_path: Path) -> None:
    definition = '<Unit name="mrad"><BaseUnit rad="1" factor="0.001"/></Unit></UnitDefinitions>'
    described = description2(phi="mrad").replace("</UnitDefinitions>", definition)
    packed(tmp_path / "Motor.fmu", described, library("fmi2.c"), "Motor")
    claim = '[[claims]]\nkind = "below"\nsignal = "weft.travel"\nbound = "9 m"\n'
    text = MOTOR + "w_free = 60\n" + WEFT + claim
    (found,) = ran(tmp_path, text, tmp_path, isolated=True).claims  # it turns by 0.003 rad
    assert not found.decided and "revolution" in found.note


def test_the_speed_of_a_lock_is_judged_in_its_own_unit_alone(tmp_path: Path) -> None:
    described = (
        description2()
        .replace('"rad.s-1"', '"rpm"')
        .replace('rad="1" s="-1"', 'rad="1" s="-1" factor="0.10471975511965977"')
    )
    packed(tmp_path / "Motor.fmu", described, library("fmi2.c"), "Motor")
    text = (
        MOTOR
        + WEFT.replace("weft", "lock").replace('machine = "WL680-3600"', "")
        + '[[claims]]\nkind = "locks_in_time"\n'
    )
    with pytest.raises(
        LoomfmuError, match=r"lock has its speed from motor\.flange_w in rev/min; it must be in rad/s"
    ):
        ran(tmp_path, text, tmp_path, isolated=True)


KELVIN, CUBIC = Definition((0, 0, 0, 0, 1, 0, 0, 0)), Definition((0, 3, 0, 0, 0, 0, 0, 0))


@pytest.mark.parametrize(
    ("unit", "definition", "text", "value"),
    [
        ("K", KELVIN, "25 degC", 298.15),
        ("K", KELVIN, "25 K", 25.0),
        ("degC", None, "25 degC", 25.0),
        ("degF", replace(KELVIN, factor=5.0 / 9.0, offset=459.67 * 5.0 / 9.0), "25 degC", 77.0),
        ("[m3]", CUBIC, "2 m3", 2.0),
        ("m", None, "25 degC", "x: 25 degC does not fit m"),
    ],
)
def test_values_in_units_of_others(
    unit: str, definition: Definition | None, text: str, value: float | str
) -> None:
    known = stated(unit, definition)
    assert known
    port = Port("x", "Real", 0, "input", known.name, "1", None, None, 0.0, "", definition=known.definition)
    if isinstance(value, str):
        with pytest.raises(LoomfmuError, match=value):
            port.value(text, "x")
    else:
        assert port.value(text, "x") == pytest.approx(value, rel=1e-14)


@pytest.mark.parametrize("own", ['unit="K" relativeQuantity="true"', 'declaredType="Difference"'])
def test_differences_of_temperatures_have_no_offset(tmp_path: Path, own: str) -> None:
    kind = '<SimpleType name="Difference"><Real unit="K" relativeQuantity="true"/></SimpleType>'
    described = (
        description2()
        .replace("<TypeDefinitions>", f"<TypeDefinitions>{kind}")
        .replace(
            '<Real unit="K"/></ScalarVariable>',
            '<Real unit="degC" relativeQuantity="true"/></ScalarVariable>',
        )
        .replace('<Real start="0" unit="Nm"/>', f'<Real start="0" {own}/>')
    )
    packed(tmp_path / "Motor.fmu", described, library("fmi2.c"), "Motor")
    scene = scenes.parse(MOTOR + '"load.tau" = "5 degC"\n', directory=tmp_path)
    assert scene.instances["motor"].values["load_tau"] == 5.0
    wired = scenes.parse(MOTOR + '[wires]\n"motor.load.tau" = "motor.winding"\n', directory=tmp_path)
    assert wired.wires[0].conversion(7.0) == 7.0


UNIT = st.builds(
    lambda factor, offset: Stated(f"{factor} {offset}", replace(KELVIN, factor=factor, offset=offset)),
    st.floats(0.5, 2.0),
    st.floats(-300.0, 300.0),
)


@given(UNIT, UNIT, UNIT, st.floats(-300.0, 300.0))
def test_conversions_go_there_and_back_and_one_after_the_other(
    one: Stated, two: Stated, three: Stated, value: float
) -> None:
    there, near = one.conversion(two), 1e-5  # factors that agree to 1e-9 are one
    assert there.then(two.conversion(one))(value) == pytest.approx(value, abs=near)
    assert there.then(two.conversion(three))(value) == pytest.approx(one.conversion(three)(value), abs=near)


def test_one_warning_names_all_wires_with_a_unit_at_one_end_alone(unitless: Path, tmp_path: Path) -> None:
    result = ran(unitless, MOTOR + WEFT, tmp_path)
    (said,) = [each for each in result.warnings if "unit" in each]
    assert said == (
        "values pass unchanged on wires with a unit at one end only:"
        " motor.flange_phi -> weft.shaft_angle in rad,"
        " motor.flange_w -> weft.shaft_velocity in rad/s and"
        " motor.flange_a -> weft.shaft_acceleration in rad/s2;"
        ' state the others in [units], as "motor.flange_a" = "...", or by --set motor.units.flange_a=...'
    )
    np.testing.assert_allclose(
        result.trace["motor.flange_phi"], exact(result.trace.time)[0], rtol=0, atol=1e-12
    )


def test_units_are_stated_with_the_instance_in_one_table_or_by_hand(unitless: Path, tmp_path: Path) -> None:
    by_hand = {"motor.units.flange.phi": "rad"}
    stated = MOTOR + 'units = {flange_a = "rad/s2"}\n[units]\n"motor.flange_w" = "rad/s"\n' + WEFT
    scene = scenes.parse(stated, "x", by_hand, unitless)
    ports = scene.instances["motor"].fmu.ports
    assert [ports[f"flange_{x}"].unit for x in ("phi", "w", "a")] == ["rad", "rad/s", "rad/s2"]
    assert not scene.notes
    with pytest.raises(LoomfmuError, match=r"^motor\.units: Motor has no variable 'x'"):
        scenes.parse(MOTOR, "x", {"motor.units.x": "rad"}, unitless)
    assert refused(unitless, MOTOR + '[units]\nmotr.x = "m"\n') == (
        "units.motr.x: there is no instance 'motr'; did you mean 'motor'?"
    )
    assert ran(unitless, stated, tmp_path).trace.unit("motor.flange_w") == "rad/s"


def test_units_as_they_are_written_in_the_wild(tmp_path: Path) -> None:
    written = description2(units=False)
    units = {"flange.phi": "[rad]", "flange.w": "[rad/s]", "flange.a": "[rad/s2]", "time": "-"}
    for name, unit in units.items():
        before, named, after = written.partition(f'name="{name}"')
        written = before + named + after.replace("<Real ", f'<Real unit="{unit}" ', 1)
    packed(tmp_path / "Motor.fmu", written, library("fmi2.c"), "Motor")
    trace = ran(tmp_path, MOTOR + WEFT, tmp_path).trace
    assert [trace.unit(f"motor.{x}") for x in ("flange_phi", "time_")] == ["rad", "1"]


def test_two_that_both_have_none_can_be_wired(unitless: Path, tmp_path: Path) -> None:
    text = MOTOR + '[other]\nfmu = "Motor.fmu"\n[wires]\n"other.load.tau" = "motor.flange.w"\n'
    assert ran(unitless, text, tmp_path).trace["other.flange_a"][-1] < 200.0


def test_a_unit_that_the_fmu_says_is_not_said_again_otherwise(place: Path) -> None:
    assert scenes.parse(MOTOR + 'units = {flange_w = "rad/s"}\n', directory=place)
    said = refused(place, MOTOR + 'units = {flange_w = "m/s"}\n')
    assert said == "motor.units.flange_w = 'm/s': the FMU itself says rad/s"
    assert refused(place, MOTOR + "units = 5\n") == 'motor.units = 5 must be a table of variable = "unit"'
    assert "motor.units: Motor has no variable 'x'" in refused(place, MOTOR + 'units = {x = "m"}\n')


# ---- how they live


@pytest.fixture
def opened(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[str]]:
    pool.free_all()
    made: list[str] = []
    original = pool.opened
    monkeypatch.setattr(pool, "opened", lambda fmu, name: made.append(name) or original(fmu, name))
    yield made
    pool.free_all()


def test_they_are_made_anew_for_every_run(place: Path, tmp_path: Path, opened: list[str]) -> None:
    text = "isolated = false\n" + MOTOR + SHAFT3 + "[weft]\n"
    first, again = (ran(place, text, tmp_path / name).trace for name in ("first", "again"))
    for signal in ("motor.flange_w", "shaft.angle"):
        np.testing.assert_array_equal(again[signal], first[signal])
    assert sorted(opened) == ["motor", "motor", "shaft", "shaft", "weft"]  # ours is reset


def test_one_that_a_process_can_have_once(tmp_path: Path) -> None:
    path = motor2(tmp_path, single=True)
    for _ in range(2):
        assert ran(tmp_path, MOTOR, tmp_path, isolated=True).holds
    two = MOTOR + '[other]\nfmu = "Motor.fmu"\n'
    assert refused(tmp_path, "isolated = false\n" + two) == (
        f"motor and other: a process can hold only one instance of {path}"
        " (canBeInstantiatedOnlyOncePerProcess); set isolated = true"
    )
    assert ran(tmp_path, two, tmp_path, isolated=True).holds  # each in a process of its own


def test_messages_with_arguments_are_told_whole_and_to_the_right_instance(
    place: Path, tmp_path: Path
) -> None:
    text = MOTOR + 'verbose = true\n[second]\nfmu = "Motor.fmu"\nverbose = true\n"load.tau" = 12.5\n'
    result = ran(place, text, tmp_path, duration="3 ms")
    assert result.warnings == tuple(
        f"{name}: {name} carries {load} N.m, step {step}"
        for name, load in (("motor", "0.000"), ("second", "12.500"))
        for step in range(3)
    )
    # the last fifty of each, and how many came before
    assert len(ran(place, text, tmp_path, duration="1 s").warnings) == 102


def test_one_without_outputs_runs_for_what_it_does(tmp_path: Path) -> None:
    binary = library("fmi2.c")
    sink = description2().replace('causality="output"', 'causality="local"')
    packed(tmp_path / "Motor.fmu", sink, binary, "Motor")
    told = [f"motor: motor carries 7.500 N.m, step {step}" for step in range(3)]
    text = MOTOR + 'verbose = true\n"load.tau" = 7.5\n'
    alone = ran(tmp_path, text, tmp_path, duration="3 ms")
    assert list(alone.warnings) == told and alone.trace.rows == 4 and list(alone.trace) == []
    # nothing that is recorded or claimed depends on it, and it depends on what is recorded nowhere
    wired = '[weft]\n[wires]\n"motor.load.tau" = "weft.shaft_torque"\n'
    text = 'record = ["weft.stroke"]\n' + MOTOR + "verbose = true\n" + wired
    scene = scenes.parse(text, "x", {"duration": "3 ms"}, tmp_path)
    torques = evaluate(scene, values=["weft.shaft_torque"]).trace["weft.shaft_torque"][1:]
    carried = [f"motor: motor carries {torque:.3f} N.m, step" for torque in torques]
    for result in (run(scene, output=tmp_path / "x.h5"), evaluate(scene)):
        assert [warning.rpartition(" ")[0] for warning in result.warnings] == carried


def test_one_that_says_it_needs_its_tool_is_tried(tmp_path: Path) -> None:
    motor2(tmp_path, flags='needsExecutionTool="true"')
    result = ran(tmp_path, MOTOR, tmp_path)
    said = "it says that it needs the tool that created it (needsExecutionTool = true)"
    assert result.holds and result.warnings == (f"motor: {said}",)
    described = description2(flags='needsExecutionTool="true"').replace("{motor-2}", "{other}")
    packed(tmp_path / "Motor.fmu", described, library("fmi2.c"), "Motor")
    with pytest.raises(LoomfmuError) as raised:
        ran(tmp_path, MOTOR, tmp_path)
    assert str(raised.value).endswith(f"cannot be instantiated: {{other}}: 0 alive ({said})")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (MOTOR + "J = -1\n", "motor: J = -1 kg.m2 is not above 0"),
        (
            MOTOR + '"load.tau" = 200\n',
            "motor at 0 s: fmi2DoStep returned fmi2Discard: stalled by 200 N.m at 0 s",
        ),
        (LENGTH + SHAFT3 + "J = -1\n", "shaft: J is not above 0"),
    ],
)
def test_what_they_refuse_is_told_in_one_line(place: Path, tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(LoomfmuError) as raised:
        ran(place, text, tmp_path)
    assert str(raised.value) == said


def test_our_own_fmus_can_be_given_as_files(tmp_path: Path) -> None:
    weft = fmus.of_component("WeftInsertion").path
    text = f'[shaft]\n[weft]\nmachine = "WL680-3600"\n[other]\nfmu = "{weft}"\nmachine = "WL680-3600"\n'
    trace = ran(tmp_path, text, tmp_path).trace
    np.testing.assert_array_equal(trace["weft.travel"], trace["other.travel"])
    assert trace.rate("other.travel") == "other.velocity"


def test_a_discrete_real_input_is_held_between_the_rows_of_its_table() -> None:
    port = Port("u", "Real", 1, "input", "1", "1", None, None, 0.0, "An input", discrete=True)
    rows, between = [[0, 1.0], [1, 2.0]], np.array([0.0, 0.5, 0.999, 1.0, 2.0])
    np.testing.assert_array_equal(drive("a.u", port, rows).along(between), [1.0, 1.0, 1.0, 2.0, 2.0])
    ramped = drive("a.u", replace(port, discrete=False), rows).along(between)
    np.testing.assert_array_equal(ramped, between.clip(0.0, 1.0) + 1.0)
