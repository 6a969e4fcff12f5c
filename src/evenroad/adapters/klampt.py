"""Klamp't's robots for our planners, our worlds and points for Klamp't's, and motions both ways; extra ``klampt``.

A configuration in Klamp't has one number per link, ours one per planned joint.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Bools, Floats, set_fields
from evenroad._checks import as_batch, require_count, require_extra, require_known
from evenroad.errors import Exhausted, InvalidValue
from evenroad.points import PointSet
from evenroad.robots.kinematics import joint_values
from evenroad.robots.robot import Robot
from evenroad.space import JointSpace
from evenroad.space.path import continued
from evenroad.trajectory import Trajectory
from evenroad.world import World
from evenroad.world.function import FunctionWorld, TestedAtStates

klampt = require_extra("klampt", "klampt", "evenroad.adapters.klampt")
_collide = require_extra("klampt.model.collide", "klampt", "evenroad.adapters.klampt")
_cspace = require_extra("klampt.plan.cspace", "klampt", "evenroad.adapters.klampt")
_motions = require_extra("klampt.model.trajectory", "klampt", "evenroad.adapters.klampt")

Klampt: TypeAlias = Any
"""A value of Klamp't, which has no types."""


@dataclass(frozen=True, eq=False)
class KlamptWorld(TestedAtStates):
    """A robot in a world of Klamp't, with Klamp't's checks, for our planners.

    The robot is free if it touches neither itself, in the pairs of links that Klamp't tests, nor terrains, rigid
    objects and other robots.  Klamp't's bodies are surfaces: a body wholly inside another does not touch it.

    Parameters
    ----------
    model : klampt.WorldModel
        A world with the robot.  Checks move the robot, and put it back.
    robot : int or str
        Number or name of the robot.
    links : sequence of str, optional
        Links whose joints are planned for; default: all with a driver of their own.  The others do not move.
    resolution : float
        Largest distance between checked states of a motion [rad or m].

    Raises
    ------
    InvalidValue
        If a link has no range, or drivers couple joints and `links` is not given.
    UnknownName
        If there is no such robot or link.
    """

    model: Klampt
    robot: int | str = 0
    links: Sequence[str] | None = None
    resolution: float = 0.05
    space: JointSpace = field(init=False)
    _robot: Klampt = field(init=False, repr=False)
    _columns: list[int] = field(init=False, repr=False)
    _held: list[float] = field(init=False, repr=False)
    _pairs: list[tuple[Klampt, Klampt]] = field(init=False, repr=False)
    _states: FunctionWorld = field(init=False, repr=False)

    def __post_init__(self) -> None:
        names = [self.model.robot(i).getName() for i in range(self.model.numRobots())]
        require_known("robot of Klamp't's world", str(self.robot), [*names, *map(str, range(len(names)))])
        robot = self.model.robot(self.robot)
        links = _driven(robot) if self.links is None else tuple(self.links)
        columns = _columns_of(robot, links)
        tests = _collide.WorldCollider(self.model).collisionTests(
            lambda body: _is_part(body, robot), lambda body: not _is_part(body, robot), bb_reject=False
        )
        set_fields(
            self,
            links=links,
            space=_space_of(robot, columns),
            _robot=robot,
            _columns=columns,
            _held=list(robot.getConfig()),
            _pairs=[(own[1], other[1]) for own, other in tests],
        )
        set_fields(self, _states=FunctionWorld(self.space, self._free, self.resolution))

    def whole(self, q: npt.ArrayLike) -> Floats:
        """Return Klamp't's configurations, (n, links), for ours, (n, dim)."""
        batch = as_batch("q", q, self.space.dim)
        rows = np.tile(self._held, (len(batch), 1))
        rows[:, self._columns] = batch
        return rows

    def explain(self, q: Floats) -> str:
        """Return in words why one configuration, (dim,), is not free."""
        return self._states.explain(q)

    @property
    def proof(self) -> str:
        """Proof of a motion: states close together."""
        return self._states.proof

    def validate(self, path: Floats) -> Bools:
        """Return which motions of a path, (p, dim), are free at states much closer together: (p - 1,)."""
        return self._states.validate(path)

    def _free(self, q: Floats) -> Bools:
        robot, before = self._robot, self._robot.getConfig()
        free = np.empty(len(q), dtype=np.bool_)
        for i, row in enumerate(self.whole(q).tolist()):
            robot.setConfig(row)
            free[i] = not (robot.selfCollides() or any(own.collides(other) for own, other in self._pairs))
        robot.setConfig(before)
        return free


def plan_on_points(
    world: World, start: npt.ArrayLike, goal: npt.ArrayLike, points: PointSet | npt.ArrayLike, knn: int = 10
) -> Floats | None:
    """Grow Klamp't's PRM in our world on as many samples as there are points; return its path, (p, dim), or None.

    Parameters
    ----------
    world : World
        The world that checks configurations and motions.
    start, goal : array_like, shape (dim,)
        Configurations.
    points : PointSet, or array_like, shape (n, dim)
        Points of the cube, or configurations.
    knn : int
        Number of neighbours that Klamp't tries to join each milestone to, >= 1.
    """
    if isinstance(points, PointSet):
        points = world.space.from_cube(points.points)
    configurations = as_batch("points", points, world.space.dim)
    space = cspace_of(world, configurations)
    plan = _cspace.MotionPlan(space, "prm", knn=require_count("knn", knn), connectionThreshold=1e9, shortcut=0)
    try:
        endpoints = as_batch("start and goal", [start, goal], world.space.dim).tolist()
        if not world.valid(np.array(endpoints)).all():
            return None
        plan.setEndpoints(*endpoints)
        plan.planMore(len(configurations))
        path = plan.getPath()
        return continued(np.array(path), world.space, np.array(endpoints[0])) if path else None
    finally:
        plan.close()
        space.close()


