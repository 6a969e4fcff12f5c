"""Makers of roadmaps: a rule joins points of a space's cube."""

from __future__ import annotations

from collections.abc import Hashable
from functools import lru_cache

import numpy as np

from evenroad._arrays import Floats, Ints32
from evenroad._call import explains_calls
from evenroad.points.pointset import PointSet
from evenroad.roadmap.points_of import as_points
from evenroad.roadmap.roadmap import Roadmap
from evenroad.roadmap.rules import KNearest, Rule
from evenroad.space import Space
from evenroad.world import World


@explains_calls
def build_roadmap(world: World, points: int | PointSet, *, rule: Rule | None = None) -> Roadmap:
    """Build a roadmap for many queries in a world, and in other worlds of the same space.

    Its edges are candidates.  A query checks the edges that it needs, and proves those of its answer.

    Parameters
    ----------
    world : World
        A world with the space of the roadmap; its obstacles do not matter.
    points : int or PointSet
        The milestones, in the unit cube of the space, or a number of even ones.
    rule : Rule, optional
        How milestones are joined.  Default: the 20 nearest, or 2 d.

    Returns
    -------
    Roadmap
        ``roadmap.within(world)`` plans, ``roadmap.save(file)`` writes it.

    Raises
    ------
    InvalidValue
        If an argument is no such value.

    See Also
    --------
    evenroad.plan_many : Many queries of an arm at once.
    evenroad.Replanner : One query of an arm again and again, among obstacles that move.

    Examples
    --------
    >>> import evenroad as er
    >>> world = er.FunctionWorld(er.spaces.Rectangle((0, 0), (1, 0), (0, 1)), lambda q: q[:, 0] < 2, resolution=0.1)
    >>> er.build_roadmap(world, 64).within(world).plan((0.1, 0.1), (0.9, 0.9)).solved
    True
    """
    return roadmap_of_points(world.space, points, rule)


def roadmap_of_points(space: Space, points: PointSet | int, rule: Rule | None = None) -> Roadmap:
    """Join the points, or this number of even ones, by the rule; memory is O(m).

    The default rule is ``KNearest(20)``, or 2 d if that is more.  The graphs of the last 64 sets of a pool (the bank,
    or the user's cache) stay in memory.  Raises InvalidValue if the points do not have the dimension of the space's
    cube.
    """
    points = as_points(points, space, rule)
    rule = KNearest(max(20, 2 * space.cube_dim)) if rule is None else rule
    # Only sets of a pool are used repeatedly. A user's own space may not be hashable.
    from_pool = points.origin.replica is not None
    if from_pool and isinstance(space, Hashable) and isinstance(rule, Hashable):
        milestones, edges = _joined_once(space, points, rule)
    else:
        milestones, edges = _joined(space, points, rule)
    return Roadmap(points, rule, milestones, edges, space)


def _joined(space: Space, points: PointSet, rule: Rule) -> tuple[Floats, Ints32]:
    """Return the milestones and the candidate edges, both read-only."""
    configurations = np.array(space.from_cube(points.points), dtype=np.float64)
    edges = rule.edges(configurations, space)
    for array in (configurations, edges):
        array.setflags(write=False)
    return configurations, edges


_joined_once = lru_cache(maxsize=64)(_joined)
