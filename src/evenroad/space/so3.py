"""SO3: rotations of space as unit quaternions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from evenroad._arrays import Bools, Floats
from evenroad._native.space import quaternion_angles
from evenroad.errors import InvalidValue
from evenroad.space.batch import as_batch, as_batch_pair, as_cube_batch, as_fractions
from evenroad.space.protocol import Space

_UNIT_TOLERANCE = 1e-6
"""Largest distance of a norm from 1. It allows for quaternions read from a text file with seven digits."""
SMALL_ANGLE = 1e-8
"""Angle below which a chord and its arc agree to the last bit, and sin(angle) is too small to divide by safely."""


@dataclass(frozen=True)
class SO3(Space):
    """The rotations of space as unit quaternions (w, x, y, z); q and -q are the same rotation.

    The metric is ``arccos |q . q'|``, in radians: half the angle of the rotation from one to the other, at
    most pi / 2.  Points of the cube have 3 coordinates, configurations 4.  Norms may differ from 1 by 1e-6.

    Examples
    --------
    >>> import evenroad as er
    >>> er.spaces.SO3().distance([(1, 0, 0, 0)], [(0, 1, 0, 0)]).round(3).tolist()
    [1.571]
    """

    @property
    def dim(self) -> int:
        """Numbers in a quaternion: 4."""
        return 4

    @property
    def cube_dim(self) -> int:
        """Number of coordinates of a point of the cube: 3."""
        return 3

    def from_cube(self, u: Floats) -> Floats:
        """Map `u`, (n, 3) in [0, 1]^3, to quaternions, (n, 4), so that equal volumes get equal measure.

        The map is that of K. Shoemake, "Uniform random rotations", Graphics Gems III, 1992, pp. 124-132.  It reaches
        all unit quaternions, so each rotation twice.
        """
        unit = as_cube_batch(u, 3)
        near, far = np.sqrt(1.0 - unit[:, 0]), np.sqrt(unit[:, 0])
        first, second = 2.0 * np.pi * unit[:, 1], 2.0 * np.pi * unit[:, 2]
        x, y, z, w = near * np.sin(first), near * np.cos(first), far * np.sin(second), far * np.cos(second)
        return np.column_stack([w, x, y, z])

    def contains(self, q: Floats) -> Bools:
        """Return for each row of `q`, (n, 4), whether its norm is 1 up to 1e-6: (n,)."""
        return np.abs(_norm(as_batch("q", q, 4)) - 1.0) <= _UNIT_TOLERANCE

    def distance(self, a: Floats, b: Floats) -> Floats:
        """Return ``arccos |a . b|`` of the rows of two (n, 4) arrays, (n,), in [0, pi / 2]."""
        return _angle(*_on_one_side(a, b))

    def all_distances(self, a: Floats, b: Floats) -> Floats:
        """Return the distances of all pairs of rows, (n, 4) and (m, 4), as (n, m).  Errors as `distance`."""
        first, second = as_batch("a", a, 4), as_batch("b", b, 4)
        _require_units(a=first, b=second)
        return quaternion_angles(first, second)

    def interpolate(self, a: Floats, b: Floats, t: Floats | float) -> Floats:
        """Return the rotations a fraction `t`, scalar or (n,) in [0, 1], of the shortest turn from `a` to `b`.

        It is spherical linear interpolation (K. Shoemake, SIGGRAPH 1985) towards b or -b, whichever is nearer, and
        towards b if they are equally near.  It is exact at both endpoints.  Errors are those of `distance`.
        """
        first, nearer = _on_one_side(a, b)
        fraction = as_fractions(t, len(first))
        angle = _angle(first, nearer)[:, np.newaxis]
        is_small = angle < SMALL_ANGLE
        sine = np.where(is_small, 1.0, np.sin(angle))
        from_first = np.where(is_small, 1.0 - fraction, np.sin((1.0 - fraction) * angle) / sine)
        from_nearer = np.where(is_small, fraction, np.sin(fraction * angle) / sine)
        between = from_first * first + from_nearer * nearer
        between /= _norm(between)[:, np.newaxis]
        # The endpoint keeps its own sign.
        return np.where(fraction == 0.0, first, np.where(fraction == 1.0, b, between))


def _require_units(**batches: Floats) -> None:
    """Raise InvalidValue for a row that is not a quaternion of norm 1."""
    for name, batch in batches.items():
        norm = _norm(batch)
        wrong = np.flatnonzero(np.abs(norm - 1.0) > _UNIT_TOLERANCE)
        if len(wrong):
            row, bad = int(wrong[0]), float(norm[wrong[0]])
            raise InvalidValue(f"{name} must hold unit quaternions: row {row} has norm {bad!r}")


def _norm(q: Floats) -> Floats:
    # Not a library call: bits of a row must not depend on the length of the batch, and huge entries not overflow.
    return np.hypot(np.hypot(q[:, 0], q[:, 1]), np.hypot(q[:, 2], q[:, 3]))


def _on_one_side(a: Floats, b: Floats) -> tuple[Floats, Floats]:
    """Return the unit quaternions `a` and `b`, (n, 4), with the signs of `b` changed to bring it nearer to `a`."""
    first, second = as_batch_pair(a, b, 4)
    _require_units(a=first, b=second)
    products = first * second
    dot = products[:, 0] + products[:, 1] + products[:, 2] + products[:, 3]
    return first, np.where(dot < 0.0, -1.0, 1.0)[:, np.newaxis] * second


def _angle(a: Floats, b: Floats) -> Floats:
    """Return the angle between unit vectors; unlike arccos it keeps all digits of small angles (Kahan)."""
    return 2.0 * np.arctan2(_norm(a - b), _norm(a + b))
