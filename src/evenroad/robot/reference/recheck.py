"""A path that was found among capsules, checked again with the meshes that the capsules stand for."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from evenroad.errors import NotAvailable
from evenroad.robot.arm_world import joint_space
from evenroad.robot.model import RobotModel
from evenroad.robot.reference.bodies import original_geometries
from evenroad.robot.reference.coal_world import CoalWorld
from evenroad.robot.robot import Robot
from evenroad.robot.scene import Scene
from evenroad.space.path import resample

Verdict = Literal["free", "in collision", "not checked"]


@dataclass(frozen=True)
class MeshCheck:
    """What the original shapes say about a path.

    Attributes
    ----------
    verdict : {"free", "in collision", "not checked"}
        Of all states, ends included, at most the resolution apart.
    states : int
        How many states were asked for; 0 where nothing was checked.
    message : str
        Why it was not checked; or which motion of the path is in collision where, and which bodies touch.
    configuration : tuple of floats, or None
        The first state in collision [rad or m].
    """

    verdict: Verdict
    states: int = 0
    message: str = ""
    configuration: tuple[float, ...] | None = None

    def __str__(self) -> str:
        if self.verdict == "free":
            return f"free ({self.states} states)"
        return (
            f"{self.verdict} {self.message}"
            if self.verdict == "in collision"
            else f"not checked ({self.message})"
        )


def has_meshes(model: RobotModel) -> bool:
    """Return whether a robot's URDF gives a mesh for any link; nothing is read for it."""
    return any(shape.startswith("mesh ") for body in model.bodies for shape in body.shapes)


def recheck(
    source: str | os.PathLike[str],
    robot: Robot,
    scene: Scene,
    path: npt.NDArray[np.float64],
    resolution: float = 0.05,
) -> MeshCheck:
    """Check a path with the shapes of the robot's URDF, meshes triangle by triangle, in coal.

    Capsules contain the shapes that they were fitted to, so what is free for them is free here.  Where it is not,
    the capsules were given by the user and leave out a piece of a shape, or something is wrong with one of the two
    checkers: either way the path is not to be driven.

    Parameters
    ----------
    source : str or path-like
        The URDF that `robot` was loaded from.
    robot, scene : Robot, Scene
        What was planned with.
    path : ndarray, shape (p, dim)
        Waypoints [rad or m]; each motion is divided as ArmWorld divides it.
    resolution : float
        As for :class:`evenroad.robot.arm_world.ArmWorld`.

    Raises
    ------
    BrokenFile, InvalidValue
        If the URDF or a mesh is missing, broken or empty by now.
    """
    try:
        world = CoalWorld(robot, scene, original_geometries(source, robot), resolution)
    except NotAvailable:
        return MeshCheck("not checked", message="needs evenroad[mesh]")
    states, motions = resample(path, joint_space(robot), resolution)
    blocked = np.flatnonzero(~world.valid(states))
    if len(blocked) == 0:
        return MeshCheck("free", len(states))
    first = states[blocked[0]]
    return MeshCheck(
        "in collision",
        len(states),
        f"at {_numbers(first)} in motion {motions[blocked[0]]} of the path: {world.explain(first)}",
        tuple(first.tolist()),
    )


def _numbers(row: Sequence[float] | npt.NDArray[np.float64]) -> str:
    return "(" + ", ".join(f"{value:.4g}" for value in row) + ")"
