"""Claims on shed and dwell follow what lifts the warp: the carrier where a frame has a damper."""

import re

import numpy as np
import pytest
from drawn_runs import drawn
from scene_texts import LOOM, claim, loom, parsed, table, verdicts, wires

from loomfmu import LoomfmuError, evaluate, judge, prepare
from loomfmu.cosim.scenes.scene import Scene
from loomfmu.loom.lifted import lift_of
from loomfmu.loom.standard_loom import pattern

DAMPED = loom('weave = "10"\ndampers = true\nwarps = true\n', '[shaft]\nspeed = "250 rev/min"\n')
DAMPED = "revolutions = 4\nsteps_per_revolution = 360\n" + DAMPED
ROOM = claim("rapier_in_open_shed", head_height="1 mm")
DWELL = claim("dwell", heald="heald_1", at_least="40 deg")
AT = claim("dwell_contains", heald="heald_1", angles=["180 deg"])


def named(frame: str, damper: str, *claims: str) -> Scene:
    """A loom with a frame and its damper under these names."""
    instances = table(frame, component="HealdFrame", pattern="10") + table(damper, component="HealdDamper")
    lift = wires(**{f"{damper}__{each}": f"{frame}.{each}" for each in ("lift", "velocity", "acceleration")})
    return parsed(
        LOOM, "[dobby]\n", instances, "[wires]\n", lift, *claims, revolutions=2, steps_per_revolution=90
    )


class Run(list[str]):
    """Signals, and the wires of a frame to what takes its lift."""

    def __init__(self, frame: str, *fed: str) -> None:
        super().__init__([f"{frame}.lift", "damper_1.carrier_lift", "damper_2.carrier_lift", "warp_1.load"])
        self.wires = {f"{each}.lift": f"{frame}.lift" for each in fed} | {"heald_9.angle": "dobby.angle"}
        self.fmus: dict[str, str] = {}


def test_the_lift_is_that_of_the_carrier_which_is_wired_to_the_frame() -> None:
    assert lift_of("heald_1", "", Run("heald_1", "warp_1")) == "heald_1.lift"
    assert lift_of("heald_1", "", Run("heald_1", "warp_1", "damper_2")) == "damper_2.carrier_lift"
    assert lift_of("left", "", Run("left", "damper_1")) == "damper_1.carrier_lift"
    assert lift_of("left", "frame", Run("left", "damper_1")) == "left.lift"
    assert lift_of("left", "damper_2", Run("left", "damper_1")) == "damper_2.carrier_lift"
    with pytest.raises(LoomfmuError, match="left has more than one damper, damper_1 and damper_2; set lift"):
        lift_of("left", "", Run("left", "damper_1", "damper_2"))


@pytest.mark.usefixtures("fmu_cache")
@pytest.mark.parametrize("names", [("left", "swing"), ("heald_1", "damper_2")])
def test_verdicts_do_not_hang_on_names(names: tuple[str, str]) -> None:
    """A frame was judged by its own lift unless its damper had its number."""

    def judged(*called: str) -> list[tuple[str, str, float, str]]:
        claims = (ROOM + DWELL + AT).replace("heald_1", called[0])
        found = evaluate(named(*called, claims), errors="none").claims
        plain = [each.signal.replace(called[1], "damper_1") for each in found]
        return [(each.word, signal, each.worst, each.note) for each, signal in zip(found, plain, strict=True)]

    usual = judged("heald_1", "damper_1")
    assert all("damper_1.carrier_lift" in signal for _word, signal, _worst, _note in usual)
    assert judged(*names) == usual


@pytest.mark.usefixtures("fmu_cache")
def test_a_carrier_that_is_not_recorded_is_not_left_out() -> None:
    peak = claim("peak_load", damper="swing", at_most="1000 kN")
    trace = evaluate(named("left", "swing", peak), errors="none").trace
    with pytest.raises(LoomfmuError, match=r"signal .swing\.carrier_lift. is not recorded"):
        judge(trace, kind="dwell", heald="left", at_least="1 deg")


@pytest.mark.usefixtures("fmu_cache")
def test_a_run_that_does_not_say_which_damper_is_in_a_frame_is_not_judged() -> None:
    """Traces of older versions have no wires."""
    trace = evaluate(named("left", "swing", ROOM), errors="none").trace
    dwell = {"kind": "dwell", "heald": "left", "at_least": "1 deg"}
    trace.wires = {}
    with pytest.raises(LoomfmuError, match=r"^the run does not say which damper is in left; set lifted_by$"):
        judge(trace, **dwell)
    assert judge(trace, **dwell, lifted_by="swing").signal == "swing.carrier_lift"


