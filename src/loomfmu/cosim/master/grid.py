"""The communication points of a run: equal steps, or points that were chosen."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..scenes.scene import Scene

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Span:
    """Some steps in a row: start, size and end of each [s], and its end in revolutions."""

    starts: Floats
    sizes: Floats
    ends: Floats
    turns: Floats

    def __len__(self) -> int:
        return len(self.starts)


@dataclass(frozen=True)
class Grid:
    """Communication points: equal steps, counted as integers so that nothing drifts, or `points` [s].

    `rate` is the number of equal steps, or of seconds of chosen points, in a revolution or whatever else the
    scene counts its inputs in. `notes` tell how points were chosen, `scouted` is the number of steps of FMUs
    that this took.
    """

    steps: int
    step_size: float
    rate: float
    points: Floats | None = None
    notes: tuple[str, ...] = ()
    scouted: int = 0

    @property
    def stop_time(self) -> float:
        """The end [s]."""
        return self.steps * self.step_size if self.points is None else float(self.points[-1])

    def span(self, first: int, count: int) -> Span:
        """A number of steps from one on."""
        if self.points is None:
            numbers = np.arange(first, first + count + 1, dtype=float)
            times = numbers * self.step_size
            sizes = np.full(count, self.step_size)
            return Span(times[:-1], sizes, times[1:], numbers[1:] / self.rate)
        times = self.points[first : first + count + 1]
        return Span(times[:-1], np.diff(times), times[1:], times[1:] / self.rate)


def uniform(scene: Scene) -> Grid:
    """Equal steps of the scene."""
    return Grid(scene.steps, scene.step_size, scene.steps_per_period)


def chosen(scene: Scene, points: Floats, notes: tuple[str, ...] = (), scouted: int = 0) -> Grid:
    """Steps from point to point [s], strictly rising from 0."""
    largest = float(np.max(np.diff(points)))
    return Grid(len(points) - 1, largest, period(scene), np.ascontiguousarray(points), notes, scouted)


def period(scene: Scene) -> float:
    """A revolution at mean speed [s], or a second in a scene that runs by seconds."""
    return scene.step_size * scene.steps_per_period
