"""Writing an SRDF: what is known of a robot, as a file to be edited."""

from __future__ import annotations

from xml.etree import ElementTree

from evenroad.robot.joint import Joint
from evenroad.robot.pairs import TOUCHING
from evenroad.robot.robot import Robot, RobotModel

_REASONS = {"neighbours": "Adjacent", TOUCHING: "Always", "fixed to each other": "Never moves"}
"""Why a pair is not tested, in MoveIt's words where it has such."""


def srdf_text(model: RobotModel) -> str:
    """Return an SRDF of a robot: groups, named states, and the pairs that are not tested, each with the reason.

    Groups are the robot's chains without a branch, each named after the link at its end, and the group that the robot
    has where it is none of these.  Every group has a state ``home``, at 0 or the nearest to it within limits, beside
    the states that are known.  Read again with this file, the robot tests the same pairs.
    """
    robot = model.robot
    root = ElementTree.Element("robot", name=robot.name)
    groups = chains(robot)
    for name, joints in groups.items():
        group = ElementTree.SubElement(root, "group", name=name)
        ElementTree.SubElement(group, "chain", base_link=joints[0].parent, tip_link=joints[-1].child)
    names = {name: tuple(joint.name for joint in joints) for name, joints in groups.items()}
    if robot.group and robot.group not in names.values():
        names["planned"] = robot.group
        group = ElementTree.SubElement(root, "group", name="planned")
        for joint in robot.group:
            ElementTree.SubElement(group, "joint", name=joint)
    neutral = {joint.name: joint.neutral for joint in robot.joints}
    for name, members in names.items():
        for state, values in ({"home": neutral} | dict(robot.states)).items():
            if set(members) <= set(values):
                element = ElementTree.SubElement(root, "group_state", name=state, group=name)
                for joint in members:
                    ElementTree.SubElement(element, "joint", name=joint, value=repr(float(values[joint])))
    for first, second, why in model.dropped:
        reason = _REASONS.get(why, why)
        ElementTree.SubElement(root, "disable_collisions", link1=first, link2=second, reason=reason)
    ElementTree.indent(root)
    return '<?xml version="1.0"?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n"


def chains(robot: Robot) -> dict[str, list[Joint]]:
    """Return the runs of joints that move by themselves, one after the other without a branch, by their last link.

    A joint that others mimic is that of a gripper, and begins a run.
    """
    free = {
        joint.child: joint
        for joint in robot.joints
        if joint.kind != "fixed" and joint.mimic is None and joint.lower < joint.upper
    }
    parent = {joint.child: joint.parent for joint in robot.joints}
    followers: dict[str | None, list[Joint]] = {}
    for joint in free.values():
        above: str | None = joint.parent
        while above is not None and above not in free:
            above = parent.get(above)
        followers.setdefault(above, []).append(joint)
    leaders = {joint.mimic.joint for joint in robot.joints if joint.mimic is not None}
    following = {
        many[0].name: above
        for above, many in followers.items()
        if above is not None and len(many) == 1 and many[0].name not in leaders
    }
    runs: dict[str, list[Joint]] = {}
    for joint in free.values():
        # Every joint comes after the one that it follows.
        above = following.get(joint.name)
        run = [] if above is None else runs.pop(above)
        runs[joint.child] = [*run, joint]
    return runs
