"""Tree planning for an arm: two trees join start and goal, then the path is shortened; every motion is proved free."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats, Ints
from evenroad._checks import require_count, require_positive
from evenroad._clock import now
from evenroad._compiled import compile_beside
from evenroad.errors import InvalidValue
from evenroad.roadmap.connector import Connection
from evenroad.robot.kernel.addresses import address
from evenroad.robot.kernel.lane_world import LaneWorld
from evenroad.robot.tree_sequences import ball_points, cube_points, share_pairs, sphere_points
from evenroad.space import JointSpace
from evenroad.space.batch import as_batch
from evenroad.space.path import configuration_at, motion_lengths

MOST_MOTIONS = 1_000_000
SECONDS = 5.0

_CAPACITY = 1040
"""Initial capacity of a tree in nodes; it doubles when full.  It is no power of two, since columns would then evict
each other from the processor's cache."""

_SLICE = 1000
"""Batches of sixteen checks between two looks at the clock: about 10 ms."""


_TOLERANCE = 1e-4
"""Tolerance of proofs where the lanes do not work [m]."""

_WORTH_WHILE = 3e-3
"""Smallest share by which a motion must shorten a path to be checked without lanes."""


class PlansWithTrees(Protocol):
    """What trees need of an arm's world; ``ArmWorld`` has these attributes."""

    @property
    def space(self) -> JointSpace: ...  # noqa: D102

    @property
    def lanes(self) -> LaneWorld: ...  # noqa: D102

    @property
    def backend(self) -> str: ...  # noqa: D102

    @property
    def fixed_contact(self) -> tuple[str, str] | None: ...  # noqa: D102

    def motion_certified(self, a: Floats, b: Floats, tolerance: float) -> npt.NDArray[np.bool_]: ...  # noqa: D102


def prepare() -> None:
    """Compile what tree planning needs, in processes beside this one, unless it is cached."""
    # The one that is needed last takes longest and goes first; this process begins at the other end.
    kernels = ("trees", "lane_check", "shorten", "motion_checks", "hull_lanes")
    compile_beside(*(f"evenroad.robot.kernel.{kernel}" for kernel in kernels))


def connect(
    world: PlansWithTrees,
    start: npt.ArrayLike,
    goals: npt.ArrayLike,
    *,
    most_motions: int = MOST_MOTIONS,
    seconds: float = SECONDS,
    sequence: npt.ArrayLike | None = None,
) -> Connection:
    """Join a start, (dim,), to one of several goals, (g, dim), by two trees that grow until they meet.

    Every motion of the path is proved free throughout, as by ``CertifiedWorld``.  The same arguments give the same
    path; the time [s] only decides whether there is one.  Goals that are not free are left out.  The trees grow towards
    a `sequence` of points of the unit cube, (n, dim), by default 2048 points of Halton's sequence; after the last point
    it repeats, shifted.

    The path is empty if the budget is spent, if start or goals are not free, or if the world's backend is not the
    lanes. InvalidValue if an argument is no such array or number.
    """
    dim = world.space.dim
    limit = require_positive("seconds", seconds)
    most = require_count("most_motions", most_motions)
    first, others = _start_and_goals(start, goals, dim)
    samples = None if sequence is None else _as_sequence(sequence, dim)
    if world.fixed_contact is not None or world.backend == "scalar":
        _require_finite(first, others)
        return Connection(np.empty((0, dim)), -1, 0, 0, 0)
    return _grown(world, first, others, samples, most, limit)[0]


def grown_trees(
    world: PlansWithTrees, start: npt.ArrayLike, goals: npt.ArrayLike, *, seconds: float = SECONDS
) -> tuple[Floats, Ints]:
    """Return the nodes, (n, dim), of the two trees of `connect` and their links, (m, 2), for viewers.

    Raises as :func:`connect`; without lanes both are empty.
    """
    dim = world.space.dim
    first, others = _start_and_goals(start, goals, dim)
    if world.fixed_contact is not None or world.backend == "scalar":
        _require_finite(first, others)
        return np.empty((0, dim)), np.empty((0, 2), dtype=np.int64)
    _, memory, sizes = _grown(world, first, others, None, MOST_MOTIONS, require_positive("seconds", seconds))
    vertices, links, _ = _trees(*memory)
    edges, before = [], 0
    for tree, size in enumerate(sizes):
        # A root has no parent: a negative number.
        child = np.flatnonzero(links[0, tree, :size] >= 0)
        edges.append(before + np.column_stack([child, links[0, tree, child]]))
        before += size
    nodes = [vertices[tree, :size] for tree, size in enumerate(sizes)]
    return np.concatenate(nodes), np.concatenate(edges)


