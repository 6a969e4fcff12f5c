"""Masses of a robot's links, and the torques that its joints need to move them."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from evenroad._arrays import Floats
from evenroad._checks import as_batch, as_row, require_known, require_positive
from evenroad.errors import InvalidValue
from evenroad.robot import Robot
from evenroad.robot.kinematics import joint_values, poses_at
from evenroad.robot.masses import Mass, read_masses

_NEXT, _LAST = np.array([1, 2, 0]), np.array([2, 0, 1])
EARTH = (0.0, 0.0, -9.81)
"""Acceleration of what falls, in the frame of the root [m/s^2]."""


@dataclass(frozen=True)
class Dynamics:
    """What the links of a robot weigh, and which torques its joints have; :func:`load_dynamics` reads both.

    Attributes
    ----------
    robot : Robot
    masses : tuple of Mass
        Links may have several, or none.
    efforts : tuple of float
        Largest torque of each planned joint, > 0; infinite where there is no limit [N m; N of those that slide].
    gravity : tuple of 3 floats
        Acceleration of what falls, in the frame of the root [m/s^2].
    """

    robot: Robot
    masses: tuple[Mass, ...]
    efforts: tuple[float, ...]
    gravity: tuple[float, ...] = EARTH

    def __post_init__(self) -> None:
        object.__setattr__(self, "efforts", tuple(map(float, self.efforts)))
        object.__setattr__(self, "gravity", as_row("gravity", self.gravity, 3))
        if len(self.efforts) != len(self.robot.group) or not all(effort > 0.0 for effort in self.efforts):
            wanted = f"{len(self.robot.group)}, one a joint, each > 0"
            raise InvalidValue(f"efforts must be {wanted}, got {self.efforts!r}")
        for mass in self.masses:
            require_known(f"link of {self.robot.name!r}:", mass.link, self.robot.links)

    def carrying(self, link: str, mass: float, centre: Iterable[float] = (0.0, 0.0, 0.0)) -> Dynamics:
        """Return the dynamics with one more mass, > 0 [kg], on a link, small and at a place in its frame [m].

        Raises InvalidValue or UnknownName if an argument is no such number or link.
        """
        at = as_row("centre", [*centre], 3)
        more = Mass(link, require_positive("mass", mass), (at[0], at[1], at[2]))
        return replace(self, masses=(*self.masses, more))

    def torques(self, q: Any, velocity: Any, acceleration: Any) -> Floats:
        """Return the torques that joints need at configurations for velocities and accelerations, (n, dim) each.

        Forces are summed up from the tips to the root (Newton and Euler; Luh, Walker and Paul 1980).

        Raises
        ------
        InvalidValue
            If an argument is no such array.
        """
        dim = len(self.robot.group)
        given = (("q", q), ("velocity", velocity), ("acceleration", acceleration))
        here, rates, pushes = (as_batch(name, each, dim) for name, each in given)
        return self._forces(here, rates, pushes, np.broadcast_to(-np.array(self.gravity), (len(here), 3)))

    def shares(self, q: Floats, velocity: Floats, acceleration: Floats) -> Floats:
        """Return the torques as shares of the efforts, (n, dim)."""
        return self.torques(q, velocity, acceleration) / np.array(self.efforts)

    def along(self, q: Floats, direction: Floats, bend: Floats) -> tuple[Floats, Floats, Floats]:
        """Return what torques, as shares of efforts, gain by the acceleration along a path and by its squared speed,
        and what they are at rest: (n, dim) each.
        """
        still, n = np.zeros_like(q), len(q)
        pulled = np.zeros((3 * n, 3))
        pulled[2 * n :] = -np.array(self.gravity)
        forces = self._forces(
            np.concatenate([q, q, q]),
            np.concatenate([still, direction, still]),
            np.concatenate([direction, bend, still]),
            pulled,
        )
        slope, rise, rest = forces.reshape(3, n, -1) / np.array(self.efforts)
        return slope, rise, rest

    def _forces(self, q: Floats, velocity: Floats, acceleration: Floats, pulled: Floats) -> Floats:
        """Return torques where the root is accelerated by `pulled`, (n, 3): that is as good as gravity."""
        robot, n = self.robot, len(q)
        values = joint_values(robot, q)
        poses = dict(zip(robot.links, np.moveaxis(poses_at(robot, values, n), 1, 0), strict=True))
        none = {joint.name: np.zeros(n) for joint in robot.joints if joint.kind != "fixed" and joint.mimic is None}
        rates = _with_mimics(robot, none | dict(zip(robot.group, velocity.T, strict=True)))
        pushes = _with_mimics(robot, none | dict(zip(robot.group, acceleration.T, strict=True)))
        zero = np.zeros((n, 3))
        # Of each link: how it turns, and is pushed to turn and to move.
        moves = {robot.links[0]: (zero, zero, pulled)}
        axes: dict[str, Floats] = {}
        for joint in robot.joints:
            turn, turned, pushed = moves[joint.parent]
            parent, child = poses[joint.parent], poses[joint.child]
            arm = child[:, :3, 3] - parent[:, :3, 3]
            pushed = pushed + _cross(turned, arm) + _cross(turn, _cross(turn, arm))
            if joint.kind != "fixed":
                # A joint leaves its own axis where it is.
                axis = child[:, :3, :3] @ np.array(joint.axis)
                rate, push = rates[joint.name][:, np.newaxis], pushes[joint.name][:, np.newaxis]
                axes[joint.name] = axis
                if joint.kind == "prismatic":
                    pushed = pushed + axis * push + 2.0 * _cross(turn, axis * rate)
                else:
                    turned = turned + axis * push + _cross(turn, axis * rate)
                    turn = turn + axis * rate
            moves[joint.child] = turn, turned, pushed
        forces, moments = (dict.fromkeys(robot.links, zero) for _ in range(2))
        for mass in self.masses:
            turn, turned, pushed = moves[mass.link]
            rotation = poses[mass.link][:, :3, :3]
            centre = rotation @ np.array(mass.centre)
            force = mass.mass * (pushed + _cross(turned, centre) + _cross(turn, _cross(turn, centre)))
            inertia = rotation @ np.array(mass.inertia).reshape(3, 3) @ rotation.transpose(0, 2, 1)
            spin = np.einsum("nij,nj->ni", inertia, turned) + _cross(turn, np.einsum("nij,nj->ni", inertia, turn))
            forces[mass.link] = forces[mass.link] + force
            moments[mass.link] = moments[mass.link] + spin + _cross(centre, force)
        torques = {name: np.zeros(n) for name in robot.group}
        for joint in reversed(robot.joints):
            force, moment = forces[joint.child], moments[joint.child]
            if joint.kind != "fixed":
                along = force if joint.kind == "prismatic" else moment
                needed = (axes[joint.name] * along).sum(axis=1)
                name = joint.name if joint.mimic is None else joint.mimic.joint
                if name in torques:
                    torques[name] = torques[name] + needed * (1.0 if joint.mimic is None else joint.mimic.multiplier)
            arm = poses[joint.child][:, :3, 3] - poses[joint.parent][:, :3, 3]
            forces[joint.parent] = forces[joint.parent] + force
            moments[joint.parent] = moments[joint.parent] + moment + _cross(arm, force)
        return np.stack([torques[name] for name in robot.group], axis=1)


def _cross(a: Floats, b: Floats) -> Floats:
    """Return the cross products of rows, (n, 3) each; NumPy's own takes three times as long."""
    product: Floats = a[:, _NEXT] * b[:, _LAST] - a[:, _LAST] * b[:, _NEXT]
    return product


