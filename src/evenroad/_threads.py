"""Threads of this process for compiled code, which releases the interpreter's lock."""

from __future__ import annotations

import multiprocessing
import os
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from itertools import starmap
from typing import TypeVar

AHEAD = 32
"""Number of tasks that are drawn before the first of them is done."""

Result = TypeVar("Result")


def processors() -> int:
    """Return how many processors this process may use; 1 for a worker of others, which use the rest."""
    if multiprocessing.parent_process() is not None:
        return 1
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def in_order(
    function: Callable[..., Result], tasks: Iterable[tuple[object, ...]], threads: int | None = None
) -> Iterator[Result]:
    """Yield results of a function for tasks, its arguments, in their order, by default of one thread a processor."""
    threads = processors() if threads is None else threads
    if threads < 2:
        yield from starmap(function, tasks)
        return
    waiting: deque[Future[Result]] = deque()
    with ThreadPoolExecutor(threads) as pool:
        try:
            for task in tasks:
                waiting.append(pool.submit(function, *task))
                if len(waiting) > AHEAD:
                    yield waiting.popleft().result()
            while waiting:
                yield waiting.popleft().result()
        finally:
            pool.shutdown(wait=False, cancel_futures=True)
