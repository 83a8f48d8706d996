"""The communication points of a run: equal steps, or points that were chosen."""

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..scenes.scene import Scene

Floats = NDArray[np.float64]
DENSE = 1.2  # communication points for each equal step
LEFT = 1e-6  # of the range of a table: what steps that meet none of its rows may leave out
AGREE = 1e-6  # of the range of a table: how far it may be from what its rate gives
SAME = 1e-6  # of a step: what a kink may be away from a communication point


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
    scene counts its inputs in, from the `start` [s] on.
    """

    steps: int
    step_size: float
    rate: float
    points: Floats | None = None
    start: float = 0.0

    @property
    def stop_time(self) -> float:
        """The end [s]."""
        return self.start + self.steps * self.step_size if self.points is None else float(self.points[-1])

    def span(self, first: int, count: int) -> Span:
        """A number of steps from one on."""
        if self.points is None:
            numbers = np.arange(first, first + count + 1, dtype=float)
            times = self.start + numbers * self.step_size
            sizes = np.full(count, self.step_size)
            return Span(times[:-1], sizes, times[1:], numbers[1:] / self.rate)
        times = self.points[first : first + count + 1]
        return Span(times[:-1], np.diff(times), times[1:], times[1:] / self.rate)


def uniform(scene: Scene, share: float = 1.0) -> Grid:
    """Equal steps of the scene, or a share of them, divided where an input that it drives has a kink.

    Where kinks crowd the grid, a share of all points is taken instead: it would hardly be coarser.
    """
    equal = Grid(scene.steps, scene.step_size, scene.steps_per_period, start=scene.start_time)
    if share < 1.0:
        whole = uniform(scene)
        if whole.points is not None and crowded(scene, whole):
            places = np.linspace(0, whole.steps, max(1, round(share * whole.steps)) + 1)
            return grid_of_points(scene, whole.points[np.round(places).astype(int)])
        steps = max(1, round(share * scene.steps))
        longer = scene.steps / steps
        equal = replace(
            equal,
            steps=steps,
            step_size=longer * scene.step_size,
            rate=scene.steps_per_period / longer,
        )
    divided = kinks(scene) / equal.step_size
    divided = divided[np.abs(divided - np.round(divided)) > SAME]
    if not len(divided):
        return equal
    points = np.concatenate([equal.span(0, equal.steps).ends, divided * equal.step_size, [0.0]])
    return grid_of_points(scene, np.unique(points))


def crowded(scene: Scene, whole: Grid | None = None) -> bool:
    """Return whether kinks divide so many equal steps that fewer of these make a run hardly coarser."""
    return (whole or uniform(scene)).steps > DENSE * scene.steps


def kinks(scene: Scene) -> Floats:
    """Times within the run at which inputs that the scene drives have their points [s], in order.

    There are none where an FMU takes equal steps alone.
    """
    if _needs_equal_steps(scene):
        return np.empty(0)
    return _rows(scene, (turn for drive in scene.drives for turn in drive.periods))


def passed_by(scene: Scene) -> dict[str, str]:
    """The instances with inputs whose points lie between steps that must be equal, and what to do."""
    equal = _needs_equal_steps(scene)
    found = dict[str, str]()
    for drive in scene.drives if equal else ():
        places = _rows(scene, drive.periods) / scene.step_size
        # between the steps lies a line, which a slow table hardly leaves
        at = (np.floor(places), places, np.ceil(places))
        before, here, after = (drive.along(each / scene.steps_per_period).astype(float) for each in at)
        off = np.abs(here - before - (places - at[0]) * (after - before))
        if np.any(off > LEFT * np.ptp(np.array(drive.values, dtype=float))):
            rows = f"rows of inputs.{drive.instance}.{drive.variable} lie between the steps"
            found[drive.instance] = f"{rows}, which {equal} needs to be equal; take steps that meet all rows"
    return found


def contradicted(scene: Scene) -> dict[str, str]:
    """The instances with an input that its rate contradicts: it stays constant, or does so between rows.

    Between rows both lie on straight lines, which agree only where the rate is constant.
    """
    driven = {(each.instance, each.variable): each for each in scene.drives}
    wired = {wire.sink: wire.source for wire in scene.wires}
    found = _fed_apart(scene, wired, driven)
    for (name, variable), drive in driven.items():
        instance = scene.instances[name]
        rate = instance.fmu.ports[variable].rate
        if rate is None or (name, rate) in wired:
            continue
        turns = [turn for each in (drive, driven.get((name, rate))) if each for turn in each.periods]
        times = np.array([0.0, *_rows(scene, turns), scene.steps * scene.step_size])
        values, rates = drive.along(times / period(scene)), np.zeros(len(times))
        moved, places = np.diff(values), times / scene.step_size
        seen = np.ones(len(moved), bool)
        if (name, rate) in driven:
            rates = driven[name, rate].along(times / period(scene))
            seen = np.ceil(places[1:] - SAME) - np.floor(places[:-1] + SAME) > 1.0
        else:
            rates += float(instance.effect(rate) or 0.0)
        off = np.maximum(*(np.abs(moved - np.diff(times) * each) for each in (rates[:-1], rates[1:])))
        if np.any(seen & (off > AGREE * np.ptp(values))):
            wrong = f"{name}.{rate} is not the rate of inputs.{name}.{variable} between its rows"
            found.setdefault(name, f"{wrong}; give both as tables, with a row for each step")
    return found


def _fed_apart(
    scene: Scene, wired: Mapping[tuple[str, str], tuple[str, str]], driven: Collection[tuple[str, str]]
) -> dict[str, str]:
    """The instances with a wired input whose rate comes from elsewhere, or from nowhere."""
    found, fed = dict[str, str](), {*wired, *driven}
    for name, instance in scene.instances.items():
        for variable, its_rate in instance.fmu.rated_inputs:
            if instance.switched_off(variable)[0]:
                continue
            here, there = (name, variable), (name, its_rate)
            value, rate = ".".join(here), ".".join(there)
            if here in wired and there not in wired:
                how = "a table" if there in driven else "constant"
                found.setdefault(name, f"{rate} is {how}, but {value} is wired; wire both")
            elif here in wired and not _is_rate(scene, wired[there], wired[here]):
                of, source = ".".join(wired[here]), ".".join(wired[there])
                wrong = f"{rate} is wired to {source}, which is not the rate of {of}"
                one = wired[here][0] == wired[there][0]
                cure = (
                    f'declare {of} with rate="{wired[there][1]}" if it is' if one else "wire both to one FMU"
                )
                found.setdefault(name, f"{wrong}; {cure}")
            elif variable in instance.fmu.shaft_inputs[:1] and not {here, there} & fed:
                found.setdefault(name, f"{name} follows a shaft, but nothing feeds {value}")
            elif there in wired and here in driven:
                found.setdefault(name, f"{rate} is wired, but {value} a table; give both")
    return found


def _is_rate(scene: Scene, rate: tuple[str, str], source: tuple[str, str]) -> bool:
    """Return whether an output is the rate of another one; FMUs of others need not say so."""
    if rate[0] != source[0] or source[0] not in scene.instances:
        return rate[0] == source[0]
    fmu = scene.instances[source[0]].fmu
    return rate[1] == fmu.ports[source[1]].rate or (
        fmu.component is None and fmu.ports[source[1]].rate is None
    )


def _needs_equal_steps(scene: Scene) -> str:
    """The first instance whose FMU takes equal steps alone; empty where none does."""
    return next((name for name, instance in scene.instances.items() if instance.fmu.fixed_step), "")


def _rows(scene: Scene, turns: Iterable[float]) -> Floats:
    """Times within the run of points of inputs [s], in order."""
    times = np.array(sorted(set(turns))) * period(scene)
    return times[(times > 0.0) & (times < scene.steps * scene.step_size)]


def grid_of_points(scene: Scene, points: Floats) -> Grid:
    """Steps from point to point [s], strictly rising from 0."""
    largest = float(np.max(np.diff(points)))
    return Grid(len(points) - 1, largest, period(scene), np.ascontiguousarray(points))


def period(scene: Scene) -> float:
    """A revolution at mean speed [s], or a second in a scene that runs by seconds."""
    return scene.step_size * scene.steps_per_period
