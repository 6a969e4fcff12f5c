"""Roadmaps: points and the edges between them, for all worlds of a space."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from evenroad._arrays import Floats, Ints, Ints32
from evenroad._call import explains_calls
from evenroad._npz import Path
from evenroad._shared import state_without
from evenroad.errors import InvalidValue
from evenroad.points.pointset import PointSet
from evenroad.roadmap.edges import EdgeCost, edge_costs
from evenroad.roadmap.neighbours import Surroundings
from evenroad.roadmap.rules import Rule
from evenroad.roadmap.search import (
    FixedPoint,
    Graph,
    graph_of,
)
from evenroad.space import Space
from evenroad.world import World

if TYPE_CHECKING:
    from evenroad.planning.world_roadmap import WorldRoadmap


class EdgeWeights(NamedTuple):
    """Edge weights of a roadmap: integers, (m,), in a unit that is large enough for nearly all links."""

    longest: float
    unit: FixedPoint
    weights: Ints


@explains_calls
@dataclass(frozen=True, eq=False, repr=False)
class Roadmap:
    """Milestones and edges for any world of one space, made by ``er.build_roadmap``; it never changes.

    The rule joins all points, valid or not.  Invalid ones are some of the k neighbours, so use a larger k than in
    `plan`: 20 rather than 10.

    Attributes
    ----------
    points : PointSet
        Points of the unit cube of the space.
    rule : Rule
        The rule that joins milestones.
    milestones : ndarray, shape (n, dim)
        Their configurations, read-only.
    edges : ndarray of int32, shape (m, 2)
        Pairs of milestones that are joined, smaller row first, ascending; read-only.
    space : Space, optional
        None in a roadmap from a file: the first world sets it.
    measured : ndarray, shape (m,), optional
        Lengths of the edges, if they were read from a file.
    """

    points: PointSet
    rule: Rule
    milestones: Floats
    edges: Ints32
    space: Space | None = None
    measured: Floats | None = None

    def __repr__(self) -> str:
        return f"Roadmap({len(self.milestones)} milestones, {len(self.edges)} edges, {self.rule})"

    @cached_property
    def lengths(self) -> Floats:
        """Lengths of the edges in the metric of the space, (m,), measured on first use; read-only."""
        if self.measured is not None:
            return self.measured
        assert self.space is not None
        lengths = edge_costs(self.space, self.milestones, self.edges)
        lengths.setflags(write=False)
        return lengths

    def __getstate__(self) -> dict[str, object]:
        """Return the state to pickle; another process makes its own graph."""
        return state_without(self, ["graph"])

    @cached_property
    def graph(self) -> Graph:
        """The edges by node."""
        return graph_of(len(self.milestones), self.edges)

    @cached_property
    def surroundings(self) -> Surroundings:
        """The milestones, with a query for those near a configuration."""
        assert self.space is not None
        return Surroundings(self.milestones, self.space)

    @cached_property
    def edge_weights(self) -> EdgeWeights:
        """The edge weights if costs are lengths."""
        return self.weighted(self.lengths)

    def weighted(self, costs: Floats) -> EdgeWeights:
        """Return the edge weights for these costs, (m,)."""
        n = len(self.milestones)
        # The largest distance between two milestones.
        across = 2.0 * float(self.surroundings.distances(self.milestones[0]).max()) if n else 0.0
        longest = max(float(costs.max(initial=0.0)), across)
        unit = FixedPoint.of(longest, n + 2)
        return EdgeWeights(longest, unit, unit.weights(costs))

    def within(self, world: World, *, edge_cost: EdgeCost | None = None) -> WorldRoadmap:
        """Return a planner in a world for many queries.  It keeps the result of every check; threads may share it.

        Parameters
        ----------
        world : World
            The world.  Milestones are checked now, edges when a query needs them.
        edge_cost : callable, optional
            As in :class:`evenroad.PRM`.

        Raises
        ------
        InvalidValue
            If the world has another space, in which points or distances differ.

        Examples
        --------
        >>> import evenroad as er
        >>> world = er.ArmWorld("ur5", "box-reach")
        >>> cell = er.build_roadmap(world, 1024).within(world)
        >>> er.plan(world, "home", "inside", cell).proof
        'certified'
        """
        if not self._fits(world.space):
            raise InvalidValue(
                f"the roadmap was built for another space than {world.space!r}: other joints, other limits or another"
                " metric; build it in a world of this space"
            )
        roadmap = replace(self, space=world.space) if self.space is None else self
        from evenroad.planning.world_roadmap import WorldRoadmap

        return WorldRoadmap(roadmap, world, edge_cost=edge_cost)

    def _fits(self, space: Space) -> bool:
        if space is self.space or space == self.space:
            return True
        if (space.dim, space.cube_dim) != (self.milestones.shape[1], self.points.d):
            return False
        a, b = self.milestones[self.edges[:, 0]], self.milestones[self.edges[:, 1]]
        same_points = np.array_equal(space.from_cube(self.points.points), self.milestones)
        return same_points and np.array_equal(space.distance(a, b), self.lengths)

    def save(self, file: Path) -> None:
        """Write its points, rule, milestones and edges, atomically; ``er.load_roadmap`` reads them.

        Raises BrokenFile if the file cannot be written; an earlier file is then untouched.
        """
        from evenroad.roadmap.npz import save_roadmap

        save_roadmap(file, self)
