"""Stretches in which a signal is not known, and errors of the model, as other outputs state both."""

import math
from collections.abc import Sequence

import numpy as np

from ... import units
from ...traces import Signals, Verdict
from .curves import Stretch
from .extremes import inside
from .shaft import angle, place


def gaps(trace: Signals, signal: str, within: Sequence[Stretch] | None = None) -> list[Stretch]:
    """Stretches of time in which a signal is not known, from the last sample at which it is to the next one.

    They are endless where there is no such sample. With `within` they are those that overlap these stretches.
    """
    flag = trace.validity(signal) if signal in trace else None
    if flag is None:
        return []
    known = np.concatenate([[True], np.asarray(trace[flag], dtype=bool), [True]])
    changes = np.flatnonzero(known[1:] != known[:-1])  # a gap begins at a sample, and ends before one
    time = np.concatenate([[-math.inf], trace.time, [math.inf]])
    found = [
        Stretch(float(time[start]), float(time[end + 1]))
        for start, end in zip(changes[::2], changes[1::2], strict=True)
    ]
    if within is None:
        return found
    return [gap for gap in found if any(gap.start < each.end and each.start < gap.end for each in within)]


def off_by(trace: Signals, verdict: Verdict, within: Sequence[Stretch] | None) -> float:
    """Return the error of a verdict's signal that no steps reduce, as its error output states it.

    That counts wherever the signal is as near to the worst value as it may be off.
    """
    name = trace.error(verdict.signal)
    if name is None:
        return 0.0
    errors = np.abs(trace[name])
    near = (np.abs(trace[verdict.signal] - verdict.worst) <= errors) & inside(trace.time, within)
    place = min(int(trace.time.searchsorted(verdict.time)), len(errors) - 1)
    near[[max(place - 1, 0), place]] = True
    return float(np.max(errors[near]))


def known_within(
    trace: Signals, without: Sequence[Stretch], within: Sequence[Stretch] | None
) -> list[Stretch]:
    """Return some stretches of time, or the whole run, without others."""
    left = list(within) if within is not None else [Stretch(float(trace.time[0]), float(trace.time[-1]))]
    for gap in without:
        pieces = [
            piece
            for each in left
            for piece in (
                each._replace(end=min(each.end, gap.start)),
                each._replace(start=max(each.start, gap.end)),
            )
        ]
        left = [piece for piece in pieces if piece.start <= piece.end]
    return left


def unknown_note(trace: Signals, signal: str, first: Stretch) -> str:
    """A note that a signal is not known, from when on, and who says so."""
    flag, turning = trace.validity(signal), angle(trace)
    since = max(first.start, float(trace.time[0]))
    at = f"{since:.6g} s"
    if turning is not None:
        degrees, revolution = place(turning, since)
        at += f", {units.show(degrees, 'deg')}, rev. {revolution}"
    return f'not known from {at} on, as {flag} is false ("{trace.description(str(flag))}")'
