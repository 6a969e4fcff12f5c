"""Ends that are hard to reach in the scene of a day: configurations with a tip between obstacles, of no task."""

from __future__ import annotations

import itertools

import numpy as np

from evenroad._arrays import Floats
from evenroad.geometry.shapes import Capsule
from evenroad.robot import ArmWorld, Joint, Robot, Scene
from evenroad.robot_roadmap.chance import Surroundings
from evenroad.robot_roadmap.pockets import last_links, tips_of

AT_ONCE, POOLS = 40_000, 10
"""So many configurations are drawn at once, and so often at most, until enough are closed in; on tables and boxes too
few are."""

FEW_TIPS = 4
"""With more links that carry no other than this, fewer are drawn, in proportion: each is looked at by itself."""

CLOSED = 8
"""A tip is closed in where so many of fourteen ways are blocked, more than half.  Those closed in more are not
preferred: they lie in the corners of a place, where queries hardly go."""

FAR = 0.3
"""A place is closed in where one does not get so far from it, as a share of the reach."""

BALL = 0.01
"""Radius of what goes there [m]."""

STEP = 0.03
"""Of the ball's motions; nothing is proved here [m]."""

_AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
_WAYS = np.array(
    [way for way in itertools.product((-1.0, 0.0, 1.0), repeat=3) if np.abs(way).sum() in (1.0, 3.0)]
)
"""To the sides and corners of a cube."""


def ends_between_obstacles(world: ArmWorld, count: int, rng: np.random.Generator) -> Floats:
    """Return `count` free configurations, fewer where hardly any is free, whose tip is closed in by obstacles.

    They are drawn uniformly from all that are; where these are too few, the rest are those closed in next to that.
    """
    q, closed, far = np.empty((0, world.space.dim)), np.empty(0), 0.0
    most = POOLS * FEW_TIPS // max(FEW_TIPS, len(last_links(world.robot)))
    for _ in range(max(1, most)):
        more = world.space.from_cube(rng.random((AT_ONCE, world.space.dim)))
        more = more[world.valid(more)]
        if not len(more):
            continue
        far = far or FAR * Surroundings.of(world.robot, more).reach
        q, closed = np.concatenate([q, more]), np.concatenate([closed, _closed(world, more, far)])
        # Where none is, hardly any follows.
        if not 0 < np.count_nonzero(closed >= CLOSED) < count:
            break
    return q[np.argsort(-np.minimum(closed, CLOSED), kind="stable")[:count]]


def _closed(world: ArmWorld, q: Floats, far: float) -> Floats:
    """Return in how many directions a tip does not get far: (n,)."""
    closed = np.zeros(len(q))
    tips = tips_of(world.robot, q)
    for tip in range(tips.shape[1]):
        closed = np.maximum(closed, _closed_in(world.scene, tips[:, tip], far))
    return closed


def _closed_in(scene: Scene, places: Floats, far: float) -> Floats:
    """Return in how many directions a ball does not get far from places, (n, 3): (n,); 0 where there is no place."""
    around = places.min(axis=0) - 2.0 * far, places.max(axis=0) + 2.0 * far
    # Nothing that the scene says of its robot.
    ball = ArmWorld(_ball(*around), Scene(scene.name, scene.obstacles), STEP)
    blocked = np.zeros(len(places))
    for way in _WAYS:
        blocked += ~ball.motion_valid(places, places + far / np.linalg.norm(way) * way)
    return np.where(ball.valid(places), blocked, 0.0)


def _ball(low: Floats, high: Floats) -> Robot:
    """Return a ball that goes anywhere between two corners, (3,)."""
    links = ("here", *_AXES)
    identity = tuple(np.eye(3).ravel().tolist())
    joints = tuple(
        Joint(f"along {name}", "prismatic", links[i], name, (0.0, 0.0, 0.0), identity, axis, low[i], high[i])
        for i, (name, axis) in enumerate(_AXES.items())
    )
    body = Capsule((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), BALL, link="z")
    return Robot("ball", links, joints, (body,), (), tuple(each.name for each in joints))
