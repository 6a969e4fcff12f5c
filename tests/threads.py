"""Asking from several threads at once, which take turns a hundred times as often as usual."""

import sys
import threading
from concurrent.futures import ThreadPoolExecutor

THREADS = 8


def together(*asks):
    """What functions of no arguments return to each of eight threads that begin at once, each with another one."""
    ready, usual = threading.Barrier(THREADS), sys.getswitchinterval()

    def asked(thread):
        ready.wait()
        answers = {i % len(asks): asks[i % len(asks)]() for i in range(thread, thread + len(asks))}
        return [answers[i] for i in range(len(asks))]

    sys.setswitchinterval(1e-5)
    try:
        with ThreadPoolExecutor(THREADS) as pool:
            return list(pool.map(asked, range(THREADS)))
    finally:
        sys.setswitchinterval(usual)
