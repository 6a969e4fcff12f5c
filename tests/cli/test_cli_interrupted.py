"""Ctrl-C while a path becomes shorter: the best one that was found is written, with the exit code of an interrupt."""

import json
import subprocess
import sys

import pytest

from evenroad.io import load_plan

INTERRUPTED = """
import os, signal, sys, threading
from evenroad.planning import improve
from evenroad.planning.planners import growing

# A real signal, soon after there is a path that can become shorter; trees take long, a roadmap may be done at once.
soon = threading.Timer(0.4, os.kill, (os.getpid(), signal.SIGINT))
bounds, draw = improve._below_bounds, growing._draw
improve._below_bounds = lambda *given: (soon.start(), bounds(*given))[1]
growing._draw = lambda *given: (given[1] > 500 and os.kill(os.getpid(), signal.SIGINT), draw(*given))[1]
from evenroad.cli import main

sys.argv = ["evenroad", *sys.argv[1:]]
raise SystemExit(main())
"""
ARM = "plan box-reach.yaml --robot ur5 --start home --goal inside"
DISK = "plan office.yaml --start 1 2 --goal 8.5 3 --robot-radius 0.25"


@pytest.mark.parametrize("command", [ARM, DISK, f"{ARM} --straight 0.05"])
def test_the_best_path_so_far_is_written(tmp_path, command):
    words = [*command.split(), "--improve", "--time", "60", "--no-picture", "--out", str(tmp_path / "o")]
    done = subprocess.run([sys.executable, "-c", INTERRUPTED, *words], capture_output=True, text=True, timeout=50)
    assert done.returncode == 130, done.stderr
    assert done.stderr == "evenroad: interrupted; what was finished is kept\n"
    plan, _ = load_plan(tmp_path / "o.json")
    assert plan.solved
    assert len(plan.path) >= 2
    assert "interrupted" in json.loads((tmp_path / "o.json").read_text())["message"] or "straight" in command
