"""The folder that a training fills: one process at a time."""

import threading
import time

from evenroad_studies.training.folder import one_at_a_time


def test_a_lock_makes_others_wait_until_it_is_let_go(tmp_path):
    inside, turns = threading.Event(), []

    def second():
        inside.wait()
        with one_at_a_time(tmp_path / "lock"):
            turns.append("second")

    other = threading.Thread(target=second)
    other.start()
    with one_at_a_time(tmp_path / "lock"):
        inside.set()
        time.sleep(0.2)
        turns.append("first")
    other.join()
    assert turns == ["first", "second"]
