"""The shafts that move what a claim judges: whole revolutions of these matter."""

from collections.abc import Container, Iterable, Mapping

from ...components.shaft_driven import FOLLOWED

ANGLE_INPUT, ANGLE = next(iter(FOLLOWED.items()))


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
        given, own = f"{name}.{ANGLE_INPUT}", f"{name}.{ANGLE}"
        if own in signals:  # it is a shaft
            found[own] = None
            continue
        if given in wires or given in signals:
            found[wires.get(given, given)] = None
        for sink, source in wires.items():
            owner, _dot, variable = sink.rpartition(".")
            if owner == name and variable not in FOLLOWED:
                waiting.append(source.partition(".")[0])
    return tuple(found)
