"""CoalWorld: a robot's own shapes, meshes included, among a scene's, checked by coal."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import product
from typing import Any

import numpy as np
import numpy.typing as npt

from evenroad.robot.arm_world import joint_space
from evenroad.robot.geometry import Geometry
from evenroad.robot.kinematics import link_poses
from evenroad.robot.reference.bodies import sound_geometries
from evenroad.robot.reference.coal_shapes import asking_for_contacts, coal_shape, placement
from evenroad.robot.robot import Robot
from evenroad.robot.scene import Scene
from evenroad.space import JointSpace
from evenroad.world import FunctionWorld
from evenroad.world.mesh.trees import require_coal


@dataclass(frozen=True, eq=False)
class CoalWorld:
    """Configurations in which no shape of a robot meets an obstacle or another link; some thousands a second.

    Links are placed by our own forward kinematics in double precision; coal (a fork of FCL) tests spheres, boxes,
    cylinders and capsules exactly, and meshes by trees of boxes over their triangles.  Meshes are surfaces: what is
    wholly inside of one does not meet it.

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
        If coal, or what reads a mesh, is not installed.
    BrokenFile
        If a mesh is missing, broken or empty.
    InvalidValue
        If a link would have no shape, or a shape is of a link that is not there.
    """

    robot: Robot
    scene: Scene
    geometries: Sequence[Geometry] | None = None
    resolution: float = 0.05
    _states: FunctionWorld = field(init=False, repr=False)
    _coal: Any = field(init=False, repr=False)
    _shapes: list[Any] = field(init=False, repr=False)
    _obstacles: list[tuple[Any, Any]] = field(init=False, repr=False)
    _tests: list[tuple[int, int, bool]] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        coal = require_coal()
        geometries = sound_geometries(self.robot, self.geometries)
        standing = self.scene.obstacles
        for name, value in (
            ("geometries", geometries),
            ("_states", FunctionWorld(joint_space(self.robot), self._free, self.resolution)),
            ("_coal", coal),
            ("_shapes", [coal_shape(coal, shape) for shape in geometries]),
            ("_obstacles", [(coal_shape(coal, o), _transform(coal, placement(o))) for o in standing]),
            ("_tests", tests_of(self.robot, self.scene, geometries)),
        ):
            object.__setattr__(self, name, value)

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
        bodies = self._first_contact(self._poses(batch)[:, 0])
        return "it is free" if bodies is None else f"{bodies[0]!r} touches {bodies[1]!r}"

    def _free(self, q: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
        poses = self._poses(q)
        return np.array([self._first_contact(poses[:, row]) is None for row in range(len(q))], dtype=np.bool_)

    def _poses(self, q: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Return the pose of every shape of the robot, (shapes, n, 4, 4)."""
        links = link_poses(self.robot, q)
        number = {link: i for i, link in enumerate(self.robot.links)}
        assert self.geometries is not None
        return np.stack([links[:, number[shape.link]] @ placement(shape) for shape in self.geometries])

    def _first_contact(self, poses: npt.NDArray[np.float64]) -> tuple[str, str] | None:
        """Return the first two bodies that touch, for the poses of all shapes, (shapes, 4, 4)."""
        assert self.geometries is not None
        coal, shapes = self._coal, self._shapes
        places = [_transform(coal, pose) for pose in poses]
        request, result = asking_for_contacts(coal.CollisionRequest()), coal.CollisionResult()
        for shape, other, is_obstacle in self._tests:
            second = self._obstacles[other] if is_obstacle else (shapes[other], places[other])
            result.clear()
            if coal.collide(shapes[shape], places[shape], *second, request, result):
                name = self.scene.obstacles[other].name if is_obstacle else self.geometries[other].link
                return self.geometries[shape].link, name
        return None


def tests_of(robot: Robot, scene: Scene, geometries: Sequence[Geometry]) -> list[tuple[int, int, bool]]:
    """Return what is tested: a shape of the robot, and the number of an obstacle (True) or of another shape."""
    of_link: dict[str, list[int]] = {}
    tests = []
    for i, geometry in enumerate(geometries):
        of_link.setdefault(geometry.link, []).append(i)
        for j, obstacle in enumerate(scene.obstacles):
            if (geometry.link, obstacle.name) not in scene.allowed:
                tests.append((i, j, True))
    for a, b in robot.pairs:
        tests += [(i, j, False) for i, j in product(of_link.get(a, ()), of_link.get(b, ()))]
    return tests


def _transform(coal: Any, pose: npt.NDArray[np.float64]) -> Any:
    return coal.Transform3s(np.ascontiguousarray(pose[:3, :3]), pose[:3, 3].copy())
