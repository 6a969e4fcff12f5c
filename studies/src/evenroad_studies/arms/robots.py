"""The robots of the suite: two that ship with evenroad, one of them with and without its last joint, and two more."""

from __future__ import annotations

from functools import lru_cache, partial
from pathlib import Path

import numpy as np

from evenroad._checks import require_known
from evenroad.robot import Robot, load_robot, with_group, with_limits

DATA = Path(__file__).parent / "data"
TOOL = "tool0"
"""The link that goes to a place, where a robot has it; else the last one."""


@lru_cache
def arm_named(name: str) -> Robot:
    """Return a robot of the suite by its name."""
    require_known("robot of this suite", name, ARMS)
    return ARMS[name]()


def tool_of(robot: Robot) -> int:
    """Return which link is the tool."""
    return robot.links.index(TOOL) if TOOL in robot.links else len(robot.links) - 1


def _ur5(joints: int) -> Robot:
    """Return the UR5 as on a table: one turn, and the lift's range ends where the arm would go through it."""
    robot = load_robot("ur5")
    wide = dict.fromkeys(robot.group, (-np.pi, np.pi))
    robot = with_limits(robot, wide | {"shoulder_lift_joint": (-1.3 * np.pi, 0.3 * np.pi)})
    return with_group(robot, robot.group[:joints])


ARMS = {
    "ur5-5": partial(_ur5, 5),
    "ur5": partial(_ur5, 6),
    "arm7": partial(load_robot, "arm7"),
    "scara": partial(load_robot, DATA / "scara.urdf"),
    "twoarm": partial(load_robot, DATA / "twoarm.urdf"),
}
"""Name -> robot, of 5, 6, 7, 4 and 8 joints."""
