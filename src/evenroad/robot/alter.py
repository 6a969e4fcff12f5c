"""The same robot with other joints to plan for, or other limits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from evenroad.errors import InvalidValue, UnknownName
from evenroad.robot.limits import require_within
from evenroad.robot.mimic import within_limits_of_mimics
from evenroad.robot.robot import Robot
from evenroad.robot.scene import Scene


def with_group(robot: Robot, group: Sequence[str], held: Mapping[str, float] | None = None) -> Robot:
    """Return the robot with another group; the other movable joints are held at `held`, else at 0.

    Where 0 is outside of a joint's limits, it is held at the limit that is nearest.

    Raises
    ------
    UnknownName
        If a joint is not one that moves freely.
    InvalidValue
        If a joint is held that is in the group, or at a value that is outside its limits.
    """
    free = {joint.name: joint for joint in robot.joints if joint.kind != "fixed" and joint.mimic is None}
    held = dict(held or {})
    for name in (*group, *held):
        if name not in free:
            raise UnknownName.among("joint", name, free)
    for name, value in held.items():
        if name in group:
            raise InvalidValue(f"joint {name!r} is in the group: it is planned for and cannot be held")
        require_within(free[name], value, f"holding {robot.name!r}")
    return replace(robot, group=tuple(group), held=held)


def in_scene(robot: Robot, scene: Scene) -> Robot:
    """Return the robot with the scene's ranges to plan in, where they are narrower than its own limits.

    Half of what a joint of four pi can do is the other half once more: a narrower range makes every point of a
    set count for more.

    Raises
    ------
    UnknownName
        If the scene names a joint that the robot does not have.
    InvalidValue
        If no value is within both ranges.
    """
    joints = {joint.name: joint for joint in robot.joints}
    limits = {}
    for name, (lower, upper) in scene.limits.items():
        if name not in joints:
            raise UnknownName.among(f"joint in the limits of scene {scene.name!r}:", name, joints)
        limits[name] = (max(lower, joints[name].lower), min(upper, joints[name].upper))
    return with_limits(robot, limits)


def with_limits(robot: Robot, limits: Mapping[str, tuple[float, float]]) -> Robot:
    """Return the robot with other limits, joint -> (lower, upper) [rad or m].

    A continuous joint that gets limits becomes a revolute one; limits of a mimic narrow those of its leader.

    Raises
    ------
    UnknownName
        If a joint is not there.
    InvalidValue
        If lower is not below upper.
    """
    names = [joint.name for joint in robot.joints]
    for name, (lower, upper) in limits.items():
        if name not in names:
            raise UnknownName.among("joint", name, names)
        if not lower < upper:
            raise InvalidValue(
                f"limits of joint {name!r} must satisfy lower < upper, got {lower!r}, {upper!r}"
            )
    joints = tuple(
        replace(
            joint,
            kind="revolute" if joint.kind == "continuous" else joint.kind,
            lower=float(limits[joint.name][0]),
            upper=float(limits[joint.name][1]),
        )
        if joint.name in limits
        else joint
        for joint in robot.joints
    )
    # A leader goes no further than its mimics may.
    return replace(robot, joints=tuple(within_limits_of_mimics(joints)))
