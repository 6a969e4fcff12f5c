"""Writing an SRDF to start from."""

from __future__ import annotations

import re
from dataclasses import replace
from xml.etree import ElementTree

from evenroad.loading.groups import chains
from evenroad.loading.model import RobotModel
from evenroad.loading.ready_posture import bent_posture, held_apart
from evenroad.robots.joint import Joint
from evenroad.robots.pairs import TOUCHING
from evenroad.robots.robot import pieces_of

_REASONS = {"neighbours": "Adjacent", TOUCHING: "Always", "fixed to each other": "Never moves"}
"""Why a pair is not tested, in MoveIt's words where it has such."""
_GRIPPER = re.compile("gripper|jaw|finger|claw", re.IGNORECASE)
"""Part of the name of a joint that opens a gripper."""


def srdf_text(model: RobotModel) -> str:
    """Return an SRDF of a robot: groups, named states, and the pairs that are not tested, each with the reason.

    Groups are the robot's chains without a branch, each named after the link at its end, and the group that the robot
    has where it is none of these.  A last joint whose name is a gripper's has a group of its own.  Every group has a
    state ``home``, at 0 or the nearest to it within limits, or near there where links would touch, and where one was
    found a state ``ready``, free and bent, beside the states that are known.  Read again with this file, the robot
    tests the same pairs, but for those that touched in every sample.
    """
    robot = model.robot
    root = ElementTree.Element("robot", name=robot.name)
    runs = chains(robot.joints)
    groups = {name: part for run in runs.values() for name, part in _without_gripper(run)}
    for name, joints in groups.items():
        group = ElementTree.SubElement(root, "group", name=name)
        ElementTree.SubElement(group, "chain", base_link=joints[0].parent, tip_link=joints[-1].child)
    names = {name: tuple(joint.name for joint in joints) for name, joints in groups.items()}
    if robot.group and set(robot.group) not in [{joint.name for joint in run} for run in runs.values()]:
        names["planned"] = robot.group
        group = ElementTree.SubElement(root, "group", name="planned")
        for joint in robot.group:
            ElementTree.SubElement(group, "joint", name=joint)
    neutral = {joint.name: joint.neutral for joint in robot.joints}
    neutral |= held_apart(replace(robot, group=(), held={}), pieces_of(robot), robot.pairs)
    ready = bent_posture(robot, pieces_of(robot), robot.pairs, neutral)
    for name, members in names.items():
        for state, values in ({"home": neutral, "ready": ready} | dict(robot.states)).items():
            if set(members) <= set(values):
                element = ElementTree.SubElement(root, "group_state", name=state, group=name)
                for joint in members:
                    ElementTree.SubElement(element, "joint", name=joint, value=repr(float(values[joint])))
    always = [(first, second, TOUCHING) for first, second in model.always_touching]
    for first, second, why in (*model.dropped, *always):
        reason = _REASONS.get(why, why)
        ElementTree.SubElement(root, "disable_collisions", link1=first, link2=second, reason=reason)
    ElementTree.indent(root)
    return '<?xml version="1.0"?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n"


def _without_gripper(run: list[Joint]) -> list[tuple[str, list[Joint]]]:
    """Return the chain, or the arm and the joint at its end that opens a gripper, each with its last link."""
    whole = (run[-1].child, run)
    opens = [_GRIPPER.search(joint.name) is not None for joint in run]
    # A finger of several joints stays one.
    if len(run) == 1 or not opens[-1] or any(opens[:-1]):
        return [whole]
    return [(run[-2].child, run[:-1]), (run[-1].child, run[-1:])]
