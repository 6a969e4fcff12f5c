"""The cell that all problems of arms share, and the free configurations in it."""

from __future__ import annotations

import numpy as np

from evenroad._arrays import Floats
from evenroad.robot import ArmWorld, Obstacle, Robot, Scene
from evenroad.robots.kinematics import link_poses


def cell_of(robot: Robot) -> Scene:
    """Return the cell that all problems share: the table that the robot stands on."""
    table = Obstacle.of("table", "box", (1.6, 1.6, 0.05), (0.3, 0.0, -0.03))
    bodied = [link for link in robot.links if any(capsule.link == link for capsule in robot.capsules)]
    return Scene((table,), name="table", allowed=frozenset((link, "table") for link in bodied[:2]))


def free_configurations(arm: Robot, cell: Scene, count: int, link: int) -> tuple[Floats, Floats]:
    """Return those of uniform configurations that are free of robot and cell, (n, dim), and where a link is, (n, 3)."""
    world = ArmWorld(arm, cell)
    q = world.space.from_cube(np.random.default_rng(0).random((count, world.space.dim)))
    q = q[world.valid(q)]
    # Some at a time: the poses of all links are much larger than those of one.
    return q, np.concatenate([link_poses(arm, part)[:, link, :3, 3] for part in np.array_split(q, 40)])
