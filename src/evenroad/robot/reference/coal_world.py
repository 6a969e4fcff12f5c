"""CoalWorld: a robot of triangles among a scene's shapes, checked by coal."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from evenroad.errors import InvalidValue, NotAvailable
from evenroad.robot.arm_world import joint_space
from evenroad.robot.kinematics import link_poses
from evenroad.robot.reference.surface import Surface, robot_surfaces
from evenroad.robot.robot import Robot
from evenroad.robot.scene import Obstacle, Scene
from evenroad.space import JointSpace
from evenroad.world import FunctionWorld


@dataclass(frozen=True, eq=False)
class CoalWorld:
    """Configurations in which no triangle of a robot meets an obstacle or another link; thousands a second.

    Links are placed by our own forward kinematics in double precision; coal (a fork of FCL) tests trees of
    boxes over their triangles.  Obstacles are solid.  Links are surfaces: one that is wholly inside of
    another does not meet it.

    Parameters
    ----------
    robot : Robot
        Tree of joints, group and pairs of links; its capsules count only where `surfaces` is not given.
    scene : Scene
        Obstacles and allowed contacts.
    surfaces : mapping of str to Surface, optional
        Surfaces of the links, in their frames.  By default those of the robot's capsules.
    resolution : float
        As for :class:`evenroad.robot.arm_world.ArmWorld`.

    Raises
    ------
    NotAvailable
        If coal is not installed.
    InvalidValue
        If a surface is given for a link that is not there, or none at all.
    """

    robot: Robot
    scene: Scene
    surfaces: Mapping[str, Surface] | None = None
    resolution: float = 0.05
    _states: FunctionWorld = field(init=False, repr=False)
    _coal: Any = field(init=False, repr=False)
    _links: dict[str, Any] = field(init=False, repr=False)
    _obstacles: dict[str, tuple[Any, Any]] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        try:
            import coal
        except ImportError as error:
            raise NotAvailable(f"meshes need the extra: pip install 'evenroad[mesh]' ({error})") from error
        surfaces = sound_surfaces(self.robot, self.surfaces)
        states = FunctionWorld(joint_space(self.robot), self._free, self.resolution)
        obstacles = {
            obstacle.name: (_solid(coal, obstacle), _place(coal, obstacle))
            for obstacle in self.scene.obstacles
        }
        object.__setattr__(self, "_states", states)
        object.__setattr__(self, "_coal", coal)
        object.__setattr__(self, "_links", {link: _tree(coal, s) for link, s in surfaces.items()})
        object.__setattr__(self, "_obstacles", obstacles)

    @property
    def space(self) -> JointSpace:
        """The ranges of the group's joints."""
        return self._states.space  # type: ignore[return-value]

    def valid(self, q: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
        """Return which configurations, (n, dim), are within the limits and touch nothing: (n,)."""
        return self._states.valid(q)

    def motion_valid(self, a: npt.NDArray[np.float64], b: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
        """Return which motions, two (m, dim) arrays, are free at states at most `resolution` apart: (m,)."""
        return self._states.motion_valid(a, b)

    def explain(self, q: npt.NDArray[np.float64]) -> str:
        """Return in words why one configuration, (dim,), is not free."""
        batch = np.asarray(q, dtype=np.float64)[np.newaxis]
        if not self.space.contains(batch)[0]:
            return self._states.explain(batch[0])
        bodies = next(self._contacts(link_poses(self.robot, batch)[0]), None)
        return "it is free" if bodies is None else f"{bodies[0]!r} touches {bodies[1]!r}"

    def _free(self, q: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
        return np.array([next(self._contacts(pose), None) is None for pose in link_poses(self.robot, q)])

    def _contacts(self, poses: npt.NDArray[np.float64]) -> Iterator[tuple[str, str]]:
        """Yield the bodies that touch, for the poses of all links, (links, 4, 4)."""
        coal, allowed = self._coal, self.scene.allowed
        places = {}
        for link, pose in zip(self.robot.links, poses, strict=True):
            if link in self._links:
                places[link] = coal.Transform3s(np.ascontiguousarray(pose[:3, :3]), pose[:3, 3].copy())
        request, result = coal.CollisionRequest(), coal.CollisionResult()
        for link, place in places.items():
            for name, (solid, where) in self._obstacles.items():
                result.clear()
                if (link, name) not in allowed and coal.collide(
                    self._links[link], place, solid, where, request, result
                ):
                    yield link, name
        for a, b in self.robot.pairs:
            result.clear()
            if a in places and b in places and coal.collide(
                self._links[a], places[a], self._links[b], places[b], request, result
            ):  # fmt: skip
                yield a, b


def sound_surfaces(robot: Robot, surfaces: Mapping[str, Surface] | None) -> dict[str, Surface]:
    """Return the surfaces to test: those given, or those of the robot's capsules.

    Raises
    ------
    InvalidValue
        If there is none, or one of a link that is not there: every check would pass.
    """
    chosen = robot_surfaces(robot) if surfaces is None else dict(surfaces)
    unknown = sorted(set(chosen) - set(robot.links))
    if not chosen or unknown:
        raise InvalidValue(
            f"surfaces must be those of links of {robot.name!r}, one or more; got {sorted(chosen)}"
            + (f", of which unknown: {', '.join(unknown)}" if unknown else "")
        )
    return chosen


def _tree(coal: Any, surface: Surface) -> Any:
    tree = coal.BVHModelOBBRSS()
    tree.beginModel(len(surface.triangles), len(surface.vertices))
    tree.addVertices(surface.vertices)
    tree.addTriangles(surface.triangles)
    tree.endModel()
    return tree


def _solid(coal: Any, obstacle: Obstacle) -> Any:
    shapes = {"box": coal.Box, "sphere": coal.Sphere, "cylinder": coal.Cylinder, "capsule": coal.Capsule}
    return shapes[obstacle.shape](*obstacle.size)


def _place(coal: Any, obstacle: Obstacle) -> Any:
    return coal.Transform3s(np.array(obstacle.rotation).reshape(3, 3), np.array(obstacle.xyz))
