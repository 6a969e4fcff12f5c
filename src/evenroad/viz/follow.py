"""An arm that follows a handle: the configuration near another that moves a link to a pose."""

from __future__ import annotations

import numpy as np

from evenroad._arrays import Floats
from evenroad.collision.arm_world import ArmWorld
from evenroad.geometry.pose import Pose
from evenroad.poses.chain import chain_of
from evenroad.poses.pose_task import PoseTask

_FARTHEST = 0.3
"""Largest move of a joint at a time [rad or m]: towards poses out of reach an arm would swing."""


def follow(world: ArmWorld, q: Floats, link: str, pose: Pose) -> Floats:
    """Return the configuration near `q`, (dim,), that moves a link to a pose, or towards it, within limits."""
    (there,), _ = chain_of(world.robot, link).reached(q[np.newaxis], PoseTask(pose).row)
    low, high, _ = world.bounds
    most = float(np.abs(there - q).max())
    return np.clip(q + min(1.0, _FARTHEST / max(most, _FARTHEST)) * (there - q), low, high)
