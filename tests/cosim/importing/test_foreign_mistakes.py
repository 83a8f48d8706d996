"""FMU files that cannot be run, and scenes that use them wrongly: one line for each."""

import zipfile
from pathlib import Path

import fmpy
import pytest
from foreign_motors import FIXED, FMI3, description2, library, packed
from motor_scenes import LENGTH, MOTOR, SHAFT3, ran, refused

from loomfmu import LoomfmuError
from loomfmu.cli import main
from loomfmu.cosim.scenes import scene as scenes

THIRD = FMI3.format(fixed=FIXED)
FILES = {
    "an FMI 1.0 FMU; only FMI 2.0 and 3.0 are supported": (
        '<fmiModelDescription fmiVersion="1.0" modelName="M" modelIdentifier="M" guid="g"'
        ' numberOfContinuousStates="0" numberOfEventIndicators="0"><ModelVariables>'
        + '<ScalarVariable name="twice" valueReference="0"><Real/></ScalarVariable>' * 2
        + "</ModelVariables></fmiModelDescription>"
    ),
    "an FMU for scheduled execution; only co-simulation and model exchange are supported": THIRD.replace(
        "<CoSimulation", "<ScheduledExecution"
    ),
    "its modelDescription.xml cannot be read (an element lacks an attribute that FMI requires)": (
        THIRD.replace('valueReference="0"', "")
    ),
    "its modelDescription.xml cannot be read (Unsupported FMI version: 4.0)": THIRD.replace('"3.0"', '"4.0"'),
}
FILES |= {
    "its modelDescription.xml cannot be read (Failed to validate modelDescription.xml: The derivative"
    " attribute of model variable J (line 21) references model variable index 0 which does not exist.)": (
        description2().replace('<Real start="0.5"', '<Real derivative="0" start="0.5"', 1)
    ),
    **{
        f"modelIdentifier = {name!r} is not a C identifier; it must name a library of the FMU by letters,"
        " digits and _, and no digit first": description2().replace(
            'Identifier="Motor"', f'Identifier="{name}"'
        )
        for name in ("../../outside/Motor", "", "7up", "Mötor")
    },
}


def bad(tmp_path: Path, description: str, binary: bytes | None = None) -> None:
    packed(tmp_path / "Motor.fmu", description, binary, "Motor")


@pytest.mark.parametrize("said", FILES)
def test_fmus_that_cannot_be_run_are_told(tmp_path: Path, said: str) -> None:
    bad(tmp_path, FILES[said])
    assert refused(tmp_path, MOTOR) == f"motor.fmu: {tmp_path}/Motor.fmu: {said}"


@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
def test_clocks_are_refused(tmp_path: Path, kind: str) -> None:
    clock = '<Clock name="tick" valueReference="9" causality="input" intervalVariability="constant"/>'
    text = THIRD.replace("</ModelVariables>", f"{clock}</ModelVariables>")
    bad(tmp_path, text.replace("<CoSimulation", f"<{kind}"))
    said = f"motor.fmu: {tmp_path}/Motor.fmu: tick is a clock; FMUs with clocks are not supported"
    assert refused(tmp_path, MOTOR) == said


def test_an_fmu_without_a_library_for_this_machine_is_refused_with_what_it_has(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    said = f"motor: {tmp_path / 'Motor.fmu'} has no library for this platform, {fmpy.platform}; it has "
    bad(tmp_path, description2())
    scene = 'record = ["weft.*"]\n' + MOTOR + "[weft]\n"  # nothing recorded depends on the motor
    for member, known in (
        ("binaries/other64/NotIt.so", "none"),
        ("binaries/win64/Motor.dll", "win64"),
        ("binaries/darwin64/Motor.dll", "darwin64 and win64"),
    ):
        with zipfile.ZipFile(tmp_path / "Motor.fmu", "a") as archive:
            archive.writestr(member, b"")
        with pytest.raises(LoomfmuError) as raised:
            ran(tmp_path, scene, tmp_path)
        assert str(raised.value) == said + known
        assert not (tmp_path / "motor.h5").exists()
    monkeypatch.chdir(tmp_path)
    Path("x.toml").write_text(scene)
    assert main(["run", "x.toml"]) == 2


def test_another_guid_is_told_in_the_fmus_words(tmp_path: Path) -> None:
    binary = library("fmi2.c", "-DSINGLE=0")
    bad(tmp_path, description2().replace("{motor-2}", "{other}"), binary)
    with pytest.raises(LoomfmuError, match=r"cannot be instantiated: \{other\}: 0 alive$"):
        ran(tmp_path, MOTOR, tmp_path)


def test_a_damaged_zip_is_told(place: Path, tmp_path: Path) -> None:
    content = bytearray((place / "Motor3.fmu").read_bytes())
    with zipfile.ZipFile(place / "Motor3.fmu") as archive:
        start = archive.getinfo("binaries/x86_64-linux/Motor3.so").header_offset
    for offset in range(start + 400, start + 800):
        content[offset] ^= 0xFF
    (tmp_path / "Motor3.fmu").write_bytes(content)
    assert refused(tmp_path, LENGTH + SHAFT3) == (
        f"shaft.fmu: {tmp_path}/Motor3.fmu: not a readable FMU"
        " (Bad CRC-32 for file 'binaries/x86_64-linux/Motor3.so')"
    )


TEXTS = {
    MOTOR + "label = 'x'\n": "motor.label is unknown; known: J, tau_stall, w_free, load_tau, verbose, mode,",
    MOTOR + '"flange.w" = 1\n': "motor.flange.w is an output of Motor and cannot be set",
    MOTOR + 'J = "2 m"\n': "motor.J: '2 m' is in m, which does not fit kg.m2",
    MOTOR + "J = -11\n": "motor.J = -11 kg.m2 is outside [-10, inf] kg.m2",
    MOTOR + "J = nan\n": "motor.J = nan is not a finite number",
    MOTOR + 'component = "MainShaft"\n': "motor has both a component and an fmu; keep one of them",
    LENGTH + "[motor]\nfmu = 5\n": "motor.fmu = 5 is not a name in quotes",
    LENGTH + '[motor]\nfmu = "no.fmu"\n': "no.fmu: there is no such FMU",
    LENGTH + '[shaft]\nfmu = "Motor.fmu"\n': "the shaft of a scene must have an output angle in rad",
    SHAFT3: 'there is no shaft whose speed sets the step: add duration = "2 s" and step = "1 ms"',
    'duration = "1 s"\n': "duration is given but not step",
    LENGTH + "revolutions = 2\n": "revolutions, duration and step: a scene runs either by duration and step",
    LENGTH.replace("1 ms", "1 mm"): "step: '1 mm' is in mm, which does not fit s",
    LENGTH.replace("1 ms", "0 s"): "step = 0 is outside [1e-12, 1e+09]",
    LENGTH.replace("1 ms", "1 s"): "duration = 0.2 s in steps of 1 s is less than one step",
}


@pytest.mark.parametrize("text", TEXTS)
def test_a_mistake_in_a_scene_is_told_in_one_line(place: Path, text: str) -> None:
    said = refused(place, text)
    assert TEXTS[text] in said and "\n" not in said


def test_a_scene_by_revolutions_has_its_shaft_beside_other_makers_fmus(place: Path) -> None:
    scene = scenes.parse('[motor]\nfmu = "Motor.fmu"\n', directory=place)
    assert list(scene.instances) == ["shaft", "motor"]
