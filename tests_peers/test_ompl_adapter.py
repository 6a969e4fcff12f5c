"""OMPL's planners on our worlds and points, ours on its spaces and checkers, and paths both ways."""

import math

import numpy as np
import pytest

import evenroad as er
from evenroad.errors import InvalidValue
from evenroad.robot import load_robot, load_scene
from evenroad.space import SE2, SE3, SO3, BoxSpace, Circle, JointSpace, Product
from evenroad.testing import WorldContract
from evenroad.world import FunctionWorld
from evenroad.world.gridmap.load import load_maze
from evenroad_studies.rules import KEarlier
from evenroad_studies.worlds import Corridor

ob = pytest.importorskip("ompl.base")
og = pytest.importorskip("ompl.geometric")
ou = pytest.importorskip("ompl.util")
from evenroad.adapters.ompl import (  # noqa: E402
    OmplWorld,
    give_points,
    ompl_path,
    ompl_space,
    path_of,
    plan_on_points,
    solve,
    space_information,
    space_of,
)

ou.setLogLevel(ou.LogLevel.LOG_NONE)

ARM = JointSpace((-3.0, -math.pi, -2.0, -math.pi), (3.0, math.pi, 1.0, math.pi), (False, True, False, True))
SPACES = {
    "box": BoxSpace((-1.0, 2.0, 0.0), (1.0, 5.0, 0.5)),
    "circle": Circle(),
    "rotations": SO3(),
    "SE(2)": SE2((-1, -2), (3, 4), weights=(1.0, 0.5), combine="sum"),
    "SE(3)": SE3((-1, -2, 0), (3, 4, 1), weights=(1.0, 2.0)),
    "two bodies": Product((SE2((0, 0), (1, 1), combine="sum"), SE3((0, 0, 0), (1, 1, 1))), (1.0, 0.5)),
    "body and joint": Product((SE2((0, 0), (1, 1), combine="sum"), BoxSpace((0.0,), (2.0,))), (1.0, 0.5)),
    "arm": ARM,
}
spaces = pytest.mark.parametrize("space", SPACES.values(), ids=SPACES)


def _random(space, count, seed=0):
    return space.from_cube(np.random.default_rng(seed).random((count, space.cube_dim)))


def _free(space):
    information = ob.SpaceInformation(ompl_space(space))
    information.setStateValidityChecker(lambda state: True)
    information.setup()
    return information


@spaces
def test_paths_come_back_bit_for_bit(space):
    path, information = _random(space, 50), _free(space)
    np.testing.assert_array_equal(path_of(information, ompl_path(information, path)), path)


@spaces
def test_a_space_comes_back_with_ompls_metric(space):
    theirs, back = ompl_space(space), space_of(ompl_space(space))
    a, b = _random(space, 100, 1), _random(space, 100, 2)
    information = _free(space)
    pairs = zip(ompl_path(information, a).getStates(), ompl_path(information, b).getStates(), strict=True)
    distances = [theirs.distance(*pair) for pair in pairs]
    np.testing.assert_allclose(back.distance(a, b), distances, atol=1e-7)
    assert back.dim == space.dim
    assert back.contains(a).all()


@spaces
def test_motions_lead_over_the_same_places(space):
    a, b = _random(space, 40, 3), _random(space, 40, 4)
    information = _free(space)
    theirs = information.getStateSpace()
    ends = zip(ompl_path(information, a).getStates(), ompl_path(information, b).getStates(), strict=True)
    between = ompl_path(information, a)
    for state, pair in zip(between.getStates(), ends, strict=True):
        theirs.interpolate(*pair, 0.3, state)
    apart = space.distance(path_of(information, between), space.interpolate(a, b, 0.3))
    np.testing.assert_allclose(apart, 0.0, atol=1e-7)


def test_a_circle_takes_any_turn():
    information = _free(ARM)
    given = [[0.0, 4.0, 0.0, -math.pi], [1.0, -9.0, 0.5, math.pi]]
    path = path_of(information, ompl_path(information, given))
    np.testing.assert_allclose(path[:, 1], [4.0 - 2 * math.pi, -9.0 + 2 * math.pi])
    np.testing.assert_allclose(path[:, 3], [-math.pi, -math.pi])


