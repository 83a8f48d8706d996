"""A run in which an expression is a signal, too: its samples, its rates, and how far they may be off.

Where the rates of all signals are known, so are those of their sums, products and quotients. Between the
samples an expression thus follows a curve of its own, as a recorded signal does.
"""

import math
from collections.abc import Mapping
from fractions import Fraction
from functools import reduce
from itertools import pairwise

import numpy as np

from ...errors import listed
from ...traces import Signals
from ...traces.extended import Extended
from ...traces.signals import Floats
from ...traces.verdict import place_text
from .expressions import Expression, Node

Jet = list[Floats]  # values, then rates and second rates as far as they are known
RATES = "rate of ", "second rate of "
ROUNDING, TINY = 2.0**-52, 5e-324  # of a number beside a smaller sum, and of one that is hardly more than 0


class Expressed(Extended):
    """A run with one expression more, under its text.

    Where it divides by 0 it has no values, and `why` says so; the text is empty otherwise.
    """

    def __init__(self, run: Signals, expression: Expression):
        super().__init__(run, {}, {}, expression.unit)
        self._node, self._display, self.why = expression.node, expression.display(run.display), ""
        with _not_finite():
            values, *rates = self._jet(self._node)
        names = [str(expression), *(f"{each}{expression}" for each in RATES)]
        self._made = dict(zip(names, [values, *rates], strict=False))
        self._rates = dict(pairwise(self._made))
        self._beside = self._others(names[0])

    # ---- the expression

    def _jet(self, node: Node) -> Jet:
        """Return the samples of a part of the expression, in SI."""
        if node.linear is not None:
            shares, constant = node.linear
            parts = [
                [as_float(share) * e for e in self._recorded_jet(name)] for name, share in shares.items()
            ]
            if constant or not shares:
                parts.append([np.full(len(self.time), as_float(constant)), *2 * [np.zeros(len(self.time))]])
            return _sum(parts)
        parts = [self._jet(part) for part in node.parts]
        if node.kind == "neg":
            return [-each for each in parts[0]]
        if node.kind == "+":
            return _sum(parts)
        if node.kind == "*":
            return reduce(_product, parts)
        if node.kind == "/":
            return self._quotient(node, *parts)
        if node.kind == "abs":
            return [np.abs(parts[0][0])]
        return [reduce(np.minimum if node.kind == "min" else np.maximum, [each[0] for each in parts])]

    def _recorded_jet(self, signal: str) -> Jet:
        """Return the samples of a signal with its rates; those of what stays the same are 0."""
        found, name = [np.asarray(self._run[signal], dtype=float)], self._run.rate(signal)
        while name and len(found) <= len(RATES):
            found.append(np.asarray(self._run[name], dtype=float))
            name = self._run.rate(name)
        steady = self._run.beside(signal, "lowest") == self._run.beside(signal, "highest") == signal
        if len(found) == 1 and steady and np.all(found[0] == found[0][0]):
            found += 2 * [np.zeros(len(self.time))]
        return found

    def _quotient(self, node: Node, above: Jet, below: Jet) -> Jet:
        """Return a quotient; it is known only at the samples where its denominator may pass 0 in between."""
        values = below[0]
        passes = (values == 0.0) | (np.sign(values) == -np.sign(values[0]))
        if np.any(passes):
            place = int(np.argmax(passes))
            angle, turn = self.shaft_angle[place], 2.0 * np.pi
            revolution = int(angle // turn) + 1 if "shaft.angle" in self._run else None
            where = place_text(float(self.time[place]), float(angle % turn), revolution)
            self.why = f"it divides by {node.parts[1].text}, which is or passes 0 at {where}"
            return [np.full(len(values), np.nan)]
        found = [above[0] / values]
        if len(above) > 1 and len(below) > 1 and not _may_pass_zero(self.time, below):
            found.append((above[1] - found[0] * below[1]) / values)
            if len(above) > 2 and len(below) > 2:
                found.append((above[2] - 2.0 * found[1] * below[1] - found[0] * below[2]) / values)
        return found

    def _off(self, node: Node, off: Mapping[str, Floats]) -> tuple[Floats, Floats]:
        """Return the samples of a part, and how far they are off if signals are off by so much, in SI."""
        values = self._jet(node)[0]
        if node.linear is not None:
            shares, constant = node.linear
            error = np.full(len(self.time), ROUNDING * abs(as_float(constant)) + TINY)
            for name, share in shares.items():
                here = np.abs(np.asarray(self._run[name], dtype=float))
                error += abs(as_float(share)) * (off[name] + ROUNDING * here) + TINY * here
            return values, error
        parts = [self._off(part, off) for part in node.parts]
        errors = [error for _values, error in parts]
        if node.kind == "*":
            (one, here), (other, there) = parts
            return values, np.abs(one) * there + np.abs(other) * here + here * there + TINY
        if node.kind == "/":
            left = np.abs(parts[1][0]) - errors[1]
            known = (errors[0] + np.abs(values) * errors[1]) / np.where(left > 0.0, left, 1.0) + TINY
            return values, np.where(left > 0.0, known, np.inf)
        if node.kind == "+":
            return values, errors[0] + errors[1]
        return values, np.maximum.reduce(errors)

    def noise(self, share: float, scatter: float) -> float:
        """Return how far it is off if its signals are by that share, and by `scatter` times their changes."""
        off = {}
        for name in self._node.signals:
            values = np.asarray(self._run[name], dtype=float)
            off[name] = share * np.abs(values) + scatter * np.abs(values - values[0])
        with _not_finite():
            return float(np.max(self._off(self._node, off)[1]))

    def _others(self, name: str) -> dict[str, str]:
        """Add what says when the expression is known and how far it is off; return these by their roles."""
        signals, found = self._node.signals, dict[str, str]()
        flags = list(dict.fromkeys(filter(None, map(self._run.validity, signals))))
        errors = {each: self._run.error(each) for each in signals}
        if len(flags) == 1:
            found["valid_if"] = flags[0]
        elif flags:
            found["valid_if"] = listed(flags)
            self._made[found["valid_if"]] = np.minimum.reduce([self._run[each] for each in flags])
        if any(errors.values()):
            zero = np.zeros(len(self.time))
            off = {each: np.abs(self._run[other]) if other else zero for each, other in errors.items()}
            found["error"] = f"error of {name}"
            with _not_finite():
                self._made[found["error"]] = self._off(self._node, off)[1]
        return found

    def beside(self, signal: str, role: str) -> str | None:
        """The signal that says more of this one in a role of `Beside`, if there is one."""
        if signal == next(iter(self._made)):
            return self._beside.get(role)
        return super().beside(signal, role)


def _not_finite() -> np.errstate:
    """Say nothing of numbers that are not finite: the verdict does."""
    return np.errstate(over="ignore", invalid="ignore")


def _sum(parts: list[Jet]) -> Jet:
    return [sum(each[1:], each[0]) for each in zip(*parts, strict=False)]


def as_float(exact: Fraction) -> float:
    """Return a number as a float, which is infinite where that is too small for it."""
    try:
        return float(exact)
    except OverflowError:  # the verdict says what is not finite
        return math.inf if exact > 0 else -math.inf


def _product(one: Jet, other: Jet) -> Jet:
    found = [one[0] * other[0]]
    if min(len(one), len(other)) > 1:
        found.append(one[1] * other[0] + one[0] * other[1])
    if min(len(one), len(other)) > 2:
        found.append(one[2] * other[0] + 2.0 * one[1] * other[1] + one[0] * other[2])
    return found


def _may_pass_zero(time: Floats, jet: Jet) -> bool:
    """Return whether a cubic that joins the samples may reach 0: its Bernstein points enclose it."""
    third, (values, rates, *_more) = np.diff(time) / 3.0, jet
    points = np.array([values[:-1], values[:-1] + third * rates[:-1], values[1:] - third * rates[1:]])
    return bool(np.any(np.sign(points) != np.sign(values[0])))
