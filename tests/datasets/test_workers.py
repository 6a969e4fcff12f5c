"""Worker processes: one thread each, deaf to Ctrl-C, and gone when their parent is."""

import ctypes
import os
import signal
import subprocess
import sys
import time
from concurrent.futures.process import BrokenProcessPool

import pytest

from evenroad.datasets.workers import ProcessPool, SerialExecutor
from tests.refused import refused

PATIENCE = 60.0

PARENT_OF_IDLE_WORKERS = """
import os, time
from evenroad.datasets.workers import ProcessPool

if __name__ == "__main__":
    pool = ProcessPool(2)
    # Each takes long enough for the other process to start, too.
    asleep = [pool.submit(time.sleep, 0.5) for _ in range(2)]
    for future in asleep:
        future.result()
    print(*pool._processes, flush=True)
    time.sleep(600.0)
"""


def _is_running(process):
    try:
        with open(f"/proc/{process}/stat") as file:
            # A zombie has ended: whoever adopted it has just not looked yet.
            return file.read().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


@pytest.mark.skipif(not os.path.isdir("/proc/self"), reason="processes are looked up in /proc")
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL])
def test_idle_workers_end_when_their_parent_is_killed(tmp_path, number):
    script = tmp_path / "parent.py"
    script.write_text(PARENT_OF_IDLE_WORKERS)
    parent = subprocess.Popen([sys.executable, script], stdout=subprocess.PIPE, text=True)
    workers = [int(word) for word in parent.stdout.readline().split()]
    assert len(workers) == 2
    assert all(map(_is_running, workers))
    parent.send_signal(number)
    parent.communicate(timeout=PATIENCE)
    deadline = time.monotonic() + PATIENCE
    while any(map(_is_running, workers)):
        assert time.monotonic() < deadline, "workers outlive their parent"
        time.sleep(0.05)


def test_each_process_has_one_thread_and_is_set_up_once_before_its_first_call():
    with ProcessPool(1, os.putenv, ("EVENROAD_SET_UP", "yes")) as pool:
        shell = pool.submit(subprocess.check_output, "echo $EVENROAD_SET_UP", shell=True)
        assert shell.result() == b"yes\n"
        assert pool.submit(os.getenv, "OMP_NUM_THREADS").result() == "1"


def test_processes_that_are_not_waited_for_are_ended_in_what_they_do():
    pool = ProcessPool(1)
    asleep = pool.submit(time.sleep, 10 * PATIENCE)
    deadline = time.monotonic() + PATIENCE
    # A call that does not run yet is cancelled, and its process has nothing to be ended in.
    while not asleep.running():
        assert time.monotonic() < deadline, "the call does not begin"
        time.sleep(0.01)
    pool.shutdown(wait=False, cancel_futures=True)
    # Not asked of the process: the pool's own thread takes its exit status, which is for a moment known to neither.
    assert isinstance(asleep.exception(PATIENCE), BrokenProcessPool)


def test_a_call_in_this_process_that_dropped_an_interrupt_has_no_result():
    """What compiled code computes after it may be wrong: SciPy's Sobol points are zeros."""

    def drops():
        raise KeyboardInterrupt

    def fails_then():
        ctypes.CFUNCTYPE(None)(drops)()
        raise ValueError("no compiled object yet")

    before, seen = sys.unraisablehook, []
    sys.unraisablehook = seen.append
    try:
        refused(KeyboardInterrupt, "", lambda: SerialExecutor().submit(ctypes.CFUNCTYPE(None)(drops)))
        refused(KeyboardInterrupt, "", lambda: SerialExecutor().submit(fails_then))
        assert sys.unraisablehook == seen.append
    finally:
        sys.unraisablehook = before
    assert [dropped.exc_type for dropped in seen] == [KeyboardInterrupt] * 2