def shorten(
    world: PlansWithTrees,
    path: npt.ArrayLike,
    *,
    pairs: int = 1 << 30,
    shortcuts: int = 64,
) -> tuple[Floats, int]:
    """Return a path, (p, dim), that is not longer, and the number of motions checked.

    A new motion enters only where it is proved free throughout.  Motions of the given path stay where nothing shorter
    was found, proved or not: :meth:`CertifiedWorld.motion_valid` says which.  At most `pairs` motions between points
    along the path are tried, and with lanes at most `shortcuts` corners.  InvalidValue if `path` is no such array.
    """
    path, dim = _as_path(world, path), world.space.dim
    if world.backend == "scalar":
        return _shortened(world, as_batch("path", path, dim))
    pointer, count = _pointer_to(share_pairs)
    short, motions = _shorten_path()(world.lanes, path, (pointer, min(pairs, count)), shortcuts)
    if not len(short):
        as_batch("path", path, dim)
    return short, motions


def smooth(
    world: PlansWithTrees, path: npt.ArrayLike, *, batches: int, proved: bool = True
) -> tuple[Floats, int]:
    """Return a smoothed path and the number of motions checked; it is shorter than that of `shorten` for the same
    checks.

    Waypoints slide along what they touch.  Every motion is proved free, and one or two are bent a little where they are
    not.  Where that fails, the given path is shortened by straight motions alone, as in `shorten`; so it is without
    lanes. After `batches` of sixteen checks, some of which are kept for the proof, no waypoint slides any more;
    shortcuts of corners and the proof follow.

    `proved` says whether the given path is; a single motion has to be, and all of them without lanes.  Where neither
    the given, nor the shortened, nor the smoothed path is proved, there are no waypoints: (0, dim).  InvalidValue if
    `path` is no such array.
    """
    path = _as_path(world, path)
    if world.backend == "scalar":
        return shorten(world, path)
    driven_by = _pointer_to(share_pairs), _pointer_to(sphere_points, world.space.dim)
    smoothed, motions = _smooth_path()(world.lanes, path, *driven_by, batches, proved)
    if not len(smoothed):
        as_batch("path", path, world.space.dim)
    return smoothed, motions


def _as_path(world: PlansWithTrees, path: npt.ArrayLike) -> Floats:
    """Return a path, (p, dim); compiled code checks that an array as planners give it is finite."""
    dim = world.space.dim
    if not (
        type(path) is np.ndarray and path.dtype == np.float64 and path.ndim == 2 and path.shape[1] == dim
    ):
        path = as_batch("path", path, dim)
    if len(path) < 2:
        raise InvalidValue(f"a path must have 2 waypoints or more, got {len(path)}")
    return path


def _shortened(world: PlansWithTrees, path: Floats) -> tuple[Floats, int]:
    """Shorten a path without lanes, one motion at a time; return it and the number of motions checked."""
    space = world.space
    path = space.interpolate(path, path, 0.0)
    motions = 0

    def is_shortcut(a: Floats, b: Floats) -> bool:
        nonlocal motions
        motions += 1
        return bool(world.motion_certified(a[np.newaxis], b[np.newaxis], _TOLERANCE)[0])

    i = 0
    while i < len(path) - 2:
        for j in range(len(path) - 1, i + 1, -1):
            if is_shortcut(path[i], path[j]):
                path = np.concatenate([path[: i + 1], path[j:]])
                break
        i += 1
    for low, high in np.sort(share_pairs(), axis=1):
        along = np.concatenate([[0.0], np.cumsum(motion_lengths(path, space))])
        shares = np.array([low, high]) * along[-1]
        first, last = np.clip(np.searchsorted(along, shares, side="right") - 1, 0, len(path) - 2)
        endpoints = configuration_at(path, space, [low, high])
        gain = shares[1] - shares[0] - space.distance(endpoints[:1], endpoints[1:])[0]
        if first < last and gain >= _WORTH_WHILE * along[-1] and is_shortcut(*endpoints):
            path = np.concatenate([path[: first + 1], endpoints, path[last + 1 :]])
    return path, motions


