"""Many sets: the same whatever the processes, and safe on disk at any moment."""

import json
import os
import signal
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress

import numpy as np
import pytest

from evenroad.errors import EvenroadError, InvalidValue, WorkerLost
from evenroad.points import load_points
from evenroad.points.anneal import SCHEDULE, anneal
from evenroad.points.measures import MEASURES
from evenroad_studies.training import anneal_many
from tests.refused import refused

SMALL = {"n": 8, "d": 2, "objective": "star", "steps": 20}


class Stop(Exception):
    pass


def test_set_i_comes_from_child_i_of_the_seed():
    third = anneal_many(**SMALL, sets=3, workers=1, rng=5)[2]
    child = np.random.SeedSequence(5, spawn_key=(2,))
    assert third.points.tobytes() == anneal(**SMALL | {"objective": MEASURES["star"]}, rng=child).points.tobytes()
    again = anneal_many(**SMALL, sets=3, workers=1, rng=np.random.SeedSequence(5))[2]
    assert third.points.tobytes() == again.points.tobytes()


def test_origins_say_what_was_done():
    plain = anneal_many(**{**SMALL, "objective": "asd+2*riesz"}, rng=5, workers=1)[0].origin
    assert plain.method == "annealed"
    assert plain.objective == plain.family == "log(average_squared) + 2*log(riesz)"
    assert (plain.seed, plain.replica) == (5, 0)
    named = anneal_many(**SMALL, rng=np.random.default_rng(0), family="even", workers=1)[0].origin
    assert (named.family, named.seed) == ("even", None)


def test_finished_sets_are_read_and_not_made_again(tmp_path):
    first = anneal_many(**SMALL, sets=2, workers=1, folder=tmp_path)
    before = [os.stat(tmp_path / f"set-000{i}.npz").st_mtime_ns for i in range(2)]
    calls = []
    more = anneal_many(**SMALL, sets=3, workers=1, folder=tmp_path, callback=lambda *a: calls.append(a))
    assert more[:2] == first
    assert [os.stat(tmp_path / f"set-000{i}.npz").st_mtime_ns for i in range(2)] == before
    assert [step for step, _, _ in calls] == list(range(41, 61))
    assert {steps for _, steps, _ in calls} == {60}


def test_a_damaged_set_is_made_again(tmp_path):
    first = anneal_many(**SMALL, sets=2, workers=1, folder=tmp_path)
    file = tmp_path / "set-0001.npz"
    file.write_bytes(file.read_bytes()[:100])
    assert anneal_many(**SMALL, sets=2, workers=1, folder=tmp_path) == first
    assert load_points(file) == first[1]


def test_a_stop_leaves_the_finished_sets_and_the_next_call_goes_on(tmp_path):
    def stop_in_the_second(step, steps, best):
        if step == 30:
            raise Stop

    refused(Stop, "", anneal_many, **SMALL, sets=3, workers=1, folder=tmp_path, callback=stop_in_the_second)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["request.json", "set-0000.npz"]
    whole = anneal_many(**SMALL, sets=3, workers=1)
    assert anneal_many(**SMALL, sets=3, workers=1, folder=tmp_path) == whole


def test_a_callback_stops_the_other_processes_soon(tmp_path):
    def stop(step, steps, best):
        if step > 0:
            raise Stop

    with pytest.raises(Stop):
        # Minutes of work, if nobody stopped it.
        anneal_many(500, 10, steps=200_000, sets=2, workers=2, folder=tmp_path, callback=stop)
    assert [path.name for path in tmp_path.iterdir()] == ["request.json"]


