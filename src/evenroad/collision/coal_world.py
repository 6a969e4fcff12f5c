"""Worlds of a robot's own shapes, meshes included, checked by others' engines: EngineWorld; and CoalWorld, by coal."""

from __future__ import annotations

import os
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache
from itertools import product
from types import ModuleType
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from evenroad._arrays import Bools, Floats, Ints, set_fields
from evenroad._checks import require_extra
from evenroad.collision.prepared_robots import joint_space
from evenroad.errors import BrokenFile, InvalidValue
from evenroad.geometry.mesh import TriangleMesh
from evenroad.geometry.shapes import Capsule, Mesh, PointCloud, Shape, along_z
from evenroad.loading.find import find_robot
from evenroad.loading.load import read_robot
from evenroad.loading.robot_file import RobotFile
from evenroad.robots.kinematics import link_poses
from evenroad.robots.robot import Robot
from evenroad.scenes.robot_in_scene import scene_around
from evenroad.scenes.scene import Scene
from evenroad.space import JointSpace
from evenroad.world.function import FunctionWorld, TestedAtStates

Solid: TypeAlias = Any
"""A shape of coal's, which has no types."""
_ROUNDING = 1e-9
"""Added to boxes: more than double precision loses on a robot of many metres [m]."""


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
        states = FunctionWorld(joint_space(self.robot), self._free, self.resolution)
        scene = scene_around(self.robot, self.scene)
        set_fields(self, scene=scene, shapes=shapes, _shapes=shapes, _states=states)

    @property
    def space(self) -> JointSpace:
        """The ranges of the group's joints."""
        return self._states.space  # type: ignore[return-value]

    @abstractmethod
    def _free(self, q: Floats) -> Bools:
        """Return which configurations within the limits, (n, dim), touch nothing: (n,)."""


@dataclass(frozen=True, eq=False)
class CoalWorld(EngineWorld):
    """Configurations in which no shape of a robot meets an obstacle or another link; one after the other.

    Links are placed by our own forward kinematics in double precision; coal (a fork of FCL) tests spheres, boxes,
    cylinders and capsules exactly, and meshes by trees of boxes over their triangles.  Bodies whose boxes are apart are
    not tested.  Meshes are surfaces: what is wholly inside of one does not meet it.  Parameters and errors are those of
    :class:`EngineWorld`.
    """

    _coal: ModuleType = field(init=False, repr=False)
    _solids: list[Solid] = field(init=False, repr=False)
    _obstacles: list[tuple[Solid, object]] = field(init=False, repr=False)
    _tests: list[tuple[int, int, bool]] = field(init=False, repr=False)
    _boxes: _Boxes = field(init=False, repr=False)

    def __post_init__(self) -> None:
        coal = require_coal()
        super().__post_init__()
        bodies = [obstacle.body for obstacle in self.scene.obstacles]
        set_fields(
            self,
            _coal=coal,
            _solids=[coal_shape(coal, shape) for shape in self._shapes],
            _obstacles=[(coal_shape(coal, body), _transform(coal, body.pose.matrix)) for body in bodies],
            _tests=tests_of(self.robot, self.scene, self._shapes),
        )
        set_fields(self, _boxes=self._boxes_of_all())

    def explain(self, q: Floats) -> str:
        """Return in words why one configuration, (dim,), is not free."""
        batch = np.asarray(q, dtype=np.float64)[np.newaxis]
        if not self.space.contains(batch)[0]:
            return self._states.explain(batch[0])
        bodies = next(self._contacts_at(batch), None)
        return "it is free" if bodies is None else f"{bodies[0]!r} touches {bodies[1]!r}"

    def _free(self, q: Floats) -> Bools:
        poses = self._poses(q)
        near = self._near(poses)
        contacts = (next(self._contacts(poses[:, row], near[:, row]), None) for row in range(len(q)))
        return np.array([contact is None for contact in contacts], dtype=np.bool_)

    def contacts(self, q: Floats) -> set[tuple[str, str]]:
        """Return all that touches in one configuration, (dim,): a link and an obstacle, or a pair of links."""
        return set(self._contacts_at(np.asarray(q, dtype=np.float64)[np.newaxis]))

    def _contacts_at(self, q: Floats) -> Iterator[tuple[str, str]]:
        poses = self._poses(q)
        return self._contacts(poses[:, 0], self._near(poses)[:, 0])

    def _poses(self, q: Floats) -> Floats:
        """Return the pose of every shape of the robot, (shapes, n, 4, 4)."""
        links = link_poses(self.robot, q)
        number = {link: i for i, link in enumerate(self.robot.links)}
        return np.stack([links[:, number[shape.link]] @ shape.pose.matrix for shape in self._shapes])

    def _boxes_of_all(self) -> _Boxes:
        solids = [*self._solids, *(solid for solid, _ in self._obstacles)]
        for solid in solids:
            solid.computeLocalAABB()
        low = np.array([solid.aabb_local.min_ for solid in solids])
        high = np.array([solid.aabb_local.max_ for solid in solids])
        tests = np.array(self._tests, dtype=np.int64).reshape(-1, 3)
        fixed = np.array([obstacle.body.pose.matrix for obstacle in self.scene.obstacles])
        second = tests[:, 1] + len(self._shapes) * tests[:, 2]
        return _Boxes(
            0.5 * (low + high),
            0.5 * (high - low) + _ROUNDING,
            fixed.reshape(-1, 1, 4, 4),
            tests[:, 0],
            second,
        )

    def _near(self, poses: Floats) -> Bools:
        """Return of which tests the boxes around the two bodies are not known to be apart, (tests, n).

        For the poses of all shapes, (shapes, n, 4, 4).  Balls around the boxes are tried first, then the directions of
        their edges (Gottschalk, Lin and Manocha 1996).
        """
        boxes, n = self._boxes, poses.shape[1]
        placed = np.concatenate([poses, np.broadcast_to(boxes.fixed, (len(boxes.fixed), n, 4, 4))])
        turns = placed[..., :3, :3]
        centres = placed[..., :3, 3] + (turns @ boxes.middle[:, np.newaxis, :, np.newaxis])[..., 0]
        reach = np.linalg.norm(boxes.half, axis=1)
        apart = centres[boxes.second] - centres[boxes.first]
        near: Bools = (apart**2).sum(axis=2) <= ((reach[boxes.first] + reach[boxes.second]) ** 2)[:, np.newaxis]
        test, row = np.nonzero(near)
        one, other = boxes.first[test], boxes.second[test]
        by, first, second = apart[test, row][:, np.newaxis], turns[one, row], turns[other, row]
        across = np.abs(first.swapaxes(1, 2) @ second)
        mine, its = boxes.half[one], boxes.half[other]
        close = np.abs((by @ first)[:, 0]) <= mine + (across @ its[..., np.newaxis])[..., 0]
        close &= np.abs((by @ second)[:, 0]) <= its + (mine[:, np.newaxis] @ across)[:, 0]
        near[test, row] = close.all(axis=1)
        return near

    def _contacts(self, poses: Floats, near: Bools) -> Iterator[tuple[str, str]]:
        """Yield two bodies that touch after the other two, for the poses of all shapes, (shapes, 4, 4)."""
        coal, solids = self._coal, self._solids
        transform_of = cache(lambda shape: _transform(coal, poses[shape]))
        request, result = with_contacts(coal.CollisionRequest()), coal.CollisionResult()
        for number in np.flatnonzero(near).tolist():
            shape, other, is_obstacle = self._tests[number]
            second = self._obstacles[other] if is_obstacle else (solids[other], transform_of(other))
            result.clear()
            if coal.collide(solids[shape], transform_of(shape), *second, request, result):
                name = self.scene.obstacles[other].name if is_obstacle else self._shapes[other].link
                yield self._shapes[shape].link, name


