"""Builds what a package brings so that who installs it needs no compiler: native FMUs for all platforms."""

import shutil
from concurrent.futures import ThreadPoolExecutor
from functools import partial

from ..components import COMPONENTS
from . import identities
from .native.builder import build_native
from .native.compiler import MINGW, mingw_licence
from .native.platforms import PLATFORMS, SHIPPED


def build_all(platforms: tuple[str, ...] = tuple(PLATFORMS)) -> None:
    """Build the native FMUs of both versions into the package. Raises LoomfmuError, OSError."""
    shutil.rmtree(SHIPPED, ignore_errors=True)
    with ThreadPoolExecutor() as pool:
        for fmi in (2, 3):
            build = partial(build_native, directory=SHIPPED / f"fmi{fmi}", platforms=platforms, fmi=fmi)
            built = pool.map(build, COMPONENTS)
            list(built)
    (SHIPPED / MINGW).write_bytes(mingw_licence())
    identities.write(SHIPPED)