def test_a_killed_process_leaves_the_finished_sets(tmp_path):
    # So many steps that no set is finished before the first call back.
    large = SMALL | {"steps": 30_000}
    first = anneal_many(**large, sets=1, folder=tmp_path, workers=1)
    with pytest.raises(WorkerLost, match="call again to go on") as caught:
        anneal_many(**large, sets=3, workers=2, folder=tmp_path, family=None, callback=kill_a_child)
    assert isinstance(caught.value, EvenroadError)
    assert isinstance(caught.value.__cause__, BrokenProcessPool)
    assert load_points(tmp_path / "set-0000.npz") == first[0]
    # It may have been killed while it wrote: what it wrote has no name of a set then.
    for file in tmp_path.glob("set-*.npz"):
        load_points(file)
    assert len(anneal_many(**large, sets=3, workers=1, folder=tmp_path)) == 3


def test_two_processes_make_the_sets_of_one_and_leave_ctrl_c_to_the_parent(tmp_path):
    before = signal.getsignal(signal.SIGINT)
    alone = anneal_many(**SMALL, sets=3, workers=1, rng=5)
    # The first call back is .2 s after the start: the processes are still importing then.
    options = dict(workers=2, rng=5, folder=tmp_path, callback=interrupt_the_children)
    assert anneal_many(**SMALL, sets=3, **options) == alone
    assert signal.getsignal(signal.SIGINT) == before
    assert len({points.hash for points in alone}) == 3
    assert [load_points(tmp_path / f"set-000{i}.npz") for i in range(3)] == list(alone)


def interrupt_the_children(step, steps, best):
    import multiprocessing

    for child in multiprocessing.active_children():
        os.kill(child.pid, signal.SIGINT)


def kill_a_child(step, steps, best):
    import multiprocessing

    for child in multiprocessing.active_children():
        # Once one is gone, the pool may end the others sooner than this loop.
        with suppress(ProcessLookupError):
            os.kill(child.pid, signal.SIGKILL)
        return


@pytest.mark.parametrize(("changes", "text"), [
    ({"n": 9}, "n=8, asked for n=9"), ({"d": 3}, "d=2, asked for d=3"),
    ({"objective": "centred"}, "objective='star', asked for objective='centred'"),
    ({"steps": 21}, "steps=20, asked for steps=21"), ({"rng": 1}, "seed=0, asked for seed=1"),
])  # fmt: skip
def test_a_folder_of_another_request_is_refused(tmp_path, changes, text):
    anneal_many(**SMALL, folder=tmp_path, workers=1)
    refused(InvalidValue, text, anneal_many, **{**SMALL, **changes}, folder=tmp_path, workers=1)


@pytest.mark.parametrize("schedule", [{"schedule": SCHEDULE - 1}, {}], ids=["another", "not written down, once"])
def test_a_folder_of_another_schedule_is_refused(tmp_path, schedule):
    anneal_many(**SMALL, folder=tmp_path, workers=1)
    file = tmp_path / "request.json"
    request = json.loads(file.read_text())
    del request["schedule"]
    file.write_text(json.dumps(request | schedule))
    with pytest.raises(InvalidValue, match=f"schedule={schedule.get('schedule')}, asked"):
        anneal_many(**SMALL, folder=tmp_path, workers=1)


def test_a_strange_set_in_the_folder_is_refused(tmp_path):
    other, ours = tmp_path / "other", tmp_path / "ours"
    other.mkdir()
    ours.mkdir()
    anneal_many(**SMALL, rng=1, folder=other, workers=1)
    os.rename(other / "set-0000.npz", ours / "set-0000.npz")
    refused(InvalidValue, "holds another set", anneal_many, **SMALL, rng=0, folder=ours, workers=1)


@pytest.mark.parametrize(("changes", "text"), [
    ({"sets": 0}, "sets must be an integer >= 1"), ({"workers": 0}, "workers must be an integer >= 1"),
    ({"rng": -1}, "rng must be an int >= 0"), ({"rng": None}, "rng must be an int >= 0"),
])  # fmt: skip
def test_arguments_out_of_range_are_refused(changes, text):
    refused(InvalidValue, text, anneal_many, **{**SMALL, **changes})
