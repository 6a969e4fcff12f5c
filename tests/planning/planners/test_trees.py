"""The trees of arms: joined where there is a way, the same each time, every motion proved, the budget kept."""

import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from evenroad.collision.arm_world import ArmWorld
from evenroad.errors import InvalidValue
from evenroad.geometry.pose import Pose
from evenroad.geometry.shapes import Box
from evenroad.planning import plan
from evenroad.planning.arm_trees import connect, grown_trees, shorten, smooth
from evenroad.points.reversed_halton import ball_points, cube_points, reversed_halton, sphere_points
from evenroad.roadmap import Budget
from evenroad.robots.joint import Joint
from evenroad.robots.kinematics import link_poses
from evenroad.robots.robot import Robot
from evenroad.scenes.scene import Obstacle, Scene
from tests.robots.kernel_arms import STRAIGHT, random_scene, random_tree, seven_joint_arm, ur5
from tests.robots.oracle import clearance
from tests.robots.paths import GOAL, START, box_world, dense_states, proved
from tests.robots.post_scenes import at, flat_arm, free_places, posts


@pytest.fixture(scope="module")
def world():
    return box_world()


@pytest.fixture(scope="module")
def found(world):
    return connect(world, START, [GOAL])


def test_a_goal_deep_in_a_box_is_reached(world, found):
    assert found.goal == 0
    np.testing.assert_array_equal(found.path[[0, -1]], [START, GOAL])
    assert proved(world, found.path)
    assert clearance(world.robot, world.scene, dense_states(world, found.path)).min() > 0.0
    assert found.nodes >= len(found.path)
    assert found.configurations > found.motions > len(found.path) - 1


def test_the_same_arguments_give_the_same_path_however_long_there_is(world, found):
    for seconds in (0.5, 500.0):
        again = connect(world, START, [GOAL], seconds=seconds)
        np.testing.assert_array_equal(again.path, found.path)
        assert counts_of(again) == counts_of(found)


ABOVE, BELOW = np.array([[0.0, -1.5, 0.0, 0.0, 0.0, 0.0], [0.0, 4.78, 0.0, 0.0, 0.0, 0.0]])


@pytest.fixture(scope="module")
def split():
    """A UR5 on a large plate, which keeps `ABOVE` from `BELOW`; there is room to move at both."""
    plate = Obstacle.of("plate", "box", (4.0, 4.0, 0.05), (0.0, 0.0, -0.25))
    return ArmWorld(ur5(), Scene((plate,), name="plate", allowed=frozenset({("base", "plate")})))


def test_trees_of_many_thousand_nodes_grow_alike_each_time(split):
    first, again = (connect(split, ABOVE, [BELOW], most_motions=20_000, seconds=60) for _ in range(2))
    assert first.goal == -1
    assert first.nodes > 2 * 2048
    assert counts_of(first) == counts_of(again)


def counts_of(connection):
    return connection.nodes, connection.motions, connection.configurations


def test_a_budget_of_motions_is_kept_to_the_last_and_changes_nothing_within_it(world, found, split):
    for most in range(1, found.motions):
        few = connect(world, START, [GOAL], most_motions=most)
        assert (few.goal, few.path.shape, few.motions) == (-1, (0, 5), most)
    enough = connect(world, START, [GOAL], most_motions=found.motions)
    assert enough.path.tobytes() == found.path.tobytes()
    assert counts_of(enough) == counts_of(found)
    # Between the plate's two sides eight steps at once are offered for long.
    assert all(connect(split, ABOVE, [BELOW], most_motions=most).motions == most for most in range(500, 540))


def test_a_budget_of_time_is_kept(split):
    begin = time.perf_counter()
    some = connect(split, ABOVE, [BELOW], seconds=0.3)
    assert some.goal == -1
    assert some.motions > 0
    assert 0.3 <= time.perf_counter() - begin < 2.0


def test_of_several_goals_one_that_can_be_reached_is_named(world, found):
    blocked = np.array([0.0, 0.9, 0.0, 0.0, 0.0])
    assert not world.valid(blocked[None])[0]
    several = connect(world, START, [blocked, GOAL])
    assert several.goal == 1
    np.testing.assert_array_equal(several.path[-1], GOAL)
    near = START + 0.05
    assert connect(world, START, [GOAL, blocked, near]).goal == 2


