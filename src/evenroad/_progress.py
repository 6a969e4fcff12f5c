"""Progress as plain lines, for logs: one every few seconds, with the time that remains."""

from __future__ import annotations

import time
from collections.abc import Callable


class LineProgress:
    """A ``callback(step, steps[, best])`` that reports a line now and then, at the pace since it was made.

    Parameters
    ----------
    title : str
        What is being done.
    report : callable
        Gets each line, a str.
    every : float
        Seconds between two lines; work that ends sooner reports nothing.
    """

    def __init__(self, title: str, report: Callable[[str], object], every: float = 10.0) -> None:
        self.title, self.report, self.every = title, report, every
        self.began = self.last = time.monotonic()
        self.first_step: int | None = None

    def __call__(self, step: int, steps: int, best: float | None = None) -> None:
        """Take note of `step` of `steps`, counted over all sets."""
        now = time.monotonic()
        if self.first_step is None:
            # Work that was resumed has steps behind it which say nothing about today's pace.
            self.first_step = step
        if now - self.last < self.every or step <= self.first_step:
            return
        self.last = now
        left = (now - self.began) / (step - self.first_step) * (steps - step)
        value = "" if best is None else f", best {best:.5g}"
        self.report(f"{self.title}: {100 * step / steps:.0f} %, {left:.0f} s left{value}")
