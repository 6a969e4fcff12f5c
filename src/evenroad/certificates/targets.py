"""Poses of a link that are goals, and in which cells of joints no posture reaches them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from evenroad._arrays import Floats, Ints
from evenroad.certificates.claim import Tree
from evenroad.errors import NotAvailable
from evenroad.poses.inverse_kinematics import task_of
from evenroad.poses.pose_goal import PoseGoal
from evenroad.robots.robot import Robot

BEYOND, UNSURE, WITHIN = -1, 0, 1
"""No posture of a cell reaches a pose; nothing is known; the middle is neither too far away nor too near."""
NEAR = 1e-3
"""By how much a posture may miss its pose and still reach it [m, rad]."""
_SPARE = 1e-7


@dataclass(frozen=True)
class Target:
    """A link that is to come to a pose.

    `line` says so in a certificate.  The joints `known`, numbers of the tree's, are those of the chain that a cell
    says.  They bring `local`, a point of the last one's frame, to where the next joint is.  From there the link's joint
    reaches `point` if it is no farther away than `most`, and no nearer than `least` [m].
    """

    line: str
    known: tuple[int, ...]
    local: Floats
    point: Floats
    least: float
    most: float


def target_of(robot: Robot, tree: Tree, goal: PoseGoal, columns: tuple[int, ...], slides: Floats) -> Target:
    """Return a pose as cells of some columns see it; `slides` are how far joints slide at most, 0 if they turn [m]."""
    chain, task = task_of(robot, goal)
    if chain.tip not in tree.placement:
        raise NotAvailable(f"no certificate speaks of a pose of {chain.tip}, which is held")
    frame, at = tree.placement[chain.tip]
    xyz, near = np.array(task.pose.xyz), NEAR + task.position_tolerance
    joints: list[int] = []
    while frame > 0:
        joints.insert(0, frame - 1)
        frame = tree.moved[frame - 1][0]
    first = next((i for i, k in enumerate(joints) if tree.moved[k][3] not in columns), len(joints))
    known, rest = joints[:first], joints[first:]
    bars = [float(np.linalg.norm(tree.moved[k][2].xyz)) for k in rest[1:]]
    shift, point = np.array(at.xyz), xyz
    words = " ".join(f"{value!r}" for value in xyz.tolist())
    if task.turns_fully:
        tilt, turn = NEAR + task.angle_tolerance, " ".join(f"{float(value)!r}" for value in task.pose.xyzw)
        line = f"pose {near!r} {tilt!r} {words} {turn} {chain.tip}"
        point = xyz - task.pose.rotation_matrix @ at.rotation_matrix.T @ shift
        near, shift = near + tilt * float(np.linalg.norm(shift)), np.zeros(3)
    else:
        line = f"position {near!r} {words} {chain.tip}"
        bars.append(float(np.linalg.norm(shift)))
    most = sum(bars) + float(slides[rest].sum())
    least = max([0.0, *(2.0 * bar - most for bar in bars)])
    if not rest:
        return Target(line, tuple(known), shift, point, -near, near)
    return Target(line, tuple(known), np.array(tree.moved[rest[0]][2].xyz), point, least - near, most + near)


def status_of(target: Target, tree: Tree, frames: Floats, half: Floats) -> Ints:
    """Return whether a target is beyond cells of half sides, (n, columns), with frames, (n, f, 4, 4), in the middle."""
    at = frames[:, target.known[-1] + 1 if target.known else 0]
    points = at[:, :3, :3] @ target.local + at[:, :3, 3]
    moved = np.zeros(len(frames))
    for k in reversed(target.known):
        moved += tree.moves_by(k, frames[:, k + 1], half[:, tree.moved[k][3]], points, moved)
    away = np.linalg.norm(points - target.point, axis=1)
    beyond = (away - moved > target.most + _SPARE) | (away + moved < target.least - _SPARE)
    within = (away <= target.most) & (away >= target.least)
    return np.where(beyond, BEYOND, np.where(within, WITHIN, UNSURE)).astype(np.int64)
