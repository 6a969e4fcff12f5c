"""Ways that trees found become milestones and edges of a roadmap, for all scenes of its cell."""

from __future__ import annotations

import numpy as np

from evenroad._arrays import Bools, Floats, Ints, Ints32
from evenroad.errors import InvalidValue
from evenroad.robot import ArmWorld
from evenroad.robot.arm_world import RECHECK_TOLERANCE
from evenroad.robot_roadmap.turns import TURN, OneTurn, lifted_motions_free, shifts
from evenroad.space.batch import as_batch

JOINED, TRIED = 16, 40
"""Each new milestone is joined to so many of the nearest that it reaches, of so many that are tried."""


def with_paths(
    world: ArmWorld, one: OneTurn, graph: tuple[Floats, Ints32, Ints], paths: tuple[Floats, ...]
) -> tuple[Floats, Ints32, Ints]:
    """Return milestones, (n, dim), edges and turns with the waypoints of paths, (p, dim), and what leads along them.

    `world` is the robot in its cell.  Raises InvalidValue if a path is no such array, or not free there.
    """
    milestones, edges, turns = graph
    first = len(milestones)
    a, b, by = [edges[:, 0].astype(np.int64)], [edges[:, 1].astype(np.int64)], [turns.astype(np.int64)]
    for number, path in enumerate(paths):
        way = as_batch(f"path {number}", path, world.space.dim)
        # Milestones are within the limits, which an end may exceed by a little.
        low, high, period = world.bounds
        way = np.where(np.isfinite(period), way, np.clip(way, low, high))
        free = world.motion_certified(way[:-1], way[1:], RECHECK_TOLERANCE)
        if not free.all():
            raise InvalidValue(
                f"path {number} cannot be remembered: its motion {int(np.argmin(free))} is not free of robot and cell"
            )
        whole = np.where(one.wraps, np.floor((way - one.low) / TURN), 0.0).astype(np.int64)
        q = np.clip(way - TURN * whole, one.low, one.high)
        rows = np.arange(len(q)) + len(milestones)
        for i, same in enumerate((milestones[:, np.newaxis] == q).all(axis=2).T):
            rows[i] = np.argmax(same) if same.any() else rows[i]
        rows = np.where(
            rows >= len(milestones), len(milestones) + np.cumsum(rows >= len(milestones)) - 1, rows
        )
        milestones = np.concatenate([milestones, q[rows >= len(milestones)]])
        a.append(rows[:-1])
        b.append(rows[1:])
        by.append(np.where(one.lifts, np.diff(whole, axis=0), shifts(one, q[:-1], q[1:])))
    for row in range(first, len(milestones)):
        near = _nearest(milestones[:row], milestones[row], one)
        here = np.broadcast_to(milestones[row], (len(near), milestones.shape[1]))
        way_round = shifts(one, milestones[near], here)
        kept = _first_free(lifted_motions_free(world, one, milestones[near], here, way_round))
        a.append(near[kept])
        b.append(np.full(len(kept), row))
        by.append(way_round[kept])
    return milestones, *_sorted(np.concatenate(a), np.concatenate(b), np.concatenate(by))


def _nearest(milestones: Floats, q: Floats, one: OneTurn) -> Ints:
    """Return the numbers of the milestones to be tried from a configuration, nearest first."""
    apart = milestones - q
    apart -= np.where(one.wraps, TURN * np.rint(apart / TURN), 0.0)
    return np.argsort(np.linalg.norm(apart, axis=1), kind="stable")[:TRIED]


def _first_free(free: Bools) -> Ints:
    return np.flatnonzero(free)[:JOINED]


def _sorted(a: Ints, b: Ints, by: Ints) -> tuple[Ints32, Ints]:
    """Return edges with the smaller row first, each once, ascending, and their turns; none of more than one turn."""
    swapped = (a > b)[:, np.newaxis]
    pairs = np.sort(np.stack([a, b], axis=1), axis=1)
    by = np.where(swapped, -by, by)
    fits = (pairs[:, 0] != pairs[:, 1]) & (np.abs(by) <= 1).all(axis=1)
    once = np.unique(np.concatenate([pairs, by], axis=1)[fits], axis=0)
    return once[:, :2].astype(np.int32), once[:, 2:].astype(np.int8)
