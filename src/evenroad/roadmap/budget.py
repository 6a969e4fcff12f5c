"""How much a planner or a query may spend."""

from __future__ import annotations

import time
from dataclasses import dataclass

from evenroad._checks import require_count, require_positive


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
        every machine.  None: no limit.

    Raises
    ------
    InvalidValue
        If a limit is not such a number.
    """

    seconds: float | None = 60.0
    motions: int | None = None
    samples: int = 1 << 16
    rounds: int | None = None

    def __post_init__(self) -> None:
        if self.seconds is not None:
            require_positive("seconds", self.seconds)
        if self.motions is not None:
            require_count("motions", self.motions)
        require_count("samples", self.samples)
        if self.rounds is not None:
            require_count("rounds", self.rounds)

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
        return time.perf_counter() + (float("inf") if self.seconds is None else self.seconds)
