"""What all processes have in common that share the tests of one session."""

import hashlib
import os
import platform
import shutil
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from importlib.metadata import version
from pathlib import Path
from threading import get_ident

import pytest
from filelock import FileLock
from platformdirs import user_cache_path

from loomfmu.cache.directory import cache_directory
from loomfmu.cache.entries import FMUS, made_file
from loomfmu.components import COMPONENTS
from loomfmu.cosim.importing import fmus
from loomfmu.fmi.native import compiler
from loomfmu.fmi.native.platforms import COMPILER, host, stamp
from loomfmu.studies.fitting import measured
from loomfmu.traces import Trace, damage

KEPT = user_cache_path("loomfmu-tests", appauthor=False)
CODE = (".c", ".cpp", ".h")
COMPILED_IN = compiler.compiled_in  # by the compiler itself


@pytest.fixture(scope="session", autouse=True)
def fmu_cache() -> Iterator[None]:
    """One cache of built FMUs for all tests and the processes that they start, kept from run to run.

    Its entries are named by all that they are made of, and checked when they are used. It is not the user's
    own.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("LOOMFMU_CACHE", str(KEPT))
        yield


@pytest.fixture(scope="session", autouse=True)
def traces_checked_here() -> Iterator[None]:
    """Commands check traces in the process of the tests: one of its own takes a third of a second each time.

    `tests/test_traces.py` tests the check in its own process.
    """
    with pytest.MonkeyPatch.context() as patch:
        for module in (damage, measured):
            patch.setattr(module, "check", lambda path: Trace(path).check())
        yield


@pytest.fixture(scope="session", autouse=True)
def compiled_once(fmu_cache: None) -> Iterator[None]:
    """What the compiler makes of the same code is kept from run to run, whatever cache a test has.

    Each call takes over a second, even if the compiler has kept what it makes.
    """

    def call(directory: Path, target: str, *arguments: str) -> None:
        compiler._required()
        code = sorted((each.name, each.read_bytes()) for each in directory.iterdir() if each.suffix in CODE)
        key = hashlib.sha256(repr((target, arguments, code, stamp(COMPILER))).encode()).hexdigest()
        kept, output = KEPT / FMUS / key / "made", directory / arguments[arguments.index("-o") + 1]
        if not kept.is_file():
            COMPILED_IN(directory, target, *arguments)
            kept.parent.mkdir(parents=True, exist_ok=True)
            part = kept.with_name(f"{os.getpid()}-{get_ident()}")
            part.write_bytes(output.read_bytes())
            part.replace(kept)
        os.utime(kept.parent)
        output.write_bytes(kept.read_bytes())

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(compiler, "compiled_in", call)
        yield


def made_by_gcc(name: str, sources: list[str], make: Callable[[], bytes]) -> Path:
    """A library that gcc makes of some text and options: once, as an entry of the cache."""
    gcc = shutil.which("gcc")
    stamp = Path(gcc).stat().st_mtime_ns if gcc else 0
    key = hashlib.sha256(repr((name, sources, stamp)).encode()).hexdigest()
    return made_file(FMUS, key, name, make)


def made_of_sources(folder: Path, make: Callable[[], bytes]) -> bytes:
    """A result that only sources decide: made once for each state of these, as an entry of the cache.

    They are the package, a folder of tests, the modules beside it and the libraries that compute and draw.
    """
    root = Path(__file__).parents[1]
    files = [*(root / "src").rglob("*"), *(root / "tests").glob("*.py"), *folder.rglob("*")]
    libraries = [version(name) for name in ("matplotlib", "numpy", "pillow", "scipy")]
    digest = hashlib.sha256(repr((sys.version, platform.machine(), libraries)).encode())
    for file in sorted(file for file in files if file.is_file() and "__pycache__" not in file.parts):
        digest.update(file.relative_to(root).as_posix().encode())
        digest.update(hashlib.sha256(file.read_bytes()).digest())
    return made_file(FMUS, digest.hexdigest(), folder.name, make).read_bytes()


# FMI 3 wraps the C of FMI 2: these have all kinds of variables between them, with and without a memory
OF_FMI_3 = ("MainShaft", "DrivenShaft", "WeftInsertion", "BeltMonitor", "DobbyDrive")


def native_fmu_of_fmi_3(name: str) -> fmus.Fmu:
    """The native FMU of a component in FMI 3, for the machine's own platform."""
    return fmus.load(fmus.file_of(COMPONENTS[name], "native", (host(),), 3))


def native_fmus() -> dict[str, fmus.Fmu]:
    """All native FMUs, for the machine's own platform, in the session's cache.

    One process builds them, and some of FMI 3, on all cores, while the others wait.
    """
    cache = cache_directory()
    cache.mkdir(parents=True, exist_ok=True)
    with FileLock(cache / "native.lock"), ThreadPoolExecutor(max_workers=4) as pool:
        third = pool.map(native_fmu_of_fmi_3, OF_FMI_3)
        list(pool.map(lambda each: fmus.file_of(each, "native", (host(),)), COMPONENTS.values()))
        list(third)
    return {name: fmus.of_component(name, "native") for name in COMPONENTS}
