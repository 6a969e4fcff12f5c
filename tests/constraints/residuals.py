"""Residuals of constraints, in words of NumPy: the slow, readable definition of what compiled code computes."""

import math

import numpy as np

from evenroad.constraints import (
    KeepInBox,
    KeepInPlane,
    KeepJoints,
    KeepOnCircle,
    KeepOrientation,
    KeepTogether,
    KeepUpright,
)
from tests.robots import oracle

TURNED = 0.1 / math.sqrt(2.0)
"""Metres that an entry of a rotation counts."""


def residuals(robot, keep, q):
    """Return how far a bound constraint is off, as vectors, (n, m), at configurations, (n, dim)."""
    poses = oracle.link_poses(robot, q)
    turn, at = poses[keep.tips[0]] if keep.tips else (None, None)
    match keep:
        case KeepUpright():
            return turn @ np.array(keep.axis) - (0.0, 0.0, 1.0)
        case KeepOrientation():
            return turn.reshape(-1, 9) - np.array(keep.rotation)
        case KeepInPlane():
            return (at - np.array(keep.through)) @ keep.across.T
        case KeepInBox():
            return at - np.clip(at, keep.low, keep.high)
        case KeepOnCircle():
            centre, along, out, across = keep.frame
            x, y = (at - centre) @ out, (at - centre) @ across
            height = (at - np.array(keep.pose.xyz)) @ along
            off = [
                turn[i] - turned(along, angle) @ keep.pose.rotation_matrix for i, angle in enumerate(np.arctan2(y, x))
            ]
            return np.column_stack([np.hypot(x, y) - keep.radius, height, TURNED * np.reshape(off, (-1, 9))])
        case KeepTogether():
            other, there = poses[keep.tips[1]]
            gap = np.einsum("nji,nj->ni", turn, there - at) - np.array(keep.pose.xyz)
            off = np.einsum("nji,njk->nik", turn, other).reshape(-1, 9) - np.array(keep.pose.rotation)
            return np.hstack([gap, TURNED * off])
        case KeepJoints():
            return q - np.clip(q, *keep.bounds)
    raise AssertionError(f"no definition of {keep}")


def turned(axis, angle):
    """Return the rotation about an axis of length 1 by an angle (Rodrigues)."""
    x, y, z = axis
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + math.sin(angle) * skew + (1.0 - math.cos(angle)) * (skew @ skew)
