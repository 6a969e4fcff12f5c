"""Frames: what the joints of a certificate move, and where it is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from evenroad_verify.certificate import Certificate
from evenroad_verify.errors import Bools, Floats, Ints, Pose, demand
from evenroad_verify.robot import Joint, Robot
from evenroad_verify.shapes import rotation_about, times


@dataclass(frozen=True)
class Frames:
    """Frame 0 is the root's; each joint that a certificate moves has the next one, parents first.

    `place` says of each link its frame and its pose there.  ``origin[k]`` is the pose of frame k + 1 in its parent with
    its joint at 0; that joint has the value ``factor * q[column] + offset``.  ``carries[f, k]`` says whether joint k
    moves frame f.
    """

    place: dict[str, tuple[int, Pose]]
    parent: tuple[int, ...]
    joints: tuple[Joint, ...]
    origin: tuple[Pose, ...]
    column: Ints
    factor: Floats
    offset: Floats

    @property
    def slides(self) -> Bools:
        """Which joints slide, (joints,)."""
        return np.array([joint.kind == "prismatic" for joint in self.joints], bool)

    @property
    def carries(self) -> Bools:
        """Which joints move which frame, (frames, joints)."""
        table = np.zeros((len(self.joints) + 1, len(self.joints)), bool)
        for k, parent in enumerate(self.parent):
            table[k + 1] = table[parent]
            table[k + 1, k] = True
        return table

    def far(self, curves: Floats, tolerance: float = 0.0) -> tuple[Floats, Floats]:
        """Return how far frames are from their joints, (frames, joints), and from the root, (frames,), at most [m]."""
        values = self.factor * curves[:, :, self.column] + self.offset
        most = (np.abs(values).max((0, 1)) + np.abs(self.factor) * tolerance) * self.slides
        far, out = np.zeros((len(self.joints) + 1, len(self.joints))), np.zeros(len(self.joints) + 1)
        for k, parent in enumerate(self.parent):
            step = float(np.linalg.norm(self.origin[k][1])) + most[k]
            far[k + 1], out[k + 1] = far[parent] + step, out[parent] + step
            far[k + 1, k] = most[k]
        return far, out

    def at(self, q: Floats) -> tuple[Floats, Floats, Floats]:
        """Return rotations, (n, f, 3, 3), and origins, (n, f, 3), of all frames, and the axes of joints, (n, j, 3)."""
        rotation, origin = np.zeros((len(q), len(self.joints) + 1, 3, 3)), np.zeros((len(q), len(self.joints) + 1, 3))
        rotation[:, 0], axes = np.eye(3), np.zeros((len(q), len(self.joints), 3))
        value = self.factor * q[:, self.column] + self.offset
        for k, (joint, parent) in enumerate(zip(self.joints, self.parent, strict=True)):
            turn, shift = self.origin[k]
            before = rotation[:, parent] @ turn
            axes[:, k] = before @ joint.axis
            origin[:, k + 1] = origin[:, parent] + rotation[:, parent] @ shift
            if joint.kind == "prismatic":
                rotation[:, k + 1] = before
                origin[:, k + 1] += axes[:, k] * value[:, k, None]
            else:
                rotation[:, k + 1] = before @ rotation_about(joint.axis, value[:, k])
        return rotation, origin, axes


def frames_of(robot: Robot, certificate: Certificate) -> Frames:
    """Return the frames of a robot that the joints of a certificate move; other joints stay where it holds them."""
    names = {joint.name: joint for joint in robot.joints}
    alone = {name for name, joint in names.items() if joint.kind != "fixed" and joint.leader == name}
    demand(certificate.held.keys() <= alone - set(certificate.joints), "a joint that is held is none that can be")
    place: dict[str, tuple[int, Pose]] = {robot.links[0]: (0, (np.eye(3), np.zeros(3)))}
    moved: list[tuple[int, Joint, Pose, int, float, float]] = []
    found = set[str]()
    for joint in robot.joints:
        frame, at = place[joint.parent]
        at = times(at, joint.origin)
        leader, factor, offset = _leader(joint, names)
        if joint.kind != "fixed" and leader in certificate.joints:
            found |= {leader} if leader == joint.name else set()
            moved.append((frame, joint, at, certificate.joints.index(leader), factor, offset))
            place[joint.child] = len(moved), (np.eye(3), np.zeros(3))
            continue
        if joint.kind != "fixed":
            value = factor * certificate.held.get(leader, 0.0) + offset
            still = (np.eye(3), value * joint.axis)
            if joint.kind != "prismatic":
                still = rotation_about(joint.axis, np.array([value]))[0], np.zeros(3)
            at = times(at, still)
        place[joint.child] = frame, at
    demand(found == set(certificate.joints), "a joint of the certificate is none that the robot moves")
    parent, joints, origin, column, factors, offsets = zip(*moved, strict=True)
    return Frames(place, parent, joints, origin, np.array(column), np.array(factors), np.array(offsets))


def _leader(joint: Joint, names: dict[str, Joint]) -> tuple[str, float, float]:
    """Return the joint that another one follows in the end, and by which factor and offset."""
    name, factor, offset = joint.leader, joint.factor, joint.offset
    passed = {joint.name}
    while name not in passed and name in names and names[name].leader != name:
        passed.add(name)
        offset += factor * names[name].offset
        factor *= names[name].factor
        name = names[name].leader
    demand(
        name in names and (name not in passed or name == joint.name == joint.leader),
        f"the mimic {joint.name} follows no joint",
    )
    return name, factor, offset
