"""What turns the instances that a claim judges, and the whole revolutions of it that a run must show."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from drawn_runs import drawn
from scene_texts import MOTION, claim, loom, table, verdicts, wires

from loomfmu import LoomfmuError, Verdict, judge
from loomfmu.cosim.claims.movers import Mover, movers_of, owners_of

MAIN = {"weft": "WeftInsertion", "belt": "BeltMonitor", "shaft": "MainShaft"}


class Run:
    """A run with the angles that its wires name, and what is known of those that turn by themselves."""

    def __init__(self, fmus: Mapping[str, str], wires: Mapping[str, str], alone: tuple[str, ...] = ()):
        self.fmus, self.wires, self._alone = fmus, wires, alone

    def __contains__(self, signal: object) -> bool:
        return signal in self.wires.values() or str(signal).endswith(".angle")

    def unit(self, signal: str) -> str:
        return "m" if signal.endswith("travel") else "rad"

    @property
    def own_speeds(self) -> Mapping[str, str]:
        return self.fmus

    def parameter(self, signal: str) -> float:
        if signal.partition(".")[0] not in self._alone:
            raise LoomfmuError(f"{signal} is not recorded")
        return 0.0


def test_the_instances_of_signals_stand_anywhere_in_an_expression() -> None:
    named = [
        "weft.travel",
        "plant.der(a)",
        "plant_2.body.v[1,2]",
        "min(0.5 mm - belt.margin, -2e-3 * a.b)",
        "1.5 deg",
    ]
    assert owners_of(named) == {"weft", "plant", "plant_2", "belt", "a"}


GEARED = {"weft.shaft_angle": "gear.turned", "gear.shaft_angle": "shaft.angle", "belt.travel": "weft.travel"}


@pytest.mark.parametrize(
    ("fmus", "wires", "alone", "found"),
    [
        (MAIN, {"weft.shaft_angle": "shaft.angle", "belt.travel": "weft.travel"}, (), {"shaft.angle"}),
        (MAIN | {"gear": "Gear"}, GEARED, (), {"shaft.angle", "gear.turned"}),
        (
            MAIN | {"gear": "Gear"},
            {"belt.travel": "weft.travel"},
            ("weft", "belt"),
            {"weft.speed", "belt.speed"},
        ),
        ({"belt": "Winder"}, {}, ("belt",), {"belt.speed"}),
        (MAIN | {"belt": "Bump"}, {**GEARED, "belt.seen": "gear.turned"}, (), {"shaft.angle", "gear.turned"}),
    ],
)
def test_all_that_turns_an_instance_counts(
    fmus: Mapping[str, str], wires: Mapping[str, str], alone: tuple[str, ...], found: set[str]
) -> None:
    movers = movers_of(["belt"], Run(fmus, wires, alone))
    names = {each.angle or each.speed for each in movers}
    assert names == found


def test_an_angle_of_a_mechanism_of_ones_own_may_swing() -> None:
    """What others follow turns; what they take as a number may swing; what nobody takes does not count."""
    fmus = {"rocker": "Rocker", "lay": "Lay", "weft": "WeftInsertion", "shaft": "MainShaft"}
    wires = {"rocker.shaft_angle": "shaft.angle"}
    assert movers_of(["rocker"], Run(fmus, wires)) == [Mover("shaft.angle")]
    taken = wires | {"lay.seen": "rocker.angle"}
    assert set(movers_of(["lay"], Run(fmus, taken))) == {
        Mover("rocker.angle", turns=False),
        Mover("shaft.angle"),
    }
    followed = wires | {"weft.shaft_angle": "rocker.angle"}
    assert set(movers_of(["rocker"], Run(fmus, followed))) == {Mover("rocker.angle"), Mover("shaft.angle")}


def test_angles_of_any_unit_that_an_fmu_takes_by_wire_or_table_count() -> None:
    """An input that a table drives is its own source; those of our own components are read at their shaft."""
    fmus = {"bump": "Bump", "gear": "Gear"}

    class Degrees(Run):
        def unit(self, signal: str) -> str:
            return "deg" if signal == "gear.turned" else "rad"

    driven = {"bump.turned": "bump.turned", "bump.seen": "gear.turned"}
    assert set(movers_of(["bump"], Degrees(fmus, driven))) == {
        Mover("bump.turned", turns=False),
        Mover("gear.turned", turns=False, turn=360.0),
    }
    assert movers_of(["bump"], Degrees(fmus, {"bump.shaft_angle": "gear.turned"})) == [
        Mover("gear.turned", turn=360.0)
    ]


@pytest.mark.parametrize(("unit", "turn"), [("rad", math.tau), ("deg", 360.0)])
def test_a_whole_turn_is_one_in_the_unit_of_the_angle(unit: str, turn: float) -> None:
    """Without a main shaft; the angle turns by 0.9 or by 1.1 turns."""
    time = np.linspace(0.0, 1.0, 51)
    for turns, word in ((0.9, "undecided"), (1.1, "holds")):
        turned = {"bump.lift": ("m", 0.0 * time), "bump.turned": (unit, turns * turn * time)}
        run = drawn(time, turned, lambda *_: None, {"bump.turned": "bump.turned"}, {"bump": "Bump"})
        assert judge(run, kind="below", signal="bump.lift", bound=1, at_samples=True).word == word


PUBLISHED = {"machine": "WL680-3600", "head": "G6300 left"}
WEFT, BELT = table("weft", **PUBLISHED), table("belt", component="BeltMonitor", **PUBLISHED)


def below(signal: str, bound: Any) -> str:
    return claim("below", signal=signal, bound=bound)


def turned_back(
    revolutions: float, start: float, force: float, end: float, *parts: str, steps: int = 720
) -> tuple[Verdict, ...]:
    """Verdicts on a shaft that a torque turns back, from 0.03 revolutions to `end`."""
    shaft = table("shaft", component="DrivenShaft", speed="60 rev/min", inertia=3, torque_slope=50)
    rows = [[0, 0], [0.02, 0], [0.03, force], [end, force], [end + 0.01, 0], [5, 0]]
    torque = "[inputs]\n" + wires(shaft__torque_32=rows)
    at = {"revolutions": revolutions, "steps_per_revolution": steps, "shaft__start_angle": f"{start} deg"}
    return verdicts(shaft, torque, *parts, **at)


def test_what_turns_at_its_own_speed_turns_whole_revolutions_too() -> None:
    """In a fifth of a revolution the belt was never at risk."""
    margin = claim("lowest_margin", bound=0.99)
    text = 'duration = "{}"\nstep = "0.0001 s"\n' + WEFT + BELT + margin
    speeds = {"weft__speed": "600 rpm", "belt__speed": "600 rpm"}
    (short,), (whole,) = (verdicts(text.format(duration), **speeds) for duration in ("20 ms", "0.1 s"))
    assert short.word == "undecided" and short.note.startswith(
        "a mechanism at its own speed turns by only 0.2"
    )
    assert whole.word == "FAILS"


def test_a_window_that_a_shaft_enters_and_leaves_by_one_edge_is_not_passed() -> None:
    window = below("weft.travel", "1 m") + 'window = ["8 deg", "300 deg"]\n'
    (found,) = turned_back(0.1, 5, 2000, 0.06, WEFT, window)
    assert (found.word, found.note) == ("undecided", "the run never passes through the whole window")


def test_a_revolution_ends_once_however_a_shaft_turns_back() -> None:
    """The first one takes 1.9549 s at 60 to -397 rev/min; its end by the arrays of a finer run."""
    (found,) = turned_back(4, 0, 3000, 0.12, claim("speed_fluctuation", at_most=8))
    assert found.word == "FAILS" and found.worst == pytest.approx(14.895, rel=1e-3)


FRAMES = '[loom]\nmachine = "WL680-3600"\nweave = "10/01"\n'
DWELL = claim("dwell", heald="heald_1", at_least="60 deg")
CLEAR = claim("clear_shed", heald="heald_1", clearance="3 mm", at_least="100 deg")


@pytest.mark.parametrize(("start", "judged"), [(230, DWELL), (330, CLEAR)])
def test_a_dwell_in_which_the_shaft_turns_back_has_no_length(start: int, judged: str) -> None:
    """Entered and left at one angle, it lasted 0 deg, and failed."""
    (found,) = turned_back(3, start, 2000, 0.06, FRAMES, judged)
    assert found.word == "undecided" and "the shaft turns back" in found.note


def test_a_mechanism_that_follows_nothing_stands() -> None:
    travel = below("weft.travel", "1 m")
    (found,) = verdicts('duration = "20 ms"\nstep = "0.2 ms"\n', WEFT, travel, weft__follow_shaft=True)
    assert found.word == "undecided" and "nothing feeds weft.shaft_angle" in found.note


def test_a_head_that_turns_back_has_not_been_through_the_shed() -> None:
    reed, shed = loom("reed = true\n"), claim("reed_clear_of_rapier", clearance="20 mm")
    late = table("reed", beat_up_angle="150 deg")
    (found,) = turned_back(0.1, 60, 2000, 0.06, reed, late, shed, steps=7200)
    assert found.word == "undecided" and "the shaft turns by only 0.0" in found.note


def test_a_table_of_the_shafts_angle_takes_effect_as_a_wire_does() -> None:
    """The mechanism turned at its own speed, whatever the table said."""
    cut = "[wires]\n" + wires(**{f"weft__shaft_{each}": False for each in MOTION})
    turning = wires(weft__shaft_angle=[[0, 0], [10, "720 deg"]], weft__shaft_velocity=[[0, "40 rpm"]])
    scene = '[shaft]\nspeed = "200 rpm"\n', WEFT, cut, f"[inputs]\n{turning}", below("weft.travel", "1 m")
    (short,), (whole,) = (verdicts(*scene, revolutions=turns, steps_per_revolution=90) for turns in (1, 6))
    assert short.word == "undecided" and short.note.startswith("weft.shaft_angle turns by only 0.2")
    assert whole.word == "FAILS" and whole.worst == pytest.approx(2.0953, rel=1e-3)
