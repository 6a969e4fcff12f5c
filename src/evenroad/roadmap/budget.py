"""Budgets of planners and queries, and a stopwatch for their phases."""

from __future__ import annotations

from dataclasses import dataclass
from time import perf_counter as now

from evenroad._checks import require_count, require_positive

BEFORE_PROOF, BEFORE_REASONS = 0.7, 0.9
"""Shares of the time.  `BEFORE_PROOF`: the search ends, and a proof that there is no path begins, unless one was tried.
`BEFORE_REASONS`: search and proof end, and the rest is to find reasons why there is no path."""


@dataclass(frozen=True, kw_only=True)
class Budget:
    """Limits of a search; when one is reached, the status is ``budget_spent`` unless a path is known by then.

    Attributes
    ----------
    seconds : float or None
        Wall time, > 0; the result within it depends on the machine.  A path that is found by then is the answer,
        smoothed or not.  None: no limit.
    motions : int or None
        Largest number of motions checked, >= 1, not counting shortcutting.  None: no limit.
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


class Stopwatch:
    """Sums the seconds spent inside ``with watch("phase"):``, also when the block raises.

    A phase inside another one pauses the outer one, so the phases add up to the whole.
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
