"""ChainSpace and ChainWorld: a planar chain of links in a horn, the kinematic chain benchmark."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numba import njit

from evenroad._arrays import Bools, Floats, Ints, set_fields
from evenroad._checks import require_count
from evenroad.errors import InvalidValue
from evenroad.space.batch import as_batch, as_batch_pair
from evenroad.space.joints import FlatSpace
from evenroad_studies.worlds.bisection import next_between
from evenroad_studies.worlds.corridor import CompiledWorld, comes_first


@dataclass(frozen=True)
class ChainSpace(FlatSpace):
    """Angles of a chain of `joints` links, each ``1 / joints`` long, that lies in the plane and starts at the origin.

    A configuration is the (joints,) angles of each link against the one before, the first against the x axis, in
    radians; any angle is taken, given back are angles in [-pi, pi).  Distances are those of OMPL's kinematic chain
    benchmark: how far the far ends of the links are apart in the plane, summed over the links.  Motions turn every
    joint the short way round at an even speed, which in this metric is neither the shortest motion nor an even one.
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


_END_PIECE = 0.001
"""Length by which the last link is longer than the others, as one more segment."""
FREE, SELF, WALL = 0, 1, 2
"""Verdicts: nothing is crossed; two links cross; a link crosses a wall."""
_REASONS = {SELF: "two links of the chain cross", WALL: "a link crosses the horn"}


@dataclass(frozen=True)
class ChainWorld(CompiledWorld):
    """A planar chain of equal links that must cross neither itself nor the walls of :func:`horn`.

    OMPL's kinematic chain benchmark.  A configuration is free if no two of the segments (the links, 2 to 1000, and a
    piece of 0.001 that goes on after the last) and no segment and wall cross.  Segments that are parallel or only touch
    do not cross.  A motion turns all joints the short way; it is divided into ``ceil(distance / resolution)`` segments,
    whose ends are tested in bisection order.
    """

    links: int = 10

    def __post_init__(self) -> None:
        set_fields(self, links=require_count("links", self.links, at_least=2))
        if self.links > 1000:
            raise InvalidValue(f"links must be at most 1000, got {self.links!r}")

    @cached_property
    def space(self) -> ChainSpace:
        """The joint angles, measured in the plane."""
        return ChainSpace(self.links)

    @cached_property
    def walls(self) -> Floats:
        """The :func:`horn`, read-only."""
        walls = horn(self.links)
        walls.setflags(write=False)
        return walls

    @property
    def resolution(self) -> float:
        """Largest distance between tested states, ``0.01 sqrt(links) 2 pi``: a hundredth of the angles' range."""
        return 0.01 * math.sqrt(self.links) * 2.0 * math.pi

    @property
    def start(self) -> Floats:
        """The chain bent to a half circle inside the horn: (0, pi / links, .., pi / links)."""
        return np.array([0.0] + [math.pi / self.links] * (self.links - 1))

    @property
    def goal(self) -> Floats:
        """The chain stretched out to the other side: (pi - 0.001, 0, .., 0)."""
        return np.array([math.pi - 0.001] + [0.0] * (self.links - 1))

    def _valid(self, q: Floats) -> Bools:
        return verdicts(q, self.walls) == FREE

    def _motion_valid(self, a: Floats, b: Floats) -> Bools:
        return motions_are_free(self.space.wrapped(a), self.space.wrapped(b), self.resolution, self.walls)

    def explain(self, q: Floats) -> str:
        """Return in words why the configuration `q`, (links,), is not free."""
        batch = as_batch("q", np.asarray(q, dtype=np.float64)[np.newaxis], self.links)
        return _REASONS[int(verdicts(batch, self.walls)[0])]


def horn(links: int) -> Floats:
    """Return the walls for a chain of so many links, (4, 2 (links - 1)): a column x, y, dx, dy for each segment.

    The scene "horn" of OMPL's kinematic chain benchmark.  With ``eps = ln(10) / links`` and s = 1, then -1: a chain of
    segments from ``(1 / links, -s eps)``, of length ``(1 / links) (1 + s pi eps)`` and headings ``i pi / links``,
    i = 1 .. links - 1.
    """
    eps = math.log(10.0) / links
    segments = []
    for side in (1.0, -1.0):
        x, y = 1.0 / links, -side * eps
        length = (1.0 + side * math.pi * eps) / links
        for i in range(1, links):
            heading = i * math.pi / links
            along_x, along_y = length * math.cos(heading), length * math.sin(heading)
            segments.append((x, y, along_x, along_y))
            x, y = x + along_x, y + along_y
    return np.ascontiguousarray(np.array(segments).T)


