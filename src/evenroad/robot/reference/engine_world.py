"""EngineWorld: what the worlds of other people's collision checkers have in common."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from evenroad.robot.arm_world import joint_space
from evenroad.robot.geometry import Geometry
from evenroad.robot.reference.bodies import sound_geometries
from evenroad.robot.robot import Robot
from evenroad.robot.scene import Scene
from evenroad.space import JointSpace
from evenroad.world import FunctionWorld


@dataclass(frozen=True, eq=False)
class EngineWorld(ABC):
    """A robot's shapes among a scene's, checked state by state; subclasses say by whom.

    Parameters
    ----------
    robot : Robot
        Tree of joints, group and pairs of links; its capsules count only where `geometries` is not given.
    scene : Scene
        Obstacles and allowed contacts.
    geometries : sequence of Geometry, optional
        Shapes of the links, each in its link's frame, as of
        :func:`evenroad.robot.reference.bodies.original_geometries`.  By default the robot's capsules.
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
    geometries: Sequence[Geometry] | None = None
    resolution: float = 0.05
    _shapes: tuple[Geometry, ...] = field(init=False, repr=False)
    _states: FunctionWorld = field(init=False, repr=False)

    def __post_init__(self) -> None:
        shapes = tuple(sound_geometries(self.robot, self.geometries))
        object.__setattr__(self, "geometries", shapes)
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
