"""Budgets of planners and queries, and how long each phase took."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from time import perf_counter as now

import numpy as np
import numpy.typing as npt

from evenroad._checks import require_count, require_positive

_FIRST_BATCH = 32
"""Number of rows in the first batch of checks where time is limited."""
_FAST = 0.02
"""Time that a batch of checks should take [s]; faster batches grow, slower ones shrink."""


@dataclass(frozen=True, kw_only=True)
class Budget:
    """Limits of a search; when one is reached, the status is ``budget_spent`` unless a path is known by then.

    Attributes
    ----------
    seconds : float or None
        Wall time, > 0, compared before each call of the world; what a planner finds within it depends on the
        machine.  Shortcutting stops when it runs out.  None: no limit.
    motions : int or None
        Largest number of motions checked, >= 1, without those of shortcutting.  None: no limit.
    samples : int
        Largest number of points drawn by a planner that grows, valid or not, >= 1.
    rounds : int or None
        Number of plans of a planner that improves, >= 1; with it and without `seconds` the path is the same on
        every machine.  None: no limit.  InvalidValue for any other limit.
    """

    seconds: float | None = 60.0
    motions: int | None = None
    samples: int = 1 << 16
    rounds: int | None = None

    def __post_init__(self) -> None:
        if self.seconds is not None:
            require_positive("seconds", self.seconds)
        for name in ("motions", "samples", "rounds"):
            if (most := getattr(self, name)) is not None:
                require_count(name, most)

    def text(self, *, samples: bool) -> str:
        """Return the limits in words, with the number of samples only for a planner that grows."""
        limits = [f"{self.samples} samples"] if samples else []
        if self.motions is not None:
            limits.append(f"{self.motions} motions")
        if self.seconds is not None:
            limits.append(f"{self.seconds:g} s")
        return ", ".join(limits)

    def deadline(self) -> float:
        """Return the deadline of a query that begins now, on the clock of ``time.perf_counter``."""
        return now() + (math.inf if self.seconds is None else self.seconds)

    def rest(self, deadline: float, motions: int) -> Budget:
        """Return the rest of the budget until a deadline and after this number of motions: at least 1 ms and one
        motion.
        """
        return replace(
            self,
            seconds=None if self.seconds is None else max(deadline - now(), 1e-3),
            motions=None if self.motions is None else max(self.motions - motions, 1),
        )


class BudgetSpent(Exception):
    """The budget does not allow another check; caught where the budget was given."""


class Pace:
    """The number of rows per check where time is limited: as many as take some milliseconds."""

    size: int = _FIRST_BATCH


def in_time(
    rows: npt.NDArray[np.integer], deadline: float, pace: Pace | None = None
) -> Iterator[npt.NDArray[np.integer]]:
    """Yield `rows` in batches, all at once if there is no deadline.

    The pace carries over from call to call.  Raises BudgetSpent when the deadline (of ``time.perf_counter``) has passed
    and rows are left.
    """
    pace = Pace() if pace is None else pace
    first, is_limited = 0, math.isfinite(deadline)
    while first < len(rows):
        began = now()
        if began >= deadline:
            raise BudgetSpent
        size = pace.size if is_limited else len(rows)
        yield rows[first : first + size]
        first += size
        if now() - began >= _FAST:
            pace.size = max(pace.size // 2, 1)
        elif size <= len(rows):
            pace.size = 2 * pace.size


class Stopwatch:
    """Adds up the seconds spent inside ``with watch("phase"):``, also when the block raises.

    A phase inside another one stops the clock of the outer one, so the phases add up to the whole.
    """

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self._running: list[str] = []
        self._next = ""
        self._since = 0.0

    def __call__(self, phase: str) -> Stopwatch:
        """Return a context that times a block under this name."""
        self._next = phase
        return self

    def __enter__(self) -> None:
        began = now()
        if self._running:
            self.seconds[self._running[-1]] += began - self._since
        self._running.append(self._next)
        self.seconds.setdefault(self._next, 0.0)
        self._since = began

    def __exit__(self, *error: object) -> None:
        ended = now()
        self.seconds[self._running.pop()] += ended - self._since
        self._since = ended
