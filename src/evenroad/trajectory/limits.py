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
from evenroad._yaml import read_mapping
from evenroad.errors import BrokenFile, InvalidValue, NotAvailable
from evenroad.robot import Robot
from evenroad.robot.chain import chain_of
from evenroad.trajectory.dynamics import Dynamics

SECONDS_TO_FULL_SPEED = 0.5
"""Default time from rest to full speed [s]: URDF has no acceleration."""

_SIDES = 8
"""Number of directions in which a tip's acceleration is limited."""
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

    def along(self, q: Floats, direction: Floats) -> Floats:
        """Return the largest speeds of the joints together, (n,), at configurations in directions, (n, dim) each."""
        return self.speed / np.maximum(np.linalg.norm(self._moves(q, direction), axis=1), 1e-9)

    def accelerations(self, q: Floats, direction: Floats, bend: Floats) -> tuple[Floats, Floats]:
        """Return the link's acceleration, (n, 3) each, by the acceleration along a path and by its squared speed."""
        chain = chain_of(self.robot, self.link)
        # How its derivative changes along the path, by central differences of a millionth.
        step = 1e-6 * direction
        ahead, behind = (chain.derivatives(q + sign * step)[:, :3] for sign in (1.0, -1.0))
        turned = np.einsum("nij,nj->ni", ahead - behind, direction) / 2e-6
        return self._moves(q, direction), self._moves(q, bend) + turned

    def sides(self, q: Floats, direction: Floats, bend: Floats) -> tuple[Floats, Floats, Floats]:
        """Return the acceleration in some directions as shares of the largest, of the two kinds, (n, k) each, and 0.

        The two span a plane.  In it a polygon of 16 sides lies within the circle of what is allowed.
        """
        first, second = self.accelerations(q, direction, bend)
        along = first / np.maximum(np.linalg.norm(first, axis=1, keepdims=True), 1e-12)
        across = second - along * (second * along).sum(axis=1, keepdims=True)
        across = across / np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-12)
        angles = np.arange(_SIDES) * np.pi / _SIDES
        normals = np.multiply.outer(np.cos(angles), along) + np.multiply.outer(np.sin(angles), across)
        most = self.acceleration * math.cos(0.5 * np.pi / _SIDES)
        slope, rise = (np.einsum("knj,nj->nk", normals, each) / most for each in (first, second))
        return slope, rise, np.zeros_like(slope)

    def share(self, q: Floats, velocity: Floats, acceleration: Floats) -> float:
        """Return the largest acceleration of the link as a share of what is allowed, of states, (n, dim) each."""
        pushed, turned = self.accelerations(q, velocity, acceleration)
        del pushed
        return float(np.linalg.norm(turned, axis=1).max()) / self.acceleration

    def _moves(self, q: Floats, direction: Floats) -> Floats:
        derivatives = chain_of(self.robot, self.link).derivatives(q)[:, :3]
        return np.einsum("nij,nj->ni", derivatives, direction)


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
    def is_further(self) -> bool:
        """Whether there are limits beside those of joints and of speeds: of a tip's acceleration, or of torques."""
        return self.torque is not None or (self.tip is not None and self.tip.acceleration < math.inf)

    @property
    def is_plain(self) -> bool:
        """Whether there are limits of joints and of the speed along the path alone."""
        return self.torque is None and self.tip is None

    def further(self, q: Floats, direction: Floats, bend: Floats) -> tuple[Floats, Floats, Floats]:
        """Return by what such limits are used, as shares, (n, k) each: by the acceleration along a path, by its squared
        speed, and at rest; at configurations with these directions and bends of the path, (n, dim) each.
        """
        kinds = []
        if self.tip is not None and self.tip.acceleration < math.inf:
            kinds.append(self.tip.sides(q, direction, bend))
        if self.torque is not None:
            kinds.append(self.torque.along(q, direction, bend))
        slope, rise, rest = (np.ascontiguousarray(np.hstack(each)) for each in zip(*kinds, strict=True))
        return slope, rise, rest

    def too_heavy(self, q: Floats) -> NotAvailable:
        """Return the error of a path, (n, dim), along which torques cannot hold the robot, or hardly."""
        assert self.torque is not None, "only torques are needed at rest"
        shares = np.abs(self.torque.shares(q, np.zeros_like(q), np.zeros_like(q)))
        row, joint = np.unravel_index(int(shares.argmax()), shares.shape)
        name, effort = self.torque.robot.group[joint], self.torque.efforts[joint]
        return NotAvailable(
            f"joint {name!r} needs {shares[row, joint] * effort:.4g} N m to hold the robot still on the path, of"
            f" {effort:.4g}: there is too little left to move"
        )

    def further_shares(self, q: Floats, velocity: Floats, acceleration: Floats) -> dict[str, float]:
        """Return the largest shares of such limits, by kind, at states, (n, dim) each."""
        shares = {}
        if self.tip is not None and self.tip.acceleration < math.inf:
            shares["tip acceleration"] = self.tip.share(q, velocity, acceleration)
        if self.torque is not None:
            shares["torque"] = float(np.abs(self.torque.shares(q, velocity, acceleration)).max())
        return shares


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
