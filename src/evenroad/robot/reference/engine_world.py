"""EngineWorld: what the worlds of other people's collision checkers have in common."""

from __future__ import annotations

import os
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from evenroad.errors import InvalidValue
from evenroad.geometry.shapes import Shape, along_z
from evenroad.robot.known_robots import joint_space
from evenroad.robot.load import find_robot
from evenroad.robot.robot import Robot
from evenroad.robot.scene import Scene
from evenroad.robot.urdf import read_urdf
from evenroad.space import JointSpace
from evenroad.world import FunctionWorld


@dataclass(frozen=True, eq=False)
class EngineWorld(ABC):
    """A robot's shapes among a scene's, checked state by state; subclasses say by whom.

    Parameters
    ----------
    robot : Robot
        Tree of joints, group and pairs of links; its capsules count only where `shapes` is not given.
    scene : Scene
        Obstacles and allowed contacts.
    shapes : sequence of Shape, optional
        Shapes of the links, each in its link's frame, as of :func:`original_shapes`.  By default the robot's capsules.
    resolution : float
        As for :class:`evenroad.robot.arm_world.ArmWorld`.

    Raises
    ------
    NotAvailable
        If the engine, or what reads a mesh, is not installed.
    BrokenFile
        If a mesh is missing, broken or empty.
    InvalidValue
        If a link would have no shape, or a shape is of a link that is not there.
    """

    robot: Robot
    scene: Scene
    shapes: Sequence[Shape] | None = None
    resolution: float = 0.05
    _shapes: tuple[Shape, ...] = field(init=False, repr=False)
    _states: FunctionWorld = field(init=False, repr=False)

    def __post_init__(self) -> None:
        shapes = sound_shapes(self.robot, self.shapes)
        object.__setattr__(self, "shapes", shapes)
        object.__setattr__(self, "_shapes", shapes)
        states = FunctionWorld(joint_space(self.robot), self._free, self.resolution)
        object.__setattr__(self, "_states", states)

    @property
    def space(self) -> JointSpace:
        """The ranges of the group's joints."""
        return self._states.space  # type: ignore[return-value]

    def valid(self, q: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
        """Return which configurations, (n, dim) [rad or m], are within the limits and touch nothing: (n,).

        Raises
        ------
        InvalidValue
            If `q` has another shape or an entry that is not finite.
        """
        return self._states.valid(q)

    def motion_valid(self, a: npt.NDArray[np.float64], b: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
        """Return which motions, two (m, dim) arrays, are free at states at most `resolution` apart: (m,).

        Raises
        ------
        InvalidValue
            As `valid`, or if the two differ in length.
        """
        return self._states.motion_valid(a, b)

    @abstractmethod
    def _free(self, q: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
        """Return which configurations within the limits, (n, dim), touch nothing: (n,)."""


def original_shapes(source: str | os.PathLike[str], robot: Robot) -> tuple[Shape, ...]:
    """Return the collision shapes that a robot's URDF gives, before any capsule was fitted to them.

    Parameters
    ----------
    source : str or path-like
        The URDF, or the name of a shipped robot, from which `robot` was loaded.
    robot : Robot
        Its links that have no shape in the URDF, because their capsules were given, keep those.

    Raises
    ------
    BrokenFile, InvalidValue, UnknownName
        As :func:`evenroad.robot.load_model`.
    """
    shapes = read_urdf(find_robot(source)[0]).shapes
    there = {shape.link for shape in shapes}
    return shapes + tuple(shape for shape in capsule_shapes(robot) if shape.link not in there)


def capsule_shapes(robot: Robot) -> tuple[Shape, ...]:
    """Return the capsules of a robot as collision shapes."""
    return tuple(map(along_z, robot.capsules))


def sound_shapes(robot: Robot, shapes: Sequence[Shape] | None) -> tuple[Shape, ...]:
    """Return the shapes to test: those given, or the robot's capsules.

    Raises
    ------
    InvalidValue
        If there is none, one is of a link that is not there, or a link with capsules has none: its checks would
        all pass.
    """
    chosen = capsule_shapes(robot) if shapes is None else tuple(shapes)
    links = {shape.link for shape in chosen}
    unknown = sorted(links - set(robot.links))
    bare = sorted({capsule.link for capsule in robot.capsules} - links)
    if not chosen or unknown or bare:
        raise InvalidValue(
            f"shapes must be those of links of {robot.name!r}, one or more; got {len(chosen)}"
            + (f", of links that are not there: {', '.join(unknown)}" if unknown else "")
            + (f", none of {', '.join(bare)}" if bare else "")
        )
    return chosen
