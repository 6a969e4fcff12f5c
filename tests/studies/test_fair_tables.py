"""Tests of the script that writes the fair suite's tables."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest

from evenroad_studies.bench.store import open_store
from evenroad_studies.bench.task import Outcome, Task

SCRIPT = Path(__file__).parents[2] / "studies" / "tools" / "fair_tables.py"


@pytest.fixture
def script():
    spec = importlib.util.spec_from_file_location("fair_tables", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_a_table_of_gains_has_a_line_a_sampler_and_says_where_there_is_no_set(script):
    row = {"uniform_success": ".441", "difference": ".0504", "low": "-.004", "high": ".1"}
    pooled = {("all/all", "sobol scrambled"): row, ("all/all", "even"): row}
    lines = script.gains(pooled, ("all",), ("all/all",), ("sobol scrambled", "mpmc", "even"))
    assert lines == [
        "| points above uniform | all |",
        "|---|---|",
        "| uniform itself, % | 44.1 |",
        "| Sobol, scrambled | +5.0 [0, 10] |",
        "| `mpmc` | no set |",
        "| **`even`** | +5.0 [0, 10] |",
    ]


def test_a_table_takes_the_place_of_the_one_with_its_heading_alone(script):
    page = "before\n\n| a | b |\n|---|---|\n| 1 | 2 |\n\n| a | c |\n"
    assert script.replaced(page, ["| a | b |", "new"]) == "before\n\n| a | b |\nnew\n\n| a | c |\n"
    with pytest.raises(SystemExit, match="0 tables"):
        script.replaced(page, ["| x |"])


def test_the_difference_from_sobol_is_paired_by_world(script, tmp_path):
    rng = np.random.default_rng(1)
    solved = rng.random((40, 3, 2)) < [0.6, 0.4]
    with open_store(tmp_path / "fair.db") as store:
        for world, run, which in np.ndindex(solved.shape):
            sampler = ("even", "sobol scrambled")[which]
            task = Task("fair-se3-50", world, sampler, 128, "k=4 symmetrised", "connect", 3 * world + run, 1)
            outcome = Outcome("solved" if solved[world, run, which] else "not_connected")
            store.add("fair", task, outcome, "here")
    means = 100 * (solved[..., 0].astype(float) - solved[..., 1]).mean(axis=1)
    line = next(line for line in script.beside_sobol(tmp_path / "fair.db") if line.startswith("| SE(3)"))
    assert f"{means.mean():+.1f} ({means.std() / np.sqrt(40):.1f})" in line