def test_more_goals_than_fit_a_batch(world):
    rng = np.random.default_rng(3)
    goals = world.space.from_cube(rng.random((500, 5)))
    free = world.valid(goals)
    several = connect(world, START, goals)
    assert free[several.goal]
    np.testing.assert_array_equal(several.path[-1], goals[several.goal])


def test_ends_that_are_not_free_give_no_path_and_one_that_is_both_is_one(world):
    blocked = np.array([0.0, 0.9, 0.0, 0.0, 0.0])
    beyond = START + np.array([0.0, 9.0, 0.0, 0.0, 0.0])
    for start, goal in ((blocked, GOAL), (START, blocked), (beyond, GOAL), (START, beyond)):
        none = connect(world, start, [goal])
        assert (none.goal, len(none.path), none.motions) == (-1, 0, 0)
    same = connect(world, START, [START])
    assert same.goal == 0
    np.testing.assert_array_equal(same.path, [START, START])


@pytest.mark.parametrize("seed", [0, 3, 4, 5, 8, 13])
def test_any_robot_gets_from_place_to_place(seed):
    robot, scene = random_tree(seed), random_scene(100 + seed, spread=0.7, clear=0.45)
    world = ArmWorld(robot, scene)
    q = world.space.from_cube(np.random.default_rng(seed).random((2000, world.space.dim)))
    q = q[world.valid(q)][:4]
    solved = 0
    for start, goal in pairwise(q):
        connection = connect(world, start, [goal], most_motions=3_000, seconds=20.0)
        if connection.goal < 0:
            continue
        solved += 1
        np.testing.assert_allclose(connection.path[[0, -1]], [start, goal], rtol=0, atol=1e-12)
        assert world.space.contains(connection.path).all()
        assert clearance(robot, scene, dense_states(world, connection.path)).min() > 0.0
    assert solved > 0


def test_joints_that_wrap_go_the_short_way_round():
    robot = ur5()
    pan = replace(robot.joints[0], kind="continuous", lower=-np.inf, upper=np.inf)
    world = ArmWorld(replace(robot, joints=(pan, *robot.joints[1:])), Scene((), name="nothing"))
    start, goal = np.array([3.0, -1.5, 0.5, 0.0, 0.0, 0.0]), np.array([-3.0, -1.5, 0.5, 0.0, 0.0, 0.0])
    path = connect(world, start, [goal]).path
    assert world.space.distance(path[:-1], path[1:]).sum() == pytest.approx(2 * np.pi - 6.0)


def test_one_joint_is_enough():
    robot = ur5(joints=1)
    world = ArmWorld(robot, Scene((), name="nothing"))
    assert connect(world, [0.3], [[2.0]]).goal == 0


def test_fourteen_joints_are_not_too_many():
    seven = seven_joint_arm()
    chain, links = list(seven.joints), list(seven.links)
    for i in range(7):
        links.append(f"more{i}")
        axis = (0.0, 1.0, 0.0) if i % 2 else (0.0, 0.0, 1.0)
        chain.append(Joint(f"more joint{i}", "revolute", *links[-2:], (0.0, 0.0, 0.05), STRAIGHT, axis, -2.0, 2.0))
    long = replace(seven, links=tuple(links), joints=tuple(chain), group=tuple(joint.name for joint in chain))
    world = ArmWorld(long, random_scene(3))
    q = world.space.from_cube(np.random.default_rng(0).random((500, 14)))
    q = q[world.valid(q)]
    connection = connect(world, q[0], q[1:2], seconds=30)
    assert connection.goal == 0
    assert clearance(long, world.scene, dense_states(world, connection.path)).min() > 0.0


