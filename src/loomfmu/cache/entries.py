"""The entries of the cache: folders whose files are checked to the last byte whenever one is used.

What an FMU was unpacked to is compared with the FMU itself, which is what a trace names by its hash. A file
that was made lies beside its own SHA-256. What is damaged, missing or does not belong there is put right file
by file, so that other processes can go on using the entry. A cache that a process uses is not emptied before
that process ends: FMUs read their files at any time.
"""

import contextlib
import hashlib
import os
import re
import secrets
import shutil
import stat
import time
from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from types import ModuleType

from ..errors import LoomfmuError
from ..files import cannot_write, put
from .directory import cache_directory, is_private

fcntl: ModuleType | None
try:
    import fcntl
except ImportError:  # Windows deletes no file that is in use
    fcntl = None

KINDS = ("fmus", "unpacked", "packages", "stepper", "identities")
FMUS, UNPACKED, PACKAGES, STEPPER, IDENTITIES = KINDS
PARTIAL = "partial"  # files that are being written, each with a name of its own
KEY = re.compile("[0-9a-f]{8}[0-9a-f-]{28}")  # how the names of entries begin; nothing else is ever deleted
CHECKSUM = "sha256"  # what the file beside a made one is called
UNUSED = 30 * 86400.0  # s after which an entry is deleted
DAY = 86400.0

# locks of this process on cache directories: users of a cache share it, the one that empties it is alone
_held: dict[Path, int | None] = {}


def folder(kind: str, key: str, names: Collection[str], content: Callable[[str], bytes]) -> Path:
    """A folder with exactly these files; names that end with / are empty folders in it.

    Raises LoomfmuError where it cannot be written, ValueError for a name that leads out of it.
    """
    top = _in_use() / kind / key
    try:
        _prepare(top, names)
        files = [name for name in names if not name.endswith("/")]
        for name in files:
            _keep(top / name, content(name))
        _mark_used(top)
    except OSError as error:
        raise cannot_write(Path(error.filename or top), error) from None
    return top


def made_file(kind: str, key: str, name: str, make: Callable[[], bytes]) -> Path:
    """A file that is made once, and again if it is damaged. Raises LoomfmuError if it cannot be written."""
    top = _in_use() / kind / key
    names = (name, CHECKSUM)
    try:
        _prepare(top, names)
        known, kept = _content(top / CHECKSUM), _content(top / name)
    except OSError as error:
        raise cannot_write(Path(error.filename or top), error) from None
    if kept is None or known != _checksum(kept):
        kept = make()
    files = {name: kept, CHECKSUM: _checksum(kept)}
    return folder(kind, key, names, files.__getitem__) / name


def has_file(kind: str, key: str, name: str) -> bool:
    """Return whether a file was made; it may be damaged."""
    return (cache_directory() / kind / key / name).is_file()


def _checksum(content: bytes) -> bytes:
    return hashlib.sha256(content).hexdigest().encode()


# ---- the whole cache


def _in_use() -> Path:
    """The cache, of which nobody else can delete anything from now on; waits until one who does has done."""
    directory = cache_directory()
    if directory not in _held:
        _held[directory] = _locked(directory)
    return directory


def _locked(directory: Path) -> int | None:
    """A lock on the cache; none where the file system has no locks.

    Before a process uses anything, and if no other one does, what was not used for long is deleted.
    """
    if fcntl is None:
        delete(UNUSED)
        return None
    lock = None
    try:
        lock = os.open(directory, os.O_RDONLY)
        with contextlib.suppress(OSError):  # others use it
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            delete(UNUSED)
        fcntl.flock(lock, fcntl.LOCK_SH)
    except OSError:
        if lock is not None:
            os.close(lock)
        return None
    return lock


def clear() -> None:
    """Delete all entries. Raises LoomfmuError where another process uses the cache."""
    directory = _in_use()
    lock = _held[directory]
    if fcntl is None or lock is None:
        delete(0.0)
        return
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        raise LoomfmuError(
            f"{directory}: in use by another loomfmu; end it (or its Python session) and try again"
        ) from None
    delete(0.0)
    fcntl.flock(lock, fcntl.LOCK_SH)


