"""Claims on the whole loom: its mechanisms keep out of each other's way."""

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from ... import units
from ...errors import LoomfmuError
from ...traces import Signals, Verdict
from ...traces.verdict import SHED_OPENING
from . import shaft
from .arguments import Edges, Flag, Name, Names, Quantity, Window, argument
from .claim import AT_LEAST, AT_MOST, LANDINGS, LENGTH, ONE, SPEED, VELOCITY, Claim, Landings
from .curves import SAME, Doubt, Motion, Stretch, advised, motion_of
from .extremes import first_lowest, lowest, nearest
from .lifted import Wired, check_lifted_by, frames_of, lift_of

NEVER = "the head never enters the shed in this run"


class _InShed(Claim, kind=False):
    """A claim on the time while the rapier head is in the shed: its travel exceeds the idle travel."""

    weft: str = argument(Name(), "weft")
    belt: str = argument(Name(), "belt")

    reads = ("belt",)
    unit = LENGTH

    def _travel(self, trace: Signals) -> Motion:
        return motion_of(trace, f"{self.weft}.travel")

    def _in_shed(self, trace: Signals) -> list[Stretch]:
        return self._travel(trace).beyond(trace.parameter(f"{self.belt}.idle_travel"), 1.0)

    def unseen(self, trace: Signals) -> str:
        return "" if any(each.whole for each in self._in_shed(trace)) else shaft.short(trace)


class RapierInOpenShed(_InShed):
    """While the rapier head is in the shed, every warp sheet leaves it its height.

    At the rapier's station each frame's warp must then be at least half the head's height above or below the
    closed shed. What is judged is twice the least distance of any frame, and 0 if its warp crosses the closed
    shed meanwhile. Where a frame has a damper, its warp is as high as the carrier lifts it, unless
    `lifted_by` is "frame".
    """

    head_height: float = argument(Quantity("m", "mm", usual=0.03, low=0.0))
    healds: Sequence[str] = argument(Names(), ())
    lifted_by: str = argument(Name(), "")

    def signals(self, scene: Wired) -> list[str]:
        check_lifted_by(self.lifted_by, ())  # it judges several frames, and a damper belongs to one
        frames = self.healds or frames_of(scene)
        wanted = [f"{frame}.{variable}" for frame in frames for variable in ("lift", "warp_height")]
        carriers = [lift_of(frame, self.lifted_by, scene) for frame in frames]
        return list(dict.fromkeys([f"{self.weft}.travel", *wanted, *carriers]))

    def judge(self, trace: Signals) -> Verdict:
        frames = self.healds or frames_of(trace)
        if not frames:
            raise LoomfmuError("rapier_in_open_shed: the run records no heald frame")
        check_lifted_by(self.lifted_by, ())
        text, limit, travel = SHED_OPENING, self.head_height, self._travel(trace)
        in_shed = self._in_shed(trace)
        warps = {frame: lift_of(frame, self.lifted_by, trace) for frame in frames}
        if not in_shed:
            signal = _opening(frames[0], warps[frames[0]])
            return self.verdict(trace, text, signal, limit, math.nan, math.nan, NEVER, travel.note)
        worst, time, signal, notes = self._least(trace, warps, in_shed)
        if any(lift != f"{frame}.lift" for frame, lift in warps.items()):
            frames_alone, *_rest = self._least(trace, {frame: f"{frame}.lift" for frame in frames}, in_shed)
            notes.append(f"the frames: {units.show(frames_alone, 'mm')}")
        return self.verdict(trace, text, signal, limit, worst, time, travel.note, *notes)

    def _least(
        self, trace: Signals, warps: Mapping[str, str], in_shed: Sequence[Stretch]
    ) -> tuple[float, float, str, list[str]]:
        """The least opening by the lifts of the frames' warps: value, time, whose, and notes."""
        openings, notes = [], []
        for frame, signal in warps.items():
            lift = motion_of(trace, signal)
            stroke, ratio = trace.parameter(f"{frame}.stroke"), trace.parameter(f"{frame}.warp_ratio")
            closest = nearest(lift, 0.5 * stroke, in_shed)
            openings.append((2.0 * ratio * closest.value, closest.time, _opening(frame, signal)))
            notes += [lift.note, closest.note]
        worst = float(np.min([opening for opening, _time, _name in openings]))  # NaN if there is one
        equal = [each for each in openings if not each[0] > worst + SAME]
        _value, time, named = min(equal, key=lambda each: each[1])
        return worst, time, named, notes