def two_arms(apart=0.7):
    """Two arms of seven joints side by side, 14 joints in all, tested against each other."""
    seven = seven_joint_arm()
    links, joints, capsules, pairs, group = ["torso"], [], [], [], []
    for side, y in (("left ", 0.5 * apart), ("right ", -0.5 * apart)):
        joints.append(Joint(side + "mount", "fixed", "torso", side + "base", (0.0, y, 0.0), STRAIGHT))
        for joint in seven.joints:
            names = {what: side + getattr(joint, what) for what in ("name", "parent", "child")}
            joints.append(replace(joint, **names))
        links += [side + link for link in seven.links]
        capsules += [replace(capsule, link=side + capsule.link) for capsule in seven.capsules]
        pairs += [(side + first, side + second) for first, second in seven.pairs]
        group += [side + joint for joint in seven.group]
    pairs += [("left " + a, "right " + b) for a in seven.links for b in seven.links if (a, b) != ("base", "base")]
    return Robot("two arms", tuple(links), tuple(joints), tuple(capsules), tuple(pairs), tuple(group))


def sleeves(robot, q, gap=0.04):
    """Four plates around either hand, open at both ends: any long step from there touches one."""
    hands = [robot.links.index(side + "link7") for side in ("left ", "right ")]
    half, obstacles = 0.059 + gap, []
    for side, hand in zip("lr", link_poses(robot, q[np.newaxis])[0, hands], strict=True):
        for number, (x, y) in enumerate(((1, 0), (-1, 0), (0, 1), (0, -1))):
            at = hand[:3, :3] @ [half * x, half * y, 0.03] + hand[:3, 3]
            sides = (0.02, 2.0 * half, 0.16) if x else (2.0 * half, 0.02, 0.16)
            pose = Pose(tuple(at), tuple(hand[:3, :3].ravel()))
            obstacles.append(Obstacle(f"{side}{number}", Box(sides, pose=pose)))
    return Scene(tuple(obstacles), name="sleeves")


def test_two_arms_get_both_hands_out_of_their_sleeves():
    # With steps in which all joints move, few of these are solved.
    robot = two_arms()
    alone = ArmWorld(robot, Scene(name="nothing"))
    q = alone.space.from_cube(np.random.default_rng(1).random((1000, 14)))
    q, solved = q[alone.valid(q)], 0
    for start, goal in zip(q[0:200:2], q[1:200:2], strict=True):
        world = ArmWorld(robot, sleeves(robot, start))
        if not world.valid(np.array([start, goal])).all():
            continue
        connection = connect(world, start, [goal], most_motions=50_000, seconds=30)
        assert connection.goal == 0
        assert clearance(robot, world.scene, dense_states(world, connection.path)[::20]).min() > 0.0
        solved += 1
        if solved == 6:
            return
    pytest.fail("too few problems whose ends are free")


def test_a_sequence_of_the_callers_leads_elsewhere_and_goes_on_behind_its_end(split):
    three = np.random.default_rng(0).random((3, 6))
    counts = {
        counts_of(connect(split, ABOVE, [BELOW], most_motions=500, seconds=60, sequence=sequence))
        for sequence in (None, three[:1], three)
    }
    assert len(counts) == 3


@pytest.mark.parametrize(("change", "text"), [
    ({"start": START[:4]}, "start must have shape"), ({"goals": GOAL}, "goals must have shape"),
    ({"goals": np.empty((0, 5))}, "goals must have shape"), ({"goals": [GOAL * np.nan]}, "must be finite"),
    ({"most_motions": 0}, "most_motions"), ({"seconds": 0.0}, "seconds"), ({"seconds": float("nan")}, "seconds"),
    ({"sequence": np.full((3, 5), 2.0)}, "unit cube"),
])  # fmt: skip
def test_arguments_that_make_no_sense_are_refused(world, change, text):
    arguments = {"start": START, "goals": [GOAL]} | change
    with pytest.raises(InvalidValue, match=text):
        connect(world, arguments.pop("start"), arguments.pop("goals"), **arguments)


