"""Certificates of point sets with a rule, of saved roadmaps, and of one query's graph."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import lru_cache

import numpy as np

from evenroad._arrays import Bools, Floats, Ints32
from evenroad._checks import require_count
from evenroad.errors import InvalidValue, NotAvailable
from evenroad.points.measures.covering import DispersionBounds, dispersion_bounds
from evenroad.points.pointset import PointSet
from evenroad.roadmap.certificate import SAFE, Certificate
from evenroad.roadmap.edges import LINKS, links_among
from evenroad.roadmap.neighbours import BLOCK, flat_metric
from evenroad.roadmap.roadmap import Roadmap
from evenroad.roadmap.rules import Complete, KNearest, Radius, Reach, Rule
from evenroad.space import Space
from evenroad.space.protocol import all_distances


def certify(points: PointSet, rule: Rule, space: Space, *, links: int | None = LINKS, goals: int = 1) -> Certificate:
    """Return the guarantees of ``plan(world, start, goal, points, rule=rule)`` in every world of the space.

    Parameters
    ----------
    points : PointSet
        Points of the space's cube.
    rule : KNearest, Radius or Complete
        Other rules guarantee nothing before the world is known: use :func:`evenroad.plan` with ``certify=True``.
    space : Space
        A space with a flat metric.
    links, goals
        The number of milestones that start and goals are linked to, as for :func:`evenroad.plan`, and the largest
        number of goals.

    Raises
    ------
    InvalidValue
        If the points do not have the dimension of the space's cube.
    NotAvailable
        If the metric is not flat, or the rule is another one.
    """
    bounds = bounds_in(points, space)
    goals = require_count("goals", goals)
    turn = _half_turn(space)
    if isinstance(rule, Radius):
        r = min(rule.r, turn)
        return Certificate(bounds.upper, bounds.lower, r, r, True)
    if isinstance(rule, Complete):
        return Certificate(bounds.upper, bounds.lower, turn, turn, True)
    if not isinstance(rule, KNearest):
        raise NotAvailable(
            f"the rule {rule} promises nothing before the world is known: certify k=K symmetrised, radius=R or"
            " complete, or let plan(..., certify=True) certify one answer"
        )
    return _by_neighbours(points, rule.k, space, bounds, links, goals, turn)


def certify_roadmap(roadmap: Roadmap, *, links: int | None = LINKS) -> Certificate:
    """Return the guarantees of a saved roadmap's queries in every world; errors are those of :func:`certify`.

    Raises InvalidValue also for a roadmap from a file that has not been used within a world.
    """
    if (space := roadmap.space) is None:
        raise InvalidValue("the roadmap is from a file: certify that of roadmap.within(world).roadmap")
    bounds, turn = bounds_in(roadmap.points, space), _half_turn(space)
    reach = roadmap.rule.reach(roadmap.points.n, space)
    n = roadmap.points.n
    most = n if reach == Reach() else max(links_among(n, links), reach.k or 0)
    to_terminals = max(reach.radius or 0.0, linked_within(roadmap.milestones, most, space, bounds.upper))
    between = _nearest_untried(roadmap.milestones, roadmap.edges, space)
    return Certificate(bounds.upper, bounds.lower, min(between, turn), min(to_terminals, turn), True)


def certify_graph(points: PointSet, space: Space, configurations: Floats, edges: Ints32, terminals: int) -> Certificate:
    """Return a graph's guarantees for its own start and goals, the last rows of `configurations`, (n, dim).

    The other rows are at least the valid ones of `points`.
    """
    bounds, turn = bounds_in(points, space), _half_turn(space)
    n = len(configurations) - terminals
    inner = edges[:, 1] < n
    between = _nearest_untried(configurations[:n], edges[inner], space)
    tried = np.zeros((terminals, len(configurations)), dtype=np.bool_)
    tried[edges[~inner, 1] - n, edges[~inner, 0]] = True
    away, tried, direct = all_distances(space, configurations[n:], configurations[:n]), tried[:, :n], tried[1:, n]
    to_end = SAFE * float(np.min(away[~tried], initial=math.inf))
    if n and to_end < bounds.upper and not tried[np.arange(terminals), away.argmin(axis=1)].all():
        # An unknown rule may not even join a terminal to its nearest milestone.
        between = 0.0
    return Certificate(bounds.upper, bounds.lower, min(between, turn), min(to_end, turn), bool(direct.all()))


def bounds_in(points: PointSet, space: Space) -> DispersionBounds:
    """Return certified bounds of the dispersion of milestones over their space; errors as :func:`certify`."""
    if points.d != space.cube_dim:
        raise InvalidValue(f"the points have d={points.d}, the space has {space.cube_dim} dimensions")
    sides, wrapping = _box_of(space)
    return _bounds_once(points, tuple(sides), tuple(wrapping))


@lru_cache(maxsize=64)
def _bounds_once(points: PointSet, sides: tuple[float, ...], wrapping: tuple[bool, ...]) -> DispersionBounds:
    return dispersion_bounds(points, sides=sides, wrapping=wrapping)


def _box_of(space: Space) -> tuple[Floats, Bools]:
    """Return the sides of the space's cube in its metric, (d,), and which wrap; NotAvailable if it is not flat."""
    metric, d = flat_metric(space), space.cube_dim
    if metric is None or space.dim != d:
        raise NotAvailable(
            f"a certificate needs a space whose metric is flat, not {type(space).__name__}: there is no bound of the"
            " dispersion for others"
        )
    origin = space.from_cube(np.zeros((1, d)))
    # The longest distance on an axis that wraps is half a side.
    sides = 2.0 * space.distance(np.repeat(origin, d, axis=0), space.from_cube(0.5 * np.eye(d)))
    some = 0.5 * np.random.default_rng(0).random((32, d))
    measured = space.distance(np.repeat(origin, len(some), axis=0), space.from_cube(some))
    if not np.allclose(measured, np.linalg.norm(some * sides, axis=1), rtol=1e-9):
        raise NotAvailable(f"a certificate needs a space that is a box, which {space!r} is not")
    return sides, metric.wrapping


