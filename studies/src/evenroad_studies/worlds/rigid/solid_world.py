"""SolidWorld: a rigid body of boxes among boxes and rectangles; and the poses of the spaces that bodies move in."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import ClassVar, TypeAlias

import numpy as np

from evenroad._arrays import Bools, Floats, Ints, set_fields
from evenroad._checks import as_row, require_positive
from evenroad._fingerprint import fingerprint_of
from evenroad.errors import InvalidValue
from evenroad.geometry.mesh import TriangleMesh
from evenroad.space import SO3, BoxSpace, Circle, Product, Space
from evenroad.space.batch import as_batch, as_batch_pair
from evenroad.world.bisection import require_few_segments
from evenroad.world.function import OUTSIDE
from evenroad_studies.worlds.rigid.kernel import contacts, motions_are_free, motions_are_proved
from evenroad_studies.worlds.rigid.oriented_box import OrientedBox, SolidTables, box_table, reaches_of

_TOLERANCE = 1e-3
"""How near to contact `SolidWorld.validate` still proves a motion free, as a share of the step of translations."""


RigidSpace: TypeAlias = Product | BoxSpace
"""``SE2(..)``, ``SE3(..)``, or a `BoxSpace` of 2 or 3 axes for a body that does not rotate."""


def body_dimension(space: Space) -> int:
    """Return 2 or 3: the dimension of the bodies that move in `space`.

    Raises InvalidValue if `space` is none of ``SE2(..)``, ``SE3(..)`` and a `BoxSpace` of 2 or 3 axes.
    """
    if isinstance(space, BoxSpace) and space.dim in (2, 3):
        return space.dim
    if isinstance(space, Product) and len(space.parts) == 2 and isinstance(space.parts[0], BoxSpace):
        position, rotation = space.parts
        for dim, kind in ((2, Circle), (3, SO3)):
            if position.dim == dim and isinstance(rotation, kind):
                return dim
    raise InvalidValue(f"space must be SE2(..), SE3(..) or a BoxSpace of 2 or 3 axes, got {space!r}")


def contact_with(obstacles: Sequence[OrientedBox | TriangleMesh], number: int) -> str:
    """Say which obstacle a body meets."""
    name = obstacles[number].name
    return f"the body meets obstacle {number}{f' ({name})' if name else ''}"


def as_poses(q: Floats, space: Space) -> Floats:
    """Return configurations (n, dim) of such a space as (n, 7): x, y, z, then the quaternion's w, x, y, z.

    The quaternions of a space that contains `q` are of norm 1; others are not, and are not looked at.
    """
    dim = body_dimension(space)
    poses = np.zeros((len(q), 7))
    poses[:, :dim] = q[:, :dim]
    poses[:, 3] = 1.0
    if isinstance(space, Product) and dim == 3:
        poses[:, 3:] = q[:, 3:]
    elif isinstance(space, Product):
        half = _heading(q) / 2.0
        poses[:, 3], poses[:, 6] = np.cos(half), np.sin(half)
    return poses


def as_pose_pair(a: Floats, b: Floats, space: Space) -> tuple[Floats, Floats]:
    """Return start and end poses whose quaternions have signs such that the shorter arc is the space's path."""
    first, second = as_poses(a, space), as_poses(b, space)
    if not isinstance(space, Product):
        return first, second
    if body_dimension(space) == 3:
        p, q = first[:, 3:].T, second[:, 3:].T
        other_sign = p[0] * q[0] + p[1] * q[1] + p[2] * q[2] + p[3] * q[3] < 0.0
    else:
        # Exactly opposite headings: their quaternions' product is zero up to rounding and decides nothing.
        other_sign = np.abs(_heading(b) - _heading(a)) > np.pi
    second[other_sign, 3:] *= -1.0
    return first, second


def _heading(q: Floats) -> Floats:
    """Return the headings of planar poses in [-pi, pi)."""
    return Circle().wrapped(q[:, 2:])[:, 0]


