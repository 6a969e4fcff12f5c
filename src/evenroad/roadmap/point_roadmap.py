"""Roadmaps that are built once and queried often; and roadmaps of points, for any world of a space."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Hashable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any, NamedTuple

import numpy as np

from evenroad._arrays import Floats, Ints, Ints32
from evenroad._npz import Path
from evenroad.errors import InvalidValue
from evenroad.points.pointset import PointSet
from evenroad.roadmap.budget import Budget
from evenroad.roadmap.connector import Smooth
from evenroad.roadmap.neighbours import Surroundings
from evenroad.roadmap.points_of import as_points
from evenroad.roadmap.problem import Problem
from evenroad.roadmap.query import EdgeCost, edge_costs
from evenroad.roadmap.result import PlanResult
from evenroad.roadmap.rules import KNearest, Rule
from evenroad.roadmap.search import FixedPoint, Graph, graph_of
from evenroad.space import Space
from evenroad.world import World


class EdgeWeights(NamedTuple):
    """Edge weights of a roadmap, as integers (m,) of a unit that is large enough for nearly all links."""

    longest: float
    unit: FixedPoint
    weights: Ints


class Roadmap(ABC):
    """Milestones and edges, built once by ``er.build_roadmap`` and queried in many worlds; never changed.

    Attributes
    ----------
    milestones : ndarray, shape (n, dim)
        Configurations, read-only.
    edges : ndarray of int32, shape (m, 2)
        Pairs of milestones that are joined, smaller row first, ascending; read-only.
    """

    milestones: Floats
    edges: Ints32

    @abstractmethod
    def within(self, world: Any) -> WorldRoadmap:
        """Return a planner in a world.  It keeps the result of every check, and threads may share it."""

    @abstractmethod
    def save(self, file: Path) -> None:
        """Write it to a file, atomically; ``er.load_roadmap`` reads it.  Raises BrokenFile if it cannot be written."""

    @abstractmethod
    def _of(self) -> str:
        """Return a few words for the repr."""

    def __repr__(self) -> str:
        return f"Roadmap({len(self.milestones)} milestones, {len(self.edges)} edges, of {self._of()})"


class WorldRoadmap(ABC):
    """A roadmap in one world: a planner that keeps the result of every check; made by :meth:`Roadmap.within`."""

    roadmap: Roadmap
    world: World

    @abstractmethod
    def plan(self, start: Any, goal: Any, *, budget: Budget | None = None, smooth: Smooth = True) -> PlanResult:
        """Find a path from a start to a goal, or one of several; nothing is checked twice."""

    @abstractmethod
    def solve(self, problem: Problem) -> PlanResult:
        """Plan along the roadmap, in its world, as planners of :func:`evenroad.plan` do."""

    def __repr__(self) -> str:
        return f"{self.roadmap!r}.within({self.world!r})"


@dataclass(frozen=True, eq=False, repr=False)
class PointRoadmap(Roadmap):
    """A roadmap of points, for any world of one space.

    The rule joins all points, valid or not.  Invalid ones take some of the k neighbours, so a larger k than in `plan`
    is wise: 20 rather than 10.

    Attributes
    ----------
    points : PointSet
        Points of the unit cube of the space; `milestones` are their configurations.
    rule : Rule
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

    def _of(self) -> str:
        return f"{self.points.n} points, {self.rule}"

    @cached_property
    def lengths(self) -> Floats:
        """Lengths of the edges in the metric of the space, (m,), measured on first use; read-only."""
        if self.measured is not None:
            return self.measured
        assert self.space is not None
        lengths = edge_costs(self.space, self.milestones, self.edges)
        lengths.setflags(write=False)
        return lengths

    def __getstate__(self) -> dict[str, Any]:
        """Return what is sent to another process, which makes a graph of its own."""
        return {name: value for name, value in self.__dict__.items() if name != "graph"}

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
        """The edge weights where costs are lengths."""
        return self.weighted(self.lengths)

    def weighted(self, costs: Floats) -> EdgeWeights:
        """Return the edge weights for these costs, (m,)."""
        n = len(self.milestones)
        # Two milestones are at most this far apart.
        across = 2.0 * float(self.surroundings.distances(self.milestones[0]).max()) if n else 0.0
        longest = max(float(costs.max(initial=0.0)), across)
        unit = FixedPoint.of(longest, n + 2)
        return EdgeWeights(longest, unit, unit.weights(costs))

    def within(self, world: World, *, edge_cost: EdgeCost | None = None) -> WorldRoadmap:
        """Return this roadmap in a world, for many queries.

        Milestones are checked now, edges when a query needs them.  An `edge_cost` is as in :class:`evenroad.PRM`.

        Raises InvalidValue if the world has another space: the points, or the distances, differ there.
        """
        if not self._fits(world.space):
            raise InvalidValue(f"the roadmap was built for another space than {world.space!r}")
        roadmap = replace(self, space=world.space) if self.space is None else self
        from evenroad.roadmap.point_world_roadmap import PointWorldRoadmap

        return PointWorldRoadmap(roadmap, world, edge_cost=edge_cost)

    def _fits(self, space: Space) -> bool:
        if space is self.space or space == self.space:
            return True
        if (space.dim, space.cube_dim) != (self.milestones.shape[1], self.points.d):
            return False
        a, b = self.milestones[self.edges[:, 0]], self.milestones[self.edges[:, 1]]
        same_points = np.array_equal(space.from_cube(self.points.points), self.milestones)
        return same_points and np.array_equal(space.distance(a, b), self.lengths)

    def save(self, file: Path) -> None:
        """Write its points, rule, milestones and edges; see :meth:`Roadmap.save`."""
        from evenroad.roadmap.npz import save_point_roadmap

        save_point_roadmap(file, self)


def roadmap_of_points(space: Space, points: PointSet | int, rule: Rule | None = None) -> PointRoadmap:
    """Join the points, or this number of even ones, by the rule, by default ``KNearest(20)``, or 2 d; memory O(m).

    The graphs of the last 64 sets of a pool (the bank, or the user's cache) stay in memory.  Raises InvalidValue if the
    points do not have the dimension of the space's cube.
    """
    points = as_points(points, space, rule)
    rule = KNearest(max(20, 2 * space.cube_dim)) if rule is None else rule
    # Sets of a pool come again and again, others hardly ever; a user's own space may not be hashable.
    from_pool = points.origin.replica is not None and isinstance(space, Hashable)
    joined: Callable[..., Any] = _joined_once if from_pool and isinstance(rule, Hashable) else _joined
    milestones, edges = joined(space, points, rule)
    return PointRoadmap(points, rule, milestones, edges, space)


def _joined(space: Space, points: PointSet, rule: Rule) -> tuple[Floats, Ints32]:
    """Return the milestones and the candidate edges, both read-only."""
    configurations = np.array(space.from_cube(points.points), dtype=np.float64)
    edges = rule.edges(configurations, space)
    for array in (configurations, edges):
        array.setflags(write=False)
    return configurations, edges


_joined_once = lru_cache(maxsize=64)(_joined)
