"""Where built and unpacked FMUs are kept between runs."""

import atexit
import os
import shutil
import tempfile
from pathlib import Path

_temporary: list[str] = []  # the directory that this process has made and removes at its end


def cache_directory() -> Path:
    """LOOMFMU_CACHE, or `loomfmu` in the user's cache directory, or where that cannot be written a new one.

    Processes started from this one share it, since they find it in LOOMFMU_CACHE; at the end it is removed.
    """
    named = os.environ.get("LOOMFMU_CACHE")
    if named:
        return Path(named).absolute()
    usual = _caches() / "loomfmu"
    if _is_writable(usual):
        return usual
    _temporary.append(tempfile.mkdtemp(prefix="loomfmu-"))
    os.environ["LOOMFMU_CACHE"] = _temporary[-1]
    return Path(_temporary[-1])


def compiler_environment() -> dict[str, str]:
    """What the compiler is started with: it waits for ever where it cannot write its own cache."""
    if os.environ.get("ZIG_GLOBAL_CACHE_DIR") or _is_writable(_caches() / "zig"):
        return dict(os.environ)
    return os.environ | {"ZIG_GLOBAL_CACHE_DIR": str(cache_directory() / "zig")}


def _caches() -> Path:
    """The user's directory of caches, which need not exist nor be one that can be written."""
    named = os.environ.get("XDG_CACHE_HOME")
    try:
        return Path(named) if named else Path.home() / ".cache"
    except RuntimeError:  # a user without a home, as in some containers
        return Path(os.devnull)


def _is_writable(directory: Path) -> bool:
    try:
        directory.mkdir(parents=True, exist_ok=True)
    except OSError:
        return False
    return os.access(directory, os.W_OK | os.X_OK)


@atexit.register
def _remove() -> None:
    for directory in _temporary:
        shutil.rmtree(directory, ignore_errors=True)
