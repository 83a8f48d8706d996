"""The window grid: communication steps that land where the claims look, and coarse steps elsewhere.

A coarse run of what the claims need finds roughly where they look: the edges of the belt's window of risk and
its lowest point, the edges of a dwell, the angles that a claim names. A second one, with more points in the
windows of risk, finds it so well that steps can land on it. At a sample there is no error of interpolation,
and near one it is small, so a few such steps replace many equal ones.

This works for what depends on the present alone. What integrates over its inputs keeps the error of every
step, so it gets the scene's own steps and the landings.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from ...declaring.variables import MOTION
from ...errors import LoomfmuError
from ...traces import Recording
from ..claims.claim import EVERY_STEP, LANDINGS, Claim
from ..claims.movers import movers_of
from ..master.grid import Grid, grid_of_points, kinks, period, uniform
from ..scenes.graph import step_order
from ..scenes.scene import Scene
from .plan import InMemory
from .pruning import prune
from .requested import Movements, Requested

Floats = NDArray[np.float64]
Scout = Callable[[Scene, Sequence[str], Grid], InMemory]

SCOUTS = 2  # runs that look for the windows: the second one sees the lowest points
MOST_STEPS = 10_000_000  # that are kept in memory, with the watched signals
INSIDE = 6  # points within a window of risk, for the second scout
REACH = 0.125  # of the steps by which a lowest point was found: it is known better than that
DEEP = 0.2  # of a signal's range above its lowest sample: a minimum there may be the lowest
RIPPLE = 1e-6  # of a signal's range: what samples about a minimum that is one differ by
APART = 1.0 / 7200.0  # of a revolution: points closer than that are one
NARROW = 0.2  # of an equal step, where that is less: equal steps stay, but for those next to a landing


@dataclass
class Places:
    """Places of steps: kinks and points to land on [s], points around them, the longest step allowed."""

    period: float
    most: float
    kinks: Floats
    points: list[float] = field(default_factory=list)
    about: list[float] = field(default_factory=list)

    def bracket(self, time: float, reach: float) -> None:
        """Land on a point that is known to within a reach, and on both sides of it."""
        if any(abs(time - point) < 0.5 * reach for point in self.points):
            return  # two claims look for the same
        self.points.append(time)
        self.about += [time - reach, time + reach]


def window_grid(requested: Requested, scene: Scene, signals: Sequence[str], in_memory: Scout) -> Grid:
    """The communication points of a scene whose `grid` is "windows" and that keeps these signals.

    It differs in values alone from the scene of which `requested` says what is asked. `in_memory` runs a
    scene on a grid and keeps some signals in memory.

    Raises:
        LoomfmuError: the scene has no shaft or no claims, or an FMU takes only equal steps
    """
    _check(scene)
    fine = period(scene) / scene.steps_per_period
    needed = prune(scene, signals).scene
    coarse, why = min(_showing(scene, Movements(requested)))
    unequal = _unequal(needed)
    if unequal:
        return replace(
            uniform(scene), notes=(f'steps: all equal, as with grid = "uniform", because {unequal}',)
        )
    longest = coarse
    for name, instance in needed.instances.items():
        if instance.fmu.keeps == MOTION and longest > fine:
            longest, why = fine, f"{name} integrates"
    places, scouted = _scouted(requested, scene, signals, coarse, longest, in_memory)
    points = _merged(_equal(scene, places.most), places)
    because = f" ({why})" if why else ""
    notes = (
        f"steps: {period(scene) / places.most:.0f} per revolution{because}, plus steps that land"
        f" where the claims look; it took {scouted} FMU steps to find these",
    )
    return grid_of_points(scene, points, notes, scouted)


def _scouted(
    requested: Requested,
    scene: Scene,
    signals: Sequence[str],
    coarse: float,
    longest: float,
    in_memory: Scout,
) -> tuple[Places, int]:
    """Return the places that the claims look at, found on coarse steps, and the FMU steps that this took."""
    places, scouted = Places(period(scene), longest, kinks(scene)), 0
    for _ in range(SCOUTS):
        points = _merged(_equal(scene, coarse), places)
        recording, plan, steps, _early, _warnings = in_memory(
            scene, _watched(requested, signals), grid_of_points(scene, points)
        )
        scouted += len(plan.pruned.scene.instances) * steps
        places = Places(period(scene), longest, places.kinks)
        for claim in requested.claims:
            _land(places, recording, scene, claim)
        for output in _latched(scene, signals):
            _extremes(places, recording, scene, output)
    return places, scouted


def _unequal(needed: Scene) -> str:
    """Return why a run needs equal steps (a loop, a loaded shaft, a third-party FMU), or an empty text."""
    _order, lagged = step_order(needed.instances, needed.wires)
    if lagged:
        return f"{lagged[0]} closes a loop"
    for name, instance in needed.instances.items():
        component = instance.fmu.component
        if component is None:
            return f"{name} is a third-party FMU, whose results may depend on the steps"
        if component.keeps == MOTION and instance.fmu.facts and instance.fmu.facts.turns_others:
            return f"{name} integrates"
    return ""


def _showing(scene: Scene, movements: Movements) -> Iterator[tuple[float, str]]:
    """The longest steps that show how mechanisms move and how the shaft's speed changes, and why."""
    fine = period(scene) / scene.steps_per_period
    yield period(scene) / scene.coarse_steps_per_revolution, ""
    for name in scene.instances:
        longest, why = movements.longest_step(scene, name)
        yield longest or fine, why


