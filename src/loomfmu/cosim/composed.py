"""Claims on what follows from the time alone: judged on the mechanisms' own functions, not between samples.

Mechanisms without a memory, in turn, are one function of the time. Dual numbers give its value and its slope
at any time, and these a cubic from one time to the next, with what it may be off by. Where a claim's worst
value may lie, the step is divided until that is rounding. What is left is the error of the verdict.
"""

import ctypes
from collections.abc import Collection, Iterable, Mapping, Sequence
from functools import cache, cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..components import COMPONENTS
from ..declaring.upstream import sources_of, upstream
from ..declaring.variables import AT_STEP_END, MOTION, NOTHING
from ..errors import LoomfmuError
from ..fmi.native.libraries import needed_library
from ..traces import Recording, Signals, Verdict
from ..traces.extended import RATE, Resampled
from .claims.arguments import TURN, Window
from .claims.claim import Claim
from .claims.conditions import remembers
from .claims.judging import run_of
from .composition import Composition, Rule
from .estimates import MOST_VALUES, undecided
from .master.grid import grid_of_points, period
from .master.steppers import SOURCE
from .planning.requested import SHAFT_ANGLE, Movements, Requested, output_port
from .scenes.graph import step_order
from .scenes.scene import Scene
from .tangents import Tangents

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

FEWEST = 2  # steps, which show a slope of rates
SHOWN = 180.0  # steps in a revolution, which show where extremes may lie
MOST = 200_000  # times: only what is rounding everywhere, such as a sum that is always 0, asks for more
PARTS, ROUNDS = 32, 8  # of a step that is divided, and how often: 1e12 parts
NARROW = 1e-12  # of the run: steps that are divided no more, which may hold a jump
EXACT, ROUNDED = 1e-11, 1e-13  # of the worst and of the largest value: what a cubic, and rounding, may leave
DOUBT = 0.25  # of the difference between second rates over a step, see `doubt` in curves.h
EDGE = 1e-12  # rad: what rounding leaves of an edge of a window
NEWTON = 4  # steps to the time at which a window begins or ends
SHARE = 1e-12  # of value or bound: what rounding leaves


