"""The shafts that move what a claim judges: whole revolutions of these matter."""

from collections.abc import Container, Iterable, Mapping

from ...components.shaft_driven import ShaftDriven
from ...components.terminals import SHAFT

FOLLOWING = ShaftDriven.terminals[0].variables  # the inputs of what follows a shaft, its angle first
ANGLE = SHAFT.members[0]  # the output of a shaft


def shafts_of(
    instances: Iterable[str], wires: Mapping[str, str], signals: Container[object]
) -> tuple[str, ...]:
    """Return the signals of the angles of the shafts that move some instances, directly or through others.

    What drives such a shaft does not count. `wires` go from input to output; `signals` are those of the run.
    """
    found, passed, waiting = dict[str, None](), set[str](), sorted(instances)
    while waiting:
        name = waiting.pop()
        if name in passed:
            continue
        passed.add(name)
        given, own = f"{name}.{FOLLOWING[0]}", f"{name}.{ANGLE}"
        if own in signals:  # it is a shaft
            found[own] = None
            continue
        if given in wires or given in signals:
            found[wires.get(given, given)] = None
        for sink, source in wires.items():
            owner, _dot, variable = sink.rpartition(".")
            if owner == name and variable not in FOLLOWING:
                waiting.append(source.partition(".")[0])
    return tuple(found)
