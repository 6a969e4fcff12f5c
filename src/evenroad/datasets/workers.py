"""Workers: in this process, in others of this machine, or wherever an executor sends calls; and Ctrl-C."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, ParamSpec, TypeVar

from evenroad._checks import require_count
from evenroad._threads import processors

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")
THREAD_VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


@dataclass(frozen=True)
class Workers:
    """Functions that make an executor, again after its processes died, and count the calls that it runs at a time."""

    make: Callable[[], Executor]
    count: Callable[[Any], int]


def in_process() -> Workers:
    """Return this process as the only worker, for tests, debuggers and profilers."""
    return Workers(SerialExecutor, lambda executor: 1)


def processes(jobs: int | None = None) -> Workers:
    """Return processes of this machine, each with one thread; by default one a processor.

    They are spawned: a script must guard its main part with ``if __name__ == "__main__"``.
    """
    jobs = processors() if jobs is None else require_count("jobs", jobs)
    return Workers(lambda: ProcessPool(jobs), lambda executor: jobs)


class SerialExecutor(Executor):
    """Runs each call at once, in this process."""

    def submit(
        self, fn: Callable[Arguments, Result], /, *args: Arguments.args, **kwargs: Arguments.kwargs
    ) -> Future[Result]:
        """Run the call; its exception is kept in the future, but Ctrl-C stops everything."""
        future: Future[Result] = Future()
        try:
            with _dropped_interrupts_raised():
                future.set_result(fn(*args, **kwargs))
        except Exception as error:
            future.set_exception(error)
        return future


class ProcessPool(ProcessPoolExecutor):
    """A pool whose processes have one thread each, leave Ctrl-C to the parent, and end when the parent ends.

    `initializer` is called once in each process, with `initargs`.
    """

    def __init__(
        self, jobs: int, initializer: Callable[..., object] | None = None, initargs: tuple[object, ...] = ()
    ) -> None:
        # Spawned, not forked: a fork of a process with threads (BLAS) can hang.
        super().__init__(
            jobs, multiprocessing.get_context("spawn"), initializer=_settle, initargs=(initializer, initargs)
        )

    def submit(
        self, fn: Callable[Arguments, Result], /, *args: Arguments.args, **kwargs: Arguments.kwargs
    ) -> Future[Result]:
        """Submit a call; a process that starts for it ignores Ctrl-C from its first moment."""
        with _interrupts_held_back():
            return super().submit(fn, *args, **kwargs)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Shut down; without `wait`, end the processes, for whose calls Python would wait when it exits."""
        running = list((self._processes or {}).values())
        try:
            super().shutdown(wait, cancel_futures=cancel_futures)
        finally:
            if not wait:
                for process in running:
                    process.terminate()


@contextmanager
def _interrupts_held_back() -> Iterator[None]:
    """Block SIGINT in this thread for the block; processes and threads that start in it have it blocked.

    An initializer alone comes too late: importing takes a second, and a terminal sends the signal to all.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _dropped_interrupts_raised() -> Iterator[None]:
    """Raise at the end of the block an interrupt that compiled code dropped in it.

    SciPy's Sobol points are zeros after one that came while they read their direction numbers.
    """
    before, dropped = sys.unraisablehook, False

    def note(what: sys.UnraisableHookArgs) -> None:
        nonlocal dropped
        dropped = dropped or what.exc_type is KeyboardInterrupt
        before(what)

    sys.unraisablehook = note
    try:
        yield
    finally:
        sys.unraisablehook = before
        # An interrupt counts more than whatever the call raised.
        if dropped:
            raise KeyboardInterrupt


def _settle(initializer: Callable[..., object] | None, initargs: tuple[object, ...]) -> None:
    """Prepare a worker process, before NumPy is imported there."""
    for name in THREAD_VARIABLES:
        os.environ.setdefault(name, "1")
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_leave_with_parent, daemon=True).start()
    if initializer is not None:
        initializer(*initargs)


def _leave_with_parent() -> None:
    """End this process when the parent has ended: nobody else would."""
    parent = multiprocessing.parent_process()
    assert parent is not None  # a worker has one
    parent.join()
    os._exit(1)


@contextmanager
def interrupt_between_steps() -> Iterator[Callable[[], None]]:
    """Yield ``check()``, which raises KeyboardInterrupt if Ctrl-C was pressed; a second Ctrl-C acts at once.

    A signal handler runs in the middle of a computation, when state is half-written; between steps, what is done is
    kept.  Outside the main thread handlers cannot be set and nothing changes.
    """
    pressed = False

    def check() -> None:
        if pressed:
            raise KeyboardInterrupt

    def press(number: int, frame: object) -> None:
        nonlocal pressed
        if pressed:
            raise KeyboardInterrupt
        pressed = True
        print("evenroad: stopping after this step (Ctrl-C again: at once)", file=sys.stderr)

    before = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or before != signal.default_int_handler:
        # An ignored SIGINT (nohup, a background job) and a handler of others stay as they are.
        yield check
        return
    signal.signal(signal.SIGINT, press)
    try:
        yield check
    finally:
        signal.signal(signal.SIGINT, before)
