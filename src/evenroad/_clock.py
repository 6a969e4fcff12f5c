"""The clock of budgets and phases. It stands still while code is compiled, once per machine.

For all threads: those that need what is compiled wait for it, and a clock that is set back would end nobody's time.
"""

from __future__ import annotations

import logging
import time
from typing import Any

from numba.core import event


class _Compiling(event.Listener):
    """Adds up what compilation took; one within another counts once, and numba has one thread at a time compile.

    `state` is what all took that ended, and when the one under way began, or None: one value, so that whoever reads it
    sees both of one moment.
    """

    def __init__(self) -> None:
        self._depth = 0
        self.state: tuple[float, float | None] = 0.0, None

    def on_start(self, event: Any) -> None:
        self._depth += 1
        if self._depth == 1:
            self.state = self.state[0], time.perf_counter()

    def on_end(self, event: Any) -> None:
        self._depth -= 1
        seconds, since = self.state
        if self._depth == 0 and since is not None:
            took = time.perf_counter() - since
            self.state = seconds + took, None
            logging.getLogger("evenroad").info("compiled for this machine, once: %.1f s", took)


_COMPILING = _Compiling()
event.register("numba:compile", _COMPILING)


def now() -> float:
    """Return seconds since some moment, without those spent compiling."""
    while True:
        state, wall = _COMPILING.state, time.perf_counter()
        if state is _COMPILING.state:
            seconds, since = state
            return (wall if since is None else since) - seconds