def cspace_of(world: World, points: PointSet | npt.ArrayLike) -> Klampt:
    """Return our world as a ``klampt.plan.cspace.CSpace``, for ``MotionPlan``; ``close()`` it afterwards.

    Checks, metric and motions are ours; samples are the points in order.  A planner that samples more of them raises
    :class:`evenroad.errors.Exhausted`.
    """
    return _OurSpace(world, points)


def klampt_motion(robot: Klampt, motion: Trajectory | npt.ArrayLike, of: Robot | Sequence[str]) -> Klampt:
    """Return a motion of ours as a ``klampt.model.trajectory.RobotTrajectory``.

    Parameters
    ----------
    robot : klampt.RobotModel
        Robot whose links it moves; its other links do not move.
    motion : Trajectory, or array_like, shape (p, dim)
        A path's waypoints get the times 0, 1, 2, ...
    of : Robot, or sequence of str
        Our robot, with held joints and mimics; or the link of each number, as :attr:`KlamptWorld.links`.
    """
    timed = isinstance(motion, Trajectory)
    q = as_batch("motion", motion.positions if timed else motion, len(_moved(of)))  # type: ignore[union-attr]
    rows = np.tile(robot.getConfig(), (len(q), 1))
    if isinstance(of, Robot):
        child, values = {joint.name: joint.child for joint in of.joints}, joint_values(of, q)
        rows[:, _columns_of(robot, [child[name] for name in values])] = np.column_stack([*values.values()])
    else:
        rows[:, _columns_of(robot, of)] = q
    times = motion.times.tolist() if isinstance(motion, Trajectory) else list(map(float, range(len(q))))
    return _motions.RobotTrajectory(robot, times, rows.tolist())


def motion_of(motion: Klampt, of: Robot | Sequence[str]) -> tuple[Floats, Floats]:
    """Return the times, (p,), and our configurations, (p, dim), of a ``RobotTrajectory``; `of` as before."""
    rows = np.array(motion.milestones, dtype=np.float64)
    return np.array(motion.times, dtype=np.float64), rows[:, _columns_of(motion.robot, _moved(of))]


class _OurSpace(_cspace.CSpace):  # type: ignore[misc, name-defined, unused-ignore]
    """A CSpace of our world."""

    def __init__(self, world: World, points: PointSet | npt.ArrayLike) -> None:
        super().__init__()
        space = world.space
        given = space.from_cube(points.points) if isinstance(points, PointSet) else points
        configurations = as_batch("points", given, space.dim)
        self.world = world
        self._rest: Iterator[list[float]] = iter(configurations.tolist())
        # Klamp't takes the number of dimensions from the bounds.
        self.bound = [(0.0, 1.0)] * space.dim

    def feasible(self, q: list[float]) -> bool:
        return bool(self.world.valid(np.array([q]))[0])

    def visible(self, a: list[float], b: list[float]) -> bool:
        return bool(self.world.motion_valid(np.array([a]), np.array([b]))[0])

    def distance(self, a: list[float], b: list[float]) -> float:
        return float(self.world.space.distance(np.array([a]), np.array([b]))[0])

    def interpolate(self, a: list[float], b: list[float], u: float) -> list[float]:
        row: list[float] = self.world.space.interpolate(np.array([a]), np.array([b]), u)[0].tolist()
        return row

    def sample(self) -> list[float]:
        for configuration in self._rest:
            return configuration
        raise Exhausted("Klamp't's planner samples more points than it was given")


def _moved(of: Robot | Sequence[str]) -> Sequence[str]:
    """Return the link that each joint of the group moves."""
    if not isinstance(of, Robot):
        return of
    child = {joint.name: joint.child for joint in of.joints}
    return [child[name] for name in of.group]


def _columns_of(robot: Klampt, links: Sequence[str]) -> list[int]:
    numbers = {robot.link(i).getName(): i for i in range(robot.numLinks())}
    for link in links:
        require_known("link of Klamp't's robot", link, numbers)
    return [numbers[link] for link in links]


def _driven(robot: Klampt) -> tuple[str, ...]:
    """Return the links that a driver moves alone, in Klamp't's order."""
    drivers = [robot.driver(i) for i in range(robot.numDrivers())]
    for driver in drivers:
        if driver.getType() != "normal":
            raise InvalidValue(
                f"driver {driver.getName()!r} of Klamp't's robot moves several joints: say which `links` to plan for"
            )
    return tuple(robot.link(driver.getAffectedLink()).getName() for driver in drivers)


def _space_of(robot: Klampt, columns: Sequence[int]) -> JointSpace:
    low, high = (np.array(row)[list(columns)] for row in robot.getJointLimits())
    wrapping = [robot.getJointType(i) == "spin" for i in columns]
    low, high = np.where(wrapping, -math.pi, low), np.where(wrapping, math.pi, high)
    for i, least, most in zip(columns, low, high, strict=True):
        if not (math.isfinite(least) and math.isfinite(most) and least < most):
            link = robot.link(i).getName()
            raise InvalidValue(f"link {link!r} of Klamp't's robot must have limits, low < high, got {least}, {most}")
    return JointSpace(tuple(low.tolist()), tuple(high.tolist()), tuple(wrapping))


def _is_part(body: Klampt, robot: Klampt) -> bool:
    return isinstance(body, klampt.RobotModelLink) and body.robot().index == robot.index
