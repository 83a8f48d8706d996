"""A trace with some of its samples alone, for what needs few of a long run."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .reader import Trace

READ = 65_536  # samples of a signal that are read at a time, however many there are


class Excerpt(Trace):
    """Some samples of a trace, as if it had no others: of each signal they alone are in memory."""

    def __init__(self, whole: Trace, places: NDArray[np.int64]):
        super().__init__(whole.path)
        self.given, self.name = whole.given, whole.name
        self.rows = len(places)
        self._whole, self._places = whole, places  # in ascending order

    def read(self, signal: str, rows: slice = slice(None)) -> NDArray[Any]:
        """The values of a signal at these samples, or at some of them."""
        if signal in self._cache:
            return self._cache[signal][rows]
        places = self._places[rows]
        found = []
        for start in range(READ * int(places[0] // READ), int(places[-1]) + 1, READ):
            low, high = np.searchsorted(places, (start, start + READ))
            if high > low:
                block = self._whole.read(signal, slice(start, start + READ))
                found.append(block[places[low:high] - start])
        return np.concatenate(found)
