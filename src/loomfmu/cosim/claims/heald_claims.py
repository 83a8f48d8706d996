"""Claims on heald frames: how long they dwell and leave the shed clear, by the angle that the shaft turns.

What lifts the warp is judged: the carrier where a frame has a damper. The note says what its frame does.
"""

import math
from collections.abc import Callable, Sequence
from typing import ClassVar

import numpy as np

from ... import units
from ...errors import LoomfmuError
from ...traces import Signals, Verdict
from . import shaft
from .arguments import Angles, Name, Quantity, angles_text, argument
from .claim import ANGLE, AT_MOST, LANDINGS, PERCENT, Claim, Landings
from .curves import Doubt, Floats, Motion, Stretch, motion_of
from .extremes import first_lowest
from .lifted import Wired, check_lifted_by, dampers_of, lift_of, lifts

TOLERANCE = 0.015  # of the stroke: within it a frame dwells, unless the claim says otherwise
SHARE = Quantity("1", between=(0.0, 0.5), of="the stroke")

CUT_OFF = Doubt("one is cut off by an end of the run and may be shorter; run longer or start elsewhere")

Ends = tuple[list[Stretch], list[Stretch]]  # when a motion is at the lower end, and at the upper one


class _Lifted(Claim, kind=False):
    """A claim that is judged by the lift of a frame's warp: the carrier's, or with "frame" the frame's."""

    heald: str = argument(Name())
    lifted_by: str = argument(Name(), "")

    def signals(self, scene: Wired) -> list[str]:
        check_lifted_by(self.lifted_by, dampers_of(scene))
        return list(dict.fromkeys((lift_of(self.heald, self.lifted_by, scene), *super().signals(scene))))

    def _lift(self, trace: Signals) -> Motion:
        """The lift that the warp has."""
        return motion_of(trace, lift_of(self.heald, self.lifted_by, trace))


class _Span(_Lifted, kind=False):
    """Whenever a frame is within a distance from an end of its stroke, it stays there for a shaft angle.

    Spans that begin and end within the run are judged, and those that an end of the run cuts off if what the
    run shows of them is long enough.
    """

    at_least: float = argument(Quantity("rad", "deg", usual=1.5, low=0.0))

    unit, grid, final = ANGLE, LANDINGS, False  # a carrier may still come to an end of its stroke
    instead: ClassVar[str] = 'lifted_by = "frame" judges the drive alone'
    both_ways: ClassVar[bool] = False  # whether a carrier that swings as far beyond the end is not near it

    def _distance(self, trace: Signals) -> float:
        """Return how near to an end of its stroke the frame must be [m]."""
        raise NotImplementedError

    def _judge(self, trace: Signals, text: str, of: str) -> Verdict:
        """The verdict; `of` is what it names of a frame without a damper."""
        signals = lifts(self.heald, self.lifted_by, trace)
        motions = [motion_of(trace, signal) for signal in signals]
        turning, stroke = shaft.needed_angle(trace), trace.parameter(f"{self.heald}.stroke")
        ends = [_ends(lift, self._distance(trace), stroke, self.both_ways) for lift in motions]
        found = [
            self._shortest(lift, sorted(lower + upper), turning)
            for lift, (lower, upper) in zip(motions, ends, strict=True)
        ]
        worst, time, *notes = found[0]
        if found[1:] and math.isfinite(found[1][0]):
            missed = self._missed(motions[0], stroke, *ends)
            if missed is not None:
                worst, time, notes[0] = missed
        notes += [
            f"its frame: {units.show(turn, 'deg')}" for turn, *_rest in found[1:] if math.isfinite(turn)
        ]
        signal = signals[0] if found[1:] else f"{self.heald}.{of}"
        return self.verdict(trace, text, signal, self.at_least, worst, time, *notes)

    def _missed(
        self, carrier: Motion, stroke: float, own: Ends, frames: Ends
    ) -> tuple[float, float, str] | None:
        """The first span of a frame, between those around it, in which its carrier is never at that end.

        Spans that an end of the run cuts off count only if the carrier is never at an end: it may come later.
        """
        time = carrier.time
        every = sorted(frames[0] + frames[1])
        ordered = sorted((span, end) for end in (0, 1) for span in frames[end])
        for span, end in ordered:
            before = max((each.end for each in every if each.end <= span.start), default=time[0])
            after = min((each.start for each in every if each.start >= span.end), default=time[-1])
            there = any(each.end > before and each.start < after for each in own[end])
            if not there and (span.whole or not (own[0] or own[1])):
                within = (time >= before) & (time <= after)
                away = float(np.min(np.abs(np.asarray(carrier.values[0])[within] - end * stroke)))
                place = ("lower", "upper")[end]
                off = f"{1e3 * away:.3g} mm or more from the {place} end of its frame's stroke"
                return 0.0, span.start, f"springs and warp keep the carrier {off}; {self.instead}"
        return None

    def _shortest(self, lift: Motion, spans: list[Stretch], turning: Motion) -> tuple[float, float, str, str]:
        """The least turn of the shaft during one of these spans of a motion, its time, and notes."""
        turned = [abs(turning.at(span.end) - turning.at(span.start)) for span in spans]
        judged = [(turn, span.start) for turn, span in zip(turned, spans, strict=True) if span.whole]
        shown = [turn for turn, span in zip(turned, spans, strict=True) if not span.whole]
        note = CUT_OFF if any(turn < self.at_least for turn in shown) else ""
        if not judged:
            judged, note = _cut_off(spans, turned, self.at_least, lift.time)
        worst, time = math.nan, math.nan
        if judged:
            worst, time = first_lowest([turn for turn, _ in judged], [start for _, start in judged])
        return worst, time, note, lift.note

    def landings(self, trace: Signals) -> Landings:
        lift, distance = self._lift(trace), self._distance(trace)
        stroke = trace.parameter(f"{self.heald}.stroke")
        return Landings(lift.crossings(distance) + lift.crossings(stroke - distance), [])