def _opening(frame: str, lift: str) -> str:
    """Return the name of the opening at a frame, or at the carrier in it."""
    return f"2 |{frame}.warp_height|" if lift == f"{frame}.lift" else f"2 |warp height by {lift}|"


class ReedClearOfRapier(_InShed):
    """While the rapier head is in the shed, the reed stays a distance behind its front limit."""

    clearance: float = argument(Quantity("m", "mm", usual=0.03, low=0.0))
    reed: str = argument(Name(), "reed")

    needs = ("reed.position", "reed.front_limit", "weft.travel")

    def judge(self, trace: Signals) -> Verdict:
        text, signal = (
            "smallest distance from the front limit",
            f"{self.reed}.front_limit - {self.reed}.position",
        )
        travel, position = self._travel(trace), motion_of(trace, f"{self.reed}.position")
        in_shed = self._in_shed(trace)
        if not in_shed:
            return self.verdict(trace, text, signal, self.clearance, math.nan, math.nan, NEVER, travel.note)
        foremost = lowest(position, -1.0, in_shed)
        worst = float(trace[f"{self.reed}.front_limit"][-1]) - foremost.value
        notes = (travel.note, position.note, foremost.note)
        return self.verdict(trace, text, signal, self.clearance, worst, foremost.time, *notes)


class _Transfer(Claim, kind=False):
    """A claim on the transfer: the hand-over lasts while the heads overlap by what the hooks need."""

    transfer: str = argument(Name(), "transfer")

    reads = ("transfer",)
    grid = LANDINGS

    def _overlap(self, trace: Signals) -> tuple[Motion, float]:
        """The overlap, and what the hooks need of it."""
        name = self.transfer
        return motion_of(trace, f"{name}.overlap"), trace.parameter(f"{name}.needed_overlap")


class TransferInTime(_Transfer):
    """In every revolution the heads overlap by what the hooks need, within a window of shaft angles.

    The largest overlap in each pass through the window is judged, and the least of these decides. Passes of
    which the run has only a part do not count.
    """

    window: Window = argument(Edges("rad", "deg", usual=1.5))

    needs = ("transfer.overlap",)
    unit = LENGTH

    def judge(self, trace: Signals) -> Verdict:
        text, signal = f"overlap of the heads {self.window.words}", f"{self.transfer}.overlap"
        overlap, needed = self._overlap(trace)
        found = [lowest(overlap, -1.0, [each]) for each in shaft.passes(trace, self.window)]
        if not found:
            nothing = math.nan, math.nan, overlap.note, shaft.UNPASSED
            return self.verdict(trace, text, signal, needed, *nothing)
        worst, time = first_lowest([each.value for each in found], [each.time for each in found])
        notes = (overlap.note, *(each.note for each in found), *self._hand_over(trace, overlap, needed, time))
        return self.verdict(trace, text, signal, needed, worst, time, *notes)

    def unseen(self, trace: Signals) -> str:
        return shaft.unpassed(trace, self.window)

    def _hand_over(self, trace: Signals, overlap: Motion, needed: float, time: float) -> list[str]:
        """A note on the shaft angles between which the heads overlap enough about a time."""
        turning = shaft.needed_angle(trace)
        return [
            "hand-over from {} to {}".format(
                *(units.show(shaft.place(turning, end)[0], "deg") for end in each[:2])
            )
            for each in overlap.beyond(needed, 1.0)
            if each.whole and each.start <= time <= each.end
        ]

    def landings(self, trace: Signals) -> Landings:
        edges = [each.start for each in shaft.times_within(trace, self.window)]
        return Landings(edges, [(f"{self.transfer}.overlap", -1.0)])