# ---- one entry


def _prepare(top: Path, names: Collection[str]) -> None:
    """Make the folders of an entry, ours alone, and delete all that does not belong there."""
    kinds: dict[str, int] = {}  # by path within the entry; texts, since there are hundreds
    for name in names:
        path = PurePosixPath(name)
        if path.is_absolute() or ".." in path.parts or "\\" in name or ":" in name:
            raise ValueError(f"its member {name!r} lies outside of it")
        kinds |= dict.fromkeys(map(str, path.parents), stat.S_IFDIR)
        kinds[str(path)] = stat.S_IFDIR if name.endswith("/") else stat.S_IFREG
    _make_private(top.parent)
    _make_private(top)
    for surplus in _surplus(top, "", kinds):
        _delete(surplus)
    for name, kind in sorted(kinds.items()):
        if kind == stat.S_IFDIR:
            (top / name).mkdir(mode=0o700, exist_ok=True)


def _make_private(directory: Path) -> None:
    """Make a folder that is ours alone; what is there instead is deleted with all that it holds."""
    if os.path.lexists(directory):
        status = directory.lstat()
        if not (stat.S_ISDIR(status.st_mode) and is_private(status)):
            _delete(directory)
    directory.mkdir(mode=0o700, exist_ok=True)


def _surplus(directory: Path | str, within: str, kinds: dict[str, int]) -> Iterator[Path]:
    """Yield the paths that do not belong in a folder, are of another kind, or are not ours alone."""
    with os.scandir(directory) as found:
        for each in found:
            status, name = each.stat(follow_symlinks=False), within + each.name
            if kinds.get(name) != stat.S_IFMT(status.st_mode) or not is_private(status):
                yield Path(each.path)
            elif stat.S_ISDIR(status.st_mode):
                yield from _surplus(each.path, f"{name}/", kinds)


def _delete(path: Path) -> None:
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)


def _content(path: Path) -> bytes | None:
    try:
        return path.read_bytes()
    except FileNotFoundError:
        return None


def _keep(path: Path, content: bytes) -> None:
    """Let a file have this content, whoever else writes the same one."""
    if _content(path) == content:
        return
    partial = cache_directory() / PARTIAL / secrets.token_hex(32)
    _make_private(partial.parent)
    try:
        partial.touch(mode=0o600, exist_ok=False)
        partial.write_bytes(content)
        put(partial, path)
    finally:
        partial.unlink(missing_ok=True)


def _mark_used(top: Path) -> None:
    """Note, once a day, that an entry is in use."""
    with contextlib.suppress(PermissionError):  # a cache that is the system's
        if time.time() - top.stat().st_mtime > DAY:
            os.utime(top)


# ---- all entries


@dataclass(frozen=True)
class Contents:
    """The number of entries of a kind, and their size [bytes]."""

    kind: str
    entries: int
    size: int


def contents() -> list[Contents]:
    """Return the contents of the cache by kind."""
    found = {kind: [_size(path) for path in _entries(kind)] for kind in (*KINDS, PARTIAL)}
    return [Contents(kind, len(sizes), sum(sizes)) for kind, sizes in found.items()]


def delete(unused: float) -> None:
    """Delete the entries that were not used for some time [s]."""
    now = time.time()
    for kind in (*KINDS, PARTIAL):
        for path in _entries(kind):
            with contextlib.suppress(OSError):
                if now - path.lstat().st_mtime >= unused:
                    _delete(path)


def _entries(kind: str) -> list[Path]:
    folder = cache_directory() / kind
    if folder.is_symlink() or not folder.is_dir():
        return []
    return [path for path in folder.iterdir() if KEY.match(path.name)]


def _size(path: Path) -> int:
    files = path.rglob("*") if path.is_dir() else [path]
    total = 0
    for file in files:
        with contextlib.suppress(OSError):
            total += file.lstat().st_size if file.is_file() else 0
    return total
