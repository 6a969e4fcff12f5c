"""ChainSpace and ChainWorld: a planar chain of links in a horn, the kinematic chain benchmark."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial.distance import cdist

from evenroad._arrays import Bools, Floats, Ints, set_fields
from evenroad._checks import require_count
from evenroad.errors import InvalidValue
from evenroad.space.batch import as_batch, as_batch_pair
from evenroad.space.joints import FlatSpace
from evenroad.world.bisection import between_endpoints
from evenroad_studies.worlds.corridor import BatchWorld, in_order


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


def _distances(a: Floats, b: Floats) -> Floats:
    """Return the distances of the configurations of two arrays, row by row, (n,)."""
    first, second = np.cumsum(a, axis=1), np.cumsum(b, axis=1)
    offset_x, offset_y = (np.cumsum(along(first) - along(second), axis=1) for along in (np.cos, np.sin))
    return np.sqrt(offset_x * offset_x + offset_y * offset_y).sum(axis=1) / a.shape[1]


def _far_ends(q: Floats) -> Floats:
    """Return ``joints p_m`` for each configuration: (n, joints, 2)."""
    headings = np.cumsum(q, axis=1)
    return np.cumsum(np.stack([np.cos(headings), np.sin(headings)], axis=-1), axis=1)


def _all_distances(a: Floats, b: Floats) -> Floats:
    distances = np.zeros((len(a), len(b)))
    for first, second in zip(a.swapaxes(0, 1), b.swapaxes(0, 1), strict=True):
        distances += cdist(first, second)
    return distances / a.shape[1]


_END_PIECE = 0.001
"""Length by which the last link is longer than the others, as one more segment."""
FREE, SELF, WALL = 0, 1, 2
"""Verdicts: nothing is crossed; two links cross; a link crosses a wall."""
_REASONS = {SELF: "two links of the chain cross", WALL: "a link crosses the horn"}


@dataclass(frozen=True)
class ChainWorld(BatchWorld):
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
        # States are rounded: in one fixed order a motion and its reverse have the same.
        a, b = in_order(self.space.wrapped(a), self.space.wrapped(b))
        # rint takes one half to zero: of two opposite ways the one that does not cross -pi is taken.
        difference = (b - a) - 2.0 * math.pi * np.rint((b - a) / (2.0 * math.pi))
        segments = np.ceil(_distances(a, b) / self.resolution).astype(np.int64)
        free = self._valid(a)
        free[free] = self._valid(b[free])
        for motion, state in between_endpoints(segments, free):
            states = a[motion] + (state / segments[motion])[:, np.newaxis] * difference[motion]
            free[motion[~self._valid(states)]] = False
        return free

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


def verdicts(q: Floats, walls: Floats) -> Ints:
    """Return the verdict on each configuration, (n, links)."""
    links = q.shape[1]
    headings = np.cumsum(q, axis=1)
    along = np.stack([np.cos(headings), np.sin(headings)]) / links
    along = np.concatenate([along, along[:, :, -1:] * links * _END_PIECE], axis=2)
    starts = np.zeros_like(along)
    np.cumsum(along[:, :, :-1], axis=2, out=starts[:, :, 1:])
    chain = np.concatenate([starts, along])
    found, rows = np.full(len(q), FREE), np.arange(len(q))
    for k in range(links + 1):
        segment = chain[:, rows, k]
        crosses_wall = _cross_any(segment, walls[:, np.newaxis])
        found[rows[crosses_wall]] = WALL
        # The link before has a joint in common with this one, and no more.
        crosses_itself = _cross_any(segment, chain[:, rows, : max(k - 1, 0)])
        found[rows[crosses_itself]] = SELF
        rows = rows[~(crosses_wall | crosses_itself)]
    return found


def _cross_any(segment: Floats, others: Floats) -> Bools:
    """Return which segments, (4, n), cross one of the others, (4, n or 1, m), inside of both; rows are x, y, dx, dy."""
    x, y, along_x, along_y = segment[..., np.newaxis]
    offset_x, offset_y, other_x, other_y = others[0] - x, others[1] - y, others[2], others[3]
    cross = along_x * other_y - other_x * along_y
    # The lines meet at the shares s / cross and t / cross of the two; a positive cross product is compared.
    size = np.abs(cross)
    sign = np.copysign(1.0, cross)
    s, t = sign * (offset_x * other_y - offset_y * other_x), sign * (offset_x * along_y - offset_y * along_x)
    # Never so where the two are parallel, for then the size is about zero.
    return ((s >= _TOUCHING) & (s < size - _TOUCHING) & (t >= _TOUCHING) & (t < size - _TOUCHING)).any(axis=-1)
