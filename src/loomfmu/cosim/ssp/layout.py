"""The drawing of a system: its elements from left to right, each after those that it depends on."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ..scenes.graph import Wire, step_order

WIDTH, GAP = 60.0, 40.0  # of an element, and between columns and rows
PER_CONNECTOR = 5.0  # height


@dataclass(frozen=True)
class Box:
    """An element's rectangle, and the heights of its connectors in it, as shares of its own."""

    left: float
    bottom: float
    height: float
    inputs: dict[str, float]
    outputs: dict[str, float]

    @property
    def right(self) -> float:
        """Right edge."""
        return self.left + WIDTH

    @property
    def top(self) -> float:
        """Upper edge."""
        return self.bottom + self.height


def layout(
    names: Sequence[str], wires: Sequence[Wire], ports: Mapping[str, tuple[Sequence[str], Sequence[str]]]
) -> dict[str, Box]:
    """A box for each element; `ports` are the names of its inputs and outputs, from the top down."""
    boxes: dict[str, Box] = {}
    below: dict[int, float] = {}
    depths = columns(names, wires)
    for name in names:
        inputs, outputs = ports[name]
        column = depths[name]
        height = PER_CONNECTOR * (1 + max(len(inputs), len(outputs), 3))
        bottom = below.get(column, 0.0) - height
        below[column] = bottom - GAP / 2
        boxes[name] = Box(column * (WIDTH + GAP), bottom, height, _heights(inputs), _heights(outputs))
    return boxes


def columns(names: Sequence[str], wires: Sequence[Wire]) -> dict[str, int]:
    """Return the column of each element, counted from 0; wires that close a loop lead back.

    >>> columns(["b", "a"], [Wire(("a", "y"), ("b", "u"))])
    {'a': 0, 'b': 1}
    """
    order, lagged = step_order(names, wires)
    depths: dict[str, int] = {}
    before: dict[str, list[str]] = {name: [] for name in order}
    for wire in dict.fromkeys(wires).keys() - set(lagged):
        before[wire.sink[0]].append(wire.source[0])
    for name in order:
        depths[name] = max((depths[source] + 1 for source in before[name] if source in depths), default=0)
    return depths


def _heights(connectors: Sequence[str]) -> dict[str, float]:
    return {name: 1.0 - place / (len(connectors) + 1) for place, name in enumerate(connectors, start=1)}


def bends(wire: Wire, boxes: Mapping[str, Box]) -> tuple[list[float], list[float]]:
    """The two corners of a wire: it turns in the gap before its sink, each wire at a place of its own."""
    source, sink = boxes[wire.source[0]], boxes[wire.sink[0]]
    start = source.bottom + source.height * source.outputs[wire.source[1]]
    end = sink.bottom + sink.height * sink.inputs[wire.sink[1]]
    share = sink.inputs[wire.sink[1]]
    corner = sink.left - GAP * (0.2 + 0.6 * share)
    return [round(corner, 3)] * 2, [round(start, 3), round(end, 3)]
