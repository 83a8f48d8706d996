"""Files of one's own that cannot be an FMU: one line that says where and what, before anything is written."""

from collections.abc import Callable
from pathlib import Path
from xml.etree.ElementTree import fromstring

import pytest

from loomfmu import LoomfmuError
from loomfmu.cli import main
from loomfmu.components import COMPONENTS
from loomfmu.cosim.scenes import scene
from loomfmu.declaring.variables import Component
from loomfmu.fmi.description.model_description import model_description, model_description3
from loomfmu.own import declared, load

GOOD = '''"""A bell."""

from dataclasses import dataclass
from typing import ClassVar

from loomfmu.mechanism import EXTREMES, NOTHING, Component, Problem, SHAFT, output, parameter, input_, state


@dataclass(slots=True)
class Bell(Component):
    """A bell."""

    problems: ClassVar = (Problem("the pitch of {pitch} is too high"),)
    pitch: float = parameter("1", 0.5, "Pitch", minimum=0.0, maximum=1.0)
    sound: float = output("m", "Sound", rate="rate")
    rate: float = output("m/s", "Rate")

    def initialize(self, time: float) -> int:
        """Silence."""
        self.sound = 0.0
        return 0

    def step(self, time: float, step_size: float) -> int:
        """Ring."""
        self.sound = self.pitch * time
        self.rate = self.pitch
        return 0
'''
# texts that are replaced, each with its new one, and what is said then
MISTAKES = {
    "a class that is no dataclass": ("@dataclass(slots=True)\n", "", r"line 9: Bell is not a dataclass"),
    "no slots": ("(slots=True)", "", r"line 10: Bell could store undeclared values"),
    "no docstring": ('    """A bell."""\n\n    p', "    p", r"line 10: Bell has no docstring"),
    "no step": ("def step(", "def stepp(", r"it has no component|line 10: Bell has no method step"),
    "a field of another kind": ('parameter("1", 0.5, "Pitch"', 'dict("1", 0.5, "Pitch"', "14: TypeError"),
    "an unknown unit": ('output("m/s"', 'output("furlong/s"', "line 16: rate: unknown unit 'furlong/s'"),
    "a unit that is not SI": ('output("m",', 'output("mm",', "line 15: sound is in mm: values are SI, m"),
    "another unit for people": ('"Rate")', '"Rate", display="N")', "line 16: rate is in m/s, which"),
    "an int for a float": ("0.5, ", "1, ", "line 14: pitch is declared float, but its start"),
    "a start outside": ("0.5, ", "1.5, ", r"line 14: pitch = 1.5 is outside \[0, 1\]"),
    "a rate that is not there": ('rate="rate"', 'rate="rat"', "line 15: sound: rate = 'rat' is not one of"),
    "a rate in another unit": ('"m/s", "Rate"', '"m", "Rate"', "line 15: sound is in m, but its rate"),
    "a switch that is not there": ("minimum=0.0, maximum=1.0)", 'when="loud")',
        "pitch: when = 'loud' is not one of its parameters"),
    "a method with the name of an output": ("    def step(",
        "    def rate(self) -> float:\n        return 0.0\n\n    def step(",
        "rate is a variable and a method: give one of them another name"),
    "a taken name": ("pitch", "machine", "line 14: a variable cannot be called machine"),
    "a key of every instance": ("pitch", "isolated", "line 14: a variable cannot be called isolated"),
    "a number that vouches": ('"Rate")', '"Rate", valid_if="sound")',
        "rate: valid_if = 'sound' is not a yes-or-no output"),
    "an error in another unit": ('"Rate")', '"Rate", error="sound")',
        "rate is in m/s, but error = 'sound' in m"),
    "an extreme in another unit": ('"Rate")', '"Rate", highest_of="sound")',
        "rate is in m/s, but highest_of = 'sound' in m"),
    "an extreme of nothing": ('"Rate")', '"Rate", lowest_of="soun")', "lowest_of = 'soun' .* mean 'sound'"),
    "a count of blows that is none": ("    pitch: float",
        '    bounces: ClassVar[str] = "sound"\n    pitch: float',
        "line 14: bounces = 'sound' is not an output that counts"),
    "an extreme that keeps nothing": ('    rate: float = output("m/s", "Rate")',
        '    keeps: ClassVar[str] = NOTHING\n    rate: float = output("m/s", "Rate", lowest_of="rate")',
        "line 17: rate is an extreme so far, but keeps = NOTHING"),
    "a state beside extremes": ('    rate: float = output("m/s", "Rate")',
        '    keeps: ClassVar[str] = EXTREMES\n    low: float = output("m", "Low", lowest_of="sound")\n'
        '    rate: float = output("m/s", "Rate")\n    blows: float = state("1", "Blows so far")',
        "line 19: blows is a state, but keeps is not MOTION: remove keeps, or declare blows as auxiliary"),
    "an output that integrates": ('    rate: float = output("m/s", "Rate")',
        '    rate: float = output("m/s", "Rate")\n    keeps: ClassVar[str] = NOTHING', "self.pitch * time",
        "self.sound + self.pitch * step_size",
        "line 15: sound depends on earlier steps, but keeps is not MOTION: remove keeps"),
    "a problem without words": ("return 0\n\n", "return 2\n\n",
        "line 18: initialize returns problem 2, but `problems` has only 1"),
    "words that show nothing": ("{pitch}", "{pich}", r"line 13: problems: \{pich\} .* did you mean 'pitch'"),
    "a terminal of other members": ("    pitch", '    terminals: ClassVar = (SHAFT.of("pitch"),)\n    pitch',
        "line 14: terminals: shaft: it has 3 members"),
    "what does not translate": ("self.pitch * time", "{0: time}[0]", r"line 25\).*Dict is not in the subset"),
    "hidden state": ("self.rate = self.pitch", "self.kept = time", "kept"),
    "a module in a method": ("self.pitch * time", "Path", r"line 25\).*`self.sound = Path`"),
    "a syntax error": ("return 0", "return 0 0", "line 21: invalid syntax"),
    "an import that fails": ('ll."""\n\nfrom', 'll."""\nimport nowhere\nfrom', "line 2: Module"),
    "an exception": ('ll."""\n\nfrom', 'll."""\n1 / 0\nfrom', "line 2: ZeroDivisionError: division"),
    "an exception that cannot say what it is": ('ll."""\n\nfrom',
        'll."""\nclass Odd(Exception):\n    def __str__(self):\n        raise ValueError\nraise Odd\nfrom',
        "line 5: Odd"),
    "an exit": ('ll."""\n\nfrom', 'll."""\nraise SystemExit(0)\nfrom', "line 2: SystemExit: 0"),
    "a name of ours": ("class Bell(", "class MainShaft(", "MainShaft is the name of one of"),
    "two components": ("@dataclass",
        "@dataclass(slots=True)\nclass Other(Component):\n    value: float = output('1', 'V')\n\n"
        "    def step(self, time: float, step_size: float) -> int:\n        return 0\n\n\n@dataclass",
        r"2 components; name one: .*bell\.py:Other, .*bell\.py:Bell"),
    "no component": ("(Component)", "", "it has no component; declare a class on"),
}  # fmt: skip


