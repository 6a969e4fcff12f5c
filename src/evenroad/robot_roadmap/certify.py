"""What a robot's roadmap guarantees in every scene, and what clearance among obstacles that takes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from evenroad.points.measures import dispersion_bounds
from evenroad.roadmap.certificate import SAFE, Certificate
from evenroad.robot import ArmWorld
from evenroad.robot.arm_world import RECHECK_TOLERANCE
from evenroad.robot_roadmap.robot_roadmap import RobotRoadmap
from evenroad.robot_roadmap.turns import TURN, lifted_motions_free, shifts

BATCH = 4096
"""Motions proved at once."""


class RobotCertificate(NamedTuple):
    """A certificate in the metric of a robot's roadmap, and what a clearance in space is there.

    Places of the robot that keep `c` metres away from what they are tested against stay free while the joints move
    by less than ``(c - allowance) * per_metre``.
    """

    certificate: Certificate
    per_metre: float
    allowance: float

    def in_joints(self, clearance: float) -> float:
        """Return what a clearance among obstacles, and of the robot's own bodies from each other, is in joints."""
        return max(clearance - self.allowance, 0.0) * self.per_metre

    def in_metres(self, clearance: float) -> float:
        """Return the clearance [m] that one in joints takes."""
        return clearance / self.per_metre + self.allowance


def certify_robot_roadmap(roadmap: RobotRoadmap) -> RobotCertificate:
    """Return what a robot's roadmap guarantees for paths in any scene of its cell.

    Of the shortest paths in its metric, with ends linked to all milestones.  So whether there is a path is what
    ``SceneRoadmap.connect(..., links=n, greed=1.0)`` finds; ``plan`` goes greedily, by fewer links, and on with trees.
    The dispersion is that over all of the joints' ranges, also where the robot is never free: a bound all the same.
    """
    one, weights, q = roadmap.one_turn, roadmap.weights, roadmap.milestones
    unit = np.clip((q - one.low) / (one.high - one.low), 0.0, np.nextafter(1.0, 0.0))
    bounds = dispersion_bounds(unit, sides=weights * (one.high - one.low), wrapping=one.wraps)
    turn = 0.5 * SAFE * TURN * float(weights[one.wraps].min(initial=np.inf))
    certificate = Certificate(bounds.upper, bounds.lower, min(_nearest_left_out(roadmap), turn), turn, True)
    return RobotCertificate(certificate, joints_per_metre(roadmap.world, weights), _allowance(roadmap.world))


def joints_per_metre(world: ArmWorld, weights: object) -> float:
    """Return how far joints may move, in the metric of such weights, (dim,), until some body has moved by a metre.

    A joint's turn by dq moves a body by at most its arm times dq, and two bodies against each other by that of the
    joints between them; the arms are bounds for all configurations.  So a move by dz in ``z = w q`` moves it by at most
    ``|arms / w| |dz|``, by Cauchy and Schwarz.
    """
    tables = world.robot_tables
    arms = np.concatenate([tables.speeds, tables.pair_speeds])
    return 1.0 / float(np.linalg.norm(arms / np.asarray(weights, dtype=np.float64), axis=1).max())


def _allowance(world: ArmWorld) -> float:
    """Return by how much the model may be larger than the robot, and how near to contact nothing is proved [m]."""
    return world.excess + 10.0 * RECHECK_TOLERANCE


def _nearest_left_out(roadmap: RobotRoadmap) -> float:
    """Return a length that is less than that of every motion between milestones that is proved free but no edge."""
    q, n, one = roadmap.milestones, len(roadmap.milestones), roadmap.one_turn
    first, second = np.triu_indices(n, k=1)
    # Of two motions between the same milestones the short one counts.
    a, b = roadmap.edges.T.astype(np.int64)
    short = (roadmap.turns == shifts(one, q[a], q[b])).all(axis=1)
    tried = np.isin(first * n + second, (a * n + b)[short])
    first, second = first[~tried], second[~tried]
    turns = shifts(one, q[first], q[second])
    length = np.linalg.norm(roadmap.weights * (q[second] + TURN * turns - q[first]), axis=1)
    order = np.argsort(length, kind="stable")
    for begin in range(0, len(order), BATCH):
        some = order[begin : begin + BATCH]
        free = lifted_motions_free(roadmap.world, one, q[first[some]], q[second[some]], turns[some])
        if free.any():
            return SAFE * float(length[some][free][0])
    return np.inf
