"""An arm that follows a handle: the configuration near another that moves a link to a pose."""

from __future__ import annotations

import numpy as np

from evenroad._arrays import Floats
from evenroad.collision.arm_world import ArmWorld
from evenroad.geometry.pose import Pose
from evenroad.poses.chain import chain_of
from evenroad.poses.pose_task import PoseTask

_BESIDE = np.array([[0.0], [0.1], [-0.1]])
"""Moves of all joints to the postures from which a pose is tried: a stretched arm bends from beside its own."""
_REACHED = 1e-6
"""Squared error up to which a pose is reached [m, rad]."""
_FARTHEST = 0.3
"""Largest move of a joint towards a pose out of reach, to which the arm would swing [rad or m]."""


def follow(world: ArmWorld, q: Floats, link: str, pose: Pose) -> Floats:
    """Return the configuration near `q`, (dim,), that moves a link to a pose, or towards it, within limits."""
    found, errors = chain_of(world.robot, link).reached(q + _BESIDE, PoseTask(pose).row)
    best = 0 if errors[0] < _REACHED else int(np.argmin(errors))
    move = found[best] - q
    if errors[best] > _REACHED:
        move *= _FARTHEST / max(float(np.abs(move).max()), _FARTHEST)
    low, high, _ = world.bounds
    moved: Floats = np.clip(q + move, low, high)
    return moved
