"""Worker processes: tasks and what becomes of them, also of those that end their process."""

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import odd_tasks
import psutil
import pytest

from loomfmu import LoomfmuError
from loomfmu.sweeps.pools import Here, Processes, Task, WorkerDied, _undisturbed
from loomfmu.sweeps.schedule import Pool


@pytest.fixture
def two() -> Iterator[Processes]:
    pool = Processes(2)
    yield pool
    pool.close()


def all_done(pool: Pool, tasks: list[Task]) -> dict[object, object]:
    found: dict[object, object] = {}
    count = len(tasks)
    while len(found) < count:
        while tasks and pool.room() > 0:
            pool.submit(tasks.pop(0))
        found |= pool.finished()
    return found


def test_tasks_are_shared_by_processes_that_stay(two: Processes) -> None:
    assert two.room() == 2
    found = all_done(two, [Task(number, odd_tasks.pid, (number,)) for number in range(20)])
    assert set(found) == set(range(20))
    assert len(set(found.values())) == 2
    assert os.getpid() not in found.values()


@pytest.mark.slow
def test_what_a_task_raises_is_its_outcome(two: Processes) -> None:
    for pool in (two, Here()):
        found = all_done(pool, [Task(number, odd_tasks.refuse, (number,)) for number in range(3)])
        assert [repr(found[number]) for number in range(3)] == [f"ValueError('not {n}')" for n in range(3)]


@pytest.mark.slow
def test_the_end_of_a_process_is_the_outcome_of_its_task_alone(two: Processes) -> None:
    tasks = [Task(number, odd_tasks.pid, (number,)) for number in range(6)]
    tasks.insert(3, Task("end", odd_tasks.end, ()))
    found = all_done(two, tasks)
    ended = found.pop("end")
    assert isinstance(ended, WorkerDied) and str(ended) == "the process that ran it ended with SIGKILL"
    assert all(isinstance(each, int) for each in found.values())


@pytest.mark.slow
def test_a_process_that_is_killed_while_it_waits_costs_no_more_than_the_next_task(two: Processes) -> None:
    found = all_done(two, [Task(number, odd_tasks.pid, (number,)) for number in range(2)])
    for victim in set(found.values()):
        assert isinstance(victim, int)
        os.kill(victim, signal.SIGKILL)
        while psutil.Process(victim).status() != psutil.STATUS_ZOMBIE:
            time.sleep(0.01)
    after = all_done(two, [Task(number, odd_tasks.pid, (number,)) for number in range(6)])
    assert sum(isinstance(each, WorkerDied) for each in after.values()) <= 2
    assert sum(isinstance(each, int) for each in after.values()) >= 4


@pytest.mark.slow
def test_a_closed_pool_leaves_no_process() -> None:
    pool = Processes(2)
    found = all_done(pool, [Task(number, odd_tasks.pid, (number,)) for number in range(2)])
    pool.close()
    assert not any(psutil.pid_exists(each) for each in found.values() if isinstance(each, int))


SCRIPT = """
from loomfmu.sweeps.pools import Processes, Task
import os, time
pool = Processes(2)
pool.submit(Task(0, time.sleep, (600,)))
pool.submit(Task(1, os.getpid, ()))
print(pool.finished()[0][1], flush=True)
time.sleep(600)
"""


def test_workers_end_with_the_process_that_started_them(tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text(
        'if __name__ == "__main__":\n' + "".join(f"    {line}\n" for line in SCRIPT.splitlines())
    )
    parent = subprocess.Popen([sys.executable, str(script)], stdout=subprocess.PIPE, text=True)
    assert parent.stdout is not None
    assert int(parent.stdout.readline()) > 0
    workers = psutil.Process(parent.pid).children(recursive=True)
    assert len(workers) >= 2
    parent.kill()
    parent.wait()
    parent.stdout.close()
    _gone, alive = psutil.wait_procs(workers, timeout=20)
    assert not alive


def test_a_script_without_main_guard_is_told_what_to_do(tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text(SCRIPT)
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, timeout=60)
    assert done.returncode == 1
    # a worker's own traceback may reach the shared standard error after the line of this process
    assert 'call sweep() under if __name__ == "__main__":' in done.stderr


def test_the_end_of_a_worker_at_its_start_is_no_fault_of_a_task(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("loomfmu.sweeps.pools._serve", odd_tasks.pid)  # ends at once
    pool = Processes(1)
    pool.submit(Task(0, odd_tasks.pid, (0,)))
    with pytest.raises(LoomfmuError, match="worker processes do not start"):
        pool.finished()
    pool.close()


def test_a_pool_of_one_is_this_process() -> None:
    assert all_done(Here(), [Task(0, odd_tasks.pid, (0,))]) == {0: os.getpid()}


@pytest.mark.skipif(not hasattr(signal, "pthread_sigmask"), reason="Windows cannot keep a signal waiting")
def test_ctrl_c_while_a_worker_is_started_is_heard_after_it() -> None:
    with pytest.raises(KeyboardInterrupt), _undisturbed():
        # to this thread: another one of this process might not keep it waiting
        signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)
        heard = False
    assert heard is False, "the start itself was not disturbed"


FIRST = """
from loomfmu.sweeps.pools import Processes, Task
import time
pool = Processes(1)
pool.submit(Task(0, time.sleep, (600,)))
print(open(f"/proc/{pool._workers[0].process.pid}/status").read(), flush=True)
pool.close()
"""


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="only Linux shows what a process hears")
def test_the_very_first_worker_does_not_hear_ctrl_c() -> None:
    done = subprocess.run([sys.executable, "-c", FIRST], capture_output=True, text=True, check=True)
    blocked = dict(line.split(":\t") for line in done.stdout.splitlines() if ":\t" in line)["SigBlk"]
    assert int(blocked, 16) & 1 << signal.SIGINT - 1
