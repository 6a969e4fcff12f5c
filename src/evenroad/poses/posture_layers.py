"""A tip's curve followed from posture to posture: the cheapest way through layers of postures, found lazily."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from evenroad._arrays import Floats
from evenroad._time_limit import look_at_clock
from evenroad.geometry.pose import Pose
from evenroad.poses.cartesian_path import LONGEST, Followed, Follower
from evenroad.poses.inverse_kinematics import stages
from evenroad.poses.pose_task import PoseTask

LAYERS = 24
"""Largest number of layers beside the first one."""
MOST_TRIED = 300
"""Largest number of pieces between layers that are followed."""

_APART = 0.2
"""Distance below which two postures of a layer are one, for an arm with spare joints [rad or m]."""
_MOST = 32
"""Largest number of postures of a layer."""
_ARRIVED = 1e-6
"""Largest distance of a followed piece's end from its posture [rad or m]."""
_SPEED = 1.5
"""Longest piece between postures, as a multiple of what joints may move between poses."""


def follow(follower: Follower, start: Floats | None = None) -> Followed:
    """Return how a tip follows its curve, from a configuration, (dim,), or from any posture at its beginning.

    Going on from each posture to the nearest is tried first.  Where that fails, postures are found at some poses of the
    curve, the layers, and pieces between them are followed along the cheapest way, until one is whole (layers as in De
    Maeyer et al. 2017; lazy as in Bohlin and Kavraki 2000).
    """
    firsts = _postures(follower, 0, np.empty((0, follower.world.dim))) if start is None else start[np.newaxis]
    if not len(firsts):
        return follower.stopped(firsts, 0)
    tried = [follower.from_posture(q) for q in firsts]
    whole = [each for each in tried if not each.why]
    if whole:
        return min(whole, key=lambda each: _length(follower, each.path))
    return _by_layers(follower, firsts, max(tried, key=lambda each: each.share))


def _by_layers(follower: Follower, firsts: Floats, best: Followed) -> Followed:
    """Return the cheapest whole path through layers of postures, else the better of `best` and what was followed."""
    count = len(follower.curve.poses)
    rows = np.unique(np.linspace(0, count - 1, min(count, LAYERS + 1)).astype(np.int64))
    layers = [firsts]
    for row in rows[1:].tolist():
        layers.append(_postures(follower, row, layers[-1]))
        if not len(layers[-1]):
            return best
    costs = [_costs(a, b, int(steps)) for (a, b), steps in zip(pairwise(layers), np.diff(rows), strict=True)]
    pieces: dict[tuple[int, int, int], Floats] = {}
    for _ in range(MOST_TRIED):
        look_at_clock()
        route = _cheapest(costs)
        if route is None:
            break
        along: list[Floats] = []
        for k, (i, j) in enumerate(pairwise(route)):
            if (k, i, j) not in pieces:
                piece = _piece(follower, layers[k][i], slice(rows[k], rows[k + 1] + 1), layers[k + 1][j])
                if piece is None:
                    costs[k][i, j] = np.inf
                    break
                pieces[k, i, j] = piece
            along.append(pieces[k, i, j])
        if along and (done := _better(follower, best, along)) is not None:
            if not done.why:
                return done
            best = done
    return best


def _piece(follower: Follower, a: Floats, rows: slice, b: Floats) -> Floats | None:
    """Return a free piece along poses of the curve from one posture to another, (n, dim); None where there is none."""
    piece = follower.steps(a, rows, b)
    if len(piece) < rows.stop - rows.start or np.abs(piece[-1] - b).max() > _ARRIVED:
        return None
    return piece if follower.world.validate(piece).all() else None


def _better(follower: Follower, best: Followed, parts: list[Floats]) -> Followed | None:
    """Return the answer along some pieces, gone on with, if it gets farther than the best one."""
    path = np.concatenate([parts[0][:1], *(part[1:] for part in parts)])
    whole = len(follower.curve.poses)
    if len(path) < best.share * whole:
        return None
    if len(path) < whole:
        path = np.concatenate([path[:-1], follower.steps(path[-1], slice(len(path) - 1, None))])
    done = follower.checked(path) if len(path) == whole else follower.stopped(path, len(path))
    return done if not done.why or done.share > best.share else None


def _postures(follower: Follower, row: int, before: Floats) -> Floats:
    """Return free postures at a pose of the curve, (n, dim): those that earlier ones go on to, and others."""
    world, chain, pose = follower.world, follower.chain, follower.curve.poses[row]
    task = PoseTask(Pose(tuple(pose[9:].tolist()), tuple(pose[:9].tolist())))
    found = []
    if len(before):
        on = [chain.followed(q, pose[np.newaxis], LONGEST, world.space.flat.wrapping) for q in before]
        found += [each for each in on if len(each)]
    middle = before[0] if len(before) else np.clip(np.zeros(world.dim), *chain.bounds)
    fresh = next(iter(stages(chain, task, middle, exact=True)))[0]
    if len(before) and len(fresh):
        # In the turns in which the arm is.
        turned = fresh - 2.0 * np.pi * np.round((fresh - middle) / (2.0 * np.pi)) * chain.turns
        inside = ((turned >= chain.bounds[0]) & (turned <= chain.bounds[1])) | ~chain.turns
        fresh = np.where(inside, turned, fresh)
    every = np.concatenate([*found, fresh]) if found else fresh
    every = _distinct(every, _APART if len(chain.moving) > 6 else 1e-4)
    return every[world.valid(every)][:_MOST] if len(every) else every


def _distinct(q: Floats, same: float) -> Floats:
    kept: list[Floats] = []
    for row in q:
        look_at_clock()
        if not kept or np.abs(np.array(kept) - row).max(axis=1).min() >= same:
            kept.append(row)
    return np.array(kept).reshape(-1, q.shape[1])


def _costs(a: Floats, b: Floats, steps: int) -> Floats:
    """Return the distances between two layers' postures, infinite where joints do not get so far."""
    gap = np.abs(a[:, np.newaxis] - b[np.newaxis])
    cost = np.sqrt((gap**2).sum(axis=2))
    return np.where(gap.max(axis=2) > _SPEED * LONGEST * steps, np.inf, cost)


def _cheapest(costs: list[Floats]) -> list[int] | None:
    """Return the postures of the cheapest way through all layers (Bellman 1957); None where there is none."""
    total, came = np.zeros(len(costs[0])), []
    for cost in costs:
        sums = total[:, np.newaxis] + cost
        came.append(sums.argmin(axis=0))
        total = sums.min(axis=0)
    if not np.isfinite(total.min()):
        return None
    route = [int(total.argmin())]
    for back in came[::-1]:
        route.append(int(back[route[-1]]))
    return route[::-1]


def _length(follower: Follower, path: Floats) -> float:
    return float(follower.world.space.distance(path[:-1], path[1:]).sum())
