"""What threads share: made once, used by one at a time."""

import copy
import os
import pickle
import time

import pytest

from evenroad import _files, qmc
from evenroad._shared import OwnLock, once, once_property, one_at_a_time, recent
from tests.threads import THREADS, together


def slowly_made():
    time.sleep(0.01)
    return object()


def test_threads_that_ask_at_once_get_one_value_of_each_arguments():
    make = once(lambda *_: slowly_made())
    values = [[one for (one,) in together(lambda i=i: make(i))] for i in range(2)]
    assert [len(set(map(id, each))) for each in values] == [1, 1]
    assert values[0][0] is make(0) is not values[1][0]


def test_threads_get_one_value_of_a_property():
    class Value:
        made = once_property(lambda self: slowly_made())

    for value in (Value(), Value()):
        assert len({id(made) for (made,) in together(lambda value=value: value.made)}) == 1
    assert isinstance(Value.made, once_property)


def test_methods_are_called_one_after_the_other_and_copies_wait_for_nobody():
    class Value:
        def __init__(self):
            self._lock, self.inside, self.most = OwnLock(), 0, 0

        @one_at_a_time
        def use(self):
            self.inside += 1
            self.most = max(self.most, self.inside)
            time.sleep(1e-3)
            self.inside -= 1

    value = Value()
    together(value.use)
    assert value.most == 1
    with value._lock:
        copy.deepcopy(value).use()
        with pickle.loads(pickle.dumps(value._lock)):
            pass


def test_files_that_are_written_at_once_leave_the_rights_of_new_files_as_they_were(tmp_path, monkeypatch):
    umask = os.umask
    monkeypatch.setattr(_files.os, "umask", lambda mask: (umask(mask), time.sleep(1e-3))[0])
    usual = umask(0o027)
    try:
        names = iter(range(100))

        def write():
            path = tmp_path / str(next(names))
            with _files.atomic_write(path) as file:
                file.write(b"-")
            return path.stat().st_mode & 0o777

        assert together(write) == THREADS * [[0o640]]
        assert umask(0o027) == 0o027
    finally:
        umask(usual)


@pytest.mark.parametrize("made", [lambda: qmc.Growing(3, rng=1), lambda: qmc.Korobov(3, n=THREADS * 20, rng=1)])
def test_an_engine_hands_out_each_point_once(made):
    alone, shared = made().random(THREADS * 20), made()
    parts = together(lambda: [row for _ in range(10) for row in shared.random(2).tolist()])
    assert sorted(row for (part,) in parts for row in part) == sorted(alone.tolist())
    assert shared.num_generated == THREADS * 20
    assert shared.reset().random(5).tolist() == alone[:5].tolist()
    assert pickle.loads(pickle.dumps(shared)).random(5).tolist() == alone[5:10].tolist()
    assert shared.fast_forward(3).num_generated == 8


def test_recent_values_are_those_of_the_same_objects_and_few():
    made = []

    @recent(most=2)
    def doubled(values, times):
        made.append(values)
        return values * times

    one, other = [1], [1]
    assert doubled(one, 2) is doubled(one, 2)
    assert doubled(other, 2) == [1, 1]
    assert [each is one for each in made] == [True, False]
    doubled(one, 3)
    doubled(one, 2)
    assert len(made) == 4
