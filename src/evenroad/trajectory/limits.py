"""Limits: velocities, accelerations and jerks of joints, from a robot or MoveIt's joint_limits.yaml."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from evenroad._arrays import Floats
from evenroad._checks import as_row, require_known, require_positive
from evenroad._yaml import read_mapping
from evenroad.errors import BrokenFile, InvalidValue
from evenroad.robot import Robot
from evenroad.robot.chain import chain_of

SECONDS_TO_FULL_SPEED = 0.5
"""Default time from rest to full speed [s]: URDF has no acceleration."""

_KINDS = ("velocity", "acceleration", "jerk")


@dataclass(frozen=True)
class TipSpeed:
    """Largest speed of a robot's link, > 0 [m/s].

    Attributes
    ----------
    robot : Robot
    link : str
        Its origin counts.
    most : float
        > 0 [m/s].
    """

    robot: Robot
    link: str
    most: float

    def __post_init__(self) -> None:
        require_positive("the tip's speed", self.most)

    def along(self, q: Floats, direction: Floats) -> Floats:
        """Return the largest speeds of the joints together, (n,), at configurations in directions, (n, dim) each."""
        derivatives = chain_of(self.robot, self.link).derivatives(q)[:, :3]
        moves = np.linalg.norm(np.einsum("nij,nj->ni", derivatives, direction), axis=1)
        return self.most / np.maximum(moves, 1e-9)


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
    tip : TipSpeed or None
        Largest speed of a link; None: no limit.  A share of full speed leaves it as it is.
    """

    velocity: tuple[float, ...]
    acceleration: tuple[float, ...]
    jerk: tuple[float, ...] | None = None
    along_path: float | None = None
    tip: TipSpeed | None = None

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
        return Limits(scaled(self.velocity, 1), scaled(self.acceleration, 2), jerk, along, self.tip)


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
