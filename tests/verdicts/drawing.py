"""Random scenes with claims, the same for the same seed: what `families.toml` says, drawn."""

import math
import re
import tomllib
from collections.abc import Mapping
from fnmatch import fnmatch
from itertools import permutations
from pathlib import Path
from random import Random
from typing import Any, NamedTuple

from loomfmu import prepare
from loomfmu.cosim.scenes.scene import parse

TABLES = tomllib.loads((Path(__file__).with_name("families.toml")).read_text(encoding="utf-8"))
FAMILIES = tuple(TABLES["families"])
PLACE = re.compile(r"<(\w+)>")
NAMED, SIGNALS = 4, 5  # claims of a scene: of kinds that its family lists, and on outputs that are drawn
EXPRESSIONS = 2
COARSEST, FINEST, MANY = 24, 4000, 1440  # steps in a revolution
FASTEST = 900.0  # rev/min
JUMP = (math.log(1e-5), math.log(1e-2))  # of a revolution, from one row of a table to a near one
OWN = ("bound", "between", "also", "whole")  # what a listed claim says to this test, not to its scene


class Claim(NamedTuple):
    """A claim without its bound: its table, the argument that bounds it, and where bounds may be."""

    table: dict[str, Any]
    bound: str = ""
    between: tuple[float, float] = (-math.inf, math.inf)
    also: tuple[float, ...] = ()
    whole: bool = False

    @property
    def label(self) -> str:
        """Its kind, and the signal that `above` and `below` are about."""
        return f"{self.table['kind']} {self.table.get('signal', '')}".strip()


class Drawn(NamedTuple):
    """A random scene without its claims, the claims, the steps to judge them with, those of the truth."""

    family: str
    number: int
    text: str
    claims: list[Claim]
    settings: list[dict[str, Any]]
    fine: list[int]


def drawn(seed: int, family: str, number: int) -> Drawn:
    """The scene of a family with that number."""
    random, tables = Random(f"{seed} {family} {number}"), _family(family)
    text = _filled(tables["text"], tables["draw"], random)
    listed = random.sample(tables["claims"], min(NAMED, len(tables["claims"])))
    claims = [_listed(each, tables["draw"], random) for each in listed] + _on_outputs(text, tables, random)
    claims += _on_expressions(text, tables, Random(f"{seed} {family} {number} expressions"))
    return Drawn(family, number, text, claims, _settings(random), tables["fine"])


def _family(name: str) -> dict[str, Any]:
    common, own = TABLES["common"], TABLES["families"][name]
    like = TABLES["families"].get(own.get("like"), {"draw": {}})
    return common | like | own | {"draw": common["draw"] | like["draw"] | own["draw"]}


def _filled(text: str, draw: Mapping[str, Any], random: Random) -> str:
    """The text with all that it names drawn, and what that names in turn."""
    while places := list(PLACE.finditer(text)):
        place = min(places, key=lambda each: "at" in draw[each[1]])  # what others decide comes last
        how = draw[place[1]]
        found = _near(text, how["at"], random) if "at" in how else _value(how, random)
        text = text[: place.start()] + found + text[place.end() :]
    return text


def _near(text: str, signal: str, random: Random) -> str:
    """A speed near the lowest value that a signal has at another speed."""
    claim = f'\n[[claims]]\nkind = "above"\nsignal = "{signal}"\nbound = 1.0\n'
    with prepare(parse(PLACE.sub("400", text) + claim)) as loom:
        (verdict,) = loom.evaluate(errors="none").claims
    away = random.choice([-1.0, 1.0]) * math.exp(random.uniform(math.log(1e-6), math.log(0.1)))
    return f"{min(verdict.displayed(verdict.worst) * (1.0 + away), FASTEST):.9g}"