def test_a_joint_that_wraps_after_another_turn_is_refused():
    with pytest.raises(InvalidValue, match="2 pi"):
        ompl_space(JointSpace((0.0,), (1.0,), True))


def test_spaces_without_a_counterpart_are_refused():
    with pytest.raises(InvalidValue, match="DubinsStateSpace"):
        space_of(ob.DubinsStateSpace(1.0))


def _ball(q):
    return ((q - 0.5) ** 2).sum(axis=1) > 0.09


class TestTheirWorld(WorldContract):
    """The corners of a square around a ball, as OMPL checks them."""

    free_between = False

    @property
    def world(self):
        information = ob.SpaceInformation(ompl_space(BoxSpace((0.0, 0.0), (1.0, 1.0))))
        information.setStateValidityChecker(lambda s: (s[0] - 0.5) ** 2 + (s[1] - 0.5) ** 2 > 0.09)
        information.setStateValidityCheckingResolution(0.01)
        return OmplWorld(information)


def test_our_planner_on_their_world_finds_what_it_finds_on_ours():
    ours = FunctionWorld(BoxSpace((0.0, 0.0), (1.0, 1.0)), _ball, 0.01)
    theirs = TestTheirWorld().world
    points = er.draw("even", 128, 2)
    one, other = (er.plan(world, (0.1, 0.1), (0.9, 0.9), er.PRM(points)) for world in (ours, theirs))
    assert one.solved
    assert other.solved
    assert other.proof == "resolution"
    assert other.cost == pytest.approx(one.cost, rel=0.02)
    assert all(_ball(other.path))


def test_their_planners_on_our_map_make_paths_that_our_map_calls_free():
    maze = load_maze(1)
    world = maze.world()
    for planner in (og.RRTConnect, og.PRM, og.LBKPIECE1):
        path = solve(planner(space_information(world)), maze.start, maze.goal, seconds=20.0)
        assert path is not None, planner
        assert world.motion_valid(path[:-1], path[1:]).all()
        np.testing.assert_allclose(path[[0, -1]], [maze.start, maze.goal])


def test_their_planner_on_our_arm_makes_a_path_that_is_proved_free():
    robot, scene = load_robot("ur5"), load_scene("box-reach")
    world = er.ArmWorld(robot, scene)
    start, goal = (robot.configuration(name, scene) for name in ("home", "inside"))
    path = solve(og.RRTConnect(space_information(world)), start, goal, seconds=30.0)
    assert path is not None
    assert world.validate(path).all()


def test_no_path_is_none_within_the_time():
    box = BoxSpace((0.0, 0.0), (1.0, 1.0))
    wall = FunctionWorld(box, lambda q: abs(q[:, 0] - 0.5) > 0.1, 0.01)
    assert solve(og.RRTConnect(space_information(wall)), (0.1, 0.1), (0.9, 0.9), seconds=0.2) is None
    assert plan_on_points(space_information(wall), (0.1, 0.1), (0.9, 0.9), er.draw("even", 64, 2)) is None


def test_the_nearest_of_several_goals_is_reached():
    world = FunctionWorld(BoxSpace((0.0, 0.0), (1.0, 1.0)), _ball, 0.01)
    goals = [(0.9, 0.9), (0.1, 0.6)]
    path = plan_on_points(space_information(world), (0.1, 0.1), goals, er.draw("even", 64, 2))
    np.testing.assert_array_equal(path[[0, -1]], [(0.1, 0.1), goals[1]])
    assert solve(og.RRTConnect(space_information(world)), (0.1, 0.1), goals, 5.0) is not None


def test_the_sampler_hands_out_the_free_points_in_their_order():
    world = FunctionWorld(BoxSpace((0.0, 0.0), (1.0, 1.0)), _ball, 0.01)
    information, points = space_information(world), er.draw("halton", 60, 2)
    sampler, state = give_points(information, points), information.allocState()
    handed = []
    while sampler.sample(state):
        handed.append(state[0:2])
    np.testing.assert_array_equal(handed, points.points[_ball(points.points)])
    assert sampler.used_up


