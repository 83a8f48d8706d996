"""Claims on heald frames: how long they dwell and leave the shed clear, by the angle that the shaft turns."""

import math
from collections.abc import Callable, Sequence

import numpy as np

from ...errors import LoomfmuError
from ...traces import Signals, Verdict
from . import shaft
from .arguments import TURN, Angles, Name, Quantity, angles_text, argument
from .claim import ANGLE, AT_MOST, LANDINGS, PERCENT, Claim, Landings
from .curves import Floats, Motion, Stretch, first_lowest, motion_of

TOLERANCE = 0.015  # of the stroke: within it a frame dwells, unless the claim says otherwise
SHARE = Quantity("1", between=(0.0, 0.5), of="the stroke")


class _Span(Claim, kind=False):
    """Whenever a frame is within a distance from an end of its stroke, it stays there for a shaft angle.

    Spans that begin and end within the run are judged, and those that an end of the run cuts off if what the
    run shows of them is long enough.
    """

    heald: str = argument(Name())
    at_least: float = argument(Quantity("rad", "deg", usual=1.5, low=0.0))

    unit, grid = ANGLE, LANDINGS

    def _distance(self, trace: Signals) -> float:
        """How near to an end of its stroke the frame is to be [m]."""
        raise NotImplementedError

    def _judge(self, trace: Signals, text: str, signal: str) -> Verdict:
        lift, turning = motion_of(trace, f"{self.heald}.lift"), shaft.needed_angle(trace)
        stroke = trace.parameter(f"{self.heald}.stroke")
        spans = _spans(lift, self._distance(trace), stroke)
        turned = [abs(turning.at(span.end) - turning.at(span.start)) for span in spans]
        judged = [(turn, span.start) for turn, span in zip(turned, spans, strict=True) if span.whole]
        note = ""
        if not judged:
            judged, note = _cut_off(spans, turned, self.at_least, _repeats(lift, stroke, turning), lift.time)
        worst, time = math.nan, math.nan
        if judged:
            worst, time = first_lowest([turn for turn, _ in judged], [start for _, start in judged])
        return self.verdict(trace, text, signal, self.at_least, worst, time, note, lift.note)

    def landings(self, trace: Signals) -> Landings:
        lift, distance = motion_of(trace, f"{self.heald}.lift"), self._distance(trace)
        stroke = trace.parameter(f"{self.heald}.stroke")
        return Landings(lift.crossings(distance) + lift.crossings(stroke - distance), [])


class Dwell(_Span):
    """Every dwell of a frame, within a share of its stroke from an end, lasts a shaft angle."""

    tolerance: float = argument(SHARE, TOLERANCE)

    needs = ("heald.lift",)

    def _distance(self, trace: Signals) -> float:
        return self.tolerance * trace.parameter(f"{self.heald}.stroke")

    def judge(self, trace: Signals) -> Verdict:
        text = f"dwell within {100 * self.tolerance:g} % of the stroke"
        return self._judge(trace, text, f"{self.heald}.lift")


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
        return self._judge(trace, f"warp beyond {1e3 * self.clearance:g} mm", f"{self.heald}.warp_height")


class DwellContains(Claim):
    """At these shaft angles of every revolution the frame is within a share of its stroke from an end."""

    heald: str = argument(Name())
    angles: Sequence[float] = argument(Angles("rad", "deg"))
    tolerance: float = argument(SHARE, TOLERANCE)

    needs = ("heald.lift",)
    sense, unit, grid = AT_MOST, PERCENT, LANDINGS

    def judge(self, trace: Signals) -> Verdict:
        signal = f"{self.heald}.lift"
        stroke, lift = trace.parameter(f"{self.heald}.stroke"), motion_of(trace, signal)
        times, note = np.array(self.landings(trace).times), lift.note
        worst, time = math.nan, math.nan
        if len(times):
            lifts = np.array([lift.at(time) for time in times.tolist()])
            away = np.minimum(np.abs(lifts), np.abs(stroke - lifts)) / stroke
            lowest, time = first_lowest(-away, times)
            worst = -lowest
        else:
            note = "the run never reaches these angles"
        text = f"dwell at {angles_text(self.angles)}"
        return self.verdict(trace, text, signal, self.tolerance, worst, time, note)

    def landings(self, trace: Signals) -> Landings:
        return Landings([time for angle in self.angles for time in shaft.times_at(trace, angle)], [])


def _spans(lift: Motion, distance: float, stroke: float) -> list[Stretch]:
    """Times from entering to leaving a distance from the lower or the upper end.

    A frame that holds stays within: its span is as long as the picks it holds for.
    """
    return sorted(lift.beyond(distance, -1.0) + lift.beyond(stroke - distance, 1.0))


def _cut_off(
    spans: list[Stretch], turned: list[float], limit: float, repeats: bool, time: Floats
) -> tuple[list[tuple[float, float]], str]:
    """What can be judged of spans that the ends of the run cut off: their lengths and starts, and a note.

    Such a span lasts at least as long as the run shows. If the motion repeats, the piece at the end of the
    run goes on as the one at its start does, so both make up one span, less whole revolutions of holding.
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
    joined = math.fmod(sum(turned), TURN)
    held = joined < sum(turned)
    if len(spans) == 2 and repeats and (joined >= limit or not held):
        note = "joined from its parts at the end and the start of the run"
        return [(joined, spans[1].start)], f"{note}: it lasts at least this long" if held else note
    if enough:
        return enough, "the other one is cut off by an end of the run and not judged"
    return [], "none begins and ends within the run"


def _repeats(lift: Motion, stroke: float, turning: Motion) -> bool:
    """Whether the run is whole revolutions, and the frame ends as far from an end as it began."""
    turns = abs(float(turning.values[0][-1] - turning.values[0][0])) / TURN
    first, last = (min(abs(lift.values[0][end]), abs(stroke - lift.values[0][end])) for end in (0, -1))
    return round(turns) > 0 and abs(turns - round(turns)) < 1e-9 and abs(last - first) <= 1e-9 * stroke
