"""Tree planning for an arm: two trees join start and goal, and smoothing follows; every motion is proved free."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats, Ints
from evenroad._checks import require_count, require_positive
from evenroad._native import planning
from evenroad._time_limit import BudgetSpent, within
from evenroad.collision.arm_world import ArmWorld
from evenroad.errors import InvalidValue
from evenroad.planning.connector import Connection
from evenroad.planning.drivers import drivers, native_points
from evenroad.points.reversed_halton import PAIRS, ball_points, cube_points, share_pairs
from evenroad.space.batch import as_batch

MOST_MOTIONS = 1_000_000
SECONDS = 5.0

_SLICE = 10_000
"""Number of batches of sixteen checks between two checks for interrupts: about 100 ms."""


def connect(
    world: ArmWorld,
    start: npt.ArrayLike,
    goals: npt.ArrayLike,
    *,
    most_motions: int = MOST_MOTIONS,
    seconds: float = SECONDS,
    sequence: npt.ArrayLike | None = None,
) -> Connection:
    """Join a start, (dim,), to one of several goals, (g, dim), by two trees that grow until they meet.

    Every motion of the path is proved free, as by ``CertifiedWorld``.  The same arguments give the same path; the
    time [s] only decides whether one is found.  Goals that are not free are ignored.  The trees grow towards a
    `sequence` of points of the unit cube, (n, dim), by default 2048 points of Halton's sequence.  After the last point
    the sequence repeats with a shift.

    The path is empty if the budget is spent, or if start or goals are not free.  Raises InvalidValue if an argument is
    no such array or number.
    """
    dim = world.space.dim
    limit = require_positive("seconds", seconds)
    most = require_count("most_motions", most_motions)
    terminals = _start_and_goals(start, goals, dim)
    samples = native_points(cube_points, dim) if sequence is None else _as_sequence(sequence, dim)
    with within(limit):
        return joined(world, terminals, samples, most)


def joined(world: ArmWorld, terminals: Floats, samples: planning.Points, most_motions: int) -> Connection:
    """Call `connect` for a start and goals in one array, (1 + g, dim)."""
    if world.fixed_contact is not None:
        return Connection(np.empty((0, terminals.shape[1])), -1, 0, 0, 0)
    return _grown(world, terminals, samples, most_motions)[0]


def grown_trees(
    world: ArmWorld, start: npt.ArrayLike, goals: npt.ArrayLike, *, seconds: float = SECONDS
) -> tuple[Floats, Ints]:
    """Return the nodes, (n, dim), of the two trees of `connect` and their links, (m, 2), for viewers.

    Errors are those of :func:`connect`.
    """
    dim = world.space.dim
    limit = require_positive("seconds", seconds)
    terminals = _start_and_goals(start, goals, dim)
    if world.fixed_contact is not None:
        return np.empty((0, dim)), np.empty((0, 2), dtype=np.int64)
    with within(limit):
        _, trees = _grown(world, terminals, native_points(cube_points, dim), MOST_MOTIONS)
    vertices, edges, before = [], [], 0
    for nodes, parents in trees.trees:
        # The parent of a root is a negative number.
        child = np.flatnonzero(parents >= 0)
        edges.append(before + np.column_stack([child, parents[child]]))
        vertices.append(nodes)
        before += len(nodes)
    return np.concatenate(vertices), np.concatenate(edges)


def shorten(
    world: ArmWorld,
    path: npt.ArrayLike,
    *,
    pairs: int = PAIRS,
    shortcuts: int = 64,
) -> tuple[Floats, int]:
    """Return a path, (p, dim), that is not longer, and the number of motions checked.

    A new motion is used only if it is proved free.  Motions for which nothing shorter was found stay, proved or not:
    :meth:`CertifiedWorld.motion_valid` says which are.  At most `pairs` motions between points along the path are
    tried, and at most `shortcuts` corners.  Raises InvalidValue if `path` is no such array.
    """
    shares = native_points(share_pairs, min(pairs, PAIRS))
    return planning.shorten(checks_of(world), _as_path(world, path), shares, shortcuts)


def smooth(world: ArmWorld, path: npt.ArrayLike, *, batches: int, proved: bool = True) -> tuple[Floats, int]:
    """Return a smoothed path and the number of motions checked.

    With the same number of checks it is shorter than the path of `shorten`.  Waypoints slide along obstacles that they
    touch.  Every motion is proved free; one or two that are not are bent a little.  If that fails, the given path is
    shortened by straight motions alone, as in `shorten`.  Waypoints stop sliding after `batches` of sixteen checks,
    some of which are reserved for the proof; shortcuts of corners and the proof follow.

    `proved` says whether the given path is proved; a single motion must be.  If neither the given, nor the shortened,
    nor the smoothed path is proved, there are no waypoints: (0, dim).  Raises InvalidValue if `path` is no such array.
    """
    by = drivers(world.space.dim)
    smoothed, motions = planning.smooth(checks_of(world), _as_path(world, path), by, batches, proved)
    return np.empty((0, world.space.dim)) if smoothed is None else smoothed, motions


def smooth_with_clearance(world: ArmWorld, path: Floats, *, batches: int) -> tuple[Floats, int]:
    """Return a path smoothed as by `smooth`, 5 mm away from obstacles if that costs at most 2 % of its length.

    The shortest paths touch obstacles.  So the given path, whose motions are proved, is first smoothed in a world with
    5 mm more clearance, where all motions must be proved.  It is then smoothed again in this world, and the two lengths
    are compared.  If an endpoint is nearer to an obstacle, the path is smoothed in this world alone.
    """
    if len(path) < 3 or world.roomier.fixed_contact is not None:
        return smooth(world, path, batches=batches)
    checks, roomier, by = checks_of(world), checks_of(world.roomier), drivers(world.space.dim)
    return planning.smooth_with_clearance(checks, roomier, _as_path(world, path), by, batches)


def improver(
    world: ArmWorld,
    terminals: Floats,
    by: planning.Drivers,
    first: tuple[Floats, int, int],
    *,
    is_smoothing: bool,
) -> planning.Improver:
    """Return an improver, which searches shorter paths: `first` is a path, the row of its goal, and its motion checks.

    The motions of `first` are proved, and so are those of better paths.  Without smoothing, paths are those of trees.
    """
    return planning.Improver(checks_of(world), terminals, by, *first, is_smoothing)


def checks_of(world: ArmWorld) -> planning.Checks:
    """Return the checks of a world for one planner."""
    return planning.Checks(world.checker)


def _as_path(world: ArmWorld, path: npt.ArrayLike) -> Floats:
    """Return a path, (p, dim), p >= 2."""
    points = as_batch("path", path, world.space.dim)
    if len(points) < 2:
        raise InvalidValue(f"a path must have 2 waypoints or more, got {len(points)}")
    return points


def _grown(
    world: ArmWorld, terminals: Floats, samples: planning.Points, most: int
) -> tuple[Connection, planning.Trees]:
    """Return the connection that two trees found, and the trees."""
    order = range(len(terminals) - 1)
    if len(order) > 1:
        # The nearest goals are tried first.
        goals = terminals[1:]
        distances = world.space.distance(np.broadcast_to(terminals[0], goals.shape), goals)
        order = np.argsort(distances, kind="stable").tolist()
        terminals = np.concatenate([terminals[:1], goals[order]])
    checks = checks_of(world)
    trees = planning.Trees(checks, terminals, samples, native_points(ball_points, terminals.shape[1]))
    is_over = False
    try:
        while trees.grow(most, _SLICE) == "paused":
            continue
    except BudgetSpent:
        is_over = True
    counts = checks.counts
    goal = order[trees.goal] if trees.goal >= 0 else -1
    return Connection(trees.path, goal, sum(trees.sizes), counts.configurations, counts.motions, is_over), trees


def _start_and_goals(start: npt.ArrayLike, goals: npt.ArrayLike, dim: int) -> Floats:
    """Return a start, (dim,), and goals, (g, dim), in one array, (1 + g, dim)."""
    try:
        first, others = np.asarray(start, dtype=np.float64), np.asarray(goals, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InvalidValue(f"start and goals must be arrays of numbers: {error}") from None
    if first.shape != (dim,):
        raise InvalidValue(f"start must have shape ({dim},), got {first.shape}")
    if others.ndim != 2 or others.shape[1] != dim or len(others) == 0:
        raise InvalidValue(f"goals must have shape (g, {dim}), g >= 1, got {others.shape}")
    return as_batch("start and goals", np.concatenate([first[np.newaxis], others]), dim)


def _as_sequence(sequence: npt.ArrayLike, dim: int) -> planning.Points:
    points = as_batch("sequence", sequence, dim)
    if len(points) == 0 or points.min() < 0.0 or points.max() > 1.0:
        raise InvalidValue(f"sequence must be points of the unit cube, one or more, got {sequence!r}")
    return planning.Points(points)
