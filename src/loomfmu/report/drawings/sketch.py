"""Drawings in millimetres whose parts follow tracks: SVG that a short script moves."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from html import escape

import numpy as np
from numpy.typing import NDArray

from .tracks import Tracks

Shapes = NDArray[np.float64]  # heights at equal distances along, a row for each
Coordinate = float | str  # mm, or the name of a track in mm
Point = tuple[Coordinate, Coordinate]
WIDTH = 440.0  # px of a drawing beside others, so that labels are of one size
SCALES = (5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0, 2000.0)  # mm of a scale bar


@dataclass(frozen=True)
class Value:
    """A number below a drawing that follows a track, or the worst value of a claim, by its place."""

    label: str
    track: str = ""
    unit: str = ""
    claim: int | None = None
    steps: bool = False  # it changes in steps, and is shown without a decimal of 0
    text: str = ""  # at the still position


@dataclass(frozen=True)
class Figure:
    """A drawing of the page: what it is in a sentence, and notes on what is schematic in it."""

    name: str
    title: str
    sentence: str
    height: float
    svg: str
    values: Sequence[Value] = ()
    note: str = ""
    width: float = WIDTH


@dataclass
class Sketch:
    """A drawing to scale, y upwards: its lower left corner [mm] is that of the box of the machine's parts."""

    tracks: Tracks
    left: float
    bottom: float
    right: float
    top: float
    width: float = WIDTH  # px
    parts: list[str] = field(default_factory=list)
    labels: list[str] = field(default_factory=list)

    @property
    def scale(self) -> float:
        """px a mm."""
        return self.width / (self.right - self.left)

    @property
    def height(self) -> float:
        """Height with the scale bar [px]."""
        return self.scale * (self.top - self.bottom) + 26.0

    @property
    def svg(self) -> str:
        """The elements: parts in mm, labels in px."""
        k = self.scale
        place = f"translate({-k * self.left:.6g} {k * self.top:.6g}) scale({k:.6g} {-k:.6g})"
        return "\n".join([f'<g transform="{place}">', *self.parts, "</g>", *self.labels, *self._bar()])

    def _bar(self) -> list[str]:
        length = max((each for each in SCALES if each * self.scale < 0.3 * self.width), default=SCALES[0])
        y, x = self.height - 8.0, 8.0 + length * self.scale
        return [
            f'<path class="scale" d="M8 {y - 4:.5g}v8m0-4H{x:.5g}m0-4v8"/>',
            f'<text x="{x + 6:.5g}" y="{y + 4:.5g}">{length:g} mm</text>',
        ]

    def line(self, *points: Point, role: str = "fixed", closed: bool = False) -> None:
        """A line through points, which may move."""
        flat = [each for point in points for each in point]
        self._add("polygon" if closed else "polyline", role, points=flat)

    def box(self, left: float, bottom: float, right: float, top: float, role: str = "fixed") -> None:
        """A rectangle."""
        self.line((left, bottom), (right, bottom), (right, top), (left, top), role=role, closed=True)

    def circle(self, at: Point, radius: float, role: str = "fixed") -> None:
        """A circle about a point; radius in mm."""
        cx, cy = (f"{self.tracks.at(each):.6g}" for each in at)
        self.parts.append(f'<circle class="{role}" cx="{cx}" cy="{cy}" r="{radius:.5g}"{_moving("at", at)}/>')

    def joint(self, *points: Point) -> None:
        """Pins that links turn about."""
        for point in points:
            self.circle(point, 3.5 / self.scale, "joint")

    def pivot(self, *points: tuple[float, float]) -> None:
        """Pins in the frame of the machine."""
        for x, y in points:
            a, b = 8.0 / self.scale, 13.0 / self.scale
            self.line((x, y), (x - a, y - b), (x + a, y - b), closed=True)
            self.joint((x, y))

    def bow(self, slope: str, length: str, at: tuple[float, float], shape: str, role: str) -> None:
        """A buckled column that starts at a point; `shape` has the points of the still position."""
        x, y = at
        self.parts.append(
            f'<polyline class="{role}" points="{shape}" data-bow="{slope} {length} {x:g} {y:g}"/>'
        )

    def curve(self, length: str, times: str, amplitudes: Sequence[str], basis: Shapes, role: str) -> None:
        """A line along a length; its height is a number of times the sum of shapes with their amplitudes."""
        along = np.linspace(0.0, self.tracks.at(length), basis.shape[1])
        heights = self.tracks.at(times) * np.array([self.tracks.at(each) for each in amplitudes]) @ basis
        shape = " ".join(f"{x:.3f} {y:.3f}" for x, y in zip(along, heights, strict=True))
        moving = _moving("curve", (length, times, *amplitudes))
        self.parts.append(f'<polyline class="{role}" points="{shape}"{moving}/>')

    @contextmanager
    def mirrored(self, x: float) -> Iterator[None]:
        """Parts whose x counts to the left, from a place."""
        self.parts.append(f'<g transform="translate({x:.6g} 0) scale(-1 1)">')
        yield
        self.parts.append("</g>")

    @contextmanager
    def group(
        self,
        shift: Point | None = None,
        turn: tuple[str, float, float] | None = None,
        shown: str = "",
        stretch: tuple[Coordinate, ...] = (),
    ) -> Iterator[None]:
        """Parts that move together: shifted, turned [deg] about a point, shown while a track is positive.

        `stretch` shifts them, too, and makes them as many times as wide and as high.
        """
        attributes = ""
        if shift:
            x, y = (f"{self.tracks.at(each):.6g}" for each in shift)
            attributes += f' transform="translate({x} {y})"{_moving("shift", shift)}'
        if stretch:
            x, y, wide, high = (f"{self.tracks.at(each):.6g}" for each in stretch)
            attributes += f' transform="translate({x} {y}) scale({wide} {high})"{_moving("stretch", stretch)}'
        if turn:
            attributes += f' transform="rotate({self.tracks.at(turn[0]):.6g} {turn[1]:g} {turn[2]:g})"'
            attributes += _moving("turn", turn)
        if shown:
            attributes += _moving("shown", (shown,)) + (" hidden" * (not self.tracks.at(shown) > 0.0))
        self.parts.append(f"<g{attributes}>")
        yield
        self.parts.append("</g>")

    def label(
        self, x: float, y: float, text: str, anchor: str = "middle", shift: tuple[float, float] = (0.0, 0.0)
    ) -> None:
        """A label at a place [mm], shifted by px."""
        px = self.scale * (x - self.left) + shift[0]
        py = self.scale * (self.top - y) + shift[1]
        self.labels.append(f'<text x="{px:.5g}" y="{py:.5g}" text-anchor="{anchor}">{escape(text)}</text>')

    def pointed(
        self, at: tuple[float, float], to: tuple[float, float], text: str, anchor: str = "middle"
    ) -> None:
        """A label at a place, with a line to what it names; the line leaves it above or below."""
        self.line(at, to, role="leader")
        self.label(*at, text, anchor, (0.0, -4.0 if at[1] > to[1] else 14.0))

    def letter(self, at: Point, text: str, shift: tuple[float, float] = (10.0, 4.0)) -> None:
        """A letter that moves with a point, shifted by px."""
        k = 1.0 / self.scale
        with self.group(shift=at):
            self.parts.append(
                f'<text transform="scale({k:.6g} {-k:.6g})" x="{shift[0]:g}" y="{shift[1]:g}"'
                f' text-anchor="middle">{escape(text)}</text>'
            )

    def _add(self, tag: str, role: str, points: Sequence[Coordinate]) -> None:
        drawn = " ".join(f"{self.tracks.at(each):.6g}" for each in points)
        self.parts.append(f'<{tag} class="{role}" points="{drawn}"{_moving("points", points)}/>')

    def figure(
        self, name: str, title: str, sentence: str, values: Sequence[Value] = (), note: str = ""
    ) -> Figure:
        """The drawing as a figure of the page."""
        verdicts = self.tracks.trace.verdicts
        shown = [
            replace(
                each,
                text=f"{self.tracks.at(each.track):.1f}".removesuffix(".0" * each.steps)
                if each.claim is None
                else verdicts[each.claim].shown_worst,
            )
            for each in values
        ]
        return Figure(name, title, sentence, self.height, self.svg, shown, note, self.width)


def title(what: str, instance: str, usual: str) -> str:
    """The title of a figure, with the instance's name unless it is the usual one."""
    return what if instance == usual else f"{what}: {instance}"


def _moving(how: str, what: Sequence[Coordinate]) -> str:
    """The attribute that tells the script what moves; nothing for what stands still."""
    if not any(isinstance(each, str) for each in what):
        return ""
    words = (each if isinstance(each, str) else f"{each:.6g}" for each in what)
    return f' data-{how}="{" ".join(words)}"'
