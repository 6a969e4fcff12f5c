"""Small stores with made-up rows."""

import numpy as np
import pytest

from evenroad_studies.bench.store import open_store, read_rows
from evenroad_studies.bench.task import Outcome, Task
from evenroad_studies.report import page
from evenroad_studies.report.analysis import analyse
from evenroad_studies.report.charts import new_figure
from evenroad_studies.report.runs import runs_of

RATES = {
    "uniform": (0.2, 0.5, 0.8),
    "halton scrambled": (0.3, 0.6, 0.95),
    "halton paper-blocks": (0.25, 0.6, 0.9),
    "hickernell": (0.5, 0.9, 1.0),
}
COUNTS = (128, 256, 512)
POOL = 16


@pytest.fixture
def without_pictures(monkeypatch):
    """Pictures are most of the time, and not what most tests look at."""
    monkeypatch.setattr(page, "draw_curves", lambda cells, title: new_figure(1, 1))
    monkeypatch.setattr(page, "draw_scene", lambda problem: new_figure(1, 1))
    monkeypatch.setattr(page, "draw_point_sets", lambda: new_figure(1, 1))


def task(problem="maze-1", sampler="uniform", n=128, run=0, **others):
    fields = {"instance": 0, "rule": "k=10 symmetrised", "search": "connect", "seed": 0} | others
    return Task(problem=problem, sampler=sampler, n=n, run=run, **fields)


def solved(yes=True, **others):
    fields = {"valid": 50, "edges_checked": 100, "seconds": 0.002} | others
    return Outcome("solved" if yes else "not_connected", **fields)


def made_up(problem="maze-1", runs=40, rates=RATES, counts=COUNTS, seed=0, **others):
    """Return (task, outcome) of every cell of one setting; `hickernell` draws from a pool of 16 sets."""
    rng = np.random.default_rng(seed)
    rows = []
    for sampler, chances in rates.items():
        for n, chance in zip(counts, chances, strict=True):
            of_set = rng.random(POOL) < chance
            for run in range(runs):
                which = int(rng.integers(POOL))
                pooled = sampler == "hickernell"
                yes = bool(of_set[which] if pooled else rng.random() < chance)
                valid = int(n * 0.4 + rng.integers(5))
                outcome = solved(
                    yes, valid=valid, edges_checked=4 * valid, seconds=1e-5 * n, set_id=str(which) if pooled else ""
                )
                rows.append((task(problem, sampler, n, run, **others), outcome))
    return rows


def from_pool(problem, sampler, n, chances, runs=80, ids=None, rng=0, **others):
    """Return rows of a pool: as many sets as chances, drawn in turn, and whether a run is solved by its set's chance.

    The sets are numbered, or called as `ids` say: ``("grid",)`` for the only set there is, ``("",)`` for fresh ones.
    """
    rng = np.random.default_rng(rng)
    ids = ids or [str(each) for each in range(len(chances))]
    rows = []
    for run in range(runs):
        which = run % len(chances)
        outcome = solved(bool(rng.random() < chances[which]), set_id=ids[which])
        rows.append((task(problem, sampler, n, run, **others), outcome))
    return rows


def write_store(path, rows, suite="paper"):
    with open_store(path) as store:
        for each, outcome in rows:
            store.add(suite, each, outcome, "here:1")
    return path


def runs_from(path, rows):
    return runs_of(read_rows(write_store(path, rows)))


def analysis_from(path, rows):
    return analyse(read_rows(write_store(path, rows)))