def test_points_in_a_ball_and_directions_are_spread_evenly():
    for dim in (1, 2, 6, 7):
        points = ball_points(dim)
        radii = np.linalg.norm(points, axis=1)
        assert radii.max() <= 1.0 + 1e-12
        np.testing.assert_allclose(points.mean(axis=0), 0.0, atol=0.02)
        # The r-th part of the volume holds the r-th part of the points.
        assert np.mean(radii**dim < 0.5) == pytest.approx(0.5, abs=0.01)
        np.testing.assert_allclose((points**2).mean(axis=0), 1.0 / (dim + 2), rtol=0.1)
    for dim in (1, 2, 6, 8, 14):
        lengths = np.linalg.norm(ball_points(dim), axis=1)
        all_sizes = [sphere_points(dim)]
        if dim > 7:
            # In many dimensions, long steps; in one pair of three only some joints move, from two to all.
            np.testing.assert_allclose(np.quantile(lengths, [0.0, 0.5, 1.0]), [0.6, 0.6**0.5, 1.0], rtol=0.01)
            moves = (ball_points(dim) != 0.0).sum(axis=1).reshape(-1, 2)
            few = moves[np.arange(len(moves)) % 3 == 0]
            assert (np.delete(moves, np.s_[::3], axis=0) == dim).all()
            assert sorted(set(few.ravel())) == list(range(2, dim + 1))
            assert np.median(few) == pytest.approx((2 * dim) ** 0.5, abs=0.6)
            joints = (ball_points(dim) != 0.0).reshape(-1, 2, dim)[::3].mean(axis=(0, 1))
            np.testing.assert_allclose(joints, joints.mean(), atol=0.06)
        for directions in all_sizes:
            assert directions.shape == ball_points(dim).shape
            np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1.0, rtol=1e-12)
            np.testing.assert_allclose(directions.mean(axis=0), 0.0, atol=0.03)
            np.testing.assert_allclose((directions**2).mean(axis=0), 1.0 / dim, rtol=0.1)


def test_halton_points_are_those_of_the_definition():
    np.testing.assert_allclose(reversed_halton(5, 1)[:, 0], [0.5, 0.25, 0.75, 0.125, 0.625])
    # Base 3: 1 -> 2/3, 2 -> 1/3, 3 = 10 -> 2/9, 4 = 11 -> 2/3 + 2/9.
    np.testing.assert_allclose(reversed_halton(4, 2)[:, 1], [2 / 3, 1 / 3, 2 / 9, 8 / 9])
    assert cube_points(30).shape == (2048, 30)


def test_threads_do_not_disturb_each_other(world, found):
    detour = np.concatenate([found.path, found.path[::-1], found.path])

    def ask(world):
        return connect(world, START, [GOAL]).path, shorten(world, detour)[0], smooth(world, detour, batches=400)[0]

    # Of a world that nobody has asked for larger bodies.
    alone, fresh = ask(world), box_world()
    with ThreadPoolExecutor(4) as threads:
        for answers in threads.map(lambda _: ask(fresh), range(20)):
            assert all(map(np.array_equal, answers, alone))


def test_trees_that_are_shown_are_free_and_begin_at_the_ends():
    world = box_world()
    nodes, links = grown_trees(world, START, GOAL[np.newaxis])
    assert len(nodes) == connect(world, START, GOAL[np.newaxis]).nodes
    assert len(links) == len(nodes) - 2
    assert world.motion_valid(nodes[links[:, 0]], nodes[links[:, 1]]).all()
    roots = nodes[np.setdiff1d(np.arange(len(nodes)), links[:, 0])]
    np.testing.assert_allclose(np.sort(roots, axis=0), np.sort([START, GOAL], axis=0))


def test_paths_among_posts_that_no_state_shows_are_free_by_proof_alone():
    """States are so far apart that most posts stand between two of them: nothing but proofs keeps paths away."""
    plans = 0
    for seed in range(3):
        rng = np.random.default_rng(seed)
        robot = flat_arm(joints=3)
        robot = replace(robot, capsules=tuple(replace(each, radius=0.01) for each in robot.capsules))
        scene = posts(*map(at, rng.uniform(-3.0, 3.0, 9), rng.uniform(0.25, 1.4, 9)), radius=0.01)
        world = ArmWorld(robot, scene, resolution=0.6)
        fine, places = replace(world, resolution=1e-3), free_places(world, rng, 8)
        for start, goal in zip(places[::2], places[1::2], strict=True):
            path = plan(world, start, goal, limits=Budget(motions=4_000)).path
            if path is not None:
                assert fine.motion_valid(path[:-1], path[1:]).all()
                plans += 1
    assert plans > 6
