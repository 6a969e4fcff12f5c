"""Masses of a robot's links, and the torques that its joints need to move them."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats
from evenroad._checks import as_batch, as_row, require_known, require_positive
from evenroad._native.trajectory import MovingLinks, TorqueLimits
from evenroad._shared import once_property, state_without
from evenroad.collision.prepared_robots import prepared
from evenroad.errors import InvalidValue
from evenroad.loading.masses import Mass, read_masses
from evenroad.robots.robot import Robot

EARTH = (0.0, 0.0, -9.81)
"""Acceleration of gravity, in the frame of the root [m/s^2]."""


@dataclass(frozen=True)
class Dynamics:
    """Masses of a robot's links and torques of its joints; :func:`load_dynamics` reads both.

    Attributes
    ----------
    robot : Robot
    masses : tuple of Mass
        Masses; a link may have several, or none.
    efforts : tuple of float
        Largest torque of each planned joint, > 0; infinite without a limit [N m; N for prismatic joints].
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
        """Return the dynamics with one more point mass, > 0 [kg], on a link, at a position in its frame [m].

        Raises InvalidValue or UnknownName if an argument is no such number or link.
        """
        at = as_row("centre", [*centre], 3)
        more = Mass(link, require_positive("mass", mass), (at[0], at[1], at[2]))
        return replace(self, masses=(*self.masses, more))

    def torques(self, q: npt.ArrayLike, velocity: npt.ArrayLike, acceleration: npt.ArrayLike) -> Floats:
        """Return the torques of joints at configurations for velocities and accelerations, (n, dim) each.

        Forces are summed from the tips to the root (Newton and Euler; Luh, Walker and Paul 1980).

        Raises
        ------
        InvalidValue
            If an argument is no such array.
        """
        dim = len(self.robot.group)
        given = (("q", q), ("velocity", velocity), ("acceleration", acceleration))
        here, rates, pushes = (as_batch(name, each, dim) for name, each in given)
        torques: Floats = self.native.torques(here, rates, pushes)
        return torques

    @once_property
    def native(self) -> TorqueLimits:
        """The limits of the native kernel."""
        return TorqueLimits(native_links(self.robot, self.masses), np.array(self.efforts), np.array(self.gravity))

    def __getstate__(self) -> dict[str, object]:
        return state_without(self, ["native"])


def native_links(robot: Robot, masses: Iterable[Mass] = ()) -> MovingLinks:
    """Return the links of a robot in the form of the native kernel.

    Each moving frame has its coordinate, its parent, whether it slides, and a row of its pose, multiplier, offset,
    mass, centre and inertia, (n, 27).
    """
    tree = prepared(robot).tables.tree
    rows = np.zeros((len(tree.frames), 27))
    for row, frame in zip(rows, tree.frames, strict=True):
        row[:14] = *frame.rotation.ravel(), *frame.translation, frame.multiplier, frame.offset
    # Each frame gets its mass, mass times centre, and the inertia about its origin.
    moments = np.zeros((len(rows), 3, 3))
    for mass in masses:
        placement = tree.links[mass.link]
        if placement.frame == 0:
            continue
        row, turn = rows[placement.frame - 1], placement.rotation
        centre = turn @ np.array(mass.centre) + placement.translation
        row[14] += mass.mass
        row[15:18] += mass.mass * centre
        moments[placement.frame - 1] += turn @ np.array(mass.inertia).reshape(3, 3) @ turn.T
        moments[placement.frame - 1] += mass.mass * _about(centre)
    for row, moment in zip(rows, moments, strict=True):
        if row[14] > 0.0:
            row[15:18] /= row[14]
        row[18:] = (moment - row[14] * _about(row[15:18])).ravel()
    frames = tree.frames
    return MovingLinks(
        len(robot.group),
        np.array([frame.coordinate for frame in frames], dtype=np.int64),
        np.array([frame.parent - 1 for frame in frames], dtype=np.int64),
        np.array([frame.slides for frame in frames], dtype=np.bool_),
        rows,
    )


def _about(point: Floats) -> Floats:
    """Return the inertia about the origin of 1 kg at a point, (3, 3)."""
    inertia: Floats = point @ point * np.eye(3) - np.outer(point, point)
    return inertia


def load_dynamics(robot: Robot, file: str | os.PathLike[str], *, gravity: Iterable[float] = EARTH) -> Dynamics:
    """Return the masses of a robot's links and the torques of its joints, from a URDF or xacro.

    Parameters
    ----------
    robot : Robot
        The robot. Its planned joints have the efforts of the file; a joint without one, or with 0, has no limit.
    file : str or path-like
        The file with ``<inertial>`` elements, usually that of the robot itself.
    gravity : sequence of 3 floats
        Acceleration of what falls, in the frame of the root [m/s^2].

    Returns
    -------
    Dynamics

    Raises
    ------
    BrokenFile
        If the file cannot be read, or a mass or inertia is not a number >= 0.
    InvalidValue
        If no link of the robot has a mass there, or gravity is not three numbers.
    """
    masses, efforts = read_masses(Path(file))
    masses = tuple(mass for mass in masses if mass.link in robot.links)
    if not any(mass.mass > 0.0 for mass in masses):
        raise InvalidValue(f"no link of {robot.name!r} has a mass in {file}: torques need its <inertial> elements")
    return Dynamics(robot, masses, tuple(efforts.get(name) or math.inf for name in robot.group), tuple(gravity))