def _check(scene: Scene) -> None:
    where = 'grid = "windows"'
    if not scene.claims:
        raise LoomfmuError(f"{where}: the scene has no claims, so there is nothing to look for")
    if "shaft" not in scene.instances:
        raise LoomfmuError(f"{where}: the scene has no shaft; its windows are in shaft angle")
    if scene.coarse_steps_per_revolution > scene.steps_per_period:
        raise LoomfmuError(
            f"coarse_steps_per_revolution = {scene.coarse_steps_per_revolution} is outside"
            f" [1, {scene.steps_per_period}], its steps_per_revolution"
        )
    for name, instance in scene.instances.items():
        if instance.fmu.fixed_step:
            raise LoomfmuError(
                f"{where}: {name} takes only equal steps ({instance.fmu.name} has"
                " canHandleVariableCommunicationStepSize = false)"
            )


def _equal(scene: Scene, longest: float) -> Floats:
    """The points of equal steps that are no longer than that."""
    end = uniform(scene).stop_time
    steps = max(1, math.ceil(end / longest - 1e-9))
    if steps > MOST_STEPS:
        raise LoomfmuError(
            f'grid = "windows": {steps} steps are more than the {MOST_STEPS} that fit into memory;'
            ' set grid = "uniform" or fewer revolutions'
        )
    return np.linspace(0.0, end, steps + 1)


def _extremes_of(scene: Scene, instance: str) -> dict[str, tuple[str, float]]:
    facts = scene.instances[instance].fmu.facts
    return facts.extremes if facts else {}


def _latched(scene: Scene, signals: Iterable[str]) -> list[str]:
    """Those of some signals that hold an extreme so far."""
    parts = [signal.split(".") for signal in signals]
    held = [(name, variable, _extremes_of(scene, name).get(variable)) for name, variable in parts]
    return [f"{name}.{variable}" for name, variable, extreme in held if extreme and extreme[0] != variable]


def _watched(requested: Requested, kept: Sequence[str]) -> list[str]:
    """The signals that show where the claims look, and where the extremes held by the kept signals occur."""
    scene, wanted, owners = requested.scene, requested.angle, list[str]()
    for claim in requested.claims:
        signals = claim.signals(requested)
        wanted += signals if claim.grid == LANDINGS else []
        owners += [signal.split(".")[0] for signal in signals]
    owners += [signal.split(".")[0] for signal in _latched(scene, kept)]
    for owner in dict.fromkeys(owners):
        followed = dict.fromkeys(name for name, _sign in _extremes_of(scene, owner).values())
        component = scene.instances[owner].fmu.component
        windows = component.windows if component and followed else ()
        wanted += [f"{owner}.{name}" for name in (*windows, *followed)]
    wanted += [mover.angle for mover in movers_of(owners, requested) if mover.angle]
    return requested.with_rates(wanted)


def _merged(equal: Floats, places: Places) -> Floats:
    """All points in order. Of two that are too close, the one that a claim looks for stays."""
    apart = min(APART * places.period, NARROW * float(equal[1] - equal[0]))
    kept = np.empty(0)
    for points in (
        equal[[0, -1]],
        places.kinks,
        _thinned(places.points, apart),
        _thinned(places.about, apart),
        equal,
    ):
        points = points[(points >= equal[0]) & (points <= equal[-1])]
        if len(kept):
            after = np.clip(np.searchsorted(kept, points), 1, len(kept) - 1)
            away = np.minimum(np.abs(points - kept[after - 1]), np.abs(kept[after] - points))
            points = points[away > apart]
        kept = np.sort(np.concatenate([kept, points]))
    return kept


