"""Inverse kinematics in closed form, of six revolute joints, by EAIK (extra ``[ik]``) where it is installed."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np

from evenroad._arrays import Floats
from evenroad.geometry.pose import Pose
from evenroad.poses.chain import Chain


@lru_cache(32)
def closed_form(chain: Chain) -> Callable[[Pose], Floats] | None:
    """Return a function of the tip's pose: all configurations that EAIK finds, (n, dim), in any turn, unchecked.

    None if EAIK is not installed or does not solve such joints.
    """
    coordinates = chain.coordinates
    if len(chain.frames) != 6 or len(set(coordinates.tolist())) != 6 or chain.slides.any():
        return None
    try:
        # Only the binding: EAIK's own reader of URDFs takes seconds to import.
        from eaik.pybindings import EAIK
    except ImportError:
        return None
    axes, origins = np.empty((3, 6)), np.empty((3, 8))
    rotation, origins[:, 0] = np.eye(3), 0.0
    for i, row in enumerate(chain.rows):
        origins[:, i + 1] = origins[:, i] + rotation @ row[9:12]
        rotation = rotation @ row[:9].reshape(3, 3)
        if i < 6:
            axes[:, i] = rotation[:, 2]
    robot = EAIK.Robot(axes, np.diff(origins, axis=1), rotation, [], True)
    if not robot.has_known_decomposition():
        return None

    def configurations(pose: Pose) -> Floats:
        angles = np.array(robot.calculate_IK(pose.matrix).Q, dtype=np.float64).reshape(-1, 6)
        q = np.zeros((len(angles), len(chain.group)))
        q[:, coordinates] = (angles - chain.rows[:6, 13]) / chain.rows[:6, 12]
        return q[np.isfinite(q).all(axis=1)]

    return configurations
