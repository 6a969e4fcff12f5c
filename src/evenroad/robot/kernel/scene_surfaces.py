"""SceneSurfaces: the clouds and meshes of a scene as compiled code reads them, by addresses found out where it runs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt

from evenroad.geometry.mesh import closed_parts
from evenroad.geometry.shapes import Mesh, PointCloud
from evenroad.robot.kernel import layout as at
from evenroad.robot.kernel.addresses import address
from evenroad.robot.kernel.placed_capsules import PlacedCapsule
from evenroad.robot.kernel.robot_tables import RobotTables
from evenroad.robot.kernel.scene_tables import OBSTACLE_PADDING
from evenroad.robot.kernel.surface_around import surface_around
from evenroad.robot.kernel.surface_grid import Grid, grid_of_points, grid_of_triangles
from evenroad.robot.kernel.surface_tree import surface_array
from evenroad.robot.scene import Scene

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Bools = npt.NDArray[np.bool_]

WORKSPACE, SURFACE_ROW = 4, 3
"""The desk: how many surfaces there are, where capsules' floats are, a grid around all surfaces or 0, and how many of
them each capsule is tested against; of each surface its array, the flags of the capsules that are tested against it,
and the number of its obstacle."""

CAPSULE_ROW = 3
"""By how much the spheres over a capsule are larger than it, half its length, one over the square of that."""

MANY = 8
"""From so many surfaces on there is a grid around all of them: motions among fewer are no quicker for it."""

PIECE = 0.1
"""Triangles are cut until no side is longer than this share of the robot's reach: a box around a large one says
little."""


@dataclass(frozen=True, eq=False)
class SceneSurfaces:
    """The clouds and meshes of a scene that the robot can reach.

    Attributes
    ----------
    arrays : tuple of int64 arrays
        The surfaces, as ``surface_tree`` makes them.
    numbers : tuple of int
        Of their obstacles in the scene.
    tested : int64 array, shape (surfaces, capsules)
        1 where a capsule is tested against a surface, else 0.
    capsules : float32 array, shape (capsules, 3)
        See `CAPSULE_ROW`.
    around : int64 array, optional
        A grid around many surfaces, see ``surface_around``.
    """

    arrays: tuple[Ints, ...]
    numbers: tuple[int, ...]
    tested: Ints
    capsules: npt.NDArray[np.float32]
    around: Ints | None = None
    _count: Ints = field(init=False, repr=False)
    _workspace: Ints = field(init=False, repr=False)

    def __post_init__(self) -> None:
        # At once, since worlds of several threads may share these surfaces.
        count, around = self.tested.sum(axis=0), 0 if self.around is None else address(self.around)
        rows = [len(self.arrays), address(self.capsules), around, address(count)]
        for array, flags, number in zip(self.arrays, self.tested, self.numbers, strict=True):
            rows += [address(array), address(flags), number]
        self.__dict__.update(_count=count, _workspace=np.array(rows, dtype=np.int64))

    def __reduce__(self) -> tuple[Any, ...]:
        """Return how a copy is made: it finds out for itself where its arrays are."""
        return SceneSurfaces, (self.arrays, self.numbers, self.tested, self.capsules, self.around)

    def added_to(self, ints: Ints, check: int) -> Ints:
        """Return tables of integers that name the surfaces, and the address of the check against them."""
        added = ints.copy()
        added[[at.SURFACES, at.SURFACE_CHECK]] = address(self._workspace), check
        # As the tables: code would be compiled anew for arrays that can be written to.
        added.setflags(write=False)
        return added


def scene_surfaces(scene: Scene, robot: RobotTables, tested: Bools) -> SceneSurfaces | None:
    """Return the clouds and meshes of a scene within a robot's reach [m], None where there are none.

    `tested` says which capsules are tested against which obstacles, (capsules, obstacles).
    """
    numbers = [
        number
        for number, obstacle in enumerate(scene.obstacles)
        if isinstance(obstacle.body, PointCloud | Mesh) and tested[:, number].any()
    ]
    bodies = tuple(scene.obstacles[number].body for number in numbers)
    return _surfaces(bodies, tuple(numbers), tested[:, numbers].tobytes(), robot)


@lru_cache(maxsize=16)
def _surfaces(
    bodies: tuple[PointCloud | Mesh, ...], numbers: tuple[int, ...], tested: bytes, robot: RobotTables
) -> SceneSurfaces | None:
    """Return these bodies as `scene_surfaces` does; kept, since the next world often has them, too."""
    arrays = [surface_of(body, robot.reach) for body in bodies]
    near = [index for index, array in enumerate(arrays) if array is not None]
    if not near:
        return None
    flags = np.frombuffer(tested, dtype=np.bool_).reshape(-1, len(bodies))[:, near]
    return SceneSurfaces(
        tuple(array for array in arrays if array is not None),
        tuple(numbers[index] for index in near),
        np.ascontiguousarray(flags.T, dtype=np.int64),
        _capsule_rows(robot.capsules),
        _around(tuple(bodies[index] for index in near), robot.reach) if len(near) >= MANY else None,
    )


def _capsule_rows(capsules: Sequence[PlacedCapsule]) -> npt.NDArray[np.float32]:
    halves = np.linalg.norm([capsule.half for capsule in capsules], axis=1)
    slack = [capsule.cover.radius - capsule.radius for capsule in capsules]
    return np.stack([slack, halves, 1.0 / np.maximum(halves**2, at.LEAST_SQUARE)], axis=1).astype(np.float32)


@lru_cache(maxsize=4)
def _around(bodies: tuple[PointCloud | Mesh, ...], reach: float) -> Ints:
    """Return the grid around several bodies that can be reached; kept, as they are."""
    return surface_around([array for body in bodies if (array := surface_of(body, reach)) is not None])


@lru_cache(maxsize=64)
def surface_of(body: PointCloud | Mesh, reach: float) -> Ints | None:
    """Return what a robot of this reach can touch of a body; kept, since the next scene often has it, too."""
    reached = reached_parts(body, reach)
    return None if reached is None else surface_array(*reached)


@lru_cache(maxsize=4)
def reached_parts(body: PointCloud | Mesh, reach: float) -> tuple[Floats, float, Grid] | None:
    """Return what a robot of this reach can touch of a body, None where that is nothing.

    These are points, (n, 1, 3), or triangles, (n, 3, 3), the radius by which they are widened, and the grid around.
    """
    if isinstance(body, PointCloud):
        points = body.pose.apply(body.points)
        points = points[np.linalg.norm(points, axis=1) <= reach + body.radius]
        if len(points) == 0:
            return None
        padding = OBSTACLE_PADDING * (float(np.linalg.norm(points, axis=1).max()) + body.radius)
        return points[:, np.newaxis], body.radius + padding, grid_of_points(points)
    mesh = body.triangles
    corners = body.pose.apply(mesh.vertices)[mesh.triangles]
    near = _within_reach(corners, reach)
    solid, turned = closed_parts(mesh)
    if len(near) == 0:
        return None
    padding = OBSTACLE_PADDING * float(np.linalg.norm(near, axis=2).max())
    return near, padding, grid_of_triangles(near, corners[solid], turned, reach)


def _within_reach(corners: Floats, reach: float) -> Floats:
    """Return the pieces of triangles, (n, 3, 3), that come within reach along each axis, see `PIECE`."""
    pieces = []
    while len(corners):
        touched = (np.abs(corners).min(axis=1) <= reach) | (corners.min(axis=1) * corners.max(axis=1) <= 0.0)
        corners = corners[touched.all(axis=1)]
        lengths = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2)
        large = lengths.max(axis=1, initial=0.0) > reach * PIECE
        pieces.append(corners[~large])
        longest = lengths[large].argmax(axis=1)
        # Longest sides first.
        turn = (longest[:, np.newaxis] + np.arange(3)) % 3
        a, b, c = np.take_along_axis(corners[large], turn[:, :, np.newaxis], axis=1).transpose(1, 0, 2)
        middle = 0.5 * (a + b)
        corners = np.concatenate([np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)])
    return np.concatenate(pieces) if pieces else np.empty((0, 3, 3))
