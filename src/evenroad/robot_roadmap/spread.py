"""The order of milestones: each far from the earlier ones, with more of them where scenes leave room."""

from __future__ import annotations

import numpy as np

from evenroad._arrays import Floats, Ints
from evenroad._native import roadmap as native
from evenroad.robot.kinematics import KinematicTree, capsule_endpoints

STEP = 1e-4
"""Of the difference quotient that measures how far a joint moves the body [rad or m]."""

LEAST_WEIGHT = 0.01
"""Of the joint that moves the body most: what a joint that moves nothing counts."""

SERVED = 1.5
"""An end that sees m of the chosen points counts (1 + m)^-SERVED: soon little, but never nothing."""

LEAST_SEEN = 1e-3
"""Share of ends that every point counts to be seen by at least, so that spreading goes on when all are served."""

_NONE = np.empty(0, dtype=np.int64)


def displacement_weights(robot: KinematicTree, q: Floats) -> Floats:
    """Return what a unit of each joint counts, by how far it moves the robot's body: (dim,), of mean 1.

    ``w_j = sqrt(m_j)`` up to a factor, where m_j is the mean over the configurations `q`, (n, dim), of the longest way
    that any end or middle of a capsule moves per unit of joint j [m/rad, or 1].
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
    """Return the ends and middles of all capsules, (n, 3 capsules, 3) [m]."""
    queries = capsule_endpoints(robot, q)
    return np.concatenate([queries[:, :, 0], queries[:, :, 1], queries.mean(axis=2)], axis=1)


def spread_order(
    points: Floats, period: Floats, preference: Floats, count: int, first: Ints = _NONE, which: Ints = _NONE
) -> Ints:
    """Return the first rows of `points`, (n, dim), in an order of which every beginning is well spread: (count,).

    Farthest-point order (Gonzalez 1985) with a preference, (n,) > 0: the next point has the largest product of its
    distance to those before and its preference, so that spacing is in proportion to 1 / preference.  Axes repeat after
    `period`, (dim,); inf where they do not.  Where end e sees the points ``which[first[e]:first[e + 1]]``, the
    preference is also in proportion to LEAST_SEEN plus the share of ends that see a point, of which one counts
    (1 + m)^-SERVED as much after m of the points it sees were chosen.
    """
    served = LEAST_SEEN, SERVED
    return native.spread_order((points, period), preference, count, (first, which), served)
