"""The clock of budgets and phases: it stands still while code is compiled, which happens once on a machine."""

from __future__ import annotations

import logging
import time
from typing import Any

from numba.core import event


class _Compiling(event.Listener):
    """Adds up what compilation took; one within another counts once."""

    def __init__(self) -> None:
        self.seconds, self._depth, self._since = 0.0, 0, 0.0

    def on_start(self, event: Any) -> None:
        if self._depth == 0:
            self._since = time.perf_counter()
        self._depth += 1

    def on_end(self, event: Any) -> None:
        self._depth -= 1
        if self._depth == 0:
            took = time.perf_counter() - self._since
            self.seconds += took
            logging.getLogger("evenroad").info("compiled for this machine, once: %.1f s", took)


_COMPILING = _Compiling()
event.register("numba:compile", _COMPILING)


def now() -> float:
    """Return seconds since some moment, without those spent compiling."""
    return time.perf_counter() - _COMPILING.seconds
