"""Ends that are hard to reach in the scene of a day: configurations with a tip between obstacles, of no task."""

from __future__ import annotations

import itertools

import numpy as np

from evenroad._arrays import Floats
from evenroad.geometry.shapes import Capsule
from evenroad.robot import ArmWorld, Joint, Robot, Scene
from evenroad.robot_roadmap.chance import Surroundings
from evenroad.robot_roadmap.pockets import tips_of
from evenroad.robot_roadmap.turns import TURN

POOL = 40_000
"""Configurations that are drawn, of which the ends are those that are closed in most."""

FAR = 0.3
"""A place is closed in where one does not get so far from it, as a share of the reach."""

ROUNDS, BESIDE, AWAY = 2, 8, 1 / 16
"""So often, so many are drawn beside each of the best, away by a deviation of this share of a joint's range or turn."""

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
    """Return `count` free configurations, fewer where hardly any is free, whose tip is closed in most by obstacles."""
    q = world.space.from_cube(rng.random((POOL, world.space.dim)))
    q = q[world.valid(q)]
    if not len(q):
        return q
    reach = Surroundings.of(world.robot, q).reach
    closed = _closed(world, q, FAR * reach)
    low, high = np.array(world.space.low), np.array(world.space.high)
    away = AWAY * np.minimum(high - low, TURN)
    for _ in range(ROUNDS):
        best = np.argsort(-closed, kind="stable")[:count]
        q, closed = q[best], closed[best]
        more = np.repeat(q, BESIDE, axis=0)
        more = np.clip(more + rng.normal(0.0, 1.0, more.shape) * away, low, high)
        more = more[world.valid(more)]
        q, closed = np.concatenate([q, more]), np.concatenate([closed, _closed(world, more, FAR * reach)])
    return q[np.argsort(-closed, kind="stable")[:count]]


def _closed(world: ArmWorld, q: Floats, far: float) -> Floats:
    """Return in how many directions a tip does not get far: (n,)."""
    closed = np.zeros(len(q))
    if not len(q):
        return closed
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
