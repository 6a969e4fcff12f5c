import time

from numba import njit
from numba.core import event

from evenroad._clock import now
from evenroad._terminal import LineProgress


def test_the_clock_stands_still_while_code_is_compiled():
    @njit
    def inner(x):
        return x * x + 1.0

    @njit
    def outer(x):
        return inner(x) + inner(x + 1.0)

    wall, began = time.perf_counter(), now()
    assert outer(1.0) == 7.0
    wall, counted = time.perf_counter() - wall, now() - began
    assert wall > 0.02
    assert counted < 0.5 * wall


def test_the_clock_goes_on_otherwise():
    wall, began = time.perf_counter(), now()
    time.sleep(0.05)
    assert abs((now() - began) - (time.perf_counter() - wall)) < 0.02


def test_progress_does_not_count_what_compiling_takes():
    lines = []
    progress = LineProgress("work", lines.append, every=0.0)
    with event.trigger_event("numba:compile"):
        time.sleep(0.6)
    progress(0, 10)
    progress(1, 10)
    # Nine times as long again: more than 5 s with what compiling took.
    assert lines == ["work: 10 %, 0 s left"]
