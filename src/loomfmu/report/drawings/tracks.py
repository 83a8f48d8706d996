"""Moving parts as rules and as keyframes, few enough for a page and equal frames only once."""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...traces import Trace
from ...traces.excerpt import Excerpt
from ..rules import Rule, evaluated, mm
from ..section import TURN, Subject

A_TURN = 361  # keyframes over a revolution: one a degree
A_RUN = 1801  # keyframes over a run without a shaft
FINEST = 4  # keyframes for each usual one, at most
MOST = 500  # revolutions that are drawn
SAMPLES = 100_000  # of a signal in memory; of a longer run, the first 30 revolutions or so are drawn
BUDGET = 120_000  # numbers in all: about 400 kB
LARGEST = 1e9  # steps, so that differences fit: 10 km in steps of 0.01 mm
EQUAL = 2  # steps by which two frames may differ and still be one

Frames = NDArray[np.int32]  # a row for each window, or one for all


@dataclass(frozen=True)
class Track:
    """Keyframes in steps of some unit, and the rule they follow; None if the angle alone counts."""

    frames: Frames
    step: float
    rule: Rule | None = None


@dataclass(frozen=True)
class Tracks:
    """Named values that move with the cursor, in windows of one revolution; without a shaft, of the run.

    `still` is the position of the drawings where nothing moves them. `fixed` collects the parameters on which
    shapes and places depend that no track moves.
    """

    subject: Subject
    still: float
    made: dict[str, Track] = field(default_factory=dict)
    fixed: set[str] = field(default_factory=set)

    @cached_property
    def span(self) -> float:
        """Length of a window: rad, or s without a shaft."""
        positions = self.subject.positions
        return TURN if self.subject.turns else max(float(positions[-1] - positions[0]), 1e-300)

    @cached_property
    def trace(self) -> Trace:
        """The trace; of a long one, the samples beside the keyframes."""
        whole = self.subject.trace
        if whole.rows <= SAMPLES:
            return whole
        after = np.searchsorted(self.subject.positions, self._places(FINEST).ravel())
        return Excerpt(whole, np.unique(np.clip([after - 1, after], 0, whole.rows - 1)))

    @cached_property
    def numbers(self) -> NDArray[np.int64]:
        """The windows that are drawn, counted from 0: those at the start, and that of the still position."""
        last, low = float(self.subject.positions[-1]) / self.span, self._first / self.span
        count = max(int(np.ceil(last - low - 1e-9)), 1)
        most = MOST if self.subject.trace.rows <= SAMPLES else SAMPLES // (2 * FINEST * len(self.shares))
        now = min(max(int(self.still / self.span - low), 0), count - 1)
        return np.unique([*range(min(count, max(most, 1))), now])

    @cached_property
    def _first(self) -> float:
        """The start of the first window."""
        first = float(self.subject.positions[0])
        return TURN * float(np.floor(first / TURN + 1e-9)) if self.subject.turns else first

    @cached_property
    def starts(self) -> NDArray[np.float64]:
        """The starts of the windows that are drawn."""
        return np.asarray(self._first + self.span * self.numbers)

    @cached_property
    def shares(self) -> NDArray[np.float64]:
        """Places of the keyframes in a window, as 0 to 1."""
        return np.linspace(0.0, 1.0, A_TURN if self.subject.turns else A_RUN)

    @cached_property
    def now(self) -> int:
        """The window of the still position."""
        return max(int(np.searchsorted(self.starts, self.still, side="right")) - 1, 0)

    def parameter(self, name: str) -> float:
        """A parameter of the run, which what stands still depends on."""
        self.fixed.add(name)
        return self.trace.parameter(name)

    def values(self, rule: Rule) -> Any:
        """Return the values of a rule at the samples, or a number; it names tracks, signals, parameters."""
        trace = self.trace

        def of(name: str) -> Any:
            if name in self.made:
                return self.values(self.made[name].rule or 0.0)
            return trace[name] if name in trace else trace.parameter(name)

        return evaluated(rule, of)

    def add(self, name: str, rule: Rule, step: float = 0.01, finer: int = 1) -> str:
        """Let a name move by a rule, rounded to a step; returns the name.

        `finer` is the number of keyframes for each usual one, for what moves at a jump.
        """
        along = self.subject.along(self.trace)
        values = np.broadcast_to(self.values(rule), along.shape)
        return self._keep(name, np.interp(self._places(finer), along, values), step, rule)

    def _places(self, finer: int) -> NDArray[np.float64]:
        """Positions of the keyframes, a row for each window."""
        shares = np.linspace(0.0, 1.0, finer * (len(self.shares) - 1) + 1)
        return np.asarray(self.starts[:, None] + self.span * shares)

    def mm(self, signal: str, finer: int = 1) -> str:
        """Let a length move, in mm; returns the name."""
        return self.add(f"{signal}_mm", mm(signal), finer=finer)

    def cycle(self, name: str, values: Any) -> str:
        """Let a name move as values of the keyframes, the same in each window; returns the name."""
        return self._keep(name, np.asarray(values)[None, :], 0.01)

    def point(self, name: str, places: NDArray[np.float64]) -> tuple[str, str]:
        """Let a point move as places of the keyframes, the same in each window; returns its names."""
        return self.cycle(f"{name}.x", places[:, 0]), self.cycle(f"{name}.y", places[:, 1])

    def _keep(self, name: str, values: NDArray[np.float64], step: float, rule: Rule | None = None) -> str:
        steps = np.clip(np.nan_to_num(np.round(values / step)), -LARGEST, LARGEST)
        self.made[name] = Track(steps.astype(np.int32), step, rule)
        return name

    def at(self, what: float | str) -> float:
        """A number, or the value of a name at the still position."""
        if not isinstance(what, str):
            return what
        track = self.made[what]
        frame = track.frames[min(self.now, len(track.frames) - 1)]
        share = (self.still - self.starts[self.now]) / self.span
        shares = np.linspace(0.0, 1.0, len(frame))
        return float(track.step * np.interp(share, shares, frame))

    def rules(self) -> dict[str, Any]:
        """Return the data of a page that runs the scene itself: rules, and one revolution of other tracks."""
        return {
            "first": 0.0,
            "span": self.span,
            "fixed": sorted(self.fixed),
            "tracks": {
                name: {"rule": track.rule}
                if track.rule is not None
                else {"step": track.step, "frames": [np.diff(track.frames[0], prepend=0)], "shown": [0]}
                for name, track in self.made.items()
            },
        }

    def data(self) -> dict[str, Any]:
        """All frames for the page, each as differences; `shown` has the frame of each window.

        Windows are taken in their order, that of the still position first, until the budget is spent: those
        after that have no frame.
        """
        kept: dict[str, list[Frames]] = {name: [] for name in self.made}
        shown: list[dict[str, int]] = [{} for _ in range(self.numbers[-1] + 1)]
        for window in sorted(range(len(self.numbers)), key=lambda each: each != self.now):
            if sum(frame.size for frames in kept.values() for frame in frames) > BUDGET:
                break
            for name, track in self.made.items():
                frame = track.frames[min(window, len(track.frames) - 1)]
                shown[self.numbers[window]][name] = _place(kept[name], frame)
        return {
            "first": self._first,
            "span": self.span,
            "tracks": {
                name: {
                    "step": track.step,
                    "frames": [np.diff(frame, prepend=0) for frame in kept[name]],
                    "shown": [each.get(name) for each in shown],
                }
                for name, track in self.made.items()
            },
        }


def _place(known: list[Frames], frame: Frames) -> int:
    """Return the place of a frame among known ones, after adding it if it is new."""
    for place, other in enumerate(known):
        if int(np.max(np.abs(frame - other))) <= EQUAL:
            return place
    known.append(frame)
    return len(known) - 1
