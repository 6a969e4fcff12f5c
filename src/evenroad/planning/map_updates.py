"""Paths of cars and disks on maps that change: what of a path is free, and the path that is kept or planned anew."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from time import perf_counter as now
from typing import TypeAlias

import numpy as np

from evenroad._arrays import Bools, Floats
from evenroad._rng import RngLike, variant_of
from evenroad.driving.car_space import CarSpace, as_pieces, cusps_of, rows_of
from evenroad.driving.car_world import CarWorld
from evenroad.driving.goal_region import GoalRegion
from evenroad.driving.polygon_map import PolygonMap
from evenroad.errors import InvalidValue, shown
from evenroad.planning.make_result import solution
from evenroad.planning.plan import plan
from evenroad.planning.problem import Problem
from evenroad.planning.read_problem import read_problem
from evenroad.planning.reading import Goal, Reading
from evenroad.planning.result import PlanResult
from evenroad.planning.sections import between, lengths_along
from evenroad.space.batch import as_batch
from evenroad.world.gridmap.disk_world import DiskWorld
from evenroad.world.gridmap.gridmap import GridMap

ChangedMap: TypeAlias = "GridMap | PolygonMap | Bools"
"""A new map: of the same size, where it is only cells."""

_AHEAD = (0.0, 0.5, 1.0, 2.0, 4.0)
"""How far along the path a car that is beside it may join it, in turning radii."""
_CLOSE = 0.1
"""Largest length by which what is reported free is too small [cells]."""
_ROUNDING = 1e-12
"""Share of a length that rounding may take away."""
_SAMPLES = 4000
"""Largest number of poses of a path among which the nearest to the robot is sought."""


@dataclass(frozen=True)
class Ahead:
    """What of the path that is driven is free on the current map.

    Attributes
    ----------
    free_until : float
        Length from the robot on that is proved free, at most a tenth of a cell too small, in map units.
    length : float
        Length of the rest of the path.
    """

    free_until: float
    length: float

    @property
    def is_free(self) -> bool:
        """Whether all of the rest is free."""
        return self.free_until >= self.length


class MapUpdates:
    """The path of a car or a disk to its goal: see :class:`evenroad.Replanner`."""

    world: CarWorld | DiskWorld

    def __init__(self, world: object, goal: Goal | GoalRegion | Sequence[Goal | GoalRegion], rng: RngLike) -> None:
        if not isinstance(world, CarWorld | DiskWorld) or (isinstance(world, CarWorld) and world.holonomic):
            raise InvalidValue(
                "world must be an ArmWorld, as er.ArmWorld(robot, scene), or that of a car or a disk on a map, as"
                f" er.load_map(file).world(radius=0.3), got {shown(world)}"
            )
        self.world = world
        self._goal, self._variant, self._failures = goal, variant_of(rng), 0
        # A goal that is none is refused now: start and goal are read, and nothing is planned.
        read_problem(world, world.space.from_cube(np.full((1, 3), 0.5)[:, : world.space.cube_dim])[0], goal, Reading())
        self._last: PlanResult | None = None
        self.path: Floats | None = None

    @property
    def goals(self) -> str:
        """The goal, in words."""
        return shown(self._goal)

    def ahead(self, q: object, changed: object) -> Ahead:
        """Return what of the path of the last update is free from a configuration, (dim,), on."""
        self._take(changed)
        if self._last is None:
            raise InvalidValue("there is no path yet: the first update plans one")
        return self._rest(self._last, _row(q, self.world.dim))[1]

    def update(self, q: object, changed: object) -> PlanResult:
        """Return the rest of the last path where it is free, else a new one."""
        result = self._updated(q, changed)
        self.path = result.path
        return result

    def _updated(self, q: object, changed: object) -> PlanResult:
        began = now()
        self._take(changed)
        start = _row(q, self.world.dim)
        if self._last is not None:
            rest, found = self._rest(self._last, start)
            if found.is_free:
                self._last = self._kept(self._last, start, rest, began)
                return self._last
        result = plan(self.world, start, self._goal, rng=self._variant + self._failures)
        self._failures = 0 if result.solved else self._failures + 1
        self._last = result if result.solved else self._last
        return result

    def _take(self, changed: object) -> None:
        if changed is None:
            return
        if isinstance(changed, PolygonMap) and isinstance(self.world, CarWorld) and self.world.polygons is not None:
            self.world = replace(self.world, grid=changed.grid, polygons=changed)
        elif isinstance(changed, GridMap):
            if changed.frame != self.world.grid.frame:
                raise InvalidValue("a new map must have the frame of the first: its size, origin and resolution")
            self.world = replace(self.world, grid=changed)
        elif isinstance(changed, np.ndarray | list | tuple):
            self.world = self.world.with_cells(np.asarray(changed))
        else:
            raise InvalidValue(f"the scene of a map must be its occupied cells, or a new map, got {shown(changed)}")

    def _rest(self, last: PlanResult, start: Floats) -> tuple[Floats, Ahead]:
        """Return the rest of a path from here, waypoints of a disk or rows of a car, and what of it is free."""
        world = self.world
        if isinstance(world, DiskWorld):
            assert last.path is not None, "it was solved"
            rest = _disk_rest(last.path, start)
            return rest, _disk_ahead(world, rest)
        best: tuple[Floats, Ahead] | None = None
        for rows in _car_rests(last, world, start):
            length, close = float(np.abs(rows[:, 1]).sum()), _CLOSE * world.grid.resolution
            free = world.vehicle.free_length(_space_of(world).steering, start, rows, close)
            found = rows, Ahead(length if free >= length * (1.0 - _ROUNDING) else free, length)
            if found[1].is_free:
                return found
            if best is None or free > best[1].free_until:
                best = found
        assert best is not None, "a path has a rest"
        return best

    def _kept(self, last: PlanResult, start: Floats, rest: Floats, began: float) -> PlanResult:
        """Return the result with the rest of the last path."""
        world = self.world
        problem = Problem(world, start, last.goal[np.newaxis].copy())
        timings = {"search": now() - began}
        if isinstance(world, DiskWorld):
            return solution(problem, rest, planner="kept", timings=timings)
        space = _space_of(world)
        path = space.steering.poses_along(start, rest, world.grid.resolution)
        turns = np.round((path[-1, 2] - last.goal[2]) / (2.0 * np.pi))
        path = np.vstack([start, path[1:-1], last.goal + np.array([0.0, 0.0, 2.0 * np.pi * turns])])
        length, pieces = float(np.abs(rest[:, 1]).sum()), as_pieces(rest, space)
        return solution(problem, path, cost=length, planner="kept", timings=timings, pieces=pieces)


def _space_of(world: CarWorld) -> CarSpace:
    assert isinstance(world.space, CarSpace), "holonomic robots are refused"
    return world.space


def _row(q: object, dim: int) -> Floats:
    try:
        row = np.asarray(q, dtype=np.float64).reshape(1, -1)
    except (TypeError, ValueError):
        raise InvalidValue(f"q must be {dim} finite numbers, got {shown(q)}") from None
    start: Floats = as_batch("q", row, dim)[0].copy()
    return start


def _disk_rest(path: Floats, start: Floats) -> Floats:
    """Return the rest of a path, (p, 2), from a point beside or on it."""
    along = np.diff(path, axis=0)
    squared = np.einsum("ij,ij->i", along, along)
    share = np.einsum("ij,ij->i", start - path[:-1], along) / np.where(squared > 0.0, squared, 1.0)
    away = np.linalg.norm(path[:-1] + np.clip(share, 0.0, 1.0)[:, np.newaxis] * along - start, axis=1)
    # Of equally near ones the last: a path may come by twice.
    nearest = len(away) - 1 - int(np.argmin(away[::-1]))
    return np.vstack([start, path[nearest + 1 :]])


def _disk_ahead(world: DiskWorld, rest: Floats) -> Ahead:
    lengths = np.linalg.norm(np.diff(rest, axis=0), axis=1)
    free = np.asarray(world.motion_valid(rest[:-1], rest[1:]))
    if free.all():
        return Ahead(float(lengths.sum()), float(lengths.sum()))
    first = int(np.argmin(free))
    a, b = rest[first], rest[first + 1]
    low, high, close = 0.0, 1.0, _CLOSE * world.grid.resolution
    while (high - low) * lengths[first] > close and high - low > 1e-12:
        shares = np.linspace(low, high, 17)[1:-1]
        ok = np.asarray(world.motion_valid(np.tile(a, (15, 1)), a + shares[:, np.newaxis] * (b - a)))
        count = int(np.argmin([*ok, False]))
        low, high = (shares[count - 1] if count else low), (shares[count] if count < 15 else high)
    return Ahead(float(lengths[:first].sum() + low * lengths[first]), float(lengths.sum()))


def _car_rests(last: PlanResult, world: CarWorld, start: Floats) -> list[Floats]:
    """Return the rest of a car's path from a pose, rows (side, signed length), the cheapest first.

    A car is seldom quite on its path: it joins it by a curve, some way ahead.
    """
    space = _space_of(world)
    assert last.pieces is not None, "a car's path has pieces"
    steering, rows = space.steering, rows_of(last.pieces, space)
    after = np.concatenate([[0.0], np.cumsum(np.abs(rows[:, 1]))])
    total, unit = float(after[-1]), space.turning_radius or space.spot
    at = _nearest_along(last.start, rows, space, start, max(world.grid.resolution, total / _SAMPLES))
    found = []
    for ahead in sorted({min(at + share * unit, total) for share in _AHEAD}):
        joined = last.goal
        if ahead < total:
            joined = steering.poses_along(last.start, between(rows, after, 0.0, ahead), 2.0 * total)[-1]
        found.append(np.vstack([rows_of(space.pieces(start, joined), space), between(rows, after, ahead, total)]))
    cost = [float(np.abs(each[:, 1]).sum()) + unit * cusps_of(as_pieces(each, space)) for each in found]
    return [found[i] for i in np.argsort(cost, kind="stable")]


def _nearest_along(first: Floats, rows: Floats, space: CarSpace, pose: Floats, step: float) -> float:
    """Return the length along pieces to the pose nearest to one, of poses a step apart."""
    poses = space.steering.poses_along(first, rows, step)
    lengths = lengths_along(rows, step)
    turned = np.abs((poses[:, 2] - pose[2] + np.pi) % (2.0 * np.pi) - np.pi)
    off = np.hypot(*(poses[:, :2] - pose[:2]).T) + space.spot * turned
    return float(lengths[len(off) - 1 - int(np.argmin(off[::-1]))])
