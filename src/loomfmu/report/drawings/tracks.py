"""What moves, as keyframes: few enough for a page, and the same frames only once."""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..section import TURN, Subject

A_TURN = 361  # keyframes over a revolution: one a degree
A_RUN = 1801  # keyframes over a run without a shaft
MOST = 500  # revolutions that are drawn
BUDGET = 60_000  # numbers in all: about 200 kB
LARGEST = 1e9  # steps, so that differences fit: 10 km in steps of 0.01 mm
EQUAL = 2  # steps by which two frames may differ and still be one

Frames = NDArray[np.int32]  # a row for each window, or one for all


@dataclass(frozen=True)
class Track:
    """Keyframes in steps of some unit."""

    frames: Frames
    step: float


@dataclass(frozen=True)
class Tracks:
    """Named values that move with the cursor, in windows of one revolution; without a shaft, of the run.

    `still` is the position of the drawings where nothing moves them.
    """

    subject: Subject
    still: float
    made: dict[str, Track] = field(default_factory=dict)

    @cached_property
    def span(self) -> float:
        """Length of a window: rad, or s without a shaft."""
        positions = self.subject.positions
        return TURN if self.subject.turns else max(float(positions[-1] - positions[0]), 1e-300)

    @cached_property
    def starts(self) -> NDArray[np.float64]:
        """Where the windows start."""
        first, last = (float(self.subject.positions[place]) for place in (0, -1))
        if not self.subject.turns:
            return np.array([first])
        low = np.floor(first / TURN + 1e-9)
        count = max(np.ceil(last / TURN - 1e-9) - low, 1.0)
        return np.asarray(TURN * (low + np.arange(min(count, MOST))))

    @cached_property
    def shares(self) -> NDArray[np.float64]:
        """Places of the keyframes in a window, as 0 to 1."""
        return np.linspace(0.0, 1.0, A_TURN if self.subject.turns else A_RUN)

    @cached_property
    def now(self) -> int:
        """The window of the still position."""
        return max(int(np.searchsorted(self.starts, self.still, side="right")) - 1, 0)

    def add(self, name: str, values: Any, step: float = 0.01, finer: int = 1) -> str:
        """Let a name move as values of the samples, rounded to a step; returns the name.

        `finer` is the number of keyframes for each usual one, for what moves at a jump.
        """
        shares = np.linspace(0.0, 1.0, finer * (len(self.shares) - 1) + 1)
        places = self.starts[:, None] + self.span * shares
        return self._keep(name, np.interp(places, self.subject.positions, values), step)

    def cycle(self, name: str, values: Any, step: float = 0.01) -> str:
        """Let a name move as values of the keyframes, the same in each window; returns the name."""
        return self._keep(name, np.asarray(values)[None, :], step)

    def _keep(self, name: str, values: NDArray[np.float64], step: float) -> str:
        steps = np.clip(np.nan_to_num(np.round(values / step)), -LARGEST, LARGEST)
        self.made[name] = Track(steps.astype(np.int32), step)
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

    def data(self) -> dict[str, Any]:
        """All frames for the page, each as differences; `shown` has the frame of each window.

        Windows are taken in their order, that of the still position first, until the budget is spent: those
        after that have no frame.
        """
        kept: dict[str, list[Frames]] = {name: [] for name in self.made}
        shown: list[dict[str, int]] = [{} for _ in self.starts]
        for window in sorted(range(len(shown)), key=lambda each: each != self.now):
            if sum(frame.size for frames in kept.values() for frame in frames) > BUDGET:
                break
            for name, track in self.made.items():
                frame = track.frames[min(window, len(track.frames) - 1)]
                shown[window][name] = _place(kept[name], frame)
        return {
            "first": float(self.starts[0]),
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
    """Where a frame is among known ones, to which it is added unless it is there."""
    for place, other in enumerate(known):
        if int(np.max(np.abs(frame - other))) <= EQUAL:
            return place
    known.append(frame)
    return len(known) - 1
