"""The probability that a configuration is free in an unknown scene: its share among random scenes."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from evenroad._arrays import Floats, Ints32
from evenroad._native.robot import Checker
from evenroad._native.robot import Scene as NativeScene
from evenroad._native.robot_roadmap import scenes_free
from evenroad._threads import in_order
from evenroad.robot import Robot
from evenroad.robot.kinematics import capsule_endpoints, link_poses
from evenroad.robot.obstacle import box_rows
from evenroad.robot.prepared_robots import prepared

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


AT_ONCE = 512
"""Number of configurations that a thread tests at once."""


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
    around = Surroundings.of(robot, q)
    # What is random is drawn first: the result is the same however many threads there are.
    drawn = [among(robot, box_rows(*random_boxes(around, rng), None)) for _ in range(scenes)]
    parts = np.array_split(q, -(-len(q) // AT_ONCE))
    free: list[Ints32] = []
    for counts in in_order(scenes_free, ((drawn, part) for part in parts)):
        free.append(counts)
        progress(len(free) / len(parts))
    shares: Floats = np.concatenate(free) / scenes
    return shares


def among(robot: Robot, boxes: Floats) -> Checker:
    """Return the checks of a robot among boxes, (n, 17), as :func:`evenroad.robot.obstacle.box_rows` gives them."""
    made = prepared(robot)
    tested = np.ones((len(made.tables.capsules), len(boxes)), dtype=np.bool_)
    return Checker(made.native, NativeScene(made.native, boxes, tested, [], None, 0.0), 1.0, 0.0, False)


def random_boxes(around: Surroundings, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Return extents and centres of random boxes within a reach, of sizes in proportion to it, (m, 3) each [m]."""
    least, small, large, most = HALF_EXTENTS
    typical, count = rng.uniform(np.log(small), np.log(large)), int(rng.integers(*BOXES))
    half = around.reach * np.clip(np.exp(rng.normal(typical, 0.5, (count, 3))), least, most)
    centres = rng.uniform(around.low, around.high, (count, 3))
    for _ in range(TRIES - 1):
        on_axis = np.hypot(*(centres - around.base)[:, :2].T) < CLEAR * around.reach
        if not on_axis.any():
            break
        centres[on_axis] = rng.uniform(around.low, around.high, (on_axis.sum(), 3))
    kept = np.cumsum(np.prod(2.0 * half, axis=1)) <= FULL * around.reach**3
    return 2.0 * half[kept], centres[kept]
