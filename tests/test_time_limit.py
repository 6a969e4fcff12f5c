"""`seconds` is a promise: queries of every kind end in time, by processor time, and hand out what they have."""

import sys
import threading
import time

import numpy as np
import pytest

import evenroad as er
from evenroad import _time_limit
from evenroad._time_limit import BudgetSpent, Deadline, Pace, Stop, look_at_clock, off_the_clock, stopped_by, within
from evenroad.constraints import KeepUpright
from evenroad.planning.planners.growing import GrowingPRM
from evenroad.planning.planners.trees import GridSearch
from evenroad.planning.result import Status
from evenroad.roadmap.budget import Budget
from evenroad.task import MoveTo, Task

SECONDS = 0.04
SPARE = 0.06
"""What a query may take longer by processor time [s]; a busy machine has slow caches."""

BALLS = [
    er.Sphere(0.05, xyz=(-0.014 + 0.102 * np.cos(angle), 0.009 + 0.102 * np.sin(angle), 0.7))
    for angle in np.arange(8) * np.pi / 4
]
"""Balls around the forearm of a UR5 that stands upright, which it cannot leave: trees and proofs take seconds."""
HOME = [0.0, -1.0, 0.0, -1.57, 0.0, 0.0]
UPRIGHT = [1.0, -1.57, 0.0, -1.57, 0.0, 0.0]


@pytest.fixture(scope="module")
def caged():
    world = er.ArmWorld("ur5", er.Scene(BALLS))
    # Modules are loaded by then.
    er.plan(world, HOME, UPRIGHT, seconds=1.5)
    return world


def slow(q):
    """A function that takes 2 ms of processor for each configuration."""
    end = time.process_time() + 2e-3
    while time.process_time() < end:
        pass
    return bool(np.linalg.norm(q - 0.5) > 0.3)


def blocks():
    rng = np.random.default_rng(3)
    return er.GridMap(np.kron(rng.random((300, 300)) < 0.38, np.ones((8, 8), dtype=bool))).world(2.0)


def in_time(call, seconds=SECONDS):
    """Return the result of a query that must end in time."""
    began = time.process_time()
    result = call(seconds)
    took = time.process_time() - began
    assert took < seconds + SPARE, f"{took:.3f} s of processor time for {seconds} s"
    return result


@pytest.mark.parametrize(
    ("planner", "options"),
    [
        (None, {}),
        (None, {"smooth": "quick", "certified": True}),
        (er.RRTConnect(improve=True), {}),
        (er.PRM(er.draw("sobol", 8192, 6)), {}),
        (GrowingPRM(), {}),
    ],
)
def test_queries_of_an_arm_without_a_path_end_in_time(caged, planner, options):
    result = in_time(lambda seconds: er.plan(caged, HOME, UPRIGHT, planner, seconds=seconds, **options))
    assert result.path is None
    assert result.status is Status.BUDGET_SPENT


def test_a_message_says_that_there_was_no_time_for_a_proof(caged):
    result = in_time(lambda seconds: er.plan(caged, HOME, UPRIGHT, seconds=seconds), 0.01)
    assert "no time for a proof" in result.message


def test_many_queries_have_the_time_of_each(caged):
    result = in_time(lambda seconds: er.plan_many(caged, [HOME] * 3, [UPRIGHT] * 3, seconds=seconds / 3, threads=1))
    assert set(result.status) == {"budget_spent"}


def test_a_path_is_improved_until_the_time_is_over_and_not_longer():
    world = er.ArmWorld("ur5", "box-reach")
    er.plan(world, "home", "inside")
    result = in_time(
        lambda seconds: er.plan(world, "home", "inside", er.RRTConnect(improve=True), seconds=seconds), 0.15
    )
    assert result.solved


def test_poses_constraints_and_lines_end_in_time(caged):
    rng = np.random.default_rng(0)
    poses = [
        er.PoseGoal(er.Pose(tuple(rng.uniform(-0.8, 0.8, 3)), rpy=tuple(rng.uniform(-3, 3, 3)))) for _ in range(30)
    ]
    loose = [er.PoseGoal(pose.pose, free_axis="z", angle_tolerance=0.1) for pose in poses[:6]]
    in_time(lambda seconds: er.plan(caged, HOME, poses, seconds=seconds), 0.01)
    found = in_time(lambda seconds: er.plan(caged, HOME, loose, seconds=seconds), 0.002)
    assert found.status is Status.BUDGET_SPENT
    for constraint in (KeepUpright(0.5, "z"), er.CartesianLine(0.1, 0.1)):
        in_time(lambda seconds, each=constraint: er.plan(caged, HOME, UPRIGHT, seconds=seconds, constraints=each))


def test_tasks_end_in_time_and_say_so(caged):
    task = Task([MoveTo(UPRIGHT), MoveTo(HOME)])
    done = in_time(lambda seconds: task.plan(caged, HOME, seconds=seconds))
    assert not done.solved
    assert done.status is Status.BUDGET_SPENT


def test_roadmaps_end_in_time(caged):
    kept = er.build_roadmap(er.ArmWorld("ur5"), er.draw("even", 64, 6)).within(caged)
    kept.plan(HOME, UPRIGHT, budget=Budget(seconds=0.3))
    in_time(lambda seconds: kept.plan(HOME, UPRIGHT, budget=Budget(seconds=seconds)))
    in_time(lambda seconds: er.plan(caged, HOME, UPRIGHT, kept, seconds=seconds))


