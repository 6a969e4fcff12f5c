"""A Planner Arena database, table by table."""

from dataclasses import replace

import pytest

from evenroad.errors import BrokenFile, InvalidValue, NotAvailable
from evenroad.planning import Status
from evenroad_studies.bench.arena import STATUSES, write_arena
from evenroad_studies.bench.rows import FAILURES
from evenroad_studies.bench.store import open_store
from evenroad_studies.bench.task import Outcome
from tests.refused import refused
from tests.studies.bench.tables import TASK, query, write

OUTCOMES = {
    TASK: Outcome("solved", 20, 7, 93, 1.25, 0.5),
    replace(TASK, run=1): Outcome("not_connected", 18, None, 40, seconds=0.25),
    replace(TASK, n=64): Outcome("failed", error="Traceback"),
    replace(TASK, sampler="even"): Outcome("solved", 30, 3, 10, 2.0, 0.125),
}


@pytest.fixture
def store(tmp_path):
    write(tmp_path / "results.db", OUTCOMES.items())
    return tmp_path / "results.db"


def test_an_experiment_has_twelve_columns_and_then_its_parameter(store, tmp_path):
    write_arena(store, tmp_path / "arena.db")
    columns = " ".join(row[1] for row in query(tmp_path / "arena.db", "PRAGMA table_info(experiments)"))
    assert columns == "id name totaltime timelimit memorylimit runcount version hostname cpuinfo date seed setup N"
    experiments = query(tmp_path / "arena.db", "SELECT name, N, runcount, totaltime, seed FROM experiments ORDER BY N")
    assert experiments == [("maze-1", 64, 1, 0.0, 1), ("maze-1", 128, 3, 0.875, 1)]


def test_every_run_has_its_planner_and_its_values_and_what_is_not_known_is_null(store, tmp_path):
    assert write_arena(store, tmp_path / "arena.db") == len(OUTCOMES)
    runs = query(
        tmp_path / "arena.db",
        "SELECT plannerConfigs.name, N, time, solved, description, valid_milestones, valid_milestones_at_solution,"
        " motions_checked, solution_length, run FROM runs JOIN plannerConfigs ON plannerConfigs.id = plannerid"
        " JOIN experiments ON experiments.id = experimentid JOIN enums ON enums.value = status",
    )
    uniform, even = "uniform, k=10 earlier, stock", "even, k=10 earlier, stock"
    assert sorted(runs, key=lambda run: (run[0], run[1], run[-1])) == [
        (even, 128, 0.125, 1, "Exact solution", 30, 3, 10, 2.0, 0),
        (uniform, 64, None, 0, "Crash", 0, None, 0, None, 0),
        (uniform, 128, 0.5, 1, "Exact solution", 20, 7, 93, 1.25, 0),
        (uniform, 128, 0.25, 0, "Not connected", 18, None, 40, None, 1),
    ]


def test_every_status_has_a_number_of_its_own():
    never_stored = {Status.BUDGET_SPENT, Status.GOAL_UNREACHABLE, Status.MESH_COLLISION, Status.NOT_CERTIFIED}
    never_stored |= {Status.START_OUTSIDE_LIMITS, Status.GOAL_OUTSIDE_LIMITS}
    assert set(STATUSES) == {*FAILURES, *(str(each) for each in Status if each not in never_stored)}
    assert len({number for number, _ in STATUSES.values()}) == len(STATUSES)


def test_an_earlier_export_is_replaced_and_nothing_is_left_behind(store, tmp_path):
    (tmp_path / "arena.db").write_text("something else")
    write_arena(store, tmp_path / "arena.db")
    assert query(tmp_path / "arena.db", "SELECT count(*) FROM runs") == [(len(OUTCOMES),)]
    assert {each.name for each in tmp_path.iterdir()} == {"arena.db", "results.db"}


def test_a_store_without_rows_is_not_exported(tmp_path):
    with open_store(tmp_path / "results.db"):
        pass
    refused(NotAvailable, "has no rows", write_arena, tmp_path / "results.db", tmp_path / "arena.db")
    assert not (tmp_path / "arena.db").exists()


def test_a_store_is_not_exported_onto_itself_or_into_a_folder_that_is_not_there(store, tmp_path):
    before = store.read_bytes()
    refused(InvalidValue, "onto itself", write_arena, store, store)
    assert store.read_bytes() == before
    refused(BrokenFile, "does not exist", write_arena, store, tmp_path / "missing" / "arena.db")
