"""Planning with trees for an arm: join a start to a goal, and shorten what was found, every motion proved free."""

from __future__ import annotations

import time
from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np
import numpy.typing as npt

from evenroad._checks import require_count, require_positive
from evenroad.errors import InvalidValue
from evenroad.robot.arm_world import ArmWorld
from evenroad.robot.certified import CertifiedWorld
from evenroad.robot.tree_sequences import ball_points, cube_points, share_pairs
from evenroad.space.batch import as_batch
from evenroad.world.protocol import Connection

Floats = npt.NDArray[np.float64]

MOST_MOTIONS = 1_000_000
SECONDS = 5.0

_CAPACITY = 2048
"""Nodes of a tree there is room for at first; doubled when it is full."""

_SLICE = 1000
"""Batches of sixteen checks between two looks at the clock: about 10 ms."""


@dataclass(frozen=True, eq=False)
class _Proofs:
    """What proofs need beside a world's tables: how fast joints move bodies, and tables to write radii to."""

    arms: Floats
    pair_arms: Floats
    enlarged: npt.NDArray[np.int64]
    enlarged_view: npt.NDArray[np.int64]


def connect(
    world: ArmWorld,
    start: npt.ArrayLike,
    goals: npt.ArrayLike,
    *,
    most_motions: int = MOST_MOTIONS,
    seconds: float = SECONDS,
    sequence: npt.ArrayLike | None = None,
) -> Connection:
    """Join a start to one of several goals, by two trees that grow until they meet.

    Every motion of the path is proved free throughout, as by ``CertifiedWorld``.  The same arguments give the same
    path; the time only decides whether there is one.

    Parameters
    ----------
    world : ArmWorld
        The robot in its scene.
    start : array_like, shape (dim,)
        Where to begin.
    goals : array_like, shape (g, dim)
        Configurations of which one is to be reached; those that are not free are left out.
    most_motions : int
        Give up after so many motions were looked at, >= 1.
    seconds : float
        Give up after so long, > 0 [s].
    sequence : array_like, shape (n, dim), optional
        Points of the unit cube that the trees grow towards, the more evenly spread the better; after the last one they
        come again, shifted.  Default: 2048 of Halton's.

    Returns
    -------
    Connection
        With an empty path where there is none within the budget, or start or goals are not free.

    Raises
    ------
    InvalidValue
        If an argument is no such array or number.
    """
    dim = world.space.dim
    deadline = time.perf_counter() + require_positive("seconds", seconds)
    most = require_count("most_motions", most_motions)
    ends = as_batch("start and goals", _stacked(start, goals, dim), dim)
    samples = cube_points(dim) if sequence is None else _as_sequence(sequence, dim)
    free = world.valid(ends)
    if not (free[0] and free[1:].any()):
        return Connection(np.empty((0, dim)), -1, 0, len(ends), 0)
    numbers = np.flatnonzero(free[1:])
    if len(numbers) > 1:
        # The nearest goal is tried first.
        to_goals = world.space.distance(np.broadcast_to(ends[0], (len(numbers), dim)), ends[1 + numbers])
        numbers = numbers[np.argsort(to_goals, kind="stable")]
    roots = world.space.interpolate(ends, ends, 0.0)
    if world.backend == "scalar":
        from evenroad.robot import plain_trees

        found = plain_trees.grown(world, roots[0], roots[1 + numbers], samples, most, deadline)
    else:
        found = _grown(world, roots[0], roots[1 + numbers], samples, most, deadline)
    goal = int(numbers[found.goal]) if found.goal >= 0 else -1
    return Connection(found.path, goal, found.nodes, found.configurations + len(ends), found.motions)


def shorten(world: ArmWorld, path: npt.ArrayLike, *, proved: bool = False) -> tuple[Floats, int]:
    """Return a path that is not longer, and how many motions were looked at.

    A motion is put in only where it is proved free throughout.  Motions of the path as it was given stay where
    nothing shorter was found, proved or not: :meth:`CertifiedWorld.motion_valid` tells.

    Parameters
    ----------
    world : ArmWorld
        The robot in its scene.
    path : array_like, shape (p, dim), p >= 2
        Waypoints; every motion is free in the world.
    proved : bool
        Whether its motions are known to be proved free, as those of :func:`connect` are.

    Raises
    ------
    InvalidValue
        If `path` is no such array.
    """
    waypoints = as_batch("path", path, world.space.dim)
    if len(waypoints) < 2:
        raise InvalidValue(f"a path must have 2 waypoints or more, got {len(waypoints)}")
    if world.backend == "scalar":
        from evenroad.robot import plain_trees

        return plain_trees.shortened(world, waypoints)
    from evenroad.robot.kernel import shorten as kernel

    proofs, counts = _proofs(world), np.zeros(3, dtype=np.int64)
    shorter, _ = kernel.shorten_path(
        world.space.interpolate(waypoints, waypoints, 0.0),
        proved,
        share_pairs(),
        counts,
        world.resolution,
        world.bounds,
        world.tables.lanes,
        proofs.enlarged,
        proofs.enlarged_view,
        proofs.arms,
        proofs.pair_arms,
    )
    return shorter, int(counts[0])


