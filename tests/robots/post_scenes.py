"""Flat arms among posts, of which one can see where they are locked."""

import math

from evenroad.geometry.shapes import Capsule
from evenroad.robot import Robot, Scene
from evenroad.robots.joint import Joint
from evenroad.scenes.scene import Obstacle
from tests.robots.kernel_arms import STRAIGHT, Z


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
        tuple(Obstacle.of(f"post{i}", "sphere", (radius,), (x, y, 0.0)) for i, (x, y) in enumerate(places)),
        name="posts",
    )


def at(angle, distance):
    return distance * math.cos(angle), distance * math.sin(angle)


def free_places(world, rng, count):
    q = world.space.from_cube(rng.random((40 * count, world.space.dim)))
    return q[world.valid(q)][:count]
