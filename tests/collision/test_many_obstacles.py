"""Scenes of so many obstacles that a grid and a tree find those that are near: verdicts are those of every obstacle."""

from dataclasses import replace

import numpy as np
import pytest

from evenroad.collision.arm_world import ArmWorld
from evenroad.geometry import PointCloud
from evenroad.loading.load import load_robot
from evenroad.scenes.scene import Obstacle, Scene
from tests.robots.kernel_arms import edge, random_rotation, ur5
from tests.robots.mesh_arms import write_fork_arm
from tests.robots.oracle import clearance

FEW = 100
"""Of so few obstacles each is tested: there is no tree."""


def small_ones(seed, count=700, low=(0.2, 0.0), size=(0.004, 0.03)):
    """Obstacles of every shape, turned and not, about a robot."""
    rng = np.random.default_rng(seed)
    made = []
    for i in range(count):
        kind = ("box", "sphere", "cylinder", "capsule")[i % 4]
        dimensions = rng.uniform(*size, {"box": 3, "sphere": 1}.get(kind, 2))
        angle, away, high = rng.uniform(-np.pi, np.pi), rng.uniform(low[0], 0.9), rng.uniform(low[1], 1.0)
        rotation = np.eye(3).ravel().tolist() if i % 3 == 0 else random_rotation(rng)
        place = (away * np.cos(angle), away * np.sin(angle), high)
        made.append(Obstacle.of(f"small {i}", kind, tuple(dimensions), place, tuple(rotation)))
    return Scene(made)


def heap():
    """Boxes of which most are at one place, beside a floor, a wall beyond reach, and what is far away."""
    rng = np.random.default_rng(8)
    boxes = [Obstacle.of(f"same {i}", "box", (0.05, 0.05, 0.05), (0.5, 0.1, 0.4)) for i in range(400)]
    for i in range(60):
        way = rng.normal(size=3)
        boxes.append(Obstacle.of(f"far {i}", "sphere", (0.5,), tuple(way / np.linalg.norm(way) * 1.3)))
    tilt = (0.999, 0.0, 0.0447, 0.0, 1.0, 0.0, -0.0447, 0.0, 0.999)
    floor = Obstacle.of("floor", "box", (90.0, 90.0, 1.0), (0.0, 0.0, -0.9), tilt)
    return Scene([*boxes, floor, Obstacle.of("wall", "cylinder", (3.0, 0.2), (0.0, 3.7, 0.5))])


def two_heaps():
    """Small balls in two heaps, and nothing between them: cells are so small that links are wider than many."""
    rng = np.random.default_rng(9)
    aside = rng.uniform(-0.05, 0.05, (400, 3)) + np.repeat([(0.5, -0.15, 0.4), (0.5, 0.15, 0.4)], 200, axis=0)
    return Scene([Obstacle.of(f"ball {i}", "sphere", (0.004,), tuple(place)) for i, place in enumerate(aside)])


def loosely_allowed(robot, scene, seed=1):
    """The scene, with a third of all contacts of links and obstacles allowed."""
    rng = np.random.default_rng(seed)
    contacts = [(link, name) for link in robot.links for name in scene.names]
    return replace(scene, allowed=frozenset(c for c in contacts if rng.random() < 1 / 3))


def parts_of(world):
    """The world again and again, each time with a few of its obstacles."""
    scene = world.scene
    for first in range(0, len(scene.obstacles), FEW):
        few = scene.obstacles[first : first + FEW]
        names = {each.name for each in few}
        allowed = frozenset(each for each in scene.allowed if each[1] in names)
        yield replace(world, scene=replace(scene, obstacles=few, allowed=allowed))


@pytest.fixture(
    scope="module", params=["small ones", "a third allowed", "a heap", "two heaps", "true shapes", "a clearance"]
)
def world(request, tmp_path_factory):
    robot, name = ur5(), request.param
    if name == "true shapes":
        robot = load_robot(write_fork_arm(tmp_path_factory.mktemp("fork")))
        return ArmWorld(robot, small_ones(4, low=(0.3, 0.2)))
    if name in ("a heap", "two heaps"):
        return ArmWorld(robot, heap() if name == "a heap" else two_heaps())
    scene = small_ones(3)
    if name == "a clearance":
        return ArmWorld(robot, small_ones(6, count=400), clearance=0.01)
    return ArmWorld(robot, loosely_allowed(robot, scene) if name == "a third allowed" else scene)


def test_verdicts_at_random_and_next_to_contact_are_those_of_all_few(world):
    q = world.space.from_cube(np.random.default_rng(1).random((3_000, world.space.dim)))
    free, blocked = edge(world, q)
    asked = np.concatenate([q, free, blocked])
    expected = np.logical_and.reduce([part.valid(asked) for part in parts_of(world)])
    assert 0.02 < expected[: len(q)].mean() < 0.98
    np.testing.assert_array_equal(world.valid(asked), expected)
    # Sixteen neighbours or none: a lane's verdict is its own.
    np.testing.assert_array_equal([world.valid(row) for row in asked[-100:]], expected[-100:])