class Composed:
    """The claims of a scene that are judged so; `judged` judges them on a run."""

    def __init__(self, requested: Requested, claims: Sequence[Claim]):
        self._scene, self._requested = requested.scene, requested
        self.claims = {number: each for number, each in enumerate(claims) if self._follows(each)}
        wanted = requested.needed(self.claims.values(), ()) if self.claims else ()
        self._latches = {name: found for name in wanted if (found := self._held(name))}
        bases = [base for base, _sign in self._latches.values()]
        owners = {name.partition(".")[0] for name in wanted}
        self._needed = upstream(owners, self._sources)
        shown = [each for base in bases for each in self._windows(base)]
        self._signals = [
            name
            for name in dict.fromkeys([*wanted, *bases, *shown])
            if name not in self._latches and self._is_smooth(name)
        ]
        try:
            self._tangents = Tangents(self._scene, self._signals) if self.claims else None
        except LoomfmuError:  # without native FMUs
            self.claims = {}

    @property
    def unrated(self) -> set[str]:
        """The signals of these claims of which nothing else tells between samples."""
        names = {name for claim in self.claims.values() for name in claim.signals(self._requested)}
        ports = {name: output_port(self._scene, name, "claim") for name in names}
        return {name for name, port in ports.items() if not (port.rate or any(port.beside))}

    @property
    def needed(self) -> Collection[str]:
        """The instances on which these claims depend."""
        return self._needed

    @property
    def plain(self) -> bool:
        """Return whether all are on signals themselves over the whole run, as C judges them in rows."""
        alike = all(
            type(each).motions is Claim.motions and _window(each) is None for each in self.claims.values()
        )
        return alike and not (self._tangents and self._tangents.driven)

    def composition(self, scene: Scene, run: Recording, room: int) -> Composition:
        """Return what C takes to judge them on rows with so many samples, as `judged` does."""
        assert self._tangents is not None
        windows = {base: self._windows(base) for base, _sign in self._latches.values()}
        rule = Rule(PARTS, ROUNDS, DOUBT, NARROW, EXACT, ROUNDED, SHARE)
        return Composition(
            self.claims, self._tangents, self._signals, self._latches, windows, rule, scene, run, room
        )

    # ---- what follows from the time

    def _follows(self, claim: Claim) -> bool:
        """Return whether all that a claim judges follows from the time, by mechanisms of the package."""
        scene, extremes = self._scene, [name for name, _sign in claim.extremes()]
        if not extremes or scene.start_time:
            return False
        signals = claim.signals(self._requested)
        owners = {each.partition(".")[0] for each in self._requested.needed([claim], ())}
        needed = upstream(owners, self._sources)
        components = [scene.instances[name].fmu.component for name in needed]
        if not all(each and COMPONENTS.owns(each) and each.keeps != MOTION for each in components):
            return False
        if any(each.instance in needed for each in scene.drives) or needed & (self._looped | self._late):
            return False
        sources = [".".join(wire.source) for wire in scene.wires if wire.sink[0] in needed]
        whole = getattr(claim, "window", None) is None
        held = {each for each in signals if whole and each in extremes and self._held(each)}
        return all(each in held or self._is_smooth(each) for each in signals) and not any(
            self._remembers(each) for each in sources
        )

    @cached_property
    def _sources(self) -> Mapping[str, set[str]]:
        return sources_of((wire.source[0], wire.sink[0]) for wire in self._scene.wires)

    @cached_property
    def _looped(self) -> set[str]:
        """The instances that take values of the step before."""
        _order, lagged = step_order(self._scene.instances, self._scene.wires)
        return {wire.sink[0] for wire in lagged}

    @cached_property
    def _late(self) -> set[str]:
        """The instances whose inputs are those of the start of each step."""
        return {
            name
            for name, each in self._scene.instances.items()
            if AT_STEP_END in each.fmu.ports and not each.start(AT_STEP_END)
        }

    def _variable(self, signal: str) -> Any:
        instance, _, variable = signal.partition(".")
        facts = self._scene.instances[instance].fmu.facts
        return facts.variables[variable] if facts else None

    def _remembers(self, signal: str) -> bool:
        component = self._scene.instances[signal.partition(".")[0]].fmu.component
        return component is None or (component.keeps != NOTHING and remembers(self._variable(signal)))

    def _is_smooth(self, signal: str) -> bool:
        """Return whether an output is a real number that samples show."""
        variable, port = self._variable(signal), output_port(self._scene, signal, "claim")
        known = port.causality == "output" and port.kind == "Real" and not any(port.beside[:2])
        return known and variable is not None and not variable.brief and not self._remembers(signal)

    def _held(self, signal: str) -> tuple[str, float] | None:
        """Return the output of which this one holds the lowest values, or with -1 the highest ones."""
        variable = self._variable(signal)
        if variable is None:
            return None
        for base, sign in ((variable.lowest_of, 1.0), (variable.highest_of, -1.0)):
            name = f"{signal.partition('.')[0]}.{base}"
            if base and variable.type is float and self._is_smooth(name):
                return name, sign
        return None

    def _windows(self, signal: str) -> list[str]:
        """Return the outputs that are all positive where the extremes of an output lie."""
        instance = signal.partition(".")[0]
        component = self._scene.instances[instance].fmu.component
        return [f"{instance}.{each}" for each in component.windows] if component else []

    # ---- verdicts

    def judged(self, scene: Scene, run: Signals, wanted: Iterable[int]) -> dict[int, Verdict]:
        """Judge the wanted ones of the claims on a run of this scene, which differs in values alone."""
        claims = {number: self.claims[number] for number in wanted if number in self.claims}
        if not claims:
            return {}
        times = self._equal(scene, run)
        if len(times) * len(self._signals) > MOST_VALUES:
            why = "numerical error not estimated: the run is too long"
            return {number: undecided(claim.judge(run), why) for number, claim in claims.items()}
        samples, left = self._divided(scene, run, times, claims)
        return {
            number: claim.settled(samples, claim.judge(samples), 0.0, SHARE, 0.0, left[number])
            for number, claim in claims.items()
        }

    def _divided(
        self, scene: Scene, run: Signals, times: Floats, claims: Mapping[int, Claim]
    ) -> tuple[Resampled, dict[int, float]]:
        """Return samples that show the worst values of all claims, and how far these may be off."""
        jets = self._at(scene, np.union1d(times, self._worst_samples(run)))
        jets = jets.with_more(self._at(scene, self._edges(scene, self._samples(run, jets))))
        left, unsure, doubtful = dict[int, float](), [*claims], np.zeros(0, dtype=bool)
        for _ in range(ROUNDS):
            if doubtful.any():
                jets = jets.with_more(self._at(scene, _parts(jets.time, doubtful)))
            samples, doubtful = self._samples(run, jets), np.zeros(len(jets.time) - 1, dtype=bool)
            for number in [*unsure]:
                cells, left[number] = self._doubtful(claims[number], samples)
                doubtful |= cells
                if not cells.any():
                    unsure.remove(number)
            if not unsure or len(jets.time) + PARTS * np.sum(doubtful) > MOST:
                break  # what is left is the error
        return samples, left

    def _equal(self, scene: Scene, run: Signals) -> Floats:
        """Return times that show how all mechanisms move; too many for the memory where that is so."""
        movements, end = Movements(self._requested), float(run.time[-1])
        steps = [movements.longest_step(scene, name)[0] for name in self._needed]
        return np.linspace(0.0, end, int(self.steps(end, period(scene), steps)) + 1)

    def steps(self, end: Any, of_period: Any, longest: Sequence[float]) -> Any:
        """Return the number of equal steps to an end, or to several, that show how mechanisms move."""
        shortest = np.minimum(of_period / SHOWN, min((each for each in longest if each), default=np.inf))
        with np.errstate(over="ignore"):
            return np.ceil(np.clip(end / shortest, FEWEST, MOST_VALUES))

    def _worst_samples(self, run: Signals) -> Floats:
        """Return the times of the run's own worst samples: no verdict is better than what it shows."""
        places = []
        for claim in self.claims.values():
            at, _within = _inside(_window(claim), run)
            for its, name, sign in claim.motions(run):
                _base, sign = self._latches.get(name, (name, sign))
                if at.any():
                    places.append(int(np.argmin(np.where(at, sign * its[name], np.inf))))
        found: Floats = run.time[places]
        return found

    def _at(self, scene: Scene, times: Floats) -> "Jets":
        """Return all signals at some times, in order, and at the start where any is later."""
        assert self._tangents is not None
        points = np.concatenate([[0.0], times[times > 0.0]])
        if len(points) == 1:
            return Jets(np.empty(0), np.empty((0, len(self._signals), 2)))
        found = self._tangents.rates(scene, grid_of_points(scene, points))
        return Jets(points, np.stack([np.stack(found[name], axis=1) for name in self._signals], axis=1))

    def _samples(self, run: Signals, jets: "Jets") -> Resampled:
        """Return the run with these samples of its signals."""
        made = {name: jets.rows[:, place, 0] for place, name in enumerate(self._signals)}
        rates = {name: RATE + name for name in made}
        made |= {rates[name]: jets.rows[:, place, 1] for place, name in enumerate(self._signals)}
        for latch, (base, sign) in self._latches.items():
            made[latch] = sign * np.minimum.accumulate(sign * made[base])
        return Resampled(run, jets.time, made, rates)

    def _edges(self, scene: Scene, samples: Resampled) -> Floats:
        """Return the times at which windows of claims begin and end."""
        windows = [window for claim in self.claims.values() if (window := _window(claim))]
        edges = {edge for window in windows for edge in (window.start, window.start + window.width)}
        found = [np.empty(0)]
        for edge in edges if SHAFT_ANGLE in samples else ():
            times = np.array([time for time in sorted(run_of(samples).stands_at(edge)) if time > 0.0])
            for _ in range(NEWTON if len(times) else 0):
                angle, speed = self._at(scene, times).rows[-len(times) :, self._signals.index(SHAFT_ANGLE)].T
                off = (angle - edge + 0.5 * TURN) % TURN - 0.5 * TURN
                times = times - np.divide(off, speed, where=speed != 0.0, out=np.zeros(len(times)))
            found.append(times)
        return np.clip(np.unique(np.concatenate(found)), 0.0, samples.time[-1])

    def _doubtful(self, claim: Claim, samples: Resampled) -> tuple[Flags, float]:
        """Return the steps that may hold the worst value of a claim, and how far that may be off."""
        time, (at, within) = samples.time, _inside(_window(claim), samples)
        wide = np.diff(time) > NARROW * time[-1]
        doubtful, off = np.zeros(len(wide), dtype=bool), 0.0
        for run, name, sign in claim.motions(samples):
            base, sign = self._latches.get(name, (name, sign))
            rate = run.rate(base)
            if rate is None or not at.any():
                continue
            lowest, best = _lowest(time, sign * run[base], sign * run[rate]), np.min(sign * run[base][at])
            left = np.max(best - lowest, where=within & wide, initial=0.0)
            most = EXACT * abs(best) + ROUNDED * np.max(np.abs(run[base]))
            doubtful |= within & wide & (best - lowest > most)
            off = max(off, float(left), float(most))
            if name in self._latches:
                doubtful |= wide & self._hidden(base, samples)
        return doubtful, off

    def _hidden(self, signal: str, samples: Resampled) -> Flags:
        """Return the steps within which alone an output may be where its extremes lie."""
        inside, may_be = np.ones(len(samples.time), dtype=bool), np.ones(len(samples.time) - 1, dtype=bool)
        names = self._windows(signal)
        for name in names:
            values, rates = samples[name], samples[RATE + name]
            inside &= values > 0.0
            may_be &= -_lowest(samples.time, -values, -rates) > 0.0
        return may_be & ~inside[:-1] & ~inside[1:] & bool(names)


