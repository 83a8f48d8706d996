"""Measured curves over shaft angle or time, read from CSV or from a trace, and an offset of their places."""

import csv
import math
import re
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ... import units
from ...cosim.planning.requested import output_port
from ...cosim.scenes.scene import Scene
from ...errors import LoomfmuError, listed, shown, within
from ...files import text_of
from ...sweeps.varied import Varied
from ...traces import Trace
from ...traces.damage import check
from ..span import Span

Floats = NDArray[np.float64]
ALONG = {"shaft_angle": "rad", "time": "s"}  # what curves are measured over: name of the column, unit in SI
FORM = "name the columns such as: shaft_angle [deg],damper_1.displacement [mm]"
_COLUMN = re.compile(r"(.+)\[([^\[\]]+)\]")  # a name may have brackets of its own
NOT_MEASURED = ("", "nan")
Row = tuple[str, list[str]]  # of a file: where it is, and its cells


@dataclass(frozen=True)
class Measured:
    """Measured values (SI) of signals, NaN where one was not measured, over `shaft_angle` or `time`.

    `along` are the places in their order, [rad] or [s], shape (n,); each of the `columns` has the same shape.
    `shifts` are the least and the most that an offset may add to the places.
    """

    path: Path
    over: str
    along: Floats
    columns: dict[str, Floats]
    shifts: tuple[float, float] = (0.0, 0.0)

    @property
    def count(self) -> int:
        """Number of measured values."""
        return sum(int(np.isfinite(values).sum()) for values in self.columns.values())

    @property
    def rows(self) -> dict[str, slice]:
        """The places of each signal where the measured values of all are joined."""
        ends = np.cumsum([0, *(np.isfinite(values).sum() for values in self.columns.values())]).tolist()
        return {name: slice(*each) for name, each in zip(self.columns, pairwise(ends), strict=True)}


def read(path: str | Path, scene: Scene, signals: Sequence[str] = ()) -> Measured:
    """Read a measurement; `signals` chooses some of a CSV file, all of them by default, and those of a trace.

    Raises:
        LoomfmuError: a column without a unit, or one that does not fit the scene's output of that name
    """
    path = Path(path)
    found = _trace(path, signals) if path.suffix in (".h5", ".hdf5") else _table(path, scene, signals)
    for signal in found.columns:
        if output_port(scene, signal, f"{path}").kind != "Real":
            raise LoomfmuError(f"{path}: {signal} is not a real number; only curves can be fitted")
    if not found.count:
        raise LoomfmuError(f"{path}: there are no measured values")
    order = np.argsort(found.along, kind="stable")
    columns = {name: values[order] for name, values in found.columns.items()}
    return replace(found, along=found.along[order], columns=columns)


def _trace(path: Path, signals: Sequence[str]) -> Measured:
    if not signals:
        raise LoomfmuError(f"{path}: name the signals of this trace that are to be fitted, with --signal")
    check(path)
    with Trace(path) as trace:
        over = "shaft_angle" if trace.turns else "time"
        along = np.array(trace.shaft_angle if trace.turns else trace.time)
        return Measured(path, over, along, {name: np.array(trace[name], float) for name in signals})


def rows_of(path: Path, form: str = FORM) -> list[Row]:
    """The rows of a CSV file, its heading first, without comments; `form` says how to name columns."""
    numbered = [
        (number, line)
        for number, line in enumerate(text_of(path).splitlines(), start=1)
        if line.strip() and not line.startswith("#")
    ]
    if not numbered:
        raise LoomfmuError(f"{path}: the file is empty; {form}")
    numbers, lines = zip(*numbered, strict=True)
    if ";" in lines[0]:
        raise LoomfmuError(f"{path}: separate the columns with commas, and write decimals with points")
    reader = csv.reader(lines)
    try:
        return [(f"{path}: line {numbers[reader.line_num - 1]}", row) for row in reader]
    except csv.Error as error:
        raise LoomfmuError(f"{path}: line {numbers[reader.line_num - 1]}: not a table ({error})") from None


def _table(path: Path, scene: Scene, signals: Sequence[str]) -> Measured:
    heading, *rows = rows_of(path)
    over, factor, named = _headings(*heading, scene)
    values = values_of(heading[1], rows)
    columns = {name: values[:, place] * scale for name, (place, scale) in named.items()}
    if missing := [name for name in signals if name not in columns]:
        raise LoomfmuError(f"{path}: there is no column {missing[0]!r}; it has {listed(columns)}")
    along = values[:, 0] * factor
    _check_places(along, columns, over, rows)
    return Measured(path, over, along, {name: columns[name] for name in signals or columns})


def _check_places(along: Floats, columns: dict[str, Floats], over: str, rows: Sequence[Row]) -> None:
    """Refuse rows without a place, and a signal that has two values at one."""
    seen: dict[tuple[str, float], str] = {}
    for number, (where, row) in enumerate(rows):
        if not math.isfinite(along[number]):
            raise LoomfmuError(f"{where}: there is no {over}")
        for name, values in columns.items():
            if not math.isfinite(values[number]):
                continue
            before = seen.setdefault((name, float(along[number])), where)
            if before != where:
                line = before.rpartition(": ")[2]
                raise LoomfmuError(
                    f"{where}: {over} = {row[0].strip()} has a second value of {name}, after that in {line};"
                    " keep one of them, or their mean"
                )


