"""The verb that makes sets: train."""

import json
import re
import signal
import subprocess
import sys

import pytest

from evenroad.points import load_points
from evenroad.points.measures import MEASURES, star_discrepancy

MPMC = ("train", "-n", 12, "-d", 2, "--method", "mpmc", "--sets", 2, "--jobs", 1, "-o", "sets")


def test_training_writes_sets_and_the_same_line_goes_on(run, tmp_path):
    line = ("train", "-n", 12, "-d", 2, "--sets", 2, "--steps", 50, "--jobs", 1, "-o", "sets")
    line += ("--objective", "hickernell+10*riesz")
    code, out, _ = run(*line)
    assert code == 0
    assert "2 sets" in out
    first = load_points(tmp_path / "sets" / "set-0000.npz")
    (tmp_path / "sets" / "set-0001.npz").unlink()
    assert run(*line)[1] == out
    assert load_points(tmp_path / "sets" / "set-0000.npz") == first
    assert first.origin.objective == "log(hickernell) + 10*log(riesz)"


def test_the_network_trains_from_the_command_line(run, tmp_path):
    assert run(*MPMC, "--steps", 5, "--refine", 20)[0] == 0
    assert load_points(tmp_path / "sets" / "set-0001.npz").origin.family == "mpmc"
    assert load_points(tmp_path / "sets" / "refined-0001.npz").origin.method.endswith("+annealed")


def test_the_published_network_makes_a_batch_and_the_same_line_reads_it(run, tmp_path):
    line = ("train", "-n", 12, "-d", 2, "--method", "printed", "--batch", 3, "--steps", 4, "-o", "sets")
    code, out, _ = run(*line)
    assert code == 0
    assert "3 sets" in out
    assert load_points(tmp_path / "sets" / "set-0002.npz").origin.method == "network as printed"
    assert run(*line)[1] == out
    assert run(*line[:-3], 5, *line[-2:])[0] == 2
    assert run(*line, "--sets", 4)[0] == 2
    assert run(*line, "--refine", 20)[0] == 0
    before, after = (load_points(tmp_path / "sets" / f"{name}-0002.npz") for name in ("set", "refined"))
    assert MEASURES["hickernell"].rooted(after) < MEASURES["hickernell"].rooted(before)
    assert after.origin.method == "network as printed+annealed"
    assert run("train", "-n", 12, "-d", 2, "--batch", 3, "-o", "other")[0] == 2


def test_the_network_is_judged_by_the_exact_star_discrepancy_on_request(run, tmp_path):
    line = ("train", "-n", 12, "-d", 2, "--method", "mpmc", "--objective", "star", "--judge", "star")
    code, out, _ = run(*line, "--sets", 1, "--steps", 50, "--jobs", 1, "-o", "sets")
    best = star_discrepancy(load_points(tmp_path / "sets" / "set-0000.npz"))
    assert (code, out.strip()) == (0, f"sets: 1 sets, star discrepancy: mean {best:.6g}, best {best:.6g}")
    assert json.loads((tmp_path / "sets" / "request.json").read_text())["network"]["start"] == "kronecker"


@pytest.mark.parametrize("star", ["star", " 1*star"])
def test_orders_are_what_is_searched_for_the_star_discrepancy_of_the_plane(run, tmp_path, star):
    line = ("train", "-n", 12, "-d", 2, "--objective", star, "--sets", 2, "--jobs", 1)
    code, out, _ = run(*line, "--steps", 200, "-o", "sets")
    assert code == 0
    best = min(star_discrepancy(load_points(tmp_path / "sets" / f"set-000{i}.npz")) for i in range(2))
    assert "2 sets, star discrepancy: mean" in out
    assert out.strip().endswith(f"best {best:.6g}")


