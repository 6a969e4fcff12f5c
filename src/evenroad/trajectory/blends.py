"""Blends at the corners of a car's path, proved free: where the curvature jumps, two clothoids come between."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from evenroad._arrays import Floats
from evenroad._native.drive import Steering
from evenroad.driving.car_world import CarWorld
from evenroad.trajectory.clothoid import AFTER, BEFORE, LONGEST, OFF, Blend, blend_of, poses_on, starts_of
from evenroad.trajectory.drive_limits import DriveLimits

_TRIES = 6
"""Number of lengths that are tried at a corner, each half of the one before; then the car stops there."""
_GROWN = 2e-3
"""By how much a footprint is larger in proofs of clothoids [cells]: the arcs in their place are off by less."""
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
    """Return pieces, (k, 3), with a blend at each corner of a straight drive and a turn where one is proved free."""
    straight, lengths = pieces[:, 0] == 0.0, np.abs(pieces[:, 2])
    is_corner = (straight[1:] != straight[:-1]) & (pieces[1:, 2] * pieces[:-1, 2] > 0.0)
    # A piece between two corners leaves half of its length to each.
    between = np.append(is_corner, False) & np.append(False, is_corner)
    usable = lengths * np.where(between, 0.5, 1.0) * (1.0 - _NO_LENGTH)
    starts, left, found, near = starts_of(start, pieces), lengths.copy(), {}, nearer(world)
    for i in np.flatnonzero(is_corner).tolist():
        for blend in _tried(pieces[i], pieces[i + 1], usable[i : i + 2], limits, deviation):
            begin = poses_on(starts[i : i + 1], pieces[i : i + 1], np.array([lengths[i] - blend.before]))[0]
            if clothoids_free(near, begin, blend.pieces):
                found[i] = blend
                left[i] -= blend.before
                left[i + 1] -= blend.after
                break
    rows = []
    for i, (first, last, signed) in enumerate(pieces):
        rows.append(np.array([[first, last, np.copysign(left[i], signed)]]))
        if i in found:
            rows.append(found[i].pieces)
    return Blended(np.concatenate(rows), len(found), max((each.deviation for each in found.values()), default=0.0))


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