def _grown(
    world: PlansWithTrees, first: Floats, goals: Floats, samples: Floats | None, most: int, seconds: float
) -> tuple[Connection, tuple[Floats, int, int, int], tuple[int, int]]:
    """Grow two trees; return what they found, their address, see `_trees`, and their sizes."""
    kernel, grow = _tree_kernels()
    order = None
    if len(goals) > 1:
        # The nearest goals are tried first.
        distances = world.space.distance(np.broadcast_to(first, goals.shape), goals)
        order = np.argsort(distances, kind="stable")
        goals = goals[order]
    count, dim = len(goals) + 1, len(first)
    capacity, steps, doubles = _sizes(count, dim, _CAPACITY)
    memory, given = world.lanes.arguments(doubles)
    block, pointer = memory[steps:], given[-1] + 8 * steps
    begin, middle = kernel.STATE + 2, kernel.STATE + 2 + dim
    block[:begin], block[begin:middle] = 0.0, first
    block[middle : middle + goals.size] = goals.ravel()
    sequence = _pointer_to(cube_points, dim) if samples is None else (address(samples), len(samples))
    driven_by = sequence, _pointer_to(ball_points, dim)
    if not grow.overloads:
        # Compile, or load, before the clock runs; no motion is checked.
        grow(pointer, count, capacity, *driven_by, (0, _SLICE), given)
    deadline = now() + seconds
    while True:
        ended = grow(pointer, count, capacity, *driven_by, (most, _SLICE), given)
        if ended == kernel.FULL:
            block = _with_more_capacity(block, begin + count * dim, capacity, dim)
            pointer, capacity = address(block), 2 * capacity
        elif ended != kernel.PAUSED or now() >= deadline:
            break
    if ended == kernel.NO_NUMBERS:
        _require_finite(first, goals)
    motions, configurations, *_, waypoints, reached, nodes, others = block[:begin].view(np.int64).tolist()
    path, goal = np.empty((0, dim)), -1
    if ended == kernel.SOLVED:
        columns = begin + count * dim + (2 * dim + 8) * capacity
        path = block[columns : columns + waypoints * dim].reshape(waypoints, dim).copy()
        goal = reached - 1 if order is None else int(order[reached - 1])
    connection = Connection(path, goal, nodes + others, configurations, motions)
    return connection, (block, begin + count * dim, capacity, dim), (nodes, others)


# Imported late: where the vector type cannot even be defined, all else still works.
@cache
def _tree_kernels() -> tuple[Any, Any]:
    from evenroad.robot.kernel import trees

    return trees, trees.grow


@cache
def _sizes(count: int, dim: int, least: int) -> tuple[int, int, int]:
    """Return the capacity of trees for this number of roots, and the numbers of doubles before them and with them."""
    from evenroad.robot.kernel import tree_steps, trees

    capacity, steps = -(-max(least, 2 * count + trees.EXTRA_NODES) // 16) * 16, tree_steps.memory_for(dim)
    return capacity, steps, steps + trees.floats_for(count, capacity, dim)


@cache
def _shorten_path() -> Callable[..., tuple[Floats, int]]:
    from evenroad.robot.kernel.shorten import shorten_path

    return shorten_path


@cache
def _smooth_path() -> Callable[..., tuple[Floats, int]]:
    from evenroad.robot.kernel.smoothing import smooth_path

    return smooth_path


def _with_more_capacity(block: Floats, begin: int, capacity: int, dim: int) -> Floats:
    """Return a block of memory with twice the capacity, with nodes, links and columns copied."""
    larger = np.empty(begin + 2 * (4 * dim + 8) * capacity)
    larger[:begin] = block[:begin]
    nodes, links, columns = _trees(larger, begin, 2 * capacity, dim)
    nodes[:, :capacity], links[..., :capacity], columns[..., :capacity] = _trees(block, begin, capacity, dim)
    return larger


def _trees(
    block: Floats, begin: int, capacity: int, dim: int
) -> tuple[Floats, npt.NDArray[np.int64], npt.NDArray[np.float32]]:
    links = begin + 2 * capacity * dim
    columns = links + 8 * capacity
    return (
        block[begin:links].reshape(2, capacity, dim),
        block[links:columns].view(np.int64).reshape(4, 2, capacity),
        block[columns : columns + capacity * dim].view(np.float32).reshape(2, dim, capacity),
    )


@cache
def _pointer_to(points: Callable[..., Floats], *dim: int) -> tuple[int, int]:
    """Return the address and the number of points that stay in memory."""
    return address(points(*dim)), len(points(*dim))


def _start_and_goals(start: npt.ArrayLike, goals: npt.ArrayLike, dim: int) -> tuple[Floats, Floats]:
    """Return start, (dim,), and goals, (g, dim); compiled code checks that they are finite."""
    try:
        first, others = np.asarray(start, dtype=np.float64), np.asarray(goals, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InvalidValue(f"start and goals must be arrays of numbers: {error}") from None
    if first.shape != (dim,):
        raise InvalidValue(f"start must have shape ({dim},), got {first.shape}")
    if others.ndim != 2 or others.shape[1] != dim or len(others) == 0:
        raise InvalidValue(f"goals must have shape (g, {dim}), g >= 1, got {others.shape}")
    return first, others


def _require_finite(first: Floats, goals: Floats) -> None:
    as_batch("start and goals", np.concatenate([first[np.newaxis], goals]), len(first))


def _as_sequence(sequence: npt.ArrayLike, dim: int) -> Floats:
    points = as_batch("sequence", sequence, dim)
    if len(points) == 0 or points.min() < 0.0 or points.max() > 1.0:
        raise InvalidValue(f"sequence must be points of the unit cube, one or more, got {sequence!r}")
    return points
