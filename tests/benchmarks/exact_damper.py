"""The heald carrier on its springs by its own impulse response, in 30 digits.

Between two changes of contact it is a linear oscillator: `z'' + c z' + k z = u(t)`, and its state after a
time is that of the homogeneous equation plus the response to u, an integral that Gauss' rule gives to all
digits, since u is analytic between the knots of the frame's law. The rules of contact stand in
`damper_reference`, which integrates step by step.
"""

from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import damper_reference
import mpmath
import neighbours  # noqa: F401  the other reference
from damper_reference import FREE, PRESSING

from loomfmu.components import HealdDamper
from loomfmu.physics.damper import stop_damping_ratio

MP = mpmath.mp.clone()
MP.dps = 30
PIECES = 120  # in a revolution: 0.05 of the shortest period each
NODES = mpmath.calculus.quadrature.GaussLegendre(MP).calc_nodes(3, MP.prec)  # 12 nodes


@dataclass(frozen=True)
class Piece:
    """A stretch of time with one contact: its start, and the state there."""

    time: Any
    displacement: Any
    rate: Any
    contact: str
    side: float


class Carrier(damper_reference.Carrier):
    """The carrier of the default damper over a duration [s], under a frame's acceleration [m/s2]."""

    def __init__(self, acceleration: Callable[[Any], Any], knots: Sequence[Any], duration: Any) -> None:
        damper = HealdDamper()
        self.acceleration = acceleration
        self.mass, self.travel = MP.mpf(damper.carrier_mass), MP.mpf(damper.free_travel)
        self.spring, self.stop_spring = 4 * MP.mpf(damper.spring_stiffness), MP.mpf(damper.stop_stiffness)
        self.damping = 2 * MP.mpf(damper.damping_ratio) * MP.sqrt(self.spring * self.mass)
        ratio = MP.mpf(stop_damping_ratio(damper.stop_restitution))
        self.stop_damping = 2 * ratio * MP.sqrt(self.stop_spring * self.mass)
        self.contacts, self.peak_load = 0, MP.mpf(0)
        self._states: dict[tuple[Piece, Any], tuple[Any, Any]] = {}
        self.pieces = [Piece(MP.mpf(0), MP.mpf(0), MP.mpf(0), FREE, 0)]
        grid = [duration * n / PIECES for n in range(1, PIECES + 1)]
        for end in sorted([*grid, *knots]):
            self._go(end)

    def at(self, time: Any) -> Any:
        """Displacement at a time [m]."""
        place = bisect_right(self.pieces, time, key=lambda piece: piece.time)
        return self._after(self.pieces[max(0, place - 1)], time)[0]

    def _go(self, end: Any) -> None:
        """Go on to a time, over all changes of contact on the way."""
        while self.pieces[-1].time < end:
            piece = self.pieces[-1]
            passed = [self._passed(piece, event, end) for event in self._events(piece)]
            time, which = min(((time, which) for which, time in enumerate(passed) if time), default=(end, -1))
            displacement, rate = self._after(piece, time)
            self._note(piece, time)
            contact, side = piece.contact, piece.side
            if which >= 0:
                contact, side = self.after(contact, side, which, displacement)
                self.contacts += piece.contact == FREE
            self.pieces.append(Piece(time, displacement, rate, contact, side))

    def _on_stop(self, piece: Piece) -> tuple[Any, Any, Any]:
        """Stiffness and damping over the mass, and the force at rest, over the mass."""
        pressed = piece.contact == PRESSING
        stiffness = (self.spring + pressed * self.stop_spring) / self.mass
        damping = (self.damping + pressed * self.stop_damping) / self.mass
        return stiffness, damping, pressed * piece.side * self.stop_spring * self.travel / self.mass

    def _after(self, piece: Piece, time: Any) -> tuple[Any, Any]:
        """Displacement and rate at a time of the piece; kept, as each is asked for several times."""
        if (piece, time) not in self._states:
            self._states[piece, time] = self._found(piece, time)
        return self._states[piece, time]

    def _found(self, piece: Piece, time: Any) -> tuple[Any, Any]:
        """Displacement and rate at a time of the piece."""
        stiffness, damping, preload = self._on_stop(piece)
        own = MP.sqrt(stiffness - damping**2 / 4)  # all contacts of this damper are underdamped

        def response(duration: Any) -> tuple[Any, Any]:
            """What an impulse leaves: displacement and rate."""
            decay = MP.exp(-damping * duration / 2)
            cosine, sine = MP.cos_sin(own * duration)
            return decay * sine / own, decay * (cosine - damping * sine / (2 * own))

        duration = time - piece.time
        moved, moving = response(duration)
        z = piece.displacement * (moving + damping * moved) + piece.rate * moved
        v = piece.rate * moving - piece.displacement * stiffness * moved
        for node, weight in NODES:
            moment = duration * (1 + node) / 2
            drive = preload - self.acceleration(piece.time + moment)
            moved, moving = response(duration - moment)
            z += weight * duration / 2 * moved * drive
            v += weight * duration / 2 * moving * drive
        return z, v

    def _events(self, piece: Piece) -> list[Callable[[Any, Any], Any]]:
        """What rises through zero where a contact ends."""
        side = piece.side
        if piece.contact == FREE:
            return [lambda z, v: z - self.travel, lambda z, v: -z - self.travel]
        if piece.contact == PRESSING:
            return [lambda z, v: -self.press(side, z, v)]
        return [lambda z, v: self.travel - side * z, lambda z, v: self.press(side, z, v)]

    def _passed(self, piece: Piece, event: Callable[[Any, Any], Any], end: Any) -> Any:
        """When an event comes within the piece, or None."""

        def value(time: Any) -> Any:
            return event(*self._after(piece, time))

        if value(end) <= 0 or value(piece.time) > 0:
            return None
        return _root(value, piece.time, end)

    def _force(self, piece: Piece, z: Any, v: Any) -> Any:
        """Force of the carrier on the frame."""
        stiffness, damping, preload = self._on_stop(piece)
        return self.mass * (stiffness * z + damping * v - preload)

    def _note(self, piece: Piece, end: Any) -> None:
        """Bring the peak load up to date with the way from the start of a piece to its end."""

        def rate(time: Any) -> Any:
            stiffness, damping, preload = self._on_stop(piece)
            z, v = self._after(piece, time)
            return stiffness * v + damping * (preload - self.acceleration(time) - stiffness * z - damping * v)

        times = [piece.time, end]
        if rate(piece.time) * rate(end) < 0:
            times.append(_root(rate, piece.time, end))
        for time in times:
            self.peak_load = max(self.peak_load, abs(self._force(piece, *self._after(piece, time))))


def _root(function: Callable[[Any], Any], low: Any, high: Any) -> Any:
    """Where a function changes its sign: regula falsi with Illinois' halving, to 1e-25 of the way."""
    at_low, at_high = function(low), function(high)
    way = high - low
    for _ in range(60):
        place = (low * at_high - high * at_low) / (at_high - at_low)
        found = function(place)
        if abs(high - low) < way * MP.mpf("1e-25") or abs(found) < MP.mpf("1e-27"):
            return place
        if found * at_high < 0:
            low, at_low = high, at_high
        else:
            at_low /= 2
        high, at_high = place, found
    return place
