"""The stepper and the judge in C, whole, under sanitizers: every example scene, and two threads at once."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from foreign_motors import gcc, motor2, motor3
from motor_scenes import LENGTH, MOTOR, SHAFT3

from loomfmu.cosim.claims import judging
from loomfmu.cosim.master import steppers

pytestmark = [
    pytest.mark.slow,
    pytest.mark.no_cover,
    pytest.mark.skipif(sys.platform != "linux", reason="the sanitizers are preloaded as on Linux"),
]

EXAMPLES = sorted((Path(__file__).parents[2] / "sims").glob("*.toml"))
CLAIM = '[[claims]]\nkind = "below"\nsignal = "{}"\nbound = "100 rad/s"\n'
# without isolation their calls are made in C, and those of the second by way of other types
FOREIGN = {
    "motor.toml": "isolated = false\n" + MOTOR + CLAIM.format("motor.flange_w"),
    "shaft.toml": "isolated = false\n" + LENGTH + SHAFT3 + CLAIM.format("shaft.velocity"),
}
RUN = """
import sys, threading
from pathlib import Path
import loomfmu
from loomfmu.cosim.claims import judging
from loomfmu.cosim.master import steppers
folder, at_once, *scenes = sys.argv[1:]
used = set()
def library_of(source):
    used.add(source.stem)
    return Path(folder) / f"{source.stem}.so"
judging.needed_library = steppers.library_of = library_of
def run():
    for scene in scenes:
        loomfmu.evaluate(scene)
threads = [threading.Thread(target=run) for _ in range(int(at_once))]
for each in threads: each.start()
for each in threads: each.join()
print(*sorted(used))
"""


def sanitized(folder: Path, sanitizers: str, scenes: list[Path], threads: int) -> str:
    """What the sanitizers say of runs of some scenes in so many threads at once."""
    runtime = {"thread": "libtsan.so"}.get(sanitizers, "libasan.so")
    for source in (steppers.SOURCE, judging.SOURCE):
        subprocess.run(
            [
                gcc(),
                "-shared",
                "-fPIC",
                "-O1",
                "-g1",
                f"-fsanitize={sanitizers}",
                "-ffp-contract=off",
                "-fno-sanitize-recover=undefined",
                "-o",
                folder / f"{source.stem}.so",
                source,
                "-lm",
            ],
            check=True,
        )
    found = subprocess.run([gcc(), f"-print-file-name={runtime}"], capture_output=True, text=True, check=True)
    done = subprocess.run(
        ["setarch", "-R", sys.executable, "-c", RUN, str(folder), str(threads), *map(str, scenes)],
        capture_output=True,
        text=True,
        check=False,
        env=os.environ
        | {
            "LD_PRELOAD": found.stdout.strip(),
            "ASAN_OPTIONS": "detect_leaks=0:halt_on_error=1",  # leaks: those of Python itself
            "TSAN_OPTIONS": "halt_on_error=1:ignore_noninstrumented_modules=1",
        },
    )
    assert done.returncode == 0, done.stderr[-4000:]
    assert done.stdout.split() == ["judge", "stepper"]
    return done.stderr


@pytest.fixture
def foreign(tmp_path: Path) -> list[Path]:
    """Scenes with third-party FMUs in this process."""
    motor2(tmp_path), motor3(tmp_path)
    for name, text in FOREIGN.items():
        (tmp_path / name).write_text(text)
    return [tmp_path / name for name in FOREIGN]


def test_no_access_out_of_bounds_and_nothing_undefined(tmp_path: Path, foreign: list[Path]) -> None:
    said = sanitized(tmp_path, "address,undefined,float-cast-overflow", [*foreign, *EXAMPLES], threads=1)
    assert "runtime error" not in said and "AddressSanitizer" not in said


def test_two_runs_in_two_threads_share_nothing(tmp_path: Path, foreign: list[Path]) -> None:
    assert "ThreadSanitizer" not in sanitized(tmp_path, "thread", [*foreign, *EXAMPLES[:3]], threads=2)
