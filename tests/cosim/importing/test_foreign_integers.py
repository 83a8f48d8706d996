"""Integers of all widths and enumerations of third-party FMUs: exact, or refused in one line."""

from pathlib import Path

import h5py
import numpy as np
import pytest
from foreign_motors import BLANKS, HELD, WHOLE, motor2, motor3
from motor_scenes import LENGTH, MOTOR, SHAFT3, ran, refused

from loomfmu import LoomfmuError
from loomfmu.cosim.scenes import scene as scenes

# in this process the compiled stepper converts the values, else Python
either = pytest.mark.parametrize("isolated", [False, True])
OTHER = '[other]\nfmu = "Motor3.fmu"\n'
CARRIED = (-(2**31), 2**31 - 1)


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A directory with a motor that has integers of all widths."""
    directory = tmp_path_factory.mktemp("whole")
    motor3(directory, description=WHOLE)
    motor2(directory)
    return directory


def limits(each: str) -> tuple[int, int]:
    bits = int(each.removeprefix("U").removeprefix("Int"))
    return (0, 2**bits - 1) if each.startswith("U") else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)


@pytest.mark.parametrize("each", HELD)
def test_what_a_type_cannot_hold_is_refused_before_the_run(place: Path, each: str) -> None:
    low, high = limits(each)
    for value in (low - 1, high + 1):
        for spelt in (value, f'"{value}"'):
            if isinstance(spelt, int) and abs(spelt) >= 2**63:  # TOML has none such
                continue
            said = refused(place, LENGTH + SHAFT3 + f"to_{each} = {spelt}\n")
            assert said == f"shaft.to_{each} = {value} is outside [{low}, {high}]"
    for value in (low, high):
        scene = scenes.parse(LENGTH + SHAFT3, "x", {f"shaft.to_{each}": str(value)}, place)
        assert scene.instances["shaft"].values[f"to_{each}"] == value


def test_those_of_fmi_2_have_32_bits(place: Path) -> None:
    fmi2 = scenes.parse(MOTOR, directory=place).instances["motor"].fmu.ports["steps"]
    assert fmi2.value("2147483647", "x") == 2**31 - 1
    with pytest.raises(LoomfmuError, match=r"^x = 3000000000 is outside \[-2147483648, 2147483647\]$"):
        fmi2.value(3000000000, "x")


@either
def test_values_come_through_as_they_are(place: Path, tmp_path: Path, isolated: bool) -> None:
    wired = OTHER + "[wires]\n" + "".join(f'"other.to_{each}" = "shaft.{each}"\n' for each in HELD)
    for side, within in ((0, max), (1, min)):
        values = {each: within(limits(each)[side], CARRIED[side]) for each in HELD}
        text = LENGTH + SHAFT3 + "".join(f"to_{each} = {value}\n" for each, value in values.items()) + wired
        trace = ran(place, text, tmp_path, isolated=isolated).trace
        for each, value in values.items():
            assert set(trace[f"shaft.{each}"]) == set(trace[f"other.{each}"]) == {value}


@either
@pytest.mark.parametrize(
    ("source", "changed", "time", "value"),
    [("Int16", {"shaft__to_Int16": -1}, "0", -1), ("steps", {"duration": "0.3 s"}, "0.255", 256)],
)
def test_what_a_wired_input_cannot_hold_ends_the_run(
    place: Path,
    tmp_path: Path,
    isolated: bool,
    source: str,
    changed: dict[str, object],
    time: str,
    value: int,
) -> None:
    text = LENGTH + SHAFT3 + OTHER + f'[wires]\n"other.to_UInt8" = "shaft.{source}"\n'
    with pytest.raises(LoomfmuError) as raised:
        ran(place, text, tmp_path, isolated=isolated, **changed)
    said = f"other at {time} s: to_UInt8 = {value} is outside [0, 255], the range of UInt8"
    assert str(raised.value) == said


@either
@pytest.mark.parametrize(("each", "value"), [("UInt32", 2**31), ("UInt64", 2**64 - 1)])
def test_what_a_run_cannot_carry_ends_it_unless_it_is_left_out(
    place: Path, tmp_path: Path, each: str, value: int, isolated: bool
) -> None:
    changed = {f"shaft__to_{each}": str(value), "isolated": isolated}
    with pytest.raises(LoomfmuError) as raised:
        ran(place, LENGTH + SHAFT3, tmp_path, **changed)
    assert str(raised.value) == (
        f"shaft at 0 s: {each} = {value} is outside [-2147483648, 2147483647],"
        " the range of 32-bit integers; leave it out of record"
    )
    trace = ran(place, 'record = ["shaft.velocity"]\n' + LENGTH + SHAFT3, tmp_path, **changed).trace
    assert f"shaft.{each}" not in trace and trace.rows == 201


@either
def test_one_that_grows_too_large_is_told_when_it_does(place: Path, tmp_path: Path, isolated: bool) -> None:
    fast = LENGTH + SHAFT3 + "w_free = 1e5\ntau_stall = 1e6\n"  # 2147 rad are soon reached
    with pytest.raises(
        LoomfmuError, match=r"^shaft at 0\.0\d* s: microradians = 21\d{8} is outside \[-2147483648, 21474836"
    ):
        ran(place, fast, tmp_path, isolated=isolated)


def test_items_of_enumerations_may_have_blanks(tmp_path: Path) -> None:
    motor3(tmp_path, description=BLANKS)
    for name in ("no way-back", "no_way_back", "no-way-back", "2", 2):
        scene = scenes.parse(LENGTH + SHAFT3, "x", {"shaft.mode": name}, tmp_path)
        assert scene.instances["shaft"].values["mode"] == 2
    said = refused(tmp_path, LENGTH + SHAFT3 + 'mode = "no ways back"\n')
    assert (
        said
        == "shaft.mode = 'no ways back' must be 'both ways' or 'no way-back'; did you mean 'no way-back'?"
    )
    trace = ran(tmp_path, LENGTH + SHAFT3, tmp_path, shaft__mode="no way-back").trace
    assert set(trace["shaft.mode_used"]) == {2}
    with h5py.File(trace.path) as file:
        about = dict(file["shaft/mode_used"].attrs)
    assert about["flag_meanings"] == "both_ways no_way_back"  # blanks separate them there
    np.testing.assert_array_equal(about["flag_values"], [1, 2])
