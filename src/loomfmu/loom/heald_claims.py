"""Claims on heald frames: how long they dwell and leave the shed clear, by the angle that the shaft turns.

What lifts the warp is judged: the carrier where a frame has a damper. The note says what its frame does.
"""

from collections.abc import Callable, Sequence

from ..cosim.claims.arguments import Angles, Name, Quantity, angles_text, argument
from ..cosim.claims.claim import ANGLE, AT_MOST, PERCENT, Claim
from ..cosim.claims.conditions import Always, Condition, Spans, Sum
from ..cosim.claims.judging import Question, needs_shaft
from ..cosim.claims.movers import Wired
from ..errors import LoomfmuError
from ..traces import Signals
from .lifted import check_lifted_by, dampers_of, height_of, lift_of, lifts

TOLERANCE = 0.015  # of the stroke: within it a frame dwells, unless the claim says otherwise
SHARE = Quantity("1", between=(0.0, 0.5), of="the stroke")


class _Lifted(Claim, kind=False):
    """A claim that is judged by the lift of a frame's warp: the carrier's, or with "frame" the frame's."""

    heald: str = argument(Name())
    lifted_by: str = argument(Name(), "")

    def ends(self, run: Wired, tolerance: float) -> tuple[Sum, Sum]:
        """Return what is not negative within a share of the stroke from the lower and from the upper end."""
        lift, stroke = lift_of(self.heald, self.lifted_by, run), f"{self.heald}.stroke"
        lower = Sum(((tolerance, stroke), (-1.0, lift)))
        return lower, Sum(((1.0, lift), (tolerance - 1.0, stroke)))

    def not_beyond(self, run: Wired, tolerance: float, angles: tuple[float, ...] = ()) -> tuple[Always, ...]:
        """Return the conditions that the lift passes no end of the stroke by more than a share of it."""
        lift, stroke = lift_of(self.heald, self.lifted_by, run), f"{self.heald}.stroke"
        lowest = Sum(((tolerance, stroke), (1.0, lift)))
        highest = Sum(((1.0 + tolerance, stroke), (-1.0, lift)))
        return tuple(Always((each,), angles=angles) for each in (lowest, highest))

    def signals(self, scene: Wired) -> list[str]:
        check_lifted_by(self.lifted_by, dampers_of(scene))
        return list(dict.fromkeys((lift_of(self.heald, self.lifted_by, scene), *super().signals(scene))))


class _Span(_Lifted, kind=False):
    """Whenever a frame is within a distance from an end of its stroke, it stays there for a shaft angle.

    Spans that begin and end within the run are judged, and those that an end of the run cuts off if what the
    run shows of them is long enough.
    """

    at_least: float = argument(Quantity("rad", "deg", usual=1.5, low=0.0))

    unit = ANGLE

    def asked(self, trace: Signals, rule: str, text: str, of: str, *numbers: float | str) -> Question:
        """The question by a rule; `of` is what the verdict names of a frame without a damper."""
        needs_shaft(trace)
        signals = lifts(self.heald, self.lifted_by, trace)
        form = self.form(text, signals[0] if signals[1:] else f"{self.heald}.{of}")
        return Question(rule, [form], signals, [self.at_least, f"{self.heald}.stroke", *numbers])


class Dwell(_Span):
    """Every dwell of a frame, within a share of its stroke from an end, lasts a shaft angle."""

    tolerance: float = argument(SHARE, TOLERANCE)

    needs = ("heald.lift",)

    def question(self, trace: Signals) -> Question:
        text = f"dwell within {100 * self.tolerance:g} % of the stroke"
        return self.asked(trace, "dwell", text, "lift", self.tolerance)

    def conditions(self, run: Wired) -> tuple[Condition, ...]:
        spans = Spans(self.ends(run, self.tolerance), self.at_least)
        return spans, *self.not_beyond(run, self.tolerance)


class ClearShed(_Span):
    """Every time that a frame's warp is beyond a height, either way, lasts a shaft angle."""

    clearance: float = argument(Quantity("m", "mm", usual=0.03, low=0.0))

    needs = ("heald.lift", "heald.warp_height")

    def check_parameters(self, parameter: Callable[[str], float]) -> None:
        reach = 0.5 * parameter(f"{self.heald}.stroke") * parameter(f"{self.heald}.warp_ratio")
        if self.clearance <= 0.0 or self.clearance >= reach:
            raise LoomfmuError(
                f"claim 'clear_shed' of {self.heald}: clearance = {1e3 * self.clearance:.7g} mm is outside"
                f" (0, {1e3 * reach:.7g}) mm, how far the warp moves to either side"
            )

    def question(self, trace: Signals) -> Question:
        self.check_parameters(trace.parameter)
        text, ratio = f"warp beyond {1e3 * self.clearance:g} mm", f"{self.heald}.warp_ratio"
        return self.asked(trace, "clear_shed", text, "warp_height", self.clearance, ratio)

    def conditions(self, run: Wired) -> tuple[Condition, ...]:
        height = height_of(self.heald, self.lifted_by, run)
        return (Spans(tuple(Sum(((side, height),), -self.clearance) for side in (1.0, -1.0)), self.at_least),)


class DwellContains(_Lifted):
    """At these shaft angles of every revolution the frame is within a share of its stroke from an end."""

    angles: Sequence[float] = argument(Angles("rad", "deg"))
    tolerance: float = argument(SHARE, TOLERANCE)

    needs = ("heald.lift",)
    sense, unit = AT_MOST, PERCENT

    def question(self, trace: Signals) -> Question:
        needs_shaft(trace)
        signals = lifts(self.heald, self.lifted_by, trace)
        form = self.form(f"dwell at {angles_text(self.angles)}", signals[0])
        stroke = f"{self.heald}.stroke"
        return Question("dwell_contains", [form], signals, [self.tolerance, stroke, *self.angles])

    def conditions(self, run: Wired) -> tuple[Condition, ...]:
        angles = tuple(self.angles)
        near = Always(self.ends(run, self.tolerance), angles=angles)
        return near, *self.not_beyond(run, self.tolerance, angles)
