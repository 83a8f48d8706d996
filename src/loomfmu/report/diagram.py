"""The timing diagram of the main shaft, straight and round, of one revolution at a time."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from html import escape
from pathlib import Path
from typing import Any

from ..errors import LoomfmuError, listed
from ..files import write_file
from ..traces import Trace, Verdict
from ..traces.signals import NO_SHAFT
from . import pictures
from .occasions import Bar, Occasions, Revolution, Row
from .section import COARSEST, TURN, Section, Subject
from .shapes import Drawing, Point, Shape, Text, file, headed, on_circle, ring, svg, triangle
from .templates import template

LEFT, RIGHT, TOP, ROW, WIDTH = 110.0, 20.0, 34.0, 30.0, 900.0
CENTRE, OUTER, INNER, SQUARE = (345.0, 345.0), 290.0, 90.0, 690.0
COARSE = math.radians(1.0)  # between samples: beyond, the diagram says how far they are apart
EXAMPLES = '"weft.travel", "belt.free_length" or "heald_1.lift"'
MARKS = {
    "worst value of a claim that holds": "holds",
    "worst value of a claim that fails or is undecided": "fails",
}
MOST_NAMED = 9  # rings of the round diagram on a narrow screen
MOST_DRAWN = 24  # revolutions that differ, in one report


@dataclass(frozen=True)
class Mark:
    """The place of a claim's worst value [rad within the revolution]."""

    angle: float
    holds: bool
    text: str

    def drawn(self, x: float, top: float, bottom: float) -> Shape:
        """A triangle at a place [px]."""
        tip = triangle(x, top, bottom, self.holds)
        return Shape(tip, "holds" if self.holds else "fails", title=self.text)


def section(subject: Subject) -> Section | None:
    """The diagram with all revolutions that differ, of which the cursor chooses; None if no shaft turns."""
    if subject.trace.standing == NO_SHAFT:
        return None
    occasions = Occasions(subject)
    if reason := _not_drawn(subject, occasions):
        return Section("diagram", "Timing diagram", f"<p>Not drawn: {escape(reason)}.</p>")
    drawn: list[Revolution] = []
    marks: list[list[Mark]] = []
    shown: dict[int, int | None] = {}
    first = revolution_of(subject.start, occasions.numbers)
    for revolution in occasions.revolutions():
        its = marks_in(subject.trace.verdicts, revolution.number)
        same = (k for k, other in enumerate(drawn) if revolution.same(other) and marks[k] == its)
        place = next(same, None)
        if place is None and (len(drawn) < MOST_DRAWN or revolution.number == first):
            place = len(drawn)
            drawn.append(revolution)
            marks.append(its)
        shown[revolution.number] = place
    claims = subject.live or any(marks)
    elsewhere = _elsewhere(subject.trace.verdicts)
    height = straight_size(occasions.rows, claims)[1]
    drawings = [
        straight(occasions.rows, each, its, claims, elsewhere) for each, its in zip(drawn, marks, strict=True)
    ]
    html = template("diagram.html.j2").render(
        width=WIDTH,
        height=height,
        square=SQUARE,
        left=LEFT,
        right=WIDTH - RIGHT,
        top=TOP - 8.0,
        centre=CENTRE,
        outer=OUTER + 8.0,
        inner=INNER - 8.0,
        straight=[svg(each) for each in drawings],
        round=[svg(round_(occasions.rows, each, its)) for each, its in zip(drawn, marks, strict=True)],
        tables=[table(occasions.rows, each) for each in drawn],
        first=first,
        shown=shown,
        crowded=len(occasions.rows) > MOST_NAMED,
        numbers=[[n for n, place in shown.items() if place == k] for k in range(len(drawn))],
        legend=_legend(occasions.rows, None if subject.live else drawings),
        coarse=math.degrees(subject.gap) if subject.gap > COARSE else 0.0,
    )
    data = {"shown": shown, "left": LEFT, "right": WIDTH - RIGHT, "centre": CENTRE}
    scripts: tuple[str, ...] = ("diagram.js",)
    if subject.live:
        data |= _layout(occasions.rows)
        scripts += ("live_diagram.js",)
    return Section("diagram", "Timing diagram", html, scripts, data)


