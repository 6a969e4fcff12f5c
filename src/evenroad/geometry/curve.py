"""Curve: poses of a tip in sequence, so close together that the motion between two of them hardly matters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from evenroad._arrays import Floats, Ints
from evenroad.errors import InvalidValue
from evenroad.geometry.pose import Pose

if TYPE_CHECKING:
    # Imported late: only curves need it.
    from scipy.spatial.transform import Rotation

STEP, TURN = 0.005, 0.05
"""Largest distance and turn between two neighbouring poses of a curve [m, rad]."""

SAG = 1e-5
"""Largest distance of a curve from the straight lines between its poses [m]."""

MOST = 100_000
"""Largest number of poses of a curve."""

_CORNER = 1e-3
"""Largest change of direction that does not count as a corner [rad]."""
_FLAT = 1e-6
"""Sine of the angle below which three points lie on a line."""


@dataclass(frozen=True, eq=False)
class Curve:
    """Poses along a curve, (n, 12): rotation row by row, and origin.

    `via` are the rows of the poses that it was made of, `stops` those at which its direction jumps.
    """

    poses: Floats
    via: Ints
    stops: Ints

    @property
    def lengths(self) -> Floats:
        """Arc length from the start of the curve to each pose, (n,) [m]."""
        return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(self.poses[:, 9:], axis=0), axis=1))])


def polyline(poses: Sequence[Pose], blend: float = 0.0) -> Curve:
    """Return straight lines through two poses or more, with a constant rate of rotation on each line.

    With a `blend` [m], a parabola rounds each inner pose.  It leaves the line at this distance from the pose, or
    halfway along the line if that is shorter, and is never farther from the pose than that.
    """
    at, turned = _read(poses)
    given, corners = _rows(at, turned), _corners(at, turned)
    legs = np.linalg.norm(np.diff(at, axis=0), axis=1)
    cut = np.zeros(len(at))
    cut[1:-1] = np.minimum(blend, 0.5 * np.minimum(legs[:-1], legs[1:]))
    shares = cut[:-1] / np.maximum(legs, 1e-300), 1.0 - cut[1:] / np.maximum(legs, 1e-300)
    first, middle, last = (_on(at, turned, share) for share in (shares[0], 0.5 * (shares[0] + shares[1]), shares[1]))
    # Each piece is a parabola from a pose towards a middle one to another. A line has its own middle there.
    rounded = 1 + np.flatnonzero(cut[1:-1])
    order = np.argsort(np.concatenate([np.arange(len(legs)), rounded - 0.5]), kind="stable")
    pieces = (first, last[rounded - 1]), (middle, given[rounded]), (last, first[rounded])
    samples, rows = _parabolas(*(np.concatenate(pair)[order] for pair in pieces))
    via = np.concatenate([[0], rows[order < len(legs)]])
    return Curve(samples, via, via[np.setdiff1d(corners, rounded)])


def spline(poses: Sequence[Pose]) -> Curve:
    """Return the smooth curve that passes through two poses or more: a cubic spline over the lengths between them."""
    from scipy.interpolate import CubicSpline
    from scipy.spatial.transform import RotationSpline

    at, turned = _read(poses)
    if len(at) < 3:
        return polyline(poses)
    turns = (turned[:-1].inv() * turned[1:]).magnitude()
    legs = np.linalg.norm(np.diff(at, axis=0), axis=1)
    knots = np.concatenate([[0.0], np.cumsum(np.maximum(legs, STEP / TURN * turns))])
    through = CubicSpline(knots, at)
    bent = np.linalg.norm(through(knots, 2), axis=1)
    count = _count(1.5 * legs, 1.5 * turns, np.diff(knots) ** 2 * np.maximum(bent[:-1], bent[1:]))
    shares = np.concatenate([np.arange(each) / each for each in count])
    row = np.repeat(np.arange(len(legs)), count)
    t = np.append(knots[row] + shares * np.diff(knots)[row], knots[-1])
    rotations = RotationSpline(knots, turned)(t)
    via = np.concatenate([[0], np.cumsum(count)])
    return Curve(_rows(through(t), rotations), via, via[:0])


def circle(start: Pose, via: Pose, to: Pose) -> Curve:
    """Return the circular arc from a pose through another to a third one; rotations change smoothly.

    Raises InvalidValue if the three are on a line.
    """
    from scipy.spatial.transform import RotationSpline

    at, turned = _read([start, via, to])
    a, b = at[1] - at[0], at[2] - at[0]
    normal = np.cross(a, b)
    if np.linalg.norm(normal) <= _FLAT * np.linalg.norm(a) * np.linalg.norm(b):
        raise InvalidValue(
            "a circle needs three points that are not on a line, got the start at"
            f" {_text(at[0])}, via {_text(at[1])} and to {_text(at[2])}"
        )
    # The centre of the circle around a triangle (Coxeter 1969, section 1.5).
    centre = at[0] + (a @ a * np.cross(b, normal) + b @ b * np.cross(normal, a)) / (2.0 * normal @ normal)
    x = at[0] - centre
    y = np.cross(normal, x) / np.linalg.norm(normal)
    angles = np.array([0.0, *(np.arctan2((each - centre) @ y, (each - centre) @ x) % (2.0 * np.pi) for each in at[1:])])
    radius = float(np.linalg.norm(x))
    turns = (turned[:-1].inv() * turned[1:]).magnitude()
    count = _count(radius * np.diff(angles), 1.5 * turns, radius * np.diff(angles) ** 2)
    share = np.concatenate([np.arange(each) / each for each in count])
    row = np.repeat([0, 1], count)
    angle = np.append(angles[row] + share * np.diff(angles)[row], angles[2])
    along = angle[:, np.newaxis]
    positions = centre + np.cos(along) * x + np.sin(along) * y
    rows = np.array([0, count[0], count.sum()])
    positions[rows] = at
    return Curve(_rows(positions, RotationSpline(angles, turned)(angle)), rows, rows[:0])


def _read(poses: Sequence[Pose]) -> tuple[Floats, Rotation]:
    from scipy.spatial.transform import Rotation

    at = np.array([pose.xyz for pose in poses])
    return at, Rotation.from_matrix(np.array([pose.rotation for pose in poses]).reshape(-1, 3, 3))


def _text(point: Floats) -> str:
    return f"({', '.join(f'{each:.4g}' for each in point)})"


def _turned(a: Rotation, b: Rotation, share: Floats) -> Rotation:
    """Return the rotations at shares, (n,), of the shortest turns from each of `a` to that of `b`."""
    from scipy.spatial.transform import Rotation

    return a * Rotation.from_rotvec(share[:, np.newaxis] * (a.inv() * b).as_rotvec())


def _on(at: Floats, turned: Rotation, share: Floats) -> Floats:
    """Return the pose at a share, (n - 1,), of each line between neighbouring poses, (n - 1, 12)."""
    along = share[:, np.newaxis]
    return _rows((1.0 - along) * at[:-1] + along * at[1:], _turned(turned[:-1], turned[1:], share))


def _rows(positions: Floats, rotations: Rotation) -> Floats:
    return np.hstack([rotations.as_matrix().reshape(-1, 9), positions])


def _count(lengths: Floats, turns: Floats, bent: Floats) -> Ints:
    """Return the number of equal steps of each piece; `bent` bounds its second derivative by its parameter in [0, 1].

    A chord over a parameter interval h is at most h^2 / 8 times that bound away from its piece.
    """
    steps = np.ceil(np.maximum.reduce([lengths / STEP, turns / TURN, np.sqrt(bent / (8.0 * SAG))]) - 1e-9)
    if steps.sum() > MOST:
        raise InvalidValue(f"the curve is {lengths.sum():.4g} m long and needs {steps.sum():.0f} poses, of {MOST}")
    counts: Ints = np.maximum(steps, 1.0).astype(np.int64)
    return counts


def _parabolas(a: Floats, c: Floats, b: Floats) -> tuple[Floats, Ints]:
    """Return poses along parabolas from `a` towards `c` to `b`, (n, 12) each, and the rows at which they end."""
    from scipy.spatial.transform import Rotation

    turned = [Rotation.from_matrix(each[:, :9].reshape(-1, 3, 3)) for each in (a, c, b)]
    legs = np.linalg.norm(c[:, 9:] - a[:, 9:], axis=1) + np.linalg.norm(b[:, 9:] - c[:, 9:], axis=1)
    turns = (turned[0].inv() * turned[1]).magnitude() + (turned[1].inv() * turned[2]).magnitude()
    count = _count(legs, turns, 2.0 * np.linalg.norm((a - 2.0 * c + b)[:, 9:], axis=1))
    row = np.repeat(np.arange(len(a)), count)
    share = np.concatenate([np.arange(1, each + 1) / each for each in count])
    t = share[:, np.newaxis]
    positions = (1.0 - t) ** 2 * a[row, 9:] + 2.0 * t * (1.0 - t) * c[row, 9:] + t**2 * b[row, 9:]
    towards = [_turned(turned[k][row], turned[k + 1][row], share) for k in (0, 1)]
    samples = np.vstack([a[:1], _rows(positions, _turned(towards[0], towards[1], share))])
    rows = np.cumsum(count)
    samples[rows] = b
    return samples, rows


def _corners(at: Floats, turned: Rotation) -> Ints:
    """Return the inner poses at which a polyline's direction or its axis of rotation jumps."""
    legs, turns = np.diff(at, axis=0), (turned[:-1].inv() * turned[1:]).as_rotvec()
    # Rotation vectors in the frame of the root.
    turns = turned[:-1].apply(turns)
    lengths = np.linalg.norm(legs, axis=1)
    jumps = np.zeros(len(at), dtype=bool)
    along = legs / np.maximum(lengths, 1e-12)[:, np.newaxis]
    jumps[1:-1] = np.linalg.norm(np.diff(along, axis=0), axis=1) > _CORNER
    rate = turns / np.maximum(lengths, STEP)[:, np.newaxis]
    jumps[1:-1] |= STEP * np.linalg.norm(np.diff(rate, axis=0), axis=1) > _CORNER
    return np.flatnonzero(jumps)
