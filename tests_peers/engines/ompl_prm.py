"""OMPL's PRM on presampled points, as the peer of ours: same points, same rule, same motion states.

OMPL inserts start and goal first and joins every new milestone to its 10 nearest earlier ones: our ``KEarlier(10)``.
Its motions are checked at n = ceil(distance / resolution) states.  The state checker is a Python function, as in every
program that uses OMPL from Python.  Needs the extra ``[peers]``.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

import numpy as np
from ompl import base as ob
from ompl import geometric as og
from ompl import util as ou

ou.setLogLevel(ou.LogLevel.LOG_NONE)

Checker = Callable[[Sequence[float]], bool]


class _Presampled(ob.ValidStateSampler):
    """Hands out given points in order, and says of each whether it is valid."""

    def __init__(
        self, si: ob.SpaceInformation, points: list[list[float]], valid: Callable[[object], bool]
    ) -> None:
        super().__init__(si)
        self.points, self.next, self.valid = points, 0, valid

    def sample(self, state) -> bool:  # type: ignore[no-untyped-def]
        if self.next >= len(self.points):
            return False
        state[0 : len(self.points[0])] = self.points[self.next]
        self.next += 1
        return self.valid(state)

    def sampleNear(self, state, near, distance) -> bool:  # type: ignore[no-untyped-def]
        return False


def ompl_prm(
    valid: Checker, points: np.ndarray, start: np.ndarray, goal: np.ndarray, resolution_share: float
) -> tuple[bool, int, float]:
    """Grow OMPL's PRM over start, goal and the points of the unit cube.

    Parameters
    ----------
    valid : callable
        Takes the coordinates of one state.
    points : ndarray, shape (n, d)
        In the unit cube, which is the space.
    start, goal : ndarray, shape (d,)
    resolution_share : float
        Motion resolution as a share of the cube's diagonal.

    Returns
    -------
    joined : bool
        Whether start and goal are in one piece.
    checked : int
        States that the checker was asked for.
    seconds : float
        Wall time of growing the roadmap.
    """
    d = points.shape[1]
    asked = 0

    def state_valid(state: object) -> bool:
        nonlocal asked
        asked += 1
        return valid([state[i] for i in range(d)])  # type: ignore[index]

    space = ob.RealVectorStateSpace(d)
    bounds = ob.RealVectorBounds(d)
    bounds.setLow(0.0)
    bounds.setHigh(1.0)
    space.setBounds(bounds)
    si = ob.SpaceInformation(space)
    si.setStateValidityChecker(state_valid)
    si.setStateValidityCheckingResolution(resolution_share)
    every = np.vstack([start, goal, points]).tolist()
    samplers: list[_Presampled] = []

    def allocate(information: ob.SpaceInformation) -> _Presampled:
        samplers.append(_Presampled(information, every, state_valid))
        return samplers[-1]

    si.setValidStateSamplerAllocator(allocate)
    si.setup()
    problem = ob.ProblemDefinition(si)
    ends = [space.allocState(), space.allocState()]
    for state, values in zip(ends, (start, goal), strict=True):
        state[0:d] = list(values)
    problem.setStartAndGoalStates(*ends)
    planner = og.PRM(si)
    planner.setProblemDefinition(problem)
    planner.setup()
    done = ob.PlannerTerminationCondition(lambda: bool(samplers) and samplers[-1].next >= len(every))
    began = time.perf_counter()
    planner.growRoadmapPtc(done)
    seconds = time.perf_counter() - began
    data = ob.PlannerData(si)
    planner.getPlannerData(data)
    return _joined(data, start, goal), asked, seconds


def _joined(data: ob.PlannerData, start: np.ndarray, goal: np.ndarray) -> bool:
    """Say whether start and goal are in one piece; OMPL's data leave isolated vertices out."""
    d = len(start)
    count = data.numVertices()
    places = [tuple(data.getVertex(v).getState()[i] for i in range(d)) for v in range(count)]
    if tuple(start) not in places or tuple(goal) not in places:
        return False
    target, seen = places.index(tuple(goal)), {places.index(tuple(start))}
    stack = list(seen)
    while stack:
        here = stack.pop()
        for there in range(count):
            if there not in seen and (data.edgeExists(here, there) or data.edgeExists(there, here)):
                seen.add(there)
                stack.append(there)
    return target in seen