def _headings(
    where: str, heading: Sequence[str], scene: Scene
) -> tuple[str, float, dict[str, tuple[int, float]]]:
    """Return the axis of the first column with its factor, and of each signal its column and factor to SI."""
    over, unit = named_column(where, heading[0], "deg" if heading[0].strip() == "shaft_angle" else "s")
    if over not in ALONG:
        raise LoomfmuError(f"{where}: the first column is {shown(over)}, not shaft_angle or time; {FORM}")
    named: dict[str, tuple[int, float]] = {}
    for place, text in enumerate(heading[1:], start=1):
        name, stated = named_column(where, text, _display(scene, text.strip()))
        if name in named:
            raise LoomfmuError(f"{where}: two columns are called {name}")
        port = output_port(scene, name, f"{where}")
        named[name] = place, factor_to(where, name, stated, port.unit)
    if not named:
        raise LoomfmuError(f"{where}: there is no column beside {over}; {FORM}")
    return over, factor_to(where, over, unit, ALONG[over]), named


def _display(scene: Scene, signal: str) -> str:
    """The unit that people read a signal in; empty where the scene has no such signal."""
    with suppress(LoomfmuError):
        return output_port(scene, signal, "").display
    return ""


def named_column(where: str, text: str, display: str = "") -> tuple[str, str]:
    """A column's name and unit. Raises LoomfmuError for one without, with the unit to `display`, if known."""
    match = _COLUMN.fullmatch(text.strip())
    if match is None:
        usual = shown(f"{text.strip()} [{display or 'mm'}]")
        pure = "" if display else ", or [1] for a pure number"
        raise LoomfmuError(
            f"{where}: column {shown(text.strip())} has no unit; write it in brackets, such as {usual}{pure}"
        )
    return match.group(1).strip(), match.group(2).strip()


def factor_to(where: str, name: str, stated: str, wanted: str) -> float:
    """Return the factor from the stated unit. Raises LoomfmuError for a unit that does not fit."""
    misfit = f"{where}: column {name} is in {shown(stated)}, which does not fit {units.fitted(wanted)}"
    if wanted not in units.UNITS:  # a third-party FMU's own
        if stated != wanted:
            raise LoomfmuError(misfit)
        return 1.0
    with within(f"{where}: column {name}"):
        given = units.unit(stated, like=wanted)
    if given.dimension != units.unit(wanted).dimension:
        raise LoomfmuError(misfit)
    return given.factor / units.unit(wanted).factor


def values_of(heading: Sequence[str], rows: Iterable[Row]) -> Floats:
    """The numbers in rows, NaN for empty cells. Raises LoomfmuError for anything else."""
    found = []
    for where, row in rows:
        if len(row) != len(heading):
            raise LoomfmuError(f"{where}: {len(row)} values for {len(heading)} columns")
        found.append([_value(f"{where}: {name}", text) for name, text in zip(heading, row, strict=True)])
    return np.array(found, float).reshape(-1, len(heading))


def _value(where: str, text: str) -> float:
    """A value, NaN where there is none."""
    text = text.strip()
    if text.lower() in NOT_MEASURED:
        return math.nan
    try:
        value = float(text)
    except ValueError:
        raise LoomfmuError(f"{where}: {shown(text)} is not a number") from None
    if not math.isfinite(value):
        raise LoomfmuError(f"{where}: {text} is not finite")
    return value


DISPLAY = {"shaft_angle": "deg", "time": "ms"}
USUAL = {"shaft_angle": "-2deg..2deg", "time": "-2ms..2ms"}


def offset_of(data: Measured, text: str) -> Span:
    """Return the offset of all places, within a range such as "-2ms..2ms". Raises LoomfmuError."""
    first, last = units.ends_of(text) if isinstance(text, str) else ("", "")
    if not (first and last):
        raise LoomfmuError(f"offset = {shown(text)} is not a range such as {USUAL[data.over]}")
    unit, display = ALONG[data.over], DISPLAY[data.over]
    read = partial(_read, unit=unit, over=data.over)
    varied = Varied("offset", (), "Real", unit, display, "Added to the places of the data", read)
    span = Span(varied, read(first), read(last), 0.0, "given")
    if not span.low < span.high:
        raise LoomfmuError(f"offset: the range from {span.show(span.low)} to {span.show(span.high)} is empty")
    return span


def _read(given: str, unit: str, over: str) -> float:
    try:
        value = units.parse(given, unit)
    except units.UnitError as error:
        raise LoomfmuError(f"offset: {error}; the data are over {over}") from None
    if not math.isfinite(value):
        raise LoomfmuError(f"offset = {shown(given)} is not finite")
    if units.is_plain(given) and value:
        raise LoomfmuError(f"offset = {shown(given)} has no unit; write a range such as {USUAL[over]}")
    return value