def test_motions_are_free_where_they_are_among_all_few(world):
    q = world.space.from_cube(np.random.default_rng(2).random((20_000, world.space.dim)))
    q = q[world.valid(q)]
    rng = np.random.default_rng(3)
    # Short ones, of neighbouring states, and long ones.
    ends = np.concatenate([q[:300] + rng.normal(size=q[:300].shape) * 0.05, q[300:400]])
    a, b = np.concatenate([q[:300], q[100:200]]), np.clip(ends, world.bounds[0], world.bounds[1])
    expected = np.logical_and.reduce([part.motion_valid(a, b) for part in parts_of(world)])
    assert 0.02 < expected.mean() < 0.98
    np.testing.assert_array_equal(world.motion_valid(a, b), expected)
    proved = world.motion_certified(a, b, 1e-6)
    assert proved.any()
    # What is proved among all is proved among a few, too.
    assert all(part.motion_certified(a[proved], b[proved], 1e-6).all() for part in parts_of(world))


def test_single_precision_is_never_optimistic_among_many():
    world = ArmWorld(ur5(), small_ones(5, count=400))
    q = world.space.from_cube(np.random.default_rng(4).random((400, world.space.dim)))
    apart = clearance(world.robot, world.scene, edge(world, q)[0])
    assert (apart > 0.0).all()
    assert np.median(apart) < 1e-5


def test_the_obstacle_that_is_named_touches_by_itself():
    world = ArmWorld(ur5(), small_ones(3))
    q = world.space.from_cube(np.random.default_rng(5).random((300, world.space.dim)))
    named = 0
    for row in q[~world.valid(q)]:
        _, touches, name = world.explain(row).rpartition(" touches ")
        if touches and name.strip("'") in world.scene.names:
            obstacle = next(each for each in world.scene.obstacles if each.name == name.strip("'"))
            assert not ArmWorld(world.robot, Scene([obstacle])).valid(row)
            named += 1
    assert named > 20


def test_a_cloud_of_so_many_points_that_they_are_sorted_along_a_curve_is_all_its_parts():
    rng = np.random.default_rng(7)
    points = rng.uniform((0.25, -0.5, 0.0), (0.8, 0.5, 0.9), (20_000, 3))
    points = points[np.linalg.norm(points - (0.5, 0.0, 0.5), axis=1) > 0.2]
    # The farthest decides by how much all are larger, for rounding: so it is in every part.
    farthest = points[np.linalg.norm(points, axis=1).argmax()]
    clouds = [PointCloud(np.vstack([part, farthest]), 0.002) for part in np.array_split(points, 3)]
    assert len(points) > 2**14 > len(clouds[0].points)
    world = ArmWorld(ur5(), Scene([PointCloud(points, 0.002)]))
    q = world.space.from_cube(np.random.default_rng(8).random((2_000, 6)))
    asked = np.concatenate([q, *edge(world, q, most=300, least=20)])
    parts = [ArmWorld(ur5(), Scene([cloud])).valid(asked) for cloud in clouds]
    np.testing.assert_array_equal(world.valid(asked), np.logical_and.reduce(parts))


def test_a_link_that_may_touch_the_first_sixteen_obstacles_does_not_pass_through_the_next():
    robot = ur5()
    far = [Obstacle.of(f"far {i}", "box", (0.1, 0.1, 0.1), (3.0, 0.0, 0.1 * i)) for i in range(16)]
    # Of so few obstacles as one wall each would be looked at alone.
    wall = [Obstacle.of(f"wall {i}", "box", (0.1, 2.0, 2.0), (0.45, 0.0, 0.5)) for i in range(12)]
    allowed = frozenset((link, each.name) for link in robot.links for each in far)
    reach = [Obstacle.of(each.name, "box", each.size, (0.0, 0.0, -0.7)) for each in far]
    q = robot.random(np.random.default_rng(0), 2000)
    alone = ArmWorld(robot, Scene((wall[0],))).valid(q)
    assert 0 < alone.sum() < len(q)
    np.testing.assert_array_equal(ArmWorld(robot, Scene((*reach, *wall), allowed=allowed)).valid(q), alone)


def test_what_is_removed_of_many_is_met_no_more():
    scene = small_ones(3, size=(0.02, 0.06))
    world = ArmWorld(ur5(), scene)
    q = world.space.from_cube(np.random.default_rng(6).random((3_000, 6)))
    left = [each for each in scene.obstacles if int(each.name.split()[1]) % 4]
    anew = ArmWorld(ur5(), Scene(left))
    expected = anew.valid(q)
    assert (expected & ~world.valid(q)).sum() > 20
    changed = world.without(*(each.name for each in scene.obstacles if not int(each.name.split()[1]) % 4))
    np.testing.assert_array_equal(changed.valid(q), expected)
