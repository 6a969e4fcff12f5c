"""Proofs by the first joints that there is no path: never where there is one."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.ndimage import label

from evenroad.geometry.shapes import Capsule
from evenroad.roadmap import Budget, find_path
from evenroad.robot import ArmWorld, Robot, Scene
from evenroad.robot.joint import Joint, Mimic
from evenroad.robot.locked import first_links, is_locked, locked_by, thinner
from evenroad.robot.scene import Obstacle
from evenroad.robot.trees import connect
from tests.robot.kernel_arms import STRAIGHT, Z, random_scene, random_tree, seven_joint_arm


def flat_arm(kind="revolute", joints=2, limit=3.0):
    """An arm in the plane: links of half a metre that turn about z."""
    links = ("base", *(f"link{i}" for i in range(joints)))
    ends = (-math.inf, math.inf) if kind == "continuous" else (-limit, limit)
    chain = tuple(
        Joint(
            f"joint{i}",
            kind if i == 0 else "revolute",
            links[i],
            links[i + 1],
            (0.5 * (i > 0), 0, 0),
            STRAIGHT,
            Z,
            *(ends if i == 0 else (-limit, limit)),
        )
        for i in range(joints)
    )
    capsules = tuple(Capsule((0.0, 0.0, 0.0), (0.5, 0.0, 0.0), 0.04, link=link) for link in links[1:])
    return Robot("flat", links, chain, capsules, (), tuple(joint.name for joint in chain))


def posts(*places, radius=0.05):
    return Scene(
        "posts",
        tuple(Obstacle.of(f"post{i}", "sphere", (radius,), (x, y, 0.0)) for i, (x, y) in enumerate(places)),
    )


def at(angle, distance):
    return distance * math.cos(angle), distance * math.sin(angle)


def free_places(world, rng, count):
    q = world.space.from_cube(rng.random((40 * count, world.space.dim)))
    return q[world.valid(q)][:count]


def in_scene(world):
    return lambda robot: replace(world, robot=robot).valid


def test_a_post_beside_the_upper_arm_locks_it():
    world = ArmWorld(flat_arm(), posts(at(1.0, 0.3)))
    a, b = np.array([0.0, 0.5]), np.array([2.0, 0.5])
    assert locked_by(in_scene(world), world.robot, a, b) == 2
    assert not world.may_connect(a, b)
    result = find_path(world, a, b, budget=Budget(motions=300_000))
    assert result.status == "not_connected"
    assert "proved" in result.message
    assert result.seconds["proof"] > 0.0


def test_a_post_that_only_the_forearm_meets_locks_nothing():
    world = ArmWorld(flat_arm(), posts(at(1.0, 0.8)))
    assert world.may_connect(np.array([0.0, 0.5]), np.array([2.0, 0.5]))


def test_a_joint_that_turns_on_goes_round_the_other_way():
    a, b = np.array([0.0, 0.5]), np.array([2.0, 0.5])
    one = ArmWorld(flat_arm("continuous"), posts(at(1.0, 0.3)))
    assert one.may_connect(a, b)
    assert find_path(one, a, b).solved
    for turn in np.linspace(-3.0, 3.0, 7):
        # Wherever the range happens to be cut.
        angles = 1.0 + turn, -1.0 + turn
        two = ArmWorld(flat_arm("continuous"), posts(*(at(angle, 0.3) for angle in angles)))
        start, goal = np.array([turn, 0.5]), np.array([2.0 + turn, 0.5])
        assert not two.may_connect(start, goal)
        assert two.may_connect(start, np.array([turn + 0.3, -0.5]))


@pytest.mark.parametrize("seed", range(6))
def test_what_is_proved_a_finer_flood_confirms(seed):
    rng = np.random.default_rng(seed)
    angles, distances = rng.uniform(-3.0, 3.0, 6), np.append(rng.uniform(0.2, 1.0, 5), 0.3)
    world = ArmWorld(flat_arm(), posts(*map(at, angles, distances), radius=0.03))
    count = 500
    middles = -3.0 + 6.0 * (np.arange(count) + 0.5) / count
    grid = np.stack(np.meshgrid(middles, middles, indexing="ij"), axis=-1)
    pieces, _ = label(world.valid(grid.reshape(-1, 2)).reshape(count, count), np.ones((3, 3)))
    ends = free_places(world, rng, 10)
    cells = np.clip(((ends + 3.0) / 6.0 * count).astype(int), 0, count - 1)
    ours = pieces[tuple(cells.T)]
    found = 0
    for i in range(len(ends)):
        for j in range(i):
            if locked_by(in_scene(world), world.robot, ends[i], ends[j]):
                assert ours[i] != ours[j]
                found += 1
    assert found > 0


def test_nothing_is_proved_of_places_that_a_path_joins():
    joined = 0
    for seed in range(8):
        robot = seven_joint_arm() if seed % 2 else random_tree(seed)
        world = ArmWorld(robot, random_scene(seed, count=8, clear=0.5))
        ends = free_places(world, np.random.default_rng(seed), 6)
        for a, b in pairwise(ends):
            if connect(world, a, b[np.newaxis], most_motions=5_000, seconds=20.0).goal < 0:
                continue
            joined += 1
            for joints in range(2, min(world.space.dim, 3) + 1):
                for reach in (np.inf, 0.5):
                    assert not is_locked(in_scene(world), robot, a, b, (reach,) * joints, 8_000)
    assert joined > 10


def test_what_a_later_joint_moves_is_gone_with_its_followers():
    robot = flat_arm(joints=3)
    finger = Joint(
        "finger", "revolute", "link0", "claw", (0.5, 0, 0), STRAIGHT, Z, -9.0, 9.0, mimic=Mimic("joint2", 2.0)
    )
    robot = replace(
        robot,
        links=(*robot.links, "claw"),
        joints=(*robot.joints, finger),
        capsules=(*robot.capsules, Capsule((0.0, 0.0, 0.0), (0.2, 0.0, 0.0), 0.03, link="claw")),
    )
    first = first_links(robot, 2)
    assert first.group == ("joint0", "joint1")
    assert [capsule.link for capsule in first.capsules] == ["link0", "link1"]


def test_joints_that_are_held_stay_where_they_are():
    robot = replace(flat_arm(joints=4), group=("joint1", "joint2", "joint3"), held={"joint0": 0.7})
    assert first_links(robot, 2).held["joint0"] == 0.7


def test_bodies_thinner_than_a_cell_moves_them_vanish_and_prove_nothing():
    robot = first_links(flat_arm(), 2)
    assert thinner(robot, np.array([1.0, 1.0])).capsules == ()
    world = ArmWorld(flat_arm(), posts(at(1.0, 0.3)))
    a, b = np.array([0.0, 0.5]), np.array([2.0, 0.5])
    assert not is_locked(in_scene(world), world.robot, a, b, (np.inf, np.inf), 4)


def test_where_a_thinner_body_touches_its_cell_is_blocked_throughout():
    """Every capsule of every place of the cell, not its spheres, touches what the thin one touches in the middle."""
    rng = np.random.default_rng(5)
    world = ArmWorld(flat_arm(), posts(at(1.0, 0.3), at(-1.5, 0.7), at(2.2, 0.9)))
    half = np.array([0.01, 0.02])
    thin = replace(world, robot=thinner(world.robot, half))
    middles = rng.uniform(-2.9, 2.9, (20_000, 2))
    middles = middles[~thin.valid(middles)]
    assert len(middles) > 500
    corners = middles[:, np.newaxis] + half * rng.uniform(-1.0, 1.0, (16, 2))
    elbow = 0.5 * np.stack([np.cos(corners[..., 0]), np.sin(corners[..., 0])], axis=-1)
    both = corners.sum(axis=-1)
    tip = elbow + 0.5 * np.stack([np.cos(both), np.sin(both)], axis=-1)
    gaps = np.full(corners.shape[:2], np.inf)
    for obstacle in world.scene.obstacles:
        centre = np.array(obstacle.body.pose.xyz[:2])
        for first, last in ((np.zeros(2), elbow), (elbow, tip)):
            along = np.clip(np.sum((centre - first) * (last - first), axis=-1) / 0.25, 0.0, 1.0)
            gap = np.linalg.norm(first + along[..., np.newaxis] * (last - first) - centre, axis=-1)
            gaps = np.minimum(gaps, gap - 0.04 - 0.05)
    assert gaps.max() < 0.0
