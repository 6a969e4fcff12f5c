"""OMPL's RRT-Connect with our checker, as the peer of the arms' planner; needs the extra ``[peers]``."""

from __future__ import annotations

import time

import numpy as np
import numpy.typing as npt
from ompl import base as ob
from ompl import geometric as og
from ompl import util as ou

from evenroad.robot.arm_world import ArmWorld

ou.setLogLevel(ou.LogLevel.LOG_NONE)

STEP = 1.5
"""Its range [rad]: the one that the compiled trees have for the UR5."""


class _Motions(ob.MotionValidator):
    """Motions as the world judges them."""

    def __init__(self, si: ob.SpaceInformation, world: ArmWorld) -> None:
        super().__init__(si)
        self.world = world

    def checkMotion(self, a, b, *rest) -> bool:  # type: ignore[no-untyped-def]
        dim = self.world.space.dim
        return bool(self.world.motion_valid(np.array([a[0:dim]]), np.array([b[0:dim]]))[0])


def rrt_connect(
    world: ArmWorld, start: npt.NDArray[np.float64], goal: npt.NDArray[np.float64], seconds: float = 10.0
) -> tuple[bool, float]:
    """Return whether OMPL joins the two, and how long it plans [s], without setting up."""
    dim = world.space.dim
    space = ob.RealVectorStateSpace(dim)
    bounds = ob.RealVectorBounds(dim)
    for k in range(dim):
        bounds.setLow(k, float(world.bounds[0, k]))
        bounds.setHigh(k, float(world.bounds[1, k]))
    space.setBounds(bounds)
    si = ob.SpaceInformation(space)
    si.setStateValidityChecker(lambda state: bool(world.valid(np.array([state[0:dim]]))[0]))
    motions = _Motions(si, world)
    si.setMotionValidator(motions)
    si.setup()
    problem = ob.ProblemDefinition(si)
    ends = [space.allocState(), space.allocState()]
    for state, values in zip(ends, (start, goal), strict=True):
        state[0:dim] = values.tolist()
    problem.setStartAndGoalStates(*ends)
    planner = og.RRTConnect(si)
    planner.setRange(STEP)
    planner.setProblemDefinition(problem)
    planner.setup()
    began = time.thread_time()
    planner.solve(float(seconds))
    return bool(problem.hasExactSolution()), time.thread_time() - began