def _thinned(points: Sequence[float], apart: float) -> Floats:
    """Points in order, without those that are too close to the one before them that stays."""
    kept: list[float] = []
    for point in sorted(points):
        if not kept or point - kept[-1] > apart:
            kept.append(point)
    return np.array(kept)


# ---- where steps land


def _land(places: Places, trace: Recording, scene: Scene, claim: Claim) -> None:
    """Steps where a claim looks: landings, or all of the scene's own."""
    landings = claim.landings(trace)
    places.points += landings.times
    everywhere = claim.grid == EVERY_STEP
    for signal, sign in landings.extremes:
        instance, _, variable = signal.partition(".")
        if variable in _extremes_of(scene, instance):
            _extremes(places, trace, scene, signal)
        elif trace.rate(signal) is None:  # it is judged at the samples
            everywhere = True
        else:
            _minima(places, trace, signal, sign)
    if everywhere:
        places.most = min(places.most, period(scene) / scene.steps_per_period)


def _extremes(places: Places, trace: Recording, scene: Scene, signal: str) -> None:
    """Land on the edges of each window and the extreme within; until samples show it, on points around it."""
    instance, _, variable = signal.partition(".")
    followed, sign = _extremes_of(scene, instance)[variable]
    facts = scene.instances[instance].fmu.facts
    if facts is None or not facts.component.windows:
        _minima(places, trace, f"{instance}.{followed}", sign, lowest_alone=True)
        return
    for low, high in _windows(trace, scene, instance):
        places.points += [low, high]
        inside = np.flatnonzero((trace.time > low) & (trace.time < high))
        if len(inside) < INSIDE:
            places.about += list(np.linspace(low, high, INSIDE + 2)[1:-1])
            continue
        seen = slice(inside[0], inside[-1] + 1)
        spacing = (high - low) / (INSIDE + 1)
        values = sign * trace[f"{instance}.{followed}"][seen]
        if facts.variables[followed].pole:
            # what it stands for, a load, has none
            values = -(values**-2.0)
        for time in _lowest_points(trace.time[seen], values):
            places.bracket(time, REACH * spacing)


def _windows(trace: Recording, scene: Scene, instance: str) -> list[tuple[float, float]]:
    """Return the stretches in which all outputs that bound an instance's windows are positive, on splines."""
    from scipy.interpolate import CubicSpline

    component = scene.instances[instance].fmu.component
    names = component.windows if component else ()
    bounding = [CubicSpline(trace.time, trace[f"{instance}.{name}"]) for name in names]
    roots = [root for each in bounding for root in each.roots(extrapolate=False)]
    edges = np.unique([*trace.time[[0, -1]], *roots])
    middles = 0.5 * (edges[1:] + edges[:-1])
    within = np.all([np.ones(len(middles), dtype=bool), *(each(middles) > 0.0 for each in bounding)], axis=0)
    return [(float(edges[place]), float(edges[place + 1])) for place in np.flatnonzero(within)]


def _lowest_points(time: Floats, values: Floats) -> list[float]:
    """Times of the local minima inside, on the spline through the samples."""
    from scipy.interpolate import CubicSpline

    curve = CubicSpline(time, values)
    turns = curve.derivative().roots(extrapolate=False)
    return [float(turn) for turn in turns[curve(turns, 2) > 0.0]]


def _minima(
    places: Places, trace: Recording, signal: str, sign: float, *, lowest_alone: bool = False
) -> None:
    """Land on the minima of `sign` times a signal, each known to a share of the samples' distance there.

    With `lowest_alone` on those that may be its lowest, and are no ripple of a rounding.
    """
    values = sign * np.asarray(trace[signal], dtype=float)
    lowest, reach = float(values.min()), float(np.ptp(values))
    for time in _lowest_points(trace.time, values):
        place = int(np.clip(np.searchsorted(trace.time, time), 1, len(trace.time) - 1))
        here, about = values[place - 1 : place + 1], values[max(place - 2, 0) : place + 2]
        may_be_lowest = here.min() <= lowest + DEEP * reach and np.ptp(about) > RIPPLE * reach
        if may_be_lowest or not lowest_alone:
            places.bracket(time, REACH * float(trace.time[place] - trace.time[place - 1]))
