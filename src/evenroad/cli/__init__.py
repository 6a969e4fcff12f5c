"""The command line: one verb a module, each a frozen dataclass of its options and a function that runs it."""

from __future__ import annotations

import gc
import signal
import sys
from collections.abc import Sequence

INTERRUPTED = 130
"""Exit code after Ctrl-C."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run ``evenroad`` and return its exit code: 0 solved, 1 any other answer, 2 bad input, 130 interrupted."""
    if arguments is None:
        # A process of our own: imports make very many objects and no garbage, and looking for some takes time.
        gc.set_threshold(100_000, 50, 50)
    try:
        # Inside, since Ctrl-C may well come while this loads.
        from evenroad.cli.verbs import run

        return run(sys.argv[1:] if arguments is None else arguments)
    except KeyboardInterrupt:
        if arguments is None:
            # This process is leaving: one more Ctrl-C could only break that, with a traceback.
            try:
                signal.signal(signal.SIGINT, signal.SIG_IGN)
            except KeyboardInterrupt:
                # It had come while files were closed, and is only seen here.
                signal.signal(signal.SIGINT, signal.SIG_IGN)
        print("evenroad: interrupted; what was finished is kept", file=sys.stderr)
        return INTERRUPTED
