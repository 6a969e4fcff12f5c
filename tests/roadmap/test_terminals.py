"""A path that begins or ends elsewhere than asked is never handed out, whoever found it."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

import evenroad as er
from evenroad.errors import EvenroadError
from evenroad.geometry.shapes import Capsule
from evenroad.planning import Problem
from evenroad.planning.connector import Connection
from evenroad.planning.connectors import PlainTrees
from evenroad.planning.make_result import led
from evenroad.planning.planners.trees import solve_by
from evenroad.planning.result import NO_POINTS, PlanResult, Status
from evenroad.planning.terminals import NEAR, SAME
from evenroad.planning.tip_motion import plan_constrained
from evenroad.roadmap import Budget
from evenroad.robot import ArmWorld, CartesianLine, Joint, Robot, Scene
from evenroad.space import SE3, BoxSpace, JointSpace
from evenroad.world import FunctionWorld
from tests.refused import refused
from tests.robots.kernel_arms import STRAIGHT, TABLE, Z, ur5

PLANE = BoxSpace((0.0, 0.0), (1.0, 1.0))
A, B, C = np.array([[0.1, 0.2], [0.8, 0.9], [0.5, 0.5]])


def in_(space):
    return SimpleNamespace(space=space)


def result(path, start=A, goals=(B,), index=0, status=Status.SOLVED, **more):
    goals, path = np.array(goals), None if path is None else np.array(path)
    asked = dict(start=np.array(start), goals=goals, origin=NO_POINTS, rule="none", goal_index=index)
    return PlanResult(status=status, message="", path=path, **asked, **more)


@pytest.mark.parametrize(("wrong", "where"), [
    (result([C, B]), "start"), (result([A, C]), "end"), (result([B, A]), "start"),
    (result([A, B], goals=[B, C], index=1), "end"), (result([A + 2.0 * SAME, B]), "start"),
    (result([A, B - 2.0 * NEAR]), "end"), (result([A, [np.nan, 0.9]]), "end"),
    (result([A, B], milestone_path=np.array([C, B])), "start"),
    (result([A, B], milestone_path=np.array([A, C])), "end"),
])  # fmt: skip
def test_a_path_that_leads_elsewhere_is_a_fault_and_no_error_of_the_input(wrong, where):
    with pytest.raises(AssertionError, match=f"does not {where} at its query, but .* away") as raised:
        led(in_(PLANE), wrong)
    assert not isinstance(raised.value, EvenroadError)


def test_one_that_leads_there_but_for_rounding_is_handed_out():
    for end in (B, B - 0.5 * NEAR, B - 0.5 * SAME):
        path = led(in_(PLANE), result([A + 0.5 * SAME, C, end])).path
        # The numbers of the query are handed out, and those of the end where they say something else.
        assert path[0].tolist() == A.tolist()
        assert path[-1].tolist() == (end if abs(end - B).max() > SAME else B).tolist()
    nothing = result(None, index=None, status=Status.NOT_CONNECTED)
    assert led(in_(PLANE), nothing) is nothing


def test_whole_turns_count_where_a_joint_wraps_and_nowhere_else():
    space = JointSpace((-math.pi, -9.0), (math.pi, 9.0), (True, False))
    asked = [A, B + np.array([5 * math.tau, 0.0])]
    said = led(in_(space), result([A, B], start=asked[0], goals=asked[1:])).message
    assert said == "; coordinate 0 ends at 0.8, whole turns from the goal"
    with pytest.raises(AssertionError, match="end"):
        led(in_(space), result([A, B], start=A, goals=[B + np.array([0.0, math.tau])]))


def test_a_path_in_one_turn_is_handed_out_in_the_numbers_of_its_start_and_without_a_jump():
    space = JointSpace((-math.pi, -9.0), (math.pi, 9.0), (True, False))
    start, goal = np.array([4 * math.tau + 3.0, 0.5]), np.array([-math.tau - 2.0, 7.0])
    within = np.array([[3.0, 0.5], [-3.0, 1.0], [3.1, 1.0], [-3.1, 5.0], [-2.0, 7.0]])
    on = led(in_(space), result(within, start=start, goals=[goal], milestone_path=within[[0, 4]]))
    assert on.path[0].tolist() == start.tolist()
    assert on.path[:, 1].tolist() == within[:, 1].tolist()
    # The turns by hand: over pi, back, over it again, and on.
    turned = [3.0, math.tau - 3.0, 3.1, math.tau - 3.1, math.tau - 2.0]
    assert on.path[:, 0] == pytest.approx(4 * math.tau + np.array(turned), abs=1e-12)
    assert on.milestone_path[:, 0] == pytest.approx(4 * math.tau + np.array([3.0, math.tau - 2.0]), abs=1e-12)
    assert on.message.endswith(f"coordinate 0 ends at {5 * math.tau - 2.0:.6g}, whole turns from the goal")


def test_of_half_a_turn_a_waypoint_says_in_which_direction():
    space = JointSpace((-math.pi,), (math.pi,), (True,))
    for first, last in ((0.0, math.pi), (7.0, 7.0 + math.pi), (1.0, 1.0 - math.pi), (-50.0, -50.0 + math.pi)):
        start, goal = np.array([first]), np.array([last])
        path = led(in_(space), result([start, goal], start=start, goals=[goal])).path
        middle = space.interpolate(start[None], goal[None], 0.5)
        assert len(path) == 3
        assert space.distance(path[1:2], middle) == pytest.approx(0.0, abs=1e-12)
        assert np.abs(np.diff(path[:, 0])) == pytest.approx(0.25 * math.tau, abs=1e-12)


def test_both_signs_of_a_quaternion_are_one_place():
    space = SE3((0, 0, 0), (1, 1, 1))
    pose = np.array([0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5])
    other = np.array([0.5, 0.5, 0.5, 1.0, 0.0, 0.0, 0.0])
    opposite = pose * [1, 1, 1, -1, -1, -1, -1]
    path = led(in_(space), result([opposite, other], start=pose, goals=[other])).path
    assert path[0].tolist() == pose.tolist()
    refused(AssertionError, "start", led, in_(space), result([other, other], start=pose, goals=[other]))


class Astray(PlainTrees):
    """Trees that connect the start to a place that nobody asked for."""

    def connect(self, world, start, goals, *, variant, most_motions):
        return Connection(np.array([start, C]), 0, 1, 1, 1)


class Short(PlainTrees):
    """Trees that leave out the goal when they smooth a path."""

    def smooth(self, world, path, *, quick=False):
        return path[:-1], 1


@pytest.mark.parametrize(("connector", "smooth"), [(Astray(), False), (Short(), True)])
def test_what_a_connector_found_is_looked_at(connector, smooth):
    world = FunctionWorld(PLANE, lambda q: np.ones(len(q), dtype=bool), 0.1)
    problem = Problem(world, np.asarray(A, float), np.array([B], float), budget=Budget(), smooth=smooth)
    refused(AssertionError, "does not end", solve_by, problem, connector)


def test_what_lies_between_straight_lines_is_looked_at():
    world = ArmWorld(ur5(), TABLE)
    start, goal = [0.0, -1.5, 1.2, -1.0, -1.5, 0.0], [0.8, -1.4, 1.3, -1.2, -1.5, 0.3]

    def plan(part):
        found = er.plan(part.world, part.start, part.goals, smooth=part.smooth)
        return PlanResult(**{**vars(found), "path": found.path[::-1] if astray else found.path})

    problem = Problem(world, np.array(start), np.array([goal]), constraints=CartesianLine(approach=0.03))
    astray = False
    assert plan_constrained(problem, plan).solved
    astray = True
    refused(AssertionError, "does not start", plan_constrained, problem, plan)


def test_ends_of_joints_that_turn_for_ever_may_be_asked_for_after_any_turns():
    turning = Joint("joint", "continuous", "base", "link", (0.0, 0.0, 0.0), STRAIGHT, Z)
    body = Capsule((0.1, 0.0, 0.0), (0.4, 0.0, 0.0), 0.02, link="link")
    robot = Robot("hand", ("base", "link"), (turning,), (body,), (), ("joint",))
    for turns in (0, 1, -3, 1000):
        found = er.plan(Scene(name="empty"), [0.3 + turns * math.tau], [2.0 - turns * math.tau], robot=robot)
        assert found.solved
        assert found.path[0, 0] == 0.3 + turns * math.tau
        assert found.path[-1, 0] == pytest.approx(2.0 + turns * math.tau, abs=1e-9)
        assert ("whole turns" in found.message) == (turns != 0)