def bell(folder: Path, *changes: tuple[str, str]) -> Path:
    """The file of a bell, some of its lines written in another way."""
    text, path = GOOD, folder / "bell.py"
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path.write_text(text)
    return path


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_gets_one_line_with_its_place(
    mistake: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    *texts, said = MISTAKES[mistake]
    path = bell(tmp_path, *zip(texts[::2], texts[1::2], strict=True))
    assert main(["build", str(path), "--output", str(tmp_path / "made")]) == 2
    error = capsys.readouterr().err
    assert error.startswith(f"loomfmu: {path}")
    assert error.count("\n") == 1
    assert not (tmp_path / "made").exists()
    with pytest.raises(LoomfmuError, match=said):
        load.component(str(path))
    (tmp_path / "scene.toml").write_text('duration = "1 s"\nstep = "0.1 s"\n[bell]\ncomponent = "bell.py"\n')
    assert main(["run", str(tmp_path / "scene.toml")]) == 2
    assert "bell.component: " in capsys.readouterr().err


@pytest.mark.parametrize(
    ("spec", "said"),
    [
        ("gone.py", "gone.py: cannot be read"),
        ("bell.py:Bel", "it has no component 'Bel'; did you mean 'Bell'"),
        ("bell.py:Component", "it has no component 'Component'"),
    ],
)
def test_files_and_classes_that_are_not_there(tmp_path: Path, spec: str, said: str) -> None:
    bell(tmp_path)
    with pytest.raises(LoomfmuError, match=said):
        load.component(spec, tmp_path)


def test_an_array_of_another_type_is_refused(tmp_path: Path) -> None:
    declared = '    peg: KIND = array(parameter("1", n, "A peg") for n in (1, 0))\n    pitch:'
    changes = (
        ("from typing", "from collections.abc import Sequence\nfrom typing"),
        ("import EX", "import array, EX"),
    )
    for kind in ("tuple[int, ...]", "Sequence[int]"):  # the latter of one that is set from a list
        path = bell(tmp_path, *changes, ("    pitch:", declared.replace("KIND", kind)))
        assert load.component(str(path))(peg_2=5).peg == (1, 5)
    bell(tmp_path, *changes, ("    pitch:", declared.replace("KIND", "tuple[float, ...]")))
    said = r"line 15: peg_1 is declared tuple\[float, \.\.\.\], but its start"
    with pytest.raises(LoomfmuError, match=said):
        load.component(str(path))


PITCHED = (("from dataclasses", "from pitches import LOW\nfrom dataclasses"), ("0.5,", "LOW,"))


def test_a_file_is_run_again_only_if_a_text_has_changed(tmp_path: Path) -> None:
    (tmp_path / "pitches.py").write_text("LOW = 0.25\n")
    bell(tmp_path, *PITCHED)
    first = load.component("bell.py", tmp_path)
    assert first().pitch == 0.25
    assert load.component("bell.py:Bell", tmp_path)().pitch == 0.25
    assert load.component("bell.py", tmp_path) is first
    (tmp_path / "pitches.py").write_text("LOW = 0.75\n")  # as long as before, within the same second
    assert load.component("bell.py", tmp_path)().pitch == 0.75


def test_neighbours_of_one_name_in_two_folders_do_not_meet(tmp_path: Path) -> None:
    found = []
    for name, low in (("here", 0.25), ("there", 0.5)):
        (tmp_path / name).mkdir()
        (tmp_path / name / "pitches.py").write_text(f"LOW = {low}\n")
        bell(tmp_path / name, *PITCHED)
        found.append(load.component("bell.py", tmp_path / name)().pitch)
    assert found == [0.25, 0.5]
    assert list(tmp_path.rglob("*.pyc")) == []


@pytest.mark.parametrize("component", COMPONENTS.values(), ids=COMPONENTS)
def test_our_own_components_have_no_fault(component: type) -> None:
    assert declared.fault(component, ()) is None


def test_variables_called_as_ours_are_have_no_special_effect(tmp_path: Path) -> None:
    more = (
        'prescribe_length_factor: bool = parameter("1", True, "Own")\n'
        '    follow_lift: bool = parameter("1", False, "Own")\n'
        '    guide_clearance: float = parameter("m", 1e-3, "Own")\n'
        '    lift_fraction: float = input_("1", 0.0, "Own")\n'
        '    loud: bool = parameter("1", False, "Loud")\n'
        '    force: float = input_("N", 0.0, "Force", when="loud")\n'
        '    soft: float = parameter("1", 0.5, "Soft", unless="loud")\n'
        "    pitch"
    )
    bell(tmp_path, ("pitch:", f"{more}:"))
    text = 'duration = "1 s"\nstep = "0.1 s"\n[shaft]\n[bell]\ncomponent = "bell.py"\n'
    instance = scene.parse(text, directory=tmp_path).instances["bell"]
    assert {"guide_clearance", "lift_fraction", "soft"} <= set(instance.effective())
    assert "force" not in instance.effective()
    instance.follow("lift_fraction")
    assert "follow_lift" not in instance.values
    instance.follow("force")
    assert instance.values["loud"] is True
    assert "soft" not in instance.effective() and "force" in instance.effective()


@pytest.mark.parametrize(
    "described", [lambda c: model_description(c, "", ""), lambda c: model_description3(c, "", "")]
)
def test_units_of_heat_and_electricity_reach_the_model_description(
    tmp_path: Path, described: Callable[[type[Component]], bytes]
) -> None:
    more = (
        'heat: float = parameter("J/K", 500.0, "Heat capacity")\n'
        '    torque: float = parameter("N.m/A", 0.5, "Torque constant")\n'
        '    warmth: float = output("K", "Temperature", rate="warming")\n'
        '    warming: float = output("K/s", "Warming")\n    pitch:'
    )
    bell(tmp_path, ("pitch:", more))
    root = fromstring(described(load.component("bell.py", tmp_path)))
    bases = {unit.get("name"): unit[0].attrib for unit in root.iter("Unit")}
    assert bases["K"] == {"K": "1"}
    assert bases["K/s"] == {"s": "-1", "K": "1"}
    assert bases["J/K"] == {"kg": "1", "m": "2", "s": "-2", "K": "-1"}
    assert bases["N.m/A"] == {"kg": "1", "m": "2", "s": "-2", "A": "-1"}
    bell(tmp_path, ("pitch:", more.replace("K/s", "W/K")))
    with pytest.raises(LoomfmuError, match="warmth is in K, but its rate warming in W/K"):
        load.component("bell.py", tmp_path)


HEARD = '    load: float = input_("N", 0.0, "Load", unbounded=True, source="{}")\n    sound: float'


@pytest.mark.parametrize(
    ("name", "source", "said"),
    [
        ("bell", "warp_#.frame_load", "its source is warp_#.frame_load, but bell has no number;"),
        ("bell_1", "wrap_#.frame_load", "but there is no instance 'wrap_1'; did you mean 'warp_1'?;"),
        ("bell", "yarn.tension", "but there is no instance 'yarn'"),
    ],
)
def test_an_input_whose_source_is_absent_is_named(tmp_path: Path, name: str, source: str, said: str) -> None:
    """A wire vanished: the claim held on the start of the input."""
    bell(tmp_path, ("    sound: float", HEARD.format(source)))
    text = f'[loom]\nweave = "10/01"\nwarps = true\n[{name}]\ncomponent = "bell.py:Bell"\n'
    with pytest.raises(LoomfmuError) as raised:
        scene.parse(text, directory=tmp_path)
    assert str(raised.value).startswith(f"{name}.load: ") and said in str(raised.value)
    assert str(raised.value).endswith(f"name it in [wires], or set {name}.load")
    for more in ("load = 2.0\n", f'[wires]\n"{name}.load" = "warp_1.frame_load"\n'):
        assert scene.parse(text + more, directory=tmp_path)


def test_a_mechanism_without_the_number_of_its_source_is_named_too() -> None:
    text = '[loom]\nweave = "10/01"\nwarps = true\n[blows]\ncomponent = "HealdPlay"\n'
    with pytest.raises(LoomfmuError, match=r"^blows.warp_load: .* but blows has no number"):
        scene.parse(text)
    assert scene.parse(text.replace("warps = true", ""))  # a standard loom leaves it out


@pytest.mark.parametrize(
    ("text", "sink", "source", "name", "wires"),
    [
        ('[my_dobby]\ncomponent = "DobbyDrive"\n[heald_1]\n', "heald_1.rotor_ratio", "dobby.rotor_ratio",
         "my_dobby", ("rotor_ratio", "lift_slope", "rotor_angle")),
        ('[dobby]\n[left]\ncomponent = "HealdFrame"\n[damper_1]\n', "damper_1.lift", "heald_1.lift", "left",
         ("lift", "velocity")),
    ],
)  # fmt: skip
def test_a_source_of_another_name_is_named(
    text: str, sink: str, source: str, name: str, wires: tuple[str, ...]
) -> None:
    """A mechanism of the standard loom under another name left what follows it without wires."""
    with pytest.raises(LoomfmuError) as raised:
        scene.parse(text)
    assert str(raised.value) == (
        f"{sink}: its source is {source}, but there is no instance {source.split('.')[0]!r};"
        f" did you mean {name!r}?; name it in [wires], or set {sink}"
    )
    owner = sink.split(".")[0]
    spelt = "".join(f'"{owner}.{each}" = "{name}.{each}"\n' for each in wires)
    assert scene.parse(f"{text}[wires]\n{spelt}")
