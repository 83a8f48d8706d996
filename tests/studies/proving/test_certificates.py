"""Certificates are confirmed, and forged ones refused."""

import json
import math
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from scene_texts import claim

from loomfmu.cosim.scenes.scene import parse
from loomfmu.declaring.declarations import input_, output
from loomfmu.declaring.variables import NOTHING, Component
from loomfmu.errors import LoomfmuError
from loomfmu.studies.proving import certificate
from loomfmu.studies.proving.proofs import Proofs
from loomfmu.studies.proving.prove import prove

pytest.importorskip("flint")
from loomfmu.studies.proving import check as checking
from loomfmu.studies.proving.check import check
from loomfmu.studies.proving.intervals import Interval, joined, number

WITHOUT_FRAMES = """
revolutions = 1
[loom]
machine = "WL680-3600"
head = "G6300 left"
[shaft]
speed = "600 rev/min"
[[claims]]
name = "shed"
kind = "rapier_in_open_shed"
head_height = "180 mm"
"""
RAPIERS = Path(__file__).parents[3] / "sims" / "both_rapiers.toml"


@pytest.fixture(scope="module")
def told(loom: Any, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """A certificate of three claims over a narrow range: its check goes box by box."""
    path = tmp_path_factory.mktemp("proof") / "proof.json"
    found = prove(loom, over=["shaft.speed=640rpm..645rpm"], claims=["margin", "dwell", "transfer"])
    assert certificate.write(found, path) == ["margin", "dwell", "transfer"]
    return dict(json.loads(path.read_text()))


def _check(told: dict[str, Any], folder: Path) -> list[str]:
    path = folder / "proof.json"
    path.write_text(json.dumps(told))
    return check(path)


def test_a_certificate_is_confirmed(told: dict[str, Any], tmp_path: Path) -> None:
    lines = _check(told, tmp_path)
    names = ("margin", "dwell", "transfer")
    assert [line.split(" (")[0] for line in lines] == [f"confirmed: {name!r}" for name in names]
    box = "for all shaft angles of 2 revolutions, shaft.speed from 640 to 645 rev/min"
    assert f"bound = 0.1) {box}" in lines[0]


FORGED = [  # what is done to a certificate, and what is said of it
    ('told["scene"] = told["scene"].replace("revolutions = 2", "revolutions = 0.1", 1)\n'
     'told["claims"] = [{"name": "transfer", "conditions": [[], [], []]}]', "never reaches 140 deg"),
    (f'told["scene"] = {WITHOUT_FRAMES!r}\ntold["claims"] = [{{"name": "shed", "conditions": []}}]',
     "no heald frame"),
    ('told["over"]["shaft.start_angle"] = ["0x0p0", (1e-3).hex()]', "all shaft angles are proven"),
    ('told["over"]["revolutions"] = [(2.0).hex(), (100.0).hex()]', "revolutions cannot vary in a proof"),
    ('told["over"]["heald.stroke"] = [(0.097).hex(), (0.099).hex()]\n'
     'told["overrides"] = {"heald_2.stroke": "150 mm"}', "heald_2.stroke keeps a value of its own"),
    ('told["scene"] = told["scene"].replace("revolutions = 2", "revolutions = 1e7", 1)',
     "more than 1000 revolutions"),
    ('told["texts"] = {"a": "", "a/b": ""}', "is not a certificate"),
    ('told["over"]["heald_2.stroke"] = [(0.01).hex(), (0.9).hex()]\n'
     'told["over"]["heald.stroke"] = [(0.098).hex(), (0.0981).hex()]', "varies twice"),
    ("""told["scene"] += '[wires]\\n"belt.velocity" = false\\n'""",
     "belt.velocity is constant, but belt.travel is wired"),
    (f'told["scene"] += {claim("lowest_margin", name="margin", bound=0.99)!r}', "under one name"),
    ('told["texts"]["mine.py"] = "print(1)"', "only the package's own mechanisms"),
    ('told["scene"] += "[other]\\nfmu = \'/etc/other.fmu\'\\n"', "only the package's own mechanisms"),
    ('told["texts"]["../weave.wif"] = ""', "outside of the certificate"),
    ('told["texts"][".weave.wif"] = ""', "not the name of a file"),
    ('told["overrides"] = {"loom.weave": "/tmp/weave.wif"}', "outside of the certificate"),
    ('told["overrides"] = {"loom.weave": "weaves/../../weave.wif"}', "outside of the certificate"),
    ('told["claims"] = []', "proves no claim"),
    ('told["over"]["shaft.speed"][1] = (700 * 0.10471975511965977).hex()', "is not confirmed"),
    ("boxes.pop()", "a box is missing"),
    ("boxes.append(-1)", "more boxes"),
    ("boxes[:] = [-1]", "for shaft angles from 0 to 720 deg, shaft.speed from 640 rev/min to 645 rev/min"),
    ("boxes.insert(0, 2 + 2 * 1)", "one end of a side is not enough"),  # the lower end of side 1 of 2
    ("boxes[:] = [2 + 2 * 2, -1]", "a box is missing"),
    ('told["scene"] = told["scene"].replace("bound = 0.1", "bound = 0.11")', "is not confirmed"),
    ('told["overrides"] = {"belt.head_mass": "130 g"}', "is not confirmed"),
    ('told["equations"]["BeltMonitor"] = "0" * 64', "equations of BeltMonitor are not those"),
    ('told["scene"] = told["scene"].replace("80 deg", "90 deg")\ndel told["claims"][0]',
     "dwell is not confirmed"),
    ('told["claims"][0]["conditions"] = []', "0 conditions, not 1"),
    ('del told["claims"][:2]\ntold["claims"][0]["conditions"][0].pop()', "ranges of the shaft angle"),
]  # fmt: skip


@pytest.mark.parametrize(("forgery", "message"), FORGED)
def test_a_forged_certificate_is_refused(
    told: dict[str, Any], tmp_path: Path, forgery: str, message: str
) -> None:
    forged = json.loads(json.dumps(told))
    exec(forgery, {"told": forged, "boxes": forged["claims"][0]["conditions"][0][0]})
    with pytest.raises(LoomfmuError, match=message):
        _check(forged, tmp_path)


def test_a_claim_that_does_not_depend_on_what_varies_is_confirmed(loom: Any, tmp_path: Path) -> None:
    claim = '[[claims]]\nname = "way"\nkind = "below"\nsignal = "weft.travel"\n'
    claim += 'bound = 1.5\nwindow = ["0 deg", "100 deg"]\n'
    found = prove(parse(loom.text + claim), over=["shaft.speed=590rpm..600rpm"], claims=["way"])
    certificate.write(found, tmp_path / "proof.json")
    assert len(check(tmp_path / "proof.json")) == 1


def test_a_meeting_is_confirmed_at_the_angle_that_the_certificate_names(tmp_path: Path) -> None:
    found = prove(RAPIERS, claims=["the heads meet in time"], set={"transfer.needed_overlap": "0.1 m"})
    certificate.write(found, tmp_path / "proof.json")
    told = json.loads((tmp_path / "proof.json").read_text())
    assert len(_check(told, tmp_path)) == 1
    (covers,) = told["claims"][0]["conditions"]
    for angle, message in ((1.0, "is not within"), (math.nan, "is not within"), (3.3, "is not confirmed")):
        covers[0][0] = angle.hex()
        with pytest.raises(LoomfmuError, match=message):
            _check(told, tmp_path)
    covers[0].clear()
    with pytest.raises(LoomfmuError, match="is not a certificate"):
        _check(told, tmp_path)


def test_the_start_angle_of_the_scene_is_no_side_of_the_box(loom: Any, tmp_path: Path) -> None:
    text = loom.text.split("[[claims]]")[0] + claim(
        "below", name="turn", signal="dobby.rotor_angle", bound=20
    )
    certificate.write(prove(parse(text, "loom")), tmp_path / "proof.json")
    told = json.loads((tmp_path / "proof.json").read_text())
    assert len(_check(told, tmp_path)) == 1
    told["scene"] = text.replace("bound = 20", 'bound = "shaft.start_angle"')
    with pytest.raises(LoomfmuError, match="is not confirmed"):
        _check(told, tmp_path)


def fill(values: list[float], value: float) -> None:
    values[0] = value


def fill_both(values: list[float], value: float) -> None:
    fill(values, value)
    values[1] = value


@dataclass(slots=True)
class Filling(Component):
    """A mechanism whose functions write to lists."""

    keeps = NOTHING
    x: float = input_("1", 0.0, "A number")
    sum: float = output("1", "A sum")

    def initialize(self, time: float) -> int:
        """Compute."""
        values = [0.0, 0.0]
        fill_both(values, self.x + 5.0)
        self.sum = values[0] + values[1]
        return 0


def test_the_check_keeps_what_functions_write_to_lists() -> None:
    module = checking._module(Filling, ["sum"], SimpleNamespace(start=lambda _name: 0.0))
    Interval.sides = 1
    placed = joined(partial(checking._started, Filling, module, ["sum"], [0]))
    (found,) = placed({"x": Interval((0.0, 1.0), [(1.0, 1.0)]), "sum": 0.0}, number(0.0))
    assert found.ends == pytest.approx((10.0, 12.0)) and found.ends[0] <= 10.0 <= 12.0 <= found.ends[1]


def test_a_slope_that_is_0_at_an_end_of_a_box_is_confirmed(tmp_path: Path) -> None:
    over, wider = ["shaft.speed=600rpm..610rpm"], {"transfer.needed_overlap": "0.05 m"}
    found = prove(RAPIERS, over=over, set=wider, claims=["the hooks pass each other slowly"])
    certificate.write(found, tmp_path / "proof.json")
    assert len(check(tmp_path / "proof.json")) == 1


def test_a_bound_that_is_reached_at_the_very_end_is_confirmed(loom: Any, tmp_path: Path) -> None:
    text = loom.text.split("[[claims]]")[0] + claim("below", signal="shaft.angle", bound=4.0 * math.pi)
    found = prove(parse(text, "loom"), over=["shaft.speed=500rpm..600rpm"])
    assert certificate.write(found, tmp_path / "proof.json")
    assert check(tmp_path / "proof.json")


def test_a_loom_that_turns_backwards_is_confirmed(loom: Any, tmp_path: Path) -> None:
    scene = parse(loom.text.replace('bound = "shaft.speed"', "bound = 1"))
    found = prove(scene, over=["shaft.speed=-400rpm..-399rpm"], claims=["margin", "transfer"])
    certificate.write(found, tmp_path / "proof.json")
    assert len(check(tmp_path / "proof.json")) == 2


@pytest.mark.parametrize("text", ["", "{}", '{"format": "loomfmu proof 9"}', "[1, 2]", "[" * 5000])
def test_what_is_no_certificate_is_refused_in_a_line(tmp_path: Path, text: str) -> None:
    (tmp_path / "proof.json").write_text(text)
    with pytest.raises(LoomfmuError, match=r"proof\.json"):
        check(tmp_path / "proof.json")


def test_nothing_is_written_if_nothing_can_be_certified(proofs: Proofs, tmp_path: Path) -> None:
    none = Proofs(proofs.scene, proofs.over, proofs.claims[-1:])
    with pytest.raises(LoomfmuError, match="no claim that a certificate can confirm is proven"):
        certificate.write(none, tmp_path / "proof.json")
