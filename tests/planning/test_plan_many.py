"""Many queries in one call: every answer is that of `er.plan`, and errors name rows."""

import numpy as np
import pytest

import evenroad as er
from tests.robots.kernel_arms import box_scene
from tests.robots.paths import GOAL, START, box_world

MOST = {"motions": 6_000}
"""More than one call of compiled code checks, so that the rest is asked, too."""


@pytest.fixture(scope="module")
def asked():
    """Worlds, starts and goals: random ones, one that is hard, and some that have no answer."""
    near, other = box_world(), er.ArmWorld(box_world().robot, box_scene(0.6), clearance=0.01)
    rng = np.random.default_rng(7)
    q = near.space.from_cube(rng.random((4_000, 5)))
    q = q[near.valid(q) & other.valid(q)][:40]
    starts, goals = (
        np.stack([*q[:20], START, START, [0.0, 0.9, 0.0, 0.0, 0.0], START]),
        np.stack([*q[20:], GOAL, START, START, GOAL]),
    )
    goals[-1] = 9.0
    worlds = [other if row % 3 == 1 else near for row in range(len(starts))]
    return worlds, starts, goals


@pytest.mark.parametrize("smooth", [True, "quick", False])
def test_each_answer_is_that_of_one_plan_whatever_the_number_of_threads(asked, smooth):
    one, three = (er.plan_many(*asked, smooth=smooth, limits=MOST, threads=threads) for threads in (1, 3))
    alone = [er.plan(*each, smooth=smooth, limits=MOST) for each in zip(*asked, strict=True)]
    assert one.status.tolist() == three.status.tolist() == [result.status for result in alone]
    assert {"solved", "goal_outside_limits", "start_invalid"} == set(one.status.tolist())
    np.testing.assert_array_equal(one.offsets, three.offsets)
    np.testing.assert_array_equal(one.waypoints, three.waypoints)
    for row, result in enumerate(alone):
        if result.path is None:
            assert one.path(row) is None
            assert np.isnan(one.cost[row])
            assert one.messages[row] == result.message
        else:
            np.testing.assert_array_equal(one.path(row), result.path)
            assert one.cost[row] == pytest.approx(result.cost, rel=1e-14)
            assert one.solved[row]
            assert row not in one.messages


def test_what_one_call_of_compiled_code_leaves_open_is_planned_on(asked, monkeypatch):
    for module in ("many", "planners.trees", "connectors"):
        monkeypatch.setattr(f"evenroad.planning.{module}.RESTART", 12)
    with monkeypatch.context() as patch:
        patch.setattr("evenroad.planning.connectors.answer", None)
        # Nobody makes the first search a second time.
        many = er.plan_many(*asked, limits=MOST)
    alone = [er.plan(*each, limits=MOST) for each in zip(*asked, strict=True)]
    hard = [row for row, result in enumerate(alone) if result.counts.get("edges_checked", 0) > 12 + 4 * 12]
    assert hard
    for row, result in enumerate(alone):
        assert many.status[row] == result.status
        np.testing.assert_array_equal(many.path(row), result.path)


def test_a_seed_draws_what_it_draws_for_one_plan(asked):
    rows = slice(12, 21)
    worlds, starts, goals = (each[rows] for each in asked)
    many = er.plan_many(worlds, starts, goals, rng=5, limits=MOST)
    other = er.plan_many(worlds, starts, goals, limits=MOST)
    for row, each in enumerate(zip(worlds, starts, goals, strict=True)):
        np.testing.assert_array_equal(many.path(row), er.plan(*each, rng=5, limits=MOST).path)
    assert many.waypoints.tolist() != other.waypoints.tolist()


def test_worlds_without_arms_are_planned_in_too():
    world = er.GridMap(np.zeros((20, 30), dtype=bool)).world(2)
    many = er.plan_many(world, [(3, 3), (0, 0)], [(27, 17), (27, 17)])
    assert many.status.tolist() == ["solved", "start_invalid"]
    np.testing.assert_array_equal(many.path(0), er.plan(world, (3, 3), (27, 17)).path)
    assert repr(many) == "PlanResults(2 queries: 1 solved, 1 start_invalid)"


def test_clearances_are_those_of_single_plans(asked):
    worlds, starts, goals = (each[-4:] for each in asked)
    many = er.plan_many(worlds, starts, goals, limits=MOST)
    alone = [er.plan(*each, limits=MOST).clearance for each in zip(worlds, starts, goals, strict=True)]
    np.testing.assert_array_equal(many.clearance, [np.nan if each is None else each for each in alone])
    assert np.isfinite(many.clearance).any()


def test_progress_ends_with_all_and_what_it_raises_stops_the_call(asked):
    said = []
    er.plan_many(*asked, limits=MOST, progress=lambda *numbers: said.append(numbers))
    assert said[-1] == (len(asked[0]), len(asked[0]))
    assert said == sorted(said)

    def interrupt(done, count):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        er.plan_many(*asked, limits=MOST, progress=interrupt)


def test_no_queries_have_no_answers():
    many = er.plan_many(box_world(), np.empty((0, 5)), np.empty((0, 5)))
    assert len(many) == 0
    assert repr(many) == "PlanResults(0 queries)"
    assert many.waypoints.shape == (0, 5)


@pytest.mark.parametrize(
    ("change", "error"),
    [
        ({"starts": [START, [0, 0, np.nan, 0, 0]]}, r"starts must be finite: entry \[1, 2\] is nan"),
        ({"starts": [START]}, "one row a query, got 1 and 2 rows"),
        ({"goals": [START[:3], GOAL[:3]]}, r"goals must have shape \(n, 5\), got \(2, 3\)"),
        ({"worlds": [box_world()]}, "worlds must be one, or one a query: 2, got 1"),
        ({"worlds": [box_world(), "box"]}, "row 1 is 'box'"),
        ({"worlds": [box_world(), er.GridMap(np.zeros((9, 9), dtype=bool)).world(1)]}, "5 in row 0; row 1 has 2"),
        ({"worlds": []}, "worlds must be a World"),
        ({"threads": 0}, "threads must be an integer >= 1"),
        ({"smooth": "fast"}, "smooth"),
    ],
)
def test_what_cannot_be_asked_is_refused_by_its_row(change, error):
    given = {"worlds": box_world(), "starts": [START, START], "goals": [GOAL, GOAL]} | change
    with pytest.raises(er.errors.InvalidValue, match=error):
        er.plan_many(**given)


def test_a_row_that_is_not_there_is_refused():
    many = er.plan_many(box_world(), [START], [START])
    assert many.path(-1).tolist() == many.path(0).tolist()
    with pytest.raises(er.errors.InvalidValue, match="row must be one of 1 query, got 1"):
        many.path(1)


def test_a_file_without_its_extra_is_refused_and_with_it_has_all_rows(asked, tmp_path):
    worlds, starts, goals = (each[-4:] for each in asked)
    many, file = er.plan_many(worlds, starts, goals, limits=MOST), tmp_path / "plans.parquet"
    try:
        from pyarrow import parquet
    except ImportError:
        with pytest.raises(er.errors.NotAvailable, match=r"evenroad\[parquet\]"):
            many.to_parquet(file)
        return
    many.to_parquet(file)
    rows = parquet.read_table(file).to_pylist()
    assert [row["status"] for row in rows] == many.status.tolist()
    assert rows[0]["path"] == many.path(0).tolist()
    assert rows[-1]["path"] == []
    assert rows[-1]["message"] == many.messages[3]
