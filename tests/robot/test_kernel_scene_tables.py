"""Tables of obstacles, and the distances of points from obstacles that they are made with."""

import math
from dataclasses import replace

import numpy as np
import pytest
from numba import njit

from evenroad.geometry.shapes import Capsule
from evenroad.robot.arm_world import ArmWorld
from evenroad.robot.kernel import layout, scene_tables
from evenroad.robot.kernel.scalar import squared_distance_to_obstacle
from evenroad.robot.scene import Obstacle, Scene
from tests.robot.kernel_arms import STRAIGHT, random_rotation, random_scene, random_tree, seven_joint_arm, ur5
from tests.robot.oracle import obstacle_distance

LONG = replace(
    ur5(), capsules=(*ur5().capsules, Capsule((0.0, 0.0, 0.0), (0.0, 0.0, 9.0), 0.1, link="wrist3"))
)
"""A robot that reaches far: nothing of an obstacle is cut off."""


@njit(cache=True)
def squared_distance(point, form, floats, data):
    return squared_distance_to_obstacle(point[0], point[1], point[2], form, floats, data)


def point_to_obstacle(point, obstacle):
    tables = ArmWorld(LONG, Scene((obstacle,), name="one")).tables
    form, data = tables.ints[tables.ints[layout.OBSTACLE_INTS]], tables.ints[layout.OBSTACLE_FLOATS]
    apart = math.sqrt(squared_distance(point, form, tables.floats, data))
    return max(apart - tables.floats[data + 15], 0.0)


QUARTER = (0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0)


def test_the_distance_of_points_from_obstacles_is_the_oracles():
    points = np.random.default_rng(1).uniform(-1.0, 1.0, (100, 3))
    for obstacle in random_scene(2, count=30).obstacles:
        slow = [point_to_obstacle(point, obstacle) for point in points]
        np.testing.assert_allclose(slow, obstacle_distance(points, obstacle), atol=1e-12)


@pytest.mark.parametrize(
    ("obstacle", "point", "distance"),
    [
        (Obstacle.of("b", "box", (2.0, 4.0, 6.0), (0, 0, 0)), (4.0, 6.0, 3.0), 5.0),
        (Obstacle.of("b", "box", (2.0, 4.0, 6.0), (0, 0, 0), QUARTER), (4.0, 0.0, 0.0), 2.0),
        (Obstacle.of("b", "box", (2.0, 4.0, 6.0), (0, 0, 0)), (0.5, 1.0, -2.0), 0.0),
        (Obstacle.of("s", "sphere", (1.0,), (1.0, 0, 0)), (4.0, 0.0, 0.0), 2.0),
        (Obstacle.of("c", "capsule", (1.0, 2.0), (0, 0, 0)), (0.0, 0.0, 3.0), 1.0),
        (Obstacle.of("c", "cylinder", (1.0, 2.0), (0, 0, 0)), (0.0, 0.0, 3.0), 2.0),
        (Obstacle.of("c", "cylinder", (1.0, 2.0), (0, 0, 0)), (4.0, 0.0, 5.0), 5.0),
    ],
)
def test_distances_that_can_be_worked_out_by_hand(obstacle, point, distance):
    assert math.isclose(point_to_obstacle(np.array(point), obstacle), distance)


def test_random_rotations_of_the_tests_are_rotations():
    for seed in range(5):
        turn = np.reshape(random_rotation(np.random.default_rng(seed)), (3, 3))
        np.testing.assert_allclose(turn @ turn.T, np.reshape(STRAIGHT, (3, 3)), atol=1e-12)
        assert np.linalg.det(turn) > 0.0


# ---- tables


def slow_rows(obstacles, tested, reach, relative_padding):
    """Rows of obstacles by plain numpy, as they were first written: kinds, obstacles, blocks, masks of tested ones."""
    kinds, rows, boxes = [], [], []
    for obstacle in obstacles:
        kind, centre, half, rotation, rounding = slow_rounded_box(obstacle, reach)
        bounds = np.abs(rotation) @ half + rounding
        if kind == layout.CYLINDER:
            upright = np.abs(rotation[:, 2])
            bounds = upright * half[2] + np.sqrt(np.maximum(1.0 - upright**2, 0.0)) * half[0]
        padding = relative_padding * float(np.linalg.norm(np.abs(centre) + bounds))
        kinds.append(kind)
        rows += [*centre, *half, *rotation.ravel(), rounding + padding]
        boxes.append((centre, bounds + padding))
    masks = []
    for first in range(0, len(boxes), 16):
        block = boxes[first : first + 16]
        for part in (0, 1):
            for axis in range(3):
                rows += [float(box[part][axis]) for box in block] + [-1e30 * part] * (16 - len(block))
    for wanted in tested:
        for first in range(0, len(boxes), 16):
            masks.append(sum(1 << lane for lane in np.flatnonzero(wanted[first : first + 16]).tolist()))
    return kinds, np.array(rows), masks


