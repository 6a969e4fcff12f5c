"""Blends at the corners of a car's path, proved free: where the curvature jumps, two clothoids come between."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from evenroad._arrays import Floats
from evenroad._native.drive import Steering
from evenroad.driving.car_world import CarWorld
from evenroad.trajectory.clothoid import AFTER, BEFORE, LONGEST, OFF, Blend, blend_of, corner_of, poses_on, starts_of
from evenroad.trajectory.drive_limits import DriveLimits

_TRIES = 6
"""Number of lengths that are tried at a corner, each half of the one before; then the car stops there."""
_GROWN = 2e-3
"""By how much a footprint is larger in proofs of clothoids [cells]: the arcs in their place are off by less."""
_SHARES = 1.0, 0.5, 0.2
"""Lengths that are tried for the blend of a whole turn, between that of the turn and the longest."""
_WIDEST = 2.5
"""Largest angle of a turn that is replaced as a whole [rad]."""
_NO_LENGTH = 1e-9
"""Share of a piece that is always left."""
_NO_CURVATURE = 1e-9
"""Arcs of a smaller curvature are straight in proofs."""


class Blended(NamedTuple):
    """Pieces with blends, (k, 3), the number of these, and their largest distance from the path."""

    pieces: Floats
    blends: int
    deviation: float


def with_blends(world: CarWorld, start: Floats, pieces: Floats, limits: DriveLimits, deviation: float) -> Blended:
    """Return pieces, (k, 3), with blends where the curvature jumps between a straight drive and a turn.

    A turn between two straight drives is replaced as a whole where that is proved free, and else each jump on its own.
    """
    straight, lengths = pieces[:, 0] == 0.0, np.abs(pieces[:, 2])
    jumps = (straight[1:] != straight[:-1]) & (pieces[1:, 2] * pieces[:-1, 2] > 0.0)
    # A piece between two jumps leaves half of its length to each.
    between = np.append(jumps, False) & np.append(False, jumps)
    usable = lengths * np.where(between, 0.5, 1.0) * (1.0 - _NO_LENGTH)
    starts, left, near = starts_of(start, pieces), lengths.copy(), nearer(world)
    found: dict[int, Blend] = {}

    def first_free(i: int, blends: Iterable[Blend]) -> Blend | None:
        """Return the first of blends from piece i on that is free."""
        for blend in blends:
            begin = poses_on(starts[i : i + 1], pieces[i : i + 1], np.array([lengths[i] - blend.before]))[0]
            if clothoids_free(near, begin, blend.pieces):
                return blend
        return None

    still = jumps.copy()
    for i in np.flatnonzero(between & ~straight).tolist():
        blend = first_free(i - 1, _around(pieces[i], usable[[i - 1, i + 1]], limits, deviation))
        if blend is not None:
            found[i - 1], still[i - 1 : i + 1] = blend, False
            left[i - 1 : i + 2] -= blend.before, lengths[i], blend.after
    for i in np.flatnonzero(still).tolist():
        blend = first_free(i, _tried(pieces[i], pieces[i + 1], usable[i : i + 2], limits, deviation))
        if blend is not None:
            found[i], still[i] = blend, False
            left[i : i + 2] -= blend.before, blend.after
    rows = []
    for i, (first, last, signed) in enumerate(pieces):
        if left[i] > 0.0:
            rows.append(np.array([[first, last, np.copysign(left[i], signed)]]))
        if i in found:
            rows.append(found[i].pieces)
    blends = int(np.count_nonzero(jumps & ~still))
    return Blended(np.concatenate(rows), blends, max((each.deviation for each in found.values()), default=0.0))


def _around(turn: Floats, usable: Floats, limits: DriveLimits, deviation: float) -> Iterator[Blend]:
    """Yield pairs of clothoids that replace a turn between straight drives: the longest that does not slow the car down
    or that fits, and shorter ones.  None is as sharp as the turn.
    """
    curvature, length = abs(float(turn[0])), abs(float(turn[2]))
    turned = curvature * length
    if turned > _WIDEST:
        return
    unit = corner_of(turned)
    assert limits.curvature_rate is not None, "else nothing is blended"
    # Of the turn, as of the unit: how far its endpoints and its middle are from where the straight drives would meet.
    before, middle = math.tan(0.5 * turned) / curvature, (1.0 / math.cos(0.5 * turned) - 1.0) / curvature
    wanted = max(math.sqrt(turned * limits.speed / limits.curvature_rate), turned * limits.speed**2 / limits.across)
    most = min((min(usable) + before) / unit.before, (deviation + middle) / unit.deviation, max(wanted, length))
    for share in _SHARES if most >= length else ():
        half = length + share * (most - length)
        pieces = unit.pieces * [np.sign(turn[0]) / half, np.sign(turn[0]) / half, np.copysign(half, turn[2])]
        reach = half * unit.before - before
        yield Blend(pieces, reach, reach, abs(half * unit.deviation - middle))


def _tried(first: Floats, second: Floats, usable: Floats, limits: DriveLimits, deviation: float) -> Iterator[Blend]:
    """Yield the blends of two pieces that are worth trying, from the longest that does not slow the car down."""
    turn, of_straight, of_turn = (second, *usable) if first[0] == 0.0 else (first, *usable[::-1])
    curvature = abs(float(turn[0]))
    assert limits.curvature_rate is not None, "else nothing is blended"
    fastest, _ = limits.along(curvature, 0.0)
    # All lengths are in radii of the turn.
    length = min(LONGEST, curvature**2 * fastest / limits.curvature_rate, math.sqrt(deviation * curvature / OFF))
    length = min(length, of_straight * curvature / BEFORE, of_turn * curvature / AFTER)
    for _ in range(_TRIES if length > 0.0 else 0):
        yield blend_of(length).between(first, second)
        length *= 0.5


def nearer(world: CarWorld) -> CarWorld:
    """Return the world of a footprint that is a little larger, for :func:`clothoids_free`."""
    return replace(world, clearance=world.clearance + _GROWN * world.grid.resolution)


def clothoids_free(near: CarWorld, start: Floats, pieces: Floats) -> bool:
    """Return whether all that is swept along pieces, (k, 3), from a pose, (3,), is proved free, by the `nearer` world.

    A clothoid is tested as arcs that begin on it, each with the curvature of its middle.  Along one of length h, where
    the curvature changes by c in a unit of length, the heading is off by at most c h^2 / 8, and the position by
    c h^3 / 12.  The footprint is larger by what its farthest point is off then.
    """
    grown, reach = _GROWN * near.grid.resolution, near.footprint.reach + near.clearance
    for pose, piece in zip(starts_of(start, pieces), pieces, strict=False):
        first, last, signed = piece.tolist()
        change = abs(last - first) / abs(signed)
        off = change * (reach / 8.0 + abs(signed) / 12.0)
        count = math.ceil(abs(signed) * math.sqrt(off / grown)) or 1
        begins = np.arange(count) / count
        poses = poses_on(np.tile(pose, (count, 1)), np.tile(piece, (count, 1)), begins * abs(signed))
        curvatures = first + (last - first) * (begins + 0.5 / count)
        for begin, curvature in zip(poses, curvatures.tolist(), strict=True):
            side = 0.0 if abs(curvature) < _NO_CURVATURE else math.copysign(1.0, curvature)
            steering = Steering(1.0 / abs(curvature) if side else 1.0, 1.0, True, 0.0)
            if not near.vehicle.pieces_free(steering, begin, np.array([[side, signed / count]])):
                return False
    return True
