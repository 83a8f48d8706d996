"""The directory of a sweep or a search: one of them in it, one writer at a time, nothing else touched.

`sweep.json`, for instance, says which sweep it is; `lock` is there while one writes.
"""

import contextlib
import json
import os
import re
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from ..errors import LoomfmuError
from ..files import ANY, cannot_write, check_target, replace_file

LOCK = "lock"
PARTIAL = r"\..*\.partial"  # names of files that are being written


class Refused(LoomfmuError):
    """A search that cannot be carried out, as its first runs show."""


Names = tuple[Path, str]  # a folder, and a regular expression of names in it


class Contents:
    """The files that a sweep or a search writes into a directory.

    `targets` have names of their own, `numbered` ones are many; `unfinished` are those that a kill leaves.
    """

    def __init__(
        self, directory: Path, targets: Sequence[Path], numbered: Sequence[Names], unfinished: Sequence[Names]
    ):
        self.directory, self.targets = directory, targets
        self._numbered, self._unfinished = numbered, unfinished

    @property
    def folders(self) -> list[Path]:
        """The folders below the directory."""
        return sorted({folder for folder, _names in self._numbered} - {self.directory})

    def results(self) -> list[Path]:
        """Return the files that exist under the names of its results."""
        return [path for path in self.targets if path.exists()] + files(self._numbered)

    def partial(self) -> list[Path]:
        """Return the partial files that a killed sweep or search has left."""
        return files(self._unfinished)


@contextlib.contextmanager
def owned(
    contents: Contents, kind: str, title: str, fingerprint: str, restart: bool, inputs: Iterable[Path] = ()
) -> Iterator[None]:
    """Have a directory alone, with what this `kind` of study finished before. None of `inputs` is written.

    A study that is refused, or fails before anything is finished, leaves nothing behind.

    Raises:
        LoomfmuError: another one is there, finished or not, or is running there now
    """
    directory = contents.directory
    identity = directory / f"{kind}.json"
    for target in (*contents.targets, directory / LOCK, identity):
        check_target(target, ANY, inputs)
    for folder in contents.folders:
        if folder.is_symlink():  # what lies behind it is not ours to write and to delete
            raise LoomfmuError(f"{folder}: cannot be written (it is a symbolic link)")
    made = [each for each in (directory, *directory.parents) if not each.exists()]
    directory.mkdir(parents=True, exist_ok=True)
    try:
        with _locked(directory, kind):
            _check_identity(contents, identity, kind, title, fingerprint, restart)
            for path in contents.partial():
                path.unlink(missing_ok=True)
            try:
                yield
            except LoomfmuError as error:
                if isinstance(error, Refused) or not any(each.stat().st_size for each in contents.results()):
                    _delete(contents, identity)
                raise
    except LoomfmuError:
        _delete_empty([*contents.folders, *made] if made else [])
        raise


def _check_identity(
    contents: Contents, path: Path, kind: str, title: str, fingerprint: str, restart: bool
) -> None:
    """Refuse to mix two of them, and to touch what none of them wrote; only their own files are deleted."""
    known = _known(path)
    if known is None and (path.exists() or contents.results()):
        foreign = path if path.exists() else contents.results()[0]
        raise LoomfmuError(
            f"{contents.directory}: contains files that no loomfmu {kind} wrote ({foreign.name});"
            " choose another directory with --output"
        )
    if restart:
        _delete(contents, path)
    elif known not in (None, fingerprint):
        raise LoomfmuError(
            f"{contents.directory}: contains another {kind}, or the {kind}, its scene, an FMU or loomfmu has"
            " changed since; --restart deletes the old results, --output chooses another directory"
        )
    if restart or known is None:
        content = {"title": title, "fingerprint": fingerprint}
        replace_file(path, (json.dumps(content, indent=1) + "\n").encode())


def _delete(contents: Contents, identity: Path) -> None:
    """Delete its files, the identity last: what a kill leaves over is still known."""
    for each in [*contents.results(), *contents.partial(), identity]:
        each.unlink(missing_ok=True)


def _delete_empty(folders: Iterable[Path]) -> None:
    """Delete folders that have nothing in them."""
    for each in folders:
        with contextlib.suppress(OSError):
            each.rmdir()


def _known(path: Path) -> str | None:
    """The fingerprint of what a directory holds; none without one."""
    try:
        return str(json.loads(path.read_text(encoding="utf-8"))["fingerprint"])
    except (FileNotFoundError, ValueError, KeyError, TypeError):
        return None


def files(several: Iterable[Names]) -> list[Path]:
    """The files of folders with such names, and links to files: a folder may be called like a file."""
    return [
        path
        for folder, names in several
        for path in folder.glob("*")
        if re.fullmatch(names, path.name) and (path.is_file() or path.is_symlink())
    ]


@contextlib.contextmanager
def _locked(directory: Path, kind: str) -> Iterator[None]:
    """Keep others out of a directory. The system frees the lock with the process that has it."""
    from filelock import FileLock, Timeout  # of an extra

    path = directory / LOCK
    descriptors: list[int] = []
    lock = FileLock(path, blocking=False, on_acquired=descriptors.append)
    try:
        lock.acquire()
    except Timeout:
        raise LoomfmuError(f"{directory}: another {kind} is running there{_holder(path)}") from None
    try:
        _sign(path, descriptors[0], kind)
        try:
            yield
        finally:
            with contextlib.suppress(PermissionError):  # Windows deletes it when it is let go
                path.unlink(missing_ok=True)
    finally:
        lock.release()


def _sign(path: Path, descriptor: int, kind: str) -> None:
    """Write into a lock that is ours which process we are."""
    if os.fstat(descriptor).st_nlink > 1:
        raise LoomfmuError(f"{path}: cannot be written (it is a hard link to another file; delete it)")
    written = os.read(descriptor, 20).strip()
    if written and not written.isdigit():
        raise LoomfmuError(f"{path}: not the lock of a {kind}; choose another directory with --output")
    try:
        os.ftruncate(descriptor, 0)
        os.lseek(descriptor, 0, os.SEEK_SET)
        # a blank first: other processes cannot read the byte that Windows locks
        os.write(descriptor, f" {os.getpid()}".encode())
    except OSError as error:
        path.unlink(missing_ok=True)
        raise cannot_write(path, error) from None


def _holder(path: Path) -> str:
    """The process that has a lock, as the end of a message; empty if that is unknown."""
    with contextlib.suppress(OSError), path.open("rb", buffering=0) as file:
        file.seek(1)
        if (process := file.read(20)).isdigit():
            return f" (process {process.decode()})"
    return ""
