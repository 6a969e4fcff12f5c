"""A robot as the text of a URDF, for engines that read joints from nothing else."""

from __future__ import annotations

import math
from collections.abc import Mapping
from xml.sax.saxutils import quoteattr

import numpy as np

from evenroad.geometry.rotation import rotation_from_rpy
from evenroad.robots.robot import Robot


def as_urdf(robot: Robot, meshes: Mapping[str, str] | None = None) -> str:
    """Return a URDF of a robot's tree of links and joints.

    Mimics are written as independent joints, and every joint gets limits of +-1000: the caller sets all values.

    Parameters
    ----------
    robot : Robot
        Its capsules are left out.
    meshes : mapping of str to str, optional
        Link -> file of its mesh.
    """
    bodies = meshes or {}
    lines = [f"<robot name={quoteattr(robot.name)}>", '<klampt use_vis_geom="0"/>']
    if "world" not in robot.links:
        # Klamp't lets every robot fly whose root has another name.
        root = quoteattr(robot.links[0])
        lines += [
            '<link name="world"/>',
            '<joint name="fixed to the world" type="fixed"><parent link="world"/>',
        ]
        lines += [f"<child link={root}/></joint>"]
    for link in robot.links:
        body = ""
        if link in bodies:
            body = f'<collision><geometry><mesh filename="{bodies[link]}"/></geometry></collision>'
        lines.append(f"<link name={quoteattr(link)}>{body}</link>")
    for joint in robot.joints:
        # A continuous joint would have two coordinates in pinocchio.
        kind = joint.kind if joint.kind in ("prismatic", "fixed") else "revolute"
        lines += [
            f"<joint name={quoteattr(joint.name)} type={quoteattr(kind)}>",
            f"<parent link={quoteattr(joint.parent)}/><child link={quoteattr(joint.child)}/>",
            f'<origin xyz="{_numbers(joint.xyz)}" rpy="{_numbers(_rpy(joint.rotation))}"/>',
            f'<axis xyz="{_numbers(joint.axis)}"/><limit lower="-1e3" upper="1e3" velocity="1" effort="1"/>',
            "</joint>",
        ]
    return "\n".join([*lines, "</robot>"])


def _numbers(row: tuple[float, ...]) -> str:
    return " ".join(repr(float(number)) for number in row)


def _rpy(rotation: tuple[float, ...]) -> tuple[float, ...]:
    """Return roll, pitch and yaw of a rotation, (9,)."""
    r = np.reshape(rotation, (3, 3))
    pitch, yaw = math.atan2(-r[2, 0], math.hypot(r[0, 0], r[1, 0])), math.atan2(r[1, 0], r[0, 0])
    # From the remaining rotation, not from the last row: near pitch = +-90 degrees yaw is ill-conditioned, and
    # roll then compensates for it.
    remaining = np.reshape(rotation_from_rpy(0.0, pitch, yaw), (3, 3)).T @ r
    return math.atan2(remaining[2, 1], remaining[1, 1]), pitch, yaw
