"""Certificates are confirmed, and forged ones refused."""

import json
import math
from pathlib import Path
from typing import Any

import pytest

from loomfmu.errors import LoomfmuError
from loomfmu.studies.proving import certificate
from loomfmu.studies.proving.proofs import Proofs
from loomfmu.studies.proving.prove import prove

pytest.importorskip("flint")
from loomfmu.studies.proving.check import check

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
    assert [line.split(" (")[0] for line in lines] == [f"confirmed: {name}" for name in names]
    assert (
        "bound = 0.1) for all shaft angles of 2 revolutions, shaft.speed from 67.0206433 to 67.5442421 (SI)"
        in lines[0]
    )


def _wider(told: dict[str, Any]) -> None:
    told["over"]["shaft.speed"][1] = (700 * 0.10471975511965977).hex()


def _missing(told: dict[str, Any]) -> None:
    told["claims"][0]["conditions"][0][0].pop()


def _too_many(told: dict[str, Any]) -> None:
    told["claims"][0]["conditions"][0][0].append(-1)


def _undivided(told: dict[str, Any]) -> None:
    told["claims"][0]["conditions"][0][0] = [-1]


def _one_end(told: dict[str, Any]) -> None:
    """Pretend that the slowest speed, the lower end of side 1 of 2, is enough for all."""
    told["claims"][0]["conditions"][0][0] = [2 + 2 * 1, *told["claims"][0]["conditions"][0][0]]


def _no_end(told: dict[str, Any]) -> None:
    told["claims"][0]["conditions"][0][0] = [2 + 2 * 2, -1]


def _other_bound(told: dict[str, Any]) -> None:
    told["scene"] = told["scene"].replace("bound = 0.1", "bound = 0.11")


def _other_scene(told: dict[str, Any]) -> None:
    told["overrides"] = {"belt.head_mass": "130 g"}


def _other_equations(told: dict[str, Any]) -> None:
    told["equations"]["BeltMonitor"] = "0" * 64


def _longer_dwell(told: dict[str, Any]) -> None:
    told["scene"] = told["scene"].replace('"80 deg"', '"90 deg"')
    del told["claims"][0]


def _without_a_condition(told: dict[str, Any]) -> None:
    told["claims"][0]["conditions"] = []


def _without_an_angle(told: dict[str, Any]) -> None:
    del told["claims"][:2]
    told["claims"][0]["conditions"][0].pop()


def _another_side(told: dict[str, Any]) -> None:
    told["over"]["shaft.start_angle"] = ["0x0p0", (1e-3).hex()]


def _twice(told: dict[str, Any]) -> None:
    told["over"] |= {
        "heald_2.stroke": [(0.01).hex(), (0.9).hex()],
        "heald.stroke": [(0.098).hex(), (0.0981).hex()],
    }


def _two_of_one_name(told: dict[str, Any]) -> None:
    told["scene"] += '\n[[claims]]\nname = "margin"\nkind = "lowest_margin"\nbound = 0.99\n'


def _code(told: dict[str, Any]) -> None:
    told["texts"]["mine.py"] = "print(1)"


def _a_file(told: dict[str, Any]) -> None:
    told["scene"] += '\n[other]\nfmu = "/etc/other.fmu"\n'


def _elsewhere(told: dict[str, Any]) -> None:
    told["texts"]["../weave.wif"] = ""


def _nothing(told: dict[str, Any]) -> None:
    told["claims"] = []


def _angles_not_reached(told: dict[str, Any]) -> None:
    told["scene"] = told["scene"].replace("revolutions = 2", "revolutions = 0.1", 1)
    told["claims"] = [{"name": "transfer", "conditions": [[]]}]


def _no_heald_frame(told: dict[str, Any]) -> None:
    """Claim something of all frames where there is none."""
    told["scene"] = WITHOUT_FRAMES
    told["claims"] = [{"name": "shed", "conditions": []}]


FORGED = [
    (_angles_not_reached, "never reaches 140 deg"),
    (_no_heald_frame, "no heald frame"),
    (_another_side, "varies twice"),
    (_twice, "varies twice"),
    (_two_of_one_name, "under one name"),
    (_code, "only the package's own mechanisms"),
    (_a_file, "only the package's own mechanisms"),
    (_elsewhere, "not the name of a file"),
    (_nothing, "proves no claim"),
    (_wider, "is not confirmed"),
    (_missing, "a box is missing"),
    (_too_many, "more boxes"),
    (_undivided, "is not confirmed"),
    (_one_end, "one end of a side is not enough"),
    (_no_end, "a box is missing"),
    (_other_bound, "is not confirmed"),
    (_other_scene, "is not confirmed"),
    (_other_equations, "equations of BeltMonitor are not those"),
    (_longer_dwell, "dwell is not confirmed"),
    (_without_a_condition, "0 conditions, not 1"),
    (_without_an_angle, "ranges of the shaft angle"),
]


@pytest.mark.parametrize(("forge", "message"), FORGED)
def test_a_forged_certificate_is_refused(
    told: dict[str, Any], tmp_path: Path, forge: Any, message: str
) -> None:
    forged = json.loads(json.dumps(told))
    forge(forged)
    with pytest.raises(LoomfmuError, match=message):
        _check(forged, tmp_path)


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


@pytest.mark.parametrize("text", ["", "{}", '{"format": "loomfmu proof 9"}', "[1, 2]", "[" * 5000])
def test_what_is_no_certificate_is_refused_in_a_line(tmp_path: Path, text: str) -> None:
    (tmp_path / "proof.json").write_text(text)
    with pytest.raises(LoomfmuError, match=r"proof\.json"):
        check(tmp_path / "proof.json")


def test_nothing_is_written_if_nothing_can_be_certified(proofs: Proofs, tmp_path: Path) -> None:
    none = Proofs(proofs.scene, proofs.over, proofs.claims[-1:])
    with pytest.raises(LoomfmuError, match="no claim that a certificate can confirm is proven"):
        certificate.write(none, tmp_path / "proof.json")
