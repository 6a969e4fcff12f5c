"""Dispersion: the distance from the loneliest place of the cube to the nearest point.

SciPy's trees are imported where they are used: with them comes its linear algebra, for which a plan does not wait.
"""

from __future__ import annotations

import numpy as np

from evenroad._arrays import Floats
from evenroad._checks import require_count, require_known, require_positive
from evenroad._njit import njit
from evenroad._rng import RngLike, generator
from evenroad.errors import InvalidValue, NotAvailable
from evenroad.points.pointset import as_unit_points

BUDGET = 4e8
"""Default limit on the estimated work of the exact linf-dispersion: about a minute."""
EXACT_UP_TO = 3
"""Largest dimension with an exact algorithm."""
NORMS = {"l2": 2.0, "linf": np.inf}
_SLABS = 32
"""Slabs that the search is split into; any number gives the same answer."""


def dispersion_l2(points: object) -> float:
    """Return the exact l2-dispersion: the supremum over [0, 1]^d of the Euclidean distance to the nearest point.

    `points`, (n, d), have coordinates in [0, 1), n >= 1, d <= 3.  Raises InvalidValue for no points or bad ones, and
    NotAvailable for d > 3.
    """
    from scipy.spatial import Voronoi, cKDTree

    coordinates = _checked(points, "dispersion_l2")
    d = coordinates.shape[1]
    if d == 1:
        return _dispersion_of_line(coordinates[:, 0])
    # The distance is largest at a vertex of the Voronoi cells cut by the cube.  With the points mirrored at every face
    # the mirrored cells meet at the faces, so those vertices are plain Voronoi vertices.
    distinct = np.unique(coordinates, axis=0)
    mirrored = [distinct]
    for axis in np.eye(d, dtype=bool):
        mirrored += [np.where(axis, 2.0 * face - distinct, distinct) for face in (0.0, 1.0)]
    vertices = Voronoi(np.unique(np.concatenate(mirrored), axis=0)).vertices
    # Rounding puts vertices of the faces slightly outside; clipped they are places of the cube again, and the
    # distance at any place of the cube is at most the supremum.
    near = ((vertices > -1e-9) & (vertices < 1.0 + 1e-9)).all(axis=1)
    places = np.concatenate([np.clip(vertices[near], 0.0, 1.0), np.indices([2] * d).reshape(d, -1).T])
    return float(np.max(cKDTree(distinct).query(places)[0]))


def dispersion_linf(points: object, budget: float = BUDGET) -> float:
    """Return the exact linf-dispersion: half the side of the largest cube centred in [0, 1]^d without a point.

    By bisection to the last bit on whether open cubes around the points cover the unit cube.  `points` and errors are
    those of :func:`dispersion_l2`; NotAvailable also if the estimated work, n^2 in d = 3 and n below, exceeds `budget`.
    The default allows 20000 points in d = 3, where a few thousand take seconds.
    """
    coordinates = _checked(points, "dispersion_linf")
    n, d = coordinates.shape
    limit, work = require_positive("budget", budget), float(n) ** max(d - 1, 1)
    if work > limit:
        raise NotAvailable(
            f"the exact linf-dispersion of n={n} points in d={d} takes about {work:.0e} steps, the budget is"
            f" {limit:.0e}: use fewer points, a larger budget, or dispersion_lower_bound"
        )
    if d == 1:
        return _dispersion_of_line(coordinates[:, 0])
    return _largest_hole(coordinates)


