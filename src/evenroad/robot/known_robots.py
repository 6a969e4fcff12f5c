"""What is a robot's in every scene: the space of its group, and its tables; made once a robot."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from evenroad.errors import InvalidValue, UnknownName
from evenroad.robot.kernel.robot_tables import RobotTables, robot_tables
from evenroad.robot.robot import Robot
from evenroad.space import JointSpace


def joint_space(robot: Robot) -> JointSpace:
    """Return the space of a robot's group: ranges in radians and metres, continuous joints on [-pi, pi) wrap.

    Raises
    ------
    InvalidValue
        If the group is empty, names a joint twice, or holds a joint that is fixed, a mimic, or without range.
    UnknownName
        If it names a joint that is not there.
    """
    if not robot.group or len(set(robot.group)) < len(robot.group):
        raise InvalidValue(f"the group must name one joint or more, each once, got {robot.group!r}")
    joints = {joint.name: joint for joint in robot.joints}
    low, high, wrapping = [], [], []
    for name in robot.group:
        if name not in joints:
            raise UnknownName.among("joint", name, joints)
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


@dataclass(frozen=True, eq=False)
class _Known:
    """A robot as a key: by the values that its space and its tables are made of."""

    robot: Robot
    key: tuple[object, ...]

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Known) and self.key == other.key

    def __hash__(self) -> int:
        return hash(self.key)


class Prepared(NamedTuple):
    """What is a robot's in every scene.

    Attributes
    ----------
    space : JointSpace
        Of its group.
    longest : float
        An upper bound on the length of a motion.
    tables : RobotTables
        What compiled code knows of it.
    by_joint : float64 array
        As in ``LaneWorld``.
    """

    space: JointSpace
    longest: float
    tables: RobotTables
    by_joint: npt.NDArray[np.float64]


_recent: dict[int, tuple[Robot, dict[str, float], Prepared]] = {}
"""By identity, which costs less to look up than a key of a robot's values; a dictionary is the only part of a robot
that can change."""


def prepared(robot: Robot) -> Prepared:
    """Return what is a robot's in every scene; kept."""
    recent = _recent.get(id(robot))
    if recent is not None and recent[0] is robot and recent[1] == robot.held:
        return recent[2]
    values = (robot.name, robot.links, robot.joints, robot.capsules, robot.pairs, robot.group)
    known = _Known(robot, (*values, tuple(sorted(robot.held.items()))))
    try:
        found = _kept(known)
    except TypeError:
        # Of lists in place of tuples: no key.
        return _kept.__wrapped__(known)
    if len(_recent) >= 32:
        _recent.clear()
    _recent[id(robot)] = robot, dict(robot.held), found
    return found


@lru_cache(maxsize=32)
def _kept(known: _Known) -> Prepared:
    space = joint_space(known.robot)
    low, high, tables = np.array(space.low), np.array(space.high), robot_tables(known.robot)
    arms, pair_arms = (np.ravel(speeds.T) for speeds in (tables.speeds, tables.pair_speeds))
    by_joint = np.concatenate([low, high, space.flat.period, arms, pair_arms])
    by_joint.setflags(write=False)
    return Prepared(space, float(np.linalg.norm(high - low)), tables, by_joint)
