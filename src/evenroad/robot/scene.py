"""Scene: what stands around a robot."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from evenroad.errors import InvalidValue

Shape = Literal["box", "sphere", "cylinder", "capsule"]


@dataclass(frozen=True)
class Obstacle:
    """A convex body that does not move.

    Attributes
    ----------
    name : str
        Unique in its scene.
    shape : {"box", "sphere", "cylinder", "capsule"}
        Cylinders and capsules stand along their own z axis.
    size : tuple of floats
        Box: full extents (x, y, z); sphere: (radius,); cylinder and capsule: (radius, length), without the caps [m].
    xyz : tuple of 3 floats
        Centre in the frame of the robot's root link [m].
    rotation : tuple of 9 floats
        From the body's frame to that of the robot's root link, row by row.
    cell : bool
        Part of the fixed cell (a mount plane, a fence), the same for every task of this installation.
    """

    name: str
    shape: Shape
    size: tuple[float, ...]
    xyz: tuple[float, float, float]
    rotation: tuple[float, ...] = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
    cell: bool = False


@dataclass(frozen=True)
class Scene:
    """Obstacles, allowed contacts and named configurations.

    Attributes
    ----------
    name : str
        Name of the scene.
    obstacles : tuple of Obstacle
        What stands around.
    allowed : frozenset of (link, obstacle) pairs of str
        Contacts that are not tested, e.g. of the base with the table that it stands on.
    states : mapping of str to mapping of str to float
        Named configurations: joint -> value; joints that are not planned for are held there.
    limits : mapping of str to (float, float)
        Ranges to plan in, joint -> (lower, upper), within the robot's own [rad or m]; a planner takes them
        over with :func:`evenroad.robot.alter.in_scene`.

    Raises
    ------
    InvalidValue
        If two obstacles share a name: what is allowed to touch the one would be allowed to touch the other.
    """

    name: str
    obstacles: tuple[Obstacle, ...]
    allowed: frozenset[tuple[str, str]] = frozenset()
    states: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    limits: Mapping[str, tuple[float, float]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        names = [obstacle.name for obstacle in self.obstacles]
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise InvalidValue(
                f"obstacles of scene {self.name!r} must have names of their own, twice: {twice}"
            )
