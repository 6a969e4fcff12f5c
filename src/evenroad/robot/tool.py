"""Joining a tool to a robot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from evenroad.errors import InvalidValue, UnknownName
from evenroad.geometry.fit import fit_capsules
from evenroad.geometry.pose import IDENTITY, Pose
from evenroad.geometry.shapes import Shape
from evenroad.robot.joint import Joint
from evenroad.robot.kinematics import held_values
from evenroad.robot.pairs import computed_pairs
from evenroad.robot.robot import Robot


def with_tool(
    robot: Robot, tool: Robot | Sequence[Shape], at: str, *, pose: Pose = IDENTITY, prefix: str = ""
) -> Robot:
    """Return the robot with a tool fixed to one of its links.

    The group stays the robot's; the tool's joints are held where the tool has them, its group at 0 or the nearest to it
    within limits.  Pairs within the robot and within the tool stay; those between the two are computed as for a robot
    without an SRDF (neighbours and bodies fixed to each other are not tested).

    Parameters
    ----------
    robot : Robot
        The arm.
    tool : Robot, or sequence of Shape
        A gripper or another tool as a robot of its own; or its shapes in the frame of a new link ``tool``, to which
        capsules are fitted.
    at : str
        The link that carries it.
    pose : Pose
        Of the tool's root link in the frame of that link.
    prefix : str
        Put before the names of all of the tool's links and joints.

    Raises
    ------
    UnknownName
        If the robot has no such link.
    InvalidValue
        If the tool has no body, or a name in common with the robot.
    """
    if at not in robot.links:
        raise UnknownName.among(f"link of {robot.name!r}", at, robot.links)
    if not isinstance(tool, Robot):
        capsules = [capsule for shape in tool for capsule in fit_capsules(shape)]
        tool = Robot("tool", ("tool",), (), tuple(replace(c, link="tool") for c in capsules), (), ())
    if not tool.capsules:
        raise InvalidValue(f"tool {tool.name!r} must have a body: without one it would never collide")
    held = {name: joint.neutral for name in tool.group for joint in tool.joints if joint.name == name}
    tool = _renamed(replace(tool, group=(), held=held_values(tool) | held, states={}), prefix)
    mount = Joint(f"{at}-{tool.links[0]}", "fixed", at, tool.links[0], pose.xyz, pose.rotation)
    for what, ours, theirs in (
        ("link", robot.links, tool.links),
        (
            "joint",
            [joint.name for joint in robot.joints],
            [mount.name, *(joint.name for joint in tool.joints)],
        ),
    ):
        shared = sorted(set(ours) & set(theirs))
        if shared:
            raise InvalidValue(
                f"robot {robot.name!r} and its tool must differ in the names of their {what}s, both have"
                f" {', '.join(shared)}; prefix='tool_' renames those of the tool"
            )
    joined = replace(
        robot,
        name=f"{robot.name} with {tool.name}",
        links=(*robot.links, *tool.links),
        joints=(*robot.joints, mount, *tool.joints),
        capsules=(*robot.capsules, *tool.capsules),
        held={**robot.held, **tool.held},
    )
    between = tuple(
        pair for pair in computed_pairs(joined).tested if (pair[0] in tool.links) != (pair[1] in tool.links)
    )
    return replace(joined, pairs=(*robot.pairs, *tool.pairs, *between))


def _renamed(robot: Robot, prefix: str) -> Robot:
    """Return a robot with `prefix` before the names of all links and joints."""
    joints = tuple(
        replace(
            joint,
            name=prefix + joint.name,
            parent=prefix + joint.parent,
            child=prefix + joint.child,
            mimic=replace(joint.mimic, joint=prefix + joint.mimic.joint) if joint.mimic else None,
        )
        for joint in robot.joints
    )
    return replace(
        robot,
        links=tuple(prefix + link for link in robot.links),
        joints=joints,
        capsules=tuple(replace(capsule, link=prefix + capsule.link) for capsule in robot.capsules),
        pairs=tuple((prefix + first, prefix + second) for first, second in robot.pairs),
        held={prefix + name: value for name, value in robot.held.items()},
    )