class TransferSpeed(_Transfer):
    """While the heads overlap by what the hooks need, they move no faster relative to each other."""

    at_most: float = argument(Quantity("m/s", low=0.0))

    needs = ("transfer.overlap", "transfer.closing_velocity")
    sense, unit = AT_MOST, VELOCITY

    def unseen(self, trace: Signals) -> str:
        overlap, needed = self._overlap(trace)
        return "" if any(each.whole for each in overlap.beyond(needed, 1.0)) else shaft.short(trace)

    def judge(self, trace: Signals) -> Verdict:
        text, signal = "highest relative speed of the heads", f"{self.transfer}.closing_velocity"
        (overlap, needed), closing = self._overlap(trace), motion_of(trace, signal)
        during = overlap.beyond(needed, 1.0)
        if not during:
            note = "the heads never overlap by what the hooks need in this run"
            return self.verdict(trace, text, signal, self.at_most, math.nan, math.nan, overlap.note, note)
        ends = [lowest(closing, sign, during) for sign in (1.0, -1.0)]
        fastest = max(ends, key=lambda found: abs(found.value))
        notes = (overlap.note, closing.note, *(each.note for each in ends))
        return self.verdict(trace, text, signal, self.at_most, abs(fastest.value), fastest.time, *notes)

    def landings(self, trace: Signals) -> Landings:
        overlap, needed = self._overlap(trace)
        return Landings(overlap.crossings(needed), [])


class NipHolds(Claim):
    """The nip's largest holding force, while fibres are drafted, is 2 to 3 times the largest drafting force.

    Below that the web slips in the nip, above it the top roller is loaded for nothing. The forces of a roller
    are known only at the samples: with `at_samples` these are judged.
    """

    roller: str = argument(Name(), "roller")
    at_least: float = argument(Quantity("1", low=0.0), 2.0)
    at_most: float = argument(Quantity("1", low=0.0), 3.0)
    at_samples: bool = argument(Flag(), False)

    needs = ("roller.holding_force", "roller.drafting_force")
    final = False

    def judge(self, trace: Signals) -> Verdict:
        drafting = motion_of(trace, f"{self.roller}.drafting_force")
        holding = motion_of(trace, f"{self.roller}.holding_force")
        most = lowest(drafting, -1.0)
        text = "holding force over drafting force" + " at the samples" * self.at_samples
        signal = f"{self.roller}.holding_force / drafting_force"
        if not most.value > 0.0:
            note = "no fibres are drafted in this run"
            return self.verdict(trace, text, signal, self.at_least, math.nan, math.nan, note)
        held = lowest(holding, -1.0, drafting.beyond(0.0, 1.0))
        ratio = held.value / most.value
        high = ratio - self.at_least > self.at_most - ratio
        notes = [most.note, held.note]
        notes += [] if self.at_samples else map(advised, (drafting.note, holding.note))
        return self.verdict(
            trace,
            text,
            signal,
            self.at_most if high else self.at_least,
            ratio,
            most.time,
            *notes,
            holds=self.at_least - SAME <= ratio <= self.at_most + SAME,
            sense=AT_MOST if high else AT_LEAST,
        )


class LocksInTime(Claim):
    """The pattern locks follow their law and let go within the time that they have.

    Both hold up to a speed of the shaft that the lock computes, so the shaft's highest speed is judged.
    """

    lock: str = argument(Name(), "lock")

    needs = ("lock.in_time", "lock.torque_margin", "lock.speed_limit")
    sense, unit = AT_MOST, SPEED

    def judge(self, trace: Signals) -> Verdict:
        text, limit = "highest speed of the shaft", float(trace[f"{self.lock}.speed_limit"][-1])
        in_time = np.asarray(trace[f"{self.lock}.in_time"], dtype=bool)
        speed = motion_of(trace, "shaft.velocity", rates=1) if "shaft.velocity" in trace else None
        if speed is None or not np.array_equal(np.abs(speed.values[0]) <= limit, in_time):
            return self._at_samples(trace, in_time)
        fastest = min(lowest(speed, 1.0), lowest(speed, -1.0), key=lambda found: -abs(found.value))
        highest = abs(fastest.value)
        notes = (speed.note, fastest.note)
        return self.verdict(trace, text, "shaft.velocity", limit, highest, fastest.time, *notes)

    def _at_samples(self, trace: Signals, in_time: NDArray[np.bool_]) -> Verdict:
        """The verdict on a lock that does not follow the main shaft: what it says at the samples."""
        signal = f"{self.lock}.torque_margin"
        margin = np.asarray(trace[signal])
        late = np.flatnonzero(~in_time)
        place = int(late[0]) if len(late) else int(np.argmin(margin))
        note = Doubt(
            f"{self.lock}.in_time is known only at the samples: the lock does not follow shaft.velocity"
        )
        return self.verdict(
            trace,
            "torque margin",
            signal,
            0.0,
            float(margin[place]),
            float(trace.time[place]),
            note,
            holds=not len(late),
            unit=ONE,
            sense=AT_LEAST,
        )
