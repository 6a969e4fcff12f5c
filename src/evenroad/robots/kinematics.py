"""Forward kinematics in double precision: the poses of all links, for a batch of configurations."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats
from evenroad.errors import InvalidValue
from evenroad.geometry.shapes import Capsule
from evenroad.robots.joint import Joint


class Tree(Protocol):
    """Links, the root first, and joints, the i-th of which carries link i + 1."""

    @property
    def links(self) -> tuple[str, ...]: ...  # noqa: D102
    @property
    def joints(self) -> tuple[Joint, ...]: ...  # noqa: D102


class KinematicTree(Tree, Protocol):
    """The part of :class:`evenroad.robot.Robot` that kinematics needs."""

    @property
    def capsules(self) -> tuple[Capsule, ...]: ...  # noqa: D102
    @property
    def group(self) -> tuple[str, ...]: ...  # noqa: D102
    @property
    def held(self) -> Mapping[str, float]: ...  # noqa: D102


def joint_values(robot: KinematicTree, q: npt.ArrayLike) -> dict[str, Floats]:
    """Return the value of every movable joint, joint -> (n,), for configurations of the group, (n, dim).

    Joints outside of the group are held (see :class:`Robot`); mimics follow.  Raises InvalidValue if `q` is not of
    that shape.
    """
    batch = np.asarray(q, dtype=np.float64)
    if batch.ndim != 2 or batch.shape[1] != len(robot.group):
        raise InvalidValue(f"q must have the shape (n, {len(robot.group)}), got {batch.shape}")
    values = dict(zip(robot.group, batch.T, strict=True))
    values |= {name: np.full(len(batch), value) for name, value in held_values(robot).items()}
    return with_mimics(robot, values)


def with_mimics(robot: Tree, values: Mapping[str, Floats]) -> dict[str, Floats]:
    """Return values, joint -> (n,), of all movable joints from those of the joints that move by themselves."""
    all_values = dict(values)
    for joint in robot.joints:
        if joint.kind != "fixed" and joint.mimic is not None:
            all_values[joint.name] = joint.mimic.multiplier * values[joint.mimic.joint] + joint.mimic.offset
    return all_values


def held_values(robot: KinematicTree) -> dict[str, float]:
    """Return the values of independent joints outside the group, joint -> value [rad or m]."""
    return {
        joint.name: float(robot.held.get(joint.name, joint.neutral))
        for joint in robot.joints
        if joint.kind != "fixed" and joint.mimic is None and joint.name not in robot.group
    }


def tip_links(robot: KinematicTree) -> tuple[str, ...]:
    """Return the last link of each chain of the group, before it branches: one for each arm of a robot."""
    moved = {joint.child: joint for joint in robot.joints}
    children: dict[str, list[str]] = {link: [] for link in robot.links}
    for joint in robot.joints:
        children[joint.parent].append(joint.child)
    carrying = set()
    for joint in robot.joints:
        link = joint.parent
        while joint.name in robot.group and link in moved:
            carrying.add(moved[link].name)
            link = moved[link].parent
    tips = []
    for joint in robot.joints:
        if joint.name in robot.group and joint.name not in carrying:
            tip = joint.child
            while len(children[tip]) == 1:
                tip = children[tip][0]
            tips.append(tip)
    return tuple(tips)


def link_poses(robot: KinematicTree, q: npt.ArrayLike) -> Floats:
    """Return the frames of all links in that of the root: (n, links, 4, 4) for configurations (n, dim) [m].

    The links are in the order of ``robot.links``.  Raises as :func:`joint_values`.
    """
    return poses_at(robot, joint_values(robot, q), len(np.asarray(q)))


def poses_at(robot: Tree, values: Mapping[str, Floats], count: int) -> Floats:
    """Return the frames of all links, (count, links, 4, 4), for the values, (count,), of all movable joints."""
    poses = np.zeros((count, len(robot.links), 4, 4))
    poses[:, 0] = np.eye(4)
    number = {link: i for i, link in enumerate(robot.links)}
    for i, joint in enumerate(robot.joints):
        # One large product takes less time than many small ones.
        here = (poses[:, number[joint.parent]].reshape(-1, 4) @ joint.origin.matrix).reshape(count, 4, 4)
        if joint.kind != "fixed":
            here = here @ joint_motion(joint, values.get(joint.name, np.zeros(count)))
        poses[:, i + 1] = here
    return poses


def joint_motion(joint: Joint, value: Floats) -> Floats:
    """Return the transforms of a joint, (n, 4, 4), for its values, (n,) [rad or m].

    Rotations by Rodrigues' formula: ``R = I + sin(q) K + (1 - cos(q)) K^2``, K v = axis x v.
    """
    motion = np.tile(np.eye(4), (len(value), 1, 1))
    if joint.kind == "prismatic":
        motion[:, :3, 3] = value[:, np.newaxis] * np.array(joint.axis)
    elif joint.kind != "fixed":
        x, y, z = joint.axis
        cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        sine, versine = np.sin(value), 2.0 * np.sin(0.5 * value) ** 2
        motion[:, :3, :3] += sine[:, np.newaxis, np.newaxis] * cross
        motion[:, :3, :3] += versine[:, np.newaxis, np.newaxis] * (cross @ cross)
    return motion


def capsule_endpoints(robot: KinematicTree, q: npt.ArrayLike) -> Floats:
    """Return the endpoints of all capsules in the frame of the root: (n, capsules, 2, 3) [m]."""
    return endpoints_at(robot, link_poses(robot, q))


def endpoints_at(robot: KinematicTree, poses: Floats) -> Floats:
    """Return the endpoints of all capsules, (n, capsules, 2, 3), for these poses of the links."""
    link = [robot.links.index(capsule.link) for capsule in robot.capsules]
    endpoints = np.array([[capsule.a, capsule.b] for capsule in robot.capsules]).reshape(-1, 2, 3)
    frames = poses[:, link, np.newaxis]
    placed = endpoints[..., :1] * frames[..., :3, 0]
    placed += endpoints[..., 1:2] * frames[..., :3, 1]
    placed += endpoints[..., 2:] * frames[..., :3, 2]
    placed += frames[..., :3, 3]
    return placed