def _layout(rows: Sequence[Row]) -> dict[str, Any]:
    """Return rules, places and sizes of the rows, with which a script draws them as this module does."""
    width = (OUTER - INNER) / len(rows)
    return {"rows": [asdict(row) for row in rows], "top": TOP, "row": ROW, "outer": OUTER, "width": width}


def write(
    trace: Trace, output: Path, revolution: int | None = None, circular: bool = False, overwrite: bool = False
) -> Path:
    """Write the diagram of one revolution of a trace and return its path.

    By default it is that of the worst failure, or the last whole one where all claims hold.

    Raises LoomfmuError where no shaft turns, there is no such revolution, or the file cannot be written.
    """
    subject = Subject([trace])
    occasions = Occasions(subject)
    if reason := _not_drawn(subject, occasions):
        raise LoomfmuError(f"{trace.given}: there is no timing diagram, as {reason}")
    numbers = occasions.numbers
    number = _usual(subject, numbers) if revolution is None else revolution
    if number not in numbers:
        raise LoomfmuError(f"revolution = {number} is outside [{numbers[0]}, {numbers[-1]}] of {trace.given}")
    its, marks = occasions.revolution(number), marks_in(trace.verdicts, number)
    if circular:
        drawing, size = round_(occasions.rows, its, marks), (SQUARE, SQUARE)
    else:
        drawing = straight(occasions.rows, its, marks, bool(marks))
        size = straight_size(occasions.rows, bool(marks))
    title = f"{trace.heading}: timing diagram, revolution {number}"
    drawing, size = headed(title, _legend(occasions.rows, [drawing]), drawing, size)
    kind = pictures.kind(output)
    return write_file(output, file(drawing, size, output.suffix, title), kind, [trace.path], overwrite)


def _usual(subject: Subject, numbers: range) -> int:
    """The revolution of the worst failure; the last whole one where all claims hold."""
    if subject.worst is None or subject.worst:
        return max(numbers[0], int(subject.positions[-1] / TURN + 1e-9))
    return revolution_of(subject.start, numbers)


def revolution_of(position: float, numbers: range) -> int:
    """Return the number of the revolution that a position is in, among those of a run."""
    return min(max(int(position / TURN + 1e-9) + 1, numbers[0]), numbers[-1])


def _not_drawn(subject: Subject, occasions: Occasions) -> str:
    """Return why there is no diagram, or an empty text if there is one."""
    if subject.trace.standing:
        return subject.trace.standing
    if not occasions.rows:
        return f"the trace records nothing that it shows; add {EXAMPLES} to record, or leave record out"
    if subject.gap > COARSEST:
        apart = f"{math.degrees(subject.gap):.0f}°"
        return f"the samples are up to {apart} apart, too far to show when things happen"
    return ""


def marks_in(verdicts: Sequence[Verdict], number: int) -> list[Mark]:
    """The claims whose worst value is in a revolution."""
    return [
        Mark(each.angle, bool(each), f"{each.word}: {each.claim}, {each.shown_worst}")
        for each in verdicts
        if each.revolution == number and math.isfinite(each.angle)
    ]


def _degrees(interval: tuple[float, float]) -> str:
    return " to ".join(f"{math.degrees(edge):.1f}°" for edge in interval)


def _elsewhere(verdicts: Sequence[Verdict]) -> str:
    """Return the text of the claims' row in a revolution that has none of their worst values."""
    found = sorted({each.revolution for each in verdicts if each.revolution is not None})
    return f"worst values in revolution{'s' * (len(found) > 1)} {listed(found)}" if found else ""


def table(rows: Sequence[Row], revolution: Revolution) -> list[tuple[str, str, str]]:
    """The same in words: row, what, from where to where."""
    return [
        (row.label, bar.label, ", ".join(map(_degrees, revolution.intervals[row.name, bar.label])) or "never")
        for row in rows
        for bar in row.bars
    ]


def _title(row: Row, bar: Bar, interval: tuple[float, float]) -> str:
    return f"{row.label} {bar.label}: {_degrees(interval)}"


def _legend(rows: Sequence[Row], drawings: Sequence[Drawing] | None) -> dict[str, str]:
    """Return the colours of drawings by their labels; with None, all that these rows may have."""
    known = {bar.label: bar.role for row in rows for bar in row.bars} | MARKS
    if drawings is None:
        return known
    shown = {each.role for drawing in drawings for each in drawing}
    return {label: role for label, role in known.items() if role in shown}


