"""A robot's roadmap, free of the robot itself and of its fixed cell, and what becomes of it in the scene of a day."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats, Ints, Ints32
from evenroad.roadmap import Budget, PlanResult, Status
from evenroad.roadmap.answer import connected, gave_up, refusal
from evenroad.roadmap.attempt import Attempt
from evenroad.roadmap.find_path import NO_POINTS, SECONDS
from evenroad.roadmap.hemmed import with_reasons
from evenroad.roadmap.query import FEW, LINKS, Query, read_places
from evenroad.robot import ArmWorld, Robot, Scene, configuration, in_scene
from evenroad.robot_roadmap.cell import day_and_all, left_to_check, require_same_robot
from evenroad.robot_roadmap.lazy_search import Ways, ends_of, lazy_path
from evenroad.robot_roadmap.turns import TURN, OneTurn, one_turn, whole_turns
from evenroad.world.protocol import Connection

Place = str | npt.ArrayLike
"""A configuration: numbers in the order of the group, or a text as :func:`evenroad.robot.configuration` takes it."""

SHARE = 0.5
"""Of the time, for the roadmap; the rest is the trees', where it does not lead to the goal."""

_LONG = 1e8
"""Seconds that stand for no limit."""


@dataclass(frozen=True, eq=False)
class RobotRoadmap:
    """Milestones and motions of a robot in its cell; made once by :func:`make_roadmap`, good for every scene.

    Attributes
    ----------
    robot : Robot
        Whose roadmap it is.
    cell : Scene
        What never moves around it.
    resolution : float
        Largest step of a motion check [rad].
    milestones : ndarray, shape (n, dim)
        Free of robot and cell, of which every beginning is well spread [rad or m]; read-only.
    edges : ndarray of int32, shape (m, 2)
        Motions that are proved free of robot and cell, smaller row first, ascending; read-only.
    turns : ndarray of int8, shape (m, dim)
        By how many turns each edge leads past its second milestone; read-only.
    weights : ndarray, shape (dim,)
        What a unit of each joint counts in the roadmap's metric.
    gamma : float
        The power of the chance of being free that milestones are as dense as.
    """

    robot: Robot
    cell: Scene
    resolution: float
    milestones: Floats
    edges: Ints32
    turns: Ints
    weights: Floats
    gamma: float

    @cached_property
    def world(self) -> ArmWorld:
        """The robot in its cell alone."""
        return ArmWorld(self.robot, self.cell, resolution=self.resolution)

    @cached_property
    def one_turn(self) -> OneTurn:
        """The ranges that the milestones are in."""
        return one_turn(self.world.space, whole_turns(self.robot))

    @cached_property
    def ways(self) -> Ways:
        """The roadmap by node, for the compiled search."""
        one, m = self.one_turn, len(self.edges)
        own = np.concatenate([self.edges[:, 0], self.edges[:, 1]]).astype(np.int64)
        order = np.argsort(own, kind="stable")
        first = np.searchsorted(own[order], np.arange(len(self.milestones) + 1))
        turned = np.where(one.lifts, self.turns, 0) @ (16 ** np.arange(self.turns.shape[1]))
        return Ways(
            self.milestones,
            first,
            np.concatenate([self.edges[:, 1], self.edges[:, 0]])[order].astype(np.int64),
            np.tile(np.arange(m), 2)[order],
            np.concatenate([turned, -turned])[order],
            np.tile(self.lengths, 2)[order],
            self.weights,
            one.limits,
            one.lifts,
            one.wraps & ~one.lifts,
            m,
        )

    @property
    def lengths(self) -> Floats:
        """Lengths of the edges in the roadmap's metric, (m,)."""
        a, b = self.milestones[self.edges[:, 0]], self.milestones[self.edges[:, 1]]
        return np.linalg.norm(self.weights * (b + TURN * self.turns - a), axis=1)

    def in_scene(self, scene: Scene) -> SceneRoadmap:
        """Return the roadmap in the day's scene, for many queries in it: what one finds out serves the next."""
        return SceneRoadmap(self, scene)

    def plan(
        self, scene: Scene, start: Place, goal: Place | Sequence[Place], *, budget: Budget | None = None
    ) -> PlanResult:
        """Plan in the day's scene, see :meth:`SceneRoadmap.plan`."""
        return self.in_scene(scene).plan(start, goal, budget=budget)


