"""The probability that a configuration is free in an unknown scene: its share among random scenes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from evenroad._arrays import Floats
from evenroad._threads import in_order
from evenroad.robot import ArmWorld, Robot, Scene
from evenroad.robot.kinematics import capsule_endpoints, link_poses

BOXES = (3, 30)
"""Range of the number of boxes in a random scene, the last number not included."""

HALF_EXTENTS = (0.01, 0.03, 0.25, 0.5)
"""Half extents of boxes as shares of the reach: the least, the range of their typical size, and the largest."""

CLEAR = 0.25
"""Least distance of boxes from the axis of the base, as a share of the reach."""

FULL = 0.5
"""Largest volume of all boxes, as a share of the cube of the reach."""

TRIES = 100
"""Number of positions that are tried for a box: a robot that moves straight up has none away from its axis."""

SEEN = 2000
"""Number of configurations that the reach is measured on."""


class Surroundings(NamedTuple):
    """The reach of a robot: its base and two corners, (3,) each, and the largest distance from the base [m]."""

    base: Floats
    low: Floats
    high: Floats
    reach: float

    @classmethod
    def of(cls, robot: Robot, q: Floats) -> Surroundings:
        """Measure it on configurations, (n, dim)."""
        some = q[:SEEN]
        points = capsule_endpoints(robot, some).reshape(-1, 3)
        moved_first = next(i for i, joint in enumerate(robot.joints) if joint.name == robot.group[0])
        base = link_poses(robot, some[:1])[0, moved_first + 1, :3, 3]
        thick = max(capsule.radius for capsule in robot.capsules)
        low, high = points.min(axis=0) - thick, points.max(axis=0) + thick
        return cls(base, low, high, thick + float(np.max(np.linalg.norm(points - base, axis=1))))


def free_probability(
    robot: Robot,
    q: Floats,
    scenes: int,
    rng: np.random.Generator,
    progress: Callable[[float], None] = lambda _: None,
) -> Floats:
    """Return for each configuration, (n, dim), the share of random scenes in which no box touches it: (n,).

    The boxes stand anywhere within the robot's reach; they depend on no task.
    """
    bare, around = replace(robot, pairs=()), Surroundings.of(robot, q)
    free = np.zeros(len(q))
    drawn = ((ArmWorld(bare, random_scene(*around, rng)), q) for _ in range(scenes))
    for i, results in enumerate(in_order(ArmWorld.valid, drawn)):
        free += results
        progress((i + 1) / scenes)
    return free / scenes


def random_scene(base: Floats, low: Floats, high: Floats, reach: float, rng: np.random.Generator) -> Scene:
    """Return random boxes between two corners, (3,), of sizes in proportion to the reach [m]."""
    least, small, large, most = HALF_EXTENTS
    typical = rng.uniform(np.log(small), np.log(large))
    boxes: list[tuple[Floats, Floats]] = []
    volume = 0.0
    for _ in range(int(rng.integers(*BOXES))):
        half = reach * np.clip(np.exp(rng.normal(typical, 0.5, 3)), least, most)
        for _ in range(TRIES):
            centre = rng.uniform(low, high)
            if np.hypot(*(centre - base)[:2]) >= CLEAR * reach:
                break
        volume += float(np.prod(2.0 * half))
        if volume > FULL * reach**3:
            break
        boxes.append((2.0 * half, centre))
    return Scene.of_boxes(*np.array(boxes).reshape(-1, 2, 3).swapaxes(0, 1), name="random")