class Jets(NamedTuple):
    """Values and rates of signals at some times: rows of shape (times, signals, 2)."""

    time: Floats
    rows: Floats

    def with_more(self, more: "Jets") -> "Jets":
        """Return these and more of them, in order."""
        time, rows = (np.concatenate(each) for each in zip(self, more, strict=True))
        time, places = np.unique(time, return_index=True)
        return Jets(time, rows[places])


def _window(claim: Claim) -> Window | None:
    window: Window | None = getattr(claim, "window", None)
    return window


def _inside(window: Window | None, samples: Signals) -> tuple[Flags, Flags]:
    """Return which samples lie in a window, edges included, and which steps do."""
    angle = samples.shaft_angle
    if window is None:
        return np.ones(len(angle), dtype=bool), np.ones(len(angle) - 1, dtype=bool)
    at = (angle - window.start + EDGE) % TURN <= window.width + 2.0 * EDGE
    return at, (0.5 * (angle[1:] + angle[:-1]) - window.start) % TURN < window.width


def _parts(times: Floats, cells: Flags) -> Floats:
    """Return the times that divide some steps into parts."""
    shares = np.arange(1, PARTS) / PARTS
    found: Floats = (times[:-1][cells, None] + np.diff(times)[cells, None] * shares).ravel()
    return found


def _lowest(time: Floats, values: Floats, rates: Floats) -> Floats:
    """Return what a motion does not go below on each step: its cubic, less what that may be off by."""
    found = np.empty(len(time) - 1)
    time, values, rates = (np.ascontiguousarray(each, dtype=float) for each in (time, values, rates))
    places = [ctypes.c_void_p(each.ctypes.data) for each in (time, values, rates, found)]
    doubt, sign = ctypes.c_double(DOUBT), ctypes.c_double(1.0)
    count, stride = ctypes.c_int64(len(time)), ctypes.c_int64(1)
    _library().find_lowest(count, doubt, sign, *places[:3], stride, places[3])
    return found


@cache
def _library() -> Any:
    return ctypes.PyDLL(str(needed_library(SOURCE)))
