"""OMPL's planners on our worlds and points, and our planners on OMPL's spaces and checkers; extra ``ompl``.

OMPL's metric of several parts is always a weighted sum, and its real vectors have no weights: neighbours may differ
from ours, results of checks and motions do not.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
import numpy.typing as npt
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

from evenroad._arrays import Bools, Floats, set_fields
from evenroad._checks import as_batch, require_extra, require_positive
from evenroad.adapters._ompl_spaces import ompl_space as ompl_space
from evenroad.adapters._ompl_spaces import space_of as space_of
from evenroad.adapters._ompl_states import Ompl, StateFormat, format_of
from evenroad.errors import InvalidValue
from evenroad.points import PointSet
from evenroad.space import Space
from evenroad.space.batch import as_batch_pair
from evenroad.space.path import continued
from evenroad.space.protocol import wrapped
from evenroad.world import World

ob = require_extra("ompl.base", "ompl", "evenroad.adapters.ompl")
og = require_extra("ompl.geometric", "ompl", "evenroad.adapters.ompl")


def space_information(world: World) -> Ompl:
    """Return OMPL's SpaceInformation of our world, set up: the world checks its states and motions.

    Motions are free as its `motion_valid` says: on maps exactly, of an arm at states close together.  Those of
    ``CertifiedWorld(world)`` are proved, without gaps.  OMPL checks one state at a time; :func:`plan_on_points` and
    :func:`give_points` check points in one batch.
    """
    return _Information(world)


def give_points(information: Ompl, points: PointSet | npt.ArrayLike) -> GivenStates:
    """Make OMPL's PRM, PRM* and other planners that sample valid states take ours in order, and return the sampler.

    Parameters
    ----------
    information : ompl.base.SpaceInformation
        That of :func:`space_information`, or another with a space that :func:`space_of` knows.
    points : PointSet, or array_like, shape (n, dim)
        Points of the cube, or configurations; those that are not free are left out.

    Notes
    -----
    After the last point ``used_up`` is True.  ``planner.solve(seconds)`` goes on until its time is over, and PRM adds
    configurations of its own; :func:`plan_on_points` grows a PRM of the points alone.
    """
    world = information.world if isinstance(information, _Information) else OmplWorld(information)
    if isinstance(points, PointSet):
        configurations = world.space.from_cube(points.points)
    else:
        configurations = as_batch("points", points, world.space.dim)
    sampler = GivenStates(information, configurations[world.valid(configurations)])
    information.setValidStateSamplerAllocator(lambda _: sampler)
    # OMPL requires another setup.
    information.setup()
    return sampler


def solve(planner: Ompl, start: npt.ArrayLike, goals: npt.ArrayLike, seconds: float = 10.0) -> Floats | None:
    """Return the path, (p, dim), of a planner of OMPL from the start, (dim,), to a goal, (dim,) or (g, dim); or None.

    Parameters
    ----------
    planner : ompl.base.Planner
        Such as ``ompl.geometric.RRTConnect(space_information(world))``, with its settings.
    start, goals : array_like
        Configurations.
    seconds : float
        Time limit of OMPL, > 0.
    """
    seconds = require_positive("seconds", seconds)
    information = planner.getSpaceInformation()
    write = format_of(information.getStateSpace()).write
    dim = space_of(information.getStateSpace()).dim
    problem = ob.ProblemDefinition(information)
    [first, *last] = [information.allocState() for _ in range(1 + len(_as_goals(goals, dim)))]
    targets = ob.GoalStates(information)
    write(first, as_batch("start", np.reshape(start, (1, -1)), dim)[0].tolist())
    for state, goal in zip(last, _as_goals(goals, dim).tolist(), strict=True):
        write(state, goal)
        targets.addState(state)
    problem.addStartState(first)
    problem.setGoal(targets)
    planner.setProblemDefinition(problem)
    planner.setup()
    planner.solve(seconds)
    if not problem.hasExactSolution():
        return None
    path = path_of(information, problem.getSolutionPath())
    return continued(path, space_of(information.getStateSpace()), as_batch("start", np.reshape(start, (1, -1)), dim)[0])


def plan_on_points(
    information: Ompl,
    start: npt.ArrayLike,
    goals: npt.ArrayLike,
    points: PointSet | npt.ArrayLike,
    planner: Ompl = None,
) -> Floats | None:
    """Grow OMPL's PRM on start, goals and the points alone, and return its shortest path, (p, dim), or None.

    OMPL joins each milestone to those before it, so start and goals, which come first, are neighbours of many.

    Parameters
    ----------
    information, points
        As :func:`give_points`.
    start, goals
        As :func:`solve`.
    planner : ompl.geometric.PRM or PRMstar, optional
        New, of `information`; default ``PRM(information)`` with 10 neighbours.
    """
    space = space_of(information.getStateSpace())
    own = information.world.space if isinstance(information, _Information) else space
    terminals = np.vstack([np.reshape(start, (1, -1)), _as_goals(goals, space.dim)])
    rest = own.from_cube(points.points) if isinstance(points, PointSet) else points
    sampler = give_points(information, np.vstack([terminals, as_batch("points", rest, space.dim)]))
    planner = og.PRM(information) if planner is None else planner
    # OMPL's PRM needs a problem for its setup, and does not use it while it grows.
    planner.setProblemDefinition(ob.ProblemDefinition(information))
    planner.setup()
    planner.growRoadmapPtc(ob.PlannerTerminationCondition(lambda: sampler.used_up))
    data = ob.PlannerData(information)
    planner.getPlannerData(data)
    return _shortest(space, data, format_of(information.getStateSpace()), terminals)


def ompl_path(information: Ompl, path: npt.ArrayLike) -> Ompl:
    """Return waypoints, (p, dim), as an ``ompl.geometric.PathGeometric``."""
    space = information.getStateSpace()
    write = format_of(space).write
    result = og.PathGeometric(information)
    for row in as_batch("path", path, space_of(space).dim).tolist():
        state = information.allocState()
        write(state, row)
        result.append(state)
    return result


def path_of(information: Ompl, path: Ompl) -> Floats:
    """Return the waypoints, (p, dim), of an ``ompl.geometric.PathGeometric``; SE(3) as x, y, z, qw, qx, qy, qz."""
    read = format_of(information.getStateSpace()).read
    return np.array([read(state) for state in path.getStates()])


@dataclass(frozen=True, eq=False)
class OmplWorld:
    """The world of an OMPL SpaceInformation, for our planners; its space is that of :func:`space_of`.

    A motion is free if OMPL's motion validator says so and both endpoints are free.  OMPL's default validator checks
    states, ``setStateValidityCheckingResolution`` apart.
    """

    proof: ClassVar[str] = "resolution"
    """The proof of motions: nothing more is known of OMPL's validators."""

    information: Ompl
    space: Space = field(init=False)
    _format: StateFormat = field(init=False, repr=False)

    def __post_init__(self) -> None:
        if not self.information.isSetup():
            self.information.setup()
        space = self.information.getStateSpace()
        set_fields(self, space=space_of(space), _format=format_of(space))

    def valid(self, q: Floats) -> Bools:
        """Return which configurations, (n, dim), lie in the space and are free: (n,)."""
        batch = wrapped(self.space, as_batch("q", q, self.space.dim))
        free, state = self.space.contains(batch), self.information.allocState()
        for i in np.flatnonzero(free):
            self._format.write(state, batch[i].tolist())
            free[i] = self.information.isValid(state)
        return free

    def motion_valid(self, a: Floats, b: Floats) -> Bools:
        """Return which motions, two (m, dim) arrays, are free: (m,)."""
        first, second = (wrapped(self.space, each) for each in as_batch_pair(a, b, self.space.dim))
        free = self.valid(first)
        free[free] = self.valid(second[free])
        one, other = self.information.allocState(), self.information.allocState()
        for i in np.flatnonzero(free):
            # States are rounded: in a fixed order a motion and its reverse have one result.
            low, high = sorted((first[i].tolist(), second[i].tolist()))
            self._format.write(one, low)
            self._format.write(other, high)
            free[i] = self.information.checkMotion(one, other)
        return free


