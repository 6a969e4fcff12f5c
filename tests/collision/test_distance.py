"""Distances of arms, against slow oracles in double precision: of capsules, of points and triangles, of true shapes."""

from dataclasses import replace

import numpy as np
import pytest

from evenroad.collision.arm_world import ArmWorld
from evenroad.errors import InvalidValue, UnknownName
from evenroad.geometry import Box, Sphere
from evenroad.loading.urdf import read_urdf
from evenroad.robot import load_robot
from evenroad.scenes.scene import Scene
from evenroad.space.path import resample
from tests.refused import refused
from tests.robots.kernel_arms import edge, random_scene, random_tree, seven_joint_arm, ur5
from tests.robots.mesh_arms import write_fork_arm
from tests.robots.oracle import clearance
from tests.robots.shape_oracle import shape_clearance
from tests.robots.surface_oracle import all_clearance
from tests.robots.surface_scenes import all_sorts, cloud_scene, scene_of

BAND = 1.2e-5
"""By so much a distance may be too small [m]: single precision costs some micrometres."""

ARMS = {
    "ur5 among every shape": (ur5(), random_scene(5)),
    "seven joints among every shape": (seven_joint_arm(), random_scene(3)),
    "ur5 far from all": (replace(ur5(), pairs=()), Scene([Sphere(0.1, xyz=(1.6, 0, 0.3), name="ball")])),
} | {f"tree {seed}": (random_tree(seed), random_scene(100 + seed, spread=0.7, clear=0.45)) for seed in (0, 5, 12)}


def near_contact(world, count=400):
    """Random configurations, and such next to contact on both sides."""
    q = world.space.from_cube(np.random.default_rng(1).random((count, world.space.dim)))
    if world.valid(q).all():
        return q
    return np.concatenate([q, *edge(world, world.space.from_cube(np.random.default_rng(2).random((4000, q.shape[1]))))])


def agree(world, q, apart):
    """See that distances are those of an oracle, 0 to 1 m, never larger and hardly smaller."""
    metres = world.distance(q).metres
    wanted = np.clip(apart, 0.0, 1.0)
    assert (metres <= wanted).all()
    assert (metres >= wanted - BAND).all()
    assert (metres[~world.valid(q)] == 0.0).all()


@pytest.mark.parametrize("arm", ARMS)
def test_distances_of_capsules_are_the_oracles(arm):
    robot, scene = ARMS[arm]
    world = ArmWorld(robot, scene)
    q = near_contact(world)
    agree(world, q, clearance(robot, scene, q))
    # The world's own clearance changes nothing.
    far = ArmWorld(robot, scene, clearance=0.03)
    np.testing.assert_array_equal(far.distance(q).metres, world.distance(q).metres)


def test_distances_from_points_and_triangles_are_the_oracles():
    robot = replace(ur5(), pairs=())
    for scene in (cloud_scene(3, 200), scene_of(all_sorts(2))):
        # What no joint moves does not count.
        scene = replace(scene, allowed=frozenset(("base", each.name) for each in scene.obstacles))
        world = ArmWorld(robot, scene)
        q = near_contact(world, 60)[:150]
        agree(world, q, all_clearance(robot, scene, q))


def test_distances_of_true_shapes_are_the_oracles(tmp_path):
    robot = replace(load_robot(write_fork_arm(tmp_path), bodies="shapes"), pairs=())
    # Prisms stand for cylinders in the oracle, the kernel plans with spheres around the round link, and what no joint
    # moves does not count.
    shapes = [shape for shape in read_urdf(tmp_path / "arm.urdf").shapes if shape.link not in ("nose", "base")]
    scene = Scene([each for each in random_scene(4, 8, spread=0.6).obstacles if each.shape != "cylinder"])
    allowed = {(link, each.name) for link in ("nose", "base") for each in scene.obstacles}
    scene = replace(scene, allowed=frozenset(allowed))
    world = ArmWorld(robot, scene)
    q = near_contact(world, 60)[:150]
    agree(world, q, shape_clearance(robot, shapes, scene, q))


def test_distances_of_hulls_end_where_hulls_touch(tmp_path):
    robot = load_robot(write_fork_arm(tmp_path))
    world = ArmWorld(robot)
    apart, touching = edge(world, world.space.from_cube(np.random.default_rng(3).random((4000, world.dim))))
    np.testing.assert_allclose(world.distance(apart).metres, 0.0, atol=1e-4)
    np.testing.assert_array_equal(world.distance(touching).metres, 0.0)


def test_the_pair_is_the_one_that_is_nearest():
    robot, scene = ur5(), random_scene(5)
    world = ArmWorld(robot, scene)
    q = world.space.from_cube(np.random.default_rng(4).random((60, 6)))
    metres, pairs = world.distance(q)
    for row, (first, second) in enumerate(pairs):
        if second in robot.links:
            without = ArmWorld(replace(robot, pairs=tuple(p for p in robot.pairs if set(p) != {first, second})), scene)
        else:
            without = ArmWorld(robot, replace(scene, allowed=frozenset({(first, second)})))
        farther = without.distance(q[row])
        assert farther.pair != (first, second)
        assert farther.metres >= metres[row]
    assert {second in robot.links for _, second in pairs} == {True, False}


@pytest.mark.parametrize("seed", range(4))
def test_the_pair_that_is_nearest_along_a_path_is_the_oracles(seed):
    robot, scene = replace(ur5(), pairs=()), random_scene(5)
    world = ArmWorld(ur5(), scene)
    rng = np.random.default_rng(seed)
    drawn = world.space.from_cube(rng.random((400, 6)))
    path = drawn[ArmWorld(robot, scene).distance(drawn).metres.argmax()] + 0.05 * rng.normal(size=(4, 6)).cumsum(axis=0)
    least = {}
    for link in robot.links:
        alone = replace(robot, capsules=tuple(each for each in robot.capsules if each.link == link))
        for each in scene.obstacles:
            among = replace(scene, obstacles=(each,))
            least[link, each.name] = clearance(alone, among, resample(path, world.space, 1e-3)[0]).min()
    found = world.nearest_along(path)
    assert 0.0 < least[found] < min(of for (link, _), of in least.items() if link != robot.links[0]) + 1e-4
    assert ArmWorld(robot, scene).path_clearance(path) == pytest.approx(least[found], abs=2e-4)


def test_one_configuration_has_one_distance_and_a_batch_has_many():
    world = ArmWorld("ur5", "box-reach")
    home = world.distance("home")
    many = world.distance(np.stack([world._row("home"), world._row("inside")]))
    assert (home.metres, home.pair) == (many.metres[0], many.pair[0])
    assert many.pair[1] == world.distance("inside").pair
    alone = ArmWorld(replace(ur5(), pairs=()), Scene([Box((0.1, 0.1, 0.1), xyz=(9, 9, 9))]))
    assert alone.distance([0.0] * 6) == (1.0, None)
    refused(InvalidValue, "q must be 6 finite numbers", world.distance, [0.0])
    refused(InvalidValue, r"q must have shape \(n, 6\)", world.distance, [[0.0]])
    refused(InvalidValue, r"row 1: joint 'elbow_joint' is at 9", world.distance, [[0.0] * 6, [0, 0, 9, 0, 0, 0]])
    refused(UnknownName, "unknown state", world.distance, "nowhere")
