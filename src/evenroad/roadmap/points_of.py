"""The points of a roadmap in a space if only their number is given."""

from __future__ import annotations

import numpy as np

from evenroad._checks import require_count
from evenroad._rng import RngLike
from evenroad.errors import InvalidValue, shown
from evenroad.points.pointset import PointSet
from evenroad.roadmap.rules import Rule
from evenroad.space import SO3, BoxSpace, Product, Space

SPARSE = 6
"""Number of neighbours up to which poses are chosen for connectivity rather than for coverage."""


def as_points(points: PointSet | int, space: Space, rule: Rule | None = None, *, rng: RngLike = 0) -> PointSet:
    """Return points of the space's cube: those given, or this many for the rule; InvalidValue for anything else."""
    if not isinstance(points, PointSet):
        if isinstance(points, bool) or not isinstance(points, int | np.integer):
            raise InvalidValue(
                "points must be a PointSet, such as draw('even', 512, 2) or PointSet(array), or how many to draw,"
                f" got {shown(points)}"
            )
        points = even_points(require_count("points", points), space, rule, rng=rng)
    if points.d != space.cube_dim:
        raise InvalidValue(f"the points have d={points.d}, the space has {space.cube_dim} dimensions")
    return points


def even_points(n: int, space: Space, rule: Rule | None = None, *, rng: RngLike = 0) -> PointSet:
    """Return n points of the space's cube: `even`, but other ones in SE(3).

    In SE(3) evenness gains nothing: points are `sliced` for a rule of at most 6 neighbours, else scrambled Sobol
    points.
    """
    # Imported late: most plans draw no points.
    from evenroad.points.samplers import make_sampler
    from evenroad.points.samplers.even import Sliced

    d = space.cube_dim
    k = None if rule is None else rule.reach(n, space).k
    parts = space.parts if isinstance(space, Product) else ()
    if [(type(part), part.dim) for part in parts] == [(BoxSpace, 3), (SO3, 4)]:
        return (Sliced() if k is not None and k <= SPARSE else make_sampler("sobol")).draw(n, d, rng=rng)
    return make_sampler("even").draw(n, d, rng=rng)
