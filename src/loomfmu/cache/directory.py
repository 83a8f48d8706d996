"""The cache of built and unpacked FMUs: a folder that only the user can write to."""

import atexit
import logging
import os
import shutil
import stat
import tempfile
from pathlib import Path

from platformdirs import user_cache_path

from ..errors import LoomfmuError

ON_UNIX = hasattr(os, "getuid")
SYSTEM = 0  # its user can change everything anyway
WRITABLE_BY_OTHERS = stat.S_IWGRP | stat.S_IWOTH

_temporary: list[str] = []  # the directory that this process has made and removes at its end


def cache_directory() -> Path:
    """LOOMFMU_CACHE, or `loomfmu` in the user's cache directory, or where that cannot be used a new one.

    Processes started from this one share a new one, since they find it in LOOMFMU_CACHE; at the end it is
    removed. Raises LoomfmuError where LOOMFMU_CACHE names no folder, or one that others may write to: what
    lies there is run.
    """
    named = os.environ.get("LOOMFMU_CACHE")
    if named:
        try:
            place = Path(named).expanduser().absolute()
        except RuntimeError as error:  # ~ without a home
            raise LoomfmuError(f"LOOMFMU_CACHE = {named}: {error}") from None
        if reason := _fault(place):
            raise LoomfmuError(f"LOOMFMU_CACHE = {place} {reason}; name a folder that only you can write to")
        return place
    usual, reason = _of_user("loomfmu")
    if reason := reason or _fault(usual, mend=True):
        # Python's own logging brings it to the standard error, if nothing else is set up
        logging.getLogger("loomfmu.cache").warning(
            "loomfmu: the cache %s %s; using a temporary one, which every run fills anew;"
            " set LOOMFMU_CACHE to a folder that only you can write to",
            usual,
            reason,
        )
        return _new_one()
    return usual


def compiler_environment() -> dict[str, str]:
    """Return the compiler's environment variables: it hangs if it cannot write its own cache."""
    if os.environ.get("ZIG_GLOBAL_CACHE_DIR"):
        return dict(os.environ)
    usual, reason = _of_user("zig")
    return os.environ | {"ZIG_GLOBAL_CACHE_DIR": str(cache_directory() / "zig" if reason else usual)}


def is_private(status: os.stat_result) -> bool:
    """Return whether only the user, or the system, can write to a file or folder; never true for links."""
    if stat.S_ISLNK(status.st_mode):
        return False
    return _is_own(status) and not (ON_UNIX and status.st_mode & WRITABLE_BY_OTHERS)


def _is_own(status: os.stat_result) -> bool:
    return not ON_UNIX or status.st_uid in (SYSTEM, os.getuid())


def _of_user(name: str) -> tuple[Path, str]:
    """The user's cache directory for a program, which is made, and why it cannot be used, empty if it can."""
    directory = Path("~/.cache") / name
    try:
        directory = user_cache_path(name, appauthor=False)
        directory.mkdir(mode=0o700, parents=True, exist_ok=True)
    except FileExistsError:
        return directory, "is a file, not a folder"
    except OSError as error:
        return directory, f"cannot be used ({error.strerror})"
    except RuntimeError as error:  # a user without a home, as in some containers
        return directory, f"cannot be used ({error})"
    return directory, "" if os.access(directory, os.W_OK | os.X_OK) else "cannot be written to"


def _fault(directory: Path, mend: bool = False) -> str:
    """Return why a folder cannot be a cache, or an empty text; make it, and with `mend` restrict it."""
    try:
        str(directory).encode()  # FMUs get it as UTF-8
        directory.mkdir(mode=0o700, parents=True, exist_ok=True)
        status = directory.stat()
        if mend and _is_own(status) and stat.S_IMODE(status.st_mode) != 0o700:
            directory.chmod(0o700)
            status = directory.stat()
    except UnicodeEncodeError:
        return "is not valid UTF-8"
    except FileExistsError:
        return "is a file, not a folder"
    except OSError as error:
        return f"cannot be used ({error.strerror})"
    if is_private(status):
        return ""
    return "can be written to by others" if _is_own(status) else "belongs to another user"


def _new_one() -> Path:
    """A temporary directory for this process and those that it starts."""
    _temporary.append(tempfile.mkdtemp(prefix="loomfmu-"))
    os.environ["LOOMFMU_CACHE"] = _temporary[-1]
    return Path(_temporary[-1])


@atexit.register
def _remove() -> None:
    for directory in _temporary:
        shutil.rmtree(directory, ignore_errors=True)
