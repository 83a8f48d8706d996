"""Builds what a package brings for those without a compiler: native FMUs and our own libraries in C.

It goes into the package that this module is part of. `make wheel` does so in a copy of the checkout, so that
one that is interrupted leaves nothing that would be run.
"""

import shutil
from concurrent.futures import ThreadPoolExecutor
from functools import partial

from ..components import COMPONENTS
from ..display.progress import progress
from ..files import replace_file
from . import identities
from .native import libraries
from .native.compiler import MINGW, mingw_licence
from .native.native_fmu import build_native
from .native.platforms import PLATFORMS, SHIPPED


def build_all(platforms: tuple[str, ...] = tuple(PLATFORMS)) -> None:
    """Build the native FMUs of both versions, and the libraries, into the package. Raises LoomfmuError."""
    shutil.rmtree(SHIPPED, ignore_errors=True)
    with progress("native FMUs", 2 * len(COMPONENTS)) as advance, ThreadPoolExecutor() as pool:
        for fmi in (2, 3):
            build = partial(build_native, directory=SHIPPED / f"fmi{fmi}", platforms=platforms, fmi=fmi)
            for _ in pool.map(build, COMPONENTS):
                advance(1)
    libraries.build_all(sorted(identities.PACKAGE.glob("**/native/*.c")), platforms)
    replace_file(SHIPPED / MINGW, mingw_licence())
    identities.write(SHIPPED)
