"""Signals drawn by matplotlib over shaft angle or time, in the units that people read."""

import math
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import LoomfmuError
from ..extras import need
from ..physics.belt import NO_LIMIT
from .signals import Floats, Signals
from .verdict import Verdict

DOTS = 200  # of an inch, in all pictures
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#a8578a", "#e69f00", "#1a1a1a")  # of Okabe and Ito, and black
HOLDS, HOLDS_LINE = "#dcefe3", "#8fc7a3"  # where claims hold: areas, lines
DASHES = ("-", "--", "-.", ":")
SIZE = (8.0, 4.0)  # of one picture [in]
# of all pictures: the colours and lines of the pages
STYLE: dict[str, Any] = {
    "font.family": "DejaVu Sans",
    "text.parse_math": False,
    "text.color": "#1a1a1a",
    "axes.labelcolor": "#1a1a1a",
    "axes.edgecolor": "#5c5c5c",
    "axes.titlesize": 11,
    "axes.axisbelow": True,
    "axes.grid": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "grid.color": "#d4d4d4",
    "grid.linewidth": 0.6,
    "xtick.color": "#5c5c5c",
    "ytick.color": "#5c5c5c",
    "xtick.labelcolor": "#1a1a1a",
    "ytick.labelcolor": "#1a1a1a",
    "legend.frameon": False,
}
FREE = "#ededed"  # where there is no limit
FAILING = "#f7dfd0"  # the failing side of a bound
HELD = ("lowest", "highest")  # roles of the extremes of a signal that its component holds
REACH, LEAST = (
    10.0,
    0.1,
)  # of a range around a bound: times the distance of the worst value, or a share of the bound
SPEED = "rad/s"  # the unit of what has `NO_LIMIT` where there is no limit
Curve = tuple[Signals, str, str]  # a trace, its signal, what the legend calls it


class Extent(NamedTuple):
    """A part of an axis [deg or s], counted from `origin`."""

    first: float
    last: float
    origin: float


def plot(trace: Signals, signals: Sequence[str], over: str | None, fold: bool, axes: Any) -> Any:
    """Plot signals for `Trace.plot`."""
    if not signals:
        raise LoomfmuError(f"{trace.name}: name at least one signal to plot")
    over = checked(trace, over, fold)
    units = {name: trace.displayed(name)[1] for name in signals}
    odd = next((name for name in signals if units[name] != units[signals[0]]), None)
    if odd is not None:
        raise LoomfmuError(
            f"{signals[0]} is in {units[signals[0]]} and {odd} in {units[odd]}; plot them apart"
        )
    if axes is None:
        axes = figure(SIZE, shown=True).subplots()
    draw(axes, [(trace, name, name) for name in signals], over, fold)
    return axes


def check() -> None:
    """Raise LoomfmuError if the extra `plot` is not installed, or matplotlib fails over a matplotlibrc."""
    need("a picture", "plot")
    # one of another environment, as a notebook sets it for its shell, keeps matplotlib from being imported
    first, backend = "matplotlib" not in sys.modules, os.environ.pop("MPLBACKEND", None)
    try:
        import matplotlib.figure
    except UnicodeDecodeError:
        raise LoomfmuError("a matplotlibrc that matplotlib reads is not text in UTF-8; delete it") from None
    finally:
        if backend is not None:
            os.environ["MPLBACKEND"] = backend
    if first and backend is not None:
        with suppress(ValueError):
            matplotlib.rcParams["backend"] = backend


@contextmanager
def fixed_style(**settings: Any) -> Iterator[None]:
    """Draw in the style of all pictures with these settings, whatever a matplotlibrc says.

    Raises LoomfmuError if matplotlib is not installed.
    """
    check()
    from matplotlib import rc_context, rcdefaults

    chosen: Any = STYLE | settings
    with rc_context():
        rcdefaults()
        with rc_context(chosen):
            yield


def figure(size: tuple[float, float], shown: bool = False, layout: Any = "constrained") -> Any:
    """A new figure [in]; `shown` where a notebook or a window is to show it.

    Raises LoomfmuError if matplotlib is not installed.
    """
    check()
    from matplotlib import figure, pyplot

    return (pyplot.figure if shown else figure.Figure)(figsize=size, layout=layout)


def checked(trace: Signals, over: str | None, fold: bool) -> str:
    """Return the axis to plot over, "angle" or "time". Raises LoomfmuError for one that makes no sense."""
    if not len(trace.time):
        raise LoomfmuError(f"{trace.name}: the trace has no samples, so there is nothing to plot")
    if over is None:
        over = "angle" if trace.turns or fold else "time"
    if over not in ("angle", "time"):
        raise LoomfmuError(f'over = {over!r}: choose "angle" or "time"')
    if over == "angle" and not trace.turns:
        raise LoomfmuError(f"{trace.name}: {trace.standing}, so nothing is plotted over its angle; use time")
    if over == "time" and fold:
        raise LoomfmuError("only a plot over the shaft angle can be folded, not one over time")
    return over


def known(trace: Signals, signal: str, values: NDArray[Any]) -> Floats:
    """Return values as floats, NaN where a speed says that it has no limit."""
    floats = np.asarray(values, dtype=float)
    limitless = trace.unit(signal) == SPEED and np.any(floats == NO_LIMIT)
    return np.where(floats == NO_LIMIT, np.nan, floats) if limitless else floats


