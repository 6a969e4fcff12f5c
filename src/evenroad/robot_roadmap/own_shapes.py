"""The robot's own shapes, asked by coal where its capsules touch: they contain the shapes, and so refuse more."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from evenroad._arrays import Bools, Floats, set_fields
from evenroad.geometry.shapes import PointCloud, Shape
from evenroad.robot import ArmWorld
from evenroad.robot.arm_world import RECHECK_TOLERANCE
from evenroad.robot.reference.coal_world import CoalWorld
from evenroad.robot.reference.recheck import FINER
from evenroad.space import JointSpace


@dataclass(frozen=True, eq=False)
class OwnShapesWorld:
    """A robot that is free where its capsules are or, else, its own shapes are.

    What the capsules prove is free without a question to coal; other motions are checked at states a tenth of the
    resolution apart.  `shapes` are as of :func:`evenroad.robot.reference.coal_world.original_shapes`.  Raises what
    CoalWorld does.  Clouds block as they do for capsules alone: coal knows none.
    """

    backend: ClassVar[str] = "coal"
    proof: ClassVar[str] = "resolution"
    """Of a path whose motions the capsules do not all prove."""

    capsules: ArmWorld
    shapes: Sequence[Shape]
    _coal: CoalWorld = field(init=False, repr=False)
    _clouds: ArmWorld | None = field(init=False, repr=False)

    def __post_init__(self) -> None:
        world = self.capsules
        scene, resolution = world.scene, world.resolution
        names = [each.name for each in scene.obstacles if isinstance(each.body, PointCloud)]
        others = [each.name for each in scene.obstacles if each.name not in names]
        clouds = ArmWorld(world.robot, scene.without(*others), resolution=resolution) if names else None
        coal = CoalWorld(world.robot, scene.without(*names), self.shapes, resolution / FINER)
        set_fields(self, _coal=coal, _clouds=clouds)

    @property
    def space(self) -> JointSpace:
        """The joints' ranges."""
        return self.capsules.space

    def valid(self, q: Floats) -> Bools:
        """Return which configurations, (n, dim), are free: (n,)."""
        free = self.capsules.valid(q)
        left = np.flatnonzero(~free)
        if self._clouds is not None:
            left = left[self._clouds.valid(q[left])]
        free[left] = self._coal.valid(q[left])
        return free

    def motion_certified(self, a: Floats, b: Floats, tolerance: float) -> Bools:
        """Return which motions, (m, dim) each, are proved free for the capsules, or free at states for the shapes."""
        free = self.capsules.motion_certified(a, b, tolerance)
        left = np.flatnonzero(~free)
        if self._clouds is not None:
            left = left[self._clouds.motion_certified(a[left], b[left], tolerance)]
        free[left] = self._coal.motion_valid(a[left], b[left])
        return free

    def motion_valid(self, a: Floats, b: Floats) -> Bools:
        """Return which motions, (m, dim) each, are free: (m,)."""
        return self.motion_certified(a, b, RECHECK_TOLERANCE)

    def shorten(self, path: Floats) -> tuple[Floats, int]:
        """Return a path that is not longer, its new motions proved for the capsules, and how many were looked at."""
        return self.capsules.shorten(path)

    def explain(self, q: Floats) -> str:
        """Return in words why one configuration, (dim,), is not free."""
        if self._clouds is not None and not self._clouds.valid(q[np.newaxis])[0]:
            return self._clouds.explain(q)
        return self._coal.explain(q)
