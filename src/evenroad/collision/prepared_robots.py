"""The space and the tables of a robot, the same in every scene; made once per robot."""

from __future__ import annotations

import math
from dataclasses import fields
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from evenroad._arrays import Floats
from evenroad._checks import require_known
from evenroad._native.robot import Robot as NativeRobot
from evenroad.collision.native_robot import native_robot
from evenroad.collision.robot_tables import RobotTables, robot_tables
from evenroad.errors import InvalidValue
from evenroad.robots.robot import Robot
from evenroad.space import JointSpace


def joint_space(robot: Robot) -> JointSpace:
    """Return the space of a robot's group: ranges in radians and metres, continuous joints on [-pi, pi) wrap.

    Raises UnknownName if the group names a joint that is not there; InvalidValue if it is empty, names a joint twice,
    or holds a joint that is fixed, a mimic, or without range.
    """
    if not robot.group or len(set(robot.group)) < len(robot.group):
        raise InvalidValue(f"the group must name one joint or more, each once, got {robot.group!r}")
    joints = {joint.name: joint for joint in robot.joints}
    low, high, wrapping = [], [], []
    for name in robot.group:
        require_known("joint", name, joints)
        joint = joints[name]
        if joint.kind == "fixed" or joint.mimic is not None:
            raise InvalidValue(f"joint {name!r} is fixed or follows another: it cannot be planned for")
        turns_on = joint.kind == "continuous"
        bounds = (-math.pi, math.pi) if turns_on else (joint.lower, joint.upper)
        if not (math.isfinite(bounds[0]) and math.isfinite(bounds[1]) and bounds[0] < bounds[1]):
            raise InvalidValue(
                f"joint {name!r} must have limits, lower below upper, got {joint.lower!r}, {joint.upper!r}"
            )
        low.append(bounds[0])
        high.append(bounds[1])
        wrapping.append(turns_on)
    return JointSpace(low, high, wrapping)


class Prepared(NamedTuple):
    """Tables of a robot for every scene.

    `longest` bounds the length of a motion; `bounds`, (3, dim), are low, high and period of each joint; `native` is the
    robot of the native kernel.
    """

    space: JointSpace
    longest: float
    tables: RobotTables
    bounds: Floats
    native: NativeRobot


_recent: dict[int, tuple[Robot, dict[str, float], Prepared]] = {}
"""Cache by identity, which is faster than a key of a robot's values; a dictionary is the only part of a robot that can
change."""
_FIELDS = tuple(each.name for each in fields(Robot) if each.name not in ("states", "held"))


def prepared(robot: Robot) -> Prepared:
    """Return a robot's tables, cached."""
    recent = _recent.get(id(robot))
    if recent is not None and recent[0] is robot and recent[1] == robot.held:
        return recent[2]
    # What lies within the shapes matters where these decide.
    values = tuple(None if name == "inner" and not robot.shapes else getattr(robot, name) for name in _FIELDS)
    held = tuple(sorted(robot.held.items()))
    try:
        found = _kept(values, held)
    except TypeError:
        # Lists instead of tuples cannot be a key.
        return _kept.__wrapped__(values, held)
    if len(_recent) >= 128:
        _recent.clear()
    _recent[id(robot)] = robot, dict(robot.held), found
    return found


@lru_cache(maxsize=128)
def _kept(values: tuple[Any, ...], held: tuple[tuple[str, float], ...]) -> Prepared:
    robot = Robot(**dict(zip(_FIELDS, values, strict=True)), held=dict(held))
    space = joint_space(robot)
    low, high, tables = np.array(space.low), np.array(space.high), robot_tables(robot)
    bounds = np.stack([low, high, space.flat.period])
    bounds.setflags(write=False)
    return Prepared(space, float(np.linalg.norm(high - low)), tables, bounds, native_robot(robot, tables, bounds))