def test_maps_end_in_time():
    world = blocks()
    places = world.space.from_cube(np.random.default_rng(0).random((500, 2)))
    start, goal = places[world.valid(places)][:2]
    for planner in (None, GridSearch(improve=True)):
        in_time(lambda seconds, by=planner: er.plan(world, start, goal, by, seconds=seconds), 0.01)


@pytest.mark.parametrize("planner", [None, er.RRTConnect(), er.PRM(er.draw("sobol", 64, 3)), er.FMT(64)])
def test_queries_of_a_slow_function_end_after_the_call_that_runs(planner):
    world = er.FunctionWorld([(0.0, 1.0)] * 3, slow, resolution=0.02, vectorised=False)
    in_time(lambda seconds: er.plan(world, (0.1, 0.5, 0.5), (0.9, 0.5, 0.5), planner, seconds=seconds))
    many = er.FunctionWorld([(0.0, 1.0)] * 3, lambda q: np.array([slow(each) for each in q]), resolution=0.02)
    in_time(lambda seconds: er.plan(many, (0.1, 0.5, 0.5), (0.9, 0.5, 0.5), planner, seconds=seconds))


def test_a_function_that_catches_all_exceptions_does_not_take_the_end_of_time_for_an_answer():
    arm, answers = er.ArmWorld("ur5", er.Scene(BALLS)), []

    def free(q):
        try:
            answers.append(bool(arm.valid(q)))
        except Exception:
            answers.append(None)
        return bool(answers[-1])

    world = er.FunctionWorld(arm.space, free, vectorised=False)
    result = er.plan(world, HOME, UPRIGHT, seconds=0.05)
    assert result.status is Status.BUDGET_SPENT
    assert None not in answers


def test_time_never_decides_which_path_there_is():
    world = er.ArmWorld("ur5", "box-reach")
    whole = er.plan(world, "home", "inside")
    seen = set()
    for seconds in (1e-4, 1e-3, 3e-3, 0.01, 1.0):
        result = er.plan(world, "home", "inside", seconds=seconds)
        if result.path is not None:
            is_whole = np.array_equal(result.path, whole.path)
            assert is_whole or np.array_equal(result.path, whole.milestone_path)
            assert is_whole or "not smoothed" in result.message
            assert world.validate(result.path).all()
            seen.add(is_whole)
    assert True in seen


def test_a_path_that_was_not_confirmed_in_time_is_not_solved(caged, monkeypatch):
    def no_time(*_):
        raise BudgetSpent

    monkeypatch.setattr(sys.modules["evenroad.planning.finish"], "mesh_check", no_time)
    result = er.plan("box-reach", "home", "inside", robot="ur5")
    assert (result.status, result.solved) == (Status.BUDGET_SPENT, False)
    assert result.path is not None
    assert "no time to check it with the meshes" in result.message
    monkeypatch.undo()
    monkeypatch.setattr(er.ArmWorld, "validate", no_time)
    result = er.plan(er.ArmWorld("ur5", "box-reach"), "home", "inside", certified=True)
    assert result.status is Status.NOT_CERTIFIED
    assert "no time" in result.message


def test_a_deadline_within_another_never_ends_later_and_what_is_off_the_clock_does_not_count():
    with within(0.05):
        with within(60.0):
            assert Deadline.after(None).left <= 0.05
        with off_the_clock():
            assert Deadline.after(None).left > 1e9
            time.sleep(0.06)
            look_at_clock()
        look_at_clock()
        assert 0.0 < Deadline.after(None).left <= 0.05
        with pytest.raises(BudgetSpent), within(0.0):
            look_at_clock()
        with pytest.raises(BudgetSpent):
            look_at_clock(0.1)
    assert Deadline.after(None).left > 1e9


def test_fast_batches_grow_but_not_by_a_last_one_of_few_rows(monkeypatch):
    monkeypatch.setattr(_time_limit, "now", lambda: 0.0)
    pace = Pace()
    with within(10.0):
        assert [len(rows) for rows in _time_limit.in_time(np.arange(9), pace)] == [4, 5]
        assert [len(rows) for rows in _time_limit.in_time(np.arange(30), pace)] == [8, 16, 6]


def test_compiled_loops_end_with_the_time_of_their_thread(caged):
    q = np.random.default_rng(0).uniform(-1.0, 1.0, (200_000, 6))
    began = time.process_time()
    with pytest.raises(BudgetSpent), within(0.005):
        caged.valid(q)
    assert time.process_time() - began < 0.005 + SPARE
    assert caged.valid(q[:16]).shape == (16,)


def test_another_thread_ends_a_query_before_its_time(caged):
    """The trees of compiled code look at it, and the loops of Python."""
    stop, results = Stop(), []

    def query():
        with stopped_by(stop):
            results.append(er.plan(caged, HOME, UPRIGHT, seconds=20.0))

    thread = threading.Thread(target=query)
    thread.start()
    thread.join(0.2)
    assert thread.is_alive()
    began = time.process_time()
    stop.set()
    thread.join(5.0)
    assert time.process_time() - began < SPARE
    assert results[0].status is Status.BUDGET_SPENT


def test_a_stop_is_over_where_its_block_is():
    stop = Stop()
    stop.set()
    with stopped_by(stop):
        assert Deadline().is_over
        assert Deadline().left == 0.0
        assert _time_limit.seconds_left() == 0.0
        with stopped_by(Stop()):
            look_at_clock()
        with pytest.raises(BudgetSpent):
            look_at_clock()
    look_at_clock()
    assert not Deadline().is_over
