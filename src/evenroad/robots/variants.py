"""Robots made from another one: with another group of joints, or with other limits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from evenroad._arrays import Floats
from evenroad._checks import require_known
from evenroad.errors import InvalidValue
from evenroad.robots.joint import Joint, require_within, within_limits_of_mimics
from evenroad.robots.kinematics import held_values
from evenroad.robots.robot import Robot, require_robot


def with_group(robot: Robot, group: Sequence[str], held: Mapping[str, float] | None = None) -> Robot:
    """Return the robot with another group; the other movable joints are held at `held`, else at 0 or nearest to it.

    Raises UnknownName if a joint is not one that moves freely; InvalidValue if one is held that is in the group, or
    outside its limits.
    """
    require_robot(robot)
    free = {joint.name: joint for joint in robot.joints if joint.kind != "fixed" and joint.mimic is None}
    held = dict(held or {})
    for name in (*group, *held):
        require_known("joint", name, free)
    for name, value in held.items():
        if name in group:
            raise InvalidValue(f"joint {name!r} is in the group: it is planned for and cannot be held")
        require_within(free[name], value, f"holding {robot.name!r}")
    changed = replace(robot, group=tuple(group), held=held)
    if robot.resting and (changed.group, held_values(changed)) != (robot.group, held_values(robot)):
        return replace(changed, pairs=(*robot.pairs, *robot.resting), resting=())
    return changed


def with_limits(robot: Robot, limits: Mapping[str, tuple[float, float]]) -> Robot:
    """Return the robot with other limits, joint -> (lower, upper) [rad or m].

    A continuous joint that gets limits becomes a revolute one; limits of a mimic narrow those of its leader.  These are
    hard limits, also where the robot's file has soft ones.  Raises UnknownName if a joint is not there; InvalidValue if
    lower is not below upper.
    """
    require_robot(robot)
    names = [joint.name for joint in robot.joints]
    for name, (lower, upper) in limits.items():
        require_known("joint", name, names)
        if not lower < upper:
            raise InvalidValue(f"limits of joint {name!r} must satisfy lower < upper, got {lower!r}, {upper!r}")
    joints = list(robot.joints)
    for i, joint in enumerate(joints):
        if joint.name in limits:
            lower, upper = map(float, limits[joint.name])
            turns = joint.kind == "continuous"
            joints[i] = replace(joint, kind="revolute" if turns else joint.kind, lower=lower, upper=upper, hard=None)
    return replace(robot, joints=tuple(within_limits_of_mimics(joints)))


def standing_at(robot: Robot, q: Floats) -> Robot:
    """Return the robot with its soft limits as wide as where it stands, (dim,), itself where it stands within them."""
    if not robot.has_soft_limits:
        return robot
    values = dict(zip(robot.group, q.tolist(), strict=True))
    joints = tuple(_reaching(joint, values.get(joint.name, joint.neutral)) for joint in robot.joints)
    return robot if joints == robot.joints else replace(robot, joints=joints)


def _reaching(joint: Joint, value: float) -> Joint:
    """Return a joint that can be at a value within its hard limits."""
    if joint.hard is None or not joint.hard[0] <= value <= joint.hard[1]:
        return joint
    return replace(joint, lower=min(joint.lower, value), upper=max(joint.upper, value))