_TOUCHING = float(np.finfo(np.float32).eps)
"""How far, as a cross product, an end must be beyond the other segment for the two to cross: chain only touch."""


@njit(cache=True, nogil=True)
def verdicts(q: Floats, walls: Floats) -> Ints:
    """Return the verdict on each configuration, (n, links)."""
    found = np.empty(len(q), dtype=np.int64)
    chain = np.empty((4, q.shape[1] + 1))
    for row in range(len(q)):
        found[row] = _verdict(q[row], walls, chain)
    return found


@njit(cache=True, nogil=True)
def motions_are_free(a: Floats, b: Floats, resolution: float, walls: Floats) -> Bools:
    """Return which motions between angles in [-pi, pi), (m, links) each, are free at all states that are tested."""
    free = np.empty(len(a), dtype=np.bool_)
    links = a.shape[1]
    chain, state, difference = np.empty((4, links + 1)), np.empty(links), np.empty(links)
    for row in range(len(a)):
        first, second = a[row], b[row]
        if not comes_first(first, second):
            # States are rounded: in one fixed order a motion and its reverse have the same.
            first, second = second, first
        for k in range(links):
            angle = second[k] - first[k]
            # rint takes one half to zero: of two opposite ways the one that does not cross -pi is taken.
            difference[k] = angle - 2.0 * math.pi * np.rint(angle / (2.0 * math.pi))
        segments = math.ceil(chain_distance(first, second) / resolution)
        free[row] = (
            _verdict(first, walls, chain) == FREE
            and _verdict(second, walls, chain) == FREE
            and _motion_is_free(first, difference, segments, walls, chain, state)
        )
    return free


@njit(cache=True, nogil=True)
def _motion_is_free(start, difference, segments, walls, chain, state):  # type: ignore[no-untyped-def]
    level, multiple, number = next_between(1, -1, segments)
    while number > 0:
        for k in range(len(start)):
            state[k] = start[k] + number / segments * difference[k]
        if _verdict(state, walls, chain) != FREE:
            return False
        level, multiple, number = next_between(level, multiple, segments)
    return True


@njit(cache=True, nogil=True)
def _verdict(q, walls, chain):  # type: ignore[no-untyped-def]
    links = len(q)
    heading, x, y = 0.0, 0.0, 0.0
    for k in range(links + 1):
        if k < links:
            heading += q[k]
            along_x, along_y = math.cos(heading) / links, math.sin(heading) / links
        else:
            along_x, along_y = along_x * links * _END_PIECE, along_y * links * _END_PIECE
        chain[0, k], chain[1, k], chain[2, k], chain[3, k] = x, y, along_x, along_y
        # The link before has a joint in common with this one, and no more.
        if _crosses_any(x, y, along_x, along_y, chain, k - 1):
            return SELF
        if _crosses_any(x, y, along_x, along_y, walls, walls.shape[1]):
            return WALL
        x, y = x + along_x, y + along_y
    return FREE


@njit(cache=True, nogil=True)
def _crosses_any(x, y, along_x, along_y, others, count):  # type: ignore[no-untyped-def]
    """Return whether the segment from (x, y) by `along` crosses one of the first `count` others inside of both."""
    crossings = 0
    # Without branches, so that compilers can take several segments at a time.
    for j in range(count):
        offset_x, offset_y = others[0, j] - x, others[1, j] - y
        other_x, other_y = others[2, j], others[3, j]
        cross = along_x * other_y - other_x * along_y
        # The lines meet at the shares s / cross and t / cross of the two; a positive cross product is compared.
        size = abs(cross)
        s = math.copysign(1.0, cross) * (offset_x * other_y - offset_y * other_x)
        t = math.copysign(1.0, cross) * (offset_x * along_y - offset_y * along_x)
        # Never so where the two are parallel, for then the size is about zero.
        crossings += (s >= _TOUCHING) & (s < size - _TOUCHING) & (t >= _TOUCHING) & (t < size - _TOUCHING)
    return crossings > 0
