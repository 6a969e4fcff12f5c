"""Rotations as the nine numbers of a matrix, row by row."""

from __future__ import annotations

import math


def rotation_from_rpy(roll: float, pitch: float, yaw: float) -> tuple[float, ...]:
    """Return ``Rz(yaw) Ry(pitch) Rx(roll)``, the convention of URDF, for angles in radians."""
    (sr, cr), (sp, cp), (sy, cy) = ((math.sin(angle), math.cos(angle)) for angle in (roll, pitch, yaw))
    return (
        *(cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
        *(sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr),
        *(-sp, cp * sr, cp * cr),
    )
