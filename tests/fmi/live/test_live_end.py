"""The end of a process that has run live FMUs."""

import os
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

from loomfmu.cosim.importing import fmus
from loomfmu.fmi.native import compiler, platforms

pytestmark = pytest.mark.skipif(
    find_spec("ziglang") is None or not sys.platform.startswith("linux"),
    reason="a C compiler for Linux is needed",
)

# Instead of freeing memory, once told to look on, it makes it look like a state with one owner left, whose
# methods tell that somebody lets go of what he has no more. Wherever malloc puts it, that is found.
WITNESS = """
#define _GNU_SOURCE
#include <dlfcn.h>
#include <malloc.h>
#include <stdint.h>
#include <unistd.h>

enum { STATUS = 99 };

static void let_go_twice(void) { _exit(STATUS); }

static void (*const methods[4])(void) = {let_go_twice, let_go_twice, let_go_twice, let_go_twice};
static void (*really_free)(void *);
static volatile int looking_on;

__attribute__((constructor)) static void prepare(void)
{
    really_free = (void (*)(void *))dlsym(RTLD_NEXT, "free");
}

__attribute__((visibility("default"))) void look_on(void) { looking_on = 1; }

__attribute__((visibility("default"))) void free(void *memory)
{
    if (!looking_on) {
        if (really_free)
            really_free(memory);
        return;
    }
    volatile uintptr_t *block = memory;
    size_t words = block ? malloc_usable_size(memory) / sizeof *block : 0;
    for (size_t word = 0; word + 1 < words; word += 2) {
        block[word] = (uintptr_t)methods;
        block[word + 1] = (uintptr_t)1 << 32 | 1; /* one owner, one who watches */
    }
}
"""

HOSTS = {
    "fmpy frees the instances and deletes the files": """
import fmpy
for path in sys.argv[2:]:
    fmpy.simulate_fmu(path, stop_time=0.01, output_interval=1e-3)
""",
    "our master keeps its instances for another run": """
import pathlib
from loomfmu.cosim.importing import fmus, pool
for path in sys.argv[2:]:
    pool.give_back(pool.borrow(fmus.load(pathlib.Path(path)), "one"))
""",
    "nobody frees the instances": """
import pathlib
from loomfmu.cosim.importing import fmus, pool
kept = [pool.borrow(fmus.load(pathlib.Path(path)), name) for path in sys.argv[2:] for name in ("one", "two")]
kept[0].rest()
""",
}


@pytest.fixture(scope="module")
def witness(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The library that looks on."""
    source = tmp_path_factory.mktemp("witness") / "witness.c"
    source.write_text(WITNESS)
    source.with_suffix(".so").write_bytes(compiler.library(source, platforms.host()))
    return source.with_suffix(".so")


@pytest.mark.parametrize("host", HOSTS)
@pytest.mark.parametrize(
    ("before_the_end", "status"),
    # without what the FMUs do at the end the wrapper frees twice: once it is mended they need not do it
    [("", 0), ("import atexit; atexit._clear()", 99)],
    ids=["as it is", "as the wrapper would do it"],
)
def test_the_wrapper_lets_go_of_its_state_once(
    witness: Path, host: str, before_the_end: str, status: int
) -> None:
    script = f"import ctypes, sys\n{HOSTS[host]}\n{before_the_end}\nctypes.CDLL(sys.argv[1]).look_on()"
    paths = [str(fmus.of_component(name).path) for name in ("WeftInsertion", "BeltMonitor")]
    done = subprocess.run(
        [sys.executable, "-c", script, str(witness), *paths],
        env=os.environ | {"LD_PRELOAD": str(witness)},
        capture_output=True,
        text=True,
        timeout=100,
        check=False,
    )
    assert (done.returncode, done.stderr) == (status, "")


AFTER_THE_FORK = {
    "it ends at once": "",
    "it runs once more": "with Master(scene) as master:\n        master.initialize()",
}


@pytest.mark.parametrize("child", AFTER_THE_FORK)
def test_a_process_forked_after_a_run_ends_with_its_own_status(child: str) -> None:
    script = f"""
import os, sys
from loomfmu.cosim.master.master import Master
from loomfmu.cosim.scenes import scene as scenes
scene = scenes.parse('[loom]\\nmachine = "WL680-3600"')
with Master(scene) as master:
    master.initialize()
if child := os.fork():
    sys.exit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
else:
    {AFTER_THE_FORK[child]}
    print("said last", end="")
    sys.exit(7)
"""
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, timeout=100, check=False
    )
    assert (done.returncode, done.stdout, done.stderr) == (7, "said last", "")
