"""A robot with a tool fixed to one of its links: another robot, or shapes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from evenroad._checks import require_known
from evenroad.errors import InvalidValue, shown
from evenroad.geometry.fit import fit_capsules
from evenroad.geometry.hulls import piece_of
from evenroad.geometry.inner import inner_of
from evenroad.geometry.parts import parts_of
from evenroad.geometry.pose import Pose
from evenroad.geometry.shapes import Shape
from evenroad.robots.held import inner_of_both
from evenroad.robots.joint import Joint
from evenroad.robots.kinematics import held_values
from evenroad.robots.pairs import self_pairs
from evenroad.robots.robot import Robot, pieces_of


def with_tool(robot: Robot, tool: Robot | Sequence[Shape], at: str, pose: Pose, prefix: str) -> Robot:
    """Return what :meth:`Robot.with_tool` does."""
    require_known(f"link of {robot.name!r}:", at, robot.links)
    tool = (tool,) if isinstance(tool, Shape) else tool
    if not isinstance(tool, Robot):
        if not isinstance(tool, list | tuple) or not all(isinstance(each, Shape) for each in tool):
            raise InvalidValue(f"tool must be a Robot, as of load_robot, or shapes, got {shown(tool)}")
        shapes = [replace(shape, link="tool") for shape in tool]
        capsules = tuple(capsule for shape in shapes for capsule in fit_capsules(shape))
        hulls = tuple(piece_of(shape).hull for shape in shapes)
        more = dict(hulls=hulls, inner=inner_of(shapes), shapes=parts_of(shapes) if robot.shapes else ())
        tool = Robot("tool", ("tool",), (), capsules, (), (), **more)  # type: ignore[arg-type]
    if not tool.capsules:
        raise InvalidValue(f"tool {tool.name!r} must have a body: without one it would never collide")
    tool = replace(tool, group=(), states={})
    tool = _renamed(replace(tool, held=held_values(tool)), prefix)
    mount = Joint(f"{at}-{tool.links[0]}", "fixed", at, tool.links[0], pose.xyz, pose.rotation)
    joints = [joint.name for joint in robot.joints], [mount.name, *(joint.name for joint in tool.joints)]
    for what, ours, theirs in (("link", robot.links, tool.links), ("joint", *joints)):
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
        hulls=(*robot.hulls, *tool.hulls),
        resting=(*robot.resting, *tool.resting),
        inner=inner_of_both(robot.inner, robot.capsules, tool.inner, tool.capsules),
        shapes=(*robot.shapes, *tool.shapes) if robot.shapes else (),
        padding=(*robot.padding, *tool.padding),
    )
    between = tuple(
        pair
        for pair in self_pairs(joined, pieces_of(joined)).tested
        if (pair[0] in tool.links) != (pair[1] in tool.links)
    )
    return replace(joined, pairs=(*robot.pairs, *tool.pairs, *between))


def _renamed(robot: Robot, prefix: str) -> Robot:
    """Return a robot with `prefix` before the names of all links and joints."""
    joints = []
    for joint in robot.joints:
        mimic = joint.mimic and replace(joint.mimic, joint=prefix + joint.mimic.joint)
        name, parent, child = (prefix + each for each in (joint.name, joint.parent, joint.child))
        joints.append(replace(joint, name=name, parent=parent, child=child, mimic=mimic))
    return replace(
        robot,
        links=tuple(prefix + link for link in robot.links),
        joints=tuple(joints),
        capsules=tuple(replace(capsule, link=prefix + capsule.link) for capsule in robot.capsules),
        pairs=tuple((prefix + first, prefix + second) for first, second in robot.pairs),
        held={prefix + name: value for name, value in robot.held.items()},
        hulls=tuple(replace(hull, link=prefix + hull.link) for hull in robot.hulls),
        resting=tuple((prefix + first, prefix + second) for first, second in robot.resting),
        inner=robot.inner and tuple(replace(each, link=prefix + each.link) for each in robot.inner),
        shapes=tuple(replace(each, link=prefix + each.link) for each in robot.shapes),
        padding=tuple((prefix + link, metres) for link, metres in robot.padding),
    )
