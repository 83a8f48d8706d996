"""Dependencies by name, direct or through others."""

from collections.abc import Collection, Iterable, Mapping


def sources_of(pairs: Iterable[tuple[str, str]]) -> dict[str, set[str]]:
    """The sources of each sink, from pairs of a source and a sink."""
    found: dict[str, set[str]] = {}
    for source, sink in pairs:
        found.setdefault(sink, set()).add(source)
    return found


def upstream(wanted: Iterable[str], sources: Mapping[str, Collection[str]]) -> set[str]:
    """Return the wanted names and all that they depend on, directly or through others.

    >>> sorted(upstream(["c"], sources_of([("a", "b"), ("b", "c"), ("c", "d")])))
    ['a', 'b', 'c']
    """
    found = set(wanted)
    waiting = list(found)
    while waiting:
        new = set(sources.get(waiting.pop(), ())) - found
        found |= new
        waiting += new
    return found
