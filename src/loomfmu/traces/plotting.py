"""Signals drawn by matplotlib over shaft angle or time, in the units that people read."""

import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import LoomfmuError
from ..extras import need
from .signals import Floats, Signals

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#a8578a", "#e69f00", "#1a1a1a")  # of Okabe and Ito, and black
DASHES = ("-", "--", "-.", ":")
SIZE = (8.0, 4.0)  # of one picture [in]
Curve = tuple[Signals, str, str]  # a trace, its signal, what the legend calls it


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
    """Draw with matplotlib's own defaults and these settings, whatever a matplotlibrc says.

    Raises LoomfmuError if matplotlib is not installed.
    """
    check()
    from matplotlib import rc_context, rcdefaults

    chosen: Any = settings
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


def draw(axes: Any, curves: Sequence[Curve], over: str, fold: bool) -> None:
    """Draw signals of one unit, each with a colour and a dash of its own."""
    for number, (trace, signal, label) in enumerate(curves):
        values = trace[signal]
        continuous = values.dtype.kind == "f"
        shown = values.astype(float) / trace.displayed(signal)[0]
        along = np.degrees(trace.shaft_angle) if over == "angle" else trace.time
        axes.plot(
            *(folded(along, shown, continuous) if fold else (along, shown)),
            label=label,
            color=COLOURS[number % len(COLOURS)],
            linestyle=DASHES[number % len(DASHES)],
            drawstyle="default" if continuous else "steps-post",
            linewidth=1.5,
        )
    unit = curves[0][0].displayed(curves[0][1])[1]
    named = curves[0][1] if len({signal for _, signal, _ in curves}) == 1 else ""
    axes.set_ylabel(" ".join([*([named] if named else []), *([f"[{unit}]"] if unit != "1" else [])]))
    axes.set_xlabel("Shaft angle [deg]" if over == "angle" else "Time [s]")
    if over == "angle":
        axes.xaxis.set_major_locator(degrees())
    axes.margins(x=0.0)
    axes.grid(color="#d4d4d4", linewidth=0.6)
    if len(curves) > 1:
        axes.legend(frameon=False)


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