@dataclass(frozen=True, eq=False)
class SolidWorld:
    """A rigid body of boxes that moves among boxes and rectangles, in the plane or in space.

    A pose is free if it lies in the space and no box of the body meets an obstacle; touching is meeting.  The
    tests are exact up to rounding, about 1e-7 of the boxes' sizes.  Boxes are solid.  For obstacles that are
    surfaces, with room inside, use rectangles: boxes with a half extent of zero, or :func:`shell`.

    A motion is divided into ``n = max(ceil(distance / step), ceil(rotation / rotation_step))`` segments and free if
    all n + 1 ends of segments are; they are tested in bisection order, the ends first.  What lies between two states is
    not seen; `validate` proves the motions of a path that is handed out, with no gap.

    `space` are the poses of the body's frame, ``SE2(..)``, ``SE3(..)``, or a BoxSpace of 2 or 3 axes, in which the
    body does not rotate; all boxes are of its plane or space, those of the `body`, at least one, in the body's frame.
    `resolution` is `step`, and for SE2 and SE3 `rotation_step`: the largest distance and rotation between neighbouring
    states, > 0, measured as the space does: headings in radians, quaternions by ``arccos |q . q'|``.  InvalidValue for
    anything else.
    """

    proof: ClassVar[str] = "certified"
    """What `validate` calls free is proved to be, everywhere between its ends."""

    space: RigidSpace
    body: Sequence[OrientedBox]
    obstacles: Sequence[OrientedBox]
    resolution: float | Sequence[float]
    _solids: SolidTables = field(init=False, repr=False)
    _steps: tuple[float, float] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        dim = body_dimension(self.space)
        body, obstacles = _as_boxes("body", self.body, dim), _as_boxes("obstacles", self.obstacles, dim)
        if not body:
            raise InvalidValue("body must be one box or more, got none")
        resolution, steps = _as_steps(self.resolution, self.space)
        set_fields(self, body=body, obstacles=obstacles, resolution=resolution, _steps=steps)
        tables = SolidTables(box_table(body), box_table(obstacles), reaches_of(body), dim == 2)
        set_fields(self, _solids=tables)

    def fingerprint(self) -> str:
        """Return the SHA-256 (hex) of space, body, obstacles and resolution: equal for worlds of the same verdicts."""
        return fingerprint_of("solid", self.space, self.body, self.obstacles, self.resolution)

    def valid(self, q: Floats) -> Bools:
        """Return which poses, (n, dim), lie in the space and are free: (n,)."""
        batch = as_batch("q", q, self.space.dim)
        free = self.space.contains(batch)
        inside = np.flatnonzero(free)
        free[inside] = self._contacts(batch[inside]) < 0
        return free

    def motion_valid(self, a: Floats, b: Floats) -> Bools:
        """Return which motions from each row of `a` to that of `b`, two (m, dim) arrays, are free: (m,)."""
        first, second = as_batch_pair(a, b, self.space.dim)
        free = self.space.contains(first) & self.space.contains(second)
        inside = np.flatnonzero(free)
        start, end = as_pose_pair(first[inside], second[inside], self.space)
        free[inside] = motions_are_free(start, end, *self._steps, self._solids)
        return free

    def validate(self, path: Floats) -> Bools:
        """Return which motions of a path, (p, dim), are proved free: (p - 1,).

        Stricter than testing states, however many: no stretch of a motion is left open.  A motion is refused, too, that
        comes nearer to an obstacle than about a thousandth of `step`.
        """
        waypoints = as_batch("path", path, self.space.dim)
        inside = self.space.contains(waypoints)
        proved = inside[:-1] & inside[1:]
        rows = np.flatnonzero(proved)
        start, end = as_pose_pair(waypoints[rows], waypoints[rows + 1], self.space)
        proved[rows] = motions_are_proved(start, end, _TOLERANCE * self._steps[0], self._solids)
        return proved

    def explain(self, q: Floats) -> str:
        """Return in words why the pose `q`, (dim,), is not free."""
        pose = as_batch("q", np.asarray(q, dtype=np.float64)[np.newaxis], self.space.dim)
        if not self.space.contains(pose)[0]:
            return OUTSIDE
        return contact_with(self.obstacles, int(self._contacts(pose)[0]))

    def _contacts(self, q: Floats) -> Ints:
        return contacts(as_poses(q, self.space), self._solids)


def _as_boxes(name: str, boxes: Sequence[OrientedBox], dim: int) -> tuple[OrientedBox, ...]:
    row = tuple(boxes)
    for i, box in enumerate(row):
        if not isinstance(box, OrientedBox) or box.dim != dim:
            raise InvalidValue(f"{name} must be OrientedBox values of {dim} dimensions, got {box!r} at {i}")
    return row


def _as_steps(
    resolution: float | Sequence[float], space: RigidSpace
) -> tuple[float | tuple[float, ...], tuple[float, float]]:
    """Return the resolution as a value, and the steps of position and quaternion that follow from it."""
    position = space.parts[0] if isinstance(space, Product) else space
    assert isinstance(position, BoxSpace)  # as body_dimension has seen to
    value: float | tuple[float, ...]
    if isinstance(space, Product):
        if not isinstance(resolution, Sequence | np.ndarray) or isinstance(resolution, str):
            raise InvalidValue(f"resolution must be a distance and a rotation here, got {resolution!r}")
        value = as_row("resolution", resolution, 2)
        distance, rotation = (require_positive("resolution", number) for number in value)
        # A heading changes twice as much as its quaternion.
        steps = (distance, rotation if position.dim == 3 else rotation / 2.0)
    else:
        value = require_positive("resolution", resolution)
        steps = (value, 1.0)
    longest = math.dist(position.low, position.high)
    require_few_segments(resolution, max(longest / steps[0], math.pi / steps[1]))
    return value, steps