class _Boxes(NamedTuple):
    """Boxes around bodies, shapes first, in their own frames: middles and half extents, (b, 3); the poses of obstacles,
    (m, 1, 4, 4); and the two bodies of each test, (t,).
    """

    middle: Floats
    half: Floats
    fixed: Floats
    first: Ints
    second: Ints


def tests_of(robot: Robot, scene: Scene, shapes: Sequence[Shape]) -> list[tuple[int, int, bool]]:
    """Return what is tested: a shape of the robot, and the number of an obstacle (True) or of another shape."""
    of_link: dict[str, list[int]] = {}
    tests = []
    for i, shape in enumerate(shapes):
        of_link.setdefault(shape.link, []).append(i)
        for j, obstacle in enumerate(scene.obstacles):
            if (shape.link, obstacle.name) not in scene.allowed:
                tests.append((i, j, True))
    for a, b in robot.pairs:
        tests += [(i, j, False) for i, j in product(of_link.get(a, ()), of_link.get(b, ()))]
    return tests


def _transform(coal: ModuleType, pose: Floats) -> object:
    return coal.Transform3s(np.ascontiguousarray(pose[:3, :3]), pose[:3, 3].copy())


def coal_shape(coal: ModuleType, shape: Shape) -> Solid:
    """Return a shape in its own frame: round ones and boxes exactly, meshes triangle by triangle.

    A mesh stays what it is.  What coal 3.0.3 builds with ``buildConvexRepresentation`` lets collisions pass where the
    mesh is not convex, and most of all where its triangles share no corners, as in an STL: docs/guides/coal.md.
    """
    if isinstance(shape, PointCloud):
        raise InvalidValue(f"coal has no clouds of points, got a {shape}")
    if isinstance(shape, Mesh):
        return tree_of(coal, shape.triangles)
    kinds = {"box": coal.Box, "sphere": coal.Sphere, "cylinder": coal.Cylinder, "capsule": coal.Capsule}
    return kinds[shape.kind](*shape.size)


def with_contacts(request: Solid) -> Solid:
    """Return a request of coal's, set so that round shapes are not missed.

    Without contacts coal 3.0.3 leaves out the step that finds how deep two shapes are in each other, and with it about
    one of 10 000 collisions of cylinders with boxes and capsules, some of them centimetres deep.
    """
    request.enable_contact = True
    return request


def require_coal() -> ModuleType:
    """Return the module coal; NotAvailable if it is not installed."""
    return require_extra("coal", "mesh", "checking meshes")


def tree_of(coal: ModuleType, mesh: TriangleMesh) -> Solid:
    """Return coal's tree of oriented boxes over the triangles of a mesh; its surface as it is, nothing made convex.

    Raises BrokenFile if coal leaves triangles out.
    """
    tree = coal.BVHModelOBBRSS()
    tree.beginModel(len(mesh.triangles), len(mesh.vertices))
    tree.addVertices(mesh.vertices)
    tree.addTriangles(mesh.triangles)
    tree.endModel()
    if not tree.num_tris == len(mesh.triangles) > 0:
        raise BrokenFile(
            f"coal took {tree.num_tris} of {len(mesh.triangles)} triangles: the others would never collide"
        )
    return tree


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
    given = robot.capsules if shapes is None else shapes
    # Coal has capsules along z alone: it would use only length and radius of another one.
    chosen = tuple(along_z(shape) if isinstance(shape, Capsule) else shape for shape in given)
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
