import json
import os
import signal
import subprocess
import sys

import numpy as np
import pytest

from evenroad import _files
from evenroad._files import atomic_write, remove_abandoned_parts, require_writable_folder
from evenroad.errors import BrokenFile
from evenroad.io import plan_record, save_json, save_path_csv
from evenroad.planning import PRM, plan
from evenroad.points import draw
from evenroad.world import GridMap
from tests.refused import refused


def test_a_reader_sees_the_old_file_until_the_new_one_is_whole(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("old")
    with atomic_write(path) as file:
        file.write(b"new")
        file.flush()
        assert path.read_text() == "old"
    assert path.read_text() == "new"


@pytest.mark.parametrize("error", [KeyboardInterrupt, ValueError, OSError])
def test_an_error_while_writing_leaves_the_old_file_and_no_litter(tmp_path, error):
    path = tmp_path / "a.txt"
    path.write_text("old")

    def stopped_half_way():
        with atomic_write(path) as file:
            file.write(b"half")
            raise error

    refused((error, BrokenFile), "", stopped_half_way)
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


KILLED_WHILE_WRITING = """
import os, signal
from evenroad._files import atomic_write
with atomic_write("a.txt") as file:
    file.write(b"half")
    os.kill(os.getpid(), signal.SIGKILL)
"""


def test_a_killed_writers_file_is_removed_and_a_living_ones_stays(tmp_path):
    killed = subprocess.run([sys.executable, "-c", KILLED_WHILE_WRITING], cwd=tmp_path, check=False)
    assert killed.returncode == -signal.SIGKILL
    assert len(list(tmp_path.glob(".evenroad-*.part"))) == 1
    with atomic_write(tmp_path / "b.txt") as file:
        file.write(b"whole")
        remove_abandoned_parts(tmp_path)
        assert len(list(tmp_path.glob(".evenroad-*.part"))) == 1
    assert [path.name for path in tmp_path.iterdir()] == ["b.txt"]


def test_a_finished_file_is_nobodys_prey_on_its_way_to_its_place(tmp_path, monkeypatch):
    replace = os.replace

    def replace_after_a_cleaning(source, target):
        remove_abandoned_parts(tmp_path)
        replace(source, target)

    monkeypatch.setattr(os, "replace", replace_after_a_cleaning)
    with atomic_write(tmp_path / "a.txt") as file:
        file.write(b"x")
    assert (tmp_path / "a.txt").read_bytes() == b"x"


def test_a_file_that_is_taken_for_an_abandoned_one_before_its_lock_is_made_again(tmp_path, monkeypatch):
    make, made = _files._created, []

    def make_and_lose_the_first_two(folder):
        made.append(make(folder))
        if len(made) <= 2:
            remove_abandoned_parts(tmp_path)
        return made[-1]

    monkeypatch.setattr(_files, "_created", make_and_lose_the_first_two)
    with atomic_write(tmp_path / "a.txt") as file:
        file.write(b"x")
    # The first shows that the folder can be written.
    assert len(made) == 3
    assert [path.name for path in tmp_path.iterdir()] == ["a.txt"]


@pytest.mark.parametrize("name", ["no/such/folder.txt", "file.txt/inside.txt", ""])
def test_a_folder_that_cannot_be_written_is_known_before_the_work(tmp_path, name):
    (tmp_path / "file.txt").write_text("")
    refused(BrokenFile, "cannot write", require_writable_folder, tmp_path / name)


def _record():
    world = GridMap(np.zeros((20, 20), dtype=bool)).world(1.0)
    return plan(world, (2, 2), (18, 18), PRM(draw("halton", 20, 2)))


def test_the_record_survives_json_and_holds_what_was_asked():
    record = json.loads(json.dumps(plan_record(_record(), {"map": "x.png"})))
    assert record["query"] == {"start": [2, 2], "goal": [18, 18], "goals": [[18, 18]], "map": "x.png"}
    assert record["origin"]["family"] == "halton"
    assert {"evenroad", "python", "numpy", "scipy"} == set(record["versions"])
    assert set(record["timings"]) == {"validity", "neighbours", "motions", "search", "shortcut"}


def test_numbers_that_are_not_json_are_refused_and_the_old_file_stays(tmp_path):
    path = tmp_path / "a.json"
    save_json(path, {"x": 1})
    refused(ValueError, "JSON", save_json, path, {"x": float("nan")})
    assert json.loads(path.read_text()) == {"x": 1}


def test_csv_floats_come_back_bit_for_bit(tmp_path):
    waypoints = np.random.default_rng(0).random((5, 3))
    save_path_csv(tmp_path / "a.csv", waypoints, ["a", "b", "c"])
    rows = (tmp_path / "a.csv").read_text().splitlines()
    assert rows[0] == "a,b,c"
    back = np.array([[float(x) for x in row.split(",")] for row in rows[1:]])
    assert back.tobytes() == waypoints.tobytes()
