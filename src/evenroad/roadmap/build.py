"""Roadmap: points joined by a rule in a space, before any world is asked."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt

from evenroad.errors import InvalidValue
from evenroad.points.pointset import PointSet
from evenroad.roadmap.cost import EdgeCost
from evenroad.roadmap.ends import require_fitting
from evenroad.roadmap.rules import KNearest, Rule
from evenroad.roadmap.world_roadmap import WorldRoadmap
from evenroad.space import Space
from evenroad.world import World


@dataclass(frozen=True, eq=False)
class Roadmap:
    """Milestones and candidate edges for any world of one space; made by :meth:`build`, never changed.

    The rule joins all points, whether a world will find them valid or not; invalid ones fill some of the k places,
    so that a larger k than in `plan` is wise: 20 rather than 10.

    Attributes
    ----------
    space : Space
        Where the milestones are.
    points : PointSet
        Of its unit cube.
    rule : Rule
        Which joined them.
    configurations : ndarray, shape (n, dim)
        The milestones, in the order of the points; read-only.
    edges : ndarray of int32, shape (m, 2)
        Pairs of milestones to try, smaller first, ascending; read-only.
    """

    space: Space
    points: PointSet
    rule: Rule
    configurations: npt.NDArray[np.float64]
    edges: npt.NDArray[np.int32]

    @classmethod
    def build(cls, space: Space, points: PointSet, rule: Rule | None = None) -> Roadmap:
        """Join the points by the rule, by default ``KNearest(20)``; memory O(m).

        The graphs of the last 64 sets that came from a pool (the bank, or the user's cache) are kept for the process.

        Raises
        ------
        InvalidValue
            If the points do not have the dimension of the space's cube.
        """
        require_fitting(points, space)
        rule = KNearest(20) if rule is None else rule
        # The sets of a pool come again and again, others hardly ever; a user's own space may not be hashable.
        from_pool = points.origin.replica is not None and isinstance(space, Hashable)
        joined: Callable[..., Any] = _joined_once if from_pool and isinstance(rule, Hashable) else _joined
        return cls(space, points, rule, *joined(space, points, rule))

    def in_world(
        self, world: World, *, lazy_milestones: bool = False, edge_cost: EdgeCost | None = None
    ) -> WorldRoadmap:
        """Return this roadmap in a world, to be asked many queries.

        Parameters
        ----------
        world : World
            Of the same space.
        lazy_milestones : bool
            Do not check the milestones now but where they could lie on a path.  Starts and goals are then
            joined to the nearest of all milestones, else to the nearest of the valid ones.
        edge_cost : callable, optional
            As in `plan`.

        Raises
        ------
        InvalidValue
            If the world has another space: the points, or the distances along the edges, differ there.
        """
        self._require_space(world.space)
        return WorldRoadmap(self, world, lazy_milestones=lazy_milestones, edge_cost=edge_cost)

    def _require_space(self, space: Space) -> None:
        if space is self.space:
            return
        if (space.dim, space.cube_dim) == (self.space.dim, self.space.cube_dim):
            a, b = self.configurations[self.edges[:, 0]], self.configurations[self.edges[:, 1]]
            same_points = np.array_equal(space.from_cube(self.points.points), self.configurations)
            if same_points and np.array_equal(space.distance(a, b), self.space.distance(a, b)):
                return
        raise InvalidValue(f"the roadmap was built for {self.space!r}, the world has {space!r}")


def _joined(
    space: Space, points: PointSet, rule: Rule
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int32]]:
    """Return the milestones and the candidate edges, both read-only."""
    configurations = np.array(space.from_cube(points.points), dtype=np.float64)
    edges = rule.edges(configurations, space)
    for array in (configurations, edges):
        array.setflags(write=False)
    return configurations, edges


_joined_once = lru_cache(maxsize=64)(_joined)
