"""Claims of one's own: a class in a Python file beside the scene computes the number that is judged."""

import inspect
import sys
from abc import abstractmethod
from collections.abc import Iterable, Mapping
from dataclasses import fields, replace
from math import inf, nan
from numbers import Real
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import LoomfmuError, listed, shown
from ...own import load
from ...traces import Signals, Verdict
from .arguments import Quantity
from .claim import AT_LEAST, AT_MOST, Claim
from .conditions import Condition, Unprovable
from .judging import Form, Question
from .movers import Wired

BOUNDS = {"at_most": AT_MOST, "at_least": AT_LEAST}  # the arguments that may be the bound


class OwnClaim(Claim, kind=False):
    """A number that the class computes from a run stays on one side of `at_most` or `at_least`.

    Subclasses declare one of these by `argument(Quantity(...))`, which gives the unit, name the signals that
    they need in `needs` or by the method `signals`, and compute the number by `value`.
    """

    not_live = "its Python code does not run in a page"

    def __init_subclass__(cls) -> None:
        super().__init_subclass__(kind=False)
        cls.sense = AT_MOST if cls._bounds() == ["at_most"] else AT_LEAST

    @classmethod
    def _bounds(cls) -> list[str]:
        return [each.name for each in fields(cls) if each.name in BOUNDS]

    @abstractmethod
    def value(self, run: Signals) -> float | tuple[float, float]:
        """Return the number to be judged, in SI, perhaps with its time [s]; NaN where there is none."""

    @property
    def _file(self) -> Path:
        return Path(getattr(sys.modules.get(type(self).__module__), "__file__", None) or "claim.py")

    def question(self, trace: Signals) -> Question:
        (bound,) = self._bounds()
        declared, words = self.declared()[bound], type(self).__name__
        assert isinstance(declared, Quantity), "own_claims.check has seen to it"
        unit = declared.unit, declared.display or declared.unit
        form = Form(_words(words), f"{self._file.name}:{words}", unit, self.sense)
        signals = [each for each in trace if each in set(self.signals(trace))]
        return Question("given", [form], signals, [getattr(self, bound), *self._found(trace), 0.0])

    def _found(self, trace: Signals) -> tuple[float, float]:
        """Return the number and its time. Raises LoomfmuError for what the code raises."""
        try:
            found = self.value(trace)
        except LoomfmuError:
            raise
        except Exception as error:
            raise load.failed(error, self._file) from None
        number, time = found if isinstance(found, tuple) and len(found) == 2 else (found, nan)
        if not isinstance(number, Real) or not isinstance(time, Real):
            raise LoomfmuError(
                f"{self._file.name}:{type(self).__name__}: value = {shown(found)} is neither a number nor a"
                " number and its time"
            )
        return float(number), float(time)

    def judge(self, trace: Signals) -> Verdict:
        verdict = super().judge(trace)
        flags = dict.fromkeys(filter(None, map(trace.validity, self.signals(trace))))
        unknown = [each for each in flags if not np.all(trace[each])]
        if not unknown:
            return verdict
        why = f"not known throughout the run, as {listed(unknown)} is false in part of it"
        note = "; ".join(filter(None, (verdict.note, why)))
        return replace(verdict, holds=False, decided=False, error=inf, note=note)

    def conditions(self, run: Wired) -> tuple[Condition, ...]:
        raise Unprovable("it is judged by Python code of its own")


def _words(name: str) -> str:
    """The name of a class in words.

    >>> _words("FramesApart")
    'frames apart'
    """
    return "".join(f" {each.lower()}" if each.isupper() else each for each in name).strip()


def _check(chosen: type[OwnClaim], path: Path, text: str) -> None:
    """Refuse a class whose arguments could not be read."""
    where = f"{path}, line {load.line(text, chosen.__name__, '')}: {chosen.__name__}"
    for each in fields(chosen):
        if "argument" not in each.metadata:
            raise LoomfmuError(f"{where}.{each.name} is not declared by argument(...)")
    bounds = chosen._bounds()
    if len(bounds) != 1 or not isinstance(chosen.declared()[bounds[0]], Quantity):
        raise LoomfmuError(
            f"{where} must have one bound: at_most or at_least, such as"
            ' at_most: float = argument(Quantity("m", "mm"))'
        )


WANTED = load.Wanted(
    OwnClaim,
    "claim",
    "declare a class on OwnClaim of loomfmu.claim, with a method value",
    lambda each: not inspect.isabstract(each),
    _check,
)


def own_claim(spec: str, directory: Path | None, where: str) -> type[OwnClaim]:
    """Return the class that `FILE.py:Class` names, from a scene's directory; the file is run.

    Raises LoomfmuError, naming file and line, for one that cannot judge, and where no scene names it.
    """
    if directory is None:
        raise LoomfmuError(f"{where}: kind = {spec!r}: only the file of a scene can name a Python file")
    try:
        found: type[OwnClaim] = load.with_texts(spec, directory, WANTED)[0]
    except LoomfmuError as error:
        raise LoomfmuError(f"{where}: kind: {error}") from None
    if inspect.isabstract(found):
        raise LoomfmuError(f"{where}: kind = {spec!r}: {found.__name__} has no method value")
    return found


def texts(tables: Iterable[Mapping[str, Any]], directory: Path) -> dict[str, str]:
    """Return the texts of the Python files that claims of a scene name."""
    found = dict[str, str]()
    for table in tables:
        if load.is_file(kind := table.get("kind")):
            own_claim(str(kind), directory, f"claim {shown(table.get('name') or kind)}")
            found |= load.texts(str(kind), directory, WANTED)
    return found
