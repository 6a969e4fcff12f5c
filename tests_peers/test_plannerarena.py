"""Planner Arena's own loader opens what we export."""

from __future__ import annotations

import polars
import pytest
from plannerarena.database import load_database
from plannerarena.performance import boxplot, ecdf_plot, enums_plot

from evenroad.datasets.workers import in_process
from evenroad_studies.bench.arena import write_arena
from evenroad_studies.bench.runner import run_tasks
from evenroad_studies.bench.store import open_store, read_rows
from evenroad_studies.bench.task import Task

TASKS = [
    Task(problem, 0, sampler, n, "k=10 earlier", search, run, 1)
    for problem in ("corridor-2d-0.1", "hypercube-legacy6")
    for sampler in ("uniform", "halton scrambled")
    for n in (128, 512)
    for run in range(4)
    for search in ("stock", "full")
]


@pytest.fixture(scope="module")
def stores(tmp_path_factory):
    """Our store of the runs, and the one that is exported."""
    folder = tmp_path_factory.mktemp("runs")
    store, arena = folder / "results.db", folder / "arena.db"
    with open_store(store) as opened:
        run_tasks("test", TASKS, opened, in_process())
    assert write_arena(store, arena) == len(TASKS)
    return store, arena


def test_planner_arena_loads_every_run_with_its_experiment_planner_and_attributes(stores):
    rows, loaded = read_rows(stores[0]), load_database(stores[1])
    assert loaded["problem_names"] == ["corridor-2d-0.1", "hypercube-legacy6"]
    assert loaded["parameters"] == ["N"]
    runs = loaded["runs"]
    assert len(runs) == len(TASKS)
    assert {"time", "solved", "status", "valid milestones", "solution length"} <= set(loaded["attributes"])
    for problem in loaded["problem_names"]:
        for sampler in ("uniform", "halton scrambled"):
            planner = f"{sampler}, k=10 earlier, stock"
            theirs = runs.filter(
                (polars.col("experiment") == problem) & (polars.col("planner") == planner) & (polars.col("N") == 512)
            )
            ours = rows.problem.is_in([problem]) & rows.sampler.is_in([sampler]) & (rows.n == 512)
            ours &= rows.search.is_in(["stock"])
            assert len(theirs) == ours.sum() == 4
            assert theirs["solved"].sum() == rows.solved[ours].sum()
            assert theirs["valid milestones"].sum() == rows.valid[ours].sum()
            assert theirs["time"].sum() == pytest.approx(rows.seconds[ours].sum())


def test_its_plots_take_the_columns(stores):
    loaded = load_database(stores[1])
    runs = loaded["runs"].filter(polars.col("experiment") == "corridor-2d-0.1")
    status = loaded["enums"].filter(polars.col("name") == "status")
    for plot in (
        enums_plot(runs, status, ""),
        ecdf_plot(runs, "time", ""),
        boxplot(runs, "motions checked", "", "o", False),
    ):
        figure = plot.draw()
        assert figure.axes
