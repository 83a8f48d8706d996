"""Batches: every row once, each batch as long as it should take, a row that ends its process found."""

from collections import Counter
from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from loomfmu.sweeps.schedule import BATCH, GROWTH, SMALLEST, Schedule

PACES = st.sampled_from([0.0, 1e-6, 1e-3, 0.02, 0.4, 3.0, 100.0])  # s for a row


def gaps(cuts: list[int]) -> list[range]:
    """Ranges between every other of some ascending numbers."""
    ends = sorted(set(cuts))
    return [range(start, stop) for start, stop in pairwise(ends)][::2]


@given(st.lists(st.integers(0, 5000), max_size=8), st.integers(1, 8), st.lists(PACES, max_size=30))
def test_every_row_that_is_left_runs_once(cuts: list[int], workers: int, paces: list[float]) -> None:
    left = gaps(cuts)
    schedule = Schedule(left, workers)
    met: Counter[int] = Counter()
    number = 0
    while (rows := schedule.next()) is not None:
        assert len(rows) > 0
        met.update(rows)
        schedule.measured(rows, paces[number % len(paces)] if paces else 0.01)
        number += 1
    assert met == Counter(row for rows in left for row in rows)


def test_batches_grow_to_the_time_that_they_should_take_and_shrink_at_the_end() -> None:
    schedule = Schedule([range(10_000)], workers=2)
    sizes = []
    while (rows := schedule.next()) is not None:
        sizes.append(len(rows))
        schedule.measured(rows, 0.01)
    wanted = round(BATCH / 0.01)
    assert sizes[:4] == [1, GROWTH, GROWTH**2, GROWTH**3]
    shrinking = next(place for place in range(4, len(sizes)) if sizes[place] < wanted)
    assert sizes[4:shrinking] == [wanted] * (shrinking - 4)
    assert sum(sizes[shrinking:]) < 4 * wanted
    # the last ones are a quarter of what is left, two for each of two workers, but no crumbs
    assert sizes[-3] < wanted // 4
    assert min(sizes[4:-1]) >= wanted // SMALLEST


def test_slow_rows_go_one_by_one() -> None:
    schedule = Schedule([range(100)], workers=2)
    for _ in range(5):
        rows = schedule.next()
        assert rows is not None and len(rows) == 1
        schedule.measured(rows, 60.0)


@given(st.integers(1, 3000), st.integers(0, 2999))
def test_halving_finds_the_row_that_ends_its_process(count: int, culprit: int) -> None:
    culprit %= count
    schedule = Schedule([range(count)], workers=1)
    met: Counter[int] = Counter()
    endings = 0
    guilty = []
    while (rows := schedule.next()) is not None:
        if culprit in rows:
            endings += 1
            guilty += list(rows) if schedule.died(rows) else []
        else:
            met.update(rows)
            schedule.measured(rows, 1e-3)
    assert guilty == [culprit]
    assert met + Counter(guilty) == Counter(range(count))
    assert endings <= count.bit_length() + 2


def test_a_suspect_runs_when_nothing_else_does() -> None:
    schedule = Schedule([range(10)], workers=3)
    first, second, third = (schedule.next() for _ in range(3))
    assert first is not None and second is not None and third is not None
    assert not schedule.died(second)
    assert schedule.next() is None
    schedule.measured(first, 0.1)
    assert schedule.next() is None
    schedule.measured(third, 0.1)
    assert schedule.next() == second
    assert schedule.next() is None
    schedule.measured(second, 0.1)
    assert schedule.next() is not None


def test_a_row_whose_process_ended_once_by_chance_is_not_guilty() -> None:
    schedule = Schedule([range(1)], workers=1)
    for died in (True, False):
        rows = schedule.next()
        assert rows == range(1)
        if died:
            assert not schedule.died(rows)
        else:
            schedule.measured(rows, 0.1)
    assert schedule.next() is None and schedule.running == 0
