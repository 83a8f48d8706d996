"""Disk space for HDF5 files, and what their first bytes say."""

import errno
import os
import shutil
from pathlib import Path

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
