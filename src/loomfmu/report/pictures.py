"""Single pictures: what files they may be, and plots of signals as such files."""

import math
from collections.abc import Iterable, Mapping, Sequence
from fnmatch import fnmatchcase
from io import BytesIO
from pathlib import Path
from textwrap import fill
from typing import Any

from .. import units
from ..errors import LoomfmuError, listed
from ..files import Kind, check_target, starts_with, write_file
from ..traces import Trace, Verdict, plotting
from .extents import extent
from .section import bounds_of, labels

MAKER = "loomfmu"  # that a picture of ours names


def _ours(name: str, *starts: bytes) -> Kind:
    """The kind of pictures that begin in one of these ways and name their maker."""
    begun = starts_with(name, *starts).ours
    return Kind(f"{name} of {MAKER}", lambda path: begun(path) and MAKER.encode() in path.read_bytes())


PICTURES = {
    ".svg": _ours("an SVG picture", b"<svg", b"<?xml"),
    ".png": _ours("a PNG picture", b"\x89PNG\r\n\x1a\n"),
    ".pdf": _ours("a PDF", b"%PDF"),
}
# what a picture says of itself: its maker, and no date
ABOUT: dict[str, dict[str, str | None]] = {
    ".svg": {"Date": None, "Creator": MAKER},
    ".pdf": {"CreationDate": None, "Creator": MAKER},
    ".png": {"Software": MAKER},
}
BOUND = "#1a1a1a"

LETTERS = 85  # of a line of the title
WIDTH, PANEL, REST = 8.0, 2.6, 0.6  # of a picture of one panel or more [in]


def kind(path: Path) -> Kind:
    """The kind of picture that a file is to be. Raises LoomfmuError for another suffix."""
    if path.suffix not in PICTURES:
        found = f"{path.suffix!r} is not a suffix of a picture" if path.suffix else "the file has no suffix"
        raise LoomfmuError(f"{path}: {found}; use .svg, .png or .pdf")
    return PICTURES[path.suffix]


def check(path: Path, inputs: Iterable[Path] = (), overwrite: bool = False) -> None:
    """Refuse a picture that could not be drawn or written, before its content is computed.

    Raises LoomfmuError.
    """
    check_target(path, kind(path), inputs, overwrite)
    plotting.check()


def save(figure: Any, path: Path, title: str, inputs: Iterable[Path] = (), overwrite: bool = False) -> Path:
    """Write a figure of matplotlib as a picture, and return its path. Raises LoomfmuError."""
    return write_file(path, content(figure, path.suffix, title), kind(path), inputs, overwrite)


def content(figure: Any, suffix: str, title: str) -> bytes:
    """A figure of matplotlib as the content of a file, the same whenever it is drawn."""
    drawn = BytesIO()
    with plotting.fixed_style(**{"svg.hashsalt": "loomfmu"}):  # else the names within an SVG are random
        figure.savefig(
            drawn, format=suffix[1:], dpi=plotting.DOTS, metadata={"Title": title, **ABOUT[suffix]}
        )
    return drawn.getvalue()


def plot(
    traces: Sequence[Trace],
    signals: Sequence[str],
    output: Path | None = None,
    over: str | None = None,
    fold: bool = False,
    overwrite: bool = False,
    ylim: str | None = None,
    start: str | None = None,
    end: str | None = None,
    revolution: int | None = None,
) -> Path:
    """Write a picture of signals, a panel for each unit, and return its path.

    Args:
        traces: the traces, laid over one another
        signals: such as `belt.margin`; `*` and `?` stand for parts of names
        output: `.png`, `.svg` or `.pdf`; `TRACE_plot.png` beside the first trace by default
        over: `"angle"` or `"time"`; the shaft's angle if a shaft turns, by default
        fold: lay the revolutions over one another, at 0 to 360 deg
        overwrite: also replace a file that is not such a picture
        ylim: the range that is drawn, such as "0..1" or "0 mm..50 mm"; of signals in one panel. By
            default that of the values, or the part around the bound of a claim
        start: where the axis begins, such as "90 deg" or "20 ms"; a plain number is in deg, or in s over time
        end: where it ends
        revolution: the only one that is drawn, counted from 1

    Raises:
        LoomfmuError: a signal is not recorded, no shaft turns, a range does not fit the signals, the file
            cannot be written, or matplotlib is not installed
    """
    if not signals:
        raise LoomfmuError("name at least one signal to plot, such as belt.margin")
    first = traces[0].given
    path = output or first.with_name(f"{first.stem}_plot.png")
    inputs = [trace.path for trace in traces]
    check(path, inputs, overwrite)
    over = plotting.checked(traces[0], over, fold)
    for trace in traces[1:]:
        plotting.checked(trace, over, fold)
    title = _title(traces)
    named = list(dict.fromkeys(each for name in signals for each in _named(traces[0], name)))
    panels = _panels(traces[0], named)
    limits = None if ylim is None else _limits(ylim, traces[0], panels)
    shown = extent(traces[0], over, fold, start, end, revolution)
    figure = _figure(traces, panels, over, fold, title, limits, shown)
    return save(figure, path, title, inputs, overwrite)


