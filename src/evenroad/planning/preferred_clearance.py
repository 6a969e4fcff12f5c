"""Paths of disks and cars that keep away from obstacles where there is room for it.

A path is planned as usual first.  Then sections of it are planned again for a robot that is larger by the clearance
that is preferred, from the first to the last sample on them where that robot is free.  Where it cannot get through, the
narrowest part stays, and what lies before and behind is planned again.  Narrow parts are tried with less clearance.
A section is taken if it costs less: a length at an obstacle counts three times one with all of the clearance.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from evenroad._arrays import Floats
from evenroad._time_limit import BudgetSpent
from evenroad.driving.car_space import CarSpace, as_pieces, rows_of
from evenroad.driving.car_world import CarWorld
from evenroad.errors import InvalidValue, shown
from evenroad.planning.planners.car import sampled
from evenroad.planning.problem import Problem
from evenroad.planning.result import PlanResult
from evenroad.planning.sections import CarSections, DiskSections, Section
from evenroad.space.path import path_length
from evenroad.world.gridmap.disk_world import DiskWorld

AT_OBSTACLE = 2.0
"""How much more a length counts that is driven at an obstacle: there 1 m costs 3 m."""
LEVELS = 1.0, 0.5, 0.25
"""Shares of the clearance that are tried one after the other."""
_MOST_PLANS = 24
"""Largest number of sections that are planned again."""


def require_preferring(problem: Problem) -> None:
    """Refuse a clearance that is preferred by another robot than a disk or a car."""
    world = problem.world
    if not isinstance(world, CarWorld | DiskWorld) or (isinstance(world, CarWorld) and world.holonomic):
        raise InvalidValue(f"prefer_clearance is of disks and cars on maps, not in {shown(world)}")


def with_preferred_clearance(problem: Problem, found: PlanResult) -> PlanResult:
    """Return the result with a path that keeps the clearance that the problem prefers, where that is worth it."""
    world, prefer = problem.world, problem.prefer_clearance
    assert found.path is not None, "only of a path"
    if isinstance(world, DiskWorld):
        path = _Search(DiskSections(world), prefer).roomier(Section(found.path[0], found.path), LEVELS).parts
        if not np.asarray(world.motion_valid(path[:-1], path[1:])).all():
            return found
        return _with_path(found, prefer, path, path_length(path, world.space))
    assert isinstance(world, CarWorld), "required before"
    space = world.space
    assert isinstance(space, CarSpace), "required before"
    assert found.pieces is not None, "a car's path has pieces"
    first = Section(problem.start, rows_of(found.pieces, space))
    rows = _Search(CarSections(world, space), prefer).roomier(first, LEVELS).parts
    # What is handed out is proved as it is driven.
    if not world.vehicle.pieces_free(space.steering, problem.start, rows):
        return found
    path = sampled(problem, space, rows, found.goal_index or 0, world.grid.resolution)
    return _with_path(found, prefer, path, float(np.abs(rows[:, 1]).sum()), as_pieces(rows, space))


def _with_path(
    found: PlanResult, prefer: float, path: Floats, length: float, pieces: Floats | None = None
) -> PlanResult:
    path.setflags(write=False)
    message = f"{found.message}; then of length {length:.6g} with a clearance of {prefer:g} where there is room"
    return replace(found, path=path, pieces=pieces, cost=length, message=message)


class _Search:
    """A search for room along one path."""

    def __init__(self, robot: DiskSections | CarSections, prefer: float) -> None:
        self._robot, self._prefer, self._plans = robot, prefer, 0

    def roomier(self, section: Section, levels: Sequence[float]) -> Section:
        """Return a section between the same samples that costs no more."""
        if not levels or self._plans >= _MOST_PLANS or not len(section.parts):
            return section
        robot, clearance = self._robot, levels[0] * self._prefer
        samples, shares = robot.samples(section)
        (free,) = np.nonzero(robot.free_with(samples, clearance))
        if len(free) < 2:
            return self.roomier(section, levels[1:])
        begin, end = float(shares[free[0]]), float(shares[free[-1]])
        head, middle, tail = (robot.cut(section, *part) for part in ((0.0, begin), (begin, end), (end, 1.0)))
        head, tail = (self.roomier(part, levels[1:]) for part in (head, tail))
        return robot.joined([head, self._planned_again(middle, levels), tail])

    def _planned_again(self, section: Section, levels: Sequence[float]) -> Section:
        """Return a section whose first and last sample have the clearance of the level, planned with it."""
        robot, clearance = self._robot, levels[0] * self._prefer
        self._plans += 1
        try:
            found = robot.planned(section, clearance)
        except BudgetSpent:
            return section
        if found is not None:
            if robot.cost(found, self._prefer, AT_OBSTACLE) < robot.cost(section, self._prefer, AT_OBSTACLE):
                return found
            return self.roomier(section, levels[1:])
        narrow = self._narrowest(section, clearance)
        if narrow is None:
            return self.roomier(section, levels[1:])
        before = self.roomier(robot.cut(section, 0.0, narrow[0]), levels)
        through = self.roomier(robot.cut(section, *narrow), levels[1:])
        return robot.joined([before, through, self.roomier(robot.cut(section, narrow[1], 1.0), levels)])

    def _narrowest(self, section: Section, clearance: float) -> tuple[float, float] | None:
        """Return between which shares of its length a section has less than a clearance, where it has the least."""
        samples, shares = self._robot.samples(section)
        free = self._robot.free_with(samples, clearance)
        if free.all():
            return None
        least = int(np.argmin(np.where(free, np.inf, self._robot.distances(samples))))
        (known,) = np.nonzero(free)
        after = int(np.searchsorted(known, least))
        if after == 0 or after == len(known):
            return None
        return float(shares[known[after - 1]]), float(shares[known[after]])
