"""The command line: one module per verb, a frozen dataclass of its options and a function that runs it."""

from __future__ import annotations

import _thread
import gc
import io
import signal
import sys
import threading
import warnings
from collections.abc import Sequence
from types import TracebackType

INTERRUPTED = 130
"""Exit code after Ctrl-C."""
INTERNAL_ERROR = 70
"""Exit code after an internal error; Python's own, 1, stands for a result without a path."""
SOON = 0.05
"""Time after which a dropped interrupt is sent again [s]."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run ``evenroad`` and return its exit code: 0 solved, 1 any other result, 2 bad input, 130 interrupted.

    Without arguments, as in the command, it prints the traceback of an internal error and returns 70.
    """
    if arguments is not None:
        try:
            return _run(arguments)
        except KeyboardInterrupt:
            return interrupted()
    # Imports make many objects and no garbage, and looking for some takes time.
    gc.set_threshold(100_000, 50, 50)
    warnings.formatwarning = lambda message, *where: f"evenroad: warning: {message}\n"
    hook = _Unraisable()
    sys.unraisablehook = hook
    # Cython prints exceptions that it drops by this one first.
    sys.excepthook = _print_unless_interrupted
    try:
        return _run(sys.argv[1:])
    except (KeyboardInterrupt, Exception) as error:
        # A compiler that is interrupted in a callback goes on without it, and may fail.
        if not isinstance(error, KeyboardInterrupt) and not hook.interrupted:
            return _internal_error(error)
        # The process ends: one more Ctrl-C would only print a traceback.
        try:
            signal.signal(signal.SIGINT, signal.SIG_IGN)
        except KeyboardInterrupt:
            # It came while files were closed.
            signal.signal(signal.SIGINT, signal.SIG_IGN)
        return interrupted()


def _run(arguments: Sequence[str]) -> int:
    for stream in (sys.stdout, sys.stderr):
        # Characters that a pipe's encoding lacks are escaped, so that no name makes an answer fail.
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    # Imported late, since Ctrl-C may come while this loads.
    from evenroad.cli.verbs import run

    return run(arguments)


def interrupted() -> int:
    """Say that Ctrl-C came, and return its exit code."""
    print("evenroad: interrupted; what was finished is kept", file=sys.stderr)
    return INTERRUPTED


def _internal_error(error: BaseException) -> int:
    sys.__excepthook__(type(error), error, error.__traceback__)
    print("evenroad: internal error: please report the lines above; this is no answer", file=sys.stderr)
    return INTERNAL_ERROR


def _print_unless_interrupted(kind: type[BaseException], error: BaseException, where: TracebackType | None) -> None:
    if kind is not KeyboardInterrupt:
        sys.__excepthook__(kind, error, where)


class _Unraisable:
    """Sends a Ctrl-C again that came in a callback of compiled code, which drops exceptions."""

    def __init__(self) -> None:
        self.interrupted = False

    def __call__(self, dropped: sys.UnraisableHookArgs) -> None:
        if dropped.exc_type is not KeyboardInterrupt:
            sys.__unraisablehook__(dropped)
            return
        self.interrupted = True
        # Later: raised here, it would be dropped again.
        again = threading.Timer(SOON, _thread.interrupt_main)
        again.daemon = True
        again.start()
