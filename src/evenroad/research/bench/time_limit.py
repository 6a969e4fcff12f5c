"""A limit on the wall time of a block."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from evenroad._checks import require_positive
from evenroad.errors import InvalidValue

DEFAULT_LIMIT = 600.0
"""Seconds for a task; the slowest of the suites take less than one."""

LONGEST_LIMIT = 1e6
"""Seconds; the clocks of some platforms take no much larger number."""


class OverTime(BaseException):
    """The time is over.  No Exception, so that code in the block that catches those does not swallow it."""


def require_limit(seconds: float | None) -> None:
    """Raise InvalidValue unless this is a limit in (0, 10^6] s, or None for no limit."""
    if seconds is not None and require_positive("limit", seconds) > LONGEST_LIMIT:
        raise InvalidValue(f"limit must be at most {LONGEST_LIMIT:g} s, got {seconds!r}")


@contextmanager
def time_limit(seconds: float | None) -> Iterator[None]:
    """Raise OverTime in the block after so many seconds; None means no limit.

    It takes a SIGALRM, so nothing is limited on platforms without it, nor outside of the main thread.  Compiled code
    is not interrupted: the error comes when it returns.
    """
    here = threading.current_thread() is threading.main_thread()
    if seconds is None or not here or not hasattr(signal, "SIGALRM"):
        yield
        return

    def ring(number: int, frame: object) -> None:
        raise OverTime

    before = signal.signal(signal.SIGALRM, ring)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
