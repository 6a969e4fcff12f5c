"""Checks of a body of boxes among boxes, for poses and for the states of motions: all together, as arrays."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeAlias

import numpy as np

from evenroad._arrays import Bools, Floats, Ints
from evenroad.space.so3 import SMALL_ANGLE
from evenroad.world.bisection import between_endpoints
from evenroad_studies.worlds.corridor import AT_ONCE
from evenroad_studies.worlds.rigid.oriented_box import SolidTables

_ROUNDING = 4e-6
"""In a proof boxes are enlarged by this share of their points' ways more: quaternions are of norm 1 up to 1e-6."""


_PARALLEL = 1e-14
"""Squared sine below which two edges count as parallel: an axis across both would be rounding alone, and the
faces' axes separate boxes with such edges as well, but for gaps of 1e-7 of their size."""

FEW_STATES = 300
"""Number of states that are tested together: a call for each level of a motion would cost more."""

Boxes: TypeAlias = tuple[Floats, Floats, Floats]
"""Centres, half extents and axes of boxes: (n, 3), (n, 3) and (n, 3, 3) with a column an axis."""


def contacts(poses: Floats, solids: SolidTables, enlarged: Floats | None = None) -> Ints:
    """Return for each pose, (n, 7), the first obstacle that the first box of the body that meets any does, or -1.

    Boxes are closed: touching is meeting.  Each box is enlarged on all sides by so much, (n, boxes), if anything.
    """
    found = np.full(len(poses), -1, dtype=np.int64)
    half = np.broadcast_to(solids.body.half, (len(poses), *solids.body.half.shape))
    if enlarged is not None:
        half = half + enlarged[..., np.newaxis]
    step = max(1, AT_ONCE // max(1, len(solids.reaches) * len(solids.obstacles.centre)))
    for at in range(0, len(poses), step):
        found[at : at + step] = _contacts(poses[at : at + step], half[at : at + step], solids)
    return found


def _contacts(poses: Floats, half: Floats, solids: SolidTables) -> Ints:
    body, obstacles = solids.body, solids.obstacles
    rotation = _rotations(poses)
    axes = rotation[:, np.newaxis] @ body.axes
    centre = poses[:, np.newaxis, :3] + body.centre @ rotation.swapaxes(1, 2)
    reach = (np.abs(axes) @ half[..., np.newaxis])[..., 0]
    near = np.ones((*centre.shape[:2], len(obstacles.centre)), dtype=np.bool_)
    for k in range(3):
        near &= (centre + reach)[..., k, np.newaxis] >= obstacles.low[:, k]
        near &= (centre - reach)[..., k, np.newaxis] <= obstacles.high[:, k]
    row, part, obstacle = np.nonzero(near)
    own = centre[row, part], half[row, part], axes[row, part]
    others = obstacles.centre[obstacle], obstacles.half[obstacle], obstacles.axes[obstacle]
    meets = _overlap(own, others, solids.planar)
    rows, first = np.unique(row[meets], return_index=True)
    found = np.full(len(poses), -1, dtype=np.int64)
    found[rows] = obstacle[meets][first]
    return found


def motions_are_free(a: Floats, b: Floats, step: float, rotation_step: float, solids: SolidTables) -> Bools:
    """Return which motions between poses, (m, 7), are free at both ends and at states between, in bisection order.

    Neighbouring states are at most `step` and, as quaternions, `rotation_step` radians apart.
    """
    # What is far from the whole motion is far from all of its states.
    near = _near_any(a, b, solids)
    free, rows = ~near, np.flatnonzero(near)
    a, b = a[rows], b[rows]
    angle = _angles(a, b)
    segments = np.maximum(np.ceil(_lengths(a, b) / step), np.ceil(angle / rotation_step)).astype(np.int64)
    left = np.ones(len(rows), dtype=np.bool_)
    for motion, state in _states(segments, left):
        count = np.maximum(segments[motion], 1)
        # Two weights, not one fraction: a motion and its reverse then have the same states.
        states = _between(a[motion], b[motion], (count - state) / count, state / count, angle[motion])
        left[motion[contacts(states, solids) >= 0]] = False
    free[rows] = left
    return free


def _states(segments: Ints, left: Bools) -> Iterator[tuple[Ints, Ints]]:
    """Yield motions and numbers of their states, both ends among them: few all at once, many level by level."""
    if segments.sum() <= FEW_STATES:
        motion = np.repeat(np.arange(len(segments)), segments + 1)
        yield motion, np.arange(len(motion)) - np.repeat(np.cumsum(segments + 1) - segments - 1, segments + 1)
        return
    every = np.arange(len(segments))
    yield every, np.zeros_like(every)
    yield every[left], segments[left]
    yield from between_endpoints(segments, left)


def motions_are_proved(a: Floats, b: Floats, tolerance: float, solids: SolidTables) -> Bools:
    """Return which motions between poses, (m, 7), are proved free, with no gap between states.

    If boxes enlarged on all sides by what half an interval moves their points meet nothing at its middle, the boxes
    meet nothing in the whole interval; else both halves are looked at, until an interval moves points by less than
    `tolerance`.
    """
    length, angle = _lengths(a, b), _angles(a, b)
    moved = length[:, np.newaxis] + 2.0 * angle[:, np.newaxis] * solids.reaches
    proved = np.ones(len(a), dtype=np.bool_)
    # The intervals of equal length that are still open: their motions and their numbers along these.
    motion = np.flatnonzero(_near_any(a, b, solids))
    number, share = np.zeros(len(motion), dtype=np.int64), 1.0
    while len(motion):
        at = np.asarray((number + 0.5) * share, dtype=np.float64)
        states = _between(a[motion], b[motion], 1.0 - at, at, angle[motion])
        left = contacts(states, solids, (0.5 + _ROUNDING) * share * moved[motion]) >= 0
        motion, number, states = motion[left], number[left], states[left]
        refused = (share * moved[motion].max(axis=1, initial=0.0) < tolerance) | (contacts(states, solids) >= 0)
        proved[motion[refused]] = False
        left = proved[motion]
        motion, number = np.repeat(motion[left], 2), (2 * number[left, np.newaxis] + (0, 1)).ravel()
        share *= 0.5
    return proved


def _lengths(a: Floats, b: Floats) -> Floats:
    return np.sqrt(((b[:, :3] - a[:, :3]) ** 2).sum(axis=1))


def _between(a: Floats, b: Floats, from_a: Floats, from_b: Floats, angle: Floats) -> Floats:
    """Return the poses with the weights `from_a` and `from_b`: straight, and by slerp (Shoemake 1985)."""
    weights = np.stack([from_a, from_b])
    position = weights[0, :, np.newaxis] * a[:, :3] + weights[1, :, np.newaxis] * b[:, :3]
    turns = angle >= SMALL_ANGLE
    weights[:, turns] = np.sin(weights[:, turns] * angle[turns]) / np.sin(angle[turns])
    return np.hstack([position, weights[0, :, np.newaxis] * a[:, 3:] + weights[1, :, np.newaxis] * b[:, 3:]])


def _angles(a: Floats, b: Floats) -> Floats:
    """Return the angles between quaternions; unlike arccos it keeps all digits of small angles (Kahan)."""
    difference, together = (np.linalg.norm(each[:, 3:], axis=1) for each in (a - b, a + b))
    return 2.0 * np.arctan2(difference, together)


def _near_any(a: Floats, b: Floats, solids: SolidTables) -> Bools:
    """Return which motions balls of the body's reach might meet an obstacle on."""
    reach, obstacles = solids.reaches.max(), solids.obstacles
    low, high = np.minimum(a, b)[:, np.newaxis, :3] - reach, np.maximum(a, b)[:, np.newaxis, :3] + reach
    near: Bools = np.any(np.all((obstacles.low <= high) & (low <= obstacles.high), axis=-1), axis=1)
    return near


def _overlap(own: Boxes, others: Boxes, planar: bool) -> Bools:
    """Test boxes against others by separating axes (Gottschalk, Lin and Manocha, SIGGRAPH 1996, section 5)."""
    (centre, half, axes), (other_centre, other_half, other_axes) = own, others
    across = axes.swapaxes(1, 2)
    products = across @ other_axes
    sizes = np.abs(products)
    # The offset in the box's own axes.
    offset = (across @ (other_centre - centre)[..., np.newaxis])[..., 0]
    apart = np.abs(offset) > half + (sizes @ other_half[..., np.newaxis])[..., 0]
    along = (offset[:, np.newaxis] @ products)[:, 0]
    apart |= np.abs(along) > other_half + (half[:, np.newaxis] @ sizes)[:, 0]
    meets: Bools = ~np.any(apart, axis=1)
    if planar:
        return meets
    i1, i2 = np.array([1, 2, 0]), np.array([2, 0, 1])
    own_reach = half[:, i1, np.newaxis] * sizes[:, i2] + half[:, i2, np.newaxis] * sizes[:, i1]
    reach = other_half[:, np.newaxis, i1] * sizes[:, :, i2] + other_half[:, np.newaxis, i2] * sizes[:, :, i1]
    along = offset[:, i2, np.newaxis] * products[:, i1] - offset[:, i1, np.newaxis] * products[:, i2]
    parallel = 1.0 - products * products < _PARALLEL
    overlaps = parallel | (np.abs(along) <= own_reach + reach)
    meets &= np.all(overlaps, axis=(1, 2))
    return meets


def _rotations(poses: Floats) -> Floats:
    """Return the rotation matrices of the poses' quaternions, whatever their norms, (n, 3, 3)."""
    w, x, y, z = poses[:, 3:].T
    s = 2.0 / (w * w + x * x + y * y + z * z)
    rows = (
        (1.0 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)),
        (s * (x * y + w * z), 1.0 - s * (x * x + z * z), s * (y * z - w * x)),
        (s * (x * z - w * y), s * (y * z + w * x), 1.0 - s * (x * x + y * y)),
    )
    return np.array(rows).transpose(2, 0, 1)