class GivenStates(ob.ValidStateSampler):  # type: ignore[misc, name-defined, unused-ignore]
    """Returns free configurations, (n, dim), in order, until they are `used_up`."""

    def __init__(self, information: Ompl, configurations: Floats) -> None:
        super().__init__(information)
        self._configurations, self._next = configurations.tolist(), 0
        self._write = format_of(information.getStateSpace()).write

    @property
    def used_up(self) -> bool:
        """Whether all have been returned."""
        return self._next >= len(self._configurations)

    def sample(self, state: Ompl) -> bool:
        """Write the next one into an OMPL state, or return False."""
        if self.used_up:
            return False
        self._write(state, self._configurations[self._next])
        self._next += 1
        return True

    def sampleNear(self, state: Ompl, near: Ompl, distance: float) -> bool:
        """Return False: a set of points cannot be sampled near a state."""
        return False


class _Information(ob.SpaceInformation):  # type: ignore[misc, name-defined, unused-ignore]
    """A SpaceInformation with the world it was made of."""

    def __init__(self, world: World) -> None:
        space = ompl_space(world.space)
        read = format_of(space).read
        super().__init__(space)
        self.world = world
        self.setStateValidityChecker(lambda state: bool(world.valid(np.array([read(state)]))[0]))
        self.setMotionValidator(_Motions(self, world, read))
        self.setup()