class SceneRoadmap:
    """A robot's roadmap in one scene, with what earlier queries found out there; of one thread.

    Parameters
    ----------
    roadmap : RobotRoadmap
    scene : Scene
        What stands around the robot today.  The roadmap's cell is always there, named again or not.
    robot : Robot, optional
        The roadmap's robot with other limits or named states.  Default: as it is in the scene.

    Attributes
    ----------
    world : ArmWorld
        The robot in its cell, with the day's obstacles.

    Raises
    ------
    InvalidValue
        If the robot is another than the roadmap's, or the scene has the cell in another way: the text says how.
    UnknownName
        If the scene names something that is not there.
    """

    def __init__(self, roadmap: RobotRoadmap, scene: Scene, robot: Robot | None = None) -> None:
        day, everything = day_and_all(roadmap.cell, scene)
        robot = in_scene(roadmap.robot if robot is None else robot, everything)
        require_same_robot(roadmap.robot, roadmap.cell, robot.empty_handed())
        resolution = roadmap.resolution
        self.roadmap = roadmap
        self.world = ArmWorld(robot, everything, resolution=resolution)
        # What the roadmap knows to be free of the robot and its cell is asked about the others alone.
        self._day = ArmWorld(*left_to_check(robot, roadmap.cell, day, everything), resolution=resolution)
        self._milestones = np.zeros(len(roadmap.milestones), dtype=np.int8)
        self._edges = np.zeros(len(roadmap.edges), dtype=np.int8)
        if not ends_of.overloads:
            # Compiled, or loaded, before a clock runs; nothing is checked.
            self.connect(roadmap.milestones[0], roadmap.milestones[:1], seconds=0.0)

    @cached_property
    def _ways(self) -> Ways:
        """The roadmap by node, within the limits of today."""
        ways, space = self.roadmap.ways, self.world.space
        limits = np.stack([np.maximum(ways.limits[0], space.low), np.minimum(ways.limits[1], space.high)])
        return ways._replace(limits=limits)

    def connect(
        self,
        start: Floats,
        goals: Floats,
        *,
        most_motions: int = 2**31 - 1,
        seconds: float = SECONDS,
        links: int = LINKS,
    ) -> Connection:
        """Join a start, (dim,), to the goal, (g, dim), that the roadmap leads to on the shortest way.

        Start and goals have to be free; each is linked to its nearest `links` milestones, of few to all.
        """
        n, m, g = len(self._milestones), len(self._edges), len(goals)
        # Compiled code is made anew for arrays that can be written to.
        start, goals = np.array(start), np.array(goals)
        start.setflags(write=False)
        goals.setflags(write=False)
        ends = ends_of(self._ways, start, goals, n if n <= FEW else links)
        edges = np.zeros(m + n * (1 + g) + g, dtype=np.int8)
        edges[:m] = self._edges
        deadline = time.perf_counter() + seconds
        path, goal, configurations, motions = lazy_path(
            self._ways, ends, self._milestones, edges, most_motions, deadline, self._day, self.world
        )
        self._edges[:] = edges[:m]
        return Connection(path, goal, n, configurations, motions)

    def plan(
        self,
        start: Place,
        goal: Place | Sequence[Place],
        *,
        budget: Budget | None = None,
        shorten: bool = True,
        trees: bool = True,
    ) -> PlanResult:
        """Plan from a start to one of the goals: along the roadmap and, where it does not lead there, with trees.

        Parameters
        ----------
        start, goal : str, array_like of shape (dim,); of goals a sequence of such, too
            Numbers in the order of the group [rad or m], or a text as :func:`evenroad.robot.configuration` takes it.
        budget : Budget, optional
            Default: 5 s.  Half of the time is the roadmap's, the rest the trees'.
        shorten : bool
            Whether the path is made shorter.
        trees : bool
            Whether trees are tried.

        Returns
        -------
        PlanResult
            Every motion of its path is proved free.

        Raises
        ------
        InvalidValue, UnknownName
            If start or goal is no configuration of the robot.
        """
        budget = Budget(seconds=SECONDS) if budget is None else budget
        places = read_places(self._place(start), self._places(goal), self.world.space)
        query = Query(*places, shorten=shorten, budget=budget)
        attempt = Attempt(self.world, query, NO_POINTS, "none", "robot roadmap")
        if (refused := refusal(attempt)) is not None:
            return refused
        seconds = max(SHARE * min(attempt.deadline - time.perf_counter(), _LONG), 1e-3)
        most = 2**31 - 1 if budget.motions is None else budget.motions
        with attempt.watch("search"):
            connection = self.connect(
                query.start, query.goals[attempt.goals], most_motions=most, seconds=seconds
            )
        attempt.motions_checked += connection.motions
        if connection.goal < 0 and trees and attempt.left() is not None:
            attempt.planner = "robot roadmap, then trees"
            grown = attempt.connect(self.world)
            connection = replace(
                grown,
                configurations=connection.configurations + grown.configurations,
                motions=connection.motions + grown.motions,
            )
        if connection.goal >= 0:
            return connected(attempt, connection)
        failed = gave_up(attempt, connection)
        if not trees:
            text = f"the roadmap of {len(self._milestones)} milestones does not lead from start to goal today"
            failed = replace(failed, status=Status.NOT_CONNECTED, message=text)
        return with_reasons(self.world, failed)

    def _place(self, place: Place) -> npt.ArrayLike:
        """Return a configuration of a text; of numbers themselves."""
        if isinstance(place, str):
            return configuration(self.world.robot, place, self.world.scene)
        return place

    def _places(self, goal: Place | Sequence[Place]) -> npt.ArrayLike:
        if isinstance(goal, list | tuple) and any(isinstance(each, str) for each in goal):
            return [self._place(each) for each in goal]  # type: ignore[return-value]
        return self._place(goal)  # type: ignore[arg-type]