def _grown(
    world: ArmWorld, start: Floats, goals: Floats, samples: Floats, most: int, deadline: float
) -> Connection:
    # Imported late: where the vector type cannot even be defined, all else still works.
    from evenroad.robot.kernel import trees as kernel

    dim, proofs = len(start), _proofs(world)
    capacity = -(-max(_CAPACITY, 2 * len(goals) + kernel.ROOM) // 16) * 16
    nodes, columns, links = _room(capacity, dim)
    sizes, state = np.array([1, len(goals)]), np.zeros(kernel.STATE, dtype=np.int64)
    periods = np.minimum(world.bounds[2], 1e30).astype(np.float32)
    nodes[0, 0], nodes[1, : len(goals)] = start, goals
    _fill_columns(columns, nodes, sizes)
    links[:, 0, :1] = links[:, 1, : len(goals)] = [[-1], [0], [0]]
    while True:
        ended = kernel.grow(
            nodes,
            columns,
            links,
            sizes,
            periods,
            state,
            samples,
            ball_points(dim),
            most,
            _SLICE,
            world.resolution,
            world.bounds,
            world.tables.lanes,
            proofs.enlarged,
            proofs.enlarged_view,
            proofs.arms,
            proofs.pair_arms,
        )
        if ended == kernel.FULL:
            wider, _, more = _room(2 * nodes.shape[1], dim)
            wider[:, : nodes.shape[1]], more[:, :, : nodes.shape[1]] = nodes, links
            nodes, links = wider, more
            columns = np.empty(2 * dim * nodes.shape[1], dtype=np.float32)
            _fill_columns(columns, nodes, sizes)
        elif ended != kernel.PAUSED or time.perf_counter() >= deadline:
            break
    motions, configurations = int(state[0]), int(state[1])
    path, goal = np.empty((0, dim)), -1
    if ended == kernel.SOLVED:
        to_root = [_to_root(links[0, tree], state[kernel.START_NODE + tree]) for tree in (0, 1)]
        path = np.concatenate([nodes[0, to_root[0][::-1]], nodes[1, to_root[1]]])
        goal = to_root[1][-1]
    return Connection(path, goal, int(sizes.sum()), configurations, motions)


def _room(capacity: int, dim: int) -> tuple[Floats, npt.NDArray[np.float32], npt.NDArray[np.int64]]:
    return (
        np.empty((2, capacity, dim)),
        np.empty(2 * dim * capacity, dtype=np.float32),
        np.empty((3, 2, capacity), dtype=np.int64),
    )


def _fill_columns(columns: npt.NDArray[np.float32], nodes: Floats, sizes: npt.NDArray[np.int64]) -> None:
    """Write the nodes by coordinate; the places up to the next multiple of 16 are far from everything."""
    by_tree = columns.reshape(2, nodes.shape[2], nodes.shape[1])
    for tree, size in enumerate(sizes):
        by_tree[tree, :, size : size + 16] = 1e15
        by_tree[tree, :, :size] = nodes[tree, :size].T


def _to_root(parents: npt.NDArray[np.int64], node: int) -> list[int]:
    """Return the numbers of a node and its ancestors, the root last."""
    way = [int(node)]
    while parents[way[-1]] >= 0:
        way.append(int(parents[way[-1]]))
    return way


_KEPT: WeakKeyDictionary[ArmWorld, _Proofs] = WeakKeyDictionary()


def _proofs(world: ArmWorld) -> _Proofs:
    """Return what proofs in `world` need, kept as long as it."""
    kept = _KEPT.get(world)
    if kept is None:
        certified = CertifiedWorld(world)
        enlarged = world.tables.lanes.copy()
        view = enlarged.view()
        view.setflags(write=False)
        kept = _KEPT[world] = _Proofs(certified._arms, certified._pair_arms, enlarged, view)
    return kept


def _stacked(start: npt.ArrayLike, goals: npt.ArrayLike, dim: int) -> Floats:
    try:
        first, others = np.asarray(start, dtype=np.float64), np.asarray(goals, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InvalidValue(f"start and goals must be arrays of numbers: {error}") from None
    if first.shape != (dim,):
        raise InvalidValue(f"start must have shape ({dim},), got {first.shape}")
    if others.ndim != 2 or others.shape[1] != dim or len(others) == 0:
        raise InvalidValue(f"goals must have shape (g, {dim}), g >= 1, got {others.shape}")
    return np.concatenate([first[np.newaxis], others])


def _as_sequence(sequence: npt.ArrayLike, dim: int) -> Floats:
    points = as_batch("sequence", sequence, dim)
    if len(points) == 0 or points.min() < 0.0 or points.max() > 1.0:
        raise InvalidValue(f"sequence must be points of the unit cube, one or more, got {sequence!r}")
    return points
