"""Files that are read, and files that are written: whole or not at all, never over what is not ours."""

import errno
import hashlib
import os
import secrets
import stat
import zipfile
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any

from .errors import LoomfmuError, shown, why

LONGEST_STEM = 180  # bytes: most file systems take 255, hidden names and endings included
NOT_A_FILE = "it is a device or a pipe, not a file"
TRACE = "; use loomfmu show {0} for a trace"
INSTEAD = {  # what to do with a file that is given where text belongs
    ".h5": TRACE,
    ".hdf5": TRACE,
    ".fmu": "; loomfmu list {0} shows an FMU; to run it, write a scene with a table such as [motor]"
    ' and in it fmu = "{0}"',
}


def source(path: Path) -> Path:
    """A file that is about to be read. Raises OSError, also for a pipe or a device: it might never end."""
    mode = path.stat().st_mode
    if not stat.S_ISREG(mode) and not stat.S_ISDIR(mode):  # a directory is refused by whoever opens it
        raise OSError(errno.EINVAL, NOT_A_FILE, str(path))
    return path


@dataclass(frozen=True)
class Kind:
    """A kind of file that loomfmu writes: its name in messages, and a test for one that loomfmu wrote."""

    name: str
    ours: Callable[[Path], bool]
    suffixes: tuple[str, ...] = ()  # the usual one first
    advice: str = ""  # for who wants another format


def starts_with(name: str, *starts: bytes, suffix: str = "", advice: str = "") -> Kind:
    """The kind of files that begin in one of these ways."""

    def ours(path: Path) -> bool:
        with path.open("rb") as file:
            return file.read(max(map(len, starts))).startswith(starts)

    return Kind(name, ours, (suffix,) if suffix else (), advice)


ANY = Kind("", lambda _path: True)  # other checks tell whose file it is
PICTURE = starts_with("a PNG picture", b"\x89PNG\r\n\x1a\n")


def zip_with(name: str, member: str, suffix: str) -> Kind:
    """The kind of archives of which a member names this package as its maker."""

    def ours(path: Path) -> bool:
        try:
            with zipfile.ZipFile(path) as archive:
                return b'generationTool="loomfmu' in archive.read(member)
        except (zipfile.BadZipFile, KeyError, RuntimeError, NotImplementedError):
            return False

    return Kind(name, ours, (suffix,))


MOST_UNPACKED = 2_000_000_000  # bytes of all files of an archive: one at a time is held in memory
MOST_MEMBERS = 20_000  # of an archive


def check_archive(archive: zipfile.ZipFile) -> dict[str, zipfile.ZipInfo]:
    """The files of an archive by their names. Raises ValueError for one too large to unpack.

    A member gives no more than its stated size: reading it ends there, and its checksum fails.
    """
    members = archive.infolist()
    if len(members) > MOST_MEMBERS:
        raise ValueError(f"it has {len(members)} files; at most {MOST_MEMBERS} are unpacked")
    size = sum(each.file_size for each in members)
    if size > MOST_UNPACKED:
        raise ValueError(
            f"it unpacks to {size / 1e9:.3g} GB; at most {MOST_UNPACKED / 1e9:.3g} GB are unpacked"
        )
    named: dict[str, zipfile.ZipInfo] = {}
    for each in members:
        if each.is_dir():
            continue
        other = named.setdefault(each.filename, each)
        if (other.CRC, other.file_size) != (each.CRC, each.file_size):
            raise ValueError(f"it has two different files called {shown(each.filename)}")
    folders = {str(folder) for name in named for folder in PurePosixPath(name).parents}
    for name in folders & named.keys():
        raise ValueError(f"{shown(name)} is both a file and a folder in it")
    return named


def short_stem(stem: str, most: int = LONGEST_STEM) -> str:
    """Return the name of a file without its suffix, cut to `most` bytes if it takes more, with a digest."""
    if len(stem.encode()) <= most:
        return stem
    return f"{stem.encode()[: most - 9].decode(errors='ignore')}-{digest(stem)}"


def digest(text: str) -> str:
    """Return the eight hex digits that keep names apart."""
    return hashlib.sha256(text.encode()).hexdigest()[:8]


