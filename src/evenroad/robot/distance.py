"""Distance: how far a robot is from contact, and which two bodies are nearest; of a configuration and along a path."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from evenroad._arrays import Floats
from evenroad._native.robot import Checker
from evenroad._shared import once_property
from evenroad.errors import InvalidValue
from evenroad.robot.kernel.native_scene import native_scene
from evenroad.robot.obstacle import MOST_CLEARANCE
from evenroad.robot.prepared_robots import prepared
from evenroad.robot.robot import Robot
from evenroad.robot.scene import Scene
from evenroad.space import JointSpace
from evenroad.space.batch import as_batch
from evenroad.space.path import resample
from evenroad.world.clearance import largest_kept
from evenroad.world.one_or_many import is_one


class Distance(NamedTuple):
    """The least distance of a robot's bodies from obstacles and from each other.

    Attributes
    ----------
    metres : float, or float64 ndarray, shape (n,)
        0.0 where two touch, also such as no joint moves, and > 0 in every free configuration; 1.0 where all are that
        far, or farther.
    pair : (str, str) or None, or list of n such
        Which two: a link and an obstacle, or two links; None where nothing is nearer than 1 m.
    """

    metres: Any
    pair: Any


MOST = 1.0
"""Distance from which on all is the same [m]."""

LEAST = 1e-9
"""Distance of what does not touch, where less than some micrometres is known of it [m]."""

WITH = ("nothing", "obstacle", "surface", "itself")
"""With what something is in contact, as the native kernel numbers it."""


class ArmDistances:
    """Distances of :class:`ArmWorld`."""

    if TYPE_CHECKING:
        robot: Robot
        scene: Scene
        resolution: float
        clearance: float
        explain: Any
        _row: Any
        _names: Any

        @property
        def space(self) -> JointSpace: ...  # noqa: D102

    @once_property
    def _measuring(self) -> Checker:
        """The native checks of this world as it is without a clearance, with the obstacles up to 1 m farther."""
        made = prepared(self.robot)
        scene = native_scene(made.native, made.tables, self.robot.links, self.scene, MOST)
        return Checker(made.native, scene, self.resolution, 0.0, False)

    @once_property
    def _bare(self) -> Any:
        """The same world without a clearance of its own."""
        world: Any = self
        return replace(world, clearance=0.0) if self.clearance else self

    @once_property
    def _unpadded(self) -> Any:
        """The same world without what is kept away beside contact: no clearance of it or of an obstacle, no padding."""
        kept = {each.name: 0.0 for each in self.scene.obstacles if each.clearance}
        if not (kept or self.robot.padding or self.clearance):
            return self
        world: Any = self
        bare = replace(self.robot, padding=())
        return replace(world, robot=bare, scene=self.scene.with_clearance(kept), clearance=0.0)

    def distance(self, q: Any) -> Distance:
        """Return how far the robot is from contact, and which two bodies are nearest.

        Bodies are those that the world plans with, without its clearance: capsules, against obstacles the spheres that
        cover them, or what decides in their place.  The distance is never larger than theirs, and some micrometres
        smaller at most; of a world without a clearance it is > 0 exactly where `valid` says so.  Pairs that may touch
        do not count.

        Parameters
        ----------
        q : array_like, shape (n, dim) or (dim,), mapping or str
            Configurations within the limits; a mapping or a named state is one.

        Returns
        -------
        Distance
            ``metres`` and ``pair``, of one configuration or of each.

        Raises
        ------
        InvalidValue
            As `valid`, or if a configuration is outside of the limits.

        Examples
        --------
        >>> import evenroad as er
        >>> er.ArmWorld("ur5", "box-reach").distance("home").pair
        ('forearm_link', 'wrist_2_link')
        """
        batch = as_batch("q", self._row(q)[np.newaxis] if is_one(q) else q, self.space.dim)
        metres, pairs = self._distances(batch)
        bare = self._bare
        if bare.fixed_contact is not None:
            pairs = [bare.fixed_contact] * len(batch)
        if (outside := np.flatnonzero(np.isnan(metres))).size:
            raise InvalidValue(f"q has no distance in row {outside[0]}: {self.explain(batch[outside[0]])}")
        metres = np.where(bare.valid(batch), np.maximum(metres, LEAST), 0.0)
        return Distance(float(metres[0]), pairs[0]) if is_one(q) else Distance(metres, pairs)

    def _distances(self, q: Floats, *, to_itself: bool = True) -> Distance:
        """Return the distances of configurations, (n, dim); without `to_itself` those from obstacles alone."""
        metres, nearest = self._measuring.distances(q, MOST, to_itself)
        return Distance(
            metres, [self._names(WITH[kind], *of, anew=True) if kind else None for kind, *of in nearest.tolist()]
        )

    def nearest_along(self, path: Floats) -> tuple[str, str] | None:
        """Return the link and the obstacle that come nearest to each other along a path, (p, dim); None beyond 1 m."""
        metres, pairs = self._unpadded._distances(resample(path, self.space, self.resolution / 4.0)[0], to_itself=False)
        pair: tuple[str, str] | None = pairs[int(metres.argmin())]
        return pair

    def path_clearance(self, path: Floats) -> float | None:
        """Return the distance from obstacles that a path, (p, dim), is proved to keep, to 0.1 mm; None if none [m].

        The clearances of obstacles and the padding of links are part of it.
        """

        def keeps(distance: float) -> bool:
            return bool(replace(self._unpadded, clearance=distance).validate(path).all())

        return largest_kept(keeps, self.clearance, MOST_CLEARANCE, 1e-4)
