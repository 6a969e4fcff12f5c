"""Scans: clouds of points in which the robot has seen itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Bools, Floats
from evenroad._checks import require_positive
from evenroad.geometry.shapes import PointCloud
from evenroad.robot.kinematics import capsule_ends
from evenroad.robot.robot import Robot
from evenroad.robot.scene import MARGIN, Obstacle, Scene
from evenroad.robot.states import at_states, configuration


def without_robot(
    cloud: PointCloud, robot: Robot, q: npt.ArrayLike, margin: float = MARGIN
) -> PointCloud | None:
    """Return a cloud without the robot's own points, None where there are no others.

    Parameters
    ----------
    cloud : PointCloud
        In the frame of the robot's root link, by its pose.
    robot : Robot
        Who stands in it, with the joints that are not planned for where it holds them.
    q : array_like, shape (dim,)
        Where its group is [rad or m].
    margin : float
        Balls of the cloud that come within it of a capsule of the robot are the robot's, >= 0 [m].
    """
    margin = require_positive("margin", margin, or_zero=True)
    points = cloud.pose.apply(cloud.points)
    ends = capsule_ends(robot, np.asarray(q, dtype=np.float64)[np.newaxis])[0]
    own = np.zeros(len(points), dtype=np.bool_)
    for (a, b), capsule in zip(ends, robot.capsules, strict=True):
        own |= _within(points, a, b, capsule.radius + cloud.radius + margin)
    return None if own.all() else replace(cloud, points=cloud.points[~own])


def scene_seen_by(robot: Robot, scene: Scene) -> Scene:
    """Return a scene with clouds that say where the robot stood without its points; without a cloud of nothing else.

    Raises InvalidValue or UnknownName as :func:`evenroad.robot.configuration` where that is no configuration.
    """
    obstacles: list[Obstacle] = []
    for obstacle in scene.obstacles:
        if obstacle.seen is None or not isinstance(obstacle.body, PointCloud):
            obstacles.append(obstacle)
            continue
        standing = at_states(robot, [obstacle.seen.at], scene)
        q = configuration(standing, obstacle.seen.at, scene)
        body = without_robot(obstacle.body, standing, q, obstacle.seen.margin)
        if body is not None:
            obstacles.append(replace(obstacle, body=body, seen=None))
    gone = {obstacle.name for obstacle in scene.obstacles} - {obstacle.name for obstacle in obstacles}
    allowed = frozenset(pair for pair in scene.allowed if pair[1] not in gone)
    return replace(scene, obstacles=tuple(obstacles), allowed=allowed)


def _within(points: Floats, a: Floats, b: Floats, reach: float) -> Bools:
    """Return which points, (n, 3), are within `reach` of the segment from `a` to `b`: (n,)."""
    near = np.flatnonzero((np.abs(points - 0.5 * (a + b)) <= 0.5 * np.abs(b - a) + reach).all(axis=1))
    apart, along = points[near] - a, b - a
    share = np.clip(apart @ along / max(float(along @ along), 1e-300), 0.0, 1.0)
    within = np.zeros(len(points), dtype=np.bool_)
    within[near] = ((apart - share[:, np.newaxis] * along) ** 2).sum(axis=1) <= reach**2
    return within
