"""Limits: velocities, accelerations and jerks of joints, from a robot or MoveIt's joint_limits.yaml."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from evenroad._arrays import Floats
from evenroad._checks import as_row, require_known, require_positive
from evenroad._native.trajectory import TipLimits as NativeTip
from evenroad._native.trajectory import TorqueLimits, further_shares
from evenroad._shared import once_property
from evenroad._yaml import read_mapping
from evenroad.errors import BrokenFile, InvalidValue, NotAvailable
from evenroad.robot import Robot
from evenroad.robot.prepared_robots import prepared
from evenroad.trajectory.dynamics import Dynamics, native_links

SECONDS_TO_FULL_SPEED = 0.5
"""Default time from rest to full speed [s]: URDF has no acceleration."""

_KINDS = ("velocity", "acceleration", "jerk")


@dataclass(frozen=True)
class TipLimits:
    """Largest speed and acceleration of a robot's link, of the origin of its frame.

    Attributes
    ----------
    robot : Robot
    link : str
    speed : float
        > 0 [m/s]; infinite: no limit.
    acceleration : float
        > 0 [m/s^2]; infinite: no limit.
    """

    robot: Robot
    link: str
    speed: float = math.inf
    acceleration: float = math.inf

    def __post_init__(self) -> None:
        for kind in ("speed", "acceleration"):
            if (most := getattr(self, kind)) != math.inf:
                require_positive(f"the tip's {kind}", most)

    @once_property
    def native(self) -> NativeTip:
        """The limits of the native kernel; InvalidValue if no joint moves the link."""
        links = prepared(self.robot).tables.tree.links
        require_known(f"link of {self.robot.name!r}:", self.link, links)
        fixed = links[self.link]
        if fixed.frame == 0:
            raise InvalidValue(f"no joint of the group, {','.join(self.robot.group)}, moves the link {self.link!r}")
        moving, dim = native_links(self.robot), len(self.robot.group)
        return NativeTip(moving, dim, fixed.frame - 1, fixed.translation, self.speed, self.acceleration)

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in self.__dict__.items() if name != "native"}


@dataclass(frozen=True)
class Limits:
    """Limits of each joint, in both directions.

    Attributes
    ----------
    velocity, acceleration : tuples of float
        > 0, one per joint [rad/s, rad/s^2; m for prismatic ones].
    jerk : tuple of float or None
        > 0, one per joint [rad/s^3]; None: no limit.
    along_path : float or None
        Largest speed of all coordinates together, as of a vehicle, > 0 [m/s]; None: no limit.
    tip : TipLimits or None
        Largest speed and acceleration of a link; None: no limit.  A share of full speed leaves them as they are.
    torque : Dynamics or None
        Masses of the links and efforts of the joints; None: no limit of torque.  A share of full speed leaves it as it
        is.
    """

    velocity: tuple[float, ...]
    acceleration: tuple[float, ...]
    jerk: tuple[float, ...] | None = None
    along_path: float | None = None
    tip: TipLimits | None = None
    torque: Dynamics | None = None

    def __post_init__(self) -> None:
        for kind in _KINDS:
            values = getattr(self, kind)
            if kind == "jerk" and values is None:
                continue
            row = as_row(kind, values, None if kind == "velocity" else len(self.velocity))
            if min(row) <= 0.0:
                raise InvalidValue(f"{kind} must be > 0 for every joint, got {values!r}")
            object.__setattr__(self, kind, row)
        if self.along_path is not None:
            require_positive("along_path", self.along_path)

    def at_speed(self, speed: float) -> Limits:
        """Return the limits at a share of full speed, 0 < speed <= 1."""
        if require_positive("speed", speed) > 1.0:
            raise InvalidValue(f"speed must be at most 1, the robot's own limits, got {speed!r}")
        if speed == 1.0:
            return self

        def scaled(row: tuple[float, ...], power: int) -> tuple[float, ...]:
            return tuple(value * speed**power for value in row)

        jerk = None if self.jerk is None else scaled(self.jerk, 3)
        along = None if self.along_path is None else self.along_path * speed
        return replace(
            self,
            velocity=scaled(self.velocity, 1),
            acceleration=scaled(self.acceleration, 2),
            jerk=jerk,
            along_path=along,
        )

    @property
    def is_plain(self) -> bool:
        """Whether there are limits of joints and of the speed along the path alone."""
        return self.torque is None and self.tip is None

    @property
    def further(self) -> tuple[TorqueLimits | None, NativeTip | None]:
        """Limits beside those of joints, of torques and of a tip, as the native kernel takes them."""
        return (
            None if self.torque is None else self.torque.native,
            None if self.tip is None else self.tip.native,
        )

    def too_heavy(self, q: Floats) -> NotAvailable:
        """Return the error of a path, (n, dim), along which torques cannot hold the robot, or hardly."""
        assert self.torque is not None, "only torques are needed at rest"
        still = np.zeros_like(q)
        shares = np.abs(self.torque.torques(q, still, still)) / np.array(self.torque.efforts)
        row, joint = np.unravel_index(int(shares.argmax()), shares.shape)
        name, effort = self.torque.robot.group[joint], self.torque.efforts[joint]
        return NotAvailable(
            f"joint {name!r} needs {shares[row, joint] * effort:.4g} N m to hold the robot still on the path, of"
            f" {effort:.4g}: there is too little left to move"
        )

    def further_shares(self, q: Floats, velocity: Floats, acceleration: Floats) -> dict[str, float]:
        """Return the largest shares of such limits, by kind, at states, (n, dim) each."""
        return named_shares(further_shares(self.further, q, velocity, acceleration))


def named_shares(used: tuple[float, float, float]) -> dict[str, float]:
    """Return shares of torque and of a tip's speed and acceleration by their names, without those that are 0."""
    kinds = dict(zip(("torque", "tip speed", "tip acceleration"), used, strict=True))
    return {kind: share for kind, share in kinds.items() if share > 0.0}


