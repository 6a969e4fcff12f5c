"""How much an anytime planner may spend."""

from __future__ import annotations

import time
from dataclasses import dataclass

from evenroad._checks import require_count, require_positive


@dataclass(frozen=True, kw_only=True)
class Budget:
    """Limits of a search that grows; None means that there is none of this kind.

    Attributes
    ----------
    samples : int
        Points drawn, valid or not.
    checks : int or None
        Motions checked, without those of the shortcut.
    seconds : float or None
        Wall time, looked at before each call of the world; answers then depend on the machine.

    Raises
    ------
    InvalidValue
        If a limit is not such a number.
    """

    samples: int = 1 << 16
    checks: int | None = None
    seconds: float | None = None

    def __post_init__(self) -> None:
        require_count("samples", self.samples)
        if self.checks is not None:
            require_count("checks", self.checks, at_least=0)
        if self.seconds is not None:
            require_positive("seconds", self.seconds, or_zero=True)

    def __str__(self) -> str:
        limits = [f"{self.samples} samples"]
        if self.checks is not None:
            limits.append(f"{self.checks} checks")
        if self.seconds is not None:
            limits.append(f"{self.seconds:g} s")
        return ", ".join(limits)

    def deadline(self) -> float:
        """Return when the time is over, on the clock of ``time.perf_counter``, if it begins now."""
        return time.perf_counter() + (float("inf") if self.seconds is None else self.seconds)