def _value(how: Any, random: Random) -> str:
    if isinstance(how, list):
        return f"{random.uniform(*how):.6g}"
    if "log" in how:
        return f"{math.exp(random.uniform(*map(math.log, how['log']))):.6g}"
    if "table" in how:
        times = {0.0, *(round(random.uniform(0.0, 3.0), 6) for _ in range(random.randint(1, 8)))}
        times |= {round(each + math.exp(random.uniform(*JUMP)), 6) for each in times if random.random() < 0.2}
        rows = [f'[{time}, "{random.uniform(*how["table"]):.6g} {how["unit"]}"]' for time in sorted(times)]
        return f"[{', '.join(rows)}]"
    return str(random.choice(how["of"]))


def _listed(table: Mapping[str, Any], draw: Mapping[str, Any], random: Random) -> Claim:
    """A claim that a family lists."""
    stated = {}
    for key, given in table.items():
        if key in OWN:
            continue
        if isinstance(given, list):
            stated[key] = [_filled(each, draw, random) for each in given]
        else:
            filled = _filled(given, draw, random)
            stated[key] = float(filled) if key == "tolerance" else filled
    positive = table["kind"] not in ("above", "below", "lowest_margin")
    low, high = table.get("between", [0.0 if positive else -math.inf, math.inf])
    return Claim(stated, table.get("bound", ""), (low, high), tuple(table.get("also", ())), "whole" in table)


def _on_outputs(text: str, tables: Mapping[str, Any], random: Random) -> list[Claim]:
    """Claims `above` and `below` on random outputs, some within a random window of the shaft's angle."""
    fitting = list(_outputs(text, tables))
    found = []
    for signal in random.sample(fitting, min(SIGNALS, len(fitting))):
        table: dict[str, Any] = {"kind": random.choice(["above", "below"]), "signal": signal}
        if random.random() < 0.4:
            start, width = random.uniform(0.0, 360.0), math.exp(random.uniform(0.0, math.log(300.0)))
            table["window"] = [f"{start:.6g} deg", f"{(start + width) % 360.0:.6g} deg"]
        found.append(Claim(table, "bound"))
    return found


def _outputs(text: str, tables: Mapping[str, Any]) -> dict[str, str]:
    """The outputs that claims may be on, with their units."""
    found = {
        f"{name}.{port.name}": port.unit
        for name, instance in parse(text).instances.items()
        for port in instance.fmu.ports.values()
        if port.causality == "output" and port.kind == "Real"
    }
    return {
        name: unit for name, unit in found.items() if any(fnmatch(name, some) for some in tables["outputs"])
    }


def _on_expressions(text: str, tables: Mapping[str, Any], random: Random) -> list[Claim]:
    """Claims `above` and `below` on expressions of two outputs of the same unit, some with a third factor."""
    units = _outputs(text, tables)
    pairs = [pair for pair in permutations(units, 2) if units[pair[0]] == units[pair[1]]]
    found = []
    for one, other in random.sample(pairs, min(EXPRESSIONS, len(pairs))):
        share, third = f"{random.uniform(0.3, 2.0):.3g}", random.choice([one, other])
        size = f"(1 {units[third]})" if units[third] != "1" else "1"
        kind, form = random.choice(
            [
                (random.choice(["above", "below"]), "{one} - {share} * {other}"),
                (random.choice(["above", "below"]), "{share} * {one} * {third} / {size} - {other}"),
                ("below", "abs({one} + {share} * {other})"),
                ("below", "max({one}, {share} * {other}) - {third} * {third} / {size}"),
                ("above", "min({one}, -{share} * {other})"),
            ]
        )
        signal = form.format(one=one, other=other, share=share, third=third, size=size)
        found.append(Claim({"kind": kind, "signal": signal}, "bound"))
    return found


def _settings(random: Random) -> list[dict[str, Any]]:
    """Steps, some many and some few, and an accuracy."""
    key = "steps_per_revolution"
    low, middle, high = map(math.log, (COARSEST, MANY, FINEST))
    few = [round(math.exp(random.uniform(low, middle))) for _ in range(3)]
    many = [random.choice([MANY, round(math.exp(random.uniform(middle, high)))]) for _ in range(2)]
    return [
        {key: few[0]},
        {key: few[1] // 2 * 2},
        {key: many[0]},
        {key: few[2]},
        {key: many[1]},
        {"accuracy": 10.0 ** random.uniform(-7.0, -3.0)},
    ]