def limits_of(robot: Robot, file: str | os.PathLike[str] | None = None) -> Limits:
    """Return the limits of the planned joints.

    Parameters
    ----------
    robot : Robot
        Its joints have the velocities of the URDF.
    file : str or path-like, optional
        MoveIt's ``joint_limits.yaml``; its ``max_velocity``, ``max_acceleration`` and ``max_jerk`` come first.  A joint
        without an acceleration reaches full speed in 0.5 s; jerk is limited if it is given for every joint.

    Raises
    ------
    BrokenFile, UnknownName
        If the file cannot be read, or names an unknown joint or key.
    InvalidValue
        If a limit is not > 0, or a joint has no velocity anywhere.
    """
    by_name = {joint.name: joint for joint in robot.joints}
    given = {} if file is None else _read(Path(file), set(by_name))
    velocity, acceleration, jerk = [], [], []
    for name in robot.group:
        said = given.get(name, {})
        fastest = said.get("velocity", by_name[name].velocity)
        if not 0.0 < fastest < math.inf:
            raise InvalidValue(
                f"joint {name!r} of {robot.name!r} has no velocity limit: give it a max_velocity > 0 in a"
                " joint_limits.yaml"
            )
        velocity.append(fastest)
        acceleration.append(said.get("acceleration", fastest / SECONDS_TO_FULL_SPEED))
        jerk.append(said.get("jerk", math.inf))
    return Limits(tuple(velocity), tuple(acceleration), tuple(jerk) if max(jerk) < math.inf else None)


def _read(path: Path, joints: set[str]) -> dict[str, dict[str, float]]:
    """Return joint -> kind of limit -> value of a file, without those that it switches off."""
    document = read_mapping(path, "joint_limits file")
    table = document.get("joint_limits")
    if not isinstance(table, dict):
        raise BrokenFile(f"{path} must have a mapping 'joint_limits', joint -> limits")
    limits = {}
    for name, row in table.items():
        require_known(f"joint in {path}:", name, joints)
        if not isinstance(row, dict):
            raise BrokenFile(f"joint_limits of {name!r} in {path} must be a mapping, got {row!r}")
        limits[str(name)] = _limits_of_joint(row, f"{name} in {path}")
    return limits


def _limits_of_joint(row: dict[Any, Any], where: str) -> dict[str, float]:
    known = {f"max_{kind}" for kind in _KINDS} | {f"has_{kind}_limits" for kind in _KINDS}
    known |= {"has_position_limits", "min_position", "max_position"}
    for key in row:
        require_known(f"limit of {where}:", key, known)
    return {
        kind: require_positive(f"max_{kind} of {where}", row[f"max_{kind}"])
        for kind in _KINDS
        if f"max_{kind}" in row and row.get(f"has_{kind}_limits", True)
    }
