"""The order of stepping, for any wiring."""

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from loomfmu.cosim.scenes.graph import Wire, step_order

NAMES = [f"i{number}" for number in range(8)]
names = st.sampled_from(NAMES)
wirings = st.lists(st.tuples(names, names), max_size=25, unique=True)


def wires(pairs: list[tuple[str, str]]) -> list[Wire]:
    return [Wire((source, f"y{n}"), (sink, f"u{n}")) for n, (source, sink) in enumerate(pairs)]


def plainly(scene: list[str], pairs: list[tuple[str, str]]) -> list[str]:
    """The order as it is defined, without any thought of speed."""
    left, order = list(scene), []
    while left:
        feeding = {name: {a for a, b in pairs if b == name and a != name and a in left} for name in left}
        for _ in left:  # all that feeds an instance, near or far
            feeding = {name: each.union(*(feeding[a] for a in each)) for name, each in feeding.items()}
        free = [name for name in left if not feeding[name]]
        loops = [name for name in left if all(name in feeding[other] for other in feeding[name])]
        order.append((free or loops)[0])
        left.remove(order[-1])
    return order


@given(wirings, st.permutations(NAMES))
def test_the_order_is_as_defined_and_the_wires_that_go_back_lag(
    pairs: list[tuple[str, str]], scene: list[str]
) -> None:
    wiring = wires(pairs)
    order, lagged = step_order(scene, wiring)
    assert order == plainly(scene, pairs)
    back = [wire for wire in wiring if order.index(wire.source[0]) >= order.index(wire.sink[0])]
    assert sorted(map(str, lagged)) == sorted(map(str, back))
    _order, rest = step_order(scene, [wire for wire in wiring if wire not in lagged])
    assert rest == []  # without them there is no loop
    for wire in lagged:  # the source of each is fed, near or far, by its sink
        reached, front = set(), {wire.sink[0]}
        while front:
            reached |= front
            front = {each.sink[0] for each in wiring if each.source[0] in front} - reached
        assert wire.source[0] in reached


def test_only_the_wire_that_closes_a_loop_lags() -> None:
    chain = [Wire(("a", "y"), ("b", "u")), Wire(("b", "y"), ("c", "u")), Wire(("c", "y"), ("a", "u"))]
    order, lagged = step_order(["a", "b", "c"], chain)
    assert (order, [str(wire) for wire in lagged]) == (["a", "b", "c"], ["c.y -> a.u"])
    own = Wire(("a", "y"), ("a", "u"))
    assert step_order(["a"], [own]) == (["a"], [own])


@pytest.mark.parametrize(
    ("scene", "more", "expected"),
    [("abcd", Wire(("d", "y"), ("c", "u")), "dcab"), ("cab", Wire(("a", "y"), ("c", "u")), "acb")],
    ids=["what does not depend on it", "what it feeds"],
)
def test_a_loop_holds_up_what_it_feeds_alone(scene: str, more: Wire, expected: str) -> None:
    wiring = [Wire(("a", "y"), ("b", "u")), Wire(("b", "y"), ("a", "u")), more]
    order, lagged = step_order(list(scene), wiring)
    assert order == list(expected)
    assert [str(wire) for wire in lagged] == ["b.y -> a.u"]


def test_ten_thousand_instances_have_an_order() -> None:
    names = [f"i{number}" for number in range(10_000)]
    chain = list(itertools.pairwise(names))
    assert step_order(names[::-1], wires(chain)) == (names, [])
    couples = [
        (one, other) for a, b in zip(names[::2], names[1::2], strict=True) for one, other in ((a, b), (b, a))
    ]
    order, lagged = step_order(names, wires(couples))
    assert (order, len(lagged)) == (names, 5000)
