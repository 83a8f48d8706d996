"""The page with all that was tried, written whole from what the trials said."""

import math
from collections import Counter
from collections.abc import Iterable
from typing import Any

Said = dict[str, Any]
SEEN = 0.01  # of the largest value: what a table lists

HEAD = """# Other tools

`make foreign` writes this page from trials, each in a process of its own.
[The guide](../docs/importing.md) says how to use the tools.

## Our FMUs in other tools

The worst difference from our own run in any real output, by the largest value of that output, in {steps}
steps of 0.1 ms; 0 is equal to the last bit. "One FMU" is `WeftInsertion`. The package is a shaft that drives
a weft insertion and, over a dobby, a heald frame, where each wire is a step late: compared are all outputs of
the first three and the lift of the frame, from the third step on, since some tools start wires at 0. The
whole loom is the demo as one FMU. FMI is 2.0 where nothing else is said, and packages are of SSP 1.0, with
FMUs of FMI 3.0 of SSP 2.0.
"""
LATE = """
## The demo as a package

The same differences of the demo, over all steps of a revolution, for the outputs that are off by {seen:g} or
more in the first column, the worst of all instances of a mechanism. Each wire is a step late. What jumps, as
at a blow of a damper against its stop or where a speed limit begins, is off by the jump at the one or two
samples by which it comes late, however small the steps. What does not jump is off by less with smaller steps.
"""
CHECKERS = """
## Checkers

The native FMUs in which a checker finds no fault: all components, and the demo as one FMU.
"""
SMALL = """
## Small packages in our runs and in OMSimulator

Each package tries one thing. It is made of FMUs of Reference-FMUs: one hands its input over, the other
multiplies its state by 1 - k / 10 in each of ten steps. Values are those of one signal at the end. "By hand"
is what SSP asks for; a "wrong" package is to be refused, an "unclear" one does not say what to run. Of the
{count} that are clear our runs treat {ours} so, and OMSimulator {theirs}; ours refuse {refused} right ones.
"""
PACKAGES = """
## Packages of other makers

The worst difference of OMSimulator from our run in any signal that both record, by the largest value of that
signal, over the whole run and at the end. OMSimulator hands a value over one step after it was computed, ours
within the step, which shows wherever a wire carries what changes. A package that states no times runs 1 s in
steps of 10 ms.
"""
OTHERS = """
## FMUs of other makers in our scenes

Each FMU runs by itself, in the steps of its default experiment, at most {most}, to the tolerance that it
states. The difference is the worst from fmpy in any recorded variable, by the largest value of that variable.
fmpy hands over steps that differ in their last bits; an FMU with a solver inside makes more of that. What
supports model exchange (ME) alone is solved here, and by CVODE in fmpy. Of {count} FMUs {ran} run in both,
{refused} are refused by us{rest}.
"""


