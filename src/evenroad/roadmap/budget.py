"""How much a planner or a query may spend, and where the time went."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from evenroad._checks import require_count, require_positive

_FIRST_BATCH = 32
"""Rows asked about at first where time is limited."""
_FAST = 0.02
"""Seconds.  While batches take less, they grow; while they take more, they shrink."""


@dataclass(frozen=True, kw_only=True)
class Budget:
    """Limits of a search; when one is reached, the status is ``budget_spent`` unless a path is known by then.

    Attributes
    ----------
    seconds : float or None
        Wall time, > 0, looked at before each call of the world; what a planner finds within it depends on the
        machine.  The shortcut of a path that was found stops when it is over.  None: no limit.
    motions : int or None
        Motions checked, >= 1, without those of the shortcut.  None: no limit.
    samples : int
        Points drawn by a planner that grows, valid or not, >= 1.
    rounds : int or None
        How often a planner that improves plans again, >= 1; with it and without `seconds` the path is the same on
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
        """Return when the time is over, on the clock of ``time.perf_counter``, if it begins now."""
        return time.perf_counter() + (math.inf if self.seconds is None else self.seconds)


class BudgetSpent(Exception):
    """Nothing more may be checked; caught where the budget was given."""


def in_time(rows: npt.NDArray[np.integer], deadline: float) -> Iterator[npt.NDArray[np.integer]]:
    """Yield `rows` in batches, all at once if there is no deadline.

    Raises BudgetSpent when the deadline (on the clock of ``time.perf_counter``) has passed and there are rows left.
    """
    size = _FIRST_BATCH if math.isfinite(deadline) else max(len(rows), 1)
    first = 0
    while first < len(rows):
        began = time.perf_counter()
        if began >= deadline:
            raise BudgetSpent
        yield rows[first : first + size]
        first += size
        size = 2 * size if time.perf_counter() - began < _FAST else max(size // 2, 1)


class Stopwatch:
    """Adds up the seconds spent inside ``with watch("phase"):``, also when the block leaves early.

    A phase inside another one stops the clock of the outer one, so the phases add up to the whole.
    """

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self._running: list[str] = []
        self._since = 0.0

    @contextmanager
    def __call__(self, phase: str) -> Iterator[None]:
        """Time the block under this name."""
        self._turn()
        self._running.append(phase)
        self.seconds.setdefault(phase, 0.0)
        try:
            yield
        finally:
            self._turn()
            self._running.pop()

    def _turn(self) -> None:
        """Give the time since the last turn to the phase that was running."""
        now = time.perf_counter()
        if self._running:
            self.seconds[self._running[-1]] += now - self._since
        self._since = now
