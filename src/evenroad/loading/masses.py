"""Masses of the links of a robot, and torques of its joints, from its file."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from evenroad._understood import require_understood
from evenroad.errors import BrokenFile
from evenroad.geometry.pose import Pose
from evenroad.loading.robot_file import RobotFile
from evenroad.loading.urdf_kinds import ROBOT
from evenroad.loading.urdf_xml import read_robot_xml


@dataclass(frozen=True)
class Mass:
    """A mass on a link: its centre in the link's frame [m], and its inertia about that along the link's axes, row by
    row [kg m^2].
    """

    link: str
    mass: float
    centre: tuple[float, float, float] = (0.0, 0.0, 0.0)
    inertia: tuple[float, ...] = (0.0,) * 9


def read_masses(path: Path) -> tuple[tuple[Mass, ...], dict[str, float]]:
    """Return the masses of the links of a URDF or xacro, and the efforts of its joints, by name, where it gives them.

    Raises BrokenFile if it cannot be read, or a number is none, or below 0.
    """
    root = read_robot_xml(RobotFile(path))
    # Unknown names are noted when the robot is loaded; here only a misspelt one matters.
    require_understood(root, ROBOT, str(path), [])
    found = [(str(link.get("name")), link.find("inertial")) for link in root.findall("link")]
    masses = tuple(_mass_of(link, inertial, path) for link, inertial in found if inertial is not None)
    efforts = {}
    for joint in root.findall("joint"):
        limit, name = joint.find("limit"), str(joint.get("name"))
        if limit is not None:
            efforts[name] = _numbers(limit.get("effort", "0"), 1, f"effort of {name!r} in {path}")[0]
            if efforts[name] < 0.0:
                raise BrokenFile(f"effort of {name!r} in {path} must be >= 0, got {efforts[name]:g}")
    return masses, efforts


def _mass_of(link: str, inertial: Element, path: Path) -> Mass:
    """Return the mass that an ``<inertial>`` gives a link."""
    where = f"of link {link!r} in {path}"
    mass, origin, inertia = (inertial.find(tag) for tag in ("mass", "origin", "inertia"))
    kilograms = _numbers("0" if mass is None else mass.get("value", ""), 1, f"mass {where}")[0]
    moments = {} if inertia is None else inertia.attrib
    xx, xy, xz, yy, yz, zz = (
        _numbers(moments.get(f"i{name}", "0"), 1, f"i{name} {where}")[0]
        for name in ("xx", "xy", "xz", "yy", "yz", "zz")
    )
    if min(kilograms, xx, yy, zz) < 0.0:
        raise BrokenFile(f"the mass and moments {where} must be >= 0")
    at = {} if origin is None else origin.attrib
    xyz = _numbers(at.get("xyz", "0 0 0"), 3, f"origin of the mass {where}")
    if "quat_xyzw" in at:
        turned = Pose.from_quaternion((0, 0, 0), xyzw=_numbers(at["quat_xyzw"], 4, f"quaternion of the mass {where}"))
    else:
        turned = Pose(rpy=tuple(_numbers(at.get("rpy", "0 0 0"), 3, f"rotation of the mass {where}")))
    turn = turned.rotation_matrix
    about = turn @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ turn.T
    return Mass(link, kilograms, (xyz[0], xyz[1], xyz[2]), tuple(about.ravel().tolist()))


def _numbers(text: str, count: int, what: str) -> list[float]:
    """Return the finite numbers of a text, `count` of them; BrokenFile for any other text."""
    try:
        numbers = [float(part) for part in text.split()]
    except ValueError:
        numbers = []
    if len(numbers) != count or not all(map(math.isfinite, numbers)):
        raise BrokenFile(f"{what} must be {count} finite number(s), got {text!r}")
    return numbers
