"""Changes to a finished HDF5 file that are written at once: a kill never finds it half changed.

HDF5 marks a file that it has open for changes, and refuses it for ever if the process is killed meanwhile.
"""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO

import h5py

from .disk import reserve

PAGE = 4096  # bytes that are written at a time


@contextmanager
def edited(path: Path) -> Iterator[Any]:
    """An HDF5 file, open for changes. Raises OSError, the file as it was, where they find no space."""
    with path.open("r+b") as file:
        pages = _Pages(file)
        with h5py.File(pages, "r+") as opened:
            yield opened
        pages.commit()


class _Pages:
    """A file whose changes stay in memory, as whole pages, until they are committed."""

    def __init__(self, file: BinaryIO):
        self._file = file
        self._place = 0
        self._size = os.fstat(file.fileno()).st_size
        self._changed: dict[int, bytearray] = {}

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        self._place = offset + {os.SEEK_SET: 0, os.SEEK_CUR: self._place, os.SEEK_END: self._size}[whence]
        return self._place

    def tell(self) -> int:
        return self._place

    def readinto(self, buffer: Any) -> int:
        view = memoryview(buffer).cast("B")
        for number, inside, piece in self._parts(len(view)):
            view[piece] = self._page(number)[inside]
        return len(view)

    def read(self, size: int = -1) -> bytes:
        content = bytearray(self._size - self._place if size < 0 else size)
        self.readinto(content)
        return bytes(content)

    def write(self, data: Any) -> int:
        view = memoryview(data).cast("B")
        for number, inside, piece in self._parts(len(view)):
            self._changed.setdefault(number, self._page(number))[inside] = view[piece]
        self._size = max(self._size, self._place)
        return len(view)

    def truncate(self, size: int) -> int:
        self._size = size
        return size

    def flush(self) -> None:
        """Nothing goes to the file before `commit`."""

    def _parts(self, length: int) -> Iterator[tuple[int, slice, slice]]:
        """The pages that the next bytes lie in: number, place within it, place within the bytes."""
        done = 0
        while done < length:
            number, start = divmod(self._place, PAGE)
            count = min(PAGE - start, length - done)
            yield number, slice(start, start + count), slice(done, done + count)
            done += count
            self._place += count

    def _page(self, number: int) -> bytearray:
        if number in self._changed:
            return self._changed[number]
        self._file.seek(number * PAGE)
        return bytearray(self._file.read(PAGE).ljust(PAGE, b"\0"))

    def commit(self) -> None:
        """Write what has changed: what is new first, the file's own header last."""
        before = os.fstat(self._file.fileno()).st_size
        try:
            reserve(self._file.fileno(), self._size)
        except OSError:
            self._file.truncate(before)
            raise
        for number in sorted(self._changed, reverse=True):
            self._file.seek(number * PAGE)
            self._file.write(self._changed[number])
            self._file.flush()
        self._file.truncate(self._size)
