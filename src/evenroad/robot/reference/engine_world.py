"""EngineWorld: what the worlds of other people's collision checkers have in common."""

from __future__ import annotations

import os
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field

from evenroad._arrays import Bools, Floats
from evenroad.errors import InvalidValue
from evenroad.geometry.shapes import Shape, along_z
from evenroad.robot.known_robots import joint_space
from evenroad.robot.load import find_robot, read_robot
from evenroad.robot.robot import Robot
from evenroad.robot.scene import Scene
from evenroad.robot.urdf_xml import RobotFile
from evenroad.space import JointSpace
from evenroad.world.function import FunctionWorld, TestedAtStates


@dataclass(frozen=True, eq=False)
class EngineWorld(TestedAtStates, ABC):
    """A robot's shapes among a scene's, checked state by state; subclasses say by whom.

    `shapes` are those of the links, each in its link's frame, as of :func:`original_shapes`; by default the robot's
    capsules.  Raises NotAvailable if the engine is not installed, BrokenFile if a mesh is missing or broken,
    InvalidValue if a link would have no shape, or a shape is of a link that is not there.
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

    @abstractmethod
    def _free(self, q: Floats) -> Bools:
        """Return which configurations within the limits, (n, dim), touch nothing: (n,)."""


def original_shapes(source: str | os.PathLike[str] | RobotFile, robot: Robot) -> tuple[Shape, ...]:
    """Return the collision shapes that a robot's file, or a shipped robot, gives, before capsules were fitted.

    Links of `robot` that have no shape there, because their capsules were given, keep those.  Raises as
    :func:`evenroad.robot.load_model`.
    """
    file = source if isinstance(source, RobotFile) else RobotFile(find_robot(source)[0])
    shapes = read_robot(file).shapes
    there = {shape.link for shape in shapes}
    return shapes + tuple(shape for shape in capsule_shapes(robot) if shape.link not in there)


def capsule_shapes(robot: Robot) -> tuple[Shape, ...]:
    """Return the capsules of a robot as collision shapes."""
    return tuple(map(along_z, robot.capsules))


def sound_shapes(robot: Robot, shapes: Sequence[Shape] | None) -> tuple[Shape, ...]:
    """Return the shapes to test: those given, or the robot's capsules.

    Raises InvalidValue if there is none, one is of a link that is not there, or a link with capsules has none: its
    checks would all pass.
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