@pytest.mark.parametrize(("arguments", "says"), [
    (("-n", 0), "n must be"), (("--objective", "hickernel"), "did you mean 'hickernell'"),
    (("--objective", "hickernell+"), "column"), (("--steps", 0), "steps"), (("-o", "no/where"), "does not exist"),
    (("--sets", 0), "sets must be"),
    (("-n", 1, "--objective", "riesz"), "at least 2 points"),
    (("--seed", -1), "seed must be"), (("--jobs", 0), "jobs must be"),
    (("--refine", 5), "--refine does not go with the method 'anneal'"),
    (("--method", "order"), "in d = 2 for --objective star, not in d = 2 for 'hickernell'"),
    (("--method", "order", "--objective", "star", "-d", 3), "not in d = 3"),
    (("--method", "order", "--objective", "star", "--refine", 3), "--refine does not go"),
    (("--judge", "star"), "--judge does not go with the method 'anneal'"),
    (("--objective", "star", "--judge", "star"), "--judge does not go with the method 'order'"),
    (("--method", "order", "--objective", "star", "--start", "sobol"), "--start does not go"),
    (("--method", "mpmc", "--start", "grid"), "unknown start 'grid'.*kronecker"),
    (("--method", "mpmc", "--judge", "star", "-d", 3), "not in d = 3"),
    (("--method", "mpmc", "--refine", -1), "refine must be"),
    (("--method", "mpmc", "--jobs", 0), "jobs must be"), (("--method", "mpmc", "-n", 1), "n must be"),
    # An error repeats a little of what was asked for.
    (("--objective", "x" * 5000), "xxx"), (("--objective", "hickernell+" * 500), "column"),
    (("--objective", "(" * 5000), "column"),
    (("--objective", "1" * 5000 + "*riesz"), "column"),
])  # fmt: skip
def test_bad_requests_to_train_leave_no_folder(run, tmp_path, arguments, says):
    size = () if "-n" in arguments else ("-n", 8)
    code, out, err = run("train", "-d", 2, "-o", "sets", *size, *arguments)
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert re.search(says, err)
    assert len(err) < 400
    assert list(tmp_path.iterdir()) == []


def test_a_file_in_the_place_of_the_folder_is_refused(run, tmp_path):
    (tmp_path / "sets").write_text("")
    code, out, err = run("train", "-n", 8, "-d", 2, "-o", "sets")
    assert (code, out, err.count("\n"), "not a folder" in err) == (2, "", 1, True)


def test_a_request_that_was_written_by_hand_is_repeated_in_short(run, tmp_path):
    line = ("train", "-n", 8, "-d", 2, "--jobs", 1, "--sets", 1, "--steps", 5, "-o", "sets")
    (tmp_path / "sets").mkdir()
    (tmp_path / "sets" / "request.json").write_text(json.dumps({"n": "8" * 5000}))
    code, _, err = run(*line)
    assert code == 2
    assert "holds sets with n=" in err
    assert len(err) < 400


KILLED_WHILE_SAVING = """
import os, signal, sys
from evenroad.cli import main
os.replace = lambda *names: os.kill(os.getpid(), signal.SIGKILL)
main(sys.argv[1:])
"""


def test_what_a_killed_training_was_writing_is_removed_by_the_next_one(run, tmp_path):
    line = ["train", "-n", "8", "-d", "2", "--jobs", "1", "--sets", "1", "--steps", "5", "-o", "sets"]
    killed = subprocess.run([sys.executable, "-c", KILLED_WHILE_SAVING, *line], check=False, timeout=120)
    assert killed.returncode == -signal.SIGKILL
    assert [path.name.startswith(".evenroad-") for path in (tmp_path / "sets").iterdir()] == [True]
    assert run(*line)[0] == 0
    assert sorted(path.name for path in (tmp_path / "sets").iterdir()) == ["request.json", "set-0000.npz"]


def test_refined_sets_are_kept_one_by_one_and_read_back(run, tmp_path, monkeypatch):
    from evenroad_studies import network

    line = (*MPMC, "--steps", 3, "--refine", 20)
    refine = network.refine

    def stop_at_the_second(sets, **options):
        if sets[0].origin.replica == 1:
            raise KeyboardInterrupt
        return refine(sets, **options)

    monkeypatch.setattr(network, "refine", stop_at_the_second)
    assert run(*line)[0] == 130
    first = tmp_path / "sets" / "refined-0000.npz"
    written = first.stat().st_mtime_ns
    monkeypatch.setattr(network, "refine", refine)
    assert run(*line)[0] == 0
    assert first.stat().st_mtime_ns == written
    assert load_points(tmp_path / "sets" / "refined-0001.npz").origin.replica == 1
    code, _, err = run(*MPMC, "--steps", 3, "--refine", 21)
    assert code == 2
    assert "steps=20, asked for steps=21; use another folder (what there is: refined.json)" in err