class Dwell(_Span):
    """Every dwell of a frame, within a share of its stroke from an end, lasts a shaft angle."""

    tolerance: float = argument(SHARE, TOLERANCE)

    needs = ("heald.lift",)
    both_ways = True
    instead = 'clear_shed judges the shed that it leaves, lifted_by = "frame" the dwell of the drive'

    def _distance(self, trace: Signals) -> float:
        return self.tolerance * trace.parameter(f"{self.heald}.stroke")

    def judge(self, trace: Signals) -> Verdict:
        return self._judge(trace, f"dwell within {100 * self.tolerance:g} % of the stroke", "lift")


class ClearShed(_Span):
    """Every time that a frame's warp is beyond a height, either way, lasts a shaft angle."""

    clearance: float = argument(Quantity("m", "mm", usual=0.03, low=0.0))

    needs = ("heald.lift", "heald.warp_height")

    def _distance(self, trace: Signals) -> float:
        stroke, ratio = (trace.parameter(f"{self.heald}.{name}") for name in ("stroke", "warp_ratio"))
        return 0.5 * stroke - self.clearance / ratio

    def check(self, parameter: Callable[[str], float]) -> None:
        reach = 0.5 * parameter(f"{self.heald}.stroke") * parameter(f"{self.heald}.warp_ratio")
        if self.clearance <= 0.0 or self.clearance >= reach:
            raise LoomfmuError(
                f"claim 'clear_shed' of {self.heald}: clearance = {1e3 * self.clearance:.7g} mm is outside"
                f" (0, {1e3 * reach:.7g}) mm, how far the warp moves to either side"
            )

    def judge(self, trace: Signals) -> Verdict:
        self.check(trace.parameter)
        return self._judge(trace, f"warp beyond {1e3 * self.clearance:g} mm", "warp_height")


class DwellContains(_Lifted):
    """At these shaft angles of every revolution the frame is within a share of its stroke from an end."""

    angles: Sequence[float] = argument(Angles("rad", "deg"))
    tolerance: float = argument(SHARE, TOLERANCE)

    needs = ("heald.lift",)
    sense, unit, grid = AT_MOST, PERCENT, LANDINGS

    def judge(self, trace: Signals) -> Verdict:
        signals = lifts(self.heald, self.lifted_by, trace)
        motions = [motion_of(trace, signal) for signal in signals]
        times, notes = self.landings(trace).times, [motions[0].note]
        worst, time = math.nan, math.nan
        if times:
            (worst, time), *others = [self._farthest(trace, lift, times) for lift in motions]
            notes += [f"its frame: {100 * away:.7g} %" for away, _time in others]
        text = f"dwell at {angles_text(self.angles)}"
        return self.verdict(trace, text, signals[0], self.tolerance, worst, time, *notes)

    def _farthest(self, trace: Signals, lift: Motion, times: list[float]) -> tuple[float, float]:
        """The largest distance from an end, as a share of the stroke, and its time."""
        stroke = trace.parameter(f"{self.heald}.stroke")
        there = [lift.at(time) for time in times]
        lowest, time = first_lowest([-min(abs(each), abs(stroke - each)) / stroke for each in there], times)
        return -lowest, time

    def unseen(self, trace: Signals) -> str:
        missing = [angle for angle in self.angles if not shaft.times_at(trace, angle)]
        return f"the run never reaches {angles_text(missing)}" if missing else ""

    def landings(self, trace: Signals) -> Landings:
        return Landings([time for angle in self.angles for time in shaft.times_at(trace, angle)], [])


def _ends(lift: Motion, distance: float, stroke: float, both_ways: bool) -> Ends:
    """Times from entering to leaving a distance from the lower end, and from the upper one.

    A frame that holds stays within: its span is as long as the picks it holds for.
    """
    lower, upper = lift.beyond(distance, -1.0), lift.beyond(stroke - distance, 1.0)
    if both_ways:
        lower = _common(lower, lift.beyond(-distance, 1.0), lift.time)
        upper = _common(upper, lift.beyond(stroke + distance, -1.0), lift.time)
    return lower, upper


def _common(some: list[Stretch], others: list[Stretch], time: Floats) -> list[Stretch]:
    """Return the intersections of two lists of stretches."""
    pairs = ((max(one.start, two.start), min(one.end, two.end)) for one in some for two in others)
    return [Stretch(low, high, low > time[0] and high < time[-1]) for low, high in pairs if low < high]


def _cut_off(
    spans: list[Stretch], turned: list[float], limit: float, time: Floats
) -> tuple[list[tuple[float, float]], str]:
    """Return lengths and starts of the spans that the ends of the run cut off, as far as known, and a note.

    Such a span lasts at least as long as the run shows.
    """
    if not spans:
        return [], "the frame never gets there in this run"
    if len(spans) == 1 and (spans[0].start, spans[0].end) == (time[0], time[-1]):
        if turned[0] < limit:
            return [], "the frame stays there all the time, but the run is too short to tell"
        return [(turned[0], spans[0].start)], "the frame stays there throughout the run"
    enough = [(turn, span.start) for turn, span in zip(turned, spans, strict=True) if turn >= limit]
    if len(enough) == len(spans):
        return enough, "cut off by an end of the run: it lasts at least this long"
    if enough:
        return enough, CUT_OFF
    return [], "none begins and ends within the run"