def _with_mimics(robot: Robot, rates: dict[str, Floats]) -> dict[str, Floats]:
    """Return how fast all movable joints move, joint -> (n,), from those that move by themselves."""
    mimics = [joint for joint in robot.joints if joint.kind != "fixed" and joint.mimic is not None]
    return rates | {j.name: j.mimic.multiplier * rates[j.mimic.joint] for j in mimics if j.mimic is not None}


def load_dynamics(robot: Robot, file: str | os.PathLike[str], *, gravity: Iterable[float] = EARTH) -> Dynamics:
    """Return what the links of a robot weigh, and which torques its joints have, as a URDF or xacro says.

    Parameters
    ----------
    robot : Robot
        Its planned joints have the efforts of the file; a joint without one, or with 0, has no limit.
    file : str or path-like
        The file with ``<inertial>`` elements, mostly that of the robot itself.
    gravity : sequence of 3 floats
        Acceleration of what falls, in the frame of the root [m/s^2].

    Returns
    -------
    Dynamics

    Raises
    ------
    BrokenFile
        If the file cannot be read, or has a mass or an inertia that is no number or below 0.
    InvalidValue
        If no link of the robot has a mass there, or gravity is no such row.
    """
    masses, efforts = read_masses(Path(file))
    masses = tuple(mass for mass in masses if mass.link in robot.links)
    if not any(mass.mass > 0.0 for mass in masses):
        raise InvalidValue(f"no link of {robot.name!r} has a mass in {file}")
    return Dynamics(robot, masses, tuple(efforts.get(name) or math.inf for name in robot.group), tuple(gravity))