# ---- straight


def straight_size(rows: Sequence[Row], claims: bool) -> tuple[float, float]:
    """Width and height of the straight diagram, with a row of claims or without [px]."""
    return WIDTH, TOP + ROW * (len(rows) + claims) + 10.0


def _x(angle: float) -> float:
    return LEFT + (WIDTH - RIGHT - LEFT) * angle / TURN


def straight(
    rows: Sequence[Row], revolution: Revolution, marks: Sequence[Mark], claims: bool, elsewhere: str = ""
) -> Drawing:
    """Rows over 0 to 360 deg, one below the other, at last that of the claims if there is one.

    Without a mark in this revolution it says that they are `elsewhere`.
    """
    drawing: list[Shape | Text] = []
    bottom = TOP + ROW * (len(rows) + claims)
    for degrees in range(0, 361, 30):
        x = _x(math.radians(degrees))
        drawing.append(Shape([(x, TOP - 4.0), (x, bottom)], "line", filled=False))
        drawing.append(Text((x, TOP - 12.0), f"{degrees}°", "faint", "middle"))
    for place, row in enumerate(rows):
        top = TOP + ROW * place
        drawing.append(Text((LEFT - 8.0, top + 0.65 * ROW), row.label, "text", "end"))
        for bar in row.bars:
            for low, high in revolution.intervals[row.name, bar.label]:
                x0, x1 = _x(low), _x(high)
                box = [(x0, top + 6.0), (x1, top + 6.0), (x1, top + ROW - 4.0), (x0, top + ROW - 4.0)]
                drawing.append(Shape(box, bar.role, title=_title(row, bar, (low, high))))
        if row.name in revolution.curves:
            drawing.append(Shape(list(_curve(revolution, row, top)), "curve", filled=False))
    top = TOP + ROW * len(rows)
    if claims:
        drawing.append(Text((LEFT - 8.0, top + 0.65 * ROW), "Claims", "text", "end"))
    if claims and not marks:
        drawing.append(Text((LEFT + 8.0, top + 0.65 * ROW), elsewhere, "faint elsewhere"))
    for mark in marks:
        drawing.append(mark.drawn(_x(mark.angle), top + 4.0, top + ROW - 6.0))
    return drawing


def _curve(revolution: Revolution, row: Row, top: float) -> Iterator[Point]:
    for angle, value in zip(*revolution.curves[row.name], strict=True):
        yield _x(float(angle)), top + 6.0 + (ROW - 10.0) * (1.0 - float(value))


# ---- round


def round_(rows: Sequence[Row], revolution: Revolution, marks: Sequence[Mark]) -> Drawing:
    """Rows as rings, the first one outside, clockwise from 0 deg at the top; the claims around them."""
    width = (OUTER - INNER) / len(rows)
    drawing: list[Shape | Text] = []
    names: list[Text] = []
    for degrees in range(0, 360, 30):
        angle = math.radians(degrees)
        spoke = [on_circle(CENTRE, radius, angle) for radius in (INNER, OUTER)]
        drawing.append(Shape(spoke, "line", filled=False))
        x, y = on_circle(CENTRE, OUTER + 26.0, angle)
        drawing.append(Text((x, y + 4.0), f"{degrees}°", "faint", "middle"))
    for place, row in enumerate(rows):
        outer = OUTER - width * place
        circle = [on_circle(CENTRE, outer, math.radians(degrees)) for degrees in range(0, 361, 3)]
        drawing.append(Shape(circle, "line", filled=False))
        for bar in row.bars:
            for low, high in revolution.intervals[row.name, bar.label]:
                sector = ring(CENTRE, outer - 0.85 * width, outer - 0.15 * width, low, high)
                drawing.append(Shape(sector, bar.role, title=_title(row, bar, (low, high))))
        names.append(Text((CENTRE[0] + 3.0, CENTRE[1] - outer + 0.5 * width + 4.0), row.label, "text"))
    drawing += names  # in front of all rings
    for mark in marks:
        x, y = on_circle(CENTRE, OUTER + 9.0, mark.angle)
        drawing.append(mark.drawn(x, y - 6.0, y + 6.0))
    return drawing