def _half_turn(space: Space) -> float:
    """Return the length from which a motion may go in the other direction; inf if nothing wraps."""
    sides, wrapping = _box_of(space)
    return 0.5 * SAFE * float(sides[wrapping].min(initial=math.inf))


def _by_neighbours(
    points: PointSet, k: int, space: Space, bounds: DispersionBounds, links: int | None, goals: int, turn: float
) -> Certificate:
    """Return the certificate of the k nearest, symmetrised, among the valid milestones, start and goals.

    A milestone x has y among its k nearest if fewer than k others are as near.  These can be k - 2 - goals milestones,
    the start and the goals.  So a pair is tried if it is nearer than the (k - goals)-th milestone is to one of the two.
    For a terminal near x the others can be k - 1 - goals milestones and the other terminals, so its distance from x
    has the same bound.
    """
    q = space.from_cube(points.points)
    rank, n = k - goals, points.n
    if rank < 1:
        raise NotAvailable(f"k={k} promises nothing with {goals} goal(s): k has to be above {goals}")
    if rank >= n:
        return Certificate(bounds.upper, bounds.lower, turn, turn, False)
    reach = _ranked(q, rank, space)
    to_terminals = max(SAFE * float(reach.min()), linked_within(q, links_among(n, links), space, bounds.upper))
    between = math.inf
    for rows, away in _rows(q, space):
        untried = away >= np.maximum(reach[rows, np.newaxis], reach)
        between = min(between, float(np.min(away[untried], initial=math.inf)))
    return Certificate(bounds.upper, bounds.lower, min(SAFE * between, turn), min(to_terminals, turn), False)


def linked_within(q: Floats, most: int, space: Space, dispersion: float) -> float:
    """Return a length up to which a terminal is linked to all milestones, if it is linked to its `most` nearest."""
    if not 0 < most < len(q):
        return 0.0 if most == 0 else math.inf
    # The ball around a terminal lies in the ball around its nearest milestone that is larger by the dispersion.
    return SAFE * float(_ranked(q, most, space).min()) - dispersion


def _ranked(q: Floats, rank: int, space: Space) -> Floats:
    """Return the distance of each row of `q` from its `rank`-th nearest other row, (n,); inf if there are fewer."""
    if rank >= len(q):
        return np.full(len(q), math.inf)
    # Copied, because a column would keep all of its block in memory.
    return np.concatenate([np.partition(away, rank - 1, axis=1)[:, rank - 1].copy() for _, away in _rows(q, space)])


def _nearest_untried(q: Floats, edges: Ints32, space: Space) -> float:
    """Return a length below that of every pair of rows of `q` that is no edge, (m, 2); inf if all are edges."""
    n = len(q)
    tried = np.sort(edges[:, 0].astype(np.int64) * n + edges[:, 1])
    tried = np.concatenate([tried, np.sort(edges[:, 1].astype(np.int64) * n + edges[:, 0])])
    least = math.inf
    for rows, away in _rows(q, space):
        mine = tried[(tried >= rows.start * n) & (tried < rows.stop * n)] - rows.start * n
        away.reshape(-1)[mine] = math.inf
        least = min(least, float(away.min(initial=math.inf)))
    return SAFE * least


def _rows(q: Floats, space: Space) -> Iterator[tuple[slice, Floats]]:
    """Yield ranges of rows with their distances from all rows, (rows, n), infinite from themselves."""
    n = len(q)
    step = max(1, 16 * BLOCK // max(n, 1))
    for begin in range(0, n, step):
        rows = slice(begin, min(begin + step, n))
        away = all_distances(space, q[rows], q)
        away[np.arange(len(away)), np.arange(rows.start, rows.stop)] = math.inf
        yield rows, away
