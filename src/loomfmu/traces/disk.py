"""Disk space for HDF5 files, what their first bytes say, and changes to finished ones.

HDF5 marks a file that it has open for changes, and refuses it for ever if the process is killed meanwhile.
So a finished file is changed in memory and then written at once: a kill never finds it half changed.
"""

import errno
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO

import h5py

from .chunks import chunk_of

SPARE = 65536  # bytes beyond what is reckoned with, for HDF5's own book-keeping
PER_DATASET = 4096  # bytes of book-keeping for a dataset, in its header or for a block


def largest(rows: int, signals: int) -> int:
    """Bytes that a trace takes at most while it is written, with time, shaft angle and book-keeping."""
    blocks = -(-rows // chunk_of(rows))
    header = SPARE + PER_DATASET * (signals + 2)
    return header + 8 * blocks * chunk_of(rows) * (signals + 2) + block_size(rows, signals)


def block_size(rows: int, signals: int) -> int:
    """Bytes that a block of a trace of so many rows takes at most, with time and shaft angle."""
    return SPARE + (PER_DATASET + 8 * chunk_of(rows)) * (signals + 2)


def check_room(path: Path, size: int) -> None:
    """Raise OSError where a new file of that size under this name would not find the space."""
    there = next(folder for folder in path.absolute().parents if folder.exists())
    disk = shutil.disk_usage(there)
    if size > disk.free and disk.total:  # what has no size, such as /proc, cannot tell
        need, have = size_text(size), size_text(disk.free)
        raise OSError(errno.ENOSPC, f"it takes up to {need}, and the disk has {have} free")


def size_text(size: int) -> str:
    """A number of bytes as people read it.

    >>> size_text(69_120_000_000), size_text(512_345)
    ('69.1 GB', '0.5 MB')
    """
    return f"{size / 1e9:.1f} GB" if size >= 1e9 else f"{size / 1e6:.1f} MB"


def reserve(file: int, size: int) -> None:
    """Take disk space for a file before HDF5 writes it: HDF5 does not survive a write that fails.

    Raises OSError where there is no space; where a system cannot tell, nothing is reserved.
    """
    if hasattr(os, "posix_fallocate"):
        try:
            os.posix_fallocate(file, 0, size)
        except OSError as error:
            if error.errno not in (errno.EOPNOTSUPP, errno.EINVAL):
                raise


def superblock(path: Path) -> tuple[bool, bool, int]:
    """Return whether an HDF5 file is marked as open for changes, whether readers may join, and its length.

    The marks stay when the writer is killed; the length is the one that the file says it has.
    """
    with path.open("rb") as file:
        head = file.read(36)
    if len(head) < 36 or head[8] != 3:  # the version that our files have
        return False, False, 0
    return bool(head[11] & 1), bool(head[11] & 4), int.from_bytes(head[28:36], "little")


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