def curve_of(trace: Signals, signal: str) -> str:
    """Return the signal of which another one is the extreme that its component holds, or that other one."""
    if signal not in trace:
        return signal
    instance = signal.partition(".")[0]
    alike = (name for name in trace if name.startswith(f"{instance}.") and name != signal)
    return next((name for name in alike if signal in (trace.beside(name, role) for role in HELD)), signal)


def around(low: float, high: float, bounds: Sequence[Verdict]) -> tuple[float, float]:
    """Return the part of a range of values, in display units, that shows how far they are from bounds.

    Far on the safe side it leaves values out: `page/plots.js` has the same rule.

    >>> claim = Verdict("c", "belt.margin", True, 0.1, 0.2, "1", "1", 0.0, 0.0, 1, sense=1)
    >>> low, high = around(0.2, 245.0, [claim])
    >>> round(low, 2), round(high, 2)
    (0.0, 1.1)
    """
    limits = [each.displayed(each.bound) for each in bounds]
    ends = [
        limit + each.sense * REACH * max(abs(each.displayed(each.worst) - limit), LEAST * abs(limit))
        for each, limit in zip(bounds, limits, strict=True)
        if math.isfinite(each.worst)
    ]
    if ends and max(each.sense for each in bounds) > 0:
        high = min(high, max(*ends, *limits))
    if ends and min(each.sense for each in bounds) < 0:
        low = max(low, min(*ends, *limits))
    low, high = min(low, *limits), max(high, *limits)
    room = 0.1 * (high - low) or 1.0
    return low - room, high + (room if max(limits) == high else 0.0)


def draw(
    axes: Any,
    curves: Sequence[Curve],
    over: str,
    fold: bool,
    extent: Extent | None = None,
) -> None:
    """Draw signals of one unit, each with a colour and a dash of its own."""
    for number, (trace, signal, label) in enumerate(curves):
        values = trace[signal]
        continuous = values.dtype.kind == "f"
        shown = known(trace, signal, values) / trace.displayed(signal)[0]
        along = np.degrees(trace.shaft_angle) if over == "angle" else trace.time
        x, y = folded(along, shown, continuous) if fold else (along, shown)
        if extent is not None:  # what is beside it would count for the range of the values
            x = x - extent.origin
            inside = np.flatnonzero((x >= extent.first) & (x <= extent.last))
            part = slice(max(int(inside.min(initial=len(x))) - 1, 0), int(inside.max(initial=0)) + 2)
            x, y = x[part], y[part]
        axes.plot(
            x,
            y,
            label=label,
            color=COLOURS[number % len(COLOURS)],
            linestyle=DASHES[number % len(DASHES)],
            drawstyle="default" if continuous else "steps-post",
            linewidth=1.5,
        )
        if continuous and np.isnan(shown).any() and not np.isnan(values).any():
            across = axes.get_xaxis_transform()
            free = {"facecolor": FREE, "edgecolor": "#c4c4c4", "linewidth": 0.6, "zorder": 0}
            free |= {"label": "no limit"} if not number else {}
            axes.fill_between(x, 0.0, 1.0, where=np.isnan(y), transform=across, **free)
    unit = curves[0][0].displayed(curves[0][1])[1]
    named = curves[0][1] if len({signal for _, signal, _ in curves}) == 1 else ""
    axes.set_ylabel(" ".join([*([named] if named else []), *([f"[{unit}]"] if unit != "1" else [])]))
    axes.set_xlabel("Shaft angle [deg]" if over == "angle" else "Time [s]")
    if over == "angle":
        axes.xaxis.set_major_locator(degrees())
    axes.margins(x=0.0)
    if extent is not None:
        axes.set_xlim(extent.first, extent.last)
    axes.grid(color=STYLE["grid.color"], linewidth=STYLE["grid.linewidth"])
    if len(curves) > 1:
        legend(axes)


def legend(axes: Any) -> None:
    """Name what is drawn, beside the axes in a figure that makes room for it: there it covers no curve."""
    makes_room = axes.figure.get_layout_engine() is not None
    axes.legend(frameon=False, **({"loc": "upper left", "bbox_to_anchor": (1.0, 1.0)} if makes_room else {}))


def degrees() -> Any:
    """Return a locator that places the ticks of an axis in degrees."""
    from matplotlib.ticker import MaxNLocator

    return MaxNLocator(nbins=12, steps=[1, 1.5, 3, 4.5, 6, 9, 10])


def folded(angles: Floats, values: Floats, continuous: bool) -> tuple[Floats, Floats]:
    """A curve at 0 to 360 deg: cut with NaN where the shaft passes 0, the ends of each part on the edge.

    >>> angles, values = folded(np.array([350.0, 370.0]), np.array([1.0, 3.0]), True)
    >>> angles.tolist(), values.tolist()
    ([350.0, 360.0, nan, 0.0, 10.0], [1.0, 2.0, nan, 2.0, 3.0])
    """
    turn = np.floor(angles / 360.0)
    before: NDArray[np.int64] = np.flatnonzero(turn[1:] != turn[:-1])
    after = before + 1
    forward = turn[after] > turn[before]
    share = (360.0 * np.maximum(turn[before], turn[after]) - angles[before]) / (
        angles[after] - angles[before]
    )
    edge = values[before] + (share * (values[after] - values[before]) if continuous else 0.0)
    gap = np.full(len(before), np.nan)
    at = np.repeat(after, 3)
    places = np.stack([np.where(forward, 360.0, 0.0), gap, np.where(forward, 0.0, 360.0)], axis=1)
    return (
        np.insert(angles - 360.0 * turn, at, places.ravel()),
        np.insert(values, at, np.stack([edge, gap, edge], axis=1).ravel()),
    )