@pytest.mark.usefixtures("fmu_cache")
def test_both_are_judged_and_the_carrier_decides() -> None:
    frame = 'lifted_by = "frame"\n'
    result = evaluate(parsed(DAMPED, *(part for each in (ROOM, DWELL, AT) for part in (each, each + frame))))
    for carrier, alone in zip(result.claims[::2], result.claims[1::2], strict=True):
        assert "damper_1.carrier_lift" in carrier.signal
        assert "heald_1" in alone.signal
        assert carrier.worst != alone.worst
        shown = carrier.note.partition("frame: ")[2] or carrier.note.partition("frames: ")[2]
        # the note has four digits
        assert float(shown.split()[0]) == pytest.approx(alone.displayed(alone.worst), rel=5e-4)
    room, frames, dwell, frames_dwell, *_ = result.claims
    assert room.worst < frames.worst
    assert not dwell
    assert frames_dwell
    # the carrier hangs 4.7 mm off at least: it does not dwell, rather than have no dwell
    assert dwell.worst == 0.0
    lift = result.trace["damper_1.carrier_lift"]
    off = 1e3 * min(lift.min(), 0.098 - lift.max())
    assert dwell.note.startswith("springs and warp keep the carrier ")
    assert float(dwell.note.split()[6]) >= off  # at the first end that it misses
    assert 'lifted_by = "frame"' in dwell.note


@pytest.mark.usefixtures("fmu_cache")
@pytest.mark.parametrize(("clearance", "reached"), [("6.65 mm", True), ("6.7 mm", False), ("7.4 mm", False)])
def test_an_end_that_the_carrier_never_reaches_is_missed_there(clearance, reached) -> None:
    """An unequal shed holds the carrier 8.94 mm below the upper end, where 8.80 mm are asked for, or less."""
    (shed,) = verdicts(
        '[loom]\nmachine = "WL680-3600"\nweave = "10/01"\ndampers = true\nwarps = true\n',
        claim("clear_shed", heald="heald_1", clearance=clearance, at_least="5 deg"),
        revolutions=6,
        steps_per_revolution=360,
        shaft__speed="150 rev/min",
        warp__shed_offset="15.4 mm",
    )
    assert bool(shed) == reached == (shed.worst > 0.0)
    if not reached:
        assert shed.note.startswith("springs and warp keep the carrier 8.94 mm or more from the upper end")


@pytest.mark.usefixtures("fmu_cache")
@pytest.mark.parametrize(
    ("claim", "said"),
    [
        (ROOM + 'lifted_by = "carrier"\n', "lifted_by = 'carrier' must be \"frame\" or be left out; then"),
        (ROOM + 'lifted_by = "damper_1"\n', "lifted_by = 'damper_1' must be \"frame\" or be left out; then"),
        (
            DWELL + 'lifted_by = "carrier"\n',
            "lifted_by = 'carrier' must be \"frame\", the name of a damper such as damper_1, or be left out;",
        ),
    ],
)
def test_an_unknown_choice_is_rejected_before_the_run(claim: str, said: str) -> None:
    with pytest.raises(LoomfmuError, match=re.escape(said)):
        prepare(parsed(DAMPED, claim))


@pytest.mark.parametrize(
    ("weave", "repeat"),
    [
        (["10" * 20], 2),
        (["1" * 40 + "0"], 41),
        ([("1" * 15 + "0") * 8], 16),
        (["110", "10"], 6),
        (["1100", "10"], 4),
        (["10" * 7 + "1", "1" * 127 + "0"], 1920),
    ],
)
def test_the_weave_repeats_where_all_frames_that_a_claim_depends_on_do(weave: list[str], repeat: int) -> None:
    frames = {f"h_{number}": pattern(pegs, "") for number, pegs in enumerate(weave)}
    wires = {f"a.u_{number}": f"h_{number}.lift" for number in range(len(weave))}
    angle = np.linspace(0.0, 3.0 * np.pi, 50)
    signals = {"a.x": ("m", 0.0 * angle), "shaft.angle": ("rad", angle)}
    trace = drawn(angle, signals, lambda frame, name: frames.get(frame, {}).get(name), wires)
    found = judge(trace, kind="above", signal="a.x", bound=-1.0, at_samples=True)
    why = f"and the weave repeats after {repeat}; set revolutions = {repeat} or more"
    assert found.note == f"the shaft turns by only 1.5 revolutions, {why}"