def _title(traces: Sequence[Trace]) -> str:
    """Return the heading of each trace, in a line each."""
    if len(traces) == 1:
        return traces[0].heading
    return "\n".join(f"{label}: {trace.heading}" for label, trace in zip(labels(traces), traces, strict=True))


def _named(trace: Trace, name: str) -> list[str]:
    """The signals that a name or a pattern stands for; itself if there is none."""
    return [each for each in trace if fnmatchcase(each, name)] or [name]


def _panels(trace: Trace, signals: Sequence[str]) -> list[list[str]]:
    """The signals of each panel."""
    panels: dict[str, list[str]] = {}
    for name in signals:
        unit = trace.displayed(name)[1]
        key = name if unit == "1" else unit  # pure numbers have no scale in common
        panels.setdefault(key, []).append(name)
    return list(panels.values())


def _limits(ylim: str, trace: Trace, panels: Sequence[Sequence[str]]) -> tuple[float, float]:
    """The ends of a range in the unit that its panel shows. Raises LoomfmuError."""
    if len(panels) > 1:
        names = listed(each[0] for each in panels)
        raise LoomfmuError(f"ylim {ylim}: {names} are in different panels; plot them apart")
    name = panels[0][0]
    low, high = units.ends_of(ylim)
    try:
        ends = [units.parse(each, trace.unit(name)) for each in (low, high if ".." in ylim else low)]
    except units.UnitError as error:
        raise LoomfmuError(f"ylim {ylim}: {error}; write LOW..HIGH, such as 0..1 or 0mm..50mm") from None
    if not ends[0] < ends[1]:
        raise LoomfmuError(f"ylim {ylim}: the range is empty; write LOW..HIGH, such as 0..1 or 0mm..50mm")
    factor = trace.displayed(name)[0]
    return ends[0] / factor, ends[1] / factor


def _check_shown(limits: tuple[float, float], values: tuple[float, float], name: str) -> None:
    """Refuse limits beyond all values, which would leave the picture empty."""
    if limits[1] < values[0] or limits[0] > values[1]:
        ends = "..".join(f"{value:.4g}" for value in values)
        raise LoomfmuError(f"ylim: no value of {name} is within; they are {ends}")


def _bounds(traces: Sequence[Trace], names: Sequence[str]) -> dict[str, Verdict]:
    """A verdict for each bound on signals, by what is said of it."""
    found = bounds_of(traces, names)
    return {"\nof ".join(filter(None, key)): verdicts[0][1] for key, verdicts in found.items()}


@plotting.fixed_style()
def _figure(
    traces: Sequence[Trace],
    panels: Sequence[Sequence[str]],
    over: str,
    fold: bool,
    title: str,
    limits: tuple[float, float] | None,
    shown: plotting.Extent | None,
) -> Any:
    figure = plotting.figure((WIDTH, PANEL * len(panels) + REST))
    all_axes = figure.subplots(len(panels), sharex=True, squeeze=False)[:, 0]
    for axes, names in zip(all_axes, panels, strict=True):
        curves = [
            (trace, name, " ".join(([name] if len(names) > 1 else []) + ([label] if len(traces) > 1 else [])))
            for name in names
            for trace, label in zip(traces, labels(traces), strict=True)
        ]
        plotting.draw(axes, curves, over, fold, shown)
        if limits:
            _check_shown(limits, axes.dataLim.intervaly, names[0])
        _judge(axes, _bounds(traces, names), limits)
        axes.label_outer()
    figure.suptitle("\n".join(fill(each, LETTERS) for each in title.split("\n")), fontsize=11)
    return figure


def _judge(axes: Any, bounds: Mapping[str, Verdict], limits: tuple[float, float] | None) -> None:
    """Draw bounds with their failing sides, and choose the range around them where none is given."""
    low, high = limits or axes.get_ylim()
    lowest, highest = axes.dataLim.intervaly
    if bounds and not limits and math.isfinite(lowest):
        low, high = plotting.around(lowest, highest, list(bounds.values()))
    axes.set_ylim(low, high)
    ends = ("up", highest, highest > high), ("down", lowest, lowest < low)
    beyond = [f"{way} to {float(f'{end:.4g}'):.10g}" for way, end, hidden in ends if hidden]
    if beyond and not limits:
        told = f"not all is drawn: values go {' and '.join(beyond)}"
        axes.text(1.0, 1.01, told, transform=axes.transAxes, ha="right", va="bottom", fontsize=8)
    fails = "fails"  # once in the legend
    for text, each in bounds.items():
        bound = each.displayed(each.bound)
        axes.axhline(bound, color=BOUND, linestyle=":", linewidth=1.5, label=text)
        if each.sense:
            side = (low, min(bound, high)) if each.sense > 0 else (max(bound, low), high)
            axes.axhspan(*side, color=plotting.FAILING, linewidth=0, zorder=0, label=fails)
            fails = ""
    if bounds:
        plotting.legend(axes)