def dispersion_lower_bound(
    points: object, norm: str = "l2", *, rng: RngLike = 0, starts: int = 8192, rounds: int = 60
) -> float:
    """Return a lower bound of the dispersion in any dimension: the best place that a random search found.

    Random places and corners, then hill climbing from the best sixteenth of them with shrinking steps.  Every
    place gives a true lower bound; how close it comes is not known.  `rng` draws the places: as many as `starts` at
    first, with `rounds` of climbing.  A norm but l2 and linf is an UnknownName, all else that is bad an InvalidValue.
    """
    from scipy.spatial import cKDTree

    coordinates = _checked(points)
    require_known("norm", norm, NORMS)
    starts, rounds = require_count("starts", starts), require_count("rounds", rounds)
    draws = generator(rng)
    d = coordinates.shape[1]
    tree = cKDTree(coordinates)

    def emptiness(places: Floats) -> Floats:
        return np.asarray(tree.query(places, p=NORMS[norm])[0])

    corners = np.round(draws.random((starts // 4 + 1, d)))
    places = np.concatenate([draws.random((starts, d)), corners])
    heights = emptiness(places)
    climbers = np.argsort(-heights, kind="stable")[: max(starts // 16, 1)]
    places, heights = places[climbers], heights[climbers]
    steps = np.full((places.shape[0], 1), float(coordinates.shape[0]) ** (-1.0 / d))
    for _ in range(rounds):
        # A step along some of the coordinates only: in high dimensions one along all hardly ever climbs.
        along = draws.random(places.shape) < max(0.3, 1.0 / d)
        moved = np.clip(places + steps * along * draws.standard_normal(places.shape), 0.0, 1.0)
        moved_heights = emptiness(moved)
        better = moved_heights > heights
        places[better], heights[better] = moved[better], moved_heights[better]
        steps[better] *= 1.5
        steps[~better] *= 0.8
    return float(heights.max())


def _checked(points: object, exact: str | None = None) -> Floats:
    coordinates = as_unit_points(points)
    n, d = coordinates.shape
    if n == 0:
        raise InvalidValue(f"dispersion needs at least one point, got an array of shape (0, {d})")
    if exact and d > EXACT_UP_TO:
        raise NotAvailable(
            f"{exact} is exact for d <= {EXACT_UP_TO}, got d={d}; dispersion_lower_bound searches in any dimension"
        )
    return coordinates


def _dispersion_of_line(coordinates: Floats) -> float:
    ordered = np.sort(coordinates)
    return float(max(ordered[0], 1.0 - ordered[-1], np.diff(ordered).max(initial=0.0) / 2.0))


def _largest_hole(coordinates: Floats) -> float:
    """Return the largest linf-distance of a place of [0, 1]^d from the nearest of (n, d) points, d = 2 or 3.

    The cube is cut into slabs, taken in a fixed random order.  A slab is bisected only if it holds a larger hole than
    all before: a few of them, so the whole costs little more than one test of coverage (Chan 1999).
    """
    n, d = coordinates.shape
    ordered = coordinates[np.argsort(coordinates[:, -1], kind="stable")]
    if d == 3:
        first, edges = np.ascontiguousarray(ordered[:, 0]), np.linspace(0.0, 1.0, _SLABS + 1)
    else:
        # A square is a section of a cube: one slab without thickness, and every point in it.
        first, edges = np.zeros(n), np.zeros(2)
    middle, last = np.ascontiguousarray(ordered[:, -2]), np.ascontiguousarray(ordered[:, -1])
    by_middle = np.argsort(middle, kind="stable")
    best = 0.0
    for slab in np.random.default_rng(0).permutation(edges.size - 1):
        cubes = first, middle, last, by_middle, edges[slab], edges[slab + 1]
        reached, missed = np.nextafter(best, 1.0), 2.0
        if not _hole_exists(*cubes, reached):
            continue
        while (radius := 0.5 * (reached + missed)) not in (reached, missed):
            if _hole_exists(*cubes, radius):
                reached = radius
            else:
                missed = radius
        best = float(reached)
    return best


@njit(cache=True)
def _hole_exists(first, middle, last, by_middle, low, high, radius):  # type: ignore[no-untyped-def]
    """Whether a place of [low, high] x [0, 1] x [0, 1] is at least `radius` from every point.

    The first such place, coordinate by coordinate, is pushed against the low side of the box or the high side of a
    point's open cube, so only those values are tried: for each in `first`, the line along `last` is swept through
    `middle`, and the gaps between the cubes on it are counted as cubes enter and leave.  Points are sorted by `last`;
    `by_middle` sorts them by `middle`.  The cubes are compared by their rounded sides throughout: then a place on a
    side is never inside by rounding, and growing the radius never uncovers a place.
    """
    starts, ends = first[by_middle] - radius, first[by_middle] + radius
    on_line = np.zeros(first.size, np.bool_)
    for place in np.append(low, first + radius):
        if place < low or place > high:
            continue
        near = by_middle[(starts < place) & (place < ends)]
        on_line[:] = False
        # With no cube the whole line is one gap.
        gaps = 1
        entering, leaving = 0, 0
        middle_place = 0.0
        while True:
            while entering < near.size and middle[near[entering]] - radius < middle_place:
                gaps += _gaps_opened_by(near[entering], last, on_line, radius)
                on_line[near[entering]] = True
                entering += 1
            while leaving < near.size and middle[near[leaving]] + radius <= middle_place:
                on_line[near[leaving]] = False
                gaps -= _gaps_opened_by(near[leaving], last, on_line, radius)
                leaving += 1
            if gaps > 0:
                return True
            # No gap means that a cube is on the line, so one is left to leave.
            middle_place = middle[near[leaving]] + radius
            if middle_place > 1.0:
                break
    return False


@njit(cache=True)
def _gaps_opened_by(point, last, on_line, radius):  # type: ignore[no-untyped-def]
    """Change of the number of gaps on the line when the cube of `point`, not on it yet, enters."""
    below, above = point - 1, point + 1
    while below >= 0 and not on_line[below]:
        below -= 1
    while above < last.size and not on_line[above]:
        above += 1
    end_below = last[below] + radius if below >= 0 else 0.0
    start_above = last[above] - radius if above < last.size else 1.0
    before = 1 if start_above >= end_below else 0
    after_below = 1 if last[point] - radius >= end_below else 0
    after_above = 1 if start_above >= last[point] + radius else 0
    return after_below + after_above - before
