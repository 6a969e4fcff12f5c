"""Ctrl-C between two steps: the first one waits for the step to end, so that nothing done is lost."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def interrupt_between_steps() -> Iterator[Callable[[], None]]:
    """Yield ``check()``, which raises KeyboardInterrupt if Ctrl-C was pressed; a second Ctrl-C acts at once.

    A signal handler runs in the middle of whatever is computed, where state is half-written; the library keeps
    what is done when its callback raises.  Outside the main thread handlers cannot be set and nothing changes.
    """
    pressed = False

    def check() -> None:
        if pressed:
            raise KeyboardInterrupt

    def press(number: int, frame: object) -> None:
        nonlocal pressed
        if pressed:
            raise KeyboardInterrupt
        pressed = True
        print("evenroad: stopping after this step (Ctrl-C again: at once)", file=sys.stderr)

    before = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or before != signal.default_int_handler:
        # Not ours to set, or somebody else's: with SIGINT ignored (nohup, a background job) it stays so.
        yield check
        return
    signal.signal(signal.SIGINT, press)
    try:
        yield check
    finally:
        signal.signal(signal.SIGINT, before)
