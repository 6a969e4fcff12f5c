"""The order of milestones: each far from the earlier ones, with more of them where random scenes are free."""

from __future__ import annotations

import numpy as np

from evenroad._arrays import Floats, Ints
from evenroad._native import roadmap as native
from evenroad.robot.kinematics import KinematicTree, capsule_endpoints

STEP = 1e-4
"""Step of the difference quotient that measures how far a joint moves the body [rad or m]."""

LEAST_WEIGHT = 0.01
"""Smallest weight of a joint, as a share of that of the joint that moves the body most."""

SERVED = 1.5
"""Power by which hard queries count less: one that sees m of the chosen points counts (1 + m)^-SERVED."""

LEAST_SEEN = 1e-3
"""Share of hard queries that every point counts to be seen by at least, so that spreading goes on in the end."""

_NONE = np.empty(0, dtype=np.int64)


def displacement_weights(robot: KinematicTree, q: Floats) -> Floats:
    """Return the weight of each joint, by how far it moves the robot's body: (dim,), of mean 1.

    ``w_j = sqrt(m_j)`` up to a factor, where m_j is the mean over the configurations `q`, (n, dim), of the longest
    displacement of any endpoint or middle of a capsule per unit of joint j [m/rad, or 1].
    """
    moved = np.empty(q.shape[1])
    body = _body_points(robot, q)
    for joint in range(len(moved)):
        there = q.copy()
        there[:, joint] += STEP
        moves = np.linalg.norm(_body_points(robot, there) - body, axis=2)
        moved[joint] = moves.max(axis=1).mean() / STEP
    if not moved.any():
        return np.ones(len(moved))
    weights = np.sqrt(np.maximum(moved, LEAST_WEIGHT * moved.max()))
    return weights / weights.mean()


def _body_points(robot: KinematicTree, q: Floats) -> Floats:
    """Return the endpoints and middles of all capsules, (n, 3 capsules, 3) [m]."""
    queries = capsule_endpoints(robot, q)
    return np.concatenate([queries[:, :, 0], queries[:, :, 1], queries.mean(axis=2)], axis=1)


def spread_order(
    points: Floats, period: Floats, preference: Floats, count: int, first: Ints = _NONE, which: Ints = _NONE
) -> Ints:
    """Return the first rows of `points`, (n, dim), in an order whose first n are well spread for every n: (count,).

    Farthest-point order (Gonzalez 1985) with a preference, (n,) > 0: the next point has the largest product of its
    distance to those before and its preference, so spacing is in proportion to 1 / preference.  Axes repeat after
    `period`, (dim,); inf where they do not.  From hard query e the points ``which[first[e]:first[e + 1]]`` are visible.
    The preference is also in proportion to LEAST_SEEN plus the share of queries that see a point, each of which counts
    (1 + m)^-SERVED after m of its points were chosen.
    """
    served = LEAST_SEEN, SERVED
    return native.spread_order((points, period), preference, count, (first, which), served)