class _Motions(ob.MotionValidator):  # type: ignore[misc, name-defined, unused-ignore]
    """Checks motions in a world."""

    def __init__(self, information: Ompl, world: World, read: Callable[[Ompl], list[float]]) -> None:
        super().__init__(information)
        self._world, self._read = world, read

    def checkMotion(self, a: Ompl, b: Ompl, *_: Ompl) -> bool:
        endpoints = np.array([self._read(a), self._read(b)])
        return bool(self._world.motion_valid(endpoints[:1], endpoints[1:])[0])


def _as_goals(goals: npt.ArrayLike, dim: int) -> Floats:
    """Return one goal or several as (g, dim)."""
    rows = np.atleast_2d(np.asarray(goals, dtype=np.float64))
    if len(rows) == 0:
        raise InvalidValue("goals must be one configuration or more, got none")
    return as_batch("goals", rows, dim)


def _shortest(space: Space, data: Ompl, states: StateFormat, terminals: Floats) -> Floats | None:
    """Return the shortest path over OMPL's roadmap from the start to a goal, the rows of `terminals`, or None."""
    configurations = [tuple(states.read(data.getVertex(v).getState())) for v in range(data.numVertices())]
    scratch = data.getSpaceInformation().allocState()
    numbers = []
    for row in terminals.tolist():
        states.write(scratch, row)
        configuration = tuple(states.read(scratch))
        numbers.append(configurations.index(configuration) if configuration in configurations else -1)
    if numbers[0] < 0 or max(numbers[1:]) < 0:
        return None
    edges = np.array([(v, w) for v in range(len(configurations)) for w in data.getEdges(v)]).reshape(-1, 2)
    where = np.array(configurations)
    # A length of 0 would be no edge to SciPy.
    lengths = np.maximum(space.distance(where[edges[:, 0]], where[edges[:, 1]]), 1e-300)
    graph = coo_matrix((lengths, edges.T), shape=(len(configurations),) * 2).tocsr()
    cost, before = dijkstra(graph, directed=False, indices=numbers[0], return_predecessors=True)
    goal = min((number for number in numbers[1:] if number >= 0), key=lambda number: cost[number])
    if not math.isfinite(cost[goal]):
        return None
    route = [goal]
    while route[-1] != numbers[0]:
        route.append(int(before[route[-1]]))
    return continued(where[route[::-1]], space, terminals[0])