def written(
    masters: dict[str, dict[str, Said]],
    late: dict[tuple[str, int], Said],
    checkers: dict[str, dict[str, Said]],
    releases: dict[str, str],
    small: dict[str, Said],
    theirs: dict[str, Said],
    found: list[Said],
    steps: int,
    most: int,
) -> str:
    """The page."""
    cases = list(next(iter(masters.values())))
    kinds = Counter(kind(said) for said in found)
    others = {
        **{"count": len(found), "ran": kinds.pop("ran", 0), "refused": kinds.pop("refused", 0), "most": most},
        "rest": "".join(f", {number} {each}" for each, number in sorted(kinds.items())),
    }
    return "\n".join(
        [
            HEAD.format(steps=steps),
            table(
                ["tool", "version", *cases],
                (
                    [tool, releases[tool] or "not run", *map(cell, said.values())]
                    for tool, said in masters.items()
                ),
            ),
            *(f"\n{tool}: {reason}." for tool, said in masters.items() for reason in absent(said)),
            LATE.format(seen=SEEN),
            table(
                ["output", *(f"{tool}, {steps} steps" for tool, steps in late)], late_rows([*late.values()])
            ),
            CHECKERS,
            table(
                ["checker", "version", "FMI 2.0", "FMI 3.0"],
                (
                    [name, releases[name] or "not run", *map(cell, said.values())]
                    for name, said in checkers.items()
                ),
            ),
            SMALL.format(**counts(small)),
            table(
                ["package", "by hand", "ours", "OMSimulator"],
                (
                    [name, *(shown(said, each) for each in ("expected", "ours", "theirs"))]
                    for name, said in small.items()
                ),
            ),
            PACKAGES,
            table(
                ["package", "steps", "signals", "worst difference", "at the end"],
                (
                    [
                        name,
                        *(str(said.get(each, "")) for each in ("steps", "signals")),
                        cell(said),
                        exponential(said["at_end"]) if "at_end" in said else "",
                    ]
                    for name, said in sorted(theirs.items())
                ),
            ),
            OTHERS.format(**others),
            table(
                ["FMU", "made by", "FMI", "offers", "steps", "signals", "difference, or why not"],
                (
                    [
                        str(said.get(each, ""))
                        for each in ("FMU", "maker", "FMI", "offers", "steps", "signals")
                    ]
                    + [cell(said)]
                    for said in sorted(found, key=lambda said: said["FMU"])
                ),
            ),
            "",
        ]
    )


def late_rows(late: list[Said]) -> list[list[str]]:
    """The outputs that are off, the worst first, and how far in each trial."""
    worst = late[0] if late else {}
    names = sorted((name for name, off in worst.items() if off >= SEEN), key=lambda name: -worst[name])
    return [[f"`{name}`", *(f"{said.get(name, math.nan):.2g}" for said in late)] for name in names]


def kind(said: Said) -> str:
    """What a trial of an FMU of others came to, in a word."""
    return "refused" if "refused" in said else "ran" if "said" not in said else "run in ours alone"


def counts(small: dict[str, Said]) -> dict[str, int]:
    """The numbers of packages, of those that each tool treats as it must, and that ours alone refuse."""
    clear = [said for said in small.values() if said["expected"] != "unclear"]
    return {
        "count": len(clear),
        **{tool: sum(is_right(said, tool) for said in clear) for tool in ("ours", "theirs")},
        "refused": sum("refused" in said and said["expected"] != "wrong" for said in clear),
    }


def is_right(said: Said, tool: str) -> bool:
    """Return whether a tool gives the value by hand, or refuses a package that is wrong."""
    if said["expected"] == "wrong":
        reason = said.get("refused" if tool == "ours" else "said", "")
        return tool not in said and reason != "" and not reason.startswith("ends its process")
    return tool in said and agree(said[tool], said["expected"])


def agree(value: float, wanted: float) -> bool:
    """Return whether two values are the same but for rounding."""
    return math.isclose(value, wanted, rel_tol=1e-9)  # a file of OMSimulator has so many digits


def shown(said: Said, tool: str) -> str:
    """A value of a small package, or why there is none."""
    if tool in said:
        value = said[tool]
        return value if isinstance(value, str) else f"{value:.7g}"
    return str(said.get("refused" if tool == "ours" else "said", "-"))


def absent(said: dict[str, Said]) -> set[str]:
    """Why a tool was not tried."""
    return {each["absent"] for each in said.values() if "absent" in each}


def cell(said: Said) -> str:
    """What a trial came to."""
    if reason := said.get("refused") or said.get("said"):
        return str(reason)
    if "number" in said:
        return str(said["number"])
    return exponential(said.get("difference", math.nan))


def exponential(worst: float) -> str:
    """A difference."""
    return "-" if math.isnan(worst) else "0" if worst == 0.0 else f"{worst:.0e}"


def table(heads: list[str], rows: Iterable[list[str]]) -> str:
    """A table in Markdown."""
    lines = [heads, ["---"] * len(heads), *rows]
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |" for line in lines)
