"""The time of a query: one deadline, set where the query begins, at which every long loop below it ends.

Loops look at the clock now and then and raise `BudgetSpent` once the time is over: those of Python by `look_at_clock`,
compiled ones by themselves.  Whoever has something to hand out by then catches it.  The deadline is that of a thread,
so no function between has an argument for it; one that is set within another never ends later.
"""

from __future__ import annotations

import math
import sys
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from time import perf_counter as now

import numpy as np
import numpy.typing as npt

from evenroad._native.time_limit import Stop as Stop
from evenroad._native.time_limit import end_after as _end_after
from evenroad._native.time_limit import stop_early as _stop_early

_FIRST_BATCH = 4
"""Number of rows in the first batch of checks where time is limited."""
_SHARE, _LEAST, _MOST = 0.01, 2e-3, 2e-2
"""Share of the time that is left which a batch of checks should take, and the least and the most that it should [s].

Faster batches grow, slower ones shrink.  Of an array function a small batch takes as long as a larger one.
"""
_TO_LOAD = 0.1
"""Least time for which a large module is loaded that only proofs and reasons need [s]: once, it takes a bit more."""


class BudgetSpent(BaseException):
    """The budget does not allow another check; caught where there is something to hand out.

    It is no `Exception`: a user's function that catches all of these must not take it for an answer.
    """


@dataclass(frozen=True)
class Deadline:
    """When the work has to end, on the clock of ``time.perf_counter``."""

    at: float = math.inf

    @classmethod
    def after(cls, seconds: float | None) -> Deadline:
        """Return the deadline some seconds from now, None for no limit, or that of this thread if it comes first."""
        return cls(_here.at if seconds is None else min(now() + seconds, _here.at))

    @property
    def left(self) -> float:
        """The seconds that are left, >= 0."""
        return 0.0 if _is_stopped() else max(self.at - now(), 0.0)

    @property
    def is_over(self) -> bool:
        """Whether the time is over."""
        return now() >= self.at or _is_stopped()

    def part(self, began: float, share: float) -> Deadline:
        """Return the end of a share of the time that began at an instant."""
        return self if self.at == math.inf else Deadline(began + share * (self.at - began))


class _Here(threading.local):
    at = math.inf
    stop: Stop | None = None


_here = _Here()


def _is_stopped() -> bool:
    return _here.stop is not None and _here.stop.is_set


def _end_at(at: float) -> None:
    _here.at = at
    _end_after(at - now())


class until:
    """Limit the work of this thread in a block, besides earlier limits: ``with until(deadline):``."""

    __slots__ = ("_at", "_outer")

    def __init__(self, deadline: Deadline) -> None:
        self._at, self._outer = deadline.at, _here.at

    def __enter__(self) -> None:
        if self._at < self._outer:
            _end_at(self._at)

    def __exit__(self, *_: object) -> None:
        if self._at < self._outer:
            _end_at(self._outer)


class within(until):
    """Limit the work of this thread in a block to some seconds, None for no limit: ``with within(seconds):``."""

    __slots__ = ()

    def __init__(self, seconds: float | None) -> None:
        self._at, self._outer = math.inf if seconds is None else now() + seconds, _here.at


class stopped_by:
    """Let another thread end the work of this one in a block, as if its time were over: ``with stopped_by(stop):``."""

    __slots__ = ("_outer", "_stop")

    def __init__(self, stop: Stop) -> None:
        self._stop, self._outer = stop, _here.stop

    def __enter__(self) -> None:
        _here.stop = self._stop
        _stop_early(self._stop)

    def __exit__(self, *_: object) -> None:
        _here.stop = self._outer
        _stop_early(self._outer)


class off_the_clock:
    """Do what a query needs before its time begins, without a limit: the deadline moves by what the block takes."""

    __slots__ = ("_began", "_outer")

    def __enter__(self) -> None:
        self._outer, self._began = _here.at, now()
        if self._outer < math.inf:
            _end_at(math.inf)

    def __exit__(self, *_: object) -> None:
        if self._outer < math.inf:
            _end_at(self._outer + now() - self._began)


def look_at_clock(ahead: float = 0.0) -> None:
    """Raise BudgetSpent where the time of this thread is over, or what comes next takes longer than is left [s]."""
    if now() + ahead >= _here.at or _is_stopped():
        raise BudgetSpent


def require_time_for(module: str) -> None:
    """Raise BudgetSpent where a module that the answer can do without has not been loaded, and there is little time."""
    if module not in sys.modules:
        look_at_clock(_TO_LOAD)


def seconds_left() -> float:
    """Return how much time this thread has left, inf without a limit [s]."""
    return 0.0 if _is_stopped() else _here.at - now()


def is_limited() -> bool:
    """Return whether there is a limit to the time of this thread."""
    return _here.at < math.inf


class Pace:
    """The number of rows per check where time is limited: as many as take some milliseconds."""

    size: int = _FIRST_BATCH


def in_time(rows: npt.NDArray[np.integer], pace: Pace | None = None) -> Iterator[npt.NDArray[np.integer]]:
    """Yield `rows` in batches, all at once if the time is not limited.

    The pace carries over from call to call.  Raises BudgetSpent when the time is over and rows are left.
    """
    pace = Pace() if pace is None else pace
    first, is_paced = 0, is_limited()
    while first < len(rows):
        look_at_clock()
        began, size = now(), pace.size if is_paced else len(rows)
        yield rows[first : first + size]
        first += size
        if now() - began >= min(max(_SHARE * (_here.at - began), _LEAST), _MOST):
            pace.size = max(pace.size // 2, 1)
        elif first <= len(rows):
            # A last batch may have had fewer rows: it says nothing of a larger one.
            pace.size = 2 * pace.size
