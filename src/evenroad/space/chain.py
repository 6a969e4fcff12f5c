"""ChainSpace: a planar chain of equal links, measured by how far its joints move in the plane."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import njit

from evenroad._arrays import Floats, set_fields
from evenroad._checks import require_count
from evenroad.space.batch import as_batch, as_batch_pair
from evenroad.space.joints import FlatSpace


@dataclass(frozen=True)
class ChainSpace(FlatSpace):
    """Angles of a chain of `joints` links, each ``1 / joints`` long, that lies in the plane and starts at the origin.

    A configuration is the (joints,) angles of each link against the one before, the first against the x axis, in
    radians; any angle is taken, given back are angles in [-pi, pi).  Distances are those of OMPL's kinematic chain
    benchmark: how far the far ends of the links are apart in the plane, summed over the links.  Motions turn every
    joint the short way round at an even speed, which in this metric is neither the shortest motion nor an even one.

    Parameters
    ----------
    joints : int
        Number of links, >= 1.

    Raises
    ------
    InvalidValue
        If `joints` is not such a number.
    """

    joints: int

    def __post_init__(self) -> None:
        joints = require_count("joints", self.joints)
        set_fields(self, joints=joints)
        self._set_axes((-math.pi,) * joints, (math.pi,) * joints, (True,) * joints, (1.0,) * joints)

    @property
    def flat(self) -> None:  # type: ignore[override]
        """None: the metric is that of the plane in which the chain moves."""
        return None

    def distance(self, a: Floats, b: Floats) -> Floats:
        """Return ``sum_m |p_m(a) - p_m(b)|`` for two (n, joints) arrays as (n,), p_m the far end of link m.

        With the headings ``theta_j = q_1 + .. + q_j`` it is ``p_m = (1 / joints) sum_(j <= m) (cos theta_j, sin
        theta_j)``.
        """
        return _distances(*as_batch_pair(a, b, self.joints))

    def all_distances(self, a: Floats, b: Floats) -> Floats:
        """Return the distances of all pairs of rows, (n, joints) and (m, joints), as (n, m)."""
        first, second = as_batch("a", a, self.joints), as_batch("b", b, self.joints)
        return _all_distances(_far_ends(first), _far_ends(second))


@njit(cache=True, nogil=True)
def chain_distance(a: Floats, b: Floats) -> float:
    """Return the distance of two configurations, (joints,): compiled, for compiled callers."""
    heading_a, heading_b, offset_x, offset_y, total = 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(len(a)):
        heading_a += a[k]
        heading_b += b[k]
        offset_x += math.cos(heading_a) - math.cos(heading_b)
        offset_y += math.sin(heading_a) - math.sin(heading_b)
        total += math.sqrt(offset_x * offset_x + offset_y * offset_y)
    return total / len(a)


@njit(cache=True, nogil=True)
def _distances(a, b):  # type: ignore[no-untyped-def]
    return np.array([chain_distance(a[row], b[row]) for row in range(len(a))])


@njit(cache=True, nogil=True)
def _far_ends(q):  # type: ignore[no-untyped-def]
    """Return ``joints p_m`` for each configuration: (n, 2 joints), the x of all links and then their y."""
    joints = q.shape[1]
    ends = np.empty((len(q), 2 * joints))
    for row in range(len(q)):
        heading, x, y = 0.0, 0.0, 0.0
        for k in range(joints):
            heading += q[row, k]
            x, y = x + math.cos(heading), y + math.sin(heading)
            ends[row, k], ends[row, joints + k] = x, y
    return ends


@njit(cache=True, nogil=True)
def _all_distances(a, b):  # type: ignore[no-untyped-def]
    distances = np.empty((len(a), len(b)))
    joints = a.shape[1] // 2
    for i in range(len(a)):
        for j in range(len(b)):
            total = 0.0
            for k in range(joints):
                offset_x, offset_y = a[i, k] - b[j, k], a[i, joints + k] - b[j, joints + k]
                total += math.sqrt(offset_x * offset_x + offset_y * offset_y)
            distances[i, j] = total / joints
    return distances
