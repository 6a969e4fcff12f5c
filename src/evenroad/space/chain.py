"""ChainSpace: a planar chain of equal links, measured by how far its joints move in the plane."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from numba import njit

from evenroad._checks import require_count
from evenroad.space.batch import as_batch, as_batch_pair
from evenroad.space.flat_space import FlatSpace


@dataclass(frozen=True)
class ChainSpace(FlatSpace):
    """Angles of a chain of `joints` links, each ``1 / joints`` long, that lies in the plane and starts at the origin.

    A configuration is the (joints,) turns of each link against the one before, the first against the x axis, in
    radians; any angle is taken, given back are angles in [-pi, pi).  The distance of two configurations is the sum,
    over all links, of how far the far ends of the link are apart in the plane: the metric of OMPL's kinematic
    chain benchmark.  Ways turn every joint the short way round at an even speed, which in this metric is neither
    the shortest way nor an even one.

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
        object.__setattr__(self, "joints", joints)
        self._set_axes((-math.pi,) * joints, (math.pi,) * joints, (True,) * joints, (1.0,) * joints)

    @property
    def flat(self) -> None:  # type: ignore[override]
        """None: the metric is that of the plane in which the chain moves."""
        return None

    def distance(self, a: npt.NDArray[np.float64], b: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Return ``sum_m |p_m(a) - p_m(b)|`` for two (n, joints) arrays as (n,), p_m the far end of link m.

        With the headings ``theta_j = q_1 + .. + q_j`` it is ``p_m = (1 / joints) sum_(j <= m) (cos theta_j, sin
        theta_j)``.
        """
        first, second = as_batch_pair(a, b, self.joints)
        return _distances(first, second)

    def wrapped(self, q: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Return `q`, (n, joints), with angles brought into [-pi, pi)."""
        return self._canonical(as_batch("q", q, self.joints))


@njit(cache=True, nogil=True)
def _distances(a, b):  # type: ignore[no-untyped-def]
    distances = np.empty(len(a))
    for row in range(len(a)):
        distances[row] = chain_distance(a[row], b[row])
    return distances


@njit(cache=True, nogil=True)
def chain_distance(a: npt.NDArray[np.float64], b: npt.NDArray[np.float64]) -> float:
    """Return the distance of two configurations, (joints,): compiled, for compiled callers."""
    heading_a, heading_b, apart_x, apart_y, total = 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(len(a)):
        heading_a += a[k]
        heading_b += b[k]
        apart_x += math.cos(heading_a) - math.cos(heading_b)
        apart_y += math.sin(heading_a) - math.sin(heading_b)
        total += math.sqrt(apart_x * apart_x + apart_y * apart_y)
    return total / len(a)
