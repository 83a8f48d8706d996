"""Claims: assertions on a recorded run, each judged to a verdict.

`judge(trace, kind="above", signal="belt.margin", bound=0.0)` returns a `Verdict`, which is true if the claim
holds: `assert judge(...)`. Scenes state the same as `[[claims]]` tables, with units. Each kind is one class.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import MISSING, fields
from pathlib import Path
from typing import Any

from ...errors import LoomfmuError, shown, suggestion
from ...own import load
from ...traces import Verdict
from ..standard import standard
from . import expressions
from .claim import Claim
from .expression_claims import of_expression
from .expressions import Expression, is_expression
from .own_claims import own_claim


def kinds() -> Mapping[str, type[Claim]]:
    """Return the class of each kind of claim, those on the standard machine included."""
    standard()
    return Claim.kinds


def read(table: Mapping[str, Any], unit_of: Callable[[str], str], directory: Path | None = None) -> Claim:
    """The claim that a table of a scene states. `unit_of` gives the unit of a signal.

    A kind may be a Python file, from the scene's `directory`; it is run.

    Raises:
        LoomfmuError: what is unknown, missing, or cannot be read or compared
    """
    kind, where = table.get("kind"), place_of(table)
    if not isinstance(kind, str) or not (load.is_file(kind) or kind in kinds()):
        raise LoomfmuError(f"claim kind = {kind!r} is unknown{suggestion(str(kind), kinds())}")
    chosen = own_claim(kind, directory, where) if load.is_file(kind) else kinds()[kind]
    arguments, values = chosen.declared(), dict[str, Any]()
    for name in table:
        if name not in arguments and name != "kind":
            raise LoomfmuError(f"{where} has no {name!r}{suggestion(name, arguments)}")
    if kind in of_expression and is_expression(str(table.get("signal", "missing"))):
        signal = expressions.read(table["signal"], unit_of, f"{where}: signal")
        table, chosen = {**table, "signal": signal}, of_expression[kind]
    for each in fields(chosen):
        value = table.get(each.name)
        if each.name not in table and each.default is MISSING:
            raise LoomfmuError(f"{where} needs {each.name!r}")
        if value is not None or each.default is MISSING:
            values[each.name] = arguments[each.name].read(
                value, f"{where}: {each.name}", lambda: _unit_of(table["signal"], unit_of)
            )
    return chosen(**values)


def _unit_of(signal: str, unit_of: Callable[[str], str]) -> str:
    return signal.unit if isinstance(signal, Expression) else unit_of(signal)


def place_of(table: Mapping[str, Any]) -> str:
    """Return what messages call a claim of a scene: by its name, or by its kind if it has none."""
    return f"claim {shown(table.get('name') or table.get('kind'))}"


def name_of(table: Mapping[str, Any]) -> str:
    """Return the name of a claim of a scene: its own, or its kind."""
    return str(table.get("name") or table["kind"])


def called(table: Mapping[str, Any], verdict: Verdict) -> str:
    """Return the name of a verdict's claim in tables: its own name, or its kind and signal."""
    return str(table.get("name") or f"{verdict.claim} ({verdict.signal})")


def angles_in(claim: Claim, table: Mapping[str, Any]) -> list[str]:
    """The arguments in a claim's table that are shaft angles."""
    arguments = claim.declared()
    return [name for name in table if name != "kind" and arguments[name].unit == "rad"]


def doubts(claim: Claim, table: Mapping[str, Any]) -> Iterator[str]:
    """Numbers of a claim's table that were probably meant in another unit."""
    for name, declared in claim.declared().items():
        if name in table:
            yield from declared.doubts(table[name], f"{place_of(table)}: {name}")
