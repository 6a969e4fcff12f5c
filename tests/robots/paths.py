"""Queries of arms, what trees find for them, and what is looked at along their paths."""

from itertools import pairwise

import numpy as np

from evenroad.collision.arm_world import ArmWorld
from evenroad.planning.arm_trees import connect
from evenroad.robots.variants import with_limits
from evenroad.space.path import resample
from tests.robots.kernel_arms import box_scene, random_scene, random_tree, seven_joint_arm, ur5
from tests.robots.oracle import motions_proved

START = np.array([0.0, -np.pi / 2, 0.0, -np.pi / 2, 0.0])
GOAL = np.array([-0.1216, -0.6993, 1.2160, -2.1070, 2.3023])
"""Of scene "c": the flange 25 cm deep in the box."""

ARMS = {
    "ur5": (ur5(np.pi), random_scene(5)),
    "seven joints": (seven_joint_arm(), random_scene(3)),
    "tree": (random_tree(8), random_scene(108, spread=0.7, clear=0.45)),
    "tree with a joint that wraps": (random_tree(13), random_scene(113, spread=0.7, clear=0.45)),
}


def box_world(inner=0.36):
    pi = np.pi
    bounds = [(-pi, pi), (-1.3 * pi, 0.3 * pi), (-pi, pi), (-pi, pi), (-pi, pi)]
    robot = ur5(joints=5)
    robot = with_limits(robot, dict(zip(robot.group, bounds, strict=True)))
    return ArmWorld(robot, box_scene(inner))


def length(world, path):
    return world.space.distance(path[:-1], path[1:]).sum()


def queries(world, count, seed=0):
    q = world.space.from_cube(np.random.default_rng(seed).random((200 * count, world.space.dim)))
    q = q[world.valid(q)][: 2 * count]
    return zip(q[0::2], q[1::2], strict=True)


def searched(world, count, least):
    """Paths of three waypoints or more that trees find, at least so many."""
    limits = {"most_motions": 5_000, "seconds": 30}
    found = [connect(world, a, [b], **limits).path for a, b in queries(world, count)]
    # Where the start sees the goal there is one motion: long ones are divided, and joints that turn on are wrapped.
    found = [world.space.wrapped(resample(path, world.space, 1.4)[0]) if len(path) == 2 else path for path in found]
    found = [path for path in found if len(path) > 2]
    assert len(found) >= least
    return found


def proved(world, *paths):
    """Whether the oracle proves every motion of paths."""
    starts, ways = (np.concatenate(each) for each in zip(*((p[:-1], np.diff(p, axis=0)) for p in paths), strict=True))
    wraps = np.isfinite(world.bounds[2])
    ways[:, wraps] -= np.rint(ways[:, wraps] / world.bounds[2][wraps]) * world.bounds[2][wraps]
    return motions_proved(world.robot, world.scene, starts, ways).all()


def dense_states(world, path, share=20):
    """States of a path at a share of the world's resolution, (n, dim)."""
    pieces = []
    for a, b in pairwise(path):
        count = int(np.ceil(world.space.distance(a[None], b[None])[0] / (world.resolution / share))) + 1
        t = np.linspace(0.0, 1.0, count)
        ends = np.broadcast_to(a, (count, len(a))), np.broadcast_to(b, (count, len(b)))
        pieces.append(world.space.interpolate(*ends, t))
    return np.concatenate(pieces)
