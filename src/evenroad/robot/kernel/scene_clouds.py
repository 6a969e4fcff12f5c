"""SceneClouds: the clouds of a scene as compiled code reads them, by addresses that are found out where it runs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt

from evenroad.geometry.shapes import PointCloud
from evenroad.robot.kernel import layout as at
from evenroad.robot.kernel.addresses import address
from evenroad.robot.kernel.cloud_tree import cloud_array
from evenroad.robot.kernel.placed_capsules import PlacedCapsule
from evenroad.robot.kernel.scene_tables import OBSTACLE_PADDING
from evenroad.robot.scene import Scene

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Bools = npt.NDArray[np.bool_]

DESK, CLOUD_ROW = 2, 3
"""The desk: how many clouds there are, where capsules' floats are; of each cloud its array, the flags of the capsules
that are tested against it, and the number of its obstacle."""

CAPSULE_ROW = 3
"""By how much the spheres over a capsule are larger than it, half its length, one over the square of that."""


@dataclass(frozen=True, eq=False)
class SceneClouds:
    """The clouds of a scene that the robot can reach.

    Attributes
    ----------
    arrays : tuple of int64 arrays
        The clouds, as ``cloud_tree`` makes them.
    numbers : tuple of int
        Of their obstacles in the scene.
    tested : int64 array, shape (clouds, capsules)
        1 where a capsule is tested against a cloud, else 0.
    capsules : float32 array, shape (capsules, 3)
        See `CAPSULE_ROW`.
    fixed_contact : tuple of 2 int, or None
        A capsule that does not move and an obstacle that it touches.
    """

    arrays: tuple[Ints, ...]
    numbers: tuple[int, ...]
    tested: Ints
    capsules: npt.NDArray[np.float32]
    fixed_contact: tuple[int, int] | None

    def __reduce__(self) -> tuple[Any, ...]:
        """Return how a copy is made: it finds out for itself where its arrays are."""
        return SceneClouds, (self.arrays, self.numbers, self.tested, self.capsules, self.fixed_contact)

    @cached_property
    def _desk(self) -> Ints:
        rows = [len(self.arrays), address(self.capsules)]
        for array, flags, number in zip(self.arrays, self.tested, self.numbers, strict=True):
            rows += [address(array), address(flags), number]
        return np.array(rows, dtype=np.int64)

    def added_to(self, ints: Ints, check: int) -> Ints:
        """Return tables of integers that name the clouds, and the address of the check against them."""
        added = ints.copy()
        added[[at.CLOUDS, at.CLOUD_CHECK]] = address(self._desk), check
        # As the tables: code would be compiled anew for arrays that can be written to.
        added.setflags(write=False)
        return added


def scene_clouds(
    scene: Scene, capsules: Sequence[PlacedCapsule], reach: float, tested: Bools
) -> SceneClouds | None:
    """Return the clouds of a scene within a robot's reach [m], None where there are none.

    `tested` says which capsules are tested against which obstacles, (capsules, obstacles).
    """
    found = {
        number: array
        for number, obstacle in enumerate(scene.obstacles)
        if isinstance(obstacle.body, PointCloud)
        and tested[:, number].any()
        and (array := _array(obstacle.body, reach)) is not None
    }
    if not found:
        return None
    halves = np.linalg.norm([capsule.half for capsule in capsules], axis=1)
    slack = [capsule.cover.radius - capsule.radius for capsule in capsules]
    floats = np.stack([slack, halves, 1.0 / np.maximum(halves**2, at.LEAST_SQUARE)], axis=1)
    flags = np.ascontiguousarray(tested[:, list(found)].T, dtype=np.int64)
    fixed = (
        (i, number)
        for number in found
        for i, capsule in enumerate(capsules)
        if capsule.frame == 0
        and tested[i, number]
        and _touches(scene.obstacles[number].body, *map(tuple, capsule.ends.tolist()), capsule.radius)
    )
    return SceneClouds(
        tuple(found.values()), tuple(found), flags, floats.astype(np.float32), next(fixed, None)
    )


@lru_cache(maxsize=16)
def _array(cloud: PointCloud, reach: float) -> Ints | None:
    """Return what a robot of this reach can touch of a cloud; kept, since the next scene often has it, too."""
    points = cloud.pose.apply(cloud.points)
    points = points[np.linalg.norm(points, axis=1) <= reach + cloud.radius]
    if len(points) == 0:
        return None
    padding = OBSTACLE_PADDING * (float(np.abs(points).max()) + cloud.radius) * 3.0**0.5
    return cloud_array(points, cloud.radius + padding)


@lru_cache(maxsize=64)
def _touches(cloud: PointCloud, a: tuple[float, ...], b: tuple[float, ...], radius: float) -> bool:
    """Return whether a capsule touches a cloud."""
    start, along = np.array(a), np.subtract(b, a)
    apart = cloud.pose.apply(cloud.points) - start
    share = np.clip(apart @ along / max(float(along @ along), at.LEAST_SQUARE), 0.0, 1.0)
    squared = ((apart - share[:, np.newaxis] * along) ** 2).sum(axis=1)
    return bool(squared.min() < (radius + cloud.radius) ** 2)