def check_target(path: Path, kind: Kind, inputs: Iterable[Path] = (), overwrite: bool = False) -> None:
    """Refuse a path that may not be written.

    Nothing ever replaces an input of the command, a link or what is not a file; only `overwrite` replaces a
    file that is not of the kind to be written. Raises LoomfmuError.
    """
    try:
        if any(given.exists() and path.exists() and path.samefile(given) for given in inputs):
            raise LoomfmuError(f"{path}: cannot be written (it is an input of this command)")
        if not path.name or path.is_dir():
            raise LoomfmuError(f"{path}: cannot be written (it is a directory)")
        if path.is_symlink():  # it would be replaced, not what it points to
            raise LoomfmuError(f"{path}: cannot be written (it is a symbolic link; name the file itself)")
        folder = next((folder for folder in path.parents if folder.exists()), path)
        if folder != path and not folder.is_dir():
            raise LoomfmuError(f"{path}: cannot be written ({folder} is not a directory)")
        free = not path.exists()
        if not free and not stat.S_ISREG(path.stat().st_mode):
            raise LoomfmuError(f"{path}: cannot be written ({NOT_A_FILE})")
        if not (free or overwrite or path.stat().st_size == 0 or kind.ours(path)):
            raise LoomfmuError(
                f"{path}: exists and is not {kind.name}; --force (overwrite=True in Python) replaces it"
            )
    except OSError as error:
        raise cannot_write(path, error) from None
    if kind.suffixes and path.suffix.lower() not in ("", *kind.suffixes):
        name = path.with_suffix(kind.suffixes[0]).name
        raise LoomfmuError(f"{path}: {kind.name} ends in {kind.suffixes[0]}; name it {name}{kind.advice}")


def write_file(
    path: Path, content: bytes, kind: Kind, inputs: Iterable[Path] = (), overwrite: bool = False
) -> Path:
    """Write a file, whole or not at all, and return its path. Raises LoomfmuError naming it."""
    check_target(path, kind, inputs, overwrite)
    return replace_file(path, content)


def replace_file(path: Path, content: Any) -> Path:
    """Write a file over what may be there, whole or not at all. Raises LoomfmuError naming it."""
    temporary = path.with_name(f".{path.name}.{secrets.token_hex(4)}.partial")
    try:
        make_folder(path.parent)
        try:
            with temporary.open("xb") as file:  # new: nothing is written through a link
                file.write(content)
            put(temporary, path)
        finally:
            temporary.unlink(missing_ok=True)
    except OSError as error:
        raise cannot_write(path, error) from None
    return path


def put(finished: Path, path: Path) -> None:
    """Give a finished file or folder its final name. Raises OSError.

    After a power loss the name stands for all of it, or for what it replaced. A file system may write a name
    long before the content, so the content has to be on the disk first.
    """
    _wait_for_disk(finished)
    finished.replace(path)
    _wait_for_disk(path.parent)


def make_folder(folder: Path) -> None:
    """Make a folder, and those above it, to outlast a power loss. Raises OSError."""
    missing = [each for each in (folder, *folder.parents) if not each.exists()]
    folder.mkdir(parents=True, exist_ok=True)
    for each in missing:
        _wait_for_disk(each.parent)


def _wait_for_disk(path: Path) -> None:
    """Wait until the content of a file, or the names in a folder, are on the disk."""
    folder = path.is_dir()
    if folder and os.name == "nt":  # which opens no folder
        return
    descriptor = os.open(path, os.O_RDONLY if folder else os.O_RDWR)  # Windows: only what can be written
    try:
        os.fsync(descriptor)
    except OSError as error:
        if not (folder and error.errno == errno.EINVAL):  # a file system that cannot do so for folders
            raise
    finally:
        os.close(descriptor)


def text_of(path: Path) -> str:
    """The text of a file that somebody wrote, perhaps with a mark of its encoding. Raises LoomfmuError."""
    try:
        return source(path).read_text(encoding="utf-8-sig")
    except OSError as error:
        raise LoomfmuError(f"{path}: cannot be read ({why(error)})") from None
    except UnicodeDecodeError:
        hint = INSTEAD.get(path.suffix.lower(), "").format(path)
        raise LoomfmuError(f"{path}: is not text in UTF-8{hint}") from None


def cannot_write(path: Path, error: OSError) -> LoomfmuError:
    """The message about a file that cannot be written; what the system says need not name it."""
    return LoomfmuError(f"{path}: cannot be written ({why(error)})")
