"""Claims on expressions of signals: each is judged as a signal whose curve follows from theirs."""

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np

from ...traces import Signals, Verdict
from .bounded import Above, Below, Bounded
from .conditions import Always, Condition, Sum, Unprovable, present
from .expressed import Expressed, as_float
from .expressions import MOST_CASES, Expression
from .judging import Question, run_of
from .movers import Wired


class _OfExpression(Bounded, kind=False):
    """An expression stays on one side of a bound.

    An `abs`, `max` or `min` that the bound can be taken into gives several smooth expressions, the cases,
    which must all keep it. With any other one the values between the samples are not known.
    """

    not_live = "a page judges signals, not expressions"

    @property
    def _expression(self) -> Expression:
        assert isinstance(self.signal, Expression), "claims on plain signals are of other classes"
        return self.signal

    def signals(self, scene: Wired) -> list[str]:
        return list(self._expression.node.signals)

    def extremes(self) -> list[tuple[str, float]]:
        cases = [] if self.at_samples else self._cases
        smooth = all(case._expression.node.smooth for case in cases)
        return [(str(case.signal), self.sense) for case in cases if smooth]

    def motions(self, run: Signals) -> list[tuple[Signals, str, float]]:
        return [(Expressed(run, case._expression), str(case.signal), self.sense) for case in self._cases]

    def unit_in(self, run: Wired) -> str:
        return self._expression.unit

    def question(self, trace: Signals) -> Question:
        return super().question(Expressed(trace, self._expression))

    @property
    def _cases(self) -> list["_OfExpression"]:
        """Claims on smooth expressions that hold together where this holds."""
        if self.at_samples:
            return [self]
        return [replace(self, signal=each) for each in self._expression.cases(self.sense)]

    def _alone(self, trace: Signals) -> Verdict:
        run = Expressed(trace, self._expression)
        found = run_of(trace).verdict(run, super().question(run), self.name)
        return replace(found, holds=False, decided=False, error=np.inf, note=run.why) if run.why else found

    def _judged(self, trace: Signals) -> list[tuple["_OfExpression", Verdict]]:
        return [(case, case._alone(trace)) for case in self._cases]

    def judge(self, trace: Signals) -> Verdict:
        found = self._whole([verdict for _case, verdict in self._judged(trace)])
        if found.decided or self.at_samples or not self._expression.has_too_many_cases(self.sense):
            return found
        many = (
            f"its abs, max and min make more than the {MOST_CASES} cases that can be judged between samples"
        )
        return replace(found, note="; ".join(filter(None, (found.note, many))))

    def _whole(self, cases: list[Verdict]) -> Verdict:
        """Return the verdict of the worst value; if that holds, it is as undecided as any other case."""
        worst, open_ = min(cases, key=self._rank), [each for each in cases if not each.holds]
        if worst.holds and open_:
            worst = replace(worst, holds=False, decided=False, error=open_[0].error, note=open_[0].note)
        return replace(worst, signal=str(self.signal))

    def _rank(self, verdict: Verdict) -> tuple[bool, float]:
        return not np.isnan(verdict.worst), self.sense * verdict.worst

    def settled(
        self, trace: Signals, verdict: Verdict, spread: float, share: float, scatter: float, noise: float
    ) -> Verdict:
        return self._whole(
            [case._settled(trace, each, spread, share, scatter, noise) for case, each in self._judged(trace)]
        )

    def _settled(
        self, trace: Signals, verdict: Verdict, spread: float, share: float, scatter: float, noise: float
    ) -> Verdict:
        """Return the verdict on this case alone; a difference has at least the errors of its two values."""
        run = Expressed(trace, self._expression)
        if run.why:
            return verdict
        noise, asked = max(noise, run.noise(share, scatter)), super().question(run)
        return run_of(trace).settled(run, asked, verdict, spread, noise, share, 0.0)

    def left_by_model(self, trace: Signals, verdict: Verdict) -> float:
        case, own = min(self._judged(trace), key=lambda each: self._rank(each[1]))
        run = Expressed(trace, case._expression)
        return run_of(trace).model_error(run, Bounded.question(case, run), own)

    def conditions(self, run: Wired) -> tuple[Condition, ...]:
        return tuple(case._condition(run) for case in self._cases)

    def _condition(self, run: Wired) -> Condition:
        """Return what must be so at every shaft angle, for a sum. Raises Unprovable for anything else."""
        linear = self._expression.node.linear
        if linear is None:
            raise Unprovable("it is on an expression that is not a sum of shares of signals")
        shares, constant = linear
        for name in shares:
            if present(name, run, self.sense) != name:
                raise Unprovable(f"{name} depends on the run so far")
        terms = [(_float(self.sense * share), name) for name, share in shares.items()]
        if isinstance(self.bound, str):
            terms.append((float(-self.sense), self.bound))
        else:
            constant -= Fraction(self.bound)
        return Always((Sum(tuple(terms), _float(self.sense * constant)),), self.window)


def _float(exact: Fraction) -> float:
    """Return a number as a float. Raises Unprovable where it is too large or too small for that."""
    found = as_float(exact)
    if math.isinf(found) or (exact and not found):
        raise Unprovable("it has numbers that are too large or too small")
    return found


class AboveExpression(_OfExpression, Above, kind=False):
    """An expression stays at or above a bound."""


class BelowExpression(_OfExpression, Below, kind=False):
    """An expression stays at or below a bound."""


of_expression: dict[str, type[_OfExpression]] = {"above": AboveExpression, "below": BelowExpression}
