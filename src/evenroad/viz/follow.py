"""An arm that follows a handle: the configuration near another that moves a link to a pose."""

from __future__ import annotations

import numpy as np

from evenroad._arrays import Floats
from evenroad.collision.arm_world import ArmWorld
from evenroad.geometry.pose import Pose
from evenroad.robots.kinematics import link_poses

_SOFTENED, _ROUNDS, _NEAR = 0.05, 12, 1e-3
"""Damping and number of steps, and the error that ends them [m, rad]."""


def follow(world: ArmWorld, q: Floats, link: str, pose: Pose) -> Floats:
    """Return the configuration near `q`, (dim,), that moves a link nearest to a pose, by damped least squares."""
    robot, number = world.robot, world.robot.links.index(link)
    low, high, _ = world.bounds
    position, target = np.array(pose.xyz), pose.rotation_matrix
    for _ in range(_ROUNDS):
        nearby = np.vstack([q, q + 1e-5 * np.eye(len(q))])
        poses = link_poses(robot, nearby)[:, number]
        turned = poses[:, :3, :3] @ poses[0, :3, :3].T
        moves = np.column_stack([poses[:, :3, 3] - poses[0, :3, 3], _turn(turned)])[1:].T / 1e-5
        error = np.append(position - poses[0, :3, 3], _turn((target @ poses[0, :3, :3].T)[np.newaxis])[0])
        if np.linalg.norm(error) < _NEAR:
            break
        damped = moves @ moves.T + _SOFTENED**2 * np.eye(6)
        step = moves.T @ np.linalg.solve(damped, error)
        q = np.clip(q + step * min(1.0, 0.3 / max(float(np.max(np.abs(step))), 1e-9)), low, high)
    return q


def _turn(rotations: Floats) -> Floats:
    """Return rotation vectors, (n, 3) [rad], of matrices, (n, 3, 3)."""
    from scipy.spatial.transform import Rotation

    vectors: Floats = Rotation.from_matrix(rotations).as_rotvec()
    return vectors