def solved_alike(world, start, goal, points):
    """Return how long the paths are that both find on these points, or None: OMPL's rule is k earlier, ends first."""
    ours = er.plan(world, start, goal, er.PRM(points, rule=KEarlier(10), links=None), smooth=False)
    theirs = plan_on_points(space_information(world), start, goal, points)
    assert ours.solved == (theirs is not None)
    if theirs is None:
        return None
    assert world.motion_valid(theirs[:-1], theirs[1:]).all()
    return ours.cost, world.space.distance(theirs[:-1], theirs[1:]).sum()


@pytest.mark.parametrize("level", [1, 2])
@pytest.mark.parametrize("n", [32, 64, 128])
def test_prm_on_our_points_solves_what_our_roadmap_does(level, n):
    maze = load_maze(level)
    for seed in range(4):
        costs = solved_alike(maze.world(), maze.start, maze.goal, er.draw("halton", n, 2, rng=seed))
        assert costs is None or costs[1] == pytest.approx(costs[0], rel=1e-9)


@pytest.mark.parametrize(("d", "lam", "n"), [(2, 0.1, 128), (3, 0.2, 128), (3, 0.15, 256)])
def test_prm_on_our_points_solves_what_our_roadmap_does_in_corridors(d, lam, n):
    world = Corridor(d, lam)
    for seed in range(4):
        solved_alike(world, world.start, world.goal, er.draw("uniform", n, d, rng=seed))


def test_prm_on_our_points_solves_what_our_roadmap_does_among_random_balls():
    outcomes = set()
    for seed in range(80):
        random = np.random.default_rng(seed)
        d = int(random.integers(2, 4))
        centres = random.random((int(random.integers(4, 12)), d))
        radius = random.uniform(0.1, 0.3 if d == 3 else 0.22)

        def free(q, centres=centres, radius=radius):
            return (((q[:, None, :] - centres) ** 2).sum(axis=2) > radius**2).all(axis=1)

        start, goal = np.full(d, 0.02), np.full(d, 0.98)
        if free(np.stack([start, goal])).all():
            world = FunctionWorld(BoxSpace(np.zeros(d), np.ones(d)), free, 0.01 * np.sqrt(d))
            outcomes.add(solved_alike(world, start, goal, er.draw("uniform", 40, d, rng=seed)) is not None)
    assert outcomes == {True, False}


def test_prm_star_takes_our_points_too():
    maze = load_maze(1)
    information = space_information(maze.world())
    path = plan_on_points(information, maze.start, maze.goal, er.draw("even", 256, 2), og.PRMstar(information))
    assert path is not None


@pytest.mark.parametrize("seed", range(3))
def test_rigid_bodies_plan_both_ways(seed):
    """A stick in the plane among balls: OMPL on our world, ours on OMPL's, one judge."""
    space = SE2((0, 0), (1, 1), weights=(1.0, 0.2), combine="sum")
    balls = np.random.default_rng(seed).random((5, 2)) * 0.6 + 0.2

    def free(q):
        along = np.linspace(-0.1, 0.1, 9)
        heads = np.stack([np.cos(q[:, 2]), np.sin(q[:, 2])], axis=1)
        places = q[:, None, :2] + along[:, None] * heads[:, None, :]
        gap = np.linalg.norm(places[:, :, None] - balls, axis=3)
        return (gap > 0.09).all(axis=(1, 2))

    world = FunctionWorld(space, free, 0.01)
    start, goal = (0.04, 0.04, 0.0), (0.96, 0.96, 1.5)
    path = solve(og.RRTConnect(space_information(world)), start, goal, seconds=20.0)
    assert path is not None
    assert world.motion_valid(path[:-1], path[1:]).all()
    information = ob.SpaceInformation(ompl_space(space))
    information.setStateValidityChecker(lambda s: bool(free(np.array([[s.getX(), s.getY(), s.getYaw()]]))[0]))
    information.setStateValidityCheckingResolution(0.005)
    result = er.plan(OmplWorld(information), start, goal, er.PRM(er.draw("even", 256, 3)))
    assert result.solved
    assert free(result.path).all()
