"""Native FMUs under hosts written in C: one that keeps the rules, and one that keeps none."""

import math
import shutil
import subprocess
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path

import pytest
from attack_figures import record
from fmpy import platform

from loomfmu.components import COMPONENTS
from loomfmu.declaring.variables import variables_of
from loomfmu.fmi.native.native_fmu import HEADERS, sources

pytestmark = pytest.mark.no_cover  # FMUs beside components, step by step: the tests of these cover them
every_fmu = pytest.mark.parametrize("name", COMPONENTS)
HERE = Path(__file__).parent
SIZE = 1e-3
CALLS = 30_000  # of the host that keeps no rules
WHAT = "random calls and states of native FMUs, FMI {}.0"
SANITIZERS = ["-fsanitize=address,undefined,float-cast-overflow", "-fno-sanitize-recover=all", "-g1"]


def compiled(*command: str | Path) -> None:
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr


@pytest.fixture(scope="module")
def host(gcc, tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("host") / "host"
    warnings = ["-Wall", "-Wextra", "-Werror"]
    compiled(gcc, "-std=c99", "-O1", *warnings, f"-I{HEADERS}", "-o", path, HERE / "host.c", "-ldl")
    return path


@every_fmu
def test_a_host_without_python_gets_the_components_results(built, host, name):
    component = COMPONENTS[name]
    steps = 1000  # one second
    letters = "".join({float: "r", int: "i", bool: "b"}[v.type] for v in variables_of(component))
    library = built[name].directory / "binaries" / platform / f"{name}.so"
    run = subprocess.run(
        [host, library, built[name].guid, str(steps), repr(SIZE), letters],
        capture_output=True,
        text=True,
        check=False,
        env={},
    )
    assert (run.returncode, run.stderr) == (0, "")
    python = component()
    assert python.initialize(0.0) == 0
    for step in range(steps):
        assert python.step(step * SIZE, SIZE) == 0
    for variable, line in zip(variables_of(component), run.stdout.split(), strict=True):
        wanted = float(getattr(python, variable.name))
        assert math.isclose(float(line), wanted, rel_tol=1e-12, abs_tol=1e-300), variable.name


# ---- a host that keeps no rules


@pytest.fixture(scope="module")
def fuzzer(gcc, tmp_path_factory) -> Callable[..., Path]:
    """Builds the fuzz host around an FMU's sources, with the sanitizers or other options."""
    folder = tmp_path_factory.mktemp("fuzz")

    @cache
    def build(name: str, fmi: int, *options: str) -> Path:
        place = folder / f"{name}{fmi}{len(options)}"
        place.mkdir()
        for file, text in sources(COMPONENTS[name], fmi).items():
            (place / file).write_text(text, encoding="utf-8")
        host = HERE / ("fuzz.c" if fmi == 2 else "fuzz3.c")
        compiled(gcc, "-std=c99", *(options or SANITIZERS), f"-I{place}", "-o", place / "fuzz", host, "-lm")
        return place / "fuzz"

    return build


def fuzzed(host: Path, seed: int) -> list[int]:
    """How far the calls got: steps made, states restored (and times set, FMI 3), bytes taken for a
    state, bytes refused."""
    run = subprocess.run([host, str(seed), str(CALLS)], capture_output=True, text=True, check=False)
    assert run.returncode == 0, f"seed {seed}: {run.stderr[-4000:]}"
    return [int(word) for word in run.stdout.split()]


@pytest.mark.few(1, each="fmi")
@pytest.mark.parametrize("fmi", [2, 3])
@every_fmu
def test_random_calls_and_random_bytes_do_no_harm(fuzzer, name, fmi):
    stepped, other, unpacked, refused = fuzzed(fuzzer(name, fmi), 1)
    # by the seed 1090 to 3600 calls are steps that could be made, and 1990 to 2400 bytes for a state
    assert stepped > 1000 and unpacked > 100 and unpacked + refused > 1900
    assert other > 50
    record(WHAT.format(fmi), CALLS, refused)


@pytest.mark.slow
@pytest.mark.parametrize("fmi", [2, 3])
@every_fmu
def test_many_random_calls_and_bytes_do_no_harm(fuzzer, name, fmi):
    host = fuzzer(name, fmi)
    with ThreadPoolExecutor() as pool:
        counts = list(pool.map(lambda seed: fuzzed(host, seed), range(100, 150)))
    assert sum(each[2] + each[3] for each in counts) > 100_000
    refused = sum(each[3] for each in counts)
    record(WHAT.format(fmi), len(counts) * CALLS, refused)


@pytest.mark.slow
@pytest.mark.parametrize("fmi", [2, 3])
@every_fmu
def test_valgrind_finds_nothing(fuzzer, name, fmi):
    valgrind = shutil.which("valgrind")
    if valgrind is None:
        pytest.skip("valgrind is not installed")
    host = fuzzer(name, fmi, "-O1", "-g")
    call = [valgrind, "--error-exitcode=9", "--leak-check=full", "--quiet", host, "7", "5000"]
    run = subprocess.run(call, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr[-4000:]


def test_a_sanitizer_would_be_heard(gcc, tmp_path):
    # the tests above are worth nothing if the sanitizers are silent
    (tmp_path / "bad.c").write_text("int main(int n, char **w) { int a[2] = {0}; (void)w; return a[n + 1]; }")
    compiled(gcc, *SANITIZERS, "-o", tmp_path / "bad", tmp_path / "bad.c")
    assert subprocess.run([tmp_path / "bad"], capture_output=True, check=False).returncode != 0