def slow_rounded_box(obstacle, reach):
    centre, rotation = np.array(obstacle.xyz), np.reshape(obstacle.rotation, (3, 3))
    straight = np.abs(rotation - np.rint(rotation)).max() < 1e-14
    if obstacle.shape == "sphere":
        return layout.ALIGNED, centre, np.zeros(3), np.eye(3), obstacle.size[0]
    if obstacle.shape == "cylinder":
        radius, length = obstacle.size
        return layout.CYLINDER, centre, np.array([radius, radius, 0.5 * length]), rotation, 0.0
    if obstacle.shape == "capsule":
        half, rounding = np.array([0.0, 0.0, 0.5 * obstacle.size[1]]), obstacle.size[0]
    else:
        half, rounding = 0.5 * np.array(obstacle.size), 0.0
    if not straight:
        return layout.ROTATED, centre, half, rotation, rounding
    half = np.abs(np.rint(rotation)) @ half
    if obstacle.shape == "box":
        low, high = np.maximum(centre - half, -2.0 * reach), np.minimum(centre + half, 2.0 * reach)
        centre, half = 0.5 * (low + high), 0.5 * (high - low)
    return layout.ALIGNED, centre, half, np.eye(3), rounding


def crowded(seed):
    """A robot of every kind, and a scene from empty to crowded, with some contacts allowed and some out of reach."""
    rng = np.random.default_rng(seed)
    robot = (ur5(), seven_joint_arm(), random_tree(seed))[seed % 3]
    some = random_scene(seed, count=int(rng.integers(0, 45)), spread=rng.uniform(0.5, 3.0), sizes=(0.02, 0.3))
    floor = Obstacle.of(
        "floor", "box", (100.0, 100.0, 1.0), (0.0, 0.0, -2.0), QUARTER if seed % 2 else STRAIGHT
    )
    obstacles = (*some.obstacles, floor) if seed % 4 else some.obstacles
    contacts = [(link, obstacle.name) for link in robot.links for obstacle in obstacles]
    return robot, Scene(
        obstacles, name="crowded", allowed=frozenset(c for c in contacts if rng.random() < 0.1)
    )


@pytest.mark.parametrize("seed", range(40))
def test_tables_are_those_of_the_slow_packer(seed):
    robot, scene = crowded(seed)
    world = ArmWorld(robot, scene)
    of_robot, tables = world.robot_tables, world.tables
    points, capsules = np.zeros((1, 3)), of_robot.capsules
    kept = [o for o in scene.obstacles if obstacle_distance(points, o)[0] <= of_robot.reach]
    assert [scene.obstacles[k] for k in tables.kept] == kept
    tested = [[(c.link, o.name) not in scene.allowed for o in kept] for c in capsules]
    kinds, rows, masks = slow_rows(kept, tested, of_robot.reach, 0.0)
    _, padded, _ = slow_rows(kept, tested, of_robot.reach, scene_tables.OBSTACLE_PADDING)
    first = len(of_robot.ints)
    assert tables.ints[first:].tolist() == kinds + masks
    header = of_robot.ints[: layout.HEADER].copy()
    header[[layout.OBSTACLES, layout.BLOCKS]] = len(kept), -(-len(kept) // 16)
    header[[layout.OBSTACLE_INTS, layout.TESTED]] = first, first + len(kept)
    header[[layout.OBSTACLE_FLOATS, layout.BLOCK_FLOATS]] = (
        len(of_robot.floats),
        len(of_robot.floats) + 16 * len(kept),
    )
    header[layout.INTEGERS] = len(tables.ints)
    np.testing.assert_array_equal(tables.ints[: layout.HEADER], header)
    np.testing.assert_array_equal(tables.ints[layout.HEADER : first], of_robot.ints[layout.HEADER :])
    np.testing.assert_array_equal(tables.floats[: len(of_robot.floats)], of_robot.floats)
    # Sums of three products are rounded as the libraries of the machine please.
    np.testing.assert_allclose(tables.floats[len(of_robot.floats) :], rows, rtol=1e-15, atol=0.0)
    np.testing.assert_array_equal(tables.lanes[: len(tables.ints)], tables.ints)
    singles = tables.lanes[len(tables.ints) :].view(np.float32)[: len(tables.floats)]
    np.testing.assert_array_equal(singles[: len(of_robot.floats)], of_robot.singles)
    np.testing.assert_allclose(
        singles[len(of_robot.floats) :], padded.astype(np.float32), rtol=1.2e-7, atol=0.0
    )


def test_a_robots_tables_are_made_once_for_robots_of_one_value():
    first, again = ArmWorld(ur5(), random_scene(1)), ArmWorld(ur5(), random_scene(2))
    assert again.robot_tables is first.robot_tables
    held = replace(ur5(joints=5), held={"wrist_3_joint": 0.1})
    assert (
        ArmWorld(held, random_scene(1)).robot_tables
        is not ArmWorld(ur5(joints=5), Scene((), name="")).robot_tables
    )
    assert ArmWorld(replace(held, held={"wrist_3_joint": 0.1}), Scene((), name="")).robot_tables is (
        ArmWorld(held, Scene((), name="")).robot_tables
    )


def test_a_robot_of_lists_is_none_to_remember_but_works():
    robot = ur5()
    lists = replace(robot, capsules=[replace(c, a=list(c.a)) for c in robot.capsules])
    q = np.random.default_rng(1).uniform(-3.0, 3.0, (500, 6))
    scene = random_scene(1)
    np.testing.assert_array_equal(ArmWorld(lists, scene).valid(q), ArmWorld(robot, scene).valid(q))
